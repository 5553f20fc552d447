"""Options and fixtures of the whole-system tests: what is under test, and fresh instances of it."""
import contextlib
import os
import signal
import subprocess

import pytest

from support import driver as driver_module, processes
from support.fake_central import FakeCentral
from support.peer import Peer
from support.processes import Central, Compiler, Library
from support.steady_pair import SteadyPair
from support.waiting import PATIENCE

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BUILD = os.environ.get("IPC_BUILD_DIR") or os.path.join(ROOT, "build", "dev")


def pytest_addoption(parser):
    group = parser.getgroup("ipc")
    add = group.addoption
    add("--central", default=os.environ.get("IPC_TEST_CENTRAL"),
        help="the central to test (IPC_TEST_CENTRAL; default: the one that was built)")
    add("--libipc", default=os.environ.get("IPC_TEST_LIBIPC"),
        help="directory of the libipc.so.1 to test (IPC_TEST_LIBIPC; default: as built)")
    add("--original-central", default=os.environ.get("IPC_ORIGINAL_CENTRAL"),
        help="a central of CMU IPC 3.9.1 to test together with (IPC_ORIGINAL_CENTRAL)")
    add("--original-libipc", default=os.environ.get("IPC_ORIGINAL_LIBIPC"),
        help="directory of a libipc.so.1 of CMU IPC 3.9.1 (IPC_ORIGINAL_LIBIPC)")
    add("--original-tests", default=os.environ.get("IPC_ORIGINAL_TESTS"),
        help="directory of the test programs of CMU IPC 3.9.1 (IPC_ORIGINAL_TESTS)")
    add("--ipc-header", default=os.environ.get("IPC_TEST_HEADER"),
        help="directory of the ipc.h to compile modules with (IPC_TEST_HEADER; default: ours)")


def pytest_configure(config):
    """Says at once which programs are judged, and remembers which of them are originals."""
    central = config.getoption("--central") or os.path.join(BUILD, "src/c/central/central")
    library = config.getoption("--libipc") or os.path.join(BUILD, "src/c/libipc")
    config.ipc_central = os.path.abspath(central)
    config.ipc_library = os.path.abspath(library)
    config.ipc_central_is_original = is_original_central(config.ipc_central)
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        # So a shell starts what runs in the background; the programs here would inherit it.
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: item.get_closest_marker("looked_at_last") is not None)


def pytest_report_header(config):
    return [f"central: {config.ipc_central}", f"libipc: {config.ipc_library}"]


def is_original_central(program):
    """Whether a program is a central of CMU IPC 3.9: it says so when asked for its version."""
    if not os.path.exists(program):
        return False
    asked = subprocess.run([program, "-v"], capture_output=True, text=True, timeout=PATIENCE,
                           stdin=subprocess.DEVNULL, check=False)
    return "Task Control Server 3.9" in asked.stderr + asked.stdout


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """Shows what the programs of a failed test have printed."""
    outcome = yield
    report = outcome.get_result()
    if report.failed:
        for process in processes.started:
            report.sections.append((f"output of {process}", process.output()[-3000:]))
    if call.when == "teardown":
        processes.started.clear()


@pytest.fixture(autouse=True)
def _skip_what_the_original_cannot(request):
    """Tests marked as true of our programs only are skipped for an original."""
    marks = (("new_central", lambda: request.config.ipc_central_is_original),
             ("new_library", lambda: request.getfixturevalue("library").original))
    for name, is_original in marks:
        mark = request.node.get_closest_marker(name)
        if mark and is_original():
            pytest.skip(f"the original differs: {mark.args[0]}")


# ---------------------------------------------------------------- what is tested


@pytest.fixture(scope="session")
def central_program(pytestconfig):
    """Path of the central under test."""
    if not os.access(pytestconfig.ipc_central, os.X_OK):
        pytest.skip(f"no central at {pytestconfig.ipc_central}")
    return pytestconfig.ipc_central


@pytest.fixture(scope="session")
def original_central_program(pytestconfig):
    """Path of the original central; the test is skipped when there is none."""
    program = pytestconfig.getoption("--original-central")
    if not program:
        pytest.skip("no original central given (--original-central)")
    return os.path.abspath(program)


@pytest.fixture(scope="session")
def library(pytestconfig):
    """The libipc under test."""
    if not os.path.exists(os.path.join(pytestconfig.ipc_library, "libipc.so.1")):
        pytest.skip(f"no libipc.so.1 in {pytestconfig.ipc_library}")
    return Library("tested", pytestconfig.ipc_library)


@pytest.fixture(scope="session")
def original_library(pytestconfig):
    """The original libipc; the test is skipped when there is none."""
    directory = pytestconfig.getoption("--original-libipc")
    if not directory:
        pytest.skip("no original libipc given (--original-libipc)")
    return Library("original", directory)


@pytest.fixture(scope="session")
def compiler(pytestconfig, tmp_path_factory):
    """Compiles C programs against the public header."""
    given = pytestconfig.getoption("--ipc-header")
    includes = [given] if given else [os.path.join(ROOT, "include", "ipc"),
                                      os.path.join(ROOT, "include")]
    return Compiler(str(tmp_path_factory.mktemp("programs")), includes)


# ------------------------------------------------------------------------- actors


@pytest.fixture
def stack():
    """What is entered here is left, newest first, when the test is over."""
    with contextlib.ExitStack() as exits:
        yield exits


@pytest.fixture(scope="session")
def once(central_program):
    """For tests that build the project anew: they pass or fail whatever the sanitizers."""
    if processes.is_sanitized(central_program):
        pytest.skip("it makes a build of its own, without sanitizers: once is enough")


@pytest.fixture
def start_central(stack, central_program, pytestconfig):
    """Starts the central under test with more options; it is ended after the test."""
    def start(*options, **popen):
        return stack.enter_context(Central(
            central_program, *options, original=pytestconfig.ipc_central_is_original, **popen))
    return start


@pytest.fixture
def central(start_central):
    """A running central of its own for each test."""
    return start_central()


@pytest.fixture(scope="session")
def gaps(pytestconfig):
    """(longest gap, number of messages, test) of the steady pairs: shown at the end."""
    pytestconfig.ipc_gaps = []
    return pytestconfig.ipc_gaps


@pytest.fixture
def start_steady_pair(stack, request, gaps):
    """Starts two modules that exchange numbers through a central until the test is over, and then
    checks that none was lost; the longest gap is reported."""
    pairs = []

    def start(central, **options):
        pairs.append(stack.enter_context(SteadyPair(central, **options)))
        return pairs[-1]
    yield start
    for pair in pairs:
        count, gap = pair.finish()
        gaps.append((gap, count, request.node.nodeid))
        assert count > 0


def pytest_terminal_summary(terminalreporter, config):
    """The longest times that a message of a steady pair took."""
    gaps_found = getattr(config, "ipc_gaps", None)
    if gaps_found:
        count = sum(count for _, count, _ in gaps_found)
        terminalreporter.write_line(f"steady pairs exchanged {count} messages; longest gaps:")
        for gap, _, test in sorted(gaps_found, reverse=True)[:5]:
            terminalreporter.write_line(f"  {gap * 1000:7.1f} ms  {test}")


@pytest.fixture
def join(stack, central):
    """Connects hand-made modules to the test's central by the shortest handshake."""
    def join_central(name, **options):
        return stack.enter_context(Peer(central, name, **options)).connect()
    return join_central


@pytest.fixture
def start_driver(stack, compiler, library):
    """Starts modules that are built on the library under test, or on another one."""
    def start(name="DRIVER", *, using=None, **options):
        program = compiler.program(driver_module.SOURCE, using or library,
                                   flags=driver_module.FLAGS)
        return stack.enter_context(
            driver_module.Driver(program, using or library, name=name, **options))
    return start


@pytest.fixture
def start_driver_on(stack, compiler, library):
    """Starts modules on a machine of another name, in a network of other names; see
    named_host.c."""
    def start(own_name, hosts=(), *, default_port="", env=None):
        program = compiler.program(
            [driver_module.SOURCE, driver_module.NAMED_HOST], library, name="named_driver",
            flags=[*driver_module.FLAGS, "-rdynamic", "-ldl"])
        return stack.enter_context(driver_module.Driver(program, library, env={
            "IPC_TEST_OWN_NAME": own_name, "IPC_TEST_HOSTS": " ".join(hosts),
            "IPC_TEST_DEFAULT_PORT": str(default_port), **(env or {})}))
    return start


@pytest.fixture
def fake_central(stack):
    """A hand-made central that behaves."""
    return stack.enter_context(FakeCentral())


@pytest.fixture
def driver(start_driver, fake_central):
    """A module on the library under test, connected to the hand-made central."""
    return start_driver().connect(fake_central.address)
