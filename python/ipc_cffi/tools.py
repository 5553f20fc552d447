"""Messages from the command line, with data as JSON.

Structures are arrays of their members or objects by f0, f1, ...; they are printed as arrays.
Bytes of messages without a format are strings of two hexadecimal digits for each.
"""
from __future__ import annotations

import argparse
import contextlib
import itertools
import json
import os
import sys
from typing import Any, Iterator

from .connection import Connection, connect
from .constants import IPC_Silent
from .errors import IPC_setVerbosity
from .messages import IPC_isMsgDefined
from .records import IPCdata


def plain(value: Any) -> Any:
    """A received value as JSON can write it."""
    if isinstance(value, IPCdata):
        return [plain(member) for member in vars(value).values()]
    if isinstance(value, list):
        return [plain(element) for element in value]
    if isinstance(value, (bytes, bytearray)):
        return value.hex()
    return value


def line(value: Any) -> str:
    """A received value as a line of JSON."""
    return json.dumps(plain(value), ensure_ascii=False)


@contextlib.contextmanager
def _connection(options: argparse.Namespace, *names: str) -> Iterator[Connection]:
    """A connection; the messages are defined if a format is given for them."""
    IPC_setVerbosity(IPC_Silent)
    with connect(f"{options.command}-{os.getpid()}", options.server) as ipc:
        for name in names:
            if options.format and not IPC_isMsgDefined(name):
                ipc.define(name, options.format)
        yield ipc


def pub(options: argparse.Namespace) -> None:
    """Publishes a message for each DATA, or for each line of the standard input."""
    with _connection(options, options.name) as ipc:
        for text in options.data or sys.stdin:
            ipc.publish(options.name, json.loads(text))


def sub(options: argparse.Namespace) -> None:
    """Prints messages, each as a line: its name, a blank, its data."""
    with _connection(options, *options.name) as ipc:
        messages = ipc.messages(*options.name, timeout=options.timeout)
        for message in itertools.islice(messages, options.count):
            print(message.name, line(message.data), flush=True)


def query(options: argparse.Namespace) -> None:
    """Asks a query with DATA, and prints the data of the answer."""
    with _connection(options, options.name) as ipc:
        print(line(ipc.query(options.name, json.loads(options.data), options.timeout)))


def echo(options: argparse.Namespace) -> None:
    """Answers queries with their own data."""
    with _connection(options, options.name) as ipc:
        messages = ipc.messages(options.name, timeout=options.timeout, queries=True)
        for message in itertools.islice(messages, options.count):
            message.respond(options.name, message.data)
