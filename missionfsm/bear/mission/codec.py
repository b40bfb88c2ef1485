"""The JSON of the mission API: requests, answers, status messages, worlds and drives, in and out."""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta

from missionfsm.bear.mission.events import PLAIN_EVENTS, Event
from missionfsm.bear.mission.operations import OPERATIONS
from missionfsm.bear.mission.render import rendered, with_bare_feedback
from missionfsm.bear.mission.request_codec import REQUESTS, read_request, split_request, write_request
from missionfsm.bear.mission.skim import skim
from missionfsm.bear.mission.state import Fault, World
from missionfsm.bear.mission.views import MORE, Listing, Seen, without_ids
from missionfsm.bear.wire import messages as wire
from missionfsm.bear.wire.binary import carries
from missionfsm.bear.wire.messages import MissionStates
from missionfsm.bear.wire.protojson import USUAL_TIMESTAMP, MalformedError, camel, key_of, read, unknown_fields, write
from missionfsm.kernel.codec import JSON, Codec, DriveForm, Malformed, Part, UnreadableError
from missionfsm.kernel.history import Answer, Mark, Name
from missionfsm.kernel.rules import DEADLINE_EXCEEDED, INTERNAL, OK
from missionfsm.kernel.shapes import BOOLEAN
from missionfsm.kernel.text import brief
from missionfsm.kernel.worlds import WorldForm

# Requests: which member of which oneof means which kind of mission.


# Answers.

RESULTS: Mapping[str, type[wire.MissionId | wire.MissionIds]] = {
    "CreateMission": wire.MissionId,
    "AppendMission": wire.MissionId,
    "ChargeRobot": wire.MissionId,
    "SkipGoal": wire.MissionId,
    "CreateMissionBatch": wire.MissionIds,
    "AppendMissionBatch": wire.MissionIds,
    "CreateMissionWorkflow": wire.MissionIds,
    "ClearMissionStatus": wire.MissionIds,
}
"""The message that a call answers with; the others answer with an empty one, or with a stream."""

_NAMED, _LISTED = Answer(OK), Answer(OK, unordered=True)
_WITH_MORE = Answer(OK, MORE), Answer(OK, MORE, unordered=True)


def read_answer(method: str, result: JSON) -> tuple[Answer, tuple[Name, ...]]:
    """What a successful result says; one that is not of the documented form is `Malformed`."""
    if method in STREAMS:
        return Answer(OK), (_stream(method, result),)
    kind = RESULTS.get(method)
    if kind is wire.MissionId and isinstance(result, dict) and len(result) == 1:
        name = result.get("missionId")
        if isinstance(name, str) and name:
            return _NAMED, (name,)  # by far the commonest form, read without further ado
    unordered = method == "ClearMissionStatus"
    try:
        return (_empty(result), ()) if kind is None else _ids(kind, result, unordered=unordered)
    except MalformedError as error:
        return Answer(OK, Malformed(str(error)), unordered), ()


def _stream(method: str, result: JSON) -> Name:
    stream = result.get("stream") if isinstance(result, dict) else None
    if isinstance(stream, bool) or not isinstance(stream, int):
        message = f"{method} answered {brief(result)}, which carries no stream number"
        raise UnreadableError(message)
    return "stream", stream


def _empty(result: JSON) -> Answer:
    """An answer that is documented to have no fields."""
    read(wire.Empty, result)
    said = next((name for name, value in result.items() if value is not None), None)
    return _NAMED if said is None else Answer(OK, Malformed(f"it has {brief(said)}; the answer has no fields"))


def _ids(
    kind: type[wire.MissionId | wire.MissionIds], result: JSON, *, unordered: bool
) -> tuple[Answer, tuple[Name, ...]]:
    """An answer that names missions. Raises MalformedError where it is not of its form."""
    found = read(kind, result)
    ids = found.mission_ids if isinstance(found, wire.MissionIds) else (found.mission_id,)
    if not all(ids):
        return Answer(OK, Malformed("a mission id is missing"), unordered), ()
    if unknown_fields(kind, result):
        return _WITH_MORE[unordered], ids
    return _LISTED if unordered else _NAMED, ids


def write_answer(method: str, _: Answer, names: tuple[Name, ...]) -> JSON:
    """The result of a call that succeeded."""
    if method in STREAMS:
        return {"stream": names[0][1]}  # type: ignore[index]
    kind = RESULTS.get(method)
    if kind is wire.MissionIds:
        return {"missionIds": list(names)}
    return {"missionId": names[0]} if kind is wire.MissionId else {}


# Status messages.


def split_message(message: JSON) -> tuple[Part, ...]:
    """The mission ids of a status message, its sequence number, and the message without them.

    What is not of the documented form, or worth a remark, is left in for `read_content` to find.
    """
    if not isinstance(message, dict):
        return (((), (), message),)
    rest = message.copy()
    marks: tuple[Mark, ...] = ()
    metadata = message.get("metadata")
    number, left = _sequence_number(metadata) if isinstance(metadata, dict) else (None, metadata)
    if number is not None:
        marks = ((None, number),)
    if number is None or left:
        rest["metadata"] = left
    else:
        del rest["metadata"]
    key = "missionStates" if message.get("missionStates") is not None else "mission_states"
    states = message.get(key)
    missions = states.get("missions") if isinstance(states, dict) else None
    found = _nameless(missions) if isinstance(missions, list) else None
    if found is None:
        return (((), marks, rest),)
    ids, bare = found
    rest[key] = states = states.copy()  # type: ignore[union-attr]
    states["missions"] = bare
    return ((ids, marks, rest),)


def _nameless(missions: list[JSON]) -> tuple[tuple[Name, ...], list[JSON]] | None:
    """The ids of missions, and the missions without them; None where one of them is no object."""
    named: list[Name] = []
    bare: list[JSON] = []
    for mission in missions:
        if type(mission) is not dict:
            return None
        name, given = "missionId", mission.get("missionId")
        if given is None:
            name, given = "mission_id", mission.get("mission_id")
        if type(given) is str and given:
            named.append(given)
            mission = mission.copy()  # noqa: PLW2901 - the same mission without its id
            mission[name] = "-"
        bare.append(mission)
    return tuple(named), bare


_USUAL_TIMESTAMP = re.compile(USUAL_TIMESTAMP)


def _sequence_number(metadata: dict[str, JSON]) -> tuple[int | None, JSON]:
    """The sequence number of well-formed metadata, None where they are malformed, and what is left to be looked at.

    That is everything where they are malformed; otherwise what is not documented, and that a timestamp is absent.
    """
    number, timestamp = metadata.get("sequenceNumber"), metadata.get("timestamp")
    if type(number) is int and type(timestamp) is str and len(metadata) == 2:
        usual = 0 <= number < 1 << 63 and _USUAL_TIMESTAMP.fullmatch(timestamp)
        if usual:
            return number, None  # by far the commonest form, read without further ado
    try:
        found = read(wire.EventMetadata, metadata)
    except MalformedError:
        return None, metadata
    left = {name: metadata[name] for name in unknown_fields(wire.EventMetadata, metadata)}
    return found.sequence_number, {"timestamp": None, **left} if found.timestamp is None else left


def read_content(rest: JSON) -> Seen | Malformed:
    """What a stripped status message shows."""
    bare: list[bool] = []
    metadata: JSON = {}
    if isinstance(rest, dict) and "metadata" in rest:
        metadata = rest["metadata"]
        wrong = _about_metadata(metadata)
        if wrong:
            return Malformed(wrong)
        rest = {name: value for name, value in rest.items() if name != "metadata"}
    try:
        wrapped = _wrapped_feedback(rest, bare)
        status = read(wire.MissionStatus, wrapped)
    except MalformedError as error:
        return Malformed(str(error))
    states = status.mission_states or MissionStates()
    named = tuple(bool(one.mission_id) for one in states.missions)
    more = unknown_fields(wire.MissionStatus, wrapped) or unknown_fields(wire.EventMetadata, metadata)
    return Seen(without_ids(states), named, tuple(bare), "timestamp" not in metadata, bool(more))


_MAYBE_BARE = ("serviFeedback", "cartiFeedback", "servi_feedback", "carti_feedback")


def _about_metadata(metadata: JSON) -> str:
    """What is wrong with metadata that are left in a message; nothing where they are only worth a remark."""
    if metadata is None:
        return "metadata: it is missing"
    try:
        read(wire.EventMetadata, metadata)
    except MalformedError as error:
        return str(error.inside("metadata"))
    return ""


def _wrapped_feedback(rest: JSON, bare: list[bool]) -> JSON:
    """AM-50: feedback that came as a bare enum put into a message; `bare` notes where."""
    if not isinstance(rest, dict):
        return rest
    key = key_of(rest, "mission_states")
    states = rest.get(key)
    missions = states.get("missions") if isinstance(states, dict) else None
    if not isinstance(states, dict) or not isinstance(missions, list):
        return rest
    wrapped = []
    for mission in missions:
        shown = key_of(mission, "mission_feedback") if isinstance(mission, dict) else ""
        feedback = mission.get(shown) if shown else None
        members = feedback if isinstance(feedback, dict) else {}
        naked = {
            name: {"status": value}
            for name, value in members.items()
            if isinstance(value, str | int) and name in _MAYBE_BARE
        }
        bare.append(bool(naked))
        wrapped.append({**mission, shown: {**members, **naked}} if naked else mission)
    return {**rest, key: {**states, "missions": wrapped}}


EPOCH = datetime(2025, 1, 1, tzinfo=UTC)
"""When the clock of the reference model starts."""


def write_message(view: Listing, names: tuple[Name, ...], choice: int, number: int, seconds: float) -> JSON:
    """The status message that shows a listing."""
    states = with_bare_feedback(write(rendered(view, tuple(map(str, names)), choice)), choice)
    timestamp = (EPOCH + timedelta(seconds=seconds)).isoformat().replace("+00:00", "Z")
    return {"metadata": {"timestamp": timestamp, "sequenceNumber": number}, "missionStates": states}


# Worlds and drives: written by testers and authors of logs, so what is wrong is refused.

WORLD = WorldForm(World, without=("unwatched",))


def _changed(given: JSON) -> tuple[Event, tuple[Name, ...]]:
    """A world that changes."""
    changed = WORLD.attributes({key: value for key, value in given.items() if key != "event"})
    if "family" in changed:
        message = "drive.family: the family changes only with reset"
        raise UnreadableError(message)
    return Event("world", tuple(sorted(changed.items()))), ()


def _fault(given: JSON) -> tuple[Event, tuple[Name, ...]]:
    """A fault of the next call."""
    status, applied = given.get("status"), given.get("applied", False)
    if status not in (INTERNAL, DEADLINE_EXCEEDED) or not isinstance(applied, bool):
        wanted = "status INTERNAL or DEADLINE_EXCEEDED and applied true or false"
        said = brief({key: value for key, value in given.items() if key != "event"})
        message = f"drive: a fault has {wanted}, not {said}"
        raise UnreadableError(message)
    return Event("fault", Fault(status, applied)), ()


DRIVES = {
    **dict.fromkeys(PLAIN_EVENTS, DriveForm(lambda given: (Event(given["event"]), ()))),
    "world": DriveForm(
        _changed,
        lambda event, _: {camel(key): list(one) if isinstance(one, tuple) else one for key, one in event.what},
        {name: one for name, one in WORLD.members.items() if name != "family"},
    ),
    "fault": DriveForm(
        _fault,
        lambda event, _: {"status": event.what.status, "applied": event.what.applied},
        {"status": {"enum": [INTERNAL, DEADLINE_EXCEEDED]}, "applied": BOOLEAN},
        ("status",),
    ),
}


STREAMS = tuple(name for name, operation in OPERATIONS.items() if operation.streaming)
CODEC = Codec(
    methods=tuple(OPERATIONS),
    streams=STREAMS,
    read_world=WORLD.read,
    split_request=split_request,
    read_request=read_request,
    read_answer=read_answer,
    split_message=split_message,
    read_content=read_content,
    drives=DRIVES,
    write_request=write_request,
    write_answer=write_answer,
    write_message=write_message,
    write_world=WORLD.write,
    skim=skim,
    carries=carries,
    robot_in_params=True,
)
__all__ = ["CODEC", "REQUESTS", "RESULTS", "STREAMS"]
