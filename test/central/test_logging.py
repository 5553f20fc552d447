"""What the logs show by which switches, their files, and that they never stop the server."""
import json
import os
import re
import select
import signal
import struct
import subprocess
import time

import pytest

from support.peer import Peer
from support.processes import Process, free_port
from support.waiting import wait_until


@pytest.fixture
def connect(stack):
    return lambda central, name: stack.enter_context(Peer(central, name)).connect()


class Log:
    """A log file in a directory."""

    def __init__(self, directory, name="a.log"):
        self.path = directory / name

    def text(self):
        return self.path.read_text("latin-1") if self.path.exists() else ""

    def lines(self):
        return self.text().split("\n")

    def until(self, pattern):
        wait_until(lambda: re.search(pattern, self.text(), re.MULTILINE), f"{pattern} in the log")


@pytest.fixture
def log(tmp_path):
    return Log(tmp_path)


def traffic(central, connect):
    """A delivery and its end, and a definition anew; after that everything is in the log."""
    a, b = connect(central, "A"), connect(central, "B")
    a.define("Ping")
    a.define("Ping")
    a.sync()
    b.subscribe("Ping", 5)
    b.sync()
    a.publish_number("Ping", 7)
    b.take(1)
    b.sync()
    return a, b


def end(central):
    central.signal(signal.SIGTERM)
    central.wait()
    central.stop_quietly()


def shown(text):
    """Letters of what a log shows."""
    found = set()
    for letter, pattern in (("m", r"^Broadcast +Ping.*\(Sent\)"), ("s", r"^Closed Connection"),
                            ("t", r"\(Sent\)  ?[ \d]\d:\d\d:\d\d\.\d\d$"), ("d", r"^    7$"),
                            ("h", r"^ +\d+: Msg: "), ("r", r"^Broadcast +Ping \{"),
                            ("p", r"A \{-1\} -->")):
        if re.search(pattern, text, re.MULTILINE):
            found.add(letter)
    if not re.search(r"x_ipc_registerMessageMsg", text):
        found.add("i")
    return "".join(sorted(found))


@pytest.mark.parametrize("letters, expected", [
    ("", "dhmst"), ("m", "m"), ("ms", "ms"), ("x", "i"), ("mx", "i"), ("z", "i"), ("MIT", "imt"),
    ("rp", "i"), ("mrp", "mpr"), ("D", "i"), ("h", "hi"), ("msdi", "dims")])
@pytest.mark.parametrize("where", ["-l", "-L"])
def test_46_letters(start_central, connect, log, where, letters, expected):
    file = ("-lx", f"-L{letters}{'n' if letters else ''}") if where == "-L" else (f"-l{letters}",)
    central = start_central(*file, "-fa.log", cwd=log.path.parent)
    a, _ = traffic(central, connect)
    a.close()
    central.wait_for_line("close Module: Closing A")
    opens = "x" not in letters and set(letters.lower() or "m") & set("mstdh")
    if where == "-L" and opens:
        log.until("close Module: Closing A")
    end(central)
    text = log.text() if where == "-L" else "\n".join(central.stdout)
    if where == "-L" and not opens:
        assert text == ""  # such letters open no file
    else:
        assert shown(text) == expected
        assert "close Module: Closing A" in text


@pytest.mark.parametrize("letters, is_shown", [("mi", False), ("m", True)])
def test_47_messages_to_ignore(start_central, connect, letters, is_shown):
    central = start_central(f"-l{letters}", "-iping")
    traffic(central, connect)
    end(central)
    assert ("Broadcast            Ping:" in "\n".join(central.stdout)) == is_shown


def test_48_modules_can_have_messages_ignored(start_central, connect):
    central = start_central("-lmi")
    a, b = traffic(central, connect)
    a.notice("x_ipc_ignoreLogging", "Ping")
    a.publish_number("Ping", 1)
    b.take(1)
    b.sync()
    a.notice("x_ipc_resumeLogging", "ping")
    a.publish_number("Ping", 2)
    b.take(1)
    b.sync()
    end(central)
    assert sum(line.startswith("Broadcast ") for line in central.stdout) == 2


def test_52_the_file_log_of_everything_asks_for_nothing(start_central, connect, log):
    central = start_central("-lx", "-L", "-fa.log", cwd=log.path.parent)
    traffic(central, connect)
    end(central)
    assert set("dhmt") <= set(shown(log.text()))
    assert "x_ipc_registerMessageMsg" in log.text()
    assert "Enter any comments" not in central.output()


def test_53_a_file_may_lag(start_central, connect, log):
    central = start_central("-lx", "-LmiFN", "-fa.log", cwd=log.path.parent)
    traffic(central, connect)
    assert "Done" not in log.text()
    end(central)
    assert "Done" in log.text()
    assert log.text().endswith("Central Abort : Signal 15\n")


def test_54_a_file_is_written_anew(start_central, log):
    for _ in range(2):
        end(start_central("-LmiN", "-fa.log", cwd=log.path.parent))
    assert log.text().count("Logging Task Control Server") == 1


def test_55_a_file_without_a_name(start_central, tmp_path):
    end(start_central("-LmiN", cwd=tmp_path))
    name, = os.listdir(tmp_path)
    assert re.fullmatch(r"x_ipc\.log\.\d{10}", name)


@pytest.mark.parametrize("zone, hour", [(9, r"  9"), (10, r" 10")])
def test_58_times_are_those_of_the_place(start_central, connect, zone, hour):
    """The zone is chosen so that it is that hour."""
    offset = (time.gmtime().tm_hour - zone) % 24
    central = start_central("-lmt", env={"TZ": f"XXX{offset if offset <= 12 else offset - 24}"})
    if time.gmtime().tm_min == 59:
        hour = r"[ \d]{2}\d"
    traffic(central, connect)
    central.wait_for_line(r"\(Sent\)" + hour + r":\d\d:\d\d\.\d\d$")


@pytest.mark.parametrize("width", range(70, 84))
def test_59_lines_break_as_they_always_did(start_central, connect, width):
    """A value whose text has a width near that of a line: two numbers in a structure."""
    central = start_central("-lmd")
    a, b = connect(central, "A"), connect(central, "B")
    a.define("Text", "{string, int}")
    a.sync()
    b.subscribe("Text", 5)
    b.sync()
    text = "x" * (width - 13)
    a.publish("Text", struct.pack("<i", len(text)) + text.encode() + struct.pack("<i", 7))
    b.take(1)
    b.sync()
    central.wait_for_line("Done +Text")
    start = next(n for n, line in enumerate(central.stdout) if "Text" in line and "Sent" in line
                 and "Broadcast" in line)
    stop = next(n for n, line in enumerate(central.stdout) if "Done" in line and "Text" in line)
    assert "\n".join(central.stdout[start + 1:stop]) == broken(text)


def broken(text):
    """A string and a 7 in a structure by the rules: tokens, each with room to keep behind it."""
    tokens = [("{", 10), ('"', 1), (text, 1), ('"', 1), (",", 0), (" ", None), ("7", 1), ("}", 0)]
    lines = ["    "]
    for token, keep in tokens:
        if keep is None and len(lines[-1]) == 80:
            lines.append("    ")
        elif keep is not None and len(lines[-1]) + len(token) + keep > 80:
            lines.append("     ")
        lines[-1] += token
    return "\n".join(lines)


@pytest.mark.new_central("it has no end of trying")
def test_61_a_full_disk_ends_the_file_only(start_central, connect):
    central = start_central("-lx", "-LmiN", "-f/dev/full")
    central.wait_for_line("^ERROR: Can not write file /dev/full.$", stream="stderr")
    traffic(central, connect)
    assert sum("/dev/full" in line for line in central.stderr) == 1


class Piped(Process):
    """A central whose output goes into a pipe that only the test reads."""

    def __init__(self, program, *options):
        self.port = free_port()
        self.reading, writing = os.pipe()
        command = f"exec {program} -u -p{self.port} {' '.join(options)} >/proc/self/fd/{writing}"
        super().__init__(["sh", "-c", command], pass_fds=(writing,))
        os.close(writing)

    def connect(self, stack, name):
        """A module, once the server serves."""
        def try_it():
            try:
                return stack.enter_context(Peer(self, name)).connect()
            except OSError:
                return None
        return wait_until(try_it, "it serves")

    def take_output(self):
        """What has come by now."""
        ready = select.select([self.reading], [], [], 0.05)[0]
        return os.read(self.reading, 1 << 20) if ready else b""


def piped_pair(central, stack):
    a, b = central.connect(stack, "A"), central.connect(stack, "B")
    a.define("Ping", None)
    a.sync()
    b.subscribe("Ping", 5)
    b.sync()
    return a, b


@pytest.mark.new_central("it stops")
def test_62_output_that_nobody_reads(central_program, stack):
    """Far more than a pipe holds; everybody is served, and later everything is there."""
    central = stack.enter_context(Piped(central_program, "-lm"))
    a, b = piped_pair(central, stack)
    count = 5000
    for number in range(0, count, 50):
        for offset in range(50):
            a.publish_number("Ping", number + offset)
        assert b.take_numbers(50) == list(range(number, number + 50))
    b.sync()
    taken = bytearray()

    def has_all():
        taken.extend(central.take_output())
        return taken.count(b"  Done               Ping:\n") == count
    wait_until(has_all, "all lines have come")
    assert b"lost" not in taken
    os.close(central.reading)


@pytest.mark.new_central("it writes about the broken pipe")
def test_105_output_whose_reader_has_gone(central_program, stack):
    central = stack.enter_context(Piped(central_program, "-lm"))
    a, b = piped_pair(central, stack)
    os.close(central.reading)
    for number in range(10):
        a.publish_number("Ping", number)
        assert b.take_numbers(1) == [number]
    assert central.stderr == []


@pytest.mark.new_central("it ends")
def test_104_a_hang_up_has_the_files_opened_anew(start_central, connect, log):
    central = start_central("-lx", "-LmiN", "-fa.log", "--json-file=a.json",
                            cwd=log.path.parent)
    log.until("Expecting")
    os.rename(log.path, log.path.with_name("old.log"))
    central.signal(signal.SIGHUP)
    log.until("^Logging Task Control Server .* on ")
    traffic(central, connect)
    log.until("Done +Ping")
    assert "Ping" not in log.path.with_name("old.log").read_text()


# ------------------------------------------------------------------- what is new


@pytest.mark.new_central("it has one file")
def test_a_file_of_some_size_is_followed_by_another(start_central, connect, log):
    central = start_central("-lx", "-LmiN", "-fa.log", "--log-size=2000", "--log-keep=2",
                            cwd=log.path.parent)
    a, b = traffic(central, connect)
    for number in range(200):
        a.publish_number("Ping", number)
        assert b.take_numbers(1) == [number]
    b.sync()
    end(central)
    assert sorted(os.listdir(log.path.parent)) == ["a.log", "a.log.1", "a.log.2"]
    for name in ("a.log.1", "a.log.2"):
        text = Log(log.path.parent, name).text()
        assert text.startswith("Logging Task Control Server ") and text.endswith("\n")
        assert len(text) >= 2000  # what comes while the disk is busy is written as one


@pytest.mark.new_central("it writes no JSON")
def test_json_has_the_same_content(start_central, connect, log):
    central = start_central("-lmsd", "--json-log=msd", "--json-file=a.json",
                            cwd=log.path.parent)
    a, _ = traffic(central, connect)
    a.close()
    central.wait_for_line("close Module: Closing A")
    end(central)
    records = [json.loads(line) for line in Log(log.path.parent, "a.json").text().splitlines()]
    for record in records:
        assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{9}Z", record.pop("time"))
    ping = [record for record in records if record.get("message") == "Ping"]
    number, reference = ping[0]["number"], ping[0]["reference"]
    assert ping == [
        {"step": "sent", "class": "Broadcast", "message": "Ping", "number": number,
         "reference": reference, "parent": -1, "from": "A", "to": "B", "bytes": 12, "data": "7"},
        {"step": "done", "class": "Broadcast", "message": "Ping", "number": number,
         "reference": reference, "parent": -1}]
    texts = [record["text"] for record in records if "text" in record]
    # Both logs have the same lines: each record is one of the terminal's, in the same order.
    terminal = "\n".join(central.stdout)
    place = terminal.index("Expecting")
    for text in texts:
        found = terminal.find(text.split("\n")[0], place)
        assert found >= 0, text
        place = found
    steps = sum(1 for line in central.stdout
                if re.match(r"(Query|Inform|Broadcast|  Done|  Reply)", line))
    assert steps - sum(1 for line in _before_banner(central.stdout)) == \
        sum("step" in record for record in records)


def _before_banner(lines):
    """What was logged before there were files."""
    banner = next(n for n, line in enumerate(lines) if line.startswith("Logging to "))
    return [line for line in lines[:banner]
            if re.match(r"(Query|Inform|Broadcast|  Done|  Reply)", line)]


@pytest.mark.new_central("it writes no JSON")
def test_json_holds_any_bytes(start_central, stack, log):
    names = ["back\\slash \"quote\"", "\xff\xc3 latin", "line\nfeed", "\xc3\xa4 utf-8"]
    central = start_central("--json-file=a.json", cwd=log.path.parent)
    for name in names:
        stack.enter_context(Peer(central, name)).connect()
    end(central)
    text = Log(log.path.parent, "a.json").path.read_bytes().decode("utf-8")
    texts = [json.loads(line)["text"] for line in text.splitlines()]
    for name in (*names[:3], "ä utf-8"):
        assert any(f"modName : {name}\n" in text for text in texts), name


@pytest.mark.new_central("it stops")
def test_a_log_file_that_takes_nothing_costs_nobody_anything(start_central, connect, log):
    """A pipe that is full stands for a disk that takes its time."""
    os.mkfifo(log.path)
    reading = os.open(log.path, os.O_RDONLY | os.O_NONBLOCK)
    central = start_central("-lx", "-LmiN", "-fa.log", cwd=log.path.parent)
    a, b = traffic(central, connect)
    count = 3000
    for number in range(count):
        a.publish_number("Ping", number)
        assert b.take_numbers(1) == [number]
    b.sync()
    taken = bytearray()

    def has_all():
        if select.select([reading], [], [], 0.05)[0]:
            taken.extend(os.read(reading, 1 << 20))
        return taken.count(b"  Done               Ping:\n") == count + 1
    wait_until(has_all, "all lines have come")
    end(central)
    os.close(reading)


@pytest.mark.new_central("it stops")
def test_a_log_file_that_takes_nothing_does_not_delay_the_end(start_central, connect, log):
    os.mkfifo(log.path)
    reading = os.open(log.path, os.O_RDONLY | os.O_NONBLOCK)
    central = start_central("-lx", "-LmiN", "-fa.log", cwd=log.path.parent)
    a, b = traffic(central, connect)
    for number in range(2000):
        a.publish_number("Ping", number)
        assert b.take_numbers(1) == [number]
    central.signal(signal.SIGTERM)
    assert central.wait() == 0
    central.stop_quietly()
    os.close(reading)


@pytest.mark.new_central("it waits for a reader")
def test_a_log_file_may_be_a_pipe(start_central, connect, log):
    os.mkfifo(log.path)
    central = start_central("-LmiN", "-fb.log", cwd=log.path.parent)
    end(central)
    done = subprocess.run([central.arguments[0], "-p0", "-u", "-LmN", f"-f{log.path}"],
                          capture_output=True, timeout=60, check=False)
    assert done.returncode == 1  # nobody reads: it says so instead of waiting
    assert b"Can not open file" in done.stderr


# ------------------------------------------------------------------ the grammar

NAME, TIME = r".*", r"(?:  \d| \d\d):\d\d:\d\d\.\d\d"
REF = r"(?: \{\d+\})?"
PAR = r"(?: \{-?\d+\})?"
CLASS = r"(?:Query|Inform|Broadcast) +"
LINES = [
    rf"{CLASS}{NAME}{REF}: +{NAME}{PAR} --> {NAME} +\(Sent\)(?:{TIME})?",
    rf"{CLASS}{NAME}{REF}: +{NAME}{PAR} --> (?:Resource )?{NAME} +\(Pending\)(?:{TIME})?",
    rf"  Done   {NAME}{REF}:(?:{TIME})?",
    rf"  Reply  {NAME}{REF}: +{NAME} --> {NAME} *{PAR}(?:{TIME})?",
    r"    .*", r"     .*",
    r" Received a new connection: \d+", r"   modName : .*", r"   hostName: .*",
    r"Closed Connection Detected from: sd: \d+: ", r" Closing .* on .*",
    r"x_ipcClose: Closed Connection Detected from: sd: \d+:", r"x_ipcClose: Closing .* on .*",
    r"close Module: Closing .*", rf"Clearing handler for message .*{REF}",
    r"Registration: Message .* Found\. Updating\.",
    rf"PENDING LIMIT: Deleted message .*{REF}(?:{TIME})?", r"WARNING: .*",
    rf"   Transferring .*{REF} from Resource .* to .*",
    r" *\d+: Msg: -?\d+\.\d\d%, Mon: \d+\.\d\d%, Wait -?\d+\.\d\d%, "
    r"Msg: \(\d+, \d+\) Ave: \(\d+, \d+\)",
    r"Direct Connection .*", r"Expecting \d+ on port \d+", r"Central Abort : Signal \d+",
    r"Logging Task Control Server \d+\.\d+\.\d+ \(.*\) on .*", r"",
]


@pytest.mark.new_central("its lines may lack ends")
def test_60_every_line_is_known_to_log_viewers(start_central, connect, log):
    """The grammar of log files; lines stand alone."""
    central = start_central("-lx", "-Lmstdhrpn", "-fa.log", cwd=log.path.parent)
    a, b = traffic(central, connect)
    a.query_number("Ping", 5)
    b.respond_number(b.next_delivery(), "Ping", 6)
    b.set_limit("Ping", 1)
    b.set_capacity(2)
    b.sync()
    for number in range(6):
        a.publish_number("Ping", number)
    a.sync()
    b.close()
    log.until("close Module: Closing B")
    a.say_goodbye()
    log.until("close Module: Closing A")
    end(central)
    for line in log.lines():
        assert any(re.fullmatch(pattern, line) for pattern in LINES), line


# ------------------------------------------------------- with a library that is sent ahead


@pytest.mark.new_library("it is not sent ahead")
@pytest.mark.new_central("it sends nothing ahead")
def test_data_wanted_too_late_are_not_shown(start_central, start_driver, connect):
    """What the receiver has already is not in the server any more when its turn has come."""
    central = start_central("-lx", console=True)
    receiver = start_driver("RECEIVER").connect(central.address)
    receiver.must("subscribe", "Ping", 0, "sequence")
    a = connect(central, "A")
    a.define("Ping")
    a.sync()
    for number in range(1, 9):
        a.publish_number("Ping", number)
    a.sync()
    central.write_line("-lmd")
    central.wait_for_line("Task Control Server", start=2)
    receiver.until(8)
    a.publish_number("Ping", 9)
    receiver.until(9)
    a.sync()
    central.wait_for_line("^    9$")
    assert sum("Ping: Resource RECEIVER --> RECEIVER" in line for line in central.stdout) == 7
