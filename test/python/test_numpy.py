"""Arrays of NumPy (check 68)."""
import dataclasses
import sys
from typing import Annotated

import pytest

from python.tools import decoded, encoded, ipc as IPC, listen_until

numpy = pytest.importorskip("numpy")
OTHER = "big" if sys.byteorder == "little" else "little"

pytestmark = pytest.mark.usefixtures("ipc")

DTYPES = {"byte": "i1", "ubyte": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
          "long": "l", "ulong": "L", "float": "f4", "double": "f8"}


def as_array(text, content, order=sys.byteorder, cls=None):
    return IPC.IPC_parseFormat(text).converter.decode(content, order, True, cls)


@pytest.mark.parametrize("name, dtype", DTYPES.items())
def test_every_type_goes_there_and_back(name, dtype):
    values = numpy.arange(24).astype(dtype)
    text = f"[{name}:24]"
    content = encoded(text, values)
    assert content == encoded(text, values.tolist()) == values.tobytes()
    back = as_array(text, content)
    assert back.dtype == values.dtype and (back == values).all()
    swapped = as_array(text, values.byteswap().tobytes(), OTHER)
    assert swapped.dtype == values.dtype and (swapped == values).all()


def test_shapes_strides_and_orders():
    cube = numpy.arange(60.0).reshape(3, 4, 5)
    for array in (cube, numpy.asfortranarray(cube), cube.astype(">f8"), cube.astype("<f8"),
                  numpy.arange(120.0).reshape(3, 4, 10)[:, :, ::2] / 2, cube.astype("f4"),
                  cube.astype(int)):
        assert encoded("[double:3,4,5]", array) == cube.tobytes()
    assert encoded("[double:2,2]", numpy.arange(9.0).reshape(3, 3)) == numpy.array(
        [[0.0, 1.0], [3.0, 4.0]]).tobytes()
    text = "{int, int, <double:1,2>}"
    content = encoded(text, (None, None, cube[0]))
    data = as_array(text, content)
    assert (data.f0, data.f1, data.f2.shape) == (4, 5, (4, 5)) and (data.f2 == cube[0]).all()
    empty = as_array(text, encoded(text, (0, 3, numpy.empty((0, 3)))))
    assert len(empty.f2) == 0


def test_numbers_that_do_not_fit_are_refused():
    for text, array, error in (
            ("[int:2]", numpy.array([1, 1 << 40]), OverflowError),
            ("[ubyte:2]", numpy.array([1, -200]), OverflowError),
            ("[int:2]", numpy.array([1.5, 2.5]), TypeError),
            ("[double:2]", numpy.array([1j, 2]), TypeError),
            ("[double:2]", numpy.array(["a", "b"]), TypeError),
            ("[double:3]", numpy.array([1.0, 2.0]), ValueError),
            ("[double:2,2]", numpy.array([1.0, 2.0]), TypeError)):
        with pytest.raises(error, match="data"):
            encoded(text, array)
    assert decoded("[int:2]", encoded("[int:2]", numpy.array([1, (1 << 32) - 1]))) == [1, -1]
    assert decoded("[boolean:2]", encoded("[boolean:2]", numpy.array([True, False]))) == [
        True, False]
    assert decoded("{int, double, boolean}", encoded(
        "{int, double, boolean}",
        (numpy.int64(3), numpy.float32(0.5), numpy.bool_(True)))).f1 == 0.5


def test_arrays_lie_over_the_bytes_of_the_message():
    content = numpy.arange(1000.0).tobytes()
    array = as_array("[double:1000]", content)
    assert array.base is not None and not array.flags.writeable
    address = array.__array_interface__["data"][0]
    assert address == numpy.frombuffer(content).__array_interface__["data"][0]
    shifted = as_array("{char, [double:2]}", b"x" + content[:16])
    assert shifted.f1.flags.aligned and shifted.f1.tolist() == [0.0, 1.0]
    del content
    assert array.sum() == 499500.0


@dataclasses.dataclass
class Scan:
    """A structure whose array is one of NumPy."""
    angle: float
    ranges: Annotated[numpy.ndarray, "[float:4]"]
    flags: Annotated[list, "[int:2]"]


def test_a_data_class_says_where_arrays_are_wanted():
    text = IPC.format_of(Scan)
    assert text == "{double, [float:4], [int:2]}"
    scan = decoded(text, encoded(text, Scan(0.5, numpy.ones(4), [1, 2])), Scan)
    assert isinstance(scan.ranges, numpy.ndarray) and scan.ranges.dtype == "f4"
    assert scan.flags == [1, 2]


def test_the_process_can_choose(ipc):
    ipc.IPC_setArrayType("numpy")
    try:
        assert isinstance(decoded("[int:2]", encoded("[int:2]", [1, 2])), numpy.ndarray)
    finally:
        ipc.IPC_setArrayType("list")
    assert decoded("[int:2]", encoded("[int:2]", [1, 2])) == [1, 2]
    with pytest.raises(ValueError):
        ipc.IPC_setArrayType("tuple")


def test_large_arrays_are_sent_and_received_where_they_lie(module):
    image = numpy.arange(480 * 640 * 3, dtype="u4").astype("u1").reshape(480, 640, 3)
    converter = module.IPC_parseFormat("[ubyte:480,640,3]").converter
    assert numpy.shares_memory(numpy.frombuffer(converter.encode(image), "u1"), image)
    assert converter.encode(image[:, ::-1]) == image[:, ::-1].tobytes()
    got = []
    module.IPC_setArrayType("numpy")
    try:
        for name, text in (("whole", "[ubyte:480,640,3]"),
                           ("part", "{string, int, int, <ubyte:2,3>, string}")):
            module.IPC_defineMsg(name, module.IPC_VARIABLE_LENGTH, text)
            module.IPC_subscribeData(name, lambda _, data, __: got.append(data))
        module.IPC_publishData("whole", image)
        module.IPC_publishData("part", ("a", None, None, image.reshape(480, -1), "b"))
        module.IPC_publishData("whole", numpy.zeros_like(image))
        listen_until(lambda: len(got) == 3)
    finally:
        module.IPC_setArrayType("list")
    assert (got[0] == image).all() and not got[2].any()
    assert not got[0].flags.owndata and not got[0].flags.writeable
    assert (got[1].f0, got[1].f1, got[1].f4) == ("a", 480, "b")
    assert (got[1].f3 == image.reshape(480, -1)).all()
    module.IPC_disconnect()
    assert (got[0] == image).all()  # lives as long as the array
