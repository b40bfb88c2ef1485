"""A robot as the mission server sees one: codelet, name and connection, with a script for a behavior tree.

The codelet is :mod:`missionfsm.isaac.runtime.codelet`. Around it: the name, said on connection and then periodically
(``MissionSubmission › Robot Identification``), and a behavior that ends as its script says. Mutable and pure: events
and time come in, effects go out, as in :mod:`missionfsm.isaac.runtime.server`.
"""

import math
import re
from collections import deque
from typing import Final

import attrs
from attrs import validators

from missionfsm.isaac.runtime import codelet as machine
from missionfsm.isaac.runtime.codelet import DEFAULT_PERIOD, Action, Codelet, Report, StartBehavior, StopBehavior
from missionfsm.isaac.runtime.missions import DEFAULT_CHANNEL, DEFAULT_STATUS_CHANNEL, TOKEN_CHANNEL
from missionfsm.isaac.wire.framing import WireError
from missionfsm.isaac.wire.messages import Message, MissionProto, MissionStatusProto, TextProto, WireStatus

NAME_PERIOD: Final = 0.25
OUTCOMES: Final = ("succeed", "fail", "hang")

_KEPT: Final = 16  # final statuses kept for a server that is away
_STEP: Final = re.compile(r"(\w+)(?::([0-9]+(?:\.[0-9]*)?|\.[0-9]+))?", re.ASCII)


@attrs.frozen
class Behavior:
    """How one mission goes: it succeeds or fails after `duration` seconds, or hangs."""

    outcome: str = attrs.field(validator=validators.in_(OUTCOMES))
    duration: float = attrs.field(default=1.0, validator=[validators.ge(0.0), validators.lt(math.inf)])


@attrs.frozen
class ScriptProblem:
    """What is wrong with a script."""

    problem: str

    def __str__(self) -> str:
        return self.problem


def parse_script(text: str, duration: float = 1.0) -> tuple[Behavior, ...] | ScriptProblem:
    """A script such as ``succeed:0.5,fail,hang``: how each mission goes; the last goes on for all that follow.

    A step without a number takes `duration` seconds.
    """
    steps: list[Behavior] = []
    for number, step in enumerate(text.split(","), start=1):
        match = _STEP.fullmatch(step.strip())
        if match is None or match[1] not in OUTCOMES:
            wanted = "|".join(OUTCOMES)
            return ScriptProblem(f"step {number}, {step.strip()!r}: wanted {wanted}, or with seconds as in fail:0.5")
        steps.append(Behavior(match[1], duration if match[2] is None else float(match[2])))
    return tuple(steps)


@attrs.frozen
class Transmit:
    """The robot sends this on this channel; the adapter stamps the header."""

    channel: str
    payload: MissionStatusProto | TextProto


@attrs.frozen
class Did:
    """What the codelet had the robot do."""

    action: Action


RobotEffect = Transmit | Did


@attrs.frozen
class Channels:
    """Where a robot says its name, listens for missions and sends statuses."""

    name: str = "name"
    missions: str = DEFAULT_CHANNEL
    statuses: str = DEFAULT_STATUS_CHANNEL


class RobotCore:
    """See the module.

    `script` says how each mission goes; an empty one leaves that to `behavior_stops`. A `token` is said before the name
    on every connection. A status made while no server is connected cannot be sent: RUNNING is dropped, a final one is
    kept (the last 16) and sent after the name on the next connection.
    """

    def __init__(
        self,
        name: str,
        *,
        script: tuple[Behavior, ...] = (),
        codelet: Codelet | None = None,
        channels: Channels = Channels(),
        name_period: float = NAME_PERIOD,
        token: str | None = None,
    ) -> None:
        if not 0 < name_period < math.inf:
            msg = f"name_period is a number of seconds, more than 0, not {name_period}"
            raise ValueError(msg)
        self.name = name
        self.codelet = Codelet(DEFAULT_PERIOD) if codelet is None else codelet
        self._script = script
        self._channels = channels
        self._name_period = name_period
        self._token = token
        self._connected = False
        self._next_name: float | None = None
        self._behavior: Behavior | None = None
        self._behavior_ends: float | None = None
        self._started = 0
        self._kept: deque[MissionStatusProto] = deque(maxlen=_KEPT)

    def next_deadline(self) -> float | None:
        """When `advance` has something to do next, if nothing else happens; None for never."""
        due = (self._next_name, self._behavior_ends, self.codelet.next_report)
        return min((time for time in due if time is not None), default=None)

    def connected(self, now: float) -> tuple[RobotEffect, ...]:
        """A server has accepted the connection: it is told the name, and what it missed."""
        effects = self._pass(now)
        self._connected = True
        self._next_name = now + self._name_period
        if self._token is not None:
            effects.append(Transmit(TOKEN_CHANNEL, TextProto(self._token)))
        effects.append(Transmit(self._channels.name, TextProto(self.name)))
        effects += [Transmit(self._channels.statuses, status) for status in self._kept]
        self._kept.clear()
        return tuple(effects)

    def disconnected(self, now: float) -> tuple[RobotEffect, ...]:
        """The connection has dropped. The mission goes on."""
        effects = self._pass(now)
        self._connected = False
        self._next_name = None
        return tuple(effects)

    def received(self, message: Message | WireError, now: float) -> tuple[RobotEffect, ...]:
        """A line from the server; what is no mission on the mission channel has no effect."""
        effects = self._pass(now)
        if (
            isinstance(message, Message)
            and isinstance(message.payload, MissionProto)
            and message.header.channel == self._channels.missions
        ):
            effects += self._step(machine.mission_arrives(self.codelet, message.payload, now), now)
        return tuple(effects)

    def behavior_stops(self, now: float, *, success: bool) -> tuple[RobotEffect, ...]:
        """The behavior tree reports its end, whatever the script says."""
        effects = self._pass(now)
        self._behavior_ends = None
        effects += self._step(machine.behavior_stops(self.codelet, success=success), now)
        return tuple(effects)

    def advance(self, now: float) -> tuple[RobotEffect, ...]:
        """Time has come to `now`."""
        return tuple(self._pass(now))

    def _pass(self, now: float) -> list[RobotEffect]:
        effects: list[RobotEffect] = []
        if self._next_name is not None and self._next_name <= now:
            following = self._next_name + self._name_period
            self._next_name = following if following > now else now + self._name_period
            effects.append(Transmit(self._channels.name, TextProto(self.name)))
        ends, behavior = self._behavior_ends, self._behavior
        if ends is not None and behavior is not None and ends <= now:
            self._behavior_ends = None
            success = behavior.outcome == "succeed"
            effects += self._step(machine.behavior_stops(self.codelet, success=success), now)
        effects += self._step(machine.time_passes(self.codelet, now), now)
        return effects

    def _step(self, step: machine.Step, now: float) -> list[RobotEffect]:
        self.codelet, actions = step
        effects: list[RobotEffect] = []
        for action in actions:
            effects.append(Did(action))
            if isinstance(action, StopBehavior):
                self._behavior_ends = None
            elif isinstance(action, StartBehavior):
                self._start(now)
            elif isinstance(action, Report):
                effects += self._say(action.status)
        return effects

    def _start(self, now: float) -> None:
        if self._script:
            self._behavior = self._script[min(self._started, len(self._script) - 1)]
            hangs = self._behavior.outcome == "hang"
            self._behavior_ends = None if hangs else now + self._behavior.duration
        self._started += 1

    def _say(self, status: MissionStatusProto) -> list[RobotEffect]:
        if self._connected:
            return [Transmit(self._channels.statuses, status)]
        if status.mission_status is not WireStatus.RUNNING:
            self._kept.append(status)
        return []
