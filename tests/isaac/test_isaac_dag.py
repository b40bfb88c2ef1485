"""The server against a naive one that looks through everything at every event."""

from collections.abc import Iterator

from hypothesis import given
from hypothesis import strategies as st
from isaac_helpers import FAILURE, RUNNING, SUCCESS, Driver

from missionfsm.isaac.runtime.codelet import Codelet
from missionfsm.isaac.runtime.missions import MissionRequest, Refused, Send, StatusChanged
from missionfsm.isaac.runtime.robot import Behavior, RobotCore, Transmit
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire import framing as wire
from missionfsm.isaac.wire.messages import Header, Message, Uuid


class Naive:
    """The documented readings, computed from scratch: no queue, no count, no heap."""

    def __init__(self) -> None:
        self.now = 0.0
        self.missions: list[tuple[str, list[int], float, float]] = []
        self.status: list[str] = []
        self.since: dict[int, float] = {}
        self.online: set[str] = set()

    def settle(self) -> list[int]:
        """Cancel what must be cancelled, time out what must be, send what can be sent."""
        sent: list[int] = []
        changed = True
        while changed:
            changed = False
            for number, (_, upstream, start, run) in enumerate(self.missions):
                limit = {"STARTED": start, "RUNNING": run}.get(self.status[number])
                before = self.status[number]
                if limit is not None and self.now >= self.since[number] + limit:
                    self.status[number] = "FAILED_TIMEDOUT"
                elif before == "QUEUED" and any(self.status[one].startswith("FAILED") for one in upstream):
                    self.status[number] = "FAILED_UPSTREAM"
                changed |= before != self.status[number]
            if changed:
                continue
            for robot in sorted(self.online):
                mine = [number for number, one in enumerate(self.missions) if one[0] == robot]
                ready = [
                    number
                    for number in mine
                    if self.status[number] == "QUEUED"
                    and all(self.status[one] == "SUCCESS" for one in self.missions[number][1])
                ]
                if ready and not any(self.status[number] in {"STARTED", "RUNNING"} for number in mine):
                    self.status[ready[0]] = "STARTED"
                    self.since[ready[0]] = self.now
                    sent.append(ready[0])
                    changed = True
        return sent

    def add(self, robot: str, upstream: list[int], start: float, run: float) -> list[int]:
        self.missions.append((robot, upstream, start, run))
        self.status.append("QUEUED")
        return self.settle()

    def connect(self, robot: str) -> list[int]:
        self.online.add(robot)
        return self.settle()

    def drop(self, robot: str) -> list[int]:
        self.online.discard(robot)
        for number, one in enumerate(self.missions):
            if one[0] == robot and self.status[number] in {"STARTED", "RUNNING"}:
                self.status[number] = "FAILED_DISCONNECTED"
        return self.settle()

    def report(self, robot: str, number: int, status: str) -> list[int]:
        if self.missions[number][0] == robot and self.status[number] in {"STARTED", "RUNNING"}:
            if status == "RUNNING" and self.status[number] == "STARTED":
                self.since[number] = self.now
            self.status[number] = status
        return self.settle()

    def wait(self, seconds: float) -> list[int]:
        sent: list[int] = []
        for _ in range(int(seconds * 2)):  # all times are halves of seconds
            self.now += 0.5
            sent += self.settle()
        return sent


@given(st.data())
def test_isaac_dag_the_server_is_the_naive_server(data: st.DataObject) -> None:
    """Over random missions, robots, reports, drops and times: the same sends and statuses at every event."""
    server, naive = Driver(), Naive()
    bound: dict[str, int] = {}
    connections = 0
    for _ in range(data.draw(st.integers(1, 40))):
        event = data.draw(st.sampled_from(["add", "add", "connect", "drop", "report", "report", "report", "wait"]))
        robot = data.draw(st.sampled_from("rst"))
        if event == "add":
            upstream = (
                data.draw(st.lists(st.integers(0, len(naive.missions) - 1), max_size=3)) if naive.missions else []
            )
            start = data.draw(st.sampled_from([0.5, 5.0]))
            run = data.draw(st.sampled_from([1.0, float("inf")]))
            found = server.add(robot, upstream, start_timeout=start, timeout=run)
            expected = naive.add(robot, upstream, start, run)
        elif event == "connect" and robot not in bound:
            connections += 1
            bound[robot] = connections
            found, expected = server.connect(connections, robot), naive.connect(robot)
        elif event == "drop" and robot in bound:
            found, expected = server.drop(bound.pop(robot)), naive.drop(robot)
        elif event == "report" and robot in bound and naive.missions:
            mine = [n for n, one in enumerate(naive.missions) if one[0] == robot and naive.status[n] != "QUEUED"]
            number = data.draw(st.sampled_from(mine or [0]))
            status = data.draw(st.sampled_from([RUNNING, SUCCESS, SUCCESS, FAILURE]))
            name = {FAILURE: "FAILED"}.get(status, status.name)
            found, expected = server.report(bound[robot], number, status), naive.report(robot, number, name)
        elif event == "wait":
            seconds = data.draw(st.sampled_from([0.5, 5.0]))
            found, expected = server.wait(seconds), naive.wait(seconds)
        else:
            continue
        assert sorted(found) == sorted(expected)
        assert server.statuses() == naive.status
    assert server.core.unfinished == sum(one in {"QUEUED", "STARTED", "RUNNING"} for one in naive.status)


def simulate(
    missions: list[tuple[int, list[int]]], robots: int, failing: set[int], tick: float = 0.5
) -> Iterator[tuple[Uuid, str]]:
    """Server and robots over real lines in virtual time; every status change in order."""
    server = MissionServerCore()
    fleet = [
        RobotCore(f"r{number}", codelet=Codelet(period=10.0), script=(Behavior("hang"),), name_period=1e6)
        for number in range(robots)
    ]
    decoders = [(wire.Decoder(), wire.Decoder()) for _ in fleet]
    effects: list[tuple[int, object]] = []
    for number, (robot, upstream) in enumerate(missions):
        assert (
            server.create(MissionRequest(f"r{robot}", upstream=tuple(Uuid(u, 0) for u in upstream)), Uuid(number, 0))
            is None
        )
    for number in range(len(missions)):
        result = server.submit(Uuid(number, 0), 0.0)
        assert not isinstance(result, Refused)
        effects += [(-1, effect) for effect in result]
    for number, core in enumerate(fleet):
        effects += [(-1, effect) for effect in server.connected(number, 0.0)]
        effects += [(number, effect) for effect in core.connected(0.0)]
    now, ending = 0.0, dict[int, int]()
    while effects or ending:
        if not effects:
            now += tick
            due, ending = ending, {}
            for robot, number in due.items():
                effects += [(robot, e) for e in fleet[robot].behavior_stops(now, success=number not in failing)]
        origin, effect = effects.pop(0)
        if isinstance(effect, StatusChanged):
            yield effect.mission, effect.status.name
        elif isinstance(effect, Send):
            line = wire.encode(Message(Header(effect.channel), effect.payload))
            for item in decoders[effect.connection][0].feed(line):
                effects += [(effect.connection, one) for one in fleet[effect.connection].received(item, now)]
            assert effect.payload.uuid is not None
            ending[effect.connection] = effect.payload.uuid.lower
        elif isinstance(effect, Transmit):
            for item in decoders[origin][1].feed(wire.encode(Message(Header(effect.channel), effect.payload))):
                effects += [(-1, one) for one in server.received(origin, item, now)]


@st.composite
def fleets(draw: st.DrawFn) -> tuple[list[tuple[int, list[int]]], int, set[int]]:
    robots = draw(st.integers(1, 4))
    size = draw(st.integers(1, 14))
    missions = [
        (
            draw(st.integers(0, robots - 1)),
            sorted(set(draw(st.lists(st.integers(0, number - 1), max_size=3)))) if number else [],
        )
        for number in range(size)
    ]
    return missions, robots, draw(st.sets(st.integers(0, size - 1), max_size=2))


@given(fleets())
def test_isaac_dag_every_mission_of_a_fleet_ends_as_its_upstreams_decide(
    fleet: tuple[list[tuple[int, list[int]]], int, set[int]],
) -> None:
    """Robots and server over encoded lines: all missions end, those fail that must, none goes before its upstreams."""
    missions, robots, failing = fleet
    expected: list[str] = []
    for number, (_, upstream) in enumerate(missions):
        lost = any(expected[one] != "SUCCESS" for one in upstream)
        expected.append("FAILED_UPSTREAM" if lost else "FAILED" if number in failing else "SUCCESS")
    last: dict[int, str] = {}
    for mission, status in simulate(missions, robots, failing):
        if status == "STARTED":
            assert all(last[one] == "SUCCESS" for one in missions[mission.lower][1])
        last[mission.lower] = status
    assert [last[number] for number in range(len(missions))] == expected


def test_isaac_dag_the_same_events_give_the_same_effects() -> None:
    """Two servers told the same say the same, in the same order."""
    missions = [(number % 3, [number // 2] if number else []) for number in range(40)]
    assert list(simulate(missions, 3, {7})) == list(simulate(missions, 3, {7}))
