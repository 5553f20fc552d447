"""Byte arrays: encoded data [manual 4.3, 4.4, 6.9]."""
from __future__ import annotations

import sys
from typing import Any, Optional, Tuple, Union


class BYTE_ARRAY(bytearray):
    """The bytes of a message, with the byte order that their numbers have.

    They stay valid as long as the object.  IPC_freeByteArray() empties it earlier; after that it
    has no bytes, and looking for one is a ValueError.
    """

    order: str = sys.byteorder
    _freed: bool = False

    def free(self) -> None:
        """Gives the bytes back, unless a memoryview still shows them."""
        if not self._freed:
            try:
                self.clear()
            except BufferError:
                return
            self._freed = True

    def __getitem__(self, index: Any) -> Any:
        if self._freed:
            raise ValueError("this byte array was freed")
        return super().__getitem__(index)

    def __setitem__(self, index: Any, value: Any) -> None:
        if self._freed:
            raise ValueError("this byte array was freed")
        super().__setitem__(index, value)

    def __hash__(self) -> int:  # type: ignore[override]
        return id(self)

    def __repr__(self) -> str:
        return f"<IPC byte array, {len(self)} bytes>"

    __str__ = __repr__


BytesLike = Union[bytes, bytearray, memoryview]


class IPC_VARCONTENT_TYPE:
    """Bytes and their number."""

    def __init__(self, content: Optional[BytesLike] = None) -> None:
        self.content: Optional[BytesLike] = content
        self.length: int = 0 if content is None else memoryview(content).nbytes

    def __repr__(self) -> str:
        return f"<IPC_VARCONTENT_TYPE: length: {self.length}; content: {self.content!r}>"


def createByteArray(numBytes: int) -> BYTE_ARRAY:
    """A byte array of zeros."""
    if numBytes < 0:
        raise ValueError(f"a byte array cannot have {numBytes} bytes")
    return BYTE_ARRAY(numBytes)


def IPC_freeByteArray(byteArray: Optional[BytesLike]) -> None:
    """Frees a byte array early; never needed."""
    if isinstance(byteArray, BYTE_ARRAY):
        byteArray.free()


def bytes_argument(content: Any, length: Optional[int] = None) -> Tuple[Any, int]:
    """A buffer to send and how many of its bytes: length, or all."""
    if content is None:
        if length:
            raise ValueError(f"{length} bytes are to be sent, and there are none")
        return None, 0
    try:
        with memoryview(content) as view:
            available = view.nbytes
            if not view.c_contiguous:
                content = view.tobytes()
    except TypeError:
        raise TypeError(f"bytes are needed, not {type(content).__name__}; "
                        "IPC_publishData and the like send other data") from None
    if length is None:
        length = available
    if length > available:
        raise ValueError(f"{length} bytes are to be sent, and there are only {available}")
    return content, length
