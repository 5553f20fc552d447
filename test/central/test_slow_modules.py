"""Modules that are slow, stuck, too fast or short-lived: memory stays within the limits, and a pair
of healthy modules misses nothing.

IPC_TEST_CHAOS_SECONDS sets how long it goes on (default 2), IPC_TEST_SEED what happens.
"""
import os
import socket
import threading

import pytest

from support.peer import Peer
from support.processes import memory_of
from support.random_modules import RandomModules
from support.waiting import Deadline, PATIENCE

pytestmark = pytest.mark.new_central("it stops, or grows without end")

SECONDS = float(os.environ.get("IPC_TEST_CHAOS_SECONDS", "2"))
SEED = int(os.environ.get("IPC_TEST_SEED", "1"))
MODULES = 200
BURST = 2000

QUEUE_BYTES, QUEUE_MESSAGES, UNSENT_BYTES = 1 << 20, 2000, 256 << 10

#: What one module may cost: its queue, the records of it, what is unsent with one message more,
#: and buffers.
COST = QUEUE_BYTES + 400 * QUEUE_MESSAGES + 2 * UNSENT_BYTES + (128 << 10)


@pytest.fixture(params=["wait", "newest", "oldest", "disconnect"])
def central(request, start_central):
    return start_central("-lsi", f"--limit-queue-bytes={QUEUE_BYTES}",
                         f"--limit-queue-messages={QUEUE_MESSAGES}",
                         f"--limit-unsent-bytes={UNSENT_BYTES}", f"--when-full={request.param}")


class ReadsByteByByte:
    """A subscriber that takes one byte a second from its socket."""

    def __init__(self, central, message):
        self.peer = Peer(central, "ONE BYTE A SECOND").connect()
        self.peer.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self.peer.set_capacity(1000)
        self.peer.subscribe(message, 1)
        self.peer.sync()
        self.over = threading.Event()
        self.thread = threading.Thread(target=self._read)
        self.thread.start()

    def _read(self):
        try:
            while not self.over.wait(1) and self.peer.socket.recv(1):
                pass
        except OSError:
            pass  # disconnected, by a policy

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()
        self.peer.close()


def test_memory_is_bounded_and_nothing_is_lost_in_chaos(central, start_steady_pair, start_driver,
                                                        stack, request, record_property):
    """One subscriber never reads, another reads one byte a second, two publishers flood, and 200
    modules come and go at random."""
    floods = [start_driver(f"FLOOD {size}").connect(central.address) for size in (100, 10_000)]
    for flood in floods:
        flood.must("define", "flood", "variable")
    never = stack.enter_context(Peer(central, "NEVER READS")).connect()
    never.set_capacity(1000)
    never.subscribe("flood", 1)
    never.sync()
    stack.enter_context(ReadsByteByByte(central, "flood"))
    pair = start_steady_pair(central)
    crowd = stack.enter_context(RandomModules(central, MODULES, SEED, "flood"))
    before = most = memory_of(central)
    deadline, sent = Deadline(SECONDS), 0
    for flood, size in zip(floods, (100, 10_000)):
        flood.start("burst", "flood", BURST, size, 1)
    while not deadline.passed():
        for flood, size in zip(floods, (100, 10_000)):
            flood.finish(20 * PATIENCE)
            flood.start("burst", "flood", BURST, size, 1)
            sent += BURST
            most = max(most, memory_of(central))
    came = crowd.finish()
    count, gap = pair.finish()
    for flood in floods:
        flood.finish(20 * PATIENCE)
    for name, value in (("seconds", SECONDS), ("memory", most), ("gap", gap), ("sent", sent),
                        ("exchanged", count), ("modules", came)):
        record_property(name, value)
    print(f"{request.node.name}: {SECONDS} s, {sent} messages of the floods, {came} modules, "
          f"{count} messages of the pair with a gap of {gap * 1000:.1f} ms at most, "
          f"{before >> 10} KiB at first, {most >> 10} KiB at most")
    assert came > MODULES
    assert most - before < (MODULES + 4) * COST
    Peer(central, "NEW").connect().close()


def test_what_a_full_queue_loses_is_told_with_message_publisher_and_subscriber(start_central,
                                                                               stack):
    """Once when it begins, once with the number when it is over; `memory` has the sum."""
    central = start_central("--limit-queue-messages=10", "--when-full=newest")
    slow, sender = (stack.enter_context(Peer(central, name)).connect()
                    for name in ("SLOW", "SENDER"))
    slow.subscribe("M", 5)
    slow.sync()
    sender.define("M")
    for number in range(1000):
        sender.publish_number("M", number)
    sender.sync()
    assert slow.take_numbers(11) == [0, *range(990, 1000)]
    slow.sync()
    central.wait_for_line("SLOW on robot: the queue of SLOW is full: M of SENDER is dropped, "
                          "the newest messages are kept")
    central.wait_for_line("SLOW on robot: the queue of SLOW was full: 989 of M were dropped")
    assert central.output().count("is full") == 1


@pytest.mark.parametrize("policy, expected", [("newest", [0, *range(90, 100)]),
                                              ("oldest", list(range(11))), ("disconnect", None)])
def test_a_policy_may_be_that_of_one_module(policy, expected, start_central, stack):
    """The others keep the standard one, and what they get is not touched."""
    central = start_central("--limit-queue-messages=10", f"--when-full=slow:{policy}")
    slow, other, sender = (stack.enter_context(Peer(central, name)).connect()
                           for name in ("SLOW", "OTHER", "SENDER"))
    for peer in (slow, other):
        peer.subscribe("M", 5)
        peer.sync()
    sender.define("M")
    for number in range(100):
        sender.publish_number("M", number)
        assert other.take_numbers(1) == [number]
    sender.sync()
    if expected is None:
        assert slow.is_closed()
    else:
        assert slow.take_numbers(11) == expected
