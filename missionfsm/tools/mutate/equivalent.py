"""Proof, within bounds, that an implementation does nothing that the documents forbid.

An implementation that is a model can be explored. If every step that it takes in every state that it reaches is among
those that the spec allows there, under readings that agree with one another, then every conversation with it can be
explained: the explanation takes the very same steps.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from typing import Any

from attrs import evolve, frozen

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import UNCONSTRAINED, Assumption, meet
from missionfsm.kernel.step import Emission, Match, Mismatch, Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Refs, Request, State
from missionfsm.tools.explore.explore import Actions, bindings
from missionfsm.tools.reference.model import Reference, recognised


@frozen
class Scope:
    """How far a model is explored.

    Attributes:
        worlds: in how many of the worlds, the first ones; None is all.
        follows_all: whether it goes on from everything that the operation in question does, and not just from the
            plain requests.
    """

    bounds: Bounds
    worlds: int | None = None
    follows_all: bool = True


SCOPES = (
    Scope(Bounds(2, goals=1, batch=2)),
    # One world for each kind of robot.
    Scope(Bounds(2, goals=2, batch=2), worlds=3, follows_all=False),
)
TIMED = (Scope(Bounds(1)),)
"""Those for systems with clocks, which make many states of one (see `Abstraction.canonical`)."""

Assumed = tuple[Assumption, ...]
Options = frozenset[Assumed]
"""Ways to explain one step: one of them has to be assumed."""

_FREE: Options = frozenset([()])
_FAILS = (LookupError, AssertionError, AttributeError, TypeError, ValueError, StopIteration)
"""What a broken model may raise."""


def unchanged_message(message: JSON) -> JSON:
    """The message itself."""
    return message


class ReferenceSteps:
    """The reference under the readings that a broken model follows, and what it takes to explain its answers.

    What it remembers serves every model that breaks something else under the same readings.
    """

    def __init__(self, model: Reference) -> None:
        self.model = model
        self._sets: dict[frozenset[str], frozenset[str]] = {}
        self._known: dict[Hashable, tuple[Step, Options, frozenset[str]]] = {}
        self._urgent: dict[Hashable, tuple[tuple[Step, ...], Step | None]] = {}
        self._renderings: dict[Hashable, tuple[tuple[Match, ...], ...] | Mismatch] = {}

    def answers(
        self,
        here: State,
        request: Request,
        refs: Refs,
    ) -> tuple[Step, Options, frozenset[str]]:
        """The reference's own answer in a state, ways to explain it, and the rules of all allowed answers."""
        key = (here, request, refs)
        found = self._known.get(key)
        if found is None:
            allowed = self.model.system.spec.outcomes(here, request, refs)
            step = next(one for one in allowed if meet(self.model.choice, one.assumes))
            options = _explaining(self.model.system, here, request, allowed, step)
            rules = frozenset(rule for one in allowed for rule in one.rules)
            found = self._known[key] = (step, options, self._sets.setdefault(rules, rules))
        return found

    def urgent(self, here: State) -> tuple[tuple[Step, ...], Step | None]:
        """What may happen at once in a state, and what of it the reference does."""
        found = self._urgent.get(here)
        if found is None:
            allowed = self.model.system.spec.urgent(here)
            own = next((one for one in allowed if meet(self.model.choice, one.assumes)), None)
            found = self._urgent[here] = (allowed, own)
        return found

    def renderings(self, emission: Emission, named: int) -> tuple[tuple[Match, ...], ...] | Mismatch:
        """Ways to explain each part of the message that the reference makes of an emission."""
        key = (emission, named)
        found = self._renderings.get(key)
        if found is None:
            found = self._renderings[key] = renderings(self.model, emission, named)
        return found


def allowed_under(
    reference: ReferenceSteps,
    model: Reference,
    rule: str,
    operation: str | None,
    mutate_message: Callable[[JSON], JSON],
    worlds: tuple[JSON, ...],
) -> str:
    """The readings under which everything that a model does within bounds is allowed; empty if there are none.

    Args:
        reference: the reference under the same readings, from which it may differ by a mutation of a step, and
            in the rules of one operation.
        model: the implementation.
        rule: the rule that it breaks; nothing is proved where that never comes up. Where it does so only in states that
            do not last, because something happens at once, nobody can meet it.
        operation: the operation whose rules differ.
        mutate_message: what it does to its messages.
        worlds: those that it is explored in.
    """
    system = reference.model.system
    states, came_up, passing = 0, False, False
    for scope in TIMED if system.spec.abstraction.canonical else SCOPES:
        explorer = _Explorer(system, model, reference, rule, operation, mutate_message, scope)
        states += sum(map(explorer.run, worlds[: scope.worlds]))
        came_up |= explorer.came_up
        passing |= explorer.passing
        if not explorer.alternatives:
            return ""
    if came_up:
        return _words(system, model, explorer.alternatives, states)
    return f"of the {states} states that it reaches it is due only in some that do not last" if passing else ""


def _words(system: System, model: Reference, alternatives: tuple[int, ...], states: int) -> str:
    own = {one.id: one.possible(model.choice)[0] for one in system.spec.ambiguities}

    def others(assumed: int) -> list[str]:
        followed = {one.id: one.possible(assumed) for one in system.spec.ambiguities}
        return [f"{name}={'|'.join(letters)}" for name, letters in followed.items() if own[name] not in letters]

    nearest = min(map(others, alternatives), key=len)
    why = f"which {', '.join(nearest)} allows" if nearest else "which its own readings allow"
    return f"it only does, in the {states} states that it reaches, {why}"


class _NotAllowedError(Exception):
    """A step is allowed under no reading that agrees with those assumed before."""


class _Explorer:
    """Walks a model through worlds, and keeps the readings under which everything so far is allowed.

    Attributes:
        alternatives: sets of readings, of which none holds another; empty once nothing explains the model.
        came_up: whether the broken rule did.
        passing: whether it did where no call can meet it, since something happens at once.
        rules_differ: whether the model differs in the rules of the operation, and not just by a mutation of a step.
    """

    def __init__(
        self,
        system: System,
        model: Reference,
        reference: ReferenceSteps,
        rule: str,
        operation: str | None,
        mutate_message: Callable[[JSON], JSON],
        scope: Scope,
    ) -> None:
        self.system = system
        self.spec = system.spec
        self.model = model
        self.reference = reference
        self.rule = rule
        self.operation = operation
        self.mutate_message = mutate_message
        self.scope = scope
        self.alternatives: tuple[int, ...] = (UNCONSTRAINED,)
        self.came_up = mutate_message is not unchanged_message
        self.passing = False
        self.rules_differ = model.system.spec is not system.spec
        self._required: set[Options] = {_FREE}
        self._judged: set[Any] = set()

    def run(self, world: JSON) -> int:
        """How many states the model has in a world; its steps there are to be explained as well."""
        if not self.alternatives:
            return 0
        try:
            return self._walk(world)
        except _NotAllowedError:
            self.alternatives = ()
            return 0

    def _walk(self, world: JSON) -> int:
        alphabet = self.system.alphabet(world, self.scope.bounds)
        plain = Actions.from_alphabet(self.system, alphabet.core_inputs, alphabet.core_drives)
        own = Actions.from_alphabet(self.system, (one for one in alphabet.inputs if one.method == self.operation), ())
        # The world stays as it is: the others are explored from their own start.
        start = self.spec.initial(self.system.codec.read_world(world))
        extent, abstraction = self.spec.explore_size, self.spec.abstraction
        # Where clocks tell states apart, what answers calls is in the shape.
        same = abstraction.search_key if abstraction.canonical else abstraction.enabled_key
        found, todo, keys = {start}, [start], set()
        for here in todo:
            taken = [step for step in self._taken(here, plain) if extent(step.after) <= self.scope.bounds.size]
            key = same(here)
            if key not in keys and not self._passes(here):
                keys.add(key)
                asked = [step for step in self._asked_all(here, own) if extent(step.after) <= self.scope.bounds.size]
                taken += asked if self.scope.follows_all else ()
            new = dict.fromkeys(step.after for step in taken if step.after not in found)
            found.update(new)
            todo += new
        return len(found)

    def _require(self, options: Options) -> None:
        if options in self._required:
            return
        self._required.add(options)
        met = {agreed for one in self.alternatives for assumes in options if (agreed := meet(one, assumes))}
        self.alternatives = tuple(sorted(one for one in met if not any(one != two and one & two == one for two in met)))
        if not self.alternatives:
            raise _NotAllowedError

    def _taken(self, here: State, actions: Actions) -> Iterator[Step]:
        """Every step that the model takes in a state, each explained; urgent ones come first."""
        allowed, own = self.reference.urgent(here)
        taken = self.model.mutate_step(here, own)
        if taken is not None:
            self.passing = self.passing or self._would_come_up(here, actions)
            self._require(self._explained(here, taken, allowed))
            yield taken
            return
        if own is not None:
            raise _NotAllowedError
        yield from self._asked_all(here, actions)
        for event, free in actions.events:
            for refs in bindings(self.spec, here, free):
                allowed = tuple(self.spec.drives[event.name].steps(here, event, refs))
                own = next((one for one in allowed if meet(self.model.choice, one.assumes)), None)
                self.came_up = self.came_up or (own is not None and self.rule in own.rules)
                happened = self.model.mutate_step(here, own)
                if happened is not None:
                    self._require(self._explained(here, happened, allowed))
                    yield happened

    def _would_come_up(self, here: State, actions: Actions) -> bool:
        """Whether a call would meet the broken rule in a state that does not last."""
        asked = (one for one in actions.requests if self.spec.request_operation(one[0]) == self.operation)
        return any(
            self.rule in self.reference.answers(here, request, refs)[2]
            for request, free in asked
            for refs in bindings(self.spec, here, free)
        )

    def _asked_all(self, here: State, actions: Actions) -> Iterator[Step]:
        for request, free in actions.requests:
            for refs in bindings(self.spec, here, free):
                step, options = self._asked(here, request, refs)
                self._require(options)
                yield step

    def _passes(self, here: State) -> bool:
        """Whether a state of the model does not last."""
        return self.model.mutate_step(here, self.reference.urgent(here)[1]) is not None

    def _asked(self, here: State, request: Request, refs: Refs) -> tuple[Step, Options]:
        own, options, rules = self.reference.answers(here, request, refs)
        self.came_up = self.came_up or self.rule in rules
        try:
            differs = self.rules_differ and self.spec.request_operation(request) == self.operation
            step = self.model.outcome(here, request, refs) if differs else self.model.mutate_step(here, own)
        except _FAILS:
            raise _NotAllowedError from None
        if step is None:
            raise _NotAllowedError
        self.came_up = self.came_up or self.rule in step.rules
        if self.mutate_message is not unchanged_message or (step is not own and (step.emits or step.opens)):
            self._see(step, passing=False)
        if step is own:
            return step, options
        # What shows a state that does not last may be left out.
        silent = not step.emits and self._passes(step.after)
        allowed = self.spec.outcomes(here, request, refs)
        return step, _explaining(self.system, here, request, allowed, step, silent=silent)

    def _explained(self, here: State, taken: Step, allowed: Iterable[Step]) -> Options:
        """What explains a step that answers nobody."""
        self.came_up = self.came_up or self.rule in taken.rules
        passing = self._passes(taken.after)
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
                self._require_shown(emission, names)

    def _require_shown(self, emission: Emission, named: int) -> None:
        if emission.only and not meet(self.model.choice, (emission.only,)):
            return
        straightforward = self.mutate_message is unchanged_message
        found = (
            self.reference.renderings(emission, named)
            if straightforward
            else renderings(self.model, emission, named, self.mutate_message)
        )
        if isinstance(found, Mismatch):
            raise _NotAllowedError
        for matches in found:
            self.came_up = self.came_up or any(self.rule in match.rules for match in matches)
            self._require(frozenset(match.assumes for match in matches))


def renderings(
    model: Reference, emission: Emission, named: int, mutate_message: Callable[[JSON], JSON] = unchanged_message
) -> tuple[tuple[Match, ...], ...] | Mismatch:
    """Ways to explain each part of the message that a model makes of an emission, or what is wrong with one.

    Args:
        named: how many names the state has.
        mutate_message: what becomes of the message.
    """
    system = model.system
    count = 1 + max((*(emission.refs or ()), named - 1), default=0)
    names = tuple(map(system.naming.in_message, range(count if emission.refs is None else len(emission.refs))))
    found: list[tuple[Match, ...]] = []
    for matches in recognised(system, emission.view, names, model.choice, mutate_message):
        if isinstance(matches, Mismatch):
            return matches
        found.append(matches)
    return tuple(found)


def _explaining(
    system: System,
    here: State,
    request: Request,
    allowed: tuple[Step, ...],
    taken: Step,
    *,
    silent: bool = False,
) -> Options:
    """Ways to explain an answer in a state, those of failures that may always come among them."""
    seen = _seen(taken, here, silent=silent)
    found = {
        (*step.assumes, *also)
        for step in allowed
        if _seen(step, here, silent=silent) == seen
        for also in _agreements(system, step.answer, taken.answer)
    }
    if taken.answer is not None and not taken.refs:
        failure = system.spec.failing(request, taken.answer.code)
        if failure is not None and failure.drive is None:
            nothing = evolve(taken, after=here, names=None, emits=(), opens=())
            found |= {failure.assumes} if _seen(nothing, here) == seen else set()
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


def _seen(step: Step, here: State, *, silent: bool = False) -> Hashable:
    names = None if step.after is here else step.names
    refs = tuple(sorted(step.refs)) if step.answer is not None and step.answer.unordered else step.refs
    return (step.after, names, () if silent else step.emits, step.opens, refs)
