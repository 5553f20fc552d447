"""Central's side of rendezvous, frames and handshake (requirements 1, 4-14)."""
import os
import socket
import stat
import struct

import pytest

from support import codec, messages
from support.frame import BROADCAST, Frame, QUERY
from support.peer import Peer, expect_nothing
from support.processes import Process
from support.waiting import TimedOut, wait_until

ORDERS = ["<", ">"]


# --------------------------------------------------------------------- rendezvous


def test_central_listens_on_a_tcp_port_and_on_the_unix_socket_of_that_number(central):
    """Requirement 1."""
    for unix in (False, True):
        with Peer(central, "M", unix=unix) as peer:
            peer.connect()
            assert peer.version[0] == 3


@pytest.mark.new_central("it makes the socket with mode 0777 & ~umask")
def test_the_unix_socket_is_open_to_every_user(central):
    """Section 1.1: a module of another user must be able to connect."""
    assert stat.S_IMODE(os.stat(central.unix_path).st_mode) == 0o777


def test_the_unix_socket_is_gone_when_central_has_ended(start_central):
    """Section 1.1: an orderly end removes the socket file."""
    central = start_central()
    assert os.path.exists(central.unix_path)
    central.stop()
    assert not os.path.exists(central.unix_path)


@pytest.mark.new_central("it removes the socket of the server that runs")
def test_a_second_central_on_the_port_fails_and_leaves_the_first_alone(central, central_program):
    """Section 1.1: never unlink a socket one has not bound."""
    with Process([central_program, f"-p{central.port}", "-u"]) as second:
        assert second.wait() == 1
        assert "Unable to start server, Is one already running?" in second.output()
    for unix in (False, True):
        with Peer(central, "M", unix=unix) as peer:
            peer.connect()


def test_central_announces_major_version_3(join):
    """Requirement 4: 3.9 by the original, 3.10 by ours."""
    version = join("M").version
    assert version[0] == 3 and version[1] >= 9


@pytest.mark.new_central("it announces 3.9")
def test_central_announces_minor_version_10(join):
    """Decision: the protocol version is 3.10."""
    assert join("M").version == (3, 10)


# ------------------------------------------------------------------------- frames


@pytest.mark.parametrize("unix", [False, True])
@pytest.mark.parametrize("piece", [1, 3, 27, 29])
def test_central_accepts_frames_in_pieces(unix, piece, stack, central):
    """Requirement 6."""
    receiver = stack.enter_context(Peer(central, "R")).connect()
    receiver.subscribe("M", 5)
    sender = stack.enter_context(Peer(central, "S", unix=unix, piece=piece)).connect()
    sender.define("M")
    for number in range(3):
        sender.publish_number("M", number)
    assert receiver.take_numbers(3) == [0, 1, 2]


def test_central_accepts_many_frames_at_once(join):
    """Requirement 6."""
    receiver, sender = join("R"), join("S")
    receiver.subscribe("M", 5)
    receiver.sync()
    sender.define("M")
    intent = sender.id_of("M")
    frames = [Frame(BROADCAST, intent, codec.variable(struct.pack("<i", number)),
                    reference=100 + number).pack() for number in range(500)]
    sender.send_bytes(b"".join(frames))
    assert receiver.take_numbers(500) == list(range(500))


@pytest.mark.parametrize("order", ORDERS)
def test_central_understands_requests_in_either_byte_order(order, join):
    """Requirement 7: the byte order of each frame is in its class word."""
    peer = join("M", order=order)
    peer.define("Msg", "{int, string}")
    found = peer.look_up("Msg")
    assert found.content == codec.parse("{int, string}")
    assert peer.request("x_ipc_moduleConnectedQ", "M") == 1
    assert peer.request("x_ipc_moduleConnectedQ", "nobody") == 0


@pytest.mark.parametrize("order, nibble", [("<", "<"), (">", ">")])
def test_central_keeps_class_and_data_order_of_a_publication(order, nibble, join):
    """Requirement 8: class words 0x2200000f and 0x2100000f: class data in central's order, data
    as it came."""
    receiver, sender = join("R"), join("S", order=order)
    receiver.subscribe("M", 5)
    receiver.sync()
    sender.define("M")
    sender.publish_number("M", 0x12345678)
    frame = receiver.next_delivery().frame
    assert (frame.cls, frame.order, frame.class_order) == (
        BROADCAST, nibble, receiver.central_order)
    assert frame.data == struct.pack(order + "iii", 4, 4, 0x12345678)
    assert frame.message_name() == "M"


def test_central_keeps_the_parent_of_a_publication(join):
    """Section 2.4: the parent of a delivery is that of the original frame."""
    receiver, sender = join("R"), join("S")
    receiver.subscribe("M", 5)
    receiver.sync()
    sender.define("M")
    sender.publish("M", b"data", parent=77)
    frame = receiver.next_delivery().frame
    assert (frame.parent, frame.dispatch) == (77, -1)


def test_replies_of_central_have_parent_0_dispatch_0_and_class_0(join):
    """Section 2.4."""
    peer = join("M")
    frame = peer.await_reply(peer.start_look_up("x_ipc_waitMsg"))
    assert (frame.cls, frame.parent, frame.dispatch, frame.intent) == (0, 0, 0, -4)
    assert frame.class_data == b"" and frame.order == peer.central_order


def test_central_accepts_any_filler_after_an_empty_string(join):
    """Requirement 9: an empty string is length 0 and one byte of any value."""
    peer = join("M")
    for filler in (b"\0", b"Z", b"\xff"):
        data = codec.encode("{string, string}", ("x_ipc_waitMsg", None), filler=filler)
        reference = peer.next_reference()
        peer.send(Frame(QUERY, peer.look_up_id, data, reference=reference))
        assert peer.finish_look_up(reference).name == "x_ipc_waitMsg"


def test_central_sends_one_filler_byte_after_an_empty_string(join):
    """Requirement 9."""
    peer = join("M")
    frame = peer.await_reply(peer.start_request("V_get_" + messages.TAPPED))
    assert codec.decode(messages.NAME_LIST, frame.data, frame.order)[0] == 0
    frame = peer.await_reply(peer.start_request("x_ipc_hndInfoMsg", ("unheard of", None)))
    assert codec.decode("{string, string}", frame.data, frame.order)[1] is None


def test_handler_id_0_and_dispatch_id_0_are_valid(join):
    """Requirement 10: only -1 means none."""
    receiver, sender = join("R"), join("S")
    receiver.subscribe("M", 0)
    receiver.sync()
    sender.define("M")
    seen = []
    for number in range(8):
        sender.publish_number("M", number)
        delivery = receiver.next_delivery()
        assert delivery.handler == 0
        assert delivery.number == number
        seen.append(delivery.dispatch)
        receiver.acknowledge(delivery)
    assert min(seen) >= 0


# ---------------------------------------------------------------------- handshake


@pytest.mark.parametrize("unix", [False, True])
def test_central_sends_its_prelude_without_waiting(unix, central):
    """Requirement 11: 137 bytes at accept."""
    with Peer(central, "M", unix=unix) as peer:
        raw = peer.read_raw(137)
        number = struct.unpack(">i", raw[:4])[0]
        assert number >= 2
        order, word = {0x22: ("<", 0x22000000), 0x11: (">", 0x11000000)}[raw[20]]
        assert raw[4:32] == struct.pack(">7i", 0, 24, 0, 0, word, 0, 0)
        assert codec.decode("format", raw[32:56], order) == codec.parse("{string, string}")
        assert raw[56:84] == struct.pack(">7i", 0, 53, 0, 0, word, 0, 0)
        assert codec.decode("format", raw[84:137], order) == codec.parse(messages.MESSAGE_INFO)
        with pytest.raises(TimedOut):
            peer.read_frame(0.05)


@pytest.mark.parametrize("listen", [True, False])
def test_central_answers_the_handshake_of_the_original_library(listen, stack, central):
    """Requirement 12: first and last column of 3.5."""
    peer = stack.enter_context(Peer(central, "M")).connect_as_original(listen=listen)
    assert not peer.direct


def test_central_announces_direct_mode_when_started_with_c(stack, start_central):
    """Requirement 12: middle column of 3.5."""
    peer = stack.enter_context(Peer(start_central("-c"), "M"))
    peer.read_prelude()
    peer.introduce()
    assert peer.direct
    peer.notice("x_ipc_directResMsg", (8000, "M"))
    peer.ready()
    peer.define("Q")
    assert peer.look_up("Q").id < 0
    assert peer.look_up("x_ipc_directMsgQuery").id > 0


@pytest.mark.parametrize("cls", range(17))
def test_central_answers_class_formats(cls, join):
    """Requirement 12: the formats of 2.3; nothing for classes without one."""
    answer = join("M").request("x_ipc_classInfoMsg", cls)
    expected = messages.CLASS_FORMATS.get(cls)
    assert answer == ((cls, codec.parse(expected)) if expected else None)


@pytest.mark.parametrize("name", sorted(messages.LIBRARY))
def test_central_describes_each_of_its_messages(name, join):
    """Requirement 12, section 4: class and formats of every library message, under both of its
    names."""
    message = messages.LIBRARY[name]
    peer = join("M")
    for known in filter(None, (name, message.alias)):
        found = peer.look_up(known)
        assert found, known
        assert found.id >= 2
        assert (found.name.lower(), found.cls) == (known.lower(), message.cls)
        assert found.wire == codec.parse(message.request)
        assert found.content == codec.parse(message.reply)


@pytest.mark.parametrize("variable, fmt", messages.VARIABLES.items())
def test_central_describes_and_answers_its_variables(variable, fmt, join):
    """Requirement 12, section 4.6: four messages for each variable, and a value to get."""
    peer = join("M")
    fmt = codec.parse(fmt)
    for prefix, cls, wire, content in (("V_set_", 6, fmt, None), ("V_get_", 3, None, fmt),
                                       ("V_get_set_", 3, fmt, fmt), ("V_watch_", 15, fmt, None)):
        found = peer.look_up(prefix + variable)
        assert (found.cls, found.wire, found.content) == (cls, wire, content), prefix
    assert peer.request("V_get_" + variable) is not None


def test_an_unknown_name_is_answered_with_one_zero_byte(join):
    """Requirement 12, section 3.2."""
    peer = join("M")
    for name in ("unheard of", "x_ipc_killTaskTree", "x_ipc_createRefMsg"):
        frame = peer.await_reply(peer.start_look_up(name))
        assert frame.data == b"\0"


def test_message_ids_are_at_least_2_and_stay(join):
    """Requirement 13: 300 messages, each looked up twice."""
    definer, asker = join("D"), join("A")
    names = [f"message{number}" for number in range(300)]
    for name in names:
        definer.define(name)
    definer.sync()
    first = [asker.finish_look_up(reference).id
             for reference in [asker.start_look_up(name) for name in names]]
    second = [definer.look_up(name).id for name in names]
    assert first == second
    assert len(set(first)) == 300
    assert min(first) >= 2


def test_nothing_is_delivered_before_the_module_is_ready(stack, central, join):
    """Requirement 14: deliveries wait until x_ipc_waitMsg has been answered."""
    sender = join("S")
    sender.define("M")
    early = stack.enter_context(Peer(central, "E"))
    early.read_prelude()
    early.introduce()
    early.subscribe("M", 5)
    early.sync()
    sender.publish_number("M", 1)
    expect_nothing(early, sender)
    early.ready()
    assert early.take_numbers(1) == [1]


def test_central_lets_nobody_start_before_so_many_modules_are_there(stack, start_central):
    """Requirement 14: `central 2`."""
    central = start_central("2")
    assert "Expecting 2 on port" in central.output()
    first, second = (stack.enter_context(Peer(central, name)) for name in ("A", "B"))
    for peer in (first, second):
        peer.read_prelude()
        peer.introduce()
    waiting = first.start_request("x_ipc_waitMsg")
    first.sync()
    assert not first.has_reply(waiting)
    second.ready()
    assert first.finish_request(waiting, "x_ipc_waitMsg") is not None
    # Later modules do not wait for a second group.
    stack.enter_context(Peer(central, "C")).connect()


def test_a_module_that_stops_waiting_no_longer_counts(stack, start_central):
    """Section 3.5: of two that are expected one waits and dies; the next one waits for another."""
    central = start_central("2")
    with Peer(central, "A") as dying:
        dying.read_prelude()
        dying.introduce()
        dying.start_request("x_ipc_waitMsg")
        dying.sync()
    second, third = (stack.enter_context(Peer(central, name)) for name in ("B", "C"))
    for peer in (second, third):
        peer.read_prelude()
        peer.introduce()
    wait_until(lambda: second.request("x_ipc_moduleConnectedQ", "A") == 0, "A is gone")
    waiting = second.start_request("x_ipc_waitMsg")
    second.sync()
    assert not second.has_reply(waiting)
    third.ready()
    assert second.finish_request(waiting, "x_ipc_waitMsg") is not None


def test_a_module_is_connected_from_its_introduction_to_its_end(stack, central, join):
    """Section 4.1: x_ipc_moduleConnectedQ, without regard to case; central counts as X_IPC
    Server."""
    observer = join("O")
    peer = stack.enter_context(Peer(central, "Robot"))
    peer.read_prelude()
    assert observer.request("x_ipc_moduleConnectedQ", "Robot") == 0
    peer.introduce()
    assert observer.request("x_ipc_moduleConnectedQ", "ROBOT") == 1
    assert observer.request("x_ipc_moduleConnectedQ", "X_IPC Server") == 1
    peer.close()
    wait_until(lambda: observer.request("x_ipc_moduleConnectedQ", "Robot") == 0, "it is gone")


@pytest.mark.parametrize("host", ["127.0.0.1", socket.gethostname()])
def test_central_listens_on_all_ipv4_interfaces(host, central):
    """Requirement 1, section 1.1."""
    try:
        connection = socket.create_connection((host, central.port), timeout=5)
    except socket.gaierror:
        pytest.skip(f"{host} has no address")
    with connection:
        assert len(connection.recv(4, socket.MSG_WAITALL)) == 4
