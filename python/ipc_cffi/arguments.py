"""Text and numbers on their way into the C library, and text out of it."""
from __future__ import annotations

from typing import Any, Optional, Union

from ._ffi import ffi

Text = Union[str, bytes]


def to_bytes(text: Optional[Text], what: str = "a name") -> Optional[bytes]:
    """A name or text as the library gets it."""
    if text is None:
        return None
    if isinstance(text, str):
        text = text.encode("utf-8", "surrogateescape")
    elif not isinstance(text, bytes):
        raise TypeError(f"{what} has to be str or bytes, not {type(text).__name__}")
    if b"\0" in text:
        raise ValueError(f"{what} contains a NUL character")
    return text


def text_argument(text: Optional[Text], what: str = "a name") -> Any:
    """The same, with NULL for None."""
    encoded = to_bytes(text, what)
    return ffi.NULL if encoded is None else encoded


def to_text(pointer: Any) -> str:
    """A copy of a string of the library."""
    return bytes(ffi.string(pointer)).decode("utf-8", "surrogateescape")


def number_argument(number: Any, what: str) -> int:
    """An unsigned int of the library; -1 is the largest, None is for ever, fractions round up."""
    if number is None:
        return 0xFFFFFFFF
    if isinstance(number, float):
        number = int(-(-number // 1))
    if number == -1:
        return 0xFFFFFFFF
    if not 0 <= number <= 0xFFFFFFFF:
        raise OverflowError(f"{what} has to be 0 to 4294967295, not {number}")
    return int(number)
