"""A status message of the Mission page made from a listing, under one choice of readings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from missionfsm.bear.mission.matching import FAMILY_TYPES, MEMBERS, TYPES, waiting_as
from missionfsm.bear.mission.readings.messages import AM_08, AM_35, AM_36, AM_50_MEMBER, AM_50_SHAPE, AM_51
from missionfsm.bear.mission.readings.scope import part_of
from missionfsm.bear.mission.readings.workflows import AM_26
from missionfsm.bear.mission.state import AUTOMATIC, FAMILY, GOALLESS, NOT_CHOSEN, RETURN_POINT, Mission
from missionfsm.bear.mission.stream import current_index
from missionfsm.bear.mission.views import Listing
from missionfsm.bear.wire.messages import (
    BaseFeedback,
    BaseStatus,
    FamilyFeedback,
    FamilyStatus,
    Goal,
    MissionFeedback,
    MissionState,
    MissionStates,
    MissionType,
    ServiType,
    State,
)
from missionfsm.kernel.readings import Assumption, meet


def rendered(view: Listing, ids: tuple[str, ...], choice: int) -> MissionStates:
    """The message that an implementation with these readings sends; `choice` leaves one of each (see `choose`)."""
    if not view.missions:
        unnamed = meet(choice, (AM_36["b"] if view.fresh else AM_35["c"],))
        return MissionStates((MissionState(state=State.STATE_DEFAULT),) if unnamed else (), -1)
    indices = current_index(view)
    index = next(value for value, assumes in indices.items() if meet(choice, assumes))
    missions = tuple(
        _mission_state(view, mission, mission_id, choice, pointed=position == index)
        for position, (mission, mission_id) in enumerate(zip(view.missions, ids, strict=True))
    )
    return MissionStates(missions, index)


_Value = TypeVar("_Value")


def _pick(choice: int, cases: Mapping[Assumption, _Value]) -> _Value:
    return next(value for assumption, value in cases.items() if meet(choice, (assumption,)))


def _mission_state(view: Listing, mission: Mission, mission_id: str, choice: int, *, pointed: bool) -> MissionState:
    state: Any = mission.state  # or a number that has no name
    if state is State.STATE_DEFAULT:
        state = _pick(choice, {AM_08[letters]: one for one, letters in waiting_as(pointed=pointed).items()})
    goals = tuple(Goal(destination_id="return point") if goal == RETURN_POINT else goal for goal in mission.goals)
    return MissionState(
        mission_id,
        state,
        goals,
        max(mission.goal, 0),
        _shown_feedback(view, mission, choice),
        _shown_type(view, mission, choice),
        "api",
    )


def _shown_feedback(view: Listing, mission: Mission, choice: int) -> MissionFeedback | None:
    if mission.state is not State.STATE_RUNNING or mission.kind in GOALLESS:
        return None
    own = MEMBERS[FAMILY[mission.kind]]
    name = own
    if own != MEMBERS[view.family]:
        name = _pick(choice, {AM_50_MEMBER["c"]: own, AM_50_MEMBER["d"]: MEMBERS[view.family]})
    waiting = mission.kind in AUTOMATIC and mission.goal == NOT_CHOSEN
    if name == "base_feedback":
        status = BaseStatus.STATUS_UNKNOWN if waiting else BaseStatus.STATUS_NAVIGATING
        return MissionFeedback(base_feedback=BaseFeedback(status))
    family_status = FamilyStatus.STATUS_UNKNOWN if waiting else FamilyStatus.STATUS_NAVIGATING
    build: Callable[..., MissionFeedback] = MissionFeedback
    return build(**{name: FamilyFeedback(family_status)})


def _shown_type(view: Listing, mission: Mission, choice: int) -> MissionType | None:
    if mission.kind in GOALLESS:
        return None
    if mission.kind in AM_26:
        which = AM_26[mission.kind]
        undocumented: Any = 7
        number = _pick(
            choice,
            {
                which["a"]: ServiType.SERVI_TYPE_UNKNOWN,
                which["b"]: undocumented,
                which["c"]: ServiType.SERVI_TYPE_SERVING,
            },
        )
        return MissionType(servi_type=number)
    of_family = FAMILY_TYPES.get((mission.kind, view.family))
    if of_family is not None and meet(choice, (AM_51[part_of(mission.kind)]["b"],)):
        return of_family
    return TYPES[mission.kind][0]


def with_bare_feedback(message: dict[str, Any], choice: int) -> dict[str, Any]:
    """AM-50: the same JSON with the feedback of a family as a bare enum, if that is what is chosen."""
    if meet(choice, (AM_50_SHAPE["b"],)):
        for mission in message.get("missions", ()):
            feedback = mission.get("missionFeedback") or {}
            for name in ("serviFeedback", "cartiFeedback"):
                if name in feedback:
                    feedback[name] = feedback[name]["status"]
    return message
