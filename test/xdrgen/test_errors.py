"""What is said about wrong specifications, and that nothing is written then."""
import os
import re

import pytest


def errors(done):
    """The (line, column, text) of all errors, in the order in which they were printed."""
    return [(int(line), int(column), text) for line, column, text
            in re.findall(r"^in\.xdr:(\d+):(\d+): error: (.*)$", done.stderr, re.MULTILINE)]


def test_an_error_shows_line_column_and_the_text_with_a_mark(xdrgen):
    done = xdrgen("in.xdr", text="struct A {\n\tint x[0];\n};\n")
    assert done.returncode == 1
    assert done.stderr == ("in.xdr:2:8: error: array dimension must be between 1 and 2147483647\n"
                           "    " + " int x[0];\n" + "    " + "       ^\n")


def test_a_syntax_error_is_told_in_the_old_words_and_in_new_ones(xdrgen):
    done = xdrgen("in.xdr", text="struct A { struct B { int x; } b; };\n")
    assert done.stderr.split("\n")[:2] == [
        "in.xdr:1: before `B': syntax error, unexpected IDENTIFIER, expecting '{'",
        "in.xdr:1:19: error: unexpected `B', expected `{'"]


def test_a_long_line_is_shown_around_the_mark(xdrgen):
    done = xdrgen("in.xdr", text="typedef int " + "x" * 5000 + "; @ " + "y" * 5000)
    excerpt, mark = done.stderr.split("\n")[1:3]
    assert len(excerpt) <= 130
    assert excerpt[mark.index("^")] == "@"


def test_all_errors_of_a_file_are_reported_in_the_order_of_their_places(xdrgen):
    done = xdrgen("in.xdr", text="""struct A {
  int int;
  short s;
  union U switch (int d) { case 1: int x; };
  int c[0];
  struct { int q; float q } z;
};
enum E { X, Y, };
const N = 3;
program P { version V { void F(void) = 1; } = 1; } = 99;
struct B { float d<>; B again; };
typedef int A;
ipc_type Z = "\\q";
#include "x.h"
typedef string s;
""")
    found = [(line, column) for line, column, _ in errors(done)]
    assert found == [(2, 7), (3, 3), (4, 3), (5, 9), (6, 27), (8, 16), (9, 1), (10, 1), (11, 8),
                     (11, 18), (12, 13), (13, 15), (14, 1), (15, 17)]
    assert found == sorted(found)


def test_a_forgotten_semicolon_gives_one_error(xdrgen):
    done = xdrgen("in.xdr", text="struct A { int a; }\nstruct B { int b; };\nstruct C { A a; B b; };\n")
    assert len(errors(done)) == 1
    assert "warning" not in done.stderr


def test_a_duplicate_says_where_the_first_one_is(xdrgen):
    done = xdrgen("in.xdr", text="typedef int A;\nenum A { B };\n")
    assert errors(done) == [(2, 6, "duplicate type `A'")]
    assert "in.xdr:1:13: note: the first `A' is here" in done.stderr


@pytest.mark.parametrize("text, line, message", [
    ("typedef int A;\n/* x", 2, "unterminated comment"),
    ("typedef int A;\n\n%{ x\n\n", 3, "unterminated code section"),
    ("ipc_type A = \"x\n;", 1, "unterminated string"),
    ("ipc_type A = \"\\012\";", 1, "line break in a format"),
    ("ipc_type A = \"\\000\";", 1, "NUL character in input"),
    ("\0", 1, "NUL character in input"),
    ("typedef int caf\u00e9;", 1, "unexpected character \\xc3"),
    ("struct S { S *x; };", 1, "`*' is not supported"),
    ("struct S { int n; S x<>; };", 1, "struct `S' contains itself"),
    ("typedef S S;", 1, "type `S' contains itself"),
    ("struct S { int getIPCFormat; };", 1, "`getIPCFormat' is a member that the header adds"),
    ("struct S { enum { A } x; int A; };", 1, "duplicate field `A'"),
    ("struct S { int a[3][2147483648]; };", 1,
     "array dimension must be between 1 and 2147483647"),
    ("struct S { int a[99999999999999999999999]; };", 1,
     "array dimension must be between 1 and 2147483647"),
])
def test_an_error_has_its_line_and_its_text(xdrgen, text, line, message):
    done = xdrgen("in.xdr", "out.h", text=text)
    assert done.returncode == 1
    assert [(error[0], error[2]) for error in errors(done)][:1] == [(line, message)]


@pytest.mark.parametrize("text, message", [
    ("enum E { A }; struct S { E n; int d<>; };", "dimension field `n' of variable-length array "
     "`d' is an enum"),
    ("struct E { void; }; struct S { E e; };", "empty structure cannot be part of a message"),
    ("struct S { int nullptr; };", "`nullptr' is a keyword in later versions of the output language"),
    ("enum E { A = 2147483648 };", "the value of `A' does not fit into an int"),
])
def test_a_warning_leaves_the_header(xdrgen, tmp_path, text, message):
    done = xdrgen("in.xdr", "out.h", text=text)
    assert done.returncode == 0, done.stderr
    assert f"warning: {message}" in done.stderr
    assert (tmp_path / "out.h").exists()


@pytest.mark.parametrize("text", ["typedef int A; struct B { A a; } ; x", "struct S { float d<>; };",
                                  "typedef int A; @", "union"])
def test_an_error_leaves_an_old_header_as_it_is(xdrgen, tmp_path, text):
    (tmp_path / "out.h").write_text("old")
    assert xdrgen("in.xdr", "out.h", text=text).returncode == 1
    assert (tmp_path / "out.h").read_text() == "old"
    assert sorted(os.listdir(tmp_path)) == ["in.xdr", "out.h"]


def test_lines_are_those_of_the_files_that_markers_name(xdrgen):
    done = xdrgen("in.xdr", text='# 1 "./a b.xdr"\n# 7 "/x/c.xdr" 1 3\ntypedef C;\n'
                                 '# 2 "a b.xdr" 2\ntypedef D;\n#line 50\ntypedef E;\n')
    lines = [line for line in done.stderr.split("\n") if "syntax error" in line or "included" in line]
    assert [line.split(": ")[0] for line in lines] == [
        "In file included from a b.xdr:1:", "/x/c.xdr:7", "a b.xdr:2", "a b.xdr:50"]


def test_three_thousand_nested_structures_are_read_and_more_than_the_limit_refused(xdrgen):
    def nested(depth):
        return "struct A {" + "struct {" * depth + "int a;" + "} x;" * depth + "};"
    assert xdrgen("in.xdr", "out.h", text=nested(3000)).returncode == 0
    for depth in (4500, 9000, 50000):
        done = xdrgen("in.xdr", text=nested(depth))
        assert done.returncode == 1
        assert [text for _, _, text in errors(done)] == ["structures are nested too deeply"]
