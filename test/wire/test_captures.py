"""The recordings of original programs, and the tests' own codec judged by them."""
import pytest

from support import captures, codec, messages
from support.central_replay import Replay
from support.frame import BROADCAST, INFORM, IS_REPLY, QUERY
from support.peer import LOOK_UP, Peer

REPLAYED = [name for name in captures.names()]
DIRECT = ("04-query-direct.txt", "05-direct-tcp.txt")


@pytest.fixture(scope="module")
def recorded():
    """All captures by name."""
    return {name: captures.Capture(name) for name in captures.names()}


@pytest.mark.parametrize("name", captures.names())
def test_every_recorded_frame_is_packed_again_to_the_same_bytes(name, recorded):
    """Requirement 5: header of seven big-endian numbers, class data before data."""
    raw = {}
    with open(f"{captures.DIRECTORY}/{name}", encoding="utf-8") as file:
        for tag, direction, text in recorded[name]._records(file):
            if direction in "<>":
                raw[tag, direction] = raw.get((tag, direction), b"") + bytes.fromhex(
                    "".join(text.split()))
    for (tag, direction), stream in raw.items():
        lines = [line for line in recorded[name].of(tag) if line.direction == direction]
        packed = b"".join(line.frame.pack() for line in lines if line.kind == "frame")
        prelude = any(line.kind == "prelude" for line in lines)
        assert packed == stream[4 if prelude else 0:], f"{tag} {direction}"


@pytest.mark.parametrize("name", captures.names())
def test_every_recorded_library_message_decodes_and_encodes_to_the_same_bytes(name, recorded):
    """Requirements 5, 7, 9: the tests' codec agrees with the original in both byte orders."""
    checked = 0
    for tag in recorded[name].connections:
        names, requests = {}, {}
        for line in recorded[name].of(tag):
            if line.kind == "prelude":
                names[line.value] = LOOK_UP
            if line.kind != "frame" or recorded[name].connections[tag].direct:
                continue
            frame, fmt = line.frame, None
            if frame.cls in (QUERY, INFORM, BROADCAST) and line.direction == ">":
                message = messages.find(names[abs(frame.intent)])
                requests[frame.reference] = message
                fmt = message.request if message else None
            elif frame.intent == IS_REPLY and frame.cls == 0:
                message = requests[frame.reference]
                fmt = message.reply
                if message.name == LOOK_UP:
                    found = codec.decode(fmt, frame.data, frame.order)
                    names.update({abs(found[0]): found[1]} if found else {})
            if fmt and frame.data:
                value = codec.decode(fmt, frame.data, frame.order)
                assert codec.encode(fmt, value, frame.order) == frame.data
                checked += 1
    assert checked > 25


@pytest.mark.parametrize("name", REPLAYED)
def test_central_answers_recorded_modules_as_the_original_did(name, recorded, start_central):
    """Requirements 5, 10-12, 17-25, 27-37, 43-47 (and 38-41 seen from central): plays the
    modules' side of a recording against the central under test and compares every frame that it
    sends."""
    ports = {c.port for c in recorded[name].connections.values() if not c.direct}
    options = ["-c"] if name in DIRECT else []
    centrals = [start_central(*options) for _ in ports]
    compared = Replay(recorded[name], centrals).run()
    assert compared >= 25


@pytest.mark.parametrize("piece", [1, 7])
def test_central_understands_a_recording_that_arrives_in_pieces(piece, recorded, central):
    """Requirement 6: frames may arrive in pieces of any size."""
    assert Replay(recorded["03-query-routed.txt"], [central], piece=piece).run() > 50


def test_central_understands_a_recording_that_arrives_all_at_once(recorded, central):
    """Requirement 6: any number of frames may arrive at once, and each request is answered."""
    capture = recorded["12-resubscribe.txt"]
    with Peer(central, "ONE") as peer:
        peer.read_prelude()
        names, stream, asked = {}, [], []
        for line in capture.of("O"):
            if line.kind == "prelude":
                names[line.value] = LOOK_UP
            elif line.kind == "frame" and line.direction == "<" and line.frame.intent == IS_REPLY:
                if line.frame.reference in asked and len(line.frame.data) > 20:
                    try:
                        found = codec.decode(messages.MESSAGE_INFO, line.frame.data)
                        names[found[0]] = found[1]
                    except (codec.Malformed, TypeError):
                        pass
            elif line.kind == "frame" and line.direction == ">" and line.frame.dispatch == -1:
                name = names[line.frame.intent]
                if name in ("M1", "x_ipc_CloseMsg"):
                    continue
                line.frame.intent = peer.id_of(name)
                line.frame.reference += 5000
                stream.append(line.frame.pack())
                asked += [line.frame.reference - 5000] if line.frame.cls == QUERY else []
        peer.send_bytes(b"".join(stream))
        for reference in asked:
            peer.await_reply(reference + 5000)
    assert len(asked) > 20
