"""For tests of programs that use IPC: a server for each test.

With pytest, put this into conftest.py, and use the fixture:

    from ipc_cffi.testing import ipc_central

    def test_something(ipc_central):
        with ipc_cffi.connect("test") as ipc:
            ...
"""
from __future__ import annotations

from typing import Iterator

from .central import Central
from .constants import IPC_Exit_On_Errors
from .contexts import disconnect_all
from .errors import IPC_setVerbosity


def central(*options: str) -> Central:
    """A private server on a free port, for a with block; CENTRALHOST names it meanwhile."""
    return Central("-lx", *options)


def clean_up() -> None:
    """Ends all connections of this process, and undoes IPC_setVerbosity()."""
    disconnect_all()
    IPC_setVerbosity(IPC_Exit_On_Errors)


try:
    import pytest
except ImportError:
    pass
else:
    @pytest.fixture
    def ipc_central() -> Iterator[Central]:
        """A private server for one test, which leaves no connections behind."""
        with central() as started:
            yield started
            clean_up()
