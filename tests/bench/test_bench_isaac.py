"""How fast the mission server is: a fleet in memory, and what one event costs with many missions waiting.

Run with ``pytest -o addopts= tests/bench/test_bench_isaac.py -s``; skipped otherwise.
"""

import gc
import random
import statistics
import time
from collections import deque
from typing import Any

import pytest

from missionfsm.isaac.runtime.missions import Effect, MissionRequest, Refused, Send, Status
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire.framing import Decoder, encode
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto, TextProto, Uuid, WireStatus

ROBOTS, MISSIONS = 1_000, 10_000


def status_line(mission: Uuid, status: WireStatus) -> bytes:
    return encode(Message(Header("mission_status", 1, 1, mission), MissionStatusProto(mission, status)))


def run_fleet(seed: int) -> tuple[MissionServerCore, list[Uuid]]:
    """1,000 robots do 10,000 missions with random upstreams, over encoded lines; every send in order."""
    numbers = random.Random(seed)
    core = MissionServerCore()
    sent: list[Uuid] = []
    robots: deque[tuple[int, Uuid]] = deque()

    def take(effects: tuple[Effect, ...] | Refused) -> None:
        assert not isinstance(effects, Refused)
        for effect in effects:
            if isinstance(effect, Send):
                line = encode(Message(Header(effect.channel, 1, 1, Uuid(1, 1)), effect.payload))
                (message,) = Decoder().feed(line)
                assert isinstance(message, Message)
                assert message.payload.uuid is not None  # type: ignore[union-attr]
                sent.append(message.payload.uuid)  # type: ignore[union-attr]
                robots.append((effect.connection, sent[-1]))

    decoders = [Decoder() for _ in range(ROBOTS)]

    def hear(connection: int, line: bytes) -> None:
        for item in decoders[connection].feed(line):
            take(core.received(connection, item, 0.0))

    for number in range(MISSIONS):
        upstream = {Uuid(numbers.randrange(number), 0) for _ in range(numbers.randrange(4))} if number else set()
        robot = f"robot-{numbers.randrange(ROBOTS)}"
        request = MissionRequest(robot, timeout=3600.0, upstream=tuple(sorted(upstream, key=lambda one: one.lower)))
        assert core.create(request, Uuid(number, 0)) is None
        take(core.submit(Uuid(number, 0), 0.0))
    for number in range(ROBOTS):
        take(core.connected(number, 0.0))
        hear(number, encode(Message(Header("name"), TextProto(f"robot-{number}"))))
    while robots:
        connection, mission = robots.popleft()
        hear(connection, status_line(mission, WireStatus.RUNNING))
        hear(connection, status_line(mission, WireStatus.SUCCESS))
    return core, sent


def test_bench_isaac_a_fleet(benchmark: Any) -> None:
    """1,000 robots, 10,000 missions with random dependencies: none lost, none twice."""
    core, sent = benchmark.pedantic(run_fleet, args=(1,), rounds=3)
    assert len(sent) == len(set(sent)) == MISSIONS
    assert {status for _, status in core.statuses()} == {Status.SUCCESS}
    print(f"\n{MISSIONS / benchmark.stats.stats.mean:,.0f} missions/s, submitted, sent, acknowledged and completed")


def waiting_server(waiting: int) -> MissionServerCore:
    """One busy robot with `waiting` missions in its queue, half of them behind a mission that never ends."""
    core = MissionServerCore()
    core.create(MissionRequest("other"), Uuid(0, 1))
    core.submit(Uuid(0, 1), 0.0)
    for number in range(waiting):
        core.create(MissionRequest("r", timeout=60.0, upstream=(Uuid(0, 1),) if number % 2 else ()), Uuid(number, 0))
        core.submit(Uuid(number, 0), 0.0)
    core.connected(1, 0.0)
    core.received(1, Message(Header("name"), TextProto("r")), 0.0)
    return core


@pytest.mark.parametrize("waiting", [1_000, 10_000, 100_000])
def test_bench_isaac_one_event(benchmark: Any, waiting: int) -> None:
    """One mission ends and the next is sent, with 1,000 to 100,000 missions waiting."""
    core = waiting_server(waiting)
    done = iter(range(0, waiting, 2))

    def event() -> None:
        message = Message(Header("mission_status"), MissionStatusProto(Uuid(next(done), 0), WireStatus.SUCCESS))
        assert len(core.received(1, message, 0.0)) == 3

    benchmark.pedantic(event, rounds=min(400, waiting // 2 - 1))


def test_bench_isaac_the_cost_of_an_event_does_not_grow(benchmark: Any) -> None:
    """The median event with 100,000 missions waiting costs no more than thrice the one with 1,000."""

    def medians() -> dict[int, float]:
        result = {}
        for waiting in (1_000, 10_000, 100_000):
            core = waiting_server(waiting)
            gc.collect()
            times = []
            for number in range(0, 800, 2):
                message = Message(Header("mission_status"), MissionStatusProto(Uuid(number, 0), WireStatus.SUCCESS))
                began = time.perf_counter()
                core.received(1, message, 0.0)
                times.append(time.perf_counter() - began)
            result[waiting] = statistics.median(times)
        return result

    found = benchmark.pedantic(medians, rounds=1)
    print("\n" + ", ".join(f"{waiting:,} waiting: {cost * 1e6:.1f} µs an event" for waiting, cost in found.items()))
