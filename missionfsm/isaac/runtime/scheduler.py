"""The queues of the mission server: what waits for what, what is sent next, what is due when.

The inner half of :mod:`missionfsm.isaac.runtime.server`, which owns the connections and says what the two halves
promise together. Mutable and pure.
"""

import heapq
import math
from collections import deque
from collections.abc import Callable, Iterable
from typing import Final, Protocol, TypeVar

from missionfsm.isaac.runtime.deadlines import Deadlines
from missionfsm.isaac.runtime.missions import Effect, Send, Status, StatusChanged
from missionfsm.isaac.runtime.profile import Profile
from missionfsm.isaac.runtime.records import ConnectionRecord, LaneRecord, MissionRecord, RobotRecord
from missionfsm.isaac.wire.messages import MissionProto, Uuid

_DAY: Final = 86400


class _Identified(Protocol):
    @property
    def uuid(self) -> Uuid: ...


_Mission = TypeVar("_Mission", bound=_Identified)


def upstreams_first(mission: _Mission, upstreams: Callable[[_Mission], list[_Mission]]) -> list[_Mission]:
    """A mission behind all its upstreams and theirs, each once."""
    order: dict[Uuid, _Mission] = {}
    stack = [(mission, False)]
    while stack:
        one, expanded = stack.pop()
        if expanded:
            order.setdefault(one.uuid, one)
        elif one.uuid not in order:
            stack.append((one, True))
            stack.extend((upstream, False) for upstream in reversed(upstreams(one)))
    return list(order.values())


class Scheduler:
    """Missions and robots.

    `close` is called where a connection has to go, with the reason; `notice` at the beginning of every scheduling pass,
    so that what waits for one (drops, names) happens then.
    """

    def __init__(
        self, profile: Profile, close: Callable[[ConnectionRecord, str], None], notice: Callable[[], None]
    ) -> None:
        self.profile = profile
        self._notice = notice
        self._unnoticed = False
        self._overdue: list[tuple[str, MissionRecord]] = []
        self._condemned: list[MissionRecord] = []
        self.now = -math.inf
        self.missions: dict[Uuid, MissionRecord] = {}
        self.attempts: dict[Uuid, MissionRecord] = {}
        self.submitted = 0
        self.robots: dict[str, RobotRecord] = {}
        self.unfinished = 0
        self.effects: list[Effect] = []
        self.deadlines: Deadlines[MissionRecord | ConnectionRecord | None] = Deadlines(self._holds)
        self._close = close
        self._dirty: dict[LaneRecord, None] = {}
        self._maybe_idle: dict[str, None] = {}
        self._pass_at: float | None = None

    def begin(self, now: float) -> None:
        """An event happens at `now`; what was due by then comes first."""
        self.effects = []
        self.now = max(self.now, now)
        self._run()

    def end(self) -> tuple[Effect, ...]:
        """The event has been told; what follows from it, and all its effects."""
        self._run()
        for key in self._maybe_idle:
            robot = self.robots.get(key)
            if robot is not None and robot.connection is None and not robot.unfinished:
                del self.robots[key]
        self._maybe_idle.clear()
        effects, self.effects = tuple(self.effects), []
        return effects

    def _run(self) -> None:
        """Do what is due, and send what can be sent, until neither is left."""
        while True:
            while (entry := self.deadlines.pop(self.now)) is not None:
                self._due(entry[1], entry[2])
            if not self._dirty and not self._unnoticed:
                return
            if self.profile.scheduling_period > 0:
                self._plan_pass()
                return
            self._pass()

    def wait_for_pass(self) -> None:
        """Something has happened that the next scheduling pass notices."""
        self._unnoticed = True

    def _plan_pass(self) -> None:
        if self._pass_at is None:
            period = self.profile.scheduling_period
            at = (math.floor(self.now / period) + 1) * period
            self._pass_at = at if at > self.now else self.now + period
            self.deadlines.push(self._pass_at, "pass", None)

    def _pass_now(self) -> None:
        self._pass_at = self.now
        self.deadlines.push(self.now, "pass", None)

    def _pass(self) -> None:
        self._unnoticed = False
        self._notice()
        condemned, self._condemned = self._condemned, []
        for mission in condemned:
            if not mission.ended and self._canceled(mission):
                self.finish(mission, Status.FAILED_UPSTREAM)
        overdue, self._overdue = self._overdue, []
        for kind, mission in overdue:
            if mission.due.get(kind, math.inf) <= self.now:
                self.abort(mission, Status.FAILED_TIMEDOUT)
        lanes = tuple(self._dirty)
        self._dirty.clear()
        for lane in lanes:
            self._dispatch(lane)

    def _holds(self, due: float, kind: str, target: MissionRecord | ConnectionRecord | None) -> bool:
        if isinstance(target, MissionRecord):
            return target.due.get(kind) == due
        if isinstance(target, ConnectionRecord):
            return target.open and target.robot is None
        return self._pass_at == due

    def _due(self, kind: str, target: MissionRecord | ConnectionRecord | None) -> None:
        if target is None:
            self._pass_at = None
            self._pass()
        elif isinstance(target, ConnectionRecord):
            self._close(target, "it did not say its name in time")
        elif kind == "silence" and target.heard + self.profile.silence_timeout > self.now:
            self.arm(target, "silence", target.heard + self.profile.silence_timeout)
        elif kind != "silence" and self.profile.ai_24_whole == "w":
            self._overdue.append((kind, target))
            self._pass_now()
        else:
            self.abort(target, Status.FAILED_TIMEDOUT)

    # dependencies

    def depend(self, mission: MissionRecord, upstream: MissionRecord) -> None:
        """Note that `mission`, which is being made, cannot go before `upstream` has succeeded."""
        upstream.needed += 1
        started = upstream.status is Status.STARTED and self.profile.started_upstream_fails
        if upstream.status is Status.SUCCESS:
            return
        if started or (upstream.ended and self._cancels(upstream.status)):
            mission.doomed = True
            return
        mission.waiting += 1  # for ever, where a failure does not cancel (AI-03 b, c)
        if not upstream.ended:
            upstream.downstream.append(mission)

    def _cancels(self, status: Status) -> bool:
        if self.profile.ai_03 == "b":
            return status is Status.FAILED
        return self.profile.ai_03 == "a" or status is not Status.FAILED_UPSTREAM

    def not_submitted(self, mission: MissionRecord) -> list[MissionRecord]:
        """The mission and all upstreams that were not submitted, upstreams first."""
        if mission.number >= 0:
            return []
        return upstreams_first(
            mission, lambda one: [up for uuid in one.request.upstream if (up := self.missions[uuid]).number < 0]
        )

    def finish(self, mission: MissionRecord, status: Status) -> None:
        """End a mission, and all that its end decides."""
        work: deque[tuple[MissionRecord, Status]] = deque([(mission, status)])
        while work:
            one, end = work.popleft()
            if one.ended:
                continue
            self._end(one, end)
            downstream, one.downstream = one.downstream, []
            succeeded = end is Status.SUCCESS
            if not succeeded and not self._cancels(end):
                continue
            for other in downstream:
                if succeeded or self.profile.ai_36 == "b":
                    other.waiting -= 1
                other.doomed = other.doomed or not succeeded
                if other.number < 0 or other.ended:
                    continue
                if other.doomed and self.profile.ai_03_when != "n":
                    self._condemn(self._lane(self.robots[other.key], other), other)
                elif self._canceled(other):
                    work.append((other, Status.FAILED_UPSTREAM))
                elif other.waiting == 0:
                    self._ready(other)

    def _condemn(self, lane: LaneRecord, mission: MissionRecord) -> None:
        """A mission is to be cancelled in a pass: in one in which it heads its queue (p), or in the next (q)."""
        if self.profile.ai_03_when == "p":
            self._touch(lane)
        else:
            self._condemned.append(mission)
            self.wait_for_pass()

    def _canceled(self, mission: MissionRecord) -> bool:
        """Whether a mission is to be cancelled since an upstream failed."""
        return mission.doomed and (mission.waiting == 0 or self.profile.ai_36 == "a")

    def _end(self, mission: MissionRecord, status: Status) -> None:
        self.change(mission, status)
        mission.ended = True
        mission.due.clear()
        for upstream in dict.fromkeys(mission.request.upstream):
            if upstream in self.missions:
                self.missions[upstream].needed -= 1
        robot = self.robots[mission.key]
        del robot.unfinished[mission.uuid]
        self.unfinished -= 1
        self._maybe_idle[robot.key] = None
        lane = self._lane(robot, mission)
        if mission.in_flight:
            self._landed(lane, mission)
        self._touch(lane)

    def _landed(self, lane: LaneRecord, mission: MissionRecord) -> None:
        """A mission that was sent is under way no more."""
        mission.in_flight = False
        lane.sent.pop(mission.uuid, None)
        if mission.connection is not None:
            mission.connection.kept.pop(mission.uuid, None)

    def change(self, mission: MissionRecord, status: Status) -> None:
        """Give a mission another status; it is said only where it is another."""
        if mission.status is not status:
            self.effects.append(StatusChanged(mission.uuid, mission.status, status))
            mission.status = status

    # queues

    def admit(self, mission: MissionRecord, number: int | None = None) -> None:
        """Take a created mission into its robot's queue, behind all others or at a place that it had."""
        robot = self.enter(mission, self.submitted if number is None else number)
        if self._canceled(mission) and self.profile.ai_03_when == "n":
            self.finish(mission, Status.FAILED_UPSTREAM)
            return
        if self.profile.ai_04 == "a":
            self.change(mission, Status.QUEUED)
        request = mission.request
        if self.profile.ai_05 == "b" or (self.profile.ai_05 == "d" and robot.connection is not None):
            self._arm_timeout(mission, "start", request.start_timeout)
        if self.profile.ai_06 == "c":
            self._arm_timeout(mission, "run", request.timeout)
        if self.profile.ai_12 == "b" or self.profile.ai_03_when == "p":
            self._lane(robot, mission).line.append(mission)
        if mission.doomed and self.profile.ai_03_when != "n":
            self._condemn(self._lane(robot, mission), mission)
        elif mission.waiting == 0:
            self._ready(mission)

    def enter(self, mission: MissionRecord, number: int) -> RobotRecord:
        """Count a mission as one that its robot has to do, at a place in the order of submission."""
        mission.number = number
        self.submitted = max(self.submitted, number + 1)
        self.unfinished += 1
        robot = self.robot(mission.request.robot or "")
        robot.unfinished[mission.uuid] = mission
        return robot

    def unqueue(self, mission: MissionRecord) -> None:
        """Take a mission that has ended out of its robot's line, before it is queued again."""
        robot = self.robots.get(mission.key)
        for lane in () if robot is None else robot.lanes.values():
            if mission in lane.line:
                lane.line.remove(mission)

    def _ready(self, mission: MissionRecord) -> None:
        self.change(mission, Status.QUEUED)
        if self.profile.ai_05 == "c":
            self._arm_timeout(mission, "start", mission.request.start_timeout)
        lane = self._lane(self.robots[mission.key], mission)
        if self.profile.ai_12 == "a":
            order = mission.number if self.profile.ai_13 == "a" else -mission.number
            heapq.heappush(lane.ready, (order, mission))
        self._touch(lane)

    def _touch(self, lane: LaneRecord) -> None:
        if lane.robot.connection is not None:
            self._dirty[lane] = None

    def _lane(self, robot: RobotRecord, mission: MissionRecord) -> LaneRecord:
        key = mission.request.channel if self.profile.ai_11 == "c" else ""
        lane = robot.lanes.get(key)
        if lane is None:
            robot.lanes[key] = lane = LaneRecord(robot)
        return lane

    def _dispatch(self, lane: LaneRecord) -> None:
        while (connection := lane.robot.connection) is not None and connection.open and not connection.leaving:
            if not lane.sent and self.profile.ai_03_when == "p":
                self._lapse(lane)
            mission = None if lane.sent and self.profile.ai_11 != "b" else self._take(lane)
            if mission is None:
                return
            self._send(lane, connection, mission)

    def _lapse(self, lane: LaneRecord) -> None:
        """AI-03.when p: cancel what is doomed at the head of the queue of a robot that is there and idle."""
        while lane.line:
            head = lane.line[0]
            if head.ended or head.in_flight:
                lane.line.popleft()
            elif self._canceled(head):
                self.finish(head, Status.FAILED_UPSTREAM)
            else:
                return

    def _take(self, lane: LaneRecord) -> MissionRecord | None:
        if self.profile.ai_12 == "a":
            while lane.ready:
                order, mission = heapq.heappop(lane.ready)
                if not mission.ended and abs(order) == mission.number:  # a retry has another number
                    return mission
            return None
        while lane.line and lane.line[0].ended:
            lane.line.popleft()
        head = lane.line[0] if lane.line else None
        return lane.line.popleft() if head is not None and head.waiting == 0 and not head.doomed else None

    def _send(self, lane: LaneRecord, connection: ConnectionRecord, mission: MissionRecord) -> None:
        profile, request = self.profile, mission.request
        at_once = request.start_timeout == 0 and (profile.ai_24, profile.ai_24_whole, profile.ai_05) == ("a", "x", "a")
        if at_once and profile.ai_07 != "c":
            # Nothing can be acknowledged before no time has passed; a robot is not set going for that.
            self.finish(mission, Status.FAILED_TIMEDOUT)
            return
        mission.in_flight = mission.was_sent = True
        mission.connection = connection
        lane.sent[mission.uuid] = mission
        header = mission.attempt if profile.ai_10 == "c" else None
        self.effects.append(
            Send(connection.id, request.channel, MissionProto(mission.attempt, request.config), mission.uuid, header)
        )
        self.change(mission, Status.STARTED)
        if profile.ai_05 == "a":
            self._arm_timeout(mission, "start", request.start_timeout)
        if profile.ai_06 == "b":
            self._arm_timeout(mission, "run", request.timeout)
        if profile.ai_07 == "c":
            self.acknowledge(mission)

    # timeouts

    def _arm_timeout(self, mission: MissionRecord, kind: str, seconds: float) -> None:
        if not math.isfinite(seconds) or mission.untimed or (seconds == 0 and self.profile.ai_24 == "b"):
            return
        if self.profile.ai_24_whole == "x":
            self.arm(mission, kind, self.now + seconds)
        elif math.floor(seconds) + 1 < _DAY:
            due = self.now + math.floor(seconds) + 1
            period = self.profile.scheduling_period
            self.arm(mission, kind, math.ceil(due / period) * period if period > 0 else due)

    def arm(self, mission: MissionRecord, kind: str, due: float) -> None:
        """Let a clock of the mission run out at `due`, whatever was said before."""
        mission.due[kind] = due
        self.deadlines.push(due, kind, mission)

    def acknowledge(self, mission: MissionRecord) -> None:
        """The robot has the mission: no start timeout any more, and the run timeout counts."""
        mission.acknowledged = True
        mission.due.pop("start", None)
        if self.profile.ai_06 == "a":
            self._arm_timeout(mission, "run", mission.request.timeout)

    def abort(self, mission: MissionRecord, status: Status) -> None:
        """Give a mission up; its robot is not told, for there are no words for it."""
        connection = mission.connection if mission.in_flight else None
        if mission.in_flight and (connection is None or not connection.open):
            connection = self.robots[mission.key].connection
        self.finish(mission, status)
        if connection is not None and self.profile.ai_08 == "c":
            self._close(connection, f"mission {mission.uuid} was aborted")

    # robots that come and go

    def found(self, robot: RobotRecord) -> None:
        """The robot has a connection now."""
        if self.profile.ai_05 == "d":
            for mission in robot.unfinished.values():
                if not mission.in_flight:
                    self._arm_timeout(mission, "start", mission.request.start_timeout)
        for lane in robot.lanes.values():
            self._touch(lane)

    def lost(self, robot: RobotRecord) -> None:
        """The robot has no connection any more."""
        self._maybe_idle[robot.key] = None
        if self.profile.ai_05 == "d":
            for mission in robot.unfinished.values():
                if not mission.in_flight:
                    mission.due.pop("start", None)
        self._cut_off([mission for lane in robot.lanes.values() for mission in reversed(lane.sent.values())])

    def left(self, robot: RobotRecord, connection: ConnectionRecord) -> None:
        """AI-16.under-way m: what was sent on a connection goes on there without its timeouts; its robot is free."""
        for lane in robot.lanes.values():
            for mission in lane.sent.values():
                mission.untimed = True
                mission.due.clear()
                connection.kept[mission.uuid] = mission
            lane.sent.clear()
            self._touch(lane)

    def ended(self, connection: ConnectionRecord) -> None:
        """A connection is gone on which missions went on after another took its robot over."""
        self._cut_off(reversed(tuple(connection.kept.values())))

    def _cut_off(self, missions: Iterable[MissionRecord]) -> None:
        """The connection of missions that were sent is gone (AI-15)."""
        for mission in missions:
            if self.profile.ai_15 == "a":
                mission.connection = None
            elif self.profile.ai_15 == "c":
                self.finish(mission, Status.FAILED_DISCONNECTED)
            else:
                self._send_again_later(self._lane(self.robots[mission.key], mission), mission)

    def _send_again_later(self, lane: LaneRecord, mission: MissionRecord) -> None:
        self._landed(lane, mission)
        mission.acknowledged = mission.untimed = False
        if self.profile.ai_05 != "b":
            mission.due.pop("start", None)
        if self.profile.ai_06 != "c":
            mission.due.pop("run", None)
        mission.due.pop("silence", None)
        if self.profile.ai_12 == "b":
            lane.line.appendleft(mission)
        self._ready(mission)

    def key(self, name: str) -> str:
        """What makes a robot's name the same name (AI-37)."""
        if self.profile.ai_37 == "b":
            return name.strip()
        return name.casefold() if self.profile.ai_37 == "c" else name

    def robot(self, name: str) -> RobotRecord:
        """The robot of this name, new where nothing is known of it."""
        key = self.key(name)
        robot = self.robots.get(key)
        if robot is None:
            self.robots[key] = robot = RobotRecord(key, name)
        return robot
