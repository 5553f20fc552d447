"""The outputs beside headers: Python, JSON, and specifications again."""
import dataclasses
import enum
import importlib.util
import json
import shutil
import sys

import pytest

from xdrgen import corpus, tokens

# Cases whose types can be used: everything that is not there just to be refused.
CASES = sorted({name for name, _ in corpus.names()})

TEXT = """
typedef double Row[2];
typedef string Name<>;
ipc_type Ext;
enum Mode { IDLE, RUN = 5, value };
struct Point { double x; double y; };
struct All {
  char c; unsigned char u; int i; bool b; float f; string s<>; Name name; Row rows[3]; Mode mode;
  Point p; Point many[2]; int n; int m; Point grid<><4>; Ext e; enum { A, B } inner;
  struct { int None; Row r; } nested;
};
"""


@pytest.fixture
def load(xdrgen, tmp_path):
    """The module that is made of in.xdr, or of a case."""
    def load_module(name="in.xdr", **options):
        done = xdrgen("--lang=python", name, "made.py", **options)
        assert done.returncode == 0, done.stderr
        spec = importlib.util.spec_from_file_location("made_by_xdrgen", tmp_path / "made.py")
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
        return module
    yield load_module
    sys.modules.pop("made_by_xdrgen", None)


def description(xdrgen, name="in.xdr", **options):
    done = xdrgen("--lang=json", name, **options)
    assert done.returncode == 0, done.stderr
    return {each["name"]: each for each in json.loads(done.stdout)["types"]}


def test_a_structure_becomes_a_dataclass_with_names_and_format(load):
    made = load(text=TEXT)
    assert made.Point.IPC_FORMAT == made.Point_IPC_FORMAT == "{double,double}"
    assert made.Point._fields == ("x", "y")
    assert made.Point(1.0, 2.0) == made.Point(x=1.0, y=2.0)
    assert [field.name for field in dataclasses.fields(made.Point)] == ["x", "y"]


def test_all_kinds_of_fields_have_a_first_value(load):
    made = load(text=TEXT)
    value = made.All()
    assert (value.c, value.u, value.i, value.b, value.f, value.s, value.name) == (
        "\0", 0, 0, "\0", 0.0, "", "")
    assert value.rows == [[0.0, 0.0]] * 3
    assert value.mode is made.Mode.IDLE
    assert value.many == [made.Point(), made.Point()]
    assert (value.grid, value.e) == ([], None)
    assert value.nested == made.All_nested(0, [0.0, 0.0])
    assert made.All().rows is not value.rows


def test_fields_with_structures_name_their_classes(load):
    made = load(text=TEXT)
    classes = {entry[0]: entry[1] for entry in made.All._fields if isinstance(entry, tuple)}
    assert classes == {"p": made.Point, "many": made.Point, "grid": made.Point,
                       "nested": made.All_nested}
    assert [entry if isinstance(entry, str) else entry[0] for entry in made.All._fields] == [
        field.name for field in dataclasses.fields(made.All)]


def test_words_that_python_reserves_get_an_underscore(load):
    made = load(text=TEXT)
    assert made.All_nested._fields == ("None_", "r")
    assert issubclass(made.Mode, enum.IntEnum)
    assert [(each.name, int(each)) for each in made.Mode] == [("IDLE", 0), ("RUN", 5), ("value_", 6)]


@pytest.mark.parametrize("case", CASES)
def test_python_and_json_agree_on_all_formats(xdrgen, load, tmp_path, case):
    shutil.copy(corpus.path(case + ".xdr"), tmp_path)
    made = load(case + ".xdr")
    for name, each in description(xdrgen, case + ".xdr").items():
        if each["type"] != "external" and hasattr(made, name + "_IPC_FORMAT"):
            assert getattr(made, name + "_IPC_FORMAT") == each["format"]


def test_json_describes_every_part(xdrgen):
    types = description(xdrgen, text=TEXT)
    assert types["Row"] == {"name": "Row", "file": "in.xdr", "line": 2, "format": "[double:2]",
                            "type": "double", "dimensions": [2]}
    assert types["Ext"]["type"] == "external"
    assert types["Mode"]["values"] == [{"name": "IDLE", "value": 0}, {"name": "RUN", "value": 5},
                                       {"name": "value", "value": 6}]
    fields = {field["name"]: field for field in types["All"]["fields"]}
    assert fields["grid"] == {"name": "grid", "type": "Point", "limits": [None, 4],
                              "sizes": ["n", "m"]}
    assert fields["nested"]["fields"][1] == {"name": "r", "type": "Row"}
    assert types["All"]["format"] == (
        "{char,ubyte,int,char,float,string,string,[[double:2]:3],int,{double,double},"
        "[{double,double}:2],int,int,<{double,double}:12,13>,Ext,{enum A,B},{int,[double:2]}}")


def test_a_format_that_ipc_would_refuse_for_its_length_is_null(xdrgen):
    text = "struct T0 { int a; int b; };\n" + "".join(
        f"struct T{i} {{ T{i - 1} a; T{i - 1} b; }};\n" for i in range(1, 60))
    types = description(xdrgen, text=text)
    assert types["T3"]["format"].count("int") == 16
    assert types["T59"]["format"] is None


@pytest.mark.parametrize("case", CASES)
def test_a_printed_specification_gives_the_same_header(xdrgen, tmp_path, case):
    shutil.copy(corpus.path(case + ".xdr"), tmp_path)
    options = ("--lang=c", "--directives=none")
    printed = xdrgen("-n", "--spec", "--lang=c", case + ".xdr")
    (tmp_path / "again.xdr").write_bytes(printed.stdout.encode("latin-1"))
    assert xdrgen(*options, case + ".xdr", "made.h").returncode == 0
    first = tokens.of(tmp_path / "made.h")
    assert xdrgen(*options, "again.xdr", "made.h").returncode == 0
    assert tokens.of(tmp_path / "made.h") == first
