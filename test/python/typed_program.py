"""A program with type hints, which mypy checks against the package's."""
from __future__ import annotations

from typing import Any, Optional

import ipc_cffi as IPC


class Point(IPC.IPCdata):
    """A structure."""
    _fields = ("x", "y")
    x: float
    y: float


def on_point(instance: IPC.MSG_INSTANCE, point: Any, client_data: Any) -> None:
    """A handler of data."""
    name: Optional[str] = IPC.IPC_msgInstanceName(instance)
    print(name, point, client_data)


def on_bytes(instance: IPC.MSG_INSTANCE, content: Optional[IPC.BYTE_ARRAY], _: Any) -> None:
    """A handler of bytes."""
    print(IPC.IPC_dataLength(instance), len(content or b""))


def main() -> int:
    """Uses functions of every kind."""
    result: IPC.IPC_RETURN_TYPE = IPC.IPC_connect("typed")
    IPC.IPC_defineMsg("point", IPC.IPC_VARIABLE_LENGTH, "{double, double}")
    IPC.IPC_subscribeData("point", on_point, None, Point)
    IPC.IPC_subscribe("point", on_bytes)
    IPC.IPC_publishData("point", Point(x=1.0, y=2.0))
    answer, result = IPC.IPC_queryResponseData("point", None, 100, Point)
    reference, result = IPC.IPC_addTimerGetRef(10, 1, lambda data, now, due: None)
    IPC.IPC_removeTimerByRef(reference)
    print(answer, result == IPC.IPC_OK, IPC.IPC_listen(10))
    return int(IPC.IPC_disconnect())
