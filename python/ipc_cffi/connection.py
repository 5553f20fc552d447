"""Connections as objects: with blocks, decorators, exceptions, iterators.

A thin layer over the functions of the manual.  Errors are exceptions here whatever the verbosity.
"""
from __future__ import annotations

import contextlib
import time
from collections import deque
from types import TracebackType
from typing import (Any, Callable, Deque, Generic, Iterator, List, Optional, Tuple, Type,
                    TypeVar, Union, overload)

from ._ffi import ffi, lib
from .constants import (IPC_Error, IPC_OK, IPC_RETURN_TYPE, IPC_Timeout, IPC_VARIABLE_LENGTH,
                        IPC_WAIT_FOREVER, TRIGGER_FOREVER)
from .contexts import (IPC_CONTEXT_PTR, IPC_connectModule, IPC_connectModuleNoListen,
                       IPC_disconnect, IPC_getContext, IPC_isConnected)
from .errors import IPCTimeout, last_error, logger
from .formatters import IPC_defineFormat
from .handlers import MSG_INSTANCE
from .hints import format_of
from .library import Text, waits
from .listening import IPC_addTimerGetRef, IPC_removeTimerByRef, TIMER_REF
from .messages import IPC_defineMsg, IPC_msgInstanceName, IPC_publishData
from .queries import IPC_delayResponse, IPC_respondData, query_data
from .subscriptions import IPC_unsubscribe, subscribe

T = TypeVar("T")
Function = TypeVar("Function", bound=Callable[..., Any])

#: What a connection does about exceptions in handlers: "raise", "log", or what it calls with them.
OnError = Union[str, Callable[[BaseException], Any]]


def checked(result: IPC_RETURN_TYPE) -> IPC_RETURN_TYPE:
    """The result of a function of the manual; an error is an exception."""
    if result == IPC_Error:
        raise last_error()
    return result


def milliseconds(seconds: Optional[float]) -> int:
    """A time limit as the library gets it."""
    if seconds is None:
        return IPC_WAIT_FOREVER
    return min(max(0, int(-(-seconds * 1000 // 1))), IPC_WAIT_FOREVER - 1)


class Message(Generic[T]):
    """A message that has arrived."""

    __slots__ = ("name", "data", "instance", "context")

    def __init__(self, instance: MSG_INSTANCE, data: T) -> None:
        self.name: str = IPC_msgInstanceName(instance) or ""
        self.data = data
        self.instance = instance
        self.context = IPC_getContext()

    def respond(self, name: Text, data: Any = None) -> None:
        """Answers a query, in its handler or, after delay(), later."""
        checked(IPC_respondData(self.instance, name, data))

    def delay(self) -> None:
        """Lets the answer be given after the handler."""
        checked(IPC_delayResponse(self.instance))

    def __repr__(self) -> str:
        return f"<Message {self.name}: {self.data!r}>"


class Subscription:
    """A subscription, until it is cancelled or its with block ends."""

    def __init__(self, connection: Connection, name: Text, handler: Callable[..., Any]) -> None:
        self._connection = connection
        self.name = name
        self.handler = handler

    def cancel(self) -> None:
        """Ends the subscription."""
        self._connection.unsubscribe(self.name, self.handler)

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        if self._connection.is_connected:
            self.cancel()


class Timer:
    """Calls a handler from time to time, until it is cancelled."""

    def __init__(self, reference: TIMER_REF) -> None:
        self._reference: Optional[TIMER_REF] = reference

    def cancel(self) -> None:
        """No more calls."""
        reference, self._reference = self._reference, None
        if reference is not None and not reference.timer.has_ended:
            IPC_removeTimerByRef(reference)


class _Adapter:
    """The handler that the library knows, for one that takes a Message."""

    def __init__(self, connection: Connection, handler: Callable[[Message[Any]], Any]) -> None:
        self._connection = connection
        self._handler = handler
        self.__qualname__ = str(getattr(handler, "__qualname__", type(handler).__name__))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Adapter) and self._handler == other._handler

    def __hash__(self) -> int:
        return hash(self._handler)

    def __call__(self, instance: MSG_INSTANCE, data: Any, client_data: Any) -> None:
        message = Message(instance, data)
        logger("ipc.traffic").debug("received %s", message.name)
        with self._connection._failures():
            self._handler(message)


class Connection:
    """A connection to a server under the name of a module."""

    def __init__(self, name: Text, server: Optional[Text] = None, *, listen: bool = True,
                 on_handler_error: OnError = "raise") -> None:
        connect = IPC_connectModule if listen else IPC_connectModuleNoListen
        checked(connect(name, server))
        context = IPC_getContext()
        assert context is not None
        self.context: IPC_CONTEXT_PTR = context
        self._stopped = False
        self._on_handler_error = on_handler_error

    # ------------------------------------------------------------- with blocks

    def __enter__(self) -> Connection:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def close(self) -> None:
        """Ends this connection; others stay."""
        with self._current():
            IPC_disconnect()

    @property
    def is_connected(self) -> bool:
        """Whether the connection is there."""
        with self._current():
            return IPC_isConnected()

    @contextlib.contextmanager
    def _current(self) -> Iterator[None]:
        """Makes this connection the current one for a while."""
        before = lib.IPC_getContext()
        if before == self.context.pointer:
            yield
            return
        lib.IPC_setContext(self.context.pointer)
        try:
            yield
        finally:
            if before != ffi.NULL:
                lib.IPC_setContext(before)

    @contextlib.contextmanager
    def _failures(self) -> Iterator[None]:
        """Treats exceptions of a handler as the connection was told to."""
        try:
            yield
        except Exception as failure:
            if self._on_handler_error == "raise":
                raise
            if callable(self._on_handler_error):
                self._on_handler_error(failure)
            else:
                import logging
                logging.getLogger("ipc.handlers").exception("a handler has failed")

    # ------------------------------------------------------------- definitions

    def define(self, name: Text, format: Any = None, length: int = IPC_VARIABLE_LENGTH) -> None:
        """Defines a message by a format string, or by a type that a format follows from."""
        if format is not None and not isinstance(format, (str, bytes)):
            format = format_of(format)
        with self._current():
            checked(IPC_defineMsg(name, length, format))

    def define_format(self, name: Text, format: Any) -> None:
        """Gives a format a name."""
        text = format if isinstance(format, (str, bytes)) else format_of(format)
        with self._current():
            checked(IPC_defineFormat(name, text))

    # ---------------------------------------------------------------- messages

    def publish(self, name: Text, data: Any = None) -> None:
        """Sends data to all who subscribe to the message."""
        with self._current():
            checked(IPC_publishData(name, data))
        logger("ipc.traffic").debug("published %s", name)

    @overload
    def query(self, name: Text, data: Any = ..., timeout: Optional[float] = ..., *,
              type: Type[T], numpy: bool = ...) -> T: ...

    @overload
    def query(self, name: Text, data: Any = ..., timeout: Optional[float] = ..., *,
              type: None = ..., numpy: bool = ...) -> Any: ...

    def query(self, name: Text, data: Any = None, timeout: Optional[float] = None, *,
              type: Optional[Type[Any]] = None, numpy: bool = False) -> Any:
        """Asks, and waits for the answer, for that many seconds; handlers run meanwhile.

        Raises IPCTimeout if none comes.
        """
        with self._current():
            answer, result = query_data(name, data, milliseconds(timeout), type, numpy)
            if checked(result) == IPC_Timeout:
                raise IPCTimeout(f"no answer to {name!r} within {timeout} seconds")
            return answer

    @overload
    def subscribe(self, name: Text, handler: Callable[[Message[Any]], Any], *,
                  type: Optional[Type[Any]] = ..., numpy: bool = ...) -> Subscription: ...

    @overload
    def subscribe(self, name: Text, handler: None = ..., *, type: Optional[Type[Any]] = ...,
                  numpy: bool = ...) -> Callable[[Function], Function]: ...

    def subscribe(self, name: Text, handler: Optional[Callable[[Message[Any]], Any]] = None, *,
                  type: Optional[Type[Any]] = None, numpy: bool = False) -> Any:
        """Has handler called with each message of that name; without handler a decorator."""
        if handler is None:
            def decorate(function: Function) -> Function:
                self.subscribe(name, function, type=type, numpy=numpy)
                return function
            return decorate
        with self._current():
            checked(subscribe(name, _Adapter(self, handler), None, True, type, numpy))
        return Subscription(self, name, handler)

    def unsubscribe(self, name: Text, handler: Optional[Callable[..., Any]] = None) -> None:
        """Ends the subscription of a handler, or of all."""
        with self._current():
            checked(IPC_unsubscribe(name, None if handler is None else _Adapter(self, handler)))

    # --------------------------------------------------------------- listening

    def listen(self, timeout: Optional[float] = None) -> bool:
        """Waits for so many seconds and handles what comes first: whether anything came."""
        return self._listen(milliseconds(timeout)) == IPC_OK

    def _listen(self, timeout: int,
                enough: Optional[Callable[[], bool]] = None) -> IPC_RETURN_TYPE:
        with self._current():
            return checked(IPC_RETURN_TYPE(waits(lib.IPC_listen, timeout, enough=enough)))

    def dispatch(self) -> None:
        """Listens until stop() is called, or the connection has been closed."""
        self._stopped = False
        while not self._stopped and self.is_connected:
            self._listen(IPC_WAIT_FOREVER, lambda: self._stopped)

    def stop(self) -> None:
        """Ends dispatch(); may be called by handlers, other threads and signal handlers."""
        self._stopped = True

    def every(self, seconds: float, handler: Callable[[], Any]) -> Timer:
        """Has a handler called again and again by listening calls."""
        return self._timer(seconds, TRIGGER_FOREVER, handler)

    def after(self, seconds: float, handler: Callable[[], Any]) -> Timer:
        """Has a handler called once."""
        return self._timer(seconds, 1, handler)

    def _timer(self, seconds: float, count: int, handler: Callable[[], Any]) -> Timer:
        def call(*_: Any) -> None:
            with self._failures():
                handler()
        reference, result = IPC_addTimerGetRef(seconds * 1000, count, call)
        checked(result)
        assert reference is not None
        return Timer(reference)

    def messages(self, *names: Text, type: Optional[Type[Any]] = None,
                 timeout: Optional[float] = None, numpy: bool = False, queries: bool = False,
                 maxsize: int = 0) -> Messages:
        """The messages of these names as they come, until none has come for timeout seconds.

        maxsize limits how many wait here; then the oldest are dropped.  With queries the messages
        are queries that are to be answered by respond().
        """
        return Messages(self, names, type, timeout, numpy, queries, maxsize)


class Messages:
    """An iterator over messages.  Its subscriptions end with the loop, or with close()."""

    def __init__(self, connection: Connection, names: Tuple[Text, ...],
                 type: Optional[Type[Any]], timeout: Optional[float], numpy: bool, queries: bool,
                 maxsize: int) -> None:
        self._connection = connection
        self._timeout = timeout
        self._queries = queries
        self._waiting: Deque[Message[Any]] = deque(maxlen=maxsize or None)
        #: How many messages were dropped because maxsize were waiting.
        self.dropped = 0
        self._subscriptions: List[Subscription] = []
        for name in names:
            self._subscriptions.append(
                connection.subscribe(name, self._arrived, type=type, numpy=numpy))

    def _arrived(self, message: Message[Any]) -> None:
        if self._queries:
            message.delay()
        if len(self._waiting) == self._waiting.maxlen:
            self.dropped += 1
        self._waiting.append(message)

    def __iter__(self) -> Iterator[Message[Any]]:
        """What is used in a for loop: leaving the loop ends the subscriptions."""
        try:
            while True:
                message = self.get()
                if message is None:
                    return
                yield message
        finally:
            self.close()

    def get(self) -> Optional[Message[Any]]:
        """The next message, None if none has come in time, or the connection was closed."""
        end = None if self._timeout is None else time.monotonic() + self._timeout
        while not self._waiting:
            left = None if end is None else end - time.monotonic()
            if left is not None and left < 0 or not self._connection.is_connected:
                return None
            self._connection.listen(left)
        return self._waiting.popleft()

    def close(self) -> None:
        """Ends the subscriptions."""
        subscriptions, self._subscriptions = self._subscriptions, []
        for subscription in subscriptions:
            with subscription:
                pass

    def __enter__(self) -> Messages:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()


def connect(name: Text, server: Optional[Text] = None, *, listen: bool = True,
            on_handler_error: OnError = "raise") -> Connection:
    """Connects to a server, by default the one of CENTRALHOST; to be used in a with statement."""
    return Connection(name, server, listen=listen, on_handler_error=on_handler_error)

