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

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

from missionfsm.isaac.runtime.again import restore, run_again, runnable_again
from missionfsm.isaac.runtime.links import Links
from missionfsm.isaac.runtime.missions import (
    DEFAULT_STATUS_CHANNEL,
    TOKEN_CHANNEL,
    Effect,
    MissionRequest,
    Refused,
    RobotView,
    Snapshot,
    Status,
    too_long,
)
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.runtime.records import ConnectionRecord, MissionRecord
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
        self._links = Links(profile, tokens, self._receive)
        self._scheduler = self._links.scheduler

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
        if connection in self._links.connections:
            msg = f"connection {connection} is open already"
            raise ValueError(msg)
        self._scheduler.begin(now)
        self._links.add(connection)
        return self._scheduler.end()

    def disconnected(self, connection: int, now: float) -> tuple[Effect, ...]:
        """A connection has dropped. One that is unknown, or was closed from here, is no matter."""
        self._scheduler.begin(now)
        self._links.drop(connection)
        return self._scheduler.end()

    def leaving(self, connection: int) -> None:
        """The other end of a connection has ended it; what it sent before is still to be told, then `disconnected`.

        No mission goes to a connection that ends.
        """
        found = self._links.connections.get(connection)
        if found is not None:
            found.leaving = True

    def received(self, connection: int, message: Message | WireError, now: float) -> tuple[Effect, ...]:
        """A message has arrived, or something that is none."""
        self._scheduler.begin(now)
        source = self._links.connections.get(connection)
        if source is not None:
            self._receive(source, message)
        return self._scheduler.end()

    def advance(self, now: float) -> tuple[Effect, ...]:
        """Time has come to `now`. All that is due by then happens now, not earlier: see `elapse` for virtual time."""
        self._scheduler.begin(now)
        return self._scheduler.end()

    # what is said

    def _receive(self, source: ConnectionRecord, message: Message | WireError) -> None:
        if isinstance(message, WireError):
            closes = self.profile.ai_38 == "d" if message.kind == "type" else self.profile.ai_26_bad == "f"
            if closes:
                self._links.close(source, str(message))
            else:
                self._links.ignore(source, str(message))
        elif isinstance(message.payload, TextProto):
            if message.header.channel == self.name_channel:
                self._links.says_name(source, message.payload.text)
            elif message.header.channel == TOKEN_CHANNEL and self._links.guarded:
                source.token = message.payload.text
            else:
                self._links.ignore(source, "a text on a channel that is not the name channel")
        elif isinstance(message.payload, MissionProto):
            self._links.ignore(source, "a mission from a robot")
        elif source.robot is not None or source.kept:
            self._status(source, message.header, message.payload)
        elif self.profile.ai_18_early == "b" and len(source.early) < _EARLY:
            source.early.append(message)
        else:
            self._links.ignore(source, "a status before the name")

    def _status(self, source: ConnectionRecord, header: Header, payload: MissionStatusProto) -> None:
        mission = self._meant(source, header, payload)
        if mission is None:
            self._links.ignore(source, "a status of no mission of this robot")
        elif not _may_report(source, mission) or mission.status_channel != header.channel or not mission.was_sent:
            self._links.ignore(source, f"a status of mission {mission.uuid}, which is not waited for here")
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
            self._links.ignore(source, f"mission {mission.uuid} ended before it was acknowledged")
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
            self._links.ignore(source, f"a status of mission {mission.uuid}, which does not run any more")


def _may_report(source: ConnectionRecord, mission: MissionRecord) -> bool:
    """Whether a connection is listened to about a mission: the one that it goes on on, or else that of its robot."""
    link = mission.connection
    if mission.in_flight and link is not None and link.kept.get(mission.uuid) is mission:
        return link is source
    return source.robot is not None and mission.key == source.robot.key


def elapse(core: MissionServerCore, now: float) -> tuple[Effect, ...]:
    """Let virtual time run to `now`, stopping at every deadline, so that what is due happens when it is due.

    However the way to `now` is cut, the effects are the same.
    """
    effects: list[Effect] = []
    while (due := core.next_deadline()) is not None and due <= now:
        effects += core.advance(due)
    effects += core.advance(now)
    return tuple(effects)
