"""What all codecs have in common."""
from __future__ import annotations

from typing import Any, Callable, Optional, Tuple

#: Reads a value at a place of the bytes: the value, and the place behind it.
Reader = Callable[[bytes, int], Tuple[Any, int]]


class Codec:
    """Encodes and decodes the values of one node of a format."""

    #: The smallest number of bytes that a value takes.
    least: int

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends the bytes of the value, in this host's order; raises Misfit."""
        raise NotImplementedError

    def reader(self, order: str, cls: Optional[type]) -> Reader:
        """Reads values whose bytes have that order, with cls for the structures in it.

        Reading raises BadBytes, struct.error or IndexError for bytes that are no such value.
        """
        raise NotImplementedError
