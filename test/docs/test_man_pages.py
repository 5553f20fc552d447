"""The manual pages that are made of the manual."""
import glob
import os
import re
import subprocess

import pytest

from docs.markdown import entries
from install.tools import tool

ENTRIES = entries()


@pytest.fixture(scope="module")
def pages(installation):
    """All installed pages by their names, such as IPC_connect.3."""
    found = {}
    for path in glob.glob(os.path.join(installation.prefix, "**/man/man*/*"), recursive=True):
        with open(path, encoding="utf-8") as file:
            found[os.path.basename(path)] = file.read()
    return found


def test_every_entry_is_a_page_and_every_page_of_functions_an_entry(pages):
    assert {name for name in pages if name.endswith(".3")} == {f"{name}.3" for name in ENTRIES}


def test_a_page_says_what_the_entry_says(pages):
    page = pages["IPC_subscribeFD.3"]
    assert ("\n.SH NAME\nIPC_subscribeFD \\- has a handler called whenever a descriptor can be read\n"
            in page)
    sections = re.findall(r"^\.SH (.*)$", page, re.MULTILINE)
    assert sections == ["NAME", "SYNOPSIS", "DESCRIPTION", "PARAMETERS", "RETURNS", "ERRORS",
                        "THREADS", "CMU MANUAL", "EXAMPLE", "SEE ALSO"]
    assert "#include <ipc/ipc.h>\n" in page
    assert "\n.TP\n\\fBfd\\fP\nan open descriptor." in page
    assert "\\fBIPC_unsubscribeFD\\fP(3)" in page.split(".SH SEE ALSO")[1]


def test_no_mark_of_the_documents_is_left(pages):
    marks = {name for name, page in pages.items()
             if name[-1] in "357" and re.search(r"\*\*[A-Z]|\]\(|^```", page, re.MULTILINE)}
    assert not marks


def test_man_has_nothing_to_complain_about(pages, tmp_path):
    tool("groff")
    complaints = ""
    for name, page in pages.items():
        (tmp_path / name).write_text(page, encoding="utf-8")
        complaints += subprocess.run(
            ["groff", "-t", "-K", "utf8", "-man", "-Tutf8", "-rLL=100n", "-ww", "-z",
             tmp_path / name], capture_output=True, text=True, timeout=60, check=False).stderr
    assert not complaints
