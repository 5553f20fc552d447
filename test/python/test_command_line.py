"""python -m ipc_cffi: demo, tools for messages, programs; ipc_cffi.fix; ipc_cffi.testing."""
import os
import re
import subprocess
import sys

import pytest

from python.tools import BUILD, PACKAGES, Program, ipc as IPC
from support.processes import Process
from support.waiting import PATIENCE, SLOW

ENVIRONMENT = {**os.environ, "PYTHONPATH": PACKAGES,
               "PATH": os.path.join(BUILD, "src/c/central") + os.pathsep + os.environ["PATH"]}


@pytest.fixture
def command(central, stack):
    """Starts python -m ipc_cffi with arguments."""
    def start(*arguments, **options):
        return stack.enter_context(Process(
            [sys.executable, "-m", "ipc_cffi", *arguments],
            env={**ENVIRONMENT, "CENTRALHOST": central.address}, **options))
    return start


def run(*arguments, module="ipc_cffi", text=None, env=None):
    done = subprocess.run([sys.executable, "-m", module, *arguments], capture_output=True,
                          text=True, input=text, env={**ENVIRONMENT, **(env or {})},
                          timeout=60 * SLOW, check=False)
    return done.returncode, done.stdout, done.stderr


def test_the_demo_goes_well():
    status, out, errors = run("demo")
    assert (status, errors) == (0, "")
    assert "robot at Position(x=4.0, y=2.0), 2.24 m to go\nall went well\n" in out


def test_help_and_versions():
    assert run("--version")[:2] == run("version")[:2] == (
        0, f"ipc_cffi {IPC.__version__}, libipc {IPC.library_version()}\n")
    status, out, _ = run("--help")
    assert status == 0
    for name in ("demo", "pub NAME", "sub NAME", "query NAME", "echo NAME", "killCentral"):
        assert name in out
    assert run()[0] == run("nonsense")[0] == 2
    status, out, _ = run("central", "--help")
    assert status == 0 and "--port" in out


def test_messages_are_published_and_printed(command, central):
    subscriber = command("sub", "a", "b", "--format", "{int, string, [double:2]}", "--count", "3")
    central.wait_for_line("modName : sub")
    asker = Program("""
        import ipc_cffi, time
        with ipc_cffi.connect("watch") as ipc:
            while ipc_cffi.IPC_numHandlers("b") == 0:
                time.sleep(0.005)
        """, central=central)
    with asker:
        assert asker.wait(PATIENCE) == 0
    env = {"CENTRALHOST": central.address}
    assert run("pub", "a", '[1, "e", [1, 2.5]]', '{"f0": 2, "f1": "", "f2": [0, 0]}',
               env=env) == (0, "", "")
    assert run("pub", "b", text='[3, "x", [0, 1]]\n', env=env) == (0, "", "")
    for line in ('a [1, "e", [1.0, 2.5]]', 'a [2, "", [0.0, 0.0]]', 'b [3, "x", [0.0, 1.0]]'):
        subscriber.wait_for_line(f"^{re.escape(line)}$")
    assert subscriber.wait() == 0


def test_queries_are_asked_and_answered(command, central):
    answering = command("echo", "q", "--format", "{int, string}", "--count", "1")
    asked = command("query", "q", '[7, "seven"]', "--format", "{int, string}", "--timeout",
                    str(PATIENCE))
    asked.wait_for_line(r'^\[7, "seven"\]$')
    assert asked.wait() == answering.wait() == 0
    status, out, errors = run("query", "q", '[8, "x"]', "--timeout", "0.05",
                              env={"CENTRALHOST": central.address})
    assert (status, out) == (1, "") and "no answer" in errors


@pytest.mark.parametrize("arguments, complaint", [
    (["pub", "unknown", "1"], "pub: IPC message not defined"),
    (["pub", "m", "1", "--format", "{"], "pub: Illegal format string"),
    (["pub", "m", '"x"', "--format", "int"], "pub: data: expected int"),
    (["pub", "m", "{", "--format", "int"], "pub: Expecting property name"),
    (["sub", "m", "--server", "localhost:1"], "sub: Not connected to IPC central"),
], ids=lambda value: str(value)[:30])
def test_what_is_wrong_is_said(central, arguments, complaint):
    status, out, errors = run(*arguments, env={"CENTRALHOST": central.address})
    assert (status, out) == (1, "")
    assert complaint in errors and "Traceback" not in errors


def test_places_to_change_are_found(tmp_path):
    script = tmp_path / "old.py"
    script.write_text('import IPC\nprint "hello"\nraise "text"\nx = 5L\nexcept Error, e:\n'
                      'print("fine")\n# print "comment"\n"print no"\ny = 0x1F\nz = 1.01e5\n')
    status, out, _ = run(str(script), module="ipc_cffi.fix")
    assert status == 1
    found = {line.split(":")[1] for line in out.splitlines()}
    assert found == {"2", "3", "4", "5"}
    script.write_text("import IPC\nprint('fine')\n")
    assert run(str(script), module="ipc_cffi.fix") == (0, "", "")
    assert run(module="ipc_cffi.fix")[0] == 2


def test_a_server_for_each_test(tmp_path):
    (tmp_path / "conftest.py").write_text("from ipc_cffi.testing import ipc_central\n")
    (tmp_path / "test_it.py").write_text("""if True:
        import os, ipc_cffi, pytest
        seen = []

        @pytest.mark.parametrize("number", range(2))
        def test_it(ipc_central, number):
            assert os.environ["CENTRALHOST"] == ipc_central.address
            assert ipc_central.address not in seen
            seen.append(ipc_central.address)
            ipc_cffi.IPC_setVerbosity(ipc_cffi.IPC_Print_Errors)
            ipc = ipc_cffi.connect("test")
            assert ipc_cffi.IPC_isMsgDefined("m") is False
            ipc.define("m", int)

        def test_nothing_is_left():
            assert ipc_cffi.IPC_getContext() is None or not ipc_cffi.IPC_isConnected()
            with pytest.raises(ipc_cffi.IPCError):
                ipc_cffi.IPC_isMsgDefined("m")
        """)
    status, out, _ = run("-q", "-p", "no:cacheprovider", str(tmp_path), module="pytest")
    assert status == 0 and "3 passed" in out, out
