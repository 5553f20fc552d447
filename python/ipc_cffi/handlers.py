"""Handlers of Python, and how the library reaches them.

The library knows a registration by its number, which it hands back with each call.  A number that
is not in the table any more means nothing: late calls do no harm.
"""
from __future__ import annotations

import itertools
import threading
from typing import Any, Callable, Dict, Generic, Iterator, List, Optional, TypeVar

from ._ffi import ffi, lib
from .arguments import to_text
from .library import LARGE, handler_failed
from .values import Content

Handler = Callable[..., Any]


class MSG_INSTANCE:
    """A message that has arrived, while its handler runs or its response is delayed."""

    __slots__ = ("pointer",)

    def __init__(self, pointer: Any) -> None:
        self.pointer = pointer

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MSG_INSTANCE) and bool(self.pointer == other.pointer)

    def __hash__(self) -> int:
        return hash(self.pointer)

    def __repr__(self) -> str:
        return f"<IPC message instance {int(ffi.cast('uintptr_t', self.pointer)):#x}>"


def check_handler(handler: Any) -> None:
    """A handler has to be something that can be called; None is the library's to refuse."""
    if not callable(handler):
        raise TypeError(f"a handler has to be callable, {type(handler).__name__} is not")


def handler_name(handler: Handler) -> str:
    return str(getattr(handler, "__qualname__", None) or type(handler).__name__)


def address(context: Any) -> int:
    """What stands for a context in the tables."""
    return int(ffi.cast("uintptr_t", context))


def current_context() -> int:
    return address(lib.IPC_getContext())


# -------------------------------------------------------------- registrations

class Registration:
    """Something that the library calls.  context is 0 for what belongs to the process."""

    def __init__(self, context: int) -> None:
        self.number = next(_numbers)
        self.context = context
        _registrations[self.number] = self

    def end(self) -> None:
        """The library's calls mean nothing from now on."""
        _registrations.pop(self.number, None)

    def arrived(self, instance: MSG_INSTANCE, content: Content, order: str) -> None:
        """A message or a reply."""

    def happened(self, *arguments: Any) -> None:
        """Anything else."""


_numbers = itertools.count(1)
_registrations: Dict[int, Registration] = {}

#: Guards what is made of several steps in the tables; never held while the library is called.
tables = threading.RLock()

R = TypeVar("R", bound=Registration)


class Table(Generic[R]):
    """Registrations by a key, several for each, told apart by their handlers."""

    def __init__(self) -> None:
        self._entries: Dict[Any, List[R]] = {}
        _all_tables.append(self)

    def find(self, key: Any, handler: Handler) -> Optional[R]:
        for registration in self._entries.get(key, ()):
            if registration.handler == handler:  # type: ignore[attr-defined]
                return registration
        return None

    def of(self, key: Any) -> List[R]:
        return list(self._entries.get(key, ()))

    def add(self, key: Any, registration: R) -> None:
        with tables:
            self._entries.setdefault(key, []).append(registration)

    def remove(self, key: Any, registration: R) -> None:
        registration.end()
        with tables:
            entries = self._entries.get(key, [])
            if registration in entries:
                entries.remove(registration)
            if not entries:
                self._entries.pop(key, None)

    def forget(self, context: int) -> None:
        for key in list(self._entries):
            for registration in self.of(key):
                if registration.context == context:
                    self.remove(key, registration)

    def __iter__(self) -> Iterator[Any]:
        return iter(list(self._entries))


_all_tables: List[Table[Any]] = []


def forget_context(context: Any) -> None:
    """A connection has ended, and with it all that was registered there."""
    gone = address(context)
    if gone == 0:
        return
    for table in _all_tables:
        table.forget(gone)
    for registration in list(_registrations.values()):
        if registration.context == gone:
            registration.end()


# ------------------------------------------------------------------ the calls

def _view(content: Any, length: int) -> memoryview:
    """The bytes of a byte array of the library where they lie; they are freed with the view."""
    owned = ffi.gc(content, lib.IPC_freeByteArray)
    return memoryview(ffi.buffer(owned, length)).toreadonly()


def taken(content: Any, length: int) -> Content:
    """The bytes of a byte array of the library, which is not needed any more."""
    if content == ffi.NULL:
        return b""
    if length >= LARGE:
        return _view(content, length)
    data = bytes(ffi.buffer(content, length))
    lib.IPC_freeByteArray(content)
    return data


def run(handler: Handler, *arguments: Any) -> None:
    """Calls one of several handlers, so that the others are called even if it fails."""
    try:
        handler(*arguments)
    except BaseException as failure:
        handler_failed(type(failure), failure, failure.__traceback__)


@ffi.def_extern(onerror=handler_failed)  # type: ignore[untyped-decorator, unused-ignore]
def py_message(instance: Any, content: Any, length: int, is_big_endian: int,
               number: int) -> None:
    # The library frees what is copied here, and leaves the others to their view.
    data = _view(content, length) if length >= LARGE else (
        ffi.unpack(content, length) if length else b"")
    registration = _registrations.get(number)
    if registration is not None:
        registration.arrived(MSG_INSTANCE(instance), data, "big" if is_big_endian else "little")


def _happened(number: int, *arguments: Any) -> None:
    registration = _registrations.get(number)
    if registration is not None:
        registration.happened(*arguments)


@ffi.def_extern(onerror=handler_failed)  # type: ignore[untyped-decorator, unused-ignore]
def py_descriptor(fd: int, number: int) -> None:
    _happened(number, fd)


@ffi.def_extern(onerror=handler_failed)  # type: ignore[untyped-decorator, unused-ignore]
def py_connect(module: Any, number: int) -> None:
    _happened(number, to_text(module))


@ffi.def_extern(onerror=handler_failed)  # type: ignore[untyped-decorator, unused-ignore]
def py_disconnect(module: Any, number: int) -> None:
    _happened(number, to_text(module))


@ffi.def_extern(onerror=handler_failed)  # type: ignore[untyped-decorator, unused-ignore]
def py_connection(connected: int, number: int) -> None:
    _happened(number, bool(connected))


@ffi.def_extern(onerror=handler_failed)  # type: ignore[untyped-decorator, unused-ignore]
def py_change(message: Any, n_handlers: int, number: int) -> None:
    _happened(number, to_text(message), n_handlers)


@ffi.def_extern(onerror=handler_failed)  # type: ignore[untyped-decorator, unused-ignore]
def py_timer(number: int, now: int, scheduled: int) -> None:
    _happened(number, now, scheduled)
