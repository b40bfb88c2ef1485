"""What comes of a recorded conversation: what calls are answered with, what streams show, when all settles."""

from __future__ import annotations

import bisect
import operator
from collections.abc import Collection, Hashable, Mapping, Sequence

from attrs import define, field, frozen

from missionfsm.kernel.history import Answer, Called, Cancelled, Ended, Received, Returned, Settled
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.transport import REDELIVERED
from missionfsm.oracle.alignment import Message
from missionfsm.oracle.explanation import GONE, Channel, Names
from missionfsm.oracle.symbols import Symbol

NEXT = 64
"""How many of the messages that a stream shows next are compared with what it owes."""

_REGULAR = frozenset({"first", "larger"})
"""How the numbers of messages compare with those before them where nothing is special about that."""

_NO_MESSAGES: tuple[list[int], list[Message]] = ([], [])

Narrowed = tuple[Channel, Assumption | None, bool]
"""A channel without what is known never to be shown, what that assumes, and whether it is done: whatever becomes of
the state now, the channel does not show it."""

Led = tuple[Narrowed | None, tuple[Message, int] | None]
"""A channel that was narrowed, and the message that the state has to come to show, if there is one, with the position
of the event before which it has."""


@define(eq=False, slots=True)
class Stretch:
    """What is known of a channel from some moment on.

    Attributes:
        due: the messages that it shows next, `NEXT` at most.
        positions: where these stand.
        before: what it has shown last, if that is known.
        nothing: whether nothing of it is known.
        rests: whether everything settles after the messages.
        rest: the position of what settles next.
        over: whether nothing else is shown after the messages.
        mute: whether it goes on, has shown nothing yet, and shows nothing before everything settles.
        led: what was found of channels with that name.
        uncertain: those of them of which it is known that none of these messages is bound to be what they owe.
    """

    due: list[Message]
    positions: list[int]
    before: Message | None
    rest: int
    nothing: bool = field(kw_only=True)
    rests: bool = field(kw_only=True)
    over: bool = field(kw_only=True)
    mute: bool = field(kw_only=True)
    led: dict[tuple[Channel, bool, bool], Led] = field(factory=dict)
    uncertain: set[Channel] = field(factory=set)


@frozen
class Excerpt:
    """Events of a recorded conversation.

    Attributes:
        symbols: the events.
        latest: what each channel showed last before them.
    """

    symbols: Sequence[Symbol]
    latest: Mapping[int, Message]


@frozen
class Horizon:
    """How far the events of an excerpt are known beforehand.

    Attributes:
        end: how many of them are.
        last: whether nothing comes after these.
        beyond: the positions of those that the system does not explain; what follows says nothing of what is before.
    """

    end: int
    last: bool
    beyond: Collection[int]


class Coming:
    """What comes, up to a horizon.

    Attributes:
        at: how many of the events have been observed.
    """

    def __init__(self, excerpt: Excerpt, horizon: Horizon) -> None:
        self.at = 0
        self.last = horizon.last
        self.answers: dict[int, tuple[Answer, Names]] = {}
        self._horizon = horizon.end
        self._beyond = sorted(horizon.beyond)
        self._latest = excerpt.latest
        self._messages: dict[int, tuple[list[int], list[Message]]] = {}
        self._same: dict[Message, Message] = {}
        self._settled: list[int] = []
        self._irregular: dict[int, list[int]] = {}
        self._ended: dict[int, int] = {}
        self._answered: dict[int, int] = {}
        self._known: dict[tuple[int, int, int, int], Stretch] = {}
        self._stretches: dict[int, tuple[int, int, int, Stretch]] = {}
        self._at_cut, self._found_cut = -1, horizon.end
        self._called = self._read(excerpt.symbols[: horizon.end], horizon.beyond)
        self._openings = self._opened(self._called)

    def _read(self, symbols: Sequence[Symbol], beyond: Collection[int]) -> dict[int, tuple[int, Hashable, Names]]:
        """Note what comes; the calls that are sent: each with its position, what it asks for and its names."""
        called: dict[int, tuple[int, Hashable, Names]] = {}
        for position, (kind, *what) in enumerate(symbols):
            if kind is Called:
                called[what[-1]] = position, *what[:2]
            elif kind is Returned:
                answer, names, call = what
                if call > GONE and position not in beyond:
                    self.answers[call] = answer, names
                    self._answered[call] = position
            elif kind is Received:
                content, names, relations, channel = what
                if channel > GONE and not _REGULAR.issuperset(relations):
                    self._irregular.setdefault(channel, []).append(position)
                if channel > GONE and channel not in self._ended and REDELIVERED not in relations:
                    positions, messages = self._messages.setdefault(channel, ([], []))
                    positions.append(position)
                    messages.append(self._same.setdefault((content, names), (content, names)))
            elif kind is Settled:
                self._settled.append(position)
            elif kind in (Cancelled, Ended):
                self._ended.setdefault(what[-1], position)
        return called

    def _opened(self, called: Mapping[int, tuple[int, Hashable, Names]]) -> list[tuple[int, int, int, Message]]:
        """Of streams that are opened: when which message came first, when the call was sent, and what it is."""
        opened = ((call, channel) for call, (_, names) in self.answers.items() for channel in names)
        first = ((*self._messages[channel], call) for call, channel in opened if channel in self._messages)
        return sorted(
            ((at, called[call][0] if call in called else -1, call, message) for (at, *_), (message, *_), call in first),
            key=operator.itemgetter(0),
        )

    def answer(self, call: int) -> tuple[Answer, Names] | None:
        """What a call in flight comes back with, and with which names; None where it is not known."""
        return self.answers.get(call)

    def lag(self, channel: Channel) -> int:
        """How many messages that last a channel owes besides those that it is known to show."""
        positions, _ = self._messages.get(channel.name, _NO_MESSAGES)
        due = len(positions) - bisect.bisect_left(positions, self.at)
        return sum(not one.passing for one in channel.owed) + channel.foretold - due

    @property
    def _cut(self) -> int:
        """Up to where it is known what comes: to the next event that the system does not explain, or the horizon."""
        if self._at_cut != self.at:
            self._at_cut = self.at
            self._found_cut = next((position for position in self._beyond if position >= self.at), self._horizon)
        return self._found_cut

    def _stretch(self, channel: Channel) -> Stretch:
        """What is known of a channel from now on, but for the messages that are foretold."""
        name = channel.name
        known = self._stretches.get(name)
        if known is not None and known[0] <= self.at <= known[1] and known[2] == channel.foretold:
            return known[3]
        cut = self._cut
        positions, _ = self._messages.get(name, _NO_MESSAGES)
        coming, quiet = bisect.bisect_left(positions, self.at), bisect.bisect_left(self._settled, self.at)
        first, end = coming + channel.foretold, min(self._ended.get(name, cut), cut)
        found = self._known.get((name, first, quiet, end))
        if found is None:
            found = self._known[name, first, quiet, end] = self._stretch_from(name, first, quiet, end)
        # Up to the next of these that is observed, no less is known.
        until = min([cut, *positions[coming : coming + 1], *self._settled[quiet : quiet + 1]])
        self._stretches[name] = self.at, until, channel.foretold, found
        return found

    def _is_last(self, last: int, positions: Sequence[int]) -> bool:
        """Whether nothing of a channel comes behind what is known either."""
        return self.last and last == len(positions) and (not self._settled or self._settled[-1] < self._cut)

    def _stretch_from(self, name: int, first: int, quiet: int, end: int) -> Stretch:
        """What is known of a channel from one of its messages on.

        Args:
            first: the index of that message.
            quiet: the index of what settles next.
            end: the position up to which anything is known.
        """
        positions, messages = self._messages.get(name, _NO_MESSAGES)
        cut, last = self._cut, bisect.bisect_left(positions, end)
        rests = quiet < bisect.bisect_left(self._settled, end)
        nothing = first >= last and not rests
        over = end < cut or self._is_last(last, positions)
        if rests:
            last = bisect.bisect_left(positions, self._settled[quiet], first)
        settles = rests or (end == cut and cut in self._settled)
        mute = settles and first >= last and not first and name not in self._latest
        shown = slice(first, min(last, first + NEXT))
        return Stretch(
            messages[shown],
            positions[shown],
            messages[first - 1] if first else self._latest.get(name),
            self._settled[quiet] if rests else cut,
            nothing=nothing,
            rests=rests and last - first <= NEXT,
            mute=mute,
            over=over and (nothing or (last - first <= NEXT and not rests)),
        )
