"""How central ends, and what signals do (sections 1.9 and 6)."""
import os
import signal
import subprocess

import pytest

from support.frame import BROADCAST, Frame
from support.processes import Process
from support.waiting import PATIENCE, wait_until

new_central = pytest.mark.new_central("statuses and reopening differ")


@new_central
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_central_in_good_order(start_central, connect, tmp_path, number):
    log = tmp_path / "log"  # check 102
    central = start_central("-LmsiN", f"-f{log}")
    peer = connect(central, "LAST")
    peer.subscribe("M", 1)
    peer.define("M")
    peer.publish_number("M", 1)
    assert peer.take_numbers(1) == [1]
    peer.sync()
    central.signal(number)
    assert central.wait_for_end() == 0
    end = f"Central Abort : Signal {int(number)}"
    assert central.stdout[-1] == end
    assert "Cumulative Memory Usage:" in central.stderr
    assert not os.path.lexists(central.unix_path)
    assert peer.is_closed()
    lines = log.read_text().splitlines()
    assert lines[-1] == end
    assert any(line.startswith("  Done") for line in lines)


@new_central
def test_central_ends_while_modules_are_half_way(start_central, connect):  # check 103
    central = start_central()
    lazy, sender = connect(central, "LAZY"), connect(central, "SENDER")
    lazy.set_capacity(100000)
    lazy.subscribe("big", 5)
    lazy.sync()
    sender.define("big", None)
    for _ in range(100):
        sender.publish("big", bytes(100000))
    sender.sync()
    sender.send_bytes(Frame(BROADCAST, sender.id_of("big"), bytes(1000)).pack()[:500])
    central.signal(signal.SIGTERM)
    assert central.wait_for_end() == 0


@new_central
def test_hanging_up_opens_the_log_anew(start_central, connect, tmp_path):  # check 104
    log, old = tmp_path / "log", tmp_path / "old"
    central = start_central("-LmsiN", f"-f{log}")
    peer = connect(central, "BEFORE")
    wait_until(lambda: "BEFORE" in log.read_text(), "the log is written")
    log.rename(old)
    central.signal(signal.SIGHUP)
    wait_until(log.exists, "there is a new log")
    connect(central, "AFTER").sync()
    peer.sync()
    wait_until(lambda: "AFTER" in log.read_text(), "the new log is written")
    assert "AFTER" not in old.read_text() and "BEFORE" not in log.read_text()


@new_central
def test_hanging_up_without_a_log_does_nothing(central, connect):
    central.signal(signal.SIGHUP)
    connect(central).sync()


@new_central
def test_a_broken_pipe_does_nothing(central, connect):  # check 105
    central.signal(signal.SIGPIPE)
    connect(central).sync()


@new_central
def test_central_goes_on_when_nobody_reads_its_output_any_more(central_program, tmp_path, connect):
    port_file = tmp_path / "port"  # check 105
    with subprocess.Popen([central_program, "-p0", "-u", f"--port-file={port_file}"],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          stdin=subprocess.DEVNULL) as central:
        try:
            wait_until(port_file.exists, "it has a port")
            central.port = int(port_file.read_text())
            central.stdout.close()
            for number in range(10):
                connect(central, f"M{number}").sync()
            assert central.poll() is None
        finally:
            central.terminate()
            central.stderr.read()
        assert central.wait(PATIENCE) == 0


def test_modules_notice_that_central_was_killed(start_central, start_driver):  # check 106
    central = start_central()
    drivers = [start_driver().connect(central.address, verbosity=2) for _ in range(2)]
    for driver in drivers:
        driver.start("dispatch")
    central.signal(signal.SIGKILL)
    assert central.wait_for_end() == -signal.SIGKILL
    for driver in drivers:
        assert driver.wait() == 255
        assert (f"Closed Connection Detected from: Central Server {central.address}"
                in driver.output())


@new_central
def test_a_closed_standard_input_does_not_end_central(central_program, tmp_path, connect):
    port_file = tmp_path / "port"
    with Process([central_program, "-p0", f"--port-file={port_file}"],
                 stdin=subprocess.PIPE) as central:
        wait_until(port_file.exists, "it has a port")
        central.close_stdin()
        central.port = int(port_file.read_text())
        connect(central).sync()
