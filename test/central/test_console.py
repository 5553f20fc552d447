"""Commands that are typed while the server runs; at a pipe, and at a terminal."""
import os
import pty
import re
import signal
import time

import pytest

from support.peer import Closed, Peer
from support.processes import Central
from support.waiting import wait_until


class Console:
    """A central, what is typed, and what it says since it was last asked."""

    def __init__(self, central):
        self.central = central
        self.read = len(central.stdout)

    def type(self, text):
        self.central.process.stdin.write(text.encode("latin-1"))
        self.central.process.stdin.flush()

    def answer(self, line, last):
        """Types a line; the lines of output up to the one that fits last, without prompts."""
        self.type(line + "\n")
        return self.until(last)

    def until(self, last):
        self.central.wait_for_line(last, start=self.read)
        lines = self.central.stdout[self.read:]
        end = next(number for number, text in enumerate(lines) if re.search(last, text))
        self.read += end + 1
        return [re.sub(r"^(> )+", "", line) for line in lines[:end + 1]]


@pytest.fixture
def start_console(start_central):
    return lambda *options, **popen: Console(start_central(*options, console=True, **popen))


@pytest.fixture
def console(start_console):
    return start_console()


@pytest.fixture
def connect(stack):
    return lambda console, name: stack.enter_context(Peer(console.central, name)).connect()


def busy_pair(console, connect):
    """B has one delivery of M under way and another one in its queue."""
    a, b = connect(console, "A"), connect(console, "B")
    a.define("M")
    a.sync()
    b.subscribe("M", 5)
    b.sync()
    a.publish_number("M", 1)
    a.publish_number("M", 2)
    a.sync()
    console.until(r"Resource B +\(Pending\)")
    return a, b


def test_24_status(console, connect):
    busy_pair(console, connect)
    console.answer("status", "^(> )*Resource status$")
    lines = console.until(" Resource ") + console.until(" Resource ")
    assert " Resource A  Attending: 0  Pending: 0 Resource Status: Active" in lines
    assert " Resource B  Attending: 1  Pending: 1 Resource Status: Active" in lines


def test_25_display(console, connect):
    busy_pair(console, connect)
    console.answer("display", "^(> )*Active and Pending Messages:$")
    lines = console.until(r"M \{\d+\}") + console.until(r"M \{\d+\}")
    assert sorted(re.sub(r"\d+", "N", line) for line in lines) == [
        "  M {N}: Active", "  M {N}: Pending"]


def test_26_memory(console):
    lines = console.answer("memory", "Max Request")
    assert [re.sub(r"-?\d+", "N", line) for line in lines] == [
        "Cumulative Memory Usage:", "  Requests: N (N bytes)", "Data Msg Buffer Stats:",
        "  Total Alloc  : N", "  Total Freed  : N", "  Min Request  : N", "  Max Request  : N"]


@pytest.mark.parametrize("line", ["help", "?", "foo"])
def test_27_the_listing(console, line):
    lines = console.answer(line, "-r: try resending")
    assert ("Unrecognized Command :foo" in lines) == (line == "foo")
    assert "The following command are available:" in lines
    assert "close <module>: Close a connection to a module." in lines
    assert not any("-p<port>" in text for text in lines)


@pytest.mark.new_central("it answers the first of several lines only")
def test_28_an_empty_line_brings_the_prompt_only(console):
    console.type("\n")
    assert console.answer("close nobody", "to close") == ["Can not find nobody to close."]


@pytest.mark.parametrize("name", ["A", "a"])
def test_29_30_close(console, connect, name):
    a, b = connect(console, "A"), connect(console, "B")
    console.until("modName : B")
    console.answer(f"close {name}", rf"close Module: Closing {name}$" if console.central.original
                   else "close Module: Closing A$")
    assert a.is_closed()
    b.sync()
    console.answer("close nobody", "^(> )*Can not find nobody to close.$")


@pytest.mark.new_central("it crashes")
def test_31_the_server_itself_cannot_be_closed(console, connect):
    console.answer("close X_IPC Server", "^(> )*Can not find X_IPC Server to close.$")
    connect(console, "A").sync()


@pytest.mark.new_central("it corrupts its memory")
@pytest.mark.parametrize("name", ["A", "R"])
def test_32_33_unlock(console, connect, name):
    a, b = connect(console, "A"), connect(console, "B")
    b.notice("x_ipc_registerResourceMsg", (1, "R"))
    b.sync()
    a.request("x_ipc_lockResourceMsg", "R")
    console.answer("status", "Resource R .*Locked$")
    console.answer(f"unlock {name}\nstatus", "Resource R .*Active$")
    b.subscribe("M", 5)
    a.define("M")
    a.sync()
    b.sync()
    for number in range(1000):
        a.publish_number("M", number)
    assert b.take_numbers(1000) == list(range(1000))


def test_34_lx(console, connect):
    console.answer("-lx", "Task Control Server")
    a, b = connect(console, "A"), connect(console, "B")
    a.define("M")
    a.sync()
    b.subscribe("M", 5)
    b.sync()
    a.publish_number("M", 1)
    b.take(1)
    b.sync()
    lines = console.answer("close nobody", "to close")
    assert "   modName : B" in lines
    assert not any("Broadcast" in line or "Done" in line for line in lines)


def test_35_lmtir(console, connect):
    console.answer("-lmtir", "Task Control Server")
    a, b = connect(console, "A"), connect(console, "B")
    a.define("M")
    a.sync()
    b.subscribe("M", 5)
    b.sync()
    a.publish_number("M", 1)
    console.until(r"^Broadcast +M \{\d+\}: +A --> B +\(Sent\) [ \d]\d:\d\d:\d\d\.\d\d$")


@pytest.mark.new_central("it answers the first only")
def test_36_several_commands_at_once(console):
    console.type("close one\nclose two\nclose three\n")
    assert [console.until("to close")[-1] for _ in range(3)] == [
        f"Can not find {name} to close." for name in ("one", "two", "three")]


@pytest.mark.new_central("it stops until the line is complete")
def test_37_a_line_in_pieces(console, connect):
    console.type("sta")
    a = connect(console, "A")
    a.sync()
    console.type("tus\n")
    console.until("Resource A ")


def processor_time(process):
    with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def null_device():
    return os.open("/dev/null", os.O_RDONLY)


def closed_pipe():
    read, write = os.pipe()
    os.close(write)
    return read


def left_terminal():
    ours, theirs = pty.openpty()
    os.close(ours)
    return theirs


@pytest.mark.new_central("it writes prompts without end")
@pytest.mark.parametrize("make", [null_device, closed_pipe, left_terminal])
def test_38_the_end_of_the_input_costs_nothing(start_central, stack, make):
    """Its processor time is compared with the time that goes by, which a busy loop would fill."""
    stdin = make()
    central = start_central(console=True, stdin=stdin)
    os.close(stdin)
    peer = stack.enter_context(Peer(central)).connect()
    before, start = processor_time(central), time.monotonic()
    for _ in range(20):
        peer.sync()
        time.sleep(0.01)
    assert processor_time(central) - before < (time.monotonic() - start) / 2
    assert [line for line in central.stdout if line.strip("> ") and "Expecting" not in line
            and "Task Control" not in line and "connection" not in line
            and "Name" not in line] == []


def test_39_nothing_is_read_without_the_interface(start_console, connect):
    console = start_console("-u")
    console.type("status\nquit\n")
    connect(console, "A").sync()
    assert "Resource status" not in console.central.output()


@pytest.mark.new_central("it cuts the line")
def test_40_a_long_line_is_one_command(console):
    lines = console.answer("x" * 300, "-r: try resending")
    assert lines.count("Unrecognized Command :" + "x" * 300) == 1
    assert sum("Unrecognized" in line for line in lines) == 1


def test_41_quit(console, connect):
    a = connect(console, "A")
    console.type("quit\n")
    assert console.central.wait() == 0
    console.central.stop_quietly()
    assert console.central.stderr[0] == "Cumulative Memory Usage:"
    assert console.central.stderr[-1] == "Central Quit"
    assert not os.path.exists(console.central.unix_path)
    with pytest.raises((Closed, OSError)):
        a.sync()


# ---------------------------------------------------------------- what is new


@pytest.mark.new_central("it has no such commands")
def test_tables_show_what_goes_through(console, connect):
    busy_pair(console, connect)
    lines = console.answer("messages", "^M ")
    assert lines[0].split() == ["Message", "Handlers", "Sent", "per", "s", "bytes", "bytes/s",
                                "Delivered", "Waiting", "Dropped"]
    assert lines[-1].split()[:3] == ["M", "1", "2"]
    assert lines[-1].split()[-3:] == ["1", "1", "0"]
    lines = console.answer("queues", "^B ")
    assert lines[-1].split() == ["B", "Active", "1", "1", "1", "12", "0", "0"]
    lines = console.answer("modules", "^B ")
    assert lines[-1].split()[:3] == ["B", "robot", "ready"]


@pytest.mark.new_central("it has no abbreviations")
@pytest.mark.parametrize("line, answer", [
    ("stat", "Resource status"), ("d", "Active and Pending"), ("MEM", "Cumulative"),
    ("mod", "Module"), ("mes", "Message"), ("que", "Resource"), ("cl nobody", "Can not find")])
def test_commands_can_be_shortened(console, line, answer):
    console.answer(line, answer)


@pytest.mark.new_central("it does not say so")
def test_what_cannot_be_changed_any_more_is_said(console):
    console.answer("-p99", "^(> )*The port cannot be changed while running$")
    console.answer("--limit-strangers=5", "^(> )*The limits cannot be changed while running$")


@pytest.mark.new_central("it is silent for good")
def test_asking_for_a_log_ends_silence(console, connect):
    console.type("-s\n")
    console.answer("help", "-r: try")
    connect(console, "QUIET").sync()
    console.answer("-lm", "Task Control Server")
    connect(console, "LOUD")
    console.until("modName : LOUD")
    assert "QUIET" not in console.central.output()


@pytest.mark.new_central("it stops for questions")
def test_comments_are_asked_for_at_a_terminal(stack, central_program, tmp_path):
    """49, 50: with a blank line at once, and with comments at both ends."""
    for typed, boxes in (([], 0), (["Second test", "x" * 80], 2)):
        ours, theirs = pty.openpty()
        central = stack.enter_context(Central(central_program, "-Lmi", "-fa.log", console=True,
                                              stdin=theirs, cwd=tmp_path))
        os.close(theirs)
        asked = "Enter any comments in the log file"
        central.wait_for_line(asked)
        stack.enter_context(Peer(central, "EARLY")).connect()  # it serves
        for line in [*typed, ""]:
            os.write(ours, line.encode() + b"\n")
        os.write(ours, b"close nobody\n")
        central.wait_for_line("Can not find nobody")
        os.write(ours, b"quit\n")
        wait_until(lambda c=central: c.output().count(asked) == 2, "it asks again")
        stack.enter_context(Peer(central, "LATE")).connect()  # it still serves
        os.write(ours, b"The end\n\n" if typed else b"\n")
        assert central.wait() == 0
        central.stop_quietly()
        os.close(ours)
        text = (tmp_path / "a.log").read_text()
        assert text.startswith("Logging Task Control Server ")
        assert text.count("Comments") == boxes
        for line in (*typed[:1], *(["The end"] if typed else [])):
            assert f"\n* {line:<77}*\n" in text
        if typed:
            assert f"\n* {'x' * 76:<77}*\n* {'x' * 4:<77}*\n" in text
        assert all(len(line) == 80 for line in text.split("\n") if line.startswith("*"))


@pytest.mark.new_central("it does not end until somebody answers")
def test_a_signal_asks_for_nothing(stack, central_program, tmp_path):
    ours, theirs = pty.openpty()
    central = stack.enter_context(Central(central_program, "-Lmi", "-fa.log", console=True,
                                          stdin=theirs, cwd=tmp_path))
    os.close(theirs)
    central.wait_for_line("Enter any comments")
    os.write(ours, b"unfinished\n")
    os.write(ours, b"comment\n")
    central.signal(signal.SIGTERM)
    assert central.wait() == 0
    central.stop_quietly()
    os.close(ours)
    assert "".join(central.stdout).count("Enter any comments") == 1


@pytest.mark.new_central("it has no such option")
def test_programs_are_asked_if_they_want(start_central, tmp_path):
    central = start_central("--prompt", "-Lmi", "-fa.log", console=True, cwd=tmp_path)
    central.wait_for_line("Enter any comments")
    for line in ("by a program", "", "quit", ""):
        central.write_line(line)
    assert central.wait() == 0
    central.stop_quietly()
    assert "by a program" in (tmp_path / "a.log").read_text(encoding="latin-1")
    assert "".join(central.stdout).count("Enter any comments") == 2  # at both ends


@pytest.mark.new_central("it asks everywhere")
def test_51_nobody_is_asked_without_a_terminal(start_central, stack, tmp_path):
    central = start_central("-Lmi", "-fa.log", cwd=tmp_path)
    stack.enter_context(Peer(central)).connect()
    assert "Enter any comments" not in central.output()
    assert (tmp_path / "a.log").stat().st_size < 1000
