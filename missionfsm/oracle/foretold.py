"""What a channel owes that is bound to be what it shows next: known before the messages come, and not carried along.

A stream may be hundreds of messages behind what happens. Where it passes over nothing and does not repeat itself, each
message that it owes has to be the next one that is known to come; then it is taken out and counted. So explanations of
what happens stay small, and one that leads to a state which a message of much later contradicts is left at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from attrs import frozen

from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.spec import Delivery, Spec
from missionfsm.kernel.step import Match
from missionfsm.oracle.alignment import Message, Showings, may_look_alike
from missionfsm.oracle.explanation import Channel, Owed


@frozen
class Foretold:
    """What becomes of an explanation where a channel does not owe any more what it is bound to show next.

    Attributes:
        channel: the channel then.
        assumed: what is assumed then; 0 where that is contradictory.
        names: its own names that the messages tell, each with the one observed.
        rules: for each message its position and the rules that it exercises.
    """

    channel: Channel
    assumed: int
    names: tuple[tuple[int, int], ...]
    rules: tuple[tuple[int, tuple[str, ...]], ...]


def foretold(
    spec: Spec,
    showings: Showings,
    channel: Channel,
    due: Iterable[tuple[Message, int]],
    assumed: int,
    assume: Callable[[int, tuple[Assumption, ...]], int],
) -> Foretold | None:
    """A channel without what it is bound to show next; None where nothing is certain.

    It goes no further than where a name becomes known.

    Args:
        due: the messages that it shows next, with their positions; it passes over nothing and does not repeat itself.
        assume: what is assumed, and more of it, to what is assumed then.
    """
    delivery, last, many = spec.delivery(channel.topic), channel.last, 0
    rules: list[tuple[int, tuple[str, ...]]] = []
    new: list[tuple[int, int]] = []
    for message, position in due:
        which = _only_one(showings, delivery, last, channel.owed[many:], message)
        if which is None:
            break
        one: Owed = channel.owed[many + which]
        match: Match
        match, *others = showings.ways(one, message)
        if others:
            break
        content, names = message
        assumed = assume(assumed, (*((one.only,) if one.only else ()), *match.assumes))
        rules.append((position, match.rules))
        last = Owed(one.view, one.names, shown_as=spec.remembered(one.view, content))
        many += which + 1
        new = [(one.names[ref], names[at]) for ref, at in match.names if one.names[ref] != names[at]]
        if new or not assumed:
            break
    if not rules:
        return None
    after = Channel(channel.name, channel.topic, last, channel.owed[many:], channel.foretold + len(rules))
    return Foretold(after, assumed, tuple(new), tuple(rules))


def _only_one(
    showings: Showings, delivery: Delivery, last: Owed | None, owed: Sequence[Owed], message: Message
) -> int | None:
    """Which of those that a channel owes is bound to be the next message, whatever it comes to owe besides.

    None where that is not certain: another one may be it, or none of these has to be shown.
    """
    found: int | None = None
    for index, one in enumerate(owed):
        if one.stays or one.optional:
            return None
        if showings.may_be(one, message):
            if found is not None:
                return None
            found = index
        if not one.passing:
            if delivery.every_time or last is None or not _may_look_like(one, last):
                return found
            if found is None:
                return None
    return None


def _may_look_like(one: Owed, last: Owed) -> bool:
    """Whether nobody may be able to tell what is owed from what was shown last."""
    return may_look_alike(one, last) or (last.shown_as is not None and not one.names)
