"""The sockets that central listens on, and the files that tell where it is (sections 1.4 to 1.8)."""
import os
import resource
import signal
import socket
import stat
import subprocess
import sys

import pytest

from support.peer import Peer
from support.processes import Central, Process, free_port
from support.waiting import wait_until

pytestmark = pytest.mark.new_central("most of this is new, or was a defect")

HOST = os.uname().nodename


def reaches(address, port, family=socket.AF_INET):
    """Whether somebody listens there."""
    with socket.socket(family) as probe:
        return probe.connect_ex((address, port)) == 0


@pytest.fixture
def fails(central_program):
    """Starts a central that cannot start; returns its exit status and what it says."""
    def start(*options):
        with Process([central_program, "-u", *options]) as central:
            return central.wait(), "\n".join(central.stderr)
    return start


# ----------------------------------------------------------------- ports and paths


def test_both_sockets_are_served(central, connect):  # check 1
    connect(central, "TCP").sync()
    connect(central, "LOCAL", unix=True).sync()


def test_a_second_server_on_a_port_leaves_the_first_alone(central, connect, fails):  # check 15
    status, said = fails(f"-p{central.port}")
    assert status == 1
    assert "ERROR: Unable to start server, Is one already running?" in said
    connect(central, "TCP").sync()
    connect(central, "LOCAL", unix=True).sync()


def test_two_servers_do_not_mix(start_central, connect):  # check 16
    peers = []
    for number, central in enumerate((start_central(), start_central())):
        peer = connect(central, f"M{number}")
        peer.subscribe("same", 1)
        peer.define("same")
        peer.sync()
        peers.append(peer)
    for number, peer in enumerate(peers):
        peer.publish_number("same", number)
    for number, peer in enumerate(peers):
        assert peer.take_numbers(1) == [number]
        peer.sync()
        assert not peer.deliveries


def test_port_0_is_any_and_its_socket_goes_at_the_end(start_central, connect):  # check 17
    central = start_central("-p0")
    assert central.port > 0
    assert stat.S_ISSOCK(os.lstat(f"/tmp/x_ipc/{central.port}").st_mode)
    connect(central, unix=True).sync()
    central.stop()
    assert not os.path.lexists(f"/tmp/x_ipc/{central.port}")


@pytest.mark.parametrize("port", ["70000", "65536", "-1"])
def test_impossible_ports_are_refused(fails, port):  # check 18
    status, said = fails(f"-p{port}")
    assert status == 2
    assert f"Illegal port {port}" in said


def test_the_socket_of_a_killed_server_is_replaced(start_central, connect):  # check 19
    first = start_central(f"-p{free_port()}")
    first.signal(signal.SIGKILL)
    assert first.wait_for_end() == -signal.SIGKILL
    assert os.path.lexists(first.unix_path)
    second = start_central(f"-p{first.port}")
    connect(second, unix=True).sync()


@pytest.fixture
def occupied():
    """A port whose path is taken by something else."""
    port = free_port()
    path = f"/tmp/x_ipc/{port}"
    os.makedirs("/tmp/x_ipc", exist_ok=True)
    yield port, path
    if os.path.isdir(path):
        os.rmdir(path)
    else:
        os.unlink(path)


def make_file(path):
    with open(path, "w", encoding="utf-8") as file:
        file.write("precious")


@pytest.mark.parametrize("make", [os.mkdir, make_file])
def test_what_is_no_socket_stays_and_modules_use_tcp(occupied, make, start_central, connect):
    port, path = occupied  # check 20
    make(path)
    central = start_central(f"-p{port}")
    assert central.wait_for_line(f"Warning: no socket {path}", stream="stderr")
    connect(central).sync()
    central.stop()
    assert os.path.exists(path)


def test_a_socket_that_took_the_place_of_ours_stays(central):
    os.unlink(central.unix_path)
    with socket.socket(socket.AF_UNIX) as other:
        other.bind(central.unix_path)
        central.stop()
        assert os.path.lexists(central.unix_path)
        os.unlink(central.unix_path)


@pytest.mark.parametrize("mask", [0, 0o022, 0o077])
def test_everybody_may_connect_whatever_the_mask(start_central, mask):  # check 21
    central = start_central(umask=mask)
    assert stat.S_IMODE(os.lstat(central.unix_path).st_mode) == 0o777
    assert stat.S_IMODE(os.lstat("/tmp/x_ipc").st_mode) & 0o777 == 0o777


def test_missing_standard_streams_do_not_matter(central_program, tmp_path, connect):  # check 22
    port_file = tmp_path / "port"
    with Process(["sh", "-c", 'exec "$@" <&- >&- 2>&-', "-", central_program, "-p0",
                  f"--port-file={port_file}"]) as process:
        wait_until(port_file.exists, "it has a port")
        process.port = int(port_file.read_text())
        connect(process).sync()


def test_a_log_that_cannot_be_opened_leaves_no_socket(fails):  # check 23
    port = free_port()
    status, said = fails(f"-p{port}", "-LmN", "-f/none/x")
    assert status == 1
    assert "ERROR: Can not open file /none/x." in said
    assert not os.path.lexists(f"/tmp/x_ipc/{port}")


# ------------------------------------------------------------------------ addresses


def test_by_default_all_addresses_are_bound(central):
    assert reaches("127.0.0.1", central.port) and reaches("127.0.0.2", central.port)


@pytest.mark.parametrize("address", ["127.0.0.1", "localhost"])
def test_one_address_can_be_bound(start_central, connect, address):
    central = start_central(f"--bind={address}")
    connect(central, "TCP").sync()
    connect(central, "LOCAL", unix=True).sync()
    assert not reaches("127.0.0.2", central.port)


@pytest.fixture
def ipv6():
    try:
        socket.create_server(("::1", 0), family=socket.AF_INET6).close()
    except OSError:
        pytest.skip("no IPv6 on this machine")


@pytest.mark.usefixtures("ipv6")
def test_ipv6_addresses_can_be_bound(start_central, start_driver):
    central = start_central("--bind=::1")
    assert reaches("::1", central.port, socket.AF_INET6)
    assert not reaches("127.0.0.1", central.port)
    driver = start_driver().connect(f"[::1]:{central.port}")
    assert driver.do("is_connected").result == "1"


@pytest.mark.usefixtures("ipv6")
def test_both_families_at_once(start_central, connect):
    central = start_central("--bind=::")
    connect(central).sync()
    assert reaches("::1", central.port, socket.AF_INET6)


@pytest.mark.parametrize("address", ["203.0.113.1", "x" * 300])
def test_addresses_that_are_not_ours_are_an_error(fails, address):
    status, said = fails("-p0", f"--bind={address}")
    assert status == 1
    assert "unable to bind TCP/IP socket for listening" in said


@pytest.mark.parametrize("option", ["--bind=local", "--access=owner"])
def test_local_sockets_only(start_central, connect, start_driver, option):
    central = start_central(option)
    assert central.port > 0 and not reaches("127.0.0.1", central.port)
    connect(central, unix=True).sync()
    driver = start_driver().connect(f"{HOST}:{central.port}")
    assert driver.do("is_connected").result == "1"


def test_without_any_socket_central_does_not_start(fails, occupied):
    port, path = occupied
    os.mkdir(path)
    status, said = fails(f"-p{port}", "--bind=local")
    assert status == 1
    assert "unable to open socket/pipe for listening" in said


# ---------------------------------------------------------------------------- files


def test_files_tell_process_and_port_while_central_runs(start_central, tmp_path):
    pid_file, port_file = tmp_path / "pid", tmp_path / "port"
    central = start_central(f"--pid-file={pid_file}", f"--port-file={port_file}")
    assert pid_file.read_text() == f"{central.pid}\n"
    assert port_file.read_text() == f"{central.port}\n"
    assert sorted(os.listdir(tmp_path)) == ["pid", "port"]
    central.stop()
    assert not os.listdir(tmp_path)


def test_files_of_a_killed_server_are_replaced(start_central, tmp_path):
    option = f"--pid-file={tmp_path / 'pid'}"
    first = start_central(option)
    first.signal(signal.SIGKILL)
    first.wait_for_end()
    assert (tmp_path / "pid").read_text() == f"{first.pid}\n"
    second = start_central(option)
    assert (tmp_path / "pid").read_text() == f"{second.pid}\n"


def test_the_file_of_a_successor_stays(start_central, tmp_path):
    option = f"--pid-file={tmp_path / 'pid'}"
    first, second = start_central(option), start_central(option)
    first.stop()
    assert (tmp_path / "pid").read_text() == f"{second.pid}\n"


@pytest.mark.parametrize("option", ["--pid-file", "--port-file"])
def test_a_file_that_cannot_be_written_is_an_error(fails, option, tmp_path):
    status, said = fails("-p0", f"{option}={tmp_path / 'none' / 'x'}")
    assert status == 1
    assert f"ERROR: Can not write file {tmp_path / 'none' / 'x'} (No such file" in said
    assert not os.listdir(tmp_path)


def test_a_file_of_a_server_that_cannot_start_is_not_written(fails, central, tmp_path):
    assert fails(f"-p{central.port}", f"--pid-file={tmp_path / 'pid'}")[0] == 1
    assert not os.listdir(tmp_path)


# ---------------------------------------------------------------------- descriptors


def limited(soft, hard):
    """What a central has to be started with to have so many descriptors."""
    return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))}


def processor_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def test_the_soft_limit_of_descriptors_is_raised(start_central, connect, stack):
    central = start_central(**limited(20, 200))
    peers = [stack.enter_context(Peer(central, f"M{number}")).connect() for number in range(100)]
    for peer in peers:
        peer.sync()


class Crowd:
    """More connections than a central has descriptors for."""

    def __init__(self, central, stack, count):
        peers = [stack.enter_context(Peer(central, f"M{number}")) for number in range(count)]
        self.served, self.refused = [], []
        for peer in peers:
            (self.served if self.is_served(peer) else self.refused).append(peer)

    @staticmethod
    def is_served(peer):
        try:
            peer.connect()
        except AssertionError:
            assert peer.look_up_id is None and peer.is_closed()
            return False
        return True


def test_without_descriptors_newcomers_are_refused_and_nobody_else_notices(
        start_central, stack, connect):  # check 100
    central = start_central(**limited(40, 40))
    crowd = Crowd(central, stack, 60)
    assert len(crowd.served) >= 28
    assert len(crowd.served) + len(crowd.refused) == 60
    for peer in crowd.served:
        peer.sync()
    assert sum("no descriptors left" in line for line in central.stdout) == 1
    for peer in crowd.served[:10]:
        peer.close()
    crowd.served[10].sync()
    wait_until(lambda: central.output().count("close Module: Closing M") == 10, "they are gone")
    for number in range(10):
        connect(central, f"LATE{number}").sync()
    assert not Crowd.is_served(stack.enter_context(Peer(central)))


@pytest.mark.skipif(sys.platform != "linux", reason="processor time is read from /proc")
def test_without_descriptors_central_is_idle(start_central, stack):  # check 100
    central = start_central(**limited(30, 30))
    crowd = Crowd(central, stack, 40)
    assert crowd.refused
    before = processor_seconds(central.pid)
    crowd.served[0].is_closed(0.4)  # nothing comes: only time passes
    assert processor_seconds(central.pid) - before < 0.2


def test_without_descriptors_the_log_is_reopened_all_the_same(start_central, stack, tmp_path):
    log = tmp_path / "log"
    central = start_central("-LmsN", f"-f{log}", **limited(30, 30))
    crowd = Crowd(central, stack, 40)
    assert crowd.refused
    log.rename(tmp_path / "old")
    central.signal(signal.SIGHUP)
    wait_until(log.exists, "there is a new log")
    crowd.served[0].close()
    wait_until(lambda: "close Module" in log.read_text(), "it is written")
