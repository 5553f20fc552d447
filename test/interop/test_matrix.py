"""Ours and theirs in every combination: first module, second module, central between them."""
import struct

import pytest

from support.driver import data_in, messages_in, replies_in, texts_in
from support.waiting import SLOW, wait_until


def settle(*drivers):
    """Lets modules take in updates of the list of subscribed messages, which originals need to
    publish.

    A round trip first, so that central has handled everything the module has sent.
    """
    for driver in drivers:
        driver.do("is_defined", "settled")
    for driver in drivers:
        driver.do("listen_clear", 25)


def test_raw_messages_of_all_lengths(pair):
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


@pytest.mark.parametrize("fmt, words, printed", [
    ("int", ["int", -5], "-5"), ("string", ["string", "hello there"], '"hello there"'),
    ("double", ["double", 2.5], "2.50"), ("long", ["long", 5_000_000_000], "5000000000"),
    ("{int, double, string}", ["sample", 7, 1.25, "abc"], '{7, 1.25, "abc"}'),
    ("{int, <int:1>}", ["numbers", 3, 1, 4, 1, 5], "{5, <3, 1, 4, 1, 5>}"),
    ("{int, *!}", ["list", 1, 2, 3], "{1, *{2, *{3, NULL}}}")])
def test_data_of_all_kinds(fmt, words, printed, pair):
    """Marshalled by one library, unmarshalled and printed by the other."""
    first, second = pair
    first.must("define", "M", "variable", fmt)
    first.do("is_defined", "M")
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", *words)
    assert data_in(second.gather(1)) == [printed]
    second.must("publish_data", "M", *words)
    assert data_in(second.gather(1)) == [printed]


def test_named_formats_are_shared(pair):
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


def test_a_hundred_messages_arrive_in_order(pair):
    """Numbered messages with capacity 1, after a first one."""
    first, second = pair
    first.must("define", "M", "variable")
    second.must("subscribe", "M", 0, "sequence")
    settle(second, first)
    first.must("burst", "M", 1, 100, 1)
    second.gather(1)
    first.must("burst", "M", 100, 100, 1, 1)
    second.gather(100)
    assert second.do("report", "M").result == "101 0 0"


def test_large_messages(pair):
    """One mebibyte."""
    first, second = pair
    first.must("define", "M", "variable")
    second.must("subscribe", "M", 0, "sequence")
    settle(second, first)
    second.start("until", 3, 20000)
    first.must("burst", "M", 3, 1 << 20, 1, seconds=20 * SLOW)
    assert second.finish(25 * SLOW).result == "OK"
    received, _, corrupt = second.do("report", "M").result.split()
    assert (received, corrupt) == ("3", "0")


def test_queries_in_both_directions(pair):
    """IPC_queryResponseData and IPC_queryNotifyData, IPC_respondData."""
    for asker, server in (pair, pair[::-1]):
        question, answer = f"Q{server.name}", f"A{server.name}"
        server.must("define", question, "variable", "int")
        server.must("define", answer, "variable", "int")
        server.must("subscribe", question, 0, "double", answer)
        settle(server)
        asker.start("query_data", question, answer, 5000, "int", 21)
        server.gather(1)
        assert asker.finish().reply == "42"
        asker.must("notify_data", question, "tag", "int", 30)
        server.gather(1)
        assert replies_in(asker.gather(1)) == [("tag", answer, "60")]


def test_a_delayed_response(pair):
    """IPC_delayResponse; the slot is taken until the response."""
    first, second = pair
    second.must("define", "Q", "variable", "int")
    second.must("define", "A", "variable", "int")
    second.must("define", "EV", "variable")
    second.must("subscribe", "Q", 0, "delay")
    second.must("subscribe", "EV", 1)
    settle(second, first)
    first.must("notify_data", "Q", "late", "int", 1)
    second.gather(1)
    first.must("publish", "EV", "event")
    first.do("is_defined", "x")
    assert second.do("listen", 50).events == []
    second.must("respond_data", "A", "int", 99)
    assert replies_in(first.gather(1)) == [("late", "A", "99")]
    assert texts_in(second.gather(1)) == ["event"]


def test_a_query_before_there_is_a_server(pair):
    """It waits in central; something else wakes the original central up."""
    first, second = pair
    first.must("define", "Q", "variable", "int")
    first.must("define", "A", "variable", "int")
    first.must("define", "X", "variable")
    first.must("notify_data", "Q", "early", "int", 4)
    first.do("is_defined", "x")
    second.must("subscribe", "X", 1)
    second.must("subscribe", "Q", 0, "double", "A")
    settle(second, first)
    first.must("publish", "X", "wake up")
    second.gather(2)
    assert replies_in(first.gather(1)) == [("early", "A", "8")]


def test_notices_of_modules_and_handlers(pair, start_driver, mix):
    """Who connects, who leaves, who subscribes."""
    watcher, other = pair
    watcher.must("watch_connect")
    watcher.must("watch_disconnect")
    watcher.must("define", "M", "variable")
    watcher.must("watch_handlers", "M")
    settle(watcher)
    assert watcher.do("module_connected", "SECOND").result == "1"
    assert watcher.do("handlers", "M").result == "0"
    other.must("subscribe", "M")
    assert "handlers M 1" in watcher.gather(1)
    assert watcher.do("handlers", "M").result == "1"
    other.must("unsubscribe", "M")
    assert "handlers M 0" in watcher.gather(1)
    assert other.leave() == 0
    assert "disconnected SECOND" in watcher.gather(1)
    assert watcher.do("module_connected", "SECOND").result == "0"


@pytest.mark.parametrize("capacity, limit, expected", [(1, 2, [0, 6, 7]), (1, 1, [0, 7])])
def test_queue_limits(capacity, limit, expected, pair):
    """Eight messages while the subscriber does not listen."""
    first, second = pair
    first.must("define", "M", "variable", "int")
    second.must("subscribe", "M")
    second.must("capacity", capacity)
    second.must("limit", "M", limit)
    settle(second, first)
    for number in range(8):
        first.must("publish_data", "M", "int", number)
    first.do("is_defined", "x")
    contents = [content for _, _, content in messages_in(second.gather(len(expected)))]
    assert contents == [struct.pack("<i", number) for number in expected]


def test_priorities(pair):
    """hi 10, mid 5, lo unset; capacity 1."""
    first, second = pair
    for name in ("hi", "mid", "lo"):
        first.must("define", name, "variable")
        second.must("subscribe", name)
    second.must("priority", "hi", 10)
    second.must("priority", "mid", 5)
    settle(second, first)
    for text in "lo0 lo1 hi0 mid0 lo2 hi1 mid1".split():
        first.must("publish", text[:-1], text)
    first.do("is_defined", "x")
    assert texts_in(second.gather(7)) == "lo0 hi0 hi1 mid0 mid1 lo1 lo2".split()


def test_a_no_listen_publisher(mix, mixed_central, start_driver):
    """IPC_connectModuleNoListen: sends whether or not anybody subscribes."""
    central = mixed_central()
    first = start_driver("FIRST", using=mix.first).connect(central.address, listen=False)
    second = start_driver("SECOND", using=mix.second).connect(central.address)
    first.must("define", "M", "variable")
    first.must("publish", "M", "lost")
    first.do("is_defined", "M")
    second.must("subscribe", "M")
    settle(second)
    first.must("publish", "M", "found")
    assert texts_in(second.gather(1)) == ["found"]


def test_two_handlers_of_one_message(pair):
    """Both are called, in order of subscription."""
    first, second = pair
    first.must("define", "M", "variable")
    second.must("subscribe", "M", 1)
    second.must("subscribe", "M", 0)
    settle(second, first)
    first.must("publish", "M", "text")
    assert [handler for handler, _, _ in messages_in(second.gather(2))] == [1, 0]


def test_the_abrupt_death_of_a_subscriber(pair):
    """The other learns of it, and goes on."""
    first, second = pair
    first.must("define", "M", "variable")
    first.must("watch_disconnect")
    second.must("subscribe", "M", 0, "kill")
    settle(second, first)
    first.must("publish", "M", "last words")
    first.do("is_defined", "x")
    second.start("listen", 5000)
    assert first.gather(1) == ["disconnected SECOND"]
    assert second.wait() == -9
    first.must("subscribe", "M")
    settle(first)
    first.must("publish", "M", "to myself")
    assert texts_in(first.gather(1)) == ["to myself"]


def test_a_module_may_leave_and_come_back(pair):
    """Definitions survive, subscriptions do not."""
    first, second = pair
    first.must("define", "M", "variable", "int")
    second.must("subscribe_data", "M")
    settle(second, first)
    address = [word for word in second.output().split() if word.isdigit()][-1]
    second.must("disconnect")
    wait_until(lambda: first.do("module_connected", "SECOND").result == "0", "SECOND is gone")
    assert first.do("handlers", "M").result == "0"
    second.connect(f"localhost:{address}")
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", "int", 6)
    assert data_in(second.gather(1)) == ["6"]


def test_messages_to_oneself(pair):
    """Each module is among the receivers of its own message."""
    for driver in pair:
        name = f"self{driver.name}"
        driver.must("define", name, "variable", "int")
        driver.must("subscribe_data", name)
        settle(driver)
        driver.must("publish_data", name, "int", 3)
        assert data_in(driver.gather(1)) == ["3"]


# --------------------------------------------------------------------- direct mode


@pytest.fixture
def direct_pair(mix, mixed_central, start_driver):
    """The same pair under a central that was started with -c."""
    central = mixed_central("-c")
    return tuple(start_driver(name, using=library).connect(central.address)
                 for name, library in (("FIRST", mix.first), ("SECOND", mix.second)))


def test_direct_publishing(direct_pair):
    """Requirements 38-40: module to module, in order."""
    first, second = direct_pair
    first.must("define", "M", "variable", "int")
    first.do("is_defined", "M")
    second.must("subscribe_data", "M")
    settle(second, first)
    for number in range(5):
        first.must("publish_data", "M", "int", number)
        assert data_in(second.gather(1)) == [str(number)]


def test_a_direct_query(direct_pair):
    """Requirements 38-40: the reply comes on the same socket."""
    first, second = direct_pair
    second.must("define", "Q", "variable", "int")
    second.must("define", "A", "variable", "int")
    second.must("subscribe", "Q", 0, "double", "A")
    settle(second, first)
    for number in (21, 30):
        first.must("notify_data", "Q", "tag", "int", number)
        second.gather(1)
        assert replies_in(first.gather(1)) == [("tag", "A", str(2 * number))]


def test_a_publisher_outlives_the_end_of_a_direct_subscriber(direct_pair):
    """Requirement 42."""
    first, second = direct_pair
    first.must("define", "M", "variable", "int")
    first.do("is_defined", "M")
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", "int", 1)
    second.gather(1)
    assert second.leave() == 0
    settle(first)
    first.must("publish_data", "M", "int", 2)
    assert first.do("is_connected").result == "1"
