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


def on_number(message: IPC.Message[int]) -> None:
    """A handler of a type that is known."""
    print(message.data + 1)


def objects() -> None:
    """Connections as objects, with types that follow from the arguments."""
    with IPC.connect("typed", reconnect="wait") as ipc:
        ipc.subscribe("number", on_number, type=int).cancel()

        @ipc.subscribe("point", type=Point)
        def on_point_message(message: IPC.Message[Point]) -> None:
            print(message.data.x)

        answer: Point = ipc.query("point", 1, timeout=1, type=Point)
        for message in ipc.messages("point", type=Point, timeout=1):
            print(message.data.y + answer.x)
        content: bytes = IPC.Format("int").encode(5)
        print(content, ipc.ask("point", 1, print), IPC.eq(answer, answer))


def on_typed_point(instance: IPC.MSG_INSTANCE, point: Point, words: str) -> None:
    """A handler whose data and client data have types."""
    print(instance, point.x, words.upper())


def main() -> int:
    """Uses functions of every kind."""
    result: IPC.IPC_RETURN_TYPE = IPC.IPC_connect("typed")
    IPC.IPC_defineMsg("point", IPC.IPC_VARIABLE_LENGTH, "{double, double}")
    IPC.IPC_subscribeData("point", on_point, None, Point)
    IPC.IPC_subscribeData("point", on_typed_point, "words", Point)
    IPC.IPC_subscribe("point", on_bytes)
    IPC.IPC_publishData("point", Point(x=1.0, y=2.0))
    answer, result = IPC.IPC_queryResponseData("point", None, 100, Point)
    reference, result = IPC.IPC_addTimerGetRef(10, 1, lambda data, now, due: None)
    IPC.IPC_removeTimerByRef(reference)
    print(answer, result == IPC.IPC_OK, IPC.IPC_listen(10))
    return int(IPC.IPC_disconnect())
