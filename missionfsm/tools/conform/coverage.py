"""Which rules a run exercised less often than it should, and why: computed from the model, not from the run."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import UNCONSTRAINED, choose, meet
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.step import Mismatch, Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import State, View
from missionfsm.tools.check.verdict import PER, RATE
from missionfsm.tools.explore.explore import Actions, bindings
from missionfsm.tools.reference.model import recognised

BOUNDS = Bounds(2, goals=2, batch=2)

SITUATIONS = 12
"""How many different situations of each world are looked at, the nearest ones."""


def rare(
    system: System,
    exercised: Mapping[str, int],
    steps: int,
    readings: Mapping[str, tuple[str, ...]],
    enough: Callable[[], bool] = lambda: False,
) -> dict[str, str]:
    """The rules that were exercised less than `RATE` times in `PER` steps, each with the reason.

    None of them where the time was up before all were counted.

    Args:
        exercised: rule id to how often it was.
        steps: calls and drives of the run.
        readings: ambiguity id to the readings that are followed, as far as any were ruled out.
        enough: whether no more should be done.
    """
    seldom = [rule for rule in system.spec.all_rules if exercised.get(rule.id, 0) * PER < RATE * steps]
    if not seldom:
        return {}
    census = Census(system, readings, enough)
    if enough():
        return {}
    return {rule.id: census.why(rule) for rule in seldom}


class Census:
    """How often each rule comes up in the model, within small bounds, under the readings that are followed.

    Args:
        enough: whether no more should be counted.

    Attributes:
        moves: how many ways to do something there are in all situations together.
        ways: rule id to in how many of them it comes up; `worlds`: in which worlds.
    """

    def __init__(
        self,
        system: System,
        readings: Mapping[str, tuple[str, ...]],
        enough: Callable[[], bool] = lambda: False,
    ) -> None:
        self.system = system
        self._enough = enough
        self.readings = readings
        self.moves = self.situations = 0
        self.ways: Counter[str] = Counter()
        self.worlds: dict[str, set[int]] = {}
        spec = system.spec
        self._assumed = meet(UNCONSTRAINED, (one[readings[one.id]] for one in spec.ambiguities if readings.get(one.id)))
        self._shown: dict[Hashable, tuple[str, ...]] = {}
        self._defaults = choose(spec.ambiguities)
        self._all = system.alphabet({}, BOUNDS).worlds
        for world, params in enumerate(self._all):
            self._look(world, spec.initial(system.codec.read_world(params)), params)

    def why(self, rule: Rule) -> str:
        """Why a rule comes up seldom."""
        followed = self.readings.get(rule.assumes.ambiguity.id) if rule.assumes else None
        if rule.assumes and followed and not set(rule.assumes.letters) & set(followed):
            return f"only under {rule.assumes}, which is not followed"
        ways, under = self.ways[rule.id], f" (it belongs to {rule.assumes})" if rule.assumes else ""
        if not ways:
            return f"no step in {self.situations} situations near the start rests on it{under}"
        worlds = len(self.worlds[rule.id])
        elsewhere = f", and that in {worlds} of {len(self._all)} worlds" if worlds < len(self._all) else ""
        return f"{ways} of {self.moves:,} ways to go on near the start lead to it{elsewhere}{under}"

    def _look(self, world: int, start: State, params: JSON) -> None:
        spec = self.system.spec
        alphabet = self.system.alphabet(params, BOUNDS)
        plain = Actions.from_alphabet(self.system, alphabet.core_inputs, alphabet.core_drives)
        everything = Actions.from_alphabet(self.system, alphabet.inputs, alphabet.drives)
        size = spec.search_size
        keys, found, todo = set[Hashable](), {start}, [start]
        for here in todo:  # grows while it is walked
            key = spec.abstraction.enabled_key(here)
            if key not in keys:
                if len(keys) >= SITUATIONS:
                    return
                keys.add(key)
                self.situations += 1
                for steps in self._moves(here, everything):
                    if self._enough():
                        return
                    self._count(world, steps)
            for step in itertools.chain.from_iterable(self._moves(here, plain)):
                if step.after not in found and size(step.after) <= BOUNDS.size:
                    found.add(step.after)
                    todo.append(step.after)

    def _moves(self, here: State, actions: Actions) -> Iterator[list[Step]]:
        spec = self.system.spec
        for request, free in actions.requests:
            for refs in bindings(spec, here, free):
                yield self._possible(spec.outcomes(here, request, refs))
        for event, free in actions.events:
            for refs in bindings(spec, here, free):
                yield self._possible(tuple(spec.drives[event.name].steps(here, event, refs)))
        yield self._possible((*spec.urgent(here), *spec.spontaneous(here)))

    def _possible(self, steps: tuple[Step, ...]) -> list[Step]:
        return [step for step in steps if meet(self._assumed, step.assumes)]

    def _count(self, world: int, steps: list[Step]) -> None:
        if not steps:
            return
        self.moves += 1
        rules = {rule for step in steps for rule in (*step.rules, *self._shown_by(step))}
        self.ways.update(rules)
        for rule in rules:
            self.worlds.setdefault(rule, set()).add(world)

    def _shown_by(self, step: Step) -> Iterator[str]:
        """The rules that the messages of a step are held to; lines that carry names cannot be made up here."""
        if not self.system.codec.streams:
            return
        for emission in (*step.emits, *(owed for opening in step.opens for owed in opening.owed)):
            if emission.only and not meet(self._assumed, (emission.only,)):
                continue
            count = self.system.spec.names(step.after) if emission.refs is None else len(emission.refs)
            rules = self._shown.get(emission.view)
            if rules is None:
                rules = self._shown[emission.view] = tuple(self._rules_of(emission.view, count))
            yield from rules

    def _rules_of(self, view: View, count: int) -> Iterator[str]:
        names = tuple(f"n{number}" for number in range(count))
        for matches in recognised(self.system, view, names, self._defaults):
            if not isinstance(matches, Mismatch):
                yield from dict.fromkeys(rule for match in matches for rule in match.rules)
