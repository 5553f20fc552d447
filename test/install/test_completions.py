"""Completions of xdrgen's command line: they know the options that the program knows."""
import re

import pytest

from install.tools import run, tool

OPTION = r"(?<![\w-])(-[DI]|--?[A-Za-z][\w-]*)"


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


@pytest.fixture(scope="module")
def options(installation):
    """The options that xdrgen's help names."""
    found = set(re.findall(OPTION, run(f"{installation.prefix}/bin/xdrgen", "--help")))
    assert {"-h", "--lang", "-D"} <= found
    return found


def test_bash_is_told_all_options(installation, options):
    words = re.search(r'words="(-h.*?)"', read(installation.path("xdrgen.bash")), re.DOTALL)[1]
    assert set(re.findall(OPTION, words)) == options


def test_zsh_is_told_all_options(installation, options):
    text = read(installation.path("_xdrgen")).replace("_arguments -S", "")
    assert set(re.findall(OPTION, re.sub(r"\[.*?\]", "", text))) == options


def test_fish_is_told_all_options(installation, options):
    text = read(installation.path("xdrgen.fish"))
    letters = {f"-{letter}" for letter in re.findall(r" -s (\w)", text)}
    assert letters | {f"--{word}" for word in re.findall(r" -l ([\w-]+)", text)} == options


@pytest.mark.parametrize("words,expected", [
    (["--l"], ["--lang="]),
    (["--lang", "=", "c"], ["c", "c++"]),
    (["--directives", "="], ["portable", "gcc", "none"]),
    (["messages"], [])], ids=" ".join)
def test_bash_completes(words, expected, installation):
    script = 'source "$0"; COMP_WORDS=(xdrgen "$@"); COMP_CWORD=$#; _xdrgen; echo "${COMPREPLY[@]}"'
    done = run(tool("bash"), "--norc", "-c", script, installation.path("xdrgen.bash"), *words)
    assert done.split() == expected


@pytest.mark.parametrize("shell,name", [("zsh", "_xdrgen"), ("fish", "xdrgen.fish")])
def test_other_shells_can_read_theirs(shell, name, installation):
    run(tool(shell), "-n", installation.path(name))
