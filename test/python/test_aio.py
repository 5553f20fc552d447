"""IPC in programs that use asyncio (check 73)."""
import asyncio
import time

import pytest

from python.tools import ipc as IPC
from support.processes import free_port
from support.waiting import PATIENCE, SLOW

from ipc_cffi import coroutines  # noqa: E402  pylint: disable=wrong-import-order
import ipc_cffi.aio as aio  # noqa: E402  pylint: disable=wrong-import-order


def run(coroutine):
    async def bounded():
        return await asyncio.wait_for(coroutine, 6 * PATIENCE)
    return asyncio.run(bounded())


@pytest.fixture
def address(ipc, central):
    """Of a central of its own."""
    return central.address


def test_a_thousand_messages(address):
    async def main():
        async with aio.connect("test", address) as ipc:
            await ipc.define("m", int)
            stream = ipc.subscribe("m")
            for number in range(1000):
                await ipc.publish("m", number)
            got = []
            async for message in stream:
                got.append(message.data)
                if len(got) == 1000:
                    break
            return got
    assert run(main()) == list(range(1000))


def test_queries_side_by_side(address):
    async def main():
        async with aio.connect("test", address) as ipc:
            await ipc.define("query", int)

            @ipc.on("query")
            def answer(message):
                message.respond("query", message.data + 1)
            return await asyncio.gather(*(ipc.query("query", number, timeout=PATIENCE)
                                          for number in range(20)))
    assert run(main()) == list(range(1, 21))


def test_no_answer_and_cancellation(address):
    async def main():
        async with aio.connect("test", address) as ipc:
            await ipc.define("query", int)
            held = []

            @ipc.on("query")
            def hold(message):
                message.delay()
                held.append(message)
            before = len(IPC.handlers._registrations)
            with pytest.raises(IPC.IPCTimeout):
                await ipc.query("query", 1, timeout=0.05)
            held.pop().respond("query", 1)
            task = asyncio.ensure_future(ipc.query("query", 2))
            while not held:
                await asyncio.sleep(0.001)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            held.pop().respond("query", 2)
            await ipc.define("after", int)
            stream = ipc.subscribe("after")
            await ipc.publish("after", 1)  # what comes behind the response
            await stream.get()
            stream.close()
            with pytest.raises(IPC.MessageNotDefined):
                await ipc.query("unknown", 2)
            with pytest.raises(TypeError):
                await ipc.query("query", "x")
            return len(IPC.handlers._registrations) - before
    assert run(main()) == 0


def test_handlers_may_be_coroutines(address):
    async def main():
        async with aio.connect("test", address) as ipc:
            await ipc.define("m", int)
            got = asyncio.Queue()

            @ipc.on("m")
            async def handler(message):
                await asyncio.sleep(0)
                await got.put(message.data)
            await ipc.publish("m", 5)
            return await got.get()
    assert run(main()) == 5


def test_failures_of_handlers_go_to_the_loop(address):
    async def main():
        failures = []
        asyncio.get_running_loop().set_exception_handler(
            lambda loop, context: failures.append(context["exception"]))
        async with aio.connect("test", address) as ipc:
            await ipc.define("m", int)

            @ipc.on("m")
            def fail(message):
                raise ValueError("plain")

            @ipc.on("m")
            async def fail_too(message):
                raise ValueError("coroutine")
            await ipc.publish("m", 5)
            while len(failures) < 2:
                await asyncio.sleep(0.001)
        return sorted(str(failure) for failure in failures)
    assert run(main()) == ["coroutine", "plain"]


def test_timers_of_the_library_fire(address):
    async def main():
        async with aio.connect("test", address) as ipc:
            ticks = asyncio.Queue()
            timer = ipc.every(0.005, lambda: ticks.put_nowait(1))
            for _ in range(3):
                await ticks.get()
            timer.cancel()
    run(main())


def test_the_loop_goes_on_while_nothing_comes(address):
    async def main():
        async with aio.connect("test", address) as ipc:
            await ipc.define("m", int)
            stream = ipc.subscribe("m")
            begin = time.process_time()
            with pytest.raises(asyncio.TimeoutError):
                await asyncio.wait_for(stream.get(), 0.5)
            return time.process_time() - begin
    assert run(main()) < 0.2 * SLOW


def test_other_tasks_run_until_there_is_a_server(ipc, start_central, monkeypatch, capfd):
    monkeypatch.setattr("ipc_cffi.coroutines.PAUSE", 0.01)
    port = free_port()

    async def start():
        start_central(f"-p{port}")

    async def main():
        other = asyncio.create_task(start())  # runs when this one waits
        async with aio.connect("test", f"127.0.0.1:{port}") as module:
            assert other.done()
            await module.define("m", int)
            stream = module.subscribe("m")
            await module.publish("m", 7)
            assert (await stream.get()).data == 7
    run(main())
    assert "Trying again" not in capfd.readouterr().out


def test_where_no_server_is_connecting_fails(ipc, monkeypatch):
    async def main(**options):
        async with aio.connect("test", "127.0.0.1:1", **options):
            pass

    async def cancelled():
        connecting = asyncio.create_task(main())
        await asyncio.sleep(0)  # until it waits
        connecting.cancel()
        await connecting
    with pytest.raises(asyncio.CancelledError):
        run(cancelled())
    with pytest.raises(ValueError, match="reconnect can be"):
        run(main(reconnect="perhaps"))
    monkeypatch.setattr("ipc_cffi.coroutines.PAUSE", 0.001)
    with pytest.raises(ipc.NotConnected, match=r"is there a central at 127\.0\.0\.1:1\?"):
        run(main())
    assert not ipc.IPC_isConnected()


def test_a_server_is_looked_for_as_often_as_by_the_library(ipc, start_central):
    port, pauses = free_port(), []

    async def sleep(seconds):
        pauses.append(seconds)
        if len(pauses) == 4:
            start_central(f"-p{port}")

    async def main():
        options = {"on_handler_error": "log", "reconnect": None}
        module = await coroutines.connected(sleep, "test", f"127.0.0.1:{port}", **options)
        with module:
            assert module.is_connected
    run(main())
    assert pauses == [1.0] * 4


def test_several_connections(ipc, start_central):
    centrals = [start_central(), start_central()]

    async def main():
        async with aio.connect("a", centrals[0].address) as first, \
                aio.connect("b", centrals[1].address) as second:
            streams = []
            for connection in (first, second):
                await connection.define("m", int)
                streams.append(connection.subscribe("m"))
            await first.publish("m", 1)
            await second.publish("m", 2)
            return [(await stream.get()).data for stream in streams]
    assert run(main()) == [1, 2]


def test_the_end_of_the_connection_ends_what_waits(ipc, start_central):
    central = start_central()

    async def main():
        async with aio.connect("test", central.address) as ipc:
            await ipc.define("query", int)
            asked = asyncio.Event()

            @ipc.on("query")
            def hold(message):
                message.delay()
                asked.set()
            stream = ipc.subscribe("other")
            waiting = asyncio.ensure_future(ipc.query("query", 1))
            await asked.wait()
            central.process.kill()
            central._stopped = True
            with pytest.raises(IPC.NotConnected):
                await waiting
            assert [message async for message in stream] == []
    run(main())
