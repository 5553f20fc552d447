"""Two modules and a central on machines that differ in byte order and in the size of long."""
import struct

import pytest

from cross.conftest import ORIGINAL
from support.driver import data_in, messages_in, replies_in

PART = "conversation"

#: Formats, and a value of each as IPC_printData() writes it.
VALUES = [
    ("{byte, ubyte, char, short, ushort, int}", "{0x12, 0xfe, c, -12345, 54321, -1234567890}"),
    ("{uint, float, double, string}", '{4123456789, 0.25, -1234567.50, "text"}'),
    ("[short:2,3]", "[[1, -2, 3], [-4, 5, -6]]"),
    ("{int, int, <double:1,2>}", "{2, 3, <<0.25, 1.50, -2.75>, <3.00, 4.25, -5.50>>}"),
    ("{byte, [{char, double}:2], short}", "{0x1, [{a, 1.50}, {b, -2.50}], -3}"),
    ("{int, <{short, string}:1>}", '{2, <{-1, "one"}, {-2, "two"}>}'),
    ("{*double, *{int, *!}}", "{*-0.50, *{1, *{258, *{-65537, NULL}}}}"),
    ("{enum red, green, blue}", "green"),
    ("{int, <byte:1>, ushort}", "{3, <0x1, 0x80, 0xff>, 513}"),
    ("{{int, byte}, [ushort:3], boolean}", "{{-2, 0x3}, [258, 772, 65535], True}"),
]


def settle(*modules):
    """Lets modules learn of each other's subscriptions, which an original needs to publish."""
    for module in modules:
        module.do("is_defined", "settled")
    for module in modules:
        module.do("listen_clear", 25)


def test_raw_bytes_stay_as_they_are(pair):
    first, second = pair
    first.must("define", "M", "variable")
    second.must("subscribe", "M")
    settle(second, first)
    first.must("publish_bytes", "M", "00010203ff10")
    assert messages_in(second.gather(1)) == [(0, "M", bytes.fromhex("00010203ff10"))]


def test_values_arrive_as_they_were_sent(pair, mix):
    """In both directions; the sender is among the receivers."""
    if ORIGINAL in mix:
        pytest.skip("an original cannot read values from text")
    for number, (fmt, text) in enumerate(VALUES):
        name = f"M{number}"
        pair[0].must("define", name, "variable", fmt)
        for module in pair:
            module.must("subscribe_data", name)
        for sender in pair:
            sender.must("publish_text", name, text)
            assert [data_in(module.gather(1)) for module in pair] == [[text], [text]], fmt


def test_a_named_format_of_one_is_used_by_the_other(pair):
    first, second = pair
    first.must("format", "sample", "{int, double, string}")
    first.must("define", "M", "variable", "sample")
    first.do("is_defined", "M")
    second.must("check_formats", "M", "sample")
    second.must("subscribe_data", "M")
    for sender in pair:
        settle(second, first)
        sender.must("publish_data", "M", "sample", -258, 0.5, "text")
        assert data_in(second.gather(1)) == ['{-258, 0.50, "text"}']


@pytest.mark.parametrize("way", ["routed", "direct"])
def test_queries_are_answered_in_both_directions(way, connect_pair, mix):
    pair = connect_pair(*["-c"] if way == "direct" else [])
    for asker, server in (pair, pair[::-1]):
        if way == "direct" and mix[1 + pair.index(asker)] == ORIGINAL:
            # With the reply at hand it asks central for the message, and reads the reply in the
            # byte order of what central says.
            continue
        question, answer = f"Q{server.name}", f"A{server.name}"
        server.must("define", question, "variable", "int")
        server.must("define", answer, "variable", "int")
        server.must("subscribe", question, 0, "double", answer)
        settle(server, asker)
        asker.must("notify_data", question, "tag", "int", -129)
        server.gather(1)
        assert replies_in(asker.gather(1)) == [("tag", answer, "-258")]


def test_notices_tell_who_subscribes_and_who_leaves(pair):
    watcher, other = pair
    watcher.must("watch_disconnect")
    watcher.must("define", "M", "variable")
    watcher.must("watch_handlers", "M")
    settle(watcher)
    other.must("subscribe", "M")
    assert "handlers M 1" in watcher.gather(1)
    assert watcher.do("handlers", "M").result == "1"
    other.must("unsubscribe", "M")
    assert "handlers M 0" in watcher.gather(1)
    assert other.leave() == 0
    assert "disconnected SECOND" in watcher.gather(1)


def what_arrives(number, sender, receiver):
    """What becomes of a long: its bytes are those of the sender, and as many are read as the
    receiver's has; one that ends too early is not delivered."""
    code = {4: "i", 8: "q"}
    sent = struct.pack(sender.order + code[sender.long_size], number)[:receiver.long_size]
    if len(sent) < receiver.long_size:
        return []
    return [str(struct.unpack(sender.order + code[receiver.long_size], sent)[0])]


def test_a_long_has_the_size_that_its_sender_gives_it(machines, pair, mix):
    """What cannot be read costs one message and nothing else."""
    sender, receiver, _ = machines
    if mix[2] == ORIGINAL and sender.long_size < receiver.long_size:
        pytest.skip("an original reads beyond the message")
    first, second = pair
    for name, fmt in (("LONG", "long"), ("INT", "int")):
        first.must("define", name, "variable", fmt)
        second.must("subscribe_data", name)
    settle(second, first)
    for number in (12345, -7, *([5_000_000_000] if sender.long_size == 8 else [])):
        first.must("publish_data", "LONG", "long", number)
        first.must("publish_data", "INT", "int", 42)
        wanted = [*what_arrives(number, sender, receiver), "42"]
        # An original may reverse the two.
        assert sorted(data_in(second.gather(len(wanted)))) == sorted(wanted)
