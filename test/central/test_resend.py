"""Option -r: what a module had not finished when it ended."""
import os
import pty
import signal

import pytest

from support.peer import Peer, expect_nothing
from support.processes import Central
from support.waiting import wait_until

pytestmark = pytest.mark.new_central("it asks everywhere, and waits for the answer")


@pytest.fixture
def connect(stack):
    return lambda central, name: stack.enter_context(Peer(central, name)).connect()


def lose_b(central, connect):
    """A has published three messages, B and D handle them; B has got one of them and is gone."""
    a, b, d = (connect(central, name) for name in "ABD")
    a.define("Ping")
    a.sync()
    for peer in (b, d):
        peer.subscribe("Ping", 5)
        peer.sync()
    for number in (1, 2, 3):
        a.publish_number("Ping", number)
    a.sync()
    assert d.take_numbers(3) == [1, 2, 3]
    d.sync()
    assert b.next_delivery().number == 1
    b.close()
    central.wait_for_line("close Module: Closing B")
    return a, d


def join_again(central, connect):
    b = connect(central, "B")
    b.subscribe("Ping", 7)
    b.sync()
    return b


def test_79_without_it_all_is_cleared_active_first(start_central, connect):
    central = start_central("-lmr")
    a, _ = lose_b(central, connect)
    a.sync()
    cleared = [line for line in central.stdout if line.startswith("Clearing handler")]
    sent = next(line for line in central.stdout if "--> B " in line)
    assert len(cleared) == 3
    assert cleared[0].split("{")[1] == sent.split("{")[1].split(":")[0]
    b = join_again(central, connect)
    expect_nothing(b, a)


def test_80_with_it_who_comes_back_gets_all(start_central, connect):
    central = start_central("-lm", "-r")
    a, d = lose_b(central, connect)
    other = connect(central, "OTHER")
    other.subscribe("Ping", 5)
    expect_nothing(other, a)
    b = join_again(central, connect)
    assert b.take_numbers(3) == [1, 2, 3]
    expect_nothing(d, a, b)
    a.publish_number("Ping", 4)
    assert b.take_numbers(1) == [4]
    assert not any("Clearing" in line for line in central.stdout)


def test_somebody_at_a_terminal_is_asked(stack, central_program, connect):
    """The scene of the original's sample 18; the server goes on meanwhile."""
    ours, theirs = pty.openpty()
    central = stack.enter_context(Central(central_program, "-lm", "-r", console=True,
                                          stdin=theirs))
    os.close(theirs)
    a, d = lose_b(central, connect)
    a.publish_number("Ping", 4)
    assert d.take_numbers(1) == [4]
    os.write(ours, b"y\ny\nn\ny\ndisplay\n")
    central.wait_for_line("Active and Pending Messages:")
    wait_until(lambda: central.output().count("}: Pending") == 2, "two wait")
    b = join_again(central, connect)
    assert b.take_numbers(2) == [1, 3]
    expect_nothing(b, a)
    text = central.output()
    assert "\a\aResend active and/or pending messages for the B resource?" in text
    assert text.count("Resend Ping message?") == 3
    assert "Not resending message: Ping" in text
    central.signal(signal.SIGTERM)
    central.wait()
    central.stop_quietly()
    os.close(ours)


def test_a_terminal_that_goes_away_asks_no_more(stack, central_program, connect):
    ours, theirs = pty.openpty()
    central = stack.enter_context(Central(central_program, "-lm", "-r", console=True,
                                          stdin=theirs))
    os.close(theirs)
    a, _ = lose_b(central, connect)
    os.close(ours)
    b = join_again(central, connect)
    assert b.take_numbers(3) == [1, 2, 3]
    expect_nothing(b, a)
