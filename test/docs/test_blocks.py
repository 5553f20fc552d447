"""Every block of C in the documents compiles, and those that say so run; so do blocks of shell.

What is tested is said behind the language in the line that begins a block:

    c             declarations and functions, compiled
    c fragment    statements, compiled inside a function
    c run         a program, compiled, and run beside a central; it ends with status 0
    c save=NAME   written to a file of that name, for the blocks of shell below
    python run    a program, run like one in C
    sh            a script that is only parsed
    sh run        a script that is run, and must succeed
    text output   what the block that ran before prints, a program also on standard error
    NAME save=X   text of any other kind, written to a file

Blocks of shell of one document run one after the other, in one directory, with what is installed in
their path and a central where CENTRALHOST says.
"""
import os

import pytest

from docs.markdown import blocks_of, documents
from install.tools import ROOT, run, tool
from support.processes import Process
from support.waiting import PATIENCE

BLOCKS = [block for document in documents() for block in blocks_of(document)]
PREAMBLE = "".join(f"#include <{header}>\n" for header in (
    "errno.h", "poll.h", "pthread.h", "stdio.h", "stdlib.h", "string.h", "unistd.h",
    "ipc/ipc.h", "ipc/ipcx.h"))
USES = {"c": ("", "fragment", "run"), "python": ("", "run"), "sh": ("", "run"),
        "text": ("", "output")}


def of_kind(language, *uses):
    return [block for block in BLOCKS if block.language == language and block.use in uses]


def documents_with_scripts():
    return sorted({block.document for block in of_kind("sh", "run")})


def is_output(block):
    return (block.language, block.use) == ("text", "output")


def expected_output(block):
    """What the text says that a block prints, or None."""
    following = BLOCKS[BLOCKS.index(block) + 1:][:1]
    if following and following[0].document == block.document and is_output(following[0]):
        return following[0].text
    return None


@pytest.mark.parametrize("block", BLOCKS, ids=str)
def test_the_word_behind_the_language_is_one_of_those_above(block):
    assert block.use.startswith("save=") or block.use in USES.get(block.language, ("",))


@pytest.mark.parametrize("block", filter(is_output, BLOCKS), ids=str)
def test_output_stands_behind_what_prints_it(block):
    before = BLOCKS[BLOCKS.index(block) - 1]
    assert (before.document, before.use) == (block.document, "run")


@pytest.mark.parametrize("block", of_kind("c", "", "fragment"), ids=str)
def test_c_compiles(block, build, tmp_path):
    text = f'#line {block.line + 1} "{block.document}"\n{block.text}'
    if block.use == "fragment":
        text = f"static void fragment(void)\n{{\n{text}}}\n"
    (tmp_path / "block.c").write_text(PREAMBLE + text, encoding="utf-8")
    run(build.compiler, "-std=c99", "-D_POSIX_C_SOURCE=200809L", "-Wall", "-Wextra", "-Werror",
        "-Wno-unused", "-Wno-unused-parameter", "-I", os.path.join(ROOT, "include"), "-fsyntax-only",
        tmp_path / "block.c")


@pytest.mark.parametrize("block", of_kind("c", "run"), ids=str)
def test_c_runs(block, shell, tmp_path):
    (tmp_path / "program.c").write_text(block.text, encoding="utf-8")
    shell("cc -Wall -Wextra -Werror program.c -o program -pthread $(pkg-config --cflags --libs ipc)")
    check_output(shell("./program 2>&1"), block)


@pytest.mark.parametrize("block", of_kind("python", "run"), ids=str)
def test_python_runs(block, shell, tmp_path):
    (tmp_path / "program.py").write_text(block.text, encoding="utf-8")
    check_output(shell("python3 program.py"), block)


@pytest.mark.parametrize("block", of_kind("sh", ""), ids=str)
def test_shell_is_shell(block, tmp_path):
    (tmp_path / "script").write_text(block.text, encoding="utf-8")
    run(tool("sh"), "-n", tmp_path / "script")


@pytest.mark.parametrize("document", documents_with_scripts())
def test_shell_runs(document, shell, tmp_path):
    for block in (block for block in BLOCKS if block.document == document):
        if block.use.startswith("save="):
            (tmp_path / block.use.removeprefix("save=")).write_text(block.text, encoding="utf-8")
        elif (block.language, block.use) == ("sh", "run"):
            check_output(shell(block.text), block)


def check_output(output, block):
    """Compares what a block has printed, less what connecting prints, with what the text says."""
    expected = expected_output(block)
    lines = [line for line in output.splitlines(keepends=True)
             if not line.startswith(("NMP IPC Version ", "... IPC Connected on port "))]
    assert expected is None or "".join(lines) == expected


@pytest.fixture
def shell(build, installation, central, tmp_path):
    """Runs scripts in a directory of their own, as a user who has installed IPC would."""
    commands = tmp_path / "commands"
    commands.mkdir()
    compiler = commands / "cc"
    compiler.write_text(f'#!/bin/sh\nexec {build.compiler} {" ".join(build.flags)} "$@"\n')
    compiler.chmod(0o755)
    tool("pkg-config")
    environment = {**installation.env, "CENTRALHOST": central.address,
                   "PATH": f"{commands}:{installation.prefix}/bin:{os.environ['PATH']}"}

    def run_script(text):
        with Process(["sh", "-e", "-c", text], cwd=tmp_path, env=environment) as process:
            status = process.wait(20 * PATIENCE)
            assert status == 0, f"{text}\n{process.output()}"
            return "".join(f"{line}\n" for line in process.stdout)
    return run_script
