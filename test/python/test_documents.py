"""The programs in docs/python.md work, and print what the document says."""
import os
import re

import pytest

from python.tools import BUILD, ROOT, Program
from support.waiting import SLOW


def programs():
    """(number, program, its output) of each program in the document."""
    with open(os.path.join(ROOT, "docs", "python.md"), encoding="utf-8") as file:
        found = re.findall(r"```python\n(.*?)```(?:(?:(?!```).)*?```text\n(.*?)```)?",
                           file.read(), re.DOTALL)
    return [(number, *pair) for number, pair in enumerate(found, 1)]


@pytest.mark.parametrize("number, text, output", programs(),
                         ids=lambda value: str(value) if isinstance(value, int) else "")
def test_a_program_of_the_document(number, text, output, central):
    for needed in re.findall(r"^import (numpy|trio)$", text, re.MULTILINE):
        pytest.importorskip(needed)
    path = os.path.join(BUILD, "src/c/central") + os.pathsep + os.environ["PATH"]
    with Program(text, central=central, env={"PATH": path}) as started:
        assert started.wait(60 * SLOW) == 0, started.output()
    lines = [line.rstrip() for line in started.stdout]
    for line in output.splitlines():
        assert line in lines
