"""How far one mission server goes, and several that share robots: ``python docs/scale.py`` prints the page's tables.

The mission server of a shard is the one that ships, without sockets (`missionfsm.isaac.runtime.server`). A mission
belongs to the shard of its robot. An upstream that belongs to another shard is stood for by a mission of nobody's
robot: its shard reports on it, as a robot would, once the upstream has ended. So no server knows that it is a shard.
"""

from __future__ import annotations

import math
import random
import time
import tracemalloc
import zlib
from collections import Counter, deque
from collections.abc import Callable

import attrs

from missionfsm.isaac.runtime.missions import Effect, MissionRequest, Refused, Send, Status, StatusChanged
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire.framing import Decoder, encode
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto, TextProto, Uuid, WireStatus

ROBOTS, MISSIONS = 200, 2_000
SHARDS = (1, 2, 4, 8, 16)
FAILS = 97
"""One mission of so many fails."""


@attrs.frozen
class Plan:
    """Missions in the order of submission: each the number of its robot and its upstreams, a third has one or two."""

    robots: int
    missions: tuple[tuple[int, tuple[int, ...]], ...]

    @classmethod
    def drawn(cls, robots: int, missions: int) -> Plan:
        """A plan of that size, always the same."""
        numbers = random.Random(1)
        drawn: list[tuple[int, tuple[int, ...]]] = []
        for number in range(missions):
            upstream: tuple[int, ...] = ()
            if number and numbers.random() < 1 / 3:
                upstream = tuple(sorted({numbers.randrange(number) for _ in range(numbers.randrange(1, 3))}))
            drawn.append((numbers.randrange(robots), upstream))
        return cls(robots, tuple(drawn))


class Shards:
    """Mission servers that share the robots.

    Attributes:
        work: how many events each has had: submissions, connections and lines.
        standing_in: how many missions stand for one of another shard.
        sent: the missions in the order in which robots were sent them.
    """

    def __init__(self, plan: Plan, shards: int) -> None:
        self.plan = plan
        self.cores = [MissionServerCore() for _ in range(shards)]
        self.work = Counter[int]()
        self.standing_in = 0
        self.sent: list[int] = []
        self._stands: dict[tuple[int, int], Uuid] = {}
        self._watched: dict[int, list[int]] = {}
        self._todo: deque[tuple[int, Send]] = deque()
        self._ended: deque[tuple[int, bool]] = deque()
        self._outside = plan.robots

    def of(self, robot: int) -> int:
        """The shard of a robot: by its name, so that everybody knows it."""
        return zlib.crc32(f"robot-{robot}".encode()) % len(self.cores)

    def _submit(self, shard: int, uuid: Uuid, request: MissionRequest) -> None:
        refused = self.cores[shard].create(request, uuid)
        if refused is not None:
            raise ValueError(refused.problem)
        self._take(shard, lambda core: core.submit(uuid, 0.0))

    def _take(self, shard: int, event: Callable[[MissionServerCore], tuple[Effect, ...] | Refused]) -> None:
        effects: tuple[Effect, ...] | Refused = event(self.cores[shard])
        self.work[shard] += 1
        if isinstance(effects, Refused):
            raise ValueError(effects.problem)  # noqa: TRY004 - it is what was asked for that is wrong
        for effect in effects:
            if isinstance(effect, Send):
                self._todo.append((shard, effect))
            elif isinstance(effect, StatusChanged) and effect.status.terminal and effect.mission.upper == 0:
                self._ended.append((effect.mission.lower, effect.status is Status.SUCCESS))

    def _hear(self, shard: int, connection: int, *payloads: TextProto | MissionStatusProto) -> None:
        for payload in payloads:
            channel = "name" if isinstance(payload, TextProto) else "mission_status"
            message = Message(Header(channel), payload)
            self._take(shard, lambda core, message=message: core.received(connection, message, 0.0))

    def upstream(self, shard: int, number: int) -> Uuid:
        """What an upstream is called in a shard: itself, or the mission that stands for it there."""
        owner = self.of(self.plan.missions[number][0])
        if owner == shard:
            return Uuid(number, 0)
        if (shard, number) not in self._stands:
            self._stands[shard, number] = stands = Uuid(number, 1)
            self.standing_in += 1
            self._submit(shard, stands, MissionRequest(f"@{number}", start_timeout=math.inf))
            status = self.cores[owner].status(Uuid(number, 0))
            if status is not None and status.terminal:
                self._report(shard, number, succeeded=status is Status.SUCCESS)
            else:
                self._watched.setdefault(number, []).append(shard)
        return self._stands[shard, number]

    def _report(self, shard: int, number: int, *, succeeded: bool) -> None:
        """The robot that nobody has comes, says how the upstream ended, and goes."""
        self._outside += 1
        connection = self._outside
        self._take(shard, lambda core: core.connected(connection, 0.0))
        status = WireStatus.SUCCESS if succeeded else WireStatus.FAILURE
        self._hear(shard, connection, TextProto(f"@{number}"), MissionStatusProto(Uuid(number, 1), status))
        self._take(shard, lambda core: core.disconnected(connection, 0.0))

    def run(self) -> None:
        """Submit all, let all robots connect, and do what they are sent."""
        for number, (robot, upstream) in enumerate(self.plan.missions):
            shard = self.of(robot)
            needs = tuple(self.upstream(shard, one) for one in upstream)
            self._submit(shard, Uuid(number, 0), MissionRequest(f"robot-{robot}", upstream=needs))
        for robot in range(self.plan.robots):
            self._take(self.of(robot), lambda core, robot=robot: core.connected(robot, 0.0))
            self._hear(self.of(robot), robot, TextProto(f"robot-{robot}"))
        while self._todo or self._ended:
            while self._ended:
                number, succeeded = self._ended.popleft()
                for shard in self._watched.pop(number, ()):
                    self._report(shard, number, succeeded=succeeded)
            if self._todo:
                self._work(*self._todo.popleft())

    def _work(self, shard: int, send: Send) -> None:
        if send.mission.upper:
            return  # its shard has reported on it, or is about to
        number = send.mission.lower
        self.sent.append(number)
        end = WireStatus.FAILURE if number % FAILS == FAILS - 1 else WireStatus.SUCCESS
        says = (MissionStatusProto(send.mission, status) for status in (WireStatus.RUNNING, end))
        self._hear(shard, send.connection, *says)

    def statuses(self) -> list[Status]:
        """How each mission ended, in the order of submission."""
        found = [self.cores[self.of(robot)].status(Uuid(at, 0)) for at, (robot, _) in enumerate(self.plan.missions)]
        return [one for one in found if one is not None]


def shared(plan: Plan) -> list[str]:
    """The rows of the table of shards; nothing in them depends on the machine."""
    rows = [
        "| servers | upstreams elsewhere | events in all | the busiest server has | ends alike |",
        "|" + " --- |" * 5,
    ]
    alone: list[Status] = []
    upstreams = sum(len(upstream) for _, upstream in plan.missions)
    for number in SHARDS:
        shards = Shards(plan, number)
        shards.run()
        ends = shards.statuses()
        alone = alone or ends
        elsewhere, whole = shards.standing_in / upstreams, shards.work.total()
        busiest = max(shards.work.values()) / whole
        alike = "yes" if ends == alone and len(shards.sent) == len(set(shards.sent)) else "NO"
        rows.append(f"| {number} | {elsewhere:.0%} | {whole:,} | {busiest:.1%} | {alike} |")
    return rows


def costs(plan: Plan) -> tuple[float, float, float]:
    """Microseconds of a mission, and of reading a line that says RUNNING again; bytes of a mission."""
    tracemalloc.start()
    shards = Shards(plan, 1)
    shards.run()
    memory, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    began = time.process_time()
    Shards(plan, 1).run()
    mission = (time.process_time() - began) / len(plan.missions)
    core, uuid = MissionServerCore(), Uuid(0, 0)
    core.create(MissionRequest("r"), uuid)
    core.submit(uuid, 0.0)
    core.connected(0, 0.0)
    core.received(0, Message(Header("name"), TextProto("r")), 0.0)
    line = encode(Message(Header("mission_status", 1, 1, uuid), MissionStatusProto(uuid, WireStatus.RUNNING)))
    decoder, times = Decoder(), 20_000
    began = time.process_time()
    for _ in range(times):
        for item in decoder.feed(line):
            core.received(0, item, 0.0)
    return mission * 1e6, (time.process_time() - began) / times * 1e6, memory / len(plan.missions)


def paper(mission: float, running: float, hertz: float, length: float) -> int:
    """How many robots keep one core busy: each says RUNNING so often a second, and does missions of so many seconds.

    Args:
        mission, running: microseconds that a mission and such a line cost.
    """
    return int(1e6 / (hertz * running + mission / length))


def main() -> None:
    """Print the page's tables."""
    print("\n".join(shared(Plan.drawn(ROBOTS, MISSIONS))), flush=True)
    mission, running, memory = costs(Plan.drawn(ROBOTS, MISSIONS))
    print(f"\na mission: {mission:.0f} µs, {memory / 1024:.1f} KiB; RUNNING again: {running:.0f} µs\n")
    print("| RUNNING a second | missions of 10 s | of 60 s | of 600 s |\n| --- | --- | --- | --- |")
    for hertz in (10, 1, 0.1):
        cells = " | ".join(f"{paper(mission, running, hertz, length):,}" for length in (10, 60, 600))
        print(f"| {hertz:g} | {cells} |")


if __name__ == "__main__":
    main()
