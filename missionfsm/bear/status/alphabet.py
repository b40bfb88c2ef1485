"""What is worth trying on an account's fleet: worlds, requests, reports.

What is reported is in range and does not contradict itself (a reason comes with a robot that is stuck, a charging
method with a battery that charges), since what becomes of other reports is nobody's promise. Requests and drives use
the robots and the locations of the world at hand.
"""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.bear.status.samples import (
    BATTERIES,
    CONNECTIONS,
    CONVEYOR,
    ERRORS,
    MISSIONS,
    NAVIGATIONS,
    NETWORKS,
    POSES,
    REPORTS,
    STOPS,
    TRAYS,
    TWISTS,
    at,
    by_ids,
    report,
)
from missionfsm.bear.status.scripts import Cast, abroad, scripts
from missionfsm.bear.status.state import GET, Endpoint
from missionfsm.kernel.alphabet import Alphabet, Bounds, Input
from missionfsm.kernel.codec import JSON


def _full(battery: JSON, **others: JSON) -> JSON:
    """The state of a robot that reports everything."""
    return {
        "connection": CONNECTIONS[0],
        "battery": battery,
        "emergencyStop": STOPS[0],
        "mission": MISSIONS[0],
        "pose": POSES[0],
        "errorCodes": ERRORS[1],
        "twist": TWISTS[0],
        "navigationState": NAVIGATIONS[0],
        **others,
    }


def _robot(robot: str, location: str, state: JSON, wifi: JSON = None, *, owned: bool = True) -> JSON:
    return {"robotId": robot, "locationId": location, "owned": owned, "state": state, "wifi": wifi}


_OWNED = {"L1": True, "L2": True, "L3": False, "L4": True, "L5": True, "L6": False}
_LOCATIONS: tuple[JSON, ...] = tuple({"locationId": place, "owned": owned} for place, owned in _OWNED.items())
"""Own ones with own robots (L1, where somebody else's is as well, and L2), without any (L4), with others' alone (L5);
somebody else's with a robot (L3) and without (L6)."""

_OTHERS = (
    _robot("x1", "L1", _full(BATTERIES[2]), NETWORKS[2], owned=False),
    _robot("x2", "L3", _full(BATTERIES[3]), None, owned=False),
    _robot("x3", "L5", _full(BATTERIES[2]), None, owned=False),
)
_WORLDS: tuple[JSON, ...] = (
    {
        "robots": [
            _robot("r1", "L1", _full(BATTERIES[0], serviState=TRAYS), NETWORKS[0]),
            _robot("r2", "L1", _full(BATTERIES[2], navigationState=NAVIGATIONS[1], twist=TWISTS[1]), None),
            _robot("r3", "L2", _full(BATTERIES[3], cartiState=CONVEYOR, errorCodes=ERRORS[2]), NETWORKS[2]),
            *_OTHERS,
        ],
        "locations": list(_LOCATIONS),
    },
    {
        "robots": [
            _robot("r1", "L1", _full(BATTERIES[1], twist=TWISTS[1], errorCodes=ERRORS[0]), NETWORKS[1]),
            _robot("r2", "L1", _full(BATTERIES[2], connection=CONNECTIONS[1]), NETWORKS[0]),
            _robot("r3", "L2", {}, None),
            *_OTHERS,
        ],
        "locations": list(_LOCATIONS),
    },
    {
        "robots": [
            _robot("r1", "L1", _full(BATTERIES[0]), NETWORKS[0]),
            _robot("r2", "L3", _full(BATTERIES[2]), NETWORKS[2]),
        ],
        "locations": [_LOCATIONS[0], _LOCATIONS[2]],
    },
)
"""In the last one a robot of the account is at somebody else's location."""
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
    def abroad(self) -> tuple[str, ...]:
        """Somebody else's locations with robots of the account."""
        homes = {self.homes[one] for one in self.own}
        return tuple(one for one in self.places if one in homes and not self.owned[one])

    @property
    def cast(self) -> Cast:
        """Who is in the conversations that are written down."""
        place = next(iter(self.selecting), None)
        others = (*self.selecting[1:], *(one for one in self.places if self.owned[one] and one not in self.selecting))
        taken = [*self.homes.values()]
        hermits = (one for one in self.own if self.homes[one] in self.selecting and taken.count(self.homes[one]) == 1)
        hermit = next(((one, self.homes[one]) for one in hermits), None)
        return Cast(self.own[:2], place, next(iter(others), None), hermit)

    @property
    def refused(self) -> tuple[str, ...]:
        """The other locations, and one that does not exist."""
        return (*(one for one in self.places if one not in self.selecting), _NOWHERE)


def _selections(names: _Names) -> Iterator[JSON]:
    """What selects robots of the account."""
    own = names.own
    yield from (by_ids(*some) for some in dict.fromkeys((own[:1], own[:2], own[:3][::-1], own[-1:])) if some)
    yield from map(at, names.selecting)


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
    by_ids(),
    by_ids(""),
    at(""),
)


def _defective(names: _Names) -> Iterator[JSON]:
    """What selects nothing, or more than the account has."""
    yield from _MALFORMED
    own, *more = names.own or ("r1",)
    other = more[0] if more else own
    yield from (
        by_ids(own, ""),
        by_ids("", _NOBODY),
        by_ids(_NOBODY, ""),
        by_ids(_NOBODY),
        by_ids(own, _NOBODY),
        by_ids(own, own),
    )
    for foreign in names.others[:1]:
        yield from (
            by_ids("", foreign),
            by_ids(foreign, ""),
            by_ids(foreign),
            by_ids(own, foreign),
            by_ids(foreign, other),
        )
        yield from (by_ids(foreign, _NOBODY), by_ids(foreign, foreign))
    yield from map(at, names.refused)
    for place in names.places[:1]:
        yield from (by_ids(own, locationId=place), by_ids(_NOBODY, locationId=place), by_ids(locationId=place))
        yield from (by_ids(one, locationId=place) for one in (*more[-1:], *names.others[:1]))
    yield from (by_ids(own, locationId=place) for place in names.places if not names.owned[place])
    yield by_ids(own, locationId="")
    yield from ({**by_ids(own), "mode": "fast"}, by_ids(own, mode="fast"))
    yield {"selector": {"robotIds": {"ids": [own], "mode": "fast"}}}
    yield from ({**by_ids(foreign), "mode": "fast"} for foreign in names.others[:1])


def _defective_gets(names: _Names) -> Iterator[JSON]:
    yield from ({}, {"robotId": ""}, {"robotId": None}, {"robotId": _NOBODY}, {"robotId": 7})
    yield from ({"robotId": one} for one in names.others[:1])
    yield from ({"robotId": one, "mode": "fast"} for one in (*names.own[:1], *names.others[:1]))


def _prompts(names: _Names) -> Iterator[Input]:
    for robot in names.own[:4]:
        yield from (Input(GET, {"robotId": robot}) for _ in range(3))
    yield from (Input(GET, params) for params in _defective_gets(names))
    for endpoint in Endpoint:
        # What works is worth more tries than what does not.
        yield from (Input(endpoint.value, params) for _ in range(6) for params in _selections(names))
        yield from (Input(endpoint.value, params) for params in _defective(names))


def _drives(names: _Names) -> Iterator[JSON]:
    watched = names.own[:3]
    for robot in watched:
        yield from (report(robot, part, value) for part, values in REPORTS for value in values)
        yield {"event": "restart", "robotId": robot}
    yield from (report(robot, "battery", BATTERIES[0]) for robot in names.others[:1])
    for robot, places in ((robot, names.places[:2]) for robot in (*watched[:1], *watched[-1:])):
        yield from ({"event": "move", "robotId": robot, "locationId": place} for place in places)
    yield {"event": "fault", "status": "INTERNAL"}


def _plain_drives(names: _Names) -> Iterator[JSON]:
    """For exploration: one robot, and what takes its lifecycles through all of their states."""
    for part, values in (
        ("battery", BATTERIES[1:4]),
        ("navigationState", NAVIGATIONS[:2]),
        ("connection", CONNECTIONS),
        ("wifi", (NETWORKS[0], None)),
    ):
        yield from (report(robot, part, value) for robot in names.own[:1] for value in values)
    yield {"event": "fault", "status": "INTERNAL"}


def _plain(names: _Names) -> Iterator[Input]:
    """For exploration: one of every kind of call; but for an armed fault none changes the fleet."""
    yield from (Input(GET, {"robotId": robot}) for robot in names.own[:1])
    yield from (Input(GET, params) for params in _defective_gets(names))
    for endpoint in Endpoint:
        yield from (Input(endpoint.value, by_ids(robot)) for robot in names.own[:1])
        yield from (Input(endpoint.value, params) for params in _defective(names))


def alphabet(world: JSON, _: Bounds) -> Alphabet:
    """What is worth trying on the fleet of a world; on the usual one where the world is empty."""
    names = _Names(world or _WORLDS[0])
    return Alphabet(
        inputs=tuple(_prompts(names)),
        core_inputs=tuple(_plain(names)),
        drives=tuple(_drives(names)),
        core_drives=tuple(_plain_drives(names)),
        worlds=_WORLDS,
        scripts=tuple(scripts(names.cast)),
        apart=tuple(map(abroad, names.abroad)),
    )


__all__ = ["alphabet"]
