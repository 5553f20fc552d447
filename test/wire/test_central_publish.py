"""Central's side of publishing: who gets what, when, and in which order (requirements 23-30)."""
import pytest

from support import codec
from support.frame import BROADCAST, Frame, REPLY, SUCCESS
from support.peer import expect_nothing
from support.waiting import wait_until


def publish_each(sender, items):
    """Publishes (message, number) pairs and waits until central has all of them."""
    for name, number in items:
        sender.publish_number(name, number)
    sender.sync()


def take_all(receiver, count):
    """(message, number) of the next count deliveries, each acknowledged after it has come."""
    return [(delivery.name, delivery.number) for delivery in receiver.take(count)]


# --------------------------------------------------------------------- delivery


def test_each_handler_gets_a_delivery_oldest_subscription_first(join):
    """Requirement 23: intent is the handler id, reference the dispatch id, dispatch is -1."""
    first, second, sender = join("A"), join("B"), join("S")
    for peer in (first, second):
        peer.set_capacity(10)
    sender.define("M")
    first.subscribe("M", 30, "a")
    first.sync()
    second.subscribe("M", 20, "b")
    second.sync()
    first.subscribe("M", 10, "c")
    first.sync()
    sender.publish_number("M", 7)
    mine = [first.next_delivery() for _ in range(2)]
    theirs = second.next_delivery()
    assert [delivery.handler for delivery in mine] == [30, 10]
    assert theirs.handler == 20
    every = [*mine, theirs]
    assert all(d.frame.cls == BROADCAST and d.frame.dispatch == -1 for d in every)
    assert all(d.number == 7 and d.dispatch >= 0 for d in every)
    assert len({d.dispatch for d in every}) == 3
    expect_nothing(first, sender)
    expect_nothing(second, sender)


def test_the_publisher_may_be_among_the_receivers(join):
    """Section 5.2."""
    peer = join("M")
    peer.define("M")
    peer.subscribe("M", 5)
    peer.publish_number("M", 1)
    assert peer.take_numbers(1) == [1]


@pytest.mark.parametrize("data", [b"", b"\x01", b"four", bytes(range(256)) * 1000],
                         ids=["none", "one byte", "four bytes", "256 kB"])
def test_data_is_delivered_as_it_came(data, join):
    """Section 5.2: central does not touch the data, so it need not understand it."""
    receiver, sender = join("R"), join("S")
    sender.define("M", None, f"[byte:{len(data)}]" if data else None)
    receiver.subscribe("M", 5)
    receiver.sync()
    sender.publish("M", data=data)
    assert receiver.next_delivery().frame.data == data


def test_data_that_does_not_fit_its_format_is_no_concern_of_central(join):
    """Section 13.3: user data is not inspected by central."""
    receiver, sender = join("R"), join("S")
    sender.define("M", "{int, string}")
    receiver.subscribe("M", 5)
    receiver.sync()
    sender.publish("M", data=b"\xff" * 11)
    assert receiver.next_delivery().frame.data == b"\xff" * 11


def test_class_data_holds_the_message_name_until_the_module_has_asked_for_the_handler(join):
    """Requirement 24: three messages in a row before the module asks."""
    receiver, sender = join("R"), join("S")
    sender.define("Msg")
    receiver.subscribe("Msg", 5, "HND-Msg1")
    receiver.set_capacity(10)
    receiver.sync()
    publish_each(sender, [("Msg", number) for number in range(3)])
    assert [delivery.name for delivery in receiver.take(3)] == ["Msg"] * 3
    assert receiver.look_up("Msg", "HND-Msg1").id == receiver.look_up("Msg").id


@pytest.mark.new_central("it leaves the name out after the look-up")
def test_class_data_always_holds_the_message_name(join):
    """Decision on 16.1."""
    receiver, sender = join("R"), join("S")
    sender.define("Msg")
    receiver.subscribe("Msg", 5, "HND-Msg1")
    receiver.look_up("Msg", "HND-Msg1")
    publish_each(sender, [("Msg", 1), ("Msg", 2)])
    assert [delivery.name for delivery in receiver.take(2)] == ["Msg", "Msg"]


def test_publications_without_handlers_are_dropped(join):
    """Requirement 30."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    publish_each(sender, [("M", number) for number in range(5)])
    receiver.subscribe("M", 5)
    receiver.sync()
    sender.publish_number("M", 99)
    assert receiver.take_numbers(1) == [99]
    expect_nothing(receiver, sender)


# --------------------------------------------------------------------- capacity


def test_one_delivery_is_unfinished_at_a_time_by_default(join):
    """Requirement 27: the rest waits in order."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.sync()
    publish_each(sender, [("M", number) for number in range(5)])
    for number in range(5):
        delivery = receiver.next_delivery()
        assert delivery.number == number
        expect_nothing(receiver, sender)
        receiver.acknowledge(delivery)


@pytest.mark.parametrize("capacity", [2, 3, 100])
def test_at_most_capacity_deliveries_are_unfinished(capacity, join):
    """Requirement 27."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.set_capacity(capacity)
    receiver.sync()
    publish_each(sender, [("M", number) for number in range(capacity + 3)])
    held = [receiver.next_delivery() for _ in range(capacity)]
    expect_nothing(receiver, sender)
    for expected, delivery in enumerate(held):
        assert delivery.number == expected
    receiver.acknowledge(held.pop(0))
    assert receiver.next_delivery().number == capacity
    expect_nothing(receiver, sender)


def test_acknowledgements_may_come_in_any_order(join):
    """Section 5.4."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.set_capacity(3)
    receiver.sync()
    publish_each(sender, [("M", number) for number in range(6)])
    held = [receiver.next_delivery() for _ in range(3)]
    for delivery in reversed(held):
        receiver.acknowledge(delivery)
    assert receiver.take_numbers(3) == [3, 4, 5]


def test_a_failure_frees_the_slot_as_well(join):
    """Section 5.4: class 13 with a reason."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.sync()
    publish_each(sender, [("M", 1), ("M", 2)])
    receiver.fail(receiver.next_delivery(), "no reason")
    assert receiver.take_numbers(1) == [2]


def test_capacity_below_1_becomes_1(join):
    """Section 5.5."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.set_capacity(0)
    receiver.sync()
    publish_each(sender, [("M", 1), ("M", 2)])
    first = receiver.next_delivery()
    expect_nothing(receiver, sender)
    receiver.acknowledge(first)
    assert receiver.take_numbers(1) == [2]


@pytest.mark.new_central("raising the capacity releases nothing by itself")
def test_raising_the_capacity_fills_the_new_slots_at_once(join):
    """Section 5.5: New fills the slots at once and keeps the order."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.sync()
    publish_each(sender, [("M", number) for number in range(6)])
    first = receiver.next_delivery()
    receiver.set_capacity(3)
    assert [receiver.next_delivery().number for _ in range(2)] == [1, 2]
    expect_nothing(receiver, sender)
    receiver.acknowledge(first)
    assert receiver.next_delivery().number == 3


def test_a_busy_module_does_not_hold_up_another(join):
    """Requirement 27: capacity belongs to a module."""
    busy, idle, sender = join("B"), join("I"), join("S")
    sender.define("M")
    for peer in (busy, idle):
        peer.subscribe("M", 5)
        peer.sync()
    publish_each(sender, [("M", number) for number in range(20)])
    assert idle.take_numbers(20) == list(range(20))
    assert busy.take_numbers(20) == list(range(20))


# --------------------------------------------------------------- limits, priorities


def test_a_limit_drops_the_oldest_pending_instance(join):
    """Requirement 28, first observed sequence: 1-8 with limit 3 arrive as 1, 6, 7, 8."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.set_limit("M", 3)
    receiver.sync()
    publish_each(sender, [("M", number) for number in range(1, 9)])
    assert receiver.take_numbers(4) == [1, 6, 7, 8]
    expect_nothing(receiver, sender)


@pytest.mark.parametrize("capacity, limit, expected", [
    (1, 2, [0, 6, 7]), (1, 1, [0, 7])])
def test_limits_as_the_programming_interface_describes_them(capacity, limit, expected, join):
    """api-behaviour 12: eight messages while the module does not listen."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.set_capacity(capacity)
    receiver.set_limit("M", limit)
    receiver.sync()
    publish_each(sender, [("M", number) for number in range(8)])
    assert receiver.take_numbers(len(expected)) == expected


def test_a_limited_message_does_not_lose_its_turn(join):
    """Section 5.5: the others move up one place each and the new one takes the newest one's
    place."""
    receiver, sender = join("R"), join("S")
    for name in ("hi", "mid", "lo"):
        sender.define(name)
        receiver.subscribe(name, 5)
    receiver.set_limit("lo", 1)
    receiver.sync()
    sent = [("lo", 0), ("lo", 1), ("hi", 0), ("mid", 0), ("lo", 2), ("hi", 1), ("mid", 1)]
    publish_each(sender, sent)
    assert take_all(receiver, 6) == [
        ("lo", 0), ("lo", 2), ("hi", 0), ("mid", 0), ("hi", 1), ("mid", 1)]


def test_a_limit_belongs_to_one_module(join):
    """Section 5.5: others get everything."""
    limited, free, sender = join("L"), join("F"), join("S")
    sender.define("M")
    for peer in (limited, free):
        peer.subscribe("M", 5)
    limited.set_limit("M", 1)
    limited.sync()
    free.sync()
    publish_each(sender, [("M", number) for number in range(8)])
    assert limited.take_numbers(2) == [0, 7]
    assert free.take_numbers(8) == list(range(8))


@pytest.mark.new_central("it loses the new one as well")
def test_a_limit_of_the_whole_resource_drops_its_first_entry(join):
    """Section 5.5: an empty message name means the whole resource."""
    receiver, sender = join("R"), join("S")
    for name in ("A", "B"):
        sender.define(name)
        receiver.subscribe(name, 5)
    receiver.set_limit(None, 2)
    receiver.sync()
    publish_each(sender, [("A", 0), ("A", 1), ("B", 2), ("A", 3), ("B", 4)])
    assert take_all(receiver, 3) == [("A", 0), ("A", 3), ("B", 4)]


@pytest.mark.parametrize("priorities, sent, expected", [
    ({"L": 1, "H": 9}, "N0 N1 L2 H3 N4 L5 H6", "N0 H3 H6 L2 L5 N1 N4"),
    ({"B": 0}, "A0 A1 B2 C3 B4", "A0 B2 B4 A1 C3")])
def test_priorities_order_what_waits(priorities, sent, expected, join):
    """Requirement 28, second and third observed sequence: unset is below 0, equals in order of
    arrival."""
    receiver, sender = join("R"), join("S")
    for name in sorted({item[0] for item in sent.split()}):
        sender.define(name)
        receiver.subscribe(name, ord(name))
    for name, priority in priorities.items():
        sender.set_priority(name, priority)
    sender.sync()
    receiver.sync()
    publish_each(sender, [(item[0], int(item[1])) for item in sent.split()])
    got = [f"{name}{number}" for name, number in take_all(receiver, len(expected.split()))]
    assert " ".join(got) == expected


def test_a_limit_for_a_resource_that_nobody_has_does_no_harm(join):
    """Section 5.5: a log line only."""
    peer = join("M")
    peer.notice("x_ipc_limitPendingMsg", ("M", "no such resource", 1))
    peer.sync()


# ------------------------------------------------------------------ other answers


def test_a_response_to_a_publication_acknowledges_it(join):
    """Requirement 37: nobody gets it."""
    receiver, sender = join("R"), join("S")
    for name in ("M", "A"):
        sender.define(name)
    receiver.subscribe("M", 5)
    receiver.sync()
    publish_each(sender, [("M", 1), ("M", 2)])
    receiver.respond_number(receiver.next_delivery(), "A", 7)
    assert receiver.take_numbers(1) == [2]
    expect_nothing(sender, receiver)
    assert not any(sender.replies.values())


def test_an_inform_frame_for_a_users_message_goes_to_one_handler(join):
    """Section 2.7: what old modules send."""
    receiver, sender = join("R"), join("S")
    sender.define("M", "int", cls=6)
    receiver.subscribe("M", 5)
    receiver.sync()
    sender.send(Frame(6, sender.id_of("M"), codec.variable(b"\1\0\0\0"),
                      reference=sender.next_reference()))
    delivery = receiver.next_delivery()
    assert (delivery.frame.cls, delivery.number) == (6, 1)
    receiver.acknowledge(delivery)
    expect_nothing(receiver, sender)


def test_acknowledgements_without_a_dispatch_are_ignored(join):
    """Section 2.7: dispatch -1 with class 11, 12 or 13."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 5)
    receiver.sync()
    for cls in (SUCCESS, REPLY):
        receiver.send(Frame(cls))
    publish_each(sender, [("M", 1), ("M", 2)])
    first = receiver.next_delivery()
    receiver.send(Frame(SUCCESS))
    expect_nothing(receiver, sender)
    receiver.acknowledge(first)
    assert receiver.take_numbers(1) == [2]


def test_priorities_outlive_the_module_that_set_them(join):
    """Section 9.1: priorities stay; they belong to the message."""
    setter, receiver, sender = join("P"), join("R"), join("S")
    for name in ("A", "B"):
        sender.define(name)
        receiver.subscribe(name, 5)
    setter.set_priority("B", 5)
    setter.sync()
    setter.close()
    wait_until(lambda: sender.request("x_ipc_moduleConnectedQ", "P") == 0, "P is gone")
    receiver.sync()
    publish_each(sender, [("A", 0), ("A", 1), ("B", 2)])
    assert take_all(receiver, 3) == [("A", 0), ("B", 2), ("A", 1)]


def test_every_size_from_0_to_70000_bytes_gets_through(join):
    """Section 2.2: sizes around the limits of buffers."""
    receiver, sender = join("R"), join("S")
    sender.define("M", None)
    receiver.subscribe("M", 5)
    receiver.sync()
    sizes = [0, 1, 2, 3, 4, 27, 28, 29, 255, 256, 1023, 1024, 4095, 4096, 4097, 16383, 16384, 16385,
             32768, 65507, 65536, 70000]
    for size in sizes:
        content = bytes(number % 251 for number in range(size))
        sender.publish("M", content)
        assert receiver.take(1)[0].content == content


@pytest.mark.new_central("it takes 40 seconds")
def test_a_message_of_64_mebibytes_gets_through(join):
    """Section 2.2: central must accept data of at least 64 MiB."""
    receiver, sender = join("R"), join("S")
    sender.define("M", None)
    receiver.subscribe("M", 5)
    receiver.sync()
    content = bytes(range(256)) * (64 << 12)
    sender.socket.settimeout(60)
    sender.publish("M", content)
    assert receiver.next_delivery(60).content == content
