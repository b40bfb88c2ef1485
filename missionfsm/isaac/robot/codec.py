"""The JSON of ``isaac.robot``: lines in both directions and the drives of the adapter protocol."""

from __future__ import annotations

import json

from missionfsm.isaac.robot.readings import AI_10, AI_25_HEADER, AI_28_STATUS
from missionfsm.isaac.robot.spec import (
    NULL,
    SPEC,
    STATUS_CHANNEL,
    UNUSABLE,
    USABLE,
    Arrives,
    Passes,
    Report,
    Stops,
)
from missionfsm.isaac.shared.drives import seconds, text_line
from missionfsm.isaac.shared.line import MICROSECONDS, Said, from_json, new_uuid, see, to_json, uuid_name
from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.framing import decode_line, encode
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.kernel.codec import JSON, Codec, Part, UnreadableError
from missionfsm.kernel.history import Answer, Name
from missionfsm.kernel.readings import meet
from missionfsm.kernel.text import brief

NAME_CHANNEL = "name"
MISSION_CHANNEL = "mission"


def _refuse(says: str) -> UnreadableError:
    return UnreadableError(says)


def world(given: JSON) -> tuple[()]:
    """The world, which has no parameters."""
    if given not in ({}, None):
        raise _refuse(f"world: isaac.robot has no parameters, not {brief(given)}")
    return ()


def _arrives(line: str) -> tuple[Arrives, tuple[Name, ...]]:
    found = decode_line(line.encode(errors="surrogatepass")) if line.strip() else []
    message = found[0] if found else None
    if not isinstance(message, Message) or message.header.channel != MISSION_CHANNEL:
        return Arrives(), ()
    if not isinstance(message.payload, MissionProto):
        return Arrives(foreign=True), ()
    strict = decode_line(line.encode(errors="surrogatepass"), numbers=False)
    numeric = not (strict and isinstance(strict[0], Message))
    uuid = message.payload.uuid
    names = () if uuid is None or uuid.value == 0 else (uuid_name(uuid),)
    return Arrives(_usable(message.payload.config), bool(names), numeric), names


def _usable(config: str) -> str:
    value = strictjson.parse(config)
    if value is None:
        return NULL
    sound = isinstance(value, dict) and next(strictjson.faults(value), None) is None
    return USABLE if sound else UNUSABLE


def drive(given: JSON) -> tuple[Arrives | Stops | Passes, tuple[Name, ...]]:
    """The event of a drive and the mission that it names."""
    event = given.get("event") if isinstance(given, dict) else None
    if event == "line":
        return _arrives(text_line(given))
    if event in ("behaviorSucceeded", "behaviorFailed"):
        return Stops(event), ()
    if event == "advance":
        return Passes(seconds(given.get("seconds"))), ()
    raise _refuse(f"drive.event: {brief(event)} is not a drive of isaac.robot")


def write_drive(event: Arrives | Stops | Passes, names: tuple[Name, ...]) -> JSON:
    """The JSON of an event."""
    if isinstance(event, Passes):
        return {"event": "advance", "seconds": event.time / MICROSECONDS}
    if isinstance(event, Stops):
        return {"event": event.name}
    if event.foreign:
        return {"event": "line", "line": encode(Message(Header(MISSION_CHANNEL), TextProto(""))).decode().rstrip()}
    if event.mission is None:
        return {"event": "line", "line": "{}"}
    config = {USABLE: "{}", NULL: "null", UNUSABLE: "no json"}[event.mission]
    uuid = Uuid.of(names[0][1]) if names else None  # type: ignore[index]
    message = Message(Header(MISSION_CHANNEL), MissionProto(uuid, config))
    return {"event": "line", "line": encode(message).decode().removesuffix("\n")}


def strip(line: JSON) -> tuple[Part, ...]:
    """The identifier in a line and what is left of it; nothing where the robot says its name (AI-37 is waived)."""
    names, said = see(line)
    if isinstance(said, Said) and said.kind == "text" and said.channel == NAME_CHANNEL and not said.bare:
        return ()
    return ((names, (), to_json(said)),)


def write_message(view: Report, names: tuple[Name, ...], choice: int, number: int, at: float) -> JSON:
    """The line that shows a report."""
    time = round(at * 1e9)
    named = names and meet(choice, (AI_10["b"],))
    uuid = Uuid.of(names[0][1]) if named else None  # type: ignore[index]
    header = Header(STATUS_CHANNEL, time, time, Uuid.of(new_uuid(number)[1]))  # type: ignore[index]
    bare = bool(meet(choice, (AI_25_HEADER["n"],)))
    line = encode(Message(header, MissionStatusProto(uuid, WireStatus(view.status))), header_uuid_as_numbers=bare)
    message = json.loads(line)
    if meet(choice, (AI_28_STATUS["c"],)):
        message["payload"]["missionStatus"] = view.status.upper()
    elif meet(choice, (AI_28_STATUS["e"],)):
        message["payload"]["missionStatus"] = [one.value for one in WireStatus].index(view.status)
    return strictjson.compact(message)


def _no_calls(method: str, *_: object) -> UnreadableError:
    return _refuse(f"{brief(method)} is not a method of isaac.robot, which has none")


def _split(method: str, _: JSON) -> tuple[tuple[Name, ...], JSON]:
    raise _no_calls(method)


def _answer(method: str, _: JSON) -> tuple[Answer, tuple[Name, ...]]:
    raise _no_calls(method)


CODEC = Codec(
    methods=tuple(SPEC.operations),
    streams=(),
    world=world,
    split=_split,
    request=_split,
    answer=_answer,
    strip=strip,
    content=from_json,
    drive=drive,
    write_request=lambda *_: {},
    write_answer=lambda *_: {},
    write_message=write_message,
    write_world=lambda _: {},
    write_drive=write_drive,
)
