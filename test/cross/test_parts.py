"""The unit tests on other machines, and central there between modules made by hand."""
import os
import subprocess
import sys

from cross.platforms import BUILD_SECONDS, PLATFORMS, ROOT
from support.waiting import SLOW

FORMATS, WIRE = "^(fuzz_)?format_", "^(wire_|link$)"

#: Tests of central by bytes, those that a slow machine does not take minutes for.
WIRE_TESTS = [f"test/wire/test_{name}.py" for name in (
    "captures", "central_definitions", "central_disconnect", "central_handshake",
    "central_publish", "central_query", "central_robustness")]


def part(name):
    """The column of the table that a test belongs to."""
    def mark(function):
        function.part = name
        return function
    return mark


@part("formats")
def test_formats_are_understood_laid_out_and_encoded_as_recorded(platform, machine):
    check(machine(platform).unit_tests("-R", FORMATS))


@part("wire")
def test_frames_are_read_and_written_as_recorded(platform, machine):
    check(machine(platform).unit_tests("-R", WIRE))


@part("unit")
def test_the_other_parts_pass_their_tests(platform, machine):
    check(machine(platform).unit_tests("-E", f"{FORMATS}|{WIRE}"))


def check(done):
    status, output = done
    assert status == 0, output[-6000:]


@part("wire")
def test_its_central_passes_the_tests_by_hand_made_bytes(platform, machine):
    """In a run of its own, since which central is tested is an option."""
    without, left_out = {}, ()
    if not PLATFORMS[platform].unix_sockets:
        without, left_out = {"IPC_TEST_WITHOUT_UNIX": "1"}, ("-k", "not unix_socket")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *WIRE_TESTS, *left_out,
         "--central", machine(platform).central], cwd=ROOT, capture_output=True, text=True,
        timeout=BUILD_SECONDS, stdin=subprocess.DEVNULL, check=False,
        env={**os.environ, "IPC_TEST_SLOW": str(4 * SLOW),
             **without})
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr
