"""Errors of the library as exceptions, and verbosity [manual 4.10 to 4.12, 4.39].

The C library always runs at a level that leaves the process alive.  What IPC_Exit_On_Errors means
in Python is decided here: errors become exceptions.
"""
from __future__ import annotations

import sys
from typing import Optional, Union

from ._ffi import ffi, lib
from .constants import (IPC_ERROR_TYPE, IPC_Argument_Out_Of_Range, IPC_Error, IPC_Exit_On_Errors,
                        IPC_OK, IPC_Print_Errors, IPC_Print_Warnings, IPC_RETURN_TYPE,
                        IPC_VERBOSITY_TYPE)


class IPCError(Exception):
    """An error of the library: its text, and its number as errno."""

    def __init__(self, text: str = "", errno: Optional[int] = None) -> None:
        super().__init__(text)
        self.errno = IPC_ERROR_TYPE(lib.IPC_errno if errno is None else errno)


class _Verbosity:
    """The level that Python was told."""

    level = IPC_Exit_On_Errors


lib.IPC_setVerbosity(IPC_Print_Errors)
_RESULTS = {int(result): result for result in IPC_RETURN_TYPE}


def error_text(errno: int) -> str:
    """The text of an error's number."""
    return bytes(ffi.string(lib.ipcErrorStrings[errno])).decode()


def raise_error(errno: Optional[int] = None) -> IPC_RETURN_TYPE:
    """What a call that the library has failed comes to: an exception, or IPC_Error."""
    number = lib.IPC_errno if errno is None else errno
    if _Verbosity.level >= IPC_Exit_On_Errors:
        raise IPCError(error_text(number), number)
    return IPC_Error


def fail(errno: IPC_ERROR_TYPE) -> IPC_RETURN_TYPE:
    """What a call comes to that fails here, as if the library had failed it."""
    lib.ipcSetError(errno)
    return raise_error(errno)


def result(number: int) -> IPC_RETURN_TYPE:
    """The result of a call of the library."""
    return _RESULTS[number] if number != IPC_Error else raise_error()


def warn(text: str) -> None:
    """A warning, to where the library's warnings go."""
    if _Verbosity.level >= IPC_Print_Warnings and sys.stderr is not None:
        sys.stderr.write(text + "\n")


def IPC_setVerbosity(verbosity: int) -> IPC_RETURN_TYPE:
    """Chooses what is printed, and with IPC_Exit_On_Errors that errors are exceptions."""
    try:
        level = IPC_VERBOSITY_TYPE(verbosity)
    except ValueError:
        return fail(IPC_Argument_Out_Of_Range)
    lib.IPC_setVerbosity(min(level, IPC_Print_Errors))
    _Verbosity.level = level
    return IPC_OK


def IPC_perror(msg: Union[str, bytes, None]) -> None:
    """Prints the text of IPC_errno on stderr, after msg."""
    from .library import text_argument
    sys.stderr.flush()
    lib.IPC_perror(text_argument(msg))
