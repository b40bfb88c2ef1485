"""Calls are read from the bytes of both ends, however they come: cut anywhere, compressed, cancelled, hostile."""

from __future__ import annotations

import gzip
import random
import zlib
from collections.abc import Iterator

import grpc
import pytest
from hpack import Encoder
from hyperframe.frame import ContinuationFrame, DataFrame, Frame, GoAwayFrame, HeadersFrame, RstStreamFrame
from relay import METHODS, WAIT, Relay

from missionfsm.adapters.grpc import control
from missionfsm.adapters.grpc.authority import Renamed
from missionfsm.adapters.grpc.descriptors import encode, path
from missionfsm.adapters.grpc.framing import MAX_MESSAGE_BYTES
from missionfsm.adapters.grpc.http2 import PREFACE, Direction, Headers
from missionfsm.adapters.grpc.overheard import Chunk, Connection, End, Line, Overheard
from missionfsm.app.serve import serve
from missionfsm.kernel.codec import JSON, UnreadableError

NAVIGATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
CREATE, SUBSCRIBE = METHODS["CreateMission"], METHODS["SubscribeMissionStatus"]
ASKED = encode(CREATE.request, NAVIGATE)
ANSWERED = encode(CREATE.response, {"missionId": "m"})
CALLED = {"call": 1, "method": "CreateMission", "params": NAVIGATE}


def prefixed(message: bytes, *, compressed: bool = False) -> bytes:
    """A message as gRPC sends it."""
    return bytes([compressed]) + len(message).to_bytes(4, "big") + message


class Wire:
    """Two ends of a connection, written by hand."""

    def __init__(self) -> None:
        self.overheard = Overheard("bear.mission")
        self._encoders = {end: Encoder() for end in End}
        self.lines = self.came(End.CLIENT, PREFACE)

    def came(self, end: End, data: bytes) -> list[Line]:
        found = self.overheard(Chunk(0.0, Connection(1), end, data))
        return [{key: value for key, value in line.items() if key != "at"} for line in found]

    def sent(self, end: End, *frames: Frame) -> list[Line]:
        """The lines that frames make, which come together."""
        return self.came(end, b"".join(frame.serialize() for frame in frames))

    def headers(self, end: End, stream: int, fields: dict[str, str], *flags: str) -> HeadersFrame:
        return HeadersFrame(stream, self._encoders[end].encode(fields), flags=("END_HEADERS", *flags))

    def asks(self, stream: int = 1, name: str = "CreateMission", **more: str) -> HeadersFrame:
        fields = {key.replace("_", "-"): value for key, value in more.items()}
        return self.headers(End.CLIENT, stream, {":method": "POST", ":path": path(METHODS[name]), **fields})

    def asked(self, stream: int = 1, name: str = "CreateMission", message: bytes = ASKED) -> list[Line]:
        """A whole request."""
        data = DataFrame(stream, prefixed(message), flags=("END_STREAM",))
        return self.sent(End.CLIENT, self.asks(stream, name), data)

    def begins(self, stream: int = 1, **more: str) -> HeadersFrame:
        fields = {key.replace("_", "-"): value for key, value in more.items()}
        return self.headers(End.ROBOT, stream, {":status": "200", **fields})

    def ends(self, stream: int = 1, status: int = 0, message: str = "") -> HeadersFrame:
        return self.headers(End.ROBOT, stream, {"grpc-status": str(status), "grpc-message": message}, "END_STREAM")


@pytest.fixture
def wire() -> Wire:
    return Wire()


def test_a_call_is_noted_when_its_request_is_whole_and_its_answer_when_it_has_ended(wire: Wire) -> None:
    """Headers alone make no line, nor does an answer without its trailers."""
    whole = prefixed(ASKED)
    assert wire.sent(End.CLIENT, wire.asks(), DataFrame(1, whole[:7])) == []
    assert wire.sent(End.CLIENT, DataFrame(1, whole[7:], flags=("END_STREAM",))) == [CALLED]
    assert wire.sent(End.ROBOT, wire.begins(), DataFrame(1, prefixed(ANSWERED))) == []
    assert wire.sent(End.ROBOT, wire.ends()) == [{"return": 1, "result": {"missionId": "m"}}]


def test_headers_may_come_in_pieces_and_frames_may_be_padded(wire: Wire) -> None:
    """Continuations and padding are what HTTP/2 allows, and change nothing."""
    headers = wire.asks()
    first = HeadersFrame(1, headers.data[:4], pad_length=3, flags=("PADDED",))
    second = ContinuationFrame(1, headers.data[4:], flags=("END_HEADERS",))
    data = DataFrame(1, prefixed(ASKED), pad_length=9, flags=("PADDED", "END_STREAM"))
    assert wire.sent(End.CLIENT, first, second, data) == [CALLED]


@pytest.mark.parametrize(("encoding", "encoded"), [("gzip", gzip.compress), ("deflate", zlib.compress)])
def test_compressed_messages_are_read(wire: Wire, encoding: str, encoded: object) -> None:
    """Either direction may say that it compresses, and how; messages that say nothing of it are as they are."""
    assert callable(encoded)
    data = DataFrame(1, prefixed(encoded(ASKED), compressed=True))
    assert wire.sent(End.CLIENT, wire.asks(grpc_encoding=encoding), data) == [CALLED]
    answer = DataFrame(1, prefixed(encoded(ANSWERED), compressed=True))
    ended = wire.sent(End.ROBOT, wire.begins(grpc_encoding=encoding), answer, wire.ends())
    assert ended == [{"return": 1, "result": {"missionId": "m"}}]


def test_what_says_that_it_is_compressed_and_is_not_is_malformed(wire: Wire) -> None:
    """Rubbish and what grows beyond all bounds are texts in the history, as other malformed messages are."""
    bomb = gzip.compress(bytes(MAX_MESSAGE_BYTES + 1))
    for stream, message, why in ((1, b"rubbish", "no gzip"), (3, bomb, f"longer than {MAX_MESSAGE_BYTES:,} bytes")):
        data = DataFrame(stream, prefixed(message, compressed=True))
        (line,) = wire.sent(End.CLIENT, wire.asks(stream, grpc_encoding="gzip"), data)
        assert line["params"] == f"(malformed: {why})"


def test_a_message_that_is_too_long_is_passed_over(wire: Wire) -> None:
    """Of a message that no server takes the length is noted, and what follows is read."""
    length = MAX_MESSAGE_BYTES + 1
    data = bytes([0]) + length.to_bytes(4, "big")
    (line,) = wire.sent(End.CLIENT, wire.asks(), DataFrame(1, data))
    assert line["params"] == f"(malformed: longer than {MAX_MESSAGE_BYTES:,} bytes)"
    part = DataFrame(1, bytes(1024 * 1024)).serialize()
    assert all(wire.came(End.CLIENT, part) == [] for _ in range(length // (1024 * 1024) + 1))
    assert wire.asked(3) == [{**CALLED, "call": 2}]


def test_an_encoding_that_nobody_knows_ends_the_record(wire: Wire) -> None:
    """A history with a hole would be judged wrong, so that there is none: nothing more is noted."""
    with pytest.raises(UnreadableError, match="a message is encoded as snappy, which is not read"):
        wire.sent(End.CLIENT, wire.asks(grpc_encoding="snappy"), DataFrame(1, prefixed(b"x", compressed=True)))


def test_a_subscription_begins_with_its_first_bytes_unless_they_refuse_it(wire: Wire) -> None:
    """Initial metadata begin a stream; with a refusal in the same breath there is none."""
    wire.asked(1, "SubscribeMissionStatus", b"")
    assert wire.sent(End.ROBOT, wire.begins()) == [{"return": 1, "result": {"stream": 1}}]
    assert wire.sent(End.ROBOT, wire.ends(message="all%20over")) == [{"stream": 1, "closed": True}]
    wire.asked(3, "SubscribeMissionStatus", b"")
    refused = {"return": 2, "error": {"status": "PERMISSION_DENIED", "message": "not yours"}}
    assert wire.sent(End.ROBOT, wire.begins(3), wire.ends(3, 7, "not%20yours")) == [refused]


def test_a_client_that_gives_up_cancels_its_stream_and_leaves_its_call_open(wire: Wire) -> None:
    """RST_STREAM of a client is a cancel of a stream; a call stays without an answer."""
    wire.asked(1, "SubscribeMissionStatus", b"")
    wire.sent(End.ROBOT, wire.begins())
    wire.asked(3)
    assert wire.sent(End.CLIENT, RstStreamFrame(1, 8), RstStreamFrame(3, 8)) == [
        {"call": 3, "method": "cancel", "params": {"stream": 1}},
        {"return": 3, "result": {}},
    ]
    assert wire.sent(End.ROBOT, wire.ends(1), wire.ends(3, 4)) == []


def test_what_the_robot_resets_or_leaves_undone_leaves_open_what_became_of_it(wire: Wire) -> None:
    """A refused stream is UNAVAILABLE to clients; of other resets and of GOAWAY a call has no answer in the history."""
    for stream in (1, 3, 5):
        wire.asked(stream)
    assert wire.sent(End.ROBOT, GoAwayFrame(last_stream_id=3), RstStreamFrame(1, 7), RstStreamFrame(3, 2)) == [
        {"return": 1, "error": {"status": "UNAVAILABLE", "message": ""}}
    ]


def test_a_robot_that_is_gone_is_unavailable_to_all_that_was_asked(wire: Wire) -> None:
    """Streams end with UNAVAILABLE and calls are answered so, as clients see it; then the connection is forgotten."""
    wire.asked(1, "SubscribeMissionStatus", b"")
    wire.sent(End.ROBOT, wire.begins())
    wire.asked(3)
    error = {"status": "UNAVAILABLE", "message": "the robot is gone"}
    assert wire.came(End.ROBOT, b"") == [{"stream": 1, "closed": True, "error": error}, {"return": 2, "error": error}]
    assert wire.came(End.CLIENT, b"") == []
    assert wire.overheard._connections == {}


def test_an_answer_that_is_none_of_grpc_is_what_clients_make_of_it(wire: Wire) -> None:
    """A gateway's 503 is UNAVAILABLE; one that says that the call is none of gRPC leaves it without an answer."""
    wire.asked(1)
    assert wire.sent(End.ROBOT, wire.headers(End.ROBOT, 1, {":status": "503"}, "END_STREAM")) == [
        {"return": 1, "error": {"status": "UNAVAILABLE", "message": ""}}
    ]
    wire.asked(3)
    page = DataFrame(3, b"<html>", flags=("END_STREAM",))
    assert wire.sent(End.ROBOT, wire.headers(End.ROBOT, 3, {":status": "500"}), page) == [
        {"return": 2, "error": {"status": "UNKNOWN", "message": ""}}
    ]


def test_a_call_that_could_not_be_read_and_is_answered_ends_the_record(wire: Wire) -> None:
    """Rubbish of a client is refused by the robot and no matter; if it is answered, the history has a hole."""
    wire.asked(1)
    assert wire.came(End.CLIENT, b"\x00\x00\x01\x09" + bytes(20)) == []
    assert wire.sent(End.ROBOT, wire.begins(), DataFrame(1, prefixed(ANSWERED)), wire.ends()) != []
    with pytest.raises(UnreadableError, match="a call is answered that could not be read"):
        wire.sent(End.ROBOT, wire.begins(3))


@pytest.mark.parametrize("first", [b"GET / HTTP/1.1\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00", b"\x00"])
def test_what_is_no_http2_makes_no_line(first: bytes) -> None:
    """HTTP/1, TLS where there is none, and zeros are passed on and not read."""
    overheard = Overheard("bear.mission")
    assert overheard(Chunk(0.0, Connection(1), End.CLIENT, first)) == []
    assert overheard(Chunk(0.0, Connection(1), End.ROBOT, b"HTTP/1.1 400 Bad Request\r\n\r\n")) == []


def test_no_bytes_make_the_reader_fail() -> None:
    """Whatever either end sends, mutated or random, makes lines, no line, or an end of the record."""
    draw = random.Random(1)
    good = Wire()
    client = b"".join(
        frame.serialize() for frame in (good.asks(), DataFrame(1, prefixed(ASKED), flags=("END_STREAM",)))
    )
    robot = b"".join(frame.serialize() for frame in (good.begins(), DataFrame(1, prefixed(ANSWERED)), good.ends()))
    whole = 0
    for _ in range(1_000):
        wire = Wire()
        try:
            lines = [*wire.came(End.CLIENT, mutated(client, draw)), *wire.came(End.ROBOT, mutated(robot, draw))]
            whole += len(lines) == 2
        except UnreadableError:
            continue
    assert 0 < whole < 1_000


def mutated(data: bytes, draw: random.Random) -> bytes:
    """Some bytes of it changed, doubled or gone."""
    found = bytearray(data)
    for _ in range(draw.randrange(4)):
        at = draw.randrange(len(found))
        found[at : at + draw.randrange(3)] = draw.randbytes(draw.randrange(4))
    return bytes(found)


@pytest.fixture(scope="module")
def conversation() -> list[Chunk]:
    """The bytes of calls, of a refusal and of a stream of a real client and a real server."""
    with serve("bear.mission") as robot:
        relay = Relay(robot.target, lambda _: None)
        stream = relay.channel.unary_stream(path(SUBSCRIBE))(b"", compression=grpc.Compression.Gzip)
        next(stream)
        relay.call("CreateMission", NAVIGATE, compression=grpc.Compression.Gzip)
        with pytest.raises(grpc.RpcError):
            relay.call("CreateMission", NAVIGATE, timeout=WAIT)
        next(stream)
        stream.cancel()
        relay.close()
    return relay.chunks


def test_lines_are_the_same_however_the_bytes_are_cut(conversation: list[Chunk]) -> None:
    """What a real client and a real server said gives the same lines byte by byte."""
    found = []
    for cut in (lambda chunk: [chunk], lambda chunk: list(by_byte(chunk))):
        overheard = Overheard("bear.mission")
        found.append([line for chunk in conversation for part in cut(chunk) for line in overheard(part)])
    assert found[0] == found[1]
    assert [next(iter(line)) for line in found[0]].count("return") == 4


def by_byte(chunk: Chunk) -> Iterator[Chunk]:
    for at in range(max(1, len(chunk.data))):
        yield Chunk(chunk.at, chunk.connection, chunk.end, chunk.data[at : at + 1])


def test_another_name_is_put_into_every_call_and_all_else_stays(conversation: list[Chunk]) -> None:
    """Of what a real client sent only ``:authority`` is another, also where headers go beyond a frame."""
    sent = b"".join(chunk.data for chunk in conversation if chunk.end is End.CLIENT)
    sent += HeadersFrame(
        99, Encoder().encode({":authority": "a", "x": "y" * 40_000}), flags=("END_HEADERS",)
    ).serialize()
    renamed, direct, changed = Renamed("robot:443"), Direction(preface=True), Direction(preface=True)
    direct.allow_table(1 << 20)
    before = list(direct.read(sent))
    after = list(changed.read(b"".join(renamed(sent[at : at + 7]) for at in range(0, len(sent), 7))))
    expected = [
        Headers(one.stream, {**one.fields, b":authority": b"robot:443"}, one.ends) if isinstance(one, Headers) else one
        for one in before
    ]
    assert after == expected
    assert sum(isinstance(one, Headers) for one in before) == 4
    with pytest.raises(ValueError, match="no HTTP/2"):
        Renamed("robot:443")(PREFACE + ContinuationFrame(1, b"", flags=("END_HEADERS",)).serialize())


SUBSCRIBED = encode(SUBSCRIBE.request, {})
NOTHING = {"missionStates": {"currentMissionIndex": -1}}


def steers(wire: Wire, stream: int, name: str, params: JSON) -> list[Line]:
    """The control service is asked for something."""
    headers = wire.headers(End.CLIENT, stream, {":method": "POST", ":path": f"/{control.SERVICE}/{name}"})
    return wire.sent(End.CLIENT, headers, DataFrame(stream, prefixed(control.pack(params)), flags=("END_STREAM",)))


def steered(wire: Wire, stream: int, result: JSON) -> list[Line]:
    """The control service answers."""
    return wire.sent(
        End.ROBOT, wire.begins(stream), DataFrame(stream, prefixed(control.pack(result))), wire.ends(stream)
    )


def shows(wire: Wire, stream: int) -> list[Line]:
    """A subscriber is shown that there is nothing."""
    return wire.sent(End.ROBOT, DataFrame(stream, prefixed(encode(SUBSCRIBE.response, NOTHING))))


def test_a_drive_stands_where_it_was_asked_for(wire: Wire) -> None:
    """What it causes may come before its answer, and is a line behind it; one that did not happen is none."""
    wire.asked(1, "SubscribeMissionStatus", SUBSCRIBED)
    wire.sent(End.ROBOT, wire.begins(1))
    message = {"stream": 1, "message": NOTHING}
    assert steers(wire, 3, "Drive", {"event": "goalReached"}) == []
    assert shows(wire, 1) == []
    assert steered(wire, 3, {"happened": True}) == [{"drive": {"event": "goalReached"}}, message]
    assert steers(wire, 5, "Drive", {"event": "goalReached"}) == []
    assert shows(wire, 1) == []
    assert steered(wire, 5, {"happened": False}) == [message]
    assert shows(wire, 1) == [message]


def test_a_reset_begins_another_conversation(wire: Wire) -> None:
    """It has the world that was asked for and the drives of the service; what was under way before is forgotten."""
    first = {"missionfsm": 1, "system": "bear.mission", "world": {"family": "carti"}, "drives": ["world"]}
    steers(wire, 1, "Describe", {})
    steered(wire, 1, {"system": "bear.mission", "drives": ["world"]})
    wire.asked(3, "SubscribeMissionStatus", SUBSCRIBED)
    wire.sent(End.ROBOT, wire.begins(3))
    wire.asked(5)
    assert steers(wire, 7, "Reset", {"world": {"family": "carti"}}) == []
    assert shows(wire, 3) == []
    assert steered(wire, 7, {}) == [first]
    assert shows(wire, 3) == []
    assert wire.sent(End.ROBOT, wire.ends(5, 9)) == []
    assert wire.asked(9) == [{**CALLED, "call": 3}]


def test_a_reset_that_is_refused_changes_nothing(wire: Wire) -> None:
    """The conversation goes on, with what came meanwhile."""
    assert steers(wire, 1, "Reset", {"world": {"family": "none"}}) == []
    assert wire.asked(3) == []
    assert wire.sent(End.ROBOT, wire.ends(1, 3, "no such family")) == [CALLED]


@pytest.mark.parametrize("status", [4, 14])
def test_a_drive_of_which_nobody_knows_ends_the_record(wire: Wire, status: int) -> None:
    """Where the service does not say whether it happened, what follows cannot be judged."""
    steers(wire, 1, "Drive", {"event": "goalReached"})
    with pytest.raises(UnreadableError, match="nobody knows what became of a Drive"):
        wire.sent(End.ROBOT, wire.ends(1, status))
