"""The functions of ipc.h are in both libraries with the same types, as their debug information
says."""
import os
import shutil
import subprocess

import pytest

SUPPRESSIONS = os.path.join(os.path.dirname(__file__), "abi.suppr")


@pytest.fixture
def compare():
    """(exit status, text) of a comparison: 0 when nothing that programs use has changed."""
    abidiff = shutil.which("abidiff")
    if abidiff is None:
        pytest.skip("no abidiff on this machine (Debian: abigail-tools)")

    def run(before, after):
        done = subprocess.run([abidiff, "--suppressions", SUPPRESSIONS, "--no-added-syms",
                               "--no-show-locs", before, after], capture_output=True, text=True,
                              timeout=300, check=False)
        return done.returncode, done.stdout + done.stderr
    return run


def has_debug_information(path):
    with open(path, "rb") as file:
        return b".debug_info\0" in file.read()


def test_no_function_of_the_original_is_gone_or_changed(compare, library, original_library):
    if library.link_flags:
        pytest.skip("sanitizers change the library")
    for path in (original_library.path, library.path):
        if not has_debug_information(path):
            pytest.skip(f"{path} has no debug information")
    status, text = compare(original_library.path, library.path)
    assert status == 0, text


@pytest.mark.parametrize("after, found", [
    ("struct content { unsigned length; void *bytes; };\n"
     "int IPC_send(const char *name, struct content *c) { return name && c->bytes; }\n", False),
    ("struct content { unsigned length; void *bytes; };\n"
     "int IPC_send(const char *name) { return name != 0; }\n", True),
    ("struct content { void *bytes; unsigned length; };\n"
     "int IPC_send(const char *name, struct content *c) { return name && c->bytes; }\n", True),
    ("int IPC_other(void) { return 0; }\n", True)],
    ids=["same", "parameter", "member", "gone"])
def test_the_comparison_finds_what_breaks_programs(after, found, compare, compiler, tmp_path):
    before = ("struct content { unsigned length; void *bytes; };\n"
              "int IPC_send(const char *name, struct content *c) { return name && c->bytes; }\n"
              "int internal(void) { return 1; }\n")
    libraries = []
    for name, text in (("before", before), ("after", after)):
        source = tmp_path / f"{name}.c"
        source.write_text(text)
        libraries.append(str(tmp_path / f"{name}.so"))
        subprocess.run([compiler.command, "-g", "-shared", "-fPIC", "-o", libraries[-1], source],
                       check=True, timeout=60)
    status, text = compare(*libraries)
    assert (status != 0) == found, text
