"""Connections and contexts [manual 4.13 to 4.19, 4.31, 7]."""
from __future__ import annotations

import atexit
import os
from types import TracebackType
from typing import Any, Dict, Optional, Set, Type

from ._ffi import ffi, lib
from .arguments import Text, text_argument
from .constants import IPC_Argument_Out_Of_Range, IPC_Null_Argument, IPC_OK, IPC_RETURN_TYPE
from .errors import fail, raise_error
from .handlers import address, forget_context
from .library import begin, end, handler_failed, listen, lost, waits


class IPC_CONTEXT_PTR:
    """A connection to one server, with all that belongs to it."""

    __slots__ = ("pointer",)

    def __init__(self, pointer: Any) -> None:
        self.pointer = pointer

    def __eq__(self, other: object) -> bool:
        return isinstance(other, IPC_CONTEXT_PTR) and bool(self.pointer == other.pointer)

    def __hash__(self) -> int:
        return hash(self.pointer)

    def __repr__(self) -> str:
        return f"<IPC context {address(self.pointer):#x}>"


#: The contexts that were connected and not disconnected since, by address.
_connected: Dict[int, Any] = {}


def forget(context: Any) -> None:
    """A connection has ended, and will not come back."""
    _connected.pop(address(context), None)
    forget_context(context)


@ffi.def_extern(onerror=handler_failed)  # type: ignore[untyped-decorator, unused-ignore]
def py_loss() -> None:
    # The library has lost the connection of its current context.
    forget(lib.IPC_getContext())
    lost()


def has_ended(context: IPC_CONTEXT_PTR) -> bool:
    """Whether the connection has ended; one that is to come back has not."""
    return address(context.pointer) not in _connected


# ------------------------------------------------------------------ connecting

#: As the name of a server: one that this process starts, and that ends with it.
EMBEDDED = "embedded:"


def _connect(function: Any, taskName: Optional[Text],
             serverName: Optional[Text]) -> IPC_RETURN_TYPE:
    begin()
    if (serverName or os.environ.get("CENTRALHOST")) == EMBEDDED:
        from .central import embedded_address
        serverName = embedded_address()
    task = text_argument(taskName, "the name of a module")
    result = listen(function, task, text_argument(serverName, "the name of a server"))
    if result == IPC_OK:
        context = lib.IPC_getContext()
        _connected[address(context)] = context
    return result


def IPC_connect(taskName: Text) -> IPC_RETURN_TYPE:
    """Connects to the server that CENTRALHOST names."""
    return _connect(lib.IPC_connectModule, taskName, None)


def IPC_connectModule(taskName: Text, serverName: Optional[Text]) -> IPC_RETURN_TYPE:
    """Connects to a server, None for the one that CENTRALHOST names."""
    return _connect(lib.IPC_connectModule, taskName, serverName)


def IPC_connectNoListen(taskName: Text) -> IPC_RETURN_TYPE:
    """IPC_connect for a module that will not listen regularly."""
    return _connect(lib.IPC_connectModuleNoListen, taskName, None)


def IPC_connectModuleNoListen(taskName: Text, serverName: Optional[Text]) -> IPC_RETURN_TYPE:
    """IPC_connectModule for a module that will not listen regularly."""
    return _connect(lib.IPC_connectModuleNoListen, taskName, serverName)


def IPCx_tryConnect(taskName: Text, serverName: Optional[Text]) -> IPC_RETURN_TYPE:
    """Connects to a server if it is there now: IPC_Timeout, and not a word, if it is not."""
    return _connect(lib.IPCx_tryConnect, taskName, serverName)


def IPC_initialize() -> IPC_RETURN_TYPE:
    """Makes formats and marshalling usable without a connection."""
    begin()
    return listen(lib.IPC_initialize)


def IPC_disconnect() -> IPC_RETURN_TYPE:
    """Ends the connection of the current context."""
    context = lib.IPC_getContext()
    try:
        return listen(lib.IPC_disconnect)
    finally:
        forget(context)


def IPC_isConnected() -> bool:
    """Whether the current context has a connection."""
    return bool(lib.IPC_isConnected())


def IPC_isModuleConnected(moduleName: Text) -> bool:
    """Whether a module of that name is connected to the server."""
    found = waits(lib.IPC_isModuleConnected, text_argument(moduleName))
    if found < 0:
        raise_error()
    return found > 0


def IPC_getConnections() -> Set[int]:
    """The descriptors that a listening call of the current context waits for."""
    room = 64
    while True:
        list = ffi.new("int[]", room)
        count = lib.glue_connections(list, room)
        if count <= room:
            return set(ffi.unpack(list, count)) if count else set()
        room = count


# -------------------------------------------------------------------- contexts

def IPC_getContext() -> Optional[IPC_CONTEXT_PTR]:
    """The current context, None if there is none."""
    pointer = lib.IPC_getContext()
    return None if pointer == ffi.NULL else IPC_CONTEXT_PTR(pointer)


def IPC_setContext(context: Optional[IPC_CONTEXT_PTR]) -> IPC_RETURN_TYPE:
    """Makes a context the current one, in a handler until it returns."""
    if context is None:
        return fail(IPC_Null_Argument)
    if not isinstance(context, IPC_CONTEXT_PTR):
        raise TypeError(f"a context is needed, not {type(context).__name__}")
    if address(context.pointer) not in _connected:
        return fail(IPC_Argument_Out_Of_Range)
    return listen(lib.IPC_setContext, context.pointer)


class Current:
    """A with block in which a context is the current one."""

    __slots__ = ("_context", "_before")

    def __init__(self, context: Any) -> None:
        self._context = context

    def __enter__(self) -> None:
        self._before = lib.IPC_getContext()
        if self._before != self._context:
            lib.IPC_setContext(self._context)

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        if self._before not in (self._context, ffi.NULL):
            lib.IPC_setContext(self._before)


# --------------------------------------------------------------- fork, the end

def _leave_all(disconnect: Any, *arguments: Any) -> None:
    for context in list(_connected.values()):
        lib.IPC_setContext(context)
        disconnect(*arguments)
        forget_context(context)
    _connected.clear()


def disconnect_all() -> None:
    """Ends all connections."""
    _leave_all(lib.IPC_disconnect)


def _after_fork() -> None:
    """The connection stays the parent's; this process closes its copy of it."""
    _leave_all(lib.x_ipcCloseInternal, 0)


def _at_exit() -> None:
    end()
    disconnect_all()


atexit.register(_at_exit)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)

__all__ = ["IPC_CONTEXT_PTR", "IPC_connect", "IPC_connectModule", "IPC_connectNoListen",
           "IPC_connectModuleNoListen", "IPC_initialize", "IPC_disconnect", "IPC_isConnected",
           "IPC_isModuleConnected", "IPC_getConnections", "IPC_getContext", "IPC_setContext"]
