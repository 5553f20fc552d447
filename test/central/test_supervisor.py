"""Central under a supervisor: sockets handed over, readiness, signs of life (systemd's protocols)."""
import os
import socket
import struct
import subprocess

import pytest

from support.peer import Peer
from support.processes import Central, Process
from support.supervisor import HAND_OVER, Supervisor

pytestmark = pytest.mark.new_central("it knows no supervisors")


@pytest.fixture
def supervisor(stack, tmp_path):
    return stack.enter_context(Supervisor(str(tmp_path)))


@pytest.fixture
def start(stack, supervisor, central_program):
    """Starts a central as the supervisor does; it is ended after the test."""
    def start_supervised(*options, **variables):
        return stack.enter_context(Central(
            HAND_OVER, *options, **supervisor.popen(central_program, **variables)))
    return start_supervised


@pytest.fixture
def fails(supervisor, central_program):
    """Starts a central that cannot start; returns its exit status and what it says."""
    def start_in_vain(*options):
        with Process([HAND_OVER, "-p0", "-u", *options],
                     **supervisor.popen(central_program)) as central:
            return central.wait(), "\n".join(central.stderr)
    return start_in_vain


# --------------------------------------------------------------------------- states


def test_readiness_is_told_when_modules_may_connect(supervisor, central_program, tmp_path):
    port_file = tmp_path / "port"
    with Process([HAND_OVER, "-p0", "-u", "-s", f"--port-file={port_file}"],
                 **supervisor.popen(central_program)) as central:
        ready = supervisor.next_notice()
        port = int(port_file.read_text())
        assert ready == ["READY=1", f"STATUS=Serving on port {port}"]
        central.port = port
        with Peer(central) as peer:
            peer.connect()


def test_the_end_is_told(supervisor, start):
    central = start()
    supervisor.wait_for("READY=1")
    central.stop()
    assert supervisor.next_notice()[0] == "STOPPING=1"


def test_a_server_that_cannot_start_is_never_ready(supervisor, fails, central):
    assert fails(f"-p{central.port}")[0] == 1
    supervisor.notices.setblocking(False)
    with pytest.raises(BlockingIOError):
        supervisor.notices.recv(100)


def test_states_are_told_to_abstract_names(supervisor, start, stack):
    notices = stack.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
    name = f"central-test-{os.getpid()}"
    notices.bind(f"\0{name}")
    supervisor.notices.close()
    supervisor.notices = notices
    start(NOTIFY_SOCKET=f"@{name}")
    supervisor.wait_for("READY=1")


@pytest.mark.parametrize("path", ["/none/there", "nonsense", "/" + 200 * "x", ""])
def test_a_supervisor_that_cannot_be_told_does_not_matter(start, connect, path):
    connect(start(NOTIFY_SOCKET=path)).sync()


@pytest.mark.parametrize("variables", [{}, {"WATCHDOG_PID": "self"}])
def test_signs_of_life_are_given_as_often_as_is_asked(supervisor, start, variables):
    start(WATCHDOG_USEC="20000", **variables)
    supervisor.wait_for("READY=1")
    for _ in range(5):
        assert supervisor.next_notice() == ["WATCHDOG=1"]


@pytest.mark.parametrize("variables", [
    {"WATCHDOG_USEC": "2000", "WATCHDOG_PID": "1"},
    {"WATCHDOG_USEC": "many"},
    {"WATCHDOG_USEC": "-1"},
    {},
])
def test_no_signs_of_life_where_nobody_asked(supervisor, start, connect, variables):
    central = start(**variables)
    for number in range(10):
        connect(central, f"M{number}").sync()
    central.stop()
    supervisor.wait_for("READY=1")
    assert supervisor.wait_for("STOPPING=1") == []


# -------------------------------------------------------------------------- sockets


def open_files(process):
    """What the descriptors of a process lead to."""
    directory = f"/proc/{process.pid}/fd"
    return {os.readlink(os.path.join(directory, fd)) for fd in os.listdir(directory)}


def listening_on_tcp():
    """The sockets that listen, named as open_files names them."""
    with open("/proc/net/tcp", encoding="ascii") as table:
        rows = [line.split() for line in table]
    return {f"socket:[{row[9]}]" for row in rows if row[3] == "0A"}


def test_sockets_that_were_handed_over_are_served_and_left_alone(
        supervisor, start, connect, tmp_path):
    path = str(tmp_path / "1500")
    tcp = supervisor.listen()
    supervisor.listen(path=path)
    for _ in range(2):  # a server that is started again takes over again
        central = start()
        assert central.port == tcp.getsockname()[1]
        assert not os.path.lexists(central.unix_path)
        central.unix_path = path
        connect(central, "TCP").sync()
        connect(central, "LOCAL", unix=True).sync()
        central.stop()
        assert os.path.lexists(path)


def test_who_connects_while_no_server_runs_is_served_later(supervisor, start, stack):
    class Early:
        port = supervisor.listen().getsockname()[1]
    peer = stack.enter_context(Peer(Early))
    start()
    peer.connect()
    peer.sync()


def test_a_unix_socket_alone_leaves_no_tcp(supervisor, start, connect, tmp_path):
    path = str(tmp_path / "1500")
    supervisor.listen(path=path)
    central = start()
    assert central.port == 1500  # what modules say to mean this path
    central.unix_path = path
    connect(central, unix=True).sync()
    assert not listening_on_tcp() & open_files(central)


def test_sockets_for_another_process_are_not_taken(supervisor, start, connect):
    supervisor.listen()
    central = start(LISTEN_PID="1")
    connect(central, "TCP").sync()
    connect(central, "LOCAL", unix=True).sync()


def test_who_asks_for_the_owner_of_the_socket_finds_central(supervisor, start, tmp_path, stack):
    """killCentral asks so; the supervisor, which has opened the socket, must not be ended."""
    path = str(tmp_path / "1500")
    supervisor.listen(path=path)
    central = start()
    peer = stack.enter_context(socket.socket(socket.AF_UNIX))
    peer.connect(path)
    peercred = peer.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
    assert struct.unpack("iII", peercred)[0] == central.pid


def test_what_does_not_listen_is_an_error(supervisor, fails, stack):
    supervisor.hand_over(stack.enter_context(socket.socket()))
    status, said = fails()
    assert status == 1
    assert "ERROR: Can not use descriptor 3 of the supervisor: it does not listen" in said


def test_two_sockets_of_one_kind_are_an_error(supervisor, fails):
    supervisor.listen()
    supervisor.listen()
    status, said = fails()
    assert status == 1
    assert "descriptor 4 of the supervisor: there is one of its kind already" in said


def test_tcp_is_an_error_where_users_decide(supervisor, fails):
    supervisor.listen()
    status, said = fails("--access=owner")
    assert status == 1
    assert "descriptor 3 of the supervisor: it is not local" in said


def test_the_socket_of_the_numbers_can_be_handed_over(supervisor, start, connect):
    numbers = supervisor.listen("metrics")
    tcp = supervisor.listen()
    central = start()
    assert central.port == tcp.getsockname()[1]
    connect(central).sync()
    with socket.create_connection(numbers.getsockname()) as caller:
        caller.sendall(b"GET /metrics HTTP/1.0\r\n\r\n")
        answer = caller.makefile().read()
    assert "\nipc_central_modules 1\n" in answer


# ----------------------------------------------------------------------------- units


@pytest.mark.parametrize("unit", ["central.service", "central.socket"])
def test_units_are_understood_by_systemd(pytestconfig, unit):
    path = os.path.join(os.path.dirname(pytestconfig.ipc_central), "systemd", unit)
    if not os.path.exists(path):
        pytest.skip("no units in this build")
    try:
        done = subprocess.run(["systemd-analyze", "verify", "--man=no", path], capture_output=True, text=True,
                              timeout=60, check=False)
    except FileNotFoundError:
        pytest.skip("no systemd-analyze on this machine")
    # The program is not where it will be installed.
    assert not [line for line in done.stderr.splitlines()
                if "central." in line and "is not executable" not in line]
