"""Fixtures of the tests that mix our programs with those of CMU IPC 3.9.1."""
import itertools
import os
import subprocess

import pytest

from support.processes import Central, Process
from support.waiting import Deadline, PATIENCE, SLOW, TimedOut

MIXES = ["-".join(mix) for mix in itertools.product(("ours", "theirs"), repeat=3)]


class Mix:
    """Who makes which part of a conversation: two modules and the central between them."""

    def __init__(self, name, libraries, centrals):
        first, second, central = name.split("-")
        self.name = name
        self.first, self.second = libraries[first](), libraries[second]()
        self.central_is_original = central == "theirs"
        self.central_program = centrals[central]()

    @property
    def all_ours(self):
        return self.name == "ours-ours-ours"


@pytest.fixture(params=MIXES)
def mix(request, pytestconfig):
    """All eight combinations of first module, second module and central; needs the originals for
    seven."""
    def get(name):
        return lambda: request.getfixturevalue(name)
    if pytestconfig.ipc_central_is_original and request.param.endswith("ours"):
        pytest.skip("the central under test is an original")
    return Mix(request.param,
               {"ours": get("library"), "theirs": get("original_library")},
               {"ours": get("central_program"), "theirs": get("original_central_program")})


@pytest.fixture
def mixed_central(mix, stack):
    """Starts the central of the mix."""
    def start(*options):
        return stack.enter_context(Central(mix.central_program, *options,
                                           original=mix.central_is_original))
    return start


@pytest.fixture
def pair(mix, mixed_central, start_driver):
    """Two connected driver modules of the mix, FIRST and SECOND."""
    central = mixed_central()
    return tuple(start_driver(name, using=library).connect(central.address)
                 for name, library in (("FIRST", mix.first), ("SECOND", mix.second)))


@pytest.fixture
def await_line():
    """Waits until a program prints a line, touching the keys of others meanwhile.

    An original that waits for its descriptors does not see a message that it has already read;
    a key press makes it look.
    """
    def wait(program, pattern, *originals, stream="stdout"):
        deadline = Deadline()
        while True:
            try:
                return program.wait_for_line(pattern, stream=stream, seconds=min(
                    deadline.left(), 0.5 * SLOW if originals else PATIENCE))
            except TimedOut:
                if deadline.passed():
                    raise
                for original in originals:
                    original.write_line("touched")
    return wait


@pytest.fixture
def start_program(stack, compiler):
    """Compiles a module program and starts it with a library against a central."""
    def start(source, library, central, *, includes=(), **options):
        program = compiler.program(source, library, includes=includes,
                                   flags=["-std=gnu99", "-w"])
        environment = {"CENTRALHOST": central.address if central else "localhost:1",
                       **library.environment()}
        return stack.enter_context(Process(
            [program, *options.pop("arguments", ())], stdin=subprocess.PIPE, env=environment,
            terminal=True, **options))
    return start


@pytest.fixture(scope="session")
def original_tests(pytestconfig):
    """Directory of the original's own test programs."""
    directory = pytestconfig.getoption("--original-tests")
    if not directory:
        pytest.skip("no directory of the original's test programs given (--original-tests)")
    return os.path.abspath(directory)
