"""IPC in programs that use trio."""
import time

import pytest

from python.tools import ipc as IPC
from support.processes import free_port
from support.waiting import PATIENCE, SLOW

trio = pytest.importorskip("trio")
import ipc_cffi.trio as ipc_trio  # noqa: E402  pylint: disable=wrong-import-order


def run(main):
    async def bounded():
        with trio.fail_after(6 * PATIENCE):
            return await main()
    return trio.run(bounded)


@pytest.fixture
def address(ipc, central):
    """Of a central of its own."""
    return central.address


def failures_of(error):
    """The exceptions in a group, or the one alone."""
    parts = getattr(error, "exceptions", ())
    return [one for part in parts for one in failures_of(part)] or [error]


def test_messages_and_queries(address):
    async def main():
        async with ipc_trio.connect("test", address) as ipc:
            await ipc.define("m", int)
            await ipc.define("q", int)

            @ipc.on("q", queries=True)
            async def square(message):
                await trio.sleep(0.01)
                message.respond("q", message.data ** 2)
            stream = ipc.subscribe("m")
            for number in range(1000):
                await ipc.publish("m", number)
            got = []
            async for message in stream:
                got.append(message.data)
                if len(got) == 1000:
                    break
            assert got == list(range(1000))
            answers = {}

            async def ask(number):
                answers[number] = await ipc.query("q", number, timeout=PATIENCE)
            async with trio.open_nursery() as nursery:
                for number in range(5):
                    nursery.start_soon(ask, number)
            assert answers == {number: number ** 2 for number in range(5)}
    run(main)


def test_no_answer_and_cancellation(address):
    async def main():
        async with ipc_trio.connect("test", address) as ipc:
            await ipc.define("q", int)
            ipc.on("q", lambda message: message.data and message.respond("q", message.data))
            with pytest.raises(IPC.IPCTimeout):
                await ipc.query("q", 0, timeout=0.02)
            with trio.move_on_after(0.02) as scope:
                await ipc.query("q", 0)
            assert scope.cancelled_caught
            assert await ipc.query("q", 5, timeout=PATIENCE) == 5
            assert not ipc._pending
    run(main)


def test_timers_and_quiet_waiting(address):
    async def main():
        async with ipc_trio.connect("test", address) as ipc:
            ticks, more = trio.open_memory_channel(100)
            timer = ipc.every(0.005, lambda: ticks.send_nowait(1))
            for _ in range(3):
                await more.receive()
            timer.cancel()
            begin = time.process_time()
            await trio.sleep(0.5)
            assert time.process_time() - begin < 0.2 * SLOW
    run(main)


def test_the_oldest_are_dropped(address):
    async def main():
        async with ipc_trio.connect("test", address) as ipc:
            await ipc.define("m", int)
            stream = ipc.subscribe("m", maxsize=2)
            for number in range(6):
                await ipc.publish("m", number)
            while stream.dropped < 4:
                await trio.sleep(0.001)
            assert [(await stream.get()).data for _ in range(2)] == [4, 5]
            stream.close()
            assert IPC.IPC_numHandlers("m") == 0
    run(main)


def test_failures_come_out_of_the_block(address):
    async def main(handler):
        async with ipc_trio.connect("test", address) as ipc:
            await ipc.define("m", int)
            ipc.on("m", handler)
            await ipc.publish("m", 5)
            await trio.sleep_forever()

    async def fail(message):
        raise ValueError("coroutine")

    def fail_too(message):
        raise ValueError("plain")
    for handler, text in ((fail, "coroutine"), (fail_too, "plain")):
        with pytest.raises(BaseException) as caught:
            run(lambda handler=handler: main(handler))
        failure, = failures_of(caught.value)
        assert isinstance(failure, ValueError) and str(failure) == text
    assert not IPC.IPC_isConnected()


def test_a_server_is_waited_for(ipc, start_central, monkeypatch):
    monkeypatch.setattr("ipc_cffi.coroutines.PAUSE", 0.01)
    port = free_port()

    async def start():
        start_central(f"-p{port}")

    async def main():
        with pytest.raises(ipc.NullArgument):
            async with ipc_trio.connect("", f"127.0.0.1:{port}"):
                pass
        async with trio.open_nursery() as nursery:
            nursery.start_soon(start)  # runs when this task waits
            async with ipc_trio.connect("test", f"127.0.0.1:{port}") as module:
                assert module.connection.is_connected
    run(main)


def test_several_connections_and_the_end_of_one(ipc, start_central):
    centrals = [start_central(), start_central()]

    async def main():
        async with ipc_trio.connect("a", centrals[0].address) as first, \
                ipc_trio.connect("b", centrals[1].address, reconnect="fail") as second:
            streams = []
            for connection in (first, second):
                await connection.define("m", int)
                streams.append(connection.subscribe("m"))
            await second.define("q", int)
            asked = trio.Event()

            @second.on("q")
            def hold(message):
                message.delay()
                asked.set()
            await first.publish("m", 1)
            await second.publish("m", 2)
            assert [(await stream.get()).data for stream in streams] == [1, 2]
            seen, gone = trio.open_memory_channel(1)
            second.connection.on_connection(seen.send_nowait)
            failed, how = trio.open_memory_channel(1)

            async def ask():
                try:
                    await second.query("q", 1)
                except IPC.NotConnected:
                    failed.send_nowait("not connected")
            async with trio.open_nursery() as nursery:
                nursery.start_soon(ask)
                await asked.wait()
                centrals[1].stop()
                assert await how.receive() == "not connected"
            assert await gone.receive() is False
    run(main)
