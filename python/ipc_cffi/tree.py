"""Formats as trees.

The library parses format strings, and resolves the names in them.  A parsed format has a wire
image, the value of the primitive "format"; it is what the tree is read from.
"""
from __future__ import annotations

import struct
from typing import Any, NamedTuple, Tuple, Union


class Primitive(NamedTuple):
    name: str


class Raw(NamedTuple):
    length: int


class Structure(NamedTuple):
    members: Tuple[Any, ...]


class Pointer(NamedTuple):
    target: Any


class SelfPointer(NamedTuple):
    """To the structure that it is a member of."""


class FixedArray(NamedTuple):
    element: Any
    dimensions: Tuple[int, ...]


class VariableArray(NamedTuple):
    element: Any
    references: Tuple[int, ...]  # members of the enclosing structure that hold the sizes, from 0


class Enumeration(NamedTuple):
    largest: int
    names: Tuple[str, ...]


Type = Union[Primitive, Raw, Structure, Pointer, SelfPointer, FixedArray, VariableArray,
             Enumeration]

_PRIMITIVES = {16: "char", 5: "byte", 9: "ubyte", 17: "short", 28: "ushort", 6: "twobyte",
               1: "int", 29: "uint", 2: "boolean", 18: "long", 30: "ulong", 3: "float",
               4: "double", 7: "string", 8: "format", 20: "X_IPC_REF_PTR"}


class _Reader:
    """Reads the image, which has this host's byte order."""

    def __init__(self, image: bytes) -> None:
        self._image = image
        self._at = 0

    def _number(self) -> int:
        (number,) = struct.unpack_from("=i", self._image, self._at)
        self._at += 4
        return int(number)

    def _name(self) -> str:
        length = self._number()
        start = self._at
        self._at += max(length, 1)
        return self._image[start:start + length].decode("utf-8", "surrogateescape")

    def type(self) -> Type:
        kind, number = self._number(), None
        if kind == 3:
            self._at += 1
            return SelfPointer() if self._image[self._at - 1] == 0 else Pointer(self.type())
        number = self._number()
        if kind == 0:
            return Primitive(_PRIMITIVES[number])
        if kind == 1:
            return Raw(number)
        if kind == 2:
            return Structure(tuple(self.type() for _ in range(number - 1)))
        if kind == 4:
            return FixedArray(self.type(), tuple(self._number() for _ in range(number - 2)))
        if kind == 5:
            # 0 and 1 both mean the first member.
            return VariableArray(self.type(), tuple(max(self._number() - 1, 0)
                                                    for _ in range(number - 2)))
        if kind == 8:
            return Enumeration(self._number(), tuple(self._name() for _ in range(number - 2)))
        raise ValueError(f"unknown kind of format {kind}")


def read_tree(image: bytes) -> Type:
    """The tree of a format's wire image."""
    return _Reader(image).type()


def format_text(node: Type) -> str:
    """A format string of the tree."""
    if isinstance(node, Primitive):
        return node.name
    if isinstance(node, Raw):
        return str(node.length)
    if isinstance(node, Structure):
        return "{" + ", ".join(map(format_text, node.members)) + "}"
    if isinstance(node, Pointer):
        return "*" + format_text(node.target)
    if isinstance(node, SelfPointer):
        return "*!"
    if isinstance(node, FixedArray):
        return f"[{format_text(node.element)}:{','.join(map(str, node.dimensions))}]"
    if isinstance(node, VariableArray):
        numbers = ",".join(str(number + 1) for number in node.references)
        return f"<{format_text(node.element)}:{numbers}>"
    if node.names:
        return "{enum " + ", ".join(node.names) + "}"
    return f"{{enum : {node.largest}}}"
