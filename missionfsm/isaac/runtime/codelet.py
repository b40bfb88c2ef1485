"""The robot's mission codelet: one mission at a time, told of while it runs. MissionSubmission › Mission Codelet.

`TABLE` is the machine; the functions below only say which trigger an event is, and what a transition makes the robot
do. Values in, values out: pure. Time is seconds on any clock.
"""

import enum
import math
from typing import Any, Final

import attrs
from attrs import validators

from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.messages import MissionProto, MissionStatusProto, Uuid, WireStatus


class State(enum.Enum):
    """Whether the behavior tree of a mission is running."""

    IDLE = "idle"
    RUNNING = "running"


class Trigger(enum.Enum):
    """What can happen to the codelet."""

    MISSION = "mission"
    """A mission arrives whose configuration can be used."""
    UNUSABLE_MISSION = "unusable_mission"
    """A mission arrives whose configuration cannot."""
    SUCCEEDED = "behavior_succeeded"
    """The behavior tree stops with reportSuccess."""
    FAILED = "behavior_failed"
    """The behavior tree stops with reportFailure."""
    PERIOD = "period"
    """It is time to say that the mission runs."""


TABLE: Final = (
    (Trigger.MISSION, State.IDLE, State.RUNNING),
    (Trigger.MISSION, State.RUNNING, State.RUNNING),
    (Trigger.UNUSABLE_MISSION, State.IDLE, State.IDLE),
    (Trigger.UNUSABLE_MISSION, State.RUNNING, State.IDLE),
    (Trigger.SUCCEEDED, State.RUNNING, State.IDLE),
    (Trigger.FAILED, State.RUNNING, State.IDLE),
    (Trigger.PERIOD, State.RUNNING, State.RUNNING),
)
"""(trigger, source, destination). What is not here has no effect."""

_DESTINATION: Final = {(trigger, source): destination for trigger, source, destination in TABLE}
_LEVELS: Final = 3  # node, component, parameter
DEFAULT_PERIOD: Final = 0.1


@attrs.frozen
class Report:
    """The robot sends this on the status channel."""

    status: MissionStatusProto


@attrs.frozen
class Configure:
    """The application's configuration becomes this JSON text."""

    configuration: str


@attrs.frozen
class StartBehavior:
    """The behavior tree starts."""


@attrs.frozen
class StopBehavior:
    """The behavior tree is stopped before its end."""


Action = Report | Configure | StartBehavior | StopBehavior


@attrs.frozen
class Codelet:
    """The codelet between two events.

    `period` seconds (more than 0) lie between two reports of RUNNING. `ai_33` is how a configuration is applied: "a"
    over what is there, "b" over what was there at first. `next_report` is None while nothing runs. ValueError for a
    period or a reading that does not exist.
    """

    period: float = attrs.field(default=DEFAULT_PERIOD, validator=[validators.gt(0.0), validators.lt(math.inf)])
    ai_33: str = attrs.field(default="a", validator=validators.in_(("a", "b")))
    state: State = State.IDLE
    mission: Uuid | None = None
    next_report: float | None = None
    configuration: str = "{}"
    initial_configuration: str = "{}"


Step = tuple[Codelet, tuple[Action, ...]]


def mission_arrives(codelet: Codelet, mission: MissionProto, now: float) -> Step:
    """A MissionProto is received: it is applied, started and reported, or reported as failed.

    One that runs is preempted: it is stopped and reported as failed before anything is said of the new one (AI-32 a).
    """
    base = codelet.configuration if codelet.ai_33 == "a" else codelet.initial_configuration
    configuration = apply(base, mission.config)
    trigger = Trigger.UNUSABLE_MISSION if configuration is None else Trigger.MISSION
    after = _DESTINATION[trigger, codelet.state]
    actions: tuple[Action, ...] = ()
    if codelet.state is State.RUNNING:
        actions += (StopBehavior(), _report(codelet.mission, WireStatus.FAILURE))
    if configuration is None:
        actions += (_report(mission.uuid, WireStatus.FAILURE),)
        return attrs.evolve(codelet, state=after, mission=None, next_report=None), actions
    actions += (Configure(configuration), StartBehavior(), _report(mission.uuid, WireStatus.RUNNING))
    started = attrs.evolve(
        codelet, state=after, mission=mission.uuid, next_report=now + codelet.period, configuration=configuration
    )
    return started, actions


def behavior_stops(codelet: Codelet, *, success: bool) -> Step:
    """The behavior tree reports its end: the one final status of the mission. Nothing where none runs."""
    after = _DESTINATION.get((Trigger.SUCCEEDED if success else Trigger.FAILED, codelet.state))
    if after is None:
        return codelet, ()
    final = _report(codelet.mission, WireStatus.SUCCESS if success else WireStatus.FAILURE)
    return attrs.evolve(codelet, state=after, mission=None, next_report=None), (final,)


def time_passes(codelet: Codelet, now: float) -> Step:
    """RUNNING is reported if it is time; once, however long the last look was ago."""
    due = codelet.next_report
    if due is None or now < due:
        return codelet, ()
    after = _DESTINATION[Trigger.PERIOD, codelet.state]
    following = due + codelet.period
    if following <= now:
        following = now + codelet.period
    return attrs.evolve(codelet, state=after, next_report=following), (_report(codelet.mission, WireStatus.RUNNING),)


def apply(configuration: str, change: str) -> str | None:
    """The configuration with a mission's config laid over it, parameter by parameter; None if that cannot be used.

    Usable is the text of a JSON object: nodes, their components, their parameters. What is deeper is one value.
    """
    value = strictjson.parse(change)
    if not isinstance(value, dict) or next(strictjson.faults(value), None) is not None:
        return None
    base = strictjson.parse(configuration)
    return strictjson.compact(_overlaid(base if isinstance(base, dict) else {}, value, _LEVELS))


def _overlaid(base: dict[str, Any], change: dict[str, Any], levels: int) -> dict[str, Any]:
    result = dict(base)
    for key, value in change.items():
        before = result.get(key)
        deeper = levels > 1 and isinstance(before, dict) and isinstance(value, dict)
        result[key] = _overlaid(before, value, levels - 1) if deeper and isinstance(before, dict) else value
    return result


def _report(mission: Uuid | None, status: WireStatus) -> Report:
    return Report(MissionStatusProto(mission, status))
