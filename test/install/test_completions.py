"""Completions of command lines: they know the options that the programs know."""
import re

import pytest

from install.tools import run, tool

PROGRAMS = ["central", "killCentral", "killModule", "xdrgen"]
OPTION = r"(?<![\w-])(--[a-z][\w-]*|-[A-Za-z])"


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


@pytest.fixture(scope="module", params=PROGRAMS)
def program(request):
    return request.param


@pytest.fixture(scope="module")
def options(installation, program):
    """The options that the program's help lists, one a line."""
    text = run(installation.path(program), "--help")
    if program.startswith("kill"):  # they have only these, and their help says nothing about them
        assert run(installation.path(program), "-h") == text
        return {"-h", "--help"}
    found = set(re.findall(OPTION, "\n".join(re.findall("^ -.*", text, re.MULTILINE))))
    assert {"-h", "--help"} < found
    return found


def test_bash_is_told_all_options(installation, program, options):
    words = re.search(r'"\s*(-[hv].*?)"', read(installation.path(f"{program}.bash")), re.DOTALL)[1]
    assert set(re.findall(OPTION, words)) == options


def test_zsh_is_told_all_options(installation, program, options):
    text = read(installation.path(f"_{program}")).replace("_arguments -S", "")
    assert set(re.findall(OPTION, re.sub(r"\[.*?\]", "", text))) == options


def test_fish_is_told_all_options(installation, program, options):
    text = read(installation.path(f"{program}.fish"))
    letters = {f"-{letter}" for letter in re.findall(r" -s (\w)", text)}
    words = {f"--{word}" for word in re.findall(r" -l ([\w-]+)", text)}
    assert letters | words == options


@pytest.mark.parametrize("words,expected", [
    (["xdrgen", "--l"], ["--lang="]),
    (["xdrgen", "--lang", "=", "c"], ["c", "c++"]),
    (["xdrgen", "--directives", "="], ["portable", "gcc", "none"]),
    (["xdrgen", "messages"], []),
    (["central", "--limit-st"], ["--limit-stuck-seconds=", "--limit-strangers="]),
    (["central", "-u", "--access", "=", "o"], ["owner"]),
    (["central", "--when-full", "="], ["wait", "newest", "oldest", "disconnect"]),
    (["central", "--bind", "l"], ["local"]),
    (["central", "--pid-file", "=", "a"], []),
    (["killCentral", "--"], ["--help"]),
    (["killModule", "name"], [])], ids=" ".join)
def test_bash_completes(words, expected, installation):
    script = ('source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); "_$1"; '
              'echo "${COMPREPLY[@]}"')
    done = run(tool("bash"), "--norc", "-c", script, installation.path(f"{words[0]}.bash"), *words)
    assert done.split() == expected


@pytest.mark.parametrize("shell,form", [("zsh", "_{}"), ("fish", "{}.fish")])
def test_other_shells_can_read_theirs(shell, form, program, installation):
    run(tool(shell), "-n", installation.path(form.format(program)))
