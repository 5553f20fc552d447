"""What C programs need to be built against the library of this package, and its version."""
from __future__ import annotations

import os

from ._ffi import ffi, lib

_HERE = os.path.dirname(os.path.abspath(__file__))


def library_version() -> str:
    """The version of the C library; "" if it is one that was installed before the package."""
    version = lib.glue_version()
    return "" if version == ffi.NULL else bytes(ffi.string(version)).decode()


def include_dir() -> str:
    """The directory for -I: programs include <ipc/ipc.h>."""
    return _place("include", os.path.join("ipc", "ipc.h"))


def library_path() -> str:
    """The static library, which needs -pthread besides."""
    return os.path.join(_place("lib", "libipc.a"), "libipc.a")


def pkgconfig_dir() -> str:
    """The directory for PKG_CONFIG_PATH."""
    return _place(os.path.join("lib", "pkgconfig"), "ipc.pc")


def _place(folder: str, file: str) -> str:
    path = os.path.join(_HERE, folder)
    if not os.path.exists(os.path.join(path, file)):
        raise FileNotFoundError(f"this package was built without {file}")
    return path
