"""Who may connect: hosts.allow and hosts.deny over TCP, users on the Unix socket (section 5)."""
import os
import signal
import socket
import struct
import subprocess
import urllib.request

import pytest

from support import processes
from support.peer import Peer, expect_nothing
from support.processes import Process
from support.waiting import PATIENCE

pytestmark = pytest.mark.new_central("the common builds of the original have no access control")

REFUSED = r"^WARNING: connection rejected from (.+)$"
EVERYBODY = "ALL : ALL"


class Rules:
    """The two files of a test."""

    def __init__(self, directory):
        self.allow, self.deny = str(directory / "hosts.allow"), str(directory / "hosts.deny")
        self.write()

    def write(self, allow="", deny=""):
        for path, text in ((self.allow, allow), (self.deny, deny)):
            with open(path, "w", encoding="utf-8") as file:
                file.write(text + "\n")

    def options(self):
        return [f"--hosts-allow={self.allow}", f"--hosts-deny={self.deny}"]


@pytest.fixture(name="rules")
def _rules(tmp_path, central_program):
    with open(central_program, "rb") as program:
        if b"libwrap.so" not in program.read():
            pytest.skip("central is built without libwrap")
    return Rules(tmp_path)


@pytest.fixture
def guarded(start_central, rules):
    """A central that goes by the test's rules."""
    return start_central(*rules.options())


def is_refused(central, stack):
    """Whether a TCP connection is closed without a byte."""
    peer = stack.enter_context(Peer(central))
    closed = peer.is_closed()
    assert not closed or peer.cutter.take(1) is None
    return closed


# ----------------------------------------------------------------------- the rules


@pytest.mark.parametrize("allow, deny, refused", [
    ("", EVERYBODY, True),
    ("central : localhost", EVERYBODY, False),
    ("central : 127.0.0.1", EVERYBODY, False),
    ("sshd : ALL", EVERYBODY, True),
    ("", "foo : ALL", False),
    ("central localhost", EVERYBODY, True),
    ("central : 127.", EVERYBODY, False),
    ("central : 127.0.0.0/255.0.0.0", EVERYBODY, False),
    ("central : ALL EXCEPT 127.0.0.1", EVERYBODY, True),
    ("central@127.0.0.1 : ALL", EVERYBODY, False),
    ("", "central : localhost", True),
    ("central : ALL : deny", "", True),
    ("", "", False),
])
def test_rules_decide_about_tcp_and_not_about_the_unix_socket(  # check 91
        rules, start_central, connect, stack, allow, deny, refused):
    rules.write(allow, deny)
    central = start_central(*rules.options())
    if refused:
        assert is_refused(central, stack)
        assert central.wait_for_line(REFUSED).group(1) in ("127.0.0.1", "localhost")
    else:
        connect(central).sync()
    connect(central, "LOCAL", unix=True).sync()


def test_rules_act_on_the_next_connection(guarded, rules, connect, stack):  # check 91
    first = connect(guarded, "FIRST")
    rules.write(deny="central : 127.0.0.1")
    assert is_refused(guarded, stack)
    first.sync()
    rules.write()
    connect(guarded, "SECOND").sync()


def test_a_refusal_is_one_line_and_no_module_that_has_gone(guarded, rules, connect, stack):
    watcher = connect(guarded, "WATCHER")
    watcher.subscribe("x_ipc_disconnectNotify", 1, "x_ipc_disconnectNotify")
    watcher.sync()
    rules.write(deny=EVERYBODY)
    assert is_refused(guarded, stack)
    expect_nothing(watcher)
    guarded.wait_for_line(REFUSED)
    about_watcher = ["Received a new connection", "modName : WATCHER", "hostName: robot"]
    lines = guarded.stdout[2:]
    assert all(part in line for part, line in zip(about_watcher, lines))
    assert lines[3:] == ["WARNING: connection rejected from 127.0.0.1"]


def test_who_leaves_at_once_does_not_slip_in(guarded, rules, connect, stack):
    """A connection that was reset has no address any more, but what it has sent can be read."""
    watcher = connect(guarded, "WATCHER", unix=True)
    rules.write(deny="central : 127.0.0.1")
    guarded.signal(signal.SIGSTOP)
    peer = stack.enter_context(Peer(guarded))
    peer.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    peer.send_bytes(bytes(100))
    peer.close()
    guarded.signal(signal.SIGCONT)
    assert guarded.wait_for_line(REFUSED).group(1) in ("unknown", "127.0.0.1")
    watcher.sync()
    assert "**NEWMOD**" not in guarded.output()


@pytest.mark.parametrize("option", ["spawn touch {0}", "twist touch {0}"])
def test_rules_run_no_commands(guarded, rules, connect, stack, tmp_path, option):
    rules.write(f"central : ALL : {option.format(tmp_path / 'made')}")
    if option.startswith("spawn"):
        connect(guarded).sync()
    else:
        assert is_refused(guarded, stack)  # the command was to stand in for central
    assert not (tmp_path / "made").exists()


def test_a_module_that_is_refused_is_told_so(guarded, rules, start_driver):
    rules.write(deny=EVERYBODY)
    driver = start_driver()
    driver.must("verbosity", 1)
    answer = driver.do("connect", driver.name, guarded.address, seconds=6 * PATIENCE)
    assert answer.result.startswith("Error")
    assert driver.do("is_connected").result == "0"
    guarded.wait_for_line(REFUSED)


# ------------------------------------------------------------- names that take long


@pytest.fixture
def start_with_names(start_central, rules, tmp_path, compiler):
    """Starts a central for which every address has the name robot.example, once go() is called."""
    library = str(tmp_path / "slow_names.so")
    subprocess.run([compiler.command, "-shared", "-fPIC", "-o", library,
                    os.path.join(os.path.dirname(processes.__file__), "slow_names.c"), "-ldl"],
                   check=True, timeout=PATIENCE * 10)

    def start(address="127.0.0.1", patience=60):
        return start_central(*rules.options(), f"--limit-look-up-seconds={patience}", env={
            "LD_PRELOAD": library, "SLOW_NAMES_NAME": "robot.example",
            "SLOW_NAMES_ADDRESS": address, "SLOW_NAMES_GO": str(tmp_path / "go"),
            "ASAN_OPTIONS": "verify_asan_link_order=0"})
    return start


def has_heard_nothing(peer):
    """Whether a connection is open and without the greeting."""
    return not peer.is_closed(0.01) and peer.cutter.take(1) is None


@pytest.fixture
def go(tmp_path):
    return lambda: (tmp_path / "go").write_text("")


def test_a_look_up_holds_up_nobody_else(start_with_names, rules, connect, stack, go):
    central = start_with_names()
    first = connect(central, "FIRST")
    rules.write("central : robot.example", EVERYBODY)
    waiting = [stack.enter_context(Peer(central, f"WAITING{i}")) for i in range(20)]
    for peer in waiting:
        first.sync()
        assert has_heard_nothing(peer)
    go()
    for peer in waiting:
        peer.connect()
        peer.sync()


def test_a_look_up_that_takes_too_long_counts_as_unknown(start_with_names, rules, connect, stack):
    central = start_with_names(patience=0.1)
    rules.write("central : robot.example", EVERYBODY)
    assert is_refused(central, stack)
    central.wait_for_line(r"^WARNING: connection rejected from 127\.0\.0\.1$")
    rules.write("central : UNKNOWN", EVERYBODY)
    connect(central).sync()


def test_a_name_that_does_not_lead_back_is_none(start_with_names, rules, stack, go):
    central = start_with_names(address="127.0.0.9")
    rules.write("central : robot.example", EVERYBODY)
    go()
    assert stack.enter_context(Peer(central)).is_closed()
    central.wait_for_line(r"^WARNING: connection rejected from 127\.0\.0\.1$")


def test_central_ends_while_names_are_looked_up(start_with_names, rules, stack):
    central = start_with_names()
    rules.write("central : robot.example", EVERYBODY)
    peer = stack.enter_context(Peer(central))
    assert has_heard_nothing(peer)
    central.stop()
    assert peer.is_closed()


# --------------------------------------------------------------------------- users


#: Connects to the Unix socket as another user; prints the number of bytes of the greeting.
AS_ANOTHER = """
import os, socket, sys
path, user, group, others = sys.argv[1], *map(int, sys.argv[2:4]), sys.argv[4:]
os.setgroups([int(other) for other in others])
os.setgid(group)
os.setuid(user)
peer = socket.socket(socket.AF_UNIX)
peer.connect(path)
try:
    print(len(peer.recv(1000)))
except ConnectionError:
    print(0)
"""

NOBODY, NO_GROUP, OTHER_GROUP = 65534, 65534, 12345


@pytest.fixture
def bytes_for(stack):
    """How many bytes greet another user."""
    if os.geteuid() != 0:
        pytest.skip("only root can become another user")

    def connect(central, user, group, *others):
        done = subprocess.run(
            ["python3", "-c", AS_ANOTHER, central.unix_path, *map(str, (user, group, *others))],
            capture_output=True, text=True, timeout=PATIENCE * 2, check=True)
        return int(done.stdout)
    return connect


def test_without_an_option_all_users_may_connect(central, bytes_for):
    assert bytes_for(central, NOBODY, NO_GROUP) > 0


def test_only_the_owner_may_connect(start_central, connect, bytes_for):
    central = start_central("--access=owner")
    connect(central, unix=True).sync()
    assert bytes_for(central, NOBODY, NO_GROUP) == 0
    central.wait_for_line(rf"^WARNING: connection rejected from user {NOBODY}$")


def test_only_a_group_may_connect(start_central, connect, bytes_for):
    central = start_central(f"--access=group={OTHER_GROUP}")
    connect(central, unix=True).sync()  # the owner, always
    assert bytes_for(central, NOBODY, NO_GROUP) == 0
    assert bytes_for(central, NOBODY, OTHER_GROUP) > 0
    assert bytes_for(central, NOBODY, NO_GROUP, 77, OTHER_GROUP) > 0


def test_where_users_decide_there_is_no_way_around_them(start_central):
    central = start_central("--access=owner")
    assert not has_tcp(central)


def has_tcp(central):
    try:
        Peer(central).close()
    except ConnectionRefusedError:
        return False
    return True


@pytest.mark.parametrize("options, said", [
    (["--access=nobody"], "nobody"),
    (["--access=group=no such group"], "no such group"),
    (["--access=owner", "--bind=127.0.0.1"], "--bind"),
])
def test_what_cannot_be_is_a_wrong_command_line(central_program, options, said):
    with Process([central_program, "-p0", "-u", *options]) as central:
        assert central.wait() == 2
        assert said in "\n".join(central.stderr)


def test_refusals_are_counted(start_central, bytes_for):
    central = start_central("--access=owner", "--metrics=0")
    address = central.wait_for_line(r"^Numbers at (\S+)$").group(1)
    assert bytes_for(central, NOBODY, NO_GROUP) == 0
    with urllib.request.urlopen(address, timeout=PATIENCE) as answer:
        assert 'ipc_central_refused_total{reason="access"} 1\n' in answer.read().decode()
