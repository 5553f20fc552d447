"""Central's side of the recordings, played against modules on the library under test."""
import pytest

from support import captures
from support.driver import data_in, messages_in, replies_in
from support.library_replay import RecordedCentral

INT = "3000"  # milliseconds that a module waits for what the recording brings


def number(value):
    """An int as content bytes."""
    return value.to_bytes(4, "little")


def until(count):
    return ("until", count, INT)


# Capture, connection: what the module does between connecting and leaving.
SCRIPTS = {
    ("01-publish-int.txt", "S"): [("subscribe", "M1"), until(1)],
    ("01-publish-int.txt", "P"): [("define", "M1", "variable", "int"),
                                  ("publish_data", "M1", "int", 0x12345678)],
    ("02-two-subscribers.txt", "S"): [("define", "M1", "variable", "int"),
                                      ("subscribe", "M1", 0), ("subscribe", "M1", 1), until(2)],
    ("02-two-subscribers.txt", "T"): [("subscribe", "M1"), until(1)],
    ("03-query-routed.txt", "S"): [("define", "Q", "variable", "int"),
                                   ("define", "A", "variable", "int"),
                                   ("subscribe", "Q", 0, "double", "A"), until(2)],
    ("03-query-routed.txt", "C"): [("query_data", "Q", "A", INT, "int", 21),
                                   ("notify_data", "Q", "tag", "int", 30), until(1)],
    ("06-named-formats.txt", "D"): [
        ("format", "point", "{int,int}"), ("format", "seg", "{point,point}"),
        ("define", "SEG", "variable", "seg"), ("define", "RAWV", "variable"),
        ("define", "FIX4", 4, "int"), ("define", "ZERO", 0),
        ("define", "STR", "variable", "string"),
        ("define", "EN", "variable", "{{enum A,B,C},[double:3],{enum :300},*int}"),
        ("define", "LIST", "variable", "{int,*!}"), ("listen_wait", 300)],
    ("06-named-formats.txt", "U"): [
        ("check_formats", "SEG", "{point,point}"), ("check_formats", "EN", "int"),
        ("check_formats", "LIST", "int"), ("subscribe_data", "STR"), ("subscribe", "ZERO"),
        ("subscribe", "RAWV"), ("subscribe", "FIX4"), ("listen_clear", 500),
        ("publish_data", "STR", "string", "hello"), ("publish", "ZERO"),
        ("publish_bytes", "RAWV", b"abcdefg".hex()), ("publish_bytes", "FIX4", "4d000000"),
        until(4)],
    ("07-capacity-priority-queue.txt", "S"): [
        ("define", "L", "variable", "int"), ("define", "H", "variable", "int"), ("capacity", 2),
        ("priority", "H", 9), ("limit", "L", 2), ("subscribe", "L"), ("subscribe", "H"), until(6)],
    ("07-capacity-priority-queue.txt", "P"): [
        *(("publish_data", "L", "int", value) for value in range(1, 7)),
        ("publish_data", "H", "int", 101), ("publish_data", "H", "int", 102)],
    ("08-connect-handler-change.txt", "O"): [
        ("subscribe", "M1"), ("module_connected", "WATCH"), ("listen", 300), ("unsubscribe", "M1"),
        ("listen", 300)],
    ("10-byte-order.txt", "S"): [("define", "M1", "variable", "{int,double,string}"),
                                 ("subscribe_data", "M1"), until(2)],
    ("10-byte-order.txt", "L"): [("publish_data", "M1", "sample", 0x12345678, 2.5, "abc")],
    ("11-delayed-response.txt", "S"): [
        ("define", "Q", "variable", "int"), ("define", "A", "variable", "int"),
        ("define", "EV", "variable", "int"), ("subscribe", "Q", 0, "delay"), ("subscribe", "EV", 1),
        until(1), ("respond_data", "A", "int", 99), until(2)],
    ("11-delayed-response.txt", "C"): [
        ("notify_data", "Q", "tag", "int", 21), ("publish_data", "EV", "int", 1), until(1),
        ("listen", 300), ("listen", 300)],
    ("12-resubscribe.txt", "O"): [
        ("define", "M1", "variable", "int"), ("subscribe", "M1"), ("listen", 300),
        ("publish_data", "M1", "int", 1), until(1), ("subscribe", "M1"),
        ("publish_data", "M1", "int", 2), until(2), ("unsubscribe", "M1"), ("listen", 300),
        ("subscribe", "M1"), ("listen", 300), ("publish_data", "M1", "int", 3), until(3)],
    ("14-no-listen.txt", "N"): [("define", "M1", "variable", "int"),
                                ("publish_data", "M1", "int", 1)],
    ("16-long-32-64.txt", "Q"): [("publish_data", "M1", "long", 0x1122334455667788)],
}

# What handlers see, in order.
SEEN = {
    ("01-publish-int.txt", "S"): [number(0x12345678)],
    ("02-two-subscribers.txt", "S"): [number(7), number(7)],
    ("02-two-subscribers.txt", "T"): [number(7)],
    ("03-query-routed.txt", "S"): [number(21), number(30)],
    ("07-capacity-priority-queue.txt", "S"): [number(n) for n in (1, 2, 101, 102, 5, 6)],
    ("10-byte-order.txt", "S"): ['{305419896, 2.50, "abc"}'] * 2,
    ("11-delayed-response.txt", "S"): [number(21), number(1)],
    ("12-resubscribe.txt", "O"): [number(1), number(2), number(3)],
    ("06-named-formats.txt", "U"): [b"", b"abcdefg", number(77), '"hello"'],
    ("03-query-routed.txt", "C"): [("tag", "A", "60")],
    ("11-delayed-response.txt", "C"): [("tag", "A", "99")],
}


@pytest.mark.parametrize("name, tag", SCRIPTS, ids=lambda part: part)
def test_a_module_sends_what_the_original_sent(name, tag, start_driver, stack):
    """Requirements 7, 9, 19, 26, 29, 31, 32: every frame but look-ups and handshake, byte for
    byte."""
    capture = captures.Capture(name)
    central = stack.enter_context(RecordedCentral(capture, tag))
    module = capture.connections[tag].module
    driver = start_driver(module)
    driver.must("verbosity", 1)
    connect = "connect_no_listen" if name.startswith("14") else "connect"
    commands = [(connect, module, central.address), *SCRIPTS[name, tag], ("disconnect",)]
    for command in commands:
        driver.start(*command)
    compared = central.replay(central.connection())
    events = []
    for command in commands:
        answer = driver.finish()
        events += answer.events
        if command[0] not in ("listen", "listen_wait", "listen_clear", "check_formats",
                              "module_connected"):
            assert answer.result.split()[0] == "OK", f"{command}: {answer.result}"
    seen = [content for _, _, content in messages_in(events)] + data_in(events) \
        + replies_in(events)
    wanted = SEEN.get((name, tag), [])
    if name.startswith("07"):
        # Whether a message of high priority overtakes one that waits depends on when it comes.
        seen, wanted = sorted(seen), sorted(wanted)
    assert seen == wanted
    assert compared >= 2
    central.connection().wait_closed()


def test_a_long_of_another_size_in_a_recording_is_not_misread(start_driver, stack):
    """Section 8.4, capture 16: 4 bytes from a 32-bit publisher, then 8 bytes."""
    capture = captures.Capture("16-long-32-64.txt")
    central = stack.enter_context(RecordedCentral(capture, "S"))
    driver = start_driver("SUB64")
    driver.must("verbosity", 1)
    commands = [("connect", "SUB64", central.address), ("define", "M1", "variable", "long"),
                ("subscribe", "M1"), until(2), ("disconnect",)]
    for command in commands:
        driver.start(*command)
    central.replay(central.connection())
    events = [event for _ in commands for event in driver.finish().events]
    assert [content for _, _, content in messages_in(events)] == [
        bytes.fromhex("44332211"), bytes.fromhex("8877665544332211")]


def test_a_watcher_of_connections_and_handlers_is_told_as_recorded(start_driver, stack):
    """Requirements 46, 47, capture 08."""
    capture = captures.Capture("08-connect-handler-change.txt")
    central = stack.enter_context(RecordedCentral(capture, "W"))
    driver = start_driver("WATCH")
    driver.must("verbosity", 1)
    commands = [("connect", "WATCH", central.address), ("watch_connect",), ("watch_disconnect",),
                ("define", "M1", "variable", "int"), ("watch_handlers", "M1"), ("handlers", "M1"),
                until(4), ("unwatch_handlers", "M1"), ("unwatch_connect",),
                ("disconnect",)]
    for command in commands:
        driver.start(*command)
    central.replay(central.connection())
    events = [event for _ in commands for event in driver.finish().events]
    wanted = ["connected OTHER", "handlers M1 1", "handlers M1 0", "disconnected OTHER"]
    assert [event for event in events if event in wanted] == wanted
