"""Toy specifications that the kernel is tested on: small enough to be searched through without any cleverness."""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable, Mapping
from typing import Any

from attrs import frozen

from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.rules import (
    DEADLINE_EXCEEDED,
    FAILED_PRECONDITION,
    NOT_FOUND,
    OK,
    RESOURCE_EXHAUSTED,
    UNAVAILABLE,
)
from missionfsm.kernel.spec import Delivery, Drive, Spec
from missionfsm.kernel.step import Emission, Match, Mismatch, Opening, Step

Request = tuple[Any, ...]
"""Operation, then its arguments."""

Refs = tuple[int | None, ...]


@frozen
class Event:
    """A drive's event."""

    name: str


def spec(
    system: str,
    initial: Callable[[Any], Hashable],
    outcomes: Callable[[Any, Any, Refs], tuple[Step, ...]],
    *,
    drives: tuple[Drive, ...] = (),
    urgent: Callable[[Any], tuple[Step, ...]] = lambda _: (),
    spontaneous: Callable[[Any], tuple[Step, ...]] = lambda _: (),
    matches: Callable[[Any, Any], tuple[Match, ...] | Mismatch] | None = None,
    delivery: Callable[[Hashable], Delivery] = lambda _: Delivery(stands=True),
    names: Callable[[Any], int] = lambda _: 0,
    ambiguities: tuple[Ambiguity, ...] = (),
    concerns: Callable[[Hashable, Hashable], bool] | None = None,
) -> Spec:
    """A toy; messages match what they equal and numbers on a track rise by default."""

    def equal(view: object, content: object) -> tuple[Match, ...] | Mismatch:
        return (Match(),) if view == content else Mismatch("toy/shown", f"{content} is not {view}")

    def rising(relation: str) -> tuple[Assumption, ...] | Mismatch:
        return () if relation in ("first", "larger", "zero") else Mismatch("toy/rising", relation)

    return Spec(
        system=system,
        title=f"a toy: {system}",
        initial=initial,
        operations={},
        outcomes=outcomes,
        drives={drive.name: drive for drive in drives},
        urgent=urgent,
        matches=matches or equal,
        delivery=delivery,
        sequence=rising,
        names=names,
        request_operation=lambda request: str(request[0]),
        ambiguities=ambiguities,
        spontaneous=spontaneous,
        concerns=concerns or (lambda channel, emission: channel == emission),
    )


def late(state: Hashable) -> Step:
    """A deadline that passed: it may still take effect."""
    return Step(state, answer=Answer(DEADLINE_EXCEEDED), applied=False)


def refused(state: Hashable, code: str, *assumes: Assumption) -> Step:
    """A refusal."""
    return Step(state, answer=Answer(code), assumes=assumes)


# A register: calls that race.


def _register(value: int, request: Request, _: Refs) -> tuple[Step, ...]:
    match request:
        case ("write", new):
            return (Step(value if new == value else new, answer=Answer(OK)), late(value))
        case ("swap", old, new):
            if value == old:
                return (Step(value if new == old else new, answer=Answer(OK, shape=True)), late(value))
            return (Step(value, answer=Answer(OK, shape=False)), late(value))
        case _:
            return (Step(value, answer=Answer(OK, shape=value)),)


REGISTER = spec("register", int, _register)
"""The world is the first value; ``("write", v)``, ``("read",)`` and ``("swap", old, new)``."""


# A ticket queue: names that the server chooses.

BOARD_ORDER = Ambiguity("T-1", "In which order does the board list?", {"a": "oldest first", "b": "newest first"}, "a")
LAST_TICKET = Ambiguity("T-2", "Can the last ticket be dropped?", {"a": "yes", "b": "no"}, "a")
KINDS = ("red", "blue")
FULL = 3

Queue = tuple[str, ...]


@functools.cache
def _queue(kinds: Queue) -> Queue:
    """Every queue is one object, so that nothing seems to change where nothing does."""
    return kinds


def _tickets(queue: Queue, request: Request, refs: Refs) -> tuple[Step, ...]:
    match request:
        case ("take", kind):
            if len(queue) == FULL:
                return (refused(queue, RESOURCE_EXHAUSTED), late(queue))
            after = _queue((*queue, kind))
            everyone = tuple(range(len(after)))
            taken = Step(
                after, names=everyone, emits=(Emission("board", after),), answer=Answer(OK), refs=(len(queue),)
            )
            return (taken, late(queue))
        case ("drop",):
            at = refs[0]
            if at is None:
                return (refused(queue, NOT_FOUND),)
            left = tuple(ref for ref in range(len(queue)) if ref != at)
            after = _queue(tuple(queue[ref] for ref in left))
            last = len(queue) == 1
            dropped = Step(
                after,
                names=left,
                emits=(Emission("board", after),),
                answer=Answer(OK),
                assumes=(LAST_TICKET["a"],) if last else (),
            )
            return (dropped, refused(queue, FAILED_PRECONDITION, LAST_TICKET["b"])) if last else (dropped,)
        case ("peek",):
            at = refs[0]
            return (refused(queue, NOT_FOUND) if at is None else Step(queue, answer=Answer(OK, shape=queue[at])),)
        case ("clear",):
            gone = tuple(range(len(queue)))
            emits = (Emission("board", ()),) if queue else ()
            return (Step(_queue(()), names=(), emits=emits, answer=Answer(OK, unordered=True), refs=gone),)
        case _:
            new = len(queue)
            first = Emission("board", queue, tuple(range(new)))
            return (Step(queue, opens=(Opening("board", new, (first,)),), answer=Answer(OK), refs=(new,)),)


def _serve(queue: Queue, _: Any, __: Refs) -> tuple[Step, ...]:
    if not queue:
        return ()
    after = _queue(queue[1:])
    return (Step(after, names=tuple(range(1, len(queue))), emits=(Emission("board", after),), label="served"),)


def _board(view: Queue, content: Queue) -> tuple[Match, ...] | Mismatch:
    size, found = len(view), []
    if view == content:
        found.append(Match((BOARD_ORDER["a"],) if size > 1 else (), tuple((at, at) for at in range(size))))
    if size > 1 and view == content[::-1]:
        found.append(Match((BOARD_ORDER["b"],), tuple((at, size - 1 - at) for at in range(size))))
    return tuple(found) or Mismatch("toy/board", "other tickets")


def _in_order(view: Queue, content: Queue) -> tuple[Match, ...] | Mismatch:
    if view != content:
        return Mismatch("toy/board", "other tickets")
    return (Match(names=tuple((at, at) for at in range(len(view)))),)


TICKETS = spec(
    "tickets",
    lambda world: _queue(tuple(world)),
    _tickets,
    drives=(Drive("serve", _serve, (Event("serve"),)),),
    matches=_board,
    names=len,
    ambiguities=(BOARD_ORDER, LAST_TICKET),
)
"""``("take", kind)``, ``("drop",)`` and ``("peek",)`` of a ticket, ``("clear",)``, ``("watch",)``; *serve* happens."""

PLAIN_TICKETS = spec(
    "plain tickets",
    lambda world: _queue(tuple(world)),
    _tickets,
    matches=_in_order,
    names=len,
    ambiguities=(LAST_TICKET,),
)
"""The same, but nobody serves and the board lists the oldest first."""


# A lamp: what happens by itself, and streams of every sort.

PRESS = Ambiguity("L-1", "What does a press do while the lamp warms up?", {"a": "off", "b": "refused"}, "a")
SKIP = Ambiguity("L-2", "May a message be skipped?", {"a": "no", "b": "yes"}, "a")
REPEAT = Ambiguity("L-3", "May a message be repeated?", {"a": "no", "b": "yes"}, "a")
WARMING = Ambiguity("L-4", "Is warming up shown?", {"a": "never", "b": "perhaps"}, "a")
TOPICS = ("lamp", "all")


def _light(after: str, *, only: Assumption | None = None) -> Emission:
    return Emission("lamp", after, (), only)


CLICK = Emission("meter", "click", ())


def _pressed(state: str) -> tuple[Step, ...]:
    ok = Answer(OK)
    match state:
        case "off":
            return (Step("warming", emits=(CLICK, _light("warming", only=WARMING["b"])), answer=ok), late(state))
        case "warming":
            back = Step("off", emits=(CLICK, _light("off")), answer=ok, assumes=(PRESS["a"],))
            return (back, refused(state, FAILED_PRECONDITION, PRESS["b"]), late(state))
        case "on":
            return (Step("off", emits=(CLICK, _light("off")), answer=ok), late(state))
        case _:
            return (refused(state, UNAVAILABLE), late(state))


def _lamp(state: str, request: Request, _: Refs) -> tuple[Step, ...]:
    match request:
        case ("press",):
            return _pressed(state)
        case ("look",):
            return (Step(state, answer=Answer(OK, shape=state)),)
        case ("unplug",):
            return (Step("off", closes=("lamp",), answer=Answer(OK)),)
        case _:
            opening = Opening(request[1], 0, (_light(state),))
            return (Step(state, opens=(opening,), answer=Answer(OK), refs=(0,)),)


def _warm(state: str) -> tuple[Step, ...]:
    return (Step("on", emits=(_light("on"),), label="it is warm"),) if state == "warming" else ()


def _blow(state: str, _: Any, __: Refs) -> tuple[Step, ...]:
    return (Step("dead", emits=(_light("dead"),), label="it blows"),) if state == "on" else ()


def _nudge(state: str, _: Any, __: Refs) -> tuple[Step, ...]:
    return (Step("warming", emits=(_light("warming", only=WARMING["b"]),)),) if state == "off" else (Step(state),)


def _flaky(state: str) -> tuple[Step, ...]:
    return (Step("off", emits=(_light("off"),), label="a bad contact"),) if state == "warming" else ()


_DELIVERIES: Mapping[Hashable, Delivery] = {
    "lamp": Delivery(skips=SKIP["b"], repeats=REPEAT["b"], ends={UNAVAILABLE: (), OK: (SKIP["a"],)}, stands=True),
    "all": Delivery(echoes=WARMING["b"], stands=True),
}

LAMP = spec(
    "lamp",
    str,
    _lamp,
    drives=(Drive("blow", _blow, (Event("blow"),)), Drive("nudge", _nudge)),
    urgent=_warm,
    delivery=lambda topic: _DELIVERIES[topic],
    ambiguities=(PRESS, SKIP, REPEAT, WARMING),
    concerns=lambda channel, emission: channel in (emission, "all"),
)
"""``("press",)``, ``("look",)``, ``("unplug",)`` and ``("watch", topic)``; warming up is urgent, *blow* happens."""

FLAKY_LAMP = spec(
    "flaky lamp",
    str,
    _lamp,
    drives=(Drive("nudge", _nudge),),
    urgent=_warm,
    spontaneous=_flaky,
    delivery=lambda topic: _DELIVERIES[topic],
    ambiguities=(PRESS, SKIP, REPEAT, WARMING),
    concerns=lambda channel, emission: channel in (emission, "all"),
)
"""A lamp that may go off again while it warms up: what is urgent need not be what happens."""


# An ambiguous machine: each of its buttons is answered as one reading of one question has it.

QUESTIONS = tuple(
    Ambiguity(f"Q-{number}", f"What does button {number} say?", {"a": "ay", "b": "bee", "c": "see"}, "a")
    for number in range(8)
)


def _buttons(state: int, request: Request, _: Refs) -> tuple[Step, ...]:
    match request:
        case ("button", number):
            question = QUESTIONS[number]
            return tuple(
                Step(state, answer=Answer(OK, shape=letter), assumes=(question[letter],), rules=(f"says-{letter}",))
                for letter in question.readings
            )
        case ("either", number):
            question = QUESTIONS[number]
            return (
                Step(state, answer=Answer(OK, shape="a or b"), assumes=(question["a", "b"],)),
                Step(state, answer=Answer(OK, shape="c"), assumes=(question["c"],)),
            )
        case ("quiet", number):
            question = QUESTIONS[number]
            return tuple(
                Step(state, answer=Answer(OK), assumes=(question[letter],), rules=(f"quiet-{letter}",))
                for letter in question.readings
            )
        case ("jump", number):
            up, question = state + 1, QUESTIONS[number]
            return tuple(Step(up, answer=Answer(OK), assumes=(question[letter],)) for letter in ("a", "b"))
        case ("read",):
            return (Step(state, answer=Answer(OK, shape=state)),)
        case ("reset",):
            return (Step(0 if state else state, answer=Answer(OK)),)
        case _:  # turn: its effect depends on the reading, and is seen by and by
            question = QUESTIONS[request[1]]
            turned = ((state + 1, "a"), (state, "b"), (state, "c"))
            return (
                *(Step(after, answer=Answer(OK), assumes=(question[letter],)) for after, letter in turned),
                refused(state, FAILED_PRECONDITION, question["c"]),
            )


BUTTONS = spec("buttons", int, _buttons, ambiguities=QUESTIONS)
"""``button``, ``either``, ``quiet``, ``turn`` and ``jump``, each with the number of a question; ``read``, ``reset``."""


# A newspaper: several channels under one name, and offers.

SIDES = ("left", "right")
HEADLINES: Mapping[tuple[int, int], tuple[int, int]] = {
    (left, right): (left, right) for left in (0, 1) for right in (0, 1)
}


def _news(state: tuple[int, int], request: Request, _: Refs) -> tuple[Step, ...]:
    match request:
        case ("flip", side):
            after = HEADLINES[(1 - state[0], state[1]) if side == "left" else (state[0], 1 - state[1])]
            shown = Emission(side, (side, after[SIDES.index(side)]), ())
            return (Step(after, emits=(shown,), answer=Answer(OK)),)
        case ("hint",):
            hint = Emission("left", ("left", "hint"), (), optional=True, stays=True)
            return (Step(state, emits=(hint,), answer=Answer(OK)),)
        case _:
            opens = tuple(
                Opening(side, 0, (Emission(side, (side, value), ()),)) for side, value in zip(SIDES, state, strict=True)
            )
            return (Step(state, opens=opens, answer=Answer(OK), refs=(0,)),)


_PAPERS: Mapping[Hashable, Delivery] = {
    "left": Delivery(skips=SKIP["b"], ends={UNAVAILABLE: ()}, stands=True),
    "right": Delivery(repeats=REPEAT["b"], ends={UNAVAILABLE: (SKIP["a"],)}, stands=True),
}
NEWS = spec("news", lambda _: HEADLINES[0, 0], _news, delivery=lambda topic: _PAPERS[topic], ambiguities=(SKIP, REPEAT))
"""``("flip", side)``, ``("hint",)`` and ``("watch",)``, which is about both sides at once."""
