"""Numbers that lie in memory as arrays: of NumPy, of the module array, memoryviews.

NumPy is used where the program uses it; it is never imported here.
"""
from __future__ import annotations

import array
import functools
import struct
import sys
from typing import Any, Optional, Sequence, Tuple

from .codec import Content, Style
from .misfit import BadBytes
from .scalars import Scalar

_TYPECODES = {(code.lower(), array.array(code).itemsize): code.lower() for code in "bhilqfd"}


def typecode(code: str) -> str:
    """The letter of the module array for a letter of struct with standard size."""
    letter = _TYPECODES[code.lower(), struct.calcsize("=" + code)]
    return letter if code.islower() else letter.upper()


@functools.lru_cache(maxsize=None)
def _same_formats(letter: str) -> Tuple[str, ...]:
    """All letters that mean numbers of that kind and size here."""
    code = typecode(letter)
    if code in "fd":
        return (code,)
    size = array.array(code).itemsize
    letters = "bhilq" if code.islower() else "BHILQ"
    return tuple(letter for letter in letters if struct.calcsize(letter) == size)


def encode_block(element: Scalar, values: Any, dimensions: Sequence[int], out: bytearray) -> bool:
    """Appends numbers that lie in memory; whether they do, and are what is needed."""
    block = block_of(element, values, dimensions)
    if block is None:
        return False
    out += block
    return True


def block_of(element: Scalar, values: Any, dimensions: Sequence[int]) -> Optional[memoryview]:
    """The bytes of numbers that lie in memory, where they lie if possible; None if they do not, or
    are not what is needed."""
    if isinstance(values, (list, tuple)):
        return None
    block = _block_of_buffer(element, values, tuple(dimensions))
    numpy = sys.modules.get("numpy")
    if block is None and numpy is not None and isinstance(values, numpy.ndarray):
        return _block_of_numpy(numpy, element, values, dimensions)
    return block


def _block_of_buffer(element: Scalar, values: Any,
                     dimensions: Tuple[int, ...]) -> Optional[memoryview]:
    if element.to_wire is not None:
        return None
    try:
        view = memoryview(values)
    except (TypeError, ValueError):
        return None
    shape = view.shape or ()
    if view.format not in _same_formats(element.code) or (
            shape != dimensions and (shape[:1] < dimensions[:1] or shape[1:] != dimensions[1:])):
        return None
    part = view if shape == dimensions else view[:dimensions[0]]
    return part.cast("B") if part.c_contiguous and part.nbytes else memoryview(part.tobytes())


# ----------------------------------------------------------------------- NumPy

def _dtype(numpy: Any, element: Scalar, prefix: str) -> Any:
    kind = {"f": "f", "d": "f"}.get(element.code, "i" if element.code.islower() else "u")
    return numpy.dtype(f"{prefix}{kind}{element.least}")


def _block_of_numpy(numpy: Any, element: Scalar, values: Any,
                    dimensions: Sequence[int]) -> Optional[memoryview]:
    if values.ndim != len(dimensions) or any(
            size < wanted for size, wanted in zip(values.shape, dimensions)):
        return None
    part = values[tuple(slice(0, size) for size in dimensions)]
    target = _dtype(numpy, element, "=")
    if not _fits(part, target):
        return None
    if not part.size:
        return memoryview(b"")
    return memoryview(numpy.ascontiguousarray(part, dtype=target)).cast("B")


def _fits(part: Any, target: Any) -> bool:
    """Whether all numbers can be converted as single ones would be."""
    kind = part.dtype.kind
    if target.kind == "f":
        return kind in "biuf"
    if kind not in "biu":
        return False
    if kind == "b" or part.dtype.itemsize < target.itemsize or part.dtype == target:
        return True
    bits = 8 * target.itemsize
    return bool(part.size == 0 or
                -(1 << bits - 1) <= int(part.min()) and int(part.max()) < 1 << bits)


class NumpyRowReader:
    """Reads scalars in a row into an array, over the bytes themselves where that is possible."""

    def __init__(self, element: Scalar, style: Style) -> None:
        import numpy  # type: ignore[import-not-found, unused-ignore]
        self._numpy: Any = numpy
        self._dtype = _dtype(numpy, element, style.prefix)
        self._is_native = self._dtype.isnative
        self._size = element.least
        self._is_boolean = element.from_wire is bool

    def read(self, data: Content, at: int, count: int) -> Tuple[Any, int]:
        end = at + count * self._size
        if count < 0 or end > len(data):
            raise BadBytes
        numbers = self._numpy.frombuffer(data, self._dtype, count, at)
        if self._is_boolean:
            return numbers != 0, end
        if not self._is_native:
            return numbers.astype(self._dtype.newbyteorder("=")), end
        return (numbers if numbers.flags.aligned else numbers.copy()), end
