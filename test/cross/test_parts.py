"""The unit tests on other machines, and central there between modules made by hand."""
import os
import subprocess
import sys

from cross.platforms import BUILD_SECONDS, PLATFORMS, ROOT
from support.driver import Driver
from support.processes import Central
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
    if PLATFORMS[platform].windows:
        without, left_out = {"IPC_TEST_WITHOUT_UNIX": "1"}, ("-k", "not unix_socket")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider",
         "--disable-warnings", *WIRE_TESTS, *left_out,
         "--central", machine(platform).central], cwd=ROOT, capture_output=True, text=True,
        timeout=BUILD_SECONDS, stdin=subprocess.DEVNULL, check=False,
        env={**os.environ, "IPC_TEST_SLOW": str(4 * SLOW),
             **without})
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr


@part("unit")
def test_its_xdrgen_writes_what_the_one_here_writes(platform, machine, build_directory, tmp_path):
    source = tmp_path / "types.x"
    source.write_text("enum colour { RED, GREEN };\n"
                      "struct sample { int number; string text<>; colour colours[3]; };\n")
    written = []
    for name, program in (("here", os.path.join(build_directory, "xdrgen/xdrgen")),
                          ("there", machine(platform).program("xdrgen/xdrgen"))):
        target = tmp_path / name / "types.h"
        target.parent.mkdir()
        subprocess.run([program, source, target], check=True, timeout=BUILD_SECONDS,
                       stdin=subprocess.DEVNULL)
        written.append(target.read_bytes())
    assert b"sample" in written[0]
    assert written[0] == written[1]


@part("unit")
def test_its_killmodule_ends_a_module_there(platform, machine, stack):
    there = machine(platform)
    central = stack.enter_context(Central(there.central))
    module = stack.enter_context(Driver(there.driver, name="VICTIM")).connect(central.address)
    done = subprocess.run([there.program("src/c/shell/killModule"), "VICTIM"], check=False,
                          capture_output=True, text=True, stdin=subprocess.DEVNULL,
                          timeout=BUILD_SECONDS,
                          env={**os.environ, "CENTRALHOST": f"127.0.0.1:{central.port}"})
    assert done.returncode == 0, done.stdout + done.stderr
    module.wait()
