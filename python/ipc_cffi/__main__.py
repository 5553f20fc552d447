"""python -m ipc_cffi COMMAND: the programs of the package, and small tools for messages.

    demo                      modules that talk to each other, on a server of their own
    pub NAME [DATA ...]       publishes data given as JSON, or each line of the standard input
    sub NAME ...              prints messages as lines of JSON
    query NAME [DATA]         asks, and prints the answer
    echo NAME                 answers queries with the data they bring
    version                   the versions of the package and of its library
    central, xdrgen, killCentral, killModule
                              the programs themselves, with all their options
"""
from __future__ import annotations

import argparse
import sys
from typing import Callable, Dict, List, Optional

from . import __version__, _programs, demo, library_version, tools
from .errors import IPCError

PROGRAMS: Dict[str, Callable[[], object]] = {
    "central": _programs.central, "xdrgen": _programs.xdrgen,
    "killCentral": _programs.kill_central, "killModule": _programs.kill_module}


def parser() -> argparse.ArgumentParser:
    """The commands that are not programs of their own, and their options."""
    description, _, commands = (__doc__ or "").partition("\n\n")
    whole = argparse.ArgumentParser(
        prog="python -m ipc_cffi", description=description.partition(": ")[2].capitalize(),
        epilog="commands:\n" + commands, formatter_class=argparse.RawDescriptionHelpFormatter)
    whole.add_argument("--version", action="version", version=versions())
    command = whole.add_subparsers(dest="command", metavar="COMMAND", required=True)

    add = command.add_parser
    one = add("demo")
    one.set_defaults(run=lambda options: demo.main())
    one = add("version")
    one.set_defaults(run=lambda options: print(versions()))
    for tool in (tools.pub, tools.sub, tools.query, tools.echo):
        one = add(tool.__name__, description=tool.__doc__)
        one.add_argument("--server", metavar="HOST[:PORT]",
                         help="the server, by default that of CENTRALHOST")
        one.add_argument("--format", help="the message's format, if nobody has defined it yet")
        if tool is not tools.pub:
            one.add_argument("--timeout", type=float, metavar="SECONDS",
                             help="how long to wait for a message, by default for ever")
        if tool in (tools.sub, tools.echo):
            one.add_argument("--count", type=int, help="ends after so many messages")
        one.add_argument("name", metavar="NAME", nargs="+" if tool is tools.sub else None)
        if tool is tools.pub:
            one.add_argument("data", nargs="*", metavar="DATA")
        if tool is tools.query:
            one.add_argument("data", nargs="?", default="null", metavar="DATA")
        one.set_defaults(run=tool)
    return whole


def versions() -> str:
    """The versions of package and library."""
    return f"ipc_cffi {__version__}, libipc {library_version() or 'of the system'}"


def main(arguments: Optional[List[str]] = None) -> int:
    """Runs a command; its exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if arguments and arguments[0] in PROGRAMS:
        sys.argv[1:] = arguments[1:]
        PROGRAMS[arguments[0]]()
    options = parser().parse_args(arguments)
    try:
        return int(options.run(options) or 0)
    except (IPCError, TypeError, ValueError, OverflowError, AttributeError) as error:
        print(f"{options.command}: {error}", file=sys.stderr)
        return 1
    except (KeyboardInterrupt, BrokenPipeError):
        return 1


if __name__ == "__main__":
    sys.exit(main())
