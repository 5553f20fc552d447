#!/usr/bin/env python3
"""Measures how a central bears many modules.

    scale.py --build build/release [--modules 10000] [--other-central PATH]

Connects modules that do nothing, as programs of CMU IPC connect, and tells for no
module, half of them and all of them: resident memory of central for each, the round
trip between two busy modules, the time of a look-up and of a change of the list of
names, and the processor time of central for a connection and for a queued message.
At the end 1,000 more connect at the same moment.
"""

import argparse
import contextlib
import pathlib
import statistics
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(ROOT / "test"))

from support.crowd import connect_at_once, raise_descriptors  # noqa: E402
from support.peer import Peer  # noqa: E402
from support.processes import Central, memory_of, processor_time_of  # noqa: E402


def median_us(action, count):
    """Median time of an action in microseconds."""
    times = []
    for number in range(count):
        start = time.perf_counter()
        action(number)
        times.append(time.perf_counter() - start)
    return statistics.median(times) * 1e6


class Probe:
    """A few modules that measure."""

    def __init__(self, central, stack):
        self.central, self.stack = central, stack
        self.left, self.right, self.queue = (self.join(name) for name in ("L", "R", "QUEUE"))
        for peer, name in ((self.left, "to left"), (self.right, "to right")):
            peer.define(name)
            peer.subscribe(name, 1)
            peer.sync()
        self.queue.define("queued")
        self.queue.subscribe("queued", 1)
        self.queue.sync()
        self.serial = 0

    def join(self, name):
        return self.stack.enter_context(Peer(self.central, name)).connect()

    def round_trip(self, number):
        self.left.publish_number("to right", number)
        assert self.right.take_numbers(1) == [number]
        self.right.publish_number("to left", number)
        assert self.left.take_numbers(1) == [number]

    def connection(self, count):
        """Processor time of central for a module that comes and goes, in us; how long the kernel
        looks for a free port is another matter."""
        before = processor_time_of(self.central)
        for number in range(count):
            with Peer(self.central, f"GUEST {number}") as peer:
                peer.connect()
        self.left.sync()
        return (processor_time_of(self.central) - before) / count * 1e6

    def subscribe_to_new_name(self, _):
        self.serial += 1
        name = f"new name {self.serial}"
        self.left.subscribe(name, 7)
        self.left.sync()
        self.left.unsubscribe(name, f"HND-{name}1007")
        self.left.sync()

    def queued_message(self, count):
        """Processor time of central for a message that waits and is handled later, in us."""
        before = processor_time_of(self.central)
        for number in range(count):
            self.left.publish_number("queued", number)
        self.left.sync()
        assert self.queue.take_numbers(count) == list(range(count))
        self.queue.sync()
        return (processor_time_of(self.central) - before) / count * 1e6

    def measure(self, n_modules, base):
        look_up = median_us(lambda _: self.left.sync(), 2000)
        row = {"modules": n_modules,
               "KiB each": (memory_of(self.central) - base) / 1024 / max(1, n_modules),
               "round trip us": median_us(self.round_trip, 3000),
               "look-up us": look_up,
               "connection us": self.connection(1000),
               "queued message us": self.queued_message(20000),
               "new name us": median_us(self.subscribe_to_new_name, 5)}
        print("  ".join(f"{name} {value:.1f}" if isinstance(value, float) else f"{name} {value}"
                        for name, value in row.items()), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default=ROOT / "build" / "release")
    parser.add_argument("--other-central", help="measure this one instead")
    parser.add_argument("--modules", type=int, default=10000)
    options = parser.parse_args()
    program = options.other_central or pathlib.Path(options.build) / "src/c/central/central"
    if not raise_descriptors(options.modules + 1200):
        sys.exit("not enough descriptors are allowed")
    with contextlib.ExitStack() as stack:
        central = stack.enter_context(Central(program, "-lx",
                                              original=options.other_central is not None))
        probe = Probe(central, stack)
        probe.measure(0, memory_of(central))
        base = memory_of(central)
        peers = 0
        for part in (options.modules // 2, options.modules):
            while peers < part:
                stack.enter_context(Peer(central, f"IDLE {peers}")).connect_as_original()
                peers += 1
            probe.measure(peers, base)
        start = time.perf_counter()
        connect_at_once(central, 1000, 60)
        print(f"1000 modules at the same moment: {time.perf_counter() - start:.2f} s")


if __name__ == "__main__":
    main()
