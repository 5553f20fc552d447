"""ipc_cffi under the name that programs for CMU IPC import, with what they used beyond the manual."""
import sys as _sys
import warnings as _warnings

import ipc_cffi as _ipc_cffi
from ipc_cffi import *  # noqa: F401,F403
from ipc_cffi import __all__ as _names

# Is seen only by those who ask for all warnings.
_warnings.warn("the module IPC is for older programs; others import ipc_cffi", DeprecationWarning,
               stacklevel=1)

__all__ = [*_names, "printByteArray", "cvar"]


def printByteArray(byteArray, stream=None):
    """Prints bytes as numbers."""
    print(" ".join(str(byte) for byte in byteArray or b""), file=stream or _sys.stdout)


class _Variables:
    """The variables of the C library."""

    @property
    def IPC_errno(self):
        return _ipc_cffi.IPC_errno


cvar = _Variables()


def __getattr__(name):
    return getattr(_ipc_cffi, name)
