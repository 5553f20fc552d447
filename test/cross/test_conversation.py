"""Two modules and a central on machines that differ in byte order and in the size of long."""
import struct

import pytest

# The conversations that originals are mixed into; here the machines are mixed.
from interop.test_matrix import (  # noqa: F401
    settle, test_a_delayed_response, test_a_direct_query, test_direct_publishing,
    test_named_formats_are_shared, test_notices_of_modules_and_handlers, test_priorities,
    test_queries_in_both_directions, test_raw_messages_of_all_lengths)
from cross.conftest import ORIGINAL
from support.driver import data_in

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


def what_arrives(number, sender, receiver):
    """What becomes of a long: its bytes are those of the sender, and as many are read as the
    receiver's has; one that ends too early is not delivered."""
    sent = struct.pack(sender.order + " lq"[sender.long_size // 4], number)
    if len(sent) < receiver.long_size:
        return []
    return [str(struct.unpack(sender.order + " lq"[receiver.long_size // 4],
                              sent[:receiver.long_size])[0])]


@pytest.mark.parametrize("number", [12345, -7, 5_000_000_000])
def test_a_long_has_the_size_that_its_sender_gives_it(number, trio, pair):
    """What cannot be read costs one message and nothing else."""
    if number >= 1 << 31 and trio[0].long_size == 4:
        pytest.skip("its long cannot hold the number")
    first, second = pair
    for name, fmt in (("LONG", "long"), ("INT", "int")):
        first.must("define", name, "variable", fmt)
        second.must("subscribe_data", name)
    settle(second, first)
    first.must("publish_data", "LONG", "long", number)
    first.must("publish_data", "INT", "int", 42)
    wanted = [*what_arrives(number, *trio[:2]), "42"]
    assert data_in(second.gather(len(wanted))) == wanted
    if len(wanted) == 1:
        assert "LONG" in second.output()
