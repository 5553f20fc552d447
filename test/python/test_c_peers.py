"""Values between Python and modules in C, on our library and on an original (checks 8, 25, 29, 33,
57); and types made by xdrgen in both languages."""
import importlib.util
import io
import itertools
import os
import subprocess
import sys
import time

import pytest

from python.tools import BUILD, ROOT, encoded, ipc as IPC, listen_until, plain
from support import codec
from support.processes import Process
from support.waiting import PATIENCE, SLOW

HERE = os.path.join(ROOT, "test", "python")


class Peer:
    """A module in C that sends values back."""

    def __init__(self, process, original):
        self.process, self.original = process, original
        self._numbers = itertools.count(1)
        self._got = []

    def learn(self, text):
        """Lets it, and this process, know a format; its number."""
        number = next(self._numbers)
        self.process.write_line(f"{number} {text}")
        self.process.wait_for_line(f"^ready {number}$")
        IPC.IPC_subscribe(f"back{number}", self._take)
        self.settle()
        return number

    def settle(self):
        """An original publishes once it has heard of the subscription, in a call that listens."""
        if self.original:
            time.sleep(0.05 * SLOW)

    def _take(self, instance, content, client_data):
        data, _ = IPC.IPC_unmarshall(IPC.IPC_msgInstanceFormatter(instance), content)
        self._got.append((bytes(content), data))

    def send(self, number, value):
        """The bytes and the data that come back, and what it prints."""
        del self._got[:]
        start = len(self.process.stdout)
        IPC.IPC_publishData(f"there{number}", value)
        listen_until(lambda: self._got, "the value comes back")
        self.process.wait_for_line("^end$", start=start)
        printed = self.process.stdout[start:]
        return *self._got[0], "\n".join(printed[:printed.index("end")])


@pytest.fixture(params=["ours", "CMU"])
def which(request):
    """Whose library the modules in C have."""
    return request.param


@pytest.fixture
def start(which, request, stack, central, compiler):
    """Starts a program of this folder on that library."""
    library = request.getfixturevalue("library" if which == "ours" else "original_library")

    def begin(name, includes=()):
        program = compiler.program(os.path.join(HERE, f"{name}.c"), library, includes=includes,
                                   flags=["-std=gnu99"])
        return stack.enter_context(Process(
            [program], stdin=subprocess.PIPE,
            env={"CENTRALHOST": central.address, **library.environment()}))
    return begin


@pytest.fixture
def peer(module, start, which):
    """A module that sends values back, and this process connected."""
    process = start("echo")
    process.wait_for_line("^started$")
    return Peer(process, which == "CMU")


CASES = [
    ("int", 42), ("int", -2**31), ("uint", 2**32 - 1), ("short", -7), ("ushort", 65535),
    ("byte", -1), ("ubyte", 255), ("long", -5), ("ulong", 2**63), ("float", 1.5), ("double", 1e300),
    ("boolean", True), ("char", "x"), ("string", "Hello, world"), ("{enum A, B, C}", 2),
    ("{short, {string, double}}", [666, ["hello", 3.14159]]),
    ("{*int, *{string, double}}", [666, None]),
    ("{*int, *{string, double}}", [7, ["x", 2.0]]),
    ("{int, <int:1>}", [3, [1, 2, 3]]),
    ("{int, int, <int:1,2>}", [2, 2, [[1, 2], [3, 4]]]),
    ("{int, *!}", [1, [2, None]]),
    ("{char, int, boolean, double, byte, long}", ["c", 1, False, 0.5, 3, 2**40]),
    ("[double:2,3]", [[0.0, 1.0, 2.0], [1.0, 2.0, 3.0]]),
    ("{[char:4], [ubyte:3], [short:2]}", [list("word"), [1, 2, 255], [-1, 1]]),
    ("{int, <{string, [int:2]}:1>}", [2, [["a", [1, 2]], ["b", [3, 4]]]]),
    ("{string, {enum WaitVal, SendVal}, [double:2,2]}", ["s", 1, [[0.5, 1.0], [2.0, 3.0]]]),
]


def printed(text, value):
    stream = io.StringIO()
    IPC.IPC_printData(IPC.IPC_parseFormat(text), stream, value)
    # What other programs print is read as Latin-1.
    return stream.getvalue().rstrip("\n").encode("utf-8", "surrogateescape").decode("latin-1")


def test_values_go_to_c_and_come_back(peer):
    for text, value in CASES:
        content, data, shown = peer.send(peer.learn(text), value)
        assert content == encoded(text, value), text
        assert plain(data) == value, text
        if not (peer.original and "byte" in text):  # which it prints as if it had four of them
            assert shown == printed(text, value), text


def test_queries_are_answered_by_c(peer):
    for text, value in CASES[15:20]:
        number = peer.learn(text)
        answer, result = IPC.IPC_queryResponseData(f"ask{number}", value, PATIENCE * 1000)
        assert (plain(answer), result) == (value, IPC.IPC_OK)
        got = []
        IPC.IPC_queryNotifyData(f"ask{number}", value, lambda _, data, __: got.append(data))
        listen_until(lambda: got)
        assert plain(got[0]) == value


@pytest.mark.new_central("does not end any more after hundreds of messages")
@pytest.mark.parametrize("which", ["ours"], indirect=True)
@pytest.mark.skipif(sys.version_info < (3, 10), reason="the other implementation needs it")
def test_random_values_are_the_same_in_c(peer):
    hypothesis = pytest.importorskip("hypothesis")
    from python.test_random_values import VALUES  # pylint: disable=import-outside-toplevel

    @hypothesis.settings(max_examples=200, deadline=None, database=None,
                         suppress_health_check=list(hypothesis.HealthCheck))
    @hypothesis.given(VALUES)
    def exchange(case):
        text, value, other = case
        if value is None and not text.startswith("*"):
            return
        content, data, shown = peer.send(peer.learn(text), value)
        assert content == codec.encode(text, other, "=")
        assert plain(data) == value
        assert shown == printed(text, value)
    exchange()


# ----------------------------------------------------------------------- xdrgen


@pytest.fixture
def made(tmp_path):
    """The types of robot.xdr: a header in tmp_path, and a module."""
    program = os.path.join(BUILD, "xdrgen", "xdrgen")
    if not os.access(program, os.X_OK):
        pytest.skip(f"no xdrgen at {program}")
    source = os.path.join(HERE, "robot.xdr")
    for language, target in (("c", "robot.h"), ("python", "robot.py")):
        subprocess.run([program, f"--lang={language}", source, tmp_path / target], check=True,
                       timeout=PATIENCE)
    spec = importlib.util.spec_from_file_location("robot_by_xdrgen", tmp_path / "robot.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def make_robot(made):
    return made.Robot(
        number=1, name="Rob", mode=made.State.DRIVING, active="y", speeds=[0.5, 1.0, 1.5],
        home=made.Point(1.0, 2.0), serial=list("S-01"), levels=[[1, 2], [3, 4]], n=2,
        path=[made.Point(1.0, 1.0), made.Point(2.0, 2.0)], rows=1, columns=2, grid=[[3.0, 4.0]],
        labels=["left", "right"])


def test_types_made_by_xdrgen(ipc, central, made):
    robot = make_robot(made)
    with ipc.connect("test", central.address) as connection:
        connection.define("robot", made.Robot)
        assert connection.format(made.Robot).encode(robot) == encoded(made.Robot_IPC_FORMAT, robot)
        got = []
        connection.subscribe("robot", got.append, type=made.Robot)
        for value in (robot, made.Robot()):
            connection.publish("robot", value)
        listen_until(lambda: len(got) == 2)
    assert [message.data for message in got] == [robot, made.Robot()]
    assert isinstance(got[0].data.mode, made.State) and isinstance(got[0].data.path[1], made.Point)


def test_types_made_by_xdrgen_in_both_languages(ipc, central, made, start, tmp_path, which):
    start("robot", [str(tmp_path)]).wait_for_line("^ready$")
    robot = make_robot(made)
    with ipc.connect("test", central.address) as connection:
        messages = connection.messages("back", type=made.Robot, timeout=PATIENCE)
        if which == "CMU":
            time.sleep(0.2 * SLOW)  # until it has heard of the subscription
        connection.publish("there", robot)
        back = messages.get().data
        messages.close()
    robot.number, robot.mode, robot.active, robot.speeds = 2, made.State.FAULT, "n", [0.5, 1.0, 3.0]
    robot.home, robot.serial, robot.levels = made.Point(1.0, -2.0), list("back"), [[1, 2], [255, 4]]
    robot.path[1].x, robot.grid[0][1], robot.labels[0] = 2.5, 1e300, "Left"
    assert back == robot
