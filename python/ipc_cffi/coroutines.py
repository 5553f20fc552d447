"""What connections of asyncio and of trio have in common."""
from __future__ import annotations

import contextlib
from typing import Any, Awaitable, Callable, Optional, Type

from .arguments import Text
from .connection import Connection, Message, Timer
from .errors import NotConnected

Handler = Callable[[Message[Any]], Any]

#: How often a server is looked for, and the seconds between: as the library does it by itself.
TRIES = 5
PAUSE = 1.0


async def connected(sleep: Callable[[float], Awaitable[Any]], name: Text, server: Optional[Text],
                    **options: Any) -> Connection:
    """A connection, as of ipc_cffi.connect(); while there is no server, others run in the sleep."""
    for _ in range(TRIES - 1):
        with contextlib.suppress(NotConnected):
            return Connection(name, server, wait=False, **options)
        await sleep(PAUSE)
    return Connection(name, server, wait=False, **options)


class CoroutineConnection:
    """Has functions and coroutine functions called."""

    @property
    def connection(self) -> Connection:
        """The connection beneath."""
        raise NotImplementedError

    def _changed(self) -> None:
        """The library's next timer may be another one now."""
        raise NotImplementedError

    def _adapted(self, handler: Handler, queries: bool) -> Handler:
        """A plain handler that starts one that may be a coroutine function."""
        raise NotImplementedError

    def on(self, name: Text, handler: Optional[Handler] = None, *,
           type: Optional[Type[Any]] = None, numpy: bool = False,
           queries: bool = False) -> Any:
        """Has a function or coroutine function called with each message; also a decorator.

        With queries the messages are queries, which a coroutine may answer whenever it likes.
        """
        if handler is None:
            def decorate(function: Handler) -> Handler:
                self.on(name, function, type=type, numpy=numpy, queries=queries)
                return function
            return decorate
        subscription = self.connection.subscribe(name, self._adapted(handler, queries), type=type,
                                                 numpy=numpy)
        self._changed()
        return subscription

    def every(self, seconds: float, handler: Callable[[], Any]) -> Timer:
        """Has a function called again and again."""
        timer = self.connection.every(seconds, handler)
        self._changed()
        return timer
