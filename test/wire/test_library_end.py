"""How modules take the loss of central (requirement 44, section 9.3)."""
import pytest

from support.driver import Ended
from support.waiting import SLOW


def test_a_listening_module_reports_the_loss_and_exits_with_255(driver, fake_central):
    """Requirement 44."""
    driver.start("dispatch")
    fake_central.connection().drop()
    assert driver.wait() == 255
    assert f"Closed Connection Detected from: Central Server {fake_central.address}" \
        not in driver.output()


def test_the_loss_is_reported_when_errors_are_printed(start_driver, fake_central):
    """Requirement 44: the text, at verbosity 2 and 3."""
    driver = start_driver().connect(fake_central.address, verbosity=2)
    driver.start("dispatch")
    fake_central.connection().drop()
    assert driver.wait() == 255
    assert f"Closed Connection Detected from: Central Server {fake_central.address}" \
        in driver.output()


@pytest.mark.parametrize("verbosity", [0, 1, 2, 3])
def test_the_loss_ends_the_module_at_every_verbosity(verbosity, start_driver, fake_central):
    """Section 9.3: whatever the verbosity."""
    driver = start_driver().connect(fake_central.address, verbosity=verbosity)
    driver.start("listen", 10000)
    fake_central.connection().drop()
    assert driver.wait() == 255


@pytest.mark.parametrize("command", [
    ("is_defined", "M"), ("handlers", "M"), ("module_connected", "M"), ("listen", 2000),
    ("listen_wait", 2000), ("listen_clear", 2000)], ids=lambda command: command[0])
def test_calls_that_read_notice_the_loss(command, driver, fake_central):
    """Section 9.3, api-behaviour 16.1."""
    fake_central.connection().drop()
    driver.start(*command)
    with pytest.raises(Ended):
        driver.finish(10 * SLOW)
    assert driver.wait() == 255


def test_a_waiting_query_ends_with_the_loss(driver, fake_central):
    """api-behaviour 16.1."""
    fake_central.define("Q", None)
    driver.start("query", "Q", "text", 10000)
    fake_central.connection().wait_for_message("Q")
    fake_central.connection().drop()
    assert driver.wait() == 255


@pytest.mark.new_library("it asks central before it leaves, and exits with 255")
def test_disconnecting_from_a_central_that_is_gone_is_no_error(driver, fake_central):
    """api-behaviour 16.1, defect B6."""
    fake_central.connection().drop()
    driver.must("disconnect")
    assert driver.do("is_connected").result == "0"
    assert "Pipe" not in driver.output()


@pytest.mark.new_library("notices always succeed")
def test_a_write_to_a_central_that_is_gone_fails_sooner_or_later(driver, fake_central):
    """api-behaviour 16.1: Error, E:Communication_Error, and IPC_isConnected becomes 0."""
    fake_central.connection().drop()
    answers = []
    for number in range(50):
        answers.append(driver.do("define", f"M{number}", "variable"))
        if answers[-1].error:
            break
    assert answers[-1].error == "Communication_Error"
    assert driver.do("is_connected").result == "0"
    assert "Pipe Broke" not in driver.output()


def test_what_arrived_before_the_end_is_handled_first(driver, fake_central):
    """Section 2.5: everything that is there is read before the end is seen."""
    driver.must("define", "M", "variable")
    driver.must("subscribe", "M")
    connection = fake_central.connection()
    connection.wait_subscribed("M")
    driver.do("is_defined", "M")
    connection.deliver("M", b"last words")
    driver.start("until", 1, 2000)
    assert driver.finish().events == ["message 0 M 10 " + b"last words".hex()]
    connection.drop()
    driver.start("listen", 5000)
    assert driver.wait() == 255


def test_leaving_in_order_gives_exit_status_0(driver, fake_central):
    """Section 9.1."""
    assert driver.leave() == 0
    fake_central.connection().wait_closed()
