"""Logs that begin while a system is in use, and systems that others use as well.

Nothing is known of such a system until a message shows its state. Later, somebody whose calls are not in the log may
bring it into another state. `in_the_middle` turns a system into one whose state may be `Unknown`. Whether others did
something is an ambiguity of its own: "yes" is flagged, and assumed only if nothing else explains an event.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Hashable, Iterator
from typing import Concatenate, ParamSpec, TypeVar

from attrs import evolve

from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.spec import Drive, Glimpses, Spec
from missionfsm.kernel.step import ONCE_HAD, Emission, Match, Mismatch, Opening, Step
from missionfsm.kernel.terms import Content, Refs, Request, State, View
from missionfsm.kernel.values import value

LOG_01 = Ambiguity(
    "LOG-01",
    "Did something from before the log, or on its way when it began, take effect?",
    {"a": "no", "b": "yes, what no line of the log brought about"},
    flagged="b",
)
LOG_02 = Ambiguity(
    "LOG-02",
    "Did somebody act whose calls are not in the log?",
    {"a": "no", "b": "yes, another client or somebody at the touchscreen"},
    flagged="b",
)
MIDDLE = (LOG_01, LOG_02)
"""Both, in the order of their numbers."""


@value(cache_hash=True)
class Unknown:
    """A state of which only the world is known, and what there was once: those things may be gone, but not changed.

    Attributes:
        world: the world that it is in.
        past: the things that there were, in the order in which they became known, and as each message shows them. The
            names of the state are those of the things, in this order.
    """

    world: Hashable
    past: tuple[tuple[Hashable, ...], ...] = ()

    def __str__(self) -> str:
        return "a state of which nothing is known yet"


@value(cache_hash=True)
class AnyView:
    """The view of a message that may show anything."""


ANY = AnyView()

P = ParamSpec("P")
T = TypeVar("T")


def in_the_middle(spec: Spec, *, anywhere: bool, others: bool) -> Spec:
    """The same system, of which a log does not hold everything that happened.

    Args:
        anywhere: whether the log begins while the system is in use.
        others: whether others use it as well.
    """
    middle, decided, rebuilt = spec.middle, spec.decided, spec.rebuilt
    foresees, succeeds, restarted = spec.foresees, spec.succeeds, spec.restarted
    if middle is None or not (anywhere or others):
        return spec
    used = middle.used
    if used:  # its own steps say what it may have been doing
        return evolve(spec, initial=lambda world: used(spec.initial(world))) if anywhere else spec
    if middle.glimpses is None:
        return evolve(spec, anywhere=anywhere, foresees=None)

    def again(other: Spec) -> Spec:
        return in_the_middle(other, anywhere=anywhere, others=others)

    return evolve(
        spec,
        anywhere=anywhere,
        others=others,
        ambiguities=(*spec.ambiguities, *_read(anywhere=anywhere, others=others)),
        initial=Unknown if anywhere else spec.initial,
        outcomes=functools.partial(_outcomes, spec),
        drives={name: _known_only(drive) for name, drive in spec.drives.items()},
        urgent=_of_known(spec.urgent, ()),
        spontaneous=_of_known(spec.spontaneous, ()),
        matches=functools.partial(_matches, spec),
        remembered=functools.partial(_remembered, spec),
        names=functools.partial(_names, spec),
        describe=functools.partial(_describe, spec),
        foresees=foresees and _of_known(foresees, unknown=True),
        succeeds=succeeds and _of_known(succeeds, unknown=True),
        decided=decided and (lambda assumed: again(decided(assumed))),
        rebuilt=rebuilt and (lambda operations: again(rebuilt(operations))),
        restarted=restarted and functools.partial(_restarted, spec),
    )


def _read(*, anywhere: bool, others: bool) -> Iterator[Ambiguity]:
    """The questions that such a log leaves open."""
    if anywhere:
        yield LOG_01
    if others:
        yield LOG_02


def _of_known(function: Callable[Concatenate[State, P], T], unknown: T) -> Callable[Concatenate[State, P], T]:
    """The same function of a state, which gives `unknown` for an unknown state."""

    def asked(state: State, /, *more: P.args, **named: P.kwargs) -> T:
        return unknown if isinstance(state, Unknown) else function(state, *more, **named)

    return asked


def _names(spec: Spec, state: State) -> int:
    return sum(map(len, state.past)) if isinstance(state, Unknown) else spec.names(state)


def _outcomes(spec: Spec, state: State, request: Request, refs: Refs) -> tuple[Step, ...]:
    if isinstance(state, Unknown):
        return _imaginable(spec, state, request, len(refs))
    return spec.outcomes(state, request, refs)


def _matches(spec: Spec, view: View, content: Content) -> tuple[Match, ...] | Mismatch:
    if view is ANY:
        return Mismatch("", content.says) if isinstance(content, Malformed) else (Match(),)
    return spec.matches(view, content)


def _remembered(spec: Spec, view: View, content: Content) -> Hashable:
    return None if view is ANY else spec.remembered(view, content)


def _describe(spec: Spec, what: Request | View | State) -> str:
    return str(what) if isinstance(what, Unknown) else "anything" if what is ANY else spec.describe(what)


def _restarted(spec: Spec, state: State) -> Step:
    """After a restart the state is known, whatever was known before."""
    assert spec.restarted, "asked only of systems that can be restarted"  # noqa: S101
    return spec.restarted(spec.initial(state.world) if isinstance(state, Unknown) else state)


def _known_only(drive: Drive) -> Drive:
    """The same drive, which leaves an unknown state unknown."""
    return evolve(
        drive,
        steps=lambda state, event, refs: (
            (Step(state),) if isinstance(state, Unknown) else drive.steps(state, event, refs)
        ),
    )


@value(cache_hash=True)
class Imagined:
    """An answer that some state allows.

    Attributes:
        step: the step that gives it, without names.
        known: for each name that the answer mentions, whether its thing was there before.
        made: the things that the other names belong to, in their order.
    """

    step: Step
    known: tuple[bool, ...]
    made: tuple[Hashable, ...]


@functools.lru_cache(maxsize=1_000)
def imaginable(spec: Spec, world: Hashable, request: Hashable, names: int) -> tuple[Imagined, ...]:
    """Every answer that some state in a world allows to a request with so many names."""
    found: dict[Hashable, Imagined] = {}
    glimpses = spec.middle and spec.middle.glimpses
    assert glimpses, "asked only of systems that can be judged so"  # noqa: S101
    for state in glimpses.samples(world):
        places = (None, *((ONCE_HAD,) if spec.recalls else ()), *range(spec.names(state)))
        for refs in itertools.product(places, repeat=names):
            for step in spec.outcomes(state, request, refs):
                if step.answer is not None:
                    one = _imagined(spec, glimpses, state, step)
                    topics = tuple(opening.topic for opening in step.opens)
                    found.setdefault((step.answer, step.assumes, topics, one.known, one.made), one)
    return tuple(found.values())


def _imagined(spec: Spec, glimpses: Glimpses, state: State, step: Step) -> Imagined:
    before, after = spec.names(state), spec.names(step.after)
    of = dict(glimpses.things(step.after, step.names or tuple(range(after))))
    opened = {opening.ref for opening in step.opens}
    mentioned = [ref for ref in step.refs if ref not in opened]
    made = tuple(of[ref] for ref in mentioned if ref >= before and ref in of)
    return Imagined(step, tuple(ref < before for ref in mentioned), made)


def _imaginable(spec: Spec, state: Unknown, request: Hashable, names: int) -> tuple[Step, ...]:
    """Every answer that some state allows, after which as little is known as before."""
    first = sum(map(len, state.past))
    steps = dict.fromkeys(
        Step(
            state,
            answer=one.step.answer,
            rules=one.step.rules,
            assumes=one.step.assumes,
            opens=tuple(
                Opening(each.topic, at, (Emission(ANY, (), optional=True),))
                for at, each in enumerate(one.step.opens, first)
            ),
            refs=tuple(range(first, first + len(one.step.opens))),
        )
        for one in imaginable(spec, state.world, request, names)
    )
    return tuple(steps)


__all__ = ["ANY", "LOG_01", "LOG_02", "MIDDLE", "Imagined", "Unknown", "imaginable", "in_the_middle"]
