"""Modules that talk to each other: python -m ipc_cffi demo.

Three programs: a robot that drives along a curve and publishes where it is, a planner that answers
how far it is from there to a goal, and a display, this program, that hears the one and asks the
other.
"""
from __future__ import annotations

import contextlib
import math
import subprocess
import sys
from dataclasses import dataclass
from typing import Callable, Dict, Iterator, Sequence

from .central import Central
from .connection import connect
from .constants import IPC_Silent
from .errors import IPC_setVerbosity


@dataclass
class Position:
    """Where the robot is."""
    x: float
    y: float


@dataclass
class Leg:
    """From here to there."""
    here: Position
    there: Position


GOAL = Position(3.0, 4.0)
STEPS = 5
PATIENCE = 30.0


def robot() -> None:
    """Publishes positions, when it is told to."""
    with connect("robot") as ipc:
        ipc.define("position", Position)
        ipc.define("drive", int)

        @ipc.subscribe("drive")
        def drive(message: object) -> None:
            for step in range(STEPS):
                ipc.publish("position", Position(float(step), math.sqrt(step)))
            ipc.stop()
        print("ready", flush=True)
        ipc.dispatch()


def planner() -> None:
    """Answers queries for distances, until its input ends."""
    with connect("planner") as ipc:
        ipc.define("distance", Leg)
        ipc.define("meters", float)
        print("ready", flush=True)
        for message in ipc.messages("distance", type=Leg, queries=True):
            leg = message.data
            message.respond("meters", math.hypot(leg.there.x - leg.here.x,
                                                 leg.there.y - leg.here.y))


def display() -> None:
    """Has the robot drive, and prints what it and the planner say."""
    with connect("display") as ipc:
        messages = ipc.messages("position", type=Position, timeout=PATIENCE)
        ipc.publish("drive", STEPS)
        for count, message in enumerate(messages, 1):
            left = ipc.query("distance", Leg(message.data, GOAL), timeout=PATIENCE)
            print(f"robot at {message.data}, {left:.2f} m to go")
            if count == STEPS:
                return


@contextlib.contextmanager
def _module(name: str) -> Iterator[None]:
    """Another program of this file, for a while."""
    with subprocess.Popen([sys.executable, "-m", "ipc_cffi.demo", name],
                          stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None
            if process.stdout.readline() != b"ready\n":
                raise RuntimeError(f"the module {name} has not started")
            print(f"{name} is there, a program of its own")
            yield
        finally:
            process.terminate()


def main(names: Sequence[str] = ()) -> None:
    """Runs one of the modules, or all of them and their server."""
    IPC_setVerbosity(IPC_Silent)
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    roles: Dict[str, Callable[[], None]] = {"robot": robot, "planner": planner}
    if names:
        return roles[names[0]]()
    with Central() as central:
        print(f"central listens at {central.address}")
        with _module("robot"), _module("planner"):
            display()
    print("all went well")
    return None


if __name__ == "__main__":
    main(sys.argv[1:])
