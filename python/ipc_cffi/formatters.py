"""Formats and marshalling [manual 6]."""
from __future__ import annotations

import sys
from typing import Any, Callable, Dict, NoReturn, Optional, Tuple

from . import tree
from ._ffi import ffi, lib
from .arguments import Text, text_argument, to_text
from .bytearrays import BYTE_ARRAY, IPC_VARCONTENT_TYPE, bytes_argument
from .constants import (IPC_No_Error, IPC_Null_Argument, IPC_OK,
                        IPC_RETURN_TYPE, IPC_Wrong_Buffer_Length)
from .errors import fail, raise_error
from .library import begin, listen, waits
from .values import BadBytes, Content, Converter, Encoded


class FORMATTER_PTR:
    """A parsed format.  There is one for each format; None is no format."""

    def __init__(self, pointer: Any) -> None:
        self.pointer = pointer
        self.converter = Converter(tree.read_tree(_image(pointer)))

    def __repr__(self) -> str:
        return f"<IPC formatter {self.converter.text}>"


def _image(pointer: Any) -> bytes:
    """The wire image of a format."""
    value = ffi.new("FORMATTER_PTR *", pointer)
    varcontent = ffi.new("IPC_VARCONTENT_TYPE *")
    if lib.IPC_marshall(lib.IPC_parseFormat(b"format"), value, varcontent) != IPC_OK:
        raise_error()
    try:
        return bytes(ffi.buffer(varcontent.content, varcontent.length))
    finally:
        lib.IPC_freeByteArray(varcontent.content)


# The library keeps a format as long as the process lives, so its address stands for it.
_known: Dict[Any, FORMATTER_PTR] = {}


def formatter_at(pointer: Any) -> Optional[FORMATTER_PTR]:
    """The formatter of a pointer of the library."""
    found = _known.get(pointer)
    if found is None and pointer != ffi.NULL:
        found = _known[pointer] = FORMATTER_PTR(pointer)
    return found


def checked(formatter: Any) -> Optional[FORMATTER_PTR]:
    """An argument that has to be a formatter or None."""
    if formatter is not None and not isinstance(formatter, FORMATTER_PTR):
        raise TypeError(f"a formatter is needed, not {type(formatter).__name__}")
    return formatter


def ask_for_formatter(function: Any, argument: Any) -> Optional[FORMATTER_PTR]:
    """The result of a function of the library that gives a formatter, or NULL, or an error."""
    lib.IPC_errno = IPC_No_Error
    pointer = waits(function, argument)
    if pointer == ffi.NULL and lib.IPC_errno != IPC_No_Error:
        raise_error()
        return None
    return formatter_at(pointer)


# ----------------------------------------------------------------- definitions

def IPC_parseFormat(formatString: Optional[Text]) -> Optional[FORMATTER_PTR]:
    """The formatter of a format string, None for none."""
    return ask_for_formatter(lib.IPC_parseFormat, text_argument(formatString, "a format string"))


def IPC_defineFormat(formatName: Optional[Text], formatString: Optional[Text]) -> IPC_RETURN_TYPE:
    """Gives a format a name that formats of all modules may use."""
    return listen(lib.IPC_defineFormat, text_argument(formatName),
                  text_argument(formatString, "a format string"))


def IPC_checkMsgFormats(msgName: Optional[Text], formatString: Optional[Text]) -> IPC_RETURN_TYPE:
    """Whether the format string means the same as the format of the message."""
    return listen(lib.IPC_checkMsgFormats, text_argument(msgName),
                  text_argument(formatString, "a format string"))


def IPC_msgFormatter(msgName: Optional[Text]) -> Optional[FORMATTER_PTR]:
    """The formatter of a message, None if it has no format."""
    return ask_for_formatter(lib.IPC_msgFormatter, text_argument(msgName))


# ----------------------------------------------------------------- marshalling

def _encode_nothing(data: Any) -> Encoded:
    if data is not None:
        raise TypeError("the message has no format: only None can be sent as its data, "
                        f"not {type(data).__name__}")
    return b""


def encoder(formatter: Optional[FORMATTER_PTR]) -> Callable[[Any], Encoded]:
    """What makes bytes of data, or raises what says why they do not fit."""
    return _encode_nothing if formatter is None else formatter.converter.encode


def encode(formatter: Optional[FORMATTER_PTR], data: Any) -> Encoded:
    """The bytes of data; raises what says why they do not fit."""
    return encoder(formatter)(data)


class _Arrays:
    """What arrays of numbers are decoded to where nothing else is asked for."""

    numpy = False


def IPC_setArrayType(name: str) -> None:
    """Whether arrays of numbers are decoded to lists ("list") or to arrays of NumPy ("numpy")."""
    if name not in ("list", "numpy"):
        raise ValueError(f"arrays can be 'list' or 'numpy', not {name!r}")
    if name == "numpy":
        import numpy  # type: ignore[import-not-found, unused-ignore]  # noqa: F401
    _Arrays.numpy = name == "numpy"


def decode(formatter: FORMATTER_PTR, content: Content, order: str, cls: Optional[type],
           numpy: bool = False) -> Any:
    """The data of the bytes of a message.  No bytes are no data, if the format needs any."""
    if not content and formatter.converter.codec.least > 0:
        return None
    return formatter.converter.decode(content, order, numpy or _Arrays.numpy, cls)


def IPC_marshall(formatter: Optional[FORMATTER_PTR], data: Any,
                 varcontent: Optional[IPC_VARCONTENT_TYPE]) -> IPC_RETURN_TYPE:
    """Encodes data into varcontent."""
    if varcontent is None:
        return fail(IPC_Null_Argument)
    if checked(formatter) is None:
        varcontent.length, varcontent.content = 0, None
        return IPC_OK
    content = BYTE_ARRAY(encode(formatter, data))
    varcontent.length, varcontent.content = len(content), content
    return IPC_OK


def IPC_unmarshall(formatter: Optional[FORMATTER_PTR], bytearray: Any,
                   oclass: Optional[type] = None) -> Tuple[Any, IPC_RETURN_TYPE]:
    """Decodes bytes: the data, structures as oclass, and the result."""
    return IPC_unmarshallData(formatter, bytearray, None, oclass)


def IPC_unmarshallData(formatter: Optional[FORMATTER_PTR], bytearray: Any, object: Any = None,
                       oclass: Optional[type] = None) -> Tuple[Any, IPC_RETURN_TYPE]:
    """Decodes bytes into a structure or list that exists, or as IPC_unmarshall."""
    if checked(formatter) is None:
        return None, IPC_OK
    assert formatter is not None
    if bytearray is None:
        return None, fail(IPC_Null_Argument)
    if object is not None and oclass is not None and not isinstance(object, oclass):
        raise TypeError(f"the object is no {oclass.__name__} but a {type(object).__name__}")
    if isinstance(bytearray, IPC_VARCONTENT_TYPE):
        bytearray = bytearray.content
    content = bytes(bytes_argument(bytearray)[0])
    is_structure = isinstance(formatter.converter.tree, tree.Structure)
    if object is not None and is_structure:
        oclass = type(object)
    try:
        order = getattr(bytearray, "order", sys.byteorder)
        data = formatter.converter.decode(content, order, _Arrays.numpy, oclass)
    except BadBytes:
        return None, fail(IPC_Wrong_Buffer_Length)
    return (data if object is None else formatter.converter.fill(object, data)), IPC_OK


# -------------------------------------------------------------------- printing

def IPC_printData(formatter: Optional[FORMATTER_PTR], stream: Any, data: Any) -> IPC_RETURN_TYPE:
    """Writes data as text to a stream, as the function of C does."""
    if checked(formatter) is None or stream is None:
        return fail(IPC_Null_Argument)
    assert formatter is not None
    begin()
    with ffi.from_buffer(encode(formatter, data)) as content:
        text = lib.glue_print(formatter.pointer, content, len(content))
    if text == ffi.NULL:
        return raise_error()
    try:
        stream.write(to_text(text))
    finally:
        lib.glue_free(text)
    return IPC_OK


def IPC_readData(formatter: Optional[FORMATTER_PTR], stream: Any) -> NoReturn:
    """Not available in Python."""
    raise NotImplementedError("IPC_readData is not available in Python")


__all__ = ["FORMATTER_PTR", "IPC_parseFormat", "IPC_defineFormat", "IPC_checkMsgFormats",
           "IPC_msgFormatter", "IPC_marshall", "IPC_unmarshall", "IPC_unmarshallData",
           "IPC_printData", "IPC_readData"]
