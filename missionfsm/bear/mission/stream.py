"""The status stream of the Mission page: what a message shows, and what it may look like."""

from __future__ import annotations

import functools
from collections.abc import Hashable, Iterator, Mapping, Sequence

from attrs import evolve

from missionfsm.bear.mission.readings.messages import (
    AM_08,
    AM_14_ENDED,
    AM_14_GAP,
    AM_14_HALTED,
    AM_35,
    AM_36,
    AM_49,
    AM_50_MEMBER,
    AM_50_SHAPE,
    AM_51,
)
from missionfsm.bear.mission.readings.scope import part_of
from missionfsm.bear.mission.readings.starting import AM_63
from missionfsm.bear.mission.readings.unlisted import AM_58_SENT
from missionfsm.bear.mission.readings.workflows import AM_26
from missionfsm.bear.mission.state import (
    ENDED,
    FAMILY,
    GOALLESS,
    MISSION,
    NOT_CHOSEN,
    RETURN_POINT,
    SYSTEM_NAME,
    Family,
    Kind,
    Mission,
    Robot,
)
from missionfsm.bear.wire.messages import (
    BaseStatus,
    BaseType,
    CartiType,
    FamilyStatus,
    Goal,
    MissionState,
    MissionStates,
    MissionType,
    ServiType,
    State,
)
from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import Rule, promise
from missionfsm.kernel.step import Match, Mismatch
from missionfsm.kernel.text import counted
from missionfsm.kernel.values import value

TOPIC = "mission status"
MORE = "with fields that are not documented"
"""The shape of an answer that has more than it should (AM-58)."""


@value(cache_hash=True)
class Listing:
    """What a status message shows: the listed missions in order, which of them is active, and on what robot.

    `fresh`: no mission was ever assigned. `held`: none of those that wait is going to start, which nobody sees.
    `created`: the call that has just made the first mission that waits, which has nothing to wait for.
    """

    missions: tuple[Mission, ...]
    active: int | None
    family: Family
    fresh: bool = False
    held: bool = False
    created: str = ""

    def looks_like(self, other: Listing) -> bool:
        """Whether a subscriber could not tell it from the other."""
        return (self.missions, self.active, self.fresh) == (other.missions, other.active, other.fresh)

    def may_look_like(self, other: Listing) -> bool:
        """Whether a subscriber need not be able to tell: a goal that is not selected may be shown as the first."""
        if self.active != other.active or self.fresh != other.fresh or len(self.missions) != len(other.missions):
            return False
        return _selected(self.missions) == _selected(other.missions)


def _selected(missions: tuple[Mission, ...]) -> tuple[Mission, ...]:
    return tuple([evolve(one, goal=0) if one.goal == NOT_CHOSEN else one for one in missions])


@functools.lru_cache(maxsize=64)
def listing(robot: Robot) -> Listing:
    """What a subscriber of the robot is shown."""
    return Listing(
        robot.listed(tuple([mission.visible for mission in robot.turns])),
        (robot.assigned[len(robot.done)] if robot.assigned else len(robot.done)) if robot.active else None,
        robot.world.family,
        robot.fresh,
        robot.active is None and bool(robot.pending) and (robot.halted or robot.pending[0].held),
    )


@value(cache_hash=True)
class Seen:
    """A status message without its mission ids and metadata; `named` tells which missions have an id.

    `bare` tells of each mission whether its feedback came as a bare enum instead of a message; `timed` whether the
    message says when it was recorded; `more` whether it has fields that are not documented.
    """

    states: MissionStates
    named: tuple[bool, ...]
    bare: tuple[bool, ...]
    timed: bool = True
    more: bool = False


def _promise(name: str, says: str, *place: str) -> Rule:
    return promise(name, says, cite=MISSION[("SubscribeMissionStatus", *place)]).registered(
        SYSTEM_NAME, "SubscribeMissionStatus"
    )


WELL_FORMED = _promise("messages-are-well-formed", "A message has the documented form.", "Response")
SEQUENCE = _promise(
    "sequence-numbers-grow", "A sequence number is larger than the one before, or 0; never negative.", "EventMetadata"
)
ALL_LISTED = _promise(
    "all-missions-are-listed", "Every mission of the robot is listed once, and no other.", "MissionStates"
)
CURRENT = _promise(
    "the-current-mission-index-is-the-active-mission",
    "current_mission_index is that of the active mission, -1 if none is active.",
    "MissionStates",
)
STATE = _promise("the-state-is-reported", "A mission is reported in the state that it is in.", "State enum")
GOALS = _promise(
    "the-goals-are-those-requested", "A mission lists its goals in the order of the request.", "MissionState"
)
GOAL_INDEX = _promise(
    "the-current-goal-index-is-the-active-goal", "current_goal_index is that of the active goal.", "MissionState"
)
FEEDBACK = _promise("the-feedback-fits-the-mission", "Feedback is of the mission's kind.", "MissionFeedback")
TYPE = _promise("the-type-is-that-requested", "A mission has the type that was asked for.", "MissionType")
OWED = _promise(
    "updates-follow-the-state", "Every state that lasts is shown, in order, and none that was never reached."
)
RULES = (WELL_FORMED, SEQUENCE, ALL_LISTED, CURRENT, STATE, GOALS, GOAL_INDEX, FEEDBACK, TYPE, OWED)

_SHOWN = tuple(rule.id for rule in RULES)
ANSWERS_FOR: Mapping[str, tuple[str, ...]] = {
    entry: (rule.id,)
    for rule, entries in (
        (STATE, ("AM-08", "AM-09", "AM-10", "AM-45.none")),
        (CURRENT, ("AM-14",)),
        (ALL_LISTED, ("AM-13", "AM-35", "AM-36")),
        (TYPE, ("AM-26", "AM-51")),
        (GOALS, ("AM-27",)),
        (GOAL_INDEX, ("AM-45.when", "AM-64")),
        (FEEDBACK, ("AM-50",)),
        (WELL_FORMED, ("AM-49", "AM-58.sent")),
        (OWED, ("AM-47", "AM-54", "AM-63")),
    )
    for entry in entries
}
"""By what is shown, the promise that a question is about; see `missionfsm.kernel.spec.Spec`."""

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
Assumed = tuple[Assumption, ...]


class _WrongError(Exception):
    """The message cannot show the view, or a mission of it."""

    def __init__(self, rule: str, says: str, *, near: bool = False) -> None:
        super().__init__()
        self.mismatch = Mismatch(rule, says, near)


def matches(view: Listing, content: Seen | Malformed) -> tuple[Match, ...] | Mismatch:
    """The ways in which a message shows a listing, or the first thing that is wrong with it."""
    if isinstance(content, Malformed):
        return Mismatch(WELL_FORMED.id, content.says)
    try:
        if not view.missions and content.states.missions:
            assumes: Assumed = _placeholder(view, content)
        else:
            assumes = _listed(view, content)
        assumes = (*_about(content), *assumes)
    except _WrongError as wrong:
        return wrong.mismatch
    # Readings that contradict each other in one message leave no explanation; the belief would find out as well.
    return (Match(assumes, tuple((index, index) for index in range(len(view.missions))), _SHOWN),)


def _about(content: Seen) -> Iterator[Assumption]:
    """AM-49, AM-58: what is assumed of a message whatever it shows."""
    if not content.timed:
        yield AM_49["b"]
    if content.more:
        yield AM_58_SENT["messages"]["b"]


def _so_many(missions: Sequence[object]) -> str:
    return f"{counted(len(missions), 'mission')} {'is' if len(missions) == 1 else 'are'} listed"


def _placeholder(view: Listing, content: Seen) -> Assumed:
    """AM-35, AM-36: an empty list may be shown as one mission in STATE_DEFAULT without an id."""
    only = content.states.missions[0]
    if len(content.states.missions) > 1 or content.named[0] or only.state != State.STATE_DEFAULT or only.goals:
        raise _WrongError(ALL_LISTED.id, f"{_so_many(content.states.missions)}; the robot has none")
    index = content.states.current_mission_index
    if index not in (-1, 0):
        raise _WrongError(CURRENT.id, f"current_mission_index is {index}, expected -1 or 0")
    if only.current_goal_index not in (-1, 0):
        raise _WrongError(GOAL_INDEX.id, f"mission 0 has current_goal_index {only.current_goal_index} and no goals")
    if any(status for _, status in _given(only)):
        raise _WrongError(FEEDBACK.id, "mission 0 waits and has feedback")
    return (AM_36["b"] if view.fresh else AM_35["c"],)


def _listed(view: Listing, content: Seen) -> Assumed:
    shown = content.states.missions
    if len(shown) != len(view.missions):
        raise _WrongError(ALL_LISTED.id, f"{_so_many(shown)}; the robot has {len(view.missions)}")
    if not all(content.named):
        raise _WrongError(ALL_LISTED.id, f"mission {content.named.index(False)} has no id")
    assumes: list[Assumption] = []
    if not view.missions:
        assumes.append(AM_36["a", "c"] if view.fresh else AM_35["a"])
    pointed = content.states.current_mission_index
    for index, (mission, message) in enumerate(zip(view.missions, shown, strict=True)):
        found = _one_listed(view.family, mission, message, pointed=pointed == index, bare=content.bare[index])
        if isinstance(found, Mismatch):
            raise _WrongError(found.rule, f"mission {index} {found.says}")
        assumes += found
    # The index is judged last: where the states are wrong, it follows them.
    assumes += _current(view, content.states.current_mission_index)
    assumes += _first_start(view)
    return tuple(dict.fromkeys(assumes))


@functools.lru_cache(maxsize=10_000)
def _one_listed(
    family: Family, mission: Mission, message: MissionState, *, pointed: bool, bare: bool
) -> Assumed | Mismatch:
    """What is assumed where a message shows a mission so, or what is wrong with it.

    Lists come again and again with one mission that has changed, so that this is remembered.

    Args:
        pointed: whether the current mission index is that of the mission.
        bare: whether its feedback came as a bare enum.
    """
    try:
        assumes = _state(mission, message, pointed=pointed)
        _goals(mission, message)
        _goal_index(mission, message)
        return (*assumes, *_feedback(family, mission, message, bare=bare), *_type(family, mission, message))
    except _WrongError as wrong:
        return wrong.mismatch


def _first_start(view: Listing) -> Assumed:
    """AM-63: a mission that was created and is seen waiting did not run at once."""
    return (AM_63[view.created]["b"],) if view.created else ()


def current_index(view: Listing) -> Mapping[int, Assumed]:
    """The values that current_mission_index may have, and what each assumes (AM-14)."""
    if view.active is not None:
        return {view.active: ()}
    ended = [place for place, mission in enumerate(view.missions) if mission.state in ENDED]
    if len(ended) == len(view.missions):
        return {-1: (AM_14_ENDED["a"],), ended[-1]: (AM_14_ENDED["b"],)} if ended else {-1: ()}
    how = AM_14_HALTED if view.held else AM_14_GAP
    following = next(place for place in range(len(view.missions)) if place not in ended)
    if not ended:
        return {-1: (how["c", "d"],), 0: (how["e"],)}
    return {-1: (how["c"],), ended[-1]: (how["d"],), following: (how["e"],)}


def _current(view: Listing, index: int) -> Assumed:
    allowed = current_index(view)
    if index not in allowed:
        values = " or ".join(str(value) for value in allowed)
        raise _WrongError(CURRENT.id, f"current_mission_index is {index}, expected {values}", near=True)
    return allowed[index]


def _state(mission: Mission, message: MissionState, *, pointed: bool) -> Assumed:
    state = mission.state
    if state is not State.STATE_DEFAULT:
        if message.state != state:
            raise _WrongError(STATE.id, f"is {_name(message.state)}, expected {state.name}")
        return ()
    letters = waiting_as(pointed=pointed).get(message.state)
    if letters is None:
        raise _WrongError(STATE.id, f"is {_name(message.state)}, expected STATE_DEFAULT since it waits")
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


TYPE_CHANGED, GOALS_CHANGED = "type changed", "goals changed"


@functools.lru_cache(maxsize=10_000)
def lasting(content: Seen | Malformed) -> tuple[tuple[tuple[str, Hashable], ...], ...]:
    """A mission keeps its type and its goals as long as it is listed, also where nothing says which they are."""
    if isinstance(content, Malformed) or not all(content.named):
        return ()
    return tuple(
        ((TYPE_CHANGED, _shown_type(one)), (GOALS_CHANGED, tuple(map(_rounded, one.goals))))
        for one in content.states.missions
    )


def _shown_type(message: MissionState) -> Hashable:
    shown = message.mission_type or MissionType()
    given = ((name, getattr(shown, name)) for name in ("base_type", "servi_type", "carti_type"))
    return next(((name, number) for name, number in given if number), None)


def _rounded(goal: Goal) -> Hashable:
    if goal.pose is None:
        return goal.destination_id
    numbers = (goal.pose.x_meters, goal.pose.y_meters, goal.pose.heading_radians)
    return tuple(float(f"{number:.5g}") for number in numbers)


def _goals(mission: Mission, message: MissionState) -> None:
    if mission.kind is Kind.RETURN:
        return
    if mission.kind is Kind.CHARGE:
        if len(message.goals) > 1:
            raise _WrongError(GOALS.id, f"has {len(message.goals)} goals, expected its own place at most")
        return
    wanted = mission.goals
    if RETURN_POINT in wanted and len(message.goals) == len(wanted):
        wanted = tuple(
            any_one if goal == RETURN_POINT else goal for goal, any_one in zip(wanted, message.goals, strict=True)
        )
    if not _same_goals(wanted, message.goals):
        raise _WrongError(GOALS.id, f"has the goals {_goal_names(message.goals)}, expected {_goal_names(wanted)}")


def has_goals(mission: Mission, message: MissionState) -> bool:
    """Whether a message lists the goals of a mission."""
    try:
        _goals(mission, message)
    except _WrongError:
        return False
    return True


def same_mission(family: Family, mission: Mission, message: MissionState) -> Assumed | None:
    """What is assumed where a message is about a mission, in whatever state; None where it is about another one."""
    try:
        _goals(mission, message)
        return _type(family, mission, message)
    except _WrongError:
        return None


FLOAT_STEP = 1e-6
"""Poses travel as 32-bit floats: what comes back is as close to what was asked as that."""


def _same_goals(wanted: tuple[Goal, ...], shown: tuple[Goal, ...]) -> bool:
    if wanted == shown:
        return True
    return len(wanted) == len(shown) and all(map(_same_goal, wanted, shown))


def _same_goal(wanted: Goal, shown: Goal) -> bool:
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
    index, last = message.current_goal_index, max(len(message.goals), len(mission.goals))
    active = mission.state in (State.STATE_RUNNING, State.STATE_PAUSED)
    if active and mission.kind not in GOALLESS and mission.goal != NOT_CHOSEN:
        if index != mission.goal:
            raise _WrongError(GOAL_INDEX.id, f"has current_goal_index {index}, expected {mission.goal}")
    elif not -1 <= index <= last:
        raise _WrongError(GOAL_INDEX.id, f"has current_goal_index {index}, outside of its goals")


MEMBERS: Mapping[Family | None, str] = {
    None: "base_feedback",
    Family.BASE: "base_feedback",
    Family.SERVI: "servi_feedback",
    Family.CARTI: "carti_feedback",
}


def _feedback(family: Family, mission: Mission, message: MissionState, *, bare: bool) -> Assumed:
    given = _given(message)
    if not given:
        return ()
    name, status = given[0]
    if not isinstance(status, BaseStatus | FamilyStatus):
        raise _WrongError(FEEDBACK.id, f"has {name} {status}, which is not documented")
    if mission.state is State.STATE_DEFAULT and status:
        raise _WrongError(FEEDBACK.id, "waits and has feedback")
    assumes: list[Assumption] = []
    own, robots = MEMBERS[FAMILY[mission.kind]], MEMBERS[family]
    if mission.kind not in GOALLESS and own != robots and name in (own, robots):
        assumes.append(AM_50_MEMBER["c" if name == own else "d"])
    elif name not in (own, robots):
        raise _WrongError(FEEDBACK.id, f"has {name}, expected {own}")
    if name != "base_feedback":
        assumes.append(AM_50_SHAPE["b" if bare else "a"])
    return tuple(assumes)


def _given(message: MissionState) -> list[tuple[str, int]]:
    """The members of a mission's feedback that are there, each with its status."""
    feedback = message.mission_feedback
    members = ((name, getattr(feedback, name)) for name in dict.fromkeys(MEMBERS.values())) if feedback else ()
    return [(name, member.status) for name, member in members if member is not None]


def _type(family: Family, mission: Mission, message: MissionState) -> Assumed:
    shown = message.mission_type or MissionType()
    if mission.kind in GOALLESS:
        return ()
    if mission.kind in AM_26:
        if shown.base_type is not None or shown.carti_type is not None:
            raise _WrongError(TYPE.id, "has a type of another family")
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
    raise _WrongError(TYPE.id, f"has {_type_name(shown)}, expected {_type_name(expected[0])}")


def _type_name(shown: MissionType) -> str:
    for one in (shown.base_type, shown.servi_type, shown.carti_type):
        if one is not None:
            return one.name if hasattr(one, "name") else f"type {one}"
    return "no type"


def without_ids(states: MissionStates) -> MissionStates:
    """The message with its mission ids taken out."""
    return evolve(states, missions=tuple(map(_without_id, states.missions)))


@functools.lru_cache(maxsize=10_000)
def _without_id(mission: MissionState) -> MissionState:
    return evolve(mission, mission_id="")
