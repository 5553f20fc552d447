"""Many modules: all get in, each costs little, and nobody pays for those that do nothing.

IPC_TEST_MODULES sets how many (default 2000, which is check 99; the goal is 10000).
"""
import os

import pytest

from support import messages
from support.crowd import connect_at_once, raise_descriptors
from support.peer import Peer
from support.processes import is_sanitized, memory_of, processor_time_of
from support.waiting import PATIENCE

pytestmark = pytest.mark.new_central("it serves 1000 modules at most")

MODULES = int(os.environ.get("IPC_TEST_MODULES", "2000"))


@pytest.fixture
def start_crowded(start_central):
    """Starts a central for so many connections, if the machine has descriptors for them."""
    def start(count, *options):
        if not raise_descriptors(count + 200):
            pytest.skip(f"this process may not have {count + 200} descriptors")
        return start_central("-lx", *options)
    return start


def join(stack, central, name, **options):
    return stack.enter_context(Peer(central, name, **options)).connect()


def test_a_thousand_modules_that_come_at_the_same_moment_all_get_in(start_crowded):
    """None is refused, and none has to try again."""
    connect_at_once(start_crowded(1000), 1000, 4 * PATIENCE)


@pytest.mark.parametrize("count", [1000])
def test_a_connection_is_told_to_nobody_but_those_who_asked(count, start_crowded, stack):
    """Modules that connected as those of CMU IPC do get not a byte when others come and go."""
    central = start_crowded(count)
    crowd = [stack.enter_context(Peer(central, f"M{number}")).connect_as_original()
             for number in range(count)]
    watcher = join(stack, central, "WATCHER")
    watcher.subscribe("x_ipc_connectNotify", 1)
    watcher.sync()
    for peer in crowd:
        peer.sync()  # the list of names has changed, which they may have been told
        peer.deliveries.clear()
    guest = stack.enter_context(Peer(central, "GUEST")).connect_as_original()
    guest.sync()
    assert [d.value("string") for d in watcher.take(1)] == ["GUEST"]
    guest.close()
    for peer in crowd:
        peer.sync()
        assert not peer.deliveries


@pytest.mark.parametrize("ability", ["ipc_x_in_order", None], ids=["ours", "cmu-ipc"])
def test_new_names_of_many_modules_at_once_cost_one_list_each_and_turn(ability, start_crowded,
                                                                       stack):
    """300 modules that watch the list subscribe to three names of their own each; the list with all
    of them has some 20 KB.  Told at each change it would be 2 GB."""
    central = start_crowded(300)
    crowd = [join(stack, central, f"M{number}") for number in range(300)]
    for peer in crowd:
        if ability:
            peer.look_up(ability)
        peer.subscribe(messages.WATCH_BROADCASTS, 9, messages.WATCH_BROADCASTS)
        peer.sync()
    references = []
    for number, peer in enumerate(crowd):
        for name in range(3):
            peer.subscribe(f"message {name} of {number}", name)
        references.append(peer.start_look_up("x_ipc_waitMsg"))
    received = 0
    for peer, reference in zip(crowd, references):
        peer.finish_look_up(reference)
        received += sum(len(delivery.frame.data) for delivery in peer.deliveries)
        if ability:
            told = peer.deliveries[-1].value(messages.NAME_LIST)[2]
            assert {f"message {name} of {peer.name[1:]}" for name in range(3)} <= set(told)
    assert received < 500 << 20


def test_every_one_of_many_modules_gets_what_is_published(start_crowded, stack,
                                                          start_steady_pair, record_property):
    """Check 99, and what one module costs: memory, and time of the others."""
    central = start_crowded(MODULES)
    sender, left, right = (join(stack, central, name) for name in ("SENDER", "LEFT", "RIGHT"))
    sender.define("to all")
    right.subscribe("number", 1)
    right.sync()
    left.define("number")

    def cost_of_messages():
        before = processor_time_of(central)
        for number in range(3000):
            left.publish_number("number", number)
            assert right.take_numbers(1) == [number]
        return processor_time_of(central) - before
    cost, memory = cost_of_messages(), memory_of(central)
    crowd = [join(stack, central, f"M{number}") for number in range(MODULES)]
    for peer in crowd:
        peer.subscribe(messages.WATCH_BROADCASTS, 9, messages.WATCH_BROADCASTS)
        peer.subscribe("to all", 1)
    for peer in crowd:
        peer.sync()
    for name in ("one", "two"):  # of these changes most do not hear, since they do not listen
        left.subscribe(name, 7)
        left.sync()
    each = (memory_of(central) - memory) / MODULES
    crowded_cost = cost_of_messages()
    for name, value in (("bytes each", each), ("cost", cost), ("crowded cost", crowded_cost)):
        record_property(name, value)
    if not is_sanitized(central.arguments[0]):
        assert each < 32 << 10
    assert crowded_cost < 5 * cost + 0.3
    start_steady_pair(central)
    sender.publish_number("to all", 42)
    for peer in crowd:
        delivery = peer.next_delivery()
        while delivery.name != "to all":
            peer.acknowledge(delivery)
            delivery = peer.next_delivery()
        assert delivery.number == 42
