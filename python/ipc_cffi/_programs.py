"""The programs that the package brings along."""
from __future__ import annotations

import os
import shutil
import sys
from typing import NoReturn

PLACE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bin")


def program_path(name: str) -> str:
    """The path of a program: that of the package, else one that is installed."""
    own = os.path.join(PLACE, name)
    if os.access(own, os.X_OK):
        return own
    here = os.path.realpath(sys.argv[0])
    for folder in os.environ.get("PATH", os.defpath).split(os.pathsep):
        found = shutil.which(name, path=folder)
        if found is not None and os.path.realpath(found) != here:
            return found
    raise FileNotFoundError(f"the program {name} is neither in this package nor on the PATH")


def _become(name: str) -> NoReturn:
    try:
        path = program_path(name)
    except FileNotFoundError as error:
        sys.exit(str(error))
    os.execv(path, [path, *sys.argv[1:]])


def central() -> NoReturn:
    """The server."""
    _become("central")


def xdrgen() -> NoReturn:
    """The generator of types and formats."""
    _become("xdrgen")


def kill_central() -> NoReturn:
    """Ends the server."""
    _become("killCentral")


def kill_module() -> NoReturn:
    """Ends modules by name."""
    _become("killModule")
