"""IPC in programs that use asyncio.

    async with ipc_cffi.aio.connect("name") as ipc:
        await ipc.publish("message", data)
        answer = await ipc.query("query", data, timeout=2)
        async for message in ipc.subscribe("message"):
            ...

The event loop waits for one descriptor of the library, and for the time of its next timer; when
something is there, the library handles it in the loop's thread.  There is no thread besides and
nothing is asked again and again.  Handlers may be coroutine functions.
"""
from __future__ import annotations

import asyncio
import functools
import inspect
import weakref
from types import TracebackType
from typing import Any, AsyncIterator, Dict, List, Optional, Set, Tuple, Type

from ._ffi import lib
from .arguments import Text
from .connection import Connection, Message, OnError, SubscribedMessages
from .constants import IPC_Not_Connected, IPC_VARIABLE_LENGTH
from .contexts import has_ended
from .coroutines import CoroutineConnection, Handler, connected
from .errors import IPCTimeout, NotConnected, last_error
from .library import waits


# ---------------------------------------------------------------- the event loop

class _Pump:
    """Lets the library work when a loop says that it has something to do."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._users: List[AsyncConnection] = []
        self._timer: Optional[asyncio.TimerHandle] = None
        self._descriptor = -1

    def add(self, user: AsyncConnection) -> None:
        if not self._users:
            self._descriptor = lib.IPCx_fd()
            if self._descriptor < 0:
                raise RuntimeError("this system has no descriptor that asyncio could wait for")
            self._loop.add_reader(self._descriptor, self.work)
        self._users.append(user)
        self.set_timer()

    def remove(self, user: AsyncConnection) -> None:
        if user in self._users:
            self._users.remove(user)
        if not self._users and self._descriptor >= 0:
            self._loop.remove_reader(self._descriptor)
            self._descriptor = -1
            self._cancel_timer()

    def work(self) -> None:
        """Handles everything that is there now."""
        try:
            waits(lib.IPCx_process)
        except BaseException as failure:
            if not isinstance(failure, Exception):
                raise
            self._tell(failure)
        finally:
            for user in list(self._users):
                user._look()
            self.set_timer()

    def _tell(self, failure: Exception) -> None:
        """What no handler has caught goes to the loop's exception handler."""
        if not isinstance(failure, NotConnected):
            self._loop.call_exception_handler(
                {"message": "an exception in a handler of IPC", "exception": failure})

    def set_timer(self) -> None:
        """Comes back when the library's next timer is due; after calls that may have changed it."""
        self._cancel_timer()
        left = lib.IPCx_nextTimeout() if self._users else -1
        if left >= 0:
            self._timer = self._loop.call_later(left / 1000, self.work)

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


_pumps: weakref.WeakKeyDictionary[asyncio.AbstractEventLoop, _Pump] = weakref.WeakKeyDictionary()


def _pump() -> _Pump:
    loop = asyncio.get_running_loop()
    if loop not in _pumps:
        _pumps[loop] = _Pump(loop)
    return _pumps[loop]


# ------------------------------------------------------------------ connections

class AsyncConnection(CoroutineConnection):
    """A connection of a program that uses asyncio."""

    def __init__(self, name: Text, server: Optional[Text] = None, *,
                 on_handler_error: OnError = "raise", reconnect: Optional[str] = None) -> None:
        self._connect = functools.partial(
            connected, asyncio.sleep, name, server, on_handler_error=on_handler_error,
            reconnect=reconnect)
        self._connection: Optional[Connection] = None
        self._pump: Optional[_Pump] = None
        self._pending: Set[asyncio.Future[Any]] = set()
        self._streams: weakref.WeakSet[Stream] = weakref.WeakSet()
        self._tasks: Dict[asyncio.Task[Any], None] = {}

    async def __aenter__(self) -> AsyncConnection:
        self._connection = await self._connect()
        self._connection.on_connection(self._switched)
        self._pump = _pump()
        self._pump.add(self)
        return self

    async def __aexit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                        trace: Optional[TracebackType]) -> None:
        await self.close()

    async def close(self) -> None:
        """Ends the connection, and with it what waits for it."""
        if self._pump is not None:
            self._pump.remove(self)
            self._pump.set_timer()
        if self._connection is not None:
            self._connection.close()
        self._end_waits()

    @property
    def connection(self) -> Connection:
        """The connection beneath."""
        if self._connection is None:
            raise RuntimeError("the connection is used before its async with block")
        return self._connection

    def _look(self) -> None:
        """Ends what waits for a connection that has gone."""
        if self._connection is None or has_ended(self._connection.context):
            self._end_waits()

    def _switched(self, connected: bool) -> None:
        if not connected:
            self._end_queries()

    def _end_queries(self) -> None:
        for future in self._pending:
            if not future.done():
                future.set_exception(last_error(IPC_Not_Connected))

    def _end_waits(self) -> None:
        self._end_queries()
        for stream in list(self._streams):
            stream._end()

    def _changed(self) -> None:
        if self._pump is not None:
            self._pump.set_timer()

    # -------------------------------------------------------------- definitions

    async def define(self, name: Text, format: Any = None,
                     length: int = IPC_VARIABLE_LENGTH) -> None:
        """Defines a message, as Connection.define()."""
        self.connection.define(name, format, length)
        self._changed()

    async def define_format(self, name: Text, format: Any) -> None:
        """Gives a format a name."""
        self.connection.define_format(name, format)
        self._changed()

    async def publish(self, name: Text, data: Any = None) -> None:
        """Sends data to all who subscribe to the message."""
        self.connection.publish(name, data)
        self._changed()

    async def query(self, name: Text, data: Any = None, timeout: Optional[float] = None, *,
                    type: Optional[Type[Any]] = None, numpy: bool = False) -> Any:
        """Asks and waits for the answer; raises IPCTimeout if none comes in timeout seconds.

        An answer that comes after the query was cancelled is forgotten.
        """
        future: asyncio.Future[Any] = asyncio.get_running_loop().create_future()

        def answered(answer: Any) -> None:
            if not future.done():
                future.set_result(answer)
        question = self.connection.ask(name, data, answered, type=type, numpy=numpy)
        self._pending.add(future)
        self._changed()
        try:
            return await asyncio.wait_for(future, timeout)
        except asyncio.TimeoutError:
            raise IPCTimeout(f"no answer to {name!r} within {timeout} seconds") from None
        finally:
            question.cancel()
            self._pending.discard(future)

    # ------------------------------------------------------------ subscriptions

    def subscribe(self, *names: Text, type: Optional[Type[Any]] = None, numpy: bool = False,
                  maxsize: int = 0) -> Stream:
        """The messages of these names as they come, for async for."""
        return Stream(self, names, type, numpy, maxsize)

    def _adapted(self, handler: Handler, queries: bool) -> Handler:
        if not inspect.iscoroutinefunction(handler):
            return handler

        def start(message: Message[Any]) -> None:
            if queries:
                message.delay()  # the coroutine runs after this handler
            task = asyncio.get_running_loop().create_task(self._run(handler, message))
            self._tasks[task] = None  # the loop itself keeps weak references only
            task.add_done_callback(lambda done: self._tasks.pop(done, None))
        return start

    async def _run(self, handler: Handler, message: Message[Any]) -> None:
        try:
            with self.connection._failures():
                await handler(message)
        except Exception as failure:
            asyncio.get_running_loop().call_exception_handler(
                {"message": "an exception in a handler of IPC", "exception": failure})


class Stream(SubscribedMessages):
    """Messages as they come.  The subscriptions end with the loop, or with close()."""

    def __init__(self, connection: AsyncConnection, names: Tuple[Text, ...],
                 type: Optional[Type[Any]], numpy: bool, maxsize: int) -> None:
        self._queue: asyncio.Queue[Optional[Message[Any]]] = asyncio.Queue()
        self._maxsize = maxsize
        super().__init__(connection.connection, names, type, numpy)
        connection._streams.add(self)
        connection._changed()

    def _arrived(self, message: Message[Any]) -> None:
        if self._maxsize and self._queue.qsize() >= self._maxsize:
            self._queue.get_nowait()
            self.dropped += 1
        self._queue.put_nowait(message)

    def _end(self) -> None:
        self._queue.put_nowait(None)

    async def get(self) -> Optional[Message[Any]]:
        """The next message, None after the end of the connection."""
        return await self._queue.get()

    async def __aiter__(self) -> AsyncIterator[Message[Any]]:
        try:
            while True:
                message = await self.get()
                if message is None:
                    return
                yield message
        finally:
            self.close()


def connect(name: Text, server: Optional[Text] = None, *,
            on_handler_error: OnError = "raise",
            reconnect: Optional[str] = None) -> AsyncConnection:
    """A connection to a server, for async with; options as for ipc_cffi.connect()."""
    return AsyncConnection(name, server, on_handler_error=on_handler_error, reconnect=reconnect)
