"""Generated headers: they compile without a warning, and their types are what IPC takes them for."""
import json
import os
import re
import shutil
import subprocess

import pytest

from xdrgen import corpus, values

# Name of a compiler, its language, the standards.
COMPILERS = [("gcc", "c", ("c99", "c11", "c2x")), ("clang", "c", ("c99", "c11", "c2x")),
             ("g++", "c++", ("c++98", "c++11", "c++20")),
             ("clang++", "c++", ("c++98", "c++11", "c++20"))]
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]

# What -Wpedantic rightly says of these specifications: C has no structure without members.
EMPTY_IN_C = {"void_struct", "void_struct_with_code"}

# A code section of this one holds a line marker, which is copied; gcc takes it for an extension.
HAS_MARKER = "code_before_line_markers"

# Types of the corpus that a code section makes larger than their format says, which the language
# forbids, and an empty structure, which has the size 1 in C++.
LARGER = {("code_in_struct", "Gadget"), ("void_struct_with_code", "Marker"),
          ("code_same_line", "S")}
LARGER_IN_CXX = LARGER | {("void_struct", "Nothing")}

HEADERS = corpus.names()


def make_header(xdrgen, folder, case, language, *options):
    """Makes the header of a case in a folder; its name."""
    shutil.copy(corpus.path(case + ".xdr"), folder)
    done = xdrgen(f"--lang={language}", *options, case + ".xdr", "made.h")
    assert done.returncode == 0, done.stderr
    return "made.h"


def describe(xdrgen, case):
    return json.loads(xdrgen("--lang=json", case + ".xdr").stdout)


def compile_only(compiler, standard, folder, source):
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler} on this machine")
    done = subprocess.run([compiler, f"-std={standard}", *WARNINGS, "-fsyntax-only", source],
                          cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, f"{compiler} -std={standard}: {done.stderr}"


@pytest.mark.parametrize("compiler, language, standards", COMPILERS,
                         ids=[compiler[0] for compiler in COMPILERS])
@pytest.mark.parametrize("case", sorted({name for name, _ in HEADERS}))
def test_a_header_compiles_without_warnings(xdrgen, tmp_path, case, compiler, language, standards):
    if (case, language) not in HEADERS:
        pytest.skip("the corpus has no header of this language that compiles")
    if language == "c" and case in EMPTY_IN_C:
        pytest.skip("C has no structure without members")
    if case == HAS_MARKER and compiler in ("gcc", "g++"):
        pytest.skip("the specification has a line marker in a code section")
    make_header(xdrgen, tmp_path, case, language)
    source = tmp_path / ("use.c" if language == "c" else "use.cc")
    # Functions that code sections define are used nowhere here.
    source.write_text('#pragma GCC diagnostic ignored "-Wunused"\n#include "made.h"\n'
                      '#include "made.h"\nint nothing;\n')
    for standard in standards:
        compile_only(compiler, standard, tmp_path, source.name)


@pytest.mark.parametrize("before", ["", "#include <stdbool.h>\n"])
@pytest.mark.parametrize("after", ["", "#include <stdbool.h>\n"])
@pytest.mark.parametrize("compiler, standard", [("gcc", "c89"), ("gcc", "c99"), ("gcc", "c2x"),
                                                ("clang", "c99"), ("g++", "c++98"),
                                                ("g++", "c++17")])
def test_bool_has_one_byte_beside_other_headers(xdrgen, tmp_path, before, after, compiler, standard):
    for name in ("one", "two"):
        done = xdrgen("--lang=c", "in.xdr", name + ".h", text="struct S%s { bool b; };" % name)
        assert done.returncode == 0
        shutil.move(tmp_path / (name + ".h"), tmp_path / (name + ".keep"))
    for name in ("one", "two"):
        shutil.move(tmp_path / (name + ".keep"), tmp_path / (name + ".h"))
    if after and standard in ("c89", "c99"):
        pytest.skip("<stdbool.h> defines the macros anew")
    source = tmp_path / ("use.c" if compiler != "g++" else "use.cc")
    source.write_text(before + '#include "one.h"\n#include "two.h"\n' + after
                      + "typedef int one_byte[sizeof(bool) == 1 ? 1 : -1];\n"
                        "static bool both[2] = {true, false};\n"
                        "int use(void);\nint use(void) { return both[0] + both[1]; }\n")
    compile_only(compiler, standard, tmp_path, source.name)


def link(compiler, library, language, source):
    """Builds a program from a source beside which the header is; its path."""
    command = "gcc" if language == "c" else "g++"
    flags = ["-w", "-std=gnu99"] if language == "c" else ["-x", "c++", "-w", "-std=gnu++11"]
    if shutil.which(command) is None:
        pytest.skip(f"no {command} on this machine")
    target = source.with_suffix("")
    done = subprocess.run([command, *flags, "-o", target, source, f"-I{source.parent}",
                           *(f"-I{path}" for path in compiler.includes), f"-L{library.directory}",
                           f"-Wl,-rpath,{library.directory}", "-l:libipc.so.1",
                           *library.link_flags, "-lm", "-lpthread"],
                          capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return target


def run(*command, **environment):
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False,
                          stdin=subprocess.DEVNULL,
                          env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0", **environment})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def checkers(tmp_path_factory):
    """Programs that have been built, by case and language: two tests use each."""
    return {"folder": tmp_path_factory.mktemp("checkers")}


@pytest.fixture
def checker(xdrgen, tmp_path, compiler, library, checkers, case, language):
    """The program that measures the types of a header and lets values of them travel."""
    if (case, language) not in checkers:
        header = make_header(xdrgen, tmp_path, case, language)
        source = tmp_path / "check.c"
        source.write_text(values.program(header, describe(xdrgen, case)))
        target = checkers["folder"] / f"{case}-{language}"
        shutil.move(link(compiler, library, language, source), target)
        checkers[case, language] = target
    return checkers[case, language]


@pytest.mark.parametrize("case, language", HEADERS)
def test_every_type_has_the_size_that_ipc_computes(checker, case, language):
    different = {(case, name) for name, own, computed
                 in re.findall(r"^(\w+) (-?\d+) (-?\d+)$", run(checker), re.MULTILINE)
                 if own != computed}
    assert different <= (LARGER if language == "c" else LARGER_IN_CXX)


@pytest.mark.parametrize("case, language", HEADERS)
def test_a_value_of_every_type_arrives_as_it_was(checker, central):
    output = run(checker, "travel", CENTRALHOST=central.address)
    assert re.search(r"^\d+ types$", output, re.MULTILINE)
    assert not re.search(r"is not the same|has not arrived", output), output


@pytest.mark.parametrize("language", ["c", "c++"])
def test_a_header_with_registration_defines_all_formats_at_central(xdrgen, tmp_path, compiler,
                                                                   library, central, language):
    header = make_header(xdrgen, tmp_path, "realistic", language, "--register")
    source = tmp_path / "register.c"
    source.write_text(f"""#include "{header}"
#include <stdio.h>
int main(void)
{{
  if (IPC_connect("registrar") != IPC_OK || xdr_register_realistic() != IPC_OK)
    return 1;
  if (IPC_defineMsg("beat", IPC_VARIABLE_LENGTH, "Heartbeat") != IPC_OK)
    return 2;
  if (IPC_checkMsgFormats("beat", Heartbeat_IPC_FORMAT) != IPC_OK)
    return 3;
  IPC_disconnect();
  return 0;
}}
""")
    run(link(compiler, library, language, source), CENTRALHOST=central.address)
