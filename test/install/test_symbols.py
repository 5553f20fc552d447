"""What the built libraries export: programs that were linked long ago must still start."""
import os
import re

import pytest

from install.tools import ROOT, run, tool

KINDS = {"T": "function", "B": "data", "D": "data", "R": "data"}


def listed_symbols():
    """name → (kind, size of data or None), as checked in."""
    symbols = {}
    with open(os.path.join(ROOT, "test/install/symbols.txt"), encoding="utf-8") as lines:
        for line in lines:
            if words := line.split("#")[0].split():
                symbols[words[0]] = (words[1], int(words[2]) if len(words) > 2 else None)
    return symbols


def symbols_of(library, *options):
    """name → (kind, size of data or None), as nm tells."""
    symbols = {}
    for line in run(tool("nm"), "--defined-only", "--extern-only", "--print-size",
                    *options, library).splitlines():
        if match := re.match(r"[0-9a-f]+ ([0-9a-f]+) (\w) (\S+)$", line):
            size, kind, name = match.groups()
            symbols[name] = (KINDS[kind], int(size, 16) if KINDS[kind] == "data" else None)
    return symbols


def skip_if_sanitized(build):
    if build.flags:
        pytest.skip("sanitizers add symbols and padding of their own")


def test_the_shared_library_exports_the_listed_symbols_and_no_others(build):
    skip_if_sanitized(build)
    assert symbols_of(build.shared_library, "--dynamic") == listed_symbols()


def test_the_static_library_shows_the_listed_symbols_and_no_others(build):
    """Anything more could clash with a function of the program."""
    skip_if_sanitized(build)
    assert symbols_of(build.static_library) == listed_symbols()


def test_the_dll_shows_the_listed_symbols_and_no_others():
    with open(os.path.join(ROOT, "Windows/ipc.def"), encoding="utf-8") as lines:
        shown = [line.split(";")[0].split() for line in lines]
    assert {words[0]: "data" if words[1:] == ["DATA"] else "function"
            for words in shown if words and words != ["EXPORTS"]} == \
        {name: kind for name, (kind, _) in listed_symbols().items()}


def test_the_soname_is_the_one_that_old_programs_ask_for(build):
    assert "Library soname: [libipc.so.1]" in run(tool("readelf"), "-d", build.shared_library)


def test_symbols_have_no_versions(build):
    """Programs linked with CMU IPC ask for none."""
    dynamic = run(tool("readelf"), "-d", build.shared_library)
    assert "(VERDEF)" not in dynamic


def test_programs_may_hold_the_data_of_the_library(build):
    """
    Non-PIC programs have copies of IPC_errno and others, which the library must use: so it is not
    linked with -Bsymbolic and reaches each of them through the global offset table.
    """
    assert "SYMBOLIC" not in run(tool("readelf"), "-d", build.shared_library)
    relocations = run(tool("readelf"), "-rW", build.shared_library)
    for name, (kind, _) in listed_symbols().items():
        if kind == "data":
            assert re.search(rf"GLOB_DAT.*\b{name}\b|_64 .*\b{name}\b", relocations), name


def test_a_program_that_is_not_position_independent_sees_the_error(build, tmp_path):
    source = tmp_path / "copy.c"
    source.write_text('#include "ipc.h"\n'
                      "extern IPC_VERBOSITY_TYPE ipcVerbosity;\n"
                      "int main(void) {\n"
                      "    ipcVerbosity = IPC_Silent; /* the library must obey */\n"
                      "    IPC_isConnected();\n"
                      '    if (IPC_publish("", 0, 0) != IPC_Error) return 1;\n'
                      "    if (IPC_errno != IPC_Null_Argument) return 2;\n"
                      "    return IPC_setVerbosity(IPC_Print_Warnings) == IPC_OK\n"
                      "               && ipcVerbosity == IPC_Print_Warnings ? 0 : 3;\n"
                      "}\n")
    program = tmp_path / "copy"
    run(build.compiler, *build.flags, "-fno-pie", "-no-pie", "-I",
        os.path.join(ROOT, "include/ipc"), source, "-o", program, build.shared_library)
    assert " R_X86_64_COPY " in run(tool("readelf"), "-rW", program) or \
        os.uname().machine != "x86_64"
    run(program, env={"LD_LIBRARY_PATH": os.path.dirname(build.shared_library),
                      "ASAN_OPTIONS": "detect_leaks=0"})
