"""Many modules at once, made by hand with as few bytes as a module needs."""
import contextlib
import resource
import selectors
import socket
import time

from support import codec
from support.frame import Frame, QUERY
from support.peer import Peer
from support.waiting import TimedOut

PRELUDE = 137  # bytes
ANSWERS = 28 + 12 + 28 + 4  # ... to an introduction and to the wish to start


def raise_descriptors(count):
    """Allows this process, and those that it starts, so many descriptors; whether that works."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < count:
        return False
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, count), hard))
    return True


def _handshake(central):
    """What a module says in its shortest handshake."""
    with Peer(central, "PATTERN") as pattern:
        pattern.read_prelude()
        introduction, ready = (pattern.id_of(name) for name in ("x_ipc_newModuleConnectMsg",
                                                                "x_ipc_waitMsg"))
    return (Frame(QUERY, introduction, codec.encode("{string, string}", ("CROWD", "host")),
                  reference=1).pack() + Frame(QUERY, ready, reference=2).pack())


def connect_at_once(central, count, seconds):
    """Begins so many connections before any of them goes on; returns when all are in."""
    said = _handshake(central)
    left = {}
    with selectors.DefaultSelector() as selector, contextlib.ExitStack() as stack:
        for _ in range(count):
            connection = stack.enter_context(socket.socket())
            connection.setblocking(False)
            connection.connect_ex(("127.0.0.1", central.port))
            selector.register(connection, selectors.EVENT_READ)
            left[connection] = [PRELUDE, ANSWERS]
        end = time.monotonic() + seconds
        while left:
            ready = selector.select(max(0, end - time.monotonic()))
            if not ready:
                raise TimedOut(f"{len(left)} of {count} modules do not get in")
            for connection in (key.fileobj for key, _ in ready):
                _go_on(connection, left, said)
                if connection not in left:
                    selector.unregister(connection)


def _go_on(connection, left, said):
    """Takes what has come; answers the prelude."""
    data = connection.recv(4096)
    assert data, "a connection was closed"
    left[connection][0] -= len(data)
    if left[connection][0] <= 0:
        if len(left[connection]) == 2:
            connection.send(said)
            del left[connection][0]
        else:
            del left[connection]
