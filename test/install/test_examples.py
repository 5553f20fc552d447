"""The example modules hold the conversation that the manual shows."""
import os
import subprocess

import pytest

from support.driver import texts_in
from support.processes import Process

PATIENCE = 20


class Module(Process):
    """An example module whose keyboard the test has."""

    def __init__(self, build, central, name):
        super().__init__([os.path.join(build.directory, "examples", name)],
                         stdin=subprocess.PIPE, env={"CENTRALHOST": central.address})
        self.wait_for_line(r"^Type ", seconds=PATIENCE)

    def type(self, keys):
        self.process.stdin.write("".join(f"{key}\n" for key in keys).encode())
        self.process.stdin.flush()

    def expect(self, pattern):
        self.wait_for_line(pattern, seconds=PATIENCE)


@pytest.fixture
def converse(build, central, stack):
    """Starts module1 and the module that it is to talk to."""
    def start(other):
        listener = stack.enter_context(Module(build, central, other))
        return stack.enter_context(Module(build, central, "module1")), listener
    return start


def check_conversation(asker, answerer, name):
    asker.type("mr")
    answerer.expect(rf"^msg1Handler: Receiving message1 \(42\) \[{name}\]$")
    answerer.expect(rf"^queryHandler: Receiving query1 \[{name}\]$")
    answerer.expect(r"^\{666, 1, \[\[0.00, 1.00, 2.00\], \[1.00, 2.00, 3.00\]\], 3.14\}$")
    asker.expect(r"^msg2Handler: Receiving message2 \(Hello, world\) \[module1\]$")
    asker.expect(r"^  Received response:$")
    asker.expect(r'^\{"Hello, world", 1, <\{666, 1, ')
    asker.expect(r"^ ReceiveVal\}$")


@pytest.mark.parametrize("other", ["module2", "module3"])
def test_message_and_query_reach_the_other_module_and_its_response_comes_back(converse, other):
    asker, answerer = converse(other)
    check_conversation(asker, answerer, other)
    for module in (asker, answerer):
        module.type("q")
        assert module.wait(PATIENCE) == 0


def test_module3_tells_who_comes_and_goes(converse):
    asker, watcher = converse("module3")
    watcher.expect(r"^connectHandler: module1 has connected \[module3\]$")
    asker.type("q")
    watcher.expect(r"^disconnectHandler: module1 has disconnected \[module3\]$")


@pytest.mark.parametrize("name", ["module1", "module2", "module3"])
def test_the_end_of_the_input_ends_a_module(build, central, stack, name):
    module = stack.enter_context(Module(build, central, name))
    module.process.stdin.close()
    assert module.wait(PATIENCE) == 0


@pytest.mark.parametrize("name", ["event_loop", "event_loop_uv"])
def test_a_module_lives_in_an_event_loop_of_its_own(name, build, central, stack, start_driver):
    """It answers while its loop waits, its timer runs, and it ends with its own descriptor."""
    program = os.path.join(build.directory, "examples", name)
    if not os.path.exists(program):
        pytest.skip(f"{name} was not built: it needs a library that was not there")
    module = stack.enter_context(Process([program], stdin=subprocess.PIPE,
                                         env={"CENTRALHOST": central.address}))
    module.wait_for_line("^ready$", seconds=PATIENCE)
    asker = start_driver("ASKER").connect(central.address)
    for value in range(1, 6):
        asked = asker.do("query_data", "question", "answer", 5000, "int", value)
        assert asked.result == f"OK {2 * value}"
        module.wait_for_line(f"^asked about {value}$", seconds=PATIENCE)
    asker.do("sleep", 300)  # the module's timer has its time
    module.process.stdin.close()
    module.wait_for_line("^ticked$", seconds=PATIENCE)
    assert module.wait(PATIENCE) == 0


def test_a_bridge_passes_messages_from_one_central_to_another(build, start_central, stack,
                                                              start_driver):
    first, second = start_central(), start_central()
    publisher = start_driver("PUB").connect(first.address)
    publisher.must("define", "news", "variable")
    subscriber = start_driver("SUB").connect(second.address)
    subscriber.must("subscribe", "news")
    bridge = stack.enter_context(Process(
        [os.path.join(build.directory, "examples/bridge"), first.address, second.address, "news"]))
    bridge.wait_for_line("^bridge: ready$", seconds=PATIENCE)
    for text in ("one", "two", "three"):
        publisher.must("publish", "news", text)
    assert texts_in(subscriber.until(3)) == ["one", "two", "three"]
