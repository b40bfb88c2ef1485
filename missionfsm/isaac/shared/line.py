"""A line that an implementation sent, as the oracle sees it: its names apart, the rest small and free of times.

Shared by the two systems of ``MissionSubmission › JsonTcpClient Codelet``. Reading is lenient where the readings leave
a form open (AI-27, AI-28) and notes which form it was; what no reading allows is kept as what is wrong. Pure.
"""

from __future__ import annotations

import json
import re
from typing import Any

from attrs import astuple, frozen

from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.framing import WireError, decode_line
from missionfsm.isaac.wire.messages import Message, MissionProto, MissionStatusProto, TextProto, Uuid
from missionfsm.kernel.codec import JSON, Malformed, Part
from missionfsm.kernel.history import Name
from missionfsm.kernel.rules import Document

MISSION_SUBMISSION = Document("MissionSubmission", "Mission Submission (Isaac SDK)")

MICROSECONDS = 1_000_000
"""The models count time in whole microseconds: sums of them meet a deadline exactly."""

_HEADER_INTEGERS = ("pubtime", "acqtime", "proto")

_LINE = frozenset({"header", "payload"})
_HEADER = frozenset({"channel", "uuid", *_HEADER_INTEGERS})
_PAYLOAD = frozenset({"uuid", "config", "missionStatus", "text"})
_HALVES = frozenset({"lower", "upper"})
"""The members of a message that are documented."""

_USUAL_NUMBER = re.compile("0|-?[1-9][0-9]*")


@frozen(cache_hash=True)
class LineContent:
    """One message, without its mission's identifier and its times.

    Attributes:
        kind: ``mission``, ``status``, ``text``, or ``other`` for what is no part of missions.
        channel: the header's.
        what: the configuration as canonical JSON, the status in lower case, the text, or the type id.
        form: how it was written: ``object`` or ``text`` (a configuration), ``upper``, ``lower`` or ``number`` (status).
        named: whether it carries a mission's identifier.
        header_named: whether the header carries an identifier that counts (only where the caller asked for it).
        bare: paths of 64-bit integers that came as numbers.
        stamped: whether the header has a uuid.
        borrowed: whether that is the mission's.
        unsigned: whether the type id is an unsigned one that has to be sent as its signed value.
    """

    kind: str
    channel: str
    what: str
    form: str = ""
    named: bool = False
    header_named: bool = False
    bare: tuple[str, ...] = ()
    stamped: bool = False
    borrowed: bool = False
    unsigned: bool = False


class Halves(int):
    """The number of an identifier, which is told as the wire writes it."""

    __slots__ = ()

    def __str__(self) -> str:
        uuid = Uuid.of(int(self))
        return f"(lower {uuid.lower}, upper {uuid.upper})"


def uuid_name(uuid: Uuid) -> Name:
    """The name under which the oracle knows a mission by its identifier."""
    return ("uuid", Halves(uuid.value))


def uuid_json(name: Any) -> JSON:  # noqa: ANN401 - a name of this system, a pair
    """An identifier's name as the wire has it: two decimal strings."""
    uuid = Uuid.of(name[1])
    return {"lower": str(uuid.lower), "upper": str(uuid.upper)}


def new_uuid(serial: int) -> Name:
    """An identifier whose halves differ and are too large for a double; another one for every serial number."""
    lower = (serial * 0x9E3779B97F4A7C15 + 0x7F4A7C15F39CC061) % (1 << 64) | 1
    upper = (serial * 0xC2B2AE3D27D4EB4F + 0x165667B19E3779F9) % (1 << 64) | 1 << 62 | 1
    return ("uuid", Halves(upper << 64 | lower))


def canonical(text: str) -> str | None:
    """A JSON object's text in one form for all texts that mean the same; None for what is no JSON object.

    Keys are sorted; a number is what it is worth, so 1 and 1.0 are one.
    """
    value = strictjson.parse(text)
    if not isinstance(value, dict):
        return None
    return json.dumps(_plain(value), sort_keys=True, separators=(",", ":"))


def _plain(value: JSON) -> JSON:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and value.is_integer():
        return int(value)
    return value


def see(line: object, *, header: bool = False) -> tuple[tuple[Name, ...], LineContent | Malformed]:
    """The names in a line (the payload's identifier, then if `header` is asked for the header's), and the rest."""
    if not isinstance(line, str):
        return (), Malformed(f"a line is text, not {strictjson.brief_json(line)}")
    if "\n" in line.removesuffix("\n"):
        return (), Malformed("the line holds newlines, which separate messages")
    found = decode_line(line.removesuffix("\n").removesuffix("\r").encode(errors="surrogatepass"))
    if not found:
        return (), Malformed("the line is empty")
    first = found[0]
    if isinstance(first, WireError):
        return (), Malformed(f"{first.path}: {first.problem}" if first.path else first.problem)
    raw = json.loads(line)
    return _named(first, raw, header=header)


def see_other(line: object) -> tuple[tuple[Name, ...], LineContent] | None:
    """The same of a message whose type is none of those that missions travel in; None where it is one, or is wrong.

    AI-27: only the channel has to be in a header, so the type may be left out where the payload does not tell it.
    """
    if not isinstance(line, str) or "\n" in line:
        return None
    found = decode_line(line.removesuffix("\r").encode(errors="surrogatepass"))
    if len(found) != 1 or not isinstance(found[0], WireError) or found[0].kind != "type":
        return None
    header = json.loads(line)["header"]
    proto = header.get("proto")
    if proto is not None and not isinstance(proto, int) and not str(proto).lstrip("-").isdecimal():
        return None
    stamped = bool(stamp(line))
    return (), LineContent(
        "other",
        header["channel"],
        "" if proto is None else str(proto),
        bare=_bare(json.loads(line)),
        stamped=stamped,
        unsigned=is_unsigned(proto),
    )


def stamp(line: object) -> int | None:
    """The uuid in the header of a line, as a number; None where there is none that could be one."""
    try:
        raw = json.loads(line)["header"]["uuid"]  # type: ignore[arg-type]
        return Uuid(int(raw["lower"]), int(raw["upper"])).value or None
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
        return None


def _named(message: Message, raw: JSON, *, header: bool) -> tuple[tuple[Name, ...], LineContent | Malformed]:
    payload, stamped = message.payload, message.header.uuid
    own = stamped is not None and bool(stamped.value)
    borrowed = own and not isinstance(payload, TextProto) and stamped == payload.uuid
    marks = (_bare(raw), own, borrowed, is_unsigned(raw["header"].get("proto")))
    if isinstance(payload, TextProto):
        return (), LineContent("text", message.header.channel, payload.text, "", False, False, *marks)  # noqa: FBT003 - no names
    names: list[Name] = []
    if payload.uuid is not None and payload.uuid.value:
        names.append(uuid_name(payload.uuid))
    named = bool(names)
    if header and stamped is not None:
        names.append(uuid_name(stamped))
    said = _mission(payload, raw) if isinstance(payload, MissionProto) else _status(payload, raw)
    if isinstance(said, Malformed):
        return tuple(names), said
    kind, what, form = said
    header_named = header and stamped is not None
    return tuple(names), LineContent(kind, message.header.channel, what, form, named, header_named, *marks)


def _mission(payload: MissionProto, raw: JSON) -> tuple[str, str, str] | Malformed:
    """What kind of line a mission is, its configuration, and the form in which that is written."""
    config = raw["payload"].get("config")
    if config is None:
        return Malformed("payload.config is missing: a MissionProto carries its configuration")
    what = canonical(payload.config)
    if what is None:
        return Malformed("the configuration is no JSON object")
    text = config.get("serialized") if isinstance(config, dict) else config
    return "mission", what, "text" if isinstance(text, str) else "object"


def _status(payload: MissionStatusProto, raw: JSON) -> tuple[str, str, str] | Malformed:
    """What kind of line a status is, the status, and the form in which that is written."""
    written = raw["payload"].get("missionStatus")
    form = "number" if isinstance(written, int) else "lower" if written == written.lower() else "upper"
    if form == "upper" and written != written.upper():
        return Malformed(f"payload.missionStatus is written {strictjson.brief_json(written)}")
    return "status", payload.mission_status.value, form


def is_unsigned(proto: JSON) -> bool:
    """Whether a type id is too large to be a signed one."""
    return str(proto).isdecimal() and int(proto) >= 1 << 63


def is_untyped(raw: JSON) -> bool:
    """Whether the header of a line has no type id, or one that is too large to be a signed one."""
    proto = raw["header"].get("proto")
    return proto is None or is_unsigned(proto)


def is_garbled(raw: JSON) -> bool:
    """Whether a message that can be read has a field that nobody knows, or a number in no usual form."""
    header, payload = raw["header"], raw["payload"]
    config = payload.get("config")
    members = ((raw, _LINE), (header, _HEADER), (payload, _PAYLOAD))
    if any(not member.keys() <= known for member, known in members):
        return True
    if isinstance(config, dict) and "serialized" in config and len(config) > 1:
        return True
    uuids = [one for one in (header.get("uuid"), payload.get("uuid")) if isinstance(one, dict)]
    if any(not uuid.keys() <= _HALVES for uuid in uuids):
        return True
    numbers = [header.get(key) for key in _HEADER_INTEGERS] + [half for uuid in uuids for half in uuid.values()]
    return any(isinstance(one, str) and not _USUAL_NUMBER.fullmatch(one) for one in numbers)


def _bare(raw: JSON) -> tuple[str, ...]:
    """Where a 64-bit integer came as a number."""
    found = [f"header.{key}" for key in _HEADER_INTEGERS if isinstance(raw["header"].get(key), int)]
    for place in ("header", "payload"):
        uuid = raw[place].get("uuid")
        if isinstance(uuid, dict) and any(isinstance(uuid.get(half), int) for half in ("lower", "upper")):
            found.append(f"{place}.uuid")
    return tuple(found)


def to_json(said: LineContent | Malformed) -> JSON:
    """What is left of a line once its names are apart, as JSON; `from_json` undoes it."""
    if isinstance(said, Malformed):
        return {"garbled": said.says}
    return [*astuple(said)]


def from_json(rest: JSON) -> LineContent | Malformed:
    """What `to_json` was made of."""
    if isinstance(rest, dict):
        return Malformed(rest["garbled"])
    kind, channel, what, form, named, header_named, bare, *marks = rest
    return LineContent(kind, channel, what, form, named, header_named, tuple(bare), *marks)


def part_of(line: JSON, names: tuple[Name, ...], said: LineContent | Malformed) -> Part:
    """A line that `see` has read as the one part of a message, with the uuid of its header as a mark."""
    own = stamp(line)
    return names, () if own is None else (("uuid", own),), to_json(said)
