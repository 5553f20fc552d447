"""The extension module that _build.py describes."""
from typing import Any

ffi: Any
lib: Any
