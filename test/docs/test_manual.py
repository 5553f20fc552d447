"""The manual has an entry for everything in the public headers, and each says the same as they do.

A function is added to the manual by an entry "## NAME" in one of the files of docs/manual:
its summary in one sentence, its prototype as a block of code, what it does, and the parts
Parameters, Returns, Errors, Threads, Memory (where something is handed over) and CMU manual.
"""
import os
import re

import pytest

from docs.markdown import DOCS, MANUAL, entries, text_of
from install.tools import ROOT

ENTRIES = entries()


COMMENT_OR_DECLARATION = (r"/\*(.*?)\*/"
                          r"|^(?!typedef)((?:extern )?\w[\w *]*\([^;{}]*\);|extern [^;(]*;)")


class Declaration:
    """A function or variable of a header, with the comment above it."""

    def __init__(self, comment, text):
        self.text = " ".join(text.split())
        self.prototype = self.text.removeprefix("extern ") if "(" in self.text else self.text
        self.name = re.search(r"(\w+)(\(|;)", self.text)[1]
        self.errors = set(re.findall(r"IPC_[A-Z]\w+", comment)) & ERRORS

    def parameters(self):
        inside = self.text[self.text.index("(") + 1:self.text.rindex(")")]
        inside = re.sub(r"\(\*(\w+)\)\([^()]*\)", r"\1", inside)  # pointers to functions
        return [] if inside == "void" else [one.split()[-1].lstrip("*")
                                            for one in inside.split(",")]


def header(name):
    with open(os.path.join(ROOT, "include/ipc", name), encoding="utf-8") as file:
        return file.read()


ERRORS = set(re.findall(r"^    (IPC_\w+) = ", header("ipc.h").split("typedef enum")[2],
                        re.MULTILINE)) - {"IPC_No_Error"}


def declarations():
    """The declarations of both headers by name.  A comment counts for all that follow it at once."""
    found = {}
    for name in ("ipc.h", "ipcx.h"):
        text = header(name).split('extern "C" {', 1)[1]
        comment = ""
        for part in re.finditer(COMMENT_OR_DECLARATION, text, re.MULTILINE | re.DOTALL):
            if part[2] is None:
                comment = part[1]
            else:
                declaration = Declaration(comment, part[2])
                found[declaration.name] = declaration
    return found


DECLARATIONS = declarations()
FUNCTIONS = {name: each for name, each in DECLARATIONS.items() if "(" in each.text}


def both(names):
    """Those that have an entry; what is missing is found by one test, not by all."""
    return sorted(set(names) & set(ENTRIES))


def test_the_headers_are_understood():
    with open(os.path.join(ROOT, "test/install/symbols.txt"), encoding="utf-8") as symbols:
        exported = {line.split()[0] for line in symbols if line.startswith(("IPC_", "IPCx_"))}
    assert exported == {name for name in DECLARATIONS if name.startswith("IPC")}


def test_everything_in_the_headers_has_an_entry():
    missing = sorted(set(DECLARATIONS) - set(ENTRIES))
    assert not missing, f"{missing} have no entry in docs/manual: see the top of {__file__}"


def test_every_entry_is_about_something_in_the_headers():
    assert not set(ENTRIES) - set(DECLARATIONS)


@pytest.mark.parametrize("name", both(DECLARATIONS))
def test_the_prototype_is_that_of_the_header(name):
    assert ENTRIES[name].prototype == DECLARATIONS[name].prototype


@pytest.mark.parametrize("name", both(FUNCTIONS))
def test_every_parameter_is_described(name):
    assert ENTRIES[name].parameters() == FUNCTIONS[name].parameters()


@pytest.mark.parametrize("name", both(DECLARATIONS))
def test_an_entry_is_complete(name):
    entry = ENTRIES[name]
    expected = {"Threads", "CMU manual"}
    if name in FUNCTIONS:
        expected |= {"Returns", "Errors"}
    assert expected <= set(entry.parts)
    assert re.fullmatch(r"[A-Z][^.]*\.", entry.summary), "the summary is one sentence"


@pytest.mark.parametrize("name", both(FUNCTIONS))
def test_the_errors_that_the_header_names_are_named(name):
    said = set(re.findall(r"IPC_\w+", ENTRIES[name].parts["Errors"]))
    missing = DECLARATIONS[name].errors - said - inherited(name)
    assert not missing


def inherited(name):
    """Errors of the functions that an entry refers to by `As IPC_other`."""
    found = set()
    for other in re.findall(r"[Aa]s `(\w+)`", ENTRIES[name].parts["Errors"]):
        found |= set(re.findall(r"IPC_\w+", ENTRIES[other].parts["Errors"])) | inherited(other)
    return found


@pytest.mark.parametrize("kind,pattern", [
    ("constants", r"^#define ((?:IPCX?|TRIGGER|NUM)_\w+)"),
    ("values", r"^    (IPC_\w+) = "),
    ("types", r"^(?:typedef|\}).*?\b([A-Z]{2,}[A-Z_]+)(?:;|\)\(|, )")])
def test_constants_and_types_are_named(kind, pattern):
    names = set(re.findall(pattern, header("ipc.h") + header("ipcx.h"), re.MULTILINE))
    assert len(names) >= 6, f"the {kind} of the headers are found"
    text = "".join(text_of(f"docs/manual/{name}") for name in os.listdir(MANUAL))
    unnamed = sorted(name for name in names if not re.search(rf"\b{name}\b", text))
    assert not unnamed, f"no file of docs/manual says what {unnamed} are"


def test_all_files_of_the_manual_are_in_its_table():
    table = text_of("docs/manual/README.md")
    names = set(os.listdir(MANUAL)) - {"README.md"}
    assert not {name for name in names if f"]({name})" not in table}


def test_all_documents_are_in_the_index():
    index = text_of("docs/README.md")
    names = {name for name in os.listdir(DOCS) if name.endswith(".md")} - {"README.md"}
    assert not {name for name in names if f"]({name})" not in index}
