"""Central's side of the end of connections, and its notices (requirements 43, 45-47)."""
import pytest

from support import codec, messages
from support.frame import Frame, REPLY, SUCCESS, class_name
from support.peer import Peer, expect_nothing
from support.waiting import wait_until

WAYS_TO_LEAVE = {
    "close notice": lambda peer: peer.say_goodbye(),
    "end of file": lambda peer: peer.close(),
    "reset": lambda peer: peer.reset(),
}


@pytest.fixture(params=WAYS_TO_LEAVE, ids=lambda name: name)
def leave(request):
    """Ends a module's connection in one of the ways there are."""
    return WAYS_TO_LEAVE[request.param]


def gone(observer, name):
    """Waits until central knows no module of that name."""
    wait_until(lambda: observer.request("x_ipc_moduleConnectedQ", name) == 0, f"{name} is gone")


def broadcasts(peer):
    return messages.names_of(peer.request("V_get_" + messages.BROADCASTS))


# ------------------------------------------------------------------- disconnection


def test_subscriptions_end_with_their_connection(leave, join):
    """Requirement 43: handlers are removed, messages without handlers leave the list."""
    leaver, stayer, sender = join("L"), join("S"), join("P")
    for name in ("A", "B"):
        sender.define(name)
    leaver.subscribe("A", 1)
    leaver.subscribe("B", 2)
    stayer.subscribe("B", 3)
    leaver.sync()
    stayer.sync()
    assert set(broadcasts(sender)) == {"A", "B"}
    leave(leaver)
    gone(sender, "L")
    assert broadcasts(sender) == ["B"]
    sender.publish_number("A", 1)
    sender.publish_number("B", 2)
    assert stayer.take_numbers(1) == [2]


def test_what_a_module_leaves_unfinished_is_forgotten(leave, join):
    """Requirement 43: unfinished and pending dispatches are dropped, others go on."""
    leaver, stayer, sender = join("L"), join("S"), join("P")
    sender.define("M")
    for peer in (leaver, stayer):
        peer.subscribe("M", 5)
        peer.sync()
    for number in range(10):
        sender.publish_number("M", number)
    sender.sync()
    assert leaver.next_delivery().number == 0
    leave(leaver)
    gone(sender, "L")
    assert stayer.take_numbers(10) == list(range(10))
    back = join("L")
    back.subscribe("M", 5)
    back.sync()
    sender.publish_number("M", 99)
    assert back.take_numbers(1) == [99]
    assert stayer.take_numbers(1) == [99]
    expect_nothing(back, sender)


def test_the_disconnect_notice_comes_last(leave, join):
    """Requirements 43, 46: handler lists, then the list of broadcasts, then the notice."""
    leaver, watcher = join("L"), join("W")
    watcher.define("M")
    watcher.set_capacity(100)
    watcher.notice("x_ipc_notifyHandlerChange", "M")
    watcher.subscribe("V_watch_M", 1, "V_watch_M")
    watcher.subscribe(messages.WATCH_BROADCASTS, 2, messages.WATCH_BROADCASTS)
    watcher.subscribe("x_ipc_disconnectNotify", 3, "x_ipc_disconnectNotify")
    watcher.sync()
    leaver.subscribe("M", 7)
    leaver.sync()
    gone_before = [delivery.handler for delivery in _until(watcher, lambda d: d.handler == 2
                   and "M" in messages.names_of(d.value(messages.NAME_LIST)))]
    assert 3 not in gone_before
    leave(leaver)
    order = _until(watcher, lambda d: d.handler == 3)
    handlers = [delivery.handler for delivery in order]
    assert 1 in handlers and 2 in handlers
    assert handlers.index(1) < handlers.index(2) < handlers.index(3)
    assert order[-1].value("string") == "L"
    last_list = [d for d in order if d.handler == 2][-1]
    assert "M" not in messages.names_of(last_list.value(messages.NAME_LIST))
    assert [d for d in order if d.handler == 1][-1].value(messages.HANDLER_LIST) == (0, [])
    expect_nothing(watcher)


def _until(peer, last):
    """Deliveries up to the one for which last() is true, all acknowledged."""
    taken = []
    while not taken or not last(taken[-1]):
        taken.append(peer.next_delivery())
        peer.acknowledge(taken[-1])
    return taken


def test_central_closes_its_side_after_a_close_notice(join):
    """Section 9.1."""
    peer = join("M")
    peer.say_goodbye()
    assert peer.is_closed()


@pytest.mark.new_central("it closes the newest of the name")
@pytest.mark.parametrize("ending", [0, 1])
def test_only_the_connection_concerned_is_closed_when_names_are_equal(ending, leave, join):
    """Requirement 43: two modules of one name, end one; names are labels."""
    twins, sender = [join("TWIN"), join("TWIN")], join("P")
    sender.define("M")
    for peer in twins:
        peer.subscribe("M", 5)
        peer.sync()
    sender.publish_number("M", 1)
    sender.publish_number("M", 2)
    sender.sync()
    leaver, stayer = twins[ending], twins[1 - ending]
    first = stayer.next_delivery()
    leave(leaver)
    wait_until(lambda: len(sender.request("x_ipc_directMsgQuery", "M")[1]) == 1, "one handler")
    assert sender.request("x_ipc_moduleConnectedQ", "TWIN") == 1
    stayer.acknowledge(first)
    assert stayer.take_numbers(1) == [2]


@pytest.mark.new_central("modules of one name share capacity")
def test_modules_of_one_name_have_a_capacity_each(join):
    """Section 5.5: one resource per connection."""
    twins, sender = [join("TWIN"), join("TWIN")], join("P")
    sender.define("M")
    for peer in twins:
        peer.subscribe("M", 5)
        peer.sync()
    sender.publish_number("M", 1)
    for peer in twins:
        assert peer.next_delivery().number == 1


@pytest.mark.new_central("it crashes on names over 99 bytes")
@pytest.mark.parametrize("length", [99, 100, 300, 1000])
def test_a_module_with_a_long_name_may_leave(length, leave, join):
    """Section 9.1, defects."""
    observer = join("O")
    peer = join("n" * length)
    leave(peer)
    gone(observer, "n" * length)


@pytest.mark.new_central("it crashes")
def test_late_and_double_acknowledgements_do_no_harm(join):
    """Requirement 45: acknowledge twice, and something that never was."""
    receiver, sender = join("R"), join("P")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.sync()
    for number in range(3):
        sender.publish_number("M", number)
    sender.sync()
    first = receiver.next_delivery()
    for _ in range(3):
        receiver.acknowledge(first)
    second = receiver.next_delivery()
    expect_nothing(receiver, sender)
    for dispatch in (7, 1000, 0x7fffffff):
        receiver.send(Frame(SUCCESS, parent=dispatch, dispatch=dispatch))
        receiver.send(Frame(REPLY, dispatch=dispatch, class_data=class_name("M"),
                            data=codec.variable(b"1234")))
    expect_nothing(receiver, sender)
    receiver.acknowledge(second)
    assert receiver.take_numbers(1) == [2]


# ------------------------------------------------------------------------- notices


def test_watchers_are_told_who_connects_and_who_leaves(leave, join):
    """Requirement 46: the first notice comes at the introduction."""
    watcher = join("W")
    watcher.subscribe("x_ipc_connectNotify", 1, "x_ipc_connectNotify")
    watcher.subscribe("x_ipc_disconnectNotify", 2, "x_ipc_disconnectNotify")
    watcher.sync()
    other = join("Other")
    notice = watcher.take(1)[0]
    assert (notice.handler, notice.value("string")) == (1, "Other")
    assert notice.frame.cls == 15
    leave(other)
    notice = watcher.take(1)[0]
    assert (notice.handler, notice.value("string")) == (2, "Other")
    expect_nothing(watcher)


def test_the_connect_notice_is_sent_before_the_introduction_is_answered(stack, central, join):
    """Requirement 46."""
    watcher = join("W")
    watcher.subscribe("x_ipc_connectNotify", 1, "x_ipc_connectNotify")
    watcher.sync()
    other = stack.enter_context(Peer(central, "Other"))
    other.read_prelude()
    expect_nothing(watcher, other)
    other.introduce()
    watcher.sync()
    assert [d.value("string") for d in watcher.deliveries] == ["Other"]


@pytest.mark.new_central("it announces **NEWMOD**")
def test_a_connection_without_introduction_is_nobody(stack, central, join):
    """Section 4.5: no notice for connections that were never introduced."""
    watcher = join("W")
    watcher.subscribe("x_ipc_connectNotify", 1, "x_ipc_connectNotify")
    watcher.subscribe("x_ipc_disconnectNotify", 2, "x_ipc_disconnectNotify")
    watcher.sync()
    for _ in range(3):
        peer = stack.enter_context(Peer(central, "nobody"))
        peer.read_prelude()
        peer.close()
    other = join("Other")
    other.sync()
    assert watcher.take(1)[0].value("string") == "Other"
    expect_nothing(watcher, other)


@pytest.mark.new_central("it renames the module and announces it again")
def test_a_second_introduction_is_refused(join):
    """Section 4.5."""
    watcher, other = join("W"), join("Other")
    watcher.subscribe("x_ipc_connectNotify", 1, "x_ipc_connectNotify")
    watcher.sync()
    other.name = "Another"
    other.start_request("x_ipc_newModuleConnectMsg", (other.name, other.host))
    watcher.sync()
    assert not watcher.deliveries
    assert watcher.request("x_ipc_moduleConnectedQ", "Another") == 0


def test_the_handlers_of_a_message_are_listed_newest_first(join):
    """Requirement 47, section 4.4."""
    first, second = join("A", host="alpha"), join("B", host="beta")
    first.define("M")
    assert first.request("x_ipc_directMsgQuery", "M") is None
    first.subscribe("M", 11)
    first.sync()
    second.subscribe("M", 22)
    second.sync()
    assert first.request("x_ipc_directMsgQuery", "m") == (
        2, [(22, 0, 0, -1, "beta", "B"), (11, 0, 0, -1, "alpha", "A")])
    assert first.request("x_ipc_directMsgQuery", "unheard of") is None


@pytest.mark.new_central("it lists none when there are more than 100")
def test_more_than_100_handlers_are_listed_too(join):
    """Central 4.11."""
    peer = join("A")
    peer.define("M")
    for number in range(150):
        peer.subscribe("M", number + 1)
    count, handlers = peer.request("x_ipc_directMsgQuery", "M")
    assert (count, len(handlers)) == (150, 150)
    assert [handler[0] for handler in handlers] == list(range(150, 0, -1))


def test_changes_of_handlers_are_told(leave, join):
    """Requirement 47: registration, deregistration, end of a module."""
    watcher, other, third = join("W"), join("O"), join("T")
    watcher.define("M")
    watcher.notice("x_ipc_notifyHandlerChange", "M")
    watcher.subscribe("V_watch_M", 1, "V_watch_M")
    watcher.sync()

    def told():
        delivery = watcher.take(1)[0]
        assert delivery.handler == 1
        count, handlers = delivery.value(messages.HANDLER_LIST)
        assert count == len(handlers)
        return [(handler[0], handler[5]) for handler in handlers]

    other.subscribe("M", 11, "a")
    assert told() == [(11, "O")]
    third.subscribe("M", 22, "b")
    assert told() == [(22, "T"), (11, "O")]
    other.unsubscribe("M", "a")
    assert told() == [(22, "T")]
    leave(third)
    assert told() == []


@pytest.mark.new_central("it exits")
def test_changes_may_be_asked_for_before_the_message_is_defined(join):
    """Section 4.4: works after definition."""
    watcher, other = join("W"), join("O")
    watcher.notice("x_ipc_notifyHandlerChange", "Later")
    watcher.subscribe("V_watch_Later", 1, "V_watch_Later")
    watcher.sync()
    other.define("Later")
    other.subscribe("Later", 5)
    lists = _until(watcher, lambda d: d.value(messages.HANDLER_LIST)[0] == 1)
    assert lists[-1].value(messages.HANDLER_LIST)[1][0][5] == "O"


def test_the_announced_port_is_in_the_list_of_handlers(stack, start_central):
    """Section 4.4, direct mode."""
    central = start_central("-c")
    peer = stack.enter_context(Peer(central, "M"))
    peer.read_prelude()
    peer.introduce()
    peer.notice("x_ipc_directResMsg", (8123, "m"))
    peer.ready()
    peer.define("Q")
    peer.subscribe("Q", 5)
    assert peer.request("x_ipc_directMsgQuery", "Q") == (1, [(5, 0, 0, 8123, "robot", "M")])


# ------------------------------------------------------------------ log lines


def test_the_log_tells_who_comes_and_who_goes(central, join):
    """Sections 3.4, 9.1: the lines on the terminal, exact."""
    peer = join("Robot1", host="somewhere")
    peer.close()
    central.wait_for_line(r"^ Received a new connection: \d+$")
    central.wait_for_line(r"^   modName : Robot1$")
    central.wait_for_line(r"^   hostName: somewhere$")
    central.wait_for_line(r"^Closed Connection Detected from: sd: \d+: ?$")
    central.wait_for_line(r"^ Closing Robot1 on somewhere$")
    central.wait_for_line(r"^close Module: Closing Robot1$")


def test_the_log_tells_a_close_notice_from_an_end_of_file(central, join):
    """Section 9.1."""
    join("Robot2", host="somewhere").say_goodbye()
    central.wait_for_line(r"^x_ipcClose: Closed Connection Detected from: sd: \d+: ?$")
    central.wait_for_line(r"^x_ipcClose: Closing Robot2 on somewhere$")
