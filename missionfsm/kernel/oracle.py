"""From explanations of what was observed so far to those of what is observed next: exact, and only once for each.

`Oracle.step` is the transition function of the belief automaton: all explanations before an event to all explanations
after it. `missionfsm.kernel.belief` walks that automaton and remembers it.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Iterable, Iterator
from typing import Any

from missionfsm.kernel.explanation import (
    GONE,
    Channel,
    Explanation,
    InFlight,
    Lost,
    Names,
    Owed,
    Ready,
    changes,
    mentioned,
    outlived,
    take,
    tidy,
    unify,
)
from missionfsm.kernel.history import Answer, Called, Cancelled, Driven, Ended, Received, Returned, Settled
from missionfsm.kernel.readings import Assumption, meet, merge
from missionfsm.kernel.spec import Match, Mismatch, Spec, Step
from missionfsm.kernel.values import value

LAG = 6
"""How many changes that nobody drove a channel may owe before the oracle stops to imagine further ones."""

BUDGET = 20_000
"""How many explanations one event may cost before the run is given up as inconclusive."""


class ExhaustedError(Exception):
    """An event has more explanations than the budget allows."""


@value
class Sighting:
    """An explanation that an observation leaves, and the rules that were exercised on the way."""

    explanation: Explanation
    rules: tuple[str, ...] = ()


class Oracle:
    """A spec with what is known about the run: what is driven, what is assumed from the start.

    It holds caches and nothing that could change an answer.

    Args:
        spec: the system.
        driven: the drives that a tester commands; what the others do may happen at any time by itself.
        budget: explanations that a single event may cost.
    """

    def __init__(self, spec: Spec, driven: Iterable[str] = (), budget: int = BUDGET) -> None:
        self.spec = spec
        self.driven = frozenset(driven)
        self.budget = budget
        self.groups = tuple(ambiguity.group for ambiguity in spec.ambiguities)
        self._outcomes: dict[Any, tuple[Step, ...]] = {}
        self._urgent: dict[Any, tuple[Step, ...]] = {}
        self._unseen: dict[Any, tuple[Step, ...]] = {}
        self._matches: dict[Any, tuple[Match, ...] | Mismatch] = {}
        self._spent = 0

    def reset(self) -> None:
        """Start counting against the budget anew."""
        self._spent = 0

    # What the spec says, remembered.

    def forget(self) -> None:
        """Drop what the spec said; it will say the same again."""
        for memory in (self._outcomes, self._urgent, self._unseen, self._matches):
            memory.clear()

    def outcomes(self, state: Any, request: Hashable, refs: tuple[int | None, ...]) -> tuple[Step, ...]:  # noqa: ANN401
        """Every answer to a request in a state."""
        key = (state, request, refs)
        found = self._outcomes.get(key)
        if found is None:
            found = self._outcomes[key] = self.spec.outcomes(state, request, refs)
        return found

    def urgent(self, state: Any) -> tuple[Step, ...]:  # noqa: ANN401 - a state of any system
        """What must happen before things have settled."""
        found = self._urgent.get(state)
        if found is None:
            found = self._urgent[state] = self.spec.urgent(state)
        return found

    def unseen(self, state: Any) -> tuple[Step, ...]:  # noqa: ANN401 - a state of any system
        """What may happen at any time although nobody asked for it."""
        found = self._unseen.get(state)
        if found is None:
            steps = list(self.spec.spontaneous(state))
            for drive in self.spec.drives.values():
                if drive.name not in self.driven:
                    for event in drive.by_itself:
                        steps += drive.steps(state, event, ())
            found = self._unseen[state] = tuple(steps)
        return found

    def matches(self, owed: Owed, content: Hashable) -> tuple[Match, ...] | Mismatch:
        """The ways in which a message shows what is owed."""
        key = (owed.view, content)
        found = self._matches.get(key)
        if found is None:
            found = self._matches[key] = self.spec.matches(owed.view, content)
        return found

    # How one explanation goes on.

    def advance(
        self, explanation: Explanation, step: Step, given: Names = (), besides: int | None = None
    ) -> tuple[Explanation, Names] | None:
        """The explanation after a step; calls in flight remember what they could have been answered before it.

        The call `besides` does not need to: whoever looks for its answer looks at every explanation on the way.
        """
        if explanation.calls and step.after is not explanation.state:
            explanation = self._remember(explanation, besides)
        passing = bool(self.urgent(step.after))
        return take(explanation, step, given, passing=passing, concerns=self.spec.concerns)

    def _remember(self, explanation: Explanation, besides: int | None) -> Explanation:
        if all(call.done or call.name == besides for call in explanation.calls):
            return explanation
        calls = []
        for call in explanation.calls:
            if call.done is None and call.name != besides:
                known = dict.fromkeys(call.ready)
                known.update(dict.fromkeys(self._idle_answers(explanation, call)))
                call = InFlight(call.name, call.request, call.args, tuple(known), call.done)  # noqa: PLW2901 - the same call, knowing more
            calls.append(call)
        return explanation.but(calls=tuple(calls))

    def _idle_answers(self, explanation: Explanation, call: InFlight) -> Iterator[Ready]:
        refs = tuple(explanation.ref(arg) for arg in call.args)
        for step in self.outcomes(explanation.state, call.request, refs):
            if step.answer is not None and step.applied and not changes(explanation, step):
                yield Ready(step.answer, tuple(explanation.names[ref] for ref in step.refs), step.assumes, step.rules)

    def _late_answers(self, explanation: Explanation, call: InFlight, refs: tuple[int | None, ...]) -> Iterator[Ready]:
        """What a call may be answered that is given up although it takes effect, now or later."""
        for step in self.outcomes(explanation.state, call.request, refs):
            if step.answer is not None and not step.applied:
                yield Ready(step.answer, (), step.assumes, step.rules)

    def _addressed(self, explanation: Explanation, args: Names) -> Iterator[tuple[Explanation, tuple[int | None, ...]]]:
        """The explanation with the positions of a request's names.

        A name that nothing has may be that of something whose name was not seen yet.
        """
        yield explanation, tuple(explanation.ref(arg) for arg in args)
        for arg in args:
            if arg != GONE and explanation.ref(arg) is None:
                for own in explanation.names:
                    if own < GONE:
                        bound = unify(explanation, [(own, arg)])
                        if bound:
                            yield from self._addressed(bound, args)

    def silent(self, explanation: Explanation, besides: int | None = None) -> Iterator[Sighting]:
        """Everything that an explanation can become next without anybody seeing it.

        Calls take effect, except the one with the name `besides`; the system and its surroundings act by themselves.
        """
        for step in self.urgent(explanation.state):
            yield from self._sight(explanation, step, besides)
        if all(len(channel.owed) < LAG for channel in explanation.channels):
            for step in self.unseen(explanation.state):
                yield from self._sight(explanation, step, besides)
        for position, (request, args) in enumerate(explanation.lost):
            if (request, args) in explanation.lost[:position]:
                continue
            rest = (*explanation.lost[:position], *explanation.lost[position + 1 :])
            for where, refs in self._addressed(explanation, args):
                for step in self.outcomes(where.state, request, refs):
                    if changes(where, step) and not step.opens:
                        yield from self._sight(where.but(lost=rest), step, besides)
        for position, call in enumerate(explanation.calls):
            if call.done is None and call.name != besides:
                yield from self._take_effect(explanation, position, besides)

    def _sight(self, explanation: Explanation, step: Step, besides: int | None = None) -> Iterator[Sighting]:
        taken = self.advance(explanation, step, besides=besides)
        if taken:
            yield Sighting(tidy(taken[0]), step.rules)

    def _take_effect(self, explanation: Explanation, position: int, besides: int | None) -> Iterator[Sighting]:
        for where, refs in self._addressed(explanation, explanation.calls[position].args):
            for step in self.outcomes(where.state, where.calls[position].request, refs):
                if step.answer is None or not changes(where, step):
                    continue
                taken = self.advance(where, step, besides=besides)
                if taken:
                    after, names = taken
                    done = Ready(step.answer, names, (), step.rules)
                    calls = list(after.calls)
                    late = () if step.opens else tuple(self._late_answers(where, where.calls[position], refs))
                    calls[position] = InFlight(calls[position].name, calls[position].request, (), late, done)
                    yield Sighting(tidy(after.but(calls=tuple(calls))), step.rules)

    def closure(self, start: Explanation, besides: int | None = None) -> Iterator[Sighting]:
        """An explanation and everything that it can silently become, nearest first.

        One that has used up more lost calls than another at the same point is left out, and so is all that follows.
        """
        seen: dict[Any, list[tuple[int, _Bag]]] = {}
        todo = [Sighting(start)]
        while todo:
            later: list[Sighting] = []
            for sighting in todo:
                if self._outdone(seen, sighting.explanation):
                    continue
                yield sighting
                later += (
                    Sighting(next_one.explanation, sighting.rules + next_one.rules)
                    for next_one in self.silent(sighting.explanation, besides)
                )
            todo = later

    def _outdone(self, seen: dict[Any, list[tuple[int, _Bag]]], explanation: Explanation) -> bool:
        """Whether something at the same point has assumed no more and has all the lost calls; notes it otherwise."""
        self._spend()
        key = _point(explanation)
        lost = _bag(explanation.lost)
        others = seen.setdefault(key, [])
        if any(explanation.assumed | assumed == assumed and lost <= left for assumed, left in others):
            return True
        others.append((explanation.assumed, lost))
        return False

    def _spend(self) -> None:
        self._spent += 1
        if self._spent > self.budget:
            raise ExhaustedError

    # One observation.

    def step(self, explanations: Iterable[Explanation], kind: type, *what: Any) -> tuple[Sighting, ...]:  # noqa: ANN401
        """Every explanation of what was observed before and of this event.

        Args:
            explanations: those of what was observed before.
            kind: the class of the event in `missionfsm.kernel.history`.
            what: its fields, with names as numbers (see `Explanation`).

        Raises:
            ExhaustedError: the event costs more than the budget.
        """
        self.reset()
        observe: Callable[..., Iterator[Sighting]] = _OBSERVERS[kind]
        found = [sighting for explanation in explanations for sighting in observe(self, explanation, *what)]
        return self._sift(found)

    def _called(
        self,
        explanation: Explanation,
        request: Hashable,
        args: Names,
        lost: bool,  # noqa: FBT001 - a field of the event
        call: int,
    ) -> Iterator[Sighting]:
        if lost:
            yield Sighting(explanation.but(lost=(*explanation.lost, (request, args))))
        else:
            yield Sighting(explanation.but(calls=(*explanation.calls, InFlight(call, request, args))))

    def _returned(self, explanation: Explanation, answer: Answer, names: Names, call: int) -> Iterator[Sighting]:
        yield from self._failed(explanation, answer, names, call)
        for sighting in self.closure(explanation, besides=call):
            here = sighting.explanation
            position = next((at for at, one in enumerate(here.calls) if one.name == call), None)
            if position is None:
                return
            for after, rules in self._answered(here, position, answer, names):
                yield Sighting(tidy(after), sighting.rules + rules)
            if here.calls[position].done:
                return

    def _failed(self, explanation: Explanation, answer: Answer, names: Names, call: int) -> Iterator[Sighting]:
        """The explanation in which the call has failed without anybody's doing, which any state allows.

        What is silent may as well come after it, so that this explanation is enough.
        """
        position = next((at for at, one in enumerate(explanation.calls) if one.name == call), None)
        if position is None or names or answer.shape is not None:
            return
        one = explanation.calls[position]
        failure = self.spec.failing(one.request, answer.code)
        if failure is None or (failure.driven and "fault" in self.driven) or (one.done and not failure.open_ended):
            return
        assumed = meet(explanation.assumed, failure.assumes)
        if assumed:
            calls = (*explanation.calls[:position], *explanation.calls[position + 1 :])
            late = ((one.request, one.args),) if failure.open_ended and not one.done else ()
            yield Sighting(tidy(explanation.but(assumed=assumed, calls=calls, lost=(*explanation.lost, *late))))

    def _answered(
        self, here: Explanation, position: int, answer: Answer, names: Names
    ) -> Iterator[tuple[Explanation, tuple[str, ...]]]:
        call = here.calls[position]
        rest = here.but(calls=(*here.calls[:position], *here.calls[position + 1 :]))
        if call.done:
            for match in self._agreements(call.done.answer, answer):
                assumed = meet(rest.assumed, match.assumes)
                for bound in _bindings(rest, answer, call.done.names, names) if assumed else ():
                    yield bound.but(assumed=assumed), match.rules
        for ready in call.ready:
            for match in self._agreements(ready.answer, answer):
                assumed = meet(rest.assumed, (*ready.assumes, *match.assumes))
                for bound in _bindings(rest, answer, ready.names, names) if assumed else ():
                    yield bound.but(assumed=assumed), ready.rules + match.rules
        if call.done:
            return
        for where, refs in self._addressed(rest, call.args):
            for step in self.outcomes(where.state, call.request, refs):
                if step.answer is None or len(step.refs) != len(names):
                    continue
                for match in self._agreements(step.answer, answer):
                    yield from self._answered_by(where, step, match, call, answer, names)

    def _answered_by(  # noqa: PLR0913 - what an answer is made of
        self, where: Explanation, step: Step, match: Match, call: InFlight, answer: Answer, names: Names
    ) -> Iterator[tuple[Explanation, tuple[str, ...]]]:
        assumed = meet(where.assumed, match.assumes)
        if not assumed:
            return
        lost = where.lost if step.applied else (*where.lost, (call.request, call.args))
        taken = self.advance(where.but(lost=lost, assumed=assumed), step)
        if taken:
            for bound in _bindings(taken[0], answer, taken[1], names):
                yield bound, step.rules + match.rules

    def _agreements(self, allowed: Answer, given: Answer) -> tuple[Match, ...]:
        """The ways in which an answer is the one that is allowed."""
        if allowed == given:
            return _EQUAL
        if self.spec.answers is None or (allowed.code, allowed.unordered) != (given.code, given.unordered):
            return ()
        key = (allowed, given)
        found = self._matches.get(key)
        if found is None:
            found = self._matches[key] = self.spec.answers(allowed.shape, given.shape)
        return () if isinstance(found, Mismatch) else found

    def _received(
        self, explanation: Explanation, content: Hashable, names: Names, relations: tuple[str, ...], channel: int
    ) -> Iterator[Sighting]:
        sequence: list[Assumption] = []
        echoes = self._echoed(explanation, channel)
        for relation in relations:
            if relation == "equal" and echoes:
                continue
            right = self.spec.sequence(relation)
            if isinstance(right, Mismatch):
                return
            sequence += right
        assumed = meet(explanation.assumed, sequence)
        if not assumed:
            return
        start = Sighting(explanation.but(assumed=assumed))
        if echoes and not {"equal", "zero", "renumbered"}.isdisjoint(relations):
            yield from self._showings(start, channel, None, content, names, echo=True)
        if "equal" in relations and echoes:
            return
        # Where several channels share the name, what one of them owes is passed over only for what it shows itself.
        seen: dict[Hashable, dict[Any, list[tuple[int, _Bag]]]] = {}
        todo: list[tuple[Sighting, Hashable]] = [(start, None)]
        while todo:
            later: list[tuple[Sighting, Hashable]] = []
            for sighting, topic in todo:
                if self._outdone(seen.setdefault(topic, {}), sighting.explanation):
                    continue
                yield from self._showings(sighting, channel, topic, content, names, echo=False)
                for skipped, whose in self._passed_over(sighting.explanation, channel, topic):
                    later += (
                        (Sighting(one.explanation, sighting.rules + one.rules), whose) for one in self.silent(skipped)
                    )
            todo = later

    def _showings(  # noqa: PLR0913 - what a message is made of
        self,
        sighting: Sighting,
        name: int,
        topic: Hashable,
        content: Hashable,
        names: Names,
        *,
        echo: bool,
    ) -> Iterator[Sighting]:
        """The explanations in which a channel of that name, and of that topic if one is given, shows the message."""
        known = _channel_names(sighting.explanation)
        for position, one in enumerate(sighting.explanation.channels):
            if topic is not None and one.topic != topic:
                continue
            if one.name == name or (one.name < GONE and name not in known):
                yield from self._shown(sighting, position, name, content, names, echo=echo, again=topic is None)

    def _echoed(self, explanation: Explanation, name: int) -> bool:
        """Whether a channel of that name may send its last message again under its old number."""
        channels = (channel for channel in explanation.channels if channel.name == name)
        return any(self.spec.delivery(channel.topic).echoes for channel in channels)

    def _candidates(
        self, channel: Channel, assumed: int, *, echo: bool, again: bool
    ) -> Iterator[tuple[Owed, tuple[Owed, ...], int]]:
        """What a channel may show next: the message, those owed after it, and what is assumed then."""
        delivery = self.spec.delivery(channel.topic)
        repeats = delivery.echoes if echo else delivery.repeats
        if channel.last and repeats and again:
            yield channel.last, channel.owed, meet(assumed, (repeats,))
        for index, owed in enumerate(() if echo else channel.owed):
            left = channel.owed[index if owed.stays else index + 1 :]
            yield owed, left, meet(assumed, (owed.only,)) if owed.only else assumed
            if not owed.passing:
                assumed = meet(assumed, (delivery.skips,)) if delivery.skips else 0
            if not assumed:
                return

    def _shown(  # noqa: PLR0913 - what a message is made of
        self,
        sighting: Sighting,
        position: int,
        name: int,
        content: Hashable,
        names: Names,
        *,
        echo: bool,
        again: bool,
    ) -> Iterator[Sighting]:
        """The explanations in which the message shows one of those that the channel owes, or its last one `again`."""
        here = sighting.explanation
        channel = here.channels[position]
        for owed, left, assumption in self._candidates(channel, here.assumed, echo=echo, again=again):
            matches = self.matches(owed, content)
            if not assumption or isinstance(matches, Mismatch):
                continue
            for match in matches:
                agreed = meet(assumption, match.assumes)
                if not agreed:
                    continue
                shown = Channel(channel.name, channel.topic, Owed(owed.view, owed.names), left)
                channels = (*here.channels[:position], shown, *here.channels[position + 1 :])
                after = here.but(assumed=agreed, channels=channels)
                pairs = [(channel.name, name), *((owed.names[ref], names[at]) for ref, at in match.names)]
                bound = unify(after, pairs)
                if bound:
                    yield Sighting(tidy(bound), sighting.rules + match.rules)

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
            assumed = explanation.assumed
            if not all(owed.passing for owed in channel.owed):
                skips = self.spec.delivery(channel.topic).skips
                assumed = meet(assumed, (skips,)) if skips else 0
            if assumed:
                passed = _offering(channel)
                channels = (*explanation.channels[:position], passed, *explanation.channels[position + 1 :])
                yield explanation.but(assumed=assumed, channels=channels), channel.topic

    def _ended(self, explanation: Explanation, code: str, name: int) -> Iterator[Sighting]:
        # A stream that nothing is known of yet is that of a call whose answer has not come.
        known = name in _channel_names(explanation)
        for sighting in (Sighting(explanation),) if known else self.closure(explanation):
            here = sighting.explanation
            for own in dict.fromkeys(channel.name for channel in here.channels):
                if own != name and (known or own >= GONE):
                    continue
                assumed = here.assumed
                for topic in (channel.topic for channel in here.channels if channel.name == own):
                    assumes = self.spec.delivery(topic).ends.get(code)
                    assumed = meet(assumed, assumes) if assumes is not None else 0
                bound = unify(here, [(own, name)]) if assumed else None
                if bound:
                    rest = tuple(channel for channel in bound.channels if channel.name != name)
                    ended = bound.but(assumed=assumed, channels=rest, gone=outlived(bound, (name,)))
                    yield Sighting(tidy(ended), sighting.rules)

    def _cancelled(self, explanation: Explanation, name: int) -> Iterator[Sighting]:
        rest = tuple(channel for channel in explanation.channels if channel.name != name)
        if len(rest) < len(explanation.channels):
            explanation = explanation.but(channels=rest, gone=outlived(explanation, (name,)))
        yield Sighting(tidy(explanation))

    def _driven(self, explanation: Explanation, event: Hashable, names: Names) -> Iterator[Sighting]:
        drive = self.spec.drives[event.name]  # type: ignore[attr-defined]
        for sighting in self.closure(explanation):
            here = sighting.explanation
            for step in drive.steps(here.state, event, tuple(here.ref(name) for name in names)):
                taken = self.advance(here, step, names)
                if taken:
                    yield Sighting(tidy(taken[0]), sighting.rules + step.rules)

    def _settled(self, explanation: Explanation) -> Iterator[Sighting]:
        # What is urgent need not be what happened: a call or the surroundings may have come before it.
        seen: dict[Any, list[tuple[int, _Bag]]] = {}
        todo = [Sighting(explanation)]
        while todo:
            later: list[Sighting] = []
            for sighting in todo:
                here = sighting.explanation
                if self._outdone(seen, here):
                    continue
                rest = None if self.urgent(here.state) else self._nothing_owed(here)
                if rest:
                    yield Sighting(rest, sighting.rules)
                if rest is None or rest.assumed != here.assumed:
                    later += (Sighting(one.explanation, sighting.rules + one.rules) for one in self.silent(here))
            todo = later

    def _nothing_owed(self, explanation: Explanation) -> Explanation | None:
        """The explanation in which every channel has shown where things stand, or None if one has not."""
        assumed, channels = explanation.assumed, []
        for channel in explanation.channels:
            due = [owed for owed in channel.owed if not owed.passing]
            if due:
                # What is back where the subscriber saw it last may stay unsaid by one that sends only the latest.
                skips = self.spec.delivery(channel.topic).skips
                told = channel.last and (due[-1].view, due[-1].names) == (channel.last.view, channel.last.names)
                assumed = meet(assumed, (skips,)) if skips and told else 0
            channels.append(
                Channel(channel.name, channel.topic, channel.last, _offers(channel)) if channel.owed else channel
            )
        return tidy(explanation.but(assumed=assumed, channels=tuple(channels))) if assumed else None

    # Fewer explanations that say the same.

    def _sift(self, found: Iterable[Sighting]) -> tuple[Sighting, ...]:
        """Those among the explanations that the others do not already stand for."""
        points: dict[_Place, list[Sighting]] = {}
        for sighting in found:
            point = _place(sighting.explanation)
            points[point] = self._widened(points.get(point, []), sighting)
        kept = _without_spendthrifts([sighting for sightings in points.values() for sighting in sightings])
        return tuple(kept) if len(kept) <= 1 else tuple(self._without_later(kept))

    def _widened(self, sightings: list[Sighting], new: Sighting) -> list[Sighting]:
        """Explanations at one point with one more; those that differ in a single question become one."""
        for position, other in enumerate(sightings):
            union = merge(other.explanation.assumed, new.explanation.assumed, self.groups)
            if union is not None:
                if union == other.explanation.assumed:
                    return sightings
                rules = tuple(dict.fromkeys(other.rules + new.rules))
                rest = [*sightings[:position], *sightings[position + 1 :]]
                return self._widened(rest, Sighting(new.explanation.but(assumed=union), rules))
        return [*sightings, new]

    def _without_later(self, sightings: list[Sighting]) -> Iterator[Sighting]:
        """Those that no other can silently become."""
        reached: dict[_Place, int] = {}
        for sighting in sightings:
            point = _place(sighting.explanation)
            if point in reached and sighting.explanation.assumed | reached[point] == reached[point]:
                covered = True
            else:
                covered = False
                yield sighting
            base = reached[point] if covered else sighting.explanation.assumed
            for later in self.silent(sighting.explanation.but(assumed=base)):
                key = _place(later.explanation)
                if key not in reached or reached[key] | later.explanation.assumed == later.explanation.assumed:
                    reached[key] = later.explanation.assumed


_Place = tuple[Hashable, ...]
_Bag = frozenset[tuple[Hashable, int]]
"""Lost calls whatever their order: each with how many like it came before."""


def _place(explanation: Explanation) -> _Place:
    """Where an explanation is, whatever it assumed."""
    return (*_point(explanation), explanation.lost)


def _point(explanation: Explanation) -> _Place:
    """Where an explanation is, whatever it assumed and whichever lost calls it has left."""
    return explanation.state, explanation.names, explanation.calls, explanation.channels, explanation.gone


def _bag(lost: Lost) -> _Bag:
    if len(set(lost)) == len(lost):
        return frozenset(zip(lost, itertools.repeat(0), strict=False))
    return frozenset((call, lost[:position].count(call)) for position, call in enumerate(lost))


_EQUAL = (Match(),)
"""The one way in which equal answers agree."""


def _offering(channel: Channel) -> Channel:
    """The channel without what it owed, but for what it may say at any time."""
    return Channel(channel.name, channel.topic, channel.last, _offers(channel))


def _offers(channel: Channel) -> tuple[Owed, ...]:
    """What a channel may still show once everything else is passed over."""
    last = channel.owed[-1] if channel.owed else None
    return (last,) if last and last.optional else ()


def _channel_names(explanation: Explanation) -> set[int]:
    return {channel.name for channel in explanation.channels}


def _bindings(explanation: Explanation, answer: Answer, own: Names, observed: Names) -> Iterator[Explanation]:
    """The explanation with the names of an answer, in every way in which they can be ours.

    In an unordered answer those that are known go together; of the others, any can be any. Where nothing else mentions
    ours, though, which is which makes no difference.
    """
    if len(own) != len(observed):
        return
    if answer.unordered:
        shared = [name for name in own if name in observed]
        left, free = ([name for name in names if name not in shared] for names in (own, observed))
        told = [name for name in left if name in set(mentioned(explanation))] if len(left) > 1 else []
        rest = [name for name in left if name not in told]
        ways = (
            [
                *zip(shared, shared, strict=True),
                *zip(told, some, strict=True),
                *zip(rest, (name for name in free if name not in some), strict=False),
            ]
            for some in (itertools.permutations(free, len(told)) if max(left, default=-2) < GONE else ())
        )
    else:
        ways = iter([list(zip(own, observed, strict=True))])  # type: ignore[assignment]
    for pairs in ways:
        bound = unify(explanation, pairs)
        if bound:
            yield bound


def _without_spendthrifts(sightings: list[Sighting]) -> list[Sighting]:
    """Without those that have used up more lost calls than another at the same point, assuming no less."""
    if not any(sighting.explanation.lost for sighting in sightings):
        return sightings
    kept: dict[_Place, list[tuple[int, _Bag, Sighting]]] = {}
    for sighting in sorted(sightings, key=lambda one: -len(one.explanation.lost)):
        lost = _bag(sighting.explanation.lost)
        others = kept.setdefault(_point(sighting.explanation), [])
        assumed = sighting.explanation.assumed
        if not any(assumed | other == other and lost <= left for other, left, _ in others):
            others.append((assumed, lost, sighting))
    return [sighting for others in kept.values() for _, _, sighting in others]


def surviving_names(explanations: Iterable[Explanation]) -> dict[int, int]:
    """New numbers for the observed names that are still carried, in the order of first mention.

    A name that is gone in some explanations and was never anything's in others is carried on as well.
    """
    explanations = tuple(explanations)
    seen = dict.fromkeys(name for one in explanations for name in mentioned(one) if name > GONE)
    outlasted = (name for one in explanations for name in one.gone)
    seen.update(dict.fromkeys(name for name in outlasted if not all(name in one.gone for one in explanations)))
    return {name: number for number, name in enumerate(seen)}


_OBSERVERS: dict[type, Callable[..., Iterator[Sighting]]] = {
    Called: Oracle._called,  # noqa: SLF001 - the table belongs to the class
    Returned: Oracle._returned,  # noqa: SLF001
    Received: Oracle._received,  # noqa: SLF001
    Ended: Oracle._ended,  # noqa: SLF001
    Cancelled: Oracle._cancelled,  # noqa: SLF001
    Driven: Oracle._driven,  # noqa: SLF001
    Settled: Oracle._settled,  # noqa: SLF001
}

__all__ = ["BUDGET", "GONE", "Channel", "ExhaustedError", "Oracle", "Sighting", "surviving_names"]
