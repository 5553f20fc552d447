"""Fixtures of the tests of the Python package."""
import pytest


@pytest.fixture
def ipc():
    """The package; afterwards this process is as if it had not been used."""
    from python.tools import ipc as package  # pylint: disable=import-outside-toplevel
    package.IPC_setVerbosity(package.IPC_Exit_On_Errors)
    package.IPC_initialize()
    yield package
    package.IPC_setVerbosity(package.IPC_Silent)
    package.contexts.disconnect_all()
    package.IPC_setVerbosity(package.IPC_Exit_On_Errors)


@pytest.fixture
def module(ipc, central):
    """The package, connected to a central of its own under the name "test"."""
    assert ipc.IPC_connectModule("test", central.address) == ipc.IPC_OK
    return ipc


@pytest.fixture
def program(stack, central):
    """Starts programs in Python that use the test's central."""
    from python.tools import Program  # pylint: disable=import-outside-toplevel

    def start(text, *arguments, **options):
        return stack.enter_context(Program(text, *arguments, central=central, **options))
    return start
