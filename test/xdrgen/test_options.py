"""The command line, files, and what is written where."""
import os
import subprocess

import pytest

TEXT = "struct Pair { int left; int right; };\n"


@pytest.mark.parametrize("option", ["-h", "--help"])
def test_help_is_printed_on_standard_output(xdrgen, option):
    done = xdrgen(option)
    assert done.returncode == 0
    assert done.stdout.startswith("usage: xdrgen OPTIONS <xdrFile> [outputHeaderFile]\n")
    assert done.stderr == ""
    for name in ("--lang", "--directives", "--register", "--spec", "--formats", "-D", "-I", "-n"):
        assert name in done.stdout


def test_the_version_is_printed(xdrgen):
    done = xdrgen("--version")
    assert done.returncode == 0
    assert done.stdout.startswith("xdrgen ")


@pytest.mark.parametrize("arguments, message", [
    ([], "xdrgen: not enough arguments"),
    (["a", "b", "c"], "xdrgen: too many arguments"),
    (["-x", "in.xdr"], "xdrgen: unknown option -x"),
    (["-hn", "in.xdr"], "xdrgen: unknown option -hn"),
    (["--lang=java", "in.xdr"], "xdrgen: unknown language java specified"),
    (["--lang=C", "in.xdr"], "xdrgen: unknown language C specified"),
    (["--directives=x", "in.xdr"], "xdrgen: unknown --directives syntax x"),
])
def test_a_wrong_command_line_is_answered_with_the_usage(xdrgen, arguments, message):
    done = xdrgen(*arguments, text=TEXT)
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.startswith(message + "\nusage: xdrgen")


@pytest.mark.parametrize("arguments, message", [
    (["none.xdr"], "xdrgen: couldn't open `none.xdr' for reading: "),
    (["."], "xdrgen: couldn't read `.': "),
    (["in.xdr", "none/out.h"], "xdrgen: couldn't open `none/out.h' for writing: "),
])
def test_a_file_that_cannot_be_used_is_named_with_the_reason(xdrgen, arguments, message):
    done = xdrgen(*arguments, text=TEXT)
    assert done.returncode == 1
    assert done.stderr.startswith(message)


def test_without_output_file_the_header_goes_to_standard_output(xdrgen):
    done = xdrgen("in.xdr", text=TEXT)
    assert "#ifndef INCstdout\n" in done.stdout
    assert "struct Pair {" in done.stdout


def test_a_single_hyphen_is_standard_input_and_output(xdrgen, tmp_path):
    done = xdrgen("-", "-", stdin=None, input=TEXT)
    assert "struct Pair {" in done.stdout
    assert os.listdir(tmp_path) == []
    wrong = xdrgen("-", stdin=None, input="typedef;")
    assert wrong.stderr.startswith("<stdin>:1: before `;': syntax error")


def test_cplusplus_is_the_default_and_the_last_language_counts(xdrgen):
    assert "typedef struct _Pair" not in xdrgen("in.xdr", text=TEXT).stdout
    assert "typedef struct _Pair" in xdrgen("--lang=c++", "in.xdr", "--lang=c").stdout


def test_no_header_only_checks(xdrgen, tmp_path):
    assert xdrgen("-n", "in.xdr", "out.h", text=TEXT).returncode == 0
    assert not (tmp_path / "out.h").exists()
    assert xdrgen("-n", "in.xdr", text="typedef;").returncode == 1


def test_a_full_disk_is_an_error(program, tmp_path):
    if not os.path.exists("/dev/full"):
        pytest.skip("no /dev/full on this system")
    (tmp_path / "in.xdr").write_text(TEXT)
    for command in ([program, "in.xdr", "/dev/full"], [program, "in.xdr"]):
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run(command, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE,
                                  timeout=60, check=False)
        assert done.returncode == 1
        assert b"couldn't write" in done.stderr


def test_a_device_is_written_to_and_stays_one(xdrgen):
    assert xdrgen("in.xdr", "/dev/null", text=TEXT).returncode == 0
    assert not os.path.isfile("/dev/null")


def test_the_mode_of_an_old_header_and_a_link_to_it_stay(xdrgen, tmp_path):
    real = tmp_path / "real.h"
    real.write_text("old")
    real.chmod(0o640)
    (tmp_path / "out.h").symlink_to("real.h")
    assert xdrgen("in.xdr", "out.h", text=TEXT).returncode == 0
    assert (tmp_path / "out.h").is_symlink()
    assert "Pair" in real.read_text()
    assert real.stat().st_mode & 0o777 == 0o640


def test_the_header_has_neither_date_nor_directory(xdrgen, tmp_path):
    xdrgen(tmp_path / "in.xdr", tmp_path / "one.h", text=TEXT)
    os.utime(tmp_path / "in.xdr", (1, 1))
    first = (tmp_path / "one.h").read_bytes()
    xdrgen(tmp_path / "in.xdr", tmp_path / "one.h")
    assert (tmp_path / "one.h").read_bytes() == first
    assert str(tmp_path).encode() not in first


def test_line_directives_back_into_the_header_are_right(xdrgen, tmp_path):
    xdrgen("in.xdr", "out.h", text="%{\nint a;\n%}\n" + TEXT + "%{ int b; %}\n")
    lines = (tmp_path / "out.h").read_text().split("\n")
    back = [(number, line) for number, line in enumerate(lines, 1) if '"out.h"' in line]
    assert len(back) == 2
    for number, line in back:
        assert line == f'#line {number + 1} "out.h"'


def test_names_of_files_are_escaped_in_directives(xdrgen, tmp_path):
    (tmp_path / 'a"b\\.xdr').write_text("%{\n%}\n")
    done = xdrgen('a"b\\.xdr')
    assert '#line 1 "a\\"b\\\\.xdr"\n' in done.stdout


def test_formats_are_printed_with_the_formats_of_other_types_in_place(xdrgen):
    done = xdrgen("-n", "--formats", "in.xdr", text="""
typedef double Length; ipc_type Ext; ipc_type Inline = "{int,int}"; enum E { A, B };
struct S { Length l[2]; Ext e; Inline i; int n; E v<>; opaque o; };""")
    assert done.stdout == ('Length: "double"\nE: "{enum A,B}"\n'
                           'S: "{[double:2],Ext,{int,int},int,<{enum A,B}:4>,ubyte}"\n')


def test_verbose_names_the_steps(xdrgen):
    done = xdrgen("-v", "-n", "--spec", "--formats", "in.xdr", text=TEXT)
    steps = [line for line in done.stdout.split("\n") if line.startswith("---")]
    assert steps == ["--- parsing", "--- printing parse tree as XDR spec",
                     "--- mapping identifier names", "--- outputting IPC formats"]
