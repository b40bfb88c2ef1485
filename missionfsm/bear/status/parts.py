"""The whole state of a robot in a message, part by part: what the readings make of each."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import attrs
from attrs import evolve

from missionfsm.bear.status.messages import (
    BatteryState,
    ConnectionState,
    EmergencyStopState,
    ErrorCodes,
    NavigationState,
    RobotConnection,
    RobotState,
    StuckState,
    Twist,
)
from missionfsm.bear.status.readings.unknown import AS_09_PART
from missionfsm.bear.status.readings.values import AS_17_OFFLINE, AS_17_ZERO, AS_21, AS_22, AS_29_EMPTY, AS_32
from missionfsm.bear.status.state import TYPED
from missionfsm.bear.status.values import difference
from missionfsm.bear.status.views import Assumed, Seen, View
from missionfsm.bear.wire.messages import MissionState, State

_EMPTY_PARTS: dict[str, tuple[tuple[str, Any], ...]] = {
    "connection": (("c", RobotConnection()), ("e", RobotConnection(ConnectionState.STATE_DISCONNECTED))),
    "battery": (("c", BatteryState()),),
    "emergency_stop": (("c", EmergencyStopState()),),
    "error_codes": (("c", ErrorCodes()),),
    "navigation_state": (("c", NavigationState(StuckState())),),
}
"""What parts that are not reported may be shown as, with the reading of AS-09 under which they are."""


_NO_MISSION = (MissionState(state=State.STATE_DEFAULT), MissionState())


def whole(view: View, shown: RobotState) -> tuple[Assumed, ...] | str:
    """The ways in which a whole state shows another, part by part."""
    if view.value == shown == RobotState():
        # Without any values it says nothing about how a part looks that is not reported.
        return ((),)
    ways: list[list[Assumed]] = []
    for attribute in attrs.fields(RobotState):
        part = attribute.name
        found = _part(view, part, getattr(view.value, part), getattr(shown, part))
        if isinstance(found, str):
            return f"{part}: {found}"
        if found != [()]:
            ways.append(found)
    return tuple(tuple(itertools.chain.from_iterable(combination)) for combination in itertools.product(*ways))


def _part(view: View, part: str, wanted: object, shown: object) -> list[Assumed] | str:
    read = _READ_APART.get(part)
    found = None if read is None else read(view, wanted, shown)
    if found is not None:
        return found
    return [()] if wanted == shown else _blank(view, part, wanted, shown) or difference(wanted, shown)


def _blank(view: View, part: str, wanted: object, shown: object) -> list[Assumed]:
    """AS-09: a part that was never reported may be shown as a blank one, and one that is blank be left out."""
    for letter, empty in _EMPTY_PARTS.get(part, ()):
        if wanted is None and shown == empty:
            return [(AS_09_PART[part][view.call][letter],)]
        if letter == "c" and wanted == empty and shown is None:
            return [()]
    return []


def _mission(view: View, wanted: MissionState | None, shown: MissionState | None) -> list[Assumed] | None:
    """AS-21: that there is no mission is shown by leaving it out, or by one in no state."""
    if wanted is None and (shown is None or shown in _NO_MISSION):
        return [(AS_21[view.call]["a" if shown is None else "b"],)]
    return None


def _codes(view: View, wanted: ErrorCodes | None, shown: ErrorCodes | None) -> list[Assumed] | None:
    """AS-29: that there are no error codes is shown by none, or by leaving them out."""
    if wanted == ErrorCodes() and shown in (None, wanted):
        return [(AS_29_EMPTY[view.call]["d" if shown is None else "c"],)]
    return None


def _of_family(view: View, wanted: object, shown: object) -> list[Assumed] | None:
    """AS-32: what only one family of robots has may be left out."""
    return [(AS_32[view.call]["b"],)] if wanted is not None and shown is None else None


def _twist(view: View, wanted: Twist | None, shown: Twist | None) -> list[Assumed] | str | None:
    """AS-17: a velocity that is reported may be left out if it is nothing or the robot is offline."""
    if wanted is None or shown not in (None, wanted):
        return None
    zero, offline = AS_17_ZERO[view.call], AS_17_OFFLINE[view.call]
    if shown is not None:
        return [(*((zero["a"],) if wanted == Twist() else ()), *((offline["d"],) if view.offline else ()))]
    found: list[Assumed] = []
    if wanted == Twist():
        found.append((zero["b"],))
    if view.offline:
        found.append((offline["c"],))
    return found or difference(wanted, None)


_READ_APART: Mapping[str, Callable[[View, Any, Any], list[Assumed] | str | None]] = {
    "mission": _mission,
    "error_codes": _codes,
    "twist": _twist,
    "servi_state": _of_family,
    "carti_state": _of_family,
}
"""Parts with readings of their own; None where those have nothing to say."""


def whole_shown(view: View, state: RobotState) -> Iterator[tuple[Seen, Assumed]]:
    """Every message that shows a whole state and that differs by a reading, the usual one first."""
    goals = bool(state.mission and state.mission.goals)
    for chosen in itertools.product(*_choices(view, state)):
        changed = {name: content for fields, _ in chosen for name, content in fields.items()}
        assumes = tuple(itertools.chain.from_iterable(assumed for _, assumed in chosen))
        for wrapped in (False, True) if goals else (None,):
            way = () if wrapped is None else (AS_22[view.call]["b" if wrapped else "a"],)
            yield Seen(view.robot, view.endpoint, evolve(state, **changed), wrapped), (*assumes, *way)


def _choices(view: View, state: RobotState) -> Iterator[list[tuple[dict[str, Any], Assumed]]]:
    """For every part that may be shown in several ways: what each changes, and what it assumes; the usual one first."""
    call = view.call
    if state.mission is None:
        yield [({}, (AS_21[call]["a"],)), ({"mission": _NO_MISSION[0]}, (AS_21[call]["b"],))]
    if state.error_codes == ErrorCodes():
        yield [({}, (AS_29_EMPTY[call]["c"],)), ({"error_codes": None}, (AS_29_EMPTY[call]["d"],))]
    if state.twist == Twist():
        yield [({}, (AS_17_ZERO[call]["a"],)), ({"twist": None}, (AS_17_ZERO[call]["b"],))]
    if state.twist is not None and view.offline:
        yield [({}, (AS_17_OFFLINE[call]["d"],)), ({"twist": None}, (AS_17_OFFLINE[call]["c"],))]
    typed = next((name for name in TYPED if getattr(state, name) is not None), None)
    if typed:
        yield [({}, (AS_32[call]["a"],)), ({typed: None}, (AS_32[call]["b"],))]
    for part, empty in _EMPTY_PARTS.items():
        if getattr(state, part) is None and part != "navigation_state":
            question = AS_09_PART[part][call]
            yield [({}, (question["a"],)), *(({part: value}, (question[letter],)) for letter, value in empty)]
