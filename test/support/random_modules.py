"""Modules that connect and die at random, in a process of their own.

    random_modules.py PORT COUNT SEED MESSAGE

COUNT of them are there before the first goes, and at most as many later.  Some subscribe to
MESSAGE, some publish it, some stop in the middle of a frame, none of them ever finishes a delivery.
They go on until standard input ends; then the number of modules that were there is printed.
"""
import os
import random
import re
import select
import subprocess
import sys
import types

if __name__ == "__main__":
    sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

from support.frame import BROADCAST, Frame
from support.peer import Closed, Peer
from support.processes import Process
from support.waiting import PATIENCE, TimedOut


class RandomModules(Process):
    """The running program, seen from a test."""

    def __init__(self, central, count, seed, message):
        super().__init__([sys.executable, __file__, central.port, count, seed, message],
                         stdin=subprocess.PIPE)
        self.wait_for_line("running", seconds=4 * PATIENCE)

    def finish(self):
        """Ends them all; returns how many have been there."""
        self.close_stdin()
        assert self.wait() == 0, self.output()[-2000:]
        return int(re.search(r"(\d+) modules", self.output()).group(1))

    def stop(self):
        self.close_stdin()
        super().stop()


def begin(central, chance, number, message):
    """One more module, which then does something, or not."""
    peer = Peer(central, f"RANDOM {number}", unix=False)
    what = chance.randrange(6)
    if what == 0:
        return peer  # silent
    peer.connect()
    if what in (1, 2):
        peer.set_capacity(chance.choice((1, 1000)))
        peer.subscribe(message, 1)
    elif what == 3:
        for _ in range(chance.randrange(50)):
            peer.publish(message, bytes(chance.randrange(2000)))
    elif what == 4:
        peer.send_bytes(Frame(BROADCAST, peer.id_of(message), bytes(1000)).pack()[
            :chance.randrange(1000)])
    return peer


def end(peer, chance):
    if chance.randrange(2):
        peer.reset()
    else:
        peer.close()


def main():
    central = types.SimpleNamespace(port=int(sys.argv[1]))
    count, chance, message = int(sys.argv[2]), random.Random(int(sys.argv[3])), sys.argv[4]
    peers, number = [], 0
    while not select.select([sys.stdin], [], [], 0)[0]:
        if number == count:
            print("running", flush=True)
        if len(peers) >= count or (number > count and chance.randrange(5) == 0):
            end(peers.pop(chance.randrange(len(peers))), chance)
        try:
            peers.append(begin(central, chance, number, message))
        except (Closed, OSError):
            pass  # it has misbehaved too early; that central serves is checked by others
        except TimedOut:
            sys.exit("central does not answer")
        number += 1
    print(f"{number} modules", flush=True)


if __name__ == "__main__":
    main()
