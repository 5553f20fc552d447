"""Two hand-made modules in a process of their own that exchange numbered messages all the time.

    steady_pair.py PORT RATE

They stop when standard input ends, and print how many messages were exchanged and the longest time
that one took.  A message that is lost, changed or out of order ends the program with a failure.
"""
import itertools
import os
import re
import select
import subprocess
import sys
import time
import types

if __name__ == "__main__":
    sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

from support.peer import Peer
from support.processes import Process


class SteadyPair(Process):
    """The running program, seen from a test."""

    def __init__(self, central, rate=1000):
        super().__init__([sys.executable, __file__, central.port, rate], stdin=subprocess.PIPE)
        self.count = self.gap = None
        self.wait_for_line("running")

    def finish(self):
        """Ends the exchange; nothing may have been lost.  Sets count, and gap in seconds."""
        if self.count is None:
            self.close_stdin()
            status = self.wait()
            assert status == 0, f"the steady pair failed:\n{self.output()[-2000:]}"
            found = re.search(r"exchanged (\d+), longest gap ([\d.]+)", self.output())
            self.count, self.gap = int(found.group(1)), float(found.group(2))
        return self.count, self.gap

    def stop(self):
        self.close_stdin()
        super().stop()


def exchange(sender, receiver, rate):
    """Publishes numbers and takes each before the next; returns how many, and the longest time."""
    longest = 0.0
    next_time = time.monotonic()
    for number in itertools.count():
        start = time.monotonic()
        sender.publish_number("steady", number)
        found = receiver.take_numbers(1)
        if found != [number]:
            sys.exit(f"{found} came instead of {number}")
        longest = max(longest, time.monotonic() - start)
        next_time = max(next_time + 1 / rate, start)
        pause = max(0.0, next_time - time.monotonic())
        if select.select([sys.stdin], [], [], pause)[0]:
            return number + 1, longest


def main():
    port, rate = int(sys.argv[1]), float(sys.argv[2])
    central = types.SimpleNamespace(port=port)
    sender, receiver = (Peer(central, name).connect() for name in ("STEADY SENDER",
                                                                   "STEADY RECEIVER"))
    sender.define("steady")
    receiver.subscribe("steady", 1)
    receiver.sync()
    print("running", flush=True)
    count, longest = exchange(sender, receiver, rate)
    print(f"exchanged {count}, longest gap {longest:.6f}", flush=True)


if __name__ == "__main__":
    main()
