"""Plays central's side of one connection of a capture against a module on a library.

The module carries out commands of its own; this central answers its requests with the recorded
bytes, sends the recorded deliveries and responses, and compares what the module sends with what
the original library sent.

Handler ids and references are the library's own and are mapped; addresses inside handler names
are ignored.  A library may leave look-ups and class formats out, the limit for the list of
subscribed messages, which has no effect, and the repetition of a subscription that holds; it may
take its handshake in another order, and name another host.
"""
import re

from support import codec, messages
from support.fake_central import FakeCentral
from support.frame import BROADCAST, Frame, HANDLER_ONLY, INFORM, IS_REPLY, QUERY, REPLY
from support.peer import LOOK_UP

#: Requests that belong to the handshake or to the library's own caching.
UNCOMPARED = {LOOK_UP, "x_ipc_classInfoMsg", "x_ipc_waitMsg", "x_ipc_directMsgQuery",
              "x_ipc_getNamedFormMsg",
              *("V_get_" + variable for variable in messages.VARIABLES)}


def _plain(value):
    """A decoded value without the addresses in handler names."""
    if isinstance(value, tuple):
        return tuple(_plain(item) for item in value)
    if isinstance(value, str) and value.startswith("HND-"):
        return re.sub(r"\d{6,}$", "", value)
    return value


class RecordedCentral(FakeCentral):
    """A central whose ids and answers come from a capture."""

    def __init__(self, capture, tag):
        self.lines = capture.of(tag)
        self.recorded_names = {}
        self.recorded_answers = {}
        self.recorded_queries = {}
        self.sent_queries = {}
        self._recorded_handlers = {}
        self._subscribed = set()
        self.taken = set()
        self._read()
        super().__init__(first_id=100_000)
        for number, name in self.recorded_names.items():
            self.ids[name.lower()], self.names[number] = number, name
        self.look_up_id = self.ids[LOOK_UP.lower()]

    def _read(self):
        """Collects names, ids and the answers to requests."""
        asked = {}
        for line in self.lines:
            frame = line.frame
            if line.kind == "prelude":
                self.recorded_names[line.value] = LOOK_UP
            elif line.kind == "frame" and line.direction == ">" and frame.cls == QUERY \
                    and frame.dispatch == -1:
                name = self.recorded_names[abs(frame.intent)]
                asked[frame.reference] = (name, self._request_value(name, frame))
            elif line.kind == "frame" and frame.intent == IS_REPLY and frame.cls == 0:
                key = asked[frame.reference]
                self.recorded_answers.setdefault(key, []).append(frame.data)
                if key[0] == LOOK_UP:
                    found = codec.decode(messages.MESSAGE_INFO, frame.data, frame.order)
                    if found and found[0]:
                        self.recorded_names[abs(found[0])] = found[1]

    @staticmethod
    def _request_value(name, frame):
        message = messages.find(name)
        value = codec.decode(message.request, frame.data, frame.order) if message else None
        if name == LOOK_UP:
            return value[0].lower()
        return None if name == "x_ipc_newModuleConnectMsg" else value

    def react(self, connection, received):
        """Answers as recorded; what the original did not ask is answered as by any central."""
        value = received.value
        if received.name == LOOK_UP:
            value = value[0].lower()
        elif received.name == "x_ipc_newModuleConnectMsg":
            connection.module, connection.host, value = *received.value, None
        answers = self.recorded_answers.get((received.name, value))
        if answers and received.frame.cls == QUERY:
            connection.reply(received, answers.pop(0) if len(answers) > 1 else answers[0])
        else:
            super().react(connection, received)

    def message_info(self, name):
        """Names that the original looked up under another handler, or not at all, here."""
        info = super().message_info(name)
        return None if info and info[2] == HANDLER_ONLY else info

    # ------------------------------------------------------------- the replay

    def replay(self, connection):
        """Compares and sends, line by line; returns the number of frames that were compared."""
        for line in self.lines:
            if line.kind != "frame":
                continue
            if line.direction == ">":
                self._expect(connection, line.frame)
            elif line.frame.intent == IS_REPLY and line.frame.cls == REPLY:
                self._send_response(connection, line.frame)
            elif line.frame.intent not in (0, IS_REPLY):
                self._send_delivery(connection, line.frame)
        return len(self.taken)

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
        name = self.recorded_names[abs(frame.intent)]
        message = messages.find(name)
        if name in UNCOMPARED:
            return
        if message is None:
            received = self._take(
                connection, lambda r: r.name == name and r.frame.cls == frame.cls
                and r.frame.data == frame.data and r.frame.order == frame.order,
                f"{name} with {frame.data!r}")
            assert abs(received.frame.intent) == abs(frame.intent)
            self.sent_queries[frame.reference] = received
            return
        exact = codec.decode(message.request, frame.data, frame.order)
        value = _plain(exact)
        if name == "x_ipc_limitPendingMsg" and value[0] == messages.BROADCASTS:
            return
        if name == "x_ipc_newModuleConnectMsg":
            received = self._take(connection, lambda r: r.name == name, name)
            assert received.value[0] == value[0]
        elif name == "x_ipc_registerHandlerMsg":
            if exact[1:] in self._subscribed:
                return
            self._subscribed.add(exact[1:])
            received = self._take(
                connection, lambda r: r.name == name and _plain(r.value)[1:] == value[1:],
                f"subscription {value}")
            if value[0]:
                self._recorded_handlers[value[0]] = received.value[0]
        else:
            self._subscribed.discard(exact[1:] if isinstance(exact, tuple) else None)
            self._take(connection, lambda r: r.name == name and _plain(r.value) == value,
                       f"{name} {value}")

    def _expect_answer(self, connection, frame):
        """An acknowledgement or a response; dispatch ids are those of the recording."""
        received = self._take(
            connection, lambda r: r.frame.dispatch == frame.dispatch and r.frame.cls == frame.cls,
            f"class {frame.cls} for dispatch {frame.dispatch}").frame
        got = (received.intent, received.reference, received.class_data, received.data)
        assert got == (frame.intent, frame.reference, frame.class_data, frame.data)
        assert received.parent in (frame.parent, frame.dispatch)

    def _send_response(self, connection, frame):
        query = self.sent_queries[frame.reference]
        connection.send(Frame(
            REPLY, IS_REPLY, frame.data, frame.class_data, parent=frame.parent,
            dispatch=frame.dispatch, reference=query.frame.reference, order=frame.order,
            class_order=frame.class_order))

    def _send_delivery(self, connection, frame):
        assert frame.cls in (BROADCAST, QUERY, INFORM)
        connection.send(Frame(
            frame.cls, self._recorded_handlers[frame.intent], frame.data, frame.class_data,
            parent=frame.parent, dispatch=frame.dispatch, reference=frame.reference,
            order=frame.order, class_order=frame.class_order))
