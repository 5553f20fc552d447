#!/usr/bin/env python3
"""Measures message rate and latency, and compares with another implementation.

    bench.py --build build/release [--other-central PATH --other-libipc DIR]

Plays test/bench/module.c on a private central: round trips, floods, system calls
per message, and round trips beside idle modules.  With another central and its
library the same is measured in turn, ours and theirs alternating, and the ratio
of the medians is printed.  Needs a C compiler; strace for the system calls.
"""

import argparse
import contextlib
import os
import pathlib
import re
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Side:
    """One implementation: a central, a library, and the module program run with them."""

    def __init__(self, name, central, libdir, module):
        self.name = name
        self.central = central
        self.libdir = libdir
        self.module = module

    def start_central(self, wrapper=()):
        self.port = free_port()
        self.env = dict(os.environ, LD_LIBRARY_PATH=str(self.libdir),
                        CENTRALHOST=f"{socket.gethostname()}:{self.port}")
        self.server = subprocess.Popen([*wrapper, str(self.central), f"-p{self.port}", "-u", "-lx"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                       stdin=subprocess.DEVNULL, env=self.env)
        deadline = time.monotonic() + 10
        while time.monotonic() < deadline:
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", self.port)) == 0:
                    return
            time.sleep(0.02)
        raise RuntimeError(f"{self.name}: central did not start")

    def stop_central(self):
        self.server.terminate()
        try:
            self.server.wait(10)
        except subprocess.TimeoutExpired:
            self.server.kill()
            self.server.wait()

    def play(self, *arguments, wait_ready=False, wrapper=()):
        process = subprocess.Popen([*wrapper, str(self.module), *map(str, arguments)],
                                   stdout=subprocess.PIPE, text=True, env=self.env,
                                   start_new_session=True)
        if wait_ready and process.stdout.readline() != "ready\n":
            raise RuntimeError(f"{self.name}: {arguments[0]} did not get ready")
        return process

    def figures(self, process):
        output, _ = process.communicate(timeout=300)
        if process.returncode != 0:
            raise RuntimeError(f"{self.name}: {process.args} failed")
        return {line.split()[0]: float(line.split()[1]) for line in output.splitlines()
                if re.fullmatch(r"\w+ [\d.]+", line)}


def end(process):
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextlib.contextmanager
def one_core():
    """All processes on one core: where the scheduler puts them changes a round trip more than
    anything that is measured here."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(cores)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)


@one_core()
def round_trip(side, size, n, idle=0):
    side.start_central()
    helpers = []
    try:
        if idle:
            helpers.append(side.play("idle", idle, wait_ready=True))
        helpers.append(side.play("echo", wait_ready=True))
        return side.figures(side.play("ping", n, size))["p50_us"]
    finally:
        for helper in helpers:
            end(helper)
        side.stop_central()


def flood(side, size, n, capacity):
    side.start_central()
    try:
        sink = side.play("sink", n, size, capacity, wait_ready=True)
        source = side.play("flood", n, size)
        rate = side.figures(sink)["per_second"]
        side.figures(source)
        return rate
    finally:
        side.stop_central()


def calls_in(trace):
    total = re.search(r"^\s*100\.00\s+\S+\s+\S*\s+(\d+)", trace.read_text(), re.M)
    return int(total.group(1))


def count_calls(side, size, n, capacity, directory):
    """System calls of publisher, central and subscriber together in one flood."""
    traces = [pathlib.Path(directory) / name for name in ("central", "sink", "flood")]
    strace = [["strace", "-c", "-f", "-o", str(trace)] for trace in traces]
    side.start_central(strace[0])
    try:
        sink = side.play("sink", n, size, capacity, wait_ready=True, wrapper=strace[1])
        source = side.play("flood", n, size, wrapper=strace[2])
        side.figures(sink)
        side.figures(source)
    finally:
        subprocess.run(["pkill", "-TERM", "-P", str(side.server.pid)], check=False)
        side.stop_central()
    return sum(map(calls_in, traces))


def calls_per_message(side, size, n, capacity):
    """The difference of two floods, so that start and end do not count."""
    with tempfile.TemporaryDirectory() as directory:
        short = count_calls(side, size, n // 4, capacity, directory)
        long = count_calls(side, size, n, capacity, directory)
    return (long - short) / (n - n // 4)


def attempt(measure, side):
    try:
        return measure(side)
    except (RuntimeError, subprocess.TimeoutExpired) as problem:
        print(f"    {problem}", file=sys.stderr)
        return None


def compare(title, unit, measure, sides, runs, better):
    results = {side.name: [] for side in sides}
    for _ in range(runs):
        for side in sides:
            value = attempt(measure, side)
            if value is not None:
                results[side.name].append(value)
    medians = {name: statistics.median(values) for name, values in results.items() if values}
    text = ", ".join(f"{name} {value:.2f} {unit} ({len(results[name])} of {runs} runs)"
                     for name, value in medians.items())
    if len(medians) == 2:
        ours, theirs = medians["ours"], medians["other"]
        ratio = theirs / ours if better == "less" else ours / theirs
        text += f"; ours {ratio:.2f} times as good"
    print(f"{title}: {text}", flush=True)


def compile_module(build, include):
    program = pathlib.Path(build) / "bench_module"
    subprocess.run(["cc", "-O2", "-I", str(include), str(HERE / "module.c"), "-o", str(program),
                    "-L", str(pathlib.Path(build) / "src/c/libipc"), "-lipc"], check=True)
    return program


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default=ROOT / "build" / "release")
    parser.add_argument("--other-central")
    parser.add_argument("--other-libipc")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--idle", type=int, default=800)
    parser.add_argument("--only", default="", help="run only comparisons whose title contains this")
    options = parser.parse_args()
    build = pathlib.Path(options.build).resolve()
    module = compile_module(build, ROOT / "include/ipc")
    sides = [Side("ours", build / "src/c/central/central", build / "src/c/libipc", module)]
    if options.other_central:
        sides.append(Side("other", options.other_central, options.other_libipc, module))

    def run(title, unit, measure, better):
        if options.only in title:
            compare(title, unit, measure, sides, options.runs, better)

    run("round trip of 8 bytes, one core", "us", lambda s: round_trip(s, 8, 20000), "less")
    run("round trip of 64 KiB, one core", "us", lambda s: round_trip(s, 65536, 5000), "less")
    run("flood of 64 bytes, capacity 1", "/s", lambda s: flood(s, 64, 100000, 1), "more")
    run("flood of 64 bytes, capacity 4", "/s", lambda s: flood(s, 64, 100000, 4), "more")
    run("flood of 64 bytes, capacity 1000", "/s", lambda s: flood(s, 64, 200000, 1000), "more")
    run("flood of 1 MiB, capacity 4", "/s", lambda s: flood(s, 1 << 20, 1000, 4), "more")
    if shutil.which("strace"):
        run("system calls per message, capacity 1", "calls",
            lambda s: calls_per_message(s, 64, 20000, 1), "less")
    run(f"round trip of 8 bytes beside {options.idle} idle modules, one core", "us",
        lambda s: round_trip(s, 8, 20000, options.idle), "less")


if __name__ == "__main__":
    main()
