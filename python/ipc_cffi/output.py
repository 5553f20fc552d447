"""The library's texts in the log of the program."""
from __future__ import annotations

import threading
from typing import Any, Dict

from ._ffi import ffi, lib
from .errors import Texts

#: Levels of the module logging by the kinds of texts: banners, warnings, errors.
_LEVELS = (20, 30, 40)

#: Lines whose end has not come yet, by kind, and what guards them.
_begun: Dict[int, bytes] = {}
_lock = threading.Lock()


def capture_output(on: bool = True) -> None:
    """Has what the library says logged by the logger ipc.lib, instead of written to the standard
    streams; the verbosity decides as before what it says.

    To be called while no other thread uses IPC."""
    import logging  # noqa: F401  pylint: disable=unused-import
    lib.glue_keep_texts(bool(on))
    log_texts()
    Texts.are_captured = bool(on)


def log_texts() -> None:
    """Logs what the library has said since the last time."""
    while True:
        text = lib.glue_take_text()
        if text == ffi.NULL:
            return
        kind, said = int(text.kind), bytes(ffi.string(text.bytes))
        lib.glue_free(text)
        _log(kind, said)


def _log(kind: int, said: bytes) -> None:
    import logging
    with _lock:
        *lines, _begun[kind] = (_begun.get(kind, b"") + said).split(b"\n")
    library: Any = logging.getLogger("ipc.lib")
    for line in lines:
        if line:
            library.log(_LEVELS[kind], "%s", line.decode("utf-8", "replace"))
