"""The constants of ipc.h [manual 4.1, 4.2, 4.10]."""
from __future__ import annotations

import enum
from typing import Final


class _Number(enum.IntEnum):
    """Prints as the number that it is, as scripts expect of return values; repr() tells the name."""

    def __str__(self) -> str:
        return str(int(self))

    def __format__(self, spec: str) -> str:
        return format(int(self), spec)


class IPC_RETURN_TYPE(_Number):
    """What a call came to."""

    IPC_Error = 0
    IPC_OK = 1
    IPC_Timeout = 2


class IPC_ERROR_TYPE(_Number):
    """Why a call failed."""

    IPC_No_Error = 0
    IPC_Not_Connected = 1
    IPC_Not_Initialized = 2
    IPC_Message_Not_Defined = 3
    IPC_Not_Fixed_Length = 4
    IPC_Message_Lengths_Differ = 5
    IPC_Argument_Out_Of_Range = 6
    IPC_Null_Argument = 7
    IPC_Illegal_Formatter = 8
    IPC_Mismatched_Formatter = 9
    IPC_Wrong_Buffer_Length = 10
    IPC_Communication_Error = 11


class IPC_VERBOSITY_TYPE(_Number):
    """What is printed, and whether errors are exceptions (IPC_Exit_On_Errors)."""

    IPC_Silent = 0
    IPC_Print_Warnings = 1
    IPC_Print_Errors = 2
    IPC_Exit_On_Errors = 3


IPC_Error: Final = IPC_RETURN_TYPE.IPC_Error
IPC_OK: Final = IPC_RETURN_TYPE.IPC_OK
IPC_Timeout: Final = IPC_RETURN_TYPE.IPC_Timeout

IPC_No_Error: Final = IPC_ERROR_TYPE.IPC_No_Error
IPC_Not_Connected: Final = IPC_ERROR_TYPE.IPC_Not_Connected
IPC_Not_Initialized: Final = IPC_ERROR_TYPE.IPC_Not_Initialized
IPC_Message_Not_Defined: Final = IPC_ERROR_TYPE.IPC_Message_Not_Defined
IPC_Not_Fixed_Length: Final = IPC_ERROR_TYPE.IPC_Not_Fixed_Length
IPC_Message_Lengths_Differ: Final = IPC_ERROR_TYPE.IPC_Message_Lengths_Differ
IPC_Argument_Out_Of_Range: Final = IPC_ERROR_TYPE.IPC_Argument_Out_Of_Range
IPC_Null_Argument: Final = IPC_ERROR_TYPE.IPC_Null_Argument
IPC_Illegal_Formatter: Final = IPC_ERROR_TYPE.IPC_Illegal_Formatter
IPC_Mismatched_Formatter: Final = IPC_ERROR_TYPE.IPC_Mismatched_Formatter
IPC_Wrong_Buffer_Length: Final = IPC_ERROR_TYPE.IPC_Wrong_Buffer_Length
IPC_Communication_Error: Final = IPC_ERROR_TYPE.IPC_Communication_Error

IPC_Silent: Final = IPC_VERBOSITY_TYPE.IPC_Silent
IPC_Print_Warnings: Final = IPC_VERBOSITY_TYPE.IPC_Print_Warnings
IPC_Print_Errors: Final = IPC_VERBOSITY_TYPE.IPC_Print_Errors
IPC_Exit_On_Errors: Final = IPC_VERBOSITY_TYPE.IPC_Exit_On_Errors

IPC_WAIT_FOREVER: Final = 0xFFFFFFFF
IPC_VARIABLE_LENGTH: Final = 0xFFFFFFFF
IPC_FIXED_LENGTH: Final = 0xFFFFFFFE
TRIGGER_FOREVER: Final = -1

__all__ = [name for name in dir() if name.startswith("IPC_")] + ["TRIGGER_FOREVER"]
