"""Who gets which message, in every mix of ours and theirs."""
from support.driver import data_in, messages_in, texts_in
from support.waiting import SLOW, wait_until


def handlers_called(driver, count):
    """The handlers that the next count messages have called."""
    return [handler for handler, _, _ in messages_in(driver.gather(count))]


def test_two_handlers_of_one_message(pair, prime):
    """Both are called, in order of subscription."""
    first, second = pair
    first.must("define", "M", "variable")
    prime(first, second, "M", handlers=(1, 0))
    first.must("publish", "M", "text")
    assert handlers_called(second, 2) == [1, 0]


def test_unsubscribing_one_handler_after_the_other(pair, settle):
    """The others are still called; with the last one the message has no receiver."""
    first, second = pair
    first.must("define", "M", "variable")
    second.must("subscribe", "M", 0)
    second.must("subscribe", "M", 1)
    settle(second, first)
    first.must("publish", "M", "to both")
    assert sorted(handlers_called(second, 2)) == [0, 1]
    second.must("unsubscribe", "M", 0)
    settle(second, first)
    first.must("publish", "M", "to one")
    assert handlers_called(second, 1) == [1]
    second.must("unsubscribe", "M", 1)
    settle(second, first)
    assert first.do("handlers", "M").result == "0"
    first.must("publish", "M", "to nobody")
    second.must("subscribe", "M", 2)
    settle(second, first)
    first.must("publish", "M", "to one again")
    assert messages_in(second.gather(1)) == [(2, "M", b"to one again\0")]


def test_several_subscribers(trio, settle):
    """Each of them gets each message, the publisher too, until it unsubscribes."""
    first, second, third = trio
    first.must("define", "M", "variable", "int")
    first.do("is_defined", "M")
    for driver in trio:
        driver.must("subscribe_data", "M")
    settle(*trio)
    first.must("publish_data", "M", "int", 5)
    assert [data_in(driver.gather(1)) for driver in trio] == [["5"]] * 3
    third.must("unsubscribe_data", "M")
    settle(third, first)
    first.must("publish_data", "M", "int", 6)
    assert [data_in(driver.gather(1)) for driver in (first, second)] == [["6"]] * 2
    assert third.do("listen", 50).events == []


def test_several_publishers(trio, settle):
    """What each of them publishes arrives in its order."""
    first, second, third = trio
    first.must("define", "M", "variable")
    first.do("is_defined", "M")
    second.must("subscribe", "M", 0, "sequence")
    settle(second, first, third)
    for publisher, driver in enumerate((first, third)):
        driver.must("burst", "M", 1, 100, publisher)
        second.gather(1)
    second.start("until", 102, 5000 * SLOW)
    for publisher, driver in enumerate((first, third)):
        driver.start("burst", "M", 50, 100, publisher, 1)
    assert second.finish(10 * SLOW).result == "OK"
    for driver in (first, third):
        assert driver.finish().result == "OK"
    assert second.do("report", "M").result == "102 0 0"


def test_messages_to_oneself(pair, settle):
    """Each module is among the receivers of its own message."""
    for driver in pair:
        name = f"self{driver.name}"
        driver.must("define", name, "variable", "int")
        driver.must("subscribe_data", name)
        settle(driver)
        driver.must("publish_data", name, "int", 3)
        assert data_in(driver.gather(1)) == ["3"]


def test_a_subscription_before_the_definition(pair, settle):
    """It counts, though the message is not defined yet."""
    first, second = pair
    second.must("subscribe_data", "M")
    settle(second, first)
    assert first.do("is_defined", "M").result == "0"
    assert first.do("handlers", "M").result == "1"
    first.must("define", "M", "variable", "{int, double, string}")
    settle(first, second)
    first.must("publish_data", "M", "sample", 4, 0.25, "late")
    assert data_in(second.gather(1)) == ['{4, 0.25, "late"}']


def test_a_no_listen_publisher(mix, server, start_driver, settle):
    """IPC_connectModuleNoListen: sends whether or not anybody subscribes."""
    first = start_driver("FIRST", using=mix.first).connect(server.address, listen=False)
    second = start_driver("SECOND", using=mix.second).connect(server.address)
    first.must("define", "M", "variable")
    first.must("publish", "M", "lost")
    first.do("is_defined", "unknown")  # central is asked, as it is not for a message that is known
    second.must("subscribe", "M")
    settle(second)
    first.must("publish", "M", "found")
    assert texts_in(second.gather(1)) == ["found"]


def test_a_module_may_leave_and_come_back(pair, server, settle):
    """Definitions survive, subscriptions do not."""
    first, second = pair
    first.must("define", "M", "variable", "int")
    second.must("subscribe_data", "M")
    settle(second, first)
    second.must("disconnect")
    wait_until(lambda: first.do("module_connected", "SECOND").result == "0", "SECOND is gone")
    assert first.do("handlers", "M").result == "0"
    second.connect(server.address)
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", "int", 6)
    assert data_in(second.gather(1)) == ["6"]


def test_a_publisher_may_leave_and_come_back(pair, server, settle):
    """Its definitions survive, and so do the subscriptions of others."""
    first, second = pair
    first.must("define", "M", "variable", "int")
    first.do("is_defined", "M")
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", "int", 1)
    assert data_in(second.gather(1)) == ["1"]
    first.must("disconnect")
    wait_until(lambda: second.do("module_connected", "FIRST").result == "0", "FIRST is gone")
    first.connect(server.address)
    settle(first)
    first.must("publish_data", "M", "int", 2)
    assert data_in(second.gather(1)) == ["2"]
