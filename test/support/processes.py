"""Programs that tests start: a central, modules, anything; captured, bounded, ended by pid."""
import os
import pty
import random
import re
import shutil
import signal
import socket
import subprocess
import threading
import tty
import zlib

from support.waiting import Deadline, PATIENCE, SLOW, TimedOut, wait_until

SANITIZER_TRACES = ("ERROR: AddressSanitizer", "ERROR: LeakSanitizer", "runtime error:",
                    "WARNING: ThreadSanitizer")


#: All programs that the running test has started.
started = []


class Process:
    """A running program whose output is collected line by line.

    With terminal=True its standard output is a terminal, so that programs that leave the
    buffering to stdio write whole lines.
    """

    def __init__(self, arguments, *, stdin=subprocess.DEVNULL, env=None, cwd=None,
                 terminal=False, **popen):
        self.arguments = [str(argument) for argument in arguments]
        # The leak checker counts what a module keeps for life, and would change its exit status.
        options = {"ASAN_OPTIONS": "detect_leaks=0"} if stdin == subprocess.PIPE else {}
        stdout, ours = subprocess.PIPE, None
        if terminal:
            ours, stdout = pty.openpty()
            tty.setraw(stdout)
        self.process = subprocess.Popen(
            self.arguments, stdin=stdin, stdout=stdout, stderr=subprocess.PIPE,
            env={**os.environ, **options, **(env or {})}, cwd=cwd, **popen)
        if terminal:
            os.close(stdout)
            self.process.stdout = os.fdopen(ours, "rb")
        self.stdout, self.stderr = [], []
        self._news = threading.Condition()
        self._open = 2
        self._readers = [
            threading.Thread(target=self._read, args=(stream, lines), daemon=True)
            for stream, lines in ((self.process.stdout, self.stdout),
                                  (self.process.stderr, self.stderr))]
        for reader in self._readers:
            reader.start()
        started.append(self)

    def _read(self, stream, lines):
        try:
            for raw in stream:
                with self._news:
                    lines.append(raw.decode("latin-1").rstrip("\n"))
                    self._news.notify_all()
        except OSError:
            pass  # a terminal ends like this
        stream.close()
        with self._news:
            self._open -= 1
            self._news.notify_all()

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self.stop()

    @property
    def pid(self):
        return self.process.pid

    def alive(self):
        return self.process.poll() is None

    def wait_until_it_waits(self):
        """Until the program's main thread is asleep, and is so at several looks in a row."""
        looks = 0

        def sleeps():
            nonlocal looks
            with open(f"/proc/{self.pid}/stat", encoding="ascii", errors="replace") as file:
                looks = looks + 1 if file.read().rpartition(")")[2].split()[0] == "S" else 0
            return looks == 5
        wait_until(sleeps, f"{self} waits")

    def output(self):
        """Everything written so far, both streams."""
        with self._news:
            return "\n".join(self.stdout + self.stderr)

    def wait_for_line(self, pattern, *, start=0, stream="stdout", seconds=None):
        """Match object of the first line from number start on in which pattern is found."""
        lines = getattr(self, stream)
        deadline = Deadline(seconds)
        with self._news:
            while True:
                for line in lines[start:]:
                    if match := re.search(pattern, line):
                        return match
                start = len(lines)
                if not self._open:
                    raise TimedOut(f"{self} ended without {pattern!r}:\n{self._tail()}")
                if not self._news.wait(deadline.left()):
                    raise TimedOut(f"{self} did not print {pattern!r}:\n{self._tail()}")

    def _tail(self):
        """The end of the output, or the beginning of what a sanitizer says."""
        for number, line in enumerate(self.stderr):
            if any(trace in line for trace in SANITIZER_TRACES):
                return "\n".join(self.stderr[number:number + 12])
        return "\n".join(self.stdout[-20:] + self.stderr[-20:])

    def wait(self, seconds=None):
        """The exit status, negative for a signal; all output has been read."""
        try:
            self.process.wait(PATIENCE if seconds is None else seconds)
        except subprocess.TimeoutExpired:
            raise TimedOut(f"{self} does not end:\n{self._tail()}") from None
        for reader in self._readers:
            reader.join(PATIENCE)
        return self.process.returncode

    def write_line(self, text):
        """Writes a line to the standard input, which has to be a pipe."""
        self.process.stdin.write(text.encode() + b"\n")
        self.process.stdin.flush()

    def signal(self, number):
        if self.alive():
            os.kill(self.pid, number)

    def stop(self):
        """Ends the program, gently at first; complains about what sanitizers have found."""
        self.signal(signal.SIGCONT)
        self.signal(signal.SIGTERM)
        try:
            self.wait()
        except TimedOut:
            self.signal(signal.SIGKILL)
            self.wait()
            raise
        finally:
            self.close_stdin()
        self.check_sanitizers()

    def close_stdin(self):
        try:
            if self.process.stdin:
                self.process.stdin.close()
        except BrokenPipeError:
            pass

    def check_sanitizers(self):
        text = self.output()
        assert not any(trace in text for trace in SANITIZER_TRACES), f"{self}:\n{text}"

    def __str__(self):
        return f"{os.path.basename(self.arguments[0])} ({self.pid})"


def memory_of(process):
    """Resident bytes."""
    with open(f"/proc/{process.pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def is_sanitized(program):
    """Whether a program keeps memory longer than it needs it, among others."""
    with open(program, "rb") as file:
        return b"__asan_init" in file.read()


def processor_time_of(process):
    """Seconds that a process has used."""
    with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def free_port():
    """A port that nobody uses at the moment, and that the kernel gives to nobody by itself."""
    while True:
        port = random.randrange(20000, 32000)
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port


class Central(Process):
    """A central on a port of its own.

    With console=True it reads commands from its standard input, a pipe unless stdin says otherwise.
    """

    def __init__(self, program, *options, original=False, console=False, **popen):
        self.original = original
        self._stopped = False
        port = free_port() if original else 0
        if console:
            popen.setdefault("stdin", subprocess.PIPE)
        else:
            options = ("-u", *options)
        super().__init__([program, f"-p{port}", *options], **popen)
        try:
            announced = int(self.wait_for_line(r"Expecting \d+ on port (\d+)").group(1))
        except TimedOut:
            self.stop()
            raise
        self.port = announced
        self.address = f"localhost:{self.port}"
        self.unix_path = f"/tmp/x_ipc/{self.port}"

    def wait_for_end(self, seconds=None):
        """The exit status of a central that is meant to end by itself."""
        self._stopped = True
        return self.wait(seconds)

    def stop_quietly(self):
        """Ends central, which may have ended already as the test wanted."""
        self._stopped = True
        super().stop()

    def stop(self):
        """Ends central; complains if it had ended by itself."""
        ended = not self._stopped and not self.alive()
        self._stopped = True
        super().stop()
        assert not ended, f"{self} had ended with {self.process.returncode}:\n{self._tail()}"


class Compiler:
    """Compiles C programs that use a libipc."""

    def __init__(self, directory, include_directories):
        self.directory = directory
        self.includes = include_directories
        self.command = os.environ.get("CC") or shutil.which("cc") or shutil.which("gcc")

    def program(self, sources, library, *, name=None, includes=(), flags=()):
        """Path of the program made from the sources and linked with the library."""
        sources = [sources] if isinstance(sources, (str, os.PathLike)) else list(sources)
        name = name or os.path.splitext(os.path.basename(sources[0]))[0]
        place = zlib.crc32("\n".join([os.path.abspath(sources[0]), *includes]).encode())
        target = os.path.join(self.directory, f"{name}-{library.kind}-{place:x}")
        if os.path.exists(target):
            return target
        command = [self.command, "-g", "-o", target, *map(str, sources), *flags,
                   *(f"-I{path}" for path in (*includes, *self.includes)),
                   f"-L{library.directory}", f"-Wl,-rpath,{library.directory}", "-l:libipc.so.1",
                   *library.link_flags, "-lm", "-lpthread"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60 * SLOW,
                              check=False)
        assert done.returncode == 0, f"{' '.join(command)}\n{done.stderr}"
        return target


class Library:
    """A directory with a libipc.so.1."""

    def __init__(self, kind, directory):
        self.kind, self.directory = kind, os.path.abspath(directory)
        self.path = os.path.join(self.directory, "libipc.so.1")
        with open(self.path, "rb") as file:
            image = file.read()
        self.link_flags = []
        if b"__asan_init" in image:
            self.link_flags.append("-fsanitize=address")
        if b"__ubsan_handle" in image:
            self.link_flags.append("-fsanitize=undefined")
        self.original = b"x_ipc_gM_ptr" in image

    def environment(self):
        """Makes a program use this library, whatever library it was linked with."""
        return {"LD_LIBRARY_PATH": self.directory}
