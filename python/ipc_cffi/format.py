"""Formats as objects: encoding and decoding without a message."""
from __future__ import annotations

import io
import sys
from typing import Any, Optional

from .constants import IPC_OK, IPC_Illegal_Formatter, IPC_Wrong_Buffer_Length
from .errors import last_error
from .formatters import FORMATTER_PTR, IPC_parseFormat, IPC_printData, decode, encode
from .hints import class_in, format_of
from .values import BadBytes


class Format:
    """A format, given by its string or by a type that it follows from."""

    def __init__(self, format: Any) -> None:
        text = format if isinstance(format, (str, bytes)) else format_of(format)
        formatter = IPC_parseFormat(text)
        if formatter is None:
            raise last_error(IPC_Illegal_Formatter)
        self.formatter: FORMATTER_PTR = formatter
        self._class = None if isinstance(format, (str, bytes)) else class_in(format)

    def encode(self, data: Any) -> bytes:
        """The bytes that data are sent as."""
        return bytes(encode(self.formatter, data))

    def decode(self, content: Any, *, type: Optional[type] = None, numpy: bool = False,
               order: str = sys.byteorder) -> Any:
        """The data of bytes; structures become of that type, or of the one the format is of."""
        try:
            return decode(self.formatter, bytes(content), order, type or self._class, numpy)
        except BadBytes:
            raise last_error(IPC_Wrong_Buffer_Length) from None

    def print(self, data: Any) -> str:
        """Data as IPC_printData writes them."""
        stream = io.StringIO()
        if IPC_printData(self.formatter, stream, data) != IPC_OK:
            raise last_error()
        return stream.getvalue().rstrip("\n")

    def __str__(self) -> str:
        return self.formatter.converter.text

    def __repr__(self) -> str:
        return f"Format({str(self)!r})"

