"""How the JSON of a system's wire becomes what the oracle sees, and back."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from typing import Any, cast

from attrs import AttrsInstance, asdict, evolve, field, frozen, has

from missionfsm.kernel.history import Answer, Mark, Name
from missionfsm.kernel.rules import OK
from missionfsm.kernel.terms import Incident, Request, View, World
from missionfsm.kernel.text import brief

JSON = Any
"""What a JSON text stands for: dicts, lists, texts, numbers, booleans and None."""


class UnreadableError(ValueError):
    """Something that was to be read is not what it should be; the message says what is wrong and where."""


@frozen(cache_hash=True)
class Malformed:
    """What an implementation sent in the place of a documented result or message; nothing explains it."""

    says: str

    def __str__(self) -> str:
        return f"(malformed: {self.says})"


Part = tuple[tuple[Name, ...], tuple[Mark, ...], JSON]
"""A part of a message: its names, its marks, and the rest."""


Skimmed = tuple[list[bytes], tuple[Mark, ...], bytes]
"""The names of a message, its marks, and the text that is left of it."""


@frozen(cache_hash=True)
class Happening:
    """Something that happens of which there is nothing to say but the name of its drive."""

    name: str

    def __str__(self) -> str:
        return self.name


STREAM = "stream"
"""The key of the number in the answer of a call that opens a stream."""

NAMED = "-"
"""What stands in the place of a name in what is left of a message, and in values whose names stand beside them."""


def apart(value: JSON, keys: tuple[str, ...]) -> tuple[tuple[Name, ...], JSON]:
    """The names in a JSON value (the texts under some keys, which are their kinds), and what is left of it."""
    if isinstance(value, list):
        parts = [apart(one, keys) for one in value]
        return tuple(name for names, _ in parts for name in names), [rest for _, rest in parts]
    if not isinstance(value, dict):
        return (), value
    names: list[Name] = []
    rest = {}
    for key, one in value.items():
        found, rest[key] = (((key, one),), NAMED) if key in keys and isinstance(one, str) else apart(one, keys)
        names += found
    return tuple(names), rest


def together(rest: JSON, keys: tuple[str, ...], names: Iterator[Name]) -> JSON:
    """What `apart` took apart."""
    if isinstance(rest, list | tuple):
        return [together(one, keys, names) for one in rest]
    if not isinstance(rest, dict):
        return rest
    return {
        key: _value(next(names)) if key in keys and one == NAMED else together(one, keys, names)
        for key, one in rest.items()
    }


def _value(name: Name) -> JSON:
    return name[1] if isinstance(name, tuple) else name


def plainly(value: object) -> JSON:
    """A value as JSON: one of an attrs class as an object with its attributes, any other as it is."""
    return asdict(cast(AttrsInstance, value)) if has(type(value)) else value


@frozen
class DriveForm:
    """The JSON of a drive that says more than its name.

    Attributes:
        read: what a tester or the author of a log wrote to the event and its names. Raises UnreadableError.
        write: (event, names) to its members besides ``event``.
        members: JSON Schemas of those members.
        needed: those that may not be missing.
    """

    read: Callable[[JSON], tuple[Incident, tuple[Name, ...]]]
    write: Callable[[Incident, tuple[Name, ...]], dict[str, JSON]] = lambda _event, _names: {}
    members: Mapping[str, JSON] = field(factory=dict)
    needed: tuple[str, ...] = ()


@frozen
class Codec:
    """The JSON of one system.

    Whatever an implementation sends has a meaning: a result or a message that is not of the documented form becomes
    `Malformed`. What a tester or the author of a log writes (worlds, drives, methods) is refused: `UnreadableError`.
    All have a default: nothing to choose, to name, to say or to show; a request is its method, an event its name.

    Attributes:
        methods: the documented calls; those of the specification, where none are given, as with the next two.
        streams: those among them that open a stream.
        events: drives that are `Happening` each, with nothing to say but the name, unless `drives` has them.
        drives: the others, each with its JSON.
        names: keys whose texts are names, wherever they stand in params and messages; the key is the kind.
        answers: method to the key of the one name that it answers with; one that is not here answers with nothing, or
            with the number of its stream.
        read_world: the parameters of `reset` to the world, defaults filled in.
        split_request: (method, params) to the names in a request and what is left of it, which is JSON again.
        read_request: (method, what is left of the params) to the request.
        read_answer: (method, result) to the answer and its names.
        split_message: a message to its parts, each with its names, its marks and what is left of it, which is JSON
            again. Most messages are one part; one about several robots has a part for each.
        read_content: what is left of a part to its content.
        read_drive: a drive's JSON to the event and its names, in the place of `drives`.
        write_request: (request, names) to params.
        write_answer: (method, answer, names) to a result.
        write_message: (view, names, choice, number, seconds) to a message: the sequence number is `number`, the
            timestamp so many seconds after the epoch. None where the channel ends, which no message shows.
        write_world: a world to the parameters of `reset`.
        write_drive_result: (event, names) to what the result of a drive says besides that it happened.
        read_drive_result: the JSON of a drive that happened, with what its result says, to the event and its names,
            among them those that only the environment could give.
        measured: fields of a drive that its result may give anew: in real time never exactly as much passes as was
            wanted.
        carries: (method, params) to whether binary protobuf can carry such a request: no two members of a oneof, no
            unknown names, no wrong types.
        skim: the text of a message that is one part, as nearly all are written, to what `split_message` finds; None for
            any other text. Two texts of which the same is left have the same content.
        robot_in_params: whether the system is about one robot, so that params that name a robot only say which.
    """

    _methods: tuple[str, ...] | None = None
    streams: tuple[str, ...] = ()
    events: tuple[str, ...] = ()
    drives: Mapping[str, DriveForm] = field(factory=dict)
    names: tuple[str, ...] = ()
    answers: Mapping[str, str] = field(factory=dict)
    read_world: Callable[[JSON], World] = lambda _given: None
    _split_request: Callable[[str, JSON], tuple[tuple[Name, ...], JSON]] | None = None
    _read_request: Callable[[str, JSON], Request] | None = None
    _read_answer: Callable[[str, JSON], tuple[Answer, tuple[Name, ...]]] | None = None
    _split_message: Callable[[JSON], tuple[Part, ...]] | None = None
    read_content: Callable[[JSON], Hashable] = str
    _read_drive: Callable[[JSON], tuple[Incident, tuple[Name, ...]]] | None = None
    write_request: Callable[[Request, tuple[Name, ...]], JSON] = lambda _request, _names: {}
    _write_answer: Callable[[str, Answer, tuple[Name, ...]], JSON] | None = None
    _write_message: Callable[[View, tuple[Name, ...], int, int, float], JSON] | None = None
    write_world: Callable[[World], JSON] = lambda _world: {}
    write_drive_result: Callable[[Incident, tuple[Name, ...]], dict[str, JSON]] = lambda _event, _names: {}
    _read_drive_result: Callable[[JSON], tuple[Incident, tuple[Name, ...]]] | None = None
    measured: tuple[str, ...] = ()
    skim: Callable[[bytes], Skimmed | None] = lambda _text: None
    robot_in_params: bool = False
    carries: Callable[[str, JSON], bool] = lambda _method, _params: True

    @property
    def methods(self) -> tuple[str, ...]:
        """The documented calls."""
        return self._methods or ()

    def completed(self, methods: tuple[str, ...], streams: tuple[str, ...], events: tuple[str, ...]) -> Codec:
        """This codec with the calls and drives of a specification, where it names no calls itself."""
        if self._methods is not None:
            return self
        return evolve(self, methods=methods, streams=self.streams or streams, events=self.events or events)

    def split_request(self, method: str, params: JSON) -> tuple[tuple[Name, ...], JSON]:
        """The names in a request, by default those under the keys of names, and what is left of it."""
        return apart(params, self.names) if self._split_request is None else self._split_request(method, params)

    def read_request(self, method: str, params: JSON) -> Request:
        """The request, by default its method alone. Raises UnreadableError for a method that is none."""
        if self._read_request is not None:
            return self._read_request(method, params)
        if method in self.methods:
            return method
        there_are = f"those are {', '.join(self.methods)}" if self.methods else "there are none"
        raise UnreadableError(f"{brief(method)} is not a method; {there_are}")

    def read_answer(self, method: str, result: JSON) -> tuple[Answer, tuple[Name, ...]]:
        """The answer and its names, by default the one name that there is, or nothing."""
        if self._read_answer is not None:
            return self._read_answer(method, result)
        key = self._answered(method)
        if key is None:
            return Answer(OK, Malformed("there is nothing that it answers with") if result else None), ()
        name = result.get(key) if isinstance(result, dict) else None
        if isinstance(name, bool) or not isinstance(name, int if key == STREAM else str):
            return Answer(OK, Malformed(f"it answers with no {key}")), ()
        return Answer(OK), ((key, name),)

    def _answered(self, method: str) -> str | None:
        return STREAM if method in self.streams else self.answers.get(method)

    def split_message(self, message: JSON) -> tuple[Part, ...]:
        """The parts of a message, by default one without marks."""
        if self._split_message is not None:
            return self._split_message(message)
        names, rest = apart(message, self.names)
        return ((names, (), rest),)

    def read_drive(self, given: JSON) -> tuple[Incident, tuple[Name, ...]]:
        """The event of a drive and its names, by default what has a name only. Raises UnreadableError."""
        if self._read_drive is not None:
            return self._read_drive(given)
        event = given.get("event") if isinstance(given, dict) else None
        if not isinstance(event, str):
            raise UnreadableError(f"drive: {brief(given)} names no event")
        if event in self.drives:
            return self.drives[event].read(given)
        if event in self.events:
            return Happening(event), ()
        there_are = ", ".join(dict.fromkeys((*self.drives, *self.events)))
        raise UnreadableError(f"drive.event: {brief(event)} is not a drive; those are {there_are}")

    def write_drive(self, event: Incident, names: tuple[Name, ...] = ()) -> JSON:
        """The JSON of an event."""
        form = self.drives.get(event.name)
        return {"event": event.name, **(form.write(event, names) if form else {})}

    @property
    def drive_members(self) -> dict[str, tuple[Mapping[str, JSON], tuple[str, ...]]]:
        """What the JSON of each drive has besides its name, and what of that it needs; none where that is not said."""
        if self._read_drive is not None:
            return {}
        plain: dict[str, tuple[Mapping[str, JSON], tuple[str, ...]]] = {one: ({}, ()) for one in self.events}
        return {**plain, **{name: (one.members, one.needed) for name, one in self.drives.items()}}

    def read_drive_result(self, given: JSON) -> tuple[Incident, tuple[Name, ...]]:
        """The event of a drive that happened and its names, by default as they were asked for."""
        return self.read_drive(given) if self._read_drive_result is None else self._read_drive_result(given)

    def write_answer(self, method: str, answer: Answer, names: tuple[Name, ...]) -> JSON:
        """The result of a call that succeeded, by default the one name that it answers with."""
        if self._write_answer is not None:
            return self._write_answer(method, answer, names)
        key = self._answered(method)
        return {} if key is None else {key: _value(names[0])}

    def write_message(self, view: View, names: tuple[Name, ...], choice: int, number: int, seconds: float) -> JSON:
        """The message that shows a view, by default with its attributes, and its names under their keys."""
        if self._write_message is not None:
            return self._write_message(view, names, choice, number, seconds)
        return together(plainly(view), self.names, iter(names))
