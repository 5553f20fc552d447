"""Who gets which message when: the plan of checks, numbers 63 to 90, with modules of either byte
order.

Modules linked with the original library do the same in test/interop; check 80 is about resending.
"""
import itertools
import re

import pytest

from support import messages
from support.peer import Peer, expect_nothing, reply_number
from support.processes import Process
from support.waiting import wait_until


@pytest.fixture(params=["<", ">", "<>"], ids=["little", "big", "mixed"])
def orders(request):
    """The byte orders in which modules write, one after the other."""
    return itertools.cycle(request.param)


@pytest.fixture
def join(stack, central, orders):
    """Connects hand-made modules."""
    return lambda name, **options: stack.enter_context(
        Peer(central, name, order=next(orders), **options)).connect()


@pytest.fixture
def trio(join):
    """A publisher of M, and two modules that know it."""
    publisher, first, second = join("A"), join("B"), join("D")
    publisher.define("M")
    publisher.sync()
    return publisher, first, second


def subscribe(peer, *names):
    """Subscribes to each under its own handler number, and returns when that is done."""
    for number, name in enumerate(names, 1):
        peer.subscribe(name, number)
    peer.sync()


def publish(peer, texts):
    """Publishes "M1 N2": message and number."""
    for text in texts.split():
        peer.publish_number(text[0], int(text[1:]))
    peer.sync()


def take(peer, count, *, acknowledge=True):
    """The next deliveries as such texts."""
    return " ".join(f"{delivery.name}{delivery.number}"
                    for delivery in peer.take(count, acknowledge=acknowledge))


# --------------------------------------------------------------------- publications


def test_two_subscribers_get_a_thousand_messages_in_order(trio):
    """Check 63."""
    publisher, *subscribers = trio
    for peer in subscribers:
        subscribe(peer, "M")
    for number in range(1000):
        publisher.publish_number("M", number)
    for peer in subscribers:
        assert peer.take_numbers(1000) == list(range(1000))


def test_a_module_gets_a_message_once_for_each_of_its_handlers(trio):
    """Check 64."""
    publisher, subscriber, _ = trio
    subscriber.set_capacity(2)
    subscriber.subscribe("M", 1)
    subscriber.subscribe("M", 2)
    subscriber.sync()
    publisher.publish_number("M", 5)
    assert [(d.handler, d.number) for d in subscriber.take(2)] == [(1, 5), (2, 5)]


def test_a_message_without_subscribers_vanishes(trio):
    """Check 65."""
    publisher, late, _ = trio
    publish(publisher, "M1")
    subscribe(late, "M")
    expect_nothing(late, publisher)


@pytest.mark.parametrize("capacity", [1, 3])
def test_as_many_as_the_capacity_are_active_and_the_others_wait(capacity, trio):
    """Checks 66 and 67."""
    publisher, subscriber, _ = trio
    subscriber.set_capacity(capacity)
    subscribe(subscriber, "M")
    publish(publisher, "M0 M1 M2 M3 M4")
    active = subscriber.take(capacity, acknowledge=False)
    expect_nothing(subscriber, publisher)
    for delivery in active:
        subscriber.acknowledge(delivery)
    assert [d.number for d in active] + subscriber.take_numbers(5 - capacity) == [0, 1, 2, 3, 4]


@pytest.mark.new_central("the queue moves on with the next acknowledgement only")
def test_a_raised_capacity_is_filled_at_once_and_in_order(trio):
    """Check 68."""
    publisher, subscriber, _ = trio
    subscribe(subscriber, "M")
    publish(publisher, "M0 M1 M2 M3 M4 M5")
    subscriber.set_capacity(3)
    assert take(subscriber, 3, acknowledge=False) == "M0 M1 M2"
    expect_nothing(subscriber, publisher)


def test_what_waits_leaves_by_priority(trio):
    """Check 69."""
    publisher, subscriber, _ = trio
    for name in "LNH":
        publisher.define(name)
    subscriber.set_priority("H", 10)
    publisher.set_priority("N", 5)
    publisher.sync()
    subscribe(subscriber, *"LNH")
    publish(publisher, "L0 L1 N2 H3 L4 N5 H6")
    assert take(subscriber, 7) == "L0 H3 H6 N2 N5 L1 L4"


def test_a_limited_message_loses_its_oldest_and_keeps_its_turns(trio, central):
    """Checks 70 and 71: the other subscribers get everything."""
    publisher, limited, other = trio
    publisher.define("L")
    limited.set_limit("L", 2)
    for peer in (limited, other):
        subscribe(peer, "L", "M")
    publish(publisher, "M0 L1 M2 L3 M4 L5 L6 M7")
    assert take(limited, 6) == "M0 L5 M2 L6 M4 M7"
    assert take(other, 8) == "M0 L1 M2 L3 M4 L5 L6 M7"
    central.wait_for_line("PENDING LIMIT: Deleted message L")


# -------------------------------------------------------------------------- queries


@pytest.fixture
def asker(join):
    peer = join("ASKER")
    peer.define("Q")
    peer.define("R")
    peer.sync()
    return peer


def test_a_query_is_answered(asker, join):
    """Check 72."""
    server = join("SERVER")
    subscribe(server, "Q")
    reference = asker.query_number("Q", 21)
    server.respond_number(server.next_delivery(), "R", 42)
    assert reply_number(asker.await_reply(reference)) == 42


@pytest.mark.new_central("it ends")
def test_of_several_handlers_exactly_one_gets_a_query(asker, join):
    """Check 73: the first one that is free."""
    first, second = join("FIRST"), join("SECOND")
    first.subscribe("Q", 1)
    first.sync()
    second.subscribe("Q", 2)
    second.sync()
    references = [asker.query_number("Q", number) for number in range(4)]
    asker.sync()
    deliveries = [(peer, peer.next_delivery()) for peer in (first, second)]
    assert [delivery.number for _, delivery in deliveries] == [0, 1]
    for peer, delivery in deliveries:
        peer.respond_number(delivery, "R", delivery.number)
        following = peer.next_delivery()
        assert following.number == delivery.number + 2
        peer.respond_number(following, "R", following.number)
    assert [reply_number(asker.await_reply(r)) for r in references] == [0, 1, 2, 3]
    for peer in (first, second):
        expect_nothing(peer, asker)


@pytest.mark.new_central("it waits for another acknowledgement")
def test_a_query_waits_for_a_handler_and_for_nothing_else(asker, join, central):
    """Check 74."""
    reference = asker.query_number("Q", 1)
    asker.sync()
    central.wait_for_line(r"Query +Q: +ASKER --> Resource Q +\(Pending\)")
    server = join("SERVER")
    server.subscribe("Q", 1)
    server.respond_number(server.next_delivery(), "R", 2)
    assert reply_number(asker.await_reply(reference)) == 2


def test_a_module_may_query_itself_while_it_handles_something(asker, join):
    """Check 75: with capacity 1 its query waits for its turn, and everybody goes on."""
    other = join("OTHER")
    subscribe(asker, "Q", "R")
    other.publish_number("R", 0)
    handled = asker.next_delivery()
    reference = asker.query_number("Q", 1)
    expect_nothing(asker, other)
    asker.acknowledge(handled)
    asker.respond_number(asker.next_delivery(), "R", 2)
    assert reply_number(asker.await_reply(reference)) == 2


def test_a_handler_may_finish_without_a_reply(asker, join, central):
    """Check 76: the asker hears nothing, the log says Done."""
    server = join("SERVER")
    subscribe(server, "Q")
    reference = asker.query_number("Q", 1)
    server.acknowledge(server.next_delivery())
    central.wait_for_line(r"Done +Q:")
    asker.sync()
    assert not asker.has_reply(reference)


def test_queries_of_modules_that_have_gone_leave_nothing_behind(asker, join, central, stack):
    """Check 78: each is answered when nobody waits for it any more."""
    server = join("SERVER")
    subscribe(server, "Q")
    for number in range(200):
        with Peer(central, "GONE") as gone:
            gone.connect()
            gone.query_number("Q", number)
            gone.sync()
        delivery = server.next_delivery()
        wait_until(lambda: asker.request("x_ipc_moduleConnectedQ", "GONE") == 0, "it has gone")
        server.respond_number(delivery, "R", number)
    server.sync()
    central.wait_for_line(r"Reply +Q: +SERVER --> GONE")
    reference = asker.query_number("Q", 7)
    server.respond_number(server.next_delivery(), "R", 8)
    assert reply_number(asker.await_reply(reference)) == 8


# ------------------------------------------------------------------------- endings


@pytest.mark.new_central("it does not tell which port it has chosen")
def test_what_was_on_its_way_to_a_module_is_cleared_active_first(stack, central_program, orders):
    """Checks 77 and 79; nothing is left in the server's table."""
    console = stack.enter_context(Process([central_program, "-p0", "-lmr"], stdin=-1))
    console.port = int(console.wait_for_line(r"Expecting \d+ on port (\d+)").group(1))
    publisher, subscriber = (stack.enter_context(
        Peer(console, name, order=next(orders))).connect() for name in ("A", "B"))
    publisher.define("M")
    subscribe(subscriber, "M")
    publish(publisher, "M0 M1 M2")
    active = subscriber.next_delivery().dispatch
    subscriber.close()
    console.wait_for_line("Closing B")
    publisher.sync()
    wait_until(lambda: console.output().count("Clearing handler") == 3, "three are cleared")
    cleared = re.findall(r"Clearing handler for message M \{(\d+)\}", console.output())
    assert len(cleared) == 3 and int(cleared[0]) == active
    console.write_line("display")
    console.write_line("status")
    console.wait_for_line("Resource status")
    shown = console.output().split("Active and Pending Messages:")[1].split("Resource status")[0]
    assert "{" not in shown


# ------------------------------------------------------------------ start, notices


def test_nobody_starts_before_as_many_as_expected_are_there(start_central, stack, orders):
    """Checks 81 and 82: one that waits and ends does not count."""
    central = start_central("3")

    def begin(name):
        peer = stack.enter_context(Peer(central, name, order=next(orders)))
        peer.read_prelude()
        peer.introduce()
        return peer, peer.start_request("x_ipc_waitMsg")
    (first, waits), (leaver, _) = begin("FIRST"), begin("LEAVER")
    first.sync()
    leaver.sync()
    assert not first.has_reply(waits)
    leaver.close()
    central.wait_for_line("Closing LEAVER")
    third, also = begin("THIRD")
    third.sync()
    first.sync()
    assert not first.has_reply(waits)
    last, too = begin("LAST")
    for peer, reference in ((first, waits), (third, also), (last, too)):
        assert peer.finish_request(reference, "x_ipc_waitMsg") is not None


def test_who_comes_and_goes_is_told_by_name(join, central):
    """Check 83; about a bare connection see test_misbehaviour.py."""
    watcher = join("WATCHER")
    watcher.set_capacity(10)
    subscribe(watcher, "x_ipc_connectNotify", "x_ipc_disconnectNotify")
    guest = join("GUEST")
    guest.close()
    assert [(d.name, d.value("string")) for d in watcher.take(2)] == [
        ("x_ipc_connectNotify", "GUEST"), ("x_ipc_disconnectNotify", "GUEST")]


def counts_of(watcher, count):
    return [delivery.value(messages.HANDLER_LIST)[0] for delivery in watcher.take(count)]


@pytest.mark.parametrize("ending", ["unsubscribe", "die"])
def test_the_number_of_handlers_is_told_when_it_changes(ending, trio, join):
    """Check 84."""
    publisher, subscriber, watcher = trio
    watcher.notice("x_ipc_notifyHandlerChange", "M")
    subscribe(watcher, "V_watch_M")
    subscribe(subscriber, "M")
    if ending == "die":
        subscriber.close()
    else:
        subscriber.unsubscribe("M", "HND-M1001")
    assert counts_of(watcher, 2) == [1, 0]


@pytest.mark.new_central("it ends")
def test_changes_of_handlers_may_be_asked_for_before_the_definition(join):
    """Check 85."""
    watcher, definer = join("WATCHER"), join("DEFINER")
    watcher.notice("x_ipc_notifyHandlerChange", "late")
    subscribe(watcher, "V_watch_late")
    definer.define("late")
    subscribe(definer, "late")
    counts = counts_of(watcher, 1)
    while counts[-1] != 1:
        counts += counts_of(watcher, 1)
    assert set(counts) <= {0, 1}


# ---------------------------------------------------------------- definitions, names


def test_of_two_definitions_the_last_one_counts(start_central, stack, orders):
    """Check 86; our log says who disagrees about what, in one line."""
    central = start_central("-lms")
    first, second = (stack.enter_context(Peer(central, name, order=next(orders))).connect()
                     for name in ("FIRST", "SECOND"))
    first.define("M", "{int, int}")
    first.sync()
    second.define("M", "{int, double}")
    second.sync()
    assert first.look_up("M").content == second.look_up("M").content
    central.wait_for_line("Registration: Message M Found. Updating.")
    if not central.original:
        line = central.wait_for_line("WARNING: SECOND on robot: (.*)").group(1)
        assert line == ("it defines M as {int, double} (variable length), but FIRST as {int, int} "
                        "(variable length): part 2 is double instead of int")
        assert central.output().count("it defines M") == 1


def test_names_that_differ_in_case_are_one_name(trio):
    """Check 87."""
    publisher, subscriber, watcher = trio
    subscribe(subscriber, "m")
    publish(publisher, "M1")
    assert subscriber.take_numbers(1) == [1]
    assert publisher.look_up("m").id == publisher.look_up("M").id
    assert watcher.request("x_ipc_moduleConnectedQ", "a") == 1


@pytest.mark.new_central("each change waits")
def test_a_module_that_does_not_listen_has_one_list_waiting_at_most(join):
    """Check 88."""
    lazy, busy = join("LAZY"), join("BUSY")
    lazy.subscribe(messages.WATCH_BROADCASTS, 9, messages.WATCH_BROADCASTS)
    lazy.sync()
    for number in range(1000):
        busy.subscribe(f"message {number}", 1)
    busy.sync()
    lazy.sync()
    for _ in range(2):
        lists = lazy.take(len(lazy.deliveries))
        assert len(lists) <= 2
        lazy.sync()
    used, _, names = lists[-1].value(messages.NAME_LIST)
    assert used > 1000 and "message 999" in names


# ------------------------------------------------------------------- direct, locked


def test_directly_sent_messages_do_not_pass_central(start_central, start_driver):
    """Check 89."""
    central = start_central("-c", "-lm")
    sender, receiver = (start_driver(name).connect(central.address) for name in ("A", "B"))
    sender.must("define", "M", "variable")
    receiver.must("subscribe", "M", 0, "sequence")
    sender.must("burst", "M", 100, 16, 1)
    receiver.until(100)
    assert receiver.do("report", "M").result == "100 0 0"
    central.wait_for_line("Direct Connection Established For: B at")
    assert not re.search(r"Broadcast +M", central.output())


@pytest.mark.new_central("unlocking may end it, and it stays locked without its holder")
@pytest.mark.parametrize("ending", ["unlocks", "dies"])
def test_a_locked_module_gets_its_messages_afterwards(ending, trio, join):
    """Check 90."""
    publisher, subscriber, holder = trio
    subscribe(subscriber, "M")
    number = holder.request("x_ipc_lockResourceMsg", "B")
    publish(publisher, "M1 M2")
    expect_nothing(subscriber, publisher)
    if ending == "dies":
        holder.close()
    else:
        holder.notice("x_ipc_unlockResourceMsg", number)
    assert subscriber.take_numbers(2) == [1, 2]
