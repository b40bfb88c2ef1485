"""The system ``bear.status``: its specification, its JSON, and what is worth trying on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from missionfsm.bear.status.codec import CODEC
from missionfsm.bear.status.mutations import BENDS, TWISTS
from missionfsm.bear.status.pictures import SKETCHES
from missionfsm.bear.status.spec import SPEC
from missionfsm.bear.status.state import GET, Endpoint
from missionfsm.bear.status.state import SYSTEM as NAME
from missionfsm.kernel.alphabet import Alphabet, Bounds, Line, Prompt
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System

_BATTERIES: tuple[JSON, ...] = (
    {"chargePercent": 78, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_CONTACT"},
    {"chargePercent": 79, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_CONTACT"},
    {"chargePercent": 42, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"},
    {"chargePercent": 100, "state": "STATE_FULL", "chargeMethod": "CHARGE_METHOD_WIRED"},
    {"chargePercent": 0, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_WIRED"},
)
_ERRORS: tuple[JSON, ...] = (
    {"codes": []},
    {"codes": [{"code": 1001, "severity": "SEVERITY_MEDIUM", "message": "Low battery warning"}]},
    {
        "codes": [
            {"code": 1001, "severity": "SEVERITY_MEDIUM", "message": "Low battery warning"},
            {"code": 2042, "severity": "SEVERITY_HIGH", "message": "Camera connection lost"},
        ]
    },
    {"codes": [{"code": 7, "severity": "SEVERITY_LOW", "message": "Up camera process error."}]},
)
_NAVIGATIONS: tuple[JSON, ...] = tuple(
    {"stuckState": {"state": state, "reason": reason}}
    for state, reason in (
        ("STATE_NOT_STUCK", "REASON_UNKNOWN"),
        ("STATE_STUCK", "REASON_PATH_BLOCKED"),
        ("STATE_STUCK", "REASON_INSIDE_RESTRICTED_AREA"),
        ("STATE_STUCK", "REASON_UNKNOWN"),
    )
)
_NETWORKS: tuple[JSON, ...] = (
    {"ssid": "office", "signalLevelDbm": -45, "linkQuality": 65, "security": "SECURITY_PASSWORD_SECURED"},
    {"ssid": "office", "signalLevelDbm": -60, "linkQuality": 40, "security": "SECURITY_PASSWORD_SECURED"},
    {"ssid": "guests", "signalLevelDbm": -70, "linkQuality": 0, "security": "SECURITY_UNSECURED"},
    None,
)
_CONNECTIONS: tuple[JSON, ...] = ({"state": "STATE_CONNECTED"}, {"state": "STATE_DISCONNECTED"})
_STOPS: tuple[JSON, ...] = (
    {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"},
    {"emergency": "EMERGENCY_ENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"},
    {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_ENGAGED"},
)
_MISSIONS: tuple[JSON, ...] = (
    {
        "missionId": "mission-123",
        "state": "STATE_RUNNING",
        "goals": [{"pose": {"xMeters": 5.2, "yMeters": 3.1, "headingRadians": 0.0}}],
        "currentGoalIndex": 0,
    },
    {
        "missionId": "mission-123",
        "state": "STATE_SUCCEEDED",
        "goals": [{"destinationId": "table-1"}],
        "currentGoalIndex": 0,
    },
    None,
)
_TWISTS: tuple[JSON, ...] = (
    {"linearVelocity": 0.5, "angularVelocity": 0.25},
    {"linearVelocity": 0.0, "angularVelocity": 0.0},
    {"linearVelocity": -0.1, "angularVelocity": -0.7},
    None,
)
_POSES: tuple[JSON, ...] = (
    {"xMeters": 1.5, "yMeters": 2.8, "headingRadians": 0.78},
    {"xMeters": 2.1, "yMeters": 1.8, "headingRadians": 1.2},
)
_TRAYS: JSON = {
    "trayStates": {
        "trayStates": [{"trayName": "top", "loadState": "LOAD_STATE_LOADED", "weightKg": 2.5, "loadRatio": 0.8}]
    }
}
_CONVEYOR: JSON = {
    "conveyorState": {"index": 0, "operationState": "OPERATION_STATE_ROLLING", "payloadState": "PAYLOAD_STATE_LOADED"}
}

_REPORTS: tuple[tuple[str, tuple[JSON, ...]], ...] = (
    ("battery", _BATTERIES),
    ("errorCodes", _ERRORS),
    ("navigationState", _NAVIGATIONS),
    ("wifi", _NETWORKS),
    ("connection", _CONNECTIONS),
    ("emergencyStop", _STOPS),
    ("mission", _MISSIONS),
    ("twist", _TWISTS),
    ("pose", _POSES),
    ("serviState", (_TRAYS, {"trayStates": {"trayStates": []}})),
    ("cartiState", (_CONVEYOR, None)),
    ("localizationState", ({"state": "STATE_SUCCEEDED"},)),
)
_EXTREME: tuple[tuple[str, JSON], ...] = (
    ("battery", {"chargePercent": 130, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_WIRED"}),
    ("battery", {"chargePercent": -1, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"}),
    ("wifi", {"ssid": "office", "signalLevelDbm": -30, "linkQuality": 99, "security": "SECURITY_UNSECURED"}),
    ("battery", None),
    ("errorCodes", None),
    ("connection", None),
    ("navigationState", None),
)


def _full(battery: JSON, **others: JSON) -> JSON:
    """The state of a robot that reports everything."""
    return {
        "connection": _CONNECTIONS[0],
        "battery": battery,
        "emergencyStop": _STOPS[0],
        "mission": _MISSIONS[0],
        "pose": _POSES[0],
        "errorCodes": _ERRORS[1],
        "twist": _TWISTS[0],
        "navigationState": _NAVIGATIONS[0],
        **others,
    }


def _robot(robot: str, location: str, state: JSON, wifi: JSON = None, *, owned: bool = True) -> JSON:
    return {"robotId": robot, "locationId": location, "owned": owned, "state": state, "wifi": wifi}


_LOCATIONS: tuple[JSON, ...] = (
    {"locationId": "L1", "owned": True},
    {"locationId": "L2", "owned": True},
    {"locationId": "L3", "owned": False},
    {"locationId": "L4", "owned": True},
)
_FOREIGN = _robot("x1", "L1", _full(_BATTERIES[2]), _NETWORKS[2], owned=False)
_FOREIGN_ELSEWHERE = _robot("x2", "L3", _full(_BATTERIES[3]), None, owned=False)
_WORLDS: tuple[JSON, ...] = (
    {
        "robots": [
            _robot("r1", "L1", _full(_BATTERIES[0], serviState=_TRAYS), _NETWORKS[0]),
            _robot("r2", "L1", _full(_BATTERIES[2], navigationState=_NAVIGATIONS[1]), None),
            _robot("r3", "L2", _full(_BATTERIES[3], cartiState=_CONVEYOR, errorCodes=_ERRORS[2]), _NETWORKS[2]),
            _FOREIGN,
            _FOREIGN_ELSEWHERE,
        ],
        "locations": list(_LOCATIONS),
    },
    {
        "robots": [
            _robot("r1", "L1", _full(_BATTERIES[1], twist=_TWISTS[1], errorCodes=_ERRORS[0]), _NETWORKS[1]),
            _robot("r2", "L1", _full(_BATTERIES[2], connection=_CONNECTIONS[1]), _NETWORKS[0]),
            _robot("r3", "L2", {}, None),
            _FOREIGN,
        ],
        "locations": list(_LOCATIONS),
    },
    {"robots": [_robot("r1", "L1", _full(_BATTERIES[0]), _NETWORKS[0])], "locations": list(_LOCATIONS[:1])},
)
_SMALL: JSON = _WORLDS[2]


def _ids(*robots: str) -> JSON:
    return {"selector": {"robotIds": {"ids": list(robots)}}}


def _at(location: str) -> JSON:
    return {"selector": {"locationId": location}}


_SELECTIONS: tuple[JSON, ...] = (
    _ids("r1"),
    _ids("r1", "r2"),
    _ids("r3", "r2", "r1"),
    _at("L1"),
    _at("L2"),
)
_DEFECTIVE: tuple[JSON, ...] = (
    {},
    {"selector": None},
    {"selector": {}},
    {"selector": "r1"},
    {"selector": {"robotIds": {}}},
    {"selector": {"robotIds": {"ids": "r1"}}},
    {"selector": {"robotIds": {"ids": [7]}}},
    _ids(),
    _ids(""),
    _ids("r1", ""),
    _ids("", "x1"),
    _ids("x1"),
    _ids("r1", "x1"),
    _ids("x1", "r2"),
    _ids("nobody"),
    _ids("r1", "nobody"),
    _ids("r1", "r1"),
    _at(""),
    _at("L3"),
    _at("L4"),
    _at("nowhere"),
    {"selector": {"robotIds": {"ids": ["r3"]}, "locationId": "L1"}},
    {"selector": {"robotIds": {"ids": ["r1"]}, "locationId": "L3"}},
    {"selector": {"robotIds": {"ids": ["x1"]}, "locationId": "L1"}},
    {"selector": {"robotIds": {"ids": ["r1"]}}, "mode": "fast"},
)


_DEFECTIVE_GETS: tuple[JSON, ...] = (
    {},
    {"robotId": ""},
    {"robotId": "x1"},
    {"robotId": "nobody"},
    {"robotId": 7},
    {"robotId": "r1", "x": 1},
)


def _prompts() -> Iterator[Prompt]:
    for robot in ("r1", "r2", "r3"):
        yield from (Prompt(GET, {"robotId": robot}) for _ in range(3))
    yield from (Prompt(GET, params) for params in _DEFECTIVE_GETS)
    for endpoint in Endpoint:
        # What works is worth more tries than what does not.
        yield from (Prompt(endpoint.value, params) for _ in range(4) for params in _SELECTIONS)
        yield from (Prompt(endpoint.value, params) for params in _DEFECTIVE)


def _drives(robots: tuple[str, ...]) -> Iterator[JSON]:
    for robot in robots:
        for part, values in _REPORTS:
            for value in values:
                yield {"event": "report", "robotId": robot, "part": part, "value": value}
    for part, value in _EXTREME:
        yield {"event": "report", "robotId": robots[0], "part": part, "value": value}
    yield {"event": "report", "robotId": "x1", "part": "battery", "value": _BATTERIES[0]}
    for robot in robots:
        yield {"event": "restart", "robotId": robot}
    for robot, location in ((robots[0], "L2"), (robots[-1], "L1"), (robots[0], "L1")):
        yield {"event": "move", "robotId": robot, "locationId": location}
    yield {"event": "fault", "status": "INTERNAL"}


def _plain_drives() -> Iterator[JSON]:
    """For exploration: one robot, and what takes its lifecycles through all of their states."""
    for part, values in (
        ("battery", _BATTERIES[1:4]),
        ("navigationState", _NAVIGATIONS[:2]),
        ("connection", _CONNECTIONS),
        ("wifi", (_NETWORKS[0], None)),
    ):
        for value in values:
            yield {"event": "report", "robotId": "r1", "part": part, "value": value}
    yield {"event": "fault", "status": "INTERNAL"}


def _plain() -> Iterator[Prompt]:
    """For exploration: one of every kind of call; but for an armed fault none changes the fleet."""
    yield Prompt(GET, {"robotId": "r1"})
    yield from (Prompt(GET, params) for params in _DEFECTIVE_GETS)
    for endpoint in Endpoint:
        yield Prompt(endpoint.value, _ids("r1"))
        yield from (Prompt(endpoint.value, params) for params in _DEFECTIVE)


_SHOWN: Mapping[Endpoint, tuple[str, tuple[JSON, ...]]] = {
    Endpoint.BATTERY: ("battery", _BATTERIES[:2]),
    Endpoint.ERRORS: ("errorCodes", _ERRORS[:2]),
    Endpoint.NAVIGATION: ("navigationState", _NAVIGATIONS[:2]),
    Endpoint.NETWORK: ("wifi", _NETWORKS[:2]),
    Endpoint.ONLINE: ("connection", _CONNECTIONS[::-1]),
    Endpoint.ROBOT: ("battery", _BATTERIES[:2]),
}
"""For each subscription a part of the state that it shows, and two values of it."""


def _scripts() -> Iterator[tuple[Line, ...]]:
    """Every subscription to several robots, and changes of each: chance seldom watches the second one change."""
    for endpoint, (part, values) in _SHOWN.items():
        for selection in (_at("L1"), _ids("r1", "r2")):
            reports = (
                Line("drive", {"event": "report", "robotId": robot, "part": part, "value": value})
                for robot in ("r2", "r1")
                for value in values
            )
            yield (Line(endpoint.value, selection), *(line for one in reports for line in (Line("settle"), one)))


def alphabet(_: JSON, __: Bounds) -> Alphabet:
    """What is worth trying on a fleet; the same robots are there in every world but the smallest."""
    return Alphabet(
        prompts=tuple(_prompts()),
        plain=tuple(_plain()),
        drives=tuple(_drives(("r1", "r2", "r3"))),
        plain_drives=tuple(_plain_drives()),
        worlds=_WORLDS,
        scripts=tuple(_scripts()),
    )


SYSTEM = System(NAME, SPEC, CODEC, alphabet, bends=BENDS, twists=TWISTS, sketches=SKETCHES)

__all__ = ["SYSTEM"]
