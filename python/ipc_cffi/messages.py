"""Defining and publishing messages, and what can be asked of an instance
[manual 4.20 to 4.25, 4.37 to 4.41, 6.12]."""
from __future__ import annotations

from typing import Any, Callable, Dict, Optional, Tuple

from ._ffi import ffi, lib
from .arguments import Text, number_argument, text_argument, to_text
from .bytearrays import IPC_VARCONTENT_TYPE, bytes_argument
from .constants import (IPC_Error, IPC_FIXED_LENGTH, IPC_No_Error, IPC_Null_Argument, IPC_OK,
                        IPC_RETURN_TYPE, IPC_VARIABLE_LENGTH)
from .errors import fail, raise_error, result
from .formatters import FORMATTER_PTR, IPC_msgFormatter, ask_for_formatter, encoder
from .handlers import MSG_INSTANCE
from .library import listen, send, waits, waits_with
from .values import Encoded


def instance_argument(msgInstance: Any) -> Any:
    """An instance as the library gets it."""
    if msgInstance is None:
        return ffi.NULL
    if not isinstance(msgInstance, MSG_INSTANCE):
        raise TypeError(f"a message instance is needed, not {type(msgInstance).__name__}")
    return msgInstance.pointer


# ------------------------------------------------------------------ definitions

def IPC_defineMsg(msgName: Text, length: int, formatString: Optional[Text]) -> IPC_RETURN_TYPE:
    """Defines a message."""
    return listen(lib.IPC_defineMsg, text_argument(msgName), number_argument(length, "length"),
                  text_argument(formatString, "a format string"))


def IPC_isMsgDefined(msgName: Text) -> bool:
    """Whether some module has defined the message."""
    lib.IPC_errno = 0
    found = waits(lib.IPC_isMsgDefined, text_argument(msgName))
    if not found and lib.IPC_errno:
        raise_error()
    return bool(found)


def IPC_setCapacity(capacity: int) -> IPC_RETURN_TYPE:
    """How many messages the server may give to this module at once."""
    return listen(lib.IPC_setCapacity, capacity)


def IPC_setMsgQueueLength(msgName: Text, queueLength: int) -> IPC_RETURN_TYPE:
    """How many instances of a message may wait for this module."""
    return listen(lib.IPC_setMsgQueueLength, text_argument(msgName), queueLength)


def IPC_setMsgPriority(msgName: Text, priority: int) -> IPC_RETURN_TYPE:
    """Messages of higher priority overtake others while they wait."""
    return listen(lib.IPC_setMsgPriority, text_argument(msgName), priority)


# --------------------------------------------------------------------- sending

def content_arguments(length: Any, content: Any) -> Tuple[int, Any]:
    """The number of bytes, never more than there are, and where they are."""
    number = number_argument(length, "length")
    if number == IPC_VARIABLE_LENGTH:
        return number, None  # the library refuses it before it looks at the bytes
    content, number = bytes_argument(content, None if number == IPC_FIXED_LENGTH else number)
    return number, content


def IPC_publish(msgName: Text, length: int, content: Any) -> IPC_RETURN_TYPE:
    """Sends bytes to all who subscribe to the message."""
    if number_argument(length, "length") == IPC_FIXED_LENGTH:
        return IPC_publishFixed(msgName, content)
    return send(lib.IPC_publish, (text_argument(msgName),), *content_arguments(length, content))


def IPC_publishVC(msgName: Text, varcontent: Optional[IPC_VARCONTENT_TYPE]) -> IPC_RETURN_TYPE:
    """Sends the bytes of varcontent."""
    if varcontent is None:
        return fail(IPC_Null_Argument)
    return IPC_publish(msgName, varcontent.length, varcontent.content)


def IPC_publishFixed(msgName: Text, content: Any) -> IPC_RETURN_TYPE:
    """Sends bytes, as many as the message was defined with."""
    return send(lib.glue_publish_fixed, (text_argument(msgName),),
                *content_arguments(IPC_FIXED_LENGTH, content))


def encoded_for(msgName: Text, data: Any) -> Tuple[int, Any]:
    """Data in the format of a message: their length and bytes.  Raises IPCError or Refused."""
    content = encoder(_formatter_of(msgName))(data)
    return len(content), content or None


def _formatter_of(msgName: Text) -> Optional[FORMATTER_PTR]:
    lib.IPC_errno = IPC_No_Error
    formatter = IPC_msgFormatter(msgName)
    if formatter is None and lib.IPC_errno != IPC_No_Error:
        raise Refused
    return formatter


class Refused(Exception):
    """The library refuses the call; its error is in IPC_errno, and was reported."""


def IPC_publishData(msgName: Text, data: Any) -> IPC_RETURN_TYPE:
    """Encodes data by the format of the message, and publishes it."""
    return publish_data(msgName, data)


class _Outlet:
    """What it takes to publish a message, as long as its format stays what it is."""

    __slots__ = ("name", "pointer", "encode")

    def __init__(self, msgName: Text) -> None:
        formatter = _formatter_of(msgName)
        self.name = text_argument(msgName)
        self.pointer = ffi.NULL if formatter is None else formatter.pointer
        self.encode = encoder(formatter)

    def publish(self, content: Encoded) -> int:
        """The library's result, or OTHER_FORMAT, and then nothing was sent."""
        return waits_with(lib.glue_publish_as, (self.name, self.pointer), len(content), content)


#: By the names that the program uses, so many at most.
_outlets: Dict[Text, _Outlet] = {}
MAX_OUTLETS = 10000
OTHER_FORMAT = int(lib.GLUE_OTHER_FORMAT)


def _outlet(msgName: Text) -> _Outlet:
    outlet = _Outlet(msgName)
    if len(_outlets) >= MAX_OUTLETS:
        _outlets.clear()
    _outlets[msgName] = outlet
    return outlet


def publish_data(msgName: Text, data: Any,
                 tell: Optional[Callable[[int], Any]] = None) -> IPC_RETURN_TYPE:
    """The same; tells how many bytes are sent."""
    try:
        content, number = _publish_again(msgName, data)
        while number == OTHER_FORMAT:
            outlet = _outlet(msgName)
            content = outlet.encode(data)
            number = outlet.publish(content)
    except Refused:
        return IPC_Error
    if tell is not None and number == IPC_OK:
        tell(len(content))
    return result(number)


def _publish_again(msgName: Text, data: Any) -> Tuple[Encoded, int]:
    """Publishes as the last time: this is what programs do most."""
    try:
        outlet = _outlets[msgName]
        content = outlet.encode(data)
    except Exception:  # the first time, or the message has another format by now, or data are wrong
        return b"", OTHER_FORMAT
    return content, outlet.publish(content)


# ------------------------------------------------------------------- instances

def IPC_msgInstanceName(msgInstance: Optional[MSG_INSTANCE]) -> Optional[str]:
    """The name of the message."""
    name = lib.IPC_msgInstanceName(instance_argument(msgInstance))
    if name == ffi.NULL:
        raise_error()
        return None
    return to_text(name)


def IPC_dataLength(msgInstance: Optional[MSG_INSTANCE]) -> int:
    """The number of bytes of the instance."""
    lib.IPC_errno = 0
    length = int(lib.IPC_dataLength(instance_argument(msgInstance)))
    if length == 0 and lib.IPC_errno:
        raise_error()
    return length


def IPC_msgInstanceFormatter(msgInstance: Optional[MSG_INSTANCE]) -> Optional[FORMATTER_PTR]:
    """The formatter of the message, None if it has no format."""
    return ask_for_formatter(lib.IPC_msgInstanceFormatter, instance_argument(msgInstance))


__all__ = ["IPC_defineMsg", "IPC_isMsgDefined", "IPC_setCapacity", "IPC_setMsgQueueLength",
           "IPC_setMsgPriority", "IPC_publish", "IPC_publishVC", "IPC_publishFixed",
           "IPC_publishData", "IPC_msgInstanceName", "IPC_dataLength",
           "IPC_msgInstanceFormatter"]
