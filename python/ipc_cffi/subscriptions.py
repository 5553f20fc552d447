"""Subscriptions [manual 4.26 to 4.28, 4.42 to 4.48]."""
from __future__ import annotations

from typing import Any, Callable, Optional, Tuple, Type, TypeVar, overload

from ._ffi import ffi, lib
from .arguments import Text, text_argument, to_bytes, to_text
from .bytearrays import BYTE_ARRAY
from .constants import IPC_Error, IPC_Null_Argument, IPC_OK, IPC_RETURN_TYPE
from .errors import fail, raise_error, warn
from .formatters import decode, formatter_at
from .handlers import (MSG_INSTANCE, Handler, Registration, Table, check_handler, current_context,
                       handler_name, run)
from .library import listen, waits
from .values import BadBytes, Content


T = TypeVar("T")
C = TypeVar("C")


def byte_array(content: Content, order: str) -> Optional[BYTE_ARRAY]:
    """Received bytes as handlers get them, None for none."""
    if not content:
        return None
    array = BYTE_ARRAY(content)
    array.order = order
    return array


def received(formatter: Any, content: Content, order: str, cls: Optional[type],
             numpy: bool = False) -> Any:
    """Received bytes as data; without a format they stay bytes.  Raises BadBytes."""
    known = formatter_at(formatter)
    if known is None:
        return byte_array(content, order)
    return decode(known, content, order, cls, numpy)


class Arrival(Registration):
    """Calls a handler with a message, as bytes or as data."""

    def __init__(self, context: int, handler: Handler, clientData: Any, decoded: bool,
                 cls: Optional[type], numpy: bool = False) -> None:
        super().__init__(context)
        self.handler = handler
        self.wire_name = b""
        self.use(clientData, decoded, cls, numpy)

    def use(self, clientData: Any, decoded: bool, cls: Optional[type], numpy: bool) -> None:
        self.client_data, self.decoded, self.cls, self.numpy = clientData, decoded, cls, numpy

    def arrived(self, instance: MSG_INSTANCE, content: Content, order: str) -> None:
        if not self.decoded:
            self.handler(instance, byte_array(content, order), self.client_data)
            return
        try:
            data = received(lib.IPC_msgInstanceFormatter(instance.pointer), content, order,
                            self.cls, self.numpy)
        except BadBytes:
            name = to_text(lib.IPC_msgInstanceName(instance.pointer))
            warn(f"WARNING: Message '{name}' could not be decoded")
            return
        self.handler(instance, data, self.client_data)


# -------------------------------------------------------------------- messages

_subscriptions: Table[Arrival] = Table()


def _key(msgName: Optional[Text]) -> Tuple[int, bytes]:
    return current_context(), (to_bytes(msgName) or b"").lower()


def _wire_name(msgName: Optional[Text], handler: Handler, number: int) -> bytes:
    """What the server knows the handler by: readable, and unique in this process."""
    message = (to_bytes(msgName) or b"").decode("ascii", "replace")
    tail = f"_{number}"
    text = f"{message}_{handler_name(handler)}"[:120 - len(tail)] + tail
    return "".join(c if " " < c < "\x7f" else "?" for c in text).encode()


def subscribe(msgName: Text, handler: Any, clientData: Any, decoded: bool,
              cls: Optional[type], numpy: bool = False) -> IPC_RETURN_TYPE:
    """Subscribes a handler of bytes or of data, or changes what it is called with."""
    if handler is None:
        return fail(IPC_Null_Argument)
    check_handler(handler)
    key = _key(msgName)
    known = _subscriptions.find(key, handler)
    if known is not None:
        if known.client_data is not clientData:
            warn(f"Resetting client data for handler {handler_name(handler)}")
        known.use(clientData, decoded, cls, numpy)
        return IPC_OK
    arrival = Arrival(key[0], handler, clientData, decoded, cls, numpy)
    arrival.wire_name = _wire_name(msgName, handler, arrival.number)
    _subscriptions.add(key, arrival)
    result = IPC_Error
    try:
        result = listen(lib.glue_subscribe, text_argument(msgName), arrival.wire_name,
                        arrival.number)
    finally:
        if result != IPC_OK:
            _subscriptions.remove(key, arrival)
    return result


def IPC_subscribe(msgName: Text, handler: Callable[[MSG_INSTANCE, Optional[BYTE_ARRAY], Any], Any],
                  clientData: Any = None) -> IPC_RETURN_TYPE:
    """Has handler called with the bytes of each instance of the message."""
    return subscribe(msgName, handler, clientData, False, None)


@overload
def IPC_subscribeData(msgName: Text, handler: Callable[[MSG_INSTANCE, T, C], Any],
                      clientData: C, dataClass: Type[T]) -> IPC_RETURN_TYPE: ...


@overload
def IPC_subscribeData(msgName: Text, handler: Callable[[MSG_INSTANCE, T, Any], Any],
                      *, dataClass: Type[T]) -> IPC_RETURN_TYPE: ...


@overload
def IPC_subscribeData(msgName: Text, handler: Callable[[MSG_INSTANCE, Any, C], Any],
                      clientData: C = ..., dataClass: None = ...) -> IPC_RETURN_TYPE: ...


def IPC_subscribeData(msgName: Text, handler: Callable[[MSG_INSTANCE, Any, Any], Any],
                      clientData: Any = None,
                      dataClass: Optional[type] = None) -> IPC_RETURN_TYPE:
    """Has handler called with the data of each instance, structures as dataClass."""
    return subscribe(msgName, handler, clientData, True, dataClass)


def IPC_unsubscribe(msgName: Text, handler: Optional[Handler]) -> IPC_RETURN_TYPE:
    """Ends the subscription of handler to the message, with None those of all handlers."""
    key = _key(msgName)
    if handler is None:
        for arrival in _subscriptions.of(key):
            _subscriptions.remove(key, arrival)
        return listen(lib.IPC_unsubscribe, text_argument(msgName), ffi.NULL)
    known = _subscriptions.find(key, handler)
    wire_name = known.wire_name if known is not None else b"none"
    if known is not None:
        _subscriptions.remove(key, known)
    return listen(lib.glue_unsubscribe, text_argument(msgName), wire_name)


# --------------------------------------------------------- comings and goings

class Watcher(Registration):
    """One handler of modules or subscriptions."""

    def __init__(self, context: int, handler: Handler, clientData: Any) -> None:
        super().__init__(context)
        self.handler = handler
        self.client_data = clientData


class Watch(Registration):
    """What the library calls in a context, for all handlers of a table that have the key."""

    def __init__(self, context: int, key: Any, table: Table[Watcher]) -> None:
        super().__init__(context)
        self.handler: Handler = run
        self._key = key
        self._table = table

    def happened(self, *arguments: Any) -> None:
        for watcher in self._table.of(self._key):
            run(watcher.handler, *arguments, watcher.client_data)


class Watching:
    """All handlers of one kind of events."""

    def __init__(self, switch: Callable[..., int], kind: str) -> None:
        self._switch = switch  # tells the library: key's arguments, on, number
        self._kind = kind
        self._watchers: Table[Watcher] = Table()
        self._watches: Table[Watch] = Table()

    def subscribe(self, key: Any, arguments: Tuple[Any, ...], handler: Any,
                  clientData: Any) -> IPC_RETURN_TYPE:
        if handler is None:
            return fail(IPC_Null_Argument)
        check_handler(handler)
        known = self._watchers.find(key, handler)
        if known is not None:
            known.client_data = clientData
            return IPC_OK
        watch = self._watches.of(key)
        if not watch:
            watch = [Watch(key[0], key, self._watchers)]
            result = IPC_Error
            try:
                result = listen(self._switch, *arguments, 1, watch[0].number)
            finally:
                if result != IPC_OK:
                    watch[0].end()
            if result != IPC_OK:
                return result
            self._watches.add(key, watch[0])
        self._watchers.add(key, Watcher(key[0], handler, clientData))
        return IPC_OK

    def unsubscribe(self, key: Any, arguments: Tuple[Any, ...], handler: Any) -> IPC_RETURN_TYPE:
        known = self._watchers.find(key, handler)
        if known is None:
            warn(f"No {self._kind} handler {handler_name(handler)} is subscribed")
            return IPC_OK
        self._watchers.remove(key, known)
        if self._watchers.of(key):
            return IPC_OK
        for watch in self._watches.of(key):
            self._watches.remove(key, watch)
        return listen(self._switch, *arguments, 0, 0)


_connects = Watching(lib.glue_watch_connect, "connect")
_disconnects = Watching(lib.glue_watch_disconnect, "disconnect")
_changes = Watching(lib.glue_watch_change, "change")


def IPC_subscribeConnect(connectHandler: Callable[[str, Any], Any],
                         clientData: Any = None) -> IPC_RETURN_TYPE:
    """Has a handler called when a module connects to the server."""
    return _connects.subscribe(_key(None), (), connectHandler, clientData)


def IPC_unsubscribeConnect(connectHandler: Handler) -> IPC_RETURN_TYPE:
    """Ends what IPC_subscribeConnect began."""
    return _connects.unsubscribe(_key(None), (), connectHandler)


def IPC_subscribeDisconnect(disconnectHandler: Callable[[str, Any], Any],
                            clientData: Any = None) -> IPC_RETURN_TYPE:
    """Has a handler called when a module disconnects."""
    return _disconnects.subscribe(_key(None), (), disconnectHandler, clientData)


def IPC_unsubscribeDisconnect(disconnectHandler: Handler) -> IPC_RETURN_TYPE:
    """Ends what IPC_subscribeDisconnect began."""
    return _disconnects.unsubscribe(_key(None), (), disconnectHandler)


def IPC_subscribeHandlerChange(msgName: Text, changeHandler: Callable[[str, int, Any], Any],
                               clientData: Any = None) -> IPC_RETURN_TYPE:
    """Has a handler called when a subscription to the message begins or ends."""
    return _changes.subscribe(_key(msgName), (text_argument(msgName),), changeHandler, clientData)


def IPC_unsubscribeHandlerChange(msgName: Text, changeHandler: Handler) -> IPC_RETURN_TYPE:
    """Ends what IPC_subscribeHandlerChange began."""
    return _changes.unsubscribe(_key(msgName), (text_argument(msgName),), changeHandler)


def IPC_numHandlers(msgName: Text) -> int:
    """The number of subscriptions to a message, of all modules."""
    count = waits(lib.IPC_numHandlers, text_argument(msgName))
    if count < 0:
        raise_error()
    return count


__all__ = ["IPC_subscribe", "IPC_subscribeData", "IPC_unsubscribe", "IPC_subscribeConnect",
           "IPC_unsubscribeConnect", "IPC_subscribeDisconnect", "IPC_unsubscribeDisconnect",
           "IPC_subscribeHandlerChange", "IPC_unsubscribeHandlerChange", "IPC_numHandlers"]
