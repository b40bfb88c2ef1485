"""Whether a status message shows what the robot has, and what has to last from one to the next."""

from __future__ import annotations

import functools
from collections.abc import Hashable, Iterator, Mapping, Sequence

from missionfsm.bear.mission.matching import Assumed, MismatchError, feedback_given, one_listed
from missionfsm.bear.mission.promises import ALL_LISTED, CURRENT, FEEDBACK, GOAL_INDEX, RULES, WELL_FORMED
from missionfsm.bear.mission.readings.messages import AM_14_ENDED, AM_14_GAP, AM_14_HALTED, AM_35, AM_36, AM_49
from missionfsm.bear.mission.readings.starting import AM_63
from missionfsm.bear.mission.readings.unlisted import AM_58_SENT
from missionfsm.bear.mission.state import ENDED
from missionfsm.bear.mission.views import Listing, Seen
from missionfsm.bear.wire.messages import Goal, MissionState, MissionType, State
from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.step import Match, Mismatch
from missionfsm.kernel.text import counted

_SHOWN = tuple(rule.id for rule in RULES)


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
    except MismatchError as wrong:
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
        raise MismatchError(ALL_LISTED.id, f"{_so_many(content.states.missions)}; the robot has none")
    index = content.states.current_mission_index
    if index not in (-1, 0):
        raise MismatchError(CURRENT.id, f"current_mission_index is {index}, expected -1 or 0")
    if only.current_goal_index not in (-1, 0):
        raise MismatchError(GOAL_INDEX.id, f"mission 0 has current_goal_index {only.current_goal_index} and no goals")
    if any(status for _, status in feedback_given(only)):
        raise MismatchError(FEEDBACK.id, "mission 0 waits and has feedback")
    return (AM_36["b"] if view.fresh else AM_35["c"],)


def _listed(view: Listing, content: Seen) -> Assumed:
    """What is assumed where a message lists the robot's missions one by one."""
    shown = content.states.missions
    if len(shown) != len(view.missions):
        raise MismatchError(ALL_LISTED.id, f"{_so_many(shown)}; the robot has {len(view.missions)}")
    if not all(content.named):
        raise MismatchError(ALL_LISTED.id, f"mission {content.named.index(False)} has no id")
    assumes: list[Assumption] = []
    if not view.missions:
        assumes.append(AM_36["a", "c"] if view.fresh else AM_35["a"])
    pointed = content.states.current_mission_index
    for index, (mission, message) in enumerate(zip(view.missions, shown, strict=True)):
        found = one_listed(view.family, mission, message, pointed=pointed == index, bare=content.bare[index])
        if isinstance(found, Mismatch):
            raise MismatchError(found.rule, f"mission {index} {found.says}")
        assumes += found
    # The index is judged last: where the states are wrong, it follows them.
    assumes += _current(view, content.states.current_mission_index)
    assumes += _first_start(view)
    return tuple(dict.fromkeys(assumes))


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
    """What is assumed where current_mission_index is this."""
    allowed = current_index(view)
    if index not in allowed:
        values = " or ".join(str(value) for value in allowed)
        raise MismatchError(CURRENT.id, f"current_mission_index is {index}, expected {values}", near=True)
    return allowed[index]


TYPE_CHANGED, GOALS_CHANGED, OWNER_CHANGED = "type changed", "goals changed", "owner changed"
"""What is wrong, or odd, where something did not last."""


@functools.lru_cache(maxsize=10_000)
def lasting(content: Seen | Malformed) -> tuple[tuple[tuple[str, Hashable], ...], ...]:
    """What each mission of a message keeps as long as it is listed: type, goals and owner, whatever they are."""
    if isinstance(content, Malformed) or not all(content.named):
        return ()
    return tuple(
        (
            (TYPE_CHANGED, _shown_type(one)),
            (GOALS_CHANGED, tuple(map(_rounded, one.goals))),
            (OWNER_CHANGED, one.owner),
        )
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
