"""Clients of a proxy that are broken, or mean harm: others are served, and the record stays right."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import ssl

import grpc
import pytest
from grpc import aio
from hpack import Encoder
from hyperframe.frame import DataFrame, HeadersFrame, SettingsFrame
from relay import METHODS, NAVIGATE, WAIT, Relay, eventually

from missionfsm.adapters.grpc.descriptors import encode, path
from missionfsm.adapters.grpc.http2 import PREFACE, Data, Direction, Headers
from missionfsm.adapters.grpc.target import Target
from missionfsm.app.asked import judged_system
from missionfsm.app.serve import Served
from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import check

CREATE, SUBSCRIBE = METHODS["CreateMission"], METHODS["SubscribeMissionStatus"]
HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {}}


def connect(relay: Relay) -> socket.socket:
    found = socket.create_connection(("127.0.0.1", relay.proxy.port))
    found.settimeout(WAIT)
    return found


def conforms(lines: list[JSON]) -> bool:
    verdict = check(judged_system("bear.mission", strict=False), head(HEAD), lines)
    return verdict.violation is None


def test_what_is_no_http2_is_refused_by_the_robot(relay: Relay, lines: list[JSON]) -> None:
    """HTTP/1 and TLS at a plain port end as they do at the robot's own; others are served, and nothing is noted."""
    with connect(relay) as one:
        one.sendall(b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n")
        with contextlib.suppress(ConnectionError):
            while one.recv(4096):
                pass
    context = ssl.create_default_context()
    with connect(relay) as one, pytest.raises(OSError):  # noqa: PT011 - what is said of it differs
        context.wrap_socket(one, server_hostname="localhost")
    assert lines == []
    assert relay.call("CreateMission", NAVIGATE)["missionId"]


def test_connections_that_say_nothing_or_half_of_it_are_forgotten_when_they_go(relay: Relay, lines: list[JSON]) -> None:
    """Silent ones, such as stop in the middle of a frame, and a hundred that come and go hold nobody up."""
    silent = [connect(relay) for _ in range(100)]
    for one in silent[::2]:
        one.sendall(PREFACE[:10])
    for one in silent[1::4]:
        one.sendall(PREFACE + SettingsFrame().serialize() + b"\x00\x00\x50\x01")
    assert relay.call("CreateMission", NAVIGATE)["missionId"]
    assert eventually(lambda: len(relay.proxy._pairs) == 101)
    for one in silent:
        one.close()
    assert eventually(lambda: len(relay.proxy._pairs) == 1)
    assert len(lines) == 2


def test_a_request_of_ten_megabytes_is_refused_as_the_robot_does(
    relay: Relay, robot: Served, lines: list[JSON]
) -> None:
    """It is RESOURCE_EXHAUSTED with the proxy as without, others are served, and the record conforms."""
    found = []
    for target in (robot.target, f"localhost:{relay.proxy.port}"):
        with grpc.insecure_channel(target) as channel, pytest.raises(grpc.RpcError) as refused:
            channel.unary_unary(path(CREATE))(bytes(10 * 1024 * 1024), timeout=WAIT)
        found.append(refused.value.code())
    assert found == [grpc.StatusCode.RESOURCE_EXHAUSTED] * 2
    assert relay.call("CreateMission", NAVIGATE)["missionId"]
    assert conforms(lines)


def test_a_subscriber_who_does_not_read_holds_nobody_up(relay: Relay, lines: list[JSON]) -> None:
    """One takes no bytes of any stream: another sees all messages meanwhile, and calls are answered."""
    with connect(relay) as one:
        one.sendall(asks("SubscribeMissionStatus", settings={SettingsFrame.INITIAL_WINDOW_SIZE: 0}))
        stream = relay.channel.unary_stream(path(SUBSCRIBE))(b"", timeout=WAIT)
        next(stream)
        relay.call("CreateMission", NAVIGATE)
        for _ in range(30):
            relay.call("AppendMission", NAVIGATE)
        assert len([next(stream) for _ in range(31)]) == 31
    assert eventually(lambda: any(line.get("method") == "cancel" for line in lines))
    assert len({line["stream"] for line in lines if "message" in line}) == 1
    assert conforms(lines)


def asks(
    name: str, message: bytes = b"", kind: str = "application/grpc", settings: dict[int, int] | None = None
) -> bytes:
    """A client's first bytes, up to its only request."""
    fields = {":method": "POST", ":scheme": "http", ":path": path(METHODS[name]), ":authority": "robot"}
    headers = Encoder().encode({**fields, "te": "trailers", "content-type": kind})
    data = b"\x00" + len(message).to_bytes(4, "big") + message
    frames = (
        SettingsFrame(settings=settings or {}),
        HeadersFrame(1, headers, flags=("END_HEADERS",)),
        DataFrame(1, data, flags=("END_STREAM",)),
    )
    return PREFACE + b"".join(frame.serialize() for frame in frames)


@pytest.mark.parametrize("kind", ["text/html", "application/json", "application/grpc+json", ""])
def test_another_content_type_is_the_robots_business(relay: Relay, lines: list[JSON], kind: str) -> None:
    """What the robot makes of it comes back, and if that was a call, its effect is in the record."""
    with connect(relay) as one:
        one.sendall(asks("CreateMission", encode(CREATE.request, NAVIGATE), kind))
        robot, ended = Direction(preface=False), False
        while not ended and (data := one.recv(4096)):
            ended = any(event.ends for event in robot.read(data) if isinstance(event, Headers | Data))
    with contextlib.suppress(grpc.RpcError):
        relay.call("AppendMission", NAVIGATE)
    assert eventually(lambda: sum("return" in line for line in lines) >= 1)
    assert conforms(lines)


@pytest.mark.long
def test_a_thousand_streams_pass_and_are_given_up(relay: Relay, robot: Served, lines: list[JSON]) -> None:
    """Every one is noted, sees the event under one number, and is cancelled when its client goes."""

    async def subscribed() -> int:
        async with aio.insecure_channel(f"localhost:{relay.proxy.port}") as channel:
            calls = [channel.unary_stream(path(SUBSCRIBE))(b"") for _ in range(1_000)]
            await asyncio.gather(*(one.read() for one in calls))
            loop = asyncio.get_running_loop()
            await loop.run_in_executor(None, lambda: robot.call("CreateMission", NAVIGATE))
            return len(set(await asyncio.wait_for(asyncio.gather(*(one.read() for one in calls)), WAIT)))

    assert asyncio.run(subscribed()) == 1
    assert eventually(lambda: sum(line.get("method") == "cancel" for line in lines) == 1_000)
    assert sum("message" in line for line in lines) == 2_000


def test_a_quiet_connection_is_not_asked_whether_it_is_alive_unless_told_so(robot: Served) -> None:
    """A server that permits no pings ends the stream of a client that asks; by default none is asked."""
    asking, quiet = (Target(robot.target, keepalive=seconds).channel() for seconds in (0.05, 0))
    streams = [one.unary_stream(path(SUBSCRIBE))(b"", timeout=3 * WAIT) for one in (asking, quiet)]
    for one in streams:
        next(one)
    assert eventually(streams[0].done)
    assert streams[0].details() == "Too many pings"
    assert not streams[1].done()
    for channel in (asking, quiet):
        channel.close()
