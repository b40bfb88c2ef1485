"""The lines that travel between server and robot."""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import dataclass
from typing import Any

from config_text import config_text
from mission import Mission
from variants import Variant

MISSION_TYPE = 9410896613310777529
"""Type id of a MissionProto."""

STATUS_TYPE = 10387078701227607428
"""Type id of a MissionStatusProto."""

TEXT_TYPE = 10961607615765939303
"""Type id of a TextProto."""

_EPOCH = 1_600_000_000 * 10**9
_HALF = 2**64
_DIGITS = re.compile(r"-?[0-9]{1,20}\Z")


@dataclass(frozen=True)
class Received:
    """A readable line: its channel, the type id of its payload where it carries one, and its payload."""

    channel: str
    type_id: int | None
    payload: dict[str, Any]

    def may_be(self, type_id: int, variant: Variant) -> bool:
        """Whether the type id lets the payload be of that type."""
        if variant("type-id-ignored"):
            return True
        if self.type_id is None:
            return not variant("type-id-required")
        return self.type_id % _HALF == type_id


def new_uuid(seed: str) -> int:
    """A 128-bit value that depends on the seed alone."""
    return int.from_bytes(hashlib.sha256(seed.encode("utf-8", "surrogatepass")).digest()[:16], "big")


def _integer(value: Any) -> int | None:
    if isinstance(value, str) and _DIGITS.match(value):
        return int(value)
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    return None


def read_line(line: str) -> Received | None:
    """The message that a line holds, or None where it is not readable as one."""
    try:
        message = json.loads(line)
    except (ValueError, RecursionError):
        return None
    if not isinstance(message, dict):
        return None
    header, payload = message.get("header"), message.get("payload")
    if not isinstance(header, dict) or not isinstance(payload, dict):
        return None
    channel = header.get("channel")
    if not isinstance(channel, str):
        return None
    type_id = header.get("proto")
    if type_id is None:
        return Received(channel, None, payload)
    number = _integer(type_id)
    return Received(channel, -1 if number is None else number, payload)


def read_uuid(value: Any, variant: Variant) -> int | None:
    """The 128-bit value of a uuid object, or None where it is none."""
    if not isinstance(value, dict):
        return None
    halves: list[int] = []
    for name in ("upper", "lower"):
        given = value.get(name)
        if variant("strings-only") and not isinstance(given, str):
            return None
        half = _integer(given)
        if half is not None and variant("signed-halves") and -(2**63) <= half < 0:
            half += _HALF
        if half is None or not 0 <= half < _HALF:
            return None
        halves.append(half)
    return halves[0] * _HALF + halves[1]


def _uuid_object(uuid: int) -> dict[str, Any]:
    return {"lower": str(uuid % _HALF), "upper": str(uuid // _HALF)}


def _mission_uuid_object(uuid: int, variant: Variant) -> dict[str, Any]:
    lower, upper = uuid % _HALF, uuid // _HALF
    if variant("halves-swapped"):
        lower, upper = upper, lower
    if variant("uuid-rounded"):
        lower, upper = int(float(lower)) % _HALF, int(float(upper)) % _HALF
    if variant("uuid-as-numbers"):
        return {"lower": lower, "upper": upper}
    return {"lower": str(lower), "upper": str(upper)}


def _header(channel: str, type_id: int, uuid: int, now: int, variant: Variant) -> dict[str, Any]:
    time = now if variant("clock-from-zero") else _EPOCH + now
    header: dict[str, Any] = {
        "channel": channel,
        "pubtime": time if variant("time-as-number") else str(time),
        "acqtime": str(time),
        "proto": str(type_id - _HALF),
        "uuid": _uuid_object(uuid),
    }
    if variant("no-acqtime"):
        del header["acqtime"]
    return header


def _lines(header: dict[str, Any], payload: dict[str, Any], variant: Variant) -> list[str]:
    if variant("header-left-out"):
        return [json.dumps(payload)]
    message = {"header": header, "payload": payload}
    if variant("line-broken-up"):
        return json.dumps(message, indent=1).split("\n")
    if variant("line-loose"):
        return [json.dumps({"payload": payload, "header": header})]
    line = json.dumps(message, separators=(",", ":"), ensure_ascii=not variant("raw-letters"))
    return [line[:1024] if variant("line-cut") else line]


def mission_lines(mission: Mission, message_number: int, now: int, variant: Variant) -> list[str]:
    """The line that carries a mission to its robot."""
    channel = mission.channel
    if variant("channel-fixed"):
        channel = "mission"
    if variant("channels-swapped"):
        channel = mission.status_channel
    uuid = mission.uuid if variant("message-uuid-is-mission") else new_uuid(f"message {message_number}")
    payload = {
        "uuid": _mission_uuid_object(mission.uuid, variant),
        "config": {"serialized": config_text(mission, variant)},
    }
    return _lines(_header(channel, MISSION_TYPE, uuid, now, variant), payload, variant)


def text_lines(channel: str, text: str, message_number: int, now: int, variant: Variant) -> list[str]:
    """The line that carries a text."""
    header = _header(channel, TEXT_TYPE, new_uuid(f"message {message_number}"), now, variant)
    return _lines(header, {"text": text}, variant)
