"""What a message tells: which of those that a channel owes it may be, and what is silently done before it."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator

from missionfsm.kernel.focus import RECEIVED
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Mismatch
from missionfsm.kernel.transport import REDELIVERED
from missionfsm.oracle import lenient, middle
from missionfsm.oracle.explanation import GONE, Channel, Explanation, Names, Owed, channel_names, tidy, unify
from missionfsm.oracle.focusing import before_message
from missionfsm.oracle.successors import Seen, Successor, Successors
from missionfsm.oracle.symbols import Arrival
from missionfsm.oracle.unsaid import Unsaid


class Receiving:
    """What becomes of explanations when a message comes.

    Args:
        successors: what one explanation can become.
        level: how much of what only a transport does is thought of (see `missionfsm.oracle.observing`).
        unsaid: what channels may pass over.
    """

    def __init__(self, successors: Successors, level: int, unsaid: Unsaid) -> None:
        self._successors = successors
        self._spec = successors.spec
        self._level = level
        self._unsaid = unsaid

    def received(
        self,
        explanations: Iterable[Explanation],
        content: Hashable,
        names: Names,
        relations: tuple[str, ...],
        channel: int,
    ) -> Iterator[Successor]:
        """The explanations in which a message comes that says this, with numbers that compare so with those before."""
        if REDELIVERED in relations:
            relations = tuple(relation for relation in relations if relation != REDELIVERED)
            yield from self._redelivered(explanations, channel)
        if self._level > 1:
            explanations = (*explanations, *lenient.restarted(self._successors, self._spec, explanations, relations))
        arrival = Arrival(channel, content, names)
        to_show: list[Successor] = []
        for explanation in explanations:
            echoes = self._echoed(explanation, channel)
            start = self._numbered(explanation, relations, echoes=echoes)
            if start is None:
                continue
            if middle.is_unknown(start):
                yield from middle.states_shown(self._successors, start, arrival)
                continue
            if self._spec.anywhere:
                start, unjudged = middle.joined(self._successors, start, channel, content)
                if unjudged:
                    yield Successor(start)
            if echoes and not {"equal", "zero", "renumbered"}.isdisjoint(relations):
                yield from self._showings(Successor(start), None, arrival, echo=True)
            if not ("equal" in relations and echoes):
                to_show.append(Successor(start))
        yield from self._shown_at_last(to_show, arrival)

    def received_at_once(
        self,
        explanations: Iterable[Explanation],
        content: Hashable,
        names: Names,
        relations: tuple[str, ...],
        channel: int,
    ) -> Iterator[Successor]:
        """The explanations in which a message comes that is owed already; see `received`."""
        for explanation in explanations:
            start = self._numbered(explanation, relations, echoes=False)
            if start is not None:
                yield from self._showings(Successor(start), None, Arrival(channel, content, names), echo=False)

    def _redelivered(self, explanations: Iterable[Explanation], channel: int) -> Iterator[Successor]:
        """The explanations in which a message came twice that was sent once."""
        # One that may send a message again under its number has said it twice.
        once = (one for one in explanations if not self._echoed(one, channel))
        return lenient.redelivered(explanations if self._level else once, channel)

    def _numbered(self, explanation: Explanation, relations: tuple[str, ...], *, echoes: bool) -> Explanation | None:
        """The explanation where a message has a number that compares so with those before; None where it cannot.

        Args:
            echoes: whether the number may be that of the message before.
        """
        sequence = numbered_so(self._spec, [one for one in relations if one != "equal" or not echoes])
        assumed = 0 if sequence is None else self._successors.meet(explanation.assumed, sequence)
        return explanation.replace(assumed=assumed) if assumed else None

    def _echoed(self, explanation: Explanation, name: int) -> bool:
        """Whether a channel of that name may send its last message again under its old number."""
        channels = (channel for channel in explanation.channels if channel.name == name)
        return any(self._spec.delivery(channel.topic).echoes for channel in channels)

    def _shown_at_last(self, starts: Iterable[Successor], arrival: Arrival) -> Iterator[Successor]:
        """The explanations in which a channel shows a message: what it owes, or what it owes after silent steps.

        All that it owed before such a step is passed over then. Where several channels share the name, what one of them
        owes is passed over only for what it shows itself.
        """
        channel = arrival.channel
        about = before_message(self._successors, RECEIVED, channel)
        seen: dict[Hashable, Seen] = {}
        todo: list[tuple[Successor, Hashable]] = [(start, None) for start in starts]
        while todo:
            later: list[tuple[Successor, Hashable]] = []
            for successor, topic in todo:
                if self._successors.outdone(seen.setdefault(topic, {}), successor.explanation):
                    continue
                if any(one.foretold and one.name == channel for one in successor.explanation.channels):
                    yield self._as_foretold(successor, channel)
                    continue
                yield from self._showings(successor, topic, arrival, echo=False)
                for skipped, whose in self._unsaid.passed_over(successor.explanation, channel, topic):
                    later += (
                        (Successor(one.explanation, successor.rules + one.rules), whose)
                        for one in self._successors.silent(skipped, focus=about)
                    )
            todo = later

    def _as_foretold(self, successor: Successor, name: int) -> Successor:
        """The explanation once a channel of that name has shown what was settled before."""
        here, ahead = successor.explanation, self._successors.ahead
        assert ahead is not None, "only who looks ahead knows what comes"  # noqa: S101
        channels = tuple(
            Channel(one.name, one.topic, one.last, one.owed, one.foretold - 1, one.done) if one.name == name else one
            for one in here.channels
        )
        return Successor(here.replace(channels=channels), successor.rules + ahead.exercised)

    def _showings(self, successor: Successor, topic: Hashable, arrival: Arrival, *, echo: bool) -> Iterator[Successor]:
        """The explanations in which a channel of that name, and of that topic if one is given, shows the message."""
        known, name = channel_names(successor.explanation), arrival.channel
        for position, one in enumerate(successor.explanation.channels):
            if topic is not None and one.topic != topic:
                continue
            if one.name == name or (one.name < GONE and name not in known):
                yield from self._shown_on(successor, position, arrival, echo=echo, may_repeat=topic is None)

    def _shown_on(
        self, successor: Successor, position: int, arrival: Arrival, *, echo: bool, may_repeat: bool
    ) -> Iterator[Successor]:
        """The explanations in which the message shows one of those that the channel owes, or repeats its last one."""
        here, content, names = successor.explanation, arrival.content, arrival.names
        channel = here.channels[position]
        for owed, left, assumption in self._candidates(channel, here.assumed, echo=echo, may_repeat=may_repeat):
            matches = self._successors.matches(owed, content)
            if not assumption or isinstance(matches, Mismatch):
                continue
            for match in matches:
                agreed = self._successors.meet(assumption, match.assumes)
                if not agreed:
                    continue
                last = Owed(owed.view, owed.names, shown_as=self._spec.remembered(owed.view, content))
                after_it = Channel(channel.name, channel.topic, last, left, channel.foretold)
                channels = (*here.channels[:position], after_it, *here.channels[position + 1 :])
                after = here.replace(assumed=agreed, channels=channels)
                pairs = [(channel.name, arrival.channel), *((owed.names[ref], names[at]) for ref, at in match.names)]
                bound = unify(after, pairs)
                if bound:
                    yield Successor(tidy(bound), successor.rules + match.rules)

    def _candidates(
        self, channel: Channel, assumed: int, *, echo: bool, may_repeat: bool
    ) -> Iterator[tuple[Owed, tuple[Owed, ...], int]]:
        """What a channel may show next: the message, those owed after it, and what is assumed then."""
        delivery = self._spec.delivery(channel.topic)
        repeats = delivery.echoes if echo else delivery.repeats
        if channel.last and repeats and may_repeat:
            yield channel.last, channel.owed, self._successors.meet(assumed, (repeats,))
        ways: tuple[int, ...] = (assumed,)
        for index, owed in enumerate(() if echo else channel.owed):
            left = channel.owed[index if owed.stays else index + 1 :]
            for way in ways:
                yield owed, left, self._successors.meet(way, (owed.only,)) if owed.only else way
            ways = tuple(dict.fromkeys(after for way in ways for after in self._unsaid.past(channel, owed, way)))
            if not ways:
                return


def numbered_so(spec: Spec, relations: Iterable[str]) -> list[Assumption] | None:
    """What is assumed where numbers compare so with those before; None where they cannot."""
    assumes: list[Assumption] = []
    for relation in relations:
        right = spec.sequence(relation)
        if isinstance(right, Mismatch):
            return None
        assumes += right
    return assumes
