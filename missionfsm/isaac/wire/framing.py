r"""Bytes in, messages out, and back: one JSON object a line. MissionSubmission › JsonTcpClient Codelet.

Lenient in what it takes, strict in what it sends. Taken: LF or CRLF at any fragmentation, blank lines, 64-bit integers
as strings or numbers (AI-25), status names in any case or by number, a configuration as object or as text (AI-28),
missing header fields other than the channel (AI-27), unknown fields. Sent: LF, ASCII, every 64-bit integer a string.

What is bad is a :class:`WireError`, never an exception, and never stops the lines after it. Nothing here reads a clock
or draws a number: pure.
"""

import re
from typing import Any, Final, Literal

import attrs

from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.messages import (
    DATA_BUFFER_TYPES,
    I64,
    TYPE_IDS,
    U64,
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
from missionfsm.isaac.wire.strictjson import JsonFault, brief_json

MAX_LINE: Final = 1 << 20
"""Bytes of one line without its end, unless told otherwise."""

ErrorKind = Literal["framing", "syntax", "shape", "type"]

_DIGITS: Final = re.compile(r"-?[0-9]{1,20}", re.ASCII)
_BY_ID: Final = {type_id: kind for kind, type_id in TYPE_IDS.items()}
_BY_FIELD: Final = {"text": TextProto, "missionStatus": MissionStatusProto, "config": MissionProto}
_STATUSES: Final = tuple(WireStatus)


@attrs.frozen
class WireError:
    """A line, or part of one, that could not be understood.

    `line` counts from 1, `offset` is the byte within the line (from 0), `path` the place inside the JSON object (empty
    for the line as a whole). `kind` says which step failed: framing, JSON syntax, the shape of a field, or a type that
    does not travel here.
    """

    line: int
    offset: int
    path: str
    problem: str
    kind: ErrorKind

    def __str__(self) -> str:
        place = f"line {self.line}, byte {self.offset}"
        return f"{place}, {self.path}: {self.problem}" if self.path else f"{place}: {self.problem}"


class Decoder:
    """The reading half of one connection. Holds at most `limit` bytes, however much arrives without a line end.

    Pure but mutable: what `feed` returns depends on the bytes so far only, not on how they were cut.
    `numbers=False` refuses 64-bit integers that are not strings (AI-25 b).
    """

    def __init__(self, *, limit: int = MAX_LINE, numbers: bool = True) -> None:
        self._limit = limit
        self._numbers = numbers
        self._partial = bytearray()
        self._skipping = False
        self._line = 1

    def feed(self, data: bytes) -> list[Message | WireError]:
        """Every message, and everything wrong, that these bytes complete."""
        results: list[Message | WireError] = []
        start = 0
        while (end := data.find(b"\n", start)) >= 0:
            self._take(data, start, end, results)
            if not self._skipping:
                results.extend(self._complete())
            self._partial.clear()
            self._skipping = False
            self._line += 1
            start = end + 1
        self._take(data, start, len(data), results)
        return results

    def close(self) -> list[Message | WireError]:
        """What a last line without an end says (AI-26 c); a half line comes out as an error. Ends the decoder."""
        results = [] if self._skipping else self._complete()
        self._partial.clear()
        return results

    @property
    def buffered(self) -> int:
        """Bytes held of a line that has not ended; never more than the limit."""
        return len(self._partial)

    def _take(self, data: bytes, start: int, end: int, results: list[Message | WireError]) -> None:
        if self._skipping:
            return
        if len(self._partial) + end - start > self._limit:
            self._partial.clear()
            self._skipping = True
            results.append(
                WireError(self._line, self._limit, "", f"the line is longer than {self._limit} bytes", "framing")
            )
        else:
            self._partial += memoryview(data)[start:end]

    def _complete(self) -> list[Message | WireError]:
        line = bytes(self._partial).removesuffix(b"\r")
        if not line.strip(b" \t"):
            return []
        return decode_line(line, line_number=self._line, numbers=self._numbers)


def decode_line(line: bytes, *, line_number: int = 1, numbers: bool = True) -> list[Message | WireError]:
    """One line without its end: the one message in it, or everything that is wrong with it."""
    try:
        text = line.decode()
    except UnicodeDecodeError as error:
        return [WireError(line_number, error.start, "", "not UTF-8", "syntax")]
    value = strictjson.parse(text)
    if isinstance(value, JsonFault):
        return [WireError(line_number, len(text[: value.position].encode()), "", value.problem, "syntax")]
    reader = _Reader(line_number, numbers=numbers)
    for path, problem in strictjson.faults(value):
        reader.wrong(path, problem)
    message = None if reader.errors else reader.message(value)
    return list(reader.errors) if message is None else [message]


class _Reader:
    """Reads one parsed line, collecting all that is wrong."""

    def __init__(self, line: int, *, numbers: bool) -> None:
        self._line = line
        self._numbers = numbers
        self.errors: list[WireError] = []

    def wrong(self, path: str, problem: str, kind: ErrorKind = "shape") -> None:
        self.errors.append(WireError(self._line, 0, path, problem, kind))

    def message(self, value: object) -> Message | None:
        if not isinstance(value, dict):
            self.wrong("", f"wanted an object with header and payload, found {brief_json(value)}")
            return None
        raw_header = self._object(value, "header")
        raw_payload = self._object(value, "payload")
        header = None if raw_header is None else self._header(raw_header)
        if raw_header is None or raw_payload is None:
            return None
        kind = self._type(raw_header.get("proto"), raw_payload)
        payload = None if kind is None else self._payload(kind, raw_payload)
        return None if self.errors or header is None or payload is None else Message(header, payload)

    def _object(self, value: dict[str, Any], key: str) -> dict[str, Any] | None:
        found = value.get(key)
        if isinstance(found, dict):
            return found
        self.wrong(key, "is missing" if found is None else f"wanted an object, found {brief_json(found)}")
        return None

    def _header(self, raw: dict[str, Any]) -> Header:
        return Header(
            channel=self._text(raw, "header", "channel"),
            pubtime=self._integer(raw.get("pubtime"), "header.pubtime", -I64, I64),
            acqtime=self._integer(raw.get("acqtime"), "header.acqtime", -I64, I64),
            uuid=self._uuid(raw.get("uuid"), "header.uuid"),
        )

    def _type(self, proto: object, payload: dict[str, Any]) -> type[Payload] | None:
        if proto in DATA_BUFFER_TYPES:
            self.wrong("header.proto", f"{proto} uses data buffers, which do not travel as JSON", "type")
            return None
        if proto is None:  # an old or lenient sender: the payload's fields tell the type (AI-27)
            kinds = [kind for field, kind in _BY_FIELD.items() if field in payload]
            if len(kinds) == 1:
                return kinds[0]
            self.wrong("header.proto", "is missing, and the payload's fields do not tell the type", "type")
            return None
        type_id = self._integer(proto, "header.proto", -I64, U64)
        if type_id is None:
            return None
        kind = _BY_ID.get(unsigned(type_id))
        if kind is None:
            known = ", ".join(sorted(kind.__name__ for kind in TYPE_IDS))
            self.wrong("header.proto", f"type {unsigned(type_id)} does not travel here; {known} do", "type")
        return kind

    def _payload(self, kind: type[Payload], raw: dict[str, Any]) -> Payload:
        if kind is TextProto:
            return TextProto(self._text(raw, "payload", "text", default=""))
        uuid = self._uuid(raw.get("uuid"), "payload.uuid")
        if kind is MissionProto:
            return MissionProto(uuid, self._config(raw.get("config")))
        return MissionStatusProto(uuid, self._status(raw.get("missionStatus")))

    def _config(self, raw: object) -> str:
        if raw is None:  # AI-33: nothing to set
            return "{}"
        if isinstance(raw, str):
            return raw
        if isinstance(raw, dict):
            serialized = raw.get("serialized")
            return serialized if isinstance(serialized, str) else strictjson.compact(raw)
        self.wrong("payload.config", f"wanted an object or JSON text, found {brief_json(raw)}")
        return "{}"

    def _status(self, raw: object) -> WireStatus:
        if isinstance(raw, str) and raw.upper() in WireStatus.__members__:
            return WireStatus[raw.upper()]
        if isinstance(raw, int) and not isinstance(raw, bool) and 0 <= raw < len(_STATUSES):
            return _STATUSES[raw]
        found = "nothing" if raw is None else brief_json(raw)
        self.wrong("payload.missionStatus", f"wanted running, success or failure, found {found}")
        return WireStatus.RUNNING

    def _text(self, raw: dict[str, Any], inside: str, key: str, default: str | None = None) -> str:
        found = raw.get(key, default)
        if isinstance(found, str):
            return found
        self.wrong(f"{inside}.{key}", "is missing" if found is None else f"wanted a string, found {brief_json(found)}")
        return ""

    def _uuid(self, raw: object, path: str) -> Uuid | None:
        if raw is None or raw == {}:
            return None
        if not isinstance(raw, dict):
            self.wrong(path, f"wanted an object with lower and upper, found {brief_json(raw)}")
            return None
        lower = self._integer(raw.get("lower", "0"), f"{path}.lower", 0, U64)
        upper = self._integer(raw.get("upper", "0"), f"{path}.upper", 0, U64)
        return Uuid(lower or 0, upper or 0)

    def _integer(self, raw: object, path: str, lowest: int, beyond: int) -> int | None:
        if raw is None:
            return None
        number: int | None = None
        if isinstance(raw, str) and _DIGITS.fullmatch(raw):
            number = int(raw)
        elif isinstance(raw, int) and not isinstance(raw, bool):
            number = raw
            if not self._numbers:
                self.wrong(path, f"wanted a 64-bit integer as a string, found the number {brief_json(raw)}")
                return None
        if number is None:
            self.wrong(path, f"wanted a 64-bit integer, found {brief_json(raw)}")
        elif not lowest <= number < beyond:
            self.wrong(path, f"{brief_json(raw)} is outside {lowest} … {beyond - 1}")
            return None
        return number


def encode(message: Message, *, header_uuid_as_numbers: bool = False) -> bytes:
    """The message as a line, its end included."""
    return as_line(message, header_uuid_as_numbers=header_uuid_as_numbers).encode("ascii") + b"\n"


def as_line(message: Message, *, header_uuid_as_numbers: bool = False) -> str:
    """The message as a line of text, without its end."""
    return strictjson.compact(as_json(message, header_uuid_as_numbers=header_uuid_as_numbers))


def as_json(message: Message, *, header_uuid_as_numbers: bool = False) -> dict[str, Any]:
    """The object that the line of a message holds.

    `header_uuid_as_numbers` is a deviation of the shipped server: the two halves of the header's identifier go as
    numbers there, although every 64-bit integer is documented to go as a string. TypeError for any other payload.
    """
    kind = type(message.payload)
    if kind not in TYPE_IDS:
        msg = f"{kind.__name__} does not travel here; {', '.join(sorted(known.__name__ for known in TYPE_IDS))} do"
        raise TypeError(msg)
    header: dict[str, object] = {"channel": message.header.channel}
    if message.header.pubtime is not None:
        header["pubtime"] = str(message.header.pubtime)
    if message.header.acqtime is not None:
        header["acqtime"] = str(message.header.acqtime)
    header["proto"] = str(signed(TYPE_IDS[kind]))
    if (uuid := message.header.uuid) is not None:
        header["uuid"] = {"lower": uuid.lower, "upper": uuid.upper} if header_uuid_as_numbers else _halves(uuid)
    return {"header": header, "payload": _payload(message.payload)}


def _payload(payload: Payload) -> dict[str, object]:
    if isinstance(payload, TextProto):
        return {"text": payload.text}
    result: dict[str, object] = {} if payload.uuid is None else {"uuid": _halves(payload.uuid)}
    if isinstance(payload, MissionProto):
        result["config"] = {"serialized": payload.config}
    else:
        result["missionStatus"] = payload.mission_status.value
    return result


def _halves(uuid: Uuid) -> dict[str, str]:
    return {"lower": str(uuid.lower), "upper": str(uuid.upper)}
