"""Logs that begin while a system is in use, and systems that others use as well.

Of such a system nothing is known until a message shows its state; later somebody whose calls are not in the log may
have brought it somewhere else. `in_the_middle` makes of a system one that may be in a state of which nothing is known.
What others did is an ambiguity of its own, read as "yes" only where nothing else explains an event, and flagged.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Hashable

from attrs import evolve

from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.spec import Drive, Spec
from missionfsm.kernel.step import ONCE_HAD, Emission, Match, Mismatch, Opening, Step
from missionfsm.kernel.terms import Content, View
from missionfsm.kernel.values import value

LOG_01 = Ambiguity(
    "LOG-01",
    "Did something from before the log, or on its way when it began, take effect?",
    {"a": "no", "b": "yes, what no line of the log brought about"},
    default="a",
    flagged=frozenset("b"),
)
LOG_02 = Ambiguity(
    "LOG-02",
    "Did somebody act whose calls are not in the log?",
    {"a": "no", "b": "yes, another client or somebody at the touchscreen"},
    default="a",
    flagged=frozenset("b"),
)
MIDDLE = (LOG_01, LOG_02)
"""Both, in the order of their numbers."""


@value(cache_hash=True)
class Unknown:
    """A state of which nothing is known but the world."""

    world: Hashable

    def __str__(self) -> str:
        return "a state of which nothing is known yet"


@value(cache_hash=True)
class AnyView:
    """The view of a message that may show anything."""


ANY = AnyView()


def in_the_middle(spec: Spec, *, anywhere: bool, others: bool) -> Spec:
    """The same system in a log that has not all there was.

    Args:
        anywhere: whether the log begins while the system is in use.
        others: whether others use it as well.
    """
    middle, decided, rebuilt = spec.middle, spec.decided, spec.rebuilt
    foresees, succeeds = spec.foresees, spec.succeeds
    if middle is None or not (anywhere or others):
        return spec
    if middle.glimpses is None:
        return evolve(spec, anywhere=anywhere)

    def matches(view: View, content: Content) -> tuple[Match, ...] | Mismatch:
        if view is ANY:
            return Mismatch("", content.says) if isinstance(content, Malformed) else (Match(),)
        return spec.matches(view, content)

    return evolve(
        spec,
        anywhere=anywhere,
        others=others,
        ambiguities=(*spec.ambiguities, *((LOG_01,) if anywhere else ()), *((LOG_02,) if others else ())),
        initial=Unknown if anywhere else spec.initial,
        outcomes=lambda state, request, refs: (
            _imaginable(spec, state, request, len(refs))
            if isinstance(state, Unknown)
            else spec.outcomes(state, request, refs)
        ),
        drives={name: _known_only(drive) for name, drive in spec.drives.items()},
        urgent=lambda state: () if isinstance(state, Unknown) else spec.urgent(state),
        spontaneous=lambda state: () if isinstance(state, Unknown) else spec.spontaneous(state),
        matches=matches,
        looks=lambda view, content: None if view is ANY else spec.looks(view, content),
        names=lambda state: 0 if isinstance(state, Unknown) else spec.names(state),
        describe=lambda one: str(one) if isinstance(one, Unknown) else "anything" if one is ANY else spec.describe(one),
        foresees=foresees and (lambda state, *more: isinstance(state, Unknown) or foresees(state, *more)),
        succeeds=succeeds and (lambda state, *more: isinstance(state, Unknown) or succeeds(state, *more)),
        decided=decided and (lambda assumed: in_the_middle(decided(assumed), anywhere=anywhere, others=others)),
        rebuilt=rebuilt and (lambda operations: in_the_middle(rebuilt(operations), anywhere=anywhere, others=others)),
        restarted=spec.restarted
        and (
            lambda state: spec.restarted(spec.initial(state.world) if isinstance(state, Unknown) else state)  # type: ignore[misc]
        ),
    )


def _known_only(drive: Drive) -> Drive:
    """The same drive, of which nobody can tell what it does to a state of which nothing is known."""
    return evolve(
        drive,
        steps=lambda state, event, refs: (
            (Step(state),) if isinstance(state, Unknown) else drive.steps(state, event, refs)
        ),
    )


@functools.lru_cache(maxsize=1_000)
def _answers(spec: Spec, world: Hashable, request: Hashable, names: int) -> tuple[Step, ...]:
    """Every answer that some state allows, without its names."""
    found: dict[Hashable, Step] = {}
    glimpses = spec.middle and spec.middle.glimpses
    assert glimpses, "asked only of systems that can be judged so"  # noqa: S101
    for state in glimpses.samples(world):
        places = (None, *((ONCE_HAD,) if spec.recalls else ()), *range(spec.names(state)))
        for refs in itertools.product(places, repeat=names):
            for step in spec.outcomes(state, request, refs):
                if step.answer is not None:
                    found.setdefault((step.answer, step.assumes, tuple(one.topic for one in step.opens)), step)
    return tuple(found.values())


def _imaginable(spec: Spec, state: Unknown, request: Hashable, names: int) -> tuple[Step, ...]:
    """Every answer that some state allows, after which as little is known as before."""
    return tuple(
        Step(
            state,
            answer=step.answer,
            rules=step.rules,
            assumes=step.assumes,
            opens=tuple(
                Opening(one.topic, at, (Emission(ANY, (), optional=True),)) for at, one in enumerate(step.opens)
            ),
            refs=tuple(range(len(step.opens))),
        )
        for step in _answers(spec, state.world, request, names)
    )


__all__ = ["ANY", "LOG_01", "LOG_02", "MIDDLE", "Unknown", "in_the_middle"]
