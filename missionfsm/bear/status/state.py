"""The fleet of the Robot Status page as a state: its robots, what they reported, and what has been heard of them.

There are no names in this system: robots and locations are called as the tester called them, and so are missions.
"""

from __future__ import annotations

import enum
import functools
from collections.abc import Mapping
from typing import Any

from attrs import evolve, frozen

from missionfsm.bear.status.messages import (
    BatteryMode,
    ConnectionState,
    Emergency,
    RobotState,
    Stuck,
    Wifi,
)
from missionfsm.kernel.chart import Chart
from missionfsm.kernel.rules import Document

STATUS = Document("Robot Status", "Robot Status (cloud API)")
SYSTEM_NAME = "bear.status"


class Endpoint(enum.Enum):
    """The subscriptions, by the name of the call."""

    BATTERY = "SubscribeBatteryStatus"
    ERRORS = "SubscribeErrorCodes"
    NAVIGATION = "SubscribeNavigationStatus"
    NETWORK = "SubscribeNetworkStatus"
    ONLINE = "SubscribeOnlineStatus"
    ROBOT = "SubscribeRobotStatus"


GET = "GetRobotStatus"
MAPS: Mapping[Endpoint, str] = {
    Endpoint.ERRORS: "errorCodes",
    Endpoint.NETWORK: "networkStates",
    Endpoint.ONLINE: "onlineStates",
}
"""Subscriptions whose messages map robot ids to entries, and the field that does."""

SINGLES: Mapping[Endpoint, str] = {
    Endpoint.BATTERY: "batteryState",
    Endpoint.NAVIGATION: "navigationState",
    Endpoint.ROBOT: "robotState",
}
"""Subscriptions whose messages are about one robot, and the field that carries its state."""

WIFI = "wifi"
LOCALIZATION = "localization_state"
STATE_PARTS = (
    "connection",
    "battery",
    "emergency_stop",
    "mission",
    "pose",
    "error_codes",
    "servi_state",
    "carti_state",
    "twist",
    "navigation_state",
)
"""The fields of RobotState that the page defines."""

TYPED = ("servi_state", "carti_state")
"""The parts of which a robot has one, by its type."""
PARTS = (*STATE_PARTS, LOCALIZATION, WIFI)
"""What a robot can report."""

TOPICAL: Mapping[Endpoint, str] = {
    Endpoint.BATTERY: "battery",
    Endpoint.ERRORS: "error_codes",
    Endpoint.NAVIGATION: "navigation_state",
    Endpoint.ONLINE: "connection",
    Endpoint.NETWORK: WIFI,
}
"""The part that a subscription with a single topic is about."""

CONNECTION: Chart[ConnectionState] = Chart(
    "connection",
    ConnectionState.STATE_UNKNOWN,
    (
        ("connect", ConnectionState.STATE_UNKNOWN, ConnectionState.STATE_CONNECTED),
        ("disconnect", ConnectionState.STATE_UNKNOWN, ConnectionState.STATE_DISCONNECTED),
        ("disconnect", ConnectionState.STATE_CONNECTED, ConnectionState.STATE_DISCONNECTED),
        ("connect", ConnectionState.STATE_DISCONNECTED, ConnectionState.STATE_CONNECTED),
    ),
    {"STATE_UNKNOWN": "nothing is known of the robot yet"},
)
BATTERY: Chart[BatteryMode] = Chart(
    "battery",
    BatteryMode.STATE_UNKNOWN,
    (
        ("plug in", BatteryMode.STATE_UNKNOWN, BatteryMode.STATE_CHARGING),
        ("unplug", BatteryMode.STATE_UNKNOWN, BatteryMode.STATE_DISCHARGING),
        ("fill up", BatteryMode.STATE_UNKNOWN, BatteryMode.STATE_FULL),
        ("plug in", BatteryMode.STATE_DISCHARGING, BatteryMode.STATE_CHARGING),
        ("fill up", BatteryMode.STATE_DISCHARGING, BatteryMode.STATE_FULL),
        ("unplug", BatteryMode.STATE_CHARGING, BatteryMode.STATE_DISCHARGING),
        ("fill up", BatteryMode.STATE_CHARGING, BatteryMode.STATE_FULL),
        ("unplug", BatteryMode.STATE_FULL, BatteryMode.STATE_DISCHARGING),
        ("top up", BatteryMode.STATE_FULL, BatteryMode.STATE_CHARGING),
    ),
    {"DISCHARGING to FULL": "a full battery is plugged in, or what lay between was not streamed (AS-13)"},
)
EMERGENCY_STOP: Chart[Emergency] = Chart(
    "emergency stop",
    Emergency.EMERGENCY_UNKNOWN,
    (
        ("engage", Emergency.EMERGENCY_UNKNOWN, Emergency.EMERGENCY_ENGAGED),
        ("disengage", Emergency.EMERGENCY_UNKNOWN, Emergency.EMERGENCY_DISENGAGED),
        ("engage", Emergency.EMERGENCY_DISENGAGED, Emergency.EMERGENCY_ENGAGED),
        ("disengage", Emergency.EMERGENCY_ENGAGED, Emergency.EMERGENCY_DISENGAGED),
    ),
    {"two of them": "the software stop and the button, each by itself (AS-16)"},
)
STUCK: Chart[Stuck] = Chart(
    "stuck",
    Stuck.STATE_UNKNOWN,
    (
        ("get free", Stuck.STATE_UNKNOWN, Stuck.STATE_NOT_STUCK),
        ("get stuck", Stuck.STATE_UNKNOWN, Stuck.STATE_STUCK),
        ("get stuck", Stuck.STATE_NOT_STUCK, Stuck.STATE_STUCK),
        ("get free", Stuck.STATE_STUCK, Stuck.STATE_NOT_STUCK),
    ),
    {"STATE_UNKNOWN": "an error if received (AS-18)"},
)
CHARTS = (CONNECTION, BATTERY, EMERGENCY_STOP, STUCK)

Value = Any
"""A part of a robot's state as it was reported (frozen and hashable), or None where it is not reported."""


class Unset(enum.Enum):
    """Why nothing is known of a topic that a robot was said not to report; None where nothing was ever said of it."""

    CEASED = "it was reported once"
    TOLD = "it was never reported"


@frozen(cache_hash=True)
class Robot:
    """A robot as the cloud knows it.

    Attributes:
        state: what it reports now.
        wifi: the network that it is connected to.
        known: by subscription with a single topic, in the order of `TOPICAL`: what is known of it, perhaps although
            the robot does not report it any more (AS-09); None or an `Unset` for nothing.
        left: the locations that it has left, sorted: once there are any, it matters which robots a location's streams
            follow (AS-25).
    """

    id: str
    location: str
    owned: bool = True
    state: RobotState = RobotState()
    wifi: Wifi | None = None
    known: tuple[Value, ...] = (None,) * len(TOPICAL)
    left: tuple[str, ...] = ()

    def part(self, name: str) -> Value:
        """What it reports of a part."""
        found: Value = self.wifi if name == WIFI else getattr(self.state, name)
        return found

    def topic(self, endpoint: Endpoint) -> Value:
        """What is known of the topic of a subscription with a single one; None for nothing."""
        known = self.known[_POSITIONS[endpoint]]
        return None if isinstance(known, Unset) else known

    def unset(self, endpoint: Endpoint) -> Unset | None:
        """Why nothing is known of the topic of a subscription with a single one, if the robot said so."""
        known = self.known[_POSITIONS[endpoint]] if endpoint in _POSITIONS else None
        return known if isinstance(known, Unset) else None

    @property
    def connection(self) -> ConnectionState:
        """What it says of its connection."""
        return self.state.connection.state if self.state.connection else ConnectionState.STATE_UNKNOWN

    @property
    def offline(self) -> bool:
        """Whether it is known to be disconnected."""
        return self.connection is ConnectionState.STATE_DISCONNECTED

    @property
    def seen(self) -> bool:
        """Whether anything is known of it at all."""
        return self.state != RobotState()


_POSITIONS = {endpoint: position for position, endpoint in enumerate(TOPICAL)}


def reporting(robot: Robot, part: str, value: Value, *, keep: bool = True) -> Robot:
    """The robot after a report.

    Args:
        keep: what was known of a topic stays known when it is not reported any more.
    """
    if part == LOCALIZATION:
        return robot
    if part == WIFI:
        robot = evolve(robot, wifi=value)
    else:
        other = {"servi_state": "carti_state", "carti_state": "servi_state"}.get(part)
        changed = {part: value, **({other: None} if other and value is not None else {})}
        robot = evolve(robot, state=evolve(robot.state, **changed))
    for endpoint, topic in TOPICAL.items():
        if topic == part:
            known = list(robot.known)
            known[_POSITIONS[endpoint]] = _learnt(known[_POSITIONS[endpoint]], value, keep=keep)
            robot = evolve(robot, known=tuple(known))
    return robot


def _learnt(known: Value, value: Value, *, keep: bool) -> Value:
    """What is known of a topic after a report about it."""
    if value is not None:
        return value
    if known is None:
        return Unset.TOLD
    return known if keep or isinstance(known, Unset) else Unset.CEASED


def starting(robot: Robot) -> Robot:
    """The robot of a world: what it reports is known."""
    return evolve(robot, known=tuple(robot.part(part) for part in TOPICAL.values()))


@frozen(cache_hash=True)
class Location:
    """A place with robots."""

    id: str
    owned: bool = True


@frozen(cache_hash=True)
class World:
    """Robots and locations; one that is not listed does not exist."""

    robots: tuple[Robot, ...] = ()
    locations: tuple[Location, ...] = ()


@frozen(cache_hash=True)
class Fleet:
    """All robots and locations.

    Attributes:
        fault: the next GetRobotStatus that would succeed fails.
        unheard: robots may have reported anything since the start, and nobody knows what.
    """

    robots: tuple[Robot, ...] = ()
    locations: tuple[Location, ...] = ()
    fault: bool = False
    unheard: bool = False

    @property
    def by_id(self) -> Mapping[str, Robot]:
        """The robots by their ids; whoever looks for many of them asks once."""
        return _by_id(self.robots)

    def robot(self, robot_id: str) -> Robot | None:
        """The robot with an id."""
        return self.by_id.get(robot_id)

    def location(self, location_id: str) -> Location | None:
        """The location with an id."""
        return next((one for one in self.locations if one.id == location_id), None)

    def at(self, location_id: str) -> tuple[Robot, ...]:
        """The account's robots at a location."""
        return tuple(one for one in self.robots if one.owned and one.location == location_id)

    def put(self, robot: Robot) -> Fleet:
        """The fleet with a robot in the place of the one with its id; the same object where nothing changes."""
        if self.robot(robot.id) == robot:
            return self
        return evolve(self, robots=tuple(robot if one.id == robot.id else one for one in self.robots))


@functools.lru_cache(maxsize=10_000)
def _by_id(robots: tuple[Robot, ...]) -> Mapping[str, Robot]:
    return {robot.id: robot for robot in robots}


def whose(fleet: Fleet) -> Fleet:
    """The fleet without what robots report: whose they are, and where; the same object for fleets alike in that."""
    return _without_reports(tuple((one.id, one.location, one.owned) for one in fleet.robots), fleet.locations)


@functools.lru_cache(maxsize=1_000)
def _without_reports(robots: tuple[tuple[str, str, bool], ...], locations: tuple[Location, ...]) -> Fleet:
    return Fleet(tuple(Robot(*one) for one in robots), locations)


@functools.lru_cache(maxsize=64)
def initial(world: World) -> Fleet:
    """The fleet of a world."""
    return Fleet(tuple(map(starting, world.robots)), world.locations)


@frozen(cache_hash=True)
class Event:
    """Something that the environment does: the name of a drive, the robot, and what it takes.

    `part` and `value` are those of a report; of a move the value is the location; of a fault it is the status.
    """

    name: str
    robot: str = ""
    part: str = ""
    value: Value = None


FORGET = Event("report")
"""Nobody drives the reports: from now on any robot may have reported anything."""


@frozen(cache_hash=True)
class Request:
    """One call of one operation, well-formed or not.

    Attributes:
        ids: the robot ids that it names, in order, each once.
        by_ids: whether the list of robot ids is set.
        location: the location that it names; None if that is not set.
        repeated: an id is named twice.
        bare: the list of robot ids stands where the message that holds it should stand.
        unknown_fields: where it has fields that are not documented: `request`, `selector`, `ids`.
        malformed: where and how it is malformed; empty where it is not.
    """

    operation: str
    ids: tuple[str, ...] = ()
    by_ids: bool = False
    location: str | None = None
    repeated: bool = False
    bare: bool = False
    unknown_fields: tuple[str, ...] = ()
    malformed: str = ""

    @property
    def both(self) -> bool:
        """Whether it selects by robot ids and by location."""
        return self.by_ids and self.location is not None
