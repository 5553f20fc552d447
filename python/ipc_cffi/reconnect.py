"""What follows the loss of the server: the additions of ipcx.h for programs that outlive it."""
from __future__ import annotations

import enum
from typing import Any, Callable

from ._ffi import lib
from .constants import IPC_RETURN_TYPE
from .handlers import Handler, current_context
from .library import begin, listen
from .subscriptions import Watching


class IPCX_RECONNECT(enum.IntEnum):
    """What the loss of the server means for a connection."""

    IPCX_RECONNECT_NEVER = 0  # its end
    IPCX_RECONNECT_FAIL = 1  # calls fail until there is a server again
    IPCX_RECONNECT_WAIT = 2  # calls wait until there is a server again


IPCX_RECONNECT_NEVER = IPCX_RECONNECT.IPCX_RECONNECT_NEVER
IPCX_RECONNECT_FAIL = IPCX_RECONNECT.IPCX_RECONNECT_FAIL
IPCX_RECONNECT_WAIT = IPCX_RECONNECT.IPCX_RECONNECT_WAIT

_watching = Watching(lib.glue_watch_connection, "connection")


def IPCx_setReconnect(mode: int) -> IPC_RETURN_TYPE:
    """Chooses what follows the loss of the server, for the current context."""
    begin()
    return listen(lib.IPCx_setReconnect, mode)


def IPCx_subscribeConnection(handler: Callable[[bool, Any], Any],
                             clientData: Any = None) -> IPC_RETURN_TYPE:
    """Has handler called with False when the server is lost, and with True when it is back."""
    return _watching.subscribe((current_context(),), (), handler, clientData)


def IPCx_unsubscribeConnection(handler: Handler) -> IPC_RETURN_TYPE:
    """Ends what IPCx_subscribeConnection began."""
    return _watching.unsubscribe((current_context(),), (), handler)
