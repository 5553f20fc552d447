"""Formats and values as bytes on the wire, written independently of the C code under test.

A format is a nested tuple, None for "no format":

    ("primitive", name)        ("raw", length)           ("struct", (member, ...))
    ("pointer", target)        ("array", item, dims)     ("varray", item, member indexes)
    ("enum", largest, names)   ("named", name)           ("bad",)

The target of a self pointer is None.  Values are numbers, strings (None when empty), bytes for
runs of byte and char, tuples for structures, lists for arrays, None or the value for pointers,
and such tuples as above where the format is "format".
"""
import functools
import re
import struct

PRIMITIVES = {
    1: "int", 2: "boolean", 3: "float", 4: "double", 5: "byte", 6: "twobyte", 7: "string",
    8: "format", 9: "ubyte", 16: "char", 17: "short", 18: "long", 20: "X_IPC_REF_PTR",
    28: "ushort", 29: "uint", 30: "ulong",
}
PRIMITIVE_CODES = {name: code for code, name in PRIMITIVES.items()}
NUMBERS = {
    "int": "i", "boolean": "i", "float": "f", "double": "d", "byte": "b", "ubyte": "B",
    "twobyte": "h", "short": "h", "ushort": "H", "uint": "I", "enum": "i",
}
LONGS = {("long", 4): "i", ("long", 8): "q", ("ulong", 4): "I", ("ulong", 8): "Q"}
BYTES = ("byte", "ubyte", "char")
KINDS = {"primitive": 0, "raw": 1, "struct": 2, "pointer": 3, "array": 4, "varray": 5,
         "bad": 6, "named": 7, "enum": 8}
KIND_NAMES = {number: name for name, number in KINDS.items()}


class Malformed(Exception):
    """A format text, or bytes, that mean nothing."""


# ------------------------------------------------------------------ format texts


@functools.lru_cache(maxsize=None)
def parse(text):
    """The format that a format string describes; None for an empty one."""
    if not text:
        return None
    parser = _Parser(text)
    result = parser.format()
    if parser.tokens:
        raise Malformed(f"{text!r}: text after the format")
    return result


class _Parser:
    def __init__(self, text):
        self.text = text
        self.tokens = re.findall(r"[{}\[\]<>:,*!]|[^\s{}\[\]<>:,*!]+", text)

    def take(self, *wanted):
        token = self.tokens.pop(0) if self.tokens else None
        if token is None or (wanted and token not in wanted):
            raise Malformed(f"{self.text!r}: {token!r} where {wanted or 'more'} should be")
        return token

    def next_is(self, token):
        return bool(self.tokens) and self.tokens[0] == token

    def format(self):
        token = self.take()
        if token == "{":
            return self.enumeration() if self.next_is("enum") else self.structure()
        if token == "[":
            return self.array("array", "]")
        if token == "<":
            return self.array("varray", ">")
        if token == "*":
            if self.next_is("!"):
                self.take("!")
                return ("pointer", None)
            return ("pointer", self.format())
        if token == "!":
            self.take("*")
            return ("pointer", None)
        if token.isdigit():
            return ("raw", int(token))
        return ("primitive", token) if token in PRIMITIVE_CODES else ("named", token)

    def structure(self):
        members = []
        while not self.next_is("}"):
            members.append(self.format())
            if not self.next_is("}"):
                self.take(",")
        self.take("}")
        return ("struct", tuple(members))

    def enumeration(self):
        self.take("enum")
        if self.next_is(":"):
            self.take(":")
            largest = int(self.take())
            self.take("}")
            return ("enum", largest, ())
        names = [self.take()]
        while self.take(",", "}") == ",":
            names.append(self.take())
        return ("enum", len(names) - 1, tuple(names))

    def array(self, kind, end):
        item = self.format()
        self.take(":")
        dims = [int(self.take())]
        while self.take(",", end) == ",":
            dims.append(int(self.take()))
        return (kind, item, tuple(dims))


# ---------------------------------------------------------------------- encoding


class _Writer:
    def __init__(self, order, long_size, filler):
        self.order, self.long_size, self.filler = order, long_size, filler
        self.parts = []

    def number(self, code, value):
        self.parts.append(struct.pack(self.order + code, value))

    def int(self, value):
        self.number("i", value)

    def string(self, value):
        raw = value.encode("latin-1") if isinstance(value, str) else value
        if not raw:
            self.int(0)
            self.parts.append(self.filler)
        else:
            self.int(len(raw))
            self.parts.append(raw)

    def format(self, fmt):
        if fmt is None:
            self.int(-1)
            return
        kind = fmt[0]
        self.int(KINDS[kind])
        if kind == "primitive":
            self.int(PRIMITIVE_CODES[fmt[1]])
        elif kind == "raw":
            self.int(fmt[1])
        elif kind == "struct":
            self.int(len(fmt[1]) + 1)
            for member in fmt[1]:
                self.format(member)
        elif kind == "pointer":
            self.parts.append(self.filler if fmt[1] else b"\0")
            if fmt[1]:
                self.format(fmt[1])
        elif kind in ("array", "varray"):
            self.int(len(fmt[2]) + 2)
            self.format(fmt[1])
            for dim in fmt[2]:
                self.int(dim)
        elif kind == "named":
            self.string(fmt[1])
        elif kind == "enum":
            self.int(len(fmt[2]) + 2)
            self.int(fmt[1])
            for name in fmt[2]:
                self.string(name)

    def value(self, fmt, value, enclosing=None):
        kind = fmt[0]
        if kind == "primitive":
            self.primitive(fmt[1], value)
        elif kind == "raw":
            self.parts.append(value)
        elif kind == "struct":
            for member, item in zip(fmt[1], value, strict=True):
                self.value(member, item, fmt)
        elif kind == "pointer":
            self.parts.append(b"\0" if value is None else self.filler)
            if value is not None:
                self.value(fmt[1] or enclosing, value)
        elif kind == "array":
            self.items(fmt[1], value)
        elif kind == "varray":
            self.int(len(value))
            self.items(fmt[1], value)
        elif kind == "enum":
            self.int(fmt[2].index(value) if isinstance(value, str) else value)
        else:
            raise Malformed(f"cannot encode {fmt!r}")

    def primitive(self, name, value):
        if name == "string":
            self.string(value)
        elif name == "format":
            self.format(value)
        elif name == "char":
            self.parts.append(value.encode("latin-1"))
        elif name in ("long", "ulong"):
            self.number(LONGS[name, self.long_size], value)
        elif name == "X_IPC_REF_PTR":
            self.int(value[0])
            self.string(value[1])
        else:
            self.number(NUMBERS[name], value)

    def items(self, item, values):
        if item[0] == "primitive" and item[1] in BYTES and isinstance(values, (bytes, bytearray)):
            self.parts.append(bytes(values))
        else:
            for value in values:
                self.value(item, value)


def _format_of(fmt):
    return parse(fmt) if isinstance(fmt, str) else fmt


def encode(fmt, value, order="<", *, long_size=8, filler=b"Z"):
    """The bytes of a value; fmt is a text or a format, None gives no bytes."""
    fmt = _format_of(fmt)
    if fmt is None:
        return b""
    writer = _Writer(order, long_size, filler)
    writer.value(fmt, value)
    return b"".join(writer.parts)


# ---------------------------------------------------------------------- decoding


class _Reader:
    def __init__(self, data, order, long_size):
        self.data, self.order, self.long_size = data, order, long_size
        self.at = 0

    def take(self, length):
        if length < 0 or self.at + length > len(self.data):
            raise Malformed(f"{length} bytes wanted at {self.at} of {len(self.data)}")
        self.at += length
        return self.data[self.at - length:self.at]

    def number(self, code):
        return struct.unpack(self.order + code, self.take(struct.calcsize("=" + code)))[0]

    def int(self):
        return self.number("i")

    def count(self, smallest=0):
        count = self.int() - smallest
        if not 0 <= count <= len(self.data):
            raise Malformed(f"count {count}")
        return count

    def string(self):
        length = self.int()
        if length == 0:
            self.take(1)
            return None
        return bytes(self.take(length)).decode("latin-1")

    def format(self, inside=False):
        number = self.int()
        if number == -1 and not inside:
            return None
        kind = KIND_NAMES.get(number)
        if kind == "primitive":
            code = self.int()
            return (kind, PRIMITIVES.get(code, f"primitive {code}"))
        if kind == "raw":
            return (kind, self.int())
        if kind == "struct":
            return (kind, tuple(self.format(True) for _ in range(self.count(1))))
        if kind == "pointer":
            return (kind, self.format(True) if self.take(1) != b"\0" else None)
        if kind in ("array", "varray"):
            count = self.count(2)
            item = self.format(True)
            return (kind, item, tuple(self.int() for _ in range(count)))
        if kind == "bad":
            return (kind,)
        if kind == "named":
            return (kind, self.string())
        if kind == "enum":
            count, largest = self.count(2), self.int()
            return (kind, largest, tuple(self.string() for _ in range(count)))
        raise Malformed(f"format kind {number}")

    def value(self, fmt, enclosing=None):
        kind = fmt[0]
        if kind == "primitive":
            return self.primitive(fmt[1])
        if kind == "raw":
            return bytes(self.take(fmt[1]))
        if kind == "struct":
            return tuple(self.value(member, fmt) for member in fmt[1])
        if kind == "pointer":
            return None if self.take(1) == b"\0" else self.value(fmt[1] or enclosing)
        if kind == "array":
            count = 1
            for dim in fmt[2]:
                count *= dim
            return self.items(fmt[1], count)
        if kind == "varray":
            return self.items(fmt[1], self.count())
        if kind == "enum":
            number = self.int()
            return fmt[2][number] if 0 <= number < len(fmt[2]) else number
        raise Malformed(f"cannot decode {fmt!r}")

    def primitive(self, name):
        if name == "string":
            return self.string()
        if name == "format":
            return self.format()
        if name == "char":
            return bytes(self.take(1)).decode("latin-1")
        if name in ("long", "ulong"):
            return self.number(LONGS[name, self.long_size])
        if name == "X_IPC_REF_PTR":
            return (self.int(), self.string())
        if name not in NUMBERS:
            raise Malformed(f"cannot decode {name}")
        return self.number(NUMBERS[name])

    def items(self, item, count):
        if item[0] == "primitive" and item[1] in BYTES:
            return bytes(self.take(count))
        return [self.value(item) for _ in range(count)]


def decode(fmt, data, order="<", *, long_size=8):
    """The value that all of data encodes; raises Malformed when bytes are missing or left over."""
    fmt = _format_of(fmt)
    if fmt is None:
        if data:
            raise Malformed(f"{len(data)} bytes where none should be")
        return None
    reader = _Reader(data, order, long_size)
    value = reader.value(fmt)
    if reader.at != len(data):
        raise Malformed(f"{len(data) - reader.at} bytes left over")
    return value


#: Wire format of a message of variable length.
VARIABLE = "{int, <byte:1>}"


def variable(content, order="<"):
    """Frame data of a message of variable length with that content."""
    length = struct.pack(order + "i", len(content))
    return length + length + content


def content_of(data, order="<"):
    """The content bytes in the frame data of a message of variable length."""
    first, content = decode(VARIABLE, data, order)
    if first != len(content):
        raise Malformed(f"length {first} before {len(content)} bytes")
    return content
