"""One way in which everything observed so far can have come about, and how it goes on.

An `Explanation` is a state with what was assumed, the names bound to it, the calls in flight and the messages still to
be seen. It stands for itself *and for everything it can silently turn into*: steps that nobody has to have seen are
taken only when an observation asks for them. That is exact, because whatever an explanation can become it can still
become later; and it is what keeps the number of explanations small.
"""

from __future__ import annotations

import operator
import sys
from collections.abc import Hashable, Iterable, Iterator

from attrs import Factory, field

from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import UNCONSTRAINED, Assumption
from missionfsm.kernel.terms import State, View
from missionfsm.kernel.values import value

Names = tuple[int, ...]
"""Names as the oracle numbers them: 0… were observed, -2, -3… exist and were not seen yet, `GONE` is neither."""

GONE = -1
"""The number of a name that was observed once and that nothing carries any more."""


def _lowest_of_owed(owed: Owed) -> int:
    return min((GONE, *owed.names))


def _lowest_of_channel(channel: Channel) -> int:
    lowest = min(channel.name, channel.last.lowest if channel.last else GONE)
    for one in channel.owed:
        lowest = min(lowest, one.lowest)
    return lowest


@value(cache_hash=True)
class Ready:
    """An answer that a call in flight may come back with, and the readings that this assumes."""

    answer: Answer
    names: Names
    assumes: tuple[Assumption, ...]
    rules: tuple[str, ...]


@value(cache_hash=True)
class InFlight:
    """A call whose answer has not come.

    Either it has taken effect (`done` says with which answer) or it has not; then `ready` has the answers without
    effect that were possible at some moment since it was sent, though perhaps not any more.
    """

    name: int
    request: Hashable
    args: Names
    ready: tuple[Ready, ...] = ()
    done: Ready | None = None


@value(cache_hash=True)
class Owed:
    """A message that a channel has still to show.

    A `passing` one may be left out, since its state does not last or since nobody has to say it. In the second case,
    where it is `optional`, it may also come once things have settled; one that `stays` may come any number of times.
    `shown_as` is the content with which one came, where the specification wants that remembered (`Spec.remembered`).
    `lowest` is the lowest of its names, `GONE` at most: below that where nobody has seen one of them.
    """

    view: View
    names: Names
    passing: bool = False
    only: Assumption | None = None
    optional: bool = False
    stays: bool = False
    shown_as: Hashable = None
    lowest: int = field(init=False, eq=False, repr=False, default=Factory(_lowest_of_owed, takes_self=True))


@value(cache_hash=True)
class Channel:
    """A stream or a connection: its name, its topic, what it showed last and what it owes.

    Where it is known what comes, `foretold` is how many of the messages that it shows next are settled already: they
    can be nothing but what it owed before. `last` is then what the last of these shows. One that is `done` shows
    nothing besides those, whatever happens: it owes nothing any more.

    `lowest` is the lowest of all names in it, `GONE` at most.
    """

    name: int
    topic: Hashable
    last: Owed | None = None
    owed: tuple[Owed, ...] = ()
    foretold: int = 0
    done: bool = False
    lowest: int = field(init=False, eq=False, repr=False, default=Factory(_lowest_of_channel, takes_self=True))

    def owing(self, owed: tuple[Owed, ...] = ()) -> Channel:
        """The channel when it owes these, and nothing else."""
        return Channel(self.name, self.topic, self.last, owed, self.foretold, self.done)


DRAINED = "drained"
"""The topic of a channel that is gone and on which something may still be seen that was on its way."""

UNNAMED = sys.maxsize
"""Where channels stand whose names nobody has seen."""

Lost = tuple[tuple[Hashable, Names, int], ...]
"""Calls that will never be answered and have not taken effect: (request, args, how many), in the order of the first."""


@value
class Explanation:
    """One way in which everything observed so far can have come about."""

    state: State
    names: Names = ()
    assumed: int = UNCONSTRAINED
    calls: tuple[InFlight, ...] = ()
    lost: Lost = ()
    channels: tuple[Channel, ...] = ()
    gone: Names = ()
    """Observed names, sorted, whose things are no more: nothing else can have them."""
    all_known: bool = False
    """Whether nothing from before the log can take effect any more: a state was shown, and things have settled."""

    def ref(self, name: int) -> int | None:
        """The position of a name among those of the state."""
        return self.names.index(name) if name in self.names else None

    def place_of(self, call: int) -> int | None:
        """The place of a call among those in flight."""
        return next((place for place, one in enumerate(self.calls) if one.name == call), None)

    def without_call(self, place: int) -> Explanation:
        """The same explanation once the call at a place is in flight no more."""
        return self.replace(calls=(*self.calls[:place], *self.calls[place + 1 :]))

    def replace(
        self,
        *,
        assumed: int | None = None,
        calls: tuple[InFlight, ...] | None = None,
        lost: Lost | None = None,
        channels: tuple[Channel, ...] | None = None,
        gone: Names | None = None,
    ) -> Explanation:
        """The same explanation but for some of what is not its state: `attrs.evolve`, four times as fast."""
        return Explanation(
            self.state,
            self.names,
            self.assumed if assumed is None else assumed,
            self.calls if calls is None else calls,
            self.lost if lost is None else lost,
            self.channels if channels is None else channels,
            self.gone if gone is None else gone,
            self.all_known,
        )


def channel_names(explanation: Explanation) -> set[int]:
    """The names of its channels."""
    return {channel.name for channel in explanation.channels}


def fresh(explanation: Explanation) -> Iterator[int]:
    """Numbers for names that nobody has seen yet."""
    taken = _lowest(explanation)
    while True:
        taken -= 1
        yield taken


def _lowest(explanation: Explanation) -> int:
    """The lowest of all names that an explanation mentions, `GONE` at most."""
    found = min((GONE, *explanation.names, *[channel.lowest for channel in explanation.channels]))
    for _, args, _ in explanation.lost:
        found = min((found, *args))
    for call in explanation.calls:
        found = min((found, *_names_of_call(call)))
    return found


def mentioned(explanation: Explanation) -> Iterator[int]:
    """Every name that an explanation mentions, in a fixed order; some come more than once."""
    yield from explanation.names
    yield from mentioned_besides(explanation)


def mentioned_besides(explanation: Explanation) -> Iterator[int]:
    """The same without the names of the state, which come first."""
    for channel in explanation.channels:
        yield channel.name
        if channel.last:
            yield from channel.last.names
        for owed in channel.owed:
            yield from owed.names
    for _, args, _ in explanation.lost:
        yield from args
    # Calls come and go most often: with the highest numbers they leave those of the others alone.
    for call in explanation.calls:
        yield from _names_of_call(call)


def _unseen(explanation: Explanation) -> list[int]:
    """The names that nobody has seen, in the order of `mentioned`."""
    found: list[int] = []
    if explanation.names and min(explanation.names) < GONE:
        found += [name for name in explanation.names if name < GONE]
    for channel in explanation.channels:
        if channel.lowest < GONE:
            found += _unseen_on(channel)
    for _, args, _ in explanation.lost:
        if args:
            found += [name for name in args if name < GONE]
    for call in explanation.calls:
        found += [name for name in _names_of_call(call) if name < GONE]
    return found


def _unseen_on(channel: Channel) -> Iterator[int]:
    """The names on a channel that nobody has seen: its own, and those in what it showed last and owes."""
    if channel.name < GONE:
        yield channel.name
    for owed in (channel.last, *channel.owed):
        if owed and owed.lowest < GONE:
            yield from [name for name in owed.names if name < GONE]


def _names_of_call(call: InFlight) -> Names:
    """The name of a call in flight, and those that it asks with and may be answered with."""
    names = (call.name, *call.args)
    if call.done:
        names += call.done.names
    for ready in call.ready:
        names += ready.names
    return names


def rename(explanation: Explanation, new: dict[int, int]) -> Explanation:
    """The same explanation with other numbers for its names; those not in `new` stay."""
    lowest = min(new, default=GONE)
    unseen_only = max(new, default=GONE) < GONE

    def stays(names: Names) -> bool:
        return not names or (unseen_only and min(names) >= GONE) or lowest > max(names)

    def each(names: Names) -> Names:
        return names if stays(names) else tuple([new.get(name, name) for name in names])

    def ready(one: Ready) -> Ready:
        return one if stays(one.names) else Ready(one.answer, each(one.names), one.assumes, one.rules)

    def in_flight(one: InFlight) -> InFlight:
        done = ready(one.done) if one.done else None
        return InFlight(new.get(one.name, one.name), one.request, each(one.args), tuple(map(ready, one.ready)), done)

    renamed: dict[int, Owed] = {}

    def owed(one: Owed) -> Owed:
        if stays(one.names):
            return one
        known = renamed.get(id(one))
        if known is None:  # channels owe the same messages, and go on to
            known = Owed(one.view, each(one.names), one.passing, one.only, one.optional, one.stays, one.shown_as)
            renamed[id(one)] = known
        return known

    def channel(one: Channel) -> Channel:
        if unseen_only and one.lowest == GONE:
            return one
        last = owed(one.last) if one.last else None
        return Channel(new.get(one.name, one.name), one.topic, last, tuple(map(owed, one.owed)), one.foretold, one.done)

    return Explanation(
        explanation.state,
        each(explanation.names),
        explanation.assumed,
        tuple(map(in_flight, explanation.calls)),
        tuple([(request, each(args), times) for request, args, times in explanation.lost]),
        tuple(map(channel, explanation.channels)),
        tuple(sorted(each(explanation.gone))),
        explanation.all_known,
    )


def _in_order(explanation: Explanation) -> Explanation:
    """The explanation with its channels in the order of their names, and those without an observed one last.

    These stand in the order of the calls that opened them.
    """
    channels = explanation.channels
    unseen = sum(channel.name < GONE for channel in channels) > 1
    openers = (call.done.names if call.done else () for call in explanation.calls) if unseen else ()
    places = {name: UNNAMED + position for position, names in enumerate(openers) for name in names}

    def place(channel: Channel) -> int:
        return channel.name if channel.name > GONE else places.get(channel.name, UNNAMED)

    order = list(map(place, channels))
    if all(map(operator.le, order, order[1:])):
        return explanation
    return explanation.replace(channels=tuple(sorted(channels, key=place)))


def tidy(explanation: Explanation) -> Explanation:
    """The explanation in the one form of all that differ in nothing that anybody can tell.

    Unseen names are numbered by first mention, and channels stand in the order of their names: in which order they were
    opened makes no difference, and of many that open at once there are many orders.
    """
    if len(explanation.channels) > 1:
        explanation = _in_order(explanation)
    found = _unseen(explanation)
    if not found or found == [*range(GONE - 1, GONE - 1 - len(found), -1)]:
        return explanation
    new = {name: GONE - 1 - position for position, name in enumerate(dict.fromkeys(found))}
    return explanation if all(map(operator.eq, new, new.values())) else rename(explanation, new)


def unify(explanation: Explanation, pairs: Iterable[tuple[int, int]]) -> Explanation | None:
    """The explanation in which each pair (a name it has, a name observed) is one name; None if they cannot be.

    A name observed stands for one thing, and a thing has one name: an unseen name takes the observed one if nothing
    else has it.
    """
    new: dict[int, int] = {}
    held: set[int] | None = None
    for own, observed in pairs:
        known = new.get(own, own)
        if known == observed:
            continue
        if known >= GONE:
            return None
        if held is None:
            held = set(explanation.names)
            held.update(channel.name for channel in explanation.channels)
        if observed in held or observed in new.values() or observed in explanation.gone or observed == GONE:
            return None
        new[own] = observed
    if not new:
        return explanation
    left = set(explanation.names)
    left.update(channel.name for channel in explanation.channels)
    lapsed = [observed for own, observed in new.items() if own not in left]
    bound = rename(explanation, new)
    return bound.replace(gone=outlived(bound, lapsed)) if lapsed else bound


def outlived(explanation: Explanation, names: Iterable[int]) -> Names:
    """The names that are gone once the things with these are no more."""
    return tuple(sorted({*explanation.gone, *(name for name in names if name > GONE)}))


def with_lost(lost: Lost, request: Hashable, args: Names) -> Lost:
    """Lost calls and one more."""
    for position, (known, known_args, times) in enumerate(lost):
        if (known, known_args) == (request, args):
            return (*lost[:position], (request, args, times + 1), *lost[position + 1 :])
    return (*lost, (request, args, 1))


def without_lost(lost: Lost, position: int) -> Lost:
    """Lost calls but for one of those at a position."""
    request, args, times = lost[position]
    left = ((request, args, times - 1),) if times > 1 else ()
    return (*lost[:position], *left, *lost[position + 1 :])


def within(lost: Lost, others: Lost) -> bool:
    """Whether all lost calls are among the others, each at least as often."""
    if not lost or lost == others:
        return True
    most = {(request, args): times for request, args, times in others}
    return all(times <= most.get((request, args), 0) for request, args, times in lost)


def undrained(explanation: Explanation, *names: int) -> Explanation:
    """The explanation where nothing is on its way any more on channels that are gone: on any, or on those so named."""
    channels = explanation.channels
    left = tuple(one for one in channels if one.topic != DRAINED or (names and one.name not in names))
    return explanation if len(left) == len(channels) else explanation.replace(channels=left)


def reopened(explanation: Explanation) -> Explanation:
    """The explanation where any channel may show something again, for those who ask what else could have come."""
    if not any(one.done for one in explanation.channels):
        return explanation
    channels = (Channel(one.name, one.topic, one.last, one.owed, one.foretold) for one in explanation.channels)
    return explanation.replace(channels=tuple(channels))
