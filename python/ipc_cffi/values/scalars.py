"""Codecs of values that are no arrays or structures."""
from __future__ import annotations

import enum
import math
import operator
import struct
from typing import Any, Callable, Dict, Optional, Tuple

from .codec import Codec, Content, Reader, Style
from .misfit import BadBytes, Misfit, expected, outside

LONG = struct.calcsize("l")

#: What the module struct says for this host's byte order.
NATIVE = Style().prefix


class Scalar(Codec):
    """A value that struct knows by a letter.

    Several of them can be packed at once with the letter as it is, after to_wire, which is None
    where struct itself refuses what is wrong; what struct refuses is tried again after exact,
    which knows more values, and says what is wrong.
    """

    code: str
    exact: Callable[[Any], Any]
    to_wire: Optional[Callable[[Any], Any]] = None
    from_wire: Optional[Callable[[Any], Any]] = None

    def __init__(self, code: str, exact: Callable[[Any], Any]) -> None:
        self.code = code
        self.exact = exact
        self.least = struct.calcsize("=" + code)
        self._pack = struct.Struct(NATIVE + code).pack

    @property
    def pack(self) -> Optional[Callable[[Any], bytes]]:  # type: ignore[override]
        return self._pack if self.to_wire is None else None

    def encode(self, value: Any, out: bytearray) -> None:
        if self.to_wire is not None:
            value = self.to_wire(value)
        try:
            out += self._pack(value)
        except Exception:  # struct.error, or what a conversion of the value's own raised
            out += self._pack(self.exact(value))

    def reader(self, style: Style, cls: Optional[type]) -> Reader:
        unpack, size = struct.Struct(style.prefix + self.code).unpack_from, self.least
        from_wire = self.from_wire

        def read(data: Content, at: int) -> Tuple[Any, int]:
            return unpack(data, at)[0], at + size

        def read_and_convert(data: Content, at: int) -> Tuple[Any, int]:
            return from_wire(unpack(data, at)[0]), at + size  # type: ignore[misc]
        return read if from_wire is None else read_and_convert


# -------------------------------------------------------------------- numbers

def _integer(name: str, code: str) -> Scalar:
    """Signed and unsigned values of that size are taken, as C takes them."""
    bits = 8 * struct.calcsize("=" + code)
    low, high, signed = -(1 << bits - 1), (1 << bits) - 1, code.islower()

    def exact(value: Any) -> int:
        try:
            number = operator.index(value)
        except TypeError:
            expected(name, value)
        if not low <= number <= high:
            outside(name, low, high, number)
        if signed:
            return number - (1 << bits) if number >= 1 << bits - 1 else number
        return number & high
    return Scalar(code, exact)


def _real(name: str, code: str) -> Scalar:
    largest = math.inf if code == "d" else struct.unpack("<f", b"\xff\xff\x7f\x7f")[0]
    midpoint = largest * (1 + 2.0 ** -25)  # from here on C rounds to infinity

    def exact(value: Any) -> float:
        if isinstance(value, (str, bytes, bytearray, complex)):
            expected(name, value)
        try:
            number = float(value)
        except OverflowError:
            raise Misfit(OverflowError, f"expected {name}, got {value!r}") from None
        except (TypeError, ValueError):
            expected(name, value)
        return math.copysign(math.inf, number) if abs(number) >= midpoint else number
    return Scalar(code, exact)


def _boolean() -> Scalar:
    def to_wire(value: Any) -> int:
        if value is True or value is False:
            return int(value)
        try:
            number = operator.index(value)
        except TypeError:
            # NumPy's booleans have no __index__.
            if type(value).__name__ in ("bool_", "bool"):
                return int(bool(value))
            expected("boolean", value)
        if number not in (0, 1):
            outside("boolean", 0, 1, number)
        return number
    codec = Scalar("i", to_wire)
    codec.to_wire, codec.from_wire = to_wire, bool
    return codec


def _char() -> Scalar:
    def to_wire(value: Any) -> int:
        if isinstance(value, str) and len(value) == 1 and value <= "\xff":
            return ord(value)
        if isinstance(value, (bytes, bytearray)) and len(value) == 1:
            return value[0]
        if isinstance(value, (str, bytes, bytearray)):
            raise Misfit(ValueError, f"expected char (one character up to \\xff), got {value!r}")
        try:
            number = operator.index(value)
        except TypeError:
            expected("char", value)
        if not 0 <= number <= 255:
            outside("char", 0, 255, number)
        return number
    codec = Scalar("B", to_wire)
    codec.to_wire, codec.from_wire = to_wire, chr
    return codec


def enumeration(names: Tuple[str, ...]) -> Scalar:
    """An enumeration; its values are numbers, and may be given by name."""
    by_name: Dict[str, int] = {name: number for number, name in enumerate(names)}
    number_of = _integer("enum", "i").exact

    def to_wire(value: Any) -> int:
        if isinstance(value, enum.Enum):
            value = value.value
        if isinstance(value, str):
            if value not in by_name:
                raise Misfit(ValueError, f"expected one of {', '.join(names) or 'the numbers'}, "
                                         f"got {value!r}")
            return by_name[value]
        return int(number_of(value))
    codec = Scalar("i", to_wire)
    codec.to_wire = to_wire
    return codec


# -------------------------------------------------------------------- strings

class String(Codec):
    """A string: its length and its bytes; the empty one has a filler byte."""

    least = 5

    def encode(self, value: Any, out: bytearray) -> None:
        if isinstance(value, str):
            value = value.encode("utf-8", "surrogateescape")
        elif value is None:
            value = b""
        else:
            try:
                value = bytes(memoryview(value))
            except TypeError:
                expected("string", value)
        if b"\0" in value:
            raise Misfit(ValueError, f"expected string, got {value!r} with a NUL character")
        out += _pack_count(len(value))
        out += value or b"Z"

    def reader(self, style: Style, cls: Optional[type]) -> Reader:
        count = struct.Struct(style.prefix + "i").unpack_from

        def read(data: Content, at: int) -> Tuple[str, int]:
            (length,) = count(data, at)
            start = at + 4
            end = start + (length or 1)
            if length < 0 or end > len(data):
                raise BadBytes
            return str(data[start:start + length], "utf-8", "surrogateescape"), end
        return read


_pack_count = struct.Struct(NATIVE + "i").pack


class RawBytes(Codec):
    """So many bytes of no type."""

    def __init__(self, length: int) -> None:
        self.least = length

    def encode(self, value: Any, out: bytearray) -> None:
        try:
            content = bytes(memoryview(value))
        except TypeError:
            expected(f"{self.least} bytes", value)
        if len(content) != self.least:
            raise Misfit(ValueError, f"expected {self.least} bytes, got {len(content)}")
        out += content

    def reader(self, style: Style, cls: Optional[type]) -> Reader:
        length = self.least

        def read(data: Content, at: int) -> Tuple[bytes, int]:
            if at + length > len(data):
                raise BadBytes
            return bytes(data[at:at + length]), at + length
        return read


class Unsupported(Codec):
    """A primitive that only library and server use."""

    least = 4

    def __init__(self, name: str) -> None:
        self._name = name

    def encode(self, value: Any, out: bytearray) -> None:
        raise Misfit(TypeError, f"values of the primitive {self._name} cannot be sent from Python")

    def reader(self, style: Style, cls: Optional[type]) -> Reader:
        def read(data: Content, at: int) -> Tuple[Any, int]:
            raise BadBytes
        return read


def primitive(name: str) -> Codec:
    """The codec of a primitive format."""
    long = "q" if LONG == 8 else "i"
    codes = {"int": "i", "uint": "I", "short": "h", "ushort": "H", "twobyte": "H", "byte": "b",
             "ubyte": "B", "long": long, "ulong": long.upper()}
    if name in codes:
        return _integer(name, codes[name])
    if name in ("float", "double"):
        return _real(name, name[0])
    special: Dict[str, Callable[[], Codec]] = {"boolean": _boolean, "char": _char,
                                               "string": String}
    return special[name]() if name in special else Unsupported(name)
