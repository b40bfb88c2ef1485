"""How the JSON of a system's wire becomes what the oracle sees, and back."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

from attrs import Factory, field, frozen

from missionfsm.kernel.history import Answer, Mark, Name
from missionfsm.kernel.terms import Incident, Request, View, World

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


@frozen
class Codec:
    """The JSON of one system.

    Whatever an implementation sends has a meaning: a result or a message that is not of the documented form becomes
    `Malformed`. What a tester or the author of a log writes (worlds, drives, methods) is refused: `UnreadableError`.

    Attributes:
        methods: the documented calls.
        streams: those among them that open a stream.
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

    methods: tuple[str, ...]
    streams: tuple[str, ...]
    read_world: Callable[[JSON], World]
    split_request: Callable[[str, JSON], tuple[tuple[Name, ...], JSON]]
    read_request: Callable[[str, JSON], Request]
    read_answer: Callable[[str, JSON], tuple[Answer, tuple[Name, ...]]]
    split_message: Callable[[JSON], tuple[Part, ...]]
    read_content: Callable[[JSON], Hashable]
    read_drive: Callable[[JSON], tuple[Incident, tuple[Name, ...]]]
    write_request: Callable[[Request, tuple[Name, ...]], JSON]
    write_answer: Callable[[str, Answer, tuple[Name, ...]], JSON]
    write_message: Callable[[View, tuple[Name, ...], int, int, float], JSON]
    write_world: Callable[[World], JSON]
    write_drive: Callable[[Incident, tuple[Name, ...]], JSON]
    write_drive_result: Callable[[Incident, tuple[Name, ...]], dict[str, JSON]] = lambda _event, _names: {}
    read_drive_result: Callable[[JSON], tuple[Incident, tuple[Name, ...]]] = field(
        default=Factory(lambda self: self.read_drive, takes_self=True)
    )
    measured: tuple[str, ...] = ()
    skim: Callable[[bytes], Skimmed | None] = lambda _text: None
    robot_in_params: bool = False
    carries: Callable[[str, JSON], bool] = lambda _method, _params: True
