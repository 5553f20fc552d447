"""Whatever central sends, a module neither crashes nor hangs (sections 13.2 and 13.3,
api-behaviour 4.1).

A central that breaks the protocol is a lost connection: the module that listens ends with status
255, or the call returns an error.  Content that does not decode costs that one message.
"""
import contextlib
import random
import struct
import time

import pytest

from support import codec, messages
from support.driver import Driver, Ended, FLAGS, SOURCE, data_in, texts_in
from support.fake_central import FakeCentral, SILENCE
from support.frame import BROADCAST, Frame, IS_REPLY, REPLY, SUCCESS, class_name
from support.waiting import SLOW

pytestmark = pytest.mark.new_library("it crashes, exits or hangs")

LOST = "lost connection"


def outcome(driver, *command, seconds=None):
    """What comes of a command: its answer, or LOST when the module reports and ends as it
    should."""
    driver.start(*command)
    try:
        answer = driver.finish(seconds)
    except Ended:
        status = driver.wait()
        driver.check_sanitizers()
        assert status == 255, f"the module ended with {status}:\n{driver.output()[-1000:]}"
        return LOST
    if answer.error in ("Communication_Error", "Not_Connected"):
        return LOST
    return answer


@pytest.fixture
def connection(driver, fake_central):
    """Central's end of a driver that subscribes to M, of content int, and to the raw message R."""
    driver.must("define", "M", "variable", "int")
    driver.must("define", "R", "variable")
    driver.must("subscribe_data", "M")
    driver.must("subscribe", "R")
    connection = fake_central.connection()
    connection.wait_subscribed("R")
    return connection


def assert_serves(driver, connection):
    """The module still handles messages and asks questions."""
    connection.deliver_number("M", 4711)
    assert "4711" in data_in(driver.listen_for(1))
    assert driver.do("is_defined", "nothing").result == "0"


# ----------------------------------------------------------------- bad frames


BROKEN_FRAMES = {
    "negative data length": dict(data_length=-1), "negative class length": dict(class_length=-5),
    "most negative": dict(data_length=-0x80000000),
    "huge data length": dict(data_length=0x7ffffff0),
    "huge class length": dict(class_length=0x7ffffff0),
    "class data above the limit": dict(class_length=(64 << 10) + 1),
    "alignment": dict(alignment=1), "order 0": dict(order=0), "order 3": dict(order=3),
    "class 2": dict(cls=2), "class 4": dict(cls=4), "class 16": dict(cls=16),
    "class 77": dict(cls=77), "class 65535": dict(cls=0xffff),
    "intent -1": dict(intent=-1), "intent -2": dict(intent=-2),
    "intent most negative": dict(intent=-0x80000000),
}


@pytest.mark.parametrize("fields", BROKEN_FRAMES.values(), ids=BROKEN_FRAMES.keys())
def test_a_broken_frame_is_a_lost_connection(fields, driver, connection):
    """13.2, 13.3."""
    good = connection.delivery("M", struct.pack("<i", 5))
    values = {"cls": BROADCAST, "intent": good.intent, "data": good.data,
              "class_data": good.class_data, "reference": 5, **fields}
    connection.send_bytes(Frame(**values).pack() + bytes(100))
    assert outcome(driver, "listen", 3000) == LOST


@pytest.mark.parametrize("text", [b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n" * 2,
                                  b"\xff" * 60, b"SSH-2.0-x\r\n" * 5],
                         ids=["http", "ones", "ssh"])
def test_text_is_a_lost_connection(text, driver, connection):
    """13.2."""
    connection.send_bytes(text)
    assert outcome(driver, "listen", 3000) == LOST


@pytest.mark.parametrize("cls", [SUCCESS, 13])
def test_an_acknowledgement_from_central_does_no_harm(cls, driver, connection):
    """13.2: a success frame; a class that central does not send."""
    connection.send(Frame(cls, intent=connection.wait_subscribed("M")[0], dispatch=3))
    outcome(driver, "listen", 200)


# --------------------------------------------------------------- partial frames


def test_the_timeout_of_listen_holds_while_a_frame_is_incomplete(driver, connection):
    """13.3: part of a frame, then silence; the rest is taken when it comes."""
    frame = connection.delivery("M", struct.pack("<i", 5)).pack()
    sent = 0
    for length in (5, 28, len(frame) - 1):
        connection.send_bytes(frame[sent:length])
        sent = length
        began = time.monotonic()
        assert driver.do("listen", 150).result == "Timeout"
        assert 0.14 <= time.monotonic() - began <= 2 * SLOW
    connection.send_bytes(frame[sent:])
    assert data_in(driver.until(1)) == ["5"]


def test_the_timeout_of_a_query_holds_while_its_reply_is_incomplete(driver, connection,
                                                                  fake_central):
    """13.2, 13.3."""
    fake_central.define("Q", "int")
    driver.start("query_data", "Q", "M", 200, "int", 1)
    query = connection.wait_for_message("Q")
    reply = Frame(REPLY, IS_REPLY, codec.variable(b"\2\0\0\0"), class_name("M"), parent=0,
                  dispatch=0, reference=query.frame.reference).pack()
    connection.send_bytes(reply[:40])
    assert driver.finish().result == "Timeout"
    connection.send_bytes(reply[40:])
    assert_serves(driver, connection)


def test_a_frame_that_never_ends_is_a_lost_connection_in_the_end(driver, connection):
    """13.2."""
    connection.send_bytes(connection.delivery("M", struct.pack("<i", 5)).pack()[:30])
    connection.drop()
    assert outcome(driver, "listen", 3000) == LOST


# -------------------------------------------------------- frames that are odd only


def test_a_delivery_for_a_handler_that_never_was_does_no_harm(driver, connection):
    """13.2: acknowledged, as every delivery, or taken as a breach."""
    for number, handler in enumerate((0, 12345, 0x7fffffff), 100):
        connection.send(connection.delivery("M", b"1234", handler=handler, dispatch=number))
        if outcome(driver, "listen", 100) == LOST:
            return
        driver.do("is_defined", "x")
        connection.wait_acknowledged(number)
    assert_serves(driver, connection)


def test_a_reply_that_nobody_waits_for_is_dropped(driver, connection):
    """13.2, section 2.7."""
    for reference in (0, 1, 2, 99999, -1, -4, 0x7fffffff):
        connection.send(Frame(0, IS_REPLY, b"data", parent=0, dispatch=0, reference=reference))
        connection.send(Frame(REPLY, IS_REPLY, codec.variable(b"data"), class_name("M"),
                              parent=0, dispatch=0, reference=reference))
    driver.do("listen", 100)
    assert_serves(driver, connection)


def test_a_second_reply_to_a_request_is_dropped(driver, connection, fake_central):
    """Section 2.7."""
    def twice(connection, received):
        connection.reply(received, codec.encode("int", 1))
        connection.reply(received, codec.encode("int", 0))
        return SILENCE
    fake_central.answers["x_ipc_moduleConnectedQ"] = twice
    assert driver.do("module_connected", "A").result == "1"
    assert driver.do("module_connected", "A").result == "1"
    assert_serves(driver, connection)


def test_a_delivery_without_class_data_is_handled(driver, connection):
    """13.2: before the look-up."""
    connection.deliver("R", b"text", class_data=b"")
    assert texts_in(driver.until(1)) == ["text"]


NO_NAMES = {
    "one byte": b"\1", "cut": b"\5\0\0\0M", "negative": struct.pack("<i", -1),
    "huge": struct.pack("<i", 0x7fffffff) + b"M", "empty": b"\0\0\0\0Z",
    "trailing": b"\1\0\0\0M trailing", "unknown name": class_name("unheard of"),
    "zero inside": class_name("\xff\0\xfe"),
}


@pytest.mark.parametrize("class_data", NO_NAMES.values(), ids=NO_NAMES.keys())
@pytest.mark.parametrize("kind", ["delivery", "reply"])
def test_class_data_that_is_no_message_name_does_no_harm(kind, class_data, driver, connection,
                                                        fake_central):
    """13.2, 13.3."""
    if kind == "delivery":
        connection.deliver("M", b"\1\0\0\0", class_data=class_data)
        outcome(driver, "listen", 100)
        return
    fake_central.define("Q", "int")
    driver.start("query_data", "Q", "M", 300, "int", 1)
    query = connection.wait_for_message("Q")
    connection.send(Frame(REPLY, IS_REPLY, codec.variable(b"\2\0\0\0"), class_data, parent=0,
                          dispatch=0, reference=query.frame.reference))
    try:
        driver.finish()
    except Ended:
        assert driver.wait() == 255


def test_a_reply_to_a_users_query_without_class_data_does_no_harm(driver, connection,
                                                                 fake_central):
    """13.2: an error or no answer, never a crash."""
    fake_central.define("Q", "int")
    driver.start("query_data", "Q", "M", 300, "int", 1)
    query = connection.wait_for_message("Q")
    connection.send(Frame(0, IS_REPLY, b"", parent=0, dispatch=0,
                          reference=query.frame.reference))
    assert driver.finish().result.split()[0] in ("Error", "Timeout")
    assert_serves(driver, connection)


# ------------------------------------------------------------------- bad content


BAD_CONTENT = {
    "none": b"", "one byte": b"\1", "too much": bytes(100),
}
BAD_DATA = {
    "no data": b"", "count only": b"\4\0\0\0", "count beyond the data":
    struct.pack("<ii", 100, 100) + b"1234", "negative count": struct.pack("<ii", -1, -1),
    "huge count": struct.pack("<ii", 0x7fffffff, 0x7fffffff) + b"1234",
    "different counts": struct.pack("<ii", 4, 2) + b"1234",
    "trailing": struct.pack("<ii", 4, 4) + b"12345678",
}


@pytest.mark.parametrize("content", BAD_CONTENT.values(), ids=BAD_CONTENT.keys())
def test_content_that_does_not_decode_costs_one_message(content, driver, connection):
    """13.3, api-behaviour 6.1: a warning, no handler, an acknowledgement."""
    dispatch = connection.deliver("M", content)
    driver.do("listen", 100)
    driver.do("is_defined", "x")
    connection.wait_acknowledged(dispatch)
    assert_serves(driver, connection)


def test_content_that_is_too_short_is_warned_of(driver, connection):
    """api-behaviour 6.1."""
    connection.deliver("M", b"\1")
    driver.do("listen", 200)
    driver.wait_for_line("WARNING: Message 'M' could not be decoded", stream="stderr")
    assert driver.do("events").result == "0"


@pytest.mark.parametrize("data", BAD_DATA.values(), ids=BAD_DATA.keys())
@pytest.mark.parametrize("name", ["M", "R"])
def test_data_that_does_not_fit_the_wire_format_does_no_harm(name, data, driver, connection):
    """13.2: counts that do not fit the data."""
    connection.deliver(name, data=data)
    if outcome(driver, "listen", 100) != LOST:
        assert_serves(driver, connection)


LYING_VALUES = {
    "string count": ("string", struct.pack("<i", 1000) + b"abc"),
    "negative string count": ("string", struct.pack("<i", -2) + b"abc"),
    "array count": ("{int, <int:1>}", struct.pack("<ii", 1 << 28, 1 << 28) + bytes(16)),
    "array count that overflows": ("{int, <double:1>}",
                                   struct.pack("<ii", 0x20000001, 0x20000001) + bytes(8)),
    "negative array count": ("{int, <int:1>}", struct.pack("<ii", -3, -3)),
    "count and product differ": ("{int, <int:1>}", struct.pack("<iii", 5, 1, 7)),
    "two dimensions": ("{int, int, <char:1,2>}",
                       struct.pack("<iii", 65536, 65536, 0)),
    "array of structures": ("{int, <{int, string}:1>}", struct.pack("<iii", 99999999, 99999999, 1)),
    "endless list": ("{int, *!}", struct.pack("<i", 1) + b"Z" + struct.pack("<i", 2) + b"Z"),
    "pointer to nothing": ("*int", b"Z"),
    "enum out of range": ("{enum A, B}", struct.pack("<i", 77)),
    "array of empty structures": ("{int, <{}:1>}", struct.pack("<ii", 0x7fffffff, 0x7fffffff)),
}


@pytest.mark.parametrize("kind", LYING_VALUES)
def test_a_value_that_lies_about_its_size_does_no_harm(kind, driver, connection):
    """13.2, 13.3: every count is checked before anything is allocated."""
    fmt, content = LYING_VALUES[kind]
    driver.do("define", "L", "variable", fmt)
    driver.do("subscribe_data", "L")
    connection.wait_subscribed("L")
    dispatch = connection.deliver("L", content)
    driver.do("listen", 100)
    driver.do("is_defined", "x")
    connection.wait_acknowledged(dispatch)
    assert_serves(driver, connection)


def test_a_list_of_a_hundred_thousand_elements_is_no_danger_to_the_stack(driver, connection):
    """formats: long lists are walked, not recursed."""
    driver.must("define", "L", "variable", "{int, *!}")
    driver.must("subscribe", "L", 0, "sequence")
    driver.must("define", "D", "variable", "{int, *!}")
    driver.must("subscribe_data", "D")
    connection.wait_subscribed("D")
    count = 100_000
    content = b"".join(struct.pack("<i", 7) + b"Z" for _ in range(count - 1))
    connection.deliver("D", content + struct.pack("<i", 7) + b"\0")
    answer = driver.do("listen", 5000, seconds=30 * SLOW)
    assert answer.result == "OK"
    assert_serves(driver, connection)


def test_a_reply_shorter_than_its_format_is_an_error(driver, connection, fake_central):
    """13.2."""
    fake_central.define("Q", "int")
    fake_central.define("A", "{int, double, string}")
    for content in (b"", b"\1\0\0\0", struct.pack("<id", 1, 2.0) + struct.pack("<i", 500)):
        start = len(connection.received)
        driver.start("query_data", "Q", "A", 300, "int", 1)
        query = connection.wait_for_message("Q", start=start)
        connection.answer(query, "A", content)
        result = driver.finish().result
        assert not result.startswith("OK {"), result
    assert_serves(driver, connection)


# -------------------------------------------------------- bad answers of central


def look_up_answers():
    """Answers to a look-up that are wrong in some way."""
    good = codec.encode(messages.MESSAGE_INFO,
                        (3333, "Odd", BROADCAST, codec.parse(codec.VARIABLE), codec.parse("int")))
    yield "nothing", b""
    yield "pointer only", b"Z"
    for length in (4, 8, 12, 20, 30, len(good) - 1):
        yield f"first {length} bytes", good[:length]
    yield "trailing bytes", good + b"trailing"
    kinds = {"kind 9": struct.pack("<i", 9), "kind 100": struct.pack("<i", 100),
             "bad format": struct.pack("<i", 6), "primitive 99": struct.pack("<ii", 0, 99),
             "raw -5": struct.pack("<ii", 1, -5), "raw huge": struct.pack("<ii", 1, 0x7fffffff),
             "structure of -1": struct.pack("<ii", 2, -1),
             "structure of many": struct.pack("<ii", 2, 0x7fffffff),
             "array without dimension": struct.pack("<iiii", 4, 2, 0, 1),
             "array of -3": struct.pack("<iiiii", 4, 3, 0, 1, -3),
             "array of many": struct.pack("<iiiiii", 4, 4, 0, 4, 65536, 65536),
             "variable array of member 9": struct.pack("<iiiiiiii", 2, 3, 0, 1, 5, 3, 0, 1)
             + struct.pack("<i", 9),
             "enum of many": struct.pack("<iii", 8, 0x7fffffff, 3),
             "lonely self pointer": struct.pack("<i", 3) + b"\0",
             "named": struct.pack("<i", 7) + codec.encode("string", "unknown"),
             "deep": struct.pack("<ii", 2, 2) * 50000 + struct.pack("<ii", 0, 1),
             "deep pointers": (struct.pack("<i", 3) + b"Z") * 50000 + struct.pack("<ii", 0, 1)}
    head = good[:4 + 1 + 4 + 3 + 4]
    wire = codec.encode("format", codec.parse(codec.VARIABLE))
    for name, data in kinds.items():
        yield f"content {name}", head + wire + data
        yield f"wire {name}", head + data + codec.encode("format", None)
    yield "id -4", b"Z" + struct.pack("<i", -4) + good[5:]
    yield "class 99", good[:12] + struct.pack("<i", 99) + good[16:]


LOOK_UP_ANSWERS = dict(look_up_answers())


@pytest.mark.parametrize("kind", LOOK_UP_ANSWERS)
def test_a_wrong_answer_to_a_look_up_does_no_harm(kind, driver, connection, fake_central):
    """13.3: an error of that call, or a lost connection."""
    plain = fake_central._look_up

    def answer(connection, received):
        if received.value[0] == "Odd":
            return LOOK_UP_ANSWERS[kind]
        return plain(connection, received.value)
    fake_central.answers["x_ipc_msgInfoMsg"] = answer
    if outcome(driver, "is_defined", "Odd") == LOST:
        return
    if outcome(driver, "publish_data", "Odd", "int", 5) == LOST:
        return
    if outcome(driver, "check_formats", "Odd", "int") != LOST:
        assert_serves(driver, connection)


WRONG_UPDATES = {
    "nothing": b"", "one byte": b"\1", "more used than there are":
    codec.encode(messages.NAME_LIST, (9, 1, ["M"])),
    "negative": struct.pack("<iii", -1, -1, -1),
    "huge": struct.pack("<iii", 0x7fffffff, 0x7fffffff, 0x7fffffff),
    "cut": codec.encode(messages.NAME_LIST, messages.name_list(["M", "N"]))[:-3],
    "trailing": codec.encode(messages.NAME_LIST, messages.name_list(["M"])) + b"xyz",
    "null names": codec.encode(messages.NAME_LIST, (3, 3, [None, "M", None])),
}


@pytest.mark.parametrize("data", WRONG_UPDATES.values(), ids=WRONG_UPDATES.keys())
def test_a_wrong_update_of_the_list_of_broadcasts_does_no_harm(data, driver, connection):
    """13.3."""
    connection.deliver(messages.WATCH_BROADCASTS, data=data)
    if outcome(driver, "listen", 100) != LOST:
        assert_serves(driver, connection)


@pytest.mark.parametrize("data", [b"", b"\0", b"\0\0\0\0Z", struct.pack("<i", 999) + b"x"],
                         ids=["nothing", "one byte", "empty name", "cut"])
def test_a_wrong_notice_does_no_harm(data, driver, connection):
    """13.3."""
    driver.must("watch_connect")
    driver.must("watch_disconnect")
    for name in ("x_ipc_connectNotify", "x_ipc_disconnectNotify"):
        connection.deliver(name, data=data)
        if outcome(driver, "listen", 100) == LOST:
            return
    assert_serves(driver, connection)


@pytest.mark.parametrize("data", [
    b"", b"\1", struct.pack("<ii", 1, 1), struct.pack("<ii", 5, 0), struct.pack("<ii", -1, -1),
    struct.pack("<ii", 0x7fffffff, 0x7fffffff),
    codec.encode(messages.HANDLER_LIST, (7, [(1, 0, 0, -1, "robot", "M")])),
    codec.encode(messages.HANDLER_LIST, (1, [(1, 0, 0, -1, None, None)]))],
    ids=["nothing", "one byte", "cut", "counts differ", "negative", "huge", "7 of 1", "no names"])
def test_a_wrong_list_of_handlers_does_no_harm(data, driver, connection, fake_central):
    """13.3: as an answer and as an update."""
    fake_central.answers["x_ipc_directMsgQuery"] = lambda *_: data
    if outcome(driver, "handlers", "M") == LOST:
        return
    if outcome(driver, "watch_handlers", "M") == LOST:
        return
    connection.deliver("V_watch_M", data=data)
    if outcome(driver, "listen", 100) != LOST:
        assert_serves(driver, connection)


@pytest.mark.parametrize("request_name, command", [
    ("x_ipc_moduleConnectedQ", ("module_connected", "A")),
    ("x_ipc_getNamedFormMsg", ("define", "N", "variable", "{int, unknown}")),
    ("x_ipc_getNamedFormMsg", ("check_formats", "M", "unknown"))],
    ids=["module query", "named format in a definition", "named format in a check"])
@pytest.mark.parametrize("data", [b"", b"\1", b"\xff" * 9, struct.pack("<ii", 2, 0x7fffffff)],
                         ids=["nothing", "one byte", "ones", "cut"])
def test_a_wrong_answer_to_a_request_does_no_harm(request_name, command, data, driver, connection,
                                                 fake_central):
    """13.3."""
    fake_central.answers[request_name] = lambda *_: data
    if outcome(driver, *command) != LOST:
        assert_serves(driver, connection)


# ------------------------------------------------------------------- random input


@pytest.mark.parametrize("seed", range(12))
def test_damaged_deliveries_do_no_harm(seed, driver, connection):
    """13.2: real frames with one to three bytes changed."""
    generator = random.Random(seed)
    for _ in range(12):
        name = generator.choice(("M", "R"))
        frame = bytearray(connection.delivery(name, struct.pack("<i", 5)).pack())
        for _ in range(generator.randrange(1, 4)):
            frame[generator.randrange(len(frame))] = generator.choice((0, 1, 4, 0x7f, 0x80, 0xff))
        try:
            connection.send_bytes(bytes(frame))
        except OSError:
            pass
        if outcome(driver, "listen", 30) == LOST:
            return


# --------------------------------------------------------------------- handshake


def _close_at_once(central):
    central.greet = lambda connection: connection.drop()


def _close_after_prelude(central):
    def greet(connection):
        connection.send_bytes(central.prelude())
        connection.drop()
    central.greet = greet


def _speak(text):
    def prepare(central):
        def greet(connection):
            connection.send_bytes(text)
        central.greet = greet
    return prepare


def _answer(name, data):
    def prepare(central):
        central.answers[name] = lambda *_: data
    return prepare


BAD_HANDSHAKES = {
    "closes at once": _close_at_once,
    "closes after the prelude": _close_after_prelude,
    "speaks http": _speak(b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n" * 5),
    "sends ones": _speak(b"\xff" * 200),
    "negative length in the prelude": _speak(struct.pack(">i7i", 182, 0, -24, 0, 0, 0x22000000,
                                                         0, 0) + bytes(200)),
    "huge length in the prelude": _speak(struct.pack(">i7i", 182, 0, 0x7ffffff0, 0, 0,
                                                     0x22000000, 0, 0) + bytes(200)),
    "introduction without data": _answer("x_ipc_newModuleConnectMsg", b""),
    "introduction cut": _answer("x_ipc_newModuleConnectMsg", b"\3\0\0\0"),
    "nothing is known": _answer("x_ipc_msgInfoMsg", b"\0"),
    "look-ups cut": _answer("x_ipc_msgInfoMsg", b"Z\1\0"),
    "look-ups of ones": _answer("x_ipc_msgInfoMsg", b"\xff" * 50),
}
HARMLESS_HANDSHAKES = {
    "no class formats": _answer("x_ipc_classInfoMsg", b"\0"),
    "odd log variable": _answer("V_get_CENTRAL_TERMINAL_LOG_VAR", b"\1\2\3"),
    "no list of broadcasts": _answer("V_get_" + messages.BROADCASTS, b""),
    "cut list of broadcasts": _answer("V_get_" + messages.BROADCASTS, b"\5\0\0\0\5\0\0\0"),
}


@pytest.fixture(scope="module")
def handshakes(compiler, library):
    """All bad handshakes at once, since each of them takes five seconds; by name: central and
    module."""
    with contextlib.ExitStack() as exits:
        program = compiler.program(SOURCE, library, flags=FLAGS)
        running = {}
        for name, prepare in {**BAD_HANDSHAKES, **HARMLESS_HANDSHAKES, "silent": None}.items():
            central = exits.enter_context(FakeCentral())
            if prepare:
                prepare(central)
            else:
                central.greet = lambda connection: None
            driver = exits.enter_context(Driver(program, library, name=name.replace(" ", "-")))
            driver.must("verbosity", 1)
            driver.start("connect", driver.name, central.address)
            running[name] = (central, driver)
        yield running


@pytest.mark.parametrize("name", BAD_HANDSHAKES)
def test_a_bad_handshake_is_a_failed_try(name, handshakes):
    """api-behaviour 4.1: five tries, then Error and E:Not_Connected; the module goes on."""
    central, driver = handshakes[name]
    answer = driver.finish(20 * SLOW)
    assert answer.error == "Not_Connected"
    assert len(central.connections) == 5
    assert driver.do("is_connected").result == "0"


@pytest.mark.parametrize("name", HARMLESS_HANDSHAKES)
def test_an_odd_handshake_does_no_harm(name, handshakes):
    """13.3: connected, or a failed try."""
    _, driver = handshakes[name]
    answer = driver.finish(20 * SLOW)
    assert answer.result == "OK" or answer.error == "Not_Connected"
    assert driver.do("events").result == "0"


def test_a_silent_central_costs_ten_seconds_for_each_try(handshakes):
    """api-behaviour 4.1: handshake limit 10 s, then as a failed try."""
    central, driver = handshakes["silent"]
    central.connection(1, seconds=13 * SLOW)
    for connection in central.connections:
        connection.send_bytes(central.prelude())
    central.greet = lambda connection: connection.send_bytes(central.prelude())
    assert driver.finish(30 * SLOW).result == "OK"


def test_after_a_failed_handshake_another_central_can_be_used(handshakes, fake_central):
    """api-behaviour 4.1."""
    _, driver = handshakes["speaks http"]
    driver.must("connect", driver.name, fake_central.address, seconds=20 * SLOW)
    assert fake_central.connection().module == driver.name
