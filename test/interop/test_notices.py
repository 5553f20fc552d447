"""What modules learn of each other, and how they outlive each other, in every mix of ours and
theirs."""
from support.driver import data_in, texts_in
from support.waiting import SLOW


def test_notices_of_modules_and_handlers(pair, mix, server, settle, start_driver):
    """Who connects, who leaves, who subscribes."""
    watcher, other = pair
    watcher.must("watch_connect")
    watcher.must("watch_disconnect")
    watcher.must("define", "M", "variable")
    watcher.must("watch_handlers", "M")
    settle(watcher)
    assert watcher.do("module_connected", "SECOND").result == "1"
    assert watcher.do("handlers", "M").result == "0"
    other.must("subscribe", "M")
    assert "handlers M 1" in watcher.gather(1)
    assert watcher.do("handlers", "M").result == "1"
    other.must("unsubscribe", "M")
    assert "handlers M 0" in watcher.gather(1)
    assert other.leave() == 0
    assert "disconnected SECOND" in watcher.gather(1)
    assert watcher.do("module_connected", "SECOND").result == "0"
    start_driver("LATER", using=mix.second).connect(server.address)
    assert "connected LATER" in watcher.gather(1)


def test_notices_that_are_not_wanted_any_more(pair, mix, server, settle, start_driver):
    """IPC_unsubscribeConnect, IPC_unsubscribeHandlerChange."""
    watcher, other = pair
    watcher.must("watch_connect")
    watcher.must("watch_disconnect")
    watcher.must("define", "M", "variable")
    watcher.must("watch_handlers", "M")
    settle(watcher)
    watcher.must("unwatch_connect")
    watcher.must("unwatch_handlers", "M")
    settle(watcher)
    other.must("subscribe", "M")
    later = start_driver("LATER", using=mix.second).connect(server.address)
    assert later.leave() == 0
    assert watcher.gather(1) == ["disconnected LATER"]


def test_the_abrupt_death_of_a_subscriber(pair, settle):
    """The other learns of it, and goes on."""
    first, second = pair
    first.must("define", "M", "variable")
    first.must("watch_disconnect")
    second.must("subscribe", "M", 0, "kill")
    settle(second, first)
    first.must("publish", "M", "last words")
    first.do("is_defined", "x")
    second.start("until", 99, 5000 * SLOW)
    assert first.gather(1) == ["disconnected SECOND"]
    assert second.wait() == -9
    first.must("subscribe", "M")
    settle(first)
    first.must("publish", "M", "to myself")
    assert texts_in(first.gather(1)) == ["to myself"]


def test_the_abrupt_death_of_a_publisher(pair, mix, server, settle, start_driver):
    """The subscriber learns of it, and serves the next publisher."""
    first, second = pair
    second.must("define", "M", "variable", "int")
    second.must("watch_disconnect")
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", "int", 1)
    assert data_in(second.gather(1)) == ["1"]
    first.signal(9)
    assert second.gather(1) == ["disconnected FIRST"]
    again = start_driver("FIRST", using=mix.first).connect(server.address)
    settle(again)
    again.must("publish_data", "M", "int", 2)
    assert data_in(second.gather(1)) == ["2"]


def test_the_abrupt_death_of_an_answerer(pair, settle):
    """The query ends after its time, and the asker goes on."""
    asker, answerer = pair
    asker.must("define", "Q", "variable", "int")
    asker.must("define", "A", "variable", "int")
    asker.do("is_defined", "A")
    answerer.must("subscribe", "Q", 0, "kill")
    settle(answerer, asker)
    asker.start("query_data", "Q", "A", 300, "int", 1)
    answerer.start("until", 99, 5000 * SLOW)
    assert asker.finish().result == "Timeout"
    assert answerer.wait() == -9
    assert asker.do("module_connected", "SECOND").result == "0"
    assert asker.do("handlers", "Q").result == "0"


def test_the_end_of_a_subscriber_is_not_noticed_by_a_publisher_that_does_not_listen(pair, settle):
    """It goes on publishing."""
    first, second = pair
    first.must("define", "M", "variable", "int")
    first.do("is_defined", "M")
    second.must("subscribe_data", "M")
    settle(second, first)
    first.must("publish_data", "M", "int", 1)
    second.gather(1)
    assert second.leave() == 0
    first.must("publish_data", "M", "int", 2)
    settle(first)
    first.must("publish_data", "M", "int", 3)
    assert first.do("is_connected").result == "1"
