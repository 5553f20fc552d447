"""Numbers that lie in memory as arrays: of NumPy, of the module array, memoryviews.

NumPy is used where the program uses it; it is never imported here.
"""
from __future__ import annotations

import array
import struct
import sys
from typing import Any, Sequence, Tuple

from .codec import Style
from .misfit import BadBytes
from .scalars import Scalar

_TYPECODES = {(code.lower(), array.array(code).itemsize): code.lower() for code in "bhilqfd"}


def typecode(code: str) -> str:
    """The letter of the module array for a letter of struct with standard size."""
    letter = _TYPECODES[code.lower(), struct.calcsize("=" + code)]
    return letter if code.islower() else letter.upper()


def _same_formats(code: str) -> Tuple[str, ...]:
    """All letters that mean numbers of that kind and size here."""
    if code in "fd":
        return (code,)
    size = array.array(code).itemsize
    letters = "bhilq" if code.islower() else "BHILQ"
    return tuple(letter for letter in letters if struct.calcsize(letter) == size)


def encode_block(element: Scalar, values: Any, dimensions: Sequence[int], out: bytearray) -> bool:
    """Appends numbers that lie in memory; whether they do, and are what is needed."""
    if isinstance(values, (list, tuple)):
        return False
    numpy = sys.modules.get("numpy")
    if numpy is not None and isinstance(values, numpy.ndarray):
        return _encode_numpy(numpy, element, values, dimensions, out)
    if element.to_wire is not None:
        return False
    try:
        view = memoryview(values)
    except TypeError:
        return False
    shape = view.shape or ()
    if (shape[:1] < tuple(dimensions[:1]) or shape[1:] != tuple(dimensions[1:])
            or view.format not in _same_formats(typecode(element.code))):
        return False
    out += view[:dimensions[0]].tobytes()
    return True


# ----------------------------------------------------------------------- NumPy

def _dtype(numpy: Any, element: Scalar, prefix: str) -> Any:
    kind = {"f": "f", "d": "f"}.get(element.code, "i" if element.code.islower() else "u")
    return numpy.dtype(f"{prefix}{kind}{element.least}")


def _encode_numpy(numpy: Any, element: Scalar, values: Any, dimensions: Sequence[int],
                  out: bytearray) -> bool:
    if values.ndim != len(dimensions) or any(
            size < wanted for size, wanted in zip(values.shape, dimensions)):
        return False
    part = values[tuple(slice(0, size) for size in dimensions)]
    target = _dtype(numpy, element, "=")
    if not _fits(part, target):
        return False
    if part.size:
        out += memoryview(numpy.ascontiguousarray(part, dtype=target)).cast("B")
    return True


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

    def read(self, data: bytes, at: int, count: int) -> Tuple[Any, int]:
        end = at + count * self._size
        if count < 0 or end > len(data):
            raise BadBytes
        numbers = self._numpy.frombuffer(data, self._dtype, count, at)
        if self._is_boolean:
            return numbers != 0, end
        if not self._is_native:
            return numbers.astype(self._dtype.newbyteorder("=")), end
        return (numbers if numbers.flags.aligned else numbers.copy()), end
