"""What an implementation may be doing, given what was observed of it: the belief automaton, built as it is walked.

A `Belief` is where one observed conversation stands. Its node is the set of all explanations; an event leads to the
next one. Nodes are interned and edges remembered in an `Automaton`, as a regular-expression engine builds its DFA: the
first walk along an edge computes, the second is a dictionary look-up. Names are kept beside the automaton, numbered in
the order in which the explanations mention them, so that the same situation with other names is the same node.
"""

from __future__ import annotations

import copy
import sys
from collections import deque
from collections.abc import Hashable, Iterable, Iterator

from missionfsm.kernel.history import (
    Called,
    Cancelled,
    Driven,
    Ended,
    Event,
    Name,
    Received,
    Returned,
    Settled,
)
from missionfsm.kernel.sequence import relation
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.terms import Incident
from missionfsm.kernel.transport import REDELIVERED
from missionfsm.oracle import memory
from missionfsm.oracle.automaton import Automaton, Edge, Node, Tally
from missionfsm.oracle.explanation import GONE
from missionfsm.oracle.successors import Successor
from missionfsm.oracle.symbols import Symbol

_NO_MARKS: dict[Hashable, int] = {}
_LARGER = ("larger",)
NOBODY = -sys.maxsize
"""The number of a channel of which an end was seen: nothing has it, so nothing explains that it ends again."""

MAX_WALKED = 32
"""How many events are remembered, so that a violation can name the rules of what has happened."""


class Belief:
    """Where one observed conversation stands.

    ``observe`` returns False once no explanation is left; from then on it stays so, and `node` is the last one that
    had explanations.

    `unfollowed` has the bits of the readings that explanations may follow which a search has left aside; while it is
    not 0, the explanations of the node are not all there are.

    Args:
        automaton: the automaton that it walks.
        world: where it begins.
        tally: counts what is exercised; the automaton's own if none.
        past: the names of what was there before, where the instance was used; None for a fresh one.
    """

    __slots__ = (
        "_ended",
        "_given_up",
        "_lasting",
        "_latest",
        "_marks",
        "_names",
        "_numbers",
        "_renumbered",
        "_retired",
        "_tally",
        "_walked",
        "automaton",
        "broken",
        "node",
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
        self._names: list[Name] = []
        self._numbers: dict[Name, int] = {}
        self._retired: dict[Name, None] = dict.fromkeys(past or ())
        self._given_up: dict[Name, None] = {}
        self._ended: dict[Name, None] = {}
        self._lasting: dict[Name, tuple[tuple[str, Hashable], ...]] = {}
        self._latest: dict[Name, Received] = {}
        self._marks: dict[Name, dict[Hashable, int]] = {}
        self._renumbered: set[tuple[Name, Hashable]] = set()
        self._walked: deque[tuple[Symbol, Node]] = deque(maxlen=MAX_WALKED)

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
        kind = type(event)
        if self._given_up and (kind is Received or kind is Ended) and event.channel in self._given_up:  # type: ignore[union-attr]
            return True  # what still comes on a stream that was given up means nothing
        symbol, new = self.symbol(event)
        edge = self.node.next.get(symbol)
        if edge is None:
            edge = self.automaton.edge(self.node, symbol)
        self._tally[edge.exercises] += 1
        if not edge.node.explanations:
            self.broken = True
            return False
        self._walked.append((symbol, self.node))
        self.node = edge.node
        self.touched |= edge.touched
        if edge.keep is not None:
            self._rename(edge, edge.keep, new)
        if kind is Received or kind is Driven or kind is Cancelled or kind is Ended:
            self._note(event)
        return True

    @property
    def awaits(self) -> bool:
        """Whether more has to be seen before everything was, unless something was lost on the way."""
        if self.broken:
            return False
        transitions = self.automaton.transitions
        transitions.successors.reset()
        return next(iter(transitions.explained(self.node.explanations, Settled)), None) is None

    def _note(self, event: Event) -> None:
        """Remember what an event says of the numbers on a channel."""
        if type(event) is Received:
            self._latest[event.channel] = event
            lasting = self.automaton.spec.lasting
            if lasting is not None:
                for name, shown in zip(event.names, lasting(event.content), strict=False):
                    self._lasting.setdefault(name, shown)
            if event.marks:
                self._mark(event.channel, event.marks)
        elif type(event) is Driven:
            self._renumber(event.event)
        elif type(event) is Cancelled:
            self._given_up[event.channel] = None
            self._unmark(event.channel)
            self._forget_oldest(self._given_up)
        elif type(event) is Ended and self.automaton.spec.closing is not None:
            self._ended[event.channel] = None
            self._forget_oldest(self._ended)

    # A window of events that are searched together.

    def lookout(self) -> Belief:
        """A belief at the same point to number events with, of which this one learns nothing."""
        other = copy.copy(self)
        other.node = Node(self.node.explanations, self.node.width)
        other._names, other._numbers = self._names.copy(), self._numbers.copy()  # noqa: SLF001 - of the same class
        other._retired, other._given_up = self._retired.copy(), self._given_up.copy()  # noqa: SLF001
        other._ended = self._ended.copy()  # noqa: SLF001
        other._marks = {channel: tracks.copy() for channel, tracks in self._marks.items()}  # noqa: SLF001
        other._lasting = self._lasting.copy()  # noqa: SLF001
        other._latest = self._latest.copy()  # noqa: SLF001
        other._renumbered = self._renumbered.copy()  # noqa: SLF001
        return other

    @property
    def latest(self) -> dict[int, tuple[Hashable, tuple[int, ...]]]:
        """What each channel has shown last, with numbers for names."""
        number = self._numbers.get
        return {
            number(channel, GONE): (event.content, tuple(number(name, GONE) for name in event.names))
            for channel, event in self._latest.items()
        }

    def number_for_good(self, event: Event) -> Symbol | None:
        """An event with numbers for names, and the new names numbered for good; None for one that means nothing."""
        if type(event) in (Received, Ended) and event.channel in self._given_up:  # type: ignore[union-attr]
            return None
        symbol, new = self.symbol(event)
        for name in new:
            self._numbers[name] = len(self._names)
            self._names.append(name)
        self.node.width = len(self._names)
        self._note(event)
        return symbol

    def leap(self, lookout: Belief, found: tuple[Successor, ...], exercised: Iterable[tuple[str, ...]]) -> None:
        """Go to where a search has led that numbered its events with a lookout.

        Args:
            found: the explanations after the last event.
            exercised: the sets of rules that were exercised on the way.
        """
        edge = self.automaton.arrive(lookout.node, found)
        for rules in exercised:
            self._tally[self.automaton.numbered(rules)] += 1
        self._names, self._numbers = lookout._names, lookout._numbers
        self._retired, self._given_up, self._ended = lookout._retired, lookout._given_up, lookout._ended
        self._latest, self._lasting = lookout._latest, lookout._lasting
        self._marks, self._renumbered = lookout._marks, lookout._renumbered
        self.node = edge.node
        if edge.keep is not None:
            self._rename(edge, edge.keep, [])

    def symbol(self, event: Event) -> tuple[Symbol, list[Name]]:
        """The event with numbers for names, as the automaton knows it, and the names that are new."""
        numbers = self._numbers
        new: list[Name] = []
        if type(event) is Called:
            args = self._number(event.names, new) if event.names else ()
            call = GONE if event.lost else numbers.get(event.call)
            if call is None:
                call = self._number_anew(event.call, new)
            return (Called, event.request, args, event.lost, call), new
        if type(event) is Returned:
            args = self._number(event.names, new) if event.names else ()
            return (Returned, event.answer, args, numbers.get(event.call, GONE)), new
        if type(event) is Received:
            channel = numbers.get(event.channel)
            if channel is None:
                channel = self._number_anew(event.channel, new)
            args = self._number(event.names, new) if event.names else ()
            relations = self._relations(event.channel, event.marks) if event.marks else ()
            if event.names and self.automaton.spec.lasting is not None:
                relations += self._changes(event)
            if event.repeats_last and self.automaton.spec.transport:
                relations = (*relations, REDELIVERED)
            return (Received, event.content, args, relations, channel), new
        if type(event) is Settled:
            return (Settled,), new
        if type(event) is Driven:
            return (Driven, event.event, self._number(event.names, new)), new
        if type(event) is Ended:
            if event.channel in self._ended:
                return (Ended, event.code, NOBODY), new
            (channel,) = self._number((event.channel,), new)
            return (Ended, event.code, channel), new
        if type(event) is Cancelled:
            return (Cancelled, numbers.get(event.channel, GONE)), new
        message = f"not an event: {event!r}"
        raise TypeError(message)

    def _number(self, names: tuple[Name, ...], new: list[Name]) -> tuple[int, ...]:
        numbers = tuple(map(self._numbers.get, names))
        if None in numbers:
            return tuple(
                self._number_anew(name, new) if number is None else number
                for name, number in zip(names, numbers, strict=True)
            )
        return numbers  # type: ignore[return-value]  # none is None

    def _number_anew(self, name: Name, new: list[Name]) -> int:
        if name in self._retired:
            return GONE
        if name in new:
            return self.node.width + new.index(name)
        new.append(name)
        return self.node.width + len(new) - 1

    def _changes(self, event: Received) -> tuple[str, ...]:
        """What a message changes of what may never change; asking changes nothing."""
        lasting = self.automaton.spec.lasting
        found: dict[str, None] = {}
        for name, shown in zip(event.names, lasting(event.content) if lasting else (), strict=False):
            known = self._lasting.get(name, shown)
            if known is not shown and known != shown:
                found.update(
                    dict.fromkeys(after[0] for before, after in zip(known, shown, strict=True) if before != after)
                )
        return tuple(found)

    def _relations(self, channel: Name, marks: tuple[tuple[Hashable, int], ...]) -> tuple[str, ...]:
        """How the numbers of a message compare with those before; asking changes nothing."""
        tracks = self._marks.get(channel, _NO_MARKS)
        if len(marks) == 1 and marks[0][1] > tracks.get(marks[0][0], marks[0][1]) and marks[0][1] > 0:
            return _LARGER  # nearly always, and faster so
        relations = []
        for track, number in marks:
            found = relation(tracks.get(track), number)
            if found in ("smaller", "equal") and (channel, track) in self._renumbered:
                found = "renumbered"
            relations.append(found)
        return tuple(relations)

    def _mark(self, channel: Name, marks: tuple[tuple[Hashable, int], ...]) -> None:
        tracks = self._marks.setdefault(channel, {})
        if not self._renumbered:
            tracks.update(marks)
            return
        for track, number in marks:
            # A number that is smaller is the first since the numbers started over; an equal one may be the last before.
            if number < tracks.get(track, number):
                self._renumbered.discard((channel, track))
            tracks[track] = number

    def _unmark(self, channel: Name) -> None:
        """A channel numbers nothing any more."""
        self._latest.pop(channel, None)
        if self._renumbered:
            self._renumbered.difference_update((channel, track) for track in self._marks.get(channel, _NO_MARKS))
        self._marks.pop(channel, None)

    def _renumber(self, event: Incident) -> None:
        renumbers = self.automaton.spec.drives[event.name].renumbers
        for track in renumbers(event) if renumbers else ():
            self._renumbered.update((channel, track) for channel, tracks in self._marks.items() if track in tracks)

    def _rename(self, edge: Edge, keep: tuple[int, ...], new: list[Name]) -> None:
        if edge.appends and len(keep) == len(self._names) + len(new):
            for name in new:
                self._numbers[name] = len(self._names)
                self._names.append(name)
            return
        if edge.cuts:
            while len(self._names) > len(keep):
                del self._numbers[self._names.pop()]
            return
        names = self._names + new
        for number in edge.retired:
            self._retire(names[number])
        self._names = [names[number] for number in keep]
        self._numbers = {name: number for number, name in enumerate(self._names)}

    def _retire(self, name: Name) -> None:
        self._lasting.pop(name, None)
        self._retired[name] = None
        self._unmark(name)
        self._forget_oldest(self._retired)

    def _forget_oldest(self, names: dict[Name, None]) -> None:
        """Keep no more names that are gone than there is room for."""
        if len(names) * memory.NAME > self.automaton.memory // memory.NAMES:
            del names[next(iter(names))]

    def name(self, number: int) -> Name | None:
        """The observed name with a number, or None for one that nobody has seen."""
        return self._names[number] if 0 <= number < len(self._names) else None

    def number(self, name: Name) -> int:
        """The number of an observed name, `GONE` for one that nothing has."""
        return self._numbers.get(name, GONE)

    def last_mark(self, channel: Name, track: Hashable) -> int | None:
        """The number that a channel showed last on a track, or None."""
        return self._marks.get(channel, _NO_MARKS).get(track)

    @property
    def walked(self) -> Iterator[tuple[Symbol, Node]]:
        """The last events with numbers for names, each with the node before it, the latest first."""
        yield from reversed(self._walked)

    @property
    def exercised_last(self) -> Iterator[tuple[Symbol, tuple[str, ...]]]:
        """The same events, each with ids of the rules that it exercised."""
        sets = self.automaton.numbers
        for symbol, node in reversed(self._walked):
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
