"""The script `run` at the root, as far as it can be tried from within a test that it runs."""
import os
import re
import subprocess

import pytest

from install.tools import ROOT


def run_script(*arguments):
    return subprocess.run([os.path.join(ROOT, "run"), *arguments], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=60, check=False)


def test_help_is_on_standard_output():
    done = run_script("help")
    assert (done.returncode, done.stderr) == (0, "")
    assert all(command in done.stdout for command in (
        "demo", "test", "test-all", "install", "uninstall", "packages", "--prefix"))


def test_help_names_files_that_are_there():
    for name in re.findall(r"\S+\.md", run_script("help").stdout):
        assert os.path.exists(os.path.join(ROOT, name)), name


@pytest.mark.parametrize("arguments", [
    [], ["unknown"], ["test", "unknown"], ["install", "unknown"], ["install", "--prefix"],
    ["install", "--prefix="]], ids=" ".join)
def test_a_wrong_command_line_is_explained_on_standard_error(arguments):
    done = run_script(*arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert "Usage: ./run COMMAND" in done.stderr


@pytest.mark.parametrize("shell", ["dash", "bash"])
def test_the_script_needs_no_more_than_a_posix_shell(shell):
    try:
        done = subprocess.run([shell, "-n", os.path.join(ROOT, "run")], timeout=60, check=False)
    except FileNotFoundError:
        pytest.skip(f"no {shell} on this machine")
    assert done.returncode == 0
