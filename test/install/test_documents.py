"""The documents: their links lead somewhere, and what they name exists."""
import glob
import os
import re

import pytest

from install.tools import ROOT, links_to_files, run


def documents():
    """Every Markdown file of the project, relative to its root."""
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [name for name in folders if not name.startswith((".", "build"))]
        for name in names:
            if name.endswith(".md"):
                yield os.path.relpath(os.path.join(folder, name), ROOT)


def text_of(document):
    with open(os.path.join(ROOT, document), encoding="utf-8") as text:
        return text.read()


@pytest.mark.parametrize("document", sorted(documents()))
def test_links_to_files_lead_to_files(document):
    path = os.path.join(ROOT, document)
    missing = [link for link in links_to_files(path)
               if not os.path.exists(os.path.join(os.path.dirname(path), link))]
    assert not missing


@pytest.mark.parametrize("document", sorted(documents()))
def test_links_into_documents_lead_to_headings(document):
    missing = []
    for target, heading in re.findall(r"\]\(([\w./-]*)#([\w-]+)\)", text_of(document)):
        path = os.path.join(os.path.dirname(document), target) if target else document
        headings = re.findall(r"^#+ (.*)$", text_of(path), re.MULTILINE)
        if heading not in {re.sub(r"[^\w -]", "", one.lower()).replace(" ", "-") for one in headings}:
            missing.append(f"{target}#{heading}")
    assert not missing


def test_files_that_the_map_of_the_code_names_exist():
    names = re.findall(r"`([\w./]+\.[ch])`", text_of("docs/architecture.md"))
    assert names
    places = ["", "include/ipc", "src/c", "src/c/libipc", "src/c/platform", "test/install",
              *glob.glob("src/c/central/**/", root_dir=ROOT, recursive=True)]
    missing = [name for name in names
               if not any(os.path.exists(os.path.join(ROOT, place, name)) for place in places)]
    assert not missing


def test_the_options_that_the_chapter_on_central_names_exist(central_program):
    listed = set(re.findall(r"--[\w-]+", run(central_program, "--help")))
    foreign = {"--now", "--option", "--limit-"}  # of systemctl, and in general
    named = set(re.findall(r"--[a-z][\w-]*", text_of("docs/operation.md"))) - foreign
    assert len(named) > 8
    assert named <= listed
