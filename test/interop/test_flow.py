"""Capacity, queue lengths and priorities, in every mix of ours and theirs."""
import pytest

from support.driver import texts_in


@pytest.mark.parametrize("capacity", [1, 3])
def test_capacity(capacity, pair, settle, way):
    """So many queries are handled at a time; in direct mode there is no limit."""
    asker, answerer = pair
    answerer.must("define", "Q", "variable", "int")
    answerer.must("define", "A", "variable", "int")
    answerer.must("capacity", capacity)
    answerer.must("subscribe", "Q", 0, "delay")
    settle(answerer, asker)
    for number in range(5):
        asker.must("notify_data", "Q", f"tag{number}", "int", number)
    asker.do("is_defined", "x")
    at_a_time = 5 if way == "direct" else capacity
    seen = len(answerer.gather(at_a_time))
    seen += len(answerer.do("listen", 50).events)
    assert seen == at_a_time
    for number in range(5):
        answerer.must("respond_data", "A", "int", 7)
        asker.gather(1)
        if at_a_time + number < 5:
            answerer.gather(1)


@pytest.mark.parametrize("limit, expected", [(2, ["6", "7"]), (1, ["7"])])
def test_queue_limits(limit, expected, pair, prime, way):
    """Eight messages while the subscriber does not listen; routed, the first one is on its way."""
    expected = ["0", *expected] if way == "routed" else expected
    first, second = pair
    first.must("define", "M", "variable")
    prime(first, second, "M")
    second.must("limit", "M", limit)
    second.do("is_defined", "x")
    for number in range(8):
        first.must("publish", "M", str(number))
    first.do("is_defined", "x")
    assert texts_in(second.gather(len(expected))) == expected


def test_priorities(pair, prime, way):
    """hi 10, mid 5, lo unset; routed, with capacity 1, the first one is on its way."""
    first, second = pair
    for name in ("hi", "mid", "lo"):
        first.must("define", name, "variable")
    prime(first, second, "hi", "mid", "lo")
    second.must("priority", "hi", 10)
    second.must("priority", "mid", 5)
    second.do("is_defined", "x")
    for text in "lo0 lo1 hi0 mid0 lo2 hi1 mid1".split():
        first.must("publish", text[:-1], text)
    first.do("is_defined", "x")
    expected = "lo0 hi0 hi1 mid0 mid1 lo1 lo2" if way == "routed" else \
        "hi0 hi1 mid0 mid1 lo0 lo1 lo2"
    assert texts_in(second.gather(7)) == expected.split()
