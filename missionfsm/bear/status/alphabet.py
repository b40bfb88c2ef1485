"""What is worth trying on an account's fleet: worlds, requests, reports.

What is reported is in range and does not contradict itself (a reason comes with a robot that is stuck, a charging
method with a battery that charges), since what becomes of other reports is nobody's promise. Requests and drives use
the robots and the locations of the world at hand.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from missionfsm.bear.status.state import GET, Endpoint
from missionfsm.kernel.alphabet import Alphabet, Bounds, Line, Prompt
from missionfsm.kernel.codec import JSON

_BATTERIES: tuple[JSON, ...] = (
    {"chargePercent": 78, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_CONTACT"},
    {"chargePercent": 79, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_CONTACT"},
    {"chargePercent": 42, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"},
    {"chargePercent": 100, "state": "STATE_FULL", "chargeMethod": "CHARGE_METHOD_WIRED"},
    {"chargePercent": 0, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_WIRED"},
    {"chargePercent": 78, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_WIRED"},
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
    # The same code with another severity, with another message, and twice.
    {"codes": [{"code": 1001, "severity": "SEVERITY_HIGH", "message": "Low battery warning"}]},
    {"codes": [{"code": 1001, "severity": "SEVERITY_MEDIUM", "message": "Low battery"}]},
    {
        "codes": [
            {"code": 7, "severity": "SEVERITY_LOW", "message": "Up camera process error."},
            {"code": 7, "severity": "SEVERITY_LOW", "message": "Down camera process error."},
        ]
    },
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
    {"ssid": "office", "signalLevelDbm": -45, "linkQuality": 70, "security": "SECURITY_PASSWORD_SECURED"},
    {"ssid": "office", "signalLevelDbm": -45, "linkQuality": 65, "security": "SECURITY_USERNAME_PASSWORD_SECURED"},
    {"ssid": "guests", "signalLevelDbm": -70, "linkQuality": 0, "security": "SECURITY_UNSECURED"},
    None,
)
_CONNECTIONS: tuple[JSON, ...] = ({"state": "STATE_CONNECTED"}, {"state": "STATE_DISCONNECTED"})
_STOPS: tuple[JSON, ...] = (
    {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"},
    {"emergency": "EMERGENCY_ENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"},
    {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_ENGAGED"},
    {"emergency": "EMERGENCY_ENGAGED", "buttonPressed": "EMERGENCY_ENGAGED"},
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
    {
        "missionId": "mission-456",
        "state": "STATE_PAUSED",
        "goals": [{"destinationId": "table-1"}, {"destinationId": "table-2"}],
        "currentGoalIndex": 1,
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
    ("battery", (*_BATTERIES, None)),
    ("errorCodes", (*_ERRORS, None)),
    ("navigationState", (*_NAVIGATIONS, None)),
    ("wifi", _NETWORKS),
    ("connection", (*_CONNECTIONS, _CONNECTIONS[0], None)),
    ("emergencyStop", (*_STOPS, None)),
    ("mission", _MISSIONS),
    ("twist", _TWISTS),
    ("pose", (*_POSES, None)),
    ("serviState", (_TRAYS, {"trayStates": {"trayStates": []}})),
    ("cartiState", (_CONVEYOR, None)),
    ("localizationState", ({"state": "STATE_SUCCEEDED"},)),
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


_OWNED = {"L1": True, "L2": True, "L3": False, "L4": True, "L5": True, "L6": False}
_LOCATIONS: tuple[JSON, ...] = tuple({"locationId": place, "owned": owned} for place, owned in _OWNED.items())
"""Own ones with own robots (L1, where somebody else's is as well, and L2), without any (L4), with others' alone (L5);
somebody else's with a robot (L3) and without (L6)."""

_OTHERS = (
    _robot("x1", "L1", _full(_BATTERIES[2]), _NETWORKS[2], owned=False),
    _robot("x2", "L3", _full(_BATTERIES[3]), None, owned=False),
    _robot("x3", "L5", _full(_BATTERIES[2]), None, owned=False),
)
_WORLDS: tuple[JSON, ...] = (
    {
        "robots": [
            _robot("r1", "L1", _full(_BATTERIES[0], serviState=_TRAYS), _NETWORKS[0]),
            _robot("r2", "L1", _full(_BATTERIES[2], navigationState=_NAVIGATIONS[1], twist=_TWISTS[1]), None),
            _robot("r3", "L2", _full(_BATTERIES[3], cartiState=_CONVEYOR, errorCodes=_ERRORS[2]), _NETWORKS[2]),
            *_OTHERS,
        ],
        "locations": list(_LOCATIONS),
    },
    {
        "robots": [
            _robot("r1", "L1", _full(_BATTERIES[1], twist=_TWISTS[1], errorCodes=_ERRORS[0]), _NETWORKS[1]),
            _robot("r2", "L1", _full(_BATTERIES[2], connection=_CONNECTIONS[1]), _NETWORKS[0]),
            _robot("r3", "L2", {}, None),
            *_OTHERS,
        ],
        "locations": list(_LOCATIONS),
    },
    {"robots": [_robot("r1", "L1", _full(_BATTERIES[0]), _NETWORKS[0])], "locations": list(_LOCATIONS[:1])},
)
_NOBODY, _NOWHERE = "nobody", "nowhere"


class _Names:
    """The names of a world."""

    def __init__(self, world: JSON) -> None:
        robots = world.get("robots") or []
        self.own = tuple(one["robotId"] for one in robots if one.get("owned", True))
        self.others = tuple(one["robotId"] for one in robots if not one.get("owned", True))
        self.places = tuple(one["locationId"] for one in world.get("locations") or [])
        self.owned = {one["locationId"]: one.get("owned", True) for one in world.get("locations") or []}
        self.homes = {one["robotId"]: one.get("locationId", "") for one in robots}

    @property
    def selecting(self) -> tuple[str, ...]:
        """The account's locations with robots of its own."""
        homes = {self.homes[one] for one in self.own}
        return tuple(one for one in self.places if one in homes and self.owned[one])

    @property
    def refused(self) -> tuple[str, ...]:
        """The other locations, and one that does not exist."""
        return (*(one for one in self.places if one not in self.selecting), _NOWHERE)


def _ids(*robots: JSON, **selector: JSON) -> JSON:
    return {"selector": {"robotIds": {"ids": list(robots)}, **selector}}


def _at(location: JSON) -> JSON:
    return {"selector": {"locationId": location}}


def _selections(names: _Names) -> Iterator[JSON]:
    """What selects robots of the account."""
    own = names.own
    yield from (_ids(*some) for some in dict.fromkeys((own[:1], own[:2], own[:3][::-1], own[-1:])) if some)
    yield from map(_at, names.selecting)


_MALFORMED: tuple[JSON, ...] = (
    {},
    {"selector": None},
    {"selector": {}},
    {"selector": "r1"},
    {"selector": ["r1"]},
    {"selector": {"robotIds": {}}},
    {"selector": {"robotIds": ["r1"]}},
    {"selector": {"robotIds": {"ids": "r1"}}},
    {"selector": {"robotIds": {"ids": [7]}}},
    {"selector": {"locationId": 7}},
    _ids(),
    _ids(""),
    _at(""),
)


def _defective(names: _Names) -> Iterator[JSON]:
    """What selects nothing, or more than the account has."""
    yield from _MALFORMED
    own, *more = names.own or ("r1",)
    other = more[0] if more else own
    yield from (_ids(own, ""), _ids("", _NOBODY), _ids(_NOBODY, ""), _ids(_NOBODY), _ids(own, _NOBODY), _ids(own, own))
    for foreign in names.others[:1]:
        yield from (_ids("", foreign), _ids(foreign, ""), _ids(foreign), _ids(own, foreign), _ids(foreign, other))
        yield from (_ids(foreign, _NOBODY), _ids(foreign, foreign))
    yield from map(_at, names.refused)
    for place in names.places[:1]:
        yield from (_ids(own, locationId=place), _ids(_NOBODY, locationId=place), _ids(locationId=place))
        yield from (_ids(one, locationId=place) for one in (*more[-1:], *names.others[:1]))
    yield from (_ids(own, locationId=place) for place in names.places if not names.owned[place])
    yield _ids(own, locationId="")
    yield from ({**_ids(own), "mode": "fast"}, _ids(own, mode="fast"))
    yield {"selector": {"robotIds": {"ids": [own], "mode": "fast"}}}
    yield from ({**_ids(foreign), "mode": "fast"} for foreign in names.others[:1])


def _defective_gets(names: _Names) -> Iterator[JSON]:
    yield from ({}, {"robotId": ""}, {"robotId": None}, {"robotId": _NOBODY}, {"robotId": 7})
    yield from ({"robotId": one} for one in names.others[:1])
    yield from ({"robotId": one, "mode": "fast"} for one in (*names.own[:1], *names.others[:1]))


def _prompts(names: _Names) -> Iterator[Prompt]:
    for robot in names.own[:4]:
        yield from (Prompt(GET, {"robotId": robot}) for _ in range(3))
    yield from (Prompt(GET, params) for params in _defective_gets(names))
    for endpoint in Endpoint:
        # What works is worth more tries than what does not.
        yield from (Prompt(endpoint.value, params) for _ in range(6) for params in _selections(names))
        yield from (Prompt(endpoint.value, params) for params in _defective(names))


def _report(robot: str, part: str, value: JSON) -> JSON:
    return {"event": "report", "robotId": robot, "part": part, "value": value}


def _drives(names: _Names) -> Iterator[JSON]:
    watched = names.own[:3]
    for robot in watched:
        yield from (_report(robot, part, value) for part, values in _REPORTS for value in values)
        yield {"event": "restart", "robotId": robot}
    yield from (_report(robot, "battery", _BATTERIES[0]) for robot in names.others[:1])
    for robot, places in ((robot, names.places[:2]) for robot in (*watched[:1], *watched[-1:])):
        yield from ({"event": "move", "robotId": robot, "locationId": place} for place in places)
    yield {"event": "fault", "status": "INTERNAL"}


def _plain_drives(names: _Names) -> Iterator[JSON]:
    """For exploration: one robot, and what takes its lifecycles through all of their states."""
    for part, values in (
        ("battery", _BATTERIES[1:4]),
        ("navigationState", _NAVIGATIONS[:2]),
        ("connection", _CONNECTIONS),
        ("wifi", (_NETWORKS[0], None)),
    ):
        yield from (_report(robot, part, value) for robot in names.own[:1] for value in values)
    yield {"event": "fault", "status": "INTERNAL"}


def _plain(names: _Names) -> Iterator[Prompt]:
    """For exploration: one of every kind of call; but for an armed fault none changes the fleet."""
    yield from (Prompt(GET, {"robotId": robot}) for robot in names.own[:1])
    yield from (Prompt(GET, params) for params in _defective_gets(names))
    for endpoint in Endpoint:
        yield from (Prompt(endpoint.value, _ids(robot)) for robot in names.own[:1])
        yield from (Prompt(endpoint.value, params) for params in _defective(names))


_SHOWN: Mapping[Endpoint, tuple[str, tuple[JSON, ...]]] = {
    Endpoint.BATTERY: ("battery", (_BATTERIES[1], _BATTERIES[5], _BATTERIES[0])),
    Endpoint.ERRORS: ("errorCodes", (_ERRORS[4], _ERRORS[1])),
    Endpoint.NAVIGATION: ("navigationState", _NAVIGATIONS[:2]),
    Endpoint.NETWORK: ("wifi", (_NETWORKS[3], _NETWORKS[0], _NETWORKS[1])),
    Endpoint.ONLINE: ("connection", _CONNECTIONS[::-1]),
    Endpoint.ROBOT: ("battery", (_BATTERIES[5], _BATTERIES[0], _BATTERIES[1])),
}
"""For each subscription a part of the state that it shows, and values of it, one after the other nearly the same."""


def _scripts(names: _Names) -> Iterator[tuple[Line, ...]]:
    """Every subscription to several robots, and changes of each: chance seldom watches the second one change."""
    robots = names.own[:2]
    for endpoint, (part, values) in _SHOWN.items():
        for selection in (*map(_at, names.selecting[:1]), _ids(*robots)):
            reports = (Line("drive", _report(robot, part, value)) for robot in robots[::-1] for value in values)
            yield (Line(endpoint.value, selection), *(line for one in reports for line in (Line("settle"), one)))


def alphabet(world: JSON, _: Bounds) -> Alphabet:
    """What is worth trying on the fleet of a world; on the usual one where the world is empty."""
    names = _Names(world or _WORLDS[0])
    return Alphabet(
        prompts=tuple(_prompts(names)),
        plain=tuple(_plain(names)),
        drives=tuple(_drives(names)),
        plain_drives=tuple(_plain_drives(names)),
        worlds=_WORLDS,
        scripts=tuple(_scripts(names)),
    )


__all__ = ["alphabet"]
