"""The original's own test programs, compiled unchanged: with our library they print what they
print with theirs."""
import collections
import os
import re
import time

import pytest

from support.processes import Central
from support.waiting import SLOW

# What a few of the programs include besides ipc.h, as far as they use it.
PRIVATE_HEADERS = {
    "libc.h": "#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n",
    "basics.h": "#define BOOLEAN int\n",
    "tca.h": "", "parseFmttrs.h": "FORMATTER_PTR ParseFormatString(const char *);\n",
    "formatters.h": "int x_ipc_dataStructureSize(FORMATTER_PTR);\n"
                    "int x_ipc_bufferSize(FORMATTER_PTR, const void *);\n"
                    "int x_ipc_sameFixedSizeDataBuffer(FORMATTER_PTR);\n"
                    "int formatContainsPointers(FORMATTER_PTR);\n",
    "tcaMem.h": "void *x_ipcMalloc(unsigned long);\n",
}


@pytest.fixture
def private_headers(tmp_path):
    """A directory with stand-ins for the original's internal headers."""
    for name, text in PRIVATE_HEADERS.items():
        (tmp_path / name).write_text(text)
    return str(tmp_path)


@pytest.fixture
def both(library, original_library, central_program, original_central_program, stack,
         pytestconfig):
    """(library, central) of ours and of theirs."""
    ours = stack.enter_context(Central(central_program,
                                       original=pytestconfig.ipc_central_is_original))
    theirs = stack.enter_context(Central(original_central_program, original=True))
    return {"ours": (library, ours), "theirs": (original_library, theirs)}


def masked(lines):
    """Output without versions, times, addresses and ports."""
    result = []
    for line in lines:
        if re.match(r"NMP IPC Version|\.\.\. IPC Connected on port|Timer timer1: Called", line):
            continue
        if line.endswith(": Received touched"):
            continue
        line = re.sub(r"0[xX][0-9A-Fa-f]+", "<address>", line)
        line = re.sub(r"HND-(\w*?)\d{6,}", r"HND-\1<address>", line)
        result.append(line)
    return result


def without_times(lines):
    """What marshallTest prints, without what it has measured."""
    return [re.sub(r"\d+ trials in .*", "trials", line) for line in lines]


def test_sizes_test(both, start_program, original_tests, private_headers):
    """sizesTest: C sizes of 60 formats, no central."""
    outputs = {}
    for who, (library, _) in both.items():
        program = start_program(os.path.join(original_tests, "sizesTest.c"), library, None,
                                includes=[private_headers])
        assert program.wait() == 0
        outputs[who] = program.stdout
    assert outputs["ours"] == outputs["theirs"]
    assert len(outputs["ours"]) > 50
    assert not any("DIFFER" in line for line in outputs["ours"])


def test_check_test(both, start_program, original_tests):
    """checkTest: which formats are equal."""
    outputs = {}
    for who, (library, _) in both.items():
        program = start_program(os.path.join(original_tests, "checkTest.c"), library, None)
        assert program.wait() == 0
        outputs[who] = program.stderr
    assert outputs["ours"] == outputs["theirs"]
    assert len([line for line in outputs["ours"] if "SAME" in line]) == 20


@pytest.mark.parametrize("fmt", ["int", "{int, double, string}", "[double:100]", "{char, double}",
                                 "{int, <int:1>}", "*int", "string"])
def test_marshall_test(fmt, both, start_program, original_tests, private_headers):
    """marshallTest: sizes of structures and buffers (the times are not compared)."""
    outputs = {}
    for who, (library, _) in both.items():
        program = start_program(os.path.join(original_tests, "marshallTest.c"), library, None,
                                includes=[private_headers], arguments=[fmt, "10"])
        assert program.wait() == 0, program.output()
        outputs[who] = without_times(program.stdout)
    assert outputs["ours"] == outputs["theirs"]


@pytest.fixture
def converse(start_program, original_tests, await_line):
    """Plays module1 and module2: m, r, q, as in Appendix A; returns both when they have ended."""
    def play(library1, library2, central):
        module1 = start_program(os.path.join(original_tests, "module1.c"), library1, central)
        module1.wait_for_line("^Type 'm' to send")
        if library1.original:
            # It does not see what comes before it has begun to listen, and nothing that can be seen
            # from outside tells that it has: it acknowledges inside calls that ask central, too.
            time.sleep(0.2 * SLOW)
        module2 = start_program(os.path.join(original_tests, "module2.c"), library2, central)
        module2.wait_for_line("^Type 'q' to quit")
        originals = [module for module, library in ((module1, library1), (module2, library2))
                     if library.original]
        await_line(module1, "HANDLER CHANGE: query1: 1", *originals, stream="stderr")
        module1.write_line("m")
        await_line(module2, "^msg1Handler: Receiving message1", *originals)
        module1.write_line("r")
        await_line(module1, "Received response", *originals)
        await_line(module1, "^msg2Handler: Receiving message2", *originals)
        module2.write_line("hello")
        await_line(module2, "^stdinHnd .module2.: Received hello")
        module2.write_line("q")
        assert module2.wait() == 0
        originals = [module1] if library1.original else []
        await_line(module1, "^DISCONNECT: module2", *originals, stream="stderr")
        await_line(module1, "HANDLER CHANGE: query1: 0", *originals, stream="stderr")
        module1.write_line("q")
        assert module1.wait() == 0
        return module1, module2
    return play


def test_module1_and_module2(both, converse):
    """module1 and module2 with everything ours, and with everything theirs."""
    printed = {}
    for who, (library, central) in both.items():
        module1, module2 = converse(library, library, central)
        # Messages and notices come through one queue, but the keyboard does not.  How many handlers
        # there are while a module connects depends on how fast it is.
        notices = [line for line in masked(module1.stderr) if "Number of handlers" not in line]
        printed[who] = (sorted(masked(module1.stdout)), masked(module2.stdout),
                        sorted(notices), masked(module2.stderr))
    assert printed["ours"] == printed["theirs"]


def test_module1_and_module2_mixed(mix, mixed_central, converse):
    """The same conversation in every mix."""
    module1, module2 = converse(mix.first, mix.second, mixed_central())
    assert any('{"Hello, world", 1, <{666, 1, [[0.00, 1.00, 2.00], [1.00, 2.00, 3.00]], 3.14}>'
               in line for line in module1.stdout)
    assert "HANDLER CHANGE: message1: 1" in module1.stderr
    assert module2.process.returncode == 0


def commands_in(lines):
    """What ipcTest1 says that it does, and what does not depend on when messages come."""
    return [line for line in lines
            if line.startswith(("IPC_", "  IPC_subscribe", "  IPC_unsubscribe", "Marshall of",
                                "Orig:", "Copy:", "ERROR", "Timed out", "[["))]


def handled_in(lines):
    """What the handlers of ipcTest1 have printed, counted."""
    return collections.Counter(line for line in lines if "Handler: Receiving" in line
                               or line.startswith("There are now"))


@pytest.mark.new_library("it loses what is published right after a subscription, now and then")
def test_ipc_test_1(both, start_program, original_tests):
    """ipcTest1: the whole basic interface in one module.

    Theirs loses what it publishes right after it has subscribed, now and then, and may answer the
    query with the time-out of 0 in time; ours handles everything that theirs handles.
    """
    programs = {who: start_program(os.path.join(original_tests, "ipcTest1.c"), library, central)
                for who, (library, central) in both.items()}
    printed, errors = {}, {}
    for who, program in programs.items():
        program.wait_for_line("to send a message, 'u' to stop listening", seconds=40 * SLOW)
        program.write_line("hello")
        program.wait_for_line("stdinHnd .FD1.: Received hello")
        program.write_line("q")
        assert program.wait() == 0
        printed[who], errors[who] = masked(program.stdout), masked(program.stderr)
    assert commands_in(printed["ours"]) == commands_in(printed["theirs"])
    lost = handled_in(printed["theirs"]) - handled_in(printed["ours"])
    assert not lost
    extra = handled_in(printed["ours"]) - handled_in(printed["theirs"])
    assert set(extra) <= {"msg1Handler: Receiving message msg1 of 6 bytes (abcde) [client1a]",
                          "msg3Handler: Receiving message msg3: 42"}
    # For a variable-length message the manual gives another error than the original.
    manual = [line.replace("Message is not fixed length",
                           "Fixed length of message differs from length argument")
              for line in errors["ours"]]
    assert manual == errors["theirs"]
