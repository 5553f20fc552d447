"""Codecs of structures and pointers.

A structure is a list of steps over the values of its members: scalars that stand side by side are
one step, every other member is one of its own.  Self pointers, of which lists and trees are made,
are followed in a loop and not by recursion, so that they may be of any length.
"""
from __future__ import annotations

import reprlib
import struct
from typing import Any, Callable, Dict, List, Optional, Sequence, Set, Tuple

from ..records import MISSING, Fields, IPCdata, builder, fields_of, members_of
from .arrays import check_sequence, encode_nested, row_of, shaped
from .codec import Codec, Content, Reader, Style
from .misfit import BadBytes, Misfit, expected, member_step
from .scalars import NATIVE, Scalar

#: Where a value of a member begins, and the step behind it.
ReadStep = Callable[[Content, int, List[Any]], int]


class Pointer(Codec):
    """A value that may be absent."""

    least = 1

    def __init__(self, target: Codec) -> None:
        self._target = target

    def encode(self, value: Any, out: bytearray) -> None:
        if value is None:
            out.append(0)
        else:
            out += b"Z"
            self._target.encode(value, out)

    def reader(self, style: Style, cls: Optional[type]) -> Reader:
        read_target = self._target.reader(style, cls)

        def read(data: Content, at: int) -> Tuple[Any, int]:
            return read_target(data, at + 1) if data[at] else (None, at + 1)
        return read


# ----------------------------------------------------------------------- steps

class Step:
    """A part of a structure: members from first on."""

    first: int
    count = 1

    def encode(self, values: Sequence[Any], out: bytearray, names: Fields) -> None:
        raise NotImplementedError

    def reader(self, style: Style, fields: Fields) -> ReadStep:
        raise NotImplementedError


def _refuse_missing(value: Any, names: Fields, index: int) -> None:
    if value is MISSING:
        raise Misfit(AttributeError,
                     f"{names.cls.__name__} has no attribute for member {index + 1}"
                     ).inside(member_step(names.shown(index)))


def _style_of(style: Style, fields: Fields, index: int) -> Style:
    """The style for a member, which the class may have wishes for."""
    return style._replace(numpy=True) if index in fields.numpy else style


class ScalarStep(Step):
    """Scalars side by side."""

    def __init__(self, first: int, codecs: Sequence[Scalar]) -> None:
        self.first, self.count = first, len(codecs)
        self._codecs = codecs
        self._codes = "".join(codec.code for codec in codecs)
        #: All members at once, if struct itself refuses what is wrong.
        self.pack: Optional[Callable[..., bytes]] = None
        if all(codec.to_wire is None for codec in codecs):
            self.pack = struct.Struct(NATIVE + self._codes).pack
        self._from_wire = [(index, codec.from_wire) for index, codec in enumerate(codecs)
                           if codec.from_wire is not None]

    def encode(self, values: Sequence[Any], out: bytearray, names: Fields) -> None:
        numbers = values[self.first:self.first + self.count]
        if self.pack is not None:
            try:
                out += self.pack(*numbers)
                return
            except Exception:  # the members are looked at one by one
                pass
        for offset, codec in enumerate(self._codecs):
            index = self.first + offset
            _refuse_missing(numbers[offset], names, index)
            try:
                codec.encode(numbers[offset], out)
            except Misfit as misfit:
                raise misfit.inside(member_step(names.shown(index))) from None

    def reader(self, style: Style, fields: Fields) -> ReadStep:
        unpacker = struct.Struct(style.prefix + self._codes)
        unpack, size, from_wire = unpacker.unpack_from, unpacker.size, self._from_wire

        def read(data: Content, at: int, values: List[Any]) -> int:
            values.extend(unpack(data, at))
            return at + size

        def read_and_convert(data: Content, at: int, values: List[Any]) -> int:
            start = len(values)
            values.extend(unpack(data, at))
            for index, convert in from_wire:
                values[start + index] = convert(values[start + index])
            return at + size
        return read_and_convert if from_wire else read


class MemberStep(Step):
    """One member of any other type."""

    def __init__(self, first: int, codec: Codec) -> None:
        self.first = first
        self._codec = codec

    def encode(self, values: Sequence[Any], out: bytearray, names: Fields) -> None:
        value = values[self.first]
        try:
            self._codec.encode(value, out)
        except Misfit as misfit:
            _refuse_missing(value, names, self.first)
            raise misfit.inside(member_step(names.shown(self.first))) from None

    def reader(self, style: Style, fields: Fields) -> ReadStep:
        read_member = self._codec.reader(_style_of(style, fields, self.first),
                                         fields.class_of(self.first))

        def read(data: Content, at: int, values: List[Any]) -> int:
            value, at = read_member(data, at)
            values.append(value)
            return at
        return read


class VariableStep(Step):
    """A variable array: the number of its elements, and these.

    Its sizes are other members, which may follow it, so the elements are read in a row and put into
    shape when the structure is complete.
    """

    def __init__(self, first: int, element: Codec, references: Sequence[int]) -> None:
        self.first = first
        self.references = references
        self._row = row_of(element)

    # Sizes that the program has not set are taken from the array.

    def supply_sizes(self, values: List[Any]) -> None:
        """Sets the sizes that are missing or None."""
        part: Any = values[self.first]
        for index in self.references:
            if values[index] is MISSING or values[index] is None:
                values[index] = 0 if part is None or part is MISSING else _length(part)
            part = _first_element(part)

    def encode(self, values: Sequence[Any], out: bytearray, names: Fields) -> None:
        array = values[self.first]
        _refuse_missing(array, names, self.first)
        dimensions = [_size(values[index], names, index) for index in self.references]
        count = _product(dimensions)
        out += _pack_count(count)
        if count == 0 and array is None:
            return
        try:
            if count == 0:
                check_sequence(array, 0, self._row)
            else:
                encode_nested(self._row, array, dimensions, out)
        except Misfit as misfit:
            raise misfit.inside(member_step(names.shown(self.first))) from None

    def reader(self, style: Style, fields: Fields) -> ReadStep:
        count = struct.Struct(style.prefix + "i").unpack_from
        read_row = self._row.reader(_style_of(style, fields, self.first),
                                    fields.class_of(self.first)).read

        def read(data: Content, at: int, values: List[Any]) -> int:
            elements, at = read_row(data, at + 4, count(data, at)[0])
            values.append(elements)
            return at
        return read

    def put_into_shape(self, values: List[Any]) -> None:
        """Checks the number of elements against the sizes, and nests the elements."""
        try:
            dimensions = [_first_part(values[index]) for index in self.references]
        except (TypeError, ValueError, IndexError):
            raise BadBytes from None
        elements = values[self.first]
        if min(dimensions) < 0 or _product(dimensions) != len(elements):
            raise BadBytes
        if len(dimensions) > 1:
            # Without elements there may be no end of empty rows.
            values[self.first] = shaped(elements, dimensions) if len(elements) else elements


_pack_count = struct.Struct(NATIVE + "i").pack


def _product(numbers: Sequence[int]) -> int:
    product = 1
    for number in numbers:
        product *= number
    return product


def _length(part: Any) -> int:
    try:
        return len(part)
    except TypeError:
        return 0


def _first_element(part: Any) -> Any:
    try:
        return part[0]
    except (TypeError, IndexError, KeyError):
        return ()


def _first_part(value: Any) -> int:
    """The number that a size is, also if it is the first part of something larger."""
    while isinstance(value, (list, tuple, IPCdata)) or hasattr(type(value), "_fields"):
        value = value[0] if isinstance(value, (list, tuple)) else members_of(value, 1)[0]
    return ord(value) if isinstance(value, (str, bytes)) else int(value)


def _size(value: Any, names: Fields, index: int) -> int:
    try:
        size = _first_part(value)
    except (TypeError, ValueError, IndexError):
        raise Misfit(TypeError, f"expected the size of an array, got {reprlib.repr(value)}"
                     ).inside(member_step(names.shown(index))) from None
    if not 0 <= size < 1 << 31:
        raise Misfit(ValueError, f"expected the size of an array, got {size}"
                     ).inside(member_step(names.shown(index)))
    return size


class SelfStep(Step):
    """A pointer to a structure of the enclosing kind; the structure itself does the work."""

    def __init__(self, first: int) -> None:
        self.first = first


# ------------------------------------------------------------------ structures

def _packer(step: ScalarStep, count: int) -> Optional[Callable[[Any], bytes]]:
    """Packs structures of scalars."""
    pack = step.pack
    if pack is None:
        return None

    def pack_structure(value: Any) -> bytes:
        return pack(*members_of(value, count))
    return pack_structure


class Structure(Codec):
    """A structure."""

    def __init__(self, steps: Sequence[Step], count: int, least: int) -> None:
        self._steps = steps
        self._count = count
        self.least = least
        self._variable = [step for step in steps if isinstance(step, VariableStep)]
        self._has_self = any(isinstance(step, SelfStep) for step in steps)
        if len(steps) == 1 and isinstance(steps[0], ScalarStep):
            self.pack = _packer(steps[0], count)
        self._plans: Dict[Tuple[Style, Fields], _Plan] = {}

    # -------------------------------------------------------------- encoding

    def _values(self, value: Any) -> List[Any]:
        try:
            values = list(members_of(value, self._count))
        except TypeError:
            expected("a structure", value)
        except ValueError as error:
            raise Misfit(ValueError, str(error)) from None
        for step in self._variable:
            step.supply_sizes(values)
        return values

    def encode(self, value: Any, out: bytearray) -> None:
        if self._has_self:
            self._encode_linked(value, out)
            return
        values = self._values(value)
        names = fields_of(type(value), self._count)
        for step in self._steps:
            step.encode(values, out, names)

    def _encode_linked(self, value: Any, out: bytearray) -> None:
        """Encodes this structure and those it leads to by self pointers."""
        nodes = [_Node(value, self._values(value), self._count)]
        on_the_way: Set[int] = {id(value)}
        try:
            while nodes:
                child = self._encode_up_to_pointer(nodes[-1], out)
                if child is MISSING:
                    on_the_way.discard(id(nodes.pop().value))
                    continue
                if id(child) in on_the_way:
                    raise Misfit(ValueError, "the structure leads back to itself")
                on_the_way.add(id(child))
                nodes.append(_Node(child, [], self._count))
                nodes[-1].values = self._values(child)
        except Misfit as misfit:
            raise self._inside_nodes(misfit, nodes) from None

    def _encode_up_to_pointer(self, node: _Node, out: bytearray) -> Any:
        """Goes on with a node; returns the one that it points to next, MISSING at the end."""
        while node.step < len(self._steps):
            step = self._steps[node.step]
            node.step += 1
            if not isinstance(step, SelfStep):
                step.encode(node.values, out, node.names)
                continue
            child = node.values[step.first]
            _refuse_missing(child, node.names, step.first)
            if child is None:
                out.append(0)
            else:
                out += b"Z"
                return child
        return MISSING

    def _inside_nodes(self, misfit: Misfit, nodes: List[_Node]) -> Misfit:
        """Says on which way the node was reached; of a long one the last part."""
        for node in reversed(nodes[-9:-1]):
            index = self._steps[node.step - 1].first
            misfit = misfit.inside(member_step(node.names.shown(index)))
        if len(nodes) > 9:
            misfit = misfit.inside(f" ({len(nodes) - 9} nodes on) ")
        return misfit

    # -------------------------------------------------------------- decoding

    def reader(self, style: Style, cls: Optional[type]) -> Reader:
        # Made when the first one is read: a class may be its own member's class.
        chosen, count = cls or IPCdata, self._count
        plan: Optional[_Plan] = None

        def read(data: Content, at: int) -> Tuple[Any, int]:
            nonlocal plan
            fields = fields_of(chosen, count)
            if plan is None or plan.fields is not fields:
                plan = self.plan(style, fields)
            return plan.read(data, at)
        return read

    def plan(self, style: Style, fields: Fields) -> _Plan:
        found = self._plans.get((style, fields))
        if found is None:
            found = self._plans[style, fields] = _Plan(self, style, fields)
        return found

    @property
    def steps(self) -> Sequence[Step]:
        return self._steps

    @property
    def count(self) -> int:
        return self._count

    @property
    def variable(self) -> Sequence[VariableStep]:
        return self._variable

    @property
    def has_self(self) -> bool:
        return self._has_self

    # ---------------------------------------------------------- filling in place

    def fill(self, target: Any, decoded: Any) -> None:
        """Gives an existing structure the members of a decoded one; keeps structures inside it."""
        fields = fields_of(type(target), self._count)
        values = members_of(decoded, self._count)
        for index, value in enumerate(values):
            name = fields.name(index)
            present = getattr(target, name, None)
            inner = self._structure_of(index)
            if inner is not None and present is not None and value is not None and (
                    isinstance(present, type(value))):
                inner.fill(present, value)
            else:
                setattr(target, name, value)

    def _structure_of(self, index: int) -> Optional[Structure]:
        for step in self._steps:
            if step.first == index and isinstance(step, MemberStep):
                codec = step._codec
                if isinstance(codec, Pointer):
                    codec = codec._target
                return codec if isinstance(codec, Structure) else None
        return None


class _Node:
    """A structure that is being encoded, and the step that is next."""

    __slots__ = ("value", "values", "names", "step")

    def __init__(self, value: Any, values: List[Any], count: int) -> None:
        self.value = value
        self.values = values
        self.names = fields_of(type(value), count)
        self.step = 0


class _Plan:
    """How a structure of one byte order becomes an object of one class."""

    def __init__(self, structure: Structure, style: Style, fields: Fields) -> None:
        self._structure = structure
        self._style = style
        self.fields = fields
        self.build = builder(fields.cls, structure.count)
        self.reads = [None if isinstance(step, SelfStep) else step.reader(style, fields)
                      for step in structure.steps]
        self.variable = structure.variable
        self.read = self._read_linked if structure.has_self else self._read_plain

    def _complete(self, values: List[Any]) -> Any:
        for step in self.variable:
            step.put_into_shape(values)
        return self.build(values)

    def _read_plain(self, data: Content, at: int) -> Tuple[Any, int]:
        values: List[Any] = []
        for read in self.reads:
            at = read(data, at, values)  # type: ignore[misc]
        return self._complete(values), at

    def child(self, index: int) -> _Plan:
        """The plan of the structure that a self pointer leads to: of its own class by default."""
        cls = self.fields.class_of(index)
        return self if cls is None else self._structure.plan(
            self._style, fields_of(cls, self._structure.count))

    def _read_linked(self, data: Content, at: int) -> Tuple[Any, int]:
        """Reads this structure and those it leads to; innermost are complete first."""
        steps = self._structure.steps
        nodes: List[_Half] = [_Half(self)]
        while True:
            node = nodes[-1]
            descended = False
            while node.step < len(steps):
                read = node.plan.reads[node.step]
                node.step += 1
                if read is not None:
                    at = read(data, at, node.values)
                    continue
                at += 1
                if data[at - 1]:
                    nodes.append(_Half(node.plan.child(steps[node.step - 1].first)))
                    descended = True
                    break
                node.values.append(None)
            if descended:
                continue
            complete = node.plan._complete(node.values)
            nodes.pop()
            if not nodes:
                return complete, at
            nodes[-1].values.append(complete)


class _Half:
    """A structure that is being read."""

    __slots__ = ("plan", "values", "step")

    def __init__(self, plan: _Plan) -> None:
        self.plan = plan
        self.values: List[Any] = []
        self.step = 0
