"""Fixtures of the tests that mix our programs with those of CMU IPC 3.9.1."""
import itertools
import os
import subprocess

import pytest

from support.processes import Central, Process
from support.waiting import Deadline, PATIENCE, SLOW, TimedOut

WHO = ("ours", "theirs")
MIXES = ["-".join(mix) for mix in itertools.product(WHO, repeat=3)]


class Mix:
    """Who makes which part of a conversation: two modules and the central between them."""

    def __init__(self, name, libraries, centrals):
        first, second, central = name.split("-")
        self.name = name
        self.first, self.second = libraries[first](), libraries[second]()
        self.central_is_original = central == "theirs"
        self.central_program = centrals[central]()


@pytest.fixture
def libraries(request):
    """Whose library → a function that gives it, or skips the test where there is none."""
    return {"ours": lambda: request.getfixturevalue("library"),
            "theirs": lambda: request.getfixturevalue("original_library")}


@pytest.fixture(params=MIXES)
def mix(request, libraries, pytestconfig):
    """All eight combinations of first module, second module and central; needs the originals for
    seven."""
    if pytestconfig.ipc_central_is_original and request.param.endswith("ours"):
        pytest.skip("the central under test is an original")
    return Mix(request.param, libraries,
               {"ours": lambda: request.getfixturevalue("central_program"),
                "theirs": lambda: request.getfixturevalue("original_central_program")})


@pytest.fixture(params=["routed", "direct"])
def way(request):
    """How messages travel: through central, or from module to module (central -c)."""
    return request.param


@pytest.fixture
def mixed_central(mix, stack):
    """Starts the central of the mix."""
    def start(*options):
        return stack.enter_context(Central(mix.central_program, *options,
                                           original=mix.central_is_original))
    return start


@pytest.fixture
def server(way, mixed_central):
    """The central of the mix, started for that way."""
    return mixed_central(*(["-c"] if way == "direct" else []))


@pytest.fixture
def pair(mix, server, start_driver):
    """Two connected driver modules of the mix, FIRST and SECOND."""
    return tuple(start_driver(name, using=library).connect(server.address)
                 for name, library in (("FIRST", mix.first), ("SECOND", mix.second)))


@pytest.fixture(params=WHO)
def trio(request, libraries, pair, server, start_driver):
    """FIRST, SECOND and a THIRD one, of either library."""
    third = start_driver("THIRD", using=libraries[request.param]())
    return (*pair, third.connect(server.address))


@pytest.fixture
def settle():
    """Lets modules take in updates of the list of subscribed messages, which originals need to
    publish.

    A round trip first, so that central has handled everything the module has sent.
    """
    def take_in(*drivers):
        for driver in drivers:
            driver.do("is_defined", "settled")
        for driver in drivers:
            driver.do("listen_clear", 25)
    return take_in


@pytest.fixture
def prime(settle):
    """Lets a module subscribe to messages, and another one publish each of them once.

    The first messages of a subscription may come in any order to an original; from then on the
    order is known.
    """
    def subscribed(publisher, subscriber, *messages, handlers=(0,)):
        for name in messages:
            for handler in handlers:
                subscriber.must("subscribe", name, handler)
        settle(subscriber, publisher)
        for name in messages:
            publisher.must("publish", name, "first")
            subscriber.gather(len(handlers))
    return subscribed


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
    """Compiles a module program, linked with a library, and starts it with the same library or
    another one against a central."""
    def start(source, library, central, *, linked=None, includes=(), **options):
        program = compiler.program(source, linked or library, includes=includes,
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
