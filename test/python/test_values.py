"""Values of Python and their bytes (checks 6 to 23, 28, 29)."""
import decimal
import enum
import io
import math
import struct
import sys

import pytest

from python.tools import decoded, encoded, ipc as IPC, plain

pytestmark = pytest.mark.usefixtures("ipc")

MISFITS = (TypeError, ValueError, OverflowError, AttributeError)


# ---------------------------------------------------------------------- scalars


@pytest.mark.parametrize("text, value, content", [
    ("int", 1, "01 00 00 00"),
    ("double", 1.0, "00 00 00 00 00 00 F0 3F"),
    ("short", 666, "9A 02"),
    ("string", "hello", "05 00 00 00 68 65 6C 6C 6F"),
    ("{int, {string, double}}", (666, ("hello", 3.14159)),
     "9A 02 00 00 05 00 00 00 68 65 6C 6C 6F 6E 86 1B F0 F9 21 09 40"),
    ("{*int, *{string, double}}", (666, None), "5A 9A 02 00 00 00"),
    ("{int, <int:1>}", (3, [1, 2, 3]),
     "03 00 00 00 03 00 00 00 01 00 00 00 02 00 00 00 03 00 00 00"),
    ("{int, int, <int:1,2>}", (2, 2, [[1, 2], [3, 4]]),
     "02 00 00 00 02 00 00 00 04 00 00 00 01 00 00 00 02 00 00 00 03 00 00 00 04 00 00 00"),
    ("{int, *!}", (1, (2, None)), "01 00 00 00 5A 02 00 00 00 00"),
    ("boolean", True, "01 00 00 00"),
    ("long", -5, "FB FF FF FF FF FF FF FF"),
])
@pytest.mark.skipif(sys.byteorder == "big" or struct.calcsize("l") != 8, reason="other host")
def test_bytes_are_those_of_the_specification(text, value, content):
    assert encoded(text, value) == bytes.fromhex(content)
    assert plain(decoded(text, bytes.fromhex(content))) == plain(value)


LONG = 8 * struct.calcsize("l")


@pytest.mark.parametrize("text, bits, signed", [
    ("int", 32, True), ("uint", 32, False), ("short", 16, True), ("ushort", 16, False),
    ("byte", 8, True), ("ubyte", 8, False), ("long", LONG, True), ("ulong", LONG, False)])
def test_integers_up_to_their_limits(text, bits, signed):
    for value in (-(1 << bits - 1), -1, 0, 1, (1 << bits - 1) - 1, 1 << bits - 1, (1 << bits) - 1):
        expected = value % (1 << bits)
        if signed and expected >= 1 << bits - 1:
            expected -= 1 << bits
        assert decoded(text, encoded(text, value)) == expected
        assert decoded(f"[{text}:2]", encoded(f"[{text}:2]", [value, 0])) == [expected, 0]
        assert plain(decoded(f"{{{text}, char}}", encoded(f"{{{text}, char}}", (value, "x")))) == [
            expected, "x"]
    for value in (-(1 << bits - 1) - 1, 1 << bits):
        for shape, data in ((text, value), (f"[{text}:1]", [value]), (f"{{{text}}}", (value,))):
            with pytest.raises(OverflowError, match=f"expected {text}"):
                encoded(shape, data)
    for value in ("1", 1.0, None, b"1", [1], object()):
        with pytest.raises(TypeError):
            encoded(f"{{{text}}}", (value,))


class Indexed:
    """Something that is used like an integer."""

    def __index__(self):
        return 7


def test_what_counts_as_a_number():
    class Number(enum.IntEnum):
        """Numbers by name."""
        SEVEN = 7
    for value in (7, Number.SEVEN, Indexed()):
        assert decoded("int", encoded("int", value)) == 7
        assert decoded("[int:1]", encoded("[int:1]", (value,))) == [7]
    assert decoded("int", encoded("int", True)) == 1
    for value in (7, 7.0, decimal.Decimal(7), Number.SEVEN):
        assert decoded("double", encoded("double", value)) == 7.0
        assert decoded("[float:1]", encoded("[float:1]", [value])) == [7.0]
    for value in ("7", b"7", None, 7j):
        with pytest.raises(TypeError, match="expected double"):
            encoded("double", value) if value is not None else encoded("{double}", (value,))
    with pytest.raises(OverflowError):
        encoded("double", 10 ** 400)


def test_odd_real_numbers():
    assert decoded("float", encoded("float", 1e300)) == math.inf
    assert decoded("float", encoded("float", -1e300)) == -math.inf
    assert decoded("[float:2]", encoded("[float:2]", [1e300, 3.4028234e38]))[0] == math.inf
    assert plain(decoded("{float}", encoded("{float}", (1e39,)))) == [math.inf]
    for text in ("float", "double"):
        assert math.isnan(decoded(text, encoded(text, math.nan)))
        assert decoded(text, encoded(text, -math.inf)) == -math.inf
        assert math.copysign(1, decoded(text, encoded(text, -0.0))) == -1


def test_booleans():
    assert decoded("[boolean:4]", encoded("[boolean:4]", [True, False, 1, 0])) == [
        True, False, True, False]
    assert decoded("boolean", struct.pack("=i", 5)) is True
    for value, error in ((2, OverflowError), (-1, OverflowError), ("x", TypeError),
                         (1.0, TypeError)):
        with pytest.raises(error):
            encoded("boolean", value)


def test_characters():
    for value in ("a", b"a", 97, bytearray(b"a")):
        assert decoded("char", encoded("char", value)) == "a"
    assert encoded("{char, char}", ("\xff", b"\0")) == b"\xff\0"
    for value in ("€", "", "ab", b"", b"ab", 256, -1, None, 1.0):
        with pytest.raises(MISFITS):
            encoded("{char}", (value,))
    every = "".join(map(chr, range(256)))
    assert decoded("[char:256]", encoded("[char:256]", every)) == list(every)
    with pytest.raises(TypeError):
        encoded("[char:1]", "€")


def test_strings():
    for value in ("", "plain", "straße €", "\udcff\udc80", "a" * (10 << 20)):
        assert decoded("string", encoded("string", value)) == value
    for value in (b"bytes", bytearray(b"bytes"), memoryview(b"bytes")):
        assert decoded("string", encoded("string", value)) == "bytes"
    assert encoded("{string}", (None,)) == encoded("string", "") == b"\0\0\0\0Z"
    assert decoded("string", b"\2\0\0\0\xc3\x28" if sys.byteorder == "little"
                   else b"\0\0\0\2\xc3\x28") == "\udcc3("
    for value, error in (("a\0b", ValueError), (3, TypeError), (["a"], TypeError)):
        with pytest.raises(error):
            encoded("string", value)


class Colour(enum.IntEnum):
    """Members of an enumeration."""
    RED = 0
    GREEN = 1


class Plain(enum.Enum):
    """The same, and no integers."""
    GREEN = 1


def test_enumerations():
    named = "{enum RED, GREEN, BLUE}"
    for value in (1, "GREEN", Colour.GREEN, Plain.GREEN, True):
        assert decoded(named, encoded(named, value)) == 1
        assert decoded(f"[{named}:2]", encoded(f"[{named}:2]", [value, 2])) == [1, 2]
        assert plain(decoded(f"{{int, {named}}}", encoded(f"{{int, {named}}}", (0, value)))) == [
            0, 1]
    assert decoded(named, encoded(named, 77)) == 77
    assert decoded("{enum : 3}", encoded("{enum : 3}", -1)) == -1
    for value, error in (("PINK", ValueError), (1.5, TypeError), (1 << 32, OverflowError)):
        with pytest.raises(error):
            encoded(named, value)


# ------------------------------------------------------------------- structures


class Named(IPC.IPCdata):
    """All members named."""
    _fields = ("i", "s", "d")


class Part(IPC.IPCdata):
    """The first member named."""
    _fields = ["i"]


class Slotted:
    """Attributes in slots, and one that is computed."""
    __slots__ = ("i", "_d")
    _fields = ("i", "s", "d")

    @property
    def s(self):
        """Always the same."""
        return "x"

    @s.setter
    def s(self, value):
        assert value == "x"

    @property
    def d(self):
        """Kept elsewhere."""
        return self._d

    @d.setter
    def d(self, value):
        self._d = value


def with_members(value, **members):
    for name, member in members.items():
        setattr(value, name, member)
    return value


@pytest.mark.parametrize("value", [
    Named(i=1, s="x", d=2.5), with_members(IPC.IPCdata(), f0=1, f1="x", f2=2.5),
    with_members(IPC.IPCdata(), _f0=1, _f1="x", _f2=2.5), Part(i=1, _f1="x", _f2=2.5),
    with_members(Part(i=1), _f1="x", f2=2.5), with_members(Slotted(), i=1, _d=2.5),
    {"f0": 1, "f1": "x", "f2": 2.5}, {"i": 1, "s": "x", "d": 2.5}, (1, "x", 2.5), [1, "x", 2.5],
    Named(i=1, s="x", d=2.5, extra="ignored")])
def test_structures_of_every_kind(value):
    assert encoded("{int, string, double}", value) == encoded("{int, string, double}",
                                                              (1, "x", 2.5))


def test_classes_get_their_attributes():
    content = encoded("{int, string, double}", (1, "x", 2.5))
    record = decoded("{int, string, double}", content, Named)
    assert (type(record), record.i, record.s, record.d) == (Named, 1, "x", 2.5)
    record = decoded("{int, string, double}", content, Part)
    assert (record.i, record._f1, record._f2) == (1, "x", 2.5)
    record = decoded("{int, string, double}", content, Slotted)
    assert (record.i, record.d) == (1, 2.5)
    record = decoded("{int, string, double}", content)
    assert (record.f0, record._f0, record.f1, record._f2) == (1, 1, "x", 2.5)
    record.f0 = 9
    assert record._f0 == 9
    del record.f0
    assert not hasattr(record, "_f0") and not hasattr(record, "f0")


class Inner(IPC.IPCdata):
    """Nested in others."""
    _fields = ("x",)


class Node(IPC.IPCdata):
    """Of a list."""
    _fields = ("value", ("next", "Node"))


@pytest.mark.parametrize("entry", [
    ("inner", Inner), ["inner", Inner], ("inner", "Inner"), ("inner", f"{__name__}.Inner"),
    ("inner", (Inner,)), ("inner", [Inner])])
def test_all_ways_to_name_a_class(entry):
    class Outer(IPC.IPCdata):
        """With a structure inside."""
        _fields = ("i", entry)
    Outer.__module__ = __name__
    for text, data in (("{int, {double}}", (1, (2.0,))), ("{int, *{double}}", (1, (2.0,))),
                       ("{int, [{double}:1]}", (1, [(2.0,)])),
                       ("{int, <{double}:1>}", (1, [(2.0,)])),
                       ("{int, [*{double}:1]}", (1, [(2.0,)]))):
        inner = decoded(text, encoded(text, data), Outer).inner
        inner = inner[0] if isinstance(inner, list) else inner
        assert (type(inner), inner.x) == (Inner, 2.0)


@pytest.fixture(autouse=True)
def _module_by_name(monkeypatch):
    """Classes are looked up in modules, which pytest does not list by their names."""
    import types  # pylint: disable=import-outside-toplevel
    module = types.ModuleType(__name__)
    vars(module).update(globals())
    monkeypatch.setitem(sys.modules, __name__, module)


def test_fields_that_say_less_or_more():
    class One(IPC.IPCdata):
        """A single name without a tuple."""
        _fields = ("i")

    class Builtin(IPC.IPCdata):
        """Built-in types say nothing."""
        _fields = (("i", int), ("a", list))
    assert decoded("{int}", encoded("{int}", One(i=4)), One).i == 4
    record = decoded("{int, [int:2]}", encoded("{int, [int:2]}", Builtin(i=1, a=[2, 3])), Builtin)
    assert (record.i, record.a) == (1, [2, 3])
    One._fields = ("j",)
    assert decoded("{int}", encoded("{int}", One(j=5)), One).j == 5


def test_missing_attributes_are_named():
    with pytest.raises(AttributeError, match=r"Named\.s: Named has no attribute for member 2"):
        encoded("{int, string, double}", Named(i=1, d=2.0))
    with pytest.raises(AttributeError, match=r"f2: .* member 3"):
        encoded("{int, string, double}", with_members(IPC.IPCdata(), f0=1, f1="x"))
    with pytest.raises(AttributeError, match=r"Named\.s"):
        encoded("{int, int, int}", Named(i=1))


def test_errors_of_properties_are_the_programs_own():
    class Broken:
        """Its attribute cannot be read."""
        _fields = ("a", "b")
        b = 1

        @property
        def a(self):
            """Fails."""
            raise AttributeError("own")
    with pytest.raises(AttributeError, match="^own$"):
        encoded("{int, int}", Broken())


class T1(IPC.IPCdata):
    """A structure of the manual."""
    _fields = ("i1", "status", "matrix", "d1")


class T2(IPC.IPCdata):
    """Another one."""
    _fields = ("str1", "count", ("t1", T1), "status")


T2_FORMAT = "{string, int, <{int, {enum : 3}, [double:2,3], double}:2>, {enum A, B}}"


def t2(matrix, **others):
    t1 = [T1(i1=0, status=0, matrix=[[0, 0, 0], [0, 0, 0]], d1=0) for _ in range(5)]
    t1[3].matrix = matrix
    return T2(**{"str1": "", "count": 5, "t1": t1, "status": 1, **others})


@pytest.mark.parametrize("value, kind, text", [
    (t2([["x", 0, 0], [0, 0, 0]]), TypeError,
     r"T2\.t1\[3\]\.matrix\[0\]\[0\]: expected double, got 'x' \(format \{string, int, <\{int, "),
    (t2([[0, 0, 0], [0, 0]]), ValueError,
     r"T2\.t1\[3\]\.matrix\[1\]: expected 3 elements, got 2"),
    (t2([[0, 0, 0]]), ValueError, r"T2\.t1\[3\]\.matrix: expected 2 elements, got 1"),
    (t2(None), TypeError, r"T2\.t1\[3\]\.matrix: expected a sequence of 2, got None"),
    (t2("ab"), TypeError, r"T2\.t1\[3\]\.matrix: expected a sequence of 2, got 'ab'"),
    (t2([[0, 0, 0], [0, 0, 0]], str1=3), TypeError, r"T2\.str1: expected string, got 3"),
    (t2([[0, 0, 0], [0, 0, 0]], count=6), ValueError, r"T2\.t1: expected 6 elements, got 5"),
    (t2([[0, 0, 0], [0, 0, 0]], count=-1), ValueError, r"T2\.count: .*got -1"),
    (t2([[0, 0, 0], [0, 0, 0]], count="x2"), TypeError, r"T2\.count"),
    (t2([[0, 0, 0], [0, 0, 0]], status="C"), ValueError, r"T2\.status: expected one of A, B"),
    (3, TypeError, r"data: expected a structure, got 3"),
    ("text", TypeError, r"data: expected a structure, got 'text'"),
    ((1, 2), ValueError, r"data: expected 4 members, got 2"),
    (object(), AttributeError, r"str"),
])
def test_a_value_that_does_not_fit_is_told_with_path_and_format(value, kind, text):
    with pytest.raises(kind, match=text if kind is not AttributeError else "no attribute"):
        encoded(T2_FORMAT, value)


# ----------------------------------------------------------------------- arrays


def test_fixed_arrays_of_every_kind_of_sequence():
    import array  # pylint: disable=import-outside-toplevel
    for value in ([1, 2, 3], (1, 2, 3), range(1, 4), array.array("i", [1, 2, 3]),
                  array.array("h", [1, 2, 3]), memoryview(array.array("i", [1, 2, 3, 4])),
                  [1, 2, 3, 4]):
        assert decoded("[int:3]", encoded("[int:3]", value)) == [1, 2, 3]
    matrix = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
    assert decoded("[double:3,2]", encoded("[double:3,2]", matrix)) == matrix
    cube = [[[1, 2], [3, 4]], [[5, 6], [7, 8]]]
    assert decoded("[short:2,2,2]", encoded("[short:2,2,2]", tuple(map(tuple, cube)))) == cube
    for value in (b"abc", bytearray(b"abc"), memoryview(b"abc"), [97, 98, 99]):
        assert decoded("[ubyte:3]", encoded("[ubyte:3]", value)) == [97, 98, 99]
        assert decoded("[byte:3]", encoded("[byte:3]", value)) == [97, 98, 99]
    for value in ("abc", b"abc", ["a", "b", "c"], [97, b"b", "c"], "abcd"):
        assert decoded("[char:3]", encoded("[char:3]", value)) == ["a", "b", "c"]
    for value in ([1, 2], 3, None, "abc", {1: 1, 2: 2, 3: 3}, {1, 2, 3}, b"abc"):
        with pytest.raises(MISFITS):
            encoded("{[int:3]}", (value,))
    assert decoded("[int:0]", b"") == [] and encoded("[int:0]", []) == b""


@pytest.mark.parametrize("element, values", [
    ("string", ["a", "", "ä"]), ("boolean", [True, False, True]), ("{enum A, B}", [0, 1, 0]),
    ("*int", [1, None, 3]), ("[int:2]", [[1, 2], [3, 4], [5, 6]]), ("{int, string}",
                                                                   [[1, "a"], [2, "b"], [3, ""]]),
    ("char", ["a", "b", "c"]), ("float", [0.5, 1.5, 2.5]), ("3", [b"abc", b"def", b"ghi"])])
def test_arrays_of_all_elements_hold_plain_values(element, values):
    assert plain(decoded(f"[{element}:3]", encoded(f"[{element}:3]", values))) == values
    text = f"{{int, <{element}:1>}}"
    assert plain(decoded(text, encoded(text, (3, values)))) == [3, values]
    assert plain(decoded(text, encoded(text, (None, values)))) == [3, values]
    assert plain(decoded(text, encoded(text, (2, values)))) == [2, values[:2]]


def test_variable_arrays_and_their_sizes():
    text = "{int, <int:1>}"
    for size, values, result in ((3, [1, 2, 3], [3, [1, 2, 3]]), (2, [1, 2, 3], [2, [1, 2]]),
                                 (0, [], [0, []]), (0, None, [0, []]), (0, [1], [0, []]),
                                 (None, (1, 2), [2, [1, 2]]), (None, None, [0, []])):
        assert plain(decoded(text, encoded(text, (size, values)))) == result
    record = with_members(IPC.IPCdata(), f1=[4, 5])
    assert plain(decoded(text, encoded(text, record))) == [2, [4, 5]]
    assert not hasattr(record, "f0")
    with pytest.raises(ValueError, match="expected 3 elements, got 2"):
        encoded(text, (3, [1, 2]))
    with pytest.raises(TypeError):
        encoded(text, (2, None))
    matrix = [[1, 2, 3], [4, 5, 6]]
    for text, data in (("{int, int, <int:1,2>}", [2, 3, matrix]),
                       ("{<int:2,3>, int, int}", [matrix, 2, 3]),
                       ("{int, <int:1,3>, int}", [2, matrix, 3])):
        assert plain(decoded(text, encoded(text, data))) == data
        unknown = [part if isinstance(part, list) else None for part in data]
        assert plain(decoded(text, encoded(text, unknown))) == data
    cube = [[["a"], ["b"]], [["c"], [""]]]
    text = "{int, int, int, <string:1,2,3>}"
    assert plain(decoded(text, encoded(text, (2, 2, 1, cube)))) == [2, 2, 1, cube]
    text = "{int, int, <int:1,2>}"
    assert plain(decoded(text, encoded(text, (0, 5, [])))) == [0, 5, []]
    assert plain(decoded(text, encoded(text, (0, 5, None)))) == [0, 5, []]
    assert plain(decoded("{ubyte, <char:1>}", encoded("{ubyte, <char:1>}", (2, "xy")))) == [
        2, ["x", "y"]]


# --------------------------------------------------------------------- pointers


def test_pointers_everywhere():
    for value in (None, 5):
        assert decoded("*int", encoded("*int", value)) == value
        assert plain(decoded("{*int, int}", encoded("{*int, int}", (value, 1)))) == [value, 1]
    assert plain(decoded("*{int}", encoded("*{int}", (3,)))) == [3]
    assert decoded("*{int}", encoded("*{int}", (3,)), Inner).x == 3
    assert decoded("*{int}", encoded("*{int}", None), Inner) is None
    assert decoded("**string", encoded("**string", "x")) == "x"


@pytest.mark.parametrize("length", [1, 2, 100000])
def test_lists_of_any_length(length):
    node = None
    for value in range(length):
        node = Node(value=value, next=node)
    found = decoded("{int, *!}", encoded("{int, *!}", node), Node)
    values = []
    while found is not None:
        assert type(found) is Node
        values.append(found.value)
        found = found.next
    assert values == list(reversed(range(length)))


def test_lists_whose_pointer_is_not_the_last_member():
    value = None
    for number in range(50000):
        value = (value, number)
    found = decoded("{*!, int}", encoded("{*!, int}", value))
    for number in reversed(range(50000)):
        assert found.f1 == number
        found = found.f0
    assert found is None


def test_trees_and_shared_parts():
    leaf = (1, None, None)
    text = "{int, *!, *!}"
    assert plain(decoded(text, encoded(text, (3, (2, leaf, None), leaf)))) == [
        3, [2, [1, None, None], None], [1, None, None]]


def test_structures_that_lead_back_to_themselves_are_refused():
    node = Node(value=1)
    node.next = Node(value=2, next=node)
    with pytest.raises(ValueError, match=r"Node\.next: the structure leads back to itself"):
        encoded("{int, *!}", node)
    long = Node(value=1, next=None)
    for _ in range(100):
        long = Node(value=1, next=long)
    tail = long
    while tail.next is not None:
        tail = tail.next
    tail.value = "x"
    with pytest.raises(TypeError, match=r"\(92 nodes on\).*\.next\.next\.value: expected int"):
        encoded("{int, *!}", long)


def test_a_list_of_a_class_without_own_class_for_its_members():
    class Link(IPC.IPCdata):
        """Says nothing of the class of next."""
        _fields = ("value", "next")
    found = decoded("{int, *!}", encoded("{int, *!}", (1, (2, None))), Link)
    assert type(found.next) is Link
    assert type(decoded("{int, *!}", encoded("{int, *!}", (1, (2, None)))).f1) is IPC.IPCdata


# ---------------------------------------------------------------- classes, None


@pytest.mark.parametrize("text, data, result", [
    ("{double}", (1.0,), "<Inner: x: 1.0>"), ("[{double}:2]", [(1.0,), (2.0,)],
                                              "[<Inner: x: 1.0>, <Inner: x: 2.0>]"),
    ("[[{double}:1]:1]", [[(1.0,)]], "[[<Inner: x: 1.0>]]"), ("*{double}", None, "None"),
    ("int", 3, "3"), ("string", "s", "'s'"), ("{enum : 3}", 2, "2")])
def test_the_class_goes_to_the_structures_of_the_data(text, data, result):
    assert repr(decoded(text, encoded(text, data), Inner)) == result


def test_existing_objects_are_filled(ipc):
    class Outer(IPC.IPCdata):
        """With a structure inside."""
        _fields = ("i", ("inner", Inner))
    formatter = ipc.IPC_parseFormat("{int, {double}}")
    outer, inner = Outer(), Inner()
    outer.inner = inner
    content = ipc.BYTE_ARRAY(encoded("{int, {double}}", (1, (2.5,))))
    assert ipc.IPC_unmarshallData(formatter, content, outer) == (outer, ipc.IPC_OK)
    assert (outer.i, outer.inner is inner, inner.x) == (1, True, 2.5)
    numbers = [9]
    data, _ = ipc.IPC_unmarshallData(ipc.IPC_parseFormat("[int:2]"),
                                     encoded("[int:2]", [1, 2]), numbers)
    assert data is numbers == [1, 2]
    assert ipc.IPC_unmarshallData(ipc.IPC_parseFormat("int"), encoded("int", 3), outer)[0] == 3
    assert ipc.IPC_unmarshallData(formatter, content, oclass=Outer)[0].i == 1
    with pytest.raises(TypeError):
        ipc.IPC_unmarshallData(formatter, content, outer, Node)
    assert ipc.IPC_unmarshall(None, content) == (None, ipc.IPC_OK)


def test_the_printed_form():
    t1 = T1(i1=666, status=1, matrix=[[0.0, 1.0, 2.0], [1.0, 2.0, 3.0]], d1=3.14159)
    assert repr(t1) == str(t1) == (
        "<T1: i1: 666; status: 1; matrix: [[0.0, 1.0, 2.0], [1.0, 2.0, 3.0]]; d1: 3.14159>")
    nested = with_members(IPC.IPCdata(), f0=666,
                          f1=with_members(IPC.IPCdata(), f0="hello", f1=3.14159))
    assert repr(nested) == "<IPCdata: 666; <IPCdata: 'hello'; 3.14159>>"
    assert repr(IPC.IPCdata()) == "<IPCdata>" and repr(T1(d1=1)) == "<T1: d1: 1>"
    node = Node(value=1)
    node.next = node
    assert repr(node) == "<Node: value: 1; next: ...>"
    assert Named(i=1) != Named(i=1) and len({Named(), Named()}) == 2


# ------------------------------------------------------------- arrays of bytes


def test_byte_arrays(ipc):
    array = ipc.createByteArray(3)
    assert len(array) == 3 and bytes(array) == b"\0\0\0" and repr(array) == (
        "<IPC byte array, 3 bytes>")
    array[1] = 5
    memoryview(array)[2] = 6
    assert bytes(array) == b"\0\5\6"
    view = memoryview(array)
    ipc.IPC_freeByteArray(array)
    assert len(view) == 3
    view.release()
    for _ in range(2):
        ipc.IPC_freeByteArray(array)
        assert len(array) == 0
    with pytest.raises(ValueError):
        array[0] = 1
    ipc.IPC_freeByteArray(None)
    with pytest.raises(ValueError):
        ipc.createByteArray(-1)


def test_varcontent(ipc):
    varcontent = ipc.IPC_VARCONTENT_TYPE()
    assert (varcontent.length, varcontent.content) == (0, None)
    varcontent.content = b"abc"
    assert varcontent.length == 0
    assert ipc.IPC_VARCONTENT_TYPE(b"abc").length == 3
    assert ipc.IPC_marshall(ipc.IPC_parseFormat("int"), 3, varcontent) == ipc.IPC_OK
    assert varcontent.length == 4 == len(varcontent.content)
    assert ipc.IPC_unmarshall(ipc.IPC_parseFormat("int"), varcontent.content)[0] == 3
    assert ipc.IPC_marshall(None, None, varcontent) == ipc.IPC_OK
    assert (varcontent.length, varcontent.content) == (0, None)
    with pytest.raises(ipc.IPCError):
        ipc.IPC_marshall(ipc.IPC_parseFormat("int"), 3, None)
    with pytest.raises(TypeError):
        ipc.IPC_marshall("int", 3, varcontent)


def test_printing_goes_to_any_stream_in_order(ipc, tmp_path, capsys):
    formatter = ipc.IPC_parseFormat("{int, string}")
    print("before")
    assert ipc.IPC_printData(formatter, sys.stdout, (1, "x")) == ipc.IPC_OK
    print("after")
    assert capsys.readouterr().out == 'before\n{1, "x"}\nafter\n'
    stream = io.StringIO()
    ipc.IPC_printData(formatter, stream, (2, "y"))
    assert stream.getvalue() == '{2, "y"}\n'
    with open(tmp_path / "file", "w", encoding="utf-8") as file:
        file.write("first\n")
        ipc.IPC_printData(formatter, file, (3, "z"))
    assert (tmp_path / "file").read_text() == 'first\n{3, "z"}\n'
    with pytest.raises(NotImplementedError):
        ipc.IPC_readData(formatter, stream)


def test_what_is_no_array_is_refused_whatever_it_is(ipc):
    for value in ({"f0": None}, {0: 1}, object(), 5, "text", {1, 2}):
        with pytest.raises((TypeError, ValueError)):
            encoded("{int, int, <int:2>}", (0, None, value))
