"""The server's numbers, as programs ask for them that watch over it."""
import os
import re
import socket

import pytest

from support.peer import Peer
from support.processes import Process
from support.waiting import PATIENCE, wait_until

pytestmark = pytest.mark.new_central("it shows no numbers")

REQUEST = b"GET /metrics HTTP/1.1\r\nHost: robot\r\nUser-Agent: test\r\n\r\n"


def call(address):
    caller = socket.socket(socket.AF_UNIX if isinstance(address, str) else socket.AF_INET)
    caller.settimeout(PATIENCE)
    caller.connect(address)
    return caller


def ask(address, request=REQUEST):
    """Status, headers and text of the answer."""
    with call(address) as caller:
        caller.sendall(request)
        answer = b""
        while data := caller.recv(65536):
            answer += data
    head, _, body = answer.decode().partition("\r\n\r\n")
    status, *headers = head.split("\r\n")
    return status, dict(header.split(": ", 1) for header in headers), body


def numbers(address):
    """The numbers by their names, without the common beginning."""
    return {name: float(value) for name, value in re.findall(
        r'^ipc_central_(\S+) (\S+)$', ask(address)[2], re.MULTILINE)}


@pytest.fixture(name="watched")
def _watched(start_central):
    """A central that shows its numbers, and where."""
    central = start_central("--metrics=0")
    port = central.wait_for_line(r"^Numbers at http://127\.0\.0\.1:(\d+)/metrics$").group(1)
    central.metrics = ("127.0.0.1", int(port))
    return central


# ------------------------------------------------------------------------- the text


def test_the_text_is_in_the_format_of_prometheus(watched):
    status, headers, body = ask(watched.metrics)
    assert status == "HTTP/1.1 200 OK"
    assert headers["Content-Type"] == "text/plain; version=0.0.4; charset=utf-8"
    assert int(headers["Content-Length"]) == len(body)
    described = set()
    for line in body.splitlines():
        if match := re.fullmatch(r"# TYPE (\w+) (counter|gauge)", line):
            assert match[1] not in described
            assert match[1].endswith("_total") == (match[2] == "counter")
            described.add(match[1])
        elif not re.fullmatch(r"# HELP \w+ .+\.", line):
            name = re.fullmatch(r'(\w+)(\{\w+="\w+"\})? \d+(\.\d+)?', line)[1]
            assert name in described
    assert len(described) >= 12


def test_the_documents_name_all_numbers_and_no_others(watched):
    path = os.path.join(os.path.dirname(__file__), "../../docs/operation.md")
    with open(path, encoding="utf-8") as file:
        rows = file.read().partition("| number, after")[2].partition("\n\n")[0]
    named = set(re.findall(r"`(\w+)", rows)) - {"ipc_central_"}
    assert named == {name.partition("{")[0] for name in numbers(watched.metrics)}


def test_numbers_count_what_happens(watched, connect, stack):
    before = numbers(watched.metrics)
    assert before["modules"] == before["connections"] == before["messages_total"] == 0
    receiver, sender = connect(watched, "RECEIVER"), connect(watched, "SENDER")
    stranger = stack.enter_context(Peer(watched))
    stranger.read_prelude()
    receiver.subscribe("M", 1)
    receiver.sync()
    sender.define("M")
    for number in range(5):
        sender.publish_number("M", number)
    sender.sync()
    busy = numbers(watched.metrics)
    assert (busy["modules"], busy["connections"]) == (2, 3)
    assert busy["queued_messages"] == 4  # capacity 1: the first is with the receiver
    assert busy["queued_bytes"] >= 16
    assert busy["deliveries"] == 5
    assert busy["messages_total"] > 5 and busy["message_bytes_total"] >= 5 * 8
    receiver.take(5)
    receiver.sync()
    sender.close()
    wait_until(lambda: numbers(watched.metrics)["modules"] == 1, "the sender is gone")
    after = numbers(watched.metrics)
    assert after["queued_messages"] == after["queued_bytes"] == after["deliveries"] == 0
    assert after["connections_peak"] == after["connections_total"] == 3
    assert after["deliveries_total"] > before["deliveries_total"] + 4
    assert after["uptime_seconds"] >= before["uptime_seconds"]


def test_what_is_dropped_is_counted(start_central, connect):
    central = start_central("--metrics=0", "--limit-queue-messages=3",
                            "--limit-progress-seconds=0.001")
    port = central.wait_for_line(r"^Numbers at \S+:(\d+)/").group(1)
    receiver, sender = connect(central, "RECEIVER"), connect(central, "SENDER")
    receiver.subscribe("M", 1)
    receiver.sync()
    sender.define("M")
    for number in range(10):
        sender.publish_number("M", number)
    sender.sync()
    shown = numbers(("127.0.0.1", int(port)))
    assert shown["queued_messages"] == 3
    assert shown["dropped_total"] == 6


# ----------------------------------------------------------------------- the address


def test_without_the_option_there_is_nothing(central, connect):
    connect(central).sync()
    assert "Numbers" not in central.output()


def test_numbers_on_a_unix_socket(start_central, tmp_path):
    path = str(tmp_path / "numbers")
    central = start_central(f"--metrics={path}")
    assert numbers(path)["connections"] == 0
    central.stop()
    assert not os.path.lexists(path)


@pytest.mark.parametrize("address", ["localhost:0", "127.0.0.1:0", "0.0.0.0:0"])
def test_addresses_may_be_names_and_numbers(start_central, address):
    central = start_central(f"--metrics={address}")
    port = central.wait_for_line(
        rf"^Numbers at http://{address.partition(':')[0]}:(\d+)/metrics$").group(1)
    assert numbers(("127.0.0.1", int(port)))["connections"] == 0


def test_ipv6_addresses_stand_in_brackets(start_central):
    try:
        socket.create_server(("::1", 0), family=socket.AF_INET6).close()
    except OSError:
        pytest.skip("no IPv6 on this machine")
    central = start_central("--metrics=[::1]:0")
    assert central.wait_for_line(r"^Numbers at http://\[::1\]:\d+/metrics$")


@pytest.mark.parametrize("address", ["there", "localhost:", "127.0.0.1:70000", "[::1]", "/none/x",
                                     "203.0.113.1:0", ":80"])
def test_what_is_no_address_is_an_error(central_program, address):
    with Process([central_program, "-p0", "-u", f"--metrics={address}"]) as central:
        assert central.wait() == 1
        assert f"ERROR: Can not show numbers at {address} (" in "\n".join(central.stderr)


# ----------------------------------------------------------------- awkward questions


@pytest.mark.parametrize("request_, status", [
    (b"GET / HTTP/1.0\n\n", "200 OK"),
    (b"GET /metrics HTTP/1.0\r\n\r\n", "200 OK"),
    (b"GET /other HTTP/1.0\r\n\r\n", "404 Not Found"),
    (b"POST /metrics HTTP/1.0\r\n\r\n", "405 Method Not Allowed"),
    (b"\r\n\r\n", "405 Method Not Allowed"),
    (b"\0\0\n\n", "405 Method Not Allowed"),
])
def test_other_questions_get_an_answer_too(watched, request_, status):
    assert ask(watched.metrics, request_)[0] == f"HTTP/1.1 {status}"


def test_a_question_may_come_in_pieces(watched):
    with call(watched.metrics) as caller:
        for byte in REQUEST:
            caller.sendall(bytes([byte]))
        assert caller.recv(15) == b"HTTP/1.1 200 OK"


@pytest.mark.parametrize("garbage", [b"x" * 100000, REQUEST[:-2] + b"a: b\r\n" * 10000])
def test_endless_questions_are_not_heard_out(watched, connect, garbage):
    with call(watched.metrics) as caller:
        try:
            caller.sendall(garbage)
            assert caller.recv(65536) == b""
        except ConnectionError:
            pass  # closed while it was still talking
    connect(watched).sync()
    assert numbers(watched.metrics)["modules"] == 1


def test_silent_callers_hold_up_nobody_and_are_hung_up(watched, connect, stack):
    module = connect(watched)
    silent = [stack.enter_context(call(watched.metrics)) for _ in range(4)]
    module.sync()
    assert numbers(watched.metrics)["modules"] == 1  # after them, so their patience is over
    module.sync()
    for caller in silent:
        assert caller.recv(1) == b""


def test_callers_that_vanish_leave_nothing(watched, connect):
    for _ in range(50):
        call(watched.metrics).close()
        with call(watched.metrics) as caller:
            caller.sendall(REQUEST)
    open_files = len(os.listdir(f"/proc/{watched.pid}/fd"))
    connect(watched).sync()
    wait_until(lambda: len(os.listdir(f"/proc/{watched.pid}/fd")) <= open_files + 1,
               "all are closed")
    assert numbers(watched.metrics)["modules"] == 1
