"""Servers of a program's own, for tests and for programs that are one process."""
from __future__ import annotations

import atexit
import os
import re
import threading
import time
from types import TracebackType
from typing import TYPE_CHECKING, Any, Optional, Type

from ._programs import program_path

if TYPE_CHECKING:
    import subprocess

#: Seconds that the server may take to begin and to end.
PATIENCE = 30


class Central:
    """A server on a free port, for the life of a with block.

    Meanwhile the environment variable CENTRALHOST names it, so that modules that this program
    connects or starts find it; with environment=False it is left alone.
    """

    def __init__(self, *options: str, environment: bool = True) -> None:
        self.address = ""
        self.port = 0
        self._options = options
        self._environment = environment
        self._before: Optional[str] = None
        self._process: Optional[subprocess.Popen[bytes]] = None
        self._log: Any = None

    def __repr__(self) -> str:
        return f"<Central {'not running' if self._process is None else f'at {self.address}'}>"

    def start(self) -> Central:
        """Starts the server and waits until it can be connected to."""
        import subprocess
        import tempfile
        self._log = tempfile.TemporaryFile()
        self._process = subprocess.Popen(
            [program_path("central"), "-p0", "-u", *self._options], stdin=subprocess.DEVNULL,
            stdout=self._log, stderr=subprocess.STDOUT)
        try:
            self.port = self._await_port()
        except BaseException:
            self.stop()
            raise
        self.address = f"localhost:{self.port}"
        if self._environment:
            self._before = os.environ.get("CENTRALHOST")
            os.environ["CENTRALHOST"] = self.address
        return self

    def _await_port(self) -> int:
        assert self._process is not None
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            has_ended = self._process.poll() is not None
            found = re.search(rb"Expecting \d+ on port (\d+)", self._text())
            if found:
                return int(found.group(1))
            if has_ended:
                break
            time.sleep(0.005)
        raise RuntimeError(f"central did not start: {self.output()}")

    def _text(self) -> bytes:
        # A descriptor of its own: the server goes on writing behind the end.
        return os.pread(self._log.fileno(), 1 << 24, 0)

    def output(self) -> str:
        """What the server has printed."""
        return self._text().decode("utf-8", "replace")

    def stop(self) -> None:
        """Ends the server."""
        if self._process is None:
            return
        import subprocess
        self._process.terminate()
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._process = None
        if self._environment and os.environ.get("CENTRALHOST") == self.address:
            if self._before is None:
                del os.environ["CENTRALHOST"]
            else:
                os.environ["CENTRALHOST"] = self._before

    def __enter__(self) -> Central:
        return self.start()

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.stop()


class _Embedded:
    """The server of CENTRALHOST=embedded:."""

    lock = threading.Lock()
    central: Optional[Central] = None


def embedded_address() -> str:
    """The address of this process's own server, which is started when it is first needed.

    Programs that this one starts then find it by CENTRALHOST.
    """
    with _Embedded.lock:
        if _Embedded.central is None:
            _Embedded.central = Central("-lx").start()
            atexit.register(_Embedded.central.stop)
        return _Embedded.central.address
