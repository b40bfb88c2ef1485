"""How the JSON of a system's wire becomes what the oracle sees, and back."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

from attrs import Factory, field, frozen

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


def _nothing(result: JSON) -> Answer:
    return Answer(OK, Malformed("there is nothing that it answers with") if result else None)


@frozen
class Codec:
    """The JSON of one system.

    Whatever an implementation sends has a meaning: a result or a message that is not of the documented form becomes
    `Malformed`. What a tester or the author of a log writes (worlds, drives, methods) is refused: `UnreadableError`.
    All have a default: nothing to choose, to name, to say or to show; a request is its method, an event its name.

    Attributes:
        methods: the documented calls.
        streams: those among them that open a stream.
        events: drives that are `Happening` each, with nothing to say but the name.
        read_world: the parameters of `reset` to the world, defaults filled in.
        split_request: (method, params) to the names in a request and what is left of it, which is JSON again.
        read_request: (method, what is left of the params) to the request.
        read_answer: (method, result) to the answer and its names.
        split_message: a message to its parts, each with its names, its marks and what is left of it, which is JSON
            again. Most messages are one part; one about several robots has a part for each.
        read_content: what is left of a part to its content.
        read_drive: a drive's JSON to the event and its names.
        write_request: (request, names) to params.
        write_answer: (method, answer, names) to a result.
        write_message: (view, names, choice, number, seconds) to a message: the sequence number is `number`, the
            timestamp so many seconds after the epoch.
        write_world: a world to the parameters of `reset`.
        write_drive: (event, names) to JSON.
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

    methods: tuple[str, ...] = ()
    streams: tuple[str, ...] = ()
    events: tuple[str, ...] = ()
    read_world: Callable[[JSON], World] = lambda _given: None
    split_request: Callable[[str, JSON], tuple[tuple[Name, ...], JSON]] = lambda _method, params: ((), params)
    read_request: Callable[[str, JSON], Request] = field(default=Factory(lambda self: self.named, takes_self=True))
    read_answer: Callable[[str, JSON], tuple[Answer, tuple[Name, ...]]] = lambda _method, result: (_nothing(result), ())
    split_message: Callable[[JSON], tuple[Part, ...]] = lambda message: (((), (), message),)
    read_content: Callable[[JSON], Hashable] = str
    read_drive: Callable[[JSON], tuple[Incident, tuple[Name, ...]]] = field(
        default=Factory(lambda self: self.happened, takes_self=True)
    )
    write_request: Callable[[Request, tuple[Name, ...]], JSON] = lambda _request, _names: {}
    write_answer: Callable[[str, Answer, tuple[Name, ...]], JSON] = lambda _method, _answer, _names: {}
    write_message: Callable[[View, tuple[Name, ...], int, int, float], JSON] = lambda view, *_: view
    write_world: Callable[[World], JSON] = lambda _world: {}
    write_drive: Callable[[Incident, tuple[Name, ...]], JSON] = lambda event, _names: {"event": event.name}
    write_drive_result: Callable[[Incident, tuple[Name, ...]], dict[str, JSON]] = lambda _event, _names: {}
    read_drive_result: Callable[[JSON], tuple[Incident, tuple[Name, ...]]] = field(
        default=Factory(lambda self: self.read_drive, takes_self=True)
    )
    measured: tuple[str, ...] = ()
    skim: Callable[[bytes], Skimmed | None] = lambda _text: None
    robot_in_params: bool = False
    carries: Callable[[str, JSON], bool] = lambda _method, _params: True

    def named(self, method: str, _params: JSON) -> str:
        """A request of which there is nothing to say but its method. Raises UnreadableError for one that is none."""
        if method in self.methods:
            return method
        there_are = f"those are {', '.join(self.methods)}" if self.methods else "there are none"
        raise UnreadableError(f"{brief(method)} is not a method; {there_are}")

    def happened(self, given: JSON) -> tuple[Happening, tuple[()]]:
        """A drive of which there is nothing to say but its name. Raises UnreadableError for what is none of them."""
        event = given.get("event") if isinstance(given, dict) else None
        if event in self.events:
            return Happening(event), ()
        raise UnreadableError(f"drive.event: {brief(event)} is not a drive; those are {', '.join(self.events)}")
