"""What all codecs have in common."""
from __future__ import annotations

import sys
from typing import Any, Callable, NamedTuple, Optional, Tuple, Union

#: Received bytes, or a view of them.
Content = Union[bytes, memoryview]

#: Reads a value at a place of the bytes: the value, and the place behind it.
Reader = Callable[[Content, int], Tuple[Any, int]]


class Style(NamedTuple):
    """How values are read."""

    order: str = sys.byteorder  #: of the bytes of numbers: "little" or "big"
    numpy: bool = False  #: arrays of numbers become arrays of NumPy

    @property
    def prefix(self) -> str:
        """What the module struct says for the order."""
        return "<" if self.order == "little" else ">"


class Codec:
    """Encodes and decodes the values of one node of a format."""

    #: The smallest number of bytes that a value takes.
    least: int

    #: Packs the usual values of a node at once; raises anything for others, which encode() knows.
    #: None if there is no such way.
    pack: Optional[Callable[[Any], bytes]] = None

    def encode(self, value: Any, out: bytearray) -> None:
        """Appends the bytes of the value, in this host's order; raises Misfit."""
        raise NotImplementedError

    def reader(self, style: Style, cls: Optional[type]) -> Reader:
        """Reads values in that style, with cls for the structures in them.

        Reading raises BadBytes, struct.error or IndexError for bytes that are no such value.
        """
        raise NotImplementedError
