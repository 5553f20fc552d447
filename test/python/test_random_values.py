"""Random formats and values: there and back in both byte orders, beside another implementation."""
import sys

import pytest

from python.tools import decoded, encoded, ipc as IPC, plain
from support import codec

if sys.version_info < (3, 10):
    pytest.skip("the other implementation needs Python 3.10", allow_module_level=True)
hypothesis = pytest.importorskip("hypothesis")
from hypothesis import given, settings, strategies as st  # noqa: E402

pytestmark = pytest.mark.usefixtures("initialized")


@pytest.fixture(scope="module")
def initialized():
    """Formats can be parsed."""
    IPC.IPC_initialize()


#: A format with a value as Python has it, and as the other implementation takes it.
def numbers(text, low, high):
    return st.integers(low, high).map(lambda number: (text, number, number))


TEXT = st.text(st.characters(blacklist_characters="\0", blacklist_categories=["Cs"]), max_size=8)
SCALARS = st.one_of(
    numbers("int", -1 << 31, (1 << 31) - 1), numbers("uint", 0, (1 << 32) - 1),
    numbers("short", -1 << 15, (1 << 15) - 1), numbers("ushort", 0, (1 << 16) - 1),
    numbers("byte", -128, 127), numbers("ubyte", 0, 255),
    numbers("long", -1 << 63, (1 << 63) - 1), numbers("ulong", 0, (1 << 64) - 1),
    st.booleans().map(lambda truth: ("boolean", truth, truth)),
    st.floats(allow_nan=False).map(lambda number: ("double", number, number)),
    st.floats(allow_nan=False, width=32).map(lambda number: ("float", number, number)),
    st.characters(max_codepoint=255).map(lambda char: ("char", char, char)),
    TEXT.map(lambda text: ("string", text, text.encode())),
    st.integers(0, 2).map(lambda number: ("{enum A, B, C}", number, number)),
    st.binary(min_size=3, max_size=3).map(lambda raw: ("3", raw, raw)))


def array_of(children):
    # [3:2] is an array of another kind.
    children = children.filter(lambda child: not child[0].isdigit())

    @st.composite
    def build(draw):
        text, value, other = draw(children)
        dimensions = draw(st.lists(st.integers(1, 3), min_size=1, max_size=3))
        nested, flat = value, [other]
        for size in reversed(dimensions):
            nested = [nested] * size
            flat = flat * size
        return f"[{text}:{','.join(map(str, dimensions))}]", nested, flat
    return build()


def structure_of(children):
    @st.composite
    def build(draw):
        members = draw(st.lists(children, min_size=1, max_size=5))
        texts, values, others = map(list, zip(*members))
        if draw(st.booleans()):
            # A variable array behind its sizes.
            text, value, other = draw(children)
            sizes = draw(st.lists(st.integers(1, 3), min_size=1, max_size=2))
            nested, flat = value, [other]
            for size in reversed(sizes):
                nested, flat = [nested] * size, flat * size
            first = len(texts) + 1
            references = ",".join(str(first + k) for k in range(len(sizes)))
            texts += ["int"] * len(sizes) + [f"<{text}:{references}>"]
            values += [*sizes, nested]
            others += [*sizes, flat]
        if draw(st.booleans()):
            # A list.
            value, other = None, None
            for _ in range(draw(st.integers(0, 3))):
                value, other = [*values, value], (*others, other)
            texts.append("*!")
            values.append(value)
            others.append(other)
        return "{" + ", ".join(texts) + "}", values, tuple(others)
    return build()


def pointer_to(children):
    return st.tuples(children, st.booleans()).map(
        lambda drawn: (f"*{drawn[0][0]}", *(drawn[0][1:] if drawn[1] else (None, None))))


def without_pointers_to_pointers(child):
    return not child[0].startswith("**")


VALUES = st.recursive(
    SCALARS,
    lambda children: st.one_of(array_of(children), structure_of(children), pointer_to(children)),
    max_leaves=12).filter(without_pointers_to_pointers)


@settings(max_examples=400, deadline=None)
@given(VALUES)
def test_values_go_there_and_come_back(case):
    text, value, other = case
    if value is None and not text.startswith("*"):
        return
    for order, sign in (("little", "<"), ("big", ">")):
        content = codec.encode(text, other, sign)
        assert plain(decoded(text, content, order=order)) == value
    assert encoded(text, value) == codec.encode(text, other, "=")


@settings(max_examples=300, deadline=None)
@given(VALUES, st.data())
def test_damaged_bytes_are_an_error_or_a_value(case, data):
    text, _, other = case
    content = bytearray(codec.encode(text, other, "<"))
    converter = IPC.IPC_parseFormat(text).converter
    for _ in range(data.draw(st.integers(0, 3))):
        if content:
            content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    content = bytes(content[:data.draw(st.integers(0, len(content)))])
    try:
        converter.decode(content, data.draw(st.sampled_from(["little", "big"])))
    except IPC.formatters.BadBytes:
        pass


JUNK = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=4),
              st.binary(max_size=4), st.just(object())),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.tuples(inner, inner),
                            st.dictionaries(st.sampled_from(["f0", "f1", "a"]), inner)),
    max_leaves=8)


@settings(max_examples=400, deadline=None)
@given(VALUES, JUNK)
def test_any_value_is_encoded_or_refused(case, junk):
    try:
        encoded(case[0], junk)
    except (TypeError, ValueError, OverflowError, AttributeError) as error:
        assert "(format " in str(error)
