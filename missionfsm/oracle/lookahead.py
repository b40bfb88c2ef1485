"""What later events of a recorded conversation tell about the ones before them.

Where a conversation is recorded nobody has to imagine every order at once: which answer a call comes back with, and
what a stream shows next, stands further down. A `Lookahead` knows it up to a horizon, and says of an explanation
whether it can still lead there. It only ever leaves out what cannot explain the events up to the horizon, so that a
search that it leads finds an explanation exactly where there is one.
"""

from __future__ import annotations

import bisect
import operator
from collections.abc import Hashable, Iterable, Sequence

from attrs import define, field

from missionfsm.kernel.history import Called, Driven
from missionfsm.kernel.readings import Assumption, meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Delivery, Spec
from missionfsm.kernel.terms import State
from missionfsm.oracle.alignment import Alignment, Message, Showings
from missionfsm.oracle.coming import Coming, Excerpt, Horizon, Led, Narrowed, Stretch
from missionfsm.oracle.explanation import GONE, Channel, Explanation, Names, tidy, unify
from missionfsm.oracle.foresight import Foresight
from missionfsm.oracle.foretold import foretold
from missionfsm.oracle.memory import MEMORY, STEPS, Room, explanation_bytes
from missionfsm.oracle.shelf import Depot
from missionfsm.oracle.symbols import Symbol

NEXT_CALLS = 12
"""How many of the calls that are sent next and succeed are looked at."""


@define(eq=False, slots=True)
class _Way:
    """Whether channels may pass over what they owe, and show again what they have shown, as last asked for.

    Attributes:
        delivery, assumed, required: of which delivery that was asked, what was assumed, and which readings had to stay.
        ways: the answer: whether they may pass over, and whether they may show again.
        groups: the bits of the ambiguities on which that depends.
        withheld: whether one of the two was withheld.
    """

    delivery: Delivery | None
    assumed: int
    required: int
    ways: tuple[bool, bool]
    groups: int
    withheld: bool = field(kw_only=True)


@define(eq=False, slots=True)
class _Resting:
    """A channel of which nothing new is known up to some moment, as long as the state is the same.

    Which calls may take effect before a message becomes fewer on the way; that they do is looked at once the state has
    changed.

    Attributes:
        since, until: from which position on, and up to which.
        delivery: how its messages travel, where that matters.
        ways: whether it may pass over what it owes, and show again what it has shown.
        state, names: those of the explanation, where it depends on these what is known; None for a state otherwise.
    """

    channel: Channel
    since: int
    until: int
    delivery: Delivery | None
    ways: tuple[bool, bool]
    state: State | None
    names: Names


class Lookahead(Coming):
    """What the events of a window say of those before them.

    Args:
        spec: the system.
        excerpt: the events.
        horizon: how many of them may be known beforehand.
        rules: by the positions of messages the rules that those exercise which are foretold; added to.
        depot: what explanations have put away; None if nothing ever is.

    Attributes:
        required: the bits of readings that have to stay possible; what contradicts one of them is withheld.
        withheld: whether anything was withheld since this was last set.
        blamed: the bits of readings that had to stay and for which something was withheld, by the position of the next
            event.
        stopped: whether changes were not imagined since all who are to see them are too far behind what is known.
        consulted: the bits of the ambiguities of which something was assumed since the last event.
        depends: the bits of those on which it has depended since then what becomes of an explanation: it would have
            come to the same under other readings of all others.
    """

    def __init__(
        self,
        spec: Spec,
        excerpt: Excerpt,
        horizon: Horizon,
        rules: dict[int, tuple[str, ...]],
        depot: Depot | None = None,
    ) -> None:
        super().__init__(excerpt, horizon)
        self.spec = spec
        self._depot = depot
        self.required, self.withheld, self.stopped = 0, False, False
        self.blamed: dict[int, int] = {}
        self.consulted = self.depends = 0
        self._room = Room(MEMORY // STEPS)
        self._led: dict[Hashable, bool] = {}
        self._resting: dict[int, _Resting] = {}
        self._rules = rules
        self._showings = Showings(spec)
        self._way = _Way(None, 0, 0, (False, False), 0, withheld=False)
        # Behind the answers that open streams which show something, and what settles.
        opened_by = [self._answered[call] for _, _, call, _ in self._openings]
        self._shown_from = max((-1, *opened_by, *self._settled, *self._beyond)) + 1
        # Calls that will succeed: when each was sent, and what it was.
        self._successes = [
            (at, call, request, args)
            for call, (at, request, args) in self._called.items()
            if call in self.answers and self.answers[call][0].code == OK
        ]
        self._sent = [at for at, *_ in self._successes]
        self._foresight = Foresight(spec, _heeded(spec, excerpt.symbols[: horizon.end]), self._make_room)

    def consult(self, assumed: int, assumptions: Iterable[Assumption]) -> None:
        """Note what more is assumed of an explanation; what becomes of it depends on what is contradictory."""
        for one in assumptions:
            self.consulted |= one.group
            assumed &= one.kept
            if not assumed & one.group:
                self.depends |= one.group
                return

    def withholds(self, assumed: int) -> bool:
        """Whether what is assumed contradicts a reading that has to stay possible."""
        withheld = self.required & ~assumed
        if not assumed or not withheld:
            return False
        self.blamed[self.at] = self.blamed.get(self.at, 0) | withheld
        self.withheld = True
        return True

    def may_assume(self, assumed: int, one: Assumption | None) -> bool:
        """Whether something more may be assumed."""
        met = meet(assumed, (one,)) if one else 0
        return met != 0 and not self.withholds(met)

    def meet(self, assumed: int, assumptions: tuple[Assumption, ...]) -> int:
        """What is assumed once these are assumed as well; 0 when that is contradictory, or withheld."""
        met = meet(assumed, assumptions)
        self.consult(assumed, assumptions)
        return 0 if self.withholds(met) else met

    def rely(self) -> None:
        """Note that something was left out since something else assumes no more."""
        self.depends |= self.consulted

    @property
    def exercised(self) -> tuple[str, ...]:
        """The rules that the next event exercises, a message that was foretold."""
        return self._rules.get(self.at, ())

    def narrowed(self, explanation: Explanation) -> Explanation | None:
        """The explanation without what is known never to be shown; None where it cannot lead to what is.

        What a channel owes and cannot be what it shows next, is passed over then: those that differ in it are one.
        """
        if not (self._messages or self._settled or self.last):
            return explanation
        if self._openings and not self._leads_to_openings(explanation):
            return None
        if self.spec.succeeds is not None and not self._leads_to_successes(explanation):
            return None
        known = [one.name for one in explanation.channels if one.name > GONE]
        if len(known) > 1 and len(set(known)) < len(known):
            return explanation  # which of the channels that share a name a message is about, nobody knows beforehand
        foretelling = self._with_messages_foretold(explanation)
        return foretelling and self._with_channels_narrowed(foretelling, rests=foretelling is explanation)

    def _with_messages_foretold(self, explanation: Explanation) -> Explanation | None:
        """The explanation without what its channels are bound to show next; None where that is contradictory."""
        if self.spec.anywhere or self.spec.others:
            return explanation
        bound = False
        for at in range(len(explanation.channels)):
            while (channel := explanation.channels[at]).owed and channel.name > GONE:
                if self._rests(channel, explanation):
                    break
                uncertain = self._stretch(channel).uncertain
                if channel in uncertain:
                    break
                due = self._due_for_certain(channel, explanation.assumed)
                found = foretold(self.spec, self._showings, channel, due, explanation.assumed, self.meet)
                if found is None:
                    if due:
                        uncertain.add(channel)
                    break
                channels = (*explanation.channels[:at], found.channel, *explanation.channels[at + 1 :])
                after = explanation.replace(assumed=found.assumed, channels=channels)
                named = unify(after, found.names) if found.assumed else None
                if named is None:
                    return None
                for position, rules in found.rules:
                    self._rules.setdefault(position, rules)
                explanation, bound = named, bound or bool(found.names)
        return tidy(explanation) if bound else explanation

    def _due_for_certain(self, channel: Channel, assumed: int) -> Sequence[tuple[Message, int]]:
        """The messages that a channel shows next, with their positions, if it passes over nothing that it owes.

        None where it may, or may repeat itself, and none from one on whose number is something special.
        """
        stretch, delivery = self._stretch(channel), self.spec.delivery(channel.topic)
        if not (stretch.due and delivery.stands):
            return ()
        if any(self._ways(assumed, delivery)):
            return ()
        irregular = self._irregular.get(channel.name, [])
        following = bisect.bisect_left(irregular, self.at)
        until = irregular[following] if following < len(irregular) else self._horizon
        certain = bisect.bisect_left(stretch.positions, until)
        return tuple(zip(stretch.due[:certain], stretch.positions[:certain], strict=True))

    def _with_channels_narrowed(self, explanation: Explanation, *, rests: bool) -> Explanation | None:
        """The explanation with each channel narrowed; None where one cannot show what it is known to show.

        Args:
            rests: whether no message of any of them is foretold.
        """
        channels, assumed = explanation.channels, explanation.assumed
        narrow: list[Channel] = []
        for channel in channels:
            if channel.name <= GONE or channel.done or self._rests(channel, explanation):
                narrow.append(channel)
                continue
            found = self._narrowed(explanation, channel)
            if found is None:
                return None
            left, assumption, _ = found
            if assumption is not None:
                assumed = meet(assumed, (assumption,))
                if not assumed or self.withholds(assumed):
                    return None
            elif rests and left is channel:
                self._let_rest(channel, explanation)
            narrow.append(left)
        if all(map(operator.is_, narrow, channels)):
            return explanation
        return explanation.replace(channels=tuple(narrow), assumed=assumed)

    def _rests(self, channel: Channel, explanation: Explanation) -> bool:
        """Whether nothing new is known of a channel of an explanation since it was last narrowed."""
        known = self._resting.get(channel.name)
        if known is None or known.channel is not channel or not known.since <= self.at <= known.until:
            return False
        if known.state is not None and (known.state is not explanation.state or known.names != explanation.names):
            return False
        return known.delivery is None or self._ways(explanation.assumed, known.delivery) == known.ways

    def _let_rest(self, channel: Channel, explanation: Explanation) -> None:
        """Note that nothing new is known of a channel for the time being."""
        stretch, delivery, ways, state = self._stretch(channel), None, (False, False), None
        if not stretch.nothing:
            delivery = self.spec.delivery(channel.topic)
            ways = self._ways(explanation.assumed, delivery)
            led = stretch.led.get((channel, *ways))
            if led is None:
                return
            state = None if led[1] is None else explanation.state
        stands = self._stretches[channel.name][:2]
        self._resting[channel.name] = _Resting(channel, *stands, delivery, ways, state, explanation.names)

    def state(self, explanation: Explanation) -> State:
        """The state, or the one that stands for all those that nobody can tell from it any more.

        Where no message shows the state from now on, what has ended only counts.
        """
        forgets = self.spec.abstraction.forget_ended
        if not forgets or not self.last or self.at < self._shown_from or self.spec.anywhere or self.spec.others:
            return explanation.state
        if all(self._is_over(explanation, channel) for channel in explanation.channels if channel.name > GONE):
            counted = forgets(explanation.state)
            return self._depot.by_names(explanation.state, counted) if self._depot else counted
        return explanation.state

    def _is_over(self, explanation: Explanation, channel: Channel) -> bool:
        if channel.done:
            return True
        if not self._stretch(channel).over:
            return False
        found = self._narrowed(explanation, channel)
        return found is not None and found[2]

    def _leads_to_openings(self, explanation: Explanation) -> bool:
        """Whether the state may come to be shown as streams begin that nobody has opened yet."""
        cut = self._cut
        for first, called, call, message in self._openings:
            if first < self.at:
                continue
            if first >= cut:
                break
            ahead = called >= self.at or any(one.name == call and one.done is None for one in explanation.calls)
            if ahead and not self._foresees(explanation, message, first):
                return False
        return True

    def _leads_to_successes(self, explanation: Explanation) -> bool:
        """Whether the next calls that are known to succeed may come to."""
        cut = self._cut
        for call in explanation.calls:
            if call.done is None and not call.ready and self._answered.get(call.name, cut) < cut:
                answer, names = self.answers[call.name]
                if answer.code == OK and not self._succeeds(explanation, call.request, call.args, names):
                    return False
        first = bisect.bisect_left(self._sent, self.at)
        key = (explanation.state, explanation.names, first, cut)
        found = self._led.get(key)
        if found is None:
            self._make_room(explanation)
            found = self._led[key] = all(
                self._answered[call] >= cut or self._succeeds(explanation, request, args, self.answers[call][1])
                for _, call, request, args in self._successes[first : first + NEXT_CALLS]
            )
        return found

    def _succeeds(self, explanation: Explanation, request: Hashable, args: Names, names: Names) -> bool:
        succeeds = self.spec.succeeds
        return succeeds is None or succeeds(explanation.state, explanation.names, request, args, names)

    def _narrowed(self, explanation: Explanation, channel: Channel) -> Narrowed | None:
        stretch, name = self._stretch(channel), channel.name
        if stretch.mute and self._has_to_show(channel):
            return None
        if stretch.nothing:
            # What is owed to a stream that ends is never shown, and nobody minds.
            silent = stretch.over and not channel.done
            left = Channel(name, channel.topic, channel.last, (), channel.foretold, done=True) if silent else channel
            return left, None, stretch.over
        delivery = self.spec.delivery(channel.topic)
        skips, repeats = self._ways(explanation.assumed, delivery)
        key = channel, skips, repeats
        found = stretch.led.get(key)
        if found is None:
            self._make_room(explanation)
            found = stretch.led[key] = self._leading(channel, stretch, delivery, skips=skips, repeats=repeats)
        narrowed, shows = found
        return narrowed if shows is None or self._foresees(explanation, *shows, channel.topic) else None

    def _has_to_show(self, channel: Channel) -> bool:
        """Whether a channel that has shown nothing yet has to, before everything settles; what it owes is not lost."""
        if self.spec.anywhere or self.spec.others or channel.last is not None or channel.foretold:
            return False
        if all(one.passing for one in channel.owed):
            return False
        delivery = self.spec.delivery(channel.topic)
        return delivery.stands and delivery.lasts

    def _ways(self, assumed: int, delivery: Delivery) -> tuple[bool, bool]:
        """Whether channels may pass over what they owe, and whether they may show again what they have shown."""
        known = self._way
        if known.delivery is not delivery or known.assumed != assumed or known.required != self.required:
            withheld, self.withheld = self.withheld, False
            ways = self.may_assume(assumed, delivery.skips), self.may_assume(assumed, delivery.repeats)
            groups = 0
            for one in (delivery.skips, delivery.repeats):
                groups |= one.group if one else 0
            known = self._way = _Way(delivery, assumed, self.required, ways, groups, withheld=self.withheld)
            self.withheld = withheld
        self.depends |= known.groups
        self.withheld = self.withheld or known.withheld
        return known.ways

    def _leading(self, channel: Channel, stretch: Stretch, delivery: Delivery, *, skips: bool, repeats: bool) -> Led:
        """The channel, if the messages can be what it owes, in order, and after that what the state comes to show.

        Args:
            skips: whether the channel may pass over what it owes.
            repeats: whether it may show again what it has shown.
        """
        trimmed, assumes = self._without_unshown(channel, stretch, delivery, repeats=repeats)
        alignment = Alignment(trimmed, delivery, self._showings, skips, repeats)
        for position, message in enumerate(stretch.due):
            if not alignment.goes_on(message):
                led, shows = self._until_shown(alignment, stretch, position)
                break
        else:
            led, shows = self._after_shown(alignment, stretch)
        if led is not None and assumes is not None:
            led = led[0], led[1] or assumes, led[2]
        return led, shows

    def _until_shown(self, alignment: Alignment, stretch: Stretch, position: int) -> Led:
        """The same where so many of the messages are what the channel owes, and the next one is not.

        It has to show what is to come then, and what is owed before it goes unsaid.
        """
        if not alignment.may_show_what_is_to_come:
            return None, None
        channel = alignment.channel
        narrowed: Narrowed | None = (channel, None, False)
        if channel.owed and not position:
            passed = self._passed_over(channel, len(channel.owed), alignment.delivery)
            narrowed = passed and (*passed, False)
        return narrowed, (stretch.due[position], stretch.positions[position])

    def _after_shown(self, alignment: Alignment, stretch: Stretch) -> Led:
        """The same where all of the messages are what the channel owes."""
        channel, place = alignment.channel, alignment.place
        owed, last = channel.owed, place - 1
        if stretch.over and place and not owed[last].stays and not alignment.goes_unsaid(last):
            # The last message shows this one, or one before it. One that comes later would be shown only where this one
            # is skipped, and whoever may skip it may skip those that are dropped as well.
            return (channel.owing(owed[:place]), None, True), None
        before = stretch.due[-1] if stretch.due else stretch.before
        left = [one for one in owed[place:] if not one.passing]
        settles = stretch.rests and before is not None and left and not self._showings.may_be(left[-1], before)
        return (channel, None, False), (before, stretch.rest) if settles and before is not None else None

    def _without_unshown(
        self, channel: Channel, stretch: Stretch, delivery: Delivery, *, repeats: bool
    ) -> tuple[Channel, Assumption | None]:
        """The channel without what it owes before the first that can be what it shows next, and what that assumes."""
        echoes = repeats or delivery.echoes is not None
        if not stretch.due or (echoes and channel.last is not None):
            return channel, None
        message, may_be = stretch.due[0], self._showings.may_be
        first = next((at for at, one in enumerate(channel.owed) if may_be(one, message)), 0)
        return (self._passed_over(channel, first, delivery) if first else None) or (channel, None)

    def _passed_over(self, channel: Channel, many: int, delivery: Delivery) -> tuple[Channel, Assumption | None] | None:
        """The channel once so many of those that it owes are passed over, and what that assumes; None if it cannot be.

        It stays as it is where it cannot be told whether they are due.
        """
        passed, over = channel.owing(channel.owed[many:]), channel.owed[:many]
        if all(one.passing for one in over):
            return passed, None
        last = channel.last
        if last and any(one.view == last.view or last.shown_as is not None for one in over if not one.passing):
            return channel, None  # what looks like what was shown last is not due
        return (passed, delivery.skips) if delivery.skips else None

    def _make_room(self, explanation: Explanation) -> None:
        """Count what is going to be remembered of an explanation; forget the rest where that becomes too much."""
        if self._room.overflows(explanation_bytes(explanation)):
            self._led.clear()
            self._foresight.forget()
            self._showings.forget()
            for stretch in self._known.values():
                stretch.led.clear()
                stretch.uncertain.clear()

    def _foresees(self, explanation: Explanation, message: Message, position: int, topic: Hashable = None) -> bool:
        """Whether the state may come to be shown so before an event."""
        whole = self._depot.whole(explanation) if self._depot else explanation
        return self._foresight.may_show(whole, message, self.at, position, topic)


def _heeded(spec: Spec, symbols: Sequence[Symbol]) -> list[tuple[int, str]]:
    """What `Spec.foresees` is told of calls and drives, each with its position."""
    found = []
    for at, (kind, *what) in enumerate(symbols):
        if kind is Called:
            found.append((at, spec.request_operation(what[0])))
        elif kind is Driven and (heeded := spec.drives[what[0].name].heeded):
            found.append((at, heeded(what[0])))
    return found
