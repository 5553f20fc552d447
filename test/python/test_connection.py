"""Connections as objects: with blocks, decorators, iterators, type hints (checks 70 to 72, 74)."""
import dataclasses
import enum
import logging
import os
import sys
import threading
import time
from typing import Annotated, List, NamedTuple, Optional, Tuple

import pytest

from python.tools import BUILD, Program, decoded, encoded, ipc as IPC
from support.waiting import PATIENCE, SLOW


@pytest.fixture
def connection(ipc, central):
    """A connection to a central of its own."""
    with ipc.connect("test", central.address) as connected:
        yield connected
    assert not ipc.IPC_isConnected()


@pytest.fixture
def programs(monkeypatch):
    """The package finds central."""
    monkeypatch.setenv("PATH", os.path.join(BUILD, "src/c/central"), prepend=os.pathsep)


def listen_until(connection, condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        connection.listen(0.05)


# ------------------------------------------------------------------- type hints


class Mode(enum.IntEnum):
    """A member of messages."""
    IDLE = 0
    RUN = 1


class Level(enum.IntEnum):
    """With gaps."""
    LOW = 1
    HIGH = 8


@dataclasses.dataclass(frozen=True)
class Point:
    """Nested in others."""
    x: float
    y: float = 0.0


class Pair(NamedTuple):
    """A named tuple."""
    first: int
    second: Point


@dataclasses.dataclass
class Everything:
    """All kinds of members."""
    number: int
    small: IPC.Short
    real: IPC.Float
    flag: bool
    text: str
    mode: Mode
    level: Level
    point: Point
    maybe: Optional[Point]
    path: List[Point]
    names: List[str]
    corner: Tuple[float, float, float]
    size: int
    values: Annotated[List[float], "<double:size>"]
    matrix: Annotated[List[List[float]], "[double:2,2]"]
    raw: Annotated[bytes, "[ubyte:3]"]
    word: Annotated[str, "[char:4]"]
    pair: Pair


@dataclasses.dataclass
class Node:
    """A list."""
    value: int
    next: "Optional[Node]" = None


EVERYTHING = Everything(
    1, 2, 0.5, True, "text", Mode.RUN, Level.HIGH, Point(1.0, 2.0), None, [Point(3.0), Point(4.0)],
    ["a", "b"], (1.0, 2.0, 3.0), 2, [5.0, 6.0], [[1.0, 2.0], [3.0, 4.0]], b"xyz", "word",
    Pair(7, Point(8.0, 9.0)))


def test_formats_follow_from_type_hints():
    point = "{double, double}"
    assert IPC.format_of(Everything) == (
        "{int, short, float, boolean, string, {enum IDLE, RUN}, {enum : 8}, " + point + ", *"
        + point + ", int, <" + point + ":10>, int, <string:12>, [double:3], int, <double:15>, "
        "[double:2,2], [ubyte:3], [char:4], {int, " + point + "}}")
    assert IPC.format_of(Node) == "{int, *!}"
    assert IPC.format_of(Pair) == "{int, {double, double}}"
    for hint, text in ((int, "int"), (str, "string"), (Optional[int], "*int"), (Mode,
                       "{enum IDLE, RUN}"), (IPC.ULong, "ulong"), (Tuple[int, int], "[int:2]")):
        assert IPC.format_of(hint) == text
    for hint in (list, dict, object, Tuple[int, str], Tuple[int, ...]):
        with pytest.raises(TypeError):
            IPC.format_of(hint)


def test_data_classes_and_named_tuples_go_there_and_back(ipc):
    text = ipc.format_of(Everything)
    assert decoded(text, encoded(text, EVERYTHING), Everything) == EVERYTHING
    pair = Pair(1, Point(2.0, 3.0))
    assert decoded(ipc.format_of(Pair), encoded(ipc.format_of(Pair), pair), Pair) == pair
    nodes = Node(1, Node(2, Node(3)))
    assert decoded("{int, *!}", encoded("{int, *!}", nodes), Node) == nodes
    unknown = dataclasses.replace(EVERYTHING, mode=77)
    assert decoded(text, encoded(text, unknown), Everything).mode == 77
    with pytest.raises(TypeError, match=r"Everything\.path\[1\]\.x: expected double, got 'x'"):
        encoded(text, dataclasses.replace(EVERYTHING, path=[Point(1.0), Point("x")]))


def test_formats_by_hand_fit_data_classes_too(ipc):
    @dataclasses.dataclass
    class Lists:
        """Its sizes are attributes."""
        count: int
        items: List[int]
    text = "{int, <int:1>}"
    assert decoded(text, encoded(text, Lists(2, [3, 4])), Lists) == Lists(2, [3, 4])
    assert ipc.format_of(Lists) == "{int, int, <int:2>}"
    text = ipc.format_of(Lists)
    assert decoded(text, encoded(text, Lists(9, [3, 4])), Lists) == Lists(9, [3, 4])
    with pytest.raises(TypeError, match="Lists has 2 members"):
        decoded("{int, int, int, int}", bytes(16), Lists)


# ------------------------------------------------------------------ connections


def test_decorated_functions_get_messages(connection):
    got = []
    connection.define("point", Point)

    @connection.subscribe("point", type=Point)
    def on_point(message):
        got.append(message)
    connection.publish("point", Point(1.0, 2.0))
    listen_until(connection, lambda: got)
    assert (got[0].name, got[0].data) == ("point", Point(1.0, 2.0))
    assert got[0].context == connection.context
    connection.unsubscribe("point", on_point)
    connection.publish("point", Point(1.0, 2.0))
    assert connection.listen(0.03) is False


def test_subscriptions_can_be_cancelled(connection):
    got = []
    connection.define("m", int)
    with connection.subscribe("m", got.append):
        connection.publish("m", 1)
        listen_until(connection, lambda: got)
    assert IPC.IPC_numHandlers("m") == 0
    subscription = connection.subscribe("m", got.append)
    assert IPC.IPC_numHandlers("m") == 1
    subscription.cancel()
    assert IPC.IPC_numHandlers("m") == 0


def test_queries(connection):
    connection.define("query", int)
    connection.define("answer", Point)

    @connection.subscribe("query")
    def answer(message):
        if message.data > 0:
            message.respond("answer", Point(message.data))
    assert connection.query("query", 3, timeout=PATIENCE, type=Point) == Point(3.0)
    assert connection.query("query", 4).f0 == 4.0
    with pytest.raises(IPC.IPCTimeout, match="no answer to 'query' within 0.02 seconds"):
        connection.query("query", 0, timeout=0.02)
    with pytest.raises(TimeoutError):
        connection.query("query", 0, timeout=0.0)


def test_errors_are_exceptions_of_their_own_whatever_the_verbosity(connection):
    IPC.IPC_setVerbosity(IPC.IPC_Silent)
    for call, error in ((lambda: connection.publish("unknown", 1), IPC.MessageNotDefined),
                        (lambda: connection.query("unknown", 1), IPC.MessageNotDefined),
                        (lambda: connection.define("m", "{"), IPC.IllegalFormat),
                        (lambda: connection.define("", "int"), IPC.NullArgument),
                        (lambda: connection.every(0, print), IPC.OutOfRange),
                        (lambda: IPC.connect("m", "localhost:1"), IPC.NotConnected)):
        with pytest.raises(error) as caught:
            call()
        assert isinstance(caught.value, IPC.IPCError)
    assert issubclass(IPC.NotConnected, ConnectionError) and issubclass(IPC.IPCTimeout,
                                                                         TimeoutError)


def test_dispatch_ends_when_told(connection):
    connection.define("m", int)
    connection.subscribe("m", lambda message: connection.stop())
    connection.publish("m", 1)
    connection.dispatch()
    connection.after(0.01, connection.stop)
    connection.dispatch()
    threading.Timer(0.05, connection.stop).start()
    begin = time.monotonic()
    connection.dispatch()
    assert time.monotonic() - begin < 1 * SLOW
    connection.after(0.01, connection.close)
    connection.dispatch()
    IPC.IPC_setVerbosity(IPC.IPC_Silent)
    with pytest.raises(IPC.NotConnected):
        connection.listen()


def test_timers(connection):
    ticks = []
    timer = connection.every(0.005, lambda: ticks.append(1))
    listen_until(connection, lambda: len(ticks) >= 3)
    timer.cancel()
    timer.cancel()
    del ticks[:]
    connection.listen(0.03)
    assert not ticks
    once = connection.after(0.005, lambda: ticks.append(1))
    listen_until(connection, lambda: ticks)
    once.cancel()


def test_messages_can_be_iterated_over(connection):
    for name in ("a", "b"):
        connection.define(name, int)
    messages = connection.messages("a", "b", timeout=0.1 * SLOW)
    for number in range(5):
        connection.publish("a", number)
        connection.publish("b", -number)
    got = [(message.name, message.data) for message in messages]
    assert sorted(got) == sorted([("a", k) for k in range(5)] + [("b", -k) for k in range(5)])
    assert IPC.IPC_numHandlers("a") == 0
    messages = connection.messages("a")
    connection.publish("a", 7)
    for message in messages:
        assert message.data == 7
        break
    del message
    messages.close()
    assert IPC.IPC_numHandlers("a") == 0


def test_the_oldest_of_too_many_messages_are_dropped(connection):
    connection.define("a", int)
    with connection.messages("a", timeout=0.05 * SLOW, maxsize=3) as messages:
        for number in range(10):
            connection.publish("a", number)
        while connection.listen(0.05 * SLOW):
            pass
        assert [message.data for message in messages] == [7, 8, 9]
        assert messages.dropped == 7


def test_queries_can_be_iterated_over(connection, program):
    connection.define("query", int)
    asker = program("""
        import ipc_cffi
        with ipc_cffi.connect("asker") as ipc:
            print("ready")
            print([ipc.query("query", number, timeout=30) for number in range(3)])
        """)
    asker.wait_for_line("ready")
    count = 0
    for message in connection.messages("query", queries=True):
        message.respond("query", message.data * 10)
        count += 1
        if count == 3:
            break
    asker.wait_for_line(r"\[0, 10, 20\]")


def test_failing_handlers_can_be_logged(ipc, central, caplog):
    def fail(message):
        raise ValueError(f"boom {message.data}")
    failures = []
    for choice, done in (("log", lambda: "boom 1" in caplog.text),
                         (failures.append, lambda: failures)):
        with ipc.connect("test", central.address, on_handler_error=choice) as connection:
            connection.define("m", int)
            connection.subscribe("m", fail)
            connection.publish("m", 1)
            with caplog.at_level(logging.DEBUG, "ipc"):
                listen_until(connection, done)
    assert isinstance(failures[0], ValueError)
    assert any(record.name == "ipc.handlers" for record in caplog.records)
    with ipc.connect("test", central.address) as connection:
        connection.define("m", int)
        connection.subscribe("m", fail)
        connection.publish("m", 2)
        with pytest.raises(ValueError, match="boom 2"):
            connection.listen(PATIENCE)


def test_what_the_library_says_can_be_logged(ipc, central, caplog, capfd):
    def said():
        return [(record.levelname, record.getMessage()) for record in caplog.records
                if record.name == "ipc.lib"]

    ipc.capture_output()
    try:
        with caplog.at_level(logging.INFO, "ipc.lib"), ipc.connect("m", central.address) as module:
            assert [level for level, text in said() if "IPC Version" in text] == ["INFO"]
            port = central.address.split(":")[1]
            assert ("WARNING", f"... IPC Connected on port {port}") in said()
            caplog.clear()
            with pytest.raises(ipc.MessageNotDefined):
                module.publish("unknown", 1)
            assert said() == [
                ("ERROR", "ERROR: x_ipc_msgFind: Query for message unknown returned NULL."),
                ("ERROR", "ERROR: IPC message not defined")]
            ipc.IPC_removeTimer(said)
        assert capfd.readouterr() == ("", "")
    finally:
        ipc.capture_output(False)
    caplog.clear()
    ipc.IPC_removeTimer(said)
    assert "does not exist" in capfd.readouterr().err
    assert not said()


def test_no_text_of_the_library_gets_lost(ipc, central, caplog, capfd):
    library = ipc.errors.lib
    ipc.capture_output()
    try:
        with ipc.connect("m", central.address):
            caplog.clear()
            for _ in range(600):  # of two texts each, and no call that fetches them between
                library.IPC_publish(b"unknown", 0, ipc.errors.ffi.NULL)
    finally:
        ipc.capture_output(False)
    logged = [record.getMessage() for record in caplog.records if record.name == "ipc.lib"]
    written = [line for line in capfd.readouterr().err.splitlines() if line]
    assert len(logged) == 1000 and len(logged + written) == 1200
    assert set(logged) == set(written)


def test_traffic_is_logged_if_wished(connection, caplog):
    connection.define("m", int)
    connection.subscribe("m", lambda message: None)
    with caplog.at_level(logging.DEBUG, "ipc.traffic"):
        connection.publish("m", 1)
        connection.listen(PATIENCE)
    assert [record.getMessage() for record in caplog.records] == [
        "published m, 4 bytes", "received m, 4 bytes"]


def test_two_connections_leave_each_other_alone(ipc, start_central):
    centrals = [start_central(), start_central()]
    got = []
    with ipc.connect("a", centrals[0].address) as first:
        with ipc.connect("b", centrals[1].address) as second:
            for number, connection in enumerate((first, second)):
                connection.define("m", int)
                connection.subscribe("m", lambda message, n=number: got.append((n, message.data)))
            first.publish("m", 1)
            second.publish("m", 2)
            listen_until(first, lambda: len(got) == 2)
            assert sorted(got) == [(0, 1), (1, 2)]
        assert first.is_connected and not second.is_connected
        first.publish("m", 3)
        listen_until(first, lambda: len(got) == 3)


def test_arrays_of_numpy_on_demand(connection):
    numpy = pytest.importorskip("numpy")
    got = []
    connection.define("image", "{int, int, <ubyte:1,2>}")
    connection.subscribe("image", got.append, numpy=True)
    image = numpy.arange(12, dtype="u1").reshape(3, 4)
    connection.publish("image", (None, None, image))
    listen_until(connection, lambda: got)
    assert (got[0].data.f2 == image).all()


# ---------------------------------------------------------------------- servers


def test_a_private_server(programs, ipc, monkeypatch):
    monkeypatch.delenv("CENTRALHOST", raising=False)
    with ipc.Central() as central:
        assert os.environ["CENTRALHOST"] == central.address
        with ipc.connect("m") as connection:
            connection.define("m", int)
        with ipc.Central(environment=False) as other:
            assert other.port != central.port
            assert os.environ["CENTRALHOST"] == central.address
        assert "modName : m" in central.output()
    assert "CENTRALHOST" not in os.environ
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setattr("ipc_cffi._programs.PLACE", "/nowhere")
    with pytest.raises(FileNotFoundError, match="central is neither"):
        ipc.Central().start()


def test_an_embedded_server():
    path = os.path.join(BUILD, "src/c/central") + os.pathsep + os.environ["PATH"]
    with Program("""
        import ipc_cffi, os
        with ipc_cffi.connect("m") as ipc:
            ipc.define("m", int)
            ipc.publish("m", 1)
            print("server", os.environ["CENTRALHOST"])
        """, env={"CENTRALHOST": "embedded:", "PATH": path}) as started:
        port = int(started.wait_for_line(r"server localhost:(\d+)").group(1))
        assert started.wait() == 0
    with Program(f"""
        import socket
        print(socket.socket().connect_ex(("localhost", {port})) != 0)
        """) as asked:
        asked.wait_for_line("True")


def test_nothing_big_is_imported():
    assert Program("""
        import sys, ipc_cffi
        print({"asyncio", "numpy", "logging", "subprocess"} & set(sys.modules))
        """).wait_for_line(r"set\(\)")
    assert sys.version_info >= (3, 9)


def test_modules_for_event_loops_are_imported_when_they_are_used():
    Program("""
        import sys, ipc_cffi
        assert "ipc_cffi.aio" not in sys.modules and not hasattr(ipc_cffi, "something else")
        print(ipc_cffi.aio.connect is sys.modules["ipc_cffi.aio"].connect,
              ipc_cffi.testing.central.__name__)
        """).wait_for_line("True central")


# ------------------------------------------------------------------ small things


@pytest.mark.parametrize("call, text", [
    (lambda module: module.publish("unknown", 1), "IPC message not defined: 'unknown'"),
    (lambda module: module.query(name="unknown"), "IPC message not defined: 'unknown'"),
    (lambda module: module.ask("unknown", 1, print), "IPC message not defined: 'unknown'"),
    (lambda module: module.define("m", "{int,"), "Illegal format string: '{int,'"),
    (lambda module: module.format("{int,"), "Illegal format string: '{int,'"),
    (lambda module: module.publish("undecided", 1), "Illegal format string: 'undecided'"),
], ids=lambda value: value if isinstance(value, str) else "")
def test_errors_say_what_they_are_about(ipc, connection, call, text):
    connection.define("undecided", "{int, later}")
    with pytest.raises(ipc.IPCError) as caught:
        call(connection)
    assert (str(caught.value), caught.value.args[0]) == (text, text.split(":")[0])


def test_who_is_there_can_be_seen(ipc, monkeypatch):
    monkeypatch.setenv("PATH", os.path.join(BUILD, "src/c/central"), prepend=os.pathsep)
    central = ipc.Central()
    assert repr(central) == "<Central not running>"
    with central:
        assert repr(central) == f"<Central at localhost:{central.port}>"
        with ipc.connect("m") as connection:
            assert repr(connection) == "<Connection 'm'>"
        assert repr(connection) == "<Connection 'm', closed>"
    assert repr(central) == "<Central not running>"


def test_who_finds_no_server_is_told_where_none_is(ipc, monkeypatch, capfd):
    for server, place in ((None, "localhost:1"), ("127.0.0.1:1", "127.0.0.1:1")):
        monkeypatch.setenv("CENTRALHOST", "localhost:1")
        with pytest.raises(ipc.NotConnected) as caught:
            ipc.connect("m", server, wait=False)
        assert str(caught.value) == \
            f"Not connected to IPC central: is there a central at {place}?"
        assert caught.value.errno == ipc.IPC_Not_Connected
    assert capfd.readouterr() == ("", "")
    with pytest.raises(ValueError, match="listen=False"):
        ipc.connect("m", wait=False, listen=False)


def test_a_server_that_is_there_need_not_be_waited_for(ipc, central):
    with ipc.connect("m", central.address, wait=False) as connection:
        assert connection.is_connected and ipc.IPC_isModuleConnected("m")


def test_errors_as_codes(ipc, central):
    with ipc.connect("test", central.address, errors="code") as connection:
        assert connection.define("m", int) == ipc.IPC_OK
        assert connection.define("n", "{") == ipc.IPC_Error
        assert ipc.IPC_errno == ipc.IPC_Illegal_Formatter
        assert connection.publish("unknown", 1) == ipc.IPC_Error
        assert ipc.IPC_errno == ipc.IPC_Message_Not_Defined
        assert connection.query("m", 1, timeout=0.01) is None
        assert ipc.IPC_errno == ipc.IPC_No_Error
        assert connection.every(0, print) is None and connection.format("{") is None
        assert connection.subscribe("", print) is None
        assert connection.publish("m", 1) == ipc.IPC_OK
        with pytest.raises(TypeError):
            connection.publish("m", "x")  # what is wrong in the program itself is not hidden

        def fail(message):
            raise ipc.MessageNotDefined("of the handler", 3)
        connection.subscribe("m", fail)
        connection.publish("m", 1)
        with pytest.raises(ipc.MessageNotDefined, match="of the handler"):
            connection.listen(PATIENCE)


def test_formats_are_objects(ipc, connection):
    connection.define_format("point", Point)
    named = connection.format("{int, point}")
    content = named.encode((1, Point(2.0, 3.0)))
    assert content == bytes.fromhex("01000000" "0000000000000040" "0000000000000840")
    assert connection.format(Pair).decode(content) == Pair(1, Point(2.0, 3.0))
    assert named.decode(content, type=Pair) == Pair(1, Point(2.0, 3.0))
    assert ipc.Format("int").decode(b"\0\0\0\1", order="big") == 1
    assert named.print((1, Point(2.0, 3.0))) == "{1, {2.00, 3.00}}"
    assert repr(ipc.Format("{ int,double }")) == "Format('{int, double}')"
    for text in ("", "{int", None):
        with pytest.raises((ipc.IllegalFormat, TypeError)):
            ipc.Format(text)
    with pytest.raises(ipc.BadData):
        named.decode(content[:-1])
    with pytest.raises(TypeError, match="expected int"):
        named.encode(("x", Point(2.0)))


def test_stopping_needs_no_waiting(connection):
    """The wait is ended, and not only asked for every 200 milliseconds."""
    quickest = PATIENCE
    for _ in range(10):
        stopped = []

        def stop(stopped=stopped):
            time.sleep(0.01)
            stopped.append(time.monotonic())
            connection.stop()
        thread = threading.Thread(target=stop)
        thread.start()
        connection.dispatch()
        quickest = min(quickest, time.monotonic() - stopped[0])
        thread.join()
    assert quickest < 0.1
    connection.stop()
    connection.dispatch()  # told before it began


def test_stop_after_close_does_nothing(ipc, central):
    descriptors = len(os.listdir("/proc/self/fd"))
    with ipc.connect("test", central.address) as connection:
        connection.after(0.001, connection.stop)
        connection.dispatch()
    connection.stop()
    connection.close()
    assert len(os.listdir("/proc/self/fd")) <= descriptors


def test_asking_without_waiting(connection):
    connection.define("q", int)
    connection.subscribe("q", lambda message: message.respond("q", message.data + 1))
    got = []
    connection.ask("q", 1, got.append)
    listen_until(connection, lambda: got)
    assert got == [2]
    connection.ask("q", 5, got.append).cancel()
    connection.query("q", 0)
    assert got == [2]


def test_equal_members(ipc):
    def make(last):
        inner = ipc.IPCdata(f0=1)
        return ipc.IPCdata(f0=inner, f1=[inner, last])
    assert ipc.eq(make(2), make(2)) and not ipc.eq(make(2), make(3))
    assert make(2) != make(2) and not ipc.eq(make(1), ipc.IPCdata())
    assert ipc.eq((1, 2), [1, 2]) and not ipc.eq([1], [1, 2])


def test_the_version_of_the_library(ipc):
    assert ipc.library_version() == ipc.__version__
