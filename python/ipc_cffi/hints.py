"""What type hints of classes say about structures."""
from __future__ import annotations

import typing
from typing import Any, List, Optional, Sequence


def type_hints(cls: type) -> Any:
    """The hints of a class, with names resolved where that is possible."""
    try:
        return typing.get_type_hints(cls, include_extras=True)
    except (NameError, AttributeError):
        return dict(getattr(cls, "__annotations__", {}))


def _class_in(hint: Any) -> Optional[type]:
    """The class of the structures in a value of that type, the first one found."""
    if isinstance(hint, type) and not typing.get_args(hint):
        return None if hint.__module__ == "builtins" else hint
    for argument in typing.get_args(hint):
        found = _class_in(argument)
        if found is not None:
            return found
    return None


def member_classes(cls: type, names: Sequence[str]) -> List[Optional[type]]:
    """The classes of nested structures, for the members of these names."""
    hints = type_hints(cls)
    return [_class_in(hints.get(name)) for name in names]
