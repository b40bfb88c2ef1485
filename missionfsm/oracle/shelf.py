"""Things that decide nothing any more are put away, beside the belief, until somebody sees or names one of them.

A list that nobody watches and nobody clears grows for ever, and every state would hold all of it. What stands at the
front of the states and is named the same in all explanations goes on a shelf, with its names; one thing stands for it
there. The same situation is the same node again then, however long the list has become. Explanations that differ in
what they have put away have different shelves; a name that is on the shelf of others is gone in those without it.

What can be said of such a node by the rules of the system itself holds for the whole one (see
`missionfsm.kernel.shelving`). For all else it is made whole before.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Iterator, Sequence

from attrs import define, evolve, field, frozen

from missionfsm.kernel.history import Called, Ended, Event, Name, Received
from missionfsm.kernel.shelving import Shelving
from missionfsm.kernel.terms import State
from missionfsm.oracle.explanation import GONE, Explanation, mentioned_besides
from missionfsm.oracle.symbols import Part

LEAST, MORE = 64, 16
"""How many things have to be there before the first are put away, and before a search puts away more."""


@frozen(eq=False)
class _Shelf:
    """What one thing stands for: what was put away before, and what more."""

    before: _Shelf | None
    names: tuple[Part, ...]
    things: tuple[Hashable, ...]

    def all(self) -> tuple[list[Part], list[Hashable]]:
        """Everything on it, the first first: the names of all but the last thing, and the things."""
        shelves: list[_Shelf] = []
        shelf: _Shelf | None = self
        while shelf is not None:
            shelves.append(shelf)
            shelf = shelf.before
        shelves.reverse()
        return [name for one in shelves for name in one.names], [thing for one in shelves for thing in one.things]


@frozen(eq=False)
class Plan:
    """How things are put away at a node.

    Attributes:
        names: the numbers of those names that are put away.
        explanations: what is left of the explanations.
        shelves: for each new shelf the number of the one that was there before (None: none), and what comes on it; the
            latter is None where nothing does.
    """

    names: tuple[int, ...]
    explanations: tuple[Explanation, ...]
    shelves: tuple[tuple[int | None, tuple[Hashable, ...] | None], ...]


def plan(shelving: Shelving, explanations: Sequence[Explanation], *, least: int = LEAST) -> Plan | None:
    """How things are put away where so many are there at least; None where nothing can be.

    Nothing is while somebody watches, or may still be told of them.
    """
    fronts = [shelving.front(one.state) for one in explanations]
    most = max(fronts, default=0)
    if most < least or any(map(_is_told, explanations, (shelving,) * len(explanations))):
        return None
    names = explanations[fronts.index(most)].names[: most - 1]
    for one, front in zip(explanations, fronts, strict=True):
        names = names[: _common(names, one, front)]
    if not names or any(not _apart(names, one) for one in explanations):
        return None
    numbers: dict[tuple[int | None, tuple[Hashable, ...] | None], int] = {}
    left = []
    for one in explanations:
        shelf = shelving.shelf(one.state)
        state, here = one.state, one.names[:1] == names[:1]
        more: tuple[Hashable, ...] | None = None
        if here:
            more = shelving.things(state, len(names) + 1)[shelf is not None :]
        if here or shelf is not None:
            number = numbers.setdefault((shelf, more), len(numbers))
            state = shelving.put(state, len(names) + 1 if here else 1, number)
        gone = one.gone if here else tuple(sorted(set(one.gone).difference(names)))
        left.append(evolve(one, state=state, names=one.names[len(names) :] if here else one.names, gone=gone))
    return Plan(names, tuple(left), tuple(numbers))


def _is_told(explanation: Explanation, shelving: Shelving) -> bool:
    """Whether something in an explanation may still tell which things there are."""
    asked = (one.request for one in explanation.calls)
    return bool(explanation.channels) or any(map(shelving.asks, (*asked, *(one[0] for one in explanation.lost))))


def _common(names: tuple[int, ...], explanation: Explanation, front: int) -> int:
    """How many of some names, from the first on, an explanation has at its front too, or has no more."""
    own = explanation.names[: max(front - 1, 0)]
    if names and own[:1] == names[:1]:
        pairs = zip(names, own, strict=False)
        return next((at for at, (name, other) in enumerate(pairs) if name != other or name <= GONE), len(own))
    gone = set(explanation.gone)
    return next((at for at, name in enumerate(names) if name not in gone), len(names))


def _apart(names: tuple[int, ...], explanation: Explanation) -> bool:
    """Whether nothing else in an explanation mentions these names."""
    away = set(names)
    behind = explanation.names[len(names) :] if explanation.names[:1] == names[:1] else explanation.names
    return away.isdisjoint(mentioned_besides(explanation)) and away.isdisjoint(behind)


@define(eq=False, slots=True)
class Shelves:
    """What one belief has put away, once and for all: there are other ones when it is more, or nothing.

    Attributes:
        shelving: how the system puts things away.
        names: the names, in the order in which they were put away.
    """

    shelving: Shelving
    names: dict[Name, None] = field(factory=dict)
    _shelves: list[_Shelf] = field(factory=list)

    def concern(self, event: Event) -> bool:
        """Whether an event may tell of what was put away."""
        kind = type(event)
        if kind is Received or kind is Ended or (kind is Called and self.shelving.asks(event.request)):  # type: ignore[union-attr]
            return True
        return any(name in self.names for name in getattr(event, "names", ()))

    def with_more(self, what: Plan, names: Sequence[Name]) -> Shelves:
        """The same once things are put away; `names` are those that the plan has the numbers of."""
        shelves: list[_Shelf] = []
        for before, more in what.shelves:
            shelf = None if before is None else self._shelves[before]
            shelves.append(_Shelf(shelf, tuple(names), more) if more is not None else _kept(shelf))
        self.names.update(dict.fromkeys(names))  # whoever looks back knows more names, which stand for nothing there
        return Shelves(self.shelving, self.names, shelves)

    def brought(self, explanations: Sequence[Explanation], first: int) -> Iterator[Explanation]:
        """The explanations with all that was put away; their names have the numbers from the first on, in order."""
        numbers = {name: first + at for at, name in enumerate(self.names)}
        everything = [one.all() for one in self._shelves]
        for one in explanations:
            shelf = self.shelving.shelf(one.state)
            names, things = ([], []) if shelf is None else everything[shelf]
            state = one.state if shelf is None else self.shelving.brought(one.state, tuple(things))
            own = tuple([numbers[name] for name in names])
            gone = tuple(sorted({*one.gone, *numbers.values()}.difference(own)))
            yield evolve(one, state=state, names=(*own, *one.names), gone=gone)


def _kept(shelf: _Shelf | None) -> _Shelf:
    assert shelf is not None, "what stands for things stands for some"  # noqa: S101
    return shelf


class Depot:
    """What the explanations of a search have put away, each for itself; names keep their numbers there.

    Args:
        shelving: how the system puts things away.

    Attributes:
        names: the numbers of all names that were put away.
    """

    def __init__(self, shelving: Shelving) -> None:
        self._shelving = shelving
        self._shelves: list[_Shelf] = []
        self._numbers: dict[Hashable, int] = {}
        self._named: dict[Hashable, int] = {}
        self._same_names: list[int] = []
        self._last: tuple[Explanation, Explanation] | None = None
        self.names: set[int] = set()

    def without(self, explanation: Explanation, named_later: Callable[[int], bool]) -> Explanation:
        """The explanation once things are put away, if there are many; not those that calls or answers name later."""
        shelving = self._shelving
        state, shelf = explanation.state, shelving.shelf(explanation.state)
        front = shelving.front(state)
        if front < (LEAST if shelf is None else MORE) or _is_told(explanation, shelving):
            return explanation
        names = tuple(itertools.takewhile(lambda name: name > GONE and not named_later(name), explanation.names))
        names = names[: front - 1]
        if not names or not _apart(names, explanation):
            return explanation
        things = shelving.things(state, len(names) + 1)[shelf is not None :]
        put = shelving.put(state, len(names) + 1, self._number(shelf, names, things))
        self.names.update(names)
        return evolve(explanation, state=put, names=explanation.names[len(names) :])

    def _number(self, before: int | None, names: tuple[int, ...], things: tuple[Hashable, ...]) -> int:
        key = before, names, things
        number = self._numbers.get(key)
        if number is None:
            number = self._numbers[key] = len(self._shelves)
            self._shelves.append(_Shelf(None if before is None else self._shelves[before], names, things))
            named = None if before is None else self._same_names[before], names
            self._same_names.append(self._named.setdefault(named, number))
        return number

    def whole(self, explanation: Explanation) -> Explanation:
        """The explanation with all that was put away."""
        shelf = self._shelving.shelf(explanation.state)
        if shelf is None:
            return explanation
        if self._last is None or self._last[0] is not explanation:
            names, things = self._shelves[shelf].all()
            state = self._shelving.brought(explanation.state, tuple(things))
            self._last = explanation, evolve(explanation, state=state, names=(*names, *explanation.names))
        return self._last[1]

    def by_names(self, state: State, counted: State) -> State:
        """A state of which what has ended only counts, so that it is told apart by the names that were put away."""
        shelf = self._shelving.shelf(state)
        return counted if shelf is None else self._shelving.put(counted, 1, self._same_names[shelf])
