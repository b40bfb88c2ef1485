"""Every state that can be reached within bounds: counts, invariants, possibilities, shortest counterexamples."""

from __future__ import annotations

import functools
import itertools
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping
from typing import Any

from attrs import field, frozen

from missionfsm.kernel.alphabet import ANY_NAME, Bounds, Input
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import UNCONSTRAINED, meet
from missionfsm.kernel.spec import Invariant, Spec
from missionfsm.kernel.step import ONCE_HAD, Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Code, Refs, State
from missionfsm.tools.placeholders import fill, slots

Free = tuple[bool, ...]
"""For each name of a request or an event, whether it may be any name of the state."""


@frozen
class Actions:
    """What is tried in every state: requests and events.

    Each has a flag for each of its names, whether it may be any name of the state; if not, it names something new.
    """

    requests: tuple[tuple[Any, Free], ...]
    events: tuple[tuple[Any, Free], ...]

    @classmethod
    def from_alphabet(cls, system: System, prompts: Iterable[Input], drives: Iterable[JSON]) -> Actions:
        """The requests of some inputs, each once, and the events of some drives."""
        requests, events = [], []
        for prompt in prompts:
            params, picked = _filled(system, prompt.params)
            names, rest = system.codec.split_request(prompt.method, params)
            requests.append((system.codec.read_request(prompt.method, rest), tuple(name in picked for name in names)))
        for drive in drives:
            params, picked = _filled(system, drive)
            event, names = system.codec.read_drive(params)
            events.append((event, tuple(name in picked for name in names)))
        return cls(tuple(dict.fromkeys(requests)), tuple(dict.fromkeys(events)))


def _filled(system: System, params: JSON) -> tuple[JSON, tuple[Any, ...]]:
    """Params with made-up names in the place of stand-ins, and those among them that a tester picks."""
    picked = {slot: system.naming.make(kind, slot + 2) for slot, kind in slots(params).items()}
    return fill(params, picked, system.naming, 1), (ANY_NAME, *picked.values())


@frozen
class Transition:
    """A step that the explorer took: what was done (a request, an event, or None: by itself) and how it came out."""

    what: Any
    step: Step

    def words(self, spec: Spec) -> str:
        """What was done, for people."""
        return "by itself" if self.what is None else spec.describe(self.what)


@frozen
class Counterexample:
    """A state in which an invariant does not hold, and the shortest way there."""

    invariant: str
    says: str
    path: tuple[str, ...]
    state: str

    def __str__(self) -> str:
        steps = "\n".join(f"    {number}. {label}" for number, label in enumerate(self.path, 1))
        return f"{self.says}\n  does not hold in {self.state}, reached by\n{steps or '    (it is the first state)'}"


@frozen
class Exploration:
    """What exploring came to.

    Attributes:
        states: distinct states.
        situations: how many of them differ in what can be done.
        transitions: steps between them, refusals included.
        depth: steps to the state that is furthest away.
        by_operation: operation to code to how often it is an allowed answer.
        unmet: possibilities that no state meets.
        idle: ids of refusals that no call meets; `constant`: of those that every call meets.
    """

    system: str
    bounds: Bounds
    states: int
    situations: int
    transitions: int
    depth: int
    by_operation: Mapping[str, Mapping[str, int]] = field(factory=dict)
    counterexample: Counterexample | None = None
    unmet: tuple[str, ...] = ()
    idle: tuple[str, ...] = ()
    constant: tuple[str, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether every invariant holds and every possibility is met."""
        return self.counterexample is None and not self.unmet

    @property
    def counts(self) -> str:
        """How much there is, in words."""
        return f"{self.states} states in {self.situations} situations, {self.transitions} steps, depth {self.depth}"

    def to_json(self) -> JSON:
        """The exploration as the command line writes it."""
        return {
            "system": self.system,
            "bounds": {"missions": self.bounds.size, **dict(self.bounds.own)},  # the key is older than other systems
            "states": self.states,
            "situations": self.situations,
            "transitions": self.transitions,
            "depth": self.depth,
            "operations": {name: dict(codes) for name, codes in self.by_operation.items()},
            "counterexample": None if self.counterexample is None else str(self.counterexample),
            "unmet": list(self.unmet),
            "idle": list(self.idle),
            "constant": list(self.constant),
        }

    def __str__(self) -> str:
        lines = [f"{self.system} within {self.bounds}: {self.counts}"]
        if self.counterexample:
            lines.append(f"broken invariant: {self.counterexample}")
        else:
            lines.append("every invariant holds")
        lines += [f"never reached: {one}" for one in self.unmet]
        lines += [f"never fires within these bounds: {one}" for one in self.idle]
        lines += [f"fires always: {one}" for one in self.constant]
        for name, codes in self.by_operation.items():
            lines.append(f"  {name}: " + ", ".join(f"{code} {times}" for code, times in codes.items()))
        return "\n".join(lines)


def steps(spec: Spec, state: State, actions: Actions) -> Iterator[Transition]:
    """Every step from a state: calls with every answer, drives, and what the system does by itself."""
    for request, free in actions.requests:
        for refs in bindings(spec, state, free):
            for step in spec.outcomes(state, request, refs):
                yield Transition(request, step)
    for event, free in actions.events:
        for refs in bindings(spec, state, free):
            for step in spec.drives[event.name].steps(state, event, refs):
                yield Transition(event, step)
    for step in (*spec.urgent(state), *spec.spontaneous(state)):
        yield Transition(None, step)


def reachable(
    spec: Spec,
    start: State,
    actions: Actions,
    most: int,
    assumed: int = UNCONSTRAINED,
    *,
    forget_ended: bool = False,
) -> Reached:
    """Every state whose size is `most` or less (see `Spec.explore_size`).

    Args:
        forget_ended: what has ended is only counted, where the system can (see `Abstraction.forget_ended`).
    """
    if spec.abstraction.compiled:
        events = [event for event, _ in actions.events]
        short = spec.abstraction.compiled(actions.requests, events, assumed, most, forget_ended=forget_ended)
        return Reached(_reach(short.encode(start), short.successors), short.decode)
    quotient = _quotient(spec, forget_ended=forget_ended)
    extent = spec.explore_size

    def successors(here: State) -> Iterator[State]:
        for one in steps(spec, here, actions):
            if meet(assumed, one.step.assumes) and extent(one.step.after) <= most:
                yield quotient(one.step.after)

    return Reached(_reach(quotient(start), successors), _itself)


def _quotient(spec: Spec, *, forget_ended: bool) -> Callable[[State], State]:
    """What stands for a state in an exploration."""
    return (spec.abstraction.forget_ended if forget_ended else None) or spec.abstraction.canonical or _itself


def _itself(state: State) -> State:
    return state


class Reached:
    """The states that were reached, nearest first, and where each was first reached from.

    They are kept as the codes that they were explored as, and read only when somebody looks at them.

    Args:
        before: every code to the one that it was first reached from, nearest first.
        decode: a code to its state.
    """

    def __init__(self, before: Mapping[Hashable, Hashable], decode: Callable[[Any], State]) -> None:
        self._before = before
        self._decode = decode

    def __len__(self) -> int:
        return len(self._before)

    def __iter__(self) -> Iterator[State]:
        return iter(self._states)

    @functools.cached_property
    def _states(self) -> tuple[State, ...]:
        return tuple(map(self._decode, self._before))

    @functools.cached_property
    def _codes(self) -> Mapping[State, Hashable]:
        return dict(zip(self._states, self._before, strict=True))

    def before(self, state: State) -> State | None:
        """The state that this one was first reached from; None for the first."""
        code = self._before[self._codes[state]]
        return None if code is None else self._decode(code)

    @property
    def depth(self) -> int:
        """Steps to the state that is furthest away."""
        depth: dict[Hashable, int] = {}
        for code, before in self._before.items():
            depth[code] = 0 if before is None else depth[before] + 1
        return max(depth.values())


def _reach(start: Code, successors: Callable[[Code], Iterable[Code]]) -> dict[Code, Code]:
    found: dict[Any, Any] = {start: None}
    todo = [start]
    add = todo.append
    for here in todo:  # grows while it is walked: a queue without a queue's cost
        for after in successors(here):
            if after not in found:
                found[after] = here
                add(after)
    return found


def explore(
    system: System,
    bounds: Bounds | None = None,
    *,
    world: JSON = None,
    assumed: int = UNCONSTRAINED,
    invariants: tuple[Invariant, ...] | None = None,
    forget_ended: bool = False,
) -> Exploration:
    """Visit every state that a system can reach within bounds, and try every step in each.

    The core inputs and core drives of the alphabet lead from state to state. Which rules fire is then asked for every
    input, in one state of every situation.

    Args:
        system: the system.
        bounds: how large states may be.
        world: the world that it starts in; by default the usual one.
        assumed: the readings that are possible (see `missionfsm.kernel.readings`); by default all, at every step.
        invariants: what has to hold; by default the spec's own.
        forget_ended: whether ended things are only counted, if the system allows that: that makes far fewer states, in
            which the same can be done. Possibilities are not looked at then, since some are about what is forgotten.
    """
    bounds = bounds or Bounds()
    spec = system.spec
    usual = system.alphabet({}, bounds).worlds[0] if world is None else world
    alphabet = system.alphabet(usual, bounds)
    actions = Actions.from_alphabet(system, alphabet.core_inputs, alphabet.core_drives)
    start = spec.initial(system.codec.read_world(usual))
    found = reachable(spec, start, actions, bounds.size, assumed, forget_ended=forget_ended)
    broken = _first_broken(found, spec.invariants if invariants is None else invariants)
    quotient = _quotient(spec, forget_ended=forget_ended)
    possible = () if forget_ended and spec.abstraction.forget_ended else spec.possibilities
    unmet = tuple(one.says for one in possible if not any(map(one.holds, found)))
    keys = [spec.abstraction.enabled_key(here) for here in found]
    groups = Counter(keys)
    representatives = dict(zip(keys, found, strict=True))
    tally = _Tally(spec)
    for key, here in representatives.items():
        tally.add(here, actions, groups[key], assumed)
    everything = Actions.from_alphabet(system, alphabet.inputs, alphabet.drives)
    firing = firings(spec, representatives.values(), everything, assumed)
    return Exploration(
        system.name,
        bounds,
        len(found),
        len(groups),
        tally.transitions,
        found.depth,
        tally.sorted,
        _counterexample(spec, actions, found, quotient, *broken) if broken else None,
        unmet,
        tuple(rule for rule, (fires, _) in firing.items() if not fires),
        tuple(rule for rule, (_, rests) in firing.items() if not rests),
    )


def _first_broken(states: Iterable[State], invariants: tuple[Invariant, ...]) -> tuple[Invariant, State] | None:
    """An invariant that does not hold in the first state in which one does not."""
    return next(((one, here) for here in states for one in invariants if not one.holds(here)), None)


class _Tally:
    """Counts steps by operation and answer."""

    def __init__(self, spec: Spec) -> None:
        self.spec = spec
        self.transitions = 0
        self.by_operation: dict[str, dict[str, int]] = {}

    @property
    def sorted(self) -> dict[str, dict[str, int]]:
        """Operation to code to times, by their names."""
        return {name: dict(sorted(codes.items())) for name, codes in sorted(self.by_operation.items())}

    def add(self, here: State, actions: Actions, times: int, assumed: int) -> None:
        for one in steps(self.spec, here, actions):
            if not meet(assumed, one.step.assumes):
                continue
            self.transitions += times
            if one.step.answer is not None:
                name = self.spec.request_operation(one.what)
                codes = self.by_operation.setdefault(name, {})
                codes[one.step.answer.code] = codes.get(one.step.answer.code, 0) + times


def firings(
    spec: Spec, states: Iterable[State], actions: Actions, assumed: int = UNCONSTRAINED, settled: Collection[str] = ()
) -> dict[str, tuple[bool, bool]]:
    """For every refusal that is not settled: whether some call in some state meets it, and whether some call does not.

    Args:
        settled: the ids of refusals of which both are known.
    """
    found = {
        rule.id: [False, False]
        for operation in spec.operations.values()
        for rule in operation.refusals
        if rule.id not in settled
    }
    for here in states:
        for request, free in actions.requests:
            operation = spec.operations[spec.request_operation(request)]
            if all(all(found.get(rule.id, ())) for rule in operation.refusals):
                continue  # no call of it can add anything
            for refs in bindings(spec, here, free):
                outcomes = spec.outcomes(here, request, refs)
                met = {rule for step in outcomes if meet(assumed, step.assumes) for rule in step.rules}
                for rule in operation.refusals:
                    if rule.id in found:
                        found[rule.id][rule.id not in met] = True
    return {rule: (fires, rests) for rule, (fires, rests) in found.items()}


def bindings(spec: Spec, here: State, free: Free) -> Iterable[Refs]:
    """Every way in which names can be those of a state, or not any more."""
    positions = (None, *((ONCE_HAD,) if spec.recalls else ()), *range(spec.names(here)))
    return itertools.product(*(positions if one else (None,) for one in free))


def _counterexample(
    spec: Spec,
    actions: Actions,
    found: Reached,
    quotient: Callable[[State], State],
    invariant: Invariant,
    state: State,
) -> Counterexample:
    path: list[str] = []
    here = state
    while (before := found.before(here)) is not None:
        taken = next(one for one in steps(spec, before, actions) if quotient(one.step.after) == here)
        path.append(taken.words(spec))
        here = before
    return Counterexample(invariant.name, invariant.says, tuple(reversed(path)), spec.describe(state))
