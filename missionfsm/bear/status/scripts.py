"""Conversations with a fleet that are worth having whole.

Each field of what a subscription shows changes alone, robots change after something has happened to them or to a
stream, and what GetRobotStatus answers is asked for again after every change.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

from attrs import frozen

from missionfsm.bear.status.samples import (
    BATTERIES,
    CONNECTIONS,
    CONVEYOR,
    ERRORS,
    MISSIONS,
    NAVIGATIONS,
    NETWORKS,
    POSES,
    SHORT,
    STOPS,
    TRAYS,
    TWISTS,
    at,
    by_ids,
    report,
)
from missionfsm.bear.status.state import GET, MAPS, Endpoint
from missionfsm.kernel.alphabet import ScriptStep, pick
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
        None,
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
    "twist": _changed(TWISTS[0], {"linearVelocity": 0.25}, {"angularVelocity": 0.5}, None),
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
"""For each part values one after the other, so that each of its fields is once the only one that changes.

The page says what it means that a network or a velocity is not there, so that this comes last.
"""

SHOWN: Mapping[Endpoint, tuple[str, ...]] = {
    Endpoint.BATTERY: ("battery",),
    Endpoint.ERRORS: ("errorCodes",),
    Endpoint.NAVIGATION: ("navigationState",),
    Endpoint.NETWORK: ("wifi",),
    Endpoint.ONLINE: ("connection",),
    Endpoint.ROBOT: tuple(part for part in APART if part != "wifi"),
}
"""For each subscription the parts that it shows."""


_SETTLE = ScriptStep("settle")


@frozen
class Cast:
    """Who is in the conversations.

    Attributes:
        robots: ids of the account's robots that are watched.
        place: the id of a location of the account where they are, or None.
        elsewhere: the id of another location of the account, or None.
        hermit: a robot of the account and the location of the account where it is alone, or None.
    """

    robots: tuple[str, ...]
    place: str | None = None
    elsewhere: str | None = None
    hermit: tuple[str, str] | None = None


def scripts(cast: Cast) -> Iterator[tuple[ScriptStep, ...]]:
    """Conversations with those who are in a world."""
    yield from _apart(cast.robots, cast.place)
    for robot in cast.robots[:1]:
        yield _asked_again(robot)
        yield from _reported_whole(robot)
        yield from _happened(cast, robot)
    if cast.hermit:
        yield from _offline_at(*cast.hermit)


def _asked_again(robot: str) -> tuple[ScriptStep, ...]:
    """What GetRobotStatus answers of a robot, asked again after each change."""
    get = ScriptStep(GET, {"robotId": robot})
    changes = (report(robot, part, value) for part in SHOWN[Endpoint.ROBOT] for value in (*APART[part], None))
    return (get, *itertools.chain.from_iterable((ScriptStep("drive", one), _SETTLE, get) for one in changes))


def _reported_whole(robot: str) -> Iterator[tuple[ScriptStep, ...]]:
    """A report takes the place of the one before whole: what it leaves out has its default, wherever it is shown."""
    get = ScriptStep(GET, {"robotId": robot})
    for endpoint, parts in SHOWN.items():
        reports: list[ScriptStep] = []
        for part in (one for one in parts if one in SHORT):
            for value in SHORT[part]:
                whole, short = (report(robot, part, one) for one in (APART[part][0], value))
                reports += (*_driven(whole, short), get)
        if reports:
            yield (ScriptStep(endpoint.value, by_ids(robot)), _SETTLE, *reports)


def _happened(cast: Cast, robot: str) -> Iterator[tuple[ScriptStep, ...]]:
    """Every subscription to a robot that changes after something has happened to it, or to a stream like it."""
    off, on = (report(robot, "connection", one) for one in CONNECTIONS[::-1])
    away, back = ({"event": "move", "robotId": robot, "locationId": one} for one in (cast.elsewhere, cast.place))
    ends = ScriptStep("cancel", {"stream": pick("stream")}, ((0, 0),))
    for endpoint, parts in SHOWN.items():
        one = ScriptStep(endpoint.value, by_ids(robot))
        changes = tuple(report(robot, parts[0], value) for value in APART[parts[0]][-3:])
        then = _driven(*changes)
        restart = _driven({"event": "restart", "robotId": robot})
        yield (one, _SETTLE, one, _SETTLE, *then)
        yield (one, _SETTLE, one, _SETTLE, ends, _SETTLE, *then)
        yield (one, _SETTLE, *(ScriptStep("drive", change) for change in changes), _SETTLE, *restart, *then)
        yield (one, _SETTLE, *_driven(off, on), *then)
        if cast.place and cast.elsewhere:
            yield (one, _SETTLE, *_driven(away), *then)
            there = ScriptStep(endpoint.value, at(cast.place))
            yield (there, _SETTLE, *_driven(away, back), *then)


def abroad(place: str) -> tuple[ScriptStep, ...]:
    """Every subscription to somebody else's location where a robot of the account is."""
    return tuple(itertools.chain.from_iterable((ScriptStep(one.value, at(place)), _SETTLE) for one in Endpoint))


def _driven(*events: JSON) -> tuple[ScriptStep, ...]:
    """Some drives, each with all that it causes."""
    return tuple(itertools.chain.from_iterable((ScriptStep("drive", one), _SETTLE) for one in events))


def _offline_at(robot: str, place: str) -> Iterator[tuple[ScriptStep, ...]]:
    """Every subscription to a location whose one robot is offline."""
    off = _driven(report(robot, "connection", CONNECTIONS[1]))
    yield from ((*off, ScriptStep(endpoint.value, at(place)), _SETTLE) for endpoint in Endpoint)


def _apart(robots: tuple[str, ...], place: str | None) -> Iterator[tuple[ScriptStep, ...]]:
    """Every subscription to several robots, and each field of what it shows changes alone.

    Chance seldom watches the second one change, and seldom one field of many.
    """
    selections = (*(() if place is None else (at(place),)), by_ids(*robots))
    # A short run begins with calls that have an answer: subscriptions alone would tell little.
    asked = tuple(ScriptStep(GET, {"robotId": robot}) for robot in robots)
    for endpoint, parts in SHOWN.items():
        for selection, part in itertools.product(selections, parts):
            reports = (report(robot, part, value) for robot in robots[::-1] for value in APART[part])
            changes = ((_SETTLE, ScriptStep("drive", one)) for one in reports)
            yield (*asked, ScriptStep(endpoint.value, selection), *itertools.chain.from_iterable(changes))
            asked = ()
    for endpoint, first in itertools.product(MAPS, robots):
        yield _numbered_apart(endpoint, first, *(one for one in robots if one != first))


def _numbered_apart(endpoint: Endpoint, first: str, *others: str) -> tuple[ScriptStep, ...]:
    """One robot has counted on before a message shows all of them; then the others change.

    Each robot has metadata of its own: who gives one the number of another lets its numbers go down.
    """
    (part,) = SHOWN[endpoint]
    before = (report(first, part, value) for value in (*APART[part], *APART[part]))
    after = (report(robot, part, value) for robot in others for value in APART[part][::-1])
    settled = ((ScriptStep("drive", one), _SETTLE) for one in after)
    return (
        *(ScriptStep("drive", one) for one in before),
        ScriptStep(endpoint.value, by_ids(first, *others)),
        _SETTLE,
        *itertools.chain.from_iterable(settled),
    )
