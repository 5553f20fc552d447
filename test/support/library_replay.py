"""Plays everybody's side of a capture against one of its modules, which is on a real library.

The module carries out commands of its own; this central answers its requests with the recorded
bytes, sends the recorded deliveries and responses, and compares what the module sends with what
the original library sent.  Where modules talk to each other directly, the other one is played
here, too.

Handler ids, references and ports are the library's own and are mapped; addresses inside handler
names are ignored.  A library may take its handshake in another order, name another host, and
leave out what has no effect:

* look-ups and class formats;
* limits for the variables of central, which name no message;
* the repetition of a subscription that holds;
* in direct mode, watching variables of central that it does not use, and who handles a message
  that is only sent as a response.

It may add what changes nothing: the question whether it is connected itself, whose answer tells
that central has handled a subscription, and in direct mode, where central tells all changes of
handlers, the wish to be told.

A module on a machine of another kind sends other bytes for the same values; of such a recording
the values are compared.
"""
import re
import socket

from support import codec, messages
from support.fake_central import Connection, FakeCentral, Server
from support.frame import BROADCAST, Frame, HANDLER_ONLY, INFORM, IS_REPLY, QUERY, REPLY
from support.peer import LOOK_UP

#: Requests that belong to the handshake or to the library's own caching.
UNCOMPARED = {LOOK_UP, "x_ipc_classInfoMsg", "x_ipc_waitMsg", "x_ipc_directMsgQuery",
              "x_ipc_getNamedFormMsg",
              *("V_get_" + variable for variable in messages.VARIABLES)}
OWN_ORDER = "<"
OWN_HOST = socket.gethostname()[:32]  # as much of the name as decides on the transport
DIRECT_PORTS = range(8000, 9001)


def _plain(value):
    """A decoded value without the addresses in handler names."""
    if isinstance(value, tuple):
        return tuple(_plain(item) for item in value)
    if isinstance(value, str) and value.startswith("HND-"):
        return re.sub(r"\d{6,}$", "", value)
    return value


class OtherModule(Server):
    """The module at the other end of a direct link.  On such a socket nobody is greeted."""

    def __init__(self, recorded):
        self.recorded = recorded
        unix = recorded.transport == "unix"
        super().__init__(unix=unix, tcp=not unix)
        # The library takes the Unix socket of a port where the host is its own.
        self.host = OWN_HOST if unix else "localhost"

    def connect_to(self, port):
        """Connects to the module under test as the recorded module did."""
        if self.recorded.transport == "unix":
            connected = socket.socket(socket.AF_UNIX)
            connected.connect(f"/tmp/x_ipc/{port}")
        else:
            connected = socket.create_connection(("127.0.0.1", port))
        self.connections.append(Connection(self, connected, self.recorded.transport))
        self.connections[0].start()


class RecordedCentral(FakeCentral):
    """A central whose ids and answers come from a capture, as the module of one connection saw it.

    foreign says that the module ran on a machine of another kind.
    """

    def __init__(self, capture, tag, *, foreign=False):
        self.tag, self.foreign = tag, foreign
        own = capture.connections[tag]
        self.module = own.module
        self.others = {other.tag: OtherModule(other) for other in capture.connections.values()
                       if other.direct and tag in (other.accepted_by, self._maker(capture, other))}
        self.lines = [line for line in capture.lines if line.tag in (tag, *self.others)]
        self.recorded_names = {}
        self.contents = {}
        self.recorded_answers = {}
        self.sent_queries = {}
        self.taken = set()
        self.responses = set()
        self.announced_port = None
        self._recorded_handlers = {}
        self._subscribed = set()  # recorded subscriptions that hold
        self._held = set()        # subscriptions of the module under test
        self._read()
        unix = own.transport == "unix"
        super().__init__(first_id=100_000, direct=bool(self.others), unix=unix, tcp=not unix)
        if unix:
            self.address = f"{OWN_HOST}:{self.port}"
        for number, name in self.recorded_names.items():
            self.ids[name.lower()], self.names[number] = number, name
        self.look_up_id = self.ids[LOOK_UP.lower()]

    @staticmethod
    def _maker(capture, link):
        """Tag of the connection to central of the module that makes a direct link."""
        return next(tag for tag, other in capture.connections.items()
                    if other.module == link.module and not other.direct)

    def close(self):
        super().close()
        for other in self.others.values():
            other.close()

    # -------------------------------------------------------------- the recording

    def _read(self):
        """Collects names, ids, formats and the answers to requests."""
        asked = {}
        for line in self.lines:
            frame = line.frame
            if line.kind == "prelude":
                self.recorded_names[line.value] = LOOK_UP
            elif line.kind != "frame":
                continue
            elif line.tag in self.others:
                self.responses.update([frame.message_name()] if frame.cls == REPLY else [])
            elif line.direction == ">" and frame.cls == QUERY and frame.dispatch == -1:
                name = self.recorded_names[abs(frame.intent)]
                asked[frame.reference] = (name, self._request_value(name, frame))
            elif frame.intent == IS_REPLY and frame.cls == 0:
                key = asked[frame.reference]
                self.recorded_answers.setdefault(key, []).append(frame.data)
                if key[0] == LOOK_UP:
                    self._read_info(codec.decode(messages.MESSAGE_INFO, frame.data, frame.order))

    def _read_info(self, info):
        if info and info[0]:
            self.recorded_names[abs(info[0])] = info[1]
            self.contents[info[1]] = info[4]

    @staticmethod
    def _request_value(name, frame):
        message = messages.find(name)
        value = codec.decode(message.request, frame.data, frame.order) if message else None
        if name == LOOK_UP:
            return value[0].lower()
        return None if name == "x_ipc_newModuleConnectMsg" else value

    # ---------------------------------------------------------------- answering

    def react(self, connection, received):
        """Answers as recorded; what the original did not ask is answered as by any central."""
        value = received.value
        if received.name == LOOK_UP:
            value = value[0].lower()
        elif received.name == "x_ipc_newModuleConnectMsg":
            connection.module, connection.host, value = *received.value, None
        answers = self.recorded_answers.get((received.name, value))
        if answers and received.frame.cls == QUERY:
            data = answers.pop(0) if len(answers) > 1 else answers[0]
            if received.name == "x_ipc_directMsgQuery":
                data = self._redirected(data)
            connection.reply(received, data)
        else:
            super().react(connection, received)

    def message_info(self, name):
        """Names that the original looked up under another handler, or not at all, here."""
        info = super().message_info(name)
        return None if info and info[2] == HANDLER_ONLY else info

    def _redirected(self, data):
        """A list of handlers that leads to the other module of this replay."""
        if not data or not self.others:
            return data
        other = next(iter(self.others.values()))
        count, handlers = codec.decode(messages.HANDLER_LIST, data)
        return codec.encode(messages.HANDLER_LIST, (count, [
            (*handler[:3], other.port, other.host, handler[5]) for handler in handlers]))

    # ---------------------------------------------------------------- the replay

    def replay(self, leave=None):
        """Compares and sends, line by line, until the module has left.

        leave, if given, is called when the module is to send its close notice.  Returns the
        number of frames that were compared.
        """
        connection = self.connection()
        for line in self.lines:
            if line.tag in self.others:
                self._replay_link(self.others[line.tag], line)
            elif line.kind != "frame":
                continue
            elif line.direction == ">":
                if leave and self._name(line.frame) == "x_ipc_CloseMsg":
                    leave()
                self._expect(connection, line.frame)
            elif line.frame.intent == IS_REPLY and line.frame.cls == REPLY:
                query = self.sent_queries[line.frame.reference]
                self._send(connection, line.frame, intent=IS_REPLY,
                           reference=query.frame.reference)
            elif line.frame.intent not in (0, IS_REPLY):
                assert line.frame.cls in (BROADCAST, QUERY, INFORM)
                self._send(connection, line.frame,
                           intent=self._recorded_handlers[line.frame.intent])
        return len(self.taken)

    def expect_no_more(self):
        """Waits for the end of all connections; nothing came that has not been compared."""
        for server in (self, *self.others.values()):
            connection = server.connection()
            connection.wait_closed()
            assert connection.failure is None
            assert len(server.connections) == 1
            more = [received for received in connection.received
                    if id(received) not in self.taken and not self._may_be_left_out(received)
                    and not self._may_be_added(received)]
            assert not more, f"sent besides: {more}"

    def _name(self, frame):
        return self.recorded_names.get(abs(frame.intent)) if frame.dispatch == -1 else None

    def _may_be_left_out(self, received):
        name, value = received.name, received.value
        if name in UNCOMPARED:
            return True
        if name == "x_ipc_limitPendingMsg":
            return value[0] in messages.VARIABLES
        if name == "x_ipc_registerHandlerMsg":
            watched = value[1].removeprefix("V_watch_") if value[1].startswith("V_watch_") else None
            return watched in self.responses or (watched in messages.VARIABLES
                                                 and watched != messages.BROADCASTS)
        return False

    def _may_be_added(self, received):
        name, value = received.name, received.value
        return ((name == "x_ipc_registerHandlerMsg" and value[1:] in self._held) or
                (name == "x_ipc_moduleConnectedQ" and value == self.connection().module) or
                (name == "x_ipc_notifyHandlerChange" and self.direct))

    def _take(self, connection, wanted, what):
        """Waits for a received frame, not taken before, for which wanted() is true."""
        def fresh(received):
            return id(received) not in self.taken and wanted(received)
        received = connection.wait_for(fresh, what)
        self.taken.add(id(received))
        return received

    def _expect(self, connection, frame):
        if frame.dispatch != -1:
            self._expect_answer(connection, frame)
            return
        recorded = self.understand(connection, frame)
        name, exact = recorded.name, recorded.value
        if messages.find(name) is None:
            self._expect_message(connection, name, frame)
        elif self._may_be_left_out(recorded):
            return
        elif name == "x_ipc_registerHandlerMsg":
            self._expect_subscription(connection, exact)
        elif name in ("x_ipc_newModuleConnectMsg", "x_ipc_directResMsg"):
            received = self._take(connection, lambda r: r.name == name, name)
            self._check_introduction(received.value, exact)
        else:
            self._subscribed.discard(exact[1:] if isinstance(exact, tuple) else None)
            self._take(connection, lambda r: r.name == name and _plain(r.value) == _plain(exact),
                       f"{name} {exact}")

    def _expect_subscription(self, connection, recorded):
        if recorded[1:] in self._subscribed:
            return
        self._subscribed.add(recorded[1:])
        received = self._take(
            connection, lambda r: r.name == "x_ipc_registerHandlerMsg"
            and _plain(r.value)[1:] == _plain(recorded)[1:], f"subscription {recorded}")
        self._held.add(received.value[1:])
        if recorded[0]:
            self._recorded_handlers[recorded[0]] = received.value[0]

    def _check_introduction(self, value, recorded):
        """{module, host}, or {port, module} of a module that accepts direct links."""
        if isinstance(recorded[0], int):
            self.announced_port = value[0]
            assert value[0] in DIRECT_PORTS
            assert value[1] == recorded[1]
        else:
            assert value[0] == recorded[0]

    def _expect_message(self, connection, name, frame):
        """A publication or a query of the module."""
        received = self._take(
            connection, lambda r: r.name == name and r.frame.cls == frame.cls
            and self._same_content(name, r.frame, frame), f"{name} with {frame.data!r}")
        assert abs(received.frame.intent) == abs(frame.intent)
        assert received.frame.class_data == frame.class_data
        self.sent_queries[frame.reference] = received

    def _same_content(self, name, frame, recorded):
        if not self.foreign:
            return (frame.data, frame.order) == (recorded.data, recorded.order)
        return frame.order == OWN_ORDER and self._content(name, frame) == self._content(
            name, recorded)

    def _content(self, name, frame):
        content = codec.content_of(frame.data, frame.order)
        for long_size in (8, 4):
            try:
                return codec.decode(self.contents[name], content, frame.order,
                                    long_size=long_size)
            except codec.Malformed:
                continue
        raise AssertionError(f"{content!r} is no {self.contents[name]}")

    def _expect_answer(self, connection, frame):
        """An acknowledgement or a response; dispatch ids are those of the recording."""
        received = self._take(
            connection, lambda r: r.frame.dispatch == frame.dispatch and r.frame.cls == frame.cls,
            f"class {frame.cls} for dispatch {frame.dispatch}").frame
        got = (received.intent, received.reference, received.class_data, received.data,
               received.order)
        assert got == (frame.intent, frame.reference, frame.class_data, frame.data,
                       OWN_ORDER if self.foreign else frame.order)
        assert received.parent in (frame.parent, frame.dispatch)

    def _send(self, connection, frame, **mapped):
        """Sends a recorded frame in which some numbers are replaced."""
        connection.send(Frame(**{**vars(frame), **mapped}))

    # ------------------------------------------------------------- direct links

    def _replay_link(self, other, line):
        """A line of a direct link, which either side may have made."""
        accepts = other.recorded.accepted_by == self.tag
        if line.kind == "connect":
            if accepts:
                other.connect_to(self.announced_port)
            other.connection()
        elif line.kind == "frame" and (line.direction == "<") == accepts:
            self._expect_on_link(other.connection(), line.frame)
        elif line.kind == "frame" and line.frame.cls == REPLY:
            reference = self.sent_queries[line.frame.reference].frame.reference
            self._send(other.connection(), line.frame, dispatch=reference, reference=reference)
        elif line.kind == "frame":
            self._send(other.connection(), line.frame,
                       intent=self._recorded_handlers[line.frame.intent])

    def _expect_on_link(self, connection, frame):
        """Handler ids of the other module and references of its queries are those recorded."""
        if frame.cls == REPLY:
            self._expect_answer(connection, frame)
            return
        wanted = (frame.cls, frame.intent, frame.class_data, frame.data, frame.order, frame.parent,
                  frame.dispatch)
        self.sent_queries[frame.reference] = self._take(
            connection, lambda r: wanted == (
                r.frame.cls, r.frame.intent, r.frame.class_data, r.frame.data, r.frame.order,
                r.frame.parent, r.frame.dispatch),
            f"class {frame.cls} for handler {frame.intent} with {frame.data!r}")
