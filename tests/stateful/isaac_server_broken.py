"""Mission servers with one thing wrong each: the machine has to find it."""

from __future__ import annotations

from collections.abc import Iterator

from attrs import evolve

from missionfsm.isaac.runtime.missions import Effect, MissionRequest, Refused, Send, Status
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire.framing import WireError
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto, TextProto, Uuid, WireStatus


class ForgetsUpstream(MissionServerCore):
    """Dependencies are not kept."""

    def create(self, request: MissionRequest, uuid: Uuid) -> Refused | None:
        refused = super().create(request, uuid)
        if refused is None and request.upstream:
            del self._scheduler.missions[uuid]
            return super().create(evolve(request, upstream=()), uuid)
        return refused


class TakesAnyUpstream(MissionServerCore):
    """Upstream missions that there are not are left out in silence."""

    def create(self, request: MissionRequest, uuid: Uuid) -> Refused | None:
        known = tuple(one for one in request.upstream if one in self._scheduler.missions)
        return super().create(evolve(request, upstream=known), uuid)


class NeverTimesOut(MissionServerCore):
    """start_timeout is not kept."""

    def create(self, request: MissionRequest, uuid: Uuid) -> Refused | None:
        return super().create(evolve(request, start_timeout=1e9), uuid)


class TimesOutEarly(MissionServerCore):
    """start_timeout elapses too early."""

    def create(self, request: MissionRequest, uuid: Uuid) -> Refused | None:
        return super().create(evolve(request, start_timeout=0.5), uuid)


class BelievesAnybody(MissionServerCore):
    """A status is taken from any robot."""

    def received(self, connection: int, message: Message | WireError, now: float) -> tuple[Effect, ...]:
        if isinstance(message, Message) and isinstance(message.payload, MissionStatusProto):
            for robot in self.robots():
                if robot.connection is not None and message.payload.uuid in robot.running:
                    connection = robot.connection
        return super().received(connection, message, now)


class FailureSucceeds(MissionServerCore):
    """A mission that failed is taken to have succeeded."""

    def received(self, connection: int, message: Message | WireError, now: float) -> tuple[Effect, ...]:
        if isinstance(message, Message) and isinstance(message.payload, MissionStatusProto):
            said = message.payload.mission_status
            said = WireStatus.SUCCESS if said is WireStatus.FAILURE else said
            message = evolve(message, payload=evolve(message.payload, mission_status=said))
        return super().received(connection, message, now)


class OverhearsRunning(MissionServerCore):
    """RUNNING is not heard."""

    def received(self, connection: int, message: Message | WireError, now: float) -> tuple[Effect, ...]:
        status = message.payload if isinstance(message, Message) else None
        if isinstance(status, MissionStatusProto) and status.mission_status is WireStatus.RUNNING:
            return self.advance(now)
        return super().received(connection, message, now)


class NeedsNoName(MissionServerCore):
    """Whoever connects is taken for carter-01."""

    def connected(self, connection: int, now: float) -> tuple[Effect, ...]:
        first = super().connected(connection, now)
        name = Message(Header(self.name_channel), TextProto("carter-01"))
        return (*first, *self.received(connection, name, now))


class OneChannel(MissionServerCore):
    """Every mission goes out on the channel "mission"."""

    def submit(self, uuid: Uuid, now: float) -> Refused | tuple[Effect, ...]:
        found = super().submit(uuid, now)
        if isinstance(found, Refused):
            return found
        return tuple(evolve(one, channel="mission") if isinstance(one, Send) else one for one in found)


class AlwaysQueued(MissionServerCore):
    """STARTED is shown as QUEUED."""

    def statuses(self) -> Iterator[tuple[Uuid, Status]]:
        for uuid, status in super().statuses():
            yield uuid, Status.QUEUED if status is Status.STARTED else status


BROKEN: tuple[type[MissionServerCore], ...] = (
    ForgetsUpstream,
    TakesAnyUpstream,
    NeverTimesOut,
    TimesOutEarly,
    BelievesAnybody,
    FailureSucceeds,
    OverhearsRunning,
    NeedsNoName,
    OneChannel,
    AlwaysQueued,
)
