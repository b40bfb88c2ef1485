"""The names of one conversation, beside the belief automaton: their numbers, and what is known of them.

A name has the number of its place among those that the explanations carry, so that the same situation with other names
is the same node. What makes a symbol of an event stands here, and what outlives a node: which names are gone, which
numbers a channel counted up to, what a thing showed that may never change.
"""

from __future__ import annotations

import sys
from collections.abc import Hashable, Iterable, Mapping

from missionfsm.kernel.history import Called, Cancelled, Driven, Ended, Event, Name, Received, Returned, Settled
from missionfsm.kernel.sequence import STALE, relation
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.terms import Incident
from missionfsm.kernel.transport import REDELIVERED
from missionfsm.oracle import memory
from missionfsm.oracle.automaton import Edge
from missionfsm.oracle.explanation import GONE
from missionfsm.oracle.symbols import Observer, Symbol

_NO_MARKS: dict[Hashable, int] = {}
_LARGER = ("larger",)
_STALE = (STALE,)
_SHOWN_AGAIN, _STARTED_OVER = frozenset({"equal"}), frozenset({"equal", "smaller"})
"""How a number may compare with its predecessor because of something that has happened since."""
NOBODY = -sys.maxsize
"""The number of a channel of which an end was seen: nothing has it, so nothing explains that it ends again."""

Numbered = tuple[Symbol, list[Name]]
"""An event with numbers for names, and the names in it that are new."""


class Numbering:
    """Numbers for names, and what is known of names.

    Args:
        spec: the system.
        room: how many bytes the names may take that are gone, by estimate.
        past: the names of what was there before.

    Attributes:
        given_up: the channels that were cancelled; what still comes on them means nothing.
    """

    __slots__ = (
        "_ended",
        "_lasting",
        "_latest",
        "_marks",
        "_names",
        "_numbers",
        "_renumbered",
        "_retired",
        "_room",
        "given_up",
        "spec",
    )

    def __init__(self, spec: Spec, room: int, past: Iterable[Name] = ()) -> None:
        self.spec = spec
        self._room = room
        self._names: list[Name] = []
        self._numbers: dict[Name, int] = {}
        self._retired: dict[Name, None] = dict.fromkeys(past)
        self.given_up: dict[Name, None] = {}
        self._ended: dict[Name, None] = {}
        self._lasting: dict[Name, tuple[tuple[str, Hashable], ...]] = {}
        self._latest: dict[Name, Received] = {}
        self._marks: dict[Name, dict[Hashable, int]] = {}
        self._renumbered: dict[tuple[Name, Hashable], frozenset[str]] = {}

    def copy(self) -> Numbering:
        """One that knows the same and goes on by itself."""
        other = Numbering(self.spec, self._room)
        for known in self.__slots__:
            one = getattr(self, known)
            setattr(other, known, one.copy() if isinstance(one, dict | list | set) else one)
        other._marks = {channel: tracks.copy() for channel, tracks in self._marks.items()}
        return other

    def __len__(self) -> int:
        """How many names have a number."""
        return len(self._names)

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
    def latest(self) -> Mapping[int, tuple[Hashable, tuple[int, ...]]]:
        """What each channel has shown last, with numbers for names."""
        number = self._numbers.get
        return {
            number(channel, GONE): (event.content, tuple(number(name, GONE) for name in event.names))
            for channel, event in self._latest.items()
        }

    # An event with numbers for names. Asking changes nothing.

    def symbol(self, event: Event) -> Numbered:
        """The event with numbers for names, as the automaton knows it, and the names that are new."""
        numbered = _NUMBERED.get(type(event))
        if numbered is None:
            message = f"not an event: {event!r}"
            raise TypeError(message)
        return numbered(self, event)

    def _called(self, event: Called) -> Numbered:
        new: list[Name] = []
        args = self._number(event.names, new) if event.names else ()
        call = GONE if event.lost else self._numbers.get(event.call)
        if call is None:
            call = self._number_anew(event.call, new)
        return (Called, event.request, args, event.lost, call), new

    def _returned(self, event: Returned) -> Numbered:
        new: list[Name] = []
        args = self._number(event.names, new) if event.names else ()
        return (Returned, event.answer, args, self._numbers.get(event.call, GONE)), new

    def _received(self, event: Received) -> Numbered:
        new: list[Name] = []
        channel = self._numbers.get(event.channel)
        if channel is None:
            channel = self._number_anew(event.channel, new)
        args = self._number(event.names, new) if event.names else ()
        relations = self._relations(event.channel, event.marks) if event.marks else ()
        if event.stale and "equal" in relations:
            relations += _STALE
        if event.names and self.spec.lasting is not None:
            relations += self._changes(event)
        if event.repeats_last and self.spec.transport:
            relations = (*relations, REDELIVERED)
        return (Received, event.content, args, relations, channel), new

    def _settled(self, _: Settled) -> Numbered:
        return (Settled,), []

    def _driven(self, event: Driven) -> Numbered:
        new: list[Name] = []
        revives = bool(event.names) and self.spec.drives[event.event.name].revives  # type: ignore[attr-defined]
        return (Driven, event.event, self._number(event.names, new, revives=revives)), new

    def _ended_by_itself(self, event: Ended) -> Numbered:
        new: list[Name] = []
        if event.channel in self._ended:
            return (Ended, event.code, NOBODY), new
        (channel,) = self._number((event.channel,), new)
        return (Ended, event.code, channel), new

    def _cancelled(self, event: Cancelled) -> Numbered:
        return (Cancelled, self._numbers.get(event.channel, GONE)), []

    def _number(self, names: tuple[Name, ...], new: list[Name], *, revives: bool = False) -> tuple[int, ...]:
        numbers = tuple(map(self._numbers.get, names))
        if None in numbers:
            return tuple(
                self._number_anew(name, new, revives=revives) if number is None else number
                for name, number in zip(names, numbers, strict=True)
            )
        return numbers  # type: ignore[return-value]  # none is None

    def _number_anew(self, name: Name, new: list[Name], *, revives: bool = False) -> int:
        if name in self._retired and not revives:
            return GONE
        if name in new:
            return len(self._names) + new.index(name)
        new.append(name)
        return len(self._names) + len(new) - 1

    def _changes(self, event: Received) -> tuple[str, ...]:
        """What a message changes of what may never change."""
        lasting = self.spec.lasting(event.content) if self.spec.lasting else ()
        if tuple(map(self._lasting.get, event.names)) == lasting:
            return ()  # nearly always, and faster so
        found: dict[str, None] = {}
        for name, shown in zip(event.names, lasting, strict=False):
            known = self._lasting.get(name, shown)
            if known is not shown and known != shown:
                found.update(
                    dict.fromkeys(after[0] for before, after in zip(known, shown, strict=True) if before != after)
                )
        return tuple(found)

    def _relations(self, channel: Name, marks: tuple[tuple[Hashable, int], ...]) -> tuple[str, ...]:
        """How the numbers of a message compare with those before."""
        tracks = self._marks.get(channel, _NO_MARKS)
        if len(marks) == 1 and marks[0][1] > tracks.get(marks[0][0], marks[0][1]) and marks[0][1] > 0:
            return _LARGER  # nearly always, and faster so
        relations = []
        for track, number in marks:
            how = relation(tracks.get(track), number)
            if how in self._renumbered.get((channel, track), ()):
                how = "renumbered"
            relations.append(how)
        return tuple(relations)

    # What becomes of names.

    def append(self, new: Iterable[Name]) -> None:
        """Number new names, behind all others."""
        for name in new:
            self._numbers[name] = len(self._names)
            self._names.append(name)

    def follow(self, edge: Edge, new: list[Name]) -> None:
        """Number the names as the node does to which an edge leads.

        Args:
            new: the new names of the event.
        """
        keep = edge.keep
        if keep is None:
            return
        if edge.appends and len(keep) == len(self._names) + len(new):
            self.append(new)
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

    def note(self, event: Event) -> None:
        """Remember what an event that was explained says of the names in it."""
        if type(event) is Received:
            self._latest[event.channel] = event
            lasting = self.spec.lasting(event.content) if self.spec.lasting else ()
            if lasting and tuple(map(self._lasting.get, event.names)) != lasting:
                for name, shown in zip(event.names, lasting, strict=False):
                    self._lasting.setdefault(name, shown)
            if event.marks:
                self._mark(event.channel, event.marks)
        elif type(event) is Driven:
            self._renumber(event.event)
        elif type(event) is Cancelled:
            self.given_up[event.channel] = None
            self._unmark(event.channel)
            self._forget_oldest(self.given_up)
        elif type(event) is Ended and self.spec.closing is not None:
            self._ended[event.channel] = None
            self._forget_oldest(self._ended)

    def _mark(self, channel: Name, marks: tuple[tuple[Hashable, int], ...]) -> None:
        """A channel has shown these numbers."""
        tracks = self._marks.setdefault(channel, {})
        if not self._renumbered:
            tracks.update(marks)
            return
        for track, number in marks:
            # A number that is smaller is the first since the numbers started over; an equal one may be the last before.
            if number < tracks.get(track, number):
                self._renumbered.pop((channel, track), None)
            tracks[track] = number

    def _unmark(self, channel: Name) -> None:
        """A channel numbers nothing any more."""
        self._latest.pop(channel, None)
        if self._renumbered:
            for track in self._marks.get(channel, _NO_MARKS):
                self._renumbered.pop((channel, track), None)
        self._marks.pop(channel, None)

    def _renumber(self, event: Incident) -> None:
        """The numbers of some tracks start over, or what came last may come again with its number."""
        drive = self.spec.drives[event.name]
        for which, excused in ((drive.shows_again, _SHOWN_AGAIN), (drive.renumbers, _STARTED_OVER)):
            for track in which(event) if which else ():
                for channel, tracks in self._marks.items():
                    if track in tracks and self._renumbered.get((channel, track)) is not _STARTED_OVER:
                        self._renumbered[channel, track] = excused

    def _retire(self, name: Name) -> None:
        """The thing with a name is no more."""
        self._lasting.pop(name, None)
        self._retired[name] = None
        self._unmark(name)
        self._forget_oldest(self._retired)

    def _forget_oldest(self, names: dict[Name, None]) -> None:
        """Keep no more names that are gone than there is room for."""
        if len(names) * memory.NAME > self._room:
            del names[next(iter(names))]


_NUMBERED: Mapping[type, Observer[Numbered]] = {
    Called: Numbering._called,  # noqa: SLF001 - the table belongs to the class
    Returned: Numbering._returned,  # noqa: SLF001
    Received: Numbering._received,  # noqa: SLF001
    Settled: Numbering._settled,  # noqa: SLF001
    Driven: Numbering._driven,  # noqa: SLF001
    Ended: Numbering._ended_by_itself,  # noqa: SLF001
    Cancelled: Numbering._cancelled,  # noqa: SLF001
}


__all__ = ["Numbered", "Numbering"]
