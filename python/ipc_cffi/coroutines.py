"""What connections of asyncio and of trio have in common."""
from __future__ import annotations

from typing import Any, Callable, Optional, Type

from .arguments import Text
from .connection import Connection, Message, Timer

Handler = Callable[[Message[Any]], Any]


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
