"""The conversation of Appendix A of the manual in Python, and in every mix with C (S1 to S10)."""
import itertools
import os
import re
import subprocess
import sys

import pytest

from python.tools import EXAMPLES, PACKAGES, ROOT
from support.processes import Process

QUERY = "{666, 1, [[0.00, 1.00, 2.00], [1.00, 2.00, 3.00]], 3.14}"
RESPONSE = '{"Hello, world", 1, <{666, 1, [[0.00, 1.00, 2.00], [1.00, 2.00, 3.00]], 3.14}>, '
READY = {"module1": "^Type 'm' to send", "module2": "^Type 'q' to quit",
         "module3": "^Type 'q' to quit"}


@pytest.fixture
def start(stack, central, compiler, library):
    """Starts a module in one of the languages and waits until it is ready."""
    def begin(name, language):
        if language == "Python":
            arguments = [sys.executable, os.path.join(EXAMPLES, f"{name}.py")]
            env = {"PYTHONPATH": PACKAGES, "PYTHONUNBUFFERED": "1"}
        else:
            source = os.path.join(ROOT, "examples", f"{name}.c")
            arguments = [compiler.program(source, library, flags=["-D_POSIX_C_SOURCE=200809L"])]
            env = library.environment()
        env["CENTRALHOST"] = central.address
        started = stack.enter_context(Process(arguments, stdin=subprocess.PIPE, env=env,
                                              terminal=language == "C"))
        started.wait_for_line(READY[name])
        return started
    return begin


@pytest.mark.parametrize("first, second", list(itertools.product(("Python", "C"), repeat=2)),
                         ids=lambda language: language)
def test_the_modules_talk_to_each_other(start, first, second):
    module1 = start("module1", first)
    module2 = start("module2", second)
    if first == "Python":
        for line in ("CONNECT1: Connection from module2", "          Confirming connection (1)",
                     "CONNECT2: Connection from module2", "HANDLER CHANGE: message1: 1", "HANDLER CHANGE2: message1: 1",
                     "HANDLER CHANGE: query1: 1"):
            module1.wait_for_line(f"^{re.escape(line)}$")
        # Module2 may have subscribed when this is asked.
        module1.wait_for_line("^          Number of handlers: [01]$")
    module3 = start("module3", "Python")
    module1.write_line("m")
    module2.wait_for_line(r"^msg1Handler: Receiving message1 \(42\) \[module2\]$")
    module3.wait_for_line(r"^msg1Handler: Receiving message1 \(42\) \[module3\]$")
    module1.write_line("r")
    module2.wait_for_line(r"^queryHandler: Receiving query1 \[module2\]$")
    module2.wait_for_line("^" + re.escape(QUERY) + "$")
    module1.wait_for_line(r"^msg2Handler: Receiving message2 \(Hello, world\) \[module1\]$")
    module1.wait_for_line("^  Received response")
    module1.wait_for_line("^" + re.escape(RESPONSE))
    module1.wait_for_line("ReceiveVal}$")
    module3.wait_for_line(r"^msg2Handler: Receiving message2 \(Hello, world\) \[module3\]$")
    module1.write_line("hello")
    module1.wait_for_line(r"^stdinHnd \[module1\]: Received hello$")
    module2.write_line("x")
    module2.wait_for_line(r"^stdinHnd \[module2\]: Received x$")
    leave(module1, module2, module3, first)


def leave(module1, module2, module3, first):
    """Module3 leaves, then the others."""
    before = len(module1.stdout)
    module3.write_line("q")
    assert module3.wait() == 0
    if first == "Python":
        for line in ("HANDLER CHANGE: message1: 1", "HANDLER CHANGE2: message1: 1",
                     "DISCONNECT: module3"):
            module1.wait_for_line(f"^{line}$", start=before)
    before = len(module1.stdout)
    module2.write_line("q")
    assert module2.wait() == 0
    if first == "Python":
        for line in ("HANDLER CHANGE: message1: 0", "HANDLER CHANGE: query1: 0",
                     "DISCONNECT: module2"):
            module1.wait_for_line(f"^{line}$", start=before)
        assert not any("CHANGE2" in line for line in module1.stdout[before:])
    module1.write_line("q")
    assert module1.wait() == 0


def test_what_is_printed_of_structures(start):
    """S5 in Python: the query, its answer, and the response."""
    module1, module2 = start("module1", "Python"), start("module2", "Python")
    module1.write_line("r")
    module1.wait_for_line("^" + re.escape(
        "  IPC_queryResponseData(query1, <T1: i1: 666; status: 1; matrix: ((0.0, 1.0, 2.0), "
        "(1.0, 2.0, 3.0)); d1: 3.14159>, IPC_WAIT_FOREVER, T1)") + "$")
    module2.wait_for_line(
        r"^  IPC.IPC_respondData\(<.*>, response1, " + re.escape(
            "<T2: str1: 'Hello, world'; count: 1; t1: [<T1: i1: 666; status: 1; matrix: "
            "[[0.0, 1.0, 2.0], [1.0, 2.0, 3.0]]; d1: 3.14159>]; status: 2>)") + "$")
    for module in (module1, module2):
        module.write_line("q")
        assert module.wait() == 0
