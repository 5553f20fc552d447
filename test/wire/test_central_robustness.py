"""Whatever one connection sends, central and everybody else go on (section 13).

Every row of 13.1 is sent while two healthy hand-made modules exchange numbered messages, and two
more in a process of their own do so all the time; the checks of 13.3 decide what becomes of the
connection that sent it.
"""
import itertools
import random
import resource
import socket
import struct

import pytest

from support import codec, messages
from support.frame import (BROADCAST, FAILURE, Frame, INFORM, QUERY, REPLY, SUCCESS,
                           class_name)
from support.peer import Closed, Peer, expect_nothing, reply_number
from support.processes import Central
from support.steady_pair import SteadyPair
from support.waiting import SLOW, TimedOut, wait_until

pytestmark = pytest.mark.new_central("most of these end it")

IMPOSSIBLE_ID = 0x7ffffff0


class HealthyPair:
    """Two modules that exchange numbered messages in both directions and miss none."""

    def __init__(self, central):
        self.left, self.right = (Peer(central, name).connect() for name in ("LEFT", "RIGHT"))
        self.numbers = itertools.count()
        for peer, message in ((self.left, "to left"), (self.right, "to right")):
            peer.define(message)
            peer.subscribe(message, 1)
            peer.sync()

    def exchange(self, count=3):
        for _ in range(count):
            number = next(self.numbers)
            self.left.publish_number("to right", number)
            self.right.publish_number("to left", number)
            assert self.right.take_numbers(1) == [number]
            assert self.left.take_numbers(1) == [number]

    def close(self):
        self.left.close()
        self.right.close()


class Server:
    """One central for many tests, started anew when it has died."""

    def __init__(self, start):
        self.start = start
        self.central = self.pair = self.steady = None

    def running(self):
        if self.central is None or not self.central.alive():
            self.discard()
            self.central = self.start()
            self.pair = HealthyPair(self.central)
            self.steady = SteadyPair(self.central)
        return self.central

    def discard(self):
        central, pair, steady = self.central, self.pair, self.steady
        self.central = self.pair = self.steady = None
        if pair:
            pair.close()
        if steady:
            steady.stop()
        if central:
            central.stop()


@pytest.fixture(scope="module")
def server(central_program, pytestconfig, gaps):
    """The central that all tests of this file share."""
    shared = Server(lambda: Central(central_program,
                                    original=pytestconfig.ipc_central_is_original))
    yield shared
    if shared.steady:
        gaps.append((*shared.steady.finish()[::-1], "the connections that misbehave on the wire"))
    shared.discard()


@pytest.fixture
def central(server):
    """The shared central; it has to be alive and serving after every test."""
    central = server.running()
    server.pair.exchange(1)
    yield central
    if not central.alive():
        server.pair.close()
        server.central = server.pair = server.steady = None
        central.check_sanitizers()
        pytest.fail(f"central ended with {central.wait()}:\n{central.output()[-2000:]}")
    try:
        server.pair.exchange(2)
        assert server.steady.alive(), server.steady.output()
    except (TimedOut, Closed):
        server.discard()
        raise


@pytest.fixture
def pair(server, central):
    return server.pair


@pytest.fixture
def bad(stack, central):
    """A module that is about to misbehave; it has been introduced."""
    return stack.enter_context(Peer(central, "BADPEER", host="badhost")).connect()


def assert_closed(peer):
    assert peer.is_closed(), "the connection should have been closed"


def assert_open(peer):
    """The connection still serves its module."""
    assert peer.request("x_ipc_moduleConnectedQ", peer.name) == 1


# -------------------------------------------------------------------------- sockets


def test_connecting_and_closing_at_once_does_no_harm(central, pair):
    """13.1."""
    for _ in range(50):
        socket.create_connection(("127.0.0.1", central.port)).close()
    pair.exchange()


@pytest.mark.parametrize("length", [1, 4, 27])
def test_a_part_of_a_header_and_an_end_closes_that_connection(length, bad, pair):
    """13.1."""
    bad.send_bytes(Frame(QUERY, 5).pack()[:length])
    bad.socket.shutdown(socket.SHUT_WR)
    assert_closed(bad)
    pair.exchange()


PARTIAL = {
    "part of a header": Frame(QUERY, 5, bytes(100)).pack()[:13],
    "header without body": Frame(QUERY, 5, bytes(100)).header(),
    "part of a body": Frame(BROADCAST, 5, bytes(100)).pack()[:70],
    "part of the class data": Frame(REPLY, 5, bytes(100), bytes(50)).pack()[:40],
}


@pytest.mark.parametrize("data", PARTIAL.values(), ids=PARTIAL.keys())
def test_a_partial_frame_and_silence_hold_nobody_up(data, bad, pair, stack, central):
    """13.1: the others are served meanwhile, and new modules can connect."""
    bad.send_bytes(data)
    pair.exchange(20)
    stack.enter_context(Peer(central, "NEW")).connect()


def test_the_rest_of_a_partial_frame_may_come_later(bad, pair):
    """13.3: 28 bytes, checks, then the body."""
    frame = Frame(QUERY, bad.look_up_id, codec.encode("{string, string}", ("V_get_x", None)),
                  reference=bad.next_reference()).pack()
    for position in (10, 28, 30):
        bad.send_bytes(frame[:position])
        pair.exchange(2)
        bad.send_bytes(frame[position:])
        bad.sync()


def test_a_silent_connection_holds_nobody_up(stack, central, pair):
    """Central section 7, row 4."""
    for _ in range(20):
        stack.enter_context(Peer(central, "silent"))
    pair.exchange(10)


# ------------------------------------------------------------------------- headers


LYING_LENGTHS = {
    "huge data": dict(data_length=0x7ffffff0), "huge class data": dict(class_length=0x7ffffff0),
    "largest data": dict(data_length=0x7fffffff),
    "data above the limit": dict(data_length=(256 << 20) + 1),
    "class data above the limit": dict(class_length=(64 << 10) + 1),
    "negative data": dict(data_length=-1), "negative class data": dict(class_length=-1),
    "most negative": dict(data_length=-0x80000000, class_length=-0x80000000),
    "sum overflows": dict(data_length=0x7fffffff, class_length=0x7fffffff),
    "sum is small": dict(data_length=-8, class_length=16),
}


@pytest.mark.parametrize("lengths", LYING_LENGTHS.values(), ids=LYING_LENGTHS.keys())
@pytest.mark.parametrize("then", ["silence", "close"])
def test_impossible_lengths_close_that_connection(lengths, then, bad, pair):
    """13.1, 13.3: 0 <= length <= limit."""
    bad.send_bytes(Frame(BROADCAST, 5, **lengths).header() + b"x" * 100)
    if then == "close":
        bad.close()
    else:
        assert_closed(bad)
    pair.exchange()


@pytest.mark.parametrize("cls", [0, 1, 2, 4, 5, 6 | 0x100, 7, 8, 9, 10, 14, 16, 17, 255, 0xffff])
def test_classes_that_modules_do_not_send_close_that_connection(cls, bad, pair):
    """13.1, 13.3: class one of 3, 6, 11, 12, 13, 15."""
    bad.send(Frame(cls, bad.look_up_id, codec.encode("{string, string}", ("x", None))))
    assert_closed(bad)
    pair.exchange()


@pytest.mark.parametrize("alignment", [1, 2, 0x80, 0xff])
def test_unpacked_data_closes_that_connection(alignment, bad, pair):
    """13.1, 13.3: alignment 0."""
    bad.send(Frame(QUERY, bad.look_up_id, codec.encode("{string, string}", ("x", None)),
                   alignment=alignment))
    assert_closed(bad)
    pair.exchange()


@pytest.mark.parametrize("nibble", [0, 3, 4, 7])
def test_unknown_byte_orders_close_that_connection(nibble, bad, pair):
    """13.1, 13.3: both order nibbles 1 or 2 for the parts that are present."""
    bad.send(Frame(QUERY, bad.look_up_id, codec.encode("{string, string}", ("x", None)),
                   order=nibble, class_order="<"))
    assert_closed(bad)
    pair.exchange()


FOREIGN = {
    "http": b"GET / HTTP/1.1\r\nHost: localhost\r\nUser-Agent: browser\r\n\r\n",
    "ssh": b"SSH-2.0-OpenSSH_9.2p1 Debian-2+deb12u2\r\n" + b"a" * 40,
    "zeros": bytes(28), "ones": b"\xff" * 28,
}


@pytest.mark.parametrize("text", FOREIGN.values(), ids=FOREIGN.keys())
def test_other_protocols_are_refused(text, stack, central, pair):
    """13.1: an HTTP request, zero bytes."""
    peer = stack.enter_context(Peer(central, "BROWSER"))
    peer.read_prelude()
    peer.send_bytes(text)
    assert_closed(peer)
    pair.exchange()


def test_a_protocol_error_is_logged_in_one_line_that_names_the_module(central, bad):
    """13.3: one log line naming module, host, reason and header."""
    before = len(central.output().splitlines())
    bad.send(Frame(QUERY, bad.look_up_id, alignment=1))
    assert_closed(bad)
    wait_until(lambda: any("BADPEER" in line and "badhost" in line
                           for line in central.output().splitlines()
                           if "Closing" not in line),
               "central names the module and its host")
    assert len(central.output().splitlines()) >= before


@pytest.mark.parametrize("intent", [-1, 0, 1, IMPOSSIBLE_ID, -IMPOSSIBLE_ID, -0x80000000])
@pytest.mark.parametrize("cls", [QUERY, INFORM, BROADCAST])
def test_message_ids_that_were_never_given_out_close_that_connection(cls, intent, bad, pair):
    """13.1, 13.3: an unknown message id is a protocol error."""
    bad.send(Frame(cls, intent, b"data", reference=9))
    assert_closed(bad)
    pair.exchange()


# -------------------------------------------------------------------- request data


NOTHING = b""
WRONG_DATA = {
    "no data": ("x_ipc_registerHandlerMsg", NOTHING),
    "no data in a query": ("x_ipc_moduleConnectedQ", NOTHING),
    "one byte": ("x_ipc_registerHandlerMsg", b"\1"),
    "string count beyond the data": ("x_ipc_notifyHandlerChange", struct.pack("<i", 1000) + b"x"),
    "string count below the data": ("x_ipc_notifyHandlerChange", struct.pack("<i", 1) + b"xyz"),
    "largest string count": ("x_ipc_moduleConnectedQ", struct.pack("<i", 0x7fffffff) + b"x"),
    "negative string count": ("x_ipc_moduleConnectedQ", struct.pack("<i", -1) + b"x"),
    "most negative string count": ("x_ipc_getNamedFormMsg",
                                   struct.pack("<i", -0x80000000) + b"x"),
    "empty string without filler": ("x_ipc_moduleConnectedQ", struct.pack("<i", 0)),
    "trailing bytes": ("x_ipc_classInfoMsg", struct.pack("<ii", 4, 4)),
    "array count beyond the data": ("x_ipc_moduleProvides", struct.pack("<iii", 1, 1 << 30,
                                                                       1 << 30)),
    "negative array count": ("x_ipc_moduleProvides", struct.pack("<iii", 1, -1, -1)),
    "more used than there are": ("x_ipc_moduleProvides",
                                 codec.encode(messages.NAME_LIST, (5, 1, ["a"]))),
}


@pytest.mark.parametrize("name, data", WRONG_DATA.values(), ids=WRONG_DATA.keys())
def test_data_that_does_not_decode_closes_that_connection(name, data, bad, pair):
    """13.1, 13.3: counts and lengths within the data, no trailing bytes."""
    intent = bad.id_of(name)
    cls = messages.find(name).cls
    bad.send(Frame(cls, intent, data, reference=bad.next_reference()))
    if name == "x_ipc_moduleProvides" and data[4:8] == struct.pack("<i", 1):
        bad.is_closed(0.2 * SLOW)  # may be taken as a list of one
    else:
        assert_closed(bad)
    pair.exchange()


EMPTY_NAMES = {
    "definition": ("x_ipc_registerMessageMsg", (None, BROADCAST, None, None)),
    "subscription": ("x_ipc_registerHandlerMsg", (5, None, "HND")),
    "subscription without handler": ("x_ipc_registerHandlerMsg", (5, "M", None)),
    "unsubscription": ("x_ipc_deregisterHandlerMsg", (0, None, None)),
    "look-up": ("x_ipc_msgInfoMsg", (None, None)),
    "look-up for a handler": ("x_ipc_msgInfoMsg", (None, "HND")),
    "priority": ("ipc_setMsgPriority", (None, 5)),
    "module query": ("x_ipc_moduleConnectedQ", None),
    "named format": ("x_ipc_registerNamedFormMsg", (None, None)),
    "unnamed format": ("x_ipc_getNamedFormMsg", None),
    "resource": ("x_ipc_registerResourceMsg", (5, None)),
    "limit": ("x_ipc_limitPendingMsg", (None, None, 5)),
    "watch of handlers": ("x_ipc_notifyHandlerChange", None),
    "list of handlers": ("x_ipc_directMsgQuery", None),
    "direct port": ("x_ipc_directResMsg", (8000, None)),
    "variable": ("x_ipc_registerGlobalVar", (None, None)),
    "tap": ("x_ipc_tapMessage", (1, None, None)),
    "removed tap": ("x_ipc_removeTap", (1, None, None)),
    "tapped reference": ("x_ipc_tapReference", (1, (0, None), None)),
    "handler and resource": ("x_ipc_addHndToResourceMsg", (None, None)),
    "lock": ("x_ipc_lockResourceMsg", None),
    "lock of a module": ("x_ipc_lockModResourceMsg", (None, None)),
    "reservation": ("x_ipc_reserveResourceMsg", None),
    "reservation of a module": ("x_ipc_reserveModResourceMsg", (None, None)),
    "details": ("x_ipc_getMessageInfo", (None,)),
    "handler info": ("x_ipc_hndInfoMsg", (None, None)),
    "direct info": ("x_ipc_directInfoMsg", None),
    "ignored logging": ("x_ipc_ignoreLogging", None),
    "resumed logging": ("x_ipc_resumeLogging", None),
}


@pytest.mark.parametrize("name, value", EMPTY_NAMES.values(), ids=EMPTY_NAMES.keys())
def test_empty_names_are_ignored(name, value, bad, pair):
    """13.1, 13.3: names not empty; the request is ignored, or answered with nothing found."""
    message = messages.find(name)
    data = codec.encode(message.request, value)
    bad.send(Frame(message.cls, bad.id_of(name), data, reference=bad.next_reference()))
    assert_open(bad)
    pair.exchange()


def test_an_introduction_without_a_name_does_no_harm(stack, central, pair):
    """13.1."""
    peer = stack.enter_context(Peer(central, "nobody"))
    peer.read_prelude()
    peer.start_request("x_ipc_newModuleConnectMsg", (None, None))
    peer.is_closed(0.1 * SLOW)
    peer.close()
    pair.exchange()


STRANGE_NAMES = {
    "percent": "%s%n%s", "escape": "\x1b[2J", "high bytes": "\xff\xfe",
    **{f"{length} bytes": "n" * length for length in (100, 1024, 1025, 5000, 60000)},
}


@pytest.mark.parametrize("name", STRANGE_NAMES.values(), ids=STRANGE_NAMES.keys())
def test_strange_and_long_module_names_do_no_harm(name, stack, central, pair):
    """13.1, 13.3: names up to 1024 bytes; longer ones are refused."""
    peer = stack.enter_context(Peer(central, name))
    peer.read_prelude()
    peer.start_request("x_ipc_newModuleConnectMsg", (name, "robot"))
    if len(name) <= 1024:
        wait_until(lambda: pair.left.request("x_ipc_moduleConnectedQ", name) == 1, "it is known")
    else:
        peer.is_closed(0.1 * SLOW)
    peer.close()
    pair.exchange()
    wait_until(lambda: pair.left.request("x_ipc_moduleConnectedQ", name) == 0, "it is gone")


# ------------------------------------------------------------- acknowledgements


@pytest.mark.parametrize("cls", [SUCCESS, FAILURE, REPLY])
@pytest.mark.parametrize("dispatch", [0, 1, 12345, 0x7fffffff, -2, -0x80000000])
def test_answers_to_dispatches_that_do_not_exist_are_ignored(cls, dispatch, bad, pair):
    """13.1, 13.3: dispatch live and sent to this connection."""
    bad.send(Frame(cls, parent=dispatch, dispatch=dispatch, class_data=class_name("reason"),
                   data=codec.variable(b"data") if cls == REPLY else b""))
    if dispatch >= 0:
        assert_open(bad)
    else:
        bad.is_closed(0.1 * SLOW)
    pair.exchange()


@pytest.mark.parametrize("cls", [SUCCESS, FAILURE, REPLY])
def test_an_answer_without_class_data_does_no_harm(cls, bad, pair):
    """13.1: failure with dispatch -1 and no class data."""
    bad.send(Frame(cls))
    assert_open(bad)
    pair.exchange()


def test_nobody_can_acknowledge_anothers_dispatch(bad, pair, stack, central):
    """13.1, 13.3: the dispatch remains unfinished, and a forged reply is not relayed."""
    victim = stack.enter_context(Peer(central, "VICTIM")).connect()
    victim.define("V")
    victim.define("A")
    victim.subscribe("V", 5)
    victim.sync()
    reference = pair.left.query("V", b"one")
    pair.left.publish("V", b"two")
    pair.left.sync()
    first = victim.next_delivery()
    for cls in (SUCCESS, FAILURE, REPLY):
        bad.send(Frame(cls, parent=first.dispatch, dispatch=first.dispatch,
                       class_data=class_name("A"), data=codec.variable(b"\1\0\0\0")))
    expect_nothing(victim, bad)
    assert not pair.left.has_reply(reference)
    victim.respond_number(first, "A", 77)
    assert reply_number(pair.left.await_reply(reference)) == 77
    assert victim.next_delivery().content == b"two"


def test_a_second_acknowledgement_frees_nothing(bad, pair):
    """13.1: late and double acknowledgements occur in practice."""
    bad.define("B")
    bad.subscribe("B", 5)
    bad.sync()
    for number in range(3):
        pair.left.publish_number("B", number)
    pair.left.sync()
    first = bad.next_delivery()
    bad.acknowledge(first)
    second = bad.next_delivery()
    if second.dispatch != first.dispatch:
        bad.acknowledge(first)
        expect_nothing(bad)
    bad.acknowledge(second)
    assert bad.take_numbers(1) == [2]


# ------------------------------------------------------------------------ formats


BAD_FORMATS = {
    "unclosed": "{int, int", "unopened": "int}", "empty array": "[int:]", "no dimension": "[int]",
    "negative dimension": "[int:-5]", "huge dimension": "[int:99999999999999999999]",
    "dimension of zero": "{int, <int:0>}", "dimension beyond the structure": "{int, <int:7>}",
    "empty enum": "{enum}", "stars": "*" * 60000, "braces": "{" * 60000,
    "deep": "{" * 5000 + "int" + "}" * 5000, "nonsense": "\x01\xff@#$%^&",
    "overflowing product": "[int:65536,65536,65536,65536]", "lonely": "!", "comma": ",",
}


@pytest.mark.parametrize("kind", BAD_FORMATS)
def test_a_bad_format_spoils_only_its_own_message(kind, bad, pair):
    """13.1, 13.3: the message stays defined; its look-up reports kind 6."""
    name, text = f"bad format, {kind}", BAD_FORMATS[kind]
    bad.define(name, text)
    bad.subscribe(name, 5)
    bad.sync()
    found = pair.left.look_up(name)
    assert found and found.cls == BROADCAST
    assert found.wire == codec.parse(codec.VARIABLE)
    if kind in ("unclosed", "empty array", "no dimension", "empty enum", "stars", "braces"):
        assert found.content == ("bad",)
    pair.left.publish_number(name, 7)
    assert bad.take_numbers(1) == [7]


def test_a_wire_format_may_be_bad_as_well(bad, pair):
    """13.1."""
    bad.define("bad wire", "int", "{int, <byte:")
    bad.sync()
    assert pair.left.look_up("bad wire").wire == ("bad",)


def test_an_unknown_named_format_is_a_bad_format(bad, pair):
    """13.1: kind 6 alone and inside a structure."""
    bad.define("alone", "no_such_format")
    bad.define("inside", "{int, no_such_format, <no_such_format:1>}")
    bad.sync()
    assert pair.left.look_up("alone").content == ("bad",)
    assert pair.left.look_up("inside").cls == BROADCAST


RECURSIVE = {
    "directly": {"r1": "{int, r1}"},
    "indirectly": {"r2": "{int, r3}", "r3": "[r2:2]"},
    "through a pointer": {"r4": "{int, *r4}"},
    "through pointers": {"r5": "*r6", "r6": "{r5, r5}"},
    "itself alone": {"r7": "r7"},
    "growing": {f"g{n}": f"{{g{n + 1}, g{n + 1}, g{n + 1}, g{n + 1}}}" for n in range(20)}
    | {"g20": "int"},
}


@pytest.mark.parametrize("formats", RECURSIVE.values(), ids=RECURSIVE.keys())
def test_named_formats_that_contain_themselves_are_bad_formats(formats, bad, pair):
    """13.1, 13.3: depth and size bounded, no recursion except the self pointer."""
    for name, text in formats.items():
        bad.define_format(name, text)
    first = next(iter(formats))
    bad.define(f"uses {first}", first)
    bad.sync()
    assert pair.left.look_up(f"uses {first}").cls == BROADCAST
    assert bad.request("x_ipc_getNamedFormMsg", first) is not None
    pair.exchange()


# ------------------------------------------------------ requests that make no sense


STRANGE_REQUESTS = {
    "notification for an undefined message": ("x_ipc_notifyHandlerChange", "undefined"),
    "details of a message": ("x_ipc_getMessageInfo", ("to left",)),
    "details of an unknown message": ("x_ipc_getMessageInfo", ("unknown",)),
    "details of an internal message": ("x_ipc_getMessageInfo", ("x_ipc_waitMsg",)),
    "unlock": ("x_ipc_unlockResourceMsg", 5), "unlock of -1": ("x_ipc_unlockResourceMsg", -1),
    "class format for -1": ("x_ipc_classInfoMsg", -1),
    "class format for the largest": ("x_ipc_classInfoMsg", 0x7fffffff),
    "cancel of an unknown number": ("x_ipc_cancelReservationMsg", 12345),
    "cancel of -1": ("x_ipc_cancelReservationMsg", -1),
    "limit 0": ("x_ipc_limitPendingMsg", ("M", "BADPEER", 0)),
    "limit -5": ("x_ipc_limitPendingMsg", ("M", "BADPEER", -5)),
    "capacity -5": ("x_ipc_registerResourceMsg", (-5, "BADPEER")),
    "largest capacity": ("x_ipc_registerResourceMsg", (0x7fffffff, "BADPEER")),
    "priority -5": ("ipc_setMsgPriority", ("M", -5)),
    "unknown handler": ("x_ipc_addHndToResourceMsg", ("no handler", "BADPEER")),
    "unknown resource": ("x_ipc_addHndToResourceMsg", ("HND-x", "no resource")),
    "lock of an unknown resource": ("x_ipc_lockResourceMsg", "no resource"),
    "lock of an unknown module": ("x_ipc_lockModResourceMsg", ("no module", "no resource")),
    "reservation of an unknown resource": ("x_ipc_reserveResourceMsg", "no resource"),
    "reservation of an unknown module": ("x_ipc_reserveModResourceMsg", ("nobody", "nothing")),
    "variable with another format": ("x_ipc_registerGlobalVar", (messages.BROADCASTS, "int")),
    "unsubscription of nothing": ("x_ipc_deregisterHandlerMsg", (0, "M", "no handler")),
    "handler id -1": ("x_ipc_registerHandlerMsg", (-1, "M", "HND-minus")),
    "handler id -4": ("x_ipc_registerHandlerMsg", (-4, "M", "HND-minus-four")),
    "port of another module": ("x_ipc_directResMsg", (1, "LEFT")),
    "impossible port": ("x_ipc_directResMsg", (-99999, "BADPEER")),
    "class of a definition": ("x_ipc_registerMessageMsg", ("strange", 77, None, None)),
    "tap of nothing": ("x_ipc_tapMessage", (1, "nothing", "nowhere")),
    "tap condition": ("x_ipc_tapMessage", (99, "to left", "nowhere")),
    "tap of the tap": ("x_ipc_tapMessage", (1, "loop", "loop")),
    "removed tap": ("x_ipc_removeTap", (1, "nothing", "nowhere")),
    "tapped reference": ("x_ipc_tapReference", (1, (77, "nothing"), "nowhere")),
    "search for a tapped reference": ("x_ipc_findTappedReference", 77),
    "unknown direct info": ("x_ipc_directInfoMsg", "nothing"),
    "unknown handler info": ("x_ipc_hndInfoMsg", ("nothing", None)),
    "all messages": ("x_ipc_getMessages", None),
    "all resources": ("x_ipc_available", None),
}


@pytest.mark.parametrize("name, value", STRANGE_REQUESTS.values(), ids=STRANGE_REQUESTS.keys())
def test_requests_that_make_no_sense_do_no_harm(name, value, bad, pair):
    """13.1: answered, or ignored with a log line."""
    if name in ("x_ipc_getMessageInfo", "x_ipc_getMessages", "x_ipc_available",
                "x_ipc_classInfoMsg"):
        bad.await_reply(bad.start_request(name, value))
    elif messages.find(name).cls == QUERY:
        bad.start_request(name, value)
    else:
        bad.notice(name, value)
    assert_open(bad)
    pair.exchange()


def test_a_module_may_require_what_nobody_provides(stack, central, pair):
    """4.3: it waits until somebody provides it."""
    peer = stack.enter_context(Peer(central, "NEEDY"))
    peer.read_prelude()
    peer.introduce()
    peer.notice("x_ipc_moduleRequires", messages.name_list(["rare resource"]))
    waiting = peer.start_request("x_ipc_waitMsg")
    peer.sync()
    assert not peer.has_reply(waiting)
    pair.left.notice("x_ipc_moduleProvides", messages.name_list(["rare resource"]))
    assert peer.finish_request(waiting, "x_ipc_waitMsg") is not None


def test_a_lock_is_released_when_its_holder_ends(stack, central, pair):
    """4.3, central section 7 row 19: nothing is delivered until unlocked."""
    receiver, holder = (stack.enter_context(Peer(central, name)).connect()
                        for name in ("LOCKED", "HOLDER"))
    receiver.define("L")
    receiver.subscribe("L", 5)
    receiver.sync()
    number = holder.request("x_ipc_lockResourceMsg", "LOCKED")
    assert number is not None and number != -1
    pair.left.publish_number("L", 1)
    expect_nothing(receiver, pair.left)
    holder.notice("x_ipc_unlockResourceMsg", number)
    assert receiver.take_numbers(1) == [1]
    assert holder.request("x_ipc_lockResourceMsg", "LOCKED") != -1
    pair.left.publish_number("L", 2)
    expect_nothing(receiver, pair.left)
    holder.close()
    assert receiver.take_numbers(1) == [2]


@pytest.mark.parametrize("name", ["x_ipc_msgInfoMsg", "x_ipc_waitMsg", "x_ipc_CloseMsg",
                                  "waitMsg", "ipc_setMsgPriority", "X_IPC_CLASSINFOMSG",
                                  "V_get_" + messages.BROADCASTS, messages.WATCH_BROADCASTS])
def test_internal_messages_cannot_be_redefined(name, bad, pair, stack, central):
    """13.1, 13.3: no control of internal names by definitions."""
    before = pair.left.look_up(name)
    bad.define(name, "{int, string}", "[byte:3]")
    bad.sync()
    assert pair.left.look_up(name) == before
    stack.enter_context(Peer(central, "NEW")).connect()
    pair.exchange()


@pytest.mark.parametrize("name", ["x_ipc_msgInfoMsg", "x_ipc_waitMsg", "x_ipc_CloseMsg",
                                  "newModuleConnectMsg", "V_set_" + messages.BROADCASTS])
def test_internal_messages_cannot_be_subscribed_to(name, bad, pair, stack, central):
    """13.1: other modules' requests still go to central."""
    bad.subscribe(name, 5)
    bad.sync()
    with Peer(central, "NEW") as new:
        new.connect()
        new.say_goodbye()
        assert new.is_closed()
    expect_nothing(bad, pair.left)
    pair.exchange()


MISUSED = {
    "broadcast of a query": (BROADCAST, "x_ipc_msgInfoMsg",
                             codec.encode("{string, string}", ("x_ipc_waitMsg", None))),
    "inform of a query": (INFORM, "x_ipc_msgInfoMsg",
                          codec.encode("{string, string}", ("x_ipc_waitMsg", None))),
    "query of an inform": (QUERY, "x_ipc_ignoreLogging", codec.encode("string", "nothing")),
    "forged notice": (BROADCAST, "x_ipc_connectNotify", codec.encode("string", "nobody")),
    "query of a notice": (QUERY, "x_ipc_disconnectNotify", codec.encode("string", "nobody")),
    "forged update": (BROADCAST, messages.WATCH_BROADCASTS, b"not a list"),
}


@pytest.mark.parametrize("cls, name, data", MISUSED.values(), ids=MISUSED.keys())
def test_library_messages_of_the_wrong_class_do_no_harm(cls, name, data, bad, pair):
    """13.1: an inform sent to a query message, a broadcast of an internal message, and the like."""
    bad.send(Frame(cls, bad.id_of(name), data, reference=bad.next_reference()))
    bad.is_closed(0.05 * SLOW)
    pair.exchange()


def test_requests_before_the_introduction_do_no_harm(stack, central, pair):
    """13.3, 16.4: look-ups and class formats may come before the introduction, nothing else."""
    for name, value in (("x_ipc_registerHandlerMsg", (5, "to left", "HND-early")),
                        ("x_ipc_registerMessageMsg", ("early", BROADCAST, None, None)),
                        ("x_ipc_CloseMsg", None), ("x_ipc_waitMsg", None),
                        ("ipc_setMsgPriority", ("to left", 5))):
        peer = stack.enter_context(Peer(central, "EARLY"))
        peer.read_prelude()
        assert peer.request("x_ipc_classInfoMsg", 2)
        message = messages.find(name)
        peer.send(Frame(message.cls, peer.id_of(name), codec.encode(message.request, value),
                        reference=peer.next_reference()))
        peer.is_closed(0.05 * SLOW)
    assert pair.left.look_up("early") is None
    pair.exchange()


# ------------------------------------------------------------------------- numbers


def test_more_than_a_thousand_connections_are_served(stack, central, pair):
    """13.1: no limit but that of the process."""
    count = 1100
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < 2 * count:
        pytest.skip(f"only {hard} descriptors are allowed")
    soft = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, 2 * count), hard))
    idle = [stack.enter_context(Peer(central, f"IDLE{number}")) for number in range(count)]
    for peer in idle:
        peer.read_prelude()
    idle[-1].introduce()
    idle[-1].ready()
    pair.exchange(10)
    for peer in idle:
        peer.close()
    pair.exchange(10)


def test_a_subscriber_that_does_not_read_holds_nobody_up(stack, central, pair):
    """13.1: large capacity, socket buffer full; when it reads at last it gets everything in
    order."""
    lazy, sender = (stack.enter_context(Peer(central, name)).connect()
                    for name in ("LAZY", "SENDER"))
    lazy.set_capacity(100000)
    lazy.subscribe("big", 5)
    lazy.sync()
    sender.define("big", None)
    count, size = 1000, 20000
    for number in range(count):
        sender.publish("big", struct.pack("<i", number) * (size // 4))
        if number % 100 == 0:
            pair.exchange(1)
    sender.sync()
    pair.exchange(10)
    for number in range(count):
        content = lazy.next_delivery().content
        assert content == struct.pack("<i", number) * (size // 4)


def test_a_subscriber_that_does_not_read_one_large_message_holds_nobody_up(stack, central, pair):
    """Central section 7, row 2: one message larger than the socket buffers."""
    lazy, sender = (stack.enter_context(Peer(central, name)).connect()
                    for name in ("LAZY", "SENDER"))
    lazy.subscribe("large", 5)
    lazy.sync()
    sender.define("large", None)
    content = bytes(8 << 20)
    sender.publish("large", content)
    sender.publish("large", b"after")
    sender.sync()
    pair.exchange(10)
    assert [d.content for d in lazy.take(2)] == [content, b"after"]


# -------------------------------------------------------------------- random input


@pytest.mark.parametrize("seed", range(4))
def test_random_bytes_do_no_harm(seed, central, pair):
    """13.1: random strings of 28 to 500 bytes."""
    generator = random.Random(seed)
    for _ in range(60):
        with Peer(central, "RANDOM") as peer:
            try:
                peer.send_bytes(generator.randbytes(generator.randrange(28, 500)))
            except OSError:
                pass
    pair.exchange()


@pytest.mark.parametrize("seed", range(8))
def test_damaged_requests_do_no_harm(seed, central, pair):
    """13.1: real requests with one to three bytes changed, lengths kept plausible."""
    generator = random.Random(seed)
    names = sorted(messages.LIBRARY)
    values = {"{string, string}": ("to left", "HND"), "string": "to left", "int": 3,
              "{int, string, string}": (5, "to left", "HND"), "{int, string}": (3, "DAMAGED"),
              "{string, int, string, string}": ("to left", 15, "int", "int"),
              "{string, string, int}": ("to left", "DAMAGED", 3), "{string, int}": ("to left", 3),
              "{string}": ("to left",), messages.NAME_LIST: messages.name_list(["a", "b"]),
              "{int, X_IPC_REF_PTR, string}": (1, (3, "to left"), "x"), None: None}
    skipped = ("x_ipc_CloseMsg", "x_ipc_lockModResourceMsg", "x_ipc_reserveModResourceMsg",
               "x_ipc_reserveResourceMsg", "x_ipc_lockResourceMsg")
    for _ in range(40):
        with Peer(central, "DAMAGED") as peer:
            peer.connect()
            name = generator.choice([n for n in names if n not in skipped])
            message = messages.LIBRARY[name]
            frame = bytearray(Frame(message.cls, peer.id_of(name),
                                    codec.encode(message.request, values[message.request]),
                                    reference=99).pack())
            for _ in range(generator.randrange(1, 4)):
                position = generator.randrange(8, len(frame))
                frame[position] = generator.choice((0, 1, 0x7f, 0x80, 0xff,
                                                    generator.randrange(256)))
            peer.send_bytes(frame)
            try:
                peer.socket.shutdown(socket.SHUT_WR)
            except OSError:
                pass
            peer.is_closed(0.5 * SLOW)
    pair.exchange()
