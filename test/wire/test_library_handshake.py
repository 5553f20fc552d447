"""The library's side of frames and handshake (requirements 4-7, 9, 12, 15, 16)."""
import socket

import pytest

from support import codec, messages
from support.driver import texts_in
from support.fake_central import FakeCentral
from support.frame import BROADCAST, INFORM, QUERY
from support.waiting import SLOW

HOST = socket.gethostname()


def test_the_library_introduces_itself_and_says_that_it_is_ready(driver, fake_central):
    """Requirements 12, 16: look-ups by name, introduction, ready; nothing is expected before."""
    connection = fake_central.connection()
    assert connection.module == "DRIVER"
    assert connection.host == HOST[:32]
    asked = [r.name for r in connection.received]
    for name in ("x_ipc_newModuleConnectMsg", "x_ipc_waitMsg"):
        assert asked.count(name) == 1
    assert asked.index("x_ipc_newModuleConnectMsg") < asked.index("x_ipc_waitMsg")
    assert driver.do("is_connected").result == "1"


def test_a_listening_module_watches_the_list_of_broadcasts(driver, fake_central):
    """Section 3.5, first column."""
    connection = fake_central.connection()
    watches = [r.value for r in connection.messages("x_ipc_registerHandlerMsg")]
    assert [value[1] for value in watches] == [messages.WATCH_BROADCASTS]
    assert watches[0][0] >= 0
    ready = [r.name for r in connection.received].index("x_ipc_waitMsg")
    watch = [r.name for r in connection.received].index("x_ipc_registerHandlerMsg")
    assert watch < ready
    assert driver.alive()


def test_a_module_that_does_not_listen_watches_nothing(start_driver, fake_central):
    """Section 3.5, last column."""
    start_driver().connect(fake_central.address, listen=False)
    assert not fake_central.connection().messages("x_ipc_registerHandlerMsg")
    assert not fake_central.connection().messages("x_ipc_limitPendingMsg")


@pytest.mark.parametrize("first_id", [2, 300, 1_000_000, 0x7f000000])
def test_no_message_id_is_assumed(first_id, start_driver):
    """Requirement 15: a central with other ids."""
    with FakeCentral(first_id=first_id, broadcasts=["M"]) as central:
        driver = start_driver().connect(central.address)
        driver.must("define", "M", "variable", "int")
        driver.must("publish_data", "M", "int", 5)
        frame = central.connection().wait_for_message("M").frame
        assert (frame.cls, frame.intent) == (BROADCAST, central.id_of("M"))


def test_every_name_is_looked_up_on_every_connection(start_driver):
    """Requirement 15: nothing is taken over from the connection before."""
    with FakeCentral(broadcasts=["M"]) as first, FakeCentral(first_id=5001,
                                                             broadcasts=["M"]) as second:
        driver = start_driver()
        for central in (first, second):
            driver.connect(central.address)
            driver.must("define", "M", "variable", "int")
            driver.must("publish_data", "M", "int", 5)
            assert central.connection().wait_for_message("M").frame.intent == central.id_of("M")
            driver.must("disconnect")


def test_references_count_from_1_without_repetition(driver, fake_central):
    """Section 2.4: classes 3, 6 and 15; a new connection starts at 1."""
    driver.must("define", "M", "variable", "int")
    driver.must("subscribe", "M")
    driver.do("is_defined", "M")
    references = [r.frame.reference for r in fake_central.connection().received
                  if r.frame.cls in (QUERY, INFORM, BROADCAST)]
    assert references[0] == 1
    assert len(set(references)) == len(references)
    assert all(reference > 0 for reference in references)


@pytest.mark.parametrize("piece", [1, 5, 28])
def test_frames_of_central_may_come_in_pieces(piece, start_driver):
    """Requirement 6."""
    with FakeCentral(piece=piece) as central:
        driver = start_driver().connect(central.address)
        driver.must("define", "M", "variable")
        driver.must("subscribe", "M")
        connection = central.connection()
        for number in range(3):
            connection.deliver("M", f"text {number}".encode())
            assert texts_in(driver.until(number + 1)) == [f"text {number}"]


@pytest.mark.new_library("it handles them in reverse order")
def test_many_frames_of_central_may_come_at_once(driver, fake_central):
    """Requirement 6."""
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    connection = fake_central.connection()
    frames = [connection.delivery("M", str(number).encode()) for number in range(200)]
    connection.send_bytes(b"".join(frame.pack() for frame in frames))
    assert texts_in(driver.until(200)) == [str(number) for number in range(200)]
    for frame in frames:
        connection.wait_acknowledged(frame.reference)


def test_headers_are_well_formed(driver, fake_central):
    """Requirements 5, 7: own order in both nibbles, alignment 0, requests without class data."""
    driver.must("define", "M", "variable", "int")
    driver.must("subscribe", "M")
    driver.do("is_defined", "M")
    for received in fake_central.connection().received:
        frame = received.frame
        assert (frame.order, frame.class_order, frame.alignment) == ("<", "<", 0)
        assert frame.dispatch == -1 and frame.parent == -1 and frame.class_data == b""


def test_empty_strings_are_sent_as_length_0_and_one_filler_byte(driver, fake_central):
    """Requirement 9: a definition without content format."""
    driver.must("define", "M", 0)
    driver.do("is_defined", "M")
    received = fake_central.connection().wait_for_message("x_ipc_registerMessageMsg")
    assert received.value == ("M", BROADCAST, None, None)
    assert len(received.frame.data) == 4 + 1 + 4 + 5 + 5


@pytest.mark.parametrize("version, works", [((3, 0), True), ((3, 9), True), ((3, 77), True),
                                            ((4, 0), False), ((2, 9), False)])
def test_only_the_major_version_of_central_matters(version, works, start_driver):
    """Requirement 4, section 1.4."""
    with FakeCentral(version=version) as central:
        driver = start_driver()
        driver.must("verbosity", 1)
        answer = driver.do("connect", "M", central.address, seconds=20 * SLOW)
        text = driver.output()
        if works:
            assert answer.result == "OK"
            assert "Major Version" not in text
        else:
            driver.wait_for_line("Major Version Number is different from Task Control Server",
                                 stream="stderr")
            driver.wait_for_line(rf"Task Control Server: {version[0]}\.{version[1]}",
                                 stream="stderr")


@pytest.mark.parametrize("length, format_text, wire", [
    ("variable", "int", codec.VARIABLE), ("variable", None, codec.VARIABLE),
    (4, "int", "[byte:4]"), (17, None, "[byte:17]"), (0, None, None)])
def test_a_definition_has_class_15_and_the_wire_format_of_its_length(length, format_text, wire,
                                                                     driver, fake_central):
    """Section 4.2."""
    driver.must("define", "M", length, *([format_text] if format_text else []))
    received = fake_central.connection().wait_for_message("x_ipc_registerMessageMsg")
    assert received.frame.cls == INFORM
    name, cls, wire_text, content = received.value
    assert (name, cls) == ("M", BROADCAST)
    assert codec.parse(wire_text) == codec.parse(wire)
    assert content == format_text


def test_the_close_notice_is_sent_at_disconnect(driver, fake_central):
    """Section 9.1: the notice, or just the end of the connection."""
    driver.must("disconnect")
    fake_central.connection().wait_closed()
    names = [r.name for r in fake_central.connection().received]
    assert names[-1] == "x_ipc_CloseMsg"
