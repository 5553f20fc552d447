"""Codecs of arrays.

The elements of an array of any number of dimensions follow one another.  A Row encodes and decodes
so many of them; for numbers that is one step, without a look at each.
"""
from __future__ import annotations

import array
import struct
import sys
from typing import Any, Iterator, List, Optional, Sequence, Tuple, Union

from .blocks import NumpyRowReader, block_of, encode_block, typecode
from .codec import Codec, Content, Reader, Style
from .misfit import BadBytes, Misfit, expected
from .scalars import NATIVE, Scalar

#: How many elements an array of elements without bytes may have.
LARGEST_EMPTY = 1 << 16


class Row:
    """Elements in a row."""

    def __init__(self, element: Codec) -> None:
        self.element = element

    def encode(self, values: Sequence[Any], count: int, out: bytearray) -> None:
        """Appends the first count elements."""
        for index in range(count):
            try:
                self.element.encode(values[index], out)
            except Misfit as misfit:
                raise misfit.inside(f"[{index}]") from None

    def reader(self, style: Style, cls: Optional[type]) -> AnyRowReader:
        return RowReader(self.element.reader(style, cls), self.element.least)


class RowReader:
    """Reads elements in a row into a list."""

    def __init__(self, read: Reader, least: int) -> None:
        self._read = read
        self._least = least

    def read(self, data: Content, at: int, count: int) -> Tuple[List[Any], int]:
        if count < 0 or count * self._least > len(data) - at or (
                not self._least and count > LARGEST_EMPTY):
            raise BadBytes
        values = []
        for _ in range(count):
            value, at = self._read(data, at)
            values.append(value)
        return values, at


# ------------------------------------------------------------ rows of numbers

class NumberRow(Row):
    """Scalars in a row."""

    element: Scalar

    def __init__(self, element: Scalar) -> None:
        super().__init__(element)
        self._code = element.code
        self._typecode = typecode(element.code)

    def encode(self, values: Sequence[Any], count: int, out: bytearray) -> None:
        if encode_block(self.element, values, (count,), out):
            return
        if self.element.to_wire is not None:
            out += self._exact(values, count, self.element.to_wire)
            return
        if isinstance(values, (list, tuple)):
            row = values if len(values) == count else values[:count]
            try:
                out += array.array(self._typecode, row)
                return
            except Exception:  # what struct or array refuse is looked at one by one
                pass
        out += self._exact(values, count, self.element.exact)

    def _exact(self, values: Sequence[Any], count: int, exact: Any) -> bytes:
        numbers = []
        for index in range(count):
            try:
                numbers.append(exact(values[index]))
            except Misfit as misfit:
                raise misfit.inside(f"[{index}]") from None
        return struct.pack(f"{NATIVE}{count}{self._code}", *numbers)

    def reader(self, style: Style, cls: Optional[type]) -> AnyRowReader:
        if style.numpy and self.element.from_wire is not chr:
            return NumpyRowReader(self.element, style)
        return NumberRowReader(self.element, style, self._typecode)


class NumberRowReader(RowReader):
    """Reads scalars in a row."""

    def __init__(self, element: Scalar, style: Style, code: str) -> None:
        super().__init__(element.reader(style, None), element.least)
        self._size = element.least
        self._code = code
        self._swap = style.order != sys.byteorder and element.least > 1
        self._from_wire = element.from_wire

    def read(self, data: Content, at: int, count: int) -> Tuple[List[Any], int]:
        end = at + count * self._size
        if count < 0 or end > len(data):
            raise BadBytes
        numbers = array.array(self._code)
        numbers.frombytes(data[at:end])
        if self._swap:
            numbers.byteswap()
        if self._from_wire is not None:
            return list(map(self._from_wire, numbers)), end
        return numbers.tolist(), end


#: Reads elements in a row: a sequence of them, and the place behind.
AnyRowReader = Union[RowReader, NumpyRowReader]


class CharacterRow(NumberRow):
    """Characters in a row, which may be given as one text."""

    def encode(self, values: Sequence[Any], count: int, out: bytearray) -> None:
        if isinstance(values, str):
            try:
                values = values.encode("latin-1")
            except UnicodeEncodeError:
                expected("characters up to \\xff", values)
        if isinstance(values, (bytes, bytearray)):
            out += values[:count]
        else:
            super().encode(values, count, out)


class ByteRow(NumberRow):
    """Bytes in a row, which may be given as such."""

    def encode(self, values: Sequence[Any], count: int, out: bytearray) -> None:
        if isinstance(values, (bytes, bytearray)):
            out += values[:count]
        else:
            super().encode(values, count, out)


def row_of(element: Codec) -> Row:
    if not isinstance(element, Scalar):
        return Row(element)
    if element.code not in "bB":
        return NumberRow(element)
    return ByteRow(element) if element.to_wire is None else CharacterRow(element)


# ----------------------------------------------------------------- dimensions

def check_sequence(values: Any, count: int, row: Optional[Row]) -> None:
    """Whether there are so many elements; row is None where the elements are rows themselves."""
    takes_text = isinstance(row, CharacterRow)
    takes_bytes = isinstance(row, (CharacterRow, ByteRow))
    if isinstance(values, str) and not takes_text or (
            isinstance(values, (bytes, bytearray)) and not takes_bytes):
        expected(f"a sequence of {count}", values)
    try:
        length = len(values)
    except TypeError:
        expected(f"a sequence of {count}", values)
    if isinstance(values, (dict, set, frozenset)) or not hasattr(values, "__getitem__"):
        expected(f"a sequence of {count}", values)
    if length < count:
        raise Misfit(ValueError, f"expected {count} elements, got {length}")


def encode_nested(row: Row, values: Any, dimensions: Sequence[int], out: bytearray) -> None:
    """Appends an array of several dimensions, in nested sequences."""
    count = dimensions[0]
    if len(dimensions) == 1:
        check_sequence(values, count, row)
        row.encode(values, count, out)
        return
    if isinstance(row, NumberRow) and encode_block(row.element, values, dimensions, out):
        return
    check_sequence(values, count, None)
    for index in range(count):
        try:
            encode_nested(row, values[index], dimensions[1:], out)
        except Misfit as misfit:
            raise misfit.inside(f"[{index}]") from None


def _chunks(values: List[Any], size: int) -> Iterator[List[Any]]:
    return (values[start:start + size] for start in range(0, len(values), size))


def shaped(values: Any, dimensions: Sequence[int]) -> Any:
    """Elements in a row as nested lists of these dimensions, or as an array."""
    if not isinstance(values, list):
        return values.reshape(dimensions)
    for size in reversed(dimensions[1:]):
        if size == 0:
            return [shaped([], dimensions[1:]) for _ in range(dimensions[0])]
        values = list(_chunks(values, size))
    return values


class FixedArray(Codec):
    """An array whose dimensions are part of the format."""

    def __init__(self, element: Codec, dimensions: Sequence[int]) -> None:
        self._row = row_of(element)
        self._dimensions = tuple(dimensions)
        self._count = 1
        for size in dimensions:
            self._count *= size
        self.least = self._count * element.least

    def block(self, value: Any) -> Optional[memoryview]:
        """The bytes of numbers that lie in memory as they are sent."""
        if isinstance(self._row, NumberRow):
            return block_of(self._row.element, value, self._dimensions)
        return None

    def encode(self, value: Any, out: bytearray) -> None:
        encode_nested(self._row, value, self._dimensions, out)

    def reader(self, style: Style, cls: Optional[type]) -> Reader:
        read_row, count = self._row.reader(style, cls).read, self._count
        dimensions = self._dimensions

        def read(data: Content, at: int) -> Tuple[List[Any], int]:
            return read_row(data, at, count)

        def read_nested(data: Content, at: int) -> Tuple[List[Any], int]:
            values, at = read_row(data, at, count)
            return shaped(values, dimensions), at
        return read if len(dimensions) == 1 else read_nested
