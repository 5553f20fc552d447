"""The recorded traffic of original programs: reads the capture files and cuts them into frames."""
import dataclasses
import os
import struct

from support.frame import Cutter, Frame

DIRECTORY = os.path.join(os.path.dirname(os.path.dirname(__file__)), "wire", "captures")


@dataclasses.dataclass
class Line:
    """One thing that happened on one connection.

    kind is "connect", "prelude" (value: the id), "frame", "shutdown" or "close"; direction is ">"
    from the connecting side and "<" to it.
    """

    tag: str
    kind: str
    direction: str = None
    frame: Frame = None
    value: object = None


@dataclasses.dataclass
class Connection:
    tag: str
    module: str
    transport: str
    port: int
    direct: bool
    accepted_by: str  # tag of the module that accepts a direct connection, else None


class Capture:
    """A capture file: its connections, and what happened in order of time."""

    def __init__(self, name):
        self.name = name
        self.connections = {}
        self.lines = []
        self._cutters = {}
        self._greeted = set()
        with open(os.path.join(DIRECTORY, name), encoding="utf-8") as file:
            for record in self._records(file):
                self._take(record)
        assert not any(cutter.buffer for cutter in self._cutters.values()), f"{name}: cut off"

    @staticmethod
    def _records(file):
        """Words of each record; the bytes of continuation lines are joined to the hex of the
        first."""
        record = None
        for line in file:
            text = line.split("#", 1)[0].rstrip()
            if not text:
                continue
            if text[0] in " \t":
                record[2] += text
                continue
            if record:
                yield record
            record = (text.split(None, 2) + ["", ""])[:3]
        if record:
            yield record

    def _take(self, record):
        first, second, rest = record
        if first == "@conn":
            self._declare(second, rest)
        elif second == "!":
            self._event(first, rest)
        else:
            self._bytes(first, second, bytes.fromhex("".join(rest.split())))

    def _declare(self, tag, text):
        # SUB -> central, tcp:127.0.0.1:21001   or   P -> S direct peer=S tcp:127.0.0.1:8000
        words = text.replace(",", " ").split()
        transport, _, address = words[-1].partition(":")
        port = int(address.replace("/", ":").rsplit(":", 1)[1])
        peers = [word.removeprefix("peer=") for word in words if word.startswith("peer=")]
        self.connections[tag] = Connection(tag, words[0], transport, port, "direct" in words,
                                           peers[0] if peers else None)

    def _event(self, tag, text):
        if text.startswith("connects"):
            self.lines.append(Line(tag, "connect"))
        elif "shuts" in text:
            self.lines.append(Line(tag, "shutdown"))
        elif text.startswith("closed"):
            self.lines.append(Line(tag, "close"))

    def _bytes(self, tag, direction, data):
        cutter = self._cutters.setdefault((tag, direction), Cutter())
        cutter.feed(data)
        if direction == "<" and tag not in self._greeted and not self.connections[tag].direct:
            raw = cutter.take(4)
            if raw is None:
                return
            self._greeted.add(tag)
            self.lines.append(Line(tag, "prelude", "<", value=struct.unpack(">i", raw)[0]))
        while (frame := cutter.next()) is not None:
            self.lines.append(Line(tag, "frame", direction, frame))

    def of(self, tag):
        """What happened on one connection."""
        return [line for line in self.lines if line.tag == tag]


def names():
    """File names of all captures."""
    return sorted(name for name in os.listdir(DIRECTORY) if name.endswith(".txt"))
