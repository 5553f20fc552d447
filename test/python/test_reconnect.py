"""Programs that outlive their server: the additions of ipcx.h, and connect(reconnect=...)."""
import asyncio

import pytest

from python.tools import ipc as IPC, listen_until
from support.waiting import PATIENCE


@pytest.fixture
def restart(start_central):
    """Starts a central, and another one in its place."""
    class Place:
        """Where central is."""
        central = None

        def begin(self):
            port = self.central.port if self.central else 0
            self.central = start_central(*([f"-p{port}"] if port else []))
            return self.central

        def end(self):
            self.central.stop()
    return Place()


def test_the_functions_of_the_library(ipc, restart):
    ipc.IPC_connectModule("test", restart.begin().address)
    seen = []

    def handler(connected, client_data):
        seen.append((connected, client_data))
    assert ipc.IPCx_setReconnect(ipc.IPCX_RECONNECT_FAIL) == ipc.IPC_OK
    assert ipc.IPCx_subscribeConnection(handler, "data") == ipc.IPC_OK
    ipc.IPC_defineMsg("m", ipc.IPC_VARIABLE_LENGTH, "int")
    got = []
    ipc.IPC_subscribeData("m", lambda instance, data, client_data: got.append(data))
    restart.end()
    listen_until(lambda: seen)
    assert seen == [(False, "data")] and not ipc.IPC_isConnected()
    with pytest.raises(ipc.NotConnected):
        ipc.IPC_publishData("m", 1)
    restart.begin()
    listen_until(lambda: len(seen) == 2)
    assert seen[1] == (True, "data") and ipc.IPC_isConnected()
    ipc.IPC_publishData("m", 2)
    listen_until(lambda: got)
    assert got == [2]
    assert ipc.IPCx_unsubscribeConnection(handler) == ipc.IPC_OK
    with pytest.raises(ipc.OutOfRange):
        ipc.IPCx_setReconnect(17)
    with pytest.raises(ipc.NullArgument):
        ipc.IPCx_subscribeConnection(None)


def test_without_a_connection_they_fail(ipc):
    for call in (lambda: ipc.IPCx_setReconnect(ipc.IPCX_RECONNECT_WAIT),
                 lambda: ipc.IPCx_subscribeConnection(print)):
        with pytest.raises(ipc.IPCError) as caught:
            call()
        assert caught.value.errno in (ipc.IPC_Not_Connected, ipc.IPC_Not_Initialized)


def test_a_connection_that_waits(ipc, restart):
    with ipc.connect("test", restart.begin().address, reconnect="wait") as connection:
        seen, got = [], []
        connection.on_connection(seen.append)
        connection.define("m", int)
        connection.subscribe("m", lambda message: (got.append(message.data), connection.stop()))
        restart.end()
        listen_until(lambda: seen)
        connection.after(0.02, restart.begin)
        connection.after(0.03, lambda: connection.publish("m", 5))
        connection.dispatch()  # goes on although there is no server
        assert got == [5] and seen == [False, True]
        connection.publish("m", 6)  # waits if it has to


def test_a_connection_that_fails_meanwhile(ipc, restart):
    with ipc.connect("test", restart.begin().address, reconnect="fail") as connection:
        connection.define("m", int)
        messages = connection.messages("m")
        seen = []
        connection.on_connection(seen.append)
        restart.end()
        listen_until(lambda: seen)
        assert not connection.is_connected
        with pytest.raises(ipc.NotConnected):
            connection.publish("m", 1)
        restart.begin()
        listen_until(lambda: connection.is_connected)
        connection.publish("m", 2)
        assert messages.get().data == 2
        messages.close()


def test_wrong_choices_are_refused_before_connecting(ipc):
    for options in ({"reconnect": "often"}, {"errors": "ignore"}, {"on_handler_error": "no"}):
        with pytest.raises(ValueError, match="can be"):
            ipc.connect("test", "localhost:1", **options)


def test_the_choice_never_ends_the_connection(ipc, restart):
    with ipc.connect("test", restart.begin().address, reconnect="never") as connection:
        restart.end()
        ipc.IPC_setVerbosity(ipc.IPC_Silent)
        with pytest.raises(ipc.NotConnected):
            connection.listen(PATIENCE)
        assert not connection.is_connected
        connection.dispatch()  # nothing to listen to


def test_asyncio(ipc, restart):
    from ipc_cffi import aio  # pylint: disable=import-outside-toplevel

    async def main():
        async with aio.connect("test", restart.begin().address, reconnect="fail") as connection:
            await connection.define("m", int)
            await connection.define("q", int)
            asked = asyncio.Event()

            @connection.on("q")
            def hold(message):
                message.delay()
                asked.set()
            stream = connection.subscribe("m")
            seen = asyncio.Queue()
            connection.connection.on_connection(seen.put_nowait)
            waiting = asyncio.ensure_future(connection.query("q", 1))
            await asked.wait()
            restart.end()
            assert await seen.get() is False
            with pytest.raises(IPC.NotConnected):
                await waiting
            restart.begin()
            assert await seen.get() is True
            await connection.publish("m", 3)
            assert (await stream.get()).data == 3
    asyncio.run(asyncio.wait_for(main(), 4 * PATIENCE))
