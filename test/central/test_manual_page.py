"""The manual page says what the program says."""
import os
import re
import shutil
import subprocess

import pytest

from support.processes import Process
from support.waiting import PATIENCE

PAGE = os.path.join(os.path.dirname(__file__), "..", "..", "src", "c", "central",
                    "central.8")

pytestmark = pytest.mark.new_central("it has no manual page of ours")


def section(name):
    """The text of a section."""
    with open(PAGE, encoding="utf-8") as file:
        text = file.read()
    return re.search(rf"^\.SH {name}\n(.*?)(?=^\.SH |\Z)", text, re.MULTILINE | re.DOTALL).group(1)


def heads(name):
    """The heads of a section's paragraphs, without fonts."""
    found = re.findall(r"^\.TP\n\.\w+ (.*)$", section(name), re.MULTILINE)
    return [re.sub(r"\\f.", "", head).replace("\\-", "-") for head in found]


def listed_options(program):
    done = subprocess.run([program, "--help"], capture_output=True, text=True, check=True,
                          timeout=PATIENCE, stdin=subprocess.DEVNULL)
    return [line.strip().split(": ")[0] for line in done.stdout.split("\n")
            if re.match(r" -", line)]


def test_options_are_those_of_the_program_in_its_order(central_program):
    options = listed_options(central_program)
    limits = [option for option in options if option.startswith("--limit-")]
    assert limits
    assert heads("OPTIONS") == [option for option in options if option not in limits] + [
        "--limit-name=<number>"]


def test_commands_are_those_of_the_program(central_program, stack):
    process = stack.enter_context(Process([central_program, "-p0", "-lx"], stdin=-1))
    process.write_line("help")
    process.wait_for_line("The following command line options")
    lines = process.stdout
    start = next(n for n, line in enumerate(lines) if "following command are" in line)
    end = next(n for n, line in enumerate(lines) if "following command line options" in line)
    listed = [re.match(r"\w+", line).group() for line in lines[start + 1:end]]
    process.write_line("quit")
    assert process.wait() == 0
    assert [head.split()[0] for head in heads("COMMANDS")] == [*listed, "quit"]


def test_the_page_has_no_errors():
    if not shutil.which("groff"):
        pytest.skip("no groff")
    done = subprocess.run(["groff", "-man", "-ww", "-z", PAGE], capture_output=True, text=True,
                          timeout=60, check=True)
    assert done.stderr == ""
