"""Conversations with a fleet that are worth having whole: each field of what a subscription shows changes alone."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

from missionfsm.bear.status.samples import (
    BATTERIES,
    CONNECTIONS,
    CONVEYOR,
    ERRORS,
    MISSIONS,
    NAVIGATIONS,
    NETWORKS,
    POSES,
    STOPS,
    TRAYS,
    TWISTS,
    at,
    by_ids,
    report,
)
from missionfsm.bear.status.state import MAPS, Endpoint
from missionfsm.kernel.alphabet import ScriptStep
from missionfsm.kernel.codec import JSON


def _changed(value: JSON, *changes: JSON) -> tuple[JSON, ...]:
    """A value, then what becomes of it by one change after the other; a change says the fields that are other."""
    found = [value]
    for change in changes:
        found.append(_with(found[-1], change))
    return tuple(found)


def _with(value: JSON, change: JSON) -> JSON:
    if not isinstance(change, dict):
        return change
    if isinstance(value, list):
        return [_with(value[0], change), *value[1:]]
    return {**value, **{name: _with(value.get(name), one) for name, one in change.items()}}


APART: Mapping[str, tuple[JSON, ...]] = {
    "battery": _changed(
        BATTERIES[0],
        {"chargePercent": 79},
        {"chargePercent": 78},
        {"chargeMethod": "CHARGE_METHOD_WIRED"},
        {"chargePercent": 100},
        {"state": "STATE_FULL"},
    ),
    "errorCodes": (
        *_changed(
            ERRORS[1],
            {"codes": {"severity": "SEVERITY_HIGH"}},
            {"codes": {"severity": "SEVERITY_MEDIUM"}},
            {"codes": {"message": "Low battery"}},
            {"codes": {"code": 1002}},
        ),
        *ERRORS[1:3],
        ERRORS[0],
    ),
    "navigationState": _changed(
        NAVIGATIONS[0],
        {"stuckState": {"state": "STATE_STUCK"}},
        {"stuckState": {"reason": "REASON_PATH_BLOCKED"}},
        {"stuckState": {"reason": "REASON_INSIDE_RESTRICTED_AREA"}},
    ),
    "wifi": _changed(
        NETWORKS[0],
        {"signalLevelDbm": -60},
        {"linkQuality": 40},
        {"security": "SECURITY_USERNAME_PASSWORD_SECURED"},
        {"security": "SECURITY_PASSWORD_SECURED"},
        {"ssid": "guests"},
    ),
    "connection": CONNECTIONS[::-1],
    "emergencyStop": _changed(STOPS[0], {"emergency": "EMERGENCY_ENGAGED"}, {"buttonPressed": "EMERGENCY_ENGAGED"}),
    "mission": _changed(
        MISSIONS[2],
        {"currentGoalIndex": 0},
        {"state": "STATE_RUNNING"},
        {"missionId": "mission-789"},
        {"goals": {"destinationId": "table-3"}},
    ),
    "pose": _changed(POSES[0], {"xMeters": 2.0}, {"yMeters": 3.0}, {"headingRadians": 1.5}),
    "twist": _changed(TWISTS[0], {"linearVelocity": 0.25}, {"angularVelocity": 0.5}),
    "serviState": _changed(
        TRAYS,
        {"trayStates": {"trayStates": {"weightKg": 3.5}}},
        {"trayStates": {"trayStates": {"loadRatio": 0.9}}},
        {"trayStates": {"trayStates": {"trayName": "middle"}}},
        {"trayStates": {"trayStates": {"loadState": "LOAD_STATE_OVERLOADED"}}},
    ),
    "cartiState": _changed(
        CONVEYOR,
        {"conveyorState": {"operationState": "OPERATION_STATE_STOP"}},
        {"conveyorState": {"payloadState": "PAYLOAD_STATE_EMPTY"}},
        {"conveyorState": {"index": 1}},
        {"conveyorState": {"healthState": "HEALTH_STATE_OK"}},
        {"conveyorState": {"installationState": "INSTALLATION_STATE_INSTALLED"}},
    ),
}
"""For each part values one after the other, so that each of its fields is once the only one that changes."""

SHOWN: Mapping[Endpoint, tuple[str, ...]] = {
    Endpoint.BATTERY: ("battery",),
    Endpoint.ERRORS: ("errorCodes",),
    Endpoint.NAVIGATION: ("navigationState",),
    Endpoint.NETWORK: ("wifi",),
    Endpoint.ONLINE: ("connection",),
    Endpoint.ROBOT: tuple(part for part in APART if part != "wifi"),
}
"""For each subscription the parts that it shows."""


def scripts(robots: tuple[str, ...], place: str | None) -> Iterator[tuple[ScriptStep, ...]]:
    """Every subscription to several robots, and each field of what it shows changes alone.

    Chance seldom watches the second one change, and seldom one field of many.

    Args:
        robots: ids of those that are watched.
        place: the id of a location where they are, or None.
    """
    selections = (*(() if place is None else (at(place),)), by_ids(*robots))
    for endpoint, parts in SHOWN.items():
        for selection, part in itertools.product(selections, parts):
            reports = (report(robot, part, value) for robot in robots[::-1] for value in APART[part])
            changes = ((ScriptStep("settle"), ScriptStep("drive", one)) for one in reports)
            yield (ScriptStep(endpoint.value, selection), *itertools.chain.from_iterable(changes))
    for endpoint, first in itertools.product(MAPS, robots):
        yield _numbered_apart(endpoint, first, *(one for one in robots if one != first))


def _numbered_apart(endpoint: Endpoint, first: str, *others: str) -> tuple[ScriptStep, ...]:
    """One robot has counted on before a message shows all of them; then the others change.

    Each robot has metadata of its own: who gives one the number of another lets its numbers go down.
    """
    (part,) = SHOWN[endpoint]
    before = (report(first, part, value) for value in (*APART[part], *APART[part]))
    after = (report(robot, part, value) for robot in others for value in APART[part][::-1])
    settled = ((ScriptStep("drive", one), ScriptStep("settle")) for one in after)
    return (
        *(ScriptStep("drive", one) for one in before),
        ScriptStep(endpoint.value, by_ids(first, *others)),
        ScriptStep("settle"),
        *itertools.chain.from_iterable(settled),
    )
