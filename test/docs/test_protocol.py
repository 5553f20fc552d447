"""The document of the protocol lists what library and central say to each other."""
import os
import re

from docs.markdown import text_of
from install.tools import ROOT


def source(path):
    with open(os.path.join(ROOT, "src/c/wire", path), encoding="utf-8") as file:
        return file.read()


def requests_of_the_source():
    """Name, alias, class, formats of data and answer of every message in the catalogue."""
    texts = dict(re.findall(r'^#define (\w+) (".*")$', source("catalogue.h") + source("catalogue.c"),
                            re.MULTILINE))
    classes = dict(re.findall(r"(CLASS_\w+) = (\d+)", source("frame.h")))
    for entry in re.findall(r'\[LM_\w+\] = \{(".*?)\},?\n', source("catalogue.c"), re.DOTALL):
        for name, text in texts.items():
            entry = re.sub(rf"\b{name}\b", text.replace("\\", "\\\\"), entry)
        name, alias, kind, data, answer, _ = re.findall(r'"[^"]*"|[A-Z_]+|true|false', entry)
        yield tuple(part.strip('"').replace("NULL", "")
                    for part in (name, alias, classes[kind], data, answer))


def requests_of_the_document():
    section = text_of("docs/protocol.md").split("\n## Requests\n")[1].split("\n## ")[0]
    for row in re.findall(r"^\| `(.*) \|$", section, re.MULTILINE):
        yield tuple(cell.strip("` ") for cell in row.split(" |")[:5])


def test_the_requests_are_those_of_the_catalogue():
    expected = list(requests_of_the_source())
    assert len(expected) > 40
    assert list(requests_of_the_document()) == expected


def test_the_abilities_are_those_of_the_catalogue():
    abilities = re.findall(r'^#define ABILITY_\w+ "(\w+)"', source("catalogue.h"), re.MULTILINE)
    section = text_of("docs/protocol.md").split("\n### Abilities\n")[1].split("\n## ")[0]
    assert re.findall(r"^\| `(\w+)`", section, re.MULTILINE) == abilities
