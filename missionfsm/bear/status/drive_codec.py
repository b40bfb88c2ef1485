"""Worlds, drives and the states in them as JSON: testers and logs write them, so that what is wrong is refused."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import evolve

from missionfsm.bear.status import messages as wire
from missionfsm.bear.status.messages import RobotState, Wifi
from missionfsm.bear.status.state import (
    LOCALIZATION,
    PARTS,
    WIFI,
    Event,
    Location,
    Robot,
    Value,
    World,
)
from missionfsm.bear.status.values import clamped, single
from missionfsm.bear.status.views import Seen, canonical, canonical_state
from missionfsm.bear.wire.messages import MissionState, Pose
from missionfsm.bear.wire.protojson import MalformedError, camel, read, write
from missionfsm.kernel.codec import JSON, DriveForm, UnreadableError
from missionfsm.kernel.history import Name
from missionfsm.kernel.rules import INTERNAL
from missionfsm.kernel.shapes import TEXT
from missionfsm.kernel.text import brief

_KINDS: Mapping[str, type] = {
    "connection": wire.RobotConnection,
    "battery": wire.BatteryState,
    "emergency_stop": wire.EmergencyStopState,
    "mission": MissionState,
    "pose": Pose,
    "error_codes": wire.ErrorCodes,
    "servi_state": wire.ServiState,
    "carti_state": wire.CartiState,
    "twist": wire.Twist,
    "navigation_state": wire.NavigationState,
    WIFI: Wifi,
}


_PARTS: Mapping[str, str] = {name: part for part in PARTS for name in (camel(part), part)}


def _text(given: Mapping[str, JSON], name: str, where: str) -> str:
    value = given.get(name)
    if not isinstance(value, str) or not value:
        raise UnreadableError(f"{where}.{name}: {brief(value)} is not a text")
    return value


def _objects(given: JSON, where: str) -> list[dict[str, JSON]]:
    found = [] if given is None else given
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise UnreadableError(f"{where}: {brief(given)} is not a list of objects")
    return found


def _owned(given: Mapping[str, JSON], where: str) -> bool:
    value = given.get("owned", True)
    if not isinstance(value, bool):
        raise UnreadableError(f"{where}.owned: {brief(value)} is not true or false")
    return value


def part_value(part: str, given: JSON) -> Value:
    """What a robot reports of a part. Raises MalformedError."""
    if given is None or part == LOCALIZATION:
        return None
    if part == "mission":
        return read_state({"mission": given})[0].mission
    value: Value = canonical(part, single(read(_KINDS[part], given)))
    return value


def _robot(given: dict[str, JSON], where: str) -> Robot:
    robot_id, state, wifi = _text(given, "robotId", where), given.get("state"), given.get("wifi")
    location = given.get("locationId", "")
    if not isinstance(location, str):
        raise UnreadableError(f"{where}.locationId: {brief(location)} is not a text")
    try:
        known = read_state(state)[0]
        network = part_value(WIFI, wifi)
    except MalformedError as error:
        raise UnreadableError(f"{where}: {error}") from None
    known = evolve(known, battery=clamped(known.battery))
    if known.servi_state is not None and known.carti_state is not None:
        raise UnreadableError(f"{where}.state: servi_state and carti_state are both set")
    return Robot(robot_id, location, _owned(given, where), known, clamped(network))


def world(given: JSON) -> World:
    """The world of a `reset` or of a history's first line."""
    given = {} if given is None else given
    if not isinstance(given, dict):
        raise UnreadableError(f"world: {brief(given)} is not an object")
    unknown = [name for name in given if name not in ("robots", "locations")]
    if unknown:
        raise UnreadableError(f"world.{unknown[0]}: there is no such field; there are robots, locations")
    robots = tuple(
        _robot(one, f"world.robots[{index}]") for index, one in enumerate(_objects(given.get("robots"), "world.robots"))
    )
    locations = tuple(
        Location(_text(one, "locationId", f"world.locations[{index}]"), _owned(one, f"world.locations[{index}]"))
        for index, one in enumerate(_objects(given.get("locations"), "world.locations"))
    )
    for kind, ids in (("robot", [one.id for one in robots]), ("location", [one.id for one in locations])):
        if len(set(ids)) < len(ids):
            raise UnreadableError(f"world: a {kind} is listed twice")
    return World(robots, locations)


def write_world(one: World) -> JSON:
    """The parameters of `reset`."""
    return {
        "robots": [
            {
                "robotId": robot.id,
                "locationId": robot.location,
                "owned": robot.owned,
                "state": write(robot.state),
                "wifi": None if robot.wifi is None else write(robot.wifi),
            }
            for robot in one.robots
        ],
        "locations": [{"locationId": place.id, "owned": place.owned} for place in one.locations],
    }


def _whose(given: JSON) -> str:
    return _text(given, "robotId", "drive")


def _report(given: JSON) -> tuple[Event, tuple[Name, ...]]:
    """A robot reports a part."""
    robot, named = _whose(given), given.get("part")
    part = _PARTS.get(named) if isinstance(named, str) else None
    if part is None:
        raise UnreadableError(f"drive.part: {brief(given.get('part'))} is not a part of a robot's state")
    try:
        value = part_value(part, given.get("value"))
    except MalformedError as error:
        raise UnreadableError(f"drive.value: {error}") from None
    return Event("report", robot, part, value), ()


def _reported(event: Event, _: tuple[Name, ...]) -> dict[str, JSON]:
    value: Any = None if event.value is None else write(event.value)
    return {"robotId": event.robot, "part": camel(event.part), "value": value}


def _fault(given: JSON) -> tuple[Event, tuple[Name, ...]]:
    """A fault of the next call."""
    if given.get("status") != INTERNAL:
        raise UnreadableError(f"drive.status: a fault has status INTERNAL, not {brief(given.get('status'))}")
    return Event("fault", value=INTERNAL), ()


DRIVES = {
    "report": DriveForm(
        _report,
        _reported,
        {"robotId": TEXT, "part": {"enum": [camel(one) for one in PARTS]}, "value": {}},
        ("robotId", "part"),
    ),
    "restart": DriveForm(
        lambda given: (Event("restart", _whose(given)), ()),
        lambda event, _: {"robotId": event.robot},
        {"robotId": TEXT},
        ("robotId",),
    ),
    "move": DriveForm(
        lambda given: (Event("move", _whose(given), value=_text(given, "locationId", "drive")), ()),
        lambda event, _: {"robotId": event.robot, "locationId": event.value},
        {"robotId": TEXT, "locationId": TEXT},
        ("robotId", "locationId"),
    ),
    "fault": DriveForm(_fault, lambda event, _: {"status": event.value}, {"status": {"const": INTERNAL}}, ("status",)),
}


def field(message: Mapping[str, JSON], name: str) -> JSON:
    """A field by either of its names; absent and null are the same."""
    value = message.get(name)
    return value if value is not None else message.get(_SNAKE.get(name, name))


_SNAKE = {
    camel(name): name
    for name in (
        "robot_id",
        "robot_ids",
        "robot_state",
        "battery_state",
        "navigation_state",
        "error_codes",
        "network_states",
        "online_states",
        "connected_wifi",
        "typed_status",
    )
}


def read_state(given: JSON) -> tuple[RobotState, bool | None]:
    """A robot state in the form in which it is compared, and whether the goals of its mission are wrapped (AS-22).

    Raises:
        MalformedError: it is not one.
    """
    if given is None:
        return RobotState(), None
    if not isinstance(given, dict):
        raise MalformedError(f"{brief(given)} is not an object", "robotState")
    if field(given, "typedStatus") is not None:
        raise MalformedError("is the name of a oneof, not of a field", "typedStatus")
    mission = given.get("mission")
    wrapped = None
    if isinstance(mission, dict) and isinstance(mission.get("goals"), list) and mission["goals"]:
        goals = mission["goals"]
        wrapped = all(isinstance(one, dict) and isinstance(one.get("goal"), dict) for one in goals)
        if wrapped:
            given = {**given, "mission": {**mission, "goals": [one["goal"] for one in goals]}}
    state = read(RobotState, given)
    return canonical_state(single(state)), wrapped


def write_state(shown: Seen) -> JSON:
    """The JSON of a robot state."""
    state = write(shown.value)
    if shown.wrapped:
        state["mission"]["goals"] = [{"goal": goal} for goal in state["mission"]["goals"]]
    return state
