"""How modules that want it come back after the loss of central, by the bytes they send."""
import socket

import pytest

from support import codec
from support.fake_central import FakeCentral, SILENCE
from support.frame import BROADCAST
from support.waiting import wait_until

pytestmark = pytest.mark.new_library("the original does not come back")

HOST = socket.gethostname()


@pytest.fixture
def start_lasting(start_driver):
    """Starts a module that goes on without central; calls fail meanwhile."""
    def start(address, *, mode="fail", **options):
        return start_driver(env={"IPC_RECONNECT": mode}).connect(address, **options)
    return start


def forget(central):
    """What a central that has been started anew does not know."""
    central.definitions.clear()
    central.formats.clear()


def come_back(driver, central, number=1):
    """The module listens until its connection of that number is ready."""
    wait_until(lambda: driver.do("listen", 50) and len(central.connections) > number and
               driver.do("is_connected").result == "1", "the module comes back")
    return central.connection(number)


def told(connection):
    """Everything but look-ups that a connection has brought."""
    return [(received.name, received.value) for received in connection.messages()]


def test_the_central_that_comes_is_told_what_the_old_one_was(start_lasting, fake_central):
    driver = start_lasting(fake_central.address)
    driver.must("format", "pair", "{int, int}")
    driver.must("define", "Second", "8", "pair")
    driver.must("define", "First", "variable", "string")
    driver.must("define", "Second", "variable", "pair")
    driver.must("subscribe", "First")
    driver.must("subscribe", "Elsewhere")
    driver.must("watch_connect")
    driver.must("watch_handlers", "First")
    driver.must("capacity", 3)
    driver.must("limit", "First", 5)
    driver.must("priority", "Elsewhere", 2)
    subscribed = [r.value for r in fake_central.connection().messages("x_ipc_registerHandlerMsg")]
    forget(fake_central)
    fake_central.connection().drop()
    connection = come_back(driver, fake_central)
    introduction, *rest = told(connection)
    assert introduction == ("x_ipc_newModuleConnectMsg", ("DRIVER", HOST[:32]))
    assert rest == [
        ("x_ipc_registerNamedFormMsg", ("pair", "{int, int}")),
        ("x_ipc_registerMessageMsg", ("Second", BROADCAST, "{int, <byte:1>}", "pair")),
        ("x_ipc_registerMessageMsg", ("First", BROADCAST, "{int, <byte:1>}", "string")),
        ("x_ipc_notifyHandlerChange", "First"),
        *(("x_ipc_registerHandlerMsg", value) for value in subscribed),
        ("x_ipc_registerResourceMsg", (3, "DRIVER")),
        ("x_ipc_limitPendingMsg", ("First", "DRIVER", 5)),
        ("ipc_setMsgPriority", ("Elsewhere", 2)),
        ("V_get_X_IPC_BROADCAST_MSG_VAR", None),
        ("x_ipc_waitMsg", None)]


def test_what_comes_over_the_new_connection_is_handled_and_acknowledged(
        start_lasting, fake_central):
    driver = start_lasting(fake_central.address)
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    first = fake_central.connection()
    first.deliver("M", b"one")
    assert driver.listen_for(1) == ["message 0 M 3 " + b"one".hex()]
    first.drop()
    second = come_back(driver, fake_central)
    dispatch = second.deliver("M", b"two")
    assert driver.listen_for(1) == ["message 0 M 3 " + b"two".hex()]
    second.wait_acknowledged(dispatch)
    assert len(second.acknowledgements()) == 1


def test_a_delivery_of_the_old_central_is_not_acknowledged_to_the_new_one(
        start_lasting, fake_central):
    driver = start_lasting(fake_central.address)
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    driver.must("capacity", 2)
    first = fake_central.connection()
    first.deliver("M", b"one")
    assert driver.do("module_connected", "nobody").result == "0"  # and the message has arrived
    first.drop()
    assert driver.do("handlers", "M").result == "-1"
    assert driver.do("events").result == "0"
    second = come_back(driver, fake_central)
    assert driver.do("events").result == "1"
    driver.do("is_defined", "other")
    assert second.acknowledgements() == []


def test_the_way_by_unix_socket_is_tried_first(start_lasting, stack):
    central = stack.enter_context(FakeCentral(unix=True))
    driver = start_lasting(f"{HOST}:{central.port}")
    assert central.connection().transport == "unix"
    central.connection().drop()
    assert come_back(driver, central).transport == "unix"


# --------------------------------------------------------------- centrals that fail

def refuse(connection, _value=None):
    connection.drop()
    return SILENCE


def expect_to_come_back_after(driver, central, restore):
    """The module has failed twice, and its next try succeeds."""
    wait_until(lambda: driver.do("listen", 50) and len(central.connections) >= 3,
               "the module tries again")
    restore()
    wait_until(lambda: driver.do("listen", 50) and driver.do("is_connected").result == "1",
               "the module comes back")
    assert driver.do("module_connected", "DRIVER").result == "1"


@pytest.mark.parametrize("greet", [
    refuse, lambda connection: connection.send_bytes(b"HTTP/1.0 400 Bad Request\r\n\r\n"),
    lambda connection: connection.send_bytes(b"\xff" * 100)],
    ids=["closes", "another protocol", "nonsense"])
def test_a_server_that_is_no_central_is_tried_again(start_lasting, fake_central, greet):
    driver = start_lasting(fake_central.address)
    fake_central.greet = lambda connection: [greet(connection), connection.drop()]
    fake_central.connection().drop()
    expect_to_come_back_after(driver, fake_central, lambda: delattr(fake_central, "greet"))


@pytest.mark.parametrize("message", ["x_ipc_msgInfoMsg", "x_ipc_newModuleConnectMsg",
                                     "x_ipc_waitMsg"])
def test_a_central_that_goes_in_the_handshake_is_tried_again(
        start_lasting, fake_central, message):
    driver = start_lasting(fake_central.address)
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    fake_central.answers[message] = refuse
    fake_central.connection().drop()
    expect_to_come_back_after(driver, fake_central, fake_central.answers.clear)


def test_a_central_of_another_major_version_is_tried_again(start_lasting, fake_central):
    driver = start_lasting(fake_central.address)
    fake_central.version = (4, 0)
    fake_central.connection().drop()
    expect_to_come_back_after(driver, fake_central,
                              lambda: setattr(fake_central, "version", (3, 10)))


def test_a_central_that_keeps_silent_holds_nobody_up(start_lasting, fake_central):
    driver = start_lasting(fake_central.address)
    fake_central.greet = lambda connection: None
    fake_central.connection().drop()
    wait_until(lambda: driver.do("listen", 20) and len(fake_central.connections) == 2,
               "the module tries again")
    assert driver.do("listen", 20).result == "Timeout"
    assert driver.do("publish", "M").error == "Not_Connected"
    fake_central.connections[1].send_bytes(fake_central.prelude())
    come_back(driver, fake_central)


def test_nothing_is_sent_before_the_handshake_is_over(start_lasting, fake_central):
    """Calls meanwhile fail and leave no bytes behind."""
    driver = start_lasting(fake_central.address)
    driver.must("define", "M", "variable")
    fake_central.answers["x_ipc_waitMsg"] = lambda *_: SILENCE
    fake_central.connection().drop()
    wait_until(lambda: driver.do("listen", 20) and len(fake_central.connections) == 2,
               "the module tries again")
    connection = fake_central.connection(1)
    wait_until(lambda: driver.do("listen", 20) and connection.messages("x_ipc_waitMsg"),
               "the module is ready")
    before = len(connection.received)
    assert driver.do("publish", "M").error == "Not_Connected"
    assert driver.do("define", "N", "variable").error == "Not_Connected"
    assert driver.do("handlers", "M").result == "-1"
    assert driver.do("is_connected").result == "0"
    ready = connection.messages("x_ipc_waitMsg")[0]
    assert len(connection.received) == before
    connection.reply(ready, codec.encode("int", 1))
    come_back(driver, fake_central)


def lose_early(start_lasting, central, answer):
    """A module that has subscribed to M and lost central, which gives that answer to "ready"."""
    driver = start_lasting(central.address)
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    central.answers["x_ipc_waitMsg"] = answer
    central.connection().drop()
    return driver


def test_a_message_that_comes_before_the_handshake_is_over_waits_for_that(
        start_lasting, fake_central):
    dispatches = []

    def deliver(connection, _received):
        dispatches.append(connection.deliver("M", b"early"))
        return SILENCE

    driver = lose_early(start_lasting, fake_central, deliver)
    wait_until(lambda: driver.do("listen", 20) and dispatches, "the message is sent")
    connection = fake_central.connection(1)
    assert driver.do("listen", 50).events == []
    connection.reply(connection.messages("x_ipc_waitMsg")[0], codec.encode("int", 1))
    events = driver.listen_for(1)
    assert events == ["message 0 M 5 " + b"early".hex()]
    connection.wait_acknowledged(dispatches[0])


def test_a_message_of_a_handshake_that_failed_is_acknowledged_to_nobody(
        start_lasting, fake_central):
    def deliver_and_go(connection, _received):
        del fake_central.answers["x_ipc_waitMsg"]
        connection.deliver("M", b"early")
        connection.drop()
        return SILENCE

    driver = lose_early(start_lasting, fake_central, deliver_and_go)
    connection = come_back(driver, fake_central, 2)
    assert driver.do("module_connected", "DRIVER").result == "1"
    assert connection.acknowledgements() == []
    dispatch = connection.deliver("M", b"late")
    driver.listen_for(1)
    connection.wait_acknowledged(dispatch)
    assert len(connection.acknowledgements()) == 1
