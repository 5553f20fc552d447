"""The conversation of Appendix A of the manual, by our examples, in every mix of ours and
theirs."""
import os
import re

import pytest

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
        started.append(program)
    return started[1], started[0], central


def test_the_modules_of_appendix_a_talk_to_each_other(modules):
    """m, r and q typed to module1, q typed to module2."""
    module1, module2, _ = modules
    module1.write_line("m")
    module2.wait_for_line(r"^msg1Handler: Receiving message1 \(42\) \[module2\]$")
    module1.write_line("r")
    module2.wait_for_line(r"^queryHandler: Receiving query1 \[module2\]$")
    module2.wait_for_line("^" + re.escape(QUERY) + "$")
    module1.wait_for_line("^" + re.escape(RESPONSE))
    module1.wait_for_line("ReceiveVal}$")
    module1.wait_for_line(r"^msg2Handler: Receiving message2 \(Hello, world\) \[module1\]$")
    module1.write_line("hello")
    module1.wait_for_line(r"^stdinHnd \[module1\]: Received hello$")
    for module in (module1, module2):
        module.write_line("q")
        assert module.wait() == 0


def test_the_modules_of_appendix_a_end_with_central(modules):
    """Section 9.3: without an exit procedure, status 255."""
    module1, module2, central = modules
    module1.write_line("m")
    module2.wait_for_line("^msg1Handler: Receiving")
    central.stop()
    for module in (module1, module2):
        assert module.wait() == 255
        assert "Closed Connection Detected from: Central Server" in module.output()
