"""All formats and values that the C library is tested with, as values of Python."""
import hashlib
import io
import sys

import pytest

from python.tools import ipc, plain
from python.vectors import generated, load, python_value

CASES = load("cases")["cases"]
ORDERS = {"little": "little_endian", "big": "big_endian"}


@pytest.fixture
def format_of(ipc):
    def parse(case):
        for name, text in case.get("named_formats", ()):
            ipc.IPC_defineFormat(name, text)
        return ipc.IPC_parseFormat(case["format"])
    return parse


def same_bytes(content, expected):
    if "hex" in expected:
        return content.hex() == expected["hex"]
    return (len(content) == expected["length"]
            and hashlib.sha256(content).hexdigest() == expected["sha256"])


def same(first, second):
    """Equality that takes a NaN for itself, and does not recurse along lists."""
    pairs = [(first, second)]
    while pairs:
        one, other = pairs.pop()
        if isinstance(one, ipc.IPCdata):
            one = list(vars(one).values())
        if isinstance(one, list) and isinstance(other, list):
            if len(one) != len(other):
                return False
            pairs.extend(zip(one, other))
        elif not (one == other or one != one and other != other) or (  # noqa: PLR0124
                type(one) is not type(other)):
            return False
    return True


def holds(value, wanted):
    if isinstance(value, list):
        return any(holds(part, wanted) for part in value)
    if isinstance(value, dict):
        return any(holds(part, wanted) for part in value.values())
    return wanted(value)


def has_odd_boolean(case):
    """Booleans other than 0 and 1 arrive, but are not sent."""
    return "boolean" in case["format"] and holds(
        case["value"], lambda number: type(number) is int and number not in (0, 1)) and (
            case["format"] == "boolean")


#: Pointers to nothing: in Python a pointer is its target, so there is only one None.
NOT_IN_PYTHON = ("ptr_ptr_inner_null", "ptr_string_null_inside")


def can_be_sent(case):
    return not ("signalling" in case["name"] or case["name"] in NOT_IN_PYTHON
                or has_odd_boolean(case) or case["name"] == "string_null")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_cases(case, format_of):
    formatter = format_of(case)
    converter = formatter.converter
    large = isinstance(case["value"], dict) and "generator" in case["value"]
    if large:
        sent = arrived = generated(case["value"]["generator"])
    else:
        sent = python_value(converter.tree, case["value"], True)
        arrived = python_value(converter.tree, case["value"], False)
    if can_be_sent(case):
        content = bytes(converter.encode(sent))
        assert same_bytes(content, case[ORDERS[sys.byteorder]]), content.hex()[:200]
    for order, name in ORDERS.items():
        if "hex" in case[name]:
            data = converter.decode(bytes.fromhex(case[name]["hex"]), order)
        elif order == sys.byteorder:
            data = converter.decode(content, order)
        else:
            continue
        assert same(data, arrived), (order, plain(data), arrived)


def test_text_is_that_of_c(format_of, ipc):
    """IPC_printData, for all cases that can be sent."""
    for case in CASES:
        if not can_be_sent(case) or "generator" in str(case["value"])[:20]:
            continue
        formatter = format_of(case)
        value = python_value(formatter.converter.tree, case["value"], True)
        stream = io.StringIO()
        ipc.IPC_printData(formatter, stream, value)
        expected = case.get("print_after_required",
                            case.get("print_after", case.get("print_required", case["print"])))
        expected = expected.encode("latin-1").decode("utf-8", "surrogateescape")
        expected = expected.split("\0")[0]
        assert stream.getvalue() == expected or "nan" in expected, case["name"]


@pytest.mark.parametrize("case", load("malformed")["cases"],
                         ids=lambda case: f"{case['format']}-{case['fault']}")
def test_malformed_bytes_are_an_error(case, ipc):
    formatter = ipc.IPC_parseFormat(case["format"])
    ipc.IPC_setVerbosity(ipc.IPC_Silent)
    array = ipc.BYTE_ARRAY(bytes.fromhex(case["bytes"]["hex"]))
    array.order = "little"
    data, result = ipc.IPC_unmarshall(formatter, array)
    if case["required"] == "IPC_OK":
        assert result == ipc.IPC_OK and data is not None
    else:
        assert (data, result) == (None, ipc.IPC_Error)
        assert ipc.IPC_errno == ipc.IPC_Wrong_Buffer_Length


@pytest.mark.parametrize("text", [case["format"] for case in load("errors")["illegal"]])
def test_illegal_formats_are_an_error(text, ipc):
    with pytest.raises(ipc.IPCError) as caught:
        ipc.IPC_parseFormat(text)
    assert caught.value.errno == ipc.IPC_Illegal_Formatter
    ipc.IPC_setVerbosity(ipc.IPC_Silent)
    assert ipc.IPC_parseFormat(text) is None


def test_formats_of_other_projects_compile(ipc):
    ipc.IPC_setVerbosity(ipc.IPC_Silent)
    known = [ipc.IPC_parseFormat(entry["format"]) for entry in load("corpus")["formats"]]
    known = [formatter for formatter in known if formatter is not None]
    assert len(known) > 250  # the others use names of formats
    for formatter in known:
        assert ipc.IPC_parseFormat(formatter.converter.text) == formatter
