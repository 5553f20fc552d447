"""IPC: messages between the modules of a robot, for Python.

All functions, types and constants of the reference manual, under the names it gives them; see
docs/python.md.
"""
from __future__ import annotations

from typing import Any

from . import (bytearrays, constants, contexts, errors, formatters, handlers, listening, messages,
               queries, records, subscriptions)
from .bytearrays import BYTE_ARRAY, IPC_VARCONTENT_TYPE, IPC_freeByteArray, createByteArray
from .central import Central as Central
from .connection import (Connection as Connection, Message as Message, Messages as Messages,
                         Question as Question, Subscription as Subscription, Timer as Timer,
                         connect as connect)
from .constants import *
from .contexts import *
from .contexts import IPCx_tryConnect as IPCx_tryConnect
from .errors import (BadData as BadData, CommunicationError as CommunicationError,
                     IllegalFormat as IllegalFormat, IPC_perror, IPC_setVerbosity, IPCError,
                     IPCTimeout as IPCTimeout, MessageNotDefined as MessageNotDefined,
                     MismatchedFormat as MismatchedFormat, NotConnected as NotConnected,
                     NotInitialized as NotInitialized, NullArgument as NullArgument,
                     OutOfRange as OutOfRange, WrongLength as WrongLength)
from .format import Format as Format
from .formatters import *
from .formatters import IPC_setArrayType as IPC_setArrayType
from .handlers import MSG_INSTANCE
from .hints import (Byte as Byte, Char as Char, Double as Double, Float as Float, Int as Int,
                    Long as Long, Short as Short, UByte as UByte, UInt as UInt, ULong as ULong,
                    UShort as UShort, format_of as format_of)
from .listening import *
from .messages import *
from .output import capture_output as capture_output
from .queries import *
from .places import (include_dir as include_dir, library_path as library_path,
                     library_version as library_version, pkgconfig_dir as pkgconfig_dir)
from .reconnect import (IPCX_RECONNECT as IPCX_RECONNECT,
                        IPCX_RECONNECT_FAIL as IPCX_RECONNECT_FAIL,
                        IPCX_RECONNECT_NEVER as IPCX_RECONNECT_NEVER,
                        IPCX_RECONNECT_WAIT as IPCX_RECONNECT_WAIT,
                        IPCx_setReconnect as IPCx_setReconnect,
                        IPCx_subscribeConnection as IPCx_subscribeConnection,
                        IPCx_unsubscribeConnection as IPCx_unsubscribeConnection)
from .records import IPCdata, eq as eq
from .subscriptions import *

__version__ = "4.0.0"

__all__ = [*constants.__all__, *contexts.__all__, *formatters.__all__, *listening.__all__,
           *messages.__all__, *queries.__all__, *subscriptions.__all__, "BYTE_ARRAY",
           "IPC_VARCONTENT_TYPE", "IPC_freeByteArray", "createByteArray", "IPC_perror",
           "IPC_setVerbosity", "IPCError", "IPCdata", "MSG_INSTANCE"]


#: The modules that are imported when they are first used, for what they import themselves.
_LATE = ("aio", "testing", "trio")


def __getattr__(name: str) -> Any:
    if name == "IPC_errno":
        from ._ffi import lib
        return constants.IPC_ERROR_TYPE(lib.IPC_errno)
    if name in _LATE:
        import importlib
        return importlib.import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
