"""The JSON of ``isaac.robot``: its world, lines in both directions and the drives of the adapter protocol."""

from __future__ import annotations

import json

from missionfsm.isaac.robot.inputs import BLANK, NULL, ODD, SHALLOW, UNUSABLE, USABLE, Arrives
from missionfsm.isaac.robot.readings import AI_10, AI_25_HEADER, AI_27_UUID, AI_28_STATUS
from missionfsm.isaac.robot.state import Introduction, Other, Report, World
from missionfsm.isaac.shared.drives import ADVANCE, text_line
from missionfsm.isaac.shared.line import from_json, is_garbled, is_untyped, new_uuid, part_of, see, see_other, uuid_name
from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.framing import as_json, as_line, decode_line
from missionfsm.isaac.wire.messages import (
    TYPE_IDS,
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    Payload,
    TextProto,
    Uuid,
    WireStatus,
    signed,
    unsigned,
)
from missionfsm.kernel.language import JSON, Codec, DriveForm, Name, WorldForm, meet
from missionfsm.kernel.shapes import TEXT

ANY_NAME = "robot"
"""What a robot is called of which the world says that its name is any."""

WORLD = WorldForm(World)

# Drives.


def _arrives(given: JSON) -> tuple[Arrives, tuple[Name, ...]]:
    """A line that arrives, and the mission that it names."""
    line = text_line(given)
    found = decode_line(line.encode(errors="surrogatepass")) if line.strip() else []
    message = found[0] if found else None
    if not isinstance(message, Message):
        return _garbled(line)
    channel = message.header.channel
    if not isinstance(message.payload, MissionProto):
        return Arrives(foreign=True, channel=channel), ()
    strict = decode_line(line.encode(errors="surrogatepass"), numbers=False)
    numeric = not (strict and isinstance(strict[0], Message))
    uuid = message.payload.uuid
    names = () if uuid is None or uuid.value == 0 else (uuid_name(uuid),)
    raw = json.loads(line)
    given = raw["payload"].get("config")
    kind = _configuration(raw, message.payload)
    arrives = Arrives(
        kind,
        bool(names),
        numeric,
        channel=channel,
        untyped=is_untyped(raw),
        garbled=is_garbled(raw) or _is_missing(given),
        misplaced=given is not None and not (isinstance(given, dict) and _is_text(given.get("serialized", ""), given)),
        nodes=kind == USABLE and not _is_missing(given) and bool(strictjson.parse(message.payload.config)),
    )
    return arrives, names


def _garbled(line: str) -> tuple[Arrives, tuple[Name, ...]]:
    """A line that cannot be read, which may still be taken for a mission, or is none."""
    raw = strictjson.parse(line)
    if not isinstance(raw, dict):
        return Arrives(), ()
    header, payload = raw.get("header"), raw.get("payload")
    if not (isinstance(header, dict) and isinstance(payload, dict) and isinstance(header.get("channel"), str)):
        return Arrives(), ()
    proto = str(header.get("proto"))
    untyped = header.get("proto") is None and not {"text", "missionStatus"} & payload.keys()
    if not untyped and proto not in _MISSION_TYPES and "config" not in payload:
        return Arrives(), ()
    return Arrives(USABLE, channel=header["channel"], garbled=True, foreign=proto in _OTHER_TYPES), ()


def _written(*kinds: type[Payload]) -> tuple[str, ...]:
    """The type ids of these, in every form."""
    return tuple(str(turned(TYPE_IDS[kind])) for kind in kinds for turned in (signed, unsigned))


_MISSION_TYPES, _OTHER_TYPES = _written(MissionProto), _written(MissionStatusProto, TextProto)


def _is_text(serialized: JSON, config: JSON) -> bool:
    """Whether a configuration is in a text, or there is none."""
    return isinstance(serialized, str | None) and ("serialized" in config or not config)


def _is_missing(config: JSON) -> bool:
    """Whether a mission has no configuration, which every mission needs."""
    return config is None or config == {} or (isinstance(config, dict) and config.get("serialized", 0) is None)


def _configuration(raw: JSON, mission: MissionProto) -> str:
    """Of which kind a configuration is."""
    if _is_missing(raw["payload"].get("config")):
        return USABLE
    if not mission.config:
        return BLANK
    value = strictjson.parse(mission.config)
    if value is None:
        return NULL
    if isinstance(value, strictjson.JsonFault):
        return UNUSABLE
    if not isinstance(value, dict) or next(strictjson.faults(value), None) is not None:
        return ODD
    return USABLE if all(_is_node(node) for node in value.values()) else SHALLOW


def _is_node(value: JSON) -> bool:
    """Whether a value holds components, each an object."""
    return isinstance(value, dict) and all(isinstance(component, dict) for component in value.values())


_CONFIGURATIONS = {USABLE: "{}", NULL: "null", BLANK: "", SHALLOW: '{"node":1}', ODD: "1", UNUSABLE: "no json"}


def _essence(event: Arrives, names: tuple[Name, ...]) -> dict[str, JSON]:
    """Of a line that arrives the essence."""
    if event.foreign:
        return {"line": as_line(Message(Header(event.channel), TextProto("")))}
    if event.mission is None:
        return {"line": "{}"}
    uuid = Uuid.of(names[0][1]) if names else None  # type: ignore[index]
    config = '{"node":{"component":{}}}' if event.nodes else _CONFIGURATIONS[event.mission]
    return {"line": as_line(Message(Header(event.channel), MissionProto(uuid, config)))}


# Lines that the robot sends.


def write_message(
    view: Report | Introduction | Other, names: tuple[Name, ...], choice: int, number: int, at: float
) -> JSON:
    """The line that shows a report, or the name; or something else."""
    time = round(at * 1e9)
    if isinstance(view, Other):
        return as_line(Message(Header(view.another, time, time), TextProto("ready")))
    statuses = [one.value for one in WireStatus]
    # An event may cause several messages, each with an identifier of its own: those differ in what they say or of what.
    says = 0 if isinstance(view, Introduction) else 1 + statuses.index(view.status)
    about = names[0][1] << 40 if names else 0  # type: ignore[index]
    own = Uuid.of(new_uuid(4 * number + says + about)[1])  # type: ignore[index]
    uuid = Uuid.of(names[0][1]) if names and meet(choice, (AI_10["b"],)) else None  # type: ignore[index]
    header = Header(view.channel, time, time, uuid if uuid and meet(choice, (AI_27_UUID["b"],)) else own)
    bare = bool(meet(choice, (AI_25_HEADER["n"],)))
    if isinstance(view, Introduction):
        return as_line(Message(header, TextProto(view.name or ANY_NAME)), header_uuid_as_numbers=bare)
    reported = Message(header, MissionStatusProto(uuid, WireStatus(view.status)))
    message = as_json(reported, header_uuid_as_numbers=bare)
    if meet(choice, (AI_28_STATUS["c"],)):
        message["payload"]["missionStatus"] = view.status.upper()
    elif meet(choice, (AI_28_STATUS["e"],)):
        message["payload"]["missionStatus"] = statuses.index(view.status)
    return strictjson.compact(message)


CODEC = Codec(
    measured=("seconds",),
    read_world=WORLD.read,
    write_world=WORLD.write,
    drives={"line": DriveForm(_arrives, _essence, {"line": TEXT}, ("line",)), "advance": ADVANCE},
    split_message=lambda line: (part_of(line, *(see_other(line) or see(line))),),
    read_content=from_json,
    write_message=write_message,
)
