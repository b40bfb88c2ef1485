"""A monitor that stands alone: the messages of one live subscription in, what is wrong with each of them out.

    monitor = StreamMonitor("SubscribeBatteryStatus")
    for message in messages:
        for problem in monitor.feed(message):
            print(problem)

Nothing is known of the robots but what the messages say, so a message is held to what it shows by itself, and to the
robot's message before it: the form, ranges and enums, values that cannot stand together, the sequence numbers. The
rules are those of the specification, functions included; what they say of a payload is remembered, so that a payload
that was seen before costs a look-up. Memory grows with the number of robots, never with that of messages.
"""

from __future__ import annotations

import marshal
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping

from missionfsm.bear.status.codec import map_value, metadata_of, single_value
from missionfsm.bear.status.drive_codec import read_state
from missionfsm.bear.status.spec import sequence
from missionfsm.bear.status.state import MAPS, PARTS, SINGLES, WIFI, Endpoint, Value
from missionfsm.bear.status.stream import SELECTED, SEQUENCE, WELL_FORMED
from missionfsm.bear.status.values import CHECKS, Fault, a_stuck_state_is_known, faults, reserved_reasons_are_not_used
from missionfsm.bear.wire.messages import EventMetadata
from missionfsm.bear.wire.problem import Problem
from missionfsm.bear.wire.protojson import USUAL_TIMESTAMP, MalformedError, camel
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.sequence import relation
from missionfsm.kernel.step import Mismatch
from missionfsm.kernel.text import brief

MAX_VERDICTS = 50_000
"""How many different payloads a monitor remembers before it starts to remember anew."""


CHECKED = (WELL_FORMED, SEQUENCE, SELECTED, *(one.rule for one in CHECKS))
"""The rules that a bare message can break."""

Verdict = tuple[Fault, ...]
_USUAL_TIMESTAMP = re.compile(USUAL_TIMESTAMP)
_POSE = frozenset({"xMeters", "yMeters", "headingRadians"})
_TWIST = frozenset({"linearVelocity", "angularVelocity"})
_KNOWN = frozenset(map(camel, PARTS)) - {camel(WIFI)}
_MOVING = frozenset({"pose", "twist"})
"""Parts that hardly ever come twice: they are looked at each time, and are no part of what is remembered."""


class _Track:
    """What is remembered of a robot: its last number, when that was, its last payload, and what was wrong with it."""

    __slots__ = ("given", "number", "payload", "timestamp", "verdict")

    def __init__(self) -> None:
        self.number: int | None = None
        self.timestamp: JSON = None
        self.given: JSON = None
        self.payload: bytes = b""
        self.verdict: Verdict | None = None


class StreamMonitor:
    """Judges the messages of one stream as they come.

    Args:
        endpoint: the subscription, as an `Endpoint` or by its name.
        robots: the robots that were selected, if that is known; any other one is a problem.
        strict: whether a message is wrong that was delivered twice.

    Attributes:
        messages: how many messages came.
        redelivered: how often the last message about a robot came again, with its number and timestamp.
        repeats: how often a robot's payload equalled that of the message before, which is tolerated. Pose and velocity
            of whole states are not compared, since those come again by design.
    """

    def __init__(
        self, endpoint: Endpoint | str, robots: Collection[str] | None = None, *, strict: bool = False
    ) -> None:
        self.endpoint = Endpoint(endpoint)
        self.messages = 0
        self.repeats = 0
        self.redelivered = 0
        self._strict = strict
        self._echoes = 0
        self._selected = None if robots is None else frozenset(robots)
        self._tracks: dict[str, _Track] = {}
        self._verdicts: dict[bytes, Verdict] = {}
        self._map = MAPS.get(self.endpoint)
        self._field = SINGLES.get(self.endpoint, "")
        self._whole = self.endpoint is Endpoint.ROBOT
        self._judge: Callable[[JSON, bytes], Verdict] = self._judge_parts if self._whole else self._remembered

    @property
    def robots(self) -> int:
        """How many robots the stream was about so far."""
        return len(self._tracks)

    def restarted(self, robot: str) -> None:
        """A robot is known to have restarted: its next number is free."""
        track = self._tracks.get(robot)
        if track is not None:
            track.number = None

    def feed(self, message: JSON) -> tuple[Problem, ...]:
        """What is wrong with the next message; nothing, usually."""
        self.messages += 1
        self._echoes = 0
        found = self._fed(message)
        if self._echoes and self._map is not None and self._echoes == len(_either(message, self._map)):
            # AS-08: an update may bring what has not changed, but not that alone.
            robot = next(iter(_either(message, self._map)))
            says = f"the sequence number is equal ({self._tracks[robot].number} again), as all are in this message"
            found = (*found, Problem(self.messages, robot, SEQUENCE.id, says))
        return found

    def _fed(self, message: JSON) -> tuple[Problem, ...]:
        try:
            if self._map is None and message["robotId"]:
                return self._one(message["robotId"], message["metadata"], message[self._field])
            if self._map is None:
                return self._careful(message)
            found: tuple[Problem, ...] = ()
            for robot, entry in message[self._map].items():
                metadata = entry.pop("metadata")
                try:
                    found += self._one(robot, metadata, entry)
                finally:
                    entry["metadata"] = metadata
        except (KeyError, TypeError, AttributeError, ValueError):
            return self._careful(message)
        return found

    def _one(self, robot: str, metadata: JSON, payload: JSON) -> tuple[Problem, ...]:
        """The usual case, and fast; raises where a message is not of the usual form."""
        number = metadata["sequenceNumber"]
        track = self._tracks.get(robot)
        if track is None or type(number) is not int or number <= (track.number or 0):
            return self._slowly(robot, metadata, payload)
        if len(metadata) != 2 or not _USUAL_TIMESTAMP.fullmatch(metadata["timestamp"]):
            return self._slowly(robot, metadata, payload)
        if self._whole:
            if not _may_stand_alone(payload):
                return self._slowly(robot, metadata, payload)
            key = marshal.dumps({part: value for part, value in payload.items() if part not in _MOVING}, 2)
        else:
            key = marshal.dumps(payload, 2)
        if key == track.payload:
            self.repeats += 1
            verdict = track.verdict
        else:
            verdict = self._judge(payload, key)
        if verdict or track.verdict:
            return self._slowly(robot, metadata, payload)
        track.number, track.timestamp, track.given = number, metadata["timestamp"], payload
        track.payload = key
        return ()

    def _remembered(self, payload: JSON, key: bytes) -> Verdict:
        verdict = self._verdicts.get(key)
        if verdict is None:
            if len(self._verdicts) >= MAX_VERDICTS:
                self._verdicts.clear()
            verdict = self._verdicts[key] = _verdict(lambda: self._value(payload))
        return verdict

    def _value(self, payload: JSON) -> Value:
        if self._map is not None:
            if not isinstance(payload, dict):
                raise MalformedError(f"{brief(payload)} is not an object")
            return map_value(self.endpoint, payload)
        return single_value(self.endpoint, payload)[0]

    def _judge_parts(self, payload: JSON, _: bytes) -> Verdict:
        """A whole state part by part, since most parts were seen before and parts alone tell it all."""
        if not _may_stand_alone(payload):
            return _verdict(lambda: read_state(payload)[0])
        found: Verdict = ()
        for part, value in payload.items():
            if part in _MOVING:
                continue
            key = marshal.dumps((part, value), 2)
            verdict = self._verdicts.get(key)
            if verdict is None:
                if len(self._verdicts) >= MAX_VERDICTS:
                    self._verdicts.clear()
                state = {part: value}
                verdict = self._verdicts[key] = _verdict(lambda given=state: read_state(given)[0])  # type: ignore[misc]
            found += verdict
        return found

    def _slowly(self, robot: str, metadata: JSON, payload: JSON) -> tuple[Problem, ...]:
        """One robot's message in whatever form, with all that can be said about it."""
        problems: list[tuple[str, str, bool]] = []
        if self._selected is not None and robot not in self._selected:
            problems.append((SELECTED.id, "the robot was not selected", False))
        track = self._tracks.get(robot)
        if track is None:
            track = self._tracks[robot] = _Track()
        key = marshal.dumps(payload, 2)
        try:
            known: EventMetadata = metadata_of(metadata)
        except MalformedError as error:
            problems.append((WELL_FORMED.id, str(error), False))
        else:
            compared = relation(track.number, known.sequence_number)
            if compared in ("equal", "zero") and not self._strict and _came_twice(track, metadata, payload):
                self.redelivered += 1
                return ()
            self._echoes += compared == "equal" and key == track.payload
            echo = compared in ("equal", "zero") and self._map is not None and key == track.payload
            problems += () if echo else _misnumbered(compared, known.sequence_number, track.number)
            track.number, track.timestamp = known.sequence_number, metadata.get("timestamp")
        track.given = payload
        verdict = self._judge(payload, key) if isinstance(payload, dict) else _verdict(lambda: self._value(payload))
        problems += self._new_faults(verdict, track.verdict)
        track.payload, track.verdict = key, verdict
        return tuple(Problem(self.messages, robot, rule, says, flagged) for rule, says, flagged in problems)

    def _new_faults(self, verdict: Verdict, before: Verdict | None) -> Iterator[tuple[str, str, bool]]:
        lasted = {fault.rule for fault in before or ()}
        for fault in verdict:
            if fault.lasts and fault.rule not in lasted:
                continue
            flagged = fault.rule == reserved_reasons_are_not_used.rule.id
            if fault.rule == a_stuck_state_is_known.rule.id:
                # AS-18: it is tolerated while nothing is known of the robot.
                flagged = before is None or fault.rule in lasted
            yield fault.rule, fault.says + (", for the second time" if fault.lasts else ""), flagged

    def _careful(self, message: JSON) -> tuple[Problem, ...]:
        """A message of an unusual form: other names, something missing, or something else altogether."""
        try:
            return self._unusual(message)
        except MalformedError as error:
            return (Problem(self.messages, "", WELL_FORMED.id, str(error)),)

    def _unusual(self, message: JSON) -> tuple[Problem, ...]:
        if not isinstance(message, dict):
            raise MalformedError(f"{brief(message)} is not an object")
        if self._map is not None:
            entries = _either(message, self._map)
            if entries is not None and not isinstance(entries, dict):
                raise MalformedError(f"{brief(entries)} is not an object", self._map)
            found: tuple[Problem, ...] = ()
            for robot, entry in (entries or {}).items():
                if not isinstance(entry, dict):
                    raise MalformedError(f"{brief(entry)} is not an object", f"{self._map}.{robot}")
                rest = {name: value for name, value in entry.items() if name != "metadata"}
                found += self._slowly(robot, entry.get("metadata"), rest)
            return found
        robot, payload = _either(message, "robotId"), _either(message, self._field)
        if not isinstance(robot, str) or not robot:
            raise MalformedError(f"{brief(robot)} is not the id of a robot", "robotId")
        return self._slowly(robot, message.get("metadata"), {} if payload is None else payload)


def _misnumbered(compared: str, number: int, before: int | None) -> Iterator[tuple[str, str, bool]]:
    """What is wrong with a number that compares so with the one before."""
    wrong = sequence(compared)
    if isinstance(wrong, Mismatch):
        yield wrong.rule, f"{wrong.says} ({number} after {before})", False


def _came_twice(track: _Track, metadata: JSON, payload: JSON) -> bool:
    """Whether a message with a robot's last number is that message again, rather than another one."""
    given = track.given
    if track.number is None or track.timestamp != metadata.get("timestamp"):
        return False
    if isinstance(given, dict):
        given = {name: value for name, value in given.items() if name != "metadata"}  # an entry of a map has its own
    return bool(given == payload and track.number == metadata_of(metadata).sequence_number)


def watch(
    endpoint: Endpoint | str, messages: Iterable[JSON], robots: Collection[str] | None = None
) -> Iterator[Problem]:
    """All that is wrong with the messages of a stream, as they come."""
    monitor = StreamMonitor(endpoint, robots)
    for message in messages:
        yield from monitor.feed(message)


def _verdict(value: Callable[[], Value]) -> Verdict:
    """What is wrong with a value, once it has been read."""
    try:
        return faults(value())
    except MalformedError as error:
        return (Fault(WELL_FORMED.id, str(error)),)


def _either(message: Mapping[str, JSON], name: str) -> JSON:
    """A field by its name in lowerCamelCase or in snake_case."""
    if name in message:
        return message[name]
    return message.get("".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name))


def _may_stand_alone(payload: JSON) -> bool:
    """Whether the parts of a state can be judged one by one: pose and velocity are numbers, and no rule joins parts."""
    twist = payload.get("twist")
    if twist is not None:
        if not _are_numbers(twist, _TWIST):
            return False
        if twist.get("linearVelocity") and not _is_free(payload.get("navigationState")):
            return False
    pose = payload.get("pose")
    if pose is not None and not _are_numbers(pose, _POSE):
        return False
    return payload.keys() <= _KNOWN and ("serviState" not in payload or "cartiState" not in payload)


def _is_free(navigation: JSON) -> bool:
    if navigation is None:
        return True
    stuck = navigation.get("stuckState") if type(navigation) is dict else None
    return type(stuck) is dict and stuck.get("state") == "STATE_NOT_STUCK"


def _are_numbers(value: JSON, names: frozenset[str]) -> bool:
    if type(value) is not dict or not value.keys() <= names:
        return False
    return all(type(one) is float or type(one) is int for one in value.values())
