"""Hand-made programs that modules talk to: a central, and whatever else is a server.

The central records what a library sends and answers as told.  It has message ids of its own,
always puts the message name into the class data of deliveries (or follows the scheme of the
original, on request), routes nothing by itself, and can be slow, send in pieces, or be wrong in
any way.
"""
import itertools
import os
import socket
import struct
import threading

from support import codec, messages
from support.frame import (BROADCAST, Cutter, Frame, HANDLER_ONLY, IS_REPLY, QUERY, REPLY, SUCCESS,
                           class_name)
from support.waiting import Deadline, TimedOut, wait_until

#: What an answer function returns to keep silent.
SILENCE = object()


class Received:
    """A frame from the library, with the message's name and, for library messages, the decoded
    data."""

    def __init__(self, frame, name, value):
        self.frame, self.name, self.value = frame, name, value

    @property
    def content(self):
        return codec.content_of(self.frame.data, self.frame.order)

    def __repr__(self):
        return f"<{self.name or 'frame'} class {self.frame.cls} {self.value!r}>"


class Connection(threading.Thread):
    """One module's connection, served by a thread of its own."""

    def __init__(self, central, accepted, transport):
        super().__init__(daemon=True)
        self.central, self.socket, self.transport = central, accepted, transport
        self.cutter = Cutter()
        self.received = []
        self.closed = False
        self.module = self.host = None
        self.handlers = {}
        self.learnt = set()
        self.failure = None
        self._news = threading.Condition()
        self._writing = threading.Lock()

    # ------------------------------------------------------------- receiving

    def run(self):
        try:
            self.central.greet(self)
            while data := self.socket.recv(1 << 20):
                self.cutter.feed(data)
                while (frame := self.cutter.next()) is not None:
                    self._take(frame)
        except OSError:
            pass
        except Exception as error:  # a frame that breaks the protocol: the test looks at it
            self.failure = error
        with self._news:
            self.closed = True
            self._news.notify_all()

    def _take(self, frame):
        received = self.central.understand(self, frame)
        with self._news:
            self.received.append(received)
            self._news.notify_all()
        self.central.react(self, received)

    def wait_for(self, wanted, what="a frame", seconds=None, start=0):
        """The first received frame, from number start on, for which wanted(received) is true."""
        deadline = Deadline(seconds)
        with self._news:
            while True:
                for received in self.received[start:]:
                    if wanted(received):
                        return received
                start = len(self.received)
                if self.failure:
                    raise AssertionError(f"the library broke the protocol: {self.failure!r}")
                if self.closed or not self._news.wait(deadline.left()):
                    raise TimedOut(f"waited in vain for {what}; received {self.received[-8:]}")

    def wait_for_message(self, name, seconds=None, start=0):
        """The first frame of that message, a publication, query, request or notice."""
        return self.wait_for(lambda r: r.name == name, name, seconds, start)

    def wait_closed(self, seconds=None):
        wait_until(lambda: self.closed, "the module closes its connection", seconds)

    def messages(self, name=None):
        """Everything received so far of one message, or of all that are no look-ups."""
        with self._news:
            return [r for r in self.received
                    if (r.name == name if name else r.name != "x_ipc_msgInfoMsg")]

    def acknowledgements(self, dispatch=None):
        with self._news:
            return [r.frame for r in self.received if r.frame.cls == SUCCESS
                    and dispatch in (None, r.frame.dispatch)]

    def wait_acknowledged(self, dispatch, seconds=None):
        return self.wait_for(lambda r: r.frame.cls == SUCCESS and r.frame.dispatch == dispatch,
                             f"acknowledgement of {dispatch}", seconds).frame

    def wait_subscribed(self, name, seconds=None):
        """Handler ids of a message as soon as there is one."""
        wait_until(lambda: self.handlers.get(name.lower()), f"{name} is subscribed to", seconds)
        return list(self.handlers[name.lower()].values())

    # --------------------------------------------------------------- sending

    def send_bytes(self, data):
        piece = self.central.piece or len(data) or 1
        with self._writing:
            for start in range(0, len(data), piece):
                self.socket.sendall(data[start:start + piece])

    def send(self, frame):
        self.send_bytes(frame.pack())

    def reply(self, received, data, order="<"):
        """Central's own answer to a request."""
        self.send(Frame(0, IS_REPLY, data, parent=0, dispatch=0,
                        reference=received.frame.reference, order=order))

    def delivery(self, name, content=b"", *, data=None, cls=BROADCAST, order="<", dispatch=None,
                 handler=None, class_data=None, parent=-1):
        """The frame that delivers a message to the oldest handler, and its dispatch id."""
        if handler is None:
            handler = self.wait_subscribed(name)[0]
        if data is None:
            data = codec.variable(content, order)
        if class_data is None:
            known = self.central.original_scheme and name.lower() in self.learnt
            class_data = b"" if known else class_name(name)
        dispatch = self.central.next_dispatch() if dispatch is None else dispatch
        return Frame(cls, handler, data, class_data, parent=parent, reference=dispatch,
                     order=order, class_order="<")

    def deliver(self, name, content=b"", **options):
        """Delivers a message; returns the dispatch id."""
        frame = self.delivery(name, content, **options)
        self.send(frame)
        return frame.reference

    def deliver_number(self, name, number, order="<", **options):
        return self.deliver(name, struct.pack(order + "i", number), order=order, **options)

    def answer(self, query, name, content=b"", order="<"):
        """Relays a response to a user's query of the module."""
        self.send(Frame(REPLY, IS_REPLY, codec.variable(content, order), class_name(name),
                        parent=0, dispatch=0, reference=query.frame.reference, order=order,
                        class_order="<"))

    def announce_broadcasts(self):
        """Sends the list of subscribed messages to the module's watch, if it has one."""
        if messages.WATCH_BROADCASTS.lower() in self.handlers:
            data = codec.encode(messages.NAME_LIST, messages.name_list(self.central.broadcasts))
            self.deliver(messages.WATCH_BROADCASTS, data=data)

    def drop(self):
        """Closes the connection."""
        try:
            self.socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self.socket.close()


class Server:
    """Listens on a port that the kernel chose, on one of the loopback addresses.

    What a subclass makes of its connections is in greet(), understand() and react().
    """

    def __init__(self, *, unix=False, tcp=True, host="127.0.0.1", port=0, piece=None):
        self.piece = piece
        self.connections = []
        self._lock = threading.RLock()
        self._listeners = []
        self.port = self._listen_tcp(host, port, tcp)
        self.unix_path = f"/tmp/x_ipc/{self.port}"
        if os.path.exists(self.unix_path):
            os.unlink(self.unix_path)  # left behind by somebody: the port is ours
        if unix:
            self._listen_unix()
        self.address = f"localhost:{self.port}"

    def greet(self, connection):
        """Sends what comes before everything else."""

    def understand(self, _connection, frame):
        """Finds out what a received frame means."""
        return Received(frame, None, None)

    def react(self, connection, received):
        """Answers a received frame."""

    def _listen_tcp(self, host, port, serve):
        listener = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        if serve:
            listener.listen(64)
            self._serve(listener, "tcp")
        else:
            self._listeners.append(listener)
        return listener.getsockname()[1]

    def _listen_unix(self):
        os.makedirs(os.path.dirname(self.unix_path), mode=0o777, exist_ok=True)
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(self.unix_path)
        os.chmod(self.unix_path, 0o777)
        listener.listen(64)
        self._serve(listener, "unix")

    def _serve(self, listener, transport):
        self._listeners.append(listener)
        threading.Thread(target=self._accept, args=(listener, transport), daemon=True).start()

    def _accept(self, listener, transport):
        while True:
            try:
                accepted, _ = listener.accept()
            except OSError:
                return
            if transport == "tcp":
                accepted.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            connection = Connection(self, accepted, transport)
            with self._lock:
                self.connections.append(connection)
            connection.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def stop_listening(self):
        for listener in self._listeners:
            try:
                listener.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
            listener.close()
        if os.path.exists(self.unix_path):
            os.unlink(self.unix_path)

    def close(self):
        self.stop_listening()
        for connection in self.connections:
            connection.drop()

    def connection(self, number=0, seconds=None):
        """The connection that was made as number ..., counted from 0."""
        wait_until(lambda: len(self.connections) > number, "a module connects", seconds)
        return self.connections[number]


class FakeCentral(Server):
    """A central that behaves, unless it is told otherwise."""

    def __init__(self, *, first_id=1000, version=(3, 10), direct=False, original_scheme=False,
                 broadcasts=(), **sockets):
        self.version, self.direct, self.original_scheme = version, direct, original_scheme
        self.broadcasts = [messages.WATCH_BROADCASTS, *broadcasts]
        self.definitions = {}
        self.formats = {}
        self.answers = {}
        self._dispatches = itertools.count(0)
        self._ids = itertools.count(first_id, 7)
        self.ids, self.names = {}, {}
        self._naming = threading.RLock()
        self.look_up_id = self.id_of("x_ipc_msgInfoMsg")
        super().__init__(**sockets)

    # ---------------------------------------------------------------- naming

    def id_of(self, name):
        with self._naming:
            key = name.lower()
            if key not in self.ids:
                self.ids[key] = next(self._ids)
                self.names[self.ids[key]] = name
            return self.ids[key]

    def next_dispatch(self):
        return next(self._dispatches)

    def define(self, name, content="int", wire=codec.VARIABLE, cls=BROADCAST):
        self.definitions[name.lower()] = (name, cls, wire, content)

    def understand(self, connection, frame):
        """Finds the name and, if it is a library message, the value of a received frame."""
        name = self.names.get(abs(frame.intent)) if frame.dispatch == -1 else None
        if frame.cls not in (QUERY, 6, BROADCAST):
            name = frame.message_name()
        message = messages.find(name) if name else None
        value = codec.decode(message.request, frame.data, frame.order) if message else None
        return Received(frame, name, value)

    # ------------------------------------------------------------- answering

    def prelude(self):
        formats = ("{string, string}", messages.MESSAGE_INFO)
        frames = (Frame(0, 0, codec.encode("format", codec.parse(text)), parent=0, dispatch=0,
                        reference=0) for text in formats)
        return struct.pack(">i", self.look_up_id) + b"".join(frame.pack() for frame in frames)

    def greet(self, connection):
        """What is sent at accept; to be replaced by a test that wants something else."""
        connection.send_bytes(self.prelude())

    def react(self, connection, received):
        name = received.name
        if name is None or received.frame.cls not in (QUERY, 6):
            return
        data = None
        if name in self.answers:
            data = self.answers[name](connection, received)
        elif handler := self._REACTIONS.get(name):
            data = handler(self, connection, received.value)
        elif name.startswith("V_get_"):
            data = self._variable(name.removeprefix("V_get_"))
        if received.frame.cls == QUERY and messages.find(name) and data is not SILENCE:
            connection.reply(received, data or b"")

    def message_info(self, name):
        """The value with which a look-up is answered."""
        message = messages.find(name)
        if message:
            second = message.reply if message.cls == QUERY else None
            return (self.id_of(message.name), message.name, message.cls,
                    codec.parse(message.request), codec.parse(second))
        if name.lower() in self.definitions:
            name, cls, wire, content = self.definitions[name.lower()]
            number = self.id_of(name)
            return (-number if self.direct else number, name, cls, codec.parse(wire),
                    self._expand(codec.parse(content)))
        if any(name.lower() in connection.handlers for connection in self.connections):
            return (0, name, HANDLER_ONLY, None, None)
        return None

    def _expand(self, fmt):
        """Replaces named formats by their definitions."""
        if not isinstance(fmt, tuple):
            return fmt
        if fmt and fmt[0] == "named":
            text = self.formats.get(fmt[1])
            return self._expand(codec.parse(text)) if text else ("bad",)
        return tuple(self._expand(part) for part in fmt)

    def _look_up(self, connection, value):
        name, handler = value
        if handler and name:
            connection.learnt.add(name.lower())
        return codec.encode(messages.MESSAGE_INFO, self.message_info(name))

    def _class_info(self, _connection, cls):
        text = messages.CLASS_FORMATS.get(cls)
        return codec.encode("*{int, format}", (cls, codec.parse(text)) if text else None)

    def _introduce(self, connection, value):
        connection.module, connection.host = value
        return codec.encode("{{int, int}, boolean}", (self.version, int(self.direct)))

    def _ready(self, _connection, _value):
        return codec.encode("int", 1)

    def _subscribe(self, connection, value):
        number, name, handler = value
        by_name = connection.handlers.setdefault(name.lower(), {})
        by_name.setdefault(handler, number)

    def _unsubscribe(self, connection, value):
        connection.handlers.get(value[1].lower(), {}).pop(value[2], None)

    def _define(self, _connection, value):
        name, cls, wire, content = value
        self.define(name, content, wire, cls)

    def _define_format(self, _connection, value):
        self.formats[value[0]] = value[1]

    def _get_format(self, _connection, name):
        return codec.encode("format", self._expand(("named", name)))

    def _is_connected(self, _connection, name):
        present = any(c.module == name and not c.closed for c in self.connections)
        return codec.encode("int", int(present))

    def _variable(self, variable):
        if variable == messages.BROADCASTS:
            return codec.encode(messages.NAME_LIST, messages.name_list(self.broadcasts))
        if variable == messages.TAPPED:
            return codec.encode(messages.NAME_LIST, messages.name_list([]))
        return codec.encode(messages.LOG_OPTIONS, (None,) + (0,) * 11)

    _REACTIONS = {
        "x_ipc_msgInfoMsg": _look_up,
        "x_ipc_classInfoMsg": _class_info,
        "x_ipc_newModuleConnectMsg": _introduce,
        "x_ipc_waitMsg": _ready,
        "x_ipc_registerHandlerMsg": _subscribe,
        "x_ipc_deregisterHandlerMsg": _unsubscribe,
        "x_ipc_registerMessageMsg": _define,
        "x_ipc_registerNamedFormMsg": _define_format,
        "x_ipc_getNamedFormMsg": _get_format,
        "x_ipc_moduleConnectedQ": _is_connected,
    }
