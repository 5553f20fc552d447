"""Connections as objects: with blocks, decorators, exceptions, iterators.

A thin layer over the functions of the manual.  Errors are exceptions here whatever the verbosity.
"""
from __future__ import annotations

import contextlib
import functools
import os
import time
from collections import deque
from types import TracebackType
from typing import (Any, Callable, Deque, Generic, Iterable, Iterator, List, Optional, Tuple, Type,
                    TypeVar, Union, cast, overload)

from ._ffi import lib
from .arguments import Text
from .constants import (IPC_Error, IPC_Not_Connected, IPC_OK, IPC_RETURN_TYPE, IPC_Timeout,
                        IPC_VARIABLE_LENGTH, IPC_WAIT_FOREVER, TRIGGER_FOREVER)
from .contexts import (Current, IPC_CONTEXT_PTR, IPC_connectModule, IPC_connectModuleNoListen,
                       IPC_disconnect, IPC_getContext, IPC_isConnected, IPCx_tryConnect,
                       has_ended)
from .errors import (BadData, IllegalFormat, IPCError, IPCTimeout, MessageNotDefined,
                     MismatchedFormat, NotConnected, WrongLength, checked, last_error, logger)
from .format import Format
from .formatters import IPC_defineFormat
from .handlers import MSG_INSTANCE
from .hints import format_of
from .library import waits
from .listening import IPC_addTimerGetRef, IPC_removeTimerByRef, TIMER_REF
from .messages import (IPC_defineMsg, IPC_dataLength, IPC_msgInstanceName, Refused, encoded_for,
                       publish_data)
from .queries import IPC_delayResponse, IPC_respondData, Reply, query_data, query_notify
from .reconnect import (IPCX_RECONNECT_FAIL, IPCX_RECONNECT_NEVER, IPCX_RECONNECT_WAIT,
                        IPCx_setReconnect, IPCx_subscribeConnection)
from .subscriptions import IPC_unsubscribe, subscribe
from .waker import Waker

T = TypeVar("T")
R = TypeVar("R")
Function = TypeVar("Function", bound=Callable[..., Any])

#: What a connection does about exceptions in handlers: "raise", "log", or what it calls with them.
OnError = Union[str, Callable[[BaseException], Any]]

#: The level of the module logging, which is not imported for it.
DEBUG = 10

_RECONNECT = {"never": IPCX_RECONNECT_NEVER, "fail": IPCX_RECONNECT_FAIL,
              "wait": IPCX_RECONNECT_WAIT}

#: The errors that are one of what a call is about, and so name it.
_OF_ITS_ARGUMENT = (MessageNotDefined, WrongLength, IllegalFormat, MismatchedFormat, BadData)


def _guarded(otherwise: Any, about: Optional[int] = None) -> Callable[[Function], Function]:
    """Makes a method name the argument of that number in its errors; or, with errors="code", give
    otherwise instead of an exception of its own."""
    def decorate(method: Function) -> Function:
        @functools.wraps(method)
        def call(self: Connection, *arguments: Any, **options: Any) -> Any:
            try:
                return method(self, *arguments, **options)
            except IPCError as error:
                if error.in_handler:
                    raise
                if about is not None and isinstance(error, _OF_ITS_ARGUMENT) and not error.about:
                    error.about = repr((*arguments, *options.values())[about])
                if self._errors == "raise":
                    raise
                lib.IPC_errno = error.errno
                return otherwise
        return cast(Function, call)
    return decorate


def _encoded(name: Text, data: Any) -> Tuple[int, Any]:
    """Data in the format of a message."""
    try:
        return encoded_for(name, data)
    except Refused:
        raise last_error() from None


def _chosen(choice: str, choices: Iterable[str], what: str) -> str:
    """An option that has to be one of several words."""
    if choice not in choices:
        raise ValueError(f"{what} can be {', '.join(map(repr, choices))}, not {choice!r}")
    return choice


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
        if not has_ended(self._connection.context):
            with contextlib.suppress(NotConnected):
                self.cancel()


class Question:
    """A query whose answer is to come, until it is there or cancelled."""

    def __init__(self, reply: Reply) -> None:
        self._reply = reply

    def cancel(self) -> None:
        """The answer will be ignored."""
        self._reply.end()


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
        traffic = logger("ipc.traffic")
        if traffic.isEnabledFor(DEBUG):
            traffic.debug("received %s, %d bytes", message.name, IPC_dataLength(instance))
        with self._connection._failures():
            self._handler(message)


class Connection:
    """A connection to a server under the name of a module."""

    def __init__(self, name: Text, server: Optional[Text] = None, *, listen: bool = True,
                 errors: str = "raise", on_handler_error: OnError = "raise",
                 reconnect: Optional[str] = None, wait: bool = True) -> None:
        self._errors = _chosen(errors, ("raise", "code"), "errors")
        if not callable(on_handler_error):
            _chosen(on_handler_error, ("raise", "log"), "on_handler_error")
        self._on_handler_error = on_handler_error
        if reconnect is not None:
            _chosen(reconnect, _RECONNECT, "reconnect")
        if not (listen or wait):
            raise ValueError("a connection with listen=False waits for the server")
        connect = IPC_connectModule if wait and listen else \
            IPC_connectModuleNoListen if wait else IPCx_tryConnect
        try:
            if checked(connect(name, server)) == IPC_Timeout:
                raise last_error(IPC_Not_Connected)
        except NotConnected as error:
            place = os.fsdecode(server or os.environ.get("CENTRALHOST") or "this host")
            error.about = f"is there a central at {place}?"
            raise
        context = IPC_getContext()
        assert context is not None
        self.name = os.fsdecode(name)
        self.context: IPC_CONTEXT_PTR = context
        self._stopped = False
        self._waker: Optional[Waker] = None
        if reconnect is not None:
            checked(IPCx_setReconnect(_RECONNECT[reconnect]))

    def __repr__(self) -> str:
        return f"<Connection {self.name!r}{', closed' if has_ended(self.context) else ''}>"

    # ------------------------------------------------------------- with blocks

    def __enter__(self) -> Connection:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def close(self) -> None:
        """Ends this connection; others stay."""
        if self._waker is not None:
            self._waker.close()
        if not has_ended(self.context):
            with self._current():
                IPC_disconnect()

    def on_connection(self, handler: Callable[[bool], Any]) -> Callable[[bool], Any]:
        """Has handler called with False when the server is lost, and with True when it is back,
        if the connection is to reconnect; can be a decorator."""
        def changed(connected: bool, client_data: Any) -> None:
            with self._failures():
                handler(connected)
        with self._current():
            checked(IPCx_subscribeConnection(changed))
        return handler

    @property
    def is_connected(self) -> bool:
        """Whether the connection is there."""
        with self._current():
            return IPC_isConnected()

    def _current(self) -> Current:
        """Makes this connection the current one for a while."""
        return Current(self.context.pointer)

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

    @_guarded(IPC_Error, about=1)
    def define(self, name: Text, format: Any = None,
               length: int = IPC_VARIABLE_LENGTH) -> IPC_RETURN_TYPE:
        """Defines a message by a format string, or by a type that a format follows from."""
        if format is not None and not isinstance(format, (str, bytes)):
            format = format_of(format)
        with self._current():
            return checked(IPC_defineMsg(name, length, format))

    @_guarded(IPC_Error, about=0)
    def define_format(self, name: Text, format: Any) -> IPC_RETURN_TYPE:
        """Gives a format a name."""
        text = format if isinstance(format, (str, bytes)) else format_of(format)
        with self._current():
            return checked(IPC_defineFormat(name, text))

    @_guarded(None, about=0)
    def format(self, format: Any) -> Format:
        """A format, by its string or by a type, which may use the named formats of the server."""
        with self._current():
            return Format(format)

    # ---------------------------------------------------------------- messages

    @_guarded(IPC_Error, about=0)
    def publish(self, name: Text, data: Any = None) -> IPC_RETURN_TYPE:
        """Sends data to all who subscribe to the message."""
        traffic = logger("ipc.traffic")
        tell = functools.partial(traffic.debug, "published %s, %d bytes", name) \
            if traffic.isEnabledFor(DEBUG) else None
        with self._current():
            return checked(publish_data(name, data, tell))

    @overload
    def query(self, name: Text, data: Any = ..., timeout: Optional[float] = ..., *,
              type: Type[T], numpy: bool = ...) -> T: ...

    @overload
    def query(self, name: Text, data: Any = ..., timeout: Optional[float] = ..., *,
              type: None = ..., numpy: bool = ...) -> Any: ...

    @_guarded(None, about=0)
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

    @_guarded(None, about=0)
    def ask(self, name: Text, data: Any, handler: Callable[[Any], Any], *,
            type: Optional[Type[Any]] = None, numpy: bool = False) -> Question:
        """Asks, and does not wait: handler is called with the data of the answer."""
        def answered(_instance: MSG_INSTANCE, answer: Any, _client_data: Any) -> None:
            with self._failures():
                handler(answer)
        with self._current():
            length, content = _encoded(name, data)
            reply = query_notify(name, length, content, answered, None, True, type, numpy)
        if reply is None:
            raise last_error()
        return Question(reply)

    @overload
    def subscribe(self, name: Text, handler: Callable[[Message[T]], Any], *,
                  type: Type[T], numpy: bool = ...) -> Subscription: ...

    @overload
    def subscribe(self, name: Text, handler: Callable[[Message[Any]], Any], *,
                  type: None = ..., numpy: bool = ...) -> Subscription: ...

    @overload
    def subscribe(self, name: Text, handler: None = ..., *, type: Type[T], numpy: bool = ...
                  ) -> Callable[[Callable[[Message[T]], R]], Callable[[Message[T]], R]]: ...

    @overload
    def subscribe(self, name: Text, handler: None = ..., *, type: None = ..., numpy: bool = ...
                  ) -> Callable[[Function], Function]: ...

    @_guarded(None, about=0)
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

    @_guarded(IPC_Error, about=0)
    def unsubscribe(self, name: Text,
                    handler: Optional[Callable[..., Any]] = None) -> IPC_RETURN_TYPE:
        """Ends the subscription of a handler, or of all."""
        with self._current():
            return checked(IPC_unsubscribe(
                name, None if handler is None else _Adapter(self, handler)))

    # --------------------------------------------------------------- listening

    @_guarded(False)
    def listen(self, timeout: Optional[float] = None) -> bool:
        """Waits for so many seconds and handles what comes first: whether anything came."""
        return self._listen(milliseconds(timeout)) == IPC_OK

    def _listen(self, timeout: int,
                enough: Optional[Callable[[], bool]] = None) -> IPC_RETURN_TYPE:
        with self._current():
            return checked(IPC_RETURN_TYPE(waits(lib.IPC_listen, timeout, enough=enough)))

    @_guarded(IPC_Error)
    def dispatch(self) -> IPC_RETURN_TYPE:
        """Listens until stop() is called, or the connection has been closed."""
        if self._waker is None:
            self._waker = Waker()
        try:
            while not self._stopped and not has_ended(self.context):
                self._listen(IPC_WAIT_FOREVER, lambda: self._stopped)
        finally:
            self._stopped = False
        return IPC_OK

    def stop(self) -> None:
        """Ends dispatch(), or lets the next one end at once; may be called by handlers, other
        threads and signal handlers."""
        self._stopped = True
        if self._waker is not None:
            self._waker.wake()

    @_guarded(None)
    def every(self, seconds: float, handler: Callable[[], Any]) -> Timer:
        """Has a handler called again and again by listening calls."""
        return self._timer(seconds, TRIGGER_FOREVER, handler)

    @_guarded(None)
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

    @overload
    def messages(self, *names: Text, type: Type[T], timeout: Optional[float] = ...,
                 numpy: bool = ..., queries: bool = ..., maxsize: int = ...) -> Messages[T]: ...

    @overload
    def messages(self, *names: Text, type: None = ..., timeout: Optional[float] = ...,
                 numpy: bool = ..., queries: bool = ..., maxsize: int = ...) -> Messages[Any]: ...

    def messages(self, *names: Text, type: Optional[Type[Any]] = None,
                 timeout: Optional[float] = None, numpy: bool = False, queries: bool = False,
                 maxsize: int = 0) -> Messages[Any]:
        """The messages of these names as they come, until none has come for timeout seconds.

        maxsize limits how many wait here; then the oldest are dropped.  With queries the messages
        are queries that are to be answered by respond().
        """
        return Messages(self, names, type, timeout, numpy, queries, maxsize)


class SubscribedMessages:
    """Messages of several names as they come."""

    def __init__(self, connection: Connection, names: Tuple[Text, ...],
                 type: Optional[Type[Any]], numpy: bool) -> None:
        #: How many messages were dropped because maxsize were waiting.
        self.dropped = 0
        self._subscriptions: List[Subscription] = [
            connection.subscribe(name, self._arrived, type=type, numpy=numpy) for name in names]

    def _arrived(self, message: Message[Any]) -> None:
        raise NotImplementedError

    def close(self) -> None:
        """Ends the subscriptions."""
        subscriptions, self._subscriptions = self._subscriptions, []
        for subscription in subscriptions:
            with subscription:
                pass


class Messages(SubscribedMessages, Generic[T]):
    """An iterator over messages.  Its subscriptions end with the loop, or with close()."""

    def __init__(self, connection: Connection, names: Tuple[Text, ...],
                 type: Optional[Type[Any]], timeout: Optional[float], numpy: bool, queries: bool,
                 maxsize: int) -> None:
        self._connection = connection
        self._timeout = timeout
        self._queries = queries
        self._waiting: Deque[Message[T]] = deque(maxlen=maxsize or None)
        super().__init__(connection, names, type, numpy)

    def _arrived(self, message: Message[T]) -> None:
        if self._queries:
            message.delay()
        if len(self._waiting) == self._waiting.maxlen:
            self.dropped += 1
        self._waiting.append(message)

    def __iter__(self) -> Iterator[Message[T]]:
        """What is used in a for loop: leaving the loop ends the subscriptions."""
        try:
            while True:
                message = self.get()
                if message is None:
                    return
                yield message
        finally:
            self.close()

    def get(self) -> Optional[Message[T]]:
        """The next message, None if none has come in time, or the connection was closed."""
        end = None if self._timeout is None else time.monotonic() + self._timeout
        while not self._waiting:
            left = None if end is None else end - time.monotonic()
            if left is not None and left < 0 or has_ended(self._connection.context):
                return None
            self._connection.listen(left)
        return self._waiting.popleft()

    def __enter__(self) -> Messages[T]:
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()


def connect(name: Text, server: Optional[Text] = None, *, listen: bool = True,
            errors: str = "raise", on_handler_error: OnError = "raise",
            reconnect: Optional[str] = None, wait: bool = True) -> Connection:
    """Connects to a server, by default the one of CENTRALHOST; to be used in a with statement.

    errors            "raise", or "code": failures other than of connect() give codes or None
    on_handler_error  "raise", "log", or what is called with the exceptions of handlers
    reconnect         after the loss of the server: "never"; "fail": calls fail until it is back;
                      "wait": they wait; by default what the variable IPC_RECONNECT says
    wait              whether to wait for the server, for five seconds; else it fails at once
    """
    return Connection(name, server, listen=listen, errors=errors, wait=wait,
                      on_handler_error=on_handler_error, reconnect=reconnect)
