"""Every way to disturb the server: it goes on serving, and nobody else notices.

Two healthy modules exchange numbered messages all the time; none may be lost.  Numbers in the
docstrings are rows of the table of provocations ("row") and of the plan of checks ("check").
"""
import os
import random
import resource
import select
import socket
import struct
import subprocess
import time

import pytest

from support import codec, messages
from support.frame import BROADCAST, FAILURE, Frame, INFORM, QUERY, REPLY, SUCCESS
from support.peer import Closed, Peer, expect_nothing, reply_number
from support.processes import (Central, Process, is_sanitized, memory_of,
                               processor_time_of)
from support.waiting import PATIENCE, SLOW, wait_until

#: How often what should leave nothing behind is repeated.
ROUNDS = int(os.environ.get("IPC_TEST_ROUNDS", "2000"))

pytestmark = pytest.mark.new_central("most of these stop it or end it")


@pytest.fixture
def central(start_central, start_steady_pair, stack):
    """A central with a steady pair; after the test new modules can still connect."""
    served = start_central()
    start_steady_pair(served)
    yield served
    with Peer(served, "NEW") as new:
        new.connect()


@pytest.fixture
def bad(join):
    return join("BAD")


def sequence(number, size):
    """Content of that size that holds the number throughout."""
    return struct.pack("<i", number) * (size // 4)


# --------------------------------------------------------------------- slow modules


@pytest.mark.parametrize("capacity", [1, 1000])
def test_a_subscriber_that_stops_reading_gets_everything_in_order_later(capacity, join):
    """Rows 1 and 2, check 97: 10 MB wait for it meanwhile."""
    lazy, sender = join("LAZY"), join("SENDER")
    lazy.set_capacity(capacity)
    lazy.subscribe("data", 5)
    lazy.sync()
    sender.define("data", None)
    for number in range(1000):
        sender.publish("data", sequence(number, 10000))
    sender.sync()
    for number in range(1000):
        delivery = lazy.next_delivery()
        assert delivery.content == sequence(number, 10000)
        lazy.acknowledge(delivery)


def test_one_message_of_100_mb_to_a_stopped_module_holds_nobody_up(join):
    """Row 2, check 98: larger than any socket buffer."""
    lazy, sender = join("LAZY"), join("SENDER")
    lazy.subscribe("large", 5)
    lazy.sync()
    sender.define("large", None)
    content = bytes(100_000_000)
    sender.publish("large", content)
    sender.publish("large", b"after")
    sender.sync()
    first = lazy.next_delivery(20 * PATIENCE)
    assert first.content == content
    lazy.acknowledge(first)
    assert lazy.next_delivery().content == b"after"


def test_a_storm_of_messages_delays_no_query_for_long(join, central, start_driver):
    """Row 14: 200,000 messages of 100 bytes; a third module asks meanwhile, and is answered."""
    sink, source = (start_driver(name).connect(central.address) for name in ("SINK", "SOURCE"))
    asker, server = join("ASKER"), join("SERVER")
    asker.define("Q")
    asker.define("A")
    server.subscribe("Q", 1)
    server.sync()
    sink.must("subscribe", "storm", 0, "sequence")
    source.must("define", "storm", "variable")
    seconds = 60 * SLOW
    sink.start("until", 200_000, int(seconds * 1000))
    source.start("burst", "storm", 200_000, 100, 1)
    for number in range(200):
        reference = asker.query_number("Q", number)
        server.respond_number(server.next_delivery(), "A", number)
        assert reply_number(asker.await_reply(reference)) == number
    assert source.finish(seconds).result.startswith("OK")
    assert sink.finish(seconds + PATIENCE).result == "OK"
    assert sink.do("report", "storm").result == "200000 0 0"


# ------------------------------------------------------------------- names and ends


def test_modules_of_one_name_are_independent(join):
    """Row 3, check 92: the end of one leaves the other its connection and its queue."""
    first, second, sender = join("TWIN"), join("TWIN"), join("SENDER")
    for twin in (first, second):
        twin.subscribe("M", 5)
        twin.sync()
    sender.define("M")
    for number in range(3):
        sender.publish_number("M", number)
    sender.sync()
    first.close()
    assert second.take_numbers(3) == [0, 1, 2]
    sender.publish_number("M", 3)
    assert second.take_numbers(1) == [3]
    second.reset()
    sender.publish_number("M", 4)
    sender.sync()


@pytest.mark.parametrize("name", ["n" * 100, "n" * 1000, "\u00fcbergr\u00f6\u00dfe \U0001f916",
                                  "\udcff\udc80", "%s%n%d", " ", "a:b --> c {1}"],
                         ids=["100", "1000", "utf-8", "no-utf-8", "percent", "blank", "like-a-log"])
def test_any_module_name_is_an_ordinary_name(name, central, join):
    """Rows 12 and 13, check 93."""
    name = name.encode("utf-8", "surrogateescape").decode("latin-1")
    peer = join(name)
    peer.define("M")
    peer.subscribe("M", 1)
    peer.publish_number("M", 1)
    assert peer.take_numbers(1) == [1]
    peer.close()
    central.wait_for_line("close Module: Closing " + "".join(f"[{c}]" if c in "[{}%().*+?" else c
                                                            for c in name[:50]))


def test_a_module_name_of_5000_bytes_is_refused(central, stack):
    """Check 93."""
    peer = stack.enter_context(Peer(central, "n" * 5000))
    peer.read_prelude()
    peer.start_request("x_ipc_newModuleConnectMsg", (peer.name, "host"))
    peer.sync()
    central.wait_for_line("WARNING: .* name")


def test_silent_connections_are_nobody(central, join, stack):
    """Row 4, check 83: their end is told to nobody and ends nobody else's connection."""
    watcher = join("WATCHER")
    watcher.subscribe("x_ipc_disconnectNotify", 1)
    watcher.sync()
    other = stack.enter_context(Peer(central, "OTHER"))
    other.read_prelude()
    for _ in range(20):
        socket.create_connection(("127.0.0.1", central.port)).close()
    other.introduce()
    other.ready()
    expect_nothing(watcher, other)


PARTS = {"nothing": b"", "10 bytes": Frame(QUERY, 5, bytes(100)).pack()[:10],
         "header and half a body": Frame(BROADCAST, 5, bytes(100)).pack()[:78],
         "2 GB announced": Frame(BROADCAST, 5, data_length=0x7fffffff).header(),
         "256 MB announced": Frame(BROADCAST, 5, data_length=256 << 20).header()}


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_connections_that_stop_in_the_middle_wait_alone(part, central, join, stack):
    """Rows 5, 6 and 9, check 94: what is announced takes no memory before it comes."""
    before = memory_of(central)
    for _ in range(50):
        stack.enter_context(Peer(central, "HALF")).connect().send_bytes(part)
    join("OTHER").sync()
    assert memory_of(central) - before < 40 << 20


HEADERS = {
    "28 zero bytes": bytes(28), "http": b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "alignment": Frame(QUERY, 5, alignment=1).pack(), "class 0": Frame(0, 5).pack(),
    "class 16": Frame(16, 5).pack(), "negative size": Frame(QUERY, 5, data_length=-1).header(),
    "negative class size": Frame(QUERY, 5, class_length=-5).header(),
    "message 1000000": Frame(BROADCAST, 1000000).pack(), "message 0": Frame(QUERY, 0).pack(),
}


@pytest.mark.parametrize("header", HEADERS.values(), ids=HEADERS.keys())
def test_malformed_headers_cost_their_own_connection(header, bad):
    """Rows 7 and 8, check 95."""
    bad.send_bytes(header)
    assert bad.is_closed()


def test_random_strings_cost_their_own_connections(central, central_program):
    """Check 95: 28 to 500 bytes each; IPC_TEST_SEED sets which."""
    generator = random.Random(int(os.environ.get("IPC_TEST_SEED", "1")))

    def say_nonsense(count):
        for _ in range(count):
            with socket.create_connection(("127.0.0.1", central.port)) as connection:
                connection.sendall(generator.randbytes(generator.randrange(28, 500)))
    say_nonsense(ROUNDS // 2)
    before = memory_of(central)
    say_nonsense(ROUNDS // 2)
    if not is_sanitized(central_program):
        assert memory_of(central) - before < 1 << 20


@pytest.mark.parametrize("cls", [SUCCESS, FAILURE, REPLY])
def test_reports_of_deliveries_that_do_not_exist_count_for_nothing(cls, bad):
    """Row 8."""
    for dispatch in (0, 7, 1 << 30, -5):
        bad.send(Frame(cls, parent=dispatch, dispatch=dispatch))
    bad.sync()


# -------------------------------------------------------------------------- numbers


def test_descriptors_may_have_numbers_beyond_1024(central, stack):
    """Row 10: a descriptor set of 1024 places plays no part."""
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    if hard != resource.RLIM_INFINITY and hard < 3000:
        pytest.skip(f"only {hard} descriptors are allowed")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(3000, resource.getrlimit(
        resource.RLIMIT_NOFILE)[0]), hard))
    peers = [stack.enter_context(Peer(central, f"P{number}")) for number in range(1200)]
    peers[-1].connect().sync()
    peers[0].connect().sync()


def test_who_finds_no_descriptor_left_costs_nothing(stack, central_program, start_steady_pair,
                                                    tmp_path):
    """Row 11, check 100: no flood of warnings, no processor time, and places that become free are
    taken by others."""
    program = tmp_path / "central"
    program.write_text(f'#!/bin/sh\nulimit -n 40\nexec "{central_program}" "$@"\n')
    program.chmod(0o755)
    central = stack.enter_context(Central(program))
    pair = start_steady_pair(central)
    peers = [stack.enter_context(Peer(central, f"P{number}")) for number in range(60)]
    central.wait_for_line("no descriptors left")

    def greeted():
        readable = select.select([peer.socket for peer in peers], [], [], 0)[0]
        return [peer for peer in peers if peer.socket in readable
                and peer.socket.recv(1, socket.MSG_PEEK)]
    served = wait_until(lambda: len(greeted()) >= 20 and greeted(), "most are greeted")
    assert len(served) < 40
    pair.finish()
    start, used = time.monotonic(), processor_time_of(central)
    wait_until(lambda: time.monotonic() - start > 0.5, "some time has passed")
    assert processor_time_of(central) - used < 0.4
    for peer in [peer for peer in peers if peer not in served] + served[:10]:
        peer.close()
    for number in range(10):
        wait_until(lambda number=number: is_let_in(stack, central, f"LATER{number}"),
                   "a free place is taken")
    assert central.output().count("no descriptors left") < 200  # the original: millions


def is_let_in(stack, central, name):
    try:
        stack.enter_context(Peer(central, name)).connect()
    except (Closed, ConnectionError):
        return False
    return True


def test_coming_and_going_leaves_nothing_behind(central, central_program, join):
    """Rows 29 and 30, check 101: connections, bare ones, subscriptions; one that does not listen
    watches."""
    watcher, changing = join("WATCHER"), join("CHANGING")
    watcher.subscribe(messages.WATCH_BROADCASTS, 9, messages.WATCH_BROADCASTS)
    watcher.sync()

    def come_and_go(count):
        for _ in range(count):
            socket.create_connection(("127.0.0.1", central.port)).close()
        for _ in range(count // 25):
            with Peer(central, "GUEST") as guest:
                guest.connect()
                guest.subscribe("guests", 1)
        for _ in range(count):
            changing.subscribe("changing", 5)
            changing.unsubscribe("changing", "HND-changing1005")
        changing.sync()
    come_and_go(ROUNDS)
    before = memory_of(central)
    come_and_go(ROUNDS)
    if not is_sanitized(central_program):  # whose memory is freed late
        assert memory_of(central) - before < 1 << 20
    assert len(watcher.deliveries) <= 1


# ------------------------------------------------------------------ senseless requests


def test_a_query_for_two_handlers_reaches_exactly_one(join):
    """Row 15, check 73; with the first busy, the second gets it."""
    asker, first, second = join("ASKER"), join("FIRST"), join("SECOND")
    asker.define("Q")
    asker.define("A")
    for peer, handler in ((first, 1), (second, 2)):
        peer.subscribe("Q", handler)
        peer.sync()
    references = [asker.query_number("Q", number) for number in range(2)]
    asker.sync()
    held, taken = first.next_delivery(), second.next_delivery()
    assert (held.number, taken.number) == (0, 1)
    second.respond_number(taken, "A", 11)
    first.respond_number(held, "A", 10)
    assert [reply_number(asker.await_reply(r)) for r in references] == [10, 11]
    expect_nothing(first, asker)
    expect_nothing(second, asker)


@pytest.mark.parametrize("text", ["{int", "unheard_of", "{" * 60000, "[int:-1]", "{int, <byte:9>}"])
def test_a_bad_format_is_told_as_such(text, bad, join):
    """Row 16."""
    bad.define("bad", text)
    bad.sync()
    assert join("OTHER").look_up("bad").content == ("bad",)


@pytest.mark.parametrize("name", ["x_ipc_waitMsg", "x_ipc_msgInfoMsg", "x_ipc_registerHandlerMsg"])
def test_the_servers_own_messages_stay_its_own(name, bad, join):
    """Row 17."""
    bad.define(name, "int")
    bad.subscribe(name, 5)
    bad.sync()
    join("NEW")
    expect_nothing(bad, bad)


SENSELESS = [
    ("x_ipc_unlockResourceMsg", 5), ("x_ipc_cancelReservationMsg", 12345),
    ("x_ipc_lockResourceMsg", "no resource"),
    ("x_ipc_registerGlobalVar", (messages.BROADCASTS, "int")),
    ("x_ipc_notifyHandlerChange", "undefined"),
    ("x_ipc_addHndToResourceMsg", ("no handler", "BAD")), ("x_ipc_getMessageInfo", ("unknown",)),
]


@pytest.mark.parametrize("name, value", SENSELESS, ids=[name for name, _ in SENSELESS])
def test_requests_about_what_does_not_exist_do_no_harm(name, value, bad):
    """Row 18, check 85."""
    if name == "x_ipc_getMessageInfo":
        bad.await_reply(bad.start_request(name, value))
    elif messages.find(name).cls == QUERY:
        bad.start_request(name, value)
    else:
        bad.notice(name, value)
    bad.sync()


BUILT_IN_DATA = {"null": b"", "empty": codec.encode("string", ""), "short": b"\1\0",
                 "lying": struct.pack("<i", 0x7ffffff0) + b"x", "long": bytes(100_000)}


@pytest.mark.parametrize("data", BUILT_IN_DATA.values(), ids=BUILT_IN_DATA.keys())
def test_no_data_of_a_library_message_harms(data, central, join):
    """Check 96."""
    for name, message in sorted(messages.LIBRARY.items()):
        with Peer(central, "BAD") as peer:
            peer.connect()
            identifier = peer.id_of(name)
            for cls in (message.cls, QUERY, INFORM, BROADCAST):
                try:
                    peer.send(Frame(cls, identifier, data, reference=99))
                except OSError:
                    break  # closed after the first
    join("OTHER").sync()


# --------------------------------------------------------- what a module leaves behind


def test_a_lock_ends_with_its_holder(bad, join):
    """Row 19, check 90."""
    receiver, sender = join("RECEIVER"), join("SENDER")
    receiver.subscribe("M", 1)
    receiver.sync()
    sender.define("M")
    assert bad.request("x_ipc_lockResourceMsg", "RECEIVER") != -1
    sender.publish_number("M", 1)
    expect_nothing(receiver, sender)
    bad.reset()
    assert receiver.take_numbers(1) == [1]


def test_the_end_of_a_responder_leaves_the_asker_in_peace(bad, join):
    """Row 20, check 77: no answer comes, and the next query reaches somebody else."""
    asker, other = join("ASKER"), join("OTHER")
    asker.define("Q")
    asker.define("A")
    bad.subscribe("Q", 1)
    bad.sync()
    lost = asker.query_number("Q", 1)
    bad.next_delivery()
    bad.close()
    other.subscribe("Q", 2)
    other.sync()
    reference = asker.query_number("Q", 2)
    other.respond_number(other.next_delivery(), "A", 20)
    assert reply_number(asker.await_reply(reference)) == 20
    assert not asker.has_reply(lost)


def test_a_peer_that_vanishes_is_found_out(central, join):
    """Row 26: connections are kept alive by probes, so the loss of a machine is noticed."""
    peer = join("PROBED")
    ends = (f":{central.port:04X}", f":{peer.socket.getsockname()[1]:04X}")

    def timer():
        with open("/proc/net/tcp", encoding="ascii") as table:
            for fields in map(str.split, table):
                if fields[1].endswith(ends[0]) and fields[2].endswith(ends[1]):
                    return fields[5].split(":")[0]
        return None
    wait_until(lambda: timer() == "02", "the timer of the socket is that of keep-alive")


# ----------------------------------------------------------------- streams of the server


class Console(Process):
    """A central that takes commands, or whatever its standard input is."""

    def __init__(self, program, *options, stdin=subprocess.PIPE, **popen):
        super().__init__([program, "-p0", *options], stdin=stdin, **popen)
        self.port = int(self.wait_for_line(r"Expecting \d+ on port (\d+)").group(1))


@pytest.fixture
def start_console(stack, central_program, start_steady_pair):
    def start(*options, **popen):
        console = stack.enter_context(Console(central_program, *options, **popen))
        start_steady_pair(console)
        return console
    return start


def test_commands_in_pieces_stop_nobody(start_console, stack):
    """Row 24, checks 36 and 37."""
    console = start_console()
    console.process.stdin.write(b"sta")
    console.process.stdin.flush()
    stack.enter_context(Peer(console, "MEANWHILE")).connect()
    console.process.stdin.write(b"tus\ndisplay\nmemory\n")
    console.process.stdin.flush()
    for line in ("Resource status", "Active and Pending Messages:", "Cumulative Memory Usage:"):
        console.wait_for_line(line)


def test_the_end_of_standard_input_ends_the_commands_only(start_console, stack):
    """Row 23, check 38: no output, no processor time."""
    console = start_console("-lx")
    console.close_stdin()
    peer = stack.enter_context(Peer(console, "PEER")).connect()
    peer.sync()
    wait_until(lambda: "hostName: robot" in console.output().partition("PEER")[2], "all is printed")
    before = console.output()
    used, start = processor_time_of(console), time.monotonic()
    for _ in range(20):
        peer.sync()
    wait_until(lambda: time.monotonic() - start > 0.5, "some time has passed")
    assert processor_time_of(console) - used < 0.4
    assert console.output() == before


def test_a_log_file_asks_nobody_at_the_end_of_standard_input(start_console, stack, tmp_path):
    """Row 25, check 51: serves at once, and the file does not grow by itself."""
    file = tmp_path / "log"
    console = start_console("-Lmi", f"-f{file}", stdin=subprocess.DEVNULL)
    peer = stack.enter_context(Peer(console, "PEER")).connect()
    peer.sync()
    assert file.read_text(encoding="latin-1").count("Enter any comments") == 0
    assert "****" not in file.read_text(encoding="latin-1")


class Unread:
    """A central whose standard output nobody reads after its first lines."""

    def __init__(self, program):
        self.process = subprocess.Popen([program, "-p0", "-u"], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        text = b""
        while b"on port" not in text or not text.endswith(b"\n"):
            text += os.read(self.process.stdout.fileno(), 4096)
        self.port = int(text.split()[-1])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.communicate(timeout=PATIENCE)


@pytest.fixture
def unread(stack, central_program):
    return stack.enter_context(Unread(central_program))


def exchange(stack, central, count):
    """Two more modules exchange so many numbers."""
    sender, receiver = (stack.enter_context(Peer(central, name)).connect()
                        for name in ("SENDER", "RECEIVER"))
    receiver.subscribe("lines", 1)
    receiver.sync()
    sender.define("lines")
    for number in range(count):
        sender.publish_number("lines", number)
        assert receiver.take_numbers(1) == [number]


def test_nobody_reading_standard_output_stops_nobody(unread, stack, start_steady_pair):
    """Row 21, check 62: 10,000 messages are some 1.5 MB of log, a pipe holds 64 KB."""
    start_steady_pair(unread)
    exchange(stack, unread, 10_000)


def test_a_reader_of_standard_output_that_goes_away_is_not_missed(unread, stack,
                                                                  start_steady_pair):
    """Row 22, check 105."""
    unread.process.stdout.close()
    pair = start_steady_pair(unread)
    exchange(stack, unread, 100)
    pair.finish()
    assert unread.process.poll() is None
    assert not select.select([unread.process.stderr], [], [], 0)[0]
    unread.process.stdout = None


def test_a_second_central_on_the_port_takes_nothing_away(central, central_program, stack):
    """Row 27, check 15: the first one's local socket stays."""
    second = subprocess.run([central_program, f"-p{central.port}", "-u"], capture_output=True,
                            stdin=subprocess.DEVNULL, timeout=PATIENCE, check=False)
    assert second.returncode == 1
    stack.enter_context(Peer(central, "LOCAL", unix=True)).connect()


def test_commands_about_the_server_itself_do_no_harm(start_console, stack):
    """Row 28, checks 31, 32 and 33."""
    console = start_console()
    holder = stack.enter_context(Peer(console, "HOLDER")).connect()
    locked = stack.enter_context(Peer(console, "LOCKED")).connect()
    locked.define("M")
    locked.subscribe("M", 1)
    locked.sync()
    console.write_line("close X_IPC Server")
    console.wait_for_line("Can not find X_IPC Server to close")
    for command in ("unlock HOLDER", "unlock LOCKED"):
        assert holder.request("x_ipc_lockResourceMsg", "LOCKED") != -1
        holder.publish_number("M", 7)
        expect_nothing(locked, holder)
        console.write_line(command)
        assert locked.take_numbers(1) == [7]
        for number in range(1000):
            holder.publish_number("M", number)
        assert locked.take_numbers(1000) == list(range(1000))
    console.write_line("unlock nobody")
    console.wait_for_line("Can not find nobody to unlock")
