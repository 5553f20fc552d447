"""The guarantee: a publication that begins after a subscription has returned is delivered, and
the messages of one publisher arrive in order.  Library and central under test together."""
import os
import signal
import socket

import pytest

from support.driver import texts_in
from support.waiting import PATIENCE, SLOW

pytestmark = pytest.mark.new_library("it drops by a stale list and reverses first messages")

HOST = socket.gethostname()
KIB, MIB = 1 << 10, 1 << 20
SIZES = {"0 bytes": (10_000, 0), "8 bytes": (10_000, 8), "100 bytes": (10_000, 100),
         "4 KiB": (3_000, 4 * KIB), "64 KiB": (300, 64 * KIB), "1 MiB": (20, MIB),
         "8 MiB": (4, 8 * MIB)}


def received(driver, name):
    """How many messages of that name a driver has seen, out of order, and damaged."""
    return tuple(int(number) for number in driver.do("report", name).result.split())


@pytest.fixture
def connected(start_driver, central):
    """Starts drivers that are connected to the central under test."""
    return lambda name, **options: start_driver(name).connect(central.address, **options)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("capacity", [1, 4, 100])
def test_every_message_arrives_whole_and_in_order(capacity, size, connected):
    """10,000 out of 10,000 at every capacity, and as many large ones as time allows."""
    count, length = SIZES[size]
    subscriber, publisher = connected("SUB"), connected("PUB")
    publisher.must("define", "numbers", "variable")
    subscriber.must("capacity", capacity)
    subscriber.must("subscribe", "numbers", 0, "sequence")
    seconds = 20 * SLOW
    subscriber.start("until", count, int(seconds * 1000))
    publisher.must("burst", "numbers", count, length, 1, seconds=seconds)
    assert subscriber.finish(seconds + PATIENCE).result == "OK", received(subscriber, "numbers")
    assert received(subscriber, "numbers") == (count, 0, 0)


@pytest.mark.parametrize("capacity", [1, 20])
def test_messages_of_several_publishers_each_arrive_in_order(capacity, connected):
    """Order holds for each publisher; nothing is lost between them."""
    subscriber = connected("SUB")
    subscriber.must("capacity", capacity)
    subscriber.must("subscribe", "numbers", 0, "sequence")
    publishers = [connected(f"PUB{number}") for number in range(3)]
    seconds = 30 * SLOW
    subscriber.start("until", 6000, int(seconds * 1000))
    for number, publisher in enumerate(publishers):
        publisher.must("define", "numbers", "variable")
        publisher.start("burst", "numbers", 2000, 64, number)
    for publisher in publishers:
        assert publisher.finish(seconds).result == "OK"
    assert subscriber.finish(seconds + PATIENCE).result == "OK", received(subscriber, "numbers")
    assert received(subscriber, "numbers") == (6000, 0, 0)


def test_every_subscriber_gets_everything(connected):
    """Four subscribers with different capacities, one of them slow."""
    subscribers = [connected(f"SUB{number}") for number in range(4)]
    for number, subscriber in enumerate(subscribers):
        subscriber.must("capacity", 1 + 3 * number)
        subscriber.must("subscribe", "numbers", 0, "sequence")
    publisher = connected("PUB")
    publisher.must("define", "numbers", "variable")
    seconds = 30 * SLOW
    for subscriber in subscribers[1:]:
        subscriber.start("until", 2000, int(seconds * 1000))
    publisher.must("burst", "numbers", 2000, 200, 1, seconds=seconds)
    for subscriber in subscribers[1:]:
        assert subscriber.finish(seconds + PATIENCE).result == "OK"
    # This one has not listened at all while the others did.
    subscribers[0].until(2000, seconds)
    assert [received(subscriber, "numbers") for subscriber in subscribers] == [(2000, 0, 0)] * 4


@pytest.mark.parametrize("publisher_host", ["localhost", HOST], ids=["tcp", "unix"])
@pytest.mark.parametrize("subscriber_host", ["localhost", HOST], ids=["tcp", "unix"])
def test_nothing_is_lost_between_subscribing_and_publishing(
        subscriber_host, publisher_host, central, start_driver, tmp_path):
    """500 races of two processes: the publisher, which never listens, is told by a byte in a pipe
    the moment that IPC_subscribe has returned, and publishes at once."""
    rounds = 500
    fifo = str(tmp_path / "race")
    os.mkfifo(fifo)
    subscriber = start_driver("SUB").connect(f"{subscriber_host}:{central.port}")
    publisher = start_driver("PUB").connect(f"{publisher_host}:{central.port}")
    publisher.start("race_publish", rounds, fifo)
    subscriber.start("race_subscribe", rounds, fifo, int(1000 * SLOW))
    assert subscriber.finish(60 * SLOW).result == "0"
    assert publisher.finish().result == str(rounds)


def test_nothing_is_lost_between_a_subscription_and_a_no_listen_publisher(connected, tmp_path):
    """The same with a publisher that has connected no-listen."""
    rounds = 200
    fifo = str(tmp_path / "race")
    os.mkfifo(fifo)
    subscriber, publisher = connected("SUB"), connected("PUB", listen=False)
    publisher.start("race_publish", rounds, fifo)
    subscriber.start("race_subscribe", rounds, fifo, int(1000 * SLOW))
    assert subscriber.finish(60 * SLOW).result == "0"
    assert publisher.finish().result == str(rounds)


def test_a_module_hears_itself_right_after_it_has_subscribed(connected):
    """Subscribe, then publish at once in the same module."""
    module = connected("SELF")
    for number in range(50):
        name = f"self{number}"
        module.must("define", name, "variable")
        module.must("subscribe", name)
        module.must("publish", name, str(number))
        assert texts_in(module.until(number + 1)) == [str(number)]


def test_many_messages_to_oneself_are_no_problem(connected):
    """Both directions of one connection are full; publishing goes on reading while it waits."""
    module = connected("SELF")
    module.must("capacity", 1000)
    module.must("define", "numbers", "variable")
    module.must("subscribe", "numbers", 0, "sequence")
    module.must("burst", "numbers", 2000, 2000, 1, seconds=30 * SLOW)
    module.until(2000, 30 * SLOW)
    assert received(module, "numbers") == (2000, 0, 0)


def test_two_modules_that_flood_each_other_do_not_lock_each_other(connected):
    """Neither listens while it publishes 8 MB."""
    modules = [connected("A"), connected("B")]
    for module, mine in zip(modules, "ab"):
        module.must("capacity", 10_000)
        module.must("define", mine, "variable")
        module.must("subscribe", mine, 0, "sequence")
    for module, theirs in zip(modules, "ba"):
        module.must("define", theirs, "variable")
        module.start("burst", theirs, 400, 20_000, 1)
    for module in modules:
        assert module.finish(30 * SLOW).result == "OK"
    for module, mine in zip(modules, "ab"):
        module.until(400, 30 * SLOW)
        assert received(module, mine) == (400, 0, 0)


def test_queries_go_back_and_forth(connected):
    """Each query gets its own answer."""
    server, client = connected("SERVER"), connected("CLIENT")
    server.must("define", "Q", "variable", "int")
    server.must("define", "A", "variable", "int")
    server.must("subscribe", "Q", 0, "double", "A")
    server.must("serve")
    for number in range(200):
        assert client.must("query_data", "Q", "A", 5000, "int", number).reply == str(2 * number)


def test_a_stopped_central_costs_nothing_but_time(connected, central):
    """Published while central stands still: everything arrives when it goes on."""
    subscriber, publisher = connected("SUB"), connected("PUB")
    publisher.must("define", "numbers", "variable")
    subscriber.must("subscribe", "numbers", 0, "sequence")
    publisher.must("burst", "numbers", 1, 1000, 1)
    central.signal(signal.SIGSTOP)
    publisher.start("burst", "numbers", 2000, 1000, 1, 1)
    central.signal(signal.SIGCONT)
    assert publisher.finish(30 * SLOW).result == "OK"
    subscriber.until(2001, 30 * SLOW)
    assert received(subscriber, "numbers") == (2001, 0, 0)
