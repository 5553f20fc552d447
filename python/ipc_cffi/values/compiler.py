"""From the tree of a format to its codecs."""
from __future__ import annotations

import struct
import sys
from typing import Any, Dict, List, Optional, Tuple, Union

from .. import tree
from .arrays import FixedArray
from .codec import Codec, Content, Reader, Style
from .misfit import BadBytes, Misfit, expected
from .scalars import RawBytes, Scalar, enumeration, primitive
from .structures import (MemberStep, Pointer, ScalarStep, SelfStep, Step, Structure, VariableStep)

#: Bytes of a value, perhaps its own.
Encoded = Union[bytes, bytearray, memoryview]

#: What a frame can hold.
LARGEST = 256 * 1024 * 1024 - 8


def compile_type(node: tree.Type) -> Codec:
    """The codec of a tree."""
    if isinstance(node, tree.Primitive):
        return primitive(node.name)
    if isinstance(node, tree.Raw):
        return RawBytes(node.length)
    if isinstance(node, tree.Enumeration):
        return enumeration(node.names)
    if isinstance(node, tree.Pointer):
        return Pointer(compile_type(node.target))
    if isinstance(node, tree.FixedArray):
        return FixedArray(compile_type(node.element), node.dimensions)
    if isinstance(node, tree.Structure):
        return _compile_structure(node)
    raise ValueError(f"{tree.format_text(node)} stands outside of a structure")


def _compile_structure(node: tree.Structure) -> Structure:
    steps: List[Step] = []
    scalars: List[Scalar] = []
    least = 0

    def close_scalars(end: int) -> None:
        if scalars:
            steps.append(ScalarStep(end - len(scalars), list(scalars)))
            scalars.clear()
    for index, member in enumerate(node.members):
        if isinstance(member, tree.SelfPointer):
            close_scalars(index)
            steps.append(SelfStep(index))
            least += 1
        elif isinstance(member, tree.VariableArray):
            close_scalars(index)
            steps.append(VariableStep(index, compile_type(member.element), member.references))
            least += 4
        else:
            codec = compile_type(member)
            least += codec.least
            if isinstance(codec, Scalar):
                scalars.append(codec)
            else:
                close_scalars(index)
                steps.append(MemberStep(index, codec))
    close_scalars(len(node.members))
    return Structure(steps, len(node.members), least)


class Converter:
    """Encodes and decodes the values of one format."""

    def __init__(self, node: tree.Type) -> None:
        self.tree = node
        self.text = tree.format_text(node)
        self.codec = compile_type(node)
        self._pack = self.codec.pack
        self._readers: Dict[Tuple[str, bool, Optional[type]], Reader] = {}

    def encode(self, value: Any) -> Encoded:
        """The bytes of a value in this host's order; of an array perhaps its own.

        Raises TypeError, ValueError, OverflowError or AttributeError if it does not fit; the text
        says where.
        """
        if self._pack is not None:
            try:
                return self._pack(value)
            except Exception:  # it is looked at member by member
                pass
        block = self.codec.block(value) if isinstance(self.codec, FixedArray) else None
        out = self._encode(value) if block is None else block
        if len(out) > LARGEST:
            raise OverflowError(f"the data take {len(out)} bytes, a message can hold {LARGEST}")
        return out

    def _encode(self, value: Any) -> bytearray:
        out = bytearray()
        try:
            if value is None and not isinstance(self.tree, tree.Pointer):
                expected("data", value)
            self.codec.encode(value, out)
        except Misfit as misfit:
            raise misfit.error(self._root(value), self.text) from None
        return out

    def _root(self, value: Any) -> str:
        if isinstance(self.tree, tree.Structure) and type(value).__module__ != "builtins":
            return type(value).__name__
        return "data"

    def decode(self, data: Content, order: str = sys.byteorder, numpy: bool = False,
               cls: Optional[type] = None) -> Any:
        """The value of bytes in that order, with cls for its structures; raises BadBytes."""
        read = self._readers.get((order, numpy, cls))
        if read is None:
            read = self._readers[order, numpy, cls] = self.codec.reader(Style(order, numpy), cls)
        try:
            return read(data, 0)[0]
        except (struct.error, IndexError, MemoryError):
            raise BadBytes from None

    def fill(self, target: Any, decoded: Any) -> Any:
        """Puts a decoded value into an existing structure or list, and returns that."""
        if isinstance(self.codec, Structure):
            self.codec.fill(target, decoded)
        elif isinstance(self.codec, FixedArray) and isinstance(target, list):
            target[:] = decoded
        else:
            return decoded
        return target
