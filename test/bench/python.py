#!/usr/bin/env python3
"""Measures messages in Python beside pyzmq, LCM and NATS, and images beside the C interface.

    python.py [--only TEXT] [--runs N] [--direct] [--nats-server FILE]

To be run by a Python in which ipc_cffi is installed, and whichever of pyzmq, lcm and nats-py are to be
compared; those that are not there are left out, NATS also without its server.  Everything runs on
this machine: a publisher and a subscriber, or one that asks and one that echoes, as two processes,
with their server where there is one.  No message may be lost.

    small   a structure of a number and three doubles; the others get it by the module struct
    scan    360 floats as an array of NumPy
    image   480 x 640 x 3 bytes as an array of NumPy

The C interface plays test/bench/module.c with messages as large as the image.
"""
import argparse
import asyncio
import contextlib
import importlib.util
import os
import pathlib
import shutil
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import time

import numpy

HERE = pathlib.Path(__file__).resolve().parent
COUNTS = {"small": (100000, 10000), "scan": (50000, 5000), "image": (2000, 1000)}
PATIENCE = 120
SMALL = struct.Struct("=iddd")


# ------------------------------------------------------------------------ values

def value_of(kind):
    """What is sent."""
    if kind == "small":
        return (7, 1.0, 2.0, 3.0)
    if kind == "scan":
        return numpy.arange(360, dtype="f4")
    return numpy.arange(480 * 640 * 3, dtype="u4").astype("u1").reshape(480, 640, 3)


def pack(kind, value):
    """A value as bytes, for those that carry nothing else."""
    return SMALL.pack(*value) if kind == "small" else value


def unpack(kind, content):
    """The value of bytes, without copying them."""
    if kind == "small":
        return SMALL.unpack(content)
    if kind == "scan":
        return numpy.frombuffer(content, "f4")
    return numpy.frombuffer(content, "u1").reshape(480, 640, 3)


def use(kind, value):
    """Looks at a value that has come."""
    right = value[1] == 1.0 if kind == "small" else value.flat[1] == 1
    if not right:
        raise RuntimeError(f"not what was sent: {value}")


class Stopwatch:
    """Counts messages, and the time from the first to the last."""

    def __init__(self, count):
        self.left = self.count = count
        self.begin = 0.0

    def tick(self):
        """One has come: whether it was the last."""
        if self.left == self.count:
            self.begin = time.perf_counter()
        self.left -= 1
        return self.left == 0

    def report(self):
        """The result of a flood."""
        if self.left:
            raise RuntimeError(f"{self.left} messages were lost")
        print("result", (self.count - 1) / (time.perf_counter() - self.begin), flush=True)


def report_times(times):
    """The result of round trips, in microseconds, without the first tenth."""
    print("result", statistics.median(times[len(times) // 10:]) * 1e6, flush=True)


def ready():
    """The other side may begin."""
    print("ready", flush=True)


# -------------------------------------------------------------------------- IPC

class Ipc:
    """ipc_cffi, through a central."""

    name = "ipc_cffi"
    FORMATS = {"small": "{int, double, double, double}", "scan": "[float:360]",
               "image": "[ubyte:480,640,3]"}

    @staticmethod
    def available(options):
        return importlib.util.find_spec("ipc_cffi") is not None

    @staticmethod
    @contextlib.contextmanager
    def server(options):
        from ipc_cffi import Central
        with Central("-lx", *(["-c"] if options.direct else []), environment=False) as central:
            yield central.address

    @staticmethod
    @contextlib.contextmanager
    def connection(role, address, kind):
        import ipc_cffi
        ipc_cffi.IPC_setVerbosity(ipc_cffi.IPC_Silent)
        ipc_cffi.IPC_setArrayType("numpy")
        with ipc_cffi.connect(role, address):
            for name in ("flood", "ping", "pong"):
                ipc_cffi.IPC_defineMsg(name, ipc_cffi.IPC_VARIABLE_LENGTH, Ipc.FORMATS[kind])
            yield ipc_cffi

    @staticmethod
    def look(kind):
        """As use(): a structure is an object."""
        if kind != "small":
            return lambda data: use(kind, data)

        def look(data):
            if data.x != 1.0:
                raise RuntimeError(f"not what was sent: {data}")
        return look

    @staticmethod
    def structure():
        """What small values are."""
        import ipc_cffi

        class Small(ipc_cffi.IPCdata):
            """One of them."""
            _fields = ("number", "x", "y", "z")
        return Small

    def sink(self, address, kind, count):
        with self.connection("sink", address, kind) as ipc:
            watch, look = Stopwatch(count), self.look(kind)

            def arrived(instance, data, client_data):
                look(data)
                watch.tick()
            ipc.IPC_setCapacity(4 if kind == "image" else 1000)
            ipc.IPC_subscribeData("flood", arrived, None, self.structure())
            ready()
            while watch.left and ipc.IPC_listen(PATIENCE * 1000) == ipc.IPC_OK:
                pass
            watch.report()

    def flood(self, address, kind, count):
        with self.connection("flood", address, kind) as ipc:
            ipc.IPC_listen(200)
            value = value_of(kind)
            for _ in range(count):
                ipc.IPC_publishData("flood", value)

    def echo(self, address, kind, count):
        with self.connection("echo", address, kind) as ipc:
            ipc.IPC_subscribeData(
                "ping", lambda instance, data, client_data: ipc.IPC_publishData("pong", data),
                None, self.structure())
            ready()
            ipc.IPC_dispatch()

    def ping(self, address, kind, count):
        with self.connection("ping", address, kind) as ipc:
            look, got, times, value = self.look(kind), [], [], value_of(kind)
            ipc.IPC_subscribeData("pong", lambda instance, data, client_data: got.append(data),
                                  None, self.structure())
            ipc.IPC_listen(200)
            for _ in range(count):
                begin = time.perf_counter()
                ipc.IPC_publishData("ping", value)
                while not got:
                    ipc.IPC_listen(1000)
                times.append(time.perf_counter() - begin)
                look(got.pop())
            report_times(times)


# ------------------------------------------------------------------------- pyzmq

class Zmq:
    """pyzmq: PUB and SUB over sockets of this machine, without a server."""

    name = "pyzmq"

    @staticmethod
    def available(options):
        return importlib.util.find_spec("zmq") is not None

    @staticmethod
    @contextlib.contextmanager
    def server(options):
        with tempfile.TemporaryDirectory() as folder:
            yield folder

    @staticmethod
    def socket(context, folder, name, kind, publishes):
        import zmq
        sock = context.socket(zmq.XPUB if publishes else zmq.SUB)
        # What is not read yet outlives a publisher; a subscriber would wait to tell one that has gone.
        sock.setsockopt(zmq.LINGER, PATIENCE * 1000 if publishes else 0)
        sock.setsockopt(zmq.SNDHWM if publishes else zmq.RCVHWM, 4 if kind == "image" else 1000)
        if publishes:
            sock.setsockopt(zmq.XPUB_NODROP, 1)
            sock.bind(f"ipc://{folder}/{name}")
        else:
            sock.setsockopt(zmq.SUBSCRIBE, b"")
            sock.setsockopt(zmq.RCVTIMEO, 5000)
            sock.connect(f"ipc://{folder}/{name}")
        return sock

    @staticmethod
    def receive(sock, kind):
        if kind == "image":
            return unpack(kind, sock.recv(copy=False).buffer)
        return unpack(kind, sock.recv())

    def sink(self, folder, kind, count):
        import zmq
        with zmq.Context() as context, self.socket(context, folder, "flood", kind, False) as sock:
            watch = Stopwatch(count)
            ready()
            with contextlib.suppress(zmq.Again):  # some are lost now and then, in spite of NODROP
                while watch.left:
                    use(kind, self.receive(sock, kind))
                    watch.tick()
            watch.report()

    def flood(self, folder, kind, count):
        import zmq
        with zmq.Context() as context, self.socket(context, folder, "flood", kind, True) as sock:
            sock.recv()  # the subscription
            value = value_of(kind)
            for _ in range(count):
                sock.send(pack(kind, value), copy=kind != "image")

    def echo(self, folder, kind, count):
        import zmq
        with zmq.Context() as context, self.socket(context, folder, "pong", kind, True) as out, \
                self.socket(context, folder, "ping", kind, False) as sock:
            ready()
            while True:
                value = self.receive(sock, kind)
                out.send(pack(kind, value), copy=kind != "image")

    def ping(self, folder, kind, count):
        import zmq
        with zmq.Context() as context, self.socket(context, folder, "ping", kind, True) as out, \
                self.socket(context, folder, "pong", kind, False) as sock:
            out.recv()
            time.sleep(0.2)  # until the other side has heard of our subscription
            times, value = [], value_of(kind)
            for _ in range(count):
                begin = time.perf_counter()
                out.send(pack(kind, value), copy=kind != "image")
                back = self.receive(sock, kind)
                times.append(time.perf_counter() - begin)
                use(kind, back)
            report_times(times)


# --------------------------------------------------------------------------- LCM

class Lcm:
    """LCM by UDP multicast, without a server.  As it loses what its socket cannot take, so many
    messages at most are under way; each is then reported back."""

    name = "lcm"
    WINDOW = {"small": 100, "scan": 20, "image": 1}
    URL = "udpm://239.255.76.67:7667?ttl=0"

    @classmethod
    def available(cls, options):
        if importlib.util.find_spec("lcm") is None:
            return False
        import lcm
        got = []
        try:
            probe = lcm.LCM(cls.URL)
            probe.subscribe("probe", lambda name, content: got.append(content))
            probe.publish("probe", b"probe")
            probe.handle_timeout(1000)
        except (OSError, RuntimeError):
            return False
        return bool(got)

    @staticmethod
    @contextlib.contextmanager
    def server(options):
        yield "none"

    def sink(self, address, kind, count):
        import lcm
        bus, watch, window = lcm.LCM(self.URL), Stopwatch(count), self.WINDOW[kind]

        def arrived(name, content):
            use(kind, unpack(kind, content))
            watch.tick()
            if watch.left % window == 0:
                bus.publish("taken", b"")
        subscription = bus.subscribe("flood", arrived)
        subscription.set_queue_capacity(0)
        ready()
        while watch.left and bus.handle_timeout(5000):
            pass
        watch.report()

    def flood(self, address, kind, count):
        import lcm
        bus, value, window, taken = lcm.LCM(self.URL), value_of(kind), self.WINDOW[kind], []
        bus.subscribe("taken", lambda name, content: taken.append(1)).set_queue_capacity(0)
        for number in range(count):
            while number >= (len(taken) + 1) * window:
                if not bus.handle_timeout(5000):
                    raise RuntimeError("a message was lost")
            content = pack(kind, value)
            bus.publish("flood", content if kind == "small" else content.tobytes())

    def echo(self, address, kind, count):
        import lcm
        bus = lcm.LCM(self.URL)

        def arrived(name, content):
            content = pack(kind, unpack(kind, content))
            bus.publish("pong", content if kind == "small" else content.tobytes())
        bus.subscribe("ping", arrived)
        ready()
        while True:
            bus.handle()

    def ping(self, address, kind, count):
        import lcm
        bus, got, times, value = lcm.LCM(self.URL), [], [], value_of(kind)
        bus.subscribe("pong", lambda name, content: got.append(unpack(kind, content)))
        for _ in range(count):
            begin = time.perf_counter()
            content = pack(kind, value)
            bus.publish("ping", content if kind == "small" else content.tobytes())
            while not got:
                if not bus.handle_timeout(5000):
                    raise RuntimeError("a message was lost")
            times.append(time.perf_counter() - begin)
            use(kind, got.pop())
        report_times(times)


# -------------------------------------------------------------------------- NATS

class Nats:
    """nats-py, through a nats-server."""

    name = "nats-py"

    @staticmethod
    def available(options):
        return importlib.util.find_spec("nats") is not None and options.nats_server is not None

    @staticmethod
    @contextlib.contextmanager
    def server(options):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        process = subprocess.Popen([options.nats_server, "-a", "127.0.0.1", "-p", str(port)],
                                   stderr=subprocess.DEVNULL)
        try:
            end = time.monotonic() + 10
            while time.monotonic() < end:
                with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)):
                    break
                time.sleep(0.02)
            yield f"nats://127.0.0.1:{port}"
        finally:
            process.terminate()
            process.wait()

    @staticmethod
    async def connect(address):
        import nats
        return await nats.connect(address, pending_size=64 << 20)

    def sink(self, address, kind, count):
        async def main():
            connection, watch = await self.connect(address), Stopwatch(count)
            done = asyncio.get_running_loop().create_future()

            async def arrived(message):
                use(kind, unpack(kind, message.data))
                if watch.tick():
                    done.set_result(None)
            await connection.subscribe("flood", cb=arrived, pending_msgs_limit=-1,
                                       pending_bytes_limit=-1)
            await connection.flush()
            ready()
            await asyncio.wait_for(done, PATIENCE)
            watch.report()
        asyncio.run(main())

    def flood(self, address, kind, count):
        async def main():
            connection, value = await self.connect(address), value_of(kind)
            every = 4 if kind == "image" else 1000
            for number in range(count):
                content = pack(kind, value)
                await connection.publish("flood", content if kind == "small" else content.tobytes())
                if number % every == 0:
                    await connection.flush()
            await connection.flush(PATIENCE)
        asyncio.run(main())

    def echo(self, address, kind, count):
        async def main():
            connection = await self.connect(address)

            async def arrived(message):
                content = pack(kind, unpack(kind, message.data))
                await connection.publish("pong", content if kind == "small" else content.tobytes())
            await connection.subscribe("ping", cb=arrived)
            await connection.flush()
            ready()
            await asyncio.sleep(PATIENCE)
        asyncio.run(main())

    def ping(self, address, kind, count):
        async def main():
            connection, value, times = await self.connect(address), value_of(kind), []
            back = await connection.subscribe("pong")
            await connection.flush()
            for _ in range(count):
                begin = time.perf_counter()
                content = pack(kind, value)
                await connection.publish("ping", content if kind == "small" else content.tobytes())
                content = unpack(kind, (await back.next_msg(PATIENCE)).data)
                times.append(time.perf_counter() - begin)
                use(kind, content)
            report_times(times)
        asyncio.run(main())


# -------------------------------------------------------------- the C interface

class C:
    """module.c, on the library that ipc_cffi brings along."""

    name = "C"

    @staticmethod
    @contextlib.contextmanager
    def server(options):
        with Ipc.server(options) as address, tempfile.TemporaryDirectory() as folder:
            import ipc_cffi
            subprocess.run(
                [*os.environ.get("CC", "cc").split(), "-O2", HERE / "module.c",
                 "-I", os.path.join(ipc_cffi.include_dir(), "ipc"), "-I", ipc_cffi.include_dir(),
                 ipc_cffi.library_path(), "-pthread", "-o", f"{folder}/module"], check=True)
            yield address, f"{folder}/module"


def command(system, role, address, kind, count):
    """What plays a role."""
    if system is C:
        capacity = 4 if kind == "image" else 1000
        size = {"image": 480 * 640 * 3, "scan": 4 * 360, "small": 28}[kind]
        return [address[1], role, str(count), str(size), str(capacity)], {"CENTRALHOST": address[0]}
    return [sys.executable, __file__, "--play", system.name, role, address, kind, str(count)], {}


def play(system, roles, address, kind, count):
    """The result of the role that reports one."""
    processes = []
    try:
        for role in roles:
            arguments, env = command(system, role, address, kind, count)
            processes.append(subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True,
                                              env={**os.environ, **env}))
            if role in ("sink", "echo") and processes[-1].stdout.readline() != "ready\n":
                raise RuntimeError(f"{system.name}: {role} does not begin")
        reporter = processes[roles.index("sink" if "sink" in roles else "ping")]
        out, _ = reporter.communicate(timeout=PATIENCE)
        for line in out.splitlines():
            word, number = line.split()
            if word in ("result", "per_second", "p50_us"):
                return float(number)
        raise RuntimeError(f"{system.name}: no result")
    finally:
        for process in processes:
            process.kill()
            process.wait()


def measure(systems, options, kind):
    """Medians of messages a second and of the round trip, for each system.

    One after the other in each run, so that what else the machine does is the same for all.
    """
    results = {system: ([], []) for system in systems}
    for _ in range(options.runs):
        for system in systems:
            for result, roles, count in zip(results[system], (["sink", "flood"], ["echo", "ping"]),
                                            COUNTS[kind]):
                with system.server(options) as address:
                    try:
                        result.append(play(system, roles, address, kind, count // options.divide))
                    except (RuntimeError, subprocess.TimeoutExpired) as error:
                        print(f"    {error}", file=sys.stderr)
    return {system: [statistics.median(result) if result else None for result in both]
            for system, both in results.items()}


def line(name, figures, ours):
    """A line of the table: figures, and how many times ours are as good."""
    texts = []
    for figure, mine, unit, more in zip(figures, ours, ("/s", "us"), (True, False)):
        if figure is None:
            texts.append(f"{'lost messages':>24}")
            continue
        ratio = (mine / figure if more else figure / mine) if mine else float("nan")
        texts.append(f"{figure:12,.0f} {unit:2} {ratio:7.2f}x")
    return f"  {name:10} {'  '.join(texts)}"


SYSTEMS = [Ipc, Zmq, Lcm, Nats]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--only", default="", help="small, scan or image")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--divide", type=int, default=1, help="so many times fewer messages")
    parser.add_argument("--direct", action="store_true", help="direct links between modules")
    parser.add_argument("--nats-server", default=shutil.which("nats-server"))
    parser.add_argument("--play", nargs=5, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.play:
        name, role, address, kind, count = options.play
        system, = (each for each in SYSTEMS if each.name == name)
        getattr(system(), role)(address, kind, int(count))
        return
    systems = [system for system in SYSTEMS if system.available(options)]
    for system in SYSTEMS:
        if system not in systems:
            print(f"{system.name} is not here")
    print("messages a second, median round trip; x: how many times ours is as good")
    for kind in COUNTS:
        if options.only in kind:
            print(kind, flush=True)
            results = measure([*systems, C], options, kind)
            for system, figures in results.items():
                print(line(system.name, figures, results[Ipc]), flush=True)


if __name__ == "__main__":
    main()
