"""One run against one implementation: conversations, what they came to, and the systematic ones among them."""

from __future__ import annotations

import functools
import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Self

from attrs import define, field

from missionfsm.kernel.alphabet import Bounds, Line, Prompt
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import meet
from missionfsm.kernel.subject import Subject
from missionfsm.kernel.system import System
from missionfsm.oracle.belief import Automaton
from missionfsm.tools.check.eliminations import Ruling
from missionfsm.tools.check.scope import assumed
from missionfsm.tools.check.verdict import Violation
from missionfsm.tools.conform.contradiction import inconsistent
from missionfsm.tools.conform.conversation import WRONG_NAME, Action, Conversation, Given, Introduced, Picks, introduce
from missionfsm.tools.conform.guide import Guide, Proposal
from missionfsm.tools.conform.shortest import everything, length, shortest
from missionfsm.tools.conform.shrink import shrink
from missionfsm.tools.placeholders import kind_of, slots

Scripts = tuple[tuple[Line, ...], ...]

BOUNDS = Bounds(4, goals=3)
"""What a run tries, unless it is told otherwise."""

SETTLED = 0.6
"""How often a tour waits for everything to settle after a step."""

WIDE = 48
"""How many explanations of a conversation are so many that the next one assumes what is known."""

RARE, RAREST = 0.4, 3
"""How often a tour turns to what the rules have said least in the whole run, and among how many things it draws."""

FAVOURED = 0.5
"""How often a tour that has a favourite turns to it."""


@define(eq=False)
class Run:
    """One run against one implementation, and what it gathers.

    Attributes:
        progress: told of the run after every conversation.
        expects: whether a violation is known; the search goes on after such a one, in another conversation.
        enough: whether no more should be done.
        found: the conversation that could not be explained.
        over: whether the last conversation ended in a violation that is known; what is done in it then is nothing.
        steps: calls and drives so far.
        answers: operation to status name to how often it was answered so.
        oddities: what is explained, and yet belongs to no reading: a line each.
        readings: the readings that every conversation so far can be explained by.
        settled_by: ambiguity and letter to the number of the first conversation that ruled it out.
        rulings: ambiguity and letter to the event in that conversation.
        contradiction: the ambiguity whose last reading was ruled out, though each conversation had one.
        aside: ambiguities of which it is known that no single reading is followed.
        narrowed: where explanations became many, the automaton of what was found out so far; conversations walk it from
            then on, and one that cannot be explained there is had again without.
    """

    system: System
    subject: Subject
    about: Introduced
    automaton: Automaton
    bounds: Bounds
    progress: Callable[[Run], None] = lambda _: None
    expects: Callable[[Violation], bool] | None = None
    enough: Callable[[], bool] = lambda: False
    guide: Guide = field(default=None)
    last: Conversation | None = None
    found: Conversation | None = None
    over: bool = False
    steps: int = 0
    events: int = 0
    examples: int = 0
    succeeded: int = 0
    answers: dict[str, Counter[str]] = field(factory=dict)
    oddities: dict[str, None] = field(factory=dict)
    readings: dict[str, tuple[str, ...]] = field(factory=dict)
    settled_by: dict[tuple[str, str], Conversation] = field(factory=dict)
    rulings: dict[tuple[str, str], Ruling] = field(factory=dict)
    contradiction: str | None = None
    aside: set[str] = field(factory=set)
    narrowed: Automaton | None = None
    _widest: int = 0
    _before: dict[str, int] = field(factory=dict)

    @classmethod
    def of(
        cls,
        system: System,
        subject: Subject,
        readings: Mapping[str, str] | None = None,
        bounds: Bounds = BOUNDS,
        *,
        no_flagged: bool = False,
        **options: Any,  # noqa: ANN401 - the other attributes
    ) -> Self:
        """A run against an implementation that nobody knows yet.

        Args:
            readings: readings that it has to follow.
            no_flagged: whether nothing may depart from the letter of the text.

        Raises:
            SubjectError: the adapter failed.
            ValueError: `readings` names something that does not exist.
        """
        decided = assumed(system.spec, readings, no_flagged=no_flagged)
        about = introduce(system, subject)
        automaton = Automaton(system.spec, about.drives, decided)
        return cls(system, subject, about, automaton, bounds, **options)

    def __attrs_post_init__(self) -> None:
        if self.guide is not None:
            return
        worlds = self.system.alphabet({}, self.bounds).worlds
        self.guide = Guide(self.system, worlds, self.bounds, self.about.drives)

    def start(self, world: JSON) -> Conversation:
        """Begin a new conversation in a world."""
        self._narrow()
        self.over = False
        automaton = self.narrowed or self.automaton
        self.last = Conversation(self.system, self.subject, self.about, world, automaton)
        return self.last

    def _narrow(self) -> None:
        """If the last conversation had many explanations, assume from now on what the run has found out."""
        if self._widest <= WIDE:
            return
        self._widest = 0
        assumed = meet(
            self.automaton.assumed,
            (one[self.readings[one.id]] for one in self.system.spec.ambiguities if self.readings.get(one.id)),
        )
        current = self.narrowed or self.automaton
        if assumed and assumed != current.assumed:
            if self.narrowed is not None:
                self._before = self.exercised(besides=self.automaton)
            self.narrowed = Automaton(self.system.spec, self.about.drives, assumed)

    def exercised(self, besides: Automaton | None = None) -> dict[str, int]:
        """How often each rule was exercised, in all automata that were walked."""
        times = dict(self._before)
        for automaton in (self.automaton, self.narrowed):
            if automaton is not None and automaton is not besides:
                for rule, count in automaton.exercised().items():
                    times[rule] = times.get(rule, 0) + count
        return times

    def act(self, method: str, params: JSON = None, name: Given | str | None = None, picks: Picks = ()) -> bool:
        """Do something in the conversation that was begun last; False once something is found that is not expected."""
        assert self.last is not None, "a conversation has begun"  # noqa: S101 - whoever acts has begun one
        return self.perform(Action(len(self.last.actions) + 1, method, params, name, picks))

    def perform(self, action: Action) -> bool:
        """Perform an action in the conversation that was begun last; see `act`."""
        last = self.last
        assert last is not None, "a conversation has begun"  # noqa: S101 - whoever acts has begun one
        if self.over:
            return True
        self.steps += action.method != "settle"
        if last.perform(action):
            self._widest = max(self._widest, len(last.judge.belief.node.explanations))
            return True
        if last.judge.exhausted and self._had_narrowly(last):
            return True
        if self.narrowed is not None and not last.judge.exhausted:
            again = self.attempt(last.world, tuple(last.actions))
            if again.right:
                # Explained by itself, but not together with those before: a contradiction, if one question shows it.
                self.last, known = again, len(self.aside)
                if not self.gather():
                    return False
                if len(self.aside) > known:
                    self.over = True
                    return True
                self.last = last
            elif not again.judge.exhausted:
                last = self.last = again
        if self._is_known(last):
            self.over = True
            return True
        self.found = last
        self.gather()
        return False

    def _is_known(self, last: Conversation) -> bool:
        if self.expects is None or last.judge.exhausted:
            return False
        found = last.judge.violation
        return found is not None and self.expects(found)

    def _had_narrowly(self, exhausted: Conversation) -> bool:
        """Have a conversation again that has too many explanations, now assuming what is known; whether that did it."""
        current = self.narrowed or self.automaton
        self._widest = WIDE + 1
        self._narrow()
        if self.narrowed is None or self.narrowed is current:
            return False
        again = self.attempt(exhausted.world, tuple(exhausted.actions), self.narrowed)
        if again.right:
            self.last = again
        return again.right

    def have(self, world: JSON, actions: tuple[Action, ...]) -> bool:
        """Have a whole conversation, judged by all that is known; False once something is found that is not expected.

        It shows more than one that is judged by itself: what others have decided is taken for decided.
        """
        self._widest = WIDE + 1
        self.start(world)
        return all(map(self.perform, actions)) and self.gather()

    def take_up(self, proposal: Proposal, *, counts: bool = True) -> bool:
        """Do what the guide proposed; the guide remembers it if it counts."""
        if counts:
            self.guide.note(proposal)
        return self.act(proposal.method, proposal.params, proposal.name, proposal.picks)

    def gather(self) -> bool:
        """Add what the last conversation came to; False if it contradicts the readings of those before."""
        done = self.last
        assert done is not None, "a conversation has ended"  # noqa: S101 - whoever gathers has had one
        self.events += done.judge.events
        for name, codes in done.judge.answers.items():
            self.answers.setdefault(name, Counter()).update(codes)
        self.oddities.update(dict.fromkeys(done.judge.oddities))
        self.examples += 1
        self.succeeded += done.succeeded
        self.progress(self)
        if not done.right:
            return True
        for name, letters in done.judge.belief.readings.items():
            if name in self.aside:
                continue
            known = self.readings.get(name)
            everything = known or next(one for one in self.system.spec.ambiguities if one.id == name).readings
            for letter in everything:
                if letter not in letters:
                    self.settled_by.setdefault((name, letter), done)
                    if (name, letter) in done.judge.rulings.found:
                        self.rulings.setdefault((name, letter), done.judge.rulings.found[name, letter])
            left = tuple(one for one in everything if one in letters)
            self.readings[name] = left
            if not left and not self._is_known_contradiction(name):
                return False
        return True

    def _is_known_contradiction(self, name: str) -> bool:
        self.contradiction = name
        if self.expects is None or not self.expects(self.inconsistency()):
            return False
        self.contradiction = None
        self.aside.add(name)
        del self.readings[name]
        if self.narrowed is not None:  # it assumes what turned out to be wrong
            self._before = self.exercised(besides=self.automaton)
            self.narrowed = None
        return True

    def play(self, most: int | None = None) -> bool:
        """Have the conversations that the system's alphabet has written down; whether all could be explained.

        Args:
            most: how many of them, from everywhere among them; all by default.
        """
        world = self.guide.worlds[0]
        for script in some(self.guide.alphabets[0].scripts, most):
            if self.enough():
                break
            self.start(world)
            for line in script:
                if line.method == "drive" and line.params["event"] not in self.about.drives:
                    break
                wanted = slots(line.params)
                picks = tuple(self._found(wanted, line.picks))
                # A name without a kind goes where `ANY_NAME` stands, not into a slot.
                name = None if wanted or not line.picks else picks[0][1] if picks else WRONG_NAME
                if not self.act(line.method, line.params, name, picks if wanted else ()):
                    return False
            if not self.act("settle") or not self.gather():
                return False
        return True

    def _found(self, wanted: dict[int, str], picks: tuple[tuple[int, int], ...]) -> Iterator[tuple[int, Given]]:
        assert self.last is not None, "a conversation has begun"  # noqa: S101 - play has begun one
        for slot, position in picks:
            known = [given for given, name in self.last.given.items() if kind_of(name) == wanted.get(slot)]
            if position < len(known):
                yield slot, known[position]

    def tour(
        self,
        draw: random.Random,
        conversations: int,
        steps: int,
        favour: str | None = None,
        again: float = 0.0,
    ) -> bool:
        """Systematic conversations: every step walks the edge that was walked least, mostly with a stream watched.

        Args:
            favour: an operation or drive to turn to again and again.
            again: how often what the surroundings just did happens once more at once, where it leads elsewhere.

        Returns:
            whether everything could be explained.
        """
        streams = self.system.codec.streams
        for number in range(conversations):
            if self.enough():
                break
            world = number % len(self.guide.worlds)
            self.start(self.guide.worlds[world])
            if len(streams) == 1 and number % 4 != 3 and not self.act(streams[0], {}):
                return False
            left = iter(range(steps))
            for _ in left:
                proposal = self._next(draw, world, favour if number % 2 else None)
                if proposal is None or self.over or self.enough():
                    break
                if not self.take_up(proposal):
                    return False
                if draw.random() < SETTLED and not self._look(world):
                    return False
                while again and draw.random() < again and not self.over:
                    more = self._once_more(proposal, world)
                    if more is None or next(left, None) is None:
                        break
                    if not (self.take_up(more) and self.act("settle")):
                        return False
            if not self.act("settle") or not self.gather():
                return False
        return True

    def _once_more(self, done: Proposal, world: int) -> Proposal | None:
        """The same drive again, if it leads elsewhere: some of what can go wrong is many goals away."""
        if done.method != "drive" or self.last is None:
            return None
        found = self.guide.proposals(self.last, world, done.params["event"])
        same = (one for one in found if one.params == done.params and one.leads_to != one.edge[0])
        return next(same, None)

    def _look(self, world: int) -> bool:
        """Wait for everything to settle and see where things stand."""
        look = self.guide.alphabets[world].look
        return self.act("settle") and (look is None or self.act(look.method, look.params))

    def _next(self, draw: random.Random, world: int, favour: str | None) -> Proposal | None:
        assert self.last is not None, "a conversation has begun"  # noqa: S101 - tour has begun one
        if draw.random() < RARE:
            proposals = self.guide.proposals(self.last, world, rare=True)[:RAREST]
            return proposals[draw.randrange(len(proposals))] if proposals else None
        wanted = favour if favour and draw.random() < FAVOURED else None
        proposals = self.guide.proposals(self.last, world, wanted) or self.guide.proposals(self.last, world)
        if not proposals:
            return None
        least = self.guide.walked[proposals[0].edge]
        equal = [one for one in proposals if self.guide.walked[one.edge] == least]
        if self.guide.system.spec.abstraction.idle_shape is not None and draw.random() < FAVOURED:
            # Where most of what can be said has no effect, what leads elsewhere comes first.
            rare = self.guide.visited[equal[0].leads_to]
            equal = [one for one in equal if self.guide.visited[one.leads_to] == rare]
        return equal[draw.randrange(len(equal))]

    def attempt(self, world: JSON, actions: tuple[Action, ...], automaton: Automaton | None = None) -> Conversation:
        """These actions in a new conversation, until it cannot be explained any more."""
        conversation = Conversation(self.system, self.subject, self.about, world, automaton or self.automaton)
        for action in actions:
            if not conversation.perform(action):
                break
        return conversation

    def shorten(self) -> None:
        """Make what was found as short as can be, asking the implementation again each time."""
        if self.found is not None and not self.found.judge.exhausted:
            self.found = self.shortened(self.found)

    def shortened(self, found: Conversation) -> Conversation:
        """The shortest conversation like one that cannot be explained, asking the implementation again each time."""
        same = functools.partial(self.attempt, automaton=found.judge.automaton)
        short = shrink(found, same, self._simpler, self.guide.worlds[0])
        if self.enough():
            return short
        alphabet = self.system.alphabet(short.world, self.bounds)
        # From some long conversations no part can go though there are shorter ones: of the same kinds of things, which
        # can be looked for deep, or of anything.
        for look in (functools.partial(shortest, short), everything):
            shorter = look(functools.partial(same, short.world), alphabet, length(short) - 1)
            if shorter is not None and not self._is_known(shorter):
                short = shrink(shorter, same, self._simpler, self.guide.worlds[0])
        return short

    def inconsistency(self) -> Violation:
        """What is wrong with an implementation that follows no single reading of the contradiction's ambiguity."""
        self.shorten_evidence()
        ambiguity = next(one for one in self.system.spec.ambiguities if one.id == self.contradiction)
        evidence = {letter: self.settled_by[ambiguity.id, letter].judge for letter in ambiguity.readings}
        return inconsistent(self.system.spec, ambiguity, evidence)

    def shorten_evidence(self) -> None:
        """Make the conversations that ruled out the readings of a contradiction as short as can be."""
        for (name, letter), conversation in list(self.settled_by.items()):
            if name == self.contradiction:

                def shows(tried: Conversation, name: str = name, letter: str = letter) -> bool:
                    return tried.right and letter not in tried.judge.belief.readings.get(name, (letter,))

                self.settled_by[name, letter] = shrink(
                    conversation, self.attempt, self._simpler, self.guide.worlds[0], shows
                )

    def _simpler(self, world: JSON, method: str) -> tuple[Prompt, ...]:
        return tuple(one for one in self.system.alphabet(world, self.bounds).plain if one.method == method)


def some(scripts: Scripts, most: int | None) -> Scripts:
    """All, or at most so many from everywhere among them."""
    return scripts if most is None else scripts[:: max(1, -(-len(scripts) // most))]
