"""From explanations of what was observed so far to those of what is observed next: exact, and only once for each.

`TransitionFunction.step` is the transition function of the belief automaton: from all explanations before an
event to all explanations after it. `missionfsm.oracle.belief` walks that automaton and remembers it.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterable, Iterator

from attrs import evolve

from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.focus import DRIVEN, ENDED, RECEIVED, RETURNED, SETTLED, Focus, Kind
from missionfsm.kernel.history import Answer, Called, Cancelled, Driven, Ended, Received, Returned, Settled
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.step import Match, Mismatch, Step
from missionfsm.kernel.terms import Refs
from missionfsm.kernel.transport import REDELIVERED
from missionfsm.oracle import lenient, middle
from missionfsm.oracle.explanation import (
    GONE,
    Channel,
    Explanation,
    InFlight,
    Names,
    Owed,
    mentioned,
    outlived,
    tidy,
    undrained,
    unify,
    with_lost,
)
from missionfsm.oracle.subsumption import prune
from missionfsm.oracle.successors import FocusOf, Seen, Successor, Successors
from missionfsm.oracle.symbols import Observer, Part


class TransitionFunction:
    """The transition function of the belief automaton.

    Args:
        successors: what one explanation can become.
        eager: whether what only a transport does is thought of at every event, not only where nothing else is left.
    """

    def __init__(self, successors: Successors, *, eager: bool = False) -> None:
        self.successors = successors
        self.spec = successors.spec
        self.eager = eager and successors.spec.transport
        self._lenient = 0

    def step(self, explanations: Iterable[Explanation], kind: type, *what: Part) -> tuple[Successor, ...]:
        """Every explanation of what was observed before and of this event.

        Args:
            explanations: those of what was observed before.
            kind: the class of the event in `missionfsm.kernel.history`.
            what: its fields, with names as numbers (see `Explanation`).

        Raises:
            ExhaustedError: the event costs more than the budget.
        """
        self.successors.reset()
        explanations = tuple(explanations)
        found: Iterable[Successor] = self.explained(explanations, kind, *what)
        if self.eager:
            found = (*found, *self._leniently(1, explanations, kind, *what))
        about = self._about(kind, *what)
        kept = prune(self.successors, found, about)
        for more in () if kept else self._beyond(explanations, kind, *what):
            kept = kept or prune(self.successors, more, about)
        return kept

    @property
    def reckons(self) -> bool:
        """Whether something besides the system itself may explain an event."""
        return self.spec.transport or self.spec.anywhere or self.spec.others

    def beyond(
        self,
        explanations: Iterable[Explanation],
        kind: type,
        *what: Part,
    ) -> Iterator[Successor]:
        """Explanations of an event that the system itself does not explain, one by one; see `step`."""
        return itertools.chain.from_iterable(self._beyond(tuple(explanations), kind, *what))

    def _beyond(
        self,
        explanations: tuple[Explanation, ...],
        kind: type,
        *what: Part,
    ) -> Iterator[Iterable[Successor]]:
        """What may have become of things on their way, or a robot that has restarted, or somebody not in the log."""
        if self.spec.transport:
            yield self._leniently(1, explanations, kind, *what)
            yield self._leniently(2, explanations, kind, *what)
        if self.spec.anywhere or self.spec.others:
            relations = (one for one in what[2] if one != REDELIVERED) if kind is Received else ()
            assumed = self._sequence(relations)
            if assumed is not None:
                yield middle.unforeseen(self.successors, explanations, assumed, kind, *what)

    def is_hopeless(self, kind: type, *what: Part, leniently: bool = False) -> bool:
        """Whether an event is wrong whatever came before it: then nobody has to look at all of that.

        The number of a message goes against those before, or an answer cannot be read.

        Args:
            leniently: whether a message may come twice.
        """
        if kind is Returned:
            return isinstance(what[0].shape, Malformed) and not (self.spec.anywhere or self.spec.others)
        if kind is not Received or (leniently and self.spec.transport and REDELIVERED in what[2]):
            return False
        relations = [one for one in what[2] if one not in ("equal", REDELIVERED)]
        return self._sequence(relations) is None

    def _leniently(
        self,
        level: int,
        explanations: Iterable[Explanation],
        kind: type,
        *what: Part,
    ) -> Iterator[Successor]:
        """What explains an event with as much of the transport as the level says."""
        found = self.explained(explanations, kind, *what)
        while True:
            self._lenient = level
            try:
                one = next(found, None)
            finally:
                self._lenient = 0
            if one is None:
                return
            yield one

    def explained(self, explanations: Iterable[Explanation], kind: type, *what: Part) -> Iterator[Successor]:
        """Explanations of an event, one by one, the nearest first, some of them more than once; see `step`.

        What only a transport does is left out.
        """
        observe: Observer[Iterator[Successor]] = _OBSERVERS[kind]
        return observe(self, explanations, *what)

    def _called(
        self,
        explanations: Iterable[Explanation],
        request: Hashable,
        args: Names,
        lost: bool,  # noqa: FBT001 - a field of the event
        call: int,
    ) -> Iterator[Successor]:
        for explanation in explanations:
            if lost:
                yield Successor(explanation.replace(lost=with_lost(explanation.lost, request, args)))
            else:
                yield Successor(explanation.replace(calls=(*explanation.calls, InFlight(call, request, args))))

    def _returned(
        self, explanations: Iterable[Explanation], answer: Answer, names: Names, call: int
    ) -> Iterator[Successor]:
        undone = []
        if self._lenient > 1:
            explanations = (*explanations, *lenient.restarted(self.successors, self.spec, explanations))
        for explanation in explanations:
            position = _position(explanation, call)
            if position is None:
                continue
            failed = tuple(self._failed(explanation, position, answer, names))
            yield from (Successor(tidy(one)) for one in failed)
            if middle.is_unknown(explanation):
                yield from middle.answered(self.successors, explanation, position, answer, names)
                continue
            for one in middle.wild(self.successors, explanation, position, answer, names):
                yield Successor(tidy(one))
            if explanation.calls[position].done is None:
                # Where the call may still take effect and nothing is assumed, this stands for all that was answered so.
                if not any(one.lost != explanation.lost and one.assumed == explanation.assumed for one in failed):
                    undone.append(explanation)
                else:
                    self.successors.rely()
                continue
            # What is silent may as well come after the answer.
            for after, rules in self._answered(explanation, position, answer, names):
                yield Successor(tidy(after), rules)
        for successor in self.successors.closure(undone, besides=call, focus=self._before_answer(call, answer)):
            position = _position(successor.explanation, call)
            if position is not None:
                for after, rules in self._answered(successor.explanation, position, answer, names):
                    yield Successor(tidy(after), successor.rules + rules)

    def _failed(self, explanation: Explanation, position: int, answer: Answer, names: Names) -> Iterator[Explanation]:
        """The explanations in which the call has failed without anybody's doing, which any state allows.

        What is silent may as well come after it, so that these explanations are enough.
        """
        if names or answer.shape is not None:
            return
        one = explanation.calls[position]
        for failure in self.successors.failures(one, answer.code):
            if one.done and not failure.open_ended:
                continue
            assumed = self.successors.meet(explanation.assumed, failure.assumes)
            if assumed:
                calls = (*explanation.calls[:position], *explanation.calls[position + 1 :])
                late = failure.open_ended and not one.done
                lost = with_lost(explanation.lost, one.request, one.args) if late else explanation.lost
                yield explanation.replace(assumed=assumed, calls=calls, lost=lost)

    def _answered(
        self, here: Explanation, position: int, answer: Answer, names: Names
    ) -> Iterator[tuple[Explanation, tuple[str, ...]]]:
        call = here.calls[position]
        rest = here.replace(calls=(*here.calls[:position], *here.calls[position + 1 :]))
        if call.done:
            for match in self.successors.agreements(call.done.answer, answer):
                assumed = self.successors.meet(rest.assumed, match.assumes)
                for bound in self._bound(rest, answer, call.done.names, names) if assumed else ():
                    yield bound.replace(assumed=assumed), match.rules
        for ready in call.ready:
            for match in self.successors.agreements(ready.answer, answer):
                assumed = self.successors.meet(rest.assumed, (*ready.assumes, *match.assumes))
                for bound in self._bound(rest, answer, ready.names, names) if assumed else ():
                    yield bound.replace(assumed=assumed), ready.rules + match.rules
        if call.done:
            return
        for where, refs in self.successors.addressed(rest, call.args):
            for step in self.successors.outcomes(where.state, call.request, refs):
                if step.answer is None or len(step.refs) != len(names):
                    continue
                for match in self.successors.agreements(step.answer, answer):
                    yield from self._answered_by(where, step, match, call, answer, names)

    def _answered_by(  # noqa: PLR0913 - what an answer is made of
        self, where: Explanation, step: Step, match: Match, call: InFlight, answer: Answer, names: Names
    ) -> Iterator[tuple[Explanation, tuple[str, ...]]]:
        assumed = self.successors.meet(where.assumed, match.assumes)
        if not assumed:
            return
        lost = where.lost if step.applied else with_lost(where.lost, call.request, call.args)
        taken = self.successors.advance(where.replace(lost=lost, assumed=assumed), step)
        if taken:
            for bound in self._bound(taken[0], answer, taken[1], names):
                yield bound, step.rules + match.rules

    def _bound(self, explanation: Explanation, answer: Answer, own: Names, observed: Names) -> Iterator[Explanation]:
        """The explanation with the names of an answer, in every way in which they can be ours.

        In an unordered answer those that are known go together; of the others, any can be any. Where nothing else
        mentions ours, though, which is which makes no difference.
        """
        if len(own) != len(observed):
            return
        for pairs in _pairings(explanation, own, observed) if answer.unordered else (zip(own, observed, strict=True),):
            self.successors.spend()
            bound = unify(explanation, pairs)
            if bound:
                yield bound

    def _received(
        self,
        explanations: Iterable[Explanation],
        content: Hashable,
        names: Names,
        relations: tuple[str, ...],
        channel: int,
    ) -> Iterator[Successor]:
        if REDELIVERED in relations:
            relations = tuple(relation for relation in relations if relation != REDELIVERED)
            yield from self._redelivered(explanations, channel)
        if self._lenient > 1:
            explanations = (*explanations, *lenient.restarted(self.successors, self.spec, explanations, relations))
        to_show: list[Successor] = []
        for explanation in explanations:
            echoes = self._echoed(explanation, channel)
            start = self._numbered(explanation, relations, echoes=echoes)
            if start is None:
                continue
            if middle.is_unknown(start):
                yield from middle.states_shown(self.successors, start, channel, content, names)
                continue
            if self.spec.anywhere:
                start, unjudged = middle.joined(self.successors, start, channel, content)
                if unjudged:
                    yield Successor(start)
            if echoes and not {"equal", "zero", "renumbered"}.isdisjoint(relations):
                yield from self._showings(Successor(start), channel, None, content, names, echo=True)
            if not ("equal" in relations and echoes):
                to_show.append(Successor(start))
        yield from self._shown_at_last(to_show, channel, content, names)

    def _redelivered(self, explanations: Iterable[Explanation], channel: int) -> Iterator[Successor]:
        """The explanations in which a message came twice that was sent once."""
        # One that may send a message again under its number has said it twice.
        once = (one for one in explanations if not self._echoed(one, channel))
        return lenient.redelivered(explanations if self._lenient else once, channel)

    def _numbered(self, explanation: Explanation, relations: tuple[str, ...], *, echoes: bool) -> Explanation | None:
        """The explanation where a message has a number that compares so with those before; None where it cannot.

        Args:
            echoes: whether the number may be that of the message before.
        """
        sequence = self._sequence([one for one in relations if one != "equal" or not echoes])
        assumed = 0 if sequence is None else self.successors.meet(explanation.assumed, sequence)
        return explanation.replace(assumed=assumed) if assumed else None

    def _shown_at_last(
        self, starts: Iterable[Successor], channel: int, content: Hashable, names: Names
    ) -> Iterator[Successor]:
        """The explanations in which a channel shows a message: what it owes, or what it owes after silent steps.

        All that it owed before such a step is passed over then. Where several channels share the name, what one of them
        owes is passed over only for what it shows itself.
        """
        about = self._before(RECEIVED, channel)
        seen: dict[Hashable, Seen] = {}
        todo: list[tuple[Successor, Hashable]] = [(start, None) for start in starts]
        while todo:
            later: list[tuple[Successor, Hashable]] = []
            for successor, topic in todo:
                if self.successors.outdone(seen.setdefault(topic, {}), successor.explanation):
                    continue
                if any(one.foretold and one.name == channel for one in successor.explanation.channels):
                    yield self._as_foretold(successor, channel)
                    continue
                yield from self._showings(successor, channel, topic, content, names, echo=False)
                for skipped, whose in self._passed_over(successor.explanation, channel, topic):
                    later += (
                        (Successor(one.explanation, successor.rules + one.rules), whose)
                        for one in self.successors.silent(skipped, focus=about)
                    )
            todo = later

    def _as_foretold(self, successor: Successor, name: int) -> Successor:
        """The explanation once a channel of that name has shown what was settled before."""
        here, ahead = successor.explanation, self.successors.ahead
        assert ahead is not None, "only who looks ahead knows what comes"  # noqa: S101
        channels = tuple(
            Channel(one.name, one.topic, one.last, one.owed, one.foretold - 1, one.done) if one.name == name else one
            for one in here.channels
        )
        return Successor(here.replace(channels=channels), successor.rules + ahead.exercised)

    def _sequence(self, relations: Iterable[str]) -> list[Assumption] | None:
        """What is assumed where numbers compare so with those before; None where they cannot."""
        assumes: list[Assumption] = []
        for relation in relations:
            right = self.spec.sequence(relation)
            if isinstance(right, Mismatch):
                return None
            assumes += right
        return assumes

    def _showings(  # noqa: PLR0913 - what a message is made of
        self,
        successor: Successor,
        name: int,
        topic: Hashable,
        content: Hashable,
        names: Names,
        *,
        echo: bool,
    ) -> Iterator[Successor]:
        """The explanations in which a channel of that name, and of that topic if one is given, shows the message."""
        known = _channel_names(successor.explanation)
        for position, one in enumerate(successor.explanation.channels):
            if topic is not None and one.topic != topic:
                continue
            if one.name == name or (one.name < GONE and name not in known):
                yield from self._shown_on(
                    successor, position, name, content, names, echo=echo, may_repeat=topic is None
                )

    def _echoed(self, explanation: Explanation, name: int) -> bool:
        """Whether a channel of that name may send its last message again under its old number."""
        channels = (channel for channel in explanation.channels if channel.name == name)
        return any(self.spec.delivery(channel.topic).echoes for channel in channels)

    def _candidates(
        self, channel: Channel, assumed: int, *, echo: bool, may_repeat: bool
    ) -> Iterator[tuple[Owed, tuple[Owed, ...], int]]:
        """What a channel may show next: the message, those owed after it, and what is assumed then."""
        delivery = self.spec.delivery(channel.topic)
        repeats = delivery.echoes if echo else delivery.repeats
        if channel.last and repeats and may_repeat:
            yield channel.last, channel.owed, self.successors.meet(assumed, (repeats,))
        ways: tuple[int, ...] = (assumed,)
        for index, owed in enumerate(() if echo else channel.owed):
            left = channel.owed[index if owed.stays else index + 1 :]
            for way in ways:
                yield owed, left, self.successors.meet(way, (owed.only,)) if owed.only else way
            ways = tuple(dict.fromkeys(after for way in ways for after in self._past(channel, owed, way)))
            if not ways:
                return

    def _past(self, channel: Channel, owed: Owed, assumed: int) -> tuple[int, ...]:
        """What is assumed where a channel does not show something that it owes: any of these, or it has to show it."""
        if owed.passing:
            return (assumed,)
        same = self._unchanged(channel, owed, assumed)
        skips = self._skips(channel)
        if assumed in same:
            self.successors.rely()
            return same
        skipped = self.successors.meet(assumed, (skips,)) if skips else 0
        return (*same, skipped) if skipped else same

    def _skips(self, channel: Channel) -> Assumption | None:
        """Under what a channel may pass over what it owes; None if never."""
        skips = self.spec.delivery(channel.topic).skips
        return lenient.skips(channel, skips) if self._lenient else skips

    def _unchanged(self, channel: Channel, owed: Owed, assumed: int) -> tuple[int, ...]:
        """What is assumed where an owed message shows what the channel showed last, so that nobody could tell it."""
        last = channel.last
        if last is None or self.spec.delivery(channel.topic).every_time:
            return ()
        if (owed.view, owed.names) == (last.view, last.names):
            return (assumed,)
        if last.shown_as is None or owed.names:
            return ()
        matches = self.successors.matches(owed, last.shown_as)
        if isinstance(matches, Mismatch):
            return ()
        return tuple(after for match in matches if (after := self.successors.meet(assumed, match.assumes)))

    def _shown_on(  # noqa: PLR0913 - what a message is made of
        self,
        successor: Successor,
        position: int,
        name: int,
        content: Hashable,
        names: Names,
        *,
        echo: bool,
        may_repeat: bool,
    ) -> Iterator[Successor]:
        """The explanations in which the message shows one of those that the channel owes, or repeats its last one."""
        here = successor.explanation
        channel = here.channels[position]
        for owed, left, assumption in self._candidates(channel, here.assumed, echo=echo, may_repeat=may_repeat):
            matches = self.successors.matches(owed, content)
            if not assumption or isinstance(matches, Mismatch):
                continue
            for match in matches:
                agreed = self.successors.meet(assumption, match.assumes)
                if not agreed:
                    continue
                last = Owed(owed.view, owed.names, shown_as=self.spec.remembered(owed.view, content))
                after_it = Channel(channel.name, channel.topic, last, left, channel.foretold)
                channels = (*here.channels[:position], after_it, *here.channels[position + 1 :])
                after = here.replace(assumed=agreed, channels=channels)
                pairs = [(channel.name, name), *((owed.names[ref], names[at]) for ref, at in match.names)]
                bound = unify(after, pairs)
                if bound:
                    yield Successor(tidy(bound), successor.rules + match.rules)

    def _passed_over(
        self, explanation: Explanation, name: int, topic: Hashable
    ) -> Iterator[tuple[Explanation, Hashable]]:
        """The explanations in which all that a channel of that name owes is passed over, each with its topic.

        One whose name is not known yet owes nothing to anybody.
        """
        if name not in _channel_names(explanation):
            yield explanation, None
            return
        for position, channel in enumerate(explanation.channels):
            if channel.name != name or (topic is not None and channel.topic != topic):
                continue
            ways: tuple[int, ...] = (explanation.assumed,)
            for owed in channel.owed:
                ways = tuple(dict.fromkeys(after for before in ways for after in self._past(channel, owed, before)))
            for assumed in ways:
                passed = _offering(channel)
                channels = (*explanation.channels[:position], passed, *explanation.channels[position + 1 :])
                yield explanation.replace(assumed=assumed, channels=channels), channel.topic

    def _may_end(self, here: Explanation, name: int, code: str) -> int:
        """The readings under which the channels with a name may end so; 0 where they may not."""
        assumed = here.assumed
        for topic in (channel.topic for channel in here.channels if channel.name == name):
            assumes = self.spec.delivery(topic).ends.get(code)
            if self.spec.transport and (assumes is None or self._lenient):
                assumes = lenient.ends(code)
            assumed = self.successors.meet(assumed, assumes) if assumes is not None else 0
        return assumed

    def _ended(self, explanations: Iterable[Explanation], code: str, name: int) -> Iterator[Successor]:
        known: list[Explanation] = []
        others: list[Explanation] = []
        for explanation in explanations:
            (known if name in _channel_names(explanation) else others).append(explanation)
        if self.spec.anywhere:  # it was opened before the log began
            yield from map(Successor, others)
        # A stream that nothing is known of yet is that of a call whose answer has not come.
        unknown = [one for one in others if not middle.is_unknown(one)]
        if self.spec.closing is not None:
            yield from self._closed((*known, *unknown), name)
        for successor in (*map(Successor, known), *self.successors.closure(unknown, focus=self._before(ENDED, name))):
            here = successor.explanation
            for own in _named_so(here, name):
                assumed = self._may_end(here, own, code)
                bound = unify(here, [(own, name)]) if assumed else None
                if bound:
                    rest = tuple(channel for channel in bound.channels if channel.name != name)
                    ended = bound.replace(assumed=assumed, channels=rest, gone=outlived(bound, (name,)))
                    yield Successor(tidy(ended), successor.rules)

    def _closed(self, explanations: Iterable[Explanation], name: int) -> Iterator[Successor]:
        """The explanations in which a step has closed the channel of that name, or closes it now.

        Where all of them have closed it, its name is carried no more.
        """
        assert self.spec.closing is not None  # noqa: S101 - the caller has looked
        for successor in self.successors.closure(explanations, focus=self._before(ENDED, name)):
            here = successor.explanation
            if name == GONE or name in here.gone:
                yield Successor(undrained(here, name), successor.rules)
            for channel in here.channels:
                for step in self.spec.closing(here.state, channel.topic) if channel.name == name else ():
                    taken = self.successors.advance(here, step)
                    if taken:
                        yield Successor(tidy(undrained(taken[0], name)), successor.rules + step.rules)

    def _cancelled(self, explanations: Iterable[Explanation], name: int) -> Iterator[Successor]:
        for explanation in explanations:
            rest = tuple(channel for channel in explanation.channels if channel.name != name)
            left = explanation
            if len(rest) < len(explanation.channels):
                left = explanation.replace(channels=rest, gone=outlived(explanation, (name,)))
            yield Successor(tidy(left))

    def _driven(self, explanations: Iterable[Explanation], event: Hashable, names: Names) -> Iterator[Successor]:
        drive = self.spec.drives[event.name]  # type: ignore[attr-defined]

        for successor in self.successors.closure(explanations, focus=self._before_drive(event, names)):
            here = successor.explanation
            for step in drive.steps(here.state, event, tuple(here.ref(name) for name in names)):
                taken = self.successors.advance(here, step, names)
                if taken:
                    yield Successor(tidy(taken[0]), successor.rules + step.rules)

    def _settled(self, explanations: Iterable[Explanation]) -> Iterator[Successor]:
        loses = self._lenient > 0
        # What is urgent need not be what happened: a call or the surroundings may have come before it.
        seen: Seen = {}
        todo = [Successor(explanation) for explanation in explanations]
        while todo:
            later: list[Successor] = []
            for successor in todo:
                here = successor.explanation
                if middle.is_unknown(here):
                    yield successor
                    continue
                if self.successors.outdone(seen, here):
                    continue
                rests = () if self.successors.urgent(here.state) else tuple(self._nothing_owed(here, loses=loses))
                for rest in rests:
                    yield Successor(self._calmed(rest), successor.rules)
                if here.assumed in (rest.assumed for rest in rests):
                    self.successors.rely()
                else:
                    silent = self.successors.silent(here, focus=self._before_rest)
                    later += (Successor(one.explanation, successor.rules + one.rules) for one in silent)
            todo = later

    def _calmed(self, explanation: Explanation) -> Explanation:
        state = self.spec.calmed(explanation.state)
        return explanation if state is explanation.state else evolve(explanation, state=state)

    def _about(self, kind: type, *what: Part) -> FocusOf:
        """What was observed by an event, seen from what explains it; of an answer no part is told more than before."""
        if kind is Driven:
            return self._before_drive(*what)
        return self._before(RECEIVED, what[-1]) if kind in (Received, Ended) else self._before_rest

    def _before_rest(self, here: Explanation) -> Focus:
        return Focus(SETTLED, calls=self._in_flight(here))

    def _before_drive(self, event: Hashable, names: Names) -> FocusOf:
        """That the surroundings do something."""

        def about(here: Explanation) -> Focus:
            return Focus(DRIVEN, event, tuple(map(here.ref, names)), calls=self._in_flight(here))

        return about

    def _before(self, kind: Kind, name: int) -> FocusOf:
        """That something comes on a channel of that name, or on one whose name is not known yet."""

        def about(here: Explanation) -> Focus:
            topics = tuple(one.topic for one in here.channels if one.name == name or one.name < GONE)
            opened = any(one.name == name for one in here.channels)
            return Focus(kind, topics=topics, calls=self._in_flight(here), aside=opened)

        return about

    def _before_answer(self, call: int, answer: Answer) -> FocusOf:
        """That a call is answered."""

        def about(here: Explanation) -> Focus:
            asked = next(one for one in here.calls if one.name == call)
            refs = self.successors.refs(here, asked.args)
            aside = self.successors.only_opens(here, asked)
            return Focus(RETURNED, asked.request, refs, answer, calls=self._in_flight(here, besides=call), aside=aside)

        return about

    def _in_flight(self, here: Explanation, besides: int | None = None) -> tuple[tuple[Hashable, Refs], ...]:
        """The calls that may still take effect, with the positions of their names."""
        return tuple(
            (one.request, self.successors.refs(here, one.args))
            for one in here.calls
            if one.done is None and one.name != besides
        )

    def _nothing_owed(self, explanation: Explanation, *, loses: bool) -> Iterator[Explanation]:
        """The explanations in which every channel has shown where things stand; none if one has not."""
        ways: tuple[int, ...] = (explanation.assumed,)
        channels = []
        for channel in explanation.channels:
            due = [owed for owed in channel.owed if not owed.passing]
            after_it = self._each_caught_up(channel, due, ways) if due else ways
            if loses and not after_it and channel.last:
                after_it = tuple(after for before in ways if (after := self.successors.meet(before, (lenient.LOSES,))))
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

    def _caught_up(self, channel: Channel, due: list[Owed], assumed: int) -> tuple[int, ...]:
        """What is assumed where the subscriber knows all that a channel owes, since it saw that last.

        What is back where the subscriber saw it last may stay unsaid by one that sends only the latest.
        """
        ways: tuple[int, ...] = (assumed,)
        for owed in due:
            ways = tuple(after for before in ways for after in self._unchanged(channel, owed, before))
        skips = self.spec.delivery(channel.topic).skips
        if assumed in ways:
            self.successors.rely()
        skipped = self.successors.meet(assumed, (skips,)) if skips and assumed not in ways else 0
        return (*ways, *self._unchanged(channel, due[-1], skipped)) if skipped else ways


def _offering(channel: Channel) -> Channel:
    """The channel without what it owed, but for what it may say at any time."""
    return channel.owing(_offers(channel))


def _offers(channel: Channel) -> tuple[Owed, ...]:
    """What a channel may still show once everything else is passed over."""
    last = channel.owed[-1] if channel.owed else None
    return (last,) if last and last.optional else ()


def _position(explanation: Explanation, call: int) -> int | None:
    """Where among the calls in flight the one with this name stands."""
    return next((position for position, one in enumerate(explanation.calls) if one.name == call), None)


def _channel_names(explanation: Explanation) -> set[int]:
    return {channel.name for channel in explanation.channels}


def _named_so(explanation: Explanation, name: int) -> tuple[int, ...]:
    """The names under which the channel with an observed name may be known: its own, or any that nobody has seen."""
    names = dict.fromkeys(channel.name for channel in explanation.channels)
    return (name,) if name in names else tuple(one for one in names if one < GONE)


def _pairings(explanation: Explanation, own: Names, observed: Names) -> Iterator[list[tuple[int, int]]]:
    """The pairs of names that an unordered answer may mean; none where it says one twice."""
    shared = [name for name in own if name in observed]
    left, free = ([name for name in names if name not in shared] for names in (own, observed))
    if max(left, default=GONE - 1) >= GONE or len(left) != len(set(free)):
        return
    elsewhere = set(mentioned(explanation)) if len(left) > 1 else set()
    mentioned_too, rest = ([name for name in left if (name in elsewhere) is known] for known in (True, False))
    for some in itertools.permutations(free, len(mentioned_too)):
        others = (name for name in free if name not in some)
        yield [
            *zip(shared, shared, strict=True),
            *zip(mentioned_too, some, strict=True),
            *zip(rest, others, strict=True),
        ]


_OBSERVERS: dict[type, Observer[Iterator[Successor]]] = {
    Called: TransitionFunction._called,  # noqa: SLF001 - the table belongs to the class
    Returned: TransitionFunction._returned,  # noqa: SLF001
    Received: TransitionFunction._received,  # noqa: SLF001
    Ended: TransitionFunction._ended,  # noqa: SLF001
    Cancelled: TransitionFunction._cancelled,  # noqa: SLF001
    Driven: TransitionFunction._driven,  # noqa: SLF001
    Settled: TransitionFunction._settled,  # noqa: SLF001
}
