"""Queries and responses [manual 5, 6.13 to 6.15]."""
from __future__ import annotations

from typing import Any, Callable, Optional, Tuple, Type, TypeVar, overload

from ._ffi import ffi, lib
from .arguments import Text, number_argument, text_argument
from .bytearrays import BYTE_ARRAY, IPC_VARCONTENT_TYPE
from .constants import (IPC_Error, IPC_Null_Argument, IPC_OK, IPC_RETURN_TYPE,
                        IPC_Wrong_Buffer_Length)
from .errors import fail
from .handlers import MSG_INSTANCE, Handler, check_handler, current_context, taken
from .library import listen, send
from .messages import Refused, content_arguments, encoded_for, instance_argument
from .subscriptions import Arrival, byte_array, received
from .values import BadBytes, Content

T = TypeVar("T")


# ------------------------------------------------------------------- answering

def IPC_respond(msgInstance: Optional[MSG_INSTANCE], msgName: Text, length: int,
                content: Any) -> IPC_RETURN_TYPE:
    """Answers a query with bytes."""
    return send(lib.IPC_respond, (instance_argument(msgInstance), text_argument(msgName)),
                *content_arguments(length, content))


def IPC_respondVC(msgInstance: Optional[MSG_INSTANCE], msgName: Text,
                  varcontent: Optional[IPC_VARCONTENT_TYPE]) -> IPC_RETURN_TYPE:
    """Answers a query with the bytes of varcontent."""
    if varcontent is None:
        return fail(IPC_Null_Argument)
    return IPC_respond(msgInstance, msgName, varcontent.length, varcontent.content)


def IPC_respondData(msgInstance: Optional[MSG_INSTANCE], msgName: Text,
                    data: Any) -> IPC_RETURN_TYPE:
    """Answers a query with data, encoded by the format of the message msgName."""
    instance = instance_argument(msgInstance)
    if instance == ffi.NULL:
        return fail(IPC_Null_Argument)
    try:
        length, content = encoded_for(msgName, data)
    except Refused:
        return IPC_Error
    return send(lib.IPC_respond, (instance, text_argument(msgName)), length, content)


def IPC_delayResponse(msgInstance: Optional[MSG_INSTANCE]) -> IPC_RETURN_TYPE:
    """Keeps an instance valid after its handler, until it is answered."""
    return listen(lib.IPC_delayResponse, instance_argument(msgInstance))


# ------------------------------------------------------- asking without waiting

class Reply(Arrival):
    """The handler of the first reply to one query."""

    def arrived(self, instance: MSG_INSTANCE, content: Content, order: str) -> None:
        self.end()
        super().arrived(instance, content, order)


def query_notify(msgName: Text, length: int, content: Any, handler: Optional[Handler],
                 clientData: Any, decoded: bool, cls: Optional[type],
                 numpy: bool = False) -> Optional[Reply]:
    """Sends a query; the reply that is to come, None if sending has failed."""
    if handler is not None:
        check_handler(handler)
    reply = Reply(current_context(), handler or (lambda *ignored: None), clientData, decoded, cls,
                  numpy)
    result = None
    try:
        result = send(lib.glue_query_notify, (text_argument(msgName),), length, content,
                      reply.number)
    finally:
        if result != IPC_OK:
            reply.end()
    return reply if result == IPC_OK else None


def IPC_queryNotify(msgName: Text, length: int, content: Any,
                    handler: Callable[[MSG_INSTANCE, Optional[BYTE_ARRAY], Any], Any],
                    clientData: Any = None) -> IPC_RETURN_TYPE:
    """Sends a query; handler is called with the bytes of the answer."""
    reply = query_notify(msgName, *content_arguments(length, content), handler, clientData, False,
                         None)
    return IPC_OK if reply is not None else IPC_Error


def IPC_queryNotifyVC(msgName: Text, varcontent: Optional[IPC_VARCONTENT_TYPE],
                      handler: Callable[[MSG_INSTANCE, Optional[BYTE_ARRAY], Any], Any],
                      clientData: Any = None) -> IPC_RETURN_TYPE:
    """The same with the bytes of varcontent."""
    if varcontent is None:
        return fail(IPC_Null_Argument)
    return IPC_queryNotify(msgName, varcontent.length, varcontent.content, handler, clientData)


def IPC_queryNotifyData(msgName: Text, data: Any,
                        handler: Callable[[MSG_INSTANCE, Any, Any], Any], clientData: Any = None,
                        responseClass: Optional[type] = None) -> IPC_RETURN_TYPE:
    """Sends a query with data; handler is called with the data of the answer."""
    try:
        length, content = encoded_for(msgName, data)
    except Refused:
        return IPC_Error
    reply = query_notify(msgName, length, content, handler, clientData, True, responseClass)
    return IPC_OK if reply is not None else IPC_Error


# ---------------------------------------------------------- asking and waiting

Taken = Callable[[Any, Content, str], Any]


def _query(take: Taken, msgName: Text, length: int, content: Any,
           timeout: Any) -> Tuple[Any, IPC_RETURN_TYPE]:
    """Sends a query and waits; what take makes of the reply's formatter, bytes and order."""
    limit = number_argument(timeout, "the time limit")
    reply = ffi.new("struct reply *")
    try:
        result = send(lib.glue_query, (text_argument(msgName),), length, content, limit, reply)
    finally:
        data = taken(reply.content, reply.length)
    if result != IPC_OK:
        return None, result
    try:
        return take(reply.formatter, data, "big" if reply.is_big_endian else "little"), IPC_OK
    except BadBytes:
        return None, fail(IPC_Wrong_Buffer_Length)


def IPC_queryResponse(msgName: Text, length: int, content: Any,
                      timeout: Any) -> Tuple[Optional[BYTE_ARRAY], IPC_RETURN_TYPE]:
    """Sends a query and listens until the answer is there: its bytes, and the result."""
    return _query(lambda formatter, data, order: byte_array(data, order), msgName,
                  *content_arguments(length, content), timeout)


def IPC_queryResponseVC(msgName: Text, varcontent: Optional[IPC_VARCONTENT_TYPE],
                        timeout: Any) -> Tuple[Optional[BYTE_ARRAY], IPC_RETURN_TYPE]:
    """The same with the bytes of varcontent."""
    if varcontent is None:
        return None, fail(IPC_Null_Argument)
    return IPC_queryResponse(msgName, varcontent.length, varcontent.content, timeout)


@overload
def IPC_queryResponseData(msgName: Text, data: Any, timeoutMSecs: Any,
                          responseClass: Type[T]) -> Tuple[Optional[T], IPC_RETURN_TYPE]: ...


@overload
def IPC_queryResponseData(msgName: Text, data: Any, timeoutMSecs: Any,
                          responseClass: None = ...) -> Tuple[Any, IPC_RETURN_TYPE]: ...


def IPC_queryResponseData(msgName: Text, data: Any, timeoutMSecs: Any,
                          responseClass: Optional[type] = None) -> Tuple[Any, IPC_RETURN_TYPE]:
    """Sends a query with data and listens until the answer is there: its data, and the result."""
    return query_data(msgName, data, timeoutMSecs, responseClass, False)


def query_data(msgName: Text, data: Any, timeout: Any, cls: Optional[type],
               numpy: bool) -> Tuple[Any, IPC_RETURN_TYPE]:
    """The same, with a wish for arrays."""
    try:
        length, content = encoded_for(msgName, data)
    except Refused:
        return None, IPC_Error
    return _query(lambda formatter, data, order: received(formatter, data, order, cls, numpy),
                  msgName, length, content, timeout)


__all__ = ["IPC_respond", "IPC_respondVC", "IPC_respondData", "IPC_delayResponse",
           "IPC_queryNotify", "IPC_queryNotifyVC", "IPC_queryNotifyData", "IPC_queryResponse",
           "IPC_queryResponseVC", "IPC_queryResponseData"]
