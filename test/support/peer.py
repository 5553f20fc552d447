"""A hand-made module: speaks the protocol of modules byte by byte, without any of our C code."""
import collections
import dataclasses
import itertools
import os
import socket
import struct

import pytest

from support import codec, messages
from support.frame import (BROADCAST, Cutter, FAILURE, Frame, INFORM, IS_REPLY, NONE, QUERY, REPLY,
                           SUCCESS, class_name)
from support.waiting import Deadline, PATIENCE, TimedOut

LOOK_UP = "x_ipc_msgInfoMsg"


class Closed(AssertionError):
    """The other side has closed the connection."""


@dataclasses.dataclass
class MessageInfo:
    """Answer to a look-up."""

    id: int
    name: str
    cls: int
    wire: tuple
    content: tuple


class Delivery:
    """A message that central has delivered, or one that came from another module."""

    def __init__(self, frame):
        self.frame = frame
        self.handler = frame.intent
        self.dispatch = frame.reference
        self.name = frame.message_name()

    @property
    def content(self):
        """The content bytes, of a message of variable length."""
        return codec.content_of(self.frame.data, self.frame.order)

    @property
    def number(self):
        """The content as one int."""
        return codec.decode("int", self.content, self.frame.order)

    def value(self, fmt):
        """The frame's data by a format: for what central itself broadcasts."""
        return codec.decode(fmt, self.frame.data, self.frame.order)


class Peer:
    """One connection to a central.

    order is the byte order in which the module writes.  piece, when set, is the number of bytes
    that go out at a time.  Frames that arrive are sorted: replies wait for whoever asks for their
    reference, everything else waits in line for next_delivery().
    """

    def __init__(self, central, name="PEER", *, host="robot", order="<", unix=False, piece=None):
        self.name, self.host, self.order, self.piece = name, host, order, piece
        if unix and os.environ.get("IPC_TEST_WITHOUT_UNIX"):
            pytest.skip("central has no Unix sockets there")
        self.socket = socket.socket(socket.AF_UNIX if unix else socket.AF_INET)
        self.socket.settimeout(PATIENCE)
        self.socket.connect(central.unix_path if unix else ("127.0.0.1", central.port))
        if not unix:
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.cutter = Cutter()
        self.replies = {}
        self.deliveries = collections.deque()
        self.look_up_id = None
        self.central_order = None  # the byte order in which central writes
        self.known = {}
        self.references = itertools.count(1)
        self.version = None
        self.direct = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # ----------------------------------------------------------------- bytes

    def send_bytes(self, data):
        if self.piece is None:
            self.socket.sendall(data)
            return
        for start in range(0, len(data), self.piece):
            self.socket.sendall(data[start:start + self.piece])

    def send(self, frame):
        self.send_bytes(frame.pack())

    def receive(self, deadline):
        """Takes in what arrives next; raises TimedOut or Closed when nothing does."""
        self.socket.settimeout(max(deadline.left(), 0.000001))
        try:
            data = self.socket.recv(1 << 20)
        except (TimeoutError, BlockingIOError):
            raise TimedOut(f"{self.name} waited in vain for bytes") from None
        except ConnectionError as error:
            raise Closed(f"{self.name}: {error}") from None
        finally:
            self.socket.settimeout(PATIENCE)
        if not data:
            raise Closed(f"{self.name}: end of file")
        self.cutter.feed(data)

    def read_raw(self, length):
        deadline = Deadline()
        while (data := self.cutter.take(length)) is None:
            self.receive(deadline)
        return data

    def read_frame(self, seconds=None):
        """The next frame, whatever it is."""
        deadline = Deadline(seconds)
        while (frame := self.cutter.next()) is None:
            self.receive(deadline)
        return frame

    def is_closed(self, seconds=None):
        """Waits for the other side to close; frames that still come are sorted in."""
        deadline = Deadline(seconds)
        try:
            while True:
                self._sort(self.read_frame(deadline.left()))
        except Closed:
            return True
        except TimedOut:
            return False

    # ---------------------------------------------------------------- frames

    def _sort(self, frame):
        if frame.intent == IS_REPLY:
            self.replies.setdefault(frame.reference, []).append(frame)
        else:
            self.deliveries.append(Delivery(frame))

    def await_reply(self, reference, seconds=None):
        """The reply frame with that reference; everything that comes before it is kept."""
        deadline = Deadline(seconds)
        while not self.replies.get(reference):
            self._sort(self.read_frame(deadline.left()))
        return self.replies[reference].pop(0)

    def has_reply(self, reference):
        """Whether the reply is already there; no waiting."""
        return bool(self.replies.get(reference))

    def next_delivery(self, seconds=None):
        deadline = Deadline(seconds)
        while not self.deliveries:
            self._sort(self.read_frame(deadline.left()))
        return self.deliveries.popleft()

    def take(self, count, *, acknowledge=True):
        """The next count deliveries, each acknowledged as it comes."""
        taken = []
        for _ in range(count):
            taken.append(self.next_delivery())
            if acknowledge:
                self.acknowledge(taken[-1])
        return taken

    def take_numbers(self, count):
        """The contents, one int each, of the next count deliveries."""
        return [delivery.number for delivery in self.take(count)]

    # -------------------------------------------------------------- requests

    def read_prelude(self):
        """The 137 bytes with which central begins; returns the two formats they hold."""
        self.look_up_id = struct.unpack(">i", self.read_raw(4))[0]
        self.known[LOOK_UP] = self.look_up_id
        frames = [self.read_frame() for _ in range(2)]
        self.central_order = frames[0].order
        return [codec.decode("format", frame.data, frame.order) for frame in frames]

    def next_reference(self):
        return next(self.references)

    def start_look_up(self, name, handler=None):
        reference = self.next_reference()
        data = codec.encode("{string, string}", (name, handler), self.order)
        self.send(Frame(QUERY, self.look_up_id, data, reference=reference, order=self.order))
        return reference

    def finish_look_up(self, reference):
        frame = self.await_reply(reference)
        found = codec.decode(messages.MESSAGE_INFO, frame.data, frame.order)
        return MessageInfo(*found) if found else None

    def look_up(self, name, handler=None):
        """What central tells about a message name, None for an unknown one."""
        return self.finish_look_up(self.start_look_up(name, handler))

    def id_of(self, name):
        """The message's id, as it has to stand in a frame to central."""
        if name not in self.known:
            found = self.look_up(name)
            if found is None:
                raise AssertionError(f"central does not know {name}")
            self.known[name] = found.id
        return self.known[name]

    def start_request(self, name, value=None, *, data=None):
        """Sends a library message of class query; data replaces the encoded value."""
        message = messages.find(messages.ALIASES.get(name, name))
        intent = self.id_of(name)
        if data is None:
            data = codec.encode(message.request, value, self.order)
        reference = self.next_reference()
        self.send(Frame(QUERY, intent, data, reference=reference, order=self.order))
        return reference

    def finish_request(self, reference, name, seconds=None):
        frame = self.await_reply(reference, seconds)
        if not frame.data:
            return None
        message = messages.find(messages.ALIASES.get(name, name))
        return codec.decode(message.reply, frame.data, frame.order)

    def request(self, name, value=None):
        """A library message of class query and its decoded answer; None for an answer without
        data."""
        return self.finish_request(self.start_request(name, value), name)

    def notice(self, name, value=None, *, data=None):
        """A library message of class inform."""
        message = messages.find(messages.ALIASES.get(name, name))
        intent = self.id_of(name)
        if data is None:
            data = codec.encode(message.request, value, self.order)
        self.send(Frame(INFORM, intent, data, reference=self.next_reference(), order=self.order))

    def sync(self):
        """Returns when central has handled everything that this module has sent, and everything
        that it sent to this module before is here."""
        self.look_up("x_ipc_waitMsg")

    # ------------------------------------------------------------- handshake

    def introduce(self):
        version, direct = self.request("x_ipc_newModuleConnectMsg", (self.name, self.host))
        self.version, self.direct = version, bool(direct)

    def ready(self):
        return self.request("x_ipc_waitMsg")

    def connect(self):
        """The shortest handshake there is."""
        self.read_prelude()
        self.introduce()
        self.ready()
        return self

    def connect_as_original(self, *, listen=True):
        """The handshake of the original library for routed messages."""
        self.read_prelude()
        for cls in messages.CLASS_FORMATS:
            self.request("x_ipc_classInfoMsg", cls)
        self.introduce()
        for variable in ("CENTRAL_TERMINAL_LOG_VAR", "CENTRAL_FILE_LOG_VAR", messages.TAPPED,
                         messages.BROADCASTS):
            self.request("V_get_" + variable)
        if listen:
            self.subscribe(messages.WATCH_BROADCASTS, 199, messages.WATCH_BROADCASTS)
            self.notice("x_ipc_limitPendingMsg", (messages.BROADCASTS, self.name, 1))
        self.ready()
        return self

    def say_goodbye(self):
        """The close notice, without closing."""
        self.notice("x_ipc_CloseMsg")

    def close(self):
        """Closes at once, without a notice."""
        self.socket.close()

    def reset(self):
        """Closes so that central gets a connection reset."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.socket.close()

    # ------------------------------------------------------- what modules do

    def define(self, name, content="int", wire=codec.VARIABLE, cls=BROADCAST):
        self.notice("x_ipc_registerMessageMsg", (name, cls, wire, content))

    def define_format(self, name, text):
        self.notice("x_ipc_registerNamedFormMsg", (name, text))

    def subscribe(self, name, handler, handler_name=None):
        """Subscribes with a handler id; the handler's name is made as the original makes it."""
        self.notice("x_ipc_registerHandlerMsg",
                    (handler, name, handler_name or f"HND-{name}{1000 + handler}"))

    def unsubscribe(self, name, handler_name):
        self.notice("x_ipc_deregisterHandlerMsg", (0, name, handler_name))

    def set_capacity(self, capacity):
        self.notice("x_ipc_registerResourceMsg", (capacity, self.name))

    def set_limit(self, name, limit):
        self.notice("x_ipc_limitPendingMsg", (name, self.name, limit))

    def set_priority(self, name, priority):
        self.notice("ipc_setMsgPriority", (name, priority))

    def publish(self, name, content=b"", *, data=None, parent=NONE):
        """Publishes content bytes in a message of variable length, or any frame data."""
        if data is None:
            data = codec.variable(content, self.order)
        self.send(Frame(BROADCAST, self.id_of(name), data, parent=parent,
                        reference=self.next_reference(), order=self.order))

    def publish_number(self, name, number):
        self.publish(name, struct.pack(self.order + "i", number))

    def query(self, name, content=b"", *, parent=NONE):
        """Sends a query; returns its reference for await_reply()."""
        reference = self.next_reference()
        self.send(Frame(QUERY, self.id_of(name), codec.variable(content, self.order),
                        parent=parent, reference=reference, order=self.order))
        return reference

    def query_number(self, name, number):
        return self.query(name, struct.pack(self.order + "i", number))

    def acknowledge(self, delivery):
        self.send(Frame(SUCCESS, parent=delivery.dispatch, dispatch=delivery.dispatch,
                        order=self.order))

    def fail(self, delivery, reason="reason"):
        self.send(Frame(FAILURE, parent=delivery.dispatch, dispatch=delivery.dispatch,
                        class_data=class_name(reason, self.order), order=self.order))

    def respond(self, delivery, name, content=b""):
        self.send(Frame(REPLY, parent=delivery.dispatch, dispatch=delivery.dispatch,
                        class_data=class_name(name, self.order),
                        data=codec.variable(content, self.order), order=self.order))

    def respond_number(self, delivery, name, number):
        self.respond(delivery, name, struct.pack(self.order + "i", number))


def reply_number(frame):
    """The int in a reply to a user's query."""
    return codec.decode("int", codec.content_of(frame.data, frame.order), frame.order)


def expect_nothing(receiver, *senders):
    """Asserts that nothing is on its way to receiver from what the senders have sent so far."""
    for sender in senders:
        sender.sync()
    receiver.sync()
    waiting = [(d.handler, d.name, d.frame.data[:40]) for d in receiver.deliveries]
    assert not waiting, f"{receiver.name} has received {waiting}"
