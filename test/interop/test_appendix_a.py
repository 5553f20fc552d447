"""The conversation of Appendix A of the manual, by our examples, in every mix of ours and
theirs."""
import os
import re
import time

import pytest

from support.waiting import SLOW

EXAMPLES = os.path.join(os.path.dirname(__file__), "..", "..", "examples")

QUERY = "{666, 1, [[0.00, 1.00, 2.00], [1.00, 2.00, 3.00]], 3.14}"
# IPC_printData breaks the line here.
RESPONSE = '{"Hello, world", 1, <{666, 1, [[0.00, 1.00, 2.00], [1.00, 2.00, 3.00]], 3.14}>, '


@pytest.fixture
def modules(mix, mixed_central, start_program):
    """module1 and module2, connected and ready."""
    if not os.path.exists(os.path.join(EXAMPLES, "module1.c")):
        pytest.skip("no examples in this tree")
    central = mixed_central()
    started = []
    for name, library in (("module2", mix.second), ("module1", mix.first)):
        program = start_program(os.path.join(EXAMPLES, f"{name}.c"), library, central)
        program.wait_for_line("^Type 'q' to quit|^Type 'm' to send")
        if library.original:
            # It takes in the list of subscribed messages only while it listens, and drops what it
            # publishes before.  Nothing that can be seen from outside tells that it has begun:
            # it also acknowledges lists inside calls that ask central.
            time.sleep(0.2 * SLOW)
        started.append(program)
    return started[1], started[0], central


def originals_in(mix, module1, module2):
    """The modules of a mix that run on the original library."""
    return [module for module, library in ((module1, mix.first), (module2, mix.second))
            if library.original]


def test_the_modules_of_appendix_a_talk_to_each_other(mix, modules, await_line):
    """m, r and q typed to module1, q typed to module2."""
    module1, module2, _ = modules
    originals = originals_in(mix, module1, module2)
    module1.write_line("m")
    await_line(module2, r"^msg1Handler: Receiving message1 \(42\) \[module2\]$", *originals)
    module1.write_line("r")
    await_line(module2, r"^queryHandler: Receiving query1 \[module2\]$", *originals)
    await_line(module2, "^" + re.escape(QUERY) + "$", *originals)
    await_line(module1, "^" + re.escape(RESPONSE), *originals)
    await_line(module1, "ReceiveVal}$", *originals)
    await_line(module1, r"^msg2Handler: Receiving message2 \(Hello, world\) \[module1\]$",
               *originals)
    module1.write_line("hello")
    await_line(module1, r"^stdinHnd \[module1\]: Received hello$")
    for module in (module1, module2):
        module.write_line("q")
        assert module.wait() == 0


def test_the_modules_of_appendix_a_end_with_central(mix, modules, await_line):
    """Section 9.3: without an exit procedure, status 255."""
    module1, module2, central = modules
    module1.write_line("m")
    await_line(module2, "^msg1Handler: Receiving", *originals_in(mix, module1, module2))
    central.wait_for_line("^  Done +message1:")
    central.stop()
    for module in (module1, module2):
        assert module.wait() == 255
        assert "Closed Connection Detected from: Central Server" in module.output()
