"""Queries and their responses, in every mix of ours and theirs."""
import pytest

from support.driver import messages_in, replies_in, texts_in
from support.waiting import SLOW


@pytest.fixture
def ask(pair, settle):
    """(asker, answerer): the second module answers Q with A, both of format int."""
    def prepare(*action):
        asker, answerer = pair
        answerer.must("define", "Q", "variable", "int")
        answerer.must("define", "A", "variable", "int")
        answerer.must("subscribe", "Q", 0, *action)
        settle(answerer, asker)
        return asker, answerer
    return prepare


def test_queries_in_both_directions(pair, settle):
    """IPC_queryResponseData and IPC_queryNotifyData, IPC_respondData."""
    for asker, server in (pair, pair[::-1]):
        question, answer = f"Q{server.name}", f"A{server.name}"
        server.must("define", question, "variable", "int")
        server.must("define", answer, "variable", "int")
        server.must("subscribe", question, 0, "double", answer)
        settle(server, asker)
        asker.start("query_data", question, answer, 5000 * SLOW, "int", 21)
        server.gather(1)
        assert asker.finish().reply == "42"
        asker.must("notify_data", question, "tag", "int", 30)
        server.gather(1)
        assert replies_in(asker.gather(1)) == [("tag", answer, "60")]


def test_queries_of_bytes(pair, settle):
    """IPC_queryResponse and IPC_queryNotify, IPC_respond: messages without a format."""
    asker, answerer = pair
    answerer.must("define", "Q", "variable")
    answerer.must("define", "A", "variable")
    answerer.must("subscribe", "Q", 0, "echo", "A")
    settle(answerer, asker)
    asker.start("query", "Q", "what is it", 5000 * SLOW)
    assert messages_in(answerer.gather(1)) == [(0, "Q", b"what is it\0")]
    assert asker.finish().reply == "what is it"
    asker.must("notify", "Q", "and this", "tag")
    answerer.gather(1)
    assert replies_in(asker.gather(1)) == [("tag", "A", "and%20this")]


def test_a_query_to_oneself(pair, settle):
    """The handler runs while its own module waits."""
    for driver in pair:
        question, answer = f"Q{driver.name}", f"A{driver.name}"
        driver.must("define", question, "variable", "int")
        driver.must("define", answer, "variable", "int")
        driver.must("subscribe", question, 0, "double", answer)
        settle(driver)
        assert driver.must("query_data", question, answer, 5000 * SLOW, "int", 8).reply == "16"


def test_queries_follow_each_other(ask):
    """Many replies, each to its own query."""
    asker, answerer = ask("double", "A")
    for number in range(20):
        asker.start("query_data", "Q", "A", 5000 * SLOW, "int", number)
        answerer.gather(1)
        assert asker.finish().reply == str(2 * number)


def test_several_outstanding_queries(ask):
    """Replies come with the client data of their queries."""
    asker, answerer = ask("double", "A")
    asker.must("notify_data", "Q", "first", "int", 0)
    answerer.gather(1)
    asker.gather(1)
    for number in (1, 2, 3):
        asker.must("notify_data", "Q", f"tag{number}", "int", number)
    answerer.gather(3)
    assert sorted(replies_in(asker.gather(3))) == \
        [("tag1", "A", "2"), ("tag2", "A", "4"), ("tag3", "A", "6")]


def test_a_query_that_nobody_answers(pair):
    """It ends after its time."""
    asker, answerer = pair
    answerer.must("define", "Q", "variable", "int")
    answerer.must("define", "A", "variable", "int")
    answerer.do("is_defined", "Q")
    assert asker.do("query_data", "Q", "A", 100, "int", 1).result == "Timeout"
    assert asker.do("is_connected").result == "1"


def test_a_response_that_comes_too_late(ask):
    """It reaches nobody; the next query gets the response to itself."""
    asker, answerer = ask("delay")
    asker.start("query_data", "Q", "A", 100, "int", 1)
    answerer.gather(1)
    assert asker.finish().result == "Timeout"
    answerer.must("respond_data", "A", "int", 11)
    asker.start("query_data", "Q", "A", 5000 * SLOW, "int", 2)
    answerer.gather(1)
    answerer.must("respond_data", "A", "int", 22)
    assert asker.finish().reply == "22"


def test_a_delayed_response(ask, settle, way):
    """IPC_delayResponse; the slot is taken until the response, where there are slots."""
    asker, answerer = ask("delay")
    answerer.must("define", "EV", "variable")
    answerer.must("subscribe", "EV", 1)
    settle(answerer, asker)
    asker.must("notify_data", "Q", "late", "int", 1)
    answerer.gather(1)
    asker.must("publish", "EV", "event")
    asker.do("is_defined", "x")
    if way == "routed":
        assert answerer.do("listen", 50).events == []
    answerer.must("respond_data", "A", "int", 99)
    assert replies_in(asker.gather(1)) == [("late", "A", "99")]
    assert texts_in(answerer.gather(1)) == ["event"]


def test_a_query_before_there_is_a_server(pair, settle, mix, way):
    """It waits in central; something else wakes the original central up."""
    if way == "direct" and mix.central_is_original and mix.second.original:
        pytest.skip("an original central ends by the response of an original in direct mode to a "
                    "query that had to wait")
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


def test_a_query_with_two_subscribers(trio, settle, mix, way):
    """One of them answers."""
    if way == "routed" and mix.central_is_original:
        pytest.skip("an original central ends when a query has several subscribers")
    asker, second, third = trio
    asker.must("define", "Q", "variable", "int")
    asker.must("define", "A", "variable", "int")
    asker.do("is_defined", "A")
    for driver in (second, third):
        driver.must("subscribe", "Q", 0, "double", "A")
    settle(second, third, asker)
    asker.must("notify_data", "Q", "tag", "int", 5)
    # In direct mode an original asks all of them, and takes the response that comes first.
    asked = (second, third) if way == "direct" and mix.first.original else (second,)
    for driver in asked:
        driver.gather(1)
    assert replies_in(asker.gather(1)) == [("tag", "A", "10")]
    if len(asked) == 1:
        assert third.do("listen", 50).events == []
