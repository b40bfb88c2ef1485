"""What a channel need not show of what it owes: what nobody could tell, what it may skip, what was lost on its way."""

from __future__ import annotations

from collections.abc import Hashable, Iterator

from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.step import Mismatch
from missionfsm.oracle import lenient
from missionfsm.oracle.explanation import Channel, Explanation, Owed, channel_names, tidy, undrained
from missionfsm.oracle.successors import Successors


class Unsaid:
    """What channels may leave unsaid.

    Args:
        successors: what one explanation can become.
        level: how much of what only a transport does is thought of (see `missionfsm.oracle.observing`).
    """

    def __init__(self, successors: Successors, level: int) -> None:
        self._successors = successors
        self._spec = successors.spec
        self._level = level

    def past(self, channel: Channel, owed: Owed, assumed: int) -> tuple[int, ...]:
        """What is assumed where a channel does not show something that it owes: any of these, or it has to show it."""
        if owed.passing:
            return (assumed,)
        same = self._unchanged(channel, owed, assumed)
        skips = self._skips(channel)
        if assumed in same:
            self._successors.rely()
            return same
        skipped = self._successors.meet(assumed, (skips,)) if skips else 0
        return (*same, skipped) if skipped else same

    def _unchanged(self, channel: Channel, owed: Owed, assumed: int) -> tuple[int, ...]:
        """What is assumed where an owed message shows what the channel showed last, so that nobody could tell it."""
        last = channel.last
        if last is None or self._spec.delivery(channel.topic).every_time:
            return ()
        if (owed.view, owed.names) == (last.view, last.names):
            return (assumed,)
        if last.shown_as is None or owed.names:
            return ()
        matches = self._successors.matches(owed, last.shown_as)
        if isinstance(matches, Mismatch):
            return ()
        return tuple(after for match in matches if (after := self._successors.meet(assumed, match.assumes)))

    def _caught_up(self, channel: Channel, due: list[Owed], assumed: int) -> tuple[int, ...]:
        """What is assumed where the subscriber knows all that a channel owes, since it saw that last.

        What is back where the subscriber saw it last may stay unsaid by one that sends only the latest.
        """
        ways: tuple[int, ...] = (assumed,)
        for owed in due:
            ways = tuple(after for before in ways for after in self._unchanged(channel, owed, before))
        skips = self._spec.delivery(channel.topic).skips
        if assumed in ways:
            self._successors.rely()
        skipped = self._successors.meet(assumed, (skips,)) if skips and assumed not in ways else 0
        return (*ways, *self._unchanged(channel, due[-1], skipped)) if skipped else ways

    def is_told(self, channel: Channel, assumed: int) -> bool:
        """Whether nobody could tell that what a channel owes has not come, since it was seen last."""
        due = [owed for owed in channel.owed if not owed.passing]
        return not due or bool(self._caught_up(channel, due, assumed))

    def passed_over(
        self, explanation: Explanation, name: int, topic: Hashable
    ) -> Iterator[tuple[Explanation, Hashable]]:
        """The explanations in which all that a channel of that name owes is passed over, each with its topic.

        One whose name is not known yet owes nothing to anybody.
        """
        if name not in channel_names(explanation):
            yield explanation, None
            return
        for position, channel in enumerate(explanation.channels):
            if channel.name != name or (topic is not None and channel.topic != topic):
                continue
            ways: tuple[int, ...] = (explanation.assumed,)
            for owed in channel.owed:
                ways = tuple(dict.fromkeys(after for before in ways for after in self.past(channel, owed, before)))
            for assumed in ways:
                passed = _offering(channel)
                channels = (*explanation.channels[:position], passed, *explanation.channels[position + 1 :])
                yield explanation.replace(assumed=assumed, channels=channels), channel.topic

    def keeps_from_rest(self, channel: Channel) -> bool:
        """Whether a channel owes what it shows every time, so that nothing settles before it has."""
        if self._level or not channel.owed or not self._spec.delivery(channel.topic).every_time:
            return False
        return self._skips(channel) is None and any(not owed.passing for owed in channel.owed)

    def nothing_owed(self, explanation: Explanation) -> Iterator[Explanation]:
        """The explanations in which every channel has shown where things stand; none if one has not."""
        ways: tuple[int, ...] = (explanation.assumed,)
        channels = []
        for channel in explanation.channels:
            due = [owed for owed in channel.owed if not owed.passing]
            after_it = self._each_caught_up(channel, due, ways) if due else ways
            if self._level and not after_it and channel.last:
                after_it = tuple(after for before in ways if (after := self._successors.meet(before, (lenient.LOSES,))))
                channels.append(lenient.given_up(channel))
            else:
                channels.append(_offering(channel) if channel.owed else channel)
            if not after_it:
                return
            ways = after_it
        for assumed in ways:
            yield tidy(undrained(explanation.replace(assumed=assumed, channels=tuple(channels))))

    def _each_caught_up(self, channel: Channel, due: list[Owed], ways: tuple[int, ...]) -> tuple[int, ...]:
        """The same as `_caught_up`, for everything that may be assumed before."""
        return tuple(dict.fromkeys(after for before in ways for after in self._caught_up(channel, due, before)))

    def _skips(self, channel: Channel) -> Assumption | None:
        """Under what a channel may pass over what it owes; None if never."""
        skips = self._spec.delivery(channel.topic).skips
        return lenient.skips(channel, skips) if self._level else skips


def _offering(channel: Channel) -> Channel:
    """The channel without what it owed, but for what it may say at any time."""
    return channel.owing(_offers(channel))


def _offers(channel: Channel) -> tuple[Owed, ...]:
    """What a channel may still show once everything else is passed over."""
    last = channel.owed[-1] if channel.owed else None
    return (last,) if last and last.optional else ()
