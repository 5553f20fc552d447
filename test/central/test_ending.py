"""How the server ends, and what it says then."""
import os
import re
import signal
import socket
import time

import pytest

from support.peer import Peer
from support.waiting import PATIENCE

STATISTICS = [r"Cumulative Memory Usage:", r"  Requests: \d+ \(\d+ bytes\)",
              r"Data Msg Buffer Stats:", r"  Total Alloc  : \d+", r"  Total Freed  : \d+",
              r"  Min Request  : -?\d+", r"  Max Request  : -?\d+"]
OURS = [r"Connections: \d+ \(at most \d+\)", r"Per Second : \d+ \(\d+ bytes\)",
        r"Waiting    : \d+ \(\d+ bytes\)", r"Dropped    : \d+"]


def assert_statistics(lines, original):
    patterns = STATISTICS + ([] if original else OURS)
    for line, pattern in zip(lines, patterns, strict=True):
        assert re.fullmatch(pattern, line), line


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_102_a_signal_ends_the_server_in_order(start_central, stack, tmp_path, number):
    central = start_central("-lmsi", "-LmsiN", "-fa.log", cwd=tmp_path)
    stack.enter_context(Peer(central, "LAST")).connect()
    central.signal(number)
    assert central.wait() == (1 if central.original else 0)
    central.stop_quietly()
    assert_statistics(central.stderr, central.original)
    last = f"Central Abort : Signal {int(number)}"
    assert central.stdout[-1] == last
    assert (tmp_path / "a.log").read_text().endswith(f"   hostName: robot\n{last}\n")
    assert not os.path.exists(central.unix_path)


def test_quit_ends_the_server_in_order(start_central):
    central = start_central(console=True)
    central.write_line("quit")
    assert central.wait() == 0
    central.stop_quietly()
    assert central.stderr[-1] == "Central Quit"
    assert_statistics(central.stderr[:-1], central.original)
    assert not os.path.exists(central.unix_path)


@pytest.mark.new_central("it waits for them")
def test_103_nobody_delays_the_end(start_central, stack):
    """Neither half a message nor a module that does not read; within a bounded time."""
    central = start_central()
    half = stack.enter_context(Peer(central, "HALF")).connect()
    half.send_bytes(b"\0\0\0\0\0\1\0\0")
    deaf = stack.enter_context(Peer(central, "DEAF"))
    deaf.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    deaf.connect()
    deaf.subscribe("Big", 5)
    deaf.set_capacity(1000)
    deaf.sync()
    sender = stack.enter_context(Peer(central, "SENDER")).connect()
    sender.define("Big", None)
    for _ in range(40):
        sender.publish("Big", bytes(1 << 20))
    sender.sync()
    start = time.monotonic()
    central.signal(signal.SIGTERM)
    assert central.wait() == 0
    central.stop_quietly()
    assert time.monotonic() - start < PATIENCE


def test_what_was_answered_is_still_sent(start_central, stack):
    central = start_central(console=True)
    peer = stack.enter_context(Peer(central, "ASKER")).connect()
    references = [peer.start_look_up("x_ipc_waitMsg") for _ in range(10)]
    peer.sync()
    central.write_line("quit")
    assert central.wait() == 0
    central.stop_quietly()
    for reference in references:
        assert peer.finish_look_up(reference).name == "x_ipc_waitMsg"
