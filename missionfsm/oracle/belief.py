"""What an implementation may be doing, given what was observed of it: the belief automaton, built as it is walked.

A `Belief` is where one observed conversation stands. Its node is the set of all explanations; an event leads to the
next one. Nodes are interned and edges remembered in an `Automaton`, as a regular-expression engine builds its DFA: the
first walk along an edge computes, the second is a dictionary look-up. Names are kept beside the automaton, numbered in
the order in which the explanations mention them, so that the same situation with other names is the same node.
"""

from __future__ import annotations

import copy
from collections import deque
from collections.abc import Hashable, Iterable, Iterator, Mapping

from missionfsm.kernel.history import Called, Cancelled, Driven, Ended, Event, Name, Received, Returned, Settled
from missionfsm.kernel.spec import Spec
from missionfsm.oracle import memory
from missionfsm.oracle.automaton import Automaton, Edge, Node, Tally
from missionfsm.oracle.numbering import Numbered, Numbering
from missionfsm.oracle.shelf import LEAST, Shelves
from missionfsm.oracle.successors import ExhaustedError, Successor
from missionfsm.oracle.symbols import Symbol

MAX_WALKED = 32
"""How many events are remembered, so that a violation can name the rules of what has happened."""


class Belief:
    """Where one observed conversation stands.

    ``observe`` returns False once no explanation is left; from then on it stays so, and `node` is the last one that
    had explanations.

    `unfollowed` has the bits of the readings that explanations may follow which a search has left aside; while it is
    not 0, the explanations of the node are not all there are.

    `presumed` is the belief before an answer that nothing but a restart explains, until that restart is seen.

    Args:
        automaton: the automaton that it walks.
        world: where it begins.
        tally: counts what is exercised; the automaton's own if none.
        past: the names of what was there before, where the instance was used; None for a fresh one.
    """

    __slots__ = (
        "_numbering",
        "_shelves",
        "_tally",
        "_walked",
        "automaton",
        "broken",
        "node",
        "presumed",
        "touched",
        "unfollowed",
    )

    def __init__(
        self, automaton: Automaton, world: object, tally: Tally | None = None, past: Iterable[Name] | None = None
    ) -> None:
        self.automaton = automaton
        self._tally = automaton.tally if tally is None else tally
        self.node = automaton.start(world, used=past is not None)
        self.broken = False
        self.touched = 0
        self.unfollowed = 0
        self.presumed: Belief | None = None
        self._numbering = Numbering(automaton.spec, automaton.memory // memory.NAMES, past or ())
        self._walked: deque[tuple[Symbol, Node, Shelves | None]] = deque(maxlen=MAX_WALKED)
        self._shelves = Shelves(automaton.shelving) if automaton.shelving else None

    @property
    def spec(self) -> Spec:
        """The system."""
        return self.automaton.spec

    def observe(self, event: Event) -> bool:
        """Take one event into account; False when nothing explains it.

        Raises:
            ExhaustedError: it costs too much to decide.
        """
        if self.broken:
            return False
        kind, numbering = type(event), self._numbering
        if numbering.given_up and self._was_given_up(event):
            return True  # what still comes on a stream that was given up means nothing
        if self._concerns_what_is_away(event):
            self._bring_back()
        symbol, new = numbering.symbol(event)
        edge = self.node.next.get(symbol) or self._edge(symbol)
        if self._has_to_bring_back(edge):
            self._bring_back()
            symbol, new = numbering.symbol(event)
            edge = self.node.next.get(symbol) or self._edge(symbol)
        self._tally[edge.exercises] += 1
        if not edge.node.explanations:
            self.broken = True
            return False
        self._follow(symbol, edge, new)
        if kind is Received or kind is Driven or kind is Cancelled or kind is Ended:
            numbering.note(event)
        self._put_away()
        return True

    def _was_given_up(self, event: Event) -> bool:
        """Whether an event is of a stream that was given up."""
        return isinstance(event, Received | Ended) and event.channel in self._numbering.given_up

    def _concerns_what_is_away(self, event: Event) -> bool:
        """Whether an event is about what is put away."""
        shelves = self._shelves
        return shelves is not None and bool(shelves.names) and shelves.concern(event)

    def _has_to_bring_back(self, edge: Edge) -> bool:
        """Whether what is put away may explain an event better than what is left."""
        shelves = self._shelves
        return bool(shelves and shelves.names) and (edge.beyond_system or not edge.node.explanations)

    def _follow(self, symbol: Symbol, edge: Edge, new: list[Name]) -> None:
        """Go along an edge."""
        if edge.presumes and self.presumed is None:
            self.presumed = self._as_it_was()
        self._walked.append((symbol, self.node, self._shelves))
        self.node = edge.node
        self.touched |= edge.touched
        if edge.keep is not None:
            self._numbering.follow(edge, new)

    def _edge(self, symbol: Symbol) -> Edge:
        """Compute where an event leads that has not come here before."""
        try:
            return self.automaton.edge(self.node, symbol)
        except ExhaustedError:
            self._bring_back()  # what comes next is searched for, from here on
            raise

    def _put_away(self) -> None:
        """Put away what decides nothing any more, if that is worth it."""
        shelves = self._shelves
        if shelves is None or not (shelves.names or self.node.width >= LEAST):
            return
        found = self.automaton.away(self.node, shelves.shelving, 2 if shelves.names else LEAST)
        if found:
            what, edge = found
            self._shelves = shelves.with_more(what, [self._numbering.name(number) for number in what.names])
            self._go(edge)

    def _bring_back(self) -> None:
        """Bring back what was put away."""
        shelves, numbering = self._shelves, self._numbering
        if shelves is None or not shelves.names:
            return
        whole = tuple(map(Successor, shelves.brought(self.node.explanations, len(numbering))))
        numbering.append(shelves.names)
        self._shelves = Shelves(shelves.shelving)
        self._go(self.automaton.arrive(Node(self.node.explanations, len(numbering)), whole))

    def _go(self, edge: Edge) -> None:
        self.node = edge.node
        self._numbering.follow(edge, [])

    def _as_it_was(self) -> Belief:
        """A belief at the same point that goes on by itself, and never presumes a restart."""
        other = self.lookout()
        other._walked = self._walked.copy()  # noqa: SLF001 - of the same class
        other.automaton = self.automaton.without_restarts
        other.node = other.automaton.adopt(self.node)
        return other

    def nothing_is_late(self) -> None:
        """From now on nothing that was on its way when the log began explains an event."""
        self.node = self.automaton.all_known(self.node)

    @property
    def of_last_event(self) -> Belief:
        """This belief; of a system in parts it is that of the part which the last event was about."""
        return self

    @property
    def exercised(self) -> dict[str, int]:
        """How often each rule was exercised, by its tally."""
        return self.automaton.exercised(self._tally)

    @property
    def awaits(self) -> bool:
        """Whether more has to be seen before everything was, unless something was lost on the way."""
        if self.broken:
            return False
        transitions = self.automaton.transitions
        transitions.successors.reset()
        return next(iter(transitions.explained(self.node.explanations, Settled)), None) is None

    # A window of events that are searched together.

    def lookout(self) -> Belief:
        """A belief at the same point to number events with, of which this one learns nothing."""
        self._bring_back()
        other = copy.copy(self)
        other._shelves = None  # noqa: SLF001 - of the same class
        other._numbering = self._numbering.copy()  # noqa: SLF001 - of the same class
        return other

    @property
    def latest(self) -> Mapping[int, tuple[Hashable, tuple[int, ...]]]:
        """What each channel has shown last, with numbers for names."""
        return self._numbering.latest

    def number_for_good(self, event: Event) -> Symbol | None:
        """An event with numbers for names, and the new names numbered for good; None for one that means nothing."""
        kind, numbering = type(event), self._numbering
        if numbering.given_up and self._was_given_up(event):
            return None
        symbol, new = numbering.symbol(event)
        if new:
            numbering.append(new)
        if kind is not Called and kind is not Returned:
            numbering.note(event)
        return symbol

    def leap(self, lookout: Belief, found: tuple[Successor, ...], exercised: Iterable[tuple[str, ...]]) -> None:
        """Go to where a search has led that numbered its events with a lookout.

        Args:
            found: the explanations after the last event.
            exercised: the sets of rules that were exercised on the way.
        """
        numbering = self._numbering = lookout._numbering
        edge = self.automaton.arrive(Node(self.node.explanations, len(numbering)), found)
        for rules in exercised:
            self._tally[self.automaton.numbered(rules)] += 1
        self._go(edge)

    def symbol(self, event: Event) -> Numbered:
        """The event with numbers for names, as the automaton knows it, and the names that are new."""
        return self._numbering.symbol(event)

    def name(self, number: int) -> Name | None:
        """The observed name with a number, or None for one that nobody has seen."""
        return self._numbering.name(number)

    def number(self, name: Name) -> int:
        """The number of an observed name, `GONE` for one that nothing has."""
        return self._numbering.number(name)

    def last_mark(self, channel: Name, track: Hashable) -> int | None:
        """The number that a channel showed last on a track, or None."""
        return self._numbering.last_mark(channel, track)

    @property
    def walked(self) -> Iterator[tuple[Symbol, Node]]:
        """The last events with numbers for names, each with the node before it, the latest first."""
        for symbol, node, shelves in reversed(self._walked):
            if shelves is not None and shelves.names:
                node = Node(tuple(shelves.brought(node.explanations, node.width)), 0)  # noqa: PLW2901 - as it was
            yield symbol, node

    def whole(self, before: Node) -> Node:
        """The node before the last event, with all that was put away there."""
        return before if self._shelves is None else next((node for _, node in self.walked), before)

    @property
    def exercised_last(self) -> Iterator[tuple[Symbol, tuple[str, ...]]]:
        """The same events, each with ids of the rules that it exercised."""
        sets = self.automaton.numbers
        for symbol, node, _ in reversed(self._walked):
            edge = node.next.get(symbol)
            yield symbol, () if edge is None else sets[edge.exercises]

    @property
    def readings(self) -> dict[str, tuple[str, ...]]:
        """For every ambiguity that mattered so far: the readings that some explanation still follows."""
        found = {}
        left = self.left
        for ambiguity in self.automaton.spec.ambiguities:
            if self.touched & ambiguity.group or any(
                one.assumed & ambiguity.group != ambiguity.group for one in self.node.explanations
            ):
                found[ambiguity.id] = ambiguity.possible(left)
        return found

    @property
    def ways(self) -> list[int]:
        """What each explanation assumes."""
        return [one.assumed for one in self.node.explanations]

    @property
    def left(self) -> int:
        """The bits of all readings that some explanation still follows, as far as is known."""
        left = self.unfollowed
        for one in self.node.explanations:
            left |= one.assumed
        return left
