"""The history format, version 1: lines of JSON to events, strictly.

A transcript reads one conversation line by line. Whatever its author got wrong is refused with `UnreadableError`,
which says what is wrong; whatever the implementation got wrong becomes an event that nothing explains.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Hashable, Mapping

from attrs import frozen

from missionfsm.kernel.codec import JSON, Codec, Part, UnreadableError
from missionfsm.kernel.history import (
    Answer,
    Called,
    Cancelled,
    Driven,
    Ended,
    Event,
    Mark,
    Name,
    Received,
    Returned,
    Settled,
)
from missionfsm.kernel.ids import IdSet
from missionfsm.kernel.rules import OK, STATUS_NUMBERS
from missionfsm.kernel.terms import Request
from missionfsm.kernel.text import brief
from missionfsm.oracle.memory import ENTRY, MEMORY, TEXT, TEXTS, Room

VERSION = 1
MAX_SILENCED = 1_000
"""How many streams that were given up are remembered."""
_SETTLED: tuple[Event, ...] = (Settled(),)
_ANY_KEYS = ("at", "robot")
_HEAD_KEYS = frozenset(("missionfsm", "system", "world", "drives", "begins", "others", "transport", *_ANY_KEYS))
STRICT, ANYWHERE = "strict", "anywhere"
STREAM_KEYS = ("stream", "message", "closed", "error")
_KEYS: Mapping[str, frozenset[str]] = {
    keys[0]: frozenset((*keys, *_ANY_KEYS))
    for keys in (
        ("call", "method", "params"),
        ("return", "result", "error"),
        STREAM_KEYS,
        ("connection", "line", "closed"),
        ("drive",),
        ("settled",),
    )
}
"""What each kind of line may have; one that has more means something that would be passed over."""

_PARAMS = (dict, str, type(None))
"""What the params of a call may be: an object, or what a proxy writes of bytes that are none, or nothing."""

_Reader = Callable[[dict[str, JSON]], tuple[Event, ...]]


@frozen
class Head:
    """The first line of a history.

    Attributes:
        system: the name of the system.
        world: the parameters of `reset`, as JSON.
        drives: the drives that the tester commanded. Without them the environment may have done everything by itself.
        strict: whether nothing was lost, doubled or made up on the way.
        anywhere: whether it begins while the system is in use; nothing is known of what was before.
        others: whether others, whose calls are not in it, use the system as well.
    """

    system: str
    world: JSON
    drives: tuple[str, ...] = ()
    strict: bool = False
    anywhere: bool = False
    others: bool = False

    @property
    def line(self) -> dict[str, JSON]:
        """The first line that says so."""
        line: dict[str, JSON] = {"missionfsm": VERSION, "system": self.system, "world": self.world}
        if self.drives:
            line["drives"] = list(self.drives)
        if self.anywhere:
            line["begins"] = ANYWHERE
        if self.others:
            line["others"] = True
        if self.strict:
            line["transport"] = STRICT
        return line


def _known_keys(kind: str, line: dict[str, JSON], known: frozenset[str]) -> None:
    if not line.keys() <= known:
        unknown = next(key for key in line if key not in known)
        raise UnreadableError(f"{brief(unknown)} is not known in a {kind} line; it may have {', '.join(sorted(known))}")


def _whole_number(line: dict[str, JSON], key: str) -> int:
    number = line[key]
    if type(number) is not int:  # a bool is none
        raise UnreadableError(f"{key}: {brief(number)} is not a whole number")
    return number


def _must_be_true(line: dict[str, JSON], key: str) -> None:
    if line.get(key) is not True:
        raise UnreadableError(f"{key}: {brief(line.get(key))} is not true")


def head(line: JSON) -> Head:
    """What the first line says. Raises UnreadableError."""
    if not isinstance(line, dict) or "missionfsm" not in line:
        raise UnreadableError('the first line has to be {"missionfsm": 1, "system": …, "world": …}')
    if line["missionfsm"] != VERSION or isinstance(line["missionfsm"], bool):
        raise UnreadableError(f"history format {brief(line['missionfsm'])} is not known; this is version {VERSION}")
    _known_keys("first", line, _HEAD_KEYS)
    name, drives = line.get("system"), line.get("drives", [])
    if not isinstance(name, str):
        raise UnreadableError(f"system: {brief(name)} is not the name of a system")
    if not isinstance(drives, list) or not all(isinstance(one, str) for one in drives):
        raise UnreadableError(f"drives: {brief(drives)} is not a list of names")
    for key, value in (("begins", ANYWHERE), ("transport", STRICT)):
        if key in line and line[key] != value:
            raise UnreadableError(f"{key}: {brief(line[key])} is not known; it is {value!r} or left out")
    others = line.get("others", False)
    if not isinstance(others, bool):
        raise UnreadableError(f"others: {brief(others)} is neither true nor false")
    return Head(name, line.get("world", {}), tuple(drives), "transport" in line, "begins" in line, others)


def answered_with(line: Mapping[str, JSON]) -> str | None:
    """Which of its members an answer is, ``result`` or ``error``; None where it has neither or both.

    One that is null beside the other one is absent.
    """
    result, error = "result" in line, "error" in line
    if result and error:
        result, error = line["result"] is not None, line["error"] is not None
    if result == error:
        return None
    return "error" if error else "result"


class Transcript:
    """Reads the lines of one conversation, after the first.

    Args:
        codec: how the system's JSON is read.
        fingerprint: JSON to something hashable that tells it from other JSON; a fast one makes reading fast.
        lost: ids of calls that are known to have no answer.
        anywhere: whether calls were sent before the first line.

    Attributes:
        answered: the request whose answer was read last.
        early: how many answers came to calls that were sent before the first line.
        silenced: the streams whose `cancel` was answered, the last ones; they show nothing more.
    """

    def __init__(
        self,
        codec: Codec,
        fingerprint: Callable[[JSON], Hashable] = repr,
        lost: frozenset[int] = frozenset(),
        *,
        anywhere: bool = False,
    ) -> None:
        self.codec = codec
        self._fingerprint = fingerprint
        self._lost = lost
        self._anywhere = anywhere
        self._open: dict[int, tuple[str, Request]] = {}
        self._cancels: dict[int, Name] = {}
        self.early = 0
        self.silenced: dict[Name, None] = {}
        self.answered: Request = None
        self._sent = IdSet()
        self._errors: dict[str, Answer] = {}
        self._room = Room(MEMORY // TEXTS)
        self._requests: dict[Hashable, Request] = {}
        self._interned: dict[Hashable, Hashable] = {}
        self._contents: dict[Hashable, Hashable] = {}
        self._forms: dict[tuple[str, ...], _Reader] = {}
        self._latest: dict[Name, dict[tuple[Hashable, ...], JSON]] = {}
        self._shown: dict[Name, dict[Hashable, int]] = {}
        self._kinds: Mapping[str, _Reader] = {
            "call": self._call,
            "return": self._return,
            "stream": self._stream,
            "connection": self._connection,
            "drive": self._drive,
            "settled": self._settled,
        }

    def read(self, line: JSON) -> tuple[Event, ...]:
        """The events that a line stands for; usually one. Raises UnreadableError."""
        if not isinstance(line, dict):
            raise UnreadableError(f"{brief(line)} is not an object")
        form = tuple(line)
        reader = self._forms.get(form)
        return (reader or self._reader(form, line))(line)

    def _reader(self, form: tuple[str, ...], line: dict[str, JSON]) -> _Reader:
        """What reads lines with these keys."""
        for key in form:
            reader = self._kinds.get(key)
            if reader is not None:
                _known_keys(key, line, _KEYS[key])
                self._forms[form] = reader
                return reader
        raise UnreadableError(f"{brief(line)} is none of {', '.join(self._kinds)}")

    @property
    def pending(self) -> Mapping[int, tuple[str, Request]]:
        """The calls that have no answer yet: their ids, in the order of sending, to the method and the request."""
        return self._open

    def _call(self, line: dict[str, JSON]) -> tuple[Event, ...]:
        number, method, params = _whole_number(line, "call"), line.get("method"), line.get("params", {})
        self.begins(number)
        if not isinstance(params, _PARAMS):
            raise UnreadableError(f"params: {brief(params)} is not an object")
        if not isinstance(method, str):
            raise UnreadableError(f"method: {brief(method)} is not the name of a call")
        if method == "cancel":
            stream = params.get("stream") if isinstance(params, dict) else None
            if type(stream) is not int:  # a bool is none
                raise UnreadableError(f"cancel: {brief(params)} names no stream")
            self._open[number] = method, None
            self._cancels[number] = "stream", stream
            return (Cancelled(("stream", stream)),)
        request, names = self._request(method, params)
        return self.sends(number, method, request, names)

    def begins(self, number: int) -> None:
        """A call has this id. Raises UnreadableError if another one had it."""
        if not self._sent.add(number):
            raise UnreadableError(f"call {number} was sent before; ids are unique within a file")

    def sends(
        self,
        number: int,
        method: str,
        request: Request,
        names: tuple[Name, ...],
    ) -> tuple[Event, ...]:
        """The event of a call that has begun and whose params are known."""
        if number in self._lost and method not in self.codec.streams:  # what a stream shows tells that it was opened
            return (Called(("call", number), request, names, lost=True),)
        self._open[number] = method, request
        return (Called(("call", number), request, names),)

    def answers(self, number: int, answer: Answer, names: tuple[Name, ...]) -> tuple[Event, ...]:
        """The event of an answer to a call that is open."""
        _, self.answered = self._open.pop(number)
        return (Returned(("call", number), answer, names),)

    def _request(self, method: str, params: JSON) -> tuple[Request, tuple[Name, ...]]:
        names, rest = self.codec.split_request(method, params)
        key = (method, self._fingerprint(rest))
        request = self._requests.get(key)
        if request is None:
            self._make_room(key[1])
            request = self.codec.read_request(method, rest)
            # One object for one request, however it is written: the oracle then knows it by identity.
            request = self._requests[key] = self._interned.setdefault(request, request)
        return request, names

    def _return(self, line: dict[str, JSON]) -> tuple[Event, ...]:
        number = _whole_number(line, "return")
        waiting = self._open.get(number)
        if waiting is None and self._anywhere and self._sent.add(number):
            self.early += 1
            return ()  # the answer to a call that was sent before the log began
        if waiting is None:
            raise UnreadableError(f"return {number}: no call with this id is waiting for an answer")
        method, _ = waiting
        kind = answered_with(line)
        if kind is None:
            raise UnreadableError(f"return {number}: expected either a result or an error")
        if method == "cancel":
            _, self.answered = self._open.pop(number)
            self._silence(number)
            return ()
        if kind == "error":
            return self.answers(number, self._error(self._status(line["error"])), ())
        return self.answers(number, *self.codec.read_answer(method, line["result"]))

    def _silence(self, number: int) -> None:
        """A `cancel` was answered: its stream shows nothing more."""
        self.silenced[self._cancels.pop(number)] = None
        if len(self.silenced) > MAX_SILENCED:
            del self.silenced[next(iter(self.silenced))]

    def _error(self, status: str) -> Answer:
        """The answer with a status, one object for one status."""
        answer = self._errors.get(status)
        if answer is None:
            answer = self._errors[status] = Answer(status)
        return answer

    def _status(self, error: JSON) -> str:
        status = error.get("status") if isinstance(error, dict) else None
        if not isinstance(status, str) or status not in STATUS_NUMBERS or status == OK:
            named = (name for name, number in STATUS_NUMBERS.items() if number == status and type(status) is int)
            name = next((f" ({name} is)" for name in named if name != OK), "")
            raise UnreadableError(f"error.status: {brief(status)} is not the name of a gRPC error{name}")
        return status

    def _stream(self, line: dict[str, JSON]) -> tuple[Event, ...]:
        stream = ("stream", _whole_number(line, "stream"))
        if "closed" not in line and "error" not in line:
            if "message" not in line:
                raise UnreadableError(f"stream {stream[1]}: expected a message or closed")
            return self._received(stream, line["message"])  # nearly always
        if "message" in line:
            raise UnreadableError(
                f"stream {stream[1]}: expected a message or closed (with an error or without), not both"
            )
        _must_be_true(line, "closed")
        error = line.get("error")
        self._latest.pop(stream, None)
        self._shown.pop(stream, None)
        return (Ended(stream, OK if error is None else self._status(error)),)

    def _received(self, channel: Name, message: JSON) -> tuple[Event, ...]:
        found = []
        parts = self.codec.split_message(message)
        repeats_last = bool(self.codec.streams) and self._comes_again(channel, message, parts)
        numbers = tuple(mark for _, marks, _ in parts for mark in marks)
        stale = bool(self.codec.streams) and self.is_stale(channel, numbers)
        for names, marks, rest in parts:
            key = self._fingerprint(rest)
            content = self._contents.get(key)
            if content is None:
                content = self._content(key, rest)
            found.append(Received(channel, content, names, marks, repeats_last, stale))
        return tuple(found)

    def _make_room(self, key: Hashable) -> None:
        """Count a request or a message that is going to be known again; forget the others where that is too much."""
        if self._room.overflows(ENTRY + TEXT * sys.getsizeof(key)):
            for known in (self._requests, self._interned, self._contents):
                known.clear()

    def _comes_again(self, channel: Name, message: JSON, parts: tuple[Part, ...]) -> bool:
        """Whether a message is the last one of its channel about the same, with the same number and all."""
        tracks = tuple(track for _, marks, _ in parts for track, _ in marks)
        latest = self._latest.setdefault(channel, {})
        repeats_last = bool(tracks) and latest.get(tracks) == message
        latest[tracks] = message
        return repeats_last

    def is_stale(self, channel: Name, numbers: tuple[Mark, ...]) -> bool:
        """Whether every number of a message that comes is the last one that its channel showed on the same track."""
        shown = self._shown.get(channel)
        if shown is None:
            shown = self._shown[channel] = {}
        stale = bool(numbers)
        for track, number in numbers:
            if shown.get(track) != number:
                shown[track], stale = number, False
        return stale

    def drives(self) -> None:
        """Something was driven: numbers may start over then, and what was shown be shown again."""
        self._shown.clear()

    def _content(self, key: Hashable, rest: JSON) -> Hashable:
        self._make_room(key)
        content = self._contents[key] = self.codec.read_content(rest)
        return content

    def _connection(self, line: dict[str, JSON]) -> tuple[Event, ...]:
        connection = ("connection", _whole_number(line, "connection"))
        if ("line" in line) == ("closed" in line):
            raise UnreadableError(f"connection {connection[1]}: expected either a line or closed")
        if "closed" in line:
            _must_be_true(line, "closed")
            return (Ended(connection, OK),)
        return self._received(connection, line["line"])

    def _drive(self, line: dict[str, JSON]) -> tuple[Event, ...]:
        self.drives()
        event, names = self.codec.read_drive_result(line["drive"])
        return (Driven(event, names),)

    def _settled(self, line: dict[str, JSON]) -> tuple[Event, ...]:
        _must_be_true(line, "settled")
        return _SETTLED
