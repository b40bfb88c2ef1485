"""Robots with one thing wrong each: the machine has to find it."""

from __future__ import annotations

from attrs import evolve

from missionfsm.isaac.runtime.codelet import StopBehavior
from missionfsm.isaac.runtime.robot import Did, RobotCore, RobotEffect, Transmit
from missionfsm.isaac.wire.framing import WireError
from missionfsm.isaac.wire.messages import Message, MissionProto, MissionStatusProto, WireStatus


def _statuses(effects: tuple[RobotEffect, ...], said: WireStatus) -> list[Transmit]:
    transmits = [one for one in effects if isinstance(one, Transmit)]
    return [
        one for one in transmits if isinstance(one.payload, MissionStatusProto) and one.payload.mission_status is said
    ]


class RefusesToPreempt(RobotCore):
    """A mission that arrives while another runs is dropped."""

    def received(self, message: Message | WireError, now: float) -> tuple[RobotEffect, ...]:
        busy = self.codelet.mission is not None
        dropped = busy and isinstance(message, Message) and isinstance(message.payload, MissionProto)
        return self.advance(now) if dropped else super().received(message, now)


class PreemptsSilently(RobotCore):
    """The mission that is preempted is not said to have failed."""

    def received(self, message: Message | WireError, now: float) -> tuple[RobotEffect, ...]:
        effects = super().received(message, now)
        failed = _statuses(effects, WireStatus.FAILURE) if any(Did(StopBehavior()) == one for one in effects) else []
        return tuple(one for one in effects if one not in failed)


class FailsAsSuccess(RobotCore):
    """A behavior tree that fails is reported as a success."""

    def behavior_stops(self, now: float, *, success: bool) -> tuple[RobotEffect, ...]:
        return super().behavior_stops(now, success=success or now >= 0)


class SaysTheEndTwice(RobotCore):
    """The final status is sent twice."""

    def behavior_stops(self, now: float, *, success: bool) -> tuple[RobotEffect, ...]:
        effects = super().behavior_stops(now, success=success)
        return (*effects, *_statuses(effects, WireStatus.SUCCESS))


class RunsSilently(RobotCore):
    """RUNNING is said once, and not periodically."""

    def advance(self, now: float) -> tuple[RobotEffect, ...]:
        effects = super().advance(now)
        running = _statuses(effects, WireStatus.RUNNING)
        return tuple(one for one in effects if one not in running)


class SaysItsNameOnce(RobotCore):
    """The name is said on connection only."""

    def advance(self, now: float) -> tuple[RobotEffect, ...]:
        return tuple(one for one in super().advance(now) if not isinstance(one, Transmit) or one.channel != "name")


class ForgetsItsName(RobotCore):
    """On a second connection no name is said at once."""

    def connected(self, now: float) -> tuple[RobotEffect, ...]:
        effects = super().connected(now)
        again = self.__dict__.setdefault("before", False)
        self.__dict__["before"] = True
        return tuple(one for one in effects if not again or not isinstance(one, Transmit))


class KeepsItsConfiguration(RobotCore):
    """The config of a mission is not applied."""

    def received(self, message: Message | WireError, now: float) -> tuple[RobotEffect, ...]:
        if isinstance(message, Message) and isinstance(message.payload, MissionProto):
            message = evolve(message, payload=evolve(message.payload, config="{}"))
        return super().received(message, now)


class TakesAnyChannel(RobotCore):
    """A MissionProto is taken from any channel."""

    def received(self, message: Message | WireError, now: float) -> tuple[RobotEffect, ...]:
        if isinstance(message, Message):
            message = evolve(message, header=evolve(message.header, channel="mission"))
        return super().received(message, now)


BROKEN: tuple[type[RobotCore], ...] = (
    RefusesToPreempt,
    PreemptsSilently,
    FailsAsSuccess,
    SaysTheEndTwice,
    RunsSilently,
    SaysItsNameOnce,
    ForgetsItsName,
    KeepsItsConfiguration,
    TakesAnyChannel,
)
