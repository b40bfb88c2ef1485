"""What a channel owes, aligned with the messages that it is known to show next.

Aligning is what conformance checking calls it: each message is matched with one that is owed, in order, and what is
owed between two matches is passed over, where the delivery lets it be.
"""

from __future__ import annotations

from collections.abc import Hashable

from attrs import define, field

from missionfsm.kernel.spec import Delivery, Spec
from missionfsm.kernel.step import Match, Mismatch
from missionfsm.kernel.terms import View
from missionfsm.oracle.explanation import GONE, Channel, Names, Owed

Message = tuple[Hashable, Names]
"""What a message shows: its content, and the names in it."""

Shown = dict[int, bool]
"""By the identity of a message: whether it may be a certain one that is owed, as far as that was looked at."""


class Showings:
    """Which messages may be which that are owed; remembered.

    Args:
        spec: the system.
    """

    def __init__(self, spec: Spec) -> None:
        self._spec = spec
        self._shown: dict[Owed, Shown] = {}
        self._matches: dict[tuple[View, Hashable], tuple[Match, ...] | Mismatch] = {}

    def forget(self) -> None:
        """Drop what is remembered; it can be found out again."""
        self._shown.clear()
        self._matches.clear()

    def of(self, owed: Owed) -> Shown:
        """What is known of one that is owed."""
        found = self._shown.get(owed)
        if found is None:
            found = self._shown[owed] = {}
        return found

    def may_be(self, owed: Owed, message: Message, shown: Shown | None = None) -> bool:
        """Whether a message may be one that is owed; of which `shown` is what is known, if that is at hand."""
        known = self.of(owed) if shown is None else shown
        found = known.get(id(message))
        if found is None:
            found = known[id(message)] = bool(self.ways(owed, message))
        return found

    def ways(self, owed: Owed, message: Message) -> list[Match]:
        """The ways in which a message may be one that is owed."""
        content, names = message
        matches = self._matched(owed.view, content)
        return [
            match
            for match in (() if isinstance(matches, Mismatch) else matches)
            if all(owed.names[ref] == names[at] or owed.names[ref] < GONE for ref, at in match.names)
        ]

    def _matched(self, view: View, content: Hashable) -> tuple[Match, ...] | Mismatch:
        """The ways in which a message may show a view, whatever the names are."""
        key = view, content
        found = self._matches.get(key)
        if found is None:
            found = self._matches[key] = self._spec.matches(view, content)
        return found


@define(eq=False, slots=True)
class Alignment:
    """How far a channel has come that shows one message after the other.

    Attributes:
        channel: the channel.
        delivery: how its messages travel.
        showings: which messages may be which that are owed.
        skips: whether the channel may pass over what it owes.
        repeats: whether it may show again what it has shown.
        places: how many of those that it owes may lie behind it, shown or passed over: any of these numbers.
    """

    channel: Channel
    delivery: Delivery
    showings: Showings
    skips: bool
    repeats: bool
    places: set[int] = field(factory=lambda: {0})
    _shown: list[Shown] = field(init=False)
    _repeatable: list[tuple[Shown, Owed]] = field(init=False, factory=list)
    _passable: list[bool] = field(init=False, factory=list)
    _before: dict[View, list[Names]] = field(init=False, factory=dict)

    def __attrs_post_init__(self) -> None:
        showings, last = self.showings, self.channel.last
        self._shown = [showings.of(one) for one in self.channel.owed]
        if self.repeats or self.delivery.echoes is not None:
            self._repeatable = [*zip(self._shown, self.channel.owed, strict=True)]
            if last is not None:
                self._repeatable.append((showings.of(last), last))
        if last is not None:
            self._before[last.view] = [last.names]

    def goes_on(self, message: Message) -> bool:
        """Go on to where the channel may be once it has shown a message; where it cannot, stay and say so."""
        owed, shown, may_be, number = self.channel.owed, self._shown, self.showings.may_be, id(message)
        following: set[int] = set()
        looked = -1
        for place in sorted(self.places) if len(self.places) > 1 else self.places:
            for index in range(place if place > looked else looked + 1, len(owed)):
                may = shown[index].get(number)
                if may or (may is None and may_be(owed[index], message, shown[index])):
                    following.add(index if owed[index].stays else index + 1)
                looked = index
                if not self.passable(index):
                    break
        if self._repeatable and any(may_be(one, message, known) for known, one in self._repeatable):
            following |= self.places
        self.places = following or self.places
        return bool(following)

    @property
    def place(self) -> int:
        """How many of those that it owes lie behind it at most."""
        return max(self.places)

    def passable(self, index: int) -> bool:
        """Whether the channel may pass over a message that it owes."""
        known = self._passable
        while len(known) <= index:
            known.append(self.skips or self._goes_unsaid(self.channel.owed[len(known)]))
        return known[index]

    def goes_unsaid(self, index: int) -> bool:
        """Whether the channel may pass over a message that it owes although it has to show all that can be told."""
        if not self.skips:
            return self.passable(index)
        return [self._goes_unsaid(one) for one in self.channel.owed[: index + 1]][index]

    def _goes_unsaid(self, owed: Owed) -> bool:
        """The same of the first that was not looked at: it may look like one before it."""
        before = self._before.setdefault(owed.view, [])
        same = (
            owed.passing
            or not owed.names
            or (not self.delivery.every_time and any(_may_be_those(owed.names, one) for one in before))
        )
        before.append(owed.names)
        return same

    @property
    def may_show_what_is_to_come(self) -> bool:
        """Whether the next message may be one that is not owed yet: all that is owed before it goes unsaid then."""
        return all(map(self.passable, range(self.place, len(self.channel.owed))))


def may_look_alike(one: Owed, other: Owed) -> bool:
    """Whether two that are owed may be found to show the same of the same."""
    view = one.view
    same = other.view is view or (hash(other.view) == hash(view) and other.view == view)
    return same and _may_be_those(one.names, other.names)


def _may_be_those(names: Names, others: Names) -> bool:
    """Whether some names may be found to be the same as others, one by one."""
    return len(names) == len(others) and all(map(_may_be_one, names, others))


def _may_be_one(name: int, other: int) -> bool:
    """Whether two names may be found to be the same."""
    return name == other or name < GONE or other < GONE
