"""Large specifications: work and memory grow as the specification does.

Nothing here looks at a clock: instructions are counted by valgrind, memory by the system.
"""
import os
import re
import shutil
import subprocess

import pytest

from xdrgen.conftest import BUILD

PART = """struct T{0} {{
  int n{0};
  float data<>;
  struct {{ int a; double b[3]; }} in[4];
  string name<>;
%{{
  /* a note */
%}}
}};
enum E{0} {{ A{0}, B{0} = 7 }};
typedef T{0} S{0}[3];
"""
LINES_OF_PART = PART.count("\n")


def write(path, lines):
    path.write_text("".join(PART.format(i) for i in range(lines // LINES_OF_PART)))


def is_sanitized():
    with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as cache:
        return re.search(r"^IPC_SANITIZE:STRING=.+", cache.read(), re.MULTILINE) is not None


def instructions(program, folder, language):
    """The number of instructions that one run takes."""
    done = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program,
                           f"--lang={language}", "in.xdr", "out"], cwd=folder, timeout=600,
                          capture_output=True, text=True, check=True)
    return int(re.search(r"Collected : (\d+)", done.stderr).group(1))


@pytest.mark.parametrize("language", ["c", "c++", "python", "json"])
def test_work_is_proportional_to_the_specification(program, tmp_path, language):
    if shutil.which("valgrind") is None:
        pytest.skip("no valgrind on this machine")
    if is_sanitized():
        pytest.skip("valgrind cannot run programs with sanitizers")
    counts = []
    for lines in (2000, 8000):
        write(tmp_path / "in.xdr", lines)
        counts.append(instructions(program, tmp_path, language))
    assert counts[1] < 4.6 * counts[0]


@pytest.mark.parametrize("lines", [25000, 100000, 400000])
def test_memory_is_proportional_to_the_specification(program, tmp_path, lines):
    if is_sanitized():
        pytest.skip("a sanitizer takes address space of its own")
    write(tmp_path / "in.xdr", lines)
    # So much for the program itself, and for every byte of the specification.
    allowed = 12000 + 40 * (tmp_path / "in.xdr").stat().st_size // 1024
    done = subprocess.run(["sh", "-c", f'ulimit -v {allowed} && exec "$0" in.xdr out', program],
                          cwd=tmp_path, timeout=300, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("text", [
    "@" * 20000, "typedef;\n" * 20000, "\n" * 20000 + "@", '# 1 "x" 1\n' * 20000, "/* \n" * 20000,
    "struct A { " * 20000, "enum E { A, " + "A, " * 20000, "%{" * 20000, "[" * 20000,
    'ipc_type A = "' + "\\q" * 20000 + '";'], ids=lambda text: text[:12].strip())
def test_bad_specifications_of_any_length_end_with_an_error(xdrgen, text):
    done = xdrgen("in.xdr", text=text)
    assert done.returncode == (0 if text.startswith("# 1") else 1)
    assert "Sanitizer" not in done.stderr and "runtime error" not in done.stderr
