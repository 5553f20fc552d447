"""The documents: their links lead somewhere, and their programs work."""
import os
import re

import pytest

from install.tools import ROOT, run, tool


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
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", re.sub("```.*?```", "", text_of(document),
                                                          flags=re.DOTALL))
    folder = os.path.dirname(os.path.join(ROOT, document))
    missing = [link for link in links if not re.match(r"\w+:", link)
               and not os.path.exists(os.path.join(folder, link))]
    assert not missing


def test_files_that_the_map_of_the_code_names_exist():
    names = re.findall(r"`([\w./]+\.[ch])`", text_of("docs/architecture.md"))
    assert names
    places = ["", "include/ipc", "src/c", "src/c/libipc", "src/c/central", "src/c/platform",
              "test/install"]
    missing = [name for name in names
               if not any(os.path.exists(os.path.join(ROOT, place, name)) for place in places)]
    assert not missing


def test_the_first_program_of_the_readme_works(build, installation, central, tmp_path):
    program = re.search("```c\n(.*?)```", text_of("README.md"), re.DOTALL).group(1)
    (tmp_path / "hello.c").write_text(program)
    flags = run(tool("pkg-config"), "--cflags", "--libs", "ipc", env=installation.env).split()
    run(build.compiler, *build.flags, "-Wall", "-Wextra", "-Werror", tmp_path / "hello.c", "-o",
        tmp_path / "hello", *flags)
    said = run(tmp_path / "hello", env={**installation.env, "CENTRALHOST": central.address})
    assert said.endswith("position: 1.5 2.5\n")


def test_the_options_that_the_chapter_on_central_names_exist(central_program):
    listed = set(re.findall(r"--[\w-]+", run(central_program, "--help")))
    foreign = {"--now", "--option", "--limit-"}  # of systemctl, and in general
    named = set(re.findall(r"--[a-z][\w-]*", text_of("docs/operation.md"))) - foreign
    assert len(named) > 8
    assert named <= listed
