"""The original's own sixteen test programs, unchanged: with our library they do what they do with
theirs.

Each runs in three settings: "theirs" is what is expected; "compiled" has the program's source
compiled with our header and library; "binary" has the program that "theirs" has, linked with the
original library, and gives it ours by LD_LIBRARY_PATH.
"""
import collections
import dataclasses
import os
import re
import shutil
import time

import pytest

from support.processes import Central, Library
from support.waiting import SLOW, wait_until

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


@dataclasses.dataclass
class Setting:
    """How programs are made, and what they run with."""
    linked: Library
    library: Library
    headers: str
    central: Central = None


@pytest.fixture(scope="session")
def headers(original_tests, tmp_path_factory):
    """Whose → a directory with the headers that its programs include: their ipc.h where it is
    found beside the programs, and what they need of internal headers, written anew."""
    directories = {}
    for who in ("ours", "theirs"):
        directory = tmp_path_factory.mktemp("headers")
        for name, text in PRIVATE_HEADERS.items():
            (directory / name).write_text(text)
        directories[who] = str(directory)
    header = os.path.join(original_tests, "..", "src", "ipc.h")
    if os.path.exists(header):
        shutil.copy(header, directories["theirs"])
    return directories


@pytest.fixture
def settings(library, original_library, headers):
    """Name → setting, without centrals."""
    found = {"theirs": Setting(original_library, original_library, headers["theirs"]),
             "compiled": Setting(library, library, headers["ours"])}
    if not library.link_flags:  # a library with sanitizers needs a program that has them, too
        found["binary"] = Setting(original_library, library, headers["theirs"])
    return found


@pytest.fixture
def served(settings, central_program, original_central_program, stack, pytestconfig):
    """Name → setting, each with a central of its own."""
    for who, setting in settings.items():
        theirs = who == "theirs"
        setting.central = stack.enter_context(Central(
            original_central_program if theirs else central_program,
            original=theirs or pytestconfig.ipc_central_is_original))
    return settings


@pytest.fixture
def launch(start_program, original_tests):
    """Starts one of the programs in a setting."""
    def start(setting, name, *arguments):
        return start_program(os.path.join(original_tests, f"{name}.c"), setting.library,
                             setting.central, linked=setting.linked, includes=[setting.headers],
                             arguments=arguments)
    return start


def assert_alike(printed):
    """In every setting a program has printed what it prints with theirs."""
    for who, lines in printed.items():
        assert lines == printed["theirs"], who


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


def without_numbers(lines):
    """Output without what was measured."""
    return [re.sub(r"\d+(\.\d+)?", "<number>", line) for line in masked(lines)]


# ------------------------------------------------------------------- without a central


def test_sizes_test(settings, launch):
    """sizesTest: C sizes of 60 formats."""
    printed = {}
    for who, setting in settings.items():
        program = launch(setting, "sizesTest")
        assert program.wait() == 0
        printed[who] = program.stdout
    assert_alike(printed)
    assert len(printed["theirs"]) > 50
    assert not any("DIFFER" in line for line in printed["compiled"])


def test_check_test(settings, launch):
    """checkTest: which formats are equal."""
    printed = {}
    for who, setting in settings.items():
        program = launch(setting, "checkTest")
        assert program.wait() == 0
        printed[who] = program.stderr
    assert_alike(printed)
    assert len([line for line in printed["theirs"] if "SAME" in line]) == 20


def test_int_test(settings, launch):
    """intTest: integers of all kinds there and back, also as those of the other sign."""
    printed = {}
    for who, setting in settings.items():
        program = launch(setting, "intTest")
        assert program.wait() == 0
        # Theirs prints a byte as if it were an int of the other byte order.
        printed[who] = [re.sub("^(0x[0-9a-f]{2})000000$", r"\1", line) for line in program.stderr]
    assert_alike(printed)
    assert len(printed["theirs"]) == 32


@pytest.mark.parametrize("fmt", ["int", "{int, double, string}", "[double:100]", "{char, double}",
                                 "{int, <int:1>}", "*int", "string"])
def test_marshall_test(fmt, settings, launch):
    """marshallTest: sizes of structures and buffers (the times are not compared)."""
    printed = {}
    for who, setting in settings.items():
        program = launch(setting, "marshallTest", fmt, "10")
        assert program.wait() == 0, program.output()
        printed[who] = [re.sub(r"\d+ trials in .*", "trials", line) for line in program.stdout]
    assert_alike(printed)


# --------------------------------------------------------------- module1, module2, module3


@pytest.fixture
def converse(launch, await_line):
    """Plays module1 and module2: m, r, q, as in Appendix A; returns both when they have ended."""
    def play(setting1, setting2):
        module1 = launch(setting1, "module1")
        module1.wait_for_line("^Type 'm' to send")
        if setting1.library.original:
            # It does not see what comes before it has begun to listen, and nothing that can be seen
            # from outside tells that it has: it acknowledges inside calls that ask central, too.
            time.sleep(0.2 * SLOW)
        module2 = launch(setting2, "module2")
        module2.wait_for_line("^Type 'q' to quit")
        originals = [module for module, setting in ((module1, setting1), (module2, setting2))
                     if setting.library.original]
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
        originals = [module1] if setting1.library.original else []
        await_line(module1, "^DISCONNECT: module2", *originals, stream="stderr")
        await_line(module1, "HANDLER CHANGE: query1: 0", *originals, stream="stderr")
        module1.write_line("q")
        assert module1.wait() == 0
        return module1, module2
    return play


def test_module1_and_module2(served, converse):
    """module1 and module2 in one setting."""
    printed = {}
    for who, setting in served.items():
        module1, module2 = converse(setting, setting)
        # Messages and notices come through one queue, but the keyboard does not.  How many handlers
        # there are while a module connects depends on how fast it is.
        notices = [line for line in masked(module1.stderr) if "Number of handlers" not in line]
        printed[who] = (sorted(masked(module1.stdout)), masked(module2.stdout),
                        sorted(notices), masked(module2.stderr))
    assert_alike(printed)


def test_module1_and_module2_mixed(mix, mixed_central, headers, converse):
    """The same conversation in every mix."""
    central = mixed_central()
    module1, module2 = converse(*(
        Setting(library, library, headers["theirs" if library.original else "ours"], central)
        for library in (mix.first, mix.second)))
    assert any('{"Hello, world", 1, <{666, 1, [[0.00, 1.00, 2.00], [1.00, 2.00, 3.00]], 3.14}>'
               in line for line in module1.stdout)
    assert "HANDLER CHANGE: message1: 1" in module1.stderr
    assert module2.process.returncode == 0


def test_module3(served, launch, await_line):
    """module3 hears what module1 and module2 publish."""
    printed = {}
    for who, setting in served.items():
        modules = []
        for name in ("module3", "module2", "module1"):
            modules.append(launch(setting, name))
            modules[-1].wait_for_line("^Type 'q' to quit|^Type 'm' to send")
            time.sleep(0.2 * SLOW if setting.library.original else 0)
        module3, module2, module1 = modules
        originals = modules if setting.library.original else []
        module1.write_line("m")
        await_line(module3, r"^msg1Handler: Receiving message1 \(42\) \[module3\]$", *originals)
        module1.write_line("r")
        await_line(module3, r"^msg2Handler: Receiving message2 \(Hello, world\) \[module3\]$",
                   *originals)
        await_line(module1, "ReceiveVal}$", *originals)
        for module in (module1, module2, module3):
            module.write_line("q")
            assert module.wait() == 0
        printed[who] = (masked(module3.stdout), masked(module3.stderr))
    assert_alike(printed)


# ------------------------------------------------------------------- programs of their own


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
def test_ipc_test_1(served, launch):
    """ipcTest1: the whole basic interface in one module.

    Theirs loses what it publishes right after it has subscribed, now and then, and may answer the
    query with the time-out of 0 in time; ours handles everything that theirs handles.
    """
    programs = {who: launch(setting, "ipcTest1") for who, setting in served.items()}
    printed, errors = {}, {}
    for who, program in programs.items():
        program.wait_for_line("to send a message, 'u' to stop listening", seconds=40 * SLOW)
        program.write_line("hello")
        program.wait_for_line("stdinHnd .FD1.: Received hello")
        program.write_line("q")
        assert program.wait() == 0
        printed[who], errors[who] = masked(program.stdout), masked(program.stderr)
    for who in printed.keys() - {"theirs"}:
        assert commands_in(printed[who]) == commands_in(printed["theirs"]), who
        lost = handled_in(printed["theirs"]) - handled_in(printed[who])
        assert not lost, who
        extra = handled_in(printed[who]) - handled_in(printed["theirs"])
        assert set(extra) <= {"msg1Handler: Receiving message msg1 of 6 bytes (abcde) [client1a]",
                              "msg3Handler: Receiving message msg3: 42"}, who
        # For a variable-length message the manual gives another error than the original.
        manual = [line.replace("Message is not fixed length",
                               "Fixed length of message differs from length argument")
                  for line in errors[who]]
        assert manual == errors["theirs"], who


def test_disconnected_listen(served, launch):
    """disconnectedListen: listens before it is connected, which ends it."""
    programs = {who: launch(setting, "disconnectedListen") for who, setting in served.items()}
    assert_alike({who: (program.wait(20 * SLOW), program.stdout, masked(program.stderr))
                  for who, program in programs.items()})


def handled_in_priority_test(program):
    """What priorityTest has handled so far."""
    return [line for line in program.stdout if line.startswith("Handling ")]


def test_priority_test(served, launch):
    """priorityTest: eleven messages, published before it listens.

    Theirs loses those that it publishes before it has heard of its own subscriptions, at times all.
    """
    theirs, *ours = [launch(setting, "priorityTest") for setting in served.values()]
    for program in ours:
        wait_until(lambda: len(handled_in_priority_test(program)) == 11, "all are handled")
        assert [line.split(":")[0] for line in handled_in_priority_test(program)] == \
            [f"Handling msg{number}" for number in (5, 5, 4, 4, 3, 3, 2, 2, 1, 0, 1)]
        assert set(handled_in_priority_test(theirs)) <= set(handled_in_priority_test(program))


def test_timer_test(served, launch):
    """timerTest: periodic timers, one that is replaced, one that removes itself after ten calls,
    one that comes later and is called once."""
    programs = {who: launch(setting, "timerTest") for who, setting in served.items()}
    calls = {}
    for who, program in programs.items():
        program.wait_for_line("^Timer timer4", seconds=40 * SLOW)
        calls[who] = collections.Counter(re.findall(r"^(Timer \w+|Added timer4|  Exit.*)",
                                                    "\n".join(program.stdout), re.M))
        for name in ("Timer timer1b", "Timer timer3"):  # they go on
            assert calls[who].pop(name) >= 10, who
    assert_alike(calls)
    assert calls["theirs"] == {"Timer timer2": 10, "Timer timer4": 1, "Added timer4": 1,
                               "  Exit IPC_listen(2000)": 1}


@pytest.mark.parametrize("capacity", ["1", "5"])
def test_latency(capacity, served, launch):
    """latency1 and latency2: a thousand messages, counted by the receiver."""
    receivers = {who: launch(setting, "latency1", capacity) for who, setting in served.items()}
    for receiver in receivers.values():
        receiver.wait_for_line("IPC Connected on port", stream="stderr")
    time.sleep(0.2 * SLOW)  # it says nothing when it has subscribed
    senders = {who: launch(setting, "latency2") for who, setting in served.items()}
    printed = {}
    for who, sender in senders.items():
        assert sender.wait(20 * SLOW) == 0
        receivers[who].wait_for_line("^Latency for 1000 messages", seconds=20 * SLOW)
        printed[who] = without_numbers(receivers[who].stdout)
    assert_alike(printed)


@pytest.mark.parametrize("capacity", [None, "5"])
def test_throughput(capacity, served, launch):
    """throughput1 and throughput2: two hundred messages of each of ten lengths."""
    arguments = [capacity] if capacity else []
    receivers = {who: launch(setting, "throughput2", *arguments)
                 for who, setting in served.items()}
    for receiver in receivers.values():
        receiver.wait_for_line("IPC Connected on port", stream="stderr")
    time.sleep(0.2 * SLOW)  # it says nothing when it has subscribed
    senders = {who: launch(setting, "throughput1") for who, setting in served.items()}
    printed = {}
    for who, sender in senders.items():
        assert sender.wait(100 * SLOW) == 0
        sent = [line for line in sender.stdout if line.startswith("200 messages")]
        printed[who] = [re.findall(r"\d+ bytes each", line) for line in sent]
        assert len(sent) == 10
    assert_alike(printed)


def answers_of(program, number):
    """(count, number, real number) in the answers to one of multiTest's threads, as far as no
    other thread has printed into the line."""
    program.wait_for_line(rf"THREAD{number} \(50\)", stream="stderr", seconds=20 * SLOW)
    return re.findall(rf'^  RESP{number} \((\d+)\): {{(\d+), "query{number}", (-?[\d.]+)}}$',
                      program.output(), re.M)


def test_multi_test(served, launch):
    """multiTest: two threads ask, one publishes, the main one dispatches.

    Not compared with theirs, which after a while gives a thread no reply, and ends.
    """
    for who in served.keys() - {"theirs"}:
        program = launch(served[who], "multiTest")
        for number in (1, 2):
            answers = answers_of(program, number)
            assert len(answers) > 10
            for count, integer, real in answers:
                assert int(integer) == number * (int(count) - 1)
                assert float(real) == -int(integer)
        program.wait_for_line('"Broadcasts #[2-9][0-9]"', stream="stderr", seconds=20 * SLOW)
        program.stop()
