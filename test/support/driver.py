"""The other side of module_driver.c: plays a module that is built on a libipc."""
import os
import subprocess
import urllib.parse

from support.processes import Process
from support.waiting import Deadline, PATIENCE, TimedOut

SOURCE = os.path.join(os.path.dirname(__file__), "module_driver.c")
NAMED_HOST = os.path.join(os.path.dirname(__file__), "named_host.c")
FLAGS = ["-std=c99", "-D_POSIX_C_SOURCE=200809L"]

ERRORS = ("No_Error", "Not_Connected", "Not_Initialized", "Message_Not_Defined",
          "Not_Fixed_Length", "Message_Lengths_Differ", "Argument_Out_Of_Range",
          "Null_Argument", "Illegal_Formatter", "Mismatched_Formatter", "Wrong_Buffer_Length",
          "Communication_Error")


class Ended(AssertionError):
    """The module has ended instead of answering."""


def _word(value):
    if value is None:
        return "-"
    text = value.decode("latin-1") if isinstance(value, bytes) else str(value)
    if text == "":
        return "%00"
    return urllib.parse.quote(text, safe="{}<>[]:,*!/.+_-()=#", encoding="latin-1") \
        if text != "-" else "%2d"


class Answer:
    """What a command has brought: events that handlers printed meanwhile, and the result."""

    def __init__(self, events, result):
        self.events, self.result = events, result

    @property
    def error(self):
        """Name of the IPC_errno after a failure."""
        word, _, number = self.result.partition(" ")
        return ERRORS[int(number)] if word == "Error" else None

    @property
    def reply(self):
        """What follows OK."""
        return urllib.parse.unquote(self.result.removeprefix("OK").strip(), encoding="latin-1")


class Driver(Process):
    """A running module."""

    def __init__(self, program, library=None, *, name="DRIVER", env=None):
        environment = dict(env or {})
        if library:
            environment.update(library.environment())
        super().__init__([program], stdin=subprocess.PIPE, env=environment)
        self.name = name
        self._read_lines = 0
        self._unread = []
        self._gathered = 0

    def __str__(self):
        return f"{self.name} ({self.pid})"

    def start(self, command, *words):
        """Sends a command without waiting for its result."""
        line = " ".join([command, *map(_word, words)]) + "\n"
        try:
            self.process.stdin.write(line.encode("latin-1"))
            self.process.stdin.flush()
        except BrokenPipeError:
            pass

    def finish(self, seconds=None):
        """The answer to the oldest command that has none yet."""
        deadline = Deadline(seconds)
        events = []
        with self._news:
            while True:
                while self._read_lines < len(self.stdout):
                    line = self.stdout[self._read_lines]
                    self._read_lines += 1
                    if line.startswith("= "):
                        self._unread += events
                        return Answer(events, line[2:])
                    if line.startswith("@ "):
                        events.append(line[2:])
                if not self._open:
                    raise Ended(f"{self} ended with {self.process.wait()}:\n{self._tail()}")
                if not self._news.wait(deadline.left()):
                    raise TimedOut(f"{self} does not answer:\n{self._tail()}")

    def do(self, command, *words, seconds=None):
        """Carries out a command and returns its answer."""
        self.start(command, *words)
        return self.finish(PATIENCE if seconds is None else seconds)

    def must(self, command, *words, seconds=None):
        """As do(), for a command that has to succeed."""
        answer = self.do(command, *words, seconds=seconds)
        assert answer.result.split()[0] == "OK", \
            f"{self}: {command} {words} gave {answer.result} {answer.error}\n{self._tail()}"
        return answer

    def until(self, count, seconds=None):
        """Listens until count events in all have been handled; returns the new ones."""
        seconds = PATIENCE if seconds is None else seconds
        answer = self.do("until", count, int(seconds * 1000), seconds=seconds + PATIENCE)
        assert answer.result == "OK", \
            f"{self} waited in vain for {count} events, saw {answer.events}\n{self._tail()}"
        return answer.events

    def listen_for(self, count, seconds=None):
        """Listens until count more events have been handled; returns them."""
        return self.until(int(self.do("events").result) + count, seconds)

    def gather(self, count, seconds=None):
        """Listens until count events more than have been gathered before have been handled;
        returns them.

        Unlike listen_for() it counts events that were handled during other commands, as originals
        do.
        """
        self._gathered += count
        self.until(self._gathered, seconds)
        events, self._unread = self._unread, []
        return events

    def connect(self, address, *, listen=True, verbosity=1):
        """Connects under the driver's name to a central, given by its address."""
        self.must("verbosity", verbosity)
        self.must("connect" if listen else "connect_no_listen", self.name, address)
        return self

    def leave(self):
        """Disconnects and ends; returns the exit status."""
        self.start("quit")
        self.close_stdin()
        return self.wait()

    def stop(self):
        self.close_stdin()
        super().stop()


def messages_in(events):
    """(handler, message name, content bytes) of the events of raw handlers."""
    found = []
    for event in events:
        kind, *rest = event.split(" ")
        if kind == "message":
            handler, name, _, content = (rest + [""])[:4]
            found.append((int(handler), urllib.parse.unquote(name, encoding="latin-1"),
                          bytes.fromhex(content)))
    return found


def texts_in(events):
    """The contents, as text, of the events of raw handlers."""
    return [content.rstrip(b"\0").decode("latin-1") for _, _, content in messages_in(events)]


def data_in(events):
    """What handlers of data have printed."""
    return [event.split(" ", 3)[3] for event in events if event.startswith("data ")]


def replies_in(events):
    """(tag, message name, printed reply) of the events of reply handlers."""
    return [tuple(event.split(" ", 3)[1:]) for event in events if event.startswith("reply ")]
