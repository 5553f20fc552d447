"""Ends the waits of listening calls, from threads and signal handlers."""
from __future__ import annotations

import contextlib
import os
import threading
from typing import Any

from .listening import IPC_subscribeFD, IPC_unsubscribeFD


class Waker:
    """Ends the wait of listening calls, from anywhere."""

    def __init__(self) -> None:
        # A signal handler may wake while its thread closes.
        self._lock = threading.RLock()
        self._read, self._write = os.pipe()
        for descriptor in (self._read, self._write):
            os.set_blocking(descriptor, False)
        IPC_subscribeFD(self._read, self._drain)

    def _drain(self, descriptor: int, client_data: Any) -> None:
        with contextlib.suppress(BlockingIOError):  # another thread may have been quicker
            os.read(descriptor, 4096)

    def wake(self) -> None:
        with self._lock, contextlib.suppress(BlockingIOError):
            if self._write >= 0:
                os.write(self._write, b"!")

    def close(self) -> None:
        with self._lock:
            write, self._write = self._write, -1
            if write >= 0:
                IPC_unsubscribeFD(self._read, None)
                os.close(self._read)
                os.close(write)
