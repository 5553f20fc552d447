"""Central's limits, made small: what reaches one, and that it costs nobody else anything."""
import socket

import pytest

from support.frame import BROADCAST, Frame
from support.peer import Peer
from support.waiting import PATIENCE, SLOW

pytestmark = pytest.mark.new_central("it has no limits")


@pytest.fixture
def limited(start_central):
    """Starts a central with the limits that are given by name."""
    return lambda **limits: start_central(
        *(f"--limit-{name.replace('_', '-')}={value}" for name, value in limits.items()))


@pytest.fixture
def connect(stack):
    """Connects a hand-made module to a central."""
    return lambda central, name, **options: stack.enter_context(
        Peer(central, name, **options)).connect()


def publish_numbers(peer, count):
    for number in range(count):
        peer.publish_number("numbers", number)


def open_pair(central, connect, **sender_options):
    """A sender and a receiver that has just finished a delivery."""
    receiver, sender = connect(central, "RECEIVER"), connect(central, "SENDER", **sender_options)
    receiver.subscribe("numbers", 5)
    receiver.sync()
    sender.define("numbers", None)
    publish_numbers(sender, 1)
    assert receiver.take_numbers(1) == [0]
    receiver.sync()
    return sender, receiver


# ------------------------------------------------------------------------- patience


def test_who_does_not_introduce_itself_in_time_has_to_go(limited, stack, connect):
    """Design section 10, limit of 30 s: a connection without a name, silent or not."""
    central = limited(introduction_seconds=0.3)
    introduced = connect(central, "INTRODUCED")
    silent = stack.enter_context(Peer(central, "SILENT"))
    asking = stack.enter_context(Peer(central, "ASKING"))
    for peer in (silent, asking):
        peer.read_prelude()
    asking.look_up("x_ipc_waitMsg")
    assert silent.is_closed()
    assert asking.is_closed()
    central.wait_for_line("it has not introduced itself")
    introduced.sync()


def test_who_never_reads_its_answers_has_to_go(limited, connect):
    """Answers pile up beyond every measure for a while."""
    central = limited(unsent_bytes=1000, message_bytes=1000, stuck_seconds=0.2)
    deaf, other = connect(central, "DEAF"), connect(central, "OTHER")
    with pytest.raises(OSError):
        for _ in range(200_000):
            deaf.start_look_up("x_ipc_msgInfoMsg")
    central.wait_for_line("it does not read, and too much waits for it")
    other.sync()


# --------------------------------------------------------------------------- length


def test_a_longer_message_than_allowed_costs_the_connection(limited, connect):
    """The limit itself is allowed."""
    central = limited(message_bytes=1000)
    receiver = connect(central, "RECEIVER")
    receiver.subscribe("long", 5)
    receiver.sync()
    sender = connect(central, "SENDER")
    sender.define("long", None)
    for length in (1000, 1001):
        sender.send(Frame(BROADCAST, sender.id_of("long"), bytes(length),
                          reference=sender.next_reference()))
    assert len(receiver.take(1)[0].frame.data) == 1000
    assert sender.is_closed()
    receiver.sync()


# --------------------------------------------------------------------------- queues


@pytest.mark.parametrize("limits", [{"queue_messages": 50}, {"queue_bytes": 5000}],
                         ids=["messages", "bytes"])
@pytest.mark.parametrize("host", ["localhost", socket.gethostname()], ids=["tcp", "unix"])
def test_who_outpaces_a_working_receiver_waits_and_loses_nothing(limits, host, limited,
                                                                  start_driver):
    """A flood through a queue that holds a fraction of it, to two receivers of one publisher."""
    central = limited(progress_seconds=10 * PATIENCE, **limits)
    address = f"{host}:{central.port}"
    receivers = [start_driver(name).connect(address) for name in ("ONE", "TWO")]
    sender = start_driver("SENDER").connect(address)
    sender.must("define", "numbers", "variable")
    seconds = 30 * SLOW
    for receiver in receivers:
        receiver.must("subscribe", "numbers", 0, "sequence")
    sender.must("burst", "numbers", 1, 64, 1)
    for receiver in receivers:
        receiver.until(1)
        receiver.start("until", 5001, int(seconds * 1000))
    sender.must("burst", "numbers", 5000, 64, 1, 1, seconds=seconds)
    for receiver in receivers:
        assert receiver.finish(seconds + PATIENCE).result == "OK"
        assert receiver.do("report", "numbers").result == "5001 0 0"


def test_nobody_waits_for_a_receiver_that_has_stopped(limited, connect):
    """The newest messages are kept; the sender goes on after a moment."""
    central = limited(queue_messages=50, progress_seconds=0.2)
    sender, receiver = open_pair(central, connect)
    publish_numbers(sender, 1000)
    sender.sync()
    assert receiver.take_numbers(51) == [0, *range(950, 1000)]
    central.wait_for_line("the queue of RECEIVER is full: numbers of SENDER is dropped, the newest")


@pytest.mark.parametrize("unix", [False, True], ids=["tcp", "unix"])
def test_what_a_waiting_sender_has_sent_is_delivered_after_its_end(unix, limited, connect):
    """It publishes 560 messages, the last 60 of which stay in its socket at first, and goes."""
    central = limited(queue_messages=1000, progress_seconds=10 * PATIENCE)
    sender, receiver = open_pair(central, connect, unix=unix)
    publish_numbers(sender, 560)
    sender.close()
    if unix:  # with TCP the end comes in the line with everything else
        central.wait_for_line("Closing SENDER")
    assert receiver.take_numbers(560) == list(range(560))
    central.wait_for_line("Closing SENDER")


def test_a_sender_waits_for_its_receiver_only(limited, connect):
    """Others go on meanwhile, and so does the sender when the receiver ends."""
    central = limited(queue_messages=50, progress_seconds=10 * PATIENCE)
    sender, receiver = open_pair(central, connect)
    left, right = connect(central, "LEFT"), connect(central, "RIGHT")
    right.subscribe("other", 6)
    right.sync()
    left.define("other", "int")
    publish_numbers(sender, 500)
    waiting = sender.start_look_up("numbers")
    for number in range(100):
        left.publish_number("other", number)
        assert right.take_numbers(1) == [number]
    assert not sender.is_closed(0.05 * SLOW)
    assert not sender.has_reply(waiting)
    receiver.close()
    sender.finish_look_up(waiting)
