"""Calls into the C library: exceptions of handlers, Ctrl-C, waits that end early.

A call in which handlers may run is made through listen().  An exception of a handler is kept until
the library returns and then goes on its way from there; the library is asked to return soon.
"""
from __future__ import annotations

import sys
import threading
from types import TracebackType
from typing import Any, Callable, Optional, Tuple, Type

from ._ffi import ffi, lib
from .constants import IPC_Not_Connected, IPC_RETURN_TYPE
from .errors import IPCError, Texts, raise_error, result
from .output import log_texts


class _Call:
    """A call that is under way in a thread, and what it has to hand on."""

    failure: Optional[BaseException] = None
    lost = False
    enough: Optional[Callable[[], bool]] = None


class _Thread(threading.local):
    call: Optional[_Call] = None


_thread = _Thread()


def waits(function: Callable[..., int], *arguments: Any,
          enough: Optional[Callable[[], bool]] = None) -> int:
    """Calls a function of the library in which this thread may wait, and handlers may run.

    The wait ends early when enough() is true.
    """
    outer = _thread.call
    call = _thread.call = _Call()
    if enough is not None:
        call.enough = enough
    try:
        number = function(*arguments)
    finally:
        _thread.call = outer
    if Texts.are_captured:
        log_texts()
    if call.failure is not None:
        failure, call.failure = call.failure, None
        raise failure
    if call.lost:
        lib.IPC_errno = IPC_Not_Connected
        return int(raise_error())
    return number


def listen(function: Callable[..., int], *arguments: Any) -> IPC_RETURN_TYPE:
    """The same for functions that return IPC_RETURN_TYPE."""
    return result(waits(function, *arguments))


#: Bytes of this number and more are not copied; a copy of fewer is quicker than a view of them.
LARGE = int(lib.GLUE_LARGE)


def waits_with(function: Callable[..., int], before: Tuple[Any, ...], length: int, content: Any,
               *after: Any) -> int:
    """Calls a function of the library that takes bytes behind other arguments."""
    if content is None:
        return waits(function, *before, length, ffi.NULL, *after)
    if length < LARGE:
        return waits(function, *before, length, bytes(content), *after)
    # Given back at once: what an exception keeps alive would not be otherwise.
    with ffi.from_buffer(content) as view:
        return waits(function, *before, length, view, *after)


def send(function: Callable[..., int], before: Tuple[Any, ...], length: int, content: Any,
         *after: Any) -> IPC_RETURN_TYPE:
    """The same for functions that return IPC_RETURN_TYPE."""
    return result(waits_with(function, before, length, content, *after))


def handler_failed(kind: Type[BaseException], failure: BaseException,
                   trace: Optional[TracebackType]) -> None:
    """Keeps an exception that left a handler for the call that the handler runs in."""
    call = _thread.call
    if isinstance(failure, IPCError):
        failure.in_handler = True
    if call is not None and call.failure is None:
        call.failure = failure.with_traceback(trace)
    else:
        report: Any = _Unraisable(kind, failure, trace)
        sys.unraisablehook(report)


class _Unraisable:
    """What sys.unraisablehook is told of an exception that cannot go anywhere."""

    def __init__(self, kind: Type[BaseException], failure: BaseException,
                 trace: Optional[TracebackType]) -> None:
        self.exc_type, self.exc_value, self.exc_traceback = kind, failure, trace
        self.err_msg = "Exception ignored in a handler of IPC"
        self.object: Any = None


@ffi.def_extern(onerror=handler_failed, error=1)  # type: ignore[untyped-decorator, unused-ignore]
def py_give_up() -> int:
    # Signal handlers of Python run here, in the main thread, and may raise.
    for _ in range(2):
        pass
    if Texts.are_captured:
        log_texts()
    call = _thread.call
    if call is None:
        return 0
    return int(call.failure is not None or call.lost or call.enough is not None and call.enough())


def lost() -> None:
    """The connection of the current context is lost: the call that noticed it fails."""
    if _thread.call is not None:
        _thread.call.lost = True


def begin() -> None:
    """Before the library is initialised or connected: that forgets what was arranged before."""
    if _State.ended:
        raise RuntimeError("IPC cannot be used while Python ends")
    _State.begun = True
    lib.glue_begin()


class _State:
    begun = False
    ended = False


def end() -> None:
    """Before Python ends: its functions are not called any more."""
    _State.ended = True
    if _State.begun:
        lib.glue_end()

