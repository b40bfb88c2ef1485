"""The mission server: missions, dependencies, robots, timeouts. MissionSubmission › MissionServer Class.

:class:`MissionServerCore` is mutable and pure: no socket, no clock, no randomness. What happens comes in through
methods, with the time (seconds on any clock that does not run backwards) and fresh identifiers as arguments; what is to
be done comes out as a tuple of effects, in order. The same calls give the same effects, always. Where the document
leaves a choice, the :class:`~missionfsm.isaac.runtime.profile.Profile` makes it.

The cost of an event does not depend on how many missions wait: a mission counts the upstreams it still waits for, each
robot keeps what is ready in a queue of its own, deadlines lie in a heap whose stale entries are dropped lazily. Only
what an event really changes is touched (a failure cancels all that depends on it).

Always kept: a mission is not sent before all its upstreams have succeeded, nor twice, save by AI-15 b.
"""

import hmac
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

from missionfsm.isaac.runtime.again import restore, run_again, runnable_again
from missionfsm.isaac.runtime.missions import (
    DEFAULT_STATUS_CHANNEL,
    TOKEN_CHANNEL,
    Close,
    Effect,
    Ignored,
    MissionRequest,
    Refused,
    RobotOffline,
    RobotOnline,
    RobotTakenOver,
    RobotView,
    Snapshot,
    Status,
    too_long,
)
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.runtime.records import ConnectionRecord, MissionRecord, RobotRecord
from missionfsm.isaac.runtime.scheduler import Scheduler
from missionfsm.isaac.wire.framing import MAX_LINE, WireError
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.isaac.wire.strictjson import brief_json

_ENDS: Final = {WireStatus.SUCCESS: Status.SUCCESS, WireStatus.FAILURE: Status.FAILED}
_EARLY: Final = 64  # messages kept of a connection without a name, under AI-18 b


class MissionServerCore:
    """See the module. Mutable but pure; not thread-safe.

    Args:
        profile: the readings that are followed.
        name_channel: where robots say their names.
        line_limit: bytes of the longest line that a robot reads, without its end; no mission that needs more is taken.
        tokens: for each name what a connection has to say on `TOKEN_CHANNEL` before it; None lets anybody be anybody.
    """

    def __init__(
        self,
        profile: Profile = DOCUMENTED,
        *,
        name_channel: str = "name",
        line_limit: int = MAX_LINE,
        tokens: Mapping[str, str] | None = None,
    ) -> None:
        self.profile = profile
        self.name_channel = name_channel
        self._line_limit = line_limit
        self._scheduler = Scheduler(profile, self._close, self._notice)
        keys = None if tokens is None else {self._scheduler.key(name): token for name, token in tokens.items()}
        self._tokens = keys
        self._connections: dict[int, ConnectionRecord] = {}
        self._arrived = 0
        self._dropped: list[ConnectionRecord] = []
        self._named: dict[tuple[ConnectionRecord, str], None] = {}

    # what can be asked

    @property
    def unfinished(self) -> int:
        """How many submitted missions have not ended."""
        return self._scheduler.unfinished

    def status(self, mission: Uuid) -> Status | None:
        """Where a mission stands; None for one that was never created here."""
        found = self._scheduler.missions.get(mission)
        return None if found is None else found.status

    def submitted(self, mission: Uuid) -> bool:
        """Whether a mission was submitted, by name or (AI-22 c) as somebody's upstream."""
        found = self._scheduler.missions.get(mission)
        return found is not None and found.number >= 0

    def snapshot(self, mission: Uuid) -> Snapshot:
        """A mission as it is kept over a restart; KeyError for one that was never created here, or is forgotten."""
        found = self._scheduler.missions[mission]
        return Snapshot(found.uuid, found.request, found.status, found.attempt, found.number)

    def statuses(self) -> Iterator[tuple[Uuid, Status]]:
        """All missions in the order in which they were created."""
        return ((uuid, mission.status) for uuid, mission in self._scheduler.missions.items())

    def robots(self) -> tuple[RobotView, ...]:
        """Every robot that is connected or has missions to do."""
        return tuple(
            RobotView(
                robot.name,
                None if robot.connection is None else robot.connection.id,
                len(robot.unfinished),
                tuple(uuid for lane in robot.lanes.values() for uuid in lane.sent),
            )
            for robot in self._scheduler.robots.values()
        )

    def next_deadline(self) -> float | None:
        """When `advance` has something to do next, if nothing else happens; None for never."""
        return self._scheduler.deadlines.first()

    # what can happen

    def create(self, request: MissionRequest, uuid: Uuid) -> Refused | None:
        """Make a mission known, as CREATED, under a fresh identifier. Its upstreams have to be known already.

        So no cycle can be made. Nothing is sent before `submit`.
        """
        if self._known(uuid):
            return Refused(f"mission {uuid} exists already")
        key = self._scheduler.key(request.robot or "")
        if not key and self.profile.ai_19 == "c":
            return Refused("the mission has no robot")
        if (problem := too_long(request.channel, request.config, self._line_limit)) is not None:
            return Refused(f"the mission {problem}")
        for number, upstream in enumerate(request.upstream):
            if upstream not in self._scheduler.missions:
                return Refused(f"upstream[{number}]: there is no mission {upstream} yet")
        mission = self._record(uuid, request, uuid)
        for upstream in dict.fromkeys(request.upstream):
            self._scheduler.depend(mission, self._scheduler.missions[upstream])
        return None

    def _known(self, uuid: Uuid) -> bool:
        return uuid in self._scheduler.missions or uuid in self._scheduler.attempts

    def _record(self, uuid: Uuid, request: MissionRequest, attempt: Uuid) -> MissionRecord:
        follows = self.profile.status_channel_follows_channel
        fallback = f"{request.channel}_status" if follows else DEFAULT_STATUS_CHANNEL
        status_channel = fallback if request.status_channel is None else request.status_channel
        key = self._scheduler.key(request.robot or "")
        self._scheduler.missions[uuid] = made = MissionRecord(uuid, request, key, status_channel, attempt)
        if attempt != uuid:
            self._scheduler.attempts[attempt] = made
        return made

    def submit(self, uuid: Uuid, now: float) -> Refused | tuple[Effect, ...]:
        """A created mission is to be run. MissionSubmission › MissionServer Class."""
        mission = self._scheduler.missions.get(uuid)
        if mission is None:
            return Refused(f"there is no mission {uuid}")
        if mission.number >= 0 and self.profile.ai_22_twice == "e":
            return Refused(f"mission {uuid} was submitted before")
        if self.profile.ai_22_upstream == "b":
            for number, upstream in enumerate(mission.request.upstream):
                if self._scheduler.missions[upstream].number < 0:
                    return Refused(f"upstream[{number}]: mission {upstream} was not submitted")
        self._scheduler.begin(now)
        if mission.number < 0:
            for one in self._scheduler.not_submitted(mission) if self.profile.ai_22_upstream == "c" else (mission,):
                self._scheduler.admit(one)
        return self._scheduler.end()

    def cancel(self, uuid: Uuid, now: float) -> Refused | tuple[Effect, ...]:
        """Give a submitted mission up, as FAILED_CANCELLED; what waits for it is cancelled with it.

        A robot that runs it is not told, for the documents have no words for it: its next mission preempts it.
        """
        mission = self._scheduler.missions.get(uuid)
        if mission is None or mission.number < 0:
            return Refused(f"there is no submitted mission {uuid}")
        if mission.ended:
            return Refused(f"mission {uuid} has ended: {mission.status.value}")
        self._scheduler.begin(now)
        if not mission.ended:  # what was due by now came first
            self._scheduler.abort(mission, Status.FAILED_CANCELLED)
        return self._scheduler.end()

    def retry(self, uuid: Uuid, attempt: Uuid, now: float) -> Refused | tuple[Effect, ...]:
        """Run a mission that failed once more, behind what waits, and all that was cancelled because of it.

        The robot is sent it under the fresh identifier `attempt`, so that nothing that is still said of the last one
        is taken for this one.
        """
        mission = self._scheduler.missions.get(uuid)
        if mission is None:
            return Refused(f"there is no mission {uuid}")
        if not mission.ended or mission.status is Status.SUCCESS:
            return Refused(f"mission {uuid} has not failed: {mission.status.value}")
        if self._known(attempt):
            return Refused(f"mission {attempt} exists already")
        again = runnable_again(self._scheduler, mission)
        if not again:
            return Refused(f"mission {uuid} has an upstream that has not succeeded; retry that")
        self._scheduler.begin(now)
        run_again(self._scheduler, again, attempt)
        return self._scheduler.end()

    def forget(self, uuid: Uuid) -> Refused | None:
        """Remember nothing more of a mission that has ended and that nothing waits for."""
        mission = self._scheduler.missions.get(uuid)
        if mission is None:
            return Refused(f"there is no mission {uuid}")
        if not mission.ended:
            return Refused(f"mission {uuid} has not ended: {mission.status.value}")
        if mission.needed:
            return Refused(f"mission {uuid} is upstream of {mission.needed} that have not ended")
        del self._scheduler.missions[uuid]
        self._scheduler.attempts.pop(mission.attempt, None)
        return None

    def restore(
        self, snapshots: Sequence[Snapshot], resume: str, fresh: Callable[[], Uuid], now: float
    ) -> tuple[Effect, ...]:
        """Go on where a server ended, before anything else happens here.

        Args:
            snapshots: all its missions, in the order in which they were created.
            resume: what becomes of a mission that was under way, see `RESUME`.
            fresh: makes identifiers that nobody has used, for what is run again.
            now: the time.
        """
        self._scheduler.begin(now)
        made = [(self._record(one.uuid, one.request, one.attempt), one) for one in snapshots]
        restore(self._scheduler, made, resume, fresh)
        return self._scheduler.end()

    def connected(self, connection: int, now: float) -> tuple[Effect, ...]:
        """Somebody has connected. `connection` is a number never used before; ValueError if it is in use."""
        if connection in self._connections:
            msg = f"connection {connection} is open already"
            raise ValueError(msg)
        self._scheduler.begin(now)
        self._arrived += 1
        self._connections[connection] = made = ConnectionRecord(connection, self._arrived)
        if self.profile.ai_18_silent == "d":
            self._scheduler.deadlines.push(self._scheduler.now + self.profile.name_timeout, "name", made)
        return self._scheduler.end()

    def disconnected(self, connection: int, now: float) -> tuple[Effect, ...]:
        """A connection has dropped. One that is unknown, or was closed from here, is no matter."""
        self._scheduler.begin(now)
        gone = self._connections.pop(connection, None)
        if gone is not None:
            gone.open = False
            if self.profile.ai_15_when == "p":
                self._dropped.append(gone)
                self._scheduler.wait_for_pass()
            else:
                self._unbind(gone)
        return self._scheduler.end()

    def leaving(self, connection: int) -> None:
        """The other end of a connection has ended it; what it sent before is still to be told, then `disconnected`.

        No mission goes to a connection that ends.
        """
        found = self._connections.get(connection)
        if found is not None:
            found.leaving = True

    def received(self, connection: int, message: Message | WireError, now: float) -> tuple[Effect, ...]:
        """A message has arrived, or something that is none."""
        self._scheduler.begin(now)
        source = self._connections.get(connection)
        if source is not None:
            self._receive(source, message)
        return self._scheduler.end()

    def advance(self, now: float) -> tuple[Effect, ...]:
        """Time has come to `now`. All that is due by then happens now, not earlier: see `elapse` for virtual time."""
        self._scheduler.begin(now)
        return self._scheduler.end()

    # connections

    def _close(self, connection: ConnectionRecord, reason: str) -> None:
        del self._connections[connection.id]
        connection.open = False
        self._scheduler.effects.append(Close(connection.id, reason))
        self._unbind(connection)

    def _unbind(self, connection: ConnectionRecord) -> None:
        robot, connection.robot = connection.robot, None
        self._scheduler.ended(connection)
        if robot is None:
            return
        robot.connection = None
        self._scheduler.effects.append(RobotOffline(robot.name, connection.id))
        self._scheduler.lost(robot)

    def _notice(self) -> None:
        """A scheduling pass begins: drops and names that waited for it."""
        dropped, self._dropped = self._dropped, []
        for gone in dropped:
            self._unbind(gone)
        named, self._named = self._named, {}
        for connection, text in named:
            if connection.open:
                self._name(connection, text)

    def _says_name(self, connection: ConnectionRecord, text: str) -> None:
        known = connection.robot is not None and connection.robot.key == self._scheduler.key(text)
        if not self.profile.names_wait_for_pass or known:  # robots say it again and again
            self._name(connection, text)
        else:
            self._named[connection, text] = None
            self._scheduler.wait_for_pass()

    def _name(self, connection: ConnectionRecord, text: str) -> None:
        key = self._scheduler.key(text)
        bound = connection.robot
        if bound is not None and bound.key == key:
            return  # said again, as robots do
        refused = self._refused(connection, key)
        if refused:
            self._ignore(connection, refused)
        elif self._tokens is not None and not _same(self._tokens.get(key), connection.token):
            self._close(connection, f"it says the name {brief_json(text)} without its token")
        else:
            self._claim(connection, text)

    def _refused(self, connection: ConnectionRecord, key: str) -> str:
        """Why a connection cannot take a name, whoever has it; empty where it can."""
        if not key:
            return "an empty name is no name"
        if connection.displaced and self.profile.ai_16_back == "r":
            return "another connection took its name over"
        if connection.robot is not None and self.profile.ai_17 == "a":
            return "it has a name already and cannot take another"
        return ""

    def _claim(self, connection: ConnectionRecord, text: str) -> None:
        """A connection takes a name; where another has it, the profile says what becomes of the two."""
        robot = self._scheduler.robot(text)
        if robot.connection is not None and not robot.connection.open:
            self._unbind(robot.connection)  # dropped, and no pass has come since
        other = robot.connection
        if other is None:
            self._unbind(connection)
            self._scheduler.effects.append(RobotOnline(text, connection.id))
            self._bind(connection, robot, text)
        elif self.profile.ai_16 == "d":
            self._close(connection, "another connection has that name")
        elif self.profile.ai_16 == "n" or (self.profile.ai_16 == "a" and connection.number > other.number):
            self._take_over(connection, robot, other, text)
        else:
            self._ignore(connection, "another connection has that name")

    def _take_over(self, connection: ConnectionRecord, robot: RobotRecord, other: ConnectionRecord, text: str) -> None:
        self._unbind(connection)
        other.robot = robot.connection = None
        other.displaced = True
        self._scheduler.effects.append(RobotTakenOver(text, other.id, connection.id))
        if self.profile.ai_16_under_way == "m":
            self._scheduler.left(robot, other)
        else:
            self._scheduler.lost(robot)
        self._bind(connection, robot, text)

    def _bind(self, connection: ConnectionRecord, robot: RobotRecord, name: str) -> None:
        connection.robot, robot.connection, robot.name = robot, connection, name
        early, connection.early = connection.early, []
        for message in early:
            self._receive(connection, message)
        self._scheduler.found(robot)

    # messages

    def _ignore(self, connection: ConnectionRecord, reason: str) -> None:
        self._scheduler.effects.append(Ignored(connection.id, reason))

    def _receive(self, source: ConnectionRecord, message: Message | WireError) -> None:
        if isinstance(message, WireError):
            closes = self.profile.ai_38 == "d" if message.kind == "type" else self.profile.ai_26_bad == "f"
            if closes:
                self._close(source, str(message))
            else:
                self._ignore(source, str(message))
        elif isinstance(message.payload, TextProto):
            if message.header.channel == self.name_channel:
                self._says_name(source, message.payload.text)
            elif message.header.channel == TOKEN_CHANNEL and self._tokens is not None:
                source.token = message.payload.text
            else:
                self._ignore(source, "a text on a channel that is not the name channel")
        elif isinstance(message.payload, MissionProto):
            self._ignore(source, "a mission from a robot")
        elif source.robot is not None or source.kept:
            self._status(source, message.header, message.payload)
        elif self.profile.ai_18_early == "b" and len(source.early) < _EARLY:
            source.early.append(message)
        else:
            self._ignore(source, "a status before the name")

    def _status(self, source: ConnectionRecord, header: Header, payload: MissionStatusProto) -> None:
        mission = self._meant(source, header, payload)
        if mission is None:
            self._ignore(source, "a status of no mission of this robot")
        elif not _may_report(source, mission) or mission.status_channel != header.channel or not mission.was_sent:
            self._ignore(source, f"a status of mission {mission.uuid}, which is not waited for here")
        elif not mission.in_flight:
            self._late(source, mission, payload.mission_status)
        elif payload.mission_status is WireStatus.RUNNING:
            mission.heard = self._scheduler.now
            if mission.status is not Status.RUNNING:
                self._scheduler.change(mission, Status.RUNNING)
                if not mission.acknowledged:
                    self._scheduler.acknowledge(mission)
                if self.profile.ai_31 == "a":
                    self._scheduler.arm(mission, "silence", self._scheduler.now + self.profile.silence_timeout)
        elif self.profile.ai_07 == "b" and not mission.acknowledged:
            self._ignore(source, f"mission {mission.uuid} ended before it was acknowledged")
        else:
            self._scheduler.finish(mission, _ENDS[payload.mission_status])

    def _meant(self, source: ConnectionRecord, header: Header, payload: MissionStatusProto) -> MissionRecord | None:
        uuid = header.uuid if self.profile.ai_10 == "c" else payload.uuid
        if uuid is not None:
            found = self._scheduler.attempts.get(uuid) or self._scheduler.missions.get(uuid)
            return None if found is None or found.attempt != uuid else found
        if self.profile.ai_10 != "a":
            return None
        lanes = () if source.robot is None else source.robot.lanes.values()
        running = [*source.kept.values(), *(mission for lane in lanes for mission in lane.sent.values())]
        return max(
            (mission for mission in running if mission.status_channel == header.channel),
            key=lambda mission: mission.number,
            default=None,
        )

    def _late(self, source: ConnectionRecord, mission: MissionRecord, status: WireStatus) -> None:
        aborted = mission.status is Status.FAILED_TIMEDOUT
        believed = self.profile.ai_09 == "b" or (self.profile.ai_09 == "c" and aborted)
        if mission.ended and believed and status is not WireStatus.RUNNING:
            self._scheduler.change(mission, _ENDS[status])
        else:
            self._ignore(source, f"a status of mission {mission.uuid}, which does not run any more")


def _may_report(source: ConnectionRecord, mission: MissionRecord) -> bool:
    """Whether a connection is listened to about a mission: the one that it goes on on, or else that of its robot."""
    link = mission.connection
    if mission.in_flight and link is not None and link.kept.get(mission.uuid) is mission:
        return link is source
    return source.robot is not None and mission.key == source.robot.key


def _same(wanted: str | None, said: str) -> bool:
    """Whether a token is the wanted one; the time that this takes tells nothing of it."""
    return wanted is not None and hmac.compare_digest(wanted.encode(), said.encode("utf-8", "replace"))


def elapse(core: MissionServerCore, now: float) -> tuple[Effect, ...]:
    """Let virtual time run to `now`, stopping at every deadline, so that what is due happens when it is due.

    However the way to `now` is cut, the effects are the same.
    """
    effects: list[Effect] = []
    while (due := core.next_deadline()) is not None and due <= now:
        effects += core.advance(due)
    effects += core.advance(now)
    return tuple(effects)
