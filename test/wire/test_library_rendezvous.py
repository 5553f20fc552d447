"""How the library finds central (section 1 of the protocol, requirements 2 and 3).

Host names are not those of the machine that runs the tests: see named_host.c.
"""
import os
import socket
import stat
import time

import pytest

from support.fake_central import FakeCentral
from support.processes import free_port
from support.waiting import SLOW

LONG = "r" * 100

# host part of the address, name of the machine: transport
TRANSPORTS = {
    ("localhost", "robot"): "tcp",
    ("127.0.0.1", "robot"): "tcp",
    ("127.0.0.1", "127.0.0.1"): "unix",
    ("robot", "robot"): "unix",
    ("robot", "robot.example.org"): "unix",
    ("robot.example.org", "robot.example.org"): "unix",
    ("robot.example.org", "robot"): "tcp",
    ("robot.example", "robot.example.org"): "unix",
    ("ROBOT", "robot"): "tcp",
    ("rob", "robot"): "tcp",
    ("robots", "robot"): "tcp",
    # As much of the own name as the protocol uses, and all of it.
    (LONG[:32], LONG[:40]): "unix",
    (LONG[:40], LONG[:40]): "tcp",
}


@pytest.fixture(autouse=True)
def _no_address_by_chance(monkeypatch):
    monkeypatch.delenv("CENTRALHOST", raising=False)


def first_contact(central, driver, address=None):
    """Connects; returns the transport by which the module came."""
    driver.must("verbosity", 1)
    driver.must("connect", "M", address)
    assert len(central.connections) == 1
    return central.connection().transport


# -------------------------------------------------------------------- the address


@pytest.mark.parametrize("host, own_name", TRANSPORTS, ids=lambda name: name[:20])
def test_the_host_part_of_the_address_decides_on_the_transport(host, own_name, start_driver_on):
    """Requirement 2, table of 1.2; the module introduces itself by its own host's name."""
    with FakeCentral(unix=True) as central:
        driver = start_driver_on(own_name, [host],
                                 env={"CENTRALHOST": f"{host}:{central.port}"})
        assert first_contact(central, driver) == TRANSPORTS[host, own_name]
        assert central.connection().host == own_name[:32]


@pytest.mark.new_library("such names fail or crash")
@pytest.mark.parametrize("host", ["7up", LONG])
def test_names_that_the_original_does_not_take_are_resolved(host, start_driver_on):
    """Section 1.2: a leading digit, more than 79 bytes."""
    with FakeCentral(unix=True) as central:
        driver = start_driver_on("robot", [host], env={"CENTRALHOST": f"{host}:{central.port}"})
        assert first_contact(central, driver) == "tcp"


@pytest.mark.new_library("it asks for the name like for any other")
def test_localhost_is_this_machine_where_nobody_knows_the_name(start_driver_on):
    """A Debian that has just been set up has no /etc/hosts."""
    with FakeCentral() as central:
        driver = start_driver_on("robot", env={"CENTRALHOST": f"localhost:{central.port}",
                                               "IPC_TEST_UNKNOWN": "localhost"})
        assert first_contact(central, driver) == "tcp"


@pytest.mark.new_library("it knows no IPv6")
def test_an_ipv6_address_stands_in_brackets(start_driver_on):
    """Section 1.2."""
    try:
        central = FakeCentral(host="::1")
    except OSError:
        pytest.skip("this machine has no IPv6 loopback")
    with central:
        driver = start_driver_on("robot", env={"CENTRALHOST": f"[::1]:{central.port}"})
        assert first_contact(central, driver) == "tcp"


@pytest.mark.parametrize("host, transport", [("localhost", "tcp"), ("robot", "unix")])
def test_the_port_is_1381_unless_the_address_says_so(host, transport, start_driver_on):
    """Section 1.2."""
    with FakeCentral(unix=True) as central:
        driver = start_driver_on("robot", ["robot"], default_port=central.port,
                                 env={"CENTRALHOST": host})
        assert first_contact(central, driver) == transport


def test_the_argument_counts_more_than_the_environment(start_driver_on):
    """Section 1.2."""
    with FakeCentral() as central, FakeCentral() as other:
        driver = start_driver_on("robot", env={"CENTRALHOST": other.address})
        first_contact(central, driver, central.address)
        assert not other.connections


@pytest.mark.parametrize("unix", [True, False])
def test_without_an_address_central_is_on_the_own_host(unix, start_driver_on):
    """Section 1.2, last row: the Unix socket, then TCP; two warnings."""
    with FakeCentral(unix=unix) as central:
        driver = start_driver_on("robot", ["robot"], default_port=central.port)
        assert first_contact(central, driver) == ("unix" if unix else "tcp")
        said = driver.stderr[:2]
        assert said == ["Warning: CENTRALHOST environment variable not set.",
                        "Warning: trying to connect to local host robot."]


@pytest.mark.parametrize("obstacle", ["missing", "stale", "plain file", "forbidden"])
def test_without_a_usable_unix_socket_tcp_is_used(obstacle, start_driver_on):
    """Requirement 2: any failure to connect to the Unix socket leads to TCP."""
    if obstacle == "forbidden" and os.geteuid() == 0:
        pytest.skip("nothing is forbidden to root")
    with FakeCentral() as central:
        os.makedirs("/tmp/x_ipc", exist_ok=True)
        if obstacle in ("stale", "forbidden"):
            with socket.socket(socket.AF_UNIX) as listener:
                listener.bind(central.unix_path)
        elif obstacle == "plain file":
            with open(central.unix_path, "w", encoding="utf-8"):
                pass
        if obstacle == "forbidden":
            os.chmod(central.unix_path, 0)
        driver = start_driver_on("robot", ["robot"])
        assert first_contact(central, driver, f"robot:{central.port}") == "tcp"
        if obstacle != "missing":
            assert stat.S_ISREG(os.stat(central.unix_path).st_mode) == (obstacle == "plain file")


# -------------------------------------------------------------------------- tries


def test_a_failed_connect_is_tried_five_times_a_second_apart(start_driver):
    """Requirement 3: 5 s without a server, then E:Not_Connected."""
    driver = start_driver()
    driver.must("verbosity", 1)
    began = time.monotonic()
    answer = driver.do("connect", "M", f"localhost:{free_port()}", seconds=20 * SLOW)
    passed = time.monotonic() - began
    assert answer.error == "Not_Connected"
    assert 4.9 <= passed <= 6 * SLOW
    said = [line for line in driver.stdout if "Trying again" in line]
    assert len(said) == 4
    assert said[0].startswith("  Trying again M to connect with the central server on localhost:")


def test_addresses_that_lead_nowhere_fail(start_driver_on):
    """Table of 1.2: no host, no port, a blank, a name that nobody knows; all at once, since each
    is tried for 5 s."""
    with FakeCentral(unix=True) as central:
        drivers = {}
        for address in ("localhost:abc", f":{central.port}", f" robot:{central.port}",
                        f"unknown.invalid:{central.port}"):
            drivers[address] = start_driver_on("robot", ["robot"], default_port=central.port)
            drivers[address].must("verbosity", 1)
            drivers[address].start("connect", "M", address)
        errors = {address: driver.finish(20 * SLOW).error for address, driver in drivers.items()}
        assert errors == {address: "Not_Connected" for address in drivers}
        assert not central.connections


def test_without_an_address_and_central_a_module_ends(start_driver_on):
    """Section 1.3: exit status 255 at the default verbosity, without a second try."""
    driver = start_driver_on("robot", ["robot"], default_port=free_port())
    driver.start("connect", "M", None)
    assert driver.wait() == 255
    assert "ERROR: Can not connect to the server on robot." in driver.output()
    assert "Trying again" not in driver.output()


def test_a_central_that_appears_meanwhile_is_found(start_driver):
    """Requirement 3: central starts when the second attempt is announced."""
    driver, port = start_driver(), free_port()
    driver.must("verbosity", 1)
    driver.start("connect", "M", f"localhost:{port}")
    driver.wait_for_line("Trying again M to connect")
    with FakeCentral(port=port) as central:
        assert driver.finish(10 * SLOW).result == "OK"
        assert central.connection().module == "M"
