"""The JSON of the Robot Status page: requests, answers, messages, worlds and drives, in and out."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from typing import Any

import attrs
from attrs import evolve

from missionfsm.bear.status import messages as wire
from missionfsm.bear.status.messages import ErrorCodes, RobotState, Wifi
from missionfsm.bear.status.rules import OPERATIONS
from missionfsm.bear.status.state import (
    GET,
    LOCALIZATION,
    MAPS,
    PARTS,
    SINGLES,
    WIFI,
    Endpoint,
    Happening,
    Location,
    Request,
    Robot,
    Value,
    World,
)
from missionfsm.bear.status.stream import show
from missionfsm.bear.status.values import clamped, single
from missionfsm.bear.status.views import Promised, Seen, View, canonical, canonical_state
from missionfsm.bear.wire.binary import carries
from missionfsm.bear.wire.messages import EventMetadata, MissionState, Pose
from missionfsm.bear.wire.protojson import MalformedError, camel, read, unknown_fields, write
from missionfsm.kernel.codec import JSON, Codec, Malformed, Part, UnreadableError
from missionfsm.kernel.history import Answer, Mark, Name
from missionfsm.kernel.rules import INTERNAL, OK
from missionfsm.kernel.text import brief

STREAMS = tuple(endpoint.value for endpoint in Endpoint)


# Requests.


def split(method: str, params: JSON) -> tuple[tuple[Name, ...], JSON]:
    """Requests have no names: what a tester calls robots and locations is content."""
    if method not in OPERATIONS:
        message = f"{brief(method)} is not a method of bear.status"
        raise UnreadableError(message)
    return (), params


def request(method: str, params: JSON) -> Request:
    """The request that a call makes."""
    params = {} if params is None else params
    try:
        if method == GET:
            unknown = ("request",) if unknown_fields(wire.StatusRequest, params) else ()
            return Request(method, (read(wire.StatusRequest, params).robot_id,), unknown_fields=unknown)
        selector = read(wire.SubscribeRequest, params).selector or wire.RobotSelector()
    except MalformedError as error:
        return Request(method, malformed=str(error))
    given = selector.robot_ids.ids if selector.robot_ids else ()
    ids = tuple(dict.fromkeys(given))
    return Request(
        method,
        ids,
        by_ids=selector.robot_ids is not None,
        location=selector.location_id,
        repeated=len(ids) < len(given),
        unknown_fields=_levels(params),
    )


def _levels(params: JSON) -> tuple[str, ...]:
    """Where a well-formed subscription has fields that are not documented."""
    selector = _field(params, "selector") or {}
    ids = _field(selector, "robotIds") or {}
    levels = ((wire.SubscribeRequest, params), (wire.RobotSelector, selector), (wire.RobotIDs, ids))
    names = ("request", "selector", "ids")
    return tuple(
        name
        for name, (kind, message) in zip(names, levels, strict=True)
        if not message.keys() <= {one for field in attrs.fields(kind) for one in (field.name, camel(field.name))}
    )


def write_request(asked: Request, _: tuple[Name, ...] = ()) -> JSON:
    """The params of a well-formed request; of a defective one the part that can be said."""
    if asked.operation == GET:
        return {"robotId": asked.ids[0]} if asked.ids else {}
    selector: dict[str, JSON] = {}
    if asked.by_ids:
        selector["robotIds"] = {"ids": [*asked.ids, *(asked.ids[:1] if asked.repeated else ())]}
    if asked.location is not None:
        selector["locationId"] = asked.location
    return {"selector": selector} if selector else {}


# Answers.


def answer(method: str, result: JSON) -> tuple[Answer, tuple[Name, ...]]:
    """What a successful result says; one that is not of the documented form is `Malformed`."""
    if method in STREAMS:
        stream = result.get("stream") if isinstance(result, dict) else None
        if isinstance(stream, bool) or not isinstance(stream, int):
            message = f"{method} answered {brief(result)}, which carries no stream number"
            raise UnreadableError(message)
        return Answer(OK), (("stream", stream),)
    try:
        if not isinstance(result, dict):
            raise MalformedError(f"{brief(result)} is not an object")
        state, wrapped = read_state(_field(result, "robotState"))
    except MalformedError as error:
        return Answer(OK, Malformed(str(error))), ()
    return Answer(OK, Seen("", Endpoint.ROBOT, state, wrapped)), ()


def write_answer(method: str, given: Answer, names: tuple[Name, ...]) -> JSON:
    """The result of a call that succeeded."""
    if method in STREAMS:
        return {"stream": names[0][1]}  # type: ignore[index]
    assert isinstance(given.shape, Promised), "the answer of GetRobotStatus has a state"  # noqa: S101
    return {"robotState": write_state(given.shape.shown)}


# States.


def _field(message: Mapping[str, JSON], name: str) -> JSON:
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
    if _field(given, "typedStatus") is not None:
        raise MalformedError("typed_status is the name of a oneof, not of a field", "robotState")
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


# Messages.


def strip(message: JSON) -> tuple[Part, ...]:
    """A message as parts, one for each robot: its number on the track of the robot, and the message without metadata.

    What is not of the documented form is left in, for `content` to find. A map without entries is no part at all, and
    null is the same as absent.
    """
    if not isinstance(message, dict):
        return (((), (), message),)
    if None in message.values():
        message = {name: value for name, value in message.items() if value is not None}
    for name in MAPS.values():
        entries = _field(message, name)
        if isinstance(entries, dict):
            return tuple(_entry(name, robot, entry) for robot, entry in entries.items())
    if not message:
        return ()
    marks, rest = _without_metadata(_field(message, "robotId"), message)
    return (((), marks, rest),)


def _entry(name: str, robot: str, entry: JSON) -> Part:
    if not isinstance(entry, dict):
        return (), (), {name: {robot: entry}}
    marks, rest = _without_metadata(robot, entry)
    return (), marks, {name: {robot: rest}}


def metadata_of(given: JSON) -> EventMetadata:
    """The metadata of a message. Raises MalformedError."""
    if not isinstance(given, dict):
        raise MalformedError("there is none" if given is None else f"{brief(given)} is not an object", "metadata")
    try:
        return read(EventMetadata, given)
    except MalformedError as error:
        raise error.inside("metadata") from None


def _without_metadata(robot: JSON, message: dict[str, JSON]) -> tuple[tuple[Mark, ...], JSON]:
    try:
        found = metadata_of(message.get("metadata"))
    except MalformedError:
        return (), message
    rest = {name: value for name, value in message.items() if name != "metadata"}
    rest[_STRIPPED] = True
    return ((robot, found.sequence_number),) if isinstance(robot, str) else (), rest


_STRIPPED = "(metadata)"
"""Marks a message whose metadata was there and has been taken out."""


def content(rest: JSON) -> Seen | Malformed:
    """What a stripped message shows."""
    try:
        return _content(rest)
    except MalformedError as error:
        return Malformed(str(error))


def _content(rest: JSON) -> Seen:
    if not isinstance(rest, dict):
        raise MalformedError(f"{brief(rest)} is not an object")
    for endpoint, name in MAPS.items():
        if name in rest:
            entries = rest[name]
            if not isinstance(entries, dict):
                raise MalformedError(f"{brief(entries)} is not an object", name)
            [(robot, entry)] = entries.items()
            try:
                if not isinstance(entry, dict):
                    raise MalformedError(f"{brief(entry)} is not an object")
                return Seen(robot, endpoint, _entry_value(endpoint, _checked(entry)))
            except MalformedError as error:
                raise error.inside(robot).inside(name) from None
    rest = _checked(rest)
    robot = _field(rest, "robotId")
    if robot is not None and not isinstance(robot, str):
        raise MalformedError(f"{brief(robot)} is not a text", "robotId")
    found = [endpoint for endpoint, name in SINGLES.items() if _field(rest, name) is not None]
    if len(found) > 1:
        raise MalformedError(f"{SINGLES[found[0]]} and {SINGLES[found[1]]} are fields of different messages")
    if not found:
        return Seen(robot or "", None)
    value, wrapped = single_value(found[0], _field(rest, SINGLES[found[0]]))
    return Seen(robot or "", found[0], value, wrapped)


def _checked(message: dict[str, JSON]) -> dict[str, JSON]:
    if _STRIPPED not in message:
        metadata_of(message.get("metadata"))
    return message


def single_value(endpoint: Endpoint, given: JSON) -> tuple[Value, bool | None]:
    """The state in a message about one robot. Raises MalformedError."""
    try:
        if endpoint is Endpoint.ROBOT:
            return read_state(given)
        if endpoint is Endpoint.BATTERY:
            return read(wire.BatteryState, given), None
        return canonical("navigation_state", read(wire.NavigationState, given)), None
    except MalformedError as error:
        raise error.inside(SINGLES[endpoint]) from None


def _entry_value(endpoint: Endpoint, entry: JSON) -> Value:
    """The state in an entry of a map, without its metadata."""
    rest = {name: value for name, value in entry.items() if name != "metadata"}
    return map_value(endpoint, rest)


def map_value(endpoint: Endpoint, entry: JSON) -> Value:
    """The state in an entry of a map that has no metadata any more. Raises MalformedError."""
    if endpoint is Endpoint.ERRORS:
        return canonical("error_codes", ErrorCodes(read(wire.ErrorCodesEntry, entry).codes))
    if endpoint is Endpoint.NETWORK:
        return read(wire.NetworkEntry, entry).connected_wifi
    return read(wire.OnlineEntry, entry).connection or wire.RobotConnection()


EPOCH = datetime(2025, 1, 1, tzinfo=UTC)
"""When the clock of the reference model starts."""


def write_message(view: View, _: tuple[Name, ...], choice: int, number: int, seconds: float) -> JSON:
    """The message that shows a view."""
    timestamp = (EPOCH + timedelta(seconds=seconds)).isoformat().replace("+00:00", "Z")
    return message_of(show(view, choice), {"timestamp": timestamp, "sequenceNumber": number})


def message_of(shown: Seen, metadata: JSON) -> JSON:
    """The message about one robot that shows something."""
    endpoint = shown.endpoint
    assert endpoint is not None, "what is shown is on a stream"  # noqa: S101 - only what was read may lack it
    if endpoint in SINGLES:
        payload = write_state(shown) if endpoint is Endpoint.ROBOT else write(shown.value)
        return {"metadata": metadata, "robotId": shown.robot, SINGLES[endpoint]: payload}
    entry: dict[str, JSON] = {"metadata": metadata}
    if endpoint is Endpoint.ERRORS:
        entry["codes"] = write(shown.value)["codes"]
    elif endpoint is Endpoint.ONLINE:
        entry["connection"] = write(shown.value)
    elif shown.value is not None:
        entry["connectedWifi"] = write(shown.value)
    return {MAPS[endpoint]: {shown.robot: entry}}


# Worlds and drives: written by testers and authors of logs, so what is wrong is refused.

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


def _refuse(says: str) -> UnreadableError:
    return UnreadableError(says)


def _text(given: Mapping[str, JSON], name: str, where: str) -> str:
    value = given.get(name)
    if not isinstance(value, str) or not value:
        raise _refuse(f"{where}.{name}: {brief(value)} is not a text")
    return value


def _objects(given: JSON, where: str) -> list[dict[str, JSON]]:
    found = [] if given is None else given
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise _refuse(f"{where}: {brief(given)} is not a list of objects")
    return found


def _owned(given: Mapping[str, JSON], where: str) -> bool:
    value = given.get("owned", True)
    if not isinstance(value, bool):
        raise _refuse(f"{where}.owned: {brief(value)} is not true or false")
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
        raise _refuse(f"{where}.locationId: {brief(location)} is not a text")
    try:
        known = read_state(state)[0]
        network = part_value(WIFI, wifi)
    except MalformedError as error:
        raise _refuse(f"{where}: {error}") from None
    known = evolve(known, battery=clamped(known.battery))
    if known.servi_state is not None and known.carti_state is not None:
        raise _refuse(f"{where}.state: servi_state and carti_state are both set")
    return Robot(robot_id, location, _owned(given, where), known, clamped(network))


def world(given: JSON) -> World:
    """The world of a `reset` or of a history's first line."""
    given = {} if given is None else given
    if not isinstance(given, dict):
        raise _refuse(f"world: {brief(given)} is not an object")
    unknown = [name for name in given if name not in ("robots", "locations")]
    if unknown:
        raise _refuse(f"world.{unknown[0]}: there is no such field; there are robots, locations")
    robots = tuple(
        _robot(one, f"world.robots[{index}]") for index, one in enumerate(_objects(given.get("robots"), "world.robots"))
    )
    locations = tuple(
        Location(_text(one, "locationId", f"world.locations[{index}]"), _owned(one, f"world.locations[{index}]"))
        for index, one in enumerate(_objects(given.get("locations"), "world.locations"))
    )
    for kind, ids in (("robot", [one.id for one in robots]), ("location", [one.id for one in locations])):
        if len(set(ids)) < len(ids):
            raise _refuse(f"world: a {kind} is listed twice")
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


def drive(given: JSON) -> tuple[Happening, tuple[Name, ...]]:
    """The event of a drive."""
    if not isinstance(given, dict) or not isinstance(given.get("event"), str):
        raise _refuse(f"drive: {brief(given)} names no event")
    event = given["event"]
    if event == "fault":
        if given.get("status") != INTERNAL:
            raise _refuse(f"drive.status: a fault has status INTERNAL, not {brief(given.get('status'))}")
        return Happening("fault", value=INTERNAL), ()
    if event not in ("report", "restart", "move"):
        raise _refuse(f"drive.event: {brief(event)} is not a drive of bear.status")
    robot = _text(given, "robotId", "drive")
    if event == "restart":
        return Happening("restart", robot), ()
    if event == "move":
        return Happening("move", robot, value=_text(given, "locationId", "drive")), ()
    named = given.get("part")
    part = _PARTS.get(named) if isinstance(named, str) else None
    if part is None:
        raise _refuse(f"drive.part: {brief(given.get('part'))} is not a part of a robot's state")
    try:
        value = part_value(part, given.get("value"))
    except MalformedError as error:
        raise _refuse(f"drive.value: {error}") from None
    return Happening("report", robot, part, value), ()


def write_drive(happening: Happening, _: tuple[Name, ...] = ()) -> JSON:
    """The JSON of a drive."""
    if happening.name == "fault":
        return {"event": "fault", "status": happening.value}
    if happening.name == "restart":
        return {"event": "restart", "robotId": happening.robot}
    if happening.name == "move":
        return {"event": "move", "robotId": happening.robot, "locationId": happening.value}
    value: Any = None if happening.value is None else write(happening.value)
    return {"event": "report", "robotId": happening.robot, "part": camel(happening.part), "value": value}


CODEC = Codec(
    methods=tuple(OPERATIONS),
    streams=STREAMS,
    world=world,
    split=split,
    request=request,
    answer=answer,
    strip=strip,
    content=content,
    drive=drive,
    write_request=write_request,
    write_answer=write_answer,
    write_message=write_message,
    write_world=write_world,
    write_drive=write_drive,
    carries=carries,
)
__all__ = ["CODEC"]
