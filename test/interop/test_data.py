"""What messages carry, in every mix of ours and theirs: bytes and data of all kinds and lengths."""
import pytest

from support.driver import data_in, messages_in
from support.waiting import SLOW

KINDS = {
    "int": ("int", ["int", -5], "-5"),
    "long": ("long", ["long", 5_000_000_000], "5000000000"),
    "double": ("double", ["double", 2.5], "2.50"),
    "string": ("string", ["string", "hello there"], '"hello there"'),
    "empty string": ("string", ["string", ""], '"NULL"'),
    "struct": ("{int, double, string}", ["sample", 7, 1.25, "abc"], '{7, 1.25, "abc"}'),
    "struct in struct": ("{int, {int, double, string}, [int:3]}",
                         ["nested", 1, 2, 0.5, "inner", 4, 5, 6],
                         '{1, {2, 0.50, "inner"}, [4, 5, 6]}'),
    "array": ("{int, <int:1>}", ["numbers", 3, 1, 4, 1, 5], "{5, <3, 1, 4, 1, 5>}"),
    "empty array": ("{int, <int:1>}", ["numbers"], "{0, NULL}"),
    "strings": ("{int, <string:1>}", ["strings", "one", "two", "three"],
                '{3, <"one", "two", "three">}'),
    "list": ("{int, *!}", ["list", 1, 2, 3], "{1, *{2, *{3, NULL}}}"),
}


def test_raw_messages_of_all_lengths(pair, settle):
    """Variable, fixed and zero length, without a format."""
    first, second = pair
    for name, length in (("V", "variable"), ("F", 6), ("Z", 0)):
        second.must("define", name, length)
        second.must("subscribe", name)
    settle(second, first)
    first.must("publish", "V", "variable text")
    first.must("publish_fixed", "F", "fixed")
    first.must("publish", "Z")
    first.must("publish_bytes", "V", "00ff10")
    # Originals reverse what arrives together at first, so the order is not compared here.
    seen = messages_in(second.gather(4))
    assert sorted(seen) == sorted([(0, "V", b"variable text\0"), (0, "F", b"fixed\0"),
                                   (0, "Z", b""), (0, "V", b"\0\xff\x10")])


@pytest.mark.parametrize("kind", KINDS)
def test_data_of_all_kinds(kind, pair, settle):
    """Marshalled by one library, unmarshalled and printed by the other."""
    fmt, words, printed = KINDS[kind]
    first, second = pair
    first.must("define", "M", "variable", fmt)
    first.do("is_defined", "M")
    for receiver, sender in (pair, pair[::-1]):
        receiver.must("subscribe_data", "M")
        settle(receiver, sender)
        sender.must("publish_data", "M", *words)
        assert data_in(receiver.gather(1)) == [printed]
        receiver.must("unsubscribe_data", "M")
        settle(receiver, sender)


def test_data_of_fixed_length(pair, settle):
    """No length goes with them."""
    first, second = pair
    first.must("define", "M", 4, "int")
    first.do("is_defined", "M")
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", "int", 1234)
    assert data_in(second.gather(1)) == ["1234"]


def test_named_formats_are_shared(pair, settle):
    """Defined by one module, used by the other."""
    first, second = pair
    first.must("format", "number", "int")
    first.must("format", "sample", "{number, double, string}")
    first.must("define", "M", "variable", "sample")
    first.do("is_defined", "M")
    second.must("check_formats", "M", "sample")
    second.must("check_formats", "M", "{int, double, string}")
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", "sample", 1, 2.0, "three")
    assert data_in(second.gather(1)) == ['{1, 2.00, "three"}']


def test_a_hundred_messages_arrive_in_order(pair, settle):
    """Numbered messages with capacity 1, after a first one."""
    first, second = pair
    first.must("define", "M", "variable")
    second.must("subscribe", "M", 0, "sequence")
    settle(second, first)
    first.must("burst", "M", 1, 100, 1)
    second.gather(1)
    # In direct mode an original waits for the subscriber when the socket between them is full.
    second.start("until", 101, 5000 * SLOW)
    first.must("burst", "M", 100, 100, 1, 1)
    assert second.finish(10 * SLOW).result == "OK"
    assert second.do("report", "M").result == "101 0 0"


@pytest.mark.parametrize("size", [1 << 20, 20_000_000])
def test_large_messages(size, pair, settle):
    """Three at a time, with content that is checked."""
    first, second = pair
    first.must("define", "M", "variable")
    second.must("subscribe", "M", 0, "sequence")
    settle(second, first)
    second.start("until", 3, 20000 * SLOW)
    first.must("burst", "M", 3, size, 1, seconds=20 * SLOW)
    assert second.finish(25 * SLOW).result == "OK"
    received, _, corrupt = second.do("report", "M").result.split()
    assert (received, corrupt) == ("3", "0")
