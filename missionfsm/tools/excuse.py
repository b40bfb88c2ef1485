"""Proof, within bounds, that an implementation does nothing that the documents forbid.

An implementation that is a model can be explored. If every step that it takes in every state that it reaches is among
those that the spec allows there, under readings that agree with one another, then every conversation with it can be
explained: the explanation takes the very same steps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from attrs import evolve

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import ANYTHING, Assumption, meet
from missionfsm.kernel.spec import Emission, Mismatch, Step
from missionfsm.kernel.system import System
from missionfsm.tools.explore import Labels, references
from missionfsm.tools.model import Model

BOUNDS = (Bounds(missions=2, goals=1, batch=2), Bounds(missions=2, goals=2, batch=2))
"""Within which it is shown; the first only sort out quickly what is forbidden already there."""

Assumed = tuple[Assumption, ...]
Options = frozenset[Assumed]
"""Ways to explain one step: one of them has to be assumed."""

_FREE: Options = frozenset([()])
_FAILS = (IndexError, AssertionError, AttributeError, TypeError, ValueError, StopIteration)
"""What a broken model may raise."""


def straight(message: JSON) -> JSON:
    """The message itself."""
    return message


class Honest:
    """The reference under the readings that a broken model follows, and what it takes to explain its answers.

    What it remembers serves every model that breaks something else under the same readings.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self._sets: dict[frozenset[str], frozenset[str]] = {}
        self._known: dict[Any, tuple[Step, Options, frozenset[str]]] = {}

    def answers(
        self,
        here: Any,  # noqa: ANN401 - of any system
        request: Any,  # noqa: ANN401 - of any system
        refs: tuple[int | None, ...],
    ) -> tuple[Step, Options, frozenset[str]]:
        """The reference's own answer in a state, ways to explain it, and the rules of all allowed answers."""
        key = (here, request, refs)
        found = self._known.get(key)
        if found is None:
            step = self.model.outcome(here, request, refs)
            options = _explaining(self.model.system, here, request, refs, step)
            found = self._known[key] = (step, options, self._rules(here, request, refs))
        return found

    def _rules(self, here: Any, request: Any, refs: tuple[int | None, ...]) -> frozenset[str]:  # noqa: ANN401
        outcomes = self.model.system.spec.outcomes(here, request, refs)
        rules = frozenset(rule for one in outcomes for rule in one.rules)
        return self._sets.setdefault(rules, rules)


def excuse(  # noqa: PLR0913 - what an implementation is made of
    honest: Honest,
    model: Model,
    rule: str,
    operation: str | None,
    bend: Callable[[JSON], JSON],
    worlds: tuple[JSON, ...],
) -> str:
    """The readings under which everything that a model does within bounds is allowed; empty if there are none.

    Args:
        honest: the reference under the same readings, from which it may differ by a twist, and in the rules of one
            operation.
        model: the implementation.
        rule: the rule that it breaks; nothing is proved where that never comes up.
        operation: the operation whose rules differ.
        bend: what it does to its messages.
        worlds: those that it is explored in.
    """
    system = honest.model.system
    for bounds in BOUNDS:
        explorer = _Explorer(system, model, honest, rule, operation, bend, bounds)
        states = sum(map(explorer.run, worlds))
        if not explorer.alternatives:
            return ""
    return _words(system, model, explorer.alternatives, states) if explorer.came_up else ""


def _words(system: System, model: Model, alternatives: tuple[int, ...], states: int) -> str:
    own = {one.id: one.possible(model.choice)[0] for one in system.spec.ambiguities}

    def others(assumed: int) -> list[str]:
        followed = {one.id: one.possible(assumed) for one in system.spec.ambiguities}
        return [f"{name}={'|'.join(letters)}" for name, letters in followed.items() if own[name] not in letters]

    nearest = min(map(others, alternatives), key=len)
    why = f"which {', '.join(nearest)} allows" if nearest else "which its own readings allow"
    return f"it only does, in the {states} states that it reaches, {why}"


class _GuiltyError(Exception):
    """A step is allowed under no reading that agrees with those assumed before."""


class _Explorer:
    """Walks a model through worlds, and keeps the readings under which everything so far is allowed.

    Attributes:
        alternatives: sets of readings, of which none holds another; empty once nothing explains the model.
        came_up: whether the broken rule did.
    """

    def __init__(  # noqa: PLR0913 - what an exploration is made of
        self,
        system: System,
        model: Model,
        honest: Honest,
        rule: str,
        operation: str | None,
        bend: Callable[[JSON], JSON],
        bounds: Bounds,
    ) -> None:
        self.system = system
        self.spec = system.spec
        self.model = model
        self.honest = honest
        self.rule = rule
        self.operation = operation
        self.bend = bend
        self.bounds = bounds
        self.alternatives: tuple[int, ...] = (ANYTHING,)
        self.came_up = bend is not straight
        self._required: set[Options] = {_FREE}
        self._judged: set[Any] = set()

    def run(self, world: JSON) -> int:
        """How many states the model has in a world; its steps there are to be explained as well."""
        if not self.alternatives:
            return 0
        try:
            return self._walk(world)
        except _GuiltyError:
            self.alternatives = ()
            return 0

    def _walk(self, world: JSON) -> int:
        alphabet = self.system.alphabet(world, self.bounds)
        plain = Labels.of(self.system, alphabet.plain, alphabet.plain_drives)
        own = [one for one in alphabet.prompts if one.method == self.operation]
        # The world stays as it is: the others are explored from their own start.
        thorough = Labels.of(self.system, (*alphabet.plain, *own), alphabet.plain_drives)
        start = self.spec.initial(self.system.codec.world(world))
        found, todo, situations = {start}, [start], set()
        for here in todo:
            situation = self.spec.situation(here)
            labels = plain if situation in situations else thorough
            situations.add(situation)
            for taken, options in self._taken(here, labels):
                self._require(options)
                after = taken.after
                if after not in found and self.spec.names(after) <= self.bounds.missions:
                    found.add(after)
                    todo.append(after)
        return len(found)

    def _require(self, options: Options) -> None:
        if options in self._required:
            return
        self._required.add(options)
        met = {agreed for one in self.alternatives for assumes in options if (agreed := meet(one, assumes))}
        self.alternatives = tuple(sorted(one for one in met if not any(one != two and one & two == one for two in met)))
        if not self.alternatives:
            raise _GuiltyError

    def _taken(self, here: Any, labels: Labels) -> Iterator[tuple[Step, Options]]:  # noqa: ANN401
        """Every step that the model takes in a state and what explains it; urgent ones come first."""
        taken = self.model.urgent(here)
        if taken is not None:
            yield taken, self._explained(here, taken, self.spec.urgent(here))
            return
        if any(meet(self.model.choice, step.assumes) for step in self.spec.urgent(here)):
            raise _GuiltyError
        for request, free in labels.requests:
            for refs in references(self.spec, here, free):
                yield self._asked(here, request, refs)
        for event, free in labels.events:
            for refs in references(self.spec, here, free):
                own = self.honest.model.happening(here, event, refs)
                self.came_up = self.came_up or (own is not None and self.rule in own.rules)
                happened = self.model.happening(here, event, refs)
                if happened is not None:
                    allowed = self.spec.drives[event.name].steps(here, event, refs)
                    yield happened, self._explained(here, happened, allowed)

    def _asked(self, here: Any, request: Any, refs: tuple[int | None, ...]) -> tuple[Step, Options]:  # noqa: ANN401
        own, options, rules = self.honest.answers(here, request, refs)
        self.came_up = self.came_up or self.rule in rules
        try:
            asked = self.spec.request_operation(request) == self.operation
            step = self.model.outcome(here, request, refs) if asked else self.model.twist(here, own)
        except _FAILS:
            raise _GuiltyError from None
        if step is None:
            raise _GuiltyError
        self.came_up = self.came_up or self.rule in step.rules
        if self.bend is not straight or (step is not own and (step.emits or step.opens)):
            self._see(step, passing=False)
        if step is own:
            return step, options
        # What shows a state that does not last may be left out.
        silent = not step.emits and self.model.urgent(step.after) is not None
        return step, _explaining(self.system, here, request, refs, step, silent=silent)

    def _explained(self, here: Any, taken: Step, allowed: Iterable[Step]) -> Options:  # noqa: ANN401
        """What explains a step that answers nobody."""
        self.came_up = self.came_up or self.rule in taken.rules
        passing = self.model.urgent(taken.after) is not None
        self._see(taken, passing=passing)
        # What shows a state that does not last may be left out.
        silent = passing and not taken.emits
        seen = _seen(taken, here, silent=silent)
        return frozenset(step.assumes for step in allowed if _seen(step, here, silent=silent) == seen)

    def _see(self, step: Step, *, passing: bool) -> None:
        """Require what explains the messages of a step."""
        if passing:
            return
        names = self.spec.names(step.after)
        for emission in (*step.emits, *(owed for opening in step.opens for owed in opening.owed)):
            key = (emission, names)
            if key not in self._judged:
                self._judged.add(key)
                for options in self._shown(emission, names):
                    self._require(options)

    def _shown(self, emission: Emission, named: int) -> Iterator[Options]:
        if emission.only and not meet(self.model.choice, (emission.only,)):
            return
        count = 1 + max((*(emission.refs or ()), named - 1), default=0)
        names = tuple(f"n{number}" for number in range(count if emission.refs is None else len(emission.refs)))
        codec = self.system.codec
        message = self.bend(codec.write_message(emission.view, names, self.model.choice, 1, 0.0))
        for _, _, rest in codec.strip(message):
            matches = self.spec.matches(emission.view, codec.content(rest))
            if isinstance(matches, Mismatch):
                raise _GuiltyError
            self.came_up = self.came_up or any(self.rule in match.rules for match in matches)
            yield frozenset(match.assumes for match in matches)


def _explaining(  # noqa: PLR0913 - a step and where it is taken
    system: System,
    here: Any,  # noqa: ANN401 - of any system
    request: Any,  # noqa: ANN401 - of any system
    refs: tuple[int | None, ...],
    taken: Step,
    *,
    silent: bool = False,
) -> Options:
    """Ways to explain an answer in a state, those of failures that may always come among them."""
    seen = _seen(taken, here, silent=silent)
    found = {
        (*step.assumes, *also)
        for step in system.spec.outcomes(here, request, refs)
        if _seen(step, here, silent=silent) == seen
        for also in _agreements(system, step.answer, taken.answer)
    }
    if taken.answer is not None and not taken.refs:
        failure = system.spec.failing(request, taken.answer.code)
        nothing = evolve(taken, after=here, names=None, emits=(), opens=())
        if failure is not None and not failure.driven and _seen(nothing, here) == seen:
            found.add(failure.assumes)
    return frozenset(found)


def _agreements(system: System, allowed: Answer | None, given: Answer | None) -> Iterable[Assumed]:
    """Under which readings an answer is the one that is allowed."""
    if allowed == given:
        return ((),)
    if allowed is None or given is None or system.spec.answers is None:
        return ()
    if (allowed.code, allowed.unordered) != (given.code, given.unordered):
        return ()
    matches = system.spec.answers(allowed.shape, given.shape)
    return () if isinstance(matches, Mismatch) else (match.assumes for match in matches)


def _seen(step: Step, here: Any, *, silent: bool = False) -> Any:  # noqa: ANN401 - what matters of a step
    names = None if step.after is here else step.names
    refs = tuple(sorted(step.refs)) if step.answer is not None and step.answer.unordered else step.refs
    return (step.after, names, () if silent else step.emits, step.opens, refs)
