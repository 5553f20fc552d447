"""The documents as the tests see them: their blocks of code, and the entries of the manual."""
import os
import re

from install.tools import ROOT

DOCS = os.path.join(ROOT, "docs")
MANUAL = os.path.join(DOCS, "manual")


class Block:
    """A block of code: its language, the word behind that (how it is tested), and its text."""

    def __init__(self, document, line, info, text):
        self.document, self.line, self.text = document, line, text
        self.language, _, self.use = info.partition(" ")

    def __str__(self):
        return f"{self.document}:{self.line}"


def documents():
    """The documents whose code is tested, relative to the root of the project."""
    yield "README.md"
    for folder, _, names in sorted(os.walk(DOCS)):
        for name in sorted(names):
            if name.endswith(".md"):
                yield os.path.relpath(os.path.join(folder, name), ROOT)


def text_of(document):
    with open(os.path.join(ROOT, document), encoding="utf-8") as file:
        return file.read()


def blocks_of(document):
    """The blocks of code between lines of three backquotes, in their order."""
    text = text_of(document)
    for found in re.finditer(r"^```([^\n]*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        yield Block(document, text.count("\n", 0, found.start()) + 1, found[1], found[2])


class Entry:
    """What the manual says about one function: its prototype, and its parts by their titles."""

    def __init__(self, name, text):
        self.name = name
        self.text = text
        self.summary = text.split("\n\n", 1)[0].replace("\n", " ")
        prototype = re.search(r"^```c\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
        self.prototype = " ".join(prototype[1].split()) if prototype else ""
        parts = re.split(r"^\*\*([A-Z][\w ]*):\*\* ?", text, flags=re.MULTILINE)
        self.parts = dict(zip(parts[1::2], parts[2::2]))

    def parameters(self):
        """Names of the parameters that are described."""
        return re.findall(r"^- `(\w+)`: ", self.parts.get("Parameters", ""), re.MULTILINE)


def entries():
    """All entries of the manual by their names."""
    found = {}
    for name in sorted(os.listdir(MANUAL)):
        if name != "README.md":
            parts = re.split(r"^## (\w+)\n\n", text_of(f"docs/manual/{name}"), flags=re.MULTILINE)
            for function, text in zip(parts[1::2], parts[2::2]):
                assert function not in found, f"two entries for {function}"
                found[function] = Entry(function, text)
    return found
