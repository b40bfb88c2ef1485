"""The messages as JSON lines: what is read from a line and how one is written."""

from __future__ import annotations

import json
import random
import uuid as uuids
from dataclasses import dataclass
from typing import Any

from variants import Options

Json = dict[str, Any]

MISSION_PROTO = 9410896613310777529
STATUS_PROTO = 10387078701227607428
TEXT_PROTO = 10961607615765939303
_WORD = 2**64


@dataclass(frozen=True)
class Uuid:
    """A UUID in two halves of 64 bits."""

    upper: int
    lower: int

    def as_json(self) -> Json:
        """The halves as decimal texts."""
        return {"lower": str(self.lower), "upper": str(self.upper)}


@dataclass(frozen=True)
class Incoming:
    """A message that came from the server."""

    channel: str
    proto: int | None
    payload: Json


def parse_line(line: str) -> Incoming | None:
    """The message in a line, None where it is none."""
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
    proto = parse_integer(header.get("proto"), texts_only=False)
    return Incoming(channel, None if proto is None else proto % _WORD, payload)


def parse_integer(value: Any, texts_only: bool) -> int | None:
    """An integer of 64 bits from a decimal text or, unless `texts_only`, a JSON number."""
    if isinstance(value, bool):
        return None
    if isinstance(value, int) and not texts_only:
        return value
    if isinstance(value, str) and len(value) <= 20 and value.lstrip("-").isdecimal():
        try:
            return int(value)
        except ValueError:
            return None
    return None


def parse_uuid(value: Any, texts_only: bool) -> Uuid | None:
    """The UUID in a payload; a half that is left out is 0; None where it is malformed."""
    if not isinstance(value, dict):
        return None
    halves = []
    for name in ("upper", "lower"):
        half = 0 if value.get(name) is None else parse_integer(value[name], texts_only)
        if half is None or not 0 <= half < _WORD:
            return None
        halves.append(half)
    return Uuid(halves[0], halves[1])


class Composer:
    """Writes the lines that the robot sends."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._random = random.Random(20180701)
        self._last: Uuid | None = None

    def line(self, channel: str, proto: int, payload: Json, now: int) -> str:
        """One message as a line, without its LF."""
        on = self._options.on
        if proto == STATUS_PROTO and on("status-with-text-type"):
            proto = TEXT_PROTO
        header: Json = {
            "channel": channel,
            "pubtime": str(now),
            "acqtime": str(now),
            "proto": str(proto - _WORD),
            "uuid": self._uuid().as_json(),
        }
        self._header_variants(header)
        if on("no-header"):
            return self._dump({"payload": payload})
        if on("header-without-channel"):
            header.pop("channel")
        if on("payload-not-wrapped"):
            return self._dump({"header": header} | payload)
        if on("payload-first"):
            return self._dump({"payload": payload, "header": header})
        return self._dump({"header": header, "payload": payload})

    def _header_variants(self, header: Json) -> None:
        on = self._options.on
        if on("header-uuid-as-numbers"):
            header["uuid"] = {half: int(value) for half, value in header["uuid"].items()}
        if on("pubtime-as-number"):
            header["pubtime"] = int(header["pubtime"])
        if on("proto-as-number"):
            header["proto"] = int(header["proto"])
        if on("acqtime-left-out"):
            header.pop("acqtime")
        if on("acqtime-zero"):
            header["acqtime"] = "0"
        if on("proto-left-out"):
            header.pop("proto")
        if on("header-has-more"):
            header["sender"] = "robot"

    def _uuid(self) -> Uuid:
        value = uuids.uuid4().int if self._options.on("uuid-from-system") else self._random.getrandbits(128)
        if self._options.on("header-uuid-repeated") and self._last is not None:
            return self._last
        self._last = Uuid(value // _WORD, value % _WORD)
        return self._last

    def _dump(self, message: Json) -> str:
        on = self._options.on
        if on("spaced-json"):
            return json.dumps(message, separators=(" , ", " : ")) + " "
        return json.dumps(message, separators=(",", ":"), ensure_ascii=not on("unescaped-text"))


def uuid_payload(options: Options, uuid: Uuid) -> Json:
    """The mission's UUID as it stands in a status."""
    halves: Json = uuid.as_json()
    if options.on("uuid-halves-swapped"):
        halves = {"lower": halves["upper"], "upper": halves["lower"]}
    if options.on("uuid-as-numbers"):
        halves = {"lower": uuid.lower, "upper": uuid.upper}
    if options.on("uuid-through-floats"):
        halves = {"lower": str(int(float(uuid.lower))), "upper": str(int(float(uuid.upper)))}
    if options.on("uuid-signed"):
        halves = {
            name: str(int(half) - _WORD if int(half) >= _WORD // 2 else int(half)) for name, half in halves.items()
        }
    if options.on("uuid-upper-lost"):
        halves["upper"] = "0"
    return halves
