"""The library's side of publishing, subscribing and queries (requirements 7, 18, 19, 25, 26, 29,
31, 32)."""
import socket
import struct
import time

import pytest

from support import codec, messages
from support.driver import data_in, messages_in, replies_in, texts_in
from support.fake_central import FakeCentral
from support.frame import BROADCAST, INFORM, QUERY, REPLY


@pytest.fixture
def connection(driver, fake_central):
    """Central's end of the driver's connection."""
    return fake_central.connection()


# ------------------------------------------------------------------------- publish


@pytest.mark.parametrize("length, content, data", [
    ("variable", "abc", codec.variable(b"abc\0")), (4, "abc", b"abc\0"), (0, None, b"")],
                         ids=["variable", "fixed", "none"])
def test_a_publication_is_one_frame_of_class_15(length, content, data, start_driver):
    """Section 5.1: data by the length of the message."""
    with FakeCentral(broadcasts=["M"]) as central:
        driver = start_driver().connect(central.address)
        driver.must("define", "M", length)
        driver.must("publish", "M", *([content] if content else []))
        frame = central.connection().wait_for_message("M").frame
        assert (frame.cls, frame.intent, frame.parent, frame.dispatch) == (
            BROADCAST, central.id_of("M"), -1, -1)
        assert frame.data == data and frame.class_data == b""


@pytest.mark.parametrize("fmt, words, value", [
    ("int", ["int", 0x12345678], 0x12345678),
    ("string", ["string", "hello"], "hello"),
    ("{int, double, string}", ["sample", 5, 2.5, "abc"], (5, 2.5, "abc")),
    ("{int, <int:1>}", ["numbers", 1, 2, 3], (3, [1, 2, 3])),
    ("{int, *!}", ["list", 1, 2], (1, (2, None))),
    ("double", ["double", -0.5], -0.5)])
def test_published_data_is_marshalled_in_the_own_byte_order(fmt, words, value, start_driver):
    """Sections 2.6, 5.1."""
    with FakeCentral(broadcasts=["M"]) as central:
        driver = start_driver().connect(central.address)
        driver.must("define", "M", "variable", fmt)
        driver.must("publish_data", "M", *words)
        received = central.connection().wait_for_message("M")
        assert received.frame.order == "<"
        assert codec.decode(fmt, received.content) == value


@pytest.fixture
def local(start_driver):
    """A driver that is connected by Unix socket, the hand-made central, and its end of the
    connection.

    Over TCP a library may send more than it has to, since it cannot know what is on its way.
    """
    with FakeCentral(unix=True) as central:
        driver = start_driver().connect(f"{socket.gethostname()}:{central.port}")
        assert central.connection().transport == "unix"
        yield driver, central, central.connection()


def test_a_message_that_nobody_subscribes_to_is_not_sent(local):
    """Section 4.6: a listening module keeps to its copy of the list of broadcasts."""
    driver, _, connection = local
    driver.must("define", "M", "variable")
    driver.must("publish", "M", "lost")
    driver.do("is_defined", "another")
    connection.wait_for(lambda r: r.value == ("another", None), "look-up")
    assert not connection.messages("M")


def test_a_no_listen_module_sends_always(start_driver, fake_central):
    """Section 4.6, capture 14."""
    driver = start_driver().connect(fake_central.address, listen=False)
    driver.must("define", "M", "variable")
    driver.must("publish", "M", "sent")
    assert fake_central.connection().wait_for_message("M").content == b"sent\0"


def test_updates_of_the_list_of_broadcasts_are_taken_in_while_listening(local):
    """Requirement 21, library's side."""
    driver, central, connection = local
    driver.must("define", "M", "variable")
    central.broadcasts.append("M")
    connection.announce_broadcasts()
    driver.do("listen", 100)
    driver.must("publish", "M", "heard")
    assert connection.wait_for_message("M").content == b"heard\0"
    central.broadcasts.remove("M")
    connection.announce_broadcasts()
    driver.do("listen", 100)
    driver.must("publish", "M", "unheard")
    driver.do("is_defined", "another")
    connection.wait_for(lambda r: r.value == ("another", None), "look-up")
    assert len(connection.messages("M")) == 1


@pytest.mark.new_library("it publishes by its old copy of the list")
def test_a_publisher_that_never_listens_takes_in_updates_that_have_arrived(local):
    """Design 9: a publisher that is about to drop first takes what its socket already holds."""
    driver, central, connection = local
    driver.must("define", "M", "variable")
    driver.do("is_defined", "M")
    central.broadcasts.append("M")
    connection.announce_broadcasts()
    driver.must("publish", "M", "heard")
    assert connection.wait_for_message("M").content == b"heard\0"


@pytest.mark.new_library("it compares the case")
def test_publishing_under_another_spelling_works(start_driver):
    """api-behaviour 5.4."""
    with FakeCentral(broadcasts=["Foo"]) as central:
        driver = start_driver().connect(central.address)
        driver.must("define", "Foo", "variable")
        driver.must("publish", "foo", "text")
        assert central.connection().wait_for_message("Foo").content == b"text\0"


# ----------------------------------------------------------------------- subscribe


def test_subscriptions_carry_a_handler_id_and_a_name_of_their_own(driver, connection):
    """Section 4.2: two functions, two handlers; a message may be subscribed to before it is
    defined."""
    driver.must("subscribe", "M", 0)
    driver.must("subscribe", "M", 1)
    driver.must("subscribe", "N", 0)
    driver.do("is_defined", "x")
    values = [r.value for r in connection.messages("x_ipc_registerHandlerMsg")
              if r.value[1] in "MN"]
    assert [value[1] for value in values] == ["M", "M", "N"]
    assert len({value[0] for value in values}) == 3
    assert all(value[0] >= 0 for value in values)
    assert len({value[2] for value in values}) == 3
    assert all(value[2].startswith(f"HND-{value[1]}") for value in values)


def test_a_handler_that_subscribes_again_keeps_its_id(driver, connection):
    """Requirement 19: also after it was unsubscribed in between, as capture 12 shows."""
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M", 0)
    driver.do("is_defined", "x")
    first = connection.wait_subscribed("M")[0]
    driver.must("subscribe", "M", 0)
    driver.must("unsubscribe", "M", 0)
    driver.must("subscribe", "M", 0)
    driver.do("is_defined", "y")
    values = [r.value for r in connection.messages("x_ipc_registerHandlerMsg")
              if r.value[1] == "M"]
    assert len({value[2] for value in values}) == 1
    assert {value[0] for value in values[1:]} <= {0, first}
    connection.deliver("M", b"text", handler=first)
    assert texts_in(driver.until(1)) == ["text"]


def test_unsubscribing_sends_the_name_of_the_handler(driver, connection):
    """Section 4.2."""
    driver.must("subscribe", "M", 0)
    driver.must("unsubscribe", "M", 0)
    driver.do("is_defined", "x")
    subscribed = connection.wait_for(
        lambda r: r.name == "x_ipc_registerHandlerMsg" and r.value[1] == "M").value
    left = connection.wait_for_message("x_ipc_deregisterHandlerMsg")
    assert left.frame.cls == INFORM
    assert left.value == (0, "M", subscribed[2])


# ------------------------------------------------------------------------ delivery


@pytest.mark.parametrize("original_scheme", [False, True])
def test_messages_are_handled_with_and_without_class_data(original_scheme, start_driver):
    """Requirement 25: the name from class data, or what the handler was registered for."""
    with FakeCentral(original_scheme=original_scheme) as central:
        driver = start_driver().connect(central.address)
        driver.must("define", "M", "variable", "int")
        driver.must("subscribe_data", "M")
        connection = central.connection()
        for number in range(3):
            connection.deliver_number("M", number)
            assert data_in(driver.until(number + 1)) == [str(number)]


def test_every_delivery_is_acknowledged_exactly_once(driver, connection):
    """Requirement 26: header only, class 12, parent and dispatch are the dispatch id, 0
    included."""
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    dispatches = [connection.deliver("M", str(number).encode()) for number in range(5)]
    driver.until(5)
    driver.do("is_defined", "x")
    for dispatch in dispatches:
        connection.wait_acknowledged(dispatch)
    assert dispatches[0] == 0
    frames = connection.acknowledgements()
    assert sorted(frame.dispatch for frame in frames) == dispatches
    for frame in frames:
        assert (frame.intent, frame.reference, frame.data, frame.class_data) == (-1, -1, b"", b"")
        assert frame.parent in (frame.dispatch, -1)


def test_a_delivery_is_acknowledged_after_its_handler(driver, connection):
    """Section 5.4: not before the handler returns."""
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M", 0, "sleep", 150)
    connection.wait_subscribed("M")
    began = time.monotonic()
    dispatch = connection.deliver("M", b"text")
    driver.until(1)
    connection.wait_acknowledged(dispatch)
    assert time.monotonic() - began >= 0.15


def test_what_a_handler_sends_has_the_dispatch_as_its_parent(start_driver):
    """Section 2.4: parent is the dispatch whose handler is running."""
    with FakeCentral(broadcasts=["E"]) as central:
        driver = start_driver().connect(central.address)
        driver.must("define", "M", "variable")
        driver.must("define", "E", "variable")
        driver.must("subscribe", "M", 0, "publish", "E", "from the handler")
        connection = central.connection()
        connection.deliver("M", b"text", dispatch=77)
        driver.until(1)
        assert connection.wait_for_message("E").frame.parent == 77


def test_a_delivery_for_a_removed_handler_is_acknowledged_and_dropped(driver, connection):
    """Requirement 26, section 5.4."""
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M", 0)
    handler = connection.wait_subscribed("M")[0]
    driver.must("unsubscribe", "M", 0)
    dispatch = connection.deliver("M", b"late", handler=handler)
    driver.do("listen", 300)
    driver.do("is_defined", "x")
    assert connection.wait_acknowledged(dispatch).parent in (-1, dispatch)
    assert driver.do("events").result == "0"
    driver.wait_for_line(r"WARNING: Message 'M' received but not processed: Handler 'HND-M\d+' "
                         "not registered", stream="stderr")


@pytest.mark.new_library("it never acknowledges what it drops")
def test_what_the_queue_limit_drops_is_acknowledged_too(driver, connection):
    """Requirement 26: queue length 2 and eight messages at once: 6 and 7 are handled, all are
    acknowledged."""
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    driver.must("capacity", 100)
    driver.must("limit", "M", 2)
    connection.wait_subscribed("M")
    frames = [connection.delivery("M", str(number).encode()) for number in range(8)]
    connection.send_bytes(b"".join(frame.pack() for frame in frames))
    assert texts_in(driver.until(2)) == ["6", "7"]
    driver.do("listen", 50)
    driver.do("is_defined", "x")
    for frame in frames:
        connection.wait_acknowledged(frame.reference)
    assert len(connection.acknowledgements()) == 8
    assert driver.do("events").result == "2"


@pytest.mark.new_library("the first messages of each handler are reversed")
def test_the_own_queue_is_ordered_by_priority(driver, connection):
    """Section 5.5: hi 10, mid 5, lo unset; ties in order of receipt."""
    for name in ("hi", "mid", "lo"):
        driver.must("define", name, "variable")
        driver.must("subscribe", name)
        connection.wait_subscribed(name)
    driver.must("priority", "hi", 10)
    driver.must("priority", "mid", 5)
    sent = "lo0 lo1 hi0 mid0 lo2 hi1 mid1".split()
    frames = [connection.delivery(text[:-1], text.encode()) for text in sent]
    connection.send_bytes(b"".join(frame.pack() for frame in frames))
    assert texts_in(driver.until(7)) == "hi0 hi1 mid0 mid1 lo0 lo1 lo2".split()


@pytest.mark.new_library("its first messages are handled in reverse order")
@pytest.mark.parametrize("original_scheme", [False, True])
def test_the_first_messages_of_a_subscription_are_handled_in_order(original_scheme, start_driver):
    """Section 5.3: no handler runs during internal look-ups."""
    with FakeCentral(original_scheme=original_scheme) as central:
        driver = start_driver().connect(central.address)
        driver.must("define", "M", "variable", "int")
        driver.must("subscribe_data", "M")
        connection = central.connection()
        connection.wait_subscribed("M")
        frames = [connection.delivery("M", struct.pack("<i", number)) for number in (70, 71, 72)]
        connection.send_bytes(b"".join(frame.pack() for frame in frames))
        assert data_in(driver.until(3)) == ["70", "71", "72"]


def test_content_of_length_0_is_null(driver, connection):
    """Section 2.2, api-behaviour 5.4."""
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    connection.deliver("M", b"")
    assert messages_in(driver.until(1)) == [(0, "M", b"")]
    driver.must("define", "Z", 0)
    driver.must("subscribe", "Z")
    connection.deliver("Z", data=b"")
    assert messages_in(driver.until(2)) == [(0, "Z", b"")]


def test_a_fixed_length_message_is_delivered_as_it_is(driver, connection):
    """Section 5.1."""
    driver.must("define", "F", 4)
    driver.must("subscribe", "F")
    connection.deliver("F", data=b"\1\2\3\4")
    assert messages_in(driver.until(1)) == [(0, "F", b"\1\2\3\4")]


# ---------------------------------------------------------------------- byte order


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("fmt, value, printed", [
    ("int", 0x12345678, "305419896"),
    ("{int, double, string}", (7, 2.5, "abc"), '{7, 2.50, "abc"}'),
    ("{short, ushort, uint}", (-2, 65535, 4000000000), "{-2, 65535, 4000000000}"),
    ("{int, <int:1>}", (3, [1, 2, 3]), "{3, <1, 2, 3>}"), ("[int:2,3]", list(range(6)),
                                                          "[[0, 1, 2], [3, 4, 5]]"),
    ("{int, *!}", (1, (2, None)), "{1, *{2, NULL}}"), ("*int", None, "NULL"),
    ("{enum A, B, C}", 2, "C"), ("float", 0.5, "0.50"), ("boolean", 1, "True")])
def test_data_of_either_byte_order_is_converted(order, fmt, value, printed, driver, connection):
    """Requirement 7: convert on receipt when the nibble is not one's own."""
    driver.must("define", "M", "variable", fmt)
    driver.must("subscribe_data", "M")
    connection.deliver("M", codec.encode(fmt, value, order), order=order)
    assert data_in(driver.until(1)) == [printed]


@pytest.mark.new_library("it keeps the order of the last frame only")
def test_each_message_is_decoded_in_its_own_byte_order(driver, connection):
    """Section 8.2: big-endian 5 followed by little-endian 6, both waiting."""
    driver.must("define", "M", "variable", "int")
    driver.must("subscribe_data", "M")
    connection.wait_subscribed("M")
    frames = [connection.delivery("M", struct.pack(order + "i", number), order=order)
              for number, order in enumerate("><><", 5)]
    connection.send_bytes(b"".join(frame.pack() for frame in frames))
    assert data_in(driver.until(4)) == ["5", "6", "7", "8"]


def test_requests_of_a_big_endian_central_are_understood(start_driver):
    """Requirement 7: replies may come in either order."""
    with FakeCentral() as central:
        plain = central.react

        def react(connection, received):
            if received.name == "x_ipc_moduleConnectedQ":
                connection.reply(received, codec.encode("int", 1, ">"), order=">")
            else:
                plain(connection, received)
        central.react = react
        driver = start_driver().connect(central.address)
        assert driver.do("module_connected", "anybody").result == "1"


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_long_of_eight_bytes_is_read(order, driver, connection):
    """Section 8.4: from an LP64 sender."""
    driver.must("define", "M", "variable", "long")
    driver.must("subscribe_data", "M")
    connection.deliver("M", codec.encode("long", -5_000_000_000, order), order=order)
    assert data_in(driver.until(1)) == ["-5000000000"]


@pytest.mark.new_library("it reads beyond the content")
def test_a_long_of_four_bytes_is_not_read_beyond_its_end(driver, connection):
    """Section 8.4: read as the other size, or not delivered; never a wrong value."""
    driver.must("define", "M", "variable", "long")
    driver.must("subscribe_data", "M")
    dispatch = connection.deliver("M", codec.encode("long", 42, long_size=4))
    printed = data_in(driver.do("listen", 300).events)
    assert printed in ([], ["42"])
    driver.do("is_defined", "x")
    connection.wait_acknowledged(dispatch)


# ------------------------------------------------------------------- queue control


def test_capacity_priority_and_limit_are_told_to_central(driver, connection):
    """Requirement 29: the frames of 4.1."""
    driver.must("capacity", 7)
    driver.must("priority", "M", 3)
    driver.must("limit", "M", 5)
    driver.do("is_defined", "x")
    assert connection.wait_for_message("x_ipc_registerResourceMsg").value == (7, "DRIVER")
    assert connection.wait_for_message("ipc_setMsgPriority").value == ("M", 3)
    assert connection.wait_for(lambda r: r.name == "x_ipc_limitPendingMsg" and r.value[0] == "M"
                               ).value == ("M", "DRIVER", 5)


# --------------------------------------------------------------------------- query


@pytest.fixture
def asker(driver, connection, fake_central):
    """A driver for which the messages Q and A of content int are defined."""
    fake_central.define("Q", "int")
    fake_central.define("A", "int")
    return driver


def test_a_query_has_class_3_and_its_reply_is_matched_by_the_reference(asker, connection):
    """Requirement 31."""
    asker.start("query_data", "Q", "A", 3000, "int", 21)
    query = connection.wait_for_message("Q")
    assert query.frame.cls == QUERY
    assert codec.decode("int", query.content) == 21
    connection.answer(query, "A", struct.pack("<i", 42))
    assert asker.finish().reply == "42"


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_reply_may_come_in_either_byte_order(order, asker, connection):
    """Requirement 7, 8.2: a reply's order counts after IPC_queryResponse has returned."""
    asker.start("query_data", "Q", "A", 3000, "int", 21)
    query = connection.wait_for_message("Q")
    connection.answer(query, "A", struct.pack(order + "i", 0x01020304), order)
    assert asker.finish().reply == str(0x01020304)


def test_replies_are_matched_in_any_order(asker, connection):
    """Requirement 31: two outstanding queries answered in reverse."""
    asker.must("notify_data", "Q", "first", "int", 1)
    asker.must("notify_data", "Q", "second", "int", 2)
    first, second = (connection.wait_for(
        lambda r, n=n: r.name == "Q" and r.content == struct.pack("<i", n)) for n in (1, 2))
    assert first.frame.reference != second.frame.reference
    connection.answer(second, "A", struct.pack("<i", 20))
    assert replies_in(asker.until(1)) == [("second", "A", "20")]
    connection.answer(first, "A", struct.pack("<i", 10))
    assert replies_in(asker.until(2)) == [("first", "A", "10")]


def test_messages_are_handled_while_a_query_waits(asker, connection):
    """Section 6.1: IPC_queryResponse waits while handling other messages."""
    asker.must("define", "M", "variable")
    asker.must("subscribe", "M")
    asker.start("query_data", "Q", "A", 3000, "int", 1)
    query = connection.wait_for_message("Q")
    dispatch = connection.deliver("M", b"meanwhile")
    connection.wait_acknowledged(dispatch)
    connection.answer(query, "A", struct.pack("<i", 2))
    answer = asker.finish()
    assert answer.reply == "2"
    assert texts_in(answer.events) == ["meanwhile"]


def test_a_query_that_nobody_answers_times_out(asker, connection):
    """Section 6.3: no frame; the late reply is dropped and disturbs nothing."""
    answer = asker.do("query_data", "Q", "A", 100, "int", 1)
    assert answer.result == "Timeout"
    late = connection.wait_for_message("Q")
    connection.answer(late, "A", struct.pack("<i", 5))
    start = len(connection.received)
    asker.start("query_data", "Q", "A", 3000, "int", 2)
    query = connection.wait_for_message("Q", start=start)
    connection.answer(query, "A", struct.pack("<i", 6))
    assert asker.finish().reply == "6"


def test_a_response_has_class_11_the_dispatch_and_the_name_of_its_message(driver, connection):
    """Requirement 32: and no success frame follows."""
    driver.must("define", "Q", "variable", "int")
    driver.must("define", "A", "variable", "int")
    driver.must("subscribe", "Q", 0, "double", "A")
    dispatch = connection.deliver_number("Q", 21, cls=QUERY)
    driver.until(1)
    response = connection.wait_for(lambda r: r.frame.cls == REPLY, "a response").frame
    assert (response.intent, response.dispatch, response.reference) == (-1, dispatch, -1)
    assert response.parent in (dispatch, -1)
    assert response.message_name() == "A"
    assert codec.decode("int", codec.content_of(response.data)) == 42
    driver.do("is_defined", "x")
    connection.wait_for(lambda r: r.value == ("x", None), "look-up")
    assert not connection.acknowledgements(dispatch)


def test_a_handler_that_does_not_respond_is_acknowledged(driver, connection):
    """Section 6.3: a success frame."""
    driver.must("define", "Q", "variable", "int")
    driver.must("subscribe", "Q", 0)
    dispatch = connection.deliver_number("Q", 21, cls=QUERY)
    driver.until(1)
    driver.do("is_defined", "x")
    connection.wait_acknowledged(dispatch)


def test_a_delayed_response_is_sent_later_and_nothing_before(driver, connection):
    """Requirement 34, library's side: no frame when the handler returns; parent -1."""
    driver.must("define", "Q", "variable", "int")
    driver.must("define", "A", "variable", "int")
    driver.must("subscribe", "Q", 0, "delay")
    dispatch = connection.deliver_number("Q", 21, cls=QUERY)
    driver.until(1)
    driver.do("is_defined", "x")
    connection.wait_for(lambda r: r.value == ("x", None), "look-up")
    assert not [r for r in connection.received if r.frame.dispatch == dispatch]
    driver.must("respond_data", "A", "int", 99)
    response = connection.wait_for(lambda r: r.frame.cls == REPLY, "a response").frame
    assert (response.dispatch, response.parent) == (dispatch, -1)
    assert codec.decode("int", codec.content_of(response.data)) == 99
    driver.do("is_defined", "y")
    assert not connection.acknowledgements(dispatch)


def test_a_response_to_a_publication_is_sent_as_its_acknowledgement(driver, connection):
    """Section 6.3, requirement 37."""
    driver.must("define", "M", "variable", "int")
    driver.must("define", "A", "variable", "int")
    driver.must("subscribe", "M", 0, "double", "A")
    dispatch = connection.deliver_number("M", 4)
    driver.until(1)
    response = connection.wait_for(lambda r: r.frame.cls == REPLY, "a response").frame
    assert response.dispatch == dispatch
    driver.do("is_defined", "x")
    assert not connection.acknowledgements(dispatch)


# ------------------------------------------------------------------------- notices


def test_notices_of_modules_are_plain_subscriptions(driver, connection):
    """Section 4.5: handler name = message name."""
    driver.must("watch_connect")
    driver.must("watch_disconnect")
    for name in ("x_ipc_connectNotify", "x_ipc_disconnectNotify"):
        value = connection.wait_for(lambda r, n=name: r.name == "x_ipc_registerHandlerMsg"
                                    and r.value[1] == n, name).value
        assert value[2] == name
    first = connection.deliver("x_ipc_connectNotify", data=codec.encode("string", "New"))
    assert driver.until(1) == ["connected New"]
    second = connection.deliver("x_ipc_disconnectNotify", data=codec.encode("string", "New"))
    assert driver.until(2) == ["disconnected New"]
    driver.do("is_defined", "x")
    connection.wait_acknowledged(first)
    connection.wait_acknowledged(second)


def test_changes_of_handlers_are_watched_by_a_variable(driver, connection, fake_central):
    """Section 4.4: the notice, the query, the watch; the callback gets the number."""
    fake_central.answers["x_ipc_directMsgQuery"] = lambda *_: codec.encode(
        messages.HANDLER_LIST, (1, [(5, 0, 0, -1, "robot", "OTHER")]))
    driver.must("define", "M", "variable")
    driver.must("watch_handlers", "M")
    assert connection.wait_for_message("x_ipc_notifyHandlerChange").value == "M"
    watch = connection.wait_for(lambda r: r.name == "x_ipc_registerHandlerMsg"
                                and r.value[1] == "V_watch_M", "watch").value
    assert watch[2] == "V_watch_M"
    handlers = [(n, 0, 0, -1, "robot", "OTHER") for n in range(3)]
    connection.deliver("V_watch_M", data=codec.encode(messages.HANDLER_LIST, (3, handlers)))
    events = driver.until(1)
    assert events[-1] == "handlers M 3"
    assert driver.do("handlers", "M").result == "1"
    driver.must("unwatch_handlers", "M")
    driver.do("is_defined", "x")
    left = connection.wait_for_message("x_ipc_deregisterHandlerMsg")
    assert left.value == (0, "V_watch_M", "V_watch_M")


def test_a_named_format_is_told_and_asked_for(driver, connection):
    """Requirement 20, library's side, capture 06."""
    driver.must("format", "point", "{int, int}")
    driver.must("define", "M", "variable", "point")
    told = connection.wait_for_message("x_ipc_registerNamedFormMsg").value
    assert told == ("point", "{int, int}")
    driver.must("check_formats", "M", "point")
    driver.must("check_formats", "M", "{int, int}")
    assert driver.do("check_formats", "M", "{int, double}").error == "Mismatched_Formatter"
