"""Whether an entry of a status message shows a mission: its state, its goals, its feedback and its type."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from missionfsm.bear.mission.promises import FEEDBACK, GOAL_INDEX, GOALS, STATE, TYPE
from missionfsm.bear.mission.readings.messages import AM_08, AM_50_MEMBER, AM_50_SHAPE, AM_51
from missionfsm.bear.mission.readings.scope import part_of
from missionfsm.bear.mission.readings.workflows import AM_26
from missionfsm.bear.mission.state import AUTOMATIC, FAMILY, GOALLESS, NOT_CHOSEN, RETURN_POINT, Family, Kind, Mission
from missionfsm.bear.wire.messages import (
    BaseStatus,
    BaseType,
    CartiType,
    FamilyStatus,
    Goal,
    MissionState,
    MissionType,
    ServiType,
    State,
)
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.step import Mismatch

TYPES: Mapping[Kind, tuple[MissionType, ...]] = {
    Kind.BASE_NAVIGATE: (MissionType(base_type=BaseType.BASE_TYPE_NAVIGATE),),
    Kind.BASE_NAVIGATE_AUTO: (MissionType(base_type=BaseType.BASE_TYPE_NAVIGATE_AUTO),),
    Kind.SERVI_DELIVERY: (
        MissionType(servi_type=ServiType.SERVI_TYPE_SERVING),
        MissionType(servi_type=ServiType.SERVI_TYPE_UNKNOWN),
    ),
    Kind.SERVI_DELIVERY_PATROL: (
        MissionType(servi_type=ServiType.SERVI_TYPE_SERVING_PATROL),
        MissionType(servi_type=ServiType.SERVI_TYPE_UNKNOWN),
    ),
    Kind.SERVI_BUSSING: (MissionType(servi_type=ServiType.SERVI_TYPE_BUSSING),),
    Kind.SERVI_BUSSING_PATROL: (MissionType(servi_type=ServiType.SERVI_TYPE_BUSSING_PATROL),),
    Kind.SERVI_NAVIGATE: (MissionType(servi_type=ServiType.SERVI_TYPE_NAVIGATE),),
    Kind.SERVI_NAVIGATE_AUTO: (MissionType(servi_type=ServiType.SERVI_TYPE_NAVIGATE_AUTO),),
    Kind.CARTI_TRAVERSE: (MissionType(carti_type=CartiType.CARTI_TYPE_TRAVERSE),),
    Kind.CARTI_TRAVERSE_PATROL: (MissionType(carti_type=CartiType.CARTI_TYPE_TRAVERSE_PATROL),),
    Kind.CARTI_NAVIGATE: (MissionType(carti_type=CartiType.CARTI_TYPE_NAVIGATE),),
    Kind.CARTI_NAVIGATE_AUTO: (MissionType(carti_type=CartiType.CARTI_TYPE_NAVIGATE_AUTO),),
}
"""The types that a kind may report, the expected one first. AM-26: a delivery is a serving mission."""

FAMILY_TYPES: Mapping[tuple[Kind, Family], MissionType] = {
    (Kind.BASE_NAVIGATE, Family.SERVI): TYPES[Kind.SERVI_NAVIGATE][0],
    (Kind.BASE_NAVIGATE_AUTO, Family.SERVI): TYPES[Kind.SERVI_NAVIGATE_AUTO][0],
    (Kind.BASE_NAVIGATE, Family.CARTI): TYPES[Kind.CARTI_NAVIGATE][0],
    (Kind.BASE_NAVIGATE_AUTO, Family.CARTI): TYPES[Kind.CARTI_NAVIGATE_AUTO][0],
}
"""The type that a base mission may report instead on a robot of a family (AM-51)."""

MEMBERS: Mapping[Family | None, str] = {
    None: "base_feedback",
    Family.BASE: "base_feedback",
    Family.SERVI: "servi_feedback",
    Family.CARTI: "carti_feedback",
}
"""The member of the feedback that belongs to a family, and to missions of no family."""

Assumed = tuple[Assumption, ...]


class MismatchError(Exception):
    """A message does not show what it is compared with."""

    def __init__(self, rule: str, says: str, *, near: bool = False) -> None:
        super().__init__()
        self.mismatch = Mismatch(rule, says, near)


@functools.lru_cache(maxsize=10_000)
def one_listed(
    family: Family, mission: Mission, message: MissionState, *, pointed: bool, bare: bool
) -> Assumed | Mismatch:
    """What is assumed where an entry shows a mission, or what is wrong with it.

    It is remembered, since lists come again and again with one mission that has changed.

    Args:
        pointed: whether the current mission index is that of the mission.
        bare: whether its feedback came as a bare enum.
    """
    try:
        assumes = _state(mission, message, pointed=pointed)
        _goals(mission, message)
        _goal_index(mission, message)
        return (*assumes, *_feedback(family, mission, message, bare=bare), *_type(family, mission, message))
    except MismatchError as wrong:
        return wrong.mismatch


def has_goals(mission: Mission, message: MissionState) -> bool:
    """Whether a message lists the goals of a mission."""
    try:
        _goals(mission, message)
    except MismatchError:
        return False
    return True


def same_mission(family: Family, mission: Mission, message: MissionState) -> Assumed | None:
    """What is assumed where a message is about a mission, in whatever state; None where it is about another one."""
    try:
        _goals(mission, message)
        return _type(family, mission, message)
    except MismatchError:
        return None


def _state(mission: Mission, message: MissionState, *, pointed: bool) -> Assumed:
    """The entry reports the state that the mission is in."""
    state = mission.state
    if state is not State.STATE_DEFAULT:
        if message.state != state:
            raise MismatchError(STATE.id, f"is {_name(message.state)}, expected {state.name}")
        return ()
    letters = waiting_as(pointed=pointed).get(message.state)
    if letters is None:
        raise MismatchError(STATE.id, f"is {_name(message.state)}, expected STATE_DEFAULT since it waits")
    return (AM_08[letters],)


def waiting_as(*, pointed: bool) -> Mapping[State | int, tuple[str, ...]]:
    """The states that a waiting mission may report, and what each assumes (AM-08).

    One that the index points at would be taken for a mission that was paused.
    """
    if pointed:
        return {State.STATE_DEFAULT: ("a", "c"), State.STATE_UNKNOWN: ("b",)}
    return {State.STATE_DEFAULT: ("a",), State.STATE_UNKNOWN: ("b",), State.STATE_PAUSED: ("c",)}


def _name(state: State | int) -> str:
    return state.name if isinstance(state, State) else f"state {state}"


def _goals(mission: Mission, message: MissionState) -> None:
    """The entry lists the goals that were requested; a return and a charge have goals of the robot's own choice."""
    if mission.kind is Kind.RETURN:
        return
    if mission.kind is Kind.CHARGE:
        if len(message.goals) > 1:
            raise MismatchError(GOALS.id, f"has {len(message.goals)} goals, expected its own place at most")
        return
    wanted = mission.goals
    if RETURN_POINT in wanted and len(message.goals) == len(wanted):
        wanted = tuple(
            any_one if goal == RETURN_POINT else goal for goal, any_one in zip(wanted, message.goals, strict=True)
        )
    if not _same_goals(wanted, message.goals):
        raise MismatchError(GOALS.id, f"has the goals {_goal_names(message.goals)}, expected {_goal_names(wanted)}")


FLOAT_STEP = 1e-6
"""How far a pose may be off, for each unit of it: poses travel as 32-bit floats."""


def _same_goals(wanted: tuple[Goal, ...], shown: tuple[Goal, ...]) -> bool:
    if wanted == shown:
        return True
    return len(wanted) == len(shown) and all(map(_same_goal, wanted, shown))


def _same_goal(wanted: Goal, shown: Goal) -> bool:
    """Whether two goals are equal, poses but for rounding."""
    if wanted.pose is None or shown.pose is None:
        return wanted == shown
    pairs = (
        (wanted.pose.x_meters, shown.pose.x_meters),
        (wanted.pose.y_meters, shown.pose.y_meters),
        (wanted.pose.heading_radians, shown.pose.heading_radians),
    )
    return all(abs(one - other) <= FLOAT_STEP * max(1.0, abs(one)) for one, other in pairs)


def _goal_names(goals: tuple[Goal, ...]) -> str:
    return "[" + ", ".join(str(goal) for goal in goals) + "]"


def _goal_index(mission: Mission, message: MissionState) -> None:
    """The index is that of the active goal; where none is known to be active, it is in range."""
    index, last = message.current_goal_index, max(len(message.goals), len(mission.goals))
    active = mission.state in (State.STATE_RUNNING, State.STATE_PAUSED)
    if active and mission.kind not in GOALLESS and mission.goal != NOT_CHOSEN:
        if index != mission.goal:
            chosen = ": free goals are taken in their order" if mission.kind in AUTOMATIC else ""
            raise MismatchError(GOAL_INDEX.id, f"has current_goal_index {index}, expected {mission.goal}{chosen}")
    elif not -1 <= index <= last:
        raise MismatchError(GOAL_INDEX.id, f"has current_goal_index {index}, outside of its goals")


def _feedback(family: Family, mission: Mission, message: MissionState, *, bare: bool) -> Assumed:
    """Feedback, where there is any, is that of the mission's kind or of the robot's family (AM-50)."""
    members = feedback_given(message)
    if not members:
        return ()
    name, status = members[0]
    if not isinstance(status, BaseStatus | FamilyStatus):
        raise MismatchError(FEEDBACK.id, f"has {name} {status}, which is not documented")
    if mission.state is State.STATE_DEFAULT and status:
        raise MismatchError(FEEDBACK.id, "waits and has feedback")
    assumes: list[Assumption] = []
    own, robots = MEMBERS[FAMILY[mission.kind]], MEMBERS[family]
    if mission.kind not in GOALLESS and own != robots and name in (own, robots):
        assumes.append(AM_50_MEMBER["c" if name == own else "d"])
    elif name not in (own, robots):
        raise MismatchError(FEEDBACK.id, f"has {name}, expected {own}")
    if name != "base_feedback":
        assumes.append(AM_50_SHAPE["b" if bare else "a"])
    return tuple(assumes)


def feedback_given(message: MissionState) -> list[tuple[str, int]]:
    """The members of a mission's feedback that are there, each with its status."""
    feedback = message.mission_feedback
    members = ((name, getattr(feedback, name)) for name in dict.fromkeys(MEMBERS.values())) if feedback else ()
    return [(name, member.status) for name, member in members if member is not None]


def _type(family: Family, mission: Mission, message: MissionState) -> Assumed:
    """The entry has the type that was asked for, or another one that a reading allows (AM-26, AM-51)."""
    shown = message.mission_type or MissionType()
    if mission.kind in GOALLESS:
        return ()
    if mission.kind in AM_26:
        if shown.base_type is not None or shown.carti_type is not None:
            raise MismatchError(TYPE.id, "has a type of another family")
        number = shown.servi_type or ServiType.SERVI_TYPE_UNKNOWN
        documented = isinstance(number, ServiType)
        return (AM_26[mission.kind]["a" if not number else "c" if documented else "b"],)
    expected = TYPES[mission.kind]
    if shown in expected:
        return (AM_51[part_of(mission.kind)]["a"],) if (mission.kind, family) in FAMILY_TYPES else ()
    if shown == FAMILY_TYPES.get((mission.kind, family)):
        return (AM_51[part_of(mission.kind)]["b"],)
    if mission.kind in (Kind.SERVI_DELIVERY, Kind.SERVI_DELIVERY_PATROL) and shown == MissionType():
        return ()
    raise MismatchError(TYPE.id, f"has {_type_name(shown)}, expected {_type_name(expected[0])}")


def _type_name(shown: MissionType) -> str:
    for one in (shown.base_type, shown.servi_type, shown.carti_type):
        if one is not None:
            return one.name if hasattr(one, "name") else f"type {one}"
    return "no type"
