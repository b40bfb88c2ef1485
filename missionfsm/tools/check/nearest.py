"""Which explanations come nearest to explaining an event that none explains, and what keeps each from it.

An event is a violation when no explanation allows it. Something keeps each of them from it: another code, another name,
a wrong value, a reading that was ruled out before, something that nobody made happen. The explanation with the least of
these problems says best what is wrong.
"""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Iterable, Iterator

from attrs import evolve, frozen

from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.history import Answer, Name, Received, Returned
from missionfsm.kernel.middle import ANY
from missionfsm.kernel.readings import Ambiguity, Assumption, meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Delivery, Spec
from missionfsm.kernel.step import Mismatch, Step, Unowed
from missionfsm.kernel.terms import Content, View
from missionfsm.kernel.text import counted
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.explanation import GONE, Channel, Explanation, Names, Owed, unify
from missionfsm.oracle.middle import world_of
from missionfsm.oracle.successors import ExhaustedError, Successor
from missionfsm.oracle.symbols import call_of, names_of
from missionfsm.oracle.unsaid import Unsaid
from missionfsm.tools.check.candidates import (
    CODE,
    ELSE,
    FAILED,
    LEFT_OUT,
    NAME,
    READING,
    SHAPE,
    UNBEGUN,
    UNDRIVEN,
    UNOWED,
    VALUE,
    AnsweredCall,
    Candidate,
    Circumstances,
    Problem,
)
from missionfsm.tools.check.causes import delivering
from missionfsm.tools.check.phrases import answer_words, described, name_words

SOME_STATE = "any state that what was shown before can have become"
"""What may come if nothing is known of what happened before, in words."""

MAX_LOOKED_AT = 200
"""How many explanations are looked at, the nearest first."""


WORD = re.compile(r"-?\w+")
"""A word or a number in a description."""


@frozen
class _Message:
    """A message that came: the event, its content, its names and its channel as the oracle numbers them."""

    event: Received
    content: Content
    given: Names
    number: int


def _distance(one: str, other: str) -> int:
    """How far two texts are from each other, from 0 to 9."""
    matcher = difflib.SequenceMatcher(None, WORD.findall(one), WORD.findall(other), autojunk=False)
    return round(9 * (1 - matcher.ratio()))


def rules_about(spec: Spec, assumption: Assumption) -> tuple[str, ...]:
    """The rules that an implementation breaks if it does not read a question the same way each time."""
    ambiguity = assumption.ambiguity
    under = [rule.id for rule in spec.all_rules if rule.assumes is not None and rule.assumes.ambiguity is ambiguity]
    named = [rule.id for rule in spec.all_rules if ambiguity.rule and rule.id.endswith(ambiguity.rule)]
    about = tuple(dict.fromkeys((*named, *under)))
    return about or spec.promised_about(ambiguity)


class Nearest:
    """The candidates for one event, found among the explanations of everything before it."""

    def __init__(self, belief: Belief, about: Circumstances) -> None:
        self.belief = belief
        self.about = about
        self.spec = belief.automaton.spec
        self.successors = belief.automaton.successors
        self._unsaid = Unsaid(self.successors, 0)
        self.successors.reset()

    def reachable(self, besides: int | None = None) -> Iterator[Explanation]:
        """What the explanations can become by silent steps, the nearest first."""
        return (successor.explanation for successor in self.ways(besides))

    def ways(self, besides: int | None = None) -> Iterator[Successor]:
        """What the explanations can become by silent steps, the nearest first, with the rules of those steps."""
        found = self.successors.closure(self.belief.node.explanations, besides)
        try:
            yield from itertools.islice(found, MAX_LOOKED_AT)
        except ExhaustedError:
            return

    def at_rest(self, here: Explanation) -> bool:
        """Whether nothing that is urgent has still to happen."""
        return not any(meet(here.assumed, step.assumes) for step in self.successors.urgent(here.state))

    def is_told(self, here: Explanation, channel: Channel) -> bool:
        """Whether a channel has shown last all that it owes, so that nobody misses it."""
        return self._unsaid.is_told(channel, here.assumed)

    def unusual(self, here: Explanation) -> int:
        """How many questions an explanation does not read in their usual way."""
        return sum(one.default not in one.possible(here.assumed) for one in self.spec.ambiguities)

    # Answers.

    def answers(self, event: Returned) -> Iterator[Candidate]:
        """Every answer that the call could have had, also under readings that were ruled out."""
        symbol, _ = self.belief.symbol(event)
        number, given = call_of(symbol), names_of(symbol)
        for successor in self.ways(besides=number):
            here = successor.explanation
            call = next((one for one in here.calls if one.name == number), None)
            if call is None:
                continue
            ready = (*call.ready, call.done) if call.done else call.ready
            for one in ready:
                problems = self._answered(here, event, given, one.answer, one.names, one.assumes)
                yield self._candidate(successor, one.answer, one.names, one.rules, one.assumes, problems)
            if call.done:
                continue
            refs = self.successors.refs(here, call.args)
            for step in self.successors.outcomes(here.state, call.request, refs):
                if step.answer is not None:
                    sent = delivering(self.spec, step)
                    rules = tuple(rule for rule in step.rules if rule not in sent)
                    names = tuple(here.names[ref] if ref < len(here.names) else GONE - 1 for ref in step.refs)
                    problems = self._answered(here, event, given, step.answer, names, step.assumes)
                    yield self._candidate(successor, step.answer, names, rules, step.assumes, problems)

    def _candidate(
        self,
        successor: Successor,
        answer: Answer,
        names: Names,
        rules: tuple[str, ...],
        assumes: tuple[Assumption, ...],
        problems: list[Problem],
    ) -> Candidate:
        here = successor.explanation
        what = answer_words(answer, tuple(map(self._known, names)))
        allowed = bool(meet(here.assumed, assumes))
        unusual = sum(
            one.ambiguity.default not in one.letters and one.ambiguity.default in one.ambiguity.possible(here.assumed)
            for one in assumes
        )
        together: dict[Ambiguity, int] = {}
        for one in assumes:
            together[one.ambiguity] = together.get(one.ambiguity, one.group) & one.kept
        shown = tuple(str(ambiguity.where(kept)) for ambiguity, kept in together.items())
        return Candidate(
            what=what,
            rules=rules,
            assumes=shown,
            problems=tuple(problems),
            allowed=allowed,
            unseen=successor.rules,
            early=not self.at_rest(here),
            unusual=unusual,
            code=answer.code,
            departs=any(one.ambiguity.flagged.issuperset(one.letters) for one in assumes),
        )

    def _answered(
        self,
        here: Explanation,
        event: Returned,
        given: Names,
        answer: Answer,
        names: Names,
        assumes: tuple[Assumption, ...],
    ) -> list[Problem]:
        problems = list(self._readings(here, assumes))
        if answer.code != event.answer.code:
            return [*problems, Problem("", (), CODE)]
        ways = self.successors.agreements(answer, event.answer)
        if not ways:
            return [*problems, self._shape(answer, event.answer)]
        problems += self._readings(here, ways[0].assumes)
        return [*problems, *self._names(here, names, given, event.names, unordered=answer.unordered)]

    def _shape(self, answer: Answer, given: Answer) -> Problem:
        if isinstance(given.shape, Malformed):
            return Problem(f"the result is malformed: {given.shape.says}", (), SHAPE)
        wrong = self.spec.answers(answer.shape, given.shape) if self.spec.answers else None
        if isinstance(wrong, Mismatch):
            return Problem(wrong.says, (wrong.rule,), SHAPE, by_itself=wrong.near)
        return Problem(f"the result is {given.shape}, expected {answer.shape}", (), SHAPE)

    # Messages.

    def messages(self, event: Received) -> Iterator[Candidate]:
        """Every message that could have come, and what keeps the one that came from being it."""
        (_, content, given, relations, number), _ = self.belief.symbol(event)
        message = _Message(event, content, given, number)
        for successor in self.ways():
            here = successor.explanation
            before = tuple(self._sequence(here, relations))
            found = (
                one
                for channel in here.channels
                if channel.name == number or (channel.name < GONE and self._is_new(here, number))
                for one in self._showing(here, channel, message, before)
            )
            unusual = self.unusual(here)
            for one in itertools.chain(found, self._undriven(here, message)):
                yield evolve(one, unseen=successor.rules, unusual=unusual + one.unusual)

    def _sequence(self, here: Explanation, relations: Iterable[str]) -> Iterator[Problem]:
        """The problems of the readings that a message's numbers need. Wrong numbers are judged elsewhere."""
        for relation in relations:
            right = self.spec.sequence(relation)
            if not isinstance(right, Mismatch):
                yield from self._readings(here, right)

    def _showing(
        self, here: Explanation, channel: Channel, message: _Message, before: tuple[Problem, ...]
    ) -> Iterator[Candidate]:
        delivery = self.spec.delivery(channel.topic)
        skipped: tuple[Assumption, ...] = ()
        for position, owed in enumerate(channel.owed):
            needs = (owed.only, *skipped) if owed.only else skipped
            problems = [*before, *self._readings(here, needs)]
            before_it = () if delivery.skips else [one for one in channel.owed[:position] if not one.passing]
            if before_it:
                problems.append(self._left_out(delivery, before_it[0], message))
            problems += self._matched(here, channel, owed, message) or self._unlike_any_state(
                here, delivery, owed, message
            )
            words = SOME_STATE if owed.view is ANY else described(self.spec, owed.view)
            possible = not before_it and not self._clash(here, needs)
            due = (channel, before_it[0] if before_it else owed)
            unusual = sum(one.ambiguity.default not in one.letters for one in needs)
            yield Candidate(
                what=words, problems=tuple(problems), allowed=possible, passing=owed.passing, owed=due, unusual=unusual
            )
            if not owed.passing and delivery.skips:
                skipped = (delivery.skips,)
        if not channel.owed:
            again = tuple(self._again(here, channel, delivery, message))
            yield Candidate(problems=(*before, *again), allowed=False)

    def _left_out(self, delivery: Delivery, owed: Owed, message: _Message) -> Problem:
        """What has to come before a message."""
        other = self.successors.matches(owed, message.content)
        own = (other.rule,) if isinstance(other, Mismatch) else ()
        says = f"{described(self.spec, owed.view)} has to come before it"
        return Problem(says, (*own, *self.missing(delivery, owed.view)), LEFT_OUT)

    def _unlike_any_state(
        self, here: Explanation, delivery: Delivery, owed: Owed, message: _Message
    ) -> Iterator[Problem]:
        """Why a message shows no state at all, where any state may be shown since nothing was known before."""
        glimpses = self.spec.middle.glimpses if self.spec.middle else None
        if owed.view is not ANY or glimpses is None:
            return
        world = world_of(glimpses, here.state)
        views = (view for _, view in glimpses.states(world, message.content))
        wrong = [self.spec.matches(view, message.content) for view in views]
        if all(isinstance(one, Mismatch) for one in wrong):
            yield from (Problem(one.says, (one.rule,), VALUE) for one in wrong[:1] if isinstance(one, Mismatch))
        else:
            yield Problem("what was shown before cannot have become this", delivery.unowed, VALUE)

    def missing(self, delivery: Delivery, view: View, *, at_first: bool = False) -> tuple[str, ...]:
        """The rules that are broken if a view is owed and does not come: its own if it has any, or else its topic's.

        Args:
            delivery: how messages of the topic travel.
            view: the view.
            at_first: whether it would have been the first message of its channel.
        """
        own = self.spec.undelivered(view) if self.spec.undelivered else ()
        return own or (at_first and delivery.first) or delivery.unowed

    def _again(self, here: Explanation, channel: Channel, delivery: Delivery, message: _Message) -> Iterator[Problem]:
        """Nothing is owed: the message repeats the last one, or shows a state that was never reached."""
        own: tuple[str, ...] = ()
        unbegun = "nothing is owed to it yet"
        if self.spec.unowed is not None:
            refs = tuple(map(here.ref, message.given))
            found = self.spec.unowed(here.state, channel.topic, message.content, refs)
            if isinstance(found, Unowed):
                seen = () if channel.last is None else self._matched(here, channel, channel.last, message)
                yield Problem(found.says, found.rules, UNOWED + seen[0].weight if seen else UNBEGUN)
                return
            own, unbegun = ((found.rule,), found.says) if isinstance(found, Mismatch) else (found, unbegun)
        if isinstance(message.content, Malformed):
            yield Problem(message.content.says, delivery.malformed or delivery.unowed, SHAPE)
            return
        if channel.last is None:
            # What is wrong with it whatever is owed is likelier than that it is something else that is owed.
            yield Problem(unbegun, own or delivery.unowed, VALUE if own else UNBEGUN)
            return
        yield from self._unchanged(here, channel, channel.last, message, own)

    def _unchanged(
        self, here: Explanation, channel: Channel, shown: Owed, message: _Message, own: tuple[str, ...]
    ) -> Iterator[Problem]:
        """Nothing changed since a channel showed a view: the message shows something else, or the same again."""
        delivery = self.spec.delivery(channel.topic)
        wrong = self._matched(here, channel, shown, message)
        if wrong:
            last = described(self.spec, shown.view)
            rules = own or (*(rule for one in wrong for rule in one.rules), *delivery.unowed)
            says = "; ".join(one.says for one in wrong) + f"; nothing changed since it showed {last}"
            yield Problem(says, rules, UNOWED + wrong[0].weight)
        elif delivery.repeats:
            yield from self._readings(here, (delivery.repeats,))
        else:
            says = "it shows again what it showed last, though nothing changed"
            yield Problem(says, own or delivery.unowed, UNOWED)

    def _matched(self, here: Explanation, channel: Channel, owed: Owed, message: _Message) -> list[Problem]:
        """What keeps a message from showing what is owed."""
        ways = self.successors.matches(owed, message.content)
        if isinstance(ways, Mismatch):
            further = _distance(described(self.spec, owed.view), described(self.spec, message.content))
            least = ELSE if ways.far else SHAPE if ways.near or isinstance(message.content, Malformed) else VALUE
            turned = self._turned(owed.names, message.given)
            says, named = (turned, self.spec.delivery(channel.topic).named) if turned else (ways.says, ())
            return [Problem(says, (*named, ways.rule), least + further)]
        found: list[list[Problem]] = []
        for way in ways:
            own = (channel.name, *(owed.names[ref] for ref, _ in way.names))
            seen = (message.number, *(message.given[at] for _, at in way.names))
            called = (message.event.channel, *(message.event.names[at] for _, at in way.names))
            named = self.spec.delivery(channel.topic).named
            names = [evolve(one, rules=named) for one in self._names(here, own, seen, called)]
            found.append([*self._readings(here, way.assumes), *names])
        return min(found, key=lambda problems: sum(one.weight for one in problems))

    def _turned(self, own: Names, seen: Names) -> str:
        """That a message has the names that are due in another order, in words; empty where it has not."""
        if own == seen or sorted(own) != sorted(seen) or min(seen, default=-1) < 0:
            return ""
        return f"it has {self._list(seen)} in another order than {self._list(own)}"

    def _undriven(self, here: Explanation, message: _Message) -> Iterator[Candidate]:
        """The message shows the effect of a drive that nobody commanded, or of a call that failed."""
        for step, says, rules, weight in self._unseen(here):
            taken = self.successors.advance(here, step)
            if taken is None:
                continue
            after = taken[0]
            for channel, before in zip(after.channels, here.channels, strict=False):
                if channel.name != message.number or len(channel.owed) <= len(before.owed):
                    continue
                if channel.owed[-1].optional:  # what may be said at any time tells nothing of what happened
                    continue
                if not self._matched(after, channel, channel.owed[-1], message):
                    unowed = self.spec.delivery(channel.topic).unowed
                    broken = (*unowed, *rules) if weight == FAILED else rules or unowed
                    yield Candidate(problems=(Problem(says, broken, weight),), allowed=False)

    def _unseen(self, here: Explanation) -> Iterator[tuple[Step, str, tuple[str, ...], int]]:
        """Steps that were not taken, each in words, with the rules that it would break, and the weight of that."""
        for drive in self.spec.drives.values():
            for event in drive.by_itself if drive.name in self.successors.driven else ():
                says = f"{described(self.spec, event)} would have to happen first, and nobody made it happen"
                yield from ((step, says, drive.impossible, UNDRIVEN) for step in drive.steps(here.state, event, ()))
        for call in self._failed_last():
            refs = self.successors.refs(here, tuple(map(self.belief.number, call.about)))
            says = f"it shows what a call would have done that failed: {call.words(self.spec)}"
            effects = self.successors.effects(here.state, call.request, refs)
            yield from ((step, says, step.rules, FAILED) for step in effects if step.answer and step.answer.code == OK)

    def _failed_last(self) -> Iterator[AnsweredCall]:
        """The calls that failed since one took effect, the latest first: what they did would have shown by then."""
        for call in reversed(self.about.recent):
            operation = self.spec.operations.get(self.spec.request_operation(call.request))
            if call.answer.code != OK:
                yield call
            elif operation is None or not operation.streaming:
                return

    # Problems.

    def _clash(self, here: Explanation, assumes: Iterable[Assumption]) -> list[Assumption]:
        """Those assumptions that contradict what an explanation assumes."""
        return [one for one in assumes if not here.assumed & one.group & one.kept]

    def _readings(self, here: Explanation, assumes: Iterable[Assumption]) -> Iterator[Problem]:
        for one in self._clash(here, assumes):
            left = one.ambiguity.possible(here.assumed)
            # What ruled the needed readings out, in this explanation; others may have been left by other events.
            eliminations = [self.about.eliminations.get((one.ambiguity.id, letter)) for letter in one.letters]
            events = dict.fromkeys(str(elimination) for elimination in eliminations if elimination is not None)
            since = f", since {'; '.join(events)}" if events else ""
            followed = f"{one.ambiguity.id}={'|'.join(left)} is followed{since}"
            since_then = tuple(
                dict.fromkeys(
                    rule for elimination in eliminations if elimination is not None for rule in elimination.rules
                )
            )
            yield Problem(f"it needs {one}, but {followed}", rules_about(self.spec, one), READING, since_then)

    def _names(
        self, here: Explanation, own: Names, seen: Names, called: tuple[Name, ...], *, unordered: bool = False
    ) -> list[Problem]:
        if unordered:
            return self._named_together(own, called)
        if len(own) != len(seen):
            names = ", ".join(map(name_words, called)) or "nothing"
            return [Problem(f"it names {names}, expected {self._list(own)}", (), NAME)]
        if unify(here, list(zip(own, seen, strict=True))):
            return []
        found = []
        for mine, number, name in zip(own, seen, called, strict=True):
            if mine == number or (mine < GONE and self._is_new(here, number)):
                continue
            due = f"it should name {self._known(mine)}" if mine >= 0 else "a name is due that nothing had before"
            found.append(f"it names {name_words(name)} where {due}")
        return [Problem("; ".join(found) or f"it names {self._list(own)} twice", (), NAME)]

    def _named_together(self, own: Names, called: tuple[Name, ...]) -> list[Problem]:
        known = {self.belief.name(one) for one in own if one >= 0}
        if len(own) == len(called) and known <= set(called):
            return []
        return [
            Problem(f"it names {', '.join(map(name_words, called)) or 'nothing'}, expected {self._list(own)}", (), NAME)
        ]

    def _is_new(self, here: Explanation, number: int) -> bool:
        held = {*here.names, *here.gone, *(channel.name for channel in here.channels)}
        return number not in held and number != GONE

    def _known(self, name: int) -> str:
        known = self.belief.name(name)
        return "a new name" if known is None else name_words(known)

    def _list(self, names: Names) -> str:
        known = [name_words(one) for one in map(self.belief.name, names) if one is not None]
        new = len(names) - len(known)
        return ", ".join((*known, *([counted(new, "new name")] if new else []))) or "nothing"
