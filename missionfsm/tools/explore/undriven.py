"""Which refusals a tester can miss for want of drives: the robot may by itself have left the state that refuses."""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterable, Iterator
from typing import Any

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.readings import choose, meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.step import Step
from missionfsm.kernel.system import System
from missionfsm.tools.explore.explore import Labels, bindings

BOUNDS = Bounds(2, goals=2, batch=2)
SITUATIONS = 12
"""How many different situations are looked at, the nearest to the start."""
MOST_UNSEEN = 200
"""How many states the system may come to unseen from each of them, at most."""

State = Any


def missed_without(system: System, missing: frozenset[str]) -> tuple[str, ...]:
    """The ids of the refusals that can always be missed where nobody commands some drives.

    A refusal is put to the test by a call in a state whose every silent continuation refuses it. What a drive does that
    nobody commands may happen by itself, and so there may be no such state any more. It is looked for in the usual
    world, for an implementation that reads the document as the reference does by default, within small bounds.

    Args:
        missing: names of the drives that nobody commands.
    """
    spec = system.spec
    if not any(spec.drives[name].by_itself for name in missing if name in spec.drives):
        return ()
    return _missed(system, missing)


@functools.lru_cache(maxsize=16)
def _missed(system: System, missing: frozenset[str]) -> tuple[str, ...]:
    look = _Look(system)
    with_all, without = look.tested(()), look.tested(missing)
    return tuple(rule.id for rule in system.spec.all_rules if rule.id in with_all and rule.id not in without)


class _Look:
    """The situations near the start, and how calls are answered there."""

    def __init__(self, system: System) -> None:
        self.spec = system.spec
        self._assumed = choose(self.spec.ambiguities)
        usual = system.alphabet({}, BOUNDS).worlds[0]
        alphabet = system.alphabet(usual, BOUNDS)
        self._labels = Labels.of(system, alphabet.core_inputs, alphabet.core_drives)
        self._found = tuple(self._situations(self.spec.initial(system.codec.world(usual))))
        self._succeeds: dict[Any, bool] = {}

    def _possible(self, steps: Iterable[Step]) -> Iterator[Step]:
        return (step for step in steps if meet(self._assumed, step.assumes))

    def _situations(self, start: State) -> Iterator[State]:
        """One state of each."""
        spec, known = self.spec, set[Any]()
        found, todo = {start}, [start]
        for here in todo:  # grows while it is walked
            situation = spec.abstraction.situation(here)
            if situation in known:
                continue
            if len(known) >= SITUATIONS:
                return
            known.add(situation)
            yield here
            for step in self._possible(self._onward(here)):
                if step.after not in found and spec.size(step.after) <= BOUNDS.size:
                    found.add(step.after)
                    todo.append(step.after)

    def _onward(self, here: State) -> Iterator[Step]:
        spec = self.spec
        for request, free in self._labels.requests:
            for refs in bindings(spec, here, free):
                yield from spec.outcomes(here, request, refs)
        for event, free in self._labels.events:
            for refs in bindings(spec, here, free):
                yield from spec.drives[event.name].steps(here, event, refs)
        yield from spec.urgent(here)
        yield from spec.spontaneous(here)

    def _unseen(self, state: State, missing: Collection[str]) -> list[State]:
        """The state, and what it can become with nobody doing anything."""
        spec, found, todo = self.spec, {state}, [state]
        for here in todo:  # grows while it is walked
            steps = [*spec.urgent(here), *spec.spontaneous(here)]
            for drive in (spec.drives[name] for name in missing if name in spec.drives):
                for event in drive.by_itself:
                    steps += drive.steps(here, event, ())
            for step in self._possible(steps):
                if step.after not in found and len(found) < MOST_UNSEEN:
                    found.add(step.after)
                    todo.append(step.after)
        return todo

    def tested(self, missing: Collection[str]) -> set[str]:
        """The ids of the refusals that a call puts to the test somewhere, whatever happened unseen before it."""
        tested = set[str]()
        for here in self._found:
            became = self._unseen(here, sorted(missing))
            for request, free in self._labels.requests:
                for refs in bindings(self.spec, here, free):
                    steps = self._possible(self.spec.outcomes(here, request, refs))
                    rules = {rule for step in steps if step.answer and step.answer.code != OK for rule in step.rules}
                    if not rules <= tested and not any(self._can_succeed(one, request, refs) for one in became):
                        tested |= rules
        return tested

    def _can_succeed(self, state: State, request: Any, refs: tuple[int | None, ...]) -> bool:  # noqa: ANN401
        key = (state, request, refs)
        if key not in self._succeeds:
            steps = self._possible(self.spec.outcomes(*key))
            self._succeeds[key] = any(step.answer is not None and step.answer.code == OK for step in steps)
        return self._succeeds[key]


__all__ = ["missed_without"]
