"""Fixtures of the tests of xdrgen."""
import os
import subprocess

import pytest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.environ.get("IPC_BUILD_DIR") or os.path.join(ROOT, "build", "dev")
PATIENCE = 120  # seconds for one run, on a slow machine


@pytest.fixture(scope="session")
def program():
    """Path of the xdrgen that was built."""
    path = os.path.join(BUILD, "xdrgen", "xdrgen")
    if not os.access(path, os.X_OK):
        pytest.skip(f"no xdrgen at {path}")
    return os.path.abspath(path)


@pytest.fixture
def xdrgen(program, tmp_path):
    """Runs xdrgen in an empty directory; a specification given as text becomes in.xdr there."""
    def run(*arguments, text=None, **options):
        if text is not None:
            data = text if isinstance(text, bytes) else text.encode()
            (tmp_path / "in.xdr").write_bytes(data)
        options = {"stdin": subprocess.DEVNULL, "encoding": "latin-1", **options}
        return subprocess.run([program, *map(str, arguments)], cwd=tmp_path, timeout=PATIENCE,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False,
                              **options)
    return run
