"""The public headers as compilers see them: in every language standard, at the strictest level."""
import os

import pytest

from install.tools import ROOT, run, tool

STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]
C = ["c89", "c99", "c11", "c17"]
CPLUSPLUS = ["c++98", "c++11", "c++17", "c++20"]
COMPILERS = ([(compiler, "c", std) for compiler in ("gcc", "clang") for std in C] +
             [(compiler, "c++", std) for compiler in ("g++", "clang++") for std in CPLUSPLUS])


@pytest.mark.parametrize("header", ["ipc.h", "ipcx.h"])
@pytest.mark.parametrize("compiler,language,standard", COMPILERS)
def test_a_header_compiles_alone(compiler, language, standard, header):
    run(tool(compiler), f"-std={standard}", *STRICT, "-I", os.path.join(ROOT, "include"),
        "-x", language, "-fsyntax-only", os.path.join(ROOT, "include/ipc", header))


@pytest.mark.parametrize("compiler,language,standard", COMPILERS)
def test_values_types_and_prototypes_are_those_programs_were_compiled_with(
        compiler, language, standard, tmp_path):
    run(tool(compiler), f"-std={standard}", *STRICT, "-x", language,
        "-I", os.path.join(ROOT, "include/ipc"), "-c", "-o", tmp_path / "check.o",
        os.path.join(ROOT, "test/install/header_check.c"))


def test_every_function_of_the_check_is_exported_and_the_other_way_round():
    with open(os.path.join(ROOT, "test/install/header_check.c"), encoding="utf-8") as source:
        checked = {line.split("(")[1].split(",")[0] for line in source
                   if line.startswith("FUNCTION(")}
    with open(os.path.join(ROOT, "test/install/symbols.txt"), encoding="utf-8") as symbols:
        exported = {line.split()[0] for line in symbols
                    if line.startswith("IPC_") and line.split()[1] == "function"}
    assert len(checked) == 70
    assert checked == exported


def test_cplusplus_names_of_functions_with_opaque_types_are_unchanged(tmp_path):
    """Libraries in C++ export such functions; their mangled names hold the struct tags."""
    source = tmp_path / "names.cc"
    source.write_text('#include "ipc.h"\n'
                      "void f(MSG_INSTANCE) {}\n"
                      "void g(IPC_CONTEXT_PTR) {}\n"
                      "void h(FORMATTER_PTR) {}\n")
    run(tool("g++"), "-I", os.path.join(ROOT, "include/ipc"), "-c", source, "-o",
        tmp_path / "names.o")
    names = run(tool("nm"), tmp_path / "names.o").split()
    assert {"_Z1fP10_X_IPC_REF", "_Z1gP14_X_IPC_CONTEXT", "_Z1hPK12_FORMAT_TYPE"} <= set(names)


def test_the_header_includes_only_two_system_headers():
    with open(os.path.join(ROOT, "include/ipc/ipc.h"), encoding="utf-8") as header:
        included = {line.split()[1] for line in header if line.startswith("#include")}
    assert included == {"<stdio.h>", "<sys/select.h>", "<winsock2.h>"}
