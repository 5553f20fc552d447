"""What the tests of the Python package share: the package, built from this tree, and programs."""
import os
import subprocess
import sys
import textwrap

import pytest

from support.processes import Process
from support.waiting import PATIENCE, SLOW, wait_until

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.environ.get("IPC_BUILD_DIR") or os.path.join(ROOT, "build", "dev")
PACKAGES = os.path.join(BUILD, "python")
EXAMPLES = os.path.join(ROOT, "examples", "python")


def _build():
    """Brings the package in the build directory up to date."""
    try:
        import cffi  # noqa: F401  pylint: disable=unused-import,import-outside-toplevel
        import setuptools  # noqa: F401  pylint: disable=unused-import,import-outside-toplevel
    except ImportError as error:
        pytest.skip(f"the Python package cannot be built: {error}", allow_module_level=True)
    done = subprocess.run(
        [sys.executable, "setup.py", "build_py", "--build-lib", PACKAGES,
         "build_ext", "--build-lib", PACKAGES, "--build-temp", os.path.join(BUILD, "python-build")],
        cwd=ROOT, capture_output=True, text=True, timeout=300 * SLOW, check=False)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]


_build()
sys.path.insert(0, PACKAGES)

import ipc_cffi as ipc  # noqa: E402  pylint: disable=wrong-import-position,wrong-import-order


def encoded(format_string, data):
    """The bytes of data."""
    varcontent = ipc.IPC_VARCONTENT_TYPE()
    ipc.IPC_marshall(ipc.IPC_parseFormat(format_string), data, varcontent)
    return bytes(varcontent.content)


def decoded(format_string, content, cls=None, order=sys.byteorder):
    """The data of bytes of that order."""
    array = ipc.BYTE_ARRAY(content)
    array.order = order
    data, result = ipc.IPC_unmarshall(ipc.IPC_parseFormat(format_string), array, cls)
    assert result == ipc.IPC_OK
    return data


def plain(value):
    """A decoded value with lists for structures, to compare with."""
    if isinstance(value, ipc.IPCdata):
        return [plain(member) for member in vars(value).values()]
    if isinstance(value, (list, tuple)):
        return [plain(element) for element in value]
    return value


class Program(Process):
    """A Python program that uses the package, given as text."""

    def __init__(self, text, *arguments, central=None, env=None, **options):
        environment = {"PYTHONPATH": PACKAGES, "PYTHONUNBUFFERED": "1", **(env or {})}
        if central is not None:
            environment["CENTRALHOST"] = central.address
        super().__init__([sys.executable, "-c", textwrap.dedent(text), *arguments],
                         env=environment, **options)


def listen_until(condition, what="it happens"):
    """Listens until the condition holds."""
    def holds():
        ipc.IPC_listen(10)
        return condition()
    return wait_until(holds, what, PATIENCE)
