"""The command line: every option, what is printed at the start, and what is refused."""
import os
import re
import resource
import signal
import socket
import stat
import subprocess

import pytest

from support.peer import Closed, Peer
from support.processes import Process, free_port
from support.waiting import PATIENCE, TimedOut, wait_until

BANNER = r"Task Control Server \d+\.\d+\.\d+ \(\w{3}-\d\d-\d\d\)"


class At:
    """Where a server should be."""

    def __init__(self, port):
        self.port, self.unix_path = port, f"/tmp/x_ipc/{port}"

    def serves(self, *, unix=False):
        """Waits until a module can connect."""
        def connect():
            try:
                with Peer(self, unix=unix) as peer:
                    peer.connect()
                return True
            except (OSError, Closed, TimedOut):
                return False
        return wait_until(connect, f"port {self.port} serves")


@pytest.fixture
def start(stack, central_program):
    """Starts a central with exactly these options; returns it and where it should be."""
    def start_it(*options, port=None, **popen):
        port = port or free_port()
        popen.setdefault("stdin", subprocess.PIPE)
        options = [option.replace("PORT", str(port)) for option in options]
        process = stack.enter_context(Process([central_program, *options], **popen))
        return process, At(port)
    return start_it


def stop(process, number=signal.SIGTERM):
    process.signal(number)
    return process.wait()


def prompted(process):
    """The output of an unfinished line: the prompt has no end."""
    process.close_stdin()
    stop(process)
    return "\n".join(process.stdout)


def test_1_a_plain_start(start):
    process, at = start("-pPORT")
    at.serves()
    at.serves(unix=True)
    assert process.stderr == []
    text = prompted(process)
    assert re.match(BANNER + rf"\nExpecting 1 on port {at.port}\n> ", text)


def test_2_without_the_user_interface(start):
    process, at = start("-pPORT", "-u")
    process.wait_for_line(rf"^Expecting 1 on port {at.port}$")
    process.write_line("quit")
    process.write_line("status")
    at.serves()
    text = prompted(process)
    assert ">" not in text and "Resource" not in text


@pytest.mark.new_central("it says goodbye even when silent")
def test_3_silence(start):
    process, at = start("-pPORT", "-s")
    at.serves()
    assert stop(process) == 0
    assert process.output() == ""


@pytest.mark.new_central("its answer stays in a buffer")
def test_4_letters_are_not_combined_su_is_s(start):
    process, at = start("-pPORT", "-su")
    at.serves()
    process.write_line("memory")
    process.wait_for_line("^Cumulative Memory Usage:$")
    assert process.stdout[0] == "Cumulative Memory Usage:"


def test_5_letters_are_not_combined_us_is_u(start):
    process, at = start("-pPORT", "-us")
    process.wait_for_line(BANNER)
    process.write_line("memory")
    at.serves()
    assert "Cumulative" not in process.output()


def test_6_an_unknown_letter_is_said_and_ignored(start):
    process, at = start("-pPORT", "-z", "-u")
    at.serves()
    process.wait_for_line("^Ignoring unknown option '-z'$", stream="stderr")


@pytest.mark.parametrize("argument, expected", [("3", 3), ("3x", 3), ("0", 1), ("foo", 1)])
def test_7_the_first_number_is_that_of_modules(start, argument, expected):
    process, at = start("-pPORT", "-u", argument)
    process.wait_for_line(rf"^Expecting {expected} on port {at.port}$")


def default_port_is_free():
    """Whether a server could have it now."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", 1381))
        except OSError:
            return False
    return True


@pytest.mark.parametrize("options, expected", [(("-u", "-p", "7"), 7), (("-pabc", "-u"), 1)])
def test_8_9_a_letter_has_its_value_behind_it_or_none(start, options, expected):
    """If another program holds the default port, the server says so."""
    free = default_port_is_free()
    process, _ = start(*options)
    if free:
        process.wait_for_line(rf"^Expecting {expected} on port 1381$")
    else:
        process.wait_for_line("Unable to start server")


def test_9_digits_in_front_are_the_port(start):
    process, at = start("-pPORTxyz", "-u")
    process.wait_for_line(rf"^Expecting 1 on port {at.port}$")


@pytest.mark.parametrize("option", ["-v", "-h"])
def test_10_texts_need_no_server(central_program, option, tmp_path, pytestconfig):
    """The texts themselves are compared with the samples."""
    done = subprocess.run([central_program, option, "-p0", f"-f{tmp_path}/log", "-L"],
                          capture_output=True, timeout=PATIENCE, stdin=subprocess.DEVNULL,
                          check=False)
    assert b"Expecting" not in done.stdout
    assert os.listdir(tmp_path) == []
    assert done.returncode == pytestconfig.ipc_central_is_original


def test_11_v_is_alone_or_unknown(start):
    process, at = start("-pPORT", "-u", "-v")
    at.serves()
    process.wait_for_line("^Ignoring unknown option '-v'$", stream="stderr")


def test_12_a_name_alone_makes_no_file(start, tmp_path):
    process, at = start("-pPORT", "-u", "-fx.log", cwd=tmp_path)
    at.serves()
    process.wait_for_line("^Expecting")
    assert process.stdout[0] == "Logging File Name: x.log"
    assert os.listdir(tmp_path) == []


def test_13_names_to_ignore_are_said(start, tmp_path):
    (tmp_path / "ign").write_text("Foo\nBar\n")
    process, at = start("-pPORT", "-u", "-Iign", cwd=tmp_path)
    at.serves()
    process.wait_for_line("Bar", stream="stderr")
    assert process.stderr == ["Ignore logging of Foo", "Ignore logging of Bar"]


def test_14_a_missing_file_of_names_is_said(start):
    process, at = start("-pPORT", "-u", "-I/none")
    at.serves()
    process.wait_for_line("Could not", stream="stderr")
    assert process.stderr == ["Could not open message ignore file /none"]


def test_15_a_second_server_on_a_port_fails(start):
    first, at = start("-pPORT", "-u")
    at.serves()
    second, _ = start("-pPORT", "-u", port=at.port)
    assert second.wait() == 1
    assert "ERROR: Unable to start server, Is one already running?" in second.output()
    at.serves()
    if not first.stdout[0].startswith("Task Control Server 3."):
        at.serves(unix=True)


def test_16_servers_on_two_ports_know_nothing_of_each_other(start, stack):
    servers = [start("-pPORT", "-u")[1] for _ in range(2)]
    modules = []
    for at in servers:
        at.serves()
        module = stack.enter_context(Peer(at)).connect()
        module.define("Same")
        module.subscribe("Same", 5)
        module.sync()
        modules.append(module)
    modules[0].publish_number("Same", 1)
    modules[1].publish_number("Same", 2)
    assert [module.take_numbers(1) for module in modules] == [[1], [2]]
    for module in modules:
        module.sync()
        assert not module.deliveries


@pytest.mark.new_central("it prints 0")
def test_17_port_0_is_a_free_one(start):
    process, _ = start("-p0", "-u")
    at = At(int(process.wait_for_line(r"Expecting 1 on port (\d+)").group(1)))
    at.serves(unix=True)
    stop(process)
    assert not os.path.exists(at.unix_path)


@pytest.mark.new_central("it takes the rest of a division")
@pytest.mark.parametrize("option", ["-p70000", "-p-1", "--port=70000"])
def test_18_impossible_ports_are_refused(start, option):
    process, _ = start(option, "-u")
    assert process.wait() == 2
    assert process.stderr == [f"Illegal port {option.replace('--port=', '-p')[2:]}"]
    assert process.stdout == []


def test_19_a_stale_socket_is_replaced(start):
    process, at = start("-pPORT", "-u")
    at.serves(unix=True)
    stop(process, signal.SIGKILL)
    assert os.path.exists(at.unix_path)
    start("-pPORT", "-u", port=at.port)
    at.serves(unix=True)


@pytest.mark.new_central("it ends")
def test_20_without_a_unix_socket_tcp_serves(start):
    port = free_port()
    at = At(port)
    os.makedirs(at.unix_path)
    try:
        process, _ = start("-pPORT", "-u", port=port)
        at.serves()
        process.wait_for_line("^Warning: no socket ", stream="stderr")
        stop(process)
    finally:
        os.rmdir(at.unix_path)


@pytest.mark.new_central("it leaves the mode to the mask of the process")
@pytest.mark.parametrize("mask", [0, 0o22, 0o77])
def test_21_everybody_may_use_the_socket(start, mask):
    """Design section 10: socket 0777, directory 01777."""
    before = os.umask(mask)
    try:
        _, at = start("-pPORT", "-u")
    finally:
        os.umask(before)
    at.serves(unix=True)
    assert stat.S_IMODE(os.stat(at.unix_path).st_mode) == 0o777
    assert stat.S_IMODE(os.stat("/tmp/x_ipc").st_mode) & 0o777 == 0o777


@pytest.mark.new_central("its sockets take their places")
def test_22_missing_streams_do_no_harm(central_program, stack):
    port = free_port()
    command = f"exec {central_program} -p{port} <&- >&- 2>&-"
    process = stack.enter_context(Process(["sh", "-c", command]))
    At(port).serves()
    assert stop(process) == 0


@pytest.mark.new_central("it leaves its socket")
def test_23_a_log_file_that_cannot_be_opened(start):
    process, at = start("-pPORT", "-u", "-LmN", "-f/none/x")
    assert process.wait() == 1
    assert "ERROR: Can not open file /none/x." in process.stderr
    assert not os.path.exists(at.unix_path)


# ------------------------------------------------------------------------- words


@pytest.mark.new_central("it has no words")
def test_words_do_what_letters_do(start, tmp_path):
    process, at = start("--port", "PORT", "--no-console", "--log=mt", "--file-log=sn",
                        "--log-file=words.log", "--ignore=Ping", "--resend", "--direct",
                        "--expected-modules=2", cwd=tmp_path)
    process.wait_for_line(rf"^Expecting 2 on port {at.port}$")
    assert process.stdout[0] == "Logging File Name: words.log"
    wait_until(lambda: "Expecting 2 on port" in (tmp_path / "words.log").read_text(), "the log")
    assert process.stderr == []


@pytest.mark.new_central("it has no words")
@pytest.mark.parametrize("options, line", [
    (["--prot=5"], "Unknown option --prot=5 (--help lists all)"),
    (["--silent=yes"], "The option --silent takes no value"),
    (["--log-file"], "The option --log-file needs a value"),
    (["--port=many"], "Illegal port many"),
    (["--expected-modules", "none"], "Illegal number of modules none"),
    (["--log-size=5"], "Illegal size of a log file 5"),
    (["--limit-strangers=some"], "Illegal number in --limit-strangers=some"),
    (["--limit-nothing=5"], "No such limit --limit-nothing=5 (--help lists them)"),
])
def test_a_wrong_word_is_one_line_and_the_end(start, options, line):
    process, _ = start("-s", *options)
    assert process.wait() == 2
    assert process.stderr == [line]
    assert process.stdout == []


@pytest.mark.new_central("it has no words")
def test_help_and_version_go_to_standard_output(central_program):
    for option, begins in (("--help", f"{central_program} command line options:\n"),
                           ("--version", "Task Control Server ")):
        done = subprocess.run([central_program, "-p5", option], capture_output=True, text=True,
                              timeout=PATIENCE, stdin=subprocess.DEVNULL, check=True)
        assert done.stdout.startswith(begins)
        assert done.stderr == ""


@pytest.mark.new_central("its limit is 1024")
def test_the_limit_of_descriptors_is_raised(start):
    """As far as the system allows."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    process, at = start("-pPORT", "-u")
    at.serves()
    with open(f"/proc/{process.pid}/limits", encoding="ascii") as file:
        found = re.search(r"Max open files +(\S+) +(\S+)", file.read())
    assert found.group(1) == found.group(2)
    assert soft <= hard
