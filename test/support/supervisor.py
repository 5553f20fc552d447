"""What starts and watches a server: hands over sockets, hears how it is, by the protocols of
systemd."""
import os
import socket

from support.waiting import Deadline, PATIENCE, TimedOut

#: Starts the program under test as a supervisor does: see there.
HAND_OVER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "hand_over.py")


class Supervisor:
    """Sockets for a server, and the place where it tells its states."""

    def __init__(self, directory):
        self.path = os.path.join(directory, "notify")
        self.notices = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.notices.bind(self.path)
        self.handed_over = []
        self.names = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for held in (self.notices, *self.handed_over):
            held.close()

    def listen(self, name="", *, tcp=None, path=None):
        """Opens a socket that the server is to take over."""
        if path is None:
            opened = socket.create_server(("127.0.0.1", 0 if tcp is None else tcp))
        else:
            opened = socket.socket(socket.AF_UNIX)
            opened.bind(path)
            opened.listen()
        return self.hand_over(opened, name)

    def hand_over(self, opened, name=""):
        self.handed_over.append(opened)
        self.names.append(name)
        return opened

    def popen(self, program, **variables):
        """What a server has to be started with, besides HAND_OVER as its program."""
        descriptors = [held.fileno() for held in self.handed_over]
        env = {"NOTIFY_SOCKET": self.path, "HAND_OVER_TO": program,
               "HAND_OVER_DESCRIPTORS": " ".join(map(str, descriptors)),
               "LISTEN_FDNAMES": ":".join(self.names), **variables}
        return {"env": env, "pass_fds": descriptors}

    def next_notice(self, seconds=None):
        """What the server tells next."""
        self.notices.settimeout(PATIENCE if seconds is None else max(seconds, 0.001))
        try:
            return self.notices.recv(4096).decode().splitlines()
        except TimeoutError:
            raise TimedOut("the server tells nothing") from None

    def wait_for(self, line):
        """Waits until the server tells that line; returns what it has told before."""
        deadline = Deadline()
        before = []
        while line not in (notice := self.next_notice(deadline.left())):
            before.append(notice)
        return before
