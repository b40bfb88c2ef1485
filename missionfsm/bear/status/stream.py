"""The streams of the Robot Status page: what they promise, and which messages show what a robot reported."""

from __future__ import annotations

import functools
from collections.abc import Hashable

from attrs import evolve

from missionfsm.bear.status.messages import (
    BatteryMode,
    BatteryState,
    RobotState,
)
from missionfsm.bear.status.parts import whole, whole_shown
from missionfsm.bear.status.readings.values import AS_14, AS_15_FULL, AS_18, AS_19, AS_22
from missionfsm.bear.status.state import (
    GET,
    STATUS,
    SYSTEM_NAME,
    Endpoint,
    Fleet,
    Value,
)
from missionfsm.bear.status.values import (
    CHECKS,
    a_stuck_state_is_known,
    difference,
    faults,
    reserved_reasons_are_not_used,
    within,
)
from missionfsm.bear.status.views import BLANK, Assumed, Promised, Seen, Topic, View
from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.readings import UNCONSTRAINED, Assumption, meet
from missionfsm.kernel.rules import Rule, promise
from missionfsm.kernel.step import Match, Mismatch
from missionfsm.kernel.text import brief

# The promises.


def _promise(name: str, says: str, *place: str) -> Rule:
    return evolve(promise(name, says, cite=STATUS[place]).registered(SYSTEM_NAME, "messages"), everywhere=True)


WELL_FORMED = _promise("messages-are-well-formed", "A message has the documented form.", "GetRobotStatus", "Response")
SEQUENCE = _promise(
    "sequence-numbers-grow",
    "A sequence number is larger than the robot's one before, or 0; never negative.",
    "SubscribeBatteryStatus",
    "EventMetadata",
)
SELECTED = _promise(
    "only-selected-robots-are-shown",
    "A message is about a robot that was selected, and says about which.",
    "SubscribeBatteryStatus",
    "Request",
)
UPDATES = _promise(
    "updates-follow-the-state",
    "Every change that lasts is streamed to all subscribers, in the order of the robot's changes.",
    "SubscribeBatteryStatus",
)
VALUES = {
    place: promise(
        "values-are-those-reported", "What is shown is what the robot reported.", cite=STATUS[place,]
    ).registered(SYSTEM_NAME, place)
    for place in (GET, *(endpoint.value for endpoint in Endpoint))
}
RULES = (WELL_FORMED, SEQUENCE, SELECTED, UPDATES, *VALUES.values(), *(one.rule for one in CHECKS))


# Reading a message.


def matches(view: View, content: Seen | Malformed) -> tuple[Match, ...] | Mismatch:
    """The ways in which a message shows a view, or the first thing that is wrong with it."""
    if isinstance(content, Malformed):
        return Mismatch(WELL_FORMED.id, content.says)
    if content.robot != view.robot:
        says = f"the message is about robot {brief(content.robot)}, not about {brief(view.robot)}"
        alike = content.value == view.value
        return Mismatch(SELECTED.id, says, near=alike, far=not alike)
    if content.endpoint is not view.endpoint and not (content.endpoint is None and view.endpoint in BLANK):
        return Mismatch(WELL_FORMED.id, f"the message is none of {view.endpoint.value}")
    value = BLANK[view.endpoint] if content.endpoint is None else content.value
    found = _matched(view, value, content.wrapped, VALUES[view.endpoint.value])
    if isinstance(found, Mismatch):
        return found
    rules = (UPDATES.id, SELECTED.id, WELL_FORMED.id, VALUES[view.endpoint.value].id, *exercised(value))
    untimed = () if content.timed else (AS_14[view.endpoint.value]["b"],)
    return tuple(Match((*assumes, *untimed), (), rules) for assumes in found)


def not_selected(here: object, topic: Hashable, content: object, _refs: object) -> tuple[str, ...] | Mismatch:
    """What is wrong with a message that nothing owes, if it is about a robot that its stream does not show."""
    if not isinstance(topic, Topic) or not isinstance(content, Seen):
        return ()
    if topic.robot:
        robot = here.robot(topic.robot) if isinstance(here, Fleet) and topic.robot == content.robot else None
        if robot is None or topic.location in (None, robot.location):
            return ()
        says = f"robot {brief(robot.id)} is at {brief(robot.location)}, and {brief(topic.location)} was selected"
        return Mismatch(SELECTED.id, says)
    where = "was not selected" if topic.location is None else f"is not at {brief(topic.location)}, which was selected"
    return Mismatch(SELECTED.id, f"robot {brief(content.robot)} {where}")


def answers(promised: object, given: object) -> tuple[Match, ...] | Mismatch:
    """The ways in which an answer of GetRobotStatus is the one promised, or what is wrong with it."""
    if not isinstance(promised, Promised):
        return Mismatch(WELL_FORMED.id, f"the answer is {given}")
    if not isinstance(given, Seen):
        return Mismatch(WELL_FORMED.id, str(getattr(given, "says", given)))
    found = _matched(promised.view, given.value, given.wrapped, VALUES[GET])
    if isinstance(found, Mismatch):
        return found
    rules = (WELL_FORMED.id, VALUES[GET].id, *exercised(given.value))
    return tuple(Match(assumes, (), rules) for assumes in found)


@functools.lru_cache(maxsize=10_000)
def exercised(value: object) -> tuple[str, ...]:
    """The ids of the checks that a value was held to."""
    kinds = {type(part) for part in within(value)}
    return tuple(one.rule.id for one in CHECKS if one.of is None or one.of in kinds)


def _matched(view: View, value: Value, wrapped: bool | None, rule: Rule) -> tuple[Assumed, ...] | Mismatch:  # noqa: FBT001
    excused = _excused(view, value)
    if isinstance(excused, Mismatch):
        return excused
    assumes = excused if wrapped is None else (*excused, AS_22[view.call]["b" if wrapped else "a"])
    if view.unheard:
        return ((*assumes, *_of_itself(value)),)
    if view.endpoint is Endpoint.NETWORK:
        found: tuple[Assumed, ...] | str = _network(view, value)
    elif view.endpoint is Endpoint.ROBOT:
        found = whole(view, value)
    else:
        found = ((),) if view.value == value else difference(view.value, value)
    if isinstance(found, str):
        return Mismatch(rule.id, found)
    return tuple(tuple(dict.fromkeys((*assumes, *one))) for one in found)


def _excused(view: View, value: Value) -> Assumed | Mismatch:
    """What lets a value be shown in spite of what is wrong with it in itself."""
    assumes: list[Assumption] = []
    for fault in faults(value):
        if fault.rule == a_stuck_state_is_known.rule.id and _may_be_unknown(view):
            assumes.append(AS_18[view.call]["b"])
        elif fault.rule == reserved_reasons_are_not_used.rule.id:
            assumes.append(AS_19[view.call]["z"])
        elif not fault.robots or (view.unheard and not fault.lasts):
            return Mismatch(fault.rule, fault.says, near=True)
    return tuple(assumes)


def _may_be_unknown(view: View) -> bool:
    """AS-18: whether a stuck state of UNKNOWN could be shown."""
    if isinstance(view.value, RobotState):
        return view.value.navigation_state is None
    return view.unheard or view.value == BLANK[Endpoint.NAVIGATION]


def _of_itself(value: Value) -> Assumed:
    """What a message assumes about the robot where nothing is known of it (AS-15)."""
    for part in within(value):
        if isinstance(part, BatteryState) and part.state == BatteryMode.STATE_FULL and part.charge_percent < 100:
            return (AS_15_FULL["b"],)
    return ()


def _network(view: View, value: Value) -> tuple[Assumed, ...] | str:
    if value == view.value:
        return ((view.unlinked["a"],),) if value is not None and view.unlinked else ((),)
    if value is None and view.unlinked:
        return ((view.unlinked["b"],),)
    return difference(view.value, value)


# Making a message.


@functools.lru_cache(maxsize=10_000)
def renderings(view: View) -> tuple[tuple[Seen, Assumed], ...]:
    """Every message that shows a view and that differs by a reading, with what it assumes; the usual one first."""
    usual = Seen(view.robot, view.endpoint, view.value)
    if view.endpoint is Endpoint.NETWORK and view.unlinked and view.value is not None:
        return (usual, (view.unlinked["a"],)), (evolve(usual, value=None), (view.unlinked["b", "c"],))
    if view.endpoint is not Endpoint.ROBOT or view.value in (None, RobotState()):
        return ((usual, ()),)
    return tuple(whole_shown(view, view.value))


def rendered(view: View, choice: int = UNCONSTRAINED) -> Seen:
    """The message that an implementation with these readings sends."""
    return next(seen for seen, assumes in renderings(view) if meet(choice, assumes))
