"""Nothing grows, and nothing is slow (checks 66, 67, 69)."""
import gc
import os
import sys
import time

import pytest

from python.tools import BUILD, PACKAGES, ROOT, decoded, encoded, ipc as IPC
from support.processes import Process
from support.waiting import SLOW


EXCHANGE = """
    import gc, os
    import ipc_cffi as IPC

    def resident_bytes():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def exchange(count):
        for number in range(count):
            IPC.IPC_publishData("m", {"f0": number, "f1": "text", "f2": [1.0, 2.0, 3.0]})
            while not got:
                IPC.IPC_listen(1000)
            got.clear()
        gc.collect()
        return resident_bytes(), len(gc.get_objects()), len(os.listdir("/proc/self/fd"))

    got = []
    IPC.IPC_connect("m")
    IPC.IPC_defineMsg("m", IPC.IPC_VARIABLE_LENGTH, "{int, string, [double:3]}")
    IPC.IPC_subscribeData("m", lambda _instance, data, _client_data: got.append(data))
    before = exchange(5000)
    after = exchange(20000)
    print("growth", *(now - then for now, then in zip(after, before)))
    """


def test_messages_leave_nothing_behind(program):
    """In a process of its own: this one keeps what the server prints."""
    growth = program(EXCHANGE).wait_for_line(r"growth (\S+) (\S+) (\S+)", seconds=60 * SLOW)
    memory, objects, descriptors = map(int, growth.groups())
    assert memory < 1 << 20 and objects < 100 and descriptors == 0


def test_subscriptions_queries_and_timers_leave_nothing_behind(module):
    module.IPC_defineMsg("m", module.IPC_VARIABLE_LENGTH, "int")
    module.IPC_subscribeData("m", lambda instance, number, _: module.IPC_respondData(
        instance, "m", number))

    def cycle(count):
        for number in range(count):
            def handler(*_):
                pass
            module.IPC_subscribeData("m", handler, object())
            module.IPC_unsubscribe("m", handler)
            module.IPC_queryResponseData("m", number, None)
            module.IPC_addTimer(1000, 1, handler)
            module.IPC_removeTimer(handler)
        gc.collect()
        return len(gc.get_objects()), len(module.handlers._registrations)
    before = cycle(50)
    after = cycle(500)
    assert after[0] - before[0] < 100 and after[1] == before[1]


def best(function, times):
    """Microseconds of the quickest of several runs."""
    quickest = float("inf")
    for _ in range(5):
        begin = time.perf_counter()
        for _ in range(times):
            function()
        quickest = min(quickest, (time.perf_counter() - begin) / times)
    return quickest * 1e6


class Record(IPC.IPCdata):
    """A small structure."""
    _fields = ("i", "s", "d", "a")


@pytest.mark.parametrize("text, value, encoding, decoding", [
    ("[double:100000]", [float(k) for k in range(100000)], 5000, 5000),
    ("[ubyte:100000]", bytes(100000), 1000, None),
    ("[ubyte:100000]", [k & 255 for k in range(100000)], 5000, 5000),
    ("[int:1000]", list(range(1000)), 100, 100),
    ("{int, string, double, [double:3]}", Record(i=1, s="text", d=2.0, a=[1.0, 2.0, 3.0]), 10, 8),
    ("int", 5, 3, 3)], ids=lambda value: str(value)[:24])
@pytest.mark.skipif("IPC_TEST_SPEED" not in os.environ,
                    reason="speed is measured with IPC_TEST_SPEED=1, on a machine that is idle")
def test_conversion_is_quick(ipc, text, value, encoding, decoding):
    converter = ipc.IPC_parseFormat(text).converter
    content = encoded(text, value)
    times = max(1, 20000 // (len(content) + 20))
    assert best(lambda: converter.encode(value), times) < encoding * SLOW
    if decoding is not None:
        assert best(lambda: converter.decode(content, cls=Record), times) < decoding * SLOW
    assert decoded(text, content) is not None


def test_many_messages_leave_memory_as_it_is():
    """A small version of what test/bench/python_memory.py does with a million."""
    script = os.path.join(ROOT, "test", "bench", "python_memory.py")
    path = os.path.join(BUILD, "src/c/central") + os.pathsep + os.environ["PATH"]
    with Process([sys.executable, script, "--messages", "20000", "--every", "5000"],
                 env={"PYTHONPATH": PACKAGES, "PATH": path}) as started:
        assert started.wait(60 * SLOW) == 0, started.output()
