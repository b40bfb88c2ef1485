"""Which rules a tester can miss for want of drives.

A refusal, as the robot may by itself have left the state that refuses; another rule, as only a drive leads to where it
matters, or as what the drive would make happen may come about by itself or not.
"""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterable, Iterator
from typing import Any

from attrs import frozen

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.readings import choose, meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.step import Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Refs, Request, State
from missionfsm.tools.explore.explore import Actions, bindings

BOUNDS, NEAR = Bounds(2, goals=2, batch=2), Bounds(1, goals=2, batch=1)
"""Within what refusals are looked for, and other rules."""
SITUATIONS, MORE_SITUATIONS = 12, 100
"""How many different situations are looked at for them, the nearest to the start."""
NOTHING_NEW = 10
"""After how many situations in a row that show no other rule no more are looked at."""
MAX_UNSEEN = 200
"""How many states the system may come to unseen from each of them, at most."""


@frozen
class Missed:
    """Ids of the rules that are not put to the test: of refusals, and of the other rules."""

    refusals: tuple[str, ...] = ()
    promises: tuple[str, ...] = ()


def missed_without(system: System, missing: frozenset[str]) -> Missed:
    """What can always be missed where nobody commands some drives.

    A refusal is put to the test by a call in a state whose every silent continuation refuses it. What a drive does that
    nobody commands may happen by itself, and so there may be no such state any more. Another rule is put to the test by
    a step that rests on it and that a call, a drive that is commanded, or an earlier such step brings about. Both are
    looked for in the usual world, for an implementation that reads the document as the reference does by default,
    within small bounds.

    Args:
        missing: names of the drives that nobody commands.
    """
    return _missed(system, frozenset(name for name in missing if name in system.spec.drives))


@functools.lru_cache(maxsize=16)
def _missed(system: System, missing: frozenset[str]) -> Missed:
    spec = system.spec
    if not missing:
        return Missed()
    refusals = {rule.id for operation in spec.operations.values() for rule in operation.refusals}
    missed, near = set[str](), _Look(system, NEAR)
    if any(spec.drives[name].by_itself for name in missing) and refusals:
        look = _Look(system, BOUNDS)
        tested = look.tested(())
        missed = tested - look.tested(missing, tested)
    promises = near.rested_on(()) - near.rested_on(missing) - refusals
    return Missed(
        tuple(rule.id for rule in spec.all_rules if rule.id in missed),
        tuple(rule.id for rule in spec.all_rules if rule.id in promises),
    )


class _Look:
    """The situations near the start, and how calls are answered there."""

    def __init__(self, system: System, bounds: Bounds) -> None:
        self._bounds = bounds
        self._assumed = choose(system.spec.ambiguities)
        self.spec = system.spec.decided(self._assumed) if system.spec.decided else system.spec
        usual = system.alphabet({}, bounds).worlds[0]
        alphabet = system.alphabet(usual, bounds)
        self._actions = Actions.from_alphabet(system, alphabet.core_inputs, alphabet.core_drives)
        self._start = self.spec.initial(system.codec.read_world(usual))
        self._succeeds: dict[Any, bool] = {}
        self._answers: dict[Any, tuple[Step, ...]] = {}

    def _possible(self, steps: Iterable[Step]) -> Iterator[Step]:
        return (step for step in steps if meet(self._assumed, step.assumes))

    def _outcomes(self, here: State, request: Request, refs: Refs) -> tuple[Step, ...]:
        """Every answer to a call; remembered, since the nearest situations are walked again and again."""
        key = (here, request, refs)
        found = self._answers.get(key)
        if found is None:
            found = self._answers[key] = tuple(self._possible(self.spec.outcomes(*key)))
        return found

    def _situations(self, most: int, missing: Collection[str] = ()) -> Iterator[State]:
        """One state of each, the nearest first, that is reached without some drives."""
        spec, known = self.spec, set[Any]()
        found, todo = {self._start}, [self._start]
        for here in todo:  # grows while it is walked
            key = spec.abstraction.enabled_key(here)
            if key in known:
                continue
            if len(known) >= most:
                return
            known.add(key)
            yield here
            for step in self._possible(self._onward(here, missing)):
                if step.after not in found and spec.search_size(step.after) <= self._bounds.size:
                    found.add(step.after)
                    todo.append(step.after)

    def _onward(self, here: State, missing: Collection[str]) -> Iterator[Step]:
        spec = self.spec
        for request, free in self._actions.requests:
            for refs in bindings(spec, here, free):
                yield from self._outcomes(here, request, refs)
        for event, free in self._actions.events:
            if event.name in missing:
                continue
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
                if step.after not in found and len(found) < MAX_UNSEEN:
                    found.add(step.after)
                    todo.append(step.after)
        return todo

    def tested(self, missing: Collection[str], all_there_are: Collection[str] = ()) -> set[str]:
        """The ids of the refusals that a call puts to the test somewhere, whatever happened unseen before it."""
        tested = set[str]()
        for here in self._situations(SITUATIONS):
            if all_there_are and tested.issuperset(all_there_are):
                break
            became = self._unseen(here, sorted(missing))
            for request, free in self._actions.requests:
                for refs in bindings(self.spec, here, free):
                    steps = self._outcomes(here, request, refs)
                    rules = {rule for step in steps if step.answer and step.answer.code != OK for rule in step.rules}
                    if not rules <= tested and not any(self._can_succeed(one, request, refs) for one in became):
                        tested |= rules
        return tested

    def rested_on(self, missing: Collection[str]) -> set[str]:
        """The ids of the rules that some step rests on which comes about without these drives."""
        found, idle = set[str](), 0
        for here in self._situations(MORE_SITUATIONS, missing):
            rules = {rule for step in self._possible(self._onward(here, missing)) for rule in step.rules}
            idle = idle + 1 if rules <= found else 0
            found |= rules
            if idle == NOTHING_NEW:
                break
        return found

    def _can_succeed(self, state: State, request: Request, refs: Refs) -> bool:
        key = (state, request, refs)
        if key not in self._succeeds:
            steps = self._outcomes(*key)
            self._succeeds[key] = any(step.answer is not None and step.answer.code == OK for step in steps)
        return self._succeeds[key]


__all__ = ["Missed", "missed_without"]
