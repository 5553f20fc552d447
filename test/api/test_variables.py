"""The variables of the library as programs without position-independent code see them."""
import os
import subprocess

import pytest

from support.waiting import SLOW

HERE = os.path.dirname(os.path.abspath(__file__))
CHECKS = ("the_verbosity_is_checked_and_can_be_read",
          "assigning_the_verbosity_variable_has_an_effect",
          "perror_prints_the_text_of_every_error",
          "a_fresh_library_never_ends_the_process")


def expect_to_pass(program, library, check):
    environment = {**os.environ, **library.environment(), "ASAN_OPTIONS": "detect_leaks=0"}
    done = subprocess.run([program, check], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, env=environment, timeout=30 * SLOW, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"ok {check}\n", "")


def program_with_copies(compiler, library):
    """A program that holds copies of the library's variables, which both must use."""
    return compiler.program(
        [os.path.join(HERE, "output.c"), os.path.join(HERE, "check.c")], library, name="copies",
        includes=[HERE],
        flags=["-std=c99", "-D_DEFAULT_SOURCE", "-D_XOPEN_SOURCE=700", "-fno-pie", "-no-pie"])


@pytest.mark.parametrize("check", CHECKS)
def test_program_and_library_share_their_variables(compiler, library, check):
    expect_to_pass(program_with_copies(compiler, library), library, check)


@pytest.mark.parametrize("check", CHECKS)
def test_so_does_a_program_that_was_linked_with_the_original(
        compiler, library, original_library, check):
    expect_to_pass(program_with_copies(compiler, original_library), library, check)
