"""IPC in programs that use trio.

    async with ipc_cffi.trio.connect("name") as ipc:
        await ipc.publish("message", data)
        answer = await ipc.query("query", data, timeout=2)
        async for message in ipc.subscribe("message"):
            ...

A task waits for one descriptor of the library, and for the time of its next timer; handlers run in
it.  An exception of a handler comes out of the async with block, as does the loss of the server.
"""
from __future__ import annotations

import contextlib
import inspect
import math
import os
from typing import Any, AsyncIterator, Optional, Set, Tuple, Type

import trio

from ._ffi import lib
from .arguments import Text
from .connection import Connection, Message, OnError, SubscribedMessages
from .constants import IPC_Not_Connected, IPC_VARIABLE_LENGTH
from .coroutines import CoroutineConnection, Handler, connected
from .errors import IPCTimeout, last_error
from .library import waits


class TrioConnection(CoroutineConnection):
    """A connection of a program that uses trio."""

    def __init__(self, connection: Connection, nursery: trio.Nursery) -> None:
        self._connection = connection
        self._nursery = nursery
        self._wait = trio.CancelScope()
        self._pending: Set[trio.MemorySendChannel[Any]] = set()
        connection.on_connection(self._switched)

    @property
    def connection(self) -> Connection:
        """The connection beneath."""
        return self._connection

    async def _work(self) -> None:
        """Lets the library work whenever it has something to do."""
        # A copy, as only one task may wait for one descriptor.
        descriptor = os.dup(lib.IPCx_fd())
        try:
            while True:
                with trio.CancelScope() as self._wait:
                    self._changed()
                    await trio.lowlevel.wait_readable(descriptor)
                waits(lib.IPCx_process)
        finally:
            os.close(descriptor)

    def _changed(self) -> None:
        """Waits no longer than the library's timers allow; after calls that may have added one."""
        left = lib.IPCx_nextTimeout()
        self._wait.deadline = math.inf if left < 0 else trio.current_time() + left / 1000

    def _switched(self, connected: bool) -> None:
        if not connected:
            for channel in list(self._pending):
                channel.close()

    # -------------------------------------------------------------- definitions

    async def define(self, name: Text, format: Any = None,
                     length: int = IPC_VARIABLE_LENGTH) -> None:
        """Defines a message, as Connection.define()."""
        self.connection.define(name, format, length)
        await self._done()

    async def define_format(self, name: Text, format: Any) -> None:
        """Gives a format a name."""
        self.connection.define_format(name, format)
        await self._done()

    async def publish(self, name: Text, data: Any = None) -> None:
        """Sends data to all who subscribe to the message."""
        self.connection.publish(name, data)
        await self._done()

    async def _done(self) -> None:
        # Every call lets others run, but what has been done is not cancelled any more.
        self._changed()
        await trio.lowlevel.cancel_shielded_checkpoint()

    async def query(self, name: Text, data: Any = None, timeout: Optional[float] = None, *,
                    type: Optional[Type[Any]] = None, numpy: bool = False) -> Any:
        """Asks and waits for the answer; raises IPCTimeout if none comes in timeout seconds.

        An answer that comes after the query was cancelled is forgotten.
        """
        send, receive = trio.open_memory_channel[Any](1)
        question = self.connection.ask(name, data, send.send_nowait, type=type, numpy=numpy)
        self._pending.add(send)
        self._changed()
        try:
            with trio.move_on_after(math.inf if timeout is None else timeout):
                return await receive.receive()
        except trio.EndOfChannel:
            raise last_error(IPC_Not_Connected) from None
        finally:
            question.cancel()
            self._pending.discard(send)
        raise IPCTimeout(f"no answer to {name!r} within {timeout} seconds")

    # ------------------------------------------------------------ subscriptions

    def subscribe(self, *names: Text, type: Optional[Type[Any]] = None, numpy: bool = False,
                  maxsize: int = 0) -> Stream:
        """The messages of these names as they come, for async for."""
        return Stream(self, names, type, numpy, maxsize)

    def _adapted(self, handler: Handler, queries: bool) -> Handler:
        if not inspect.iscoroutinefunction(handler):
            return handler

        async def run(message: Message[Any]) -> None:
            with self.connection._failures():
                await handler(message)

        def start(message: Message[Any]) -> None:
            if queries:
                message.delay()  # the coroutine runs after this handler
            self._nursery.start_soon(run, message)
        return start


class Stream(SubscribedMessages):
    """Messages as they come.  The subscriptions end with the loop, or with close()."""

    def __init__(self, ipc: TrioConnection, names: Tuple[Text, ...], type: Optional[Type[Any]],
                 numpy: bool, maxsize: int) -> None:
        self._send, self._receive = trio.open_memory_channel[Message[Any]](maxsize or math.inf)
        super().__init__(ipc.connection, names, type, numpy)
        ipc._changed()

    def _arrived(self, message: Message[Any]) -> None:
        try:
            self._send.send_nowait(message)
        except trio.WouldBlock:
            self._receive.receive_nowait()
            self.dropped += 1
            self._send.send_nowait(message)

    async def get(self) -> Message[Any]:
        """The next message."""
        return await self._receive.receive()

    async def __aiter__(self) -> AsyncIterator[Message[Any]]:
        try:
            while True:
                yield await self.get()
        finally:
            self.close()


@contextlib.asynccontextmanager
async def connect(name: Text, server: Optional[Text] = None, *,
                  on_handler_error: OnError = "raise",
                  reconnect: Optional[str] = None) -> AsyncIterator[TrioConnection]:
    """A connection to a server, for async with; options as for ipc_cffi.connect()."""
    with await connected(trio.sleep, name, server, on_handler_error=on_handler_error,
                                    reconnect=reconnect) as connection:
        async with trio.open_nursery() as nursery:
            ipc = TrioConnection(connection, nursery)
            nursery.start_soon(ipc._work)
            yield ipc
            nursery.cancel_scope.cancel()
