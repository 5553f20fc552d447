"""The corpus: specifications, and what must come of each.

NAME.xdr is a specification written for these tests.  NAME.c.h and NAME.cc.h are what xdrgen of CMU
IPC 3.9.1 makes of it, NAME.err what it says; NAME.want.* take their places where it is wrong.
cases.tsv has a line for each run of the program.
"""
import csv
import os
import re

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "corpus")

# Lines that must be as they are in full; of the others the place and the kind count.
EXACT = ("not supported.", "variable-length array", "undeclared type")


def cases():
    """The lines of cases.tsv as dictionaries."""
    with open(os.path.join(FOLDER, "cases.tsv"), encoding="utf-8") as table:
        return list(csv.DictReader(table, delimiter="\t", quoting=csv.QUOTE_NONE))


def path(name):
    """Path of a file of the corpus."""
    return os.path.join(FOLDER, name)


def binding_part(line):
    """The part of a line of diagnostics that must be the same."""
    if "syntax error" in line:
        return line[:line.index("syntax error") + len("syntax error")]
    if "warning: dimension field" in line or "warning: negative" in line:
        return re.match(r"[^:]*:\d+: warning:", line).group(0)
    if any(text in line for text in EXACT) or "from " in line:
        return line
    return re.match(r"[^:]*:\d+:", line).group(0)


def diagnostics(name):
    """Beginnings of the lines that a run must print on standard error, in this order."""
    if name == "-":
        return []
    with open(path(name), encoding="latin-1") as file:
        _, _, text = file.read().partition("--- stderr\n")
    return [binding_part(line) for line in text.split("\n")
            if line and not line.startswith(("XDRParser::", "couldn't parse"))]


def names():
    """Specifications of which headers can be made and compiled, with the languages."""
    return sorted({(case["case"], case["lang"]) for case in cases()
                   if case["expected_header"] != "-" and "directives" not in case["arguments"]
                   and (case["original_compiles"] == "yes" or ".want." in case["expected_header"])
                   and case["expected_header"] != "guard_name.want.c.h"})
