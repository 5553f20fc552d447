"""Fixtures of the tests with other machines, and the table of what has passed on which."""
import functools
import itertools
import os
import pathlib
import struct

import pytest

from cross.platforms import Machine, Missing, PLATFORMS
from support import driver as driver_module
from support.driver import Driver
from support.processes import Central

HERE = "x86-64"
ORIGINAL = "CMU IPC"
PARTS = ("unit", "wire", "formats", "conversation")

FOLDER = pathlib.Path(__file__).parent
_open_machines = []


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item, nextitem):
    """Machines end with the last test of this folder: what serves the programs of one may be busy
    as long as it lives."""
    del item
    if nextitem is None or FOLDER not in nextitem.path.parents:
        while _open_machines:
            _open_machines.pop().close()


class Here:
    """This machine: the programs under test, or those of an original."""

    order = "<" if struct.pack("=h", 1) == struct.pack("<h", 1) else ">"
    long_size = struct.calcsize("l")

    def __init__(self, central, library, compiler):
        self.central, self.library = central, library
        self.driver = compiler.program(driver_module.SOURCE, library, flags=driver_module.FLAGS)


@pytest.fixture(scope="session")
def build_directory(pytestconfig):
    """Where the programs of this machine are built."""
    build = os.environ.get("IPC_BUILD_DIR") or os.path.join(pytestconfig.rootpath, "..", "build/dev")
    return os.path.abspath(build)


@pytest.fixture(scope="session")
def machine(once, build_directory, request, central_program, library, compiler):
    """Gives the machine of a name, built when it is first asked for; skips the test where the
    machine cannot be had."""

    @functools.lru_cache(None)
    def find(name):
        if name == HERE:
            return Here(central_program, library, compiler)
        if name == ORIGINAL:
            return Here(request.getfixturevalue("original_central_program"),
                        request.getfixturevalue("original_library"), compiler)
        try:
            machine = Machine(PLATFORMS[name], os.path.join(build_directory, "cross", name))
        except Missing as missing:
            return missing
        _open_machines.append(machine)
        request.addfinalizer(machine.close)  # if the tests are interrupted
        return machine

    def get(name):
        found = find(name)
        if isinstance(found, Missing):
            pytest.skip(str(found))
        return found
    return get


# -------------------------------------------------------------------- conversations


def mixes_of(platform, original):
    """Who may be first module, second module and central: every mix with this machine, a long of
    64 bits in the other order for those that have 32, and an original that is given as a peer."""
    yield from ((first, second, central)
                for first, second, central in itertools.product((platform, HERE), repeat=3)
                if platform in (first, second, central))
    if PLATFORMS[platform].long_size == 4:
        yield "s390x", platform, HERE
    if original:
        for central in (HERE, ORIGINAL, platform):
            yield platform, ORIGINAL, central
            yield ORIGINAL, platform, central


def pytest_generate_tests(metafunc):
    config = metafunc.config
    if "mix" in metafunc.fixturenames:
        original = config.getoption("--original-central") and config.getoption("--original-libipc")
        metafunc.parametrize("mix", [
            pytest.param((platform, *mix), id=f"{platform}: " + "-".join(mix))
            for platform in PLATFORMS for mix in mixes_of(platform, original)], scope="session")
    elif "platform" in metafunc.fixturenames:
        metafunc.parametrize("platform", PLATFORMS, scope="session")


@pytest.fixture(scope="session")
def machines(mix, machine):
    """The machines of first module, second module and central."""
    return tuple(machine(name) for name in mix[1:])


@pytest.fixture
def connect_pair(machines, mix, stack):
    """Starts a central of the mix and connects two modules, FIRST and SECOND."""
    def connect(*options):
        first, second, central = machines
        running = stack.enter_context(Central(central.central, *options,
                                              original=mix[3] == ORIGINAL))
        return tuple(
            stack.enter_context(Driver(
                module.driver, getattr(module, "library", None), name=name)
            ).connect(running.address) for name, module in (("FIRST", first), ("SECOND", second)))
    return connect


@pytest.fixture
def pair(connect_pair):
    return connect_pair()


# ---------------------------------------------------------------------------- table


def pytest_configure(config):
    config.cross_results = {}


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    outcome = yield
    report = outcome.get_result()
    parameters = getattr(item, "callspec", None)
    platform = parameters and (parameters.params.get("mix") or [parameters.params.get("platform")])
    part = getattr(item.module, "PART", None) or getattr(item.function, "part", None)
    if not platform or not part or not (report.when == "call" or report.outcome != "passed"):
        return
    reason = report.longrepr[2].removeprefix("Skipped: ") if report.skipped else report.outcome
    item.config.cross_results.setdefault((platform[0], part), []).append(reason)


def cell(results):
    """What a table says of the tests of one part on one platform."""
    if not results:
        return "not run"
    if "failed" in results:
        return f"{results.count('failed')} of {len(results)} failed"
    passed = results.count("passed")
    if passed == len(results):
        return "pass" if passed == 1 else f"pass ({passed})"
    if passed:
        return f"pass ({passed}, skipped {len(results) - passed})"
    return ", ".join(sorted(set(results)))


def pytest_terminal_summary(terminalreporter, config):
    if not config.cross_results:
        return
    rows = [("with " + HERE, *PARTS)]
    rows += [(name, *(cell(config.cross_results.get((name, part))) for part in PARTS))
             for name in PLATFORMS]
    widths = [max(len(row[column]) for row in rows) for column in range(len(PARTS) + 1)]
    terminalreporter.section("other machines")
    for row in rows:
        terminalreporter.write_line("  ".join(
            text.ljust(width) for text, width in zip(row, widths)).rstrip())
