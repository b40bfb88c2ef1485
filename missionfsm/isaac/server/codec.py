"""The JSON of ``isaac.server``: submissions, statuses, lines in both directions, and the drives of the protocol."""

from __future__ import annotations

import json
import math
import operator
from typing import Any

from attrs import evolve

from missionfsm.isaac.server import inputs
from missionfsm.isaac.server.inputs import (
    BAD,
    BLANK,
    DEFECTS,
    FOREIGN,
    NAME,
    NOISE,
    STATUS,
    Connects,
    Drops,
    Incoming,
    Statuses,
    Submission,
)
from missionfsm.isaac.server.readings import AI_10, AI_25_HEADER, AI_27_UUID, AI_28_CONFIG, AI_28_UUID
from missionfsm.isaac.server.state import Closes, Sends, World
from missionfsm.isaac.shared.drives import ADVANCE, in_microseconds, seconds, text_line
from missionfsm.isaac.shared.line import (
    MICROSECONDS,
    LineContent,
    canonical,
    from_json,
    is_garbled,
    is_untyped,
    new_uuid,
    part_of,
    see,
    uuid_name,
)
from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.framing import WireError, as_json, decode_line
from missionfsm.isaac.wire.messages import Header, Message, MissionProto, MissionStatusProto, TextProto, Uuid
from missionfsm.kernel.codec import JSON, Codec, DriveForm, Malformed, Part, UnreadableError
from missionfsm.kernel.history import Answer, Name
from missionfsm.kernel.readings import meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.shapes import TEXT
from missionfsm.kernel.terms import Incident
from missionfsm.kernel.text import brief

_KEYS = ("robot", "channel", "status_channel", "config", "start_timeout", "timeout", "upstream")
_BUFFERS = "type"
_MAX_DIGITS = 19


def read_world(given: JSON) -> World:
    """The name channel of a world, and by how many seconds the times of a history may be off."""
    given = given or {}
    if not isinstance(given, dict) or not set(given) <= {"nameChannel", "tolerance"}:
        raise UnreadableError(f"world: isaac.server has nameChannel and tolerance only, not {brief(given)}")
    channel, tolerance = given.get("nameChannel", "name"), given.get("tolerance", 0)
    if not isinstance(channel, str) or not channel:
        raise UnreadableError(f"world.nameChannel: {brief(channel)} is not the name of a channel")
    return World(channel, seconds(tolerance, "world.tolerance"))


def write_world(given: World) -> JSON:
    """The parameters of a world."""
    exact: JSON = {"nameChannel": given.name_channel}
    return {**exact, "tolerance": given.tolerance / MICROSECONDS} if given.tolerance else exact


# Calls.


def split_request(method: str, params: JSON) -> tuple[tuple[Name, ...], JSON]:
    """The handles that a submission names as upstreams, and what is left with a 0 in the place of each."""
    mission = params.get("mission") if isinstance(params, dict) else None
    upstream = mission.get("upstream") if isinstance(mission, dict) else None
    if method != "submit" or not isinstance(upstream, list):
        return (), params
    handles = tuple(("mission", one) for one in upstream if _is_handle(one))
    bare = [0 if _is_handle(one) else one for one in upstream]
    return handles, {**params, "mission": {**mission, "upstream": bare}}  # type: ignore[dict-item]


def _is_handle(value: JSON) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def read_request(method: str, params: JSON) -> Submission | Statuses:
    """The request of a call, whatever its handles are."""
    if method == "statuses":
        return Statuses()
    if method != "submit":
        raise UnreadableError(f"{brief(method)} is not a method of isaac.server; those are submit, statuses")
    mission = params.get("mission") if isinstance(params, dict) else None
    if not isinstance(mission, dict):
        return Submission(defects=(inputs.MALFORMED,))
    return _Reader(mission).submission()


class _Reader:
    """Reads one submission and collects what is wrong with it."""

    def __init__(self, mission: dict[str, Any]) -> None:
        self.mission = mission
        self.defects: set[str] = set()

    def submission(self) -> Submission:
        if not set(self.mission) <= set(_KEYS):
            self.defects.add(inputs.KEY)
        robot = self._text("robot")
        if robot == "":
            self.defects.add(inputs.NO_NAME)
        channel, status_channel = self._channel("channel"), self._channel("status_channel")
        start, run = self._time("start_timeout", inputs.DEFAULT_START / MICROSECONDS), self._time("timeout", math.inf)
        upstream = self._upstream()
        config = self._config()
        defects = tuple(one for one in DEFECTS if one in self.defects)
        channel = inputs.DEFAULT_CHANNEL if channel is None else channel
        return Submission(robot, channel, status_channel, config, start, run, upstream, defects)

    def _text(self, key: str) -> str | None:
        value = self.mission.get(key)
        if value is not None and not isinstance(value, str):
            self.defects.add(inputs.MALFORMED)
            return None
        return value

    def _channel(self, key: str) -> str | None:
        if key in self.mission and self.mission[key] is None:
            self.defects.add(inputs.NULL)
        value = self._text(key)
        if value == "":
            self.defects.add(inputs.EMPTY)
        return value

    def _time(self, key: str, default: float) -> int | None:
        value = self.mission.get(key, default)
        if value is None:
            self.defects.add(inputs.NULL)
            value = default
        if isinstance(value, bool) or not isinstance(value, int | float) or value != value:  # noqa: PLR0124 - NaN
            self.defects.add(inputs.MALFORMED)
            return None
        if value < 0:
            self.defects.add(inputs.NEGATIVE)
        return None if abs(value) == math.inf else in_microseconds(value, f"submit.{key}")

    def _upstream(self) -> int:
        value = self.mission.get("upstream", [])
        if value is None:
            self.defects.add(inputs.NULL)
            return 0
        if not isinstance(value, list):
            self.defects.add(inputs.MALFORMED)
            return 0
        if not all(map(_is_handle, value)):
            self.defects.add(inputs.HANDLE)
        return len(value)

    def _config(self) -> str:
        value = self.mission.get("config", {})
        if value is None:
            self.defects.add(inputs.NULL_CONFIG)
            value = {}
        if not isinstance(value, dict):
            self.defects.add(inputs.MALFORMED)
            return "{}"
        return canonical(json.dumps(value)) or "{}"


_WORDS = {
    "created": ("CREATED",),
    "queued": ("QUEUED",),
    "started": ("STARTED",),
    "running": ("RUNNING",),
    "success": ("SUCCESS", "SUCCEEDED", "COMPLETED"),
    "failed": ("FAILED", "FAILURE"),
    "canceled": ("FAILED_UPSTREAM", "CANCELED", "CANCELLED"),
    "aborted": ("ABORTED",),
    "timed out": ("FAILED_TIMEDOUT", "TIMEDOUT", "TIMED_OUT", "TIMEOUT", "FAILED_TIMEOUT"),
    "lost": ("FAILED_DISCONNECTED", "DISCONNECTED", "LOST"),
}
"""AI-02: the names that are taken for one and the same; the first is the shipped server's."""

_BY_NAME = {name: word for word, names in _WORDS.items() for name in names}


def read_answer(method: str, result: JSON) -> tuple[Answer, tuple[Name, ...]]:
    """What a result says. Missions are shown in the order of their handles, which is that of their submission."""
    if method == "submit":
        handle = result.get("mission") if isinstance(result, dict) else None
        if not _is_handle(handle):
            return Answer(OK, Malformed(f"mission: {brief(handle)} is no handle")), ()
        return Answer(OK), (("mission", handle),)
    missions = result.get("missions") if isinstance(result, dict) else None
    if not isinstance(missions, dict) or not all(map(_is_number, missions)):
        return Answer(OK, Malformed(f"missions: {brief(missions)} is no object from handles to statuses")), ()
    in_order = sorted(((int(key), value) for key, value in missions.items()), key=operator.itemgetter(0))
    names = tuple(("mission", handle) for handle, _ in in_order)
    words = tuple(_word(value) for _, value in in_order)
    if None in words:
        unknown = in_order[words.index(None)][1]
        return Answer(OK, Malformed(f"{brief(unknown)} is not the name of a status")), names
    return Answer(OK, words), names


def _is_number(key: str) -> bool:
    """Whether the key of an object is a handle."""
    return key.isascii() and key.isdecimal() and len(key) <= _MAX_DIGITS


def _word(status: JSON) -> str | None:
    """What is meant by the name of a status, in upper or lower case; None for what is no such name."""
    return _BY_NAME.get(status.upper()) if isinstance(status, str) and status.isascii() else None


def write_answer(method: str, answer: Answer, names: tuple[Name, ...]) -> JSON:
    """The result of a call that succeeded, with the shipped server's names."""
    if method == "submit":
        return {"mission": names[0][1]}  # type: ignore[index]
    words: Any = answer.shape
    return {"missions": {str(name[1]): _WORDS[word][0] for name, word in zip(names, words, strict=True)}}  # type: ignore[index]


def write_request(asked: Submission | Statuses, names: tuple[Name, ...]) -> JSON:
    """The params of a well-formed request."""
    if isinstance(asked, Statuses):
        return {}
    mission: dict[str, JSON] = {"channel": asked.channel, "config": json.loads(asked.config)}
    mission["upstream"] = [name[1] for name in names]  # type: ignore[index]
    texts = (("robot", asked.robot), ("status_channel", asked.status_channel))
    times = (("start_timeout", asked.start), ("timeout", asked.run))
    mission |= {key: text for key, text in texts if text is not None}
    mission |= {key: time / MICROSECONDS for key, time in times if time is not None}
    return {"mission": mission}


# Drives.


def _connection(given: JSON) -> Name:
    number = given.get("connection")
    if isinstance(number, bool) or not isinstance(number, int):
        raise UnreadableError(f"drive.connection: {brief(number)} is not the number of a connection")
    return ("connection", number)


def _line(given: JSON) -> tuple[Incoming, tuple[Name, ...]]:
    """A line of a robot, and its names: the connection, then the missions that it names."""
    heard, names = hear(text_line(given))
    return heard, (_connection(given), *names)


def read_drive_result(given: JSON) -> tuple[Any, tuple[Name, ...]]:
    """The event of a drive that happened and its names: a robot that has connected has a connection."""
    event, names = CODEC.read_drive(given)
    return event, names or ((_connection(given),) if isinstance(event, Connects) else ())


def hear(line: str) -> tuple[Incoming, tuple[Name, ...]]:
    """What a robot's line is to a server."""
    if not line.strip():
        return Incoming(BLANK), ()
    data = line.encode(errors="surrogatepass")
    message = decode_line(data)[0]
    if isinstance(message, WireError):
        if mended := _mended(line):
            heard, names = hear(mended)
            return evolve(heard, garbled=True), names
        return Incoming(FOREIGN if message.kind == _BUFFERS else BAD), ()
    numeric = isinstance(decode_line(data, numbers=False)[0], WireError)
    payload, channel = message.payload, message.header.channel
    raw = json.loads(line)
    untyped, garbled = is_untyped(raw), is_garbled(raw)
    if isinstance(payload, TextProto):
        return Incoming(NAME, payload.text, channel, numeric=numeric, untyped=untyped, garbled=garbled), ()
    if not isinstance(payload, MissionStatusProto):
        return Incoming(NOISE, channel=channel, numeric=numeric), ()
    odd = raw["payload"]["missionStatus"] != payload.mission_status.value
    names = tuple(uuid_name(one) for one in (payload.uuid, message.header.uuid) if one is not None)
    named, header = payload.uuid is not None, message.header.uuid is not None
    return Incoming(STATUS, payload.mission_status.value, channel, named, header, numeric, untyped, odd, garbled), names


def _mended(line: str) -> str | None:
    """A line without those of its numbers that cannot be read, if it is a message then: nobody has to look at them."""
    raw = strictjson.parse(line)
    if not isinstance(raw, dict) or not isinstance(raw.get("header"), dict) or not isinstance(raw.get("payload"), dict):
        return None
    header = {key: value for key, value in raw["header"].items() if key in ("channel", "proto")}
    payload = {key: value for key, value in raw["payload"].items() if key != "uuid"}
    for mended in ({"header": header, "payload": raw["payload"]}, {"header": header, "payload": payload}):
        text = json.dumps(mended)
        if not isinstance(decode_line(text.encode(errors="surrogatepass"))[0], WireError):
            return text
    return None


def _number(_: Incident, names: tuple[Name, ...]) -> dict[str, JSON]:
    """The connection's number, where it is known."""
    return {"connection": names[0][1]} if names else {}  # type: ignore[index]


def _essence(event: Incoming, names: tuple[Name, ...]) -> dict[str, JSON]:
    """Of a line that arrives the essence."""
    payload: JSON = {"text": event.what} if event.kind == NAME else {"missionStatus": event.what}
    uuids = [{"lower": str(Uuid.of(one[1]).lower), "upper": str(Uuid.of(one[1]).upper)} for one in names[1:]]  # type: ignore[index]
    header: JSON = {"channel": event.channel}
    if event.header:
        header["uuid"] = uuids[-1]
    if event.named:
        payload["uuid"] = uuids[0]
    if event.kind == NOISE:  # a mission, which nobody sends to a server
        payload = {"uuid": {"lower": "1", "upper": "1"}, "config": {"serialized": "{}"}}
    essences = {BLANK: "", BAD: "no message", FOREIGN: "{}"}
    line = (
        essences[event.kind] if event.kind in essences else strictjson.compact({"header": header, "payload": payload})
    )
    return {**_number(event, names), "line": line}


_CONNECTION = {"connection": {"type": "integer"}}
DRIVES = {
    "connect": DriveForm(
        lambda given: (Connects(), (_connection(given),) if "connection" in given else ()), _number, _CONNECTION
    ),
    "line": DriveForm(_line, _essence, {**_CONNECTION, "line": TEXT}, ("connection", "line")),
    "disconnect": DriveForm(lambda given: (Drops(), (_connection(given),)), _number, _CONNECTION, ("connection",)),
    "advance": ADVANCE,
}


def write_drive_result(event: Incident, names: tuple[Name, ...]) -> dict[str, JSON]:
    """What connecting tells: the connection's number."""
    return {"connection": names[0][1]} if isinstance(event, Connects) else {}  # type: ignore[index]


# Lines that the server sends.


def split_message(line: JSON) -> tuple[Part, ...]:
    """The identifier in a line, the uuid of its header as a mark, and what is left of it.

    Nothing of a text, as long as it is well formed: whether a server greets a robot, or confirms its name, is its own
    affair.
    """
    names, said = see(line)
    greets = isinstance(said, LineContent) and said.kind == "text" and not said.bare
    if greets and "config" in json.loads(line)["payload"]:
        greets, said = False, Malformed("header.proto is the type id of a text, the payload is a mission")
    return () if greets else (part_of(line, names, said),)


def write_message(view: Sends | Closes, names: tuple[Name, ...], choice: int, number: int, at: float) -> JSON:
    """The line that sends a mission; None where the connection ends."""
    if isinstance(view, Closes):
        return None
    time = round(at * 1e9)
    uuid = Uuid.of(names[0][1])  # type: ignore[index]
    # The message's own is no mission's, whatever names those are given, and another one for each that an event causes.
    message_uuid = Uuid.of(new_uuid(number + (uuid.value << 40))[1])  # type: ignore[index]
    own = uuid if meet(choice, (AI_27_UUID["b"],)) or meet(choice, (AI_10["c"],)) else message_uuid
    bare = bool(meet(choice, (AI_25_HEADER["n"],)))
    stated = uuid if meet(choice, (AI_28_UUID["y"],)) else None
    header = Header(view.channel, time, time, own)
    message = as_json(Message(header, MissionProto(stated, view.config)), header_uuid_as_numbers=bare)
    if meet(choice, (AI_28_CONFIG["a"],)):
        message["payload"]["config"] = json.loads(view.config)
    return strictjson.compact(message)


CODEC = Codec(
    measured=("seconds",),
    read_world=read_world,
    split_request=split_request,
    read_request=read_request,
    read_answer=read_answer,
    split_message=split_message,
    read_content=from_json,
    drives=DRIVES,
    write_request=write_request,
    write_answer=write_answer,
    write_message=write_message,
    write_world=write_world,
    write_drive_result=write_drive_result,
    read_drive_result=read_drive_result,
)
