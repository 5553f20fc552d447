"""Errors of the library as exceptions, and verbosity [manual 4.10 to 4.12, 4.39].

The C library always runs at a level that leaves the process alive.  What IPC_Exit_On_Errors means
in Python is decided here: errors become exceptions.
"""
from __future__ import annotations

import sys
from typing import Any, Optional, Union

from ._ffi import ffi, lib
from .arguments import text_argument
from .constants import (IPC_ERROR_TYPE, IPC_Argument_Out_Of_Range, IPC_Error, IPC_Exit_On_Errors,
                        IPC_OK, IPC_Print_Errors, IPC_Print_Warnings, IPC_RETURN_TYPE,
                        IPC_VERBOSITY_TYPE)


class IPCError(Exception):
    """An error of the library: its text, and its number as errno."""

    #: Whether it has left a handler, and so is none of the call that it comes out of.
    in_handler = False

    #: What it is about, where that is known; str() then ends with it.
    about: Optional[str] = None

    def __init__(self, text: str = "", errno: Optional[int] = None) -> None:
        super().__init__(text)
        self.errno = IPC_ERROR_TYPE(lib.IPC_errno if errno is None else errno)

    def __str__(self) -> str:
        text = super().__str__()
        return f"{text}: {self.about}" if self.about else text


class NotConnected(IPCError, ConnectionError):  # type: ignore[misc]
    """There is no connection to the server, or none any more."""


class NotInitialized(IPCError):
    """Neither IPC_initialize() nor a connection came before."""


class MessageNotDefined(IPCError):
    """No module has defined the message."""


class WrongLength(IPCError, ValueError):
    """The number of bytes is not that of the message."""


class OutOfRange(IPCError, ValueError):
    """A number, or something that is stale or foreign."""


class NullArgument(IPCError, ValueError):
    """Something is missing, or a name is empty."""


class IllegalFormat(IPCError, ValueError):
    """The format string is none."""


class MismatchedFormat(IPCError, ValueError):
    """The format is not that of the message."""


class BadData(IPCError, ValueError):
    """The bytes do not hold a value of the format."""


class CommunicationError(IPCError, ConnectionError):  # type: ignore[misc]
    """The connection has failed."""


class IPCTimeout(IPCError, TimeoutError):  # type: ignore[misc]
    """Nothing has come in time."""

    def __init__(self, text: str) -> None:
        super().__init__(text, 0)


_CLASSES = {1: NotConnected, 2: NotInitialized, 3: MessageNotDefined, 4: WrongLength,
            5: WrongLength, 6: OutOfRange, 7: NullArgument, 8: IllegalFormat,
            9: MismatchedFormat, 10: BadData, 11: CommunicationError}


class _Verbosity:
    """The level that Python was told."""

    level = IPC_Exit_On_Errors


lib.IPC_setVerbosity(IPC_Print_Errors)
_RESULTS = {int(result): result for result in IPC_RETURN_TYPE}


def error_text(errno: int) -> str:
    """The text of an error's number."""
    return bytes(ffi.string(lib.ipcErrorStrings[errno])).decode()


def last_error(errno: Optional[int] = None) -> IPCError:
    """The exception for the last error of the library, or for another one."""
    number = lib.IPC_errno if errno is None else errno
    return _CLASSES.get(number, IPCError)(error_text(number), number)


def raise_error(errno: Optional[int] = None) -> IPC_RETURN_TYPE:
    """What a call that the library has failed comes to: an exception, or IPC_Error."""
    if _Verbosity.level >= IPC_Exit_On_Errors:
        raise last_error(errno)
    return IPC_Error


def fail(errno: IPC_ERROR_TYPE) -> IPC_RETURN_TYPE:
    """What a call comes to that fails here, as if the library had failed it."""
    lib.ipcSetError(errno)
    return raise_error(errno)


def result(number: int) -> IPC_RETURN_TYPE:
    """The result of a call of the library."""
    return _RESULTS[number] if number != IPC_Error else raise_error()


def checked(result: IPC_RETURN_TYPE) -> IPC_RETURN_TYPE:
    """The result of a function of the manual; an error is an exception."""
    if result == IPC_Error:
        raise last_error()
    return result


class Texts:
    """Where texts go."""

    are_captured = False  #: to the log only, see output.py


def warn(text: str) -> None:
    """A warning, to where the library's warnings go, and to the logger ipc."""
    logger("ipc").warning("%s", text)
    if (_Verbosity.level >= IPC_Print_Warnings and not Texts.are_captured
            and sys.stderr is not None):
        sys.stderr.write(text + "\n")


class _NoLogger:
    """Stands for a logger in a program that does not use the module logging."""

    def isEnabledFor(self, level: int) -> bool:
        return False

    def warning(self, *arguments: Any, **others: Any) -> None:
        """Goes nowhere."""

    debug = error = warning


def logger(name: str) -> Any:
    """A logger, if the program has arranged for any logging."""
    logging = sys.modules.get("logging")
    if logging is None or not (logging.getLogger().handlers or logging.getLogger("ipc").handlers):
        return _NoLogger()
    return logging.getLogger(name)


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
    sys.stderr.flush()
    lib.IPC_perror(text_argument(msg))
