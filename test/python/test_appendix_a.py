"""The conversation of Appendix A of the manual in Python, in every mix with C and with CMU IPC (S1 to
S10)."""
import itertools
import os
import re
import subprocess
import sys
import time

import pytest

from python.tools import EXAMPLES, PACKAGES, ROOT
from support.processes import Central, Process
from support.waiting import Deadline, PATIENCE, SLOW, TimedOut

QUERY = "{666, 1, [[0.00, 1.00, 2.00], [1.00, 2.00, 3.00]], 3.14}"
RESPONSE = '{"Hello, world", 1, <{666, 1, [[0.00, 1.00, 2.00], [1.00, 2.00, 3.00]], 3.14}>, '
READY = {"module1": "^Type 'm' to send", "module2": "^Type 'q' to quit",
         "module3": "^Type 'q' to quit"}

#: The central, and what the three modules are: C is C on our library, CMU the same on an original.
MIXES = [("ours", *modules) for modules in itertools.product(("Python", "C"), repeat=3)]
MIXES += [(central, *modules) for central in ("ours", "CMU")
          for modules in itertools.product(("Python", "CMU"), repeat=3)
          if "Python" in modules and (central == "CMU" or "CMU" in modules)]


class Scene:
    """A central and the modules that were started on it."""

    def __init__(self, central, start):
        self.central, self._start = central, start
        self.originals = []

    def start(self, name, language):
        """Starts a module and waits until it is ready."""
        module = self._start(self.central, name, language)
        module.wait_for_line(READY[name])
        if language == "CMU":
            self.originals.append(module)
        return module

    def settle(self):
        """Gives originals time to hear of subscriptions: before, they do not publish, and nothing
        that can be seen from outside tells."""
        if self.originals or self.central.original:
            time.sleep(0.2 * SLOW)

    def expect(self, module, pattern, start=0):
        """Waits for a line.  Originals that have read a message may have to be touched to see it."""
        deadline = Deadline()
        while True:
            try:
                return module.wait_for_line(pattern, start=start, seconds=min(
                    deadline.left(), 0.5 * SLOW if self.originals else PATIENCE))
            except TimedOut:
                if deadline.passed():
                    raise
                for original in self.originals:
                    if original.alive():
                        original.write_line("touched")


@pytest.fixture
def scene(stack, request, compiler):
    """Makes the scene of a central."""
    def arguments(name, language):
        if language == "Python":
            return ([sys.executable, os.path.join(EXAMPLES, f"{name}.py")],
                    {"PYTHONPATH": PACKAGES, "PYTHONUNBUFFERED": "1"})
        library = request.getfixturevalue("library" if language == "C" else "original_library")
        folder = os.path.join(ROOT, "test", "python") if name == "module3" else os.path.join(
            ROOT, "examples")
        program = compiler.program(os.path.join(folder, f"{name}.c"), library,
                                   flags=["-D_POSIX_C_SOURCE=200809L"])
        return [program], library.environment()

    def start(central, name, language):
        command, env = arguments(name, language)
        env["CENTRALHOST"] = central.address
        return stack.enter_context(Process(command, stdin=subprocess.PIPE, env=env,
                                           terminal=language != "Python"))

    def make(central="ours"):
        if central == "ours":
            return Scene(request.getfixturevalue("central"), start)
        program = request.getfixturevalue("original_central_program")
        return Scene(stack.enter_context(Central(program, original=True)), start)
    return make


@pytest.mark.parametrize("mix", MIXES, ids="-".join)
def test_the_modules_talk_to_each_other(scene, mix):
    central, first, second, third = mix
    scene = scene(central)
    module1 = scene.start("module1", first)
    module2 = scene.start("module2", second)
    if first == "Python":
        for line in ("CONNECT1: Connection from module2", "          Confirming connection (1)",
                     "CONNECT2: Connection from module2", "HANDLER CHANGE: message1: 1",
                     "HANDLER CHANGE2: message1: 1", "HANDLER CHANGE: query1: 1"):
            scene.expect(module1, f"^{re.escape(line)}$")
        # Module2 may have subscribed when this is asked.
        scene.expect(module1, "^          Number of handlers: [01]$")
    module3 = scene.start("module3", third)
    if first == "Python":
        for line in ("CONNECT1: Connection from module3", "CONNECT2: Connection from module3",
                     "HANDLER CHANGE: message1: 2", "HANDLER CHANGE2: message1: 2"):
            scene.expect(module1, f"^{re.escape(line)}$")
    scene.settle()
    module1.write_line("m")
    scene.expect(module2, r"^msg1Handler: Receiving message1 \(42\) \[module2\]$")
    scene.expect(module3, r"^msg1Handler: Receiving message1 \(42\) \[module3\]$")
    module1.write_line("r")
    scene.expect(module2, r"^queryHandler: Receiving query1 \[module2\]$")
    scene.expect(module2, "^" + re.escape(QUERY) + "$")
    scene.expect(module1, r"^msg2Handler: Receiving message2 \(Hello, world\) \[module1\]$")
    scene.expect(module1, "^  Received response")
    scene.expect(module1, "^" + re.escape(RESPONSE))
    scene.expect(module1, "ReceiveVal}$")
    scene.expect(module3, r"^msg2Handler: Receiving message2 \(Hello, world\) \[module3\]$")
    module1.write_line("hello")
    scene.expect(module1, r"^stdinHnd \[module1\]: Received hello$")
    module2.write_line("x")
    scene.expect(module2, r"^stdinHnd \[module2\]: Received x$")
    leave(scene, module1, module2, module3, first)


def leave(scene, module1, module2, module3, first):
    """Module3 leaves, then the others."""
    before = len(module1.stdout)
    module3.write_line("q")
    assert module3.wait() == 0
    if first == "Python":
        for line in ("HANDLER CHANGE: message1: 1", "HANDLER CHANGE2: message1: 1",
                     "DISCONNECT: module3"):
            scene.expect(module1, f"^{line}$", start=before)
    before = len(module1.stdout)
    module2.write_line("q")
    assert module2.wait() == 0
    if first == "Python":
        for line in ("HANDLER CHANGE: message1: 0", "HANDLER CHANGE: query1: 0",
                     "DISCONNECT: module2"):
            scene.expect(module1, f"^{line}$", start=before)
        assert not any("CHANGE2" in line for line in module1.stdout[before:])
    module1.write_line("q")
    assert module1.wait() == 0


def test_what_is_printed_of_structures(scene):
    """S1 and S5 in Python: definitions, the query, its answer, and the response."""
    scene = scene()
    module1, module2 = scene.start("module1", "Python"), scene.start("module2", "Python")
    t1 = "{int, {enum : 3}, [double:2,3], double}"
    t2 = "{string, int, <T1:2>, {enum WaitVal, SendVal, ReceiveVal, ListenVal}}"
    for line in ("IPC.IPC_connect(module1)", f"IPC.IPC_defineFormat(T1, {t1})",
                 f"IPC.IPC_defineFormat(T2, {t2})",
                 "IPC.IPC_defineMsg(message1, IPC_VARIABLE_LENGTH, int)",
                 "IPC.IPC_defineMsg(query1, IPC_VARIABLE_LENGTH, T1)"):
        assert module1.stdout[module1.stdout.index(line) - 1] == ""
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


@pytest.mark.parametrize("name", ["module1", "module2", "module3"])
def test_a_module_ends_with_its_server(scene, name):
    """None goes on without one, printing errors."""
    scene = scene()
    module = scene.start(name, "Python")
    scene.central.stop()
    assert module.wait() != 0


@pytest.mark.parametrize("name", ["module1", "module2", "module3"])
def test_keys_that_come_together_are_all_read(scene, name):
    module = scene().start(name, "Python")
    module.write_line("x\nq")
    assert module.wait() == 0
