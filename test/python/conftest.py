"""Fixtures of the tests of the Python package."""
import pytest

from support.processes import Central


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


#: Tests that hold with an original central too, and are made with one if it is given.
WITH_ORIGINAL = {"python.test_single_process", "python.test_messages", "python.test_queries",
                 "python.test_c_peers"}


def pytest_generate_tests(metafunc):
    """Has tests that need a central run with an original one as well."""
    config = metafunc.config
    if (metafunc.module.__name__ in WITH_ORIGINAL and "central" in metafunc.fixturenames
            and config.getoption("--original-central") and not config.ipc_central_is_original
            and not metafunc.definition.get_closest_marker("new_central")):
        metafunc.parametrize("central", ["ours", "CMU"], indirect=True)


@pytest.fixture
def central(request, start_central, stack):
    """A running central of its own for each test."""
    if getattr(request, "param", "ours") == "ours":
        return start_central()
    program = request.getfixturevalue("original_central_program")
    return stack.enter_context(Central(program, original=True))


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
