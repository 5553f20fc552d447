"""What type hints of classes say about structures: formats, nested classes, conversions.

    int, float, bool, str       int, double, boolean, string
    Short, Float, ...           the formats of these names
    Annotated[T, "format"]      that format; in <...> members may be named instead of numbered
    Optional[T]                 *T, and *! for the class itself
    an enumeration              {enum ...}
    Tuple[T, T, T]              [T:3]
    List[T]                     <T:...>, behind an int that holds the length and is no attribute
    a class with hints          {...}
"""
from __future__ import annotations

import dataclasses
import enum
import sys
import typing
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

from typing import Annotated

Byte = Annotated[int, "byte"]
UByte = Annotated[int, "ubyte"]
Short = Annotated[int, "short"]
UShort = Annotated[int, "ushort"]
Int = Annotated[int, "int"]
UInt = Annotated[int, "uint"]
Long = Annotated[int, "long"]
ULong = Annotated[int, "ulong"]
Float = Annotated[float, "float"]
Double = Annotated[float, "double"]
Char = Annotated[str, "char"]

_SIMPLE = {bool: "boolean", int: "int", float: "double", str: "string"}


def type_hints(cls: type) -> Dict[str, Any]:
    """The hints of a class, with names resolved where that is possible."""
    try:
        return typing.get_type_hints(cls, localns={cls.__name__: cls}, include_extras=True)
    except (NameError, AttributeError, TypeError):
        return dict(getattr(cls, "__annotations__", {}))


def member_names(cls: type) -> List[str]:
    """The members of a class in order."""
    if dataclasses.is_dataclass(cls):
        return [field.name for field in dataclasses.fields(cls) if field.init]
    declared = getattr(cls, "_fields", None)
    if isinstance(declared, str):
        return [declared]
    if declared is not None:
        return [entry if isinstance(entry, str) else entry[0] for entry in declared]
    return [name for name in type_hints(cls) if not name.startswith("_")]


# ------------------------------------------------------------- parts of a hint

def _annotation(hint: Any) -> Tuple[Any, Optional[str]]:
    """A hint without its annotation, and the format that this gives."""
    if typing.get_origin(hint) is Annotated:
        inner, *notes = typing.get_args(hint)
        return inner, next((note for note in notes if isinstance(note, str)), None)
    return hint, None


def _optional(hint: Any) -> Any:
    """T of Optional[T], None for others."""
    origin = typing.get_origin(hint)
    if origin is Union or type(hint).__name__ == "UnionType":
        inner = [part for part in typing.get_args(hint) if part is not type(None)]
        if len(inner) == 1 and len(typing.get_args(hint)) == 2:
            return inner[0]
    return None


def _is_numpy(hint: Any) -> bool:
    numpy = sys.modules.get("numpy")
    hint = _annotation(hint)[0]
    return numpy is not None and (typing.get_origin(hint) or hint) is numpy.ndarray


def class_in(hint: Any) -> Optional[type]:
    """The class of the structures in a value of that type, the first one found."""
    hint = _annotation(hint)[0]
    if isinstance(hint, type) and not typing.get_args(hint):
        is_other = hint.__module__ in ("builtins", "numpy") or issubclass(hint, enum.Enum)
        return None if is_other else hint
    if _is_numpy(hint):
        return None
    for argument in typing.get_args(hint):
        found = class_in(argument)
        if found is not None:
            return found
    return None


# --------------------------------------------------------------------- formats

def format_of(hint: Any) -> str:
    """The format of a type."""
    return _format(hint, None)


def _format(hint: Any, enclosing: Optional[type]) -> str:
    inner, text = _annotation(hint)
    if text is not None:
        return text
    target = _optional(inner)
    if target is not None:
        is_self = enclosing is not None and _annotation(target)[0] in (enclosing,
                                                                      enclosing.__name__)
        return "*!" if is_self else "*" + _format(target, None)
    if inner in _SIMPLE:
        return _SIMPLE[inner]
    if isinstance(inner, type) and issubclass(inner, enum.Enum):
        return _format_of_enumeration(inner)
    if typing.get_origin(inner) is tuple:
        return _format_of_tuple(inner)
    if isinstance(inner, type) and not typing.get_args(inner) and member_names(inner):
        return format_of_class(inner)
    raise TypeError(f"no format follows from the type {hint!r}; Annotated[..., 'format'] gives one")


def _format_of_enumeration(cls: Any) -> str:
    values = [member.value for member in cls]
    if not all(isinstance(value, int) for value in values) or min(values) < 0:
        return "int"
    if values == list(range(len(values))):
        return "{enum " + ", ".join(member.name for member in cls) + "}"
    return f"{{enum : {max(values)}}}"


def _format_of_tuple(hint: Any) -> str:
    parts = typing.get_args(hint)
    if not parts or parts[-1] is Ellipsis or any(part != parts[0] for part in parts):
        raise TypeError(f"{hint!r} is no array: a tuple has to have a number of equal elements")
    return f"[{_format(parts[0], None)}:{len(parts)}]"


def is_list(hint: Any) -> bool:
    """Whether a member is a variable array whose length is no attribute."""
    inner, text = _annotation(hint)
    return text is None and typing.get_origin(inner) is list


def format_of_class(cls: type) -> str:
    """The format of a class with hints, or the one that it says it has, as those of xdrgen do."""
    declared = getattr(cls, "IPC_FORMAT", None)
    if isinstance(declared, str):
        return declared
    hints = type_hints(cls)
    parts: List[str] = []
    places: Dict[str, int] = {}
    for name in member_names(cls):
        if name not in hints:
            raise TypeError(f"{cls.__name__}.{name} has no type hint, so no format follows")
        if is_list(hints[name]):
            element, = typing.get_args(_annotation(hints[name])[0])
            parts += ["int", f"<{_format(element, None)}:{len(parts) + 1}>"]
        else:
            parts.append(_format(hints[name], cls))
        places[name] = len(parts)
    return "{" + ", ".join(_numbered(part, places) for part in parts) + "}"


def _numbered(text: str, places: Dict[str, int]) -> str:
    """The format of a member, with numbers for the names of members in <...:name>."""
    if not text.startswith("<") or not text.endswith(">"):
        return text
    element, _, names = text[1:-1].rpartition(":")
    numbers = [str(places.get(name.strip(), name.strip())) for name in names.split(",")]
    return f"<{element}:{','.join(numbers)}>"


# ------------------------------------------------------------------- decoding

Conversion = Callable[[Any], Any]


def conversion(hint: Any) -> Optional[Conversion]:
    """What makes a decoded value one of that type, None if nothing is to be done."""
    inner, _ = _annotation(hint)
    target = _optional(inner)
    if target is not None:
        convert = conversion(target)
        return None if convert is None else lambda value: (
            None if value is None else convert(value))
    if isinstance(inner, type) and issubclass(inner, enum.Enum):
        return _to_member(inner)
    if inner is bytes:
        return lambda value: bytes(value) if not value or isinstance(value[0], int) else (
            "".join(value).encode("latin-1"))
    if inner is str:
        return lambda value: "".join(value) if isinstance(value, list) else value
    if typing.get_origin(inner) in (tuple, list):
        return _to_sequence(inner)
    return None


def _to_member(cls: Any) -> Conversion:
    def convert(value: Any) -> Any:
        try:
            return cls(value)
        except ValueError:
            return value
    return convert


def _to_sequence(hint: Any) -> Optional[Conversion]:
    parts = typing.get_args(hint)
    element = conversion(parts[0]) if parts else None
    kind = typing.get_origin(hint)
    if element is None:
        return tuple if kind is tuple else None
    return lambda value: kind(map(element, value))


def member_hints(cls: type, names: Sequence[str]) -> List[Any]:
    """The hints of members, None where there is none."""
    hints = type_hints(cls)
    return [hints.get(name) for name in names]


def wants_numpy(hint: Any) -> bool:
    """Whether arrays of a member are to be arrays of NumPy."""
    target = _optional(_annotation(hint)[0])
    return _is_numpy(hint if target is None else target)
