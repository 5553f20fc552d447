"""Byte arrays from modules on other machines, and such that are not what their format says."""
import os
import socket
import subprocess

import pytest

from support import codec
from support.waiting import PATIENCE

HERE = os.path.dirname(os.path.abspath(__file__))
FORMAT = "{int, string}"


class Player:
    """A module of foreign_data.c."""

    def __init__(self, program, player, central, library):
        self.control, theirs = socket.socketpair()
        self.control.settimeout(PATIENCE)
        environment = {**os.environ, **library.environment(), "ASAN_OPTIONS": "detect_leaks=0"}
        self.process = subprocess.Popen(
            [program, player, central.address, str(theirs.fileno())], stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, env=environment,
            pass_fds=[theirs.fileno()])
        theirs.close()

    def __enter__(self):
        assert self.control.recv(4) == b"\0\0\0\0", self.process.communicate()
        return self

    def __exit__(self, *_):
        self.control.close()
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def output(self):
        """What the module has printed by its end: standard output, standard error."""
        out, err = self.process.communicate(timeout=2 * PATIENCE)
        assert self.process.returncode == 0, (out, err)
        return out, err


@pytest.fixture
def play(stack, compiler, library, central):
    """Starts a player, which listens when this returns."""
    def start(player):
        program = compiler.program(
            [os.path.join(HERE, "foreign_data.c"), os.path.join(HERE, "check.c")], library,
            includes=[HERE], flags=["-std=c99", "-D_DEFAULT_SOURCE", "-D_XOPEN_SOURCE=700"])
        return stack.enter_context(Player(program, player, central, library))
    return start


@pytest.fixture
def big(join):
    """A module of the other byte order that has defined the message."""
    peer = join("BIG", order=">")
    peer.define("value", FORMAT)
    peer.define("other", "int")
    peer.sync()
    return peer


def value_bytes(number, text, order):
    return codec.encode(FORMAT, (number, text), order)


@pytest.mark.new_library("it takes the order of the message that came last")
def test_an_array_is_unmarshalled_in_its_own_order_after_one_of_another_order_has_come(
        play, big, join):
    small = join("SMALL")
    player = play("unmarshalls_later")
    big.publish("value", value_bytes(7, "seven", ">"))
    big.sync()
    small.publish_number("other", 1)
    assert player.output() == ("7 seven\n7 seven\n", "")


def test_an_array_of_the_other_order_is_unmarshalled_in_the_handler(play, big):
    player = play("unmarshalls_at_once")
    big.publish("value", value_bytes(9, "nine", ">"))
    assert player.output() == ("9 nine\n", "")


TRUNCATED = [value_bytes(7, "seven", "<")[:length] for length in (1, 4, 7, 8, 12)]


@pytest.mark.new_library("it reads what is behind the array")
@pytest.mark.parametrize("content", TRUNCATED, ids=len)
def test_a_truncated_array_is_refused_in_the_handler(play, big, join, content):
    player = play("unmarshalls_at_once")
    join("SMALL").publish("value", content)
    assert player.output() == ("error 10\n", "")


@pytest.mark.new_library("it reads what is behind the array")
@pytest.mark.parametrize("content", TRUNCATED, ids=len)
def test_a_truncated_array_is_refused_later(play, big, join, content):
    small = join("SMALL")
    player = play("unmarshalls_later")
    small.publish("value", content)
    small.publish_number("other", 1)
    assert player.output() == ("error 10\nerror 10\n", "")


@pytest.mark.new_library("it reads what is behind the array")
def test_truncated_data_reach_no_handler_and_are_warned_of(play, big, join):
    small = join("SMALL")
    player = play("wants_data")
    small.publish("value", TRUNCATED[3])
    small.publish_number("other", 1)
    assert player.output() == ("", "WARNING: Message 'value' could not be decoded\n")
