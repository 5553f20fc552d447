"""Crowds of threads with ThreadSanitizer, on a library that is built for it."""
import os
import shutil
import subprocess

import pytest

from support.processes import Library
from support.waiting import SLOW

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
SANITIZE = "-fsanitize=thread"


def works_here(directory):
    """Whether programs with ThreadSanitizer can be built, and run on this system."""
    source = os.path.join(directory, "try.c")
    program = os.path.join(directory, "try")
    with open(source, "w", encoding="utf-8") as file:
        file.write("int main(void) { return 0; }\n")
    compiler = os.environ.get("CC") or shutil.which("cc")
    for command in ([compiler, SANITIZE, "-o", program, source], [program]):
        done = subprocess.run(command, capture_output=True, timeout=60 * SLOW, check=False)
        if done.returncode != 0:
            return False
    return True


@pytest.fixture(scope="module")
def thread_library(library, tmp_path_factory):
    """The library, built with ThreadSanitizer in a directory of its own."""
    if library.original:
        pytest.skip("no sources of the original")
    if not shutil.which("cmake"):
        pytest.skip("no cmake")
    directory = str(tmp_path_factory.mktemp("thread"))
    if not works_here(directory):
        pytest.skip("no ThreadSanitizer here")
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    for command in (["cmake", "-S", ROOT, "-B", directory, *generator, "-DIPC_SANITIZE=thread",
                     "-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DIPC_BUILD_EXAMPLES=OFF"],
                    ["cmake", "--build", directory, "--target", "ipc", "--parallel", "2"]):
        done = subprocess.run(command, capture_output=True, text=True, timeout=300 * SLOW,
                              check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return Library("thread", os.path.join(directory, "src/c/libipc"))


@pytest.mark.parametrize("source,check", [
    ("crowd.c", "eight_threads_in_two_contexts_lose_nothing"),
    ("reconnect.c", "threads_wait_for_central_together")])
def test_a_crowd_of_threads_races_for_nothing(
        thread_library, compiler, central_program, tmp_path, source, check):
    program = compiler.program(
        [os.path.join(HERE, source), os.path.join(HERE, "check.c")], thread_library,
        includes=[HERE], flags=["-std=c99", "-D_DEFAULT_SOURCE", "-D_XOPEN_SOURCE=700", SANITIZE])
    environment = {**os.environ, "IPC_CHECK_CENTRAL": central_program,
                   "TSAN_OPTIONS": f"suppressions={os.path.join(HERE, 'thread_sanitizer.txt')} "
                                   "print_suppressions=0"}
    done = subprocess.run([program, check], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, cwd=tmp_path, env=environment, timeout=120 * SLOW,
                          check=False)
    assert done.stderr == ""
    assert (done.returncode, done.stdout) == (0, f"ok {check}\n")
