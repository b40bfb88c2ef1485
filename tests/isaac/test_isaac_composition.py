"""The mission server and robots that ship, explored as one system: every order of events within bounds.

Lines travel in order and are lost only with their connection. A state is copied for every event that may happen in it.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator

import attrs
import pytest

from missionfsm.isaac.runtime.codelet import StartBehavior
from missionfsm.isaac.runtime.missions import Close, MissionRequest, Refused, Send, Status
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.runtime.robot import Did, RobotCore, Transmit
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire.messages import Header, Message, MissionProto, Payload, Uuid

Plan = tuple[tuple[str, tuple[int, ...]], ...]
"""Missions: the robot, and the missions that it waits for."""


class Together:
    """A server, its robots, and what is on its way between them."""

    def __init__(self, plan: Plan, profile: Profile = DOCUMENTED, drops: int = 0) -> None:
        self.plan = plan
        self.core = MissionServerCore(profile)
        self.robots = {name: RobotCore(name) for name in dict.fromkeys(robot for robot, _ in plan)}
        self.link: dict[str, int | None] = dict.fromkeys(self.robots)
        self.up: dict[str, tuple[Message, ...]] = dict.fromkeys(self.robots, ())
        self.down: dict[str, tuple[Message, ...]] = dict.fromkeys(self.robots, ())
        self.drops = drops
        self.connected = 0
        self.started = [0] * len(plan)
        self.early: list[str] = []
        for number, (robot, upstream) in enumerate(plan):
            request = MissionRequest(
                robot=robot, start_timeout=math.inf, upstream=tuple(Uuid(one + 1, 0) for one in upstream)
            )
            assert self.core.create(request, Uuid(number + 1, 0)) is None
            assert not isinstance(self.core.submit(Uuid(number + 1, 0), 0.0), Refused)

    @property
    def statuses(self) -> tuple[Status, ...]:
        return tuple(status for _, status in self.core.statuses())

    def key(self) -> object:
        """All that decides what may happen next, with connections by whose they are."""
        there = tuple((one.robot, one.connection is not None, one.running) for one in self.core.robots())
        robots = tuple((one.codelet, tuple(one._kept)) for one in self.robots.values())
        linked = tuple(one is not None for one in self.link.values())
        ways = tuple(self.up.values()), tuple(self.down.values())
        return self.statuses, there, robots, linked, ways, self.drops, tuple(self.started)

    def events(self) -> Iterator[tuple[str, Callable[[Together], None]]]:
        """What may happen, with a name for it."""
        for name in self.robots:
            if self.link[name] is None:
                yield f"{name} connects", lambda it, name=name: it.connect(name)
                continue
            if self.up[name]:
                yield f"the server hears {name}", lambda it, name=name: it.to_server(name)
            if self.down[name]:
                yield f"{name} hears the server", lambda it, name=name: it.to_robot(name)
            if self.drops:
                yield f"{name} drops", lambda it, name=name: it.drop(name)
        for name, robot in self.robots.items():
            if robot.codelet.mission is not None:
                yield f"{name} succeeds", lambda it, name=name: it.stop(name, success=True)
                yield f"{name} fails", lambda it, name=name: it.stop(name, success=False)

    def connect(self, name: str) -> None:
        self.connected += 1
        self.link[name] = self.connected
        self._server(self.core.connected(self.connected, 0.0))
        self._robot(name, self.robots[name].connected(0.0))

    def drop(self, name: str) -> None:
        self.drops -= 1
        self._cut(name)

    def _cut(self, name: str) -> None:
        link, self.link[name] = self.link[name], None
        self.up[name] = self.down[name] = ()
        self._robot(name, self.robots[name].disconnected(0.0))
        if link is not None:
            self._server(self.core.disconnected(link, 0.0))

    def to_server(self, name: str) -> None:
        message, *rest = self.up[name]
        self.up[name] = tuple(rest)
        link = self.link[name]
        assert link is not None
        self._server(self.core.received(link, message, 0.0))

    def to_robot(self, name: str) -> None:
        message, *rest = self.down[name]
        self.down[name] = tuple(rest)
        assert isinstance(message.payload, MissionProto)
        assert message.payload.uuid is not None
        number = message.payload.uuid.lower - 1
        effects = self.robots[name].received(message, 0.0)
        if any(isinstance(one, Did) and isinstance(one.action, StartBehavior) for one in effects):
            self.started[number] += 1
            open_ones = [one for one in self.plan[number][1] if self.statuses[one] is not Status.SUCCESS]
            if open_ones:
                self.early.append(f"mission {number} started before {open_ones}")
        self._robot(name, effects)

    def stop(self, name: str, *, success: bool) -> None:
        self._robot(name, self.robots[name].behavior_stops(0.0, success=success))

    def _server(self, effects: tuple[object, ...]) -> None:
        for one in effects:
            name = next((name for name, link in self.link.items() if link == getattr(one, "connection", -1)), None)
            if isinstance(one, Send) and name is not None:
                self.down[name] = (*self.down[name], _message(one.channel, one.payload))
            elif isinstance(one, Close) and name is not None:
                self._cut(name)

    def _robot(self, name: str, effects: tuple[object, ...]) -> None:
        for one in effects:
            if isinstance(one, Transmit) and self.link[name] is not None:
                self.up[name] = (*self.up[name], _message(one.channel, one.payload))


def _message(channel: str, payload: Payload) -> Message:
    return Message(Header(channel), payload)


@attrs.frozen
class Explored:
    """What exploring came to: how many states, those where nothing more happens, and the first that is wrong."""

    states: int
    ends: tuple[Together, ...]
    wrong: str = ""


def explore(start: Together, wrong: Callable[[Together], str], most: int = 20_000) -> Explored:
    """Every state that can be reached, nearest first, until one is wrong."""
    seen = {start.key()}
    todo: list[tuple[Together, tuple[str, ...]]] = [(start, ())]
    ends: list[Together] = []
    for here, path in todo:
        moves = list(here.events())
        if not any(not label.endswith("drops") for label, _ in moves):
            ends.append(here)
        for label, event in moves:
            after = copy.deepcopy(here)
            event(after)
            key = after.key()
            if key in seen:
                continue
            seen.add(key)
            if said := wrong(after):
                return Explored(len(seen), tuple(ends), f"{said}: {', '.join((*path, label))}")
            assert len(seen) <= most, "there are more states than this test is for"
            todo.append((after, (*path, label)))
    return Explored(len(seen), tuple(ends))


def broken(it: Together) -> str:
    """What never happens: a mission started twice, or before its upstreams have succeeded."""
    if it.early:
        return it.early[0]
    twice = [number for number, times in enumerate(it.started) if times > 1]
    return f"mission {twice[0]} was started twice" if twice else ""


FORKLIFTS: Plan = (("fork01", ()), ("fork02", ()), ("arm01", (0, 1)), ("fork01", (2,)), ("fork02", (2,)))
"""The page's example: two forklifts bring pallets, the arm moves the box from one to the other, the forklifts leave."""


def test_forklifts_and_arm() -> None:
    """Two forklifts and an arm, in every order of events: nothing starts early or twice, and everything ends."""
    found = explore(Together(FORKLIFTS), broken)
    assert (found.wrong, found.states) == ("", 451)
    assert all(status.terminal for end in found.ends for status in end.statuses)
    outcomes = {end.statuses for end in found.ends}
    assert (Status.SUCCESS,) * 5 in outcomes
    # Whatever fails first, what depends on it is cancelled: no other mixture is reached.
    failed, canceled, done = Status.FAILED, Status.FAILED_UPSTREAM, Status.SUCCESS
    bringing = {(one, two, canceled, canceled, canceled) for one in (failed, done) for two in (failed, done)}
    leaving = {(done, done, done, one, two) for one in (failed, done) for two in (failed, done)}
    arm = {(done, done, failed, canceled, canceled)}
    assert outcomes == (bringing - {(done, done, canceled, canceled, canceled)}) | leaving | arm


@pytest.mark.long
@pytest.mark.parametrize(
    "profile",
    [DOCUMENTED, pytest.param(attrs.evolve(DOCUMENTED, ai_12="b", ai_10="b"), marks=pytest.mark.long)],
    ids=["a", "strict"],
)
def test_lost_connections(profile: Profile) -> None:
    """Connections that drop at any moment make no mission run twice or early, and everything still ends."""
    plan: Plan = (("r1", ()), ("r2", (0,)), ("r1", ()))
    found = explore(Together(plan, profile, drops=2), broken)
    assert (found.wrong, found.states > 2_000) == ("", True)
    assert all(status.terminal for end in found.ends for status in end.statuses)


def test_sending_again_is_a_reading() -> None:
    """Only where a lost connection means that the mission is sent again (AI-15 b) can one run twice."""
    plan: Plan = (("r1", ()), ("r1", (0,)))
    assert explore(Together(plan, drops=1), broken).wrong == ""
    again = explore(Together(plan, attrs.evolve(DOCUMENTED, ai_15="b"), drops=1), broken)
    assert again.wrong.startswith("mission 0 was started twice")


def test_a_lost_mission_does_not_end_the_next() -> None:
    """A robot that comes back and reports the end of a mission that was given up does not end the one after it."""
    plan: Plan = (("r1", ()), ("r1", ()))

    def credited(it: Together) -> str:
        second = it.statuses[1]
        return "the second ended before it started" if second.terminal and not it.started[1] and it.drops else ""

    assert explore(Together(plan, drops=1), credited).wrong == ""
