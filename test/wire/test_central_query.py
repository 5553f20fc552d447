"""Central's side of queries and responses (requirements 33-37)."""
import pytest

from support import codec
from support.frame import Frame, IS_REPLY, QUERY, REPLY, class_name
from support.peer import expect_nothing, reply_number
from support.waiting import wait_until


@pytest.fixture
def asker(join):
    """A module that asks Q; Q and its answer A are defined."""
    peer = join("ASKER")
    peer.define("Q")
    peer.define("A")
    return peer


@pytest.fixture
def server(join, asker):
    """A module that handles Q."""
    asker.sync()
    peer = join("SERVER")
    peer.subscribe("Q", 198)
    peer.sync()
    return peer


def assert_silent(peer, *others):
    """Asserts that neither a reply nor a delivery is on its way to peer."""
    expect_nothing(peer, *others)
    assert not any(peer.replies.values())


def test_a_query_reaches_the_handler_and_its_response_the_asker(asker, server):
    """Requirement 33: class data, data and class word as the server sent them, intent -4,
    reference of the query."""
    reference = asker.query_number("Q", 21)
    delivery = server.next_delivery()
    assert delivery.frame.cls == QUERY
    assert (delivery.handler, delivery.name, delivery.number) == (198, "Q", 21)
    server.respond_number(delivery, "A", 42)
    reply = asker.await_reply(reference)
    assert (reply.cls, reply.intent, reply.reference) == (REPLY, IS_REPLY, reference)
    assert (reply.parent, reply.dispatch) == (delivery.dispatch, delivery.dispatch)
    assert reply.message_name() == "A"
    assert reply_number(reply) == 42


def test_only_the_asker_gets_the_response(asker, server, join):
    """Requirement 33: not even subscribers of the response's message."""
    other = join("OTHER")
    other.subscribe("A", 5)
    other.sync()
    reference = asker.query_number("Q", 1)
    server.respond_number(server.next_delivery(), "A", 2)
    assert reply_number(asker.await_reply(reference)) == 2
    assert_silent(other, server)
    assert_silent(asker, server)


def test_a_handler_that_does_not_respond_leaves_the_asker_without_an_answer(asker, server):
    """Requirement 33: a reply without class data must never be sent to a user's query."""
    asker.query_number("Q", 1)
    server.acknowledge(server.next_delivery())
    assert_silent(asker, server)
    reference = asker.query_number("Q", 2)
    server.respond_number(server.next_delivery(), "A", 3)
    assert reply_number(asker.await_reply(reference)) == 3


def test_a_response_frees_the_slot(asker, server):
    """Section 6.1: the response is the acknowledgement."""
    references = [asker.query_number("Q", number) for number in range(5)]
    for number in range(5):
        delivery = server.next_delivery()
        assert delivery.number == number
        assert_silent(server, asker)
        server.respond_number(delivery, "A", number * 2)
    assert [reply_number(asker.await_reply(reference)) for reference in references] == [
        0, 2, 4, 6, 8]


def test_replies_may_come_in_any_order(asker, server):
    """Requirement 31, central's side: each reply has the reference of its query."""
    server.set_capacity(2)
    server.sync()
    first, second = (asker.query_number("Q", number) for number in (1, 2))
    held = [server.next_delivery() for _ in range(2)]
    server.respond_number(held[1], "A", 20)
    assert reply_number(asker.await_reply(second)) == 20
    assert not asker.has_reply(first)
    server.respond_number(held[0], "A", 10)
    assert reply_number(asker.await_reply(first)) == 10


def test_a_delayed_response_keeps_the_slot(asker, server):
    """Requirement 34: with capacity 1 the module gets nothing else until it has responded."""
    asker.define("EV")
    server.subscribe("EV", 197)
    server.sync()
    reference = asker.query_number("Q", 1)
    delivery = server.next_delivery()
    asker.publish_number("EV", 5)
    assert_silent(server, asker)
    frame = Frame(REPLY, dispatch=delivery.dispatch, class_data=class_name("A"),
                  data=codec.variable(b"\7\0\0\0"))
    assert frame.parent == -1
    server.send(frame)
    assert reply_number(asker.await_reply(reference)) == 7
    assert server.next_delivery().name == "EV"


def test_a_query_without_handler_waits_for_one(asker, join):
    """Requirement 35: it is delivered when a handler comes."""
    reference = asker.query_number("Q", 3)
    asker.sync()
    server = join("SERVER")
    server.define("X")
    server.subscribe("X", 1)
    server.subscribe("Q", 198)
    server.sync()
    # The original delivers it only after another delivery of the module has been finished.
    asker.publish_number("X", 0)
    by_name = {}
    while "Q" not in by_name:
        delivery = server.next_delivery()
        by_name[delivery.name] = delivery
        if delivery.name == "X":
            server.acknowledge(delivery)
        else:
            server.respond_number(delivery, "A", 6)
    assert reply_number(asker.await_reply(reference)) == 6


@pytest.mark.new_central("it waits for another acknowledgement of the module")
def test_waiting_queries_are_delivered_as_soon_as_a_handler_comes(asker, join):
    """Requirement 35, section 6.2: oldest first, without any other traffic."""
    references = [asker.query_number("Q", number) for number in range(3)]
    asker.sync()
    server = join("SERVER")
    server.subscribe("Q", 198)
    for number in range(3):
        delivery = server.next_delivery()
        assert delivery.number == number
        server.respond_number(delivery, "A", number + 10)
    assert [reply_number(asker.await_reply(r)) for r in references] == [10, 11, 12]


def test_publications_do_not_wait_with_a_query(asker, join):
    """Section 6.2: publications without handler are dropped."""
    asker.publish_number("Q", 1)
    asker.sync()
    server = join("SERVER")
    server.subscribe("Q", 198)
    server.sync()
    asker.publish_number("Q", 2)
    assert server.take_numbers(1) == [2]
    assert_silent(server, asker)


@pytest.mark.new_central("it counts the handlers of a waiting query and crashes")
def test_handlers_can_be_counted_while_a_query_waits(asker):
    """Section 6.2."""
    asker.query_number("Q", 1)
    assert asker.request("x_ipc_directMsgQuery", "Q") is None


@pytest.mark.new_central("it exits when the handlers have different names")
def test_exactly_one_of_several_handlers_gets_a_query(asker, server, join):
    """Requirement 36: the oldest one with a free slot, else the oldest."""
    second = join("SECOND")
    second.subscribe("Q", 20, "HND-another")
    second.sync()
    references = [asker.query_number("Q", number) for number in range(3)]
    asker.sync()
    first_query, second_query = server.next_delivery(), second.next_delivery()
    assert (first_query.number, second_query.number) == (0, 1)
    assert_silent(second, asker)
    second.respond_number(second_query, "A", 101)
    server.respond_number(first_query, "A", 100)
    third_query = server.next_delivery()
    server.respond_number(third_query, "A", 102)
    assert [reply_number(asker.await_reply(r)) for r in references] == [100, 101, 102]
    assert_silent(second, server)


def test_of_handlers_with_one_name_the_oldest_free_one_gets_the_query(asker, server, join):
    """Section 6.2."""
    second = join("SECOND")
    second.subscribe("Q", 20, "HND-Q1198")
    second.sync()
    first = asker.query_number("Q", 0)
    delivery = server.next_delivery()
    other = asker.query_number("Q", 1)
    overflow = second.next_delivery()
    assert (delivery.number, overflow.number) == (0, 1)
    second.respond_number(overflow, "A", 11)
    server.respond_number(delivery, "A", 10)
    assert reply_number(asker.await_reply(first)) == 10
    assert reply_number(asker.await_reply(other)) == 11


def test_a_response_of_a_dead_askers_query_is_dropped(asker, server, join):
    """Section 6.3: the response is accepted and frees the slot."""
    observer = join("OBSERVER")
    asker.query_number("Q", 1)
    delivery = server.next_delivery()
    asker.close()
    wait_until(lambda: observer.request("x_ipc_moduleConnectedQ", "ASKER") == 0, "asker is gone")
    server.respond_number(delivery, "A", 2)
    observer.publish_number("Q", 9)
    assert server.take_numbers(1) == [9]


def test_nothing_is_sent_to_the_asker_when_the_responder_dies(asker, server, join):
    """Section 6.3: the dispatch is dropped."""
    reference = asker.query_number("Q", 1)
    server.next_delivery()
    server.close()
    wait_until(lambda: asker.request("x_ipc_moduleConnectedQ", "SERVER") == 0, "server is gone")
    asker.sync()
    assert not asker.has_reply(reference)
    again = join("AGAIN")
    again.subscribe("Q", 3)
    again.sync()
    second = asker.query_number("Q", 2)
    delivery = again.next_delivery()
    assert delivery.number == 2
    again.respond_number(delivery, "A", 4)
    assert reply_number(asker.await_reply(second)) == 4


def test_a_module_may_query_itself(asker):
    """Section 6.3."""
    asker.subscribe("Q", 7)
    reference = asker.query_number("Q", 5)
    asker.respond_number(asker.next_delivery(), "A", 50)
    assert reply_number(asker.await_reply(reference)) == 50


def test_a_response_may_name_any_message_and_carry_either_byte_order(asker, join):
    """Requirement 33: class data, data and class word pass unchanged."""
    server = join("SERVER", order=">")
    server.subscribe("Q", 198)
    server.sync()
    reference = asker.query_number("Q", 1)
    server.respond_number(server.next_delivery(), "Some other Message", 0x01020304)
    reply = asker.await_reply(reference)
    assert (reply.order, reply.class_order) == (">", ">")
    assert reply.message_name() == "Some other Message"
    assert reply_number(reply) == 0x01020304


def test_many_queries_may_be_outstanding(asker, server):
    """Section 4.8 of central: several queries between the same two modules."""
    server.set_capacity(1000)
    server.sync()
    references = [asker.query_number("Q", number) for number in range(300)]
    for delivery in reversed([server.next_delivery() for _ in range(300)]):
        server.respond_number(delivery, "A", delivery.number + 1)
    assert [reply_number(asker.await_reply(r)) for r in references] == list(range(1, 301))
