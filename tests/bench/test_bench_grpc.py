"""How fast robots are served, and what the proxy adds, beside a bare echo server of grpcio in the same run.

    pytest -o addopts= tests/bench/test_bench_grpc.py -s

Servers, proxy, relay and client have a process each. What is compared takes turns, so that what else the machine does
is in both; processor time is that of the server alone. Only ratios say something.
"""

from __future__ import annotations

import contextlib
import os
import re
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import grpc
import pytest
from attrs import frozen

from missionfsm.adapters.grpc.descriptors import decode, encode, methods, path

CALLS = 2_000
EVENTS = 200
ROUNDS = 7
METHODS = methods("bear.mission")
SUBSCRIBE, CREATE, UPDATE = (METHODS[name] for name in ("SubscribeMissionStatus", "CreateMission", "UpdateMission"))
GOAL = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
ECHO = str(Path(__file__).with_name("echo.py"))
ROBOT = ("-m", "missionfsm", "serve", "bear.mission", "--grpc", "0")


@frozen
class Process:
    """A server in a process of its own: where it listens, and which process it is."""

    port: int
    pid: int

    @property
    def target(self) -> str:
        """What a client connects to."""
        return f"127.0.0.1:{self.port}"

    @property
    def seconds(self) -> float:
        """Processor time that it has taken so far."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextlib.contextmanager
def process(*arguments: str) -> Iterator[Process]:
    """A Python process that prints its port, after a colon or alone, in its first line; interrupted at the end."""
    with subprocess.Popen([sys.executable, *arguments], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        yield Process(int(re.findall(r"\d+", child.stdout.readline().split(";")[0].split(",")[0])[-1]), child.pid)
        child.send_signal(signal.SIGINT)


def called(target: str, name: str, request: bytes) -> list[float]:
    """How many seconds each of many unary calls takes, one after the other."""
    with grpc.insecure_channel(target) as channel:
        ask = channel.unary_unary(name)
        times = []
        for _ in range(CALLS // ROUNDS):
            begun = time.perf_counter()
            with contextlib.suppress(grpc.RpcError):
                ask(request, timeout=10)
            times.append(time.perf_counter() - begun)
    return times


def subscribed(target: str, name: str, subscribers: int, cause: Callable[[grpc.Channel, int], object]) -> float:
    """Seconds from the first of many events to the last message about them, to so many subscribers."""
    with grpc.insecure_channel(target) as channel:
        streams = [channel.unary_stream(name)(b"") for _ in range(subscribers)]
        for one in streams:
            next(one)
        begun = time.perf_counter()
        for number in range(EVENTS):
            cause(channel, number)
        for one in streams:
            for _ in range(EVENTS):
                next(one)
        taken = time.perf_counter() - begun
        for one in streams:
            one.cancel()
    return taken


def tell(what: str, servers: Sequence[Process], turns: Sequence[Callable[[], float]], count: int) -> None:
    """Let the echo server and the robot do the same in turns, and print how many a second, in medians."""
    seconds: list[list[float]] = [[], []]
    before = [server.seconds for server in servers]
    for _ in range(ROUNDS):
        for turn, taken in zip(turns, seconds, strict=True):
            taken.append(turn())
    spent = [server.seconds - begun for server, begun in zip(servers, before, strict=True)]
    bare, robot = (count / statistics.median(taken) for taken in seconds)
    print(f"\n{what}: echo {bare:,.0f}/s, robot {robot:,.0f}/s: {robot / bare:.2f} of it; ", end="")
    one = [1e6 * taken / (count * ROUNDS) for taken in spent]
    print(f"processor time of the server for one: {one[0]:.0f} and {one[1]:.0f} µs: {one[0] / one[1]:.2f}", end="")


def test_unary_calls_beside_an_echo() -> None:
    """Calls a second to the robot against those to the echo server."""
    request = encode(CREATE.request, GOAL)
    with process(ECHO) as echo, process(*ROBOT) as robot:
        turns = [
            lambda: sum(called(echo.target, "/bench.Echo/Call", request)),
            lambda: sum(called(robot.target, path(CREATE), request)),
        ]
        tell("unary calls", (echo, robot), turns, CALLS // ROUNDS)


@pytest.mark.parametrize("subscribers", [1, 8, 200])
def test_messages_beside_an_echo(subscribers: int) -> None:
    """Messages a second to subscribers of the robot against those of the echo server.

    Both are made to send by a client's call, which they answer with nothing: the robot by an UpdateMission that pauses
    or resumes its mission, the echo server by one that carries a message of the robot's.
    """
    with process(ECHO) as echo, process(*ROBOT) as robot:
        with grpc.insecure_channel(robot.target) as channel:
            made = channel.unary_unary(path(CREATE))(encode(CREATE.request, GOAL), timeout=10)
            shown = next(iter(channel.unary_stream(path(SUBSCRIBE))(b"")))
        named = decode(CREATE.response, made)["missionId"]
        commands = [
            encode(UPDATE.request, {"missionCommand": {"missionId": named, "command": command}})
            for command in ("COMMAND_PAUSE", "COMMAND_RESUME")
        ]

        def update(channel: grpc.Channel, number: int) -> bytes:
            answer: bytes = channel.unary_unary(path(UPDATE))(commands[number % 2], timeout=10)
            return answer

        def ask(channel: grpc.Channel, _: int) -> bytes:
            answer: bytes = channel.unary_unary("/bench.Echo/Tell")(shown, timeout=10)
            return answer

        turns = [
            lambda: subscribed(echo.target, "/bench.Echo/Subscribe", subscribers, ask),
            lambda: subscribed(robot.target, path(SUBSCRIBE), subscribers, update),
        ]
        tell(f"messages to {subscribers}", (echo, robot), turns, subscribers * EVENTS)


def test_what_a_proxy_adds(tmp_path: Path) -> None:
    """Milliseconds that the proxy adds while it records and judges, beside those of a bare relay of grpcio.

    The relay only passes bytes on: it is the least that anything in between that speaks gRPC costs in Python.
    """
    name, request = path(CREATE), encode(CREATE.request, GOAL)
    with process(ECHO) as echo:
        options = ("--grpc", echo.target, "--listen", "0", "--record", str(tmp_path / "day.jsonl"))
        judging = ("-m", "missionfsm", "proxy", "bear.mission", *options)
        with process(*judging) as proxy, process(ECHO, str(echo.port)) as relay:
            took: list[list[float]] = [[], [], []]
            for _ in range(ROUNDS):
                for server, times in zip((echo, relay, proxy), took, strict=True):
                    times.extend(called(server.target, name, request))
            bare, relayed, proxied = (1000 * statistics.median(times) for times in took)
    print(f"\nproxy: {proxied - bare:.2f} ms added to {bare:.2f} ms (medians); a bare relay adds ", end="")
    print(f"{relayed - bare:.2f} ms: {(proxied - bare) / (relayed - bare):.2f} of it", end="")
