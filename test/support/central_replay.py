"""Plays the modules of a capture against a central and compares what that central sends.

Every frame that a module sent is sent again, in the recorded order over all connections, after
everything that had reached its connection before has arrived.  Between frames on different
connections the central is given the time to handle the first one, so that the recorded order is
also the order in which it acts.

Message ids and dispatch ids are mapped; the rest has to agree.  What a central may do differently:

* write in another byte order than the recorded one,
* announce another minor version,
* put the message name into the class data of deliveries for longer than the original does,
* send fewer updates of the list of subscribed messages (the last one has to be right) and any
  pointer in the variables with log options.
"""
import itertools
import socket

from support import codec, messages
from support.frame import (BROADCAST, Frame, INFORM, IS_REPLY, QUERY, REPLY)
from support.peer import LOOK_UP, Peer
from support.waiting import Deadline, wait_until

SYNC_REFERENCES = 1 << 20


class Module:
    """The real connection that stands for one of a capture."""

    def __init__(self, recorded, central, piece):
        self.recorded = recorded
        self.peer = Peer(central, recorded.module, unix=recorded.transport == "unix", piece=piece)
        self.names = {}
        self.requests = {}
        self.watch_handler = None
        self.replies = {}
        self.deliveries = []
        self.broadcasts = None
        self.recorded_broadcasts = None
        self.withdrawn = set()
        self.unsettled = False
        self.leaving = False

    def take_in(self, frame):
        """Sorts an arrived frame; updates of the list of subscribed messages are acknowledged."""
        if frame.intent == IS_REPLY:
            assert frame.reference not in self.replies, f"second reply to {frame.reference}"
            self.replies[frame.reference] = frame
        elif frame.intent == self.watch_handler:
            value = codec.decode(messages.NAME_LIST, frame.data, frame.order)
            self.broadcasts = set(messages.names_of(value))
            self.peer.send(Frame(12, parent=frame.reference, dispatch=frame.reference))
        else:
            self.deliveries.append(frame)

    def await_recorded_broadcasts(self):
        """Takes in frames until the list is the recorded one.  The central may have sent none between
        that and what this module has withdrawn since."""
        if self.recorded_broadcasts is not None:
            self.pump(lambda: (self.broadcasts is not None and self.broadcasts | self.withdrawn
                               == self.recorded_broadcasts | self.withdrawn),
                      f"the list {self.recorded_broadcasts}, has {self.broadcasts}")

    def pump(self, condition, what):
        """Takes in frames until condition() gives something."""
        deadline = Deadline()
        while not (found := condition()):
            try:
                self.take_in(self.peer.read_frame(deadline.left()))
            except AssertionError as error:
                raise AssertionError(f"{self.recorded.module} lacks {what}: {error}") from None
        return found


class Replay:
    """One run of a capture against centrals; ports of the capture map to centrals."""

    def __init__(self, capture, centrals, piece=None):
        self.capture, self.piece = capture, piece
        self.centrals = dict(zip(sorted({c.port for c in capture.connections.values()
                                         if not c.direct}), centrals, strict=True))
        self.modules = {}
        self.ids = {port: {} for port in self.centrals}
        self.dispatches = {port: {-1: -1} for port in self.centrals}
        self.observers = {}
        self.sync_references = itertools.count(SYNC_REFERENCES)
        self.compared = 0

    # ------------------------------------------------------------------ order

    def run(self):
        """Replays the whole capture; returns the number of frames of central that were compared."""
        try:
            for port, central in self.centrals.items():
                self.observers[port] = Peer(central, "observer").connect()
            self._replay()
        finally:
            for peer in (*self.observers.values(), *(m.peer for m in self.modules.values())):
                peer.close()
        return self.compared

    def _replay(self):
        last = {line.tag: number for number, line in enumerate(self.capture.lines)}
        for number, line in enumerate(self.capture.lines):
            recorded = self.capture.connections[line.tag]
            if recorded.direct:
                continue
            if line.kind == "connect":
                self._settle_others(None, recorded.port)
                self.modules[line.tag] = Module(recorded, self.centrals[recorded.port], self.piece)
                continue
            module = self.modules[line.tag]
            if line.kind == "prelude":
                self._take_prelude(module, line.value)
            elif line.kind == "shutdown":
                self._leave(module)
            elif line.kind == "frame" and line.direction == ">":
                self._send(module, line.frame)
            elif line.kind == "frame":
                self._compare(module, line.frame)
            if number == last[line.tag] and line.kind != "close":
                self._leave(module)

    def _settle_others(self, module, port):
        """Waits until central has handled what the other modules have sent."""
        for other in self.modules.values():
            if other is module or other.recorded.port != port or not other.unsettled:
                continue
            other.unsettled = False
            if other.leaving:
                self._wait_gone(other)
                continue
            reference = next(self.sync_references)
            data = codec.encode("{string, string}", ("x_ipc_waitMsg", None))
            other.peer.send(Frame(QUERY, other.peer.look_up_id, data, reference=reference))
            other.pump(lambda r=reference, o=other: o.replies.pop(r, None), "the reply to a sync")

    def _wait_gone(self, module):
        observer = self.observers[module.recorded.port]
        wait_until(lambda: observer.request("x_ipc_moduleConnectedQ", module.recorded.module) == 0,
                   f"central has seen {module.recorded.module} leave")

    def _leave(self, module):
        """The end of a connection, with a last look at what has arrived on it."""
        if module.leaving is None:
            return
        # After its close notice a module gets nothing any more.
        if not module.leaving:
            module.await_recorded_broadcasts()
        assert not module.deliveries, f"{module.recorded.module} got more: {module.deliveries}"
        assert not module.replies, f"{module.recorded.module} got more: {module.replies}"
        try:
            module.peer.socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        module.peer.close()
        module.leaving, module.unsettled = None, False
        self._wait_gone(module)

    # ---------------------------------------------------------------- sending

    def _send(self, module, frame):
        port = module.recorded.port
        self._settle_others(module, port)
        known = self.dispatches[port]
        intent, name = frame.intent, None
        if frame.dispatch == -1 and frame.cls in (QUERY, INFORM, BROADCAST):
            name = module.names[abs(frame.intent)]
            real = abs(self.ids[port][name.lower()])
            intent = real if frame.intent > 0 else -real
            module.requests[frame.reference] = name
            self._note_subscription(module, name, frame)
        elif known.get(frame.dispatch, -1) is None:
            return  # the acknowledgement of an update that has been acknowledged already
        if name == "x_ipc_CloseMsg":
            module.await_recorded_broadcasts()
        reference = frame.reference if frame.dispatch == -1 else known.get(frame.reference, -1)
        module.peer.send(Frame(
            frame.cls, intent, frame.data, frame.class_data,
            parent=known.get(frame.parent) or -1, dispatch=known[frame.dispatch],
            reference=reference, order=frame.order, class_order=frame.class_order))
        module.unsettled = True
        module.leaving = module.leaving or name == "x_ipc_CloseMsg"

    @staticmethod
    def _note_subscription(module, name, frame):
        if name == "x_ipc_registerHandlerMsg":
            number, message, _ = codec.decode("{int, string, string}", frame.data, frame.order)
            if message == messages.WATCH_BROADCASTS and number:
                module.watch_handler = number
        elif name == "x_ipc_deregisterHandlerMsg":
            module.withdrawn.add(codec.decode("{int, string, string}", frame.data, frame.order)[1])

    # -------------------------------------------------------------- comparing

    def _take_prelude(self, module, recorded_id):
        formats = module.peer.read_prelude()
        assert formats == [codec.parse("{string, string}"), codec.parse(messages.MESSAGE_INFO)]
        module.names[recorded_id] = LOOK_UP
        self._learn(module.recorded.port, LOOK_UP, module.peer.look_up_id)

    def _learn(self, port, name, number):
        known = self.ids[port].setdefault(name.lower(), number)
        assert known == number, f"{name} has had the id {known}, now it has {number}"

    def _compare(self, module, expected):
        if expected.intent == 0 and expected.cls == 0 and expected.reference == 0:
            return  # the formats of the prelude
        self.compared += 1
        if expected.intent == IS_REPLY:
            name = module.requests[expected.reference]
            actual = module.pump(lambda: module.replies.pop(expected.reference, None),
                                 f"the reply to {name}")
            if expected.cls == REPLY:
                self._compare_response(module, name, expected, actual)
            else:
                self._compare_reply(module, name, expected, actual)
        elif expected.intent == module.watch_handler:
            value = codec.decode(messages.NAME_LIST, expected.data, expected.order)
            module.recorded_broadcasts = set(messages.names_of(value))
            self.dispatches[module.recorded.port][expected.reference] = None
        else:
            module.pump(lambda: module.deliveries, f"a delivery for handler {expected.intent}")
            self._compare_delivery(module, expected, module.deliveries.pop(0))

    def _compare_reply(self, module, name, expected, actual):
        header = (actual.cls, actual.parent, actual.dispatch, actual.alignment, actual.class_data)
        assert header == (0, 0, 0, 0, b""), f"header of the reply to {name}"
        fmt = messages.find(name).reply
        if not expected.data:
            assert not actual.data, f"reply to {name}"
            return
        wanted = codec.decode(fmt, expected.data, expected.order)
        got = codec.decode(fmt, actual.data, actual.order)
        if name == LOOK_UP and wanted:
            assert got, f"look-up of {wanted[1]}"
            module.names[abs(wanted[0])] = wanted[1]
            if wanted[0]:
                self._learn(module.recorded.port, wanted[1], got[0])
            assert (got[0] > 0) - (got[0] < 0) == (wanted[0] > 0) - (wanted[0] < 0), \
                f"sign of the id of {wanted[1]}"
            wanted, got = wanted[1:], got[1:]
            assert len(actual.data) == len(expected.data), f"length of the look-up of {wanted[0]}"
        elif name == "x_ipc_newModuleConnectMsg":
            wanted, got = (wanted[0][0], wanted[1]), (got[0][0], got[1])
        elif name.startswith("V_get_CENTRAL"):
            wanted, got = wanted[1:], got[1:]
        elif name == "V_get_" + messages.BROADCASTS:
            wanted, got = (set(messages.names_of(value)) for value in (wanted, got))
        assert got == wanted, f"{module.recorded.module}: reply to {name}"

    def _compare_response(self, module, name, expected, actual):
        known = self.dispatches[module.recorded.port]
        got = (actual.cls, actual.class_data, actual.data, actual.order, actual.class_order,
               actual.parent, actual.dispatch)
        wanted = (REPLY, expected.class_data, expected.data, expected.order, expected.class_order,
                  known.get(expected.parent, -1), known.get(expected.dispatch, actual.dispatch))
        assert got == wanted, f"{module.recorded.module}: response to {name}"

    @staticmethod
    def _content(notice, frame):
        """What central says itself, as a value, since it writes in its own byte order; what modules
        have sent, as bytes."""
        return (codec.decode(notice.request, frame.data, frame.order) if notice
                else (frame.data, frame.order))

    def _compare_delivery(self, module, expected, actual):
        known = self.dispatches[module.recorded.port]
        assert actual.intent == expected.intent, "handler id of a delivery"
        known[expected.reference] = actual.reference
        notice = messages.find(actual.message_name() or "")
        got = (actual.cls, self._content(notice, actual), actual.dispatch, actual.parent)
        wanted = (expected.cls, self._content(notice, expected), -1,
                  known.get(expected.parent, -1))
        assert got == wanted, f"{module.recorded.module}: delivery for handler {expected.intent}"
        assert actual.reference >= 0
        if expected.class_data:
            assert actual.message_name() == expected.message_name()
