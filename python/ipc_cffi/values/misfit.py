"""What is said of values that do not fit their format, and of bytes that do not."""
from __future__ import annotations

import reprlib
from typing import Any, List, NoReturn, Type


class BadBytes(Exception):
    """The bytes do not hold a value of the format."""


class Misfit(Exception):
    """A value does not fit.  On its way out it is told by each level where that was."""

    def __init__(self, kind: Type[Exception], text: str) -> None:
        super().__init__(text)
        self.kind = kind
        self.text = text
        self._path: List[str] = []

    def inside(self, step: str) -> Misfit:
        """The value was there, seen from one level further out."""
        self._path.append(step)
        return self

    def error(self, root: str, format_text: str) -> Exception:
        """The exception that the program gets."""
        path = root + "".join(reversed(self._path))
        return self.kind(f"{path}: {self.text} (format {shortened(format_text)})")


def shortened(text: str) -> str:
    return text if len(text) <= 200 else text[:197] + "..."


def expected(what: str, value: Any) -> NoReturn:
    """The value is of another kind."""
    raise Misfit(TypeError, f"expected {what}, got {reprlib.repr(value)}")


def outside(what: str, low: int, high: int, value: Any) -> NoReturn:
    """The value is of the right kind and too large or too small."""
    raise Misfit(OverflowError, f"expected {what} ({low} to {high}), got {reprlib.repr(value)}")


def member_step(name: str) -> str:
    return f".{name}"
