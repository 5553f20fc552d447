"""Coming back where the central that comes is one of CMU IPC: the checks of reconnect.c."""
import os
import re
import subprocess

import pytest

from support.waiting import SLOW

HERE = os.path.dirname(os.path.abspath(__file__))


def checks():
    with open(os.path.join(HERE, "reconnect.c"), encoding="utf-8") as source:
        return re.findall(r"^CHECK_NEW\((\w+)\)", source.read(), re.M)


@pytest.mark.parametrize("check", checks())
def test_the_central_that_comes_may_be_an_original(
        compiler, library, central_program, original_central_program, tmp_path, check):
    if library.original:
        pytest.skip("the original does not come back")
    program = compiler.program(
        [os.path.join(HERE, file) for file in ("reconnect.c", "check.c")], library,
        includes=[HERE], flags=["-std=c99", "-D_DEFAULT_SOURCE", "-D_XOPEN_SOURCE=700"])
    environment = {**os.environ, **library.environment(),
                   "IPC_CHECK_CENTRAL": central_program,
                   "IPC_CHECK_LATER_CENTRALS": original_central_program,
                   "ASAN_OPTIONS": "detect_leaks=1:" + os.environ.get("ASAN_OPTIONS", "")}
    done = subprocess.run([program, check], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, cwd=tmp_path, env=environment, timeout=60 * SLOW, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"ok {check}\n", "")
