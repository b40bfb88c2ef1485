"""The JSON of the Robot Status page: requests, answers, messages, worlds and drives, in and out."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import attrs

from missionfsm.bear.status import messages as wire
from missionfsm.bear.status.drive_codec import DRIVES, field, read_state, world, write_state, write_world
from missionfsm.bear.status.messages import ErrorCodes
from missionfsm.bear.status.rules import OPERATIONS
from missionfsm.bear.status.state import (
    GET,
    MAPS,
    SINGLES,
    Endpoint,
    Request,
    Value,
)
from missionfsm.bear.status.stream import rendered
from missionfsm.bear.status.views import Promised, Seen, View, canonical
from missionfsm.bear.wire.binary import carries
from missionfsm.bear.wire.messages import EventMetadata
from missionfsm.bear.wire.protojson import MalformedError, camel, read, unknown_fields, write
from missionfsm.kernel.codec import JSON, Codec, Malformed, Part, UnreadableError
from missionfsm.kernel.history import Answer, Mark, Name
from missionfsm.kernel.rules import OK
from missionfsm.kernel.text import brief

STREAMS = tuple(endpoint.value for endpoint in Endpoint)


# Requests.


def split_request(method: str, params: JSON) -> tuple[tuple[Name, ...], JSON]:
    """Requests have no names: what a tester calls robots and locations is content."""
    if method not in OPERATIONS:
        message = f"{brief(method)} is not a method of bear.status"
        raise UnreadableError(message)
    return (), params


def read_request(method: str, params: JSON) -> Request:
    """The request that a call makes."""
    params = {} if params is None else params
    try:
        if method == GET:
            unknown = ("request",) if unknown_fields(wire.StatusRequest, params) else ()
            return Request(method, (read(wire.StatusRequest, params).robot_id,), unknown_fields=unknown)
        params, bare = _unwrapped(params)
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
        bare=bare,
        unknown_fields=_levels(params),
    )


def _unwrapped(params: JSON) -> tuple[JSON, bool]:
    """The request with its robot ids where they should stand, and whether they stood as a bare list (AS-06.list)."""
    selector = field(params, "selector") if isinstance(params, dict) else None
    if not isinstance(selector, dict) or not isinstance(ids := field(selector, "robotIds"), list):
        return params, False
    rest = {name: value for name, value in selector.items() if name not in ("robotIds", "robot_ids")}
    return {**params, "selector": {**rest, "robotIds": {"ids": ids}}}, True


def _levels(params: JSON) -> tuple[str, ...]:
    """Where a well-formed subscription has fields that are not documented."""
    selector = field(params, "selector") or {}
    ids = field(selector, "robotIds") or {}
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
        ids = [*asked.ids, *(asked.ids[:1] if asked.repeated else ())]
        selector["robotIds"] = ids if asked.bare else {"ids": ids}
    if asked.location is not None:
        selector["locationId"] = asked.location
    return {"selector": selector} if selector else {}


# Answers.


def read_answer(method: str, result: JSON) -> tuple[Answer, tuple[Name, ...]]:
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
        state, wrapped = read_state(field(result, "robotState"))
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


# Messages.


def split_message(message: JSON) -> tuple[Part, ...]:
    """A message as parts, one for each robot: its number on the track of the robot, and the message without metadata.

    What is not of the documented form is left in, for `read_content` to find. A map without entries is no part at all,
    and null is the same as absent.
    """
    if not isinstance(message, dict):
        return (((), (), message),)
    if None in message.values():
        message = {name: value for name, value in message.items() if value is not None}
    for name in MAPS.values():
        entries = field(message, name)
        if isinstance(entries, dict):
            return tuple(_entry(name, robot, entry) for robot, entry in entries.items())
    if not message:
        return ()
    marks, rest = _without_metadata(field(message, "robotId"), message)
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
    rest[_STRIPPED] = found.timestamp is not None
    return ((robot, found.sequence_number),) if isinstance(robot, str) else (), rest


_STRIPPED = "(metadata)"
"""Marks a message whose metadata was there and has been taken out: whether they had a timestamp."""


def read_content(rest: JSON) -> Seen | Malformed:
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
                return Seen(robot, endpoint, _entry_value(endpoint, _checked(entry)), timed=_is_timed(entry))
            except MalformedError as error:
                raise error.inside(robot).inside(name) from None
    rest = _checked(rest)
    robot = field(rest, "robotId")
    if robot is not None and not isinstance(robot, str):
        raise MalformedError(f"{brief(robot)} is not a text", "robotId")
    found = [endpoint for endpoint, name in SINGLES.items() if field(rest, name) is not None]
    if len(found) > 1:
        raise MalformedError(f"{SINGLES[found[0]]} and {SINGLES[found[1]]} are fields of different messages")
    if not found:
        return Seen(robot or "", None, timed=_is_timed(rest))
    value, wrapped = single_value(found[0], field(rest, SINGLES[found[0]]))
    return Seen(robot or "", found[0], value, wrapped, _is_timed(rest))


def _is_timed(stripped: dict[str, JSON]) -> bool:
    return stripped.get(_STRIPPED) is not False


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
    return message_of(rendered(view, choice), {"timestamp": timestamp, "sequenceNumber": number})


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


CODEC = Codec(
    methods=tuple(OPERATIONS),
    streams=STREAMS,
    read_world=world,
    split_request=split_request,
    read_request=read_request,
    read_answer=read_answer,
    split_message=split_message,
    read_content=read_content,
    drives=DRIVES,
    write_request=write_request,
    write_answer=write_answer,
    write_message=write_message,
    write_world=write_world,
    carries=carries,
)
__all__ = ["CODEC"]
