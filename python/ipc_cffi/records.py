"""Structures in Python: which attribute stands for which member [manual 3].

A class says with _fields in which order its attributes make up the structure, and of what class
nested structures are.  Dataclasses and named tuples say it by their annotations.
"""
from __future__ import annotations

import dataclasses
import operator
import reprlib
import sys
from typing import Any, Callable, Dict, List, Optional, Sequence, Set, Tuple

from . import hints

#: Stands for the value of an attribute that is not there.
MISSING: Any = type("MISSING", (), {"__repr__": lambda self: "nothing"})()

Getter = Callable[[Any], Sequence[Any]]
Builder = Callable[[List[Any]], Any]
Conversion = Callable[[Any], Any]


class IPCdata:
    """A structure: attributes, printed in the order of the class's _fields.

    Without _fields the members are _f0, _f1, ... with f0, f1, ... as other names of them.
    """

    _fields: Any

    def __init__(self, **members: Any) -> None:
        for name, value in members.items():
            setattr(self, name, value)

    def __getattr__(self, name: str) -> Any:
        # Called for attributes that are not found.
        if name[:1] == "f" and name[1:].isdigit() and "_" + name in self.__dict__:
            return self.__dict__["_" + name]
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __setattr__(self, name: str, value: Any) -> None:
        object.__setattr__(self, _stored_name(self, name), value)

    def __delattr__(self, name: str) -> None:
        object.__delattr__(self, _stored_name(self, name))

    def asdict(self) -> Dict[str, Any]:
        """The members by name, nested structures too."""
        return {name: _as_plain(getattr(self, name)) for name in _names_set(self)}

    def __repr__(self) -> str:
        return _shown(self)

    __str__ = __repr__


@reprlib.recursive_repr()
def _shown(record: IPCdata) -> str:
    named = hasattr(type(record), "_fields")
    parts = [f"{name}: {getattr(record, name)!r}" if named else repr(getattr(record, name))
             for name in _names_set(record)]
    return f"<{type(record).__name__}{': ' if parts else ''}{'; '.join(parts)}>"


def eq(a: Any, b: Any) -> bool:
    """Whether two values have equal members; == of IPCdata asks whether they are the same."""
    if isinstance(a, IPCdata) and isinstance(b, IPCdata):
        a, b = vars(a), vars(b)
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(eq(a[name], b[name]) for name in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(eq, a, b))
    equal = a == b
    return bool(equal.all() if hasattr(equal, "all") else equal)


def _stored_name(record: IPCdata, name: str) -> str:
    if name[:1] == "f" and name[1:].isdigit() and not hasattr(type(record), "_fields"):
        return "_" + name
    return name


def _names_set(record: IPCdata) -> List[str]:
    """The names of the members that have a value, in order."""
    if hasattr(type(record), "_fields"):
        return [name for name in hints.member_names(type(record)) if hasattr(record, name)]
    names: List[str] = []
    while f"_f{len(names)}" in record.__dict__:
        names.append(f"_f{len(names)}")
    return names


def _as_plain(value: Any) -> Any:
    if isinstance(value, IPCdata):
        return value.asdict()
    if isinstance(value, (list, tuple)):
        return [_as_plain(element) for element in value]
    return value


# ---------------------------------------------------------------------- fields

class Fields:
    """What a class says of itself as a structure of so many members.

    Lists of a class with type hints have a member before them that holds their length and is no
    attribute, if the structure has as many members as there are with these.
    """

    def __init__(self, cls: type, count: int) -> None:
        self.cls = cls
        self.count = count
        self.declared = getattr(cls, "_fields", None)
        self.by_constructor = (dataclasses.is_dataclass(cls) and self.declared is None
                               or issubclass(cls, tuple) and self.declared is not None)
        self.names: Tuple[Optional[str], ...]  # None for what is no attribute
        self._classes: Tuple[Any, ...]
        #: What is done to decoded values of members.
        self.conversions: Dict[int, Conversion] = {}
        #: Members whose arrays are to be NumPy's.
        self.numpy: Set[int] = set()
        if self.by_constructor or self.declared is None and cls.__dict__.get("__annotations__"):
            self._from_hints()
        else:
            self._from_declaration()
        self.get = self._getter()

    def _from_hints(self) -> None:
        declared = hints.member_names(self.cls)
        lists = sum(map(hints.is_list, hints.member_hints(self.cls, declared)))
        with_lengths = self.count == len(declared) + lists
        names: List[Optional[str]] = []
        classes: List[Any] = []
        for name, hint in zip(declared, hints.member_hints(self.cls, declared)):
            if with_lengths and hints.is_list(hint):
                names.append(None)
                classes.append(None)
            self._convert(len(names), hint)
            names.append(name)
            classes.append(hints.class_in(hint))
        self.names, self._classes = tuple(names), tuple(classes)

    def _from_declaration(self) -> None:
        declared = self.declared
        entries = [declared] if isinstance(declared, str) else list(declared or ())
        names, classes = [], []
        for entry in entries:
            name, cls = (entry, None) if isinstance(entry, str) else (entry[0], entry[1])
            if isinstance(cls, (tuple, list)):
                cls = cls[0] if cls else None
            names.append(name)
            classes.append(cls)
        self.names, self._classes = tuple(names), tuple(classes)
        if dataclasses.is_dataclass(self.cls):
            for index, hint in enumerate(hints.member_hints(self.cls, names)):
                self._convert(index, hint)

    def _convert(self, index: int, hint: Any) -> None:
        """Heeds the type of a member, beyond what class its structures have."""
        convert = hints.conversion(hint)
        if convert is not None:
            self.conversions[index] = convert
        if hints.wants_numpy(hint):
            self.numpy.add(index)

    def class_of(self, index: int) -> Optional[type]:
        """The class of the structures in a member, None if nothing is said about them."""
        cls = self._classes[index] if index < len(self._classes) else None
        if isinstance(cls, str):
            cls = self._look_up(cls)
        if not isinstance(cls, type) or cls.__module__ == "builtins":
            return None
        return cls

    def _look_up(self, name: str) -> Any:
        module, _, simple = name.rpartition(".")
        module = module or self.cls.__module__
        found = getattr(sys.modules.get(module), simple, None)
        if found is None and simple == self.cls.__name__:
            return self.cls
        if found is None:
            raise NameError(f"{self.cls.__name__}._fields names the class {name!r}, "
                            f"which is not in module {module}")
        return found

    def name(self, index: int) -> str:
        """The attribute that a member is set by."""
        name = self.names[index] if index < len(self.names) else None
        return name or f"_f{index}"

    def shown(self, index: int) -> str:
        """What a member is called in messages."""
        name = self.names[index] if index < len(self.names) else None
        return name or f"f{index}"

    # -------------------------------------------------- values of the members

    def _getter(self) -> Getter:
        names = self.names[:self.count]
        if len(names) == self.count > 1 and None not in names:
            return operator.attrgetter(*names)  # type: ignore[arg-type, unused-ignore]
        return self.each

    def each(self, value: Any) -> List[Any]:
        """The values of the members; MISSING where there is no attribute."""
        return [self._member(value, index) for index in range(self.count)]

    def _member(self, value: Any, index: int) -> Any:
        if index < len(self.names):
            name = self.names[index]
            return MISSING if name is None else _attribute(value, name)
        found = _attribute(value, f"_f{index}")
        return _attribute(value, f"f{index}") if found is MISSING else found


_known: Dict[Tuple[type, int], Fields] = {}


def fields_of(cls: type, count: int) -> Fields:
    """The fields of a class, looked at again if it has been given others."""
    fields = _known.get((cls, count))
    if fields is None or fields.declared is not getattr(cls, "_fields", None):
        fields = _known[cls, count] = Fields(cls, count)
    return fields


# --------------------------------------------------------- members of a value

_PLAIN = (str, bytes, bytearray, int, float, complex, type(None))


def members_of(value: Any, count: int) -> Sequence[Any]:
    """The values of the members of a structure; MISSING where there is no attribute.

    Raises TypeError or ValueError for what is no structure of that many members.
    """
    if isinstance(value, (list, tuple)) and not hasattr(value, "_fields"):
        if len(value) != count:
            raise ValueError(f"expected {count} members, got {len(value)}")
        return value
    if isinstance(value, dict):
        return _members_of_dict(value, count)
    if isinstance(value, _PLAIN):
        raise TypeError(f"expected a structure, got {reprlib.repr(value)}")
    fields = fields_of(type(value), count)
    try:
        return fields.get(value)
    except AttributeError:
        return fields.each(value)


def _attribute(value: Any, name: str) -> Any:
    try:
        return getattr(value, name)
    except AttributeError:
        # One that a property raises is the program's own.
        if isinstance(getattr(type(value), name, None), property):
            raise
        return MISSING


def _members_of_dict(value: Dict[str, Any], count: int) -> List[Any]:
    if not value or "f0" in value or "_f0" in value:
        return [value.get(f"_f{k}", value.get(f"f{k}", MISSING)) for k in range(count)]
    if len(value) != count:
        raise ValueError(f"expected {count} members, got {len(value)}: {', '.join(map(str, value))}")
    return list(value.values())


# ------------------------------------------------------------------- building

def builder(cls: type, count: int) -> Builder:
    """Makes structures of a class from the values of their members."""
    fields = fields_of(cls, count)
    if fields.conversions:
        return _converting(fields, _builder(fields))
    return _builder(fields)


def _converting(fields: Fields, build: Builder) -> Builder:
    def convert_and_build(values: List[Any]) -> Any:
        for index, convert in fields.conversions.items():
            values[index] = convert(values[index])
        return build(values)
    return convert_and_build


def _builder(fields: Fields) -> Builder:
    cls, count = fields.cls, fields.count
    if fields.by_constructor:
        if len(fields.names) != count:
            raise TypeError(f"{cls.__name__} has {len(fields.names)} members, "
                            f"the format has {count}")
        return lambda values: cls(**{name: value for name, value in zip(fields.names, values)
                                     if name is not None})
    names = tuple(fields.name(index) for index in range(count))
    if _takes_attributes_plainly(cls, names):
        make = _plain_maker(cls)

        def build(values: List[Any]) -> Any:
            record = make(cls)
            record.__dict__.update(zip(names, values))
            return record
        return build

    def build_by_setting(values: List[Any]) -> Any:
        record = cls()
        for name, value in zip(names, values):
            setattr(record, name, value)
        return record
    return build_by_setting


def _plain_maker(cls: type) -> Callable[[type], Any]:
    """What makes an empty object of the class: without a call of __init__ that would do nothing."""
    new: Any = object.__new__
    plain: Tuple[Any, ...] = (object.__init__, IPCdata.__init__)
    does_nothing = getattr(cls, "__new__") is new and getattr(cls, "__init__") in plain
    return new if does_nothing else lambda cls: cls()


def _takes_attributes_plainly(cls: type, names: Sequence[str]) -> bool:
    """Whether setting these attributes does nothing but put them into the object's dictionary."""
    plain: Tuple[Any, ...] = (object.__setattr__, IPCdata.__setattr__)
    return (cls.__setattr__ in plain
            and getattr(cls, "__dictoffset__", 0) != 0
            and not any(hasattr(getattr(cls, name, None), "__set__") for name in names))
