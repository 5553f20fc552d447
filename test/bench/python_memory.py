#!/usr/bin/env python3
"""Sends many messages to one subscriber in Python, and looks at its memory.

    python_memory.py [--messages N] [--every N] [--limit KIB]

To be run by a Python in which ipc_cffi is installed.  Two programs and a central of their own: one
publishes structures with numbers, a text and an array, and now and then a large array; the other
subscribes, by data and by bytes, and answers a query for every tenth message.  Prints the subscriber's
resident memory as it goes, and fails if it grows by more than the limit after the first part, if a
message is lost, or if anything is still registered when it has disconnected.
"""
import argparse
import gc
import os
import subprocess
import sys
import time

import ipc_cffi as IPC

LARGE = 100000


def resident():
    """KiB."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024


def define():
    """The messages."""
    IPC.IPC_defineMsg("state", IPC.IPC_VARIABLE_LENGTH, "{int, string, [double:3], int, <short:4>}")
    IPC.IPC_defineMsg("image", IPC.IPC_VARIABLE_LENGTH, "{int, <ubyte:1>}")
    IPC.IPC_defineMsg("answer", IPC.IPC_VARIABLE_LENGTH, "int")


def publish(address, count):
    """Sends so many messages; every tenth is a query, every hundredth a large one."""
    IPC.IPC_connectModule("publisher", address)
    define()
    answers = []
    image = {"f0": LARGE, "f1": bytes(LARGE)}
    for number in range(count):
        state = [number, f"text {number}", [number, 0.5, -0.5], number % 7, [1] * (number % 7)]
        if number % 10 == 5:
            IPC.IPC_queryNotifyData("state", state, lambda _, data, __: answers.append(data))
        elif number % 100 == 99:
            IPC.IPC_publishData("image", image)
        else:
            IPC.IPC_publishData("state", state)
        if number % 1000 == 0:
            IPC.IPC_listenClear(0)
    while len(answers) < count // 10:
        IPC.IPC_listen(1000)
    assert sorted(answers) == list(range(5, count, 10)), "an answer was wrong"
    IPC.IPC_disconnect()


class Subscriber:
    """Takes the messages."""

    def __init__(self, options):
        self.options = options
        self.count = self.raw = 0
        self.sizes = []
        self.begin = time.perf_counter()

    def on_state(self, instance, data, client_data):
        """A structure; queries are answered."""
        assert len(data.f4) == data.f3 and data.f1 == f"text {data.f0}"
        if data.f0 % 10 == 5:
            IPC.IPC_respondData(instance, "answer", data.f0)
        self.tick()

    def on_image(self, instance, data, client_data):
        """A large array."""
        assert data.f0 == len(data.f1) == LARGE
        self.tick()

    def on_bytes(self, instance, content, client_data):
        """The same message as bytes."""
        self.raw += len(content) > LARGE

    def tick(self):
        """Counts, and shows the memory now and then."""
        self.count += 1
        if self.count % self.options.every == 0:
            gc.collect()
            self.sizes.append(resident())
            rate = self.count / (time.perf_counter() - self.begin)
            print(f"{self.count:9} messages, {self.sizes[-1]:7} KiB, {rate:8.0f}/s, "
                  f"{len(gc.get_objects())} objects", flush=True)

    def run(self, address):
        """Listens until all have come."""
        IPC.IPC_connectModule("subscriber", address)
        define()
        IPC.IPC_setCapacity(100)
        IPC.IPC_subscribeData("state", self.on_state)
        IPC.IPC_subscribeData("image", self.on_image)
        IPC.IPC_subscribe("image", self.on_bytes)
        before = len(IPC.handlers._registrations)
        with subprocess.Popen([sys.executable, __file__, "--publish", address, "--messages",
                               str(self.options.messages)]) as publisher:
            while self.count < self.options.messages and IPC.IPC_listen(60000) == IPC.IPC_OK:
                pass
            assert publisher.wait(60) == 0, "the publisher failed"
        assert self.count == self.options.messages, f"only {self.count} messages came"
        assert self.raw == self.options.messages // 100
        assert len(IPC.handlers._registrations) == before
        IPC.IPC_disconnect()
        assert not IPC.handlers._registrations, "something is still registered"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--messages", type=int, default=1000000)
    parser.add_argument("--every", type=int, default=100000)
    parser.add_argument("--limit", type=int, default=1024, help="KiB")
    parser.add_argument("--publish", help=argparse.SUPPRESS)
    options = parser.parse_args()
    IPC.IPC_setVerbosity(IPC.IPC_Silent)
    if options.publish:
        publish(options.publish, options.messages)
        return
    subscriber = Subscriber(options)
    with IPC.Central("-lx", environment=False) as central:
        subscriber.run(central.address)
    growth = max(subscriber.sizes) - subscriber.sizes[0]
    print(f"growth after the first {options.every} messages: {growth} KiB")
    if growth > options.limit:
        sys.exit(f"that is more than {options.limit} KiB")


if __name__ == "__main__":
    main()
