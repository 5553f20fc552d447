"""Direct mode: what central does with -c, and what a library does that is told of it (requirements
38-42, section 7).

Central is played by hand for the library, and modules are played by hand for both.
"""
import os
import socket
import stat
import struct

import pytest

from support import codec, messages
from support.driver import messages_in, replies_in, texts_in
from support.fake_central import FakeCentral
from support.frame import BROADCAST, Cutter, Frame, IS_REPLY, QUERY, REPLY, class_name
from support.peer import Peer, expect_nothing, reply_number
from support.waiting import PATIENCE

OWN_HOST = socket.gethostname()
OTHER_HOST = "127.0.0.1"  # not the name of this host, so it is reached by TCP


# --------------------------------------------------------------------- central with -c


@pytest.fixture
def join_direct(stack, start_central):
    """Connects hand-made modules that announce a port to a central that was started with -c."""
    central = start_central("-c")

    def join(name, port, host="robot"):
        peer = stack.enter_context(Peer(central, name, host=host))
        peer.read_prelude()
        peer.introduce()
        assert peer.direct
        peer.notice("x_ipc_directResMsg", (port, name))
        peer.ready()
        return peer
    return join


def test_central_gives_negative_ids_to_the_messages_of_modules_only(join_direct):
    """Requirement 38: what library and central say to each other stays routed."""
    peer = join_direct("M", 8000)
    peer.define("Q")
    assert peer.look_up("Q").id < 0
    for name in ("x_ipc_directMsgQuery", "x_ipc_registerHandlerMsg", "x_ipc_connectNotify",
                 messages.WATCH_BROADCASTS):
        assert peer.look_up(name).id > 0, name


def test_central_tells_the_watchers_of_a_message_each_change_of_its_handlers(join_direct):
    """Requirement 38: whole lists, newest subscription first, with ports and hosts."""
    watcher, second, third = (join_direct("W", 8001), join_direct("S", 8002, "host2"),
                              join_direct("T", 8003, "host3"))
    watcher.define("M")
    assert watcher.request("x_ipc_directMsgQuery", "M") is None  # nobody; from now on it is kept
    watcher.subscribe("V_watch_M", 7, "V_watch_M")
    watcher.sync()

    def told(count):
        """The first list with so many handlers."""
        while (found := watcher.take(1)[0].value(messages.HANDLER_LIST))[0] != count:
            pass
        return found[1]

    second.subscribe("M", 5, "second's")
    assert told(1) == [(5, 0, 0, 8002, "host2", "S")]
    third.subscribe("M", 6, "third's")
    assert told(2) == [(6, 0, 0, 8003, "host3", "T"), (5, 0, 0, 8002, "host2", "S")]
    second.unsubscribe("M", "second's")
    assert told(1) == [(6, 0, 0, 8003, "host3", "T")]
    third.close()
    assert not told(0)


@pytest.mark.parametrize("sign", [1, -1], ids=["positive", "negative"])
def test_central_routes_publications_and_queries_by_ids_of_either_sign(sign, join_direct):
    """Requirement 41: what a module sends through central nevertheless."""
    sender, receiver = join_direct("S", 8001), join_direct("R", 8002)
    for name in ("M", "Q", "A"):
        receiver.define(name)
    receiver.subscribe("M", 5)
    receiver.subscribe("Q", 6)
    receiver.sync()
    for name in ("M", "Q"):
        sender.known[name] = sign * abs(sender.look_up(name).id)
    sender.publish_number("M", 11)
    assert receiver.take_numbers(1) == [11]
    reference = sender.query_number("Q", 21)
    delivery = receiver.next_delivery()
    receiver.respond_number(delivery, "A", 42)
    assert reply_number(sender.await_reply(reference)) == 42


@pytest.mark.new_central("it ends")
def test_central_takes_the_response_of_a_direct_module_to_a_query_that_had_to_wait(join_direct):
    """Requirement 41, section 7.4: intent -4, dispatch and reference both the dispatch id."""
    asker = join_direct("A", 8001)
    for name in ("Q", "R", "X"):
        asker.define(name)
    reference = asker.query_number("Q", 4)
    asker.sync()
    answerer = join_direct("S", 8002)
    answerer.subscribe("Q", 5)
    delivery = answerer.next_delivery()
    answerer.send(Frame(REPLY, IS_REPLY, codec.variable(struct.pack("<i", 8)), class_name("R"),
                        dispatch=delivery.dispatch, reference=delivery.dispatch))
    assert reply_number(asker.await_reply(reference)) == 8
    expect_nothing(answerer, asker)
    # The dispatch is finished: the next message is delivered.
    answerer.subscribe("X", 6)
    answerer.sync()
    asker.publish_number("X", 9)
    assert answerer.take_numbers(1) == [9]


# --------------------------------------------------------------------- the library


class Line:
    """A socket between two modules: frames from the first byte on, no acknowledgements."""

    def __init__(self, connected):
        self.socket = connected
        self.socket.settimeout(PATIENCE)
        self.cutter = Cutter()

    def send(self, frame):
        self.socket.sendall(frame.pack())

    def read(self):
        while (frame := self.cutter.next()) is None:
            data = self.socket.recv(1 << 16)
            assert data, "the module has closed the line"
            self.cutter.feed(data)
        return frame

    def close(self):
        """Closes it; the module must not have sent anything that was not read."""
        self.socket.setblocking(False)
        try:
            assert not self.socket.recv(1), "the module has sent more"
        except BlockingIOError:
            pass
        self.socket.close()


class Module:
    """A hand-made module that others can reach, by TCP or as modules on the same host do."""

    def __init__(self, host=OTHER_HOST):
        self.host = host
        self.listener = socket.socket()
        self.listener.bind(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.path = None
        if host == OWN_HOST:
            self.path = f"/tmp/x_ipc/{self.port}"
            os.makedirs(os.path.dirname(self.path), mode=0o777, exist_ok=True)
            if os.path.exists(self.path):
                os.unlink(self.path)  # left behind by somebody: the port is ours
            self.reserved, self.listener = self.listener, socket.socket(socket.AF_UNIX)
            self.listener.bind(self.path)
        self.listener.listen()
        self.listener.settimeout(PATIENCE)
        self.lines = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()
        for line in self.lines:
            line.socket.close()

    def stop(self):
        """Cannot be reached any more."""
        self.listener.close()
        if self.path and os.path.exists(self.path):
            os.unlink(self.path)

    def accept(self):
        self.lines.append(Line(self.listener.accept()[0]))
        return self.lines[-1]

    def entry(self, handler, name="OTHER"):
        """The module in central's list of handlers."""
        return (handler, 0, 0, self.port, self.host, name)


@pytest.fixture
def direct(stack):
    """A hand-made central in direct mode, where M, Q and A are defined."""
    central = stack.enter_context(FakeCentral(direct=True, broadcasts=["M", "Q"]))
    for name in ("M", "Q", "A"):
        central.define(name)
    return central


@pytest.fixture
def local(start_driver, direct):
    """The module under test, connected to it."""
    return start_driver().connect(direct.address)


@pytest.fixture
def handlers(direct):
    """Sets central's list of the handlers of every message."""
    def are(*entries):
        direct.answers["x_ipc_directMsgQuery"] = lambda *_: codec.encode(
            messages.HANDLER_LIST, (len(entries), list(entries)))
    are()
    return are


@pytest.fixture
def module(stack):
    """Starts hand-made modules."""
    return lambda *args: stack.enter_context(Module(*args))


def announced_port(direct):
    port, name = direct.connection().wait_for_message("x_ipc_directResMsg").value
    assert name.upper() == "DRIVER"
    return port


def line_to(port, stack, transport="unix"):
    """Opens a line to the module under test."""
    connected = socket.socket(socket.AF_UNIX if transport == "unix" else socket.AF_INET)
    stack.enter_context(connected)
    connected.connect(f"/tmp/x_ipc/{port}" if transport == "unix" else ("127.0.0.1", port))
    return Line(connected)


def number(value):
    return codec.variable(struct.pack("<i", value))


def test_a_library_announces_a_port_from_8000_up_before_it_is_ready(local, direct):
    """Requirement 39: its own name with it, and a Unix socket for its host."""
    port = announced_port(direct)
    assert 8000 <= port <= 9000
    assert stat.S_ISSOCK(os.stat(f"/tmp/x_ipc/{port}").st_mode)
    names = [received.name for received in direct.connection().messages()]
    assert names.index("x_ipc_directResMsg") < names.index("x_ipc_waitMsg")


@pytest.mark.parametrize("transport", ["tcp", "unix"])
def test_a_library_takes_publications_from_others_without_prelude_or_acknowledgement(
        transport, local, direct, stack):
    """Requirement 39: by TCP and by Unix socket."""
    local.must("subscribe", "M", 2)
    (handler,) = direct.connection().wait_subscribed("M")
    line = line_to(announced_port(direct), stack, transport)
    for value in (1, 2):
        line.send(Frame(BROADCAST, handler, number(value), reference=40 + value))
        assert messages_in(local.gather(1)) == [(2, "M", struct.pack("<i", value))]
    local.do("is_defined", "x")
    assert not direct.connection().acknowledgements()
    line.close()


def test_a_library_answers_a_direct_query_on_the_line_it_came_by(local, direct, stack):
    """Requirement 39, section 7.3: intent -4, the query's reference, the response's name."""
    local.must("subscribe", "Q", 0, "double", "A")
    (handler,) = direct.connection().wait_subscribed("Q")
    line = line_to(announced_port(direct), stack)
    line.send(Frame(QUERY, handler, number(21), reference=40))
    local.gather(1)
    frame = line.read()
    assert (frame.cls, frame.intent, frame.reference) == (REPLY, IS_REPLY, 40)
    assert frame.message_name() == "A"
    assert reply_number(frame) == 42
    local.do("is_defined", "x")
    assert not [r for r in direct.connection().messages() if r.frame.cls == REPLY]
    line.close()


@pytest.mark.parametrize("host", [OTHER_HOST, OWN_HOST], ids=["tcp", "unix"])
def test_a_library_publishes_to_the_handlers_of_the_list_oldest_first(host, local, direct, handlers,
                                                                     module):
    """Requirement 40: with the receivers' ids, over one line to each module."""
    other = module(host)
    handlers(other.entry(6), other.entry(5))
    local.must("publish_data", "M", "int", 11)
    local.must("publish_data", "M", "int", 12)
    line = other.accept()
    frames = [line.read() for _ in range(4)]
    assert [frame.intent for frame in frames] == [5, 6, 5, 6]
    for frame, value in zip(frames, (11, 11, 12, 12)):
        assert (frame.cls, frame.dispatch, frame.class_data) == (BROADCAST, -1, b"")
        assert frame.data == number(value)
    local.do("is_defined", "x")
    assert not direct.connection().messages("M")
    line.close()


def test_a_library_sends_through_central_while_nobody_is_in_the_list(local, direct, handlers,
                                                                    module):
    """Requirement 40: with the negative id; and directly as soon as central tells of somebody."""
    local.must("publish_data", "M", "int", 11)
    frame = direct.connection().wait_for_message("M").frame
    assert (frame.cls, frame.intent, frame.data) == (BROADCAST, -direct.id_of("M"), number(11))
    other = module()
    direct.connection().deliver("V_watch_M", data=codec.encode(
        messages.HANDLER_LIST, (1, [other.entry(5)])))
    local.do("listen", 100)
    local.must("publish_data", "M", "int", 12)
    frame = other.accept().read()
    assert (frame.intent, frame.data) == (5, number(12))


def test_a_library_asks_directly_and_takes_the_reply_from_the_same_line(local, handlers, module):
    """Requirement 40."""
    other = module()
    handlers(other.entry(5))
    local.start("query_data", "Q", "A", PATIENCE * 1000, "int", 21)
    line = other.accept()
    frame = line.read()
    assert (frame.cls, frame.intent, frame.data) == (QUERY, 5, number(21))
    assert frame.dispatch == -1 and not frame.class_data
    line.send(Frame(REPLY, IS_REPLY, number(42), class_name("A"), dispatch=frame.reference,
                    reference=frame.reference))
    assert local.finish().reply == "42"


@pytest.mark.new_library("it asks all, and keeps the second reply for ever")
def test_a_library_asks_the_oldest_handler_only(local, handlers, module):
    """Requirement 40, section 7.3."""
    older, newer = module(), module()
    handlers(newer.entry(6, "NEWER"), older.entry(5, "OLDER"))
    local.must("notify_data", "Q", "tag", "int", 21)
    line = older.accept()
    frame = line.read()
    line.send(Frame(REPLY, IS_REPLY, number(42), class_name("A"), dispatch=frame.reference,
                    reference=frame.reference))
    assert replies_in(local.gather(1)) == [("tag", "A", "42")]
    newer.listener.setblocking(False)
    try:
        newer.accept().close()
    except BlockingIOError:
        pass  # not even a line


@pytest.mark.new_library("it exits")
@pytest.mark.parametrize("kind", ["dead", "portless", "unknown host"])
def test_a_library_skips_modules_that_it_cannot_reach(kind, local, handlers, module):
    """Requirement 42: the others in the list get the message."""
    other, lost = module(), module()
    lost.stop()
    entry = {"dead": lost.entry(6), "portless": (6, 0, 0, -1, OTHER_HOST, "LOST"),
             "unknown host": (6, 0, 0, 8000, "host.invalid", "LOST")}[kind]
    handlers(entry, other.entry(5))
    local.must("publish_data", "M", "int", 11)
    frame = other.accept().read()
    assert (frame.intent, frame.data) == (5, number(11))
    assert local.do("is_connected").result == "1"


@pytest.mark.new_library("it exits")
def test_a_library_goes_on_when_nobody_in_the_list_can_be_reached(local, direct, handlers, module):
    """Requirement 42: also when a later list tells of somebody."""
    handlers((6, 0, 0, -1, OTHER_HOST, "LOST"))
    local.must("publish_data", "M", "int", 11)
    assert local.do("is_connected").result == "1"
    other = module()
    direct.connection().deliver("V_watch_M", data=codec.encode(
        messages.HANDLER_LIST, (1, [other.entry(5)])))
    local.do("listen", 100)
    local.must("publish_data", "M", "int", 12)
    assert other.accept().read().data == number(12)


def test_a_library_outlives_the_end_of_a_subscriber_between_two_publications(local, handlers,
                                                                            module):
    """Requirement 42, section 7.5: it goes on with the next handler."""
    gone, other = module(), module()
    handlers(other.entry(6, "OTHER"), gone.entry(5, "GONE"))
    local.must("publish_data", "M", "int", 1)
    line, first = other.accept(), gone.accept()
    assert line.read().data == first.read().data == number(1)
    gone.stop()
    first.close()
    # It may learn of it by the first write or by a later one.
    for value in (2, 3, 4):
        local.must("publish_data", "M", "int", value)
        assert line.read().data == number(value)
    assert local.do("is_connected").result == "1"


def test_the_end_of_a_line_is_no_end_for_the_module_that_was_reached_by_it(local, direct, stack):
    """Section 7.5: the next line is as good."""
    local.must("subscribe", "M", 2)
    (handler,) = direct.connection().wait_subscribed("M")
    port = announced_port(direct)
    for value in (1, 2):
        line = line_to(port, stack)
        line.send(Frame(BROADCAST, handler, number(value), reference=value))
        assert texts_in(local.gather(1))
        line.close()
        local.do("listen", 50)
    assert local.do("is_connected").result == "1"
