"""One run against one implementation: it has conversations, and enters into its ledger what they show."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any, Self

from attrs import define, field

from missionfsm.kernel.alphabet import Alphabet, Bounds, Input
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Subject
from missionfsm.kernel.system import System
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.check.scope import assumed
from missionfsm.tools.check.verdict import Violation
from missionfsm.tools.conform.actions import SETTLE, Action, Bindings, NameRef
from missionfsm.tools.conform.conversation import Conversation, Partner
from missionfsm.tools.conform.guide import Guide, Proposal
from missionfsm.tools.conform.handshake import AdapterInfo, handshake, offered
from missionfsm.tools.conform.ledger import Ledger
from missionfsm.tools.conform.narrowing import Narrowing
from missionfsm.tools.conform.reach import Reach

BOUNDS = Bounds(4, goals=3)
"""The default bounds of what a run tries."""
FEW, ONE_IN = 3, 20
"""So many conversations, or one in so many if that is more, may be given up before a run is inconclusive."""
ONE_IN_UNDRIVEN = 5
"""The same of an implementation that moves by itself: all of a conversation until then was judged."""
LEFT, STRAIN, EARLY = 20, 20_000, 300
"""A run ends when so many conversations ended early and so many events were seen, each of those counting as so many:
what moves by itself takes long to follow. The tester's choice."""


@define(eq=False)
class Run:
    """One run against one implementation.

    Attributes:
        partner: the implementation.
        narrowing: the automata in which conversations are judged.
        bounds: the bounds of what is tried.
        guide: what proposes the next action.
        progress: given the run after every conversation.
        expects: whether a violation is known. After a known one the search goes on, in another conversation.
        enough: whether the run is to stop.
        without: calls and drives that are left out, although the adapter may have them.
        ledger: what all conversations so far have shown.
        reach: which actions were done in which situations; None if the system has no matrix.
        last: the conversation that was begun last.
        found: the conversation that could not be explained, if there is one.
        over: whether the last conversation ended in a known violation, or early. Nothing more is done in it.
    """

    partner: Partner
    narrowing: Narrowing
    bounds: Bounds
    guide: Guide
    progress: Callable[[Run], None] = lambda _: None
    expects: Callable[[Violation], bool] | None = None
    enough: Callable[[], bool] = lambda: False
    without: frozenset[str] = frozenset()
    ledger: Ledger = field(init=False)
    reach: Reach | None = field(init=False)
    last: Conversation | None = None
    found: Conversation | None = None
    over: bool = False
    _alphabets: dict[str, Alphabet] = field(factory=dict)

    def __attrs_post_init__(self) -> None:
        self.ledger = Ledger(self.system)
        asked = self.enough
        self.enough = lambda: asked() or self._is_strained()
        matrix = self.system.matrix
        self.reach = Reach(self.system, matrix, self.guide.worlds) if matrix is not None else None

    @classmethod
    def against(  # noqa: PLR0913 - every one but the first two has a default
        cls,
        system: System,
        subject: Subject,
        readings: Mapping[str, str] | None = None,
        bounds: Bounds = BOUNDS,
        *,
        automaton: Automaton | None = None,
        no_flagged: bool = False,
        only: Collection[str] = (),
        without: Collection[str] = (),
        **options: Any,  # noqa: ANN401 - the other attributes
    ) -> Self:
        """A run against an implementation, after a handshake with it.

        Args:
            system: the system.
            subject: the implementation.
            readings: readings that it has to follow.
            bounds: the bounds of what is tried.
            automaton: the belief automaton to walk; None makes one for this run.
            no_flagged: whether nothing may depart from the letter of the text.
            only: the calls to make; all if there are none.
            without: calls and drives to leave out.
            options: other attributes of the run.

        Raises:
            SubjectError: the adapter failed.
            ValueError: `readings` names something that does not exist.
        """
        decided = assumed(system.spec, readings, no_flagged=no_flagged)
        info = handshake(system, subject)
        given = offered(system, info, only, without)
        guide = Guide(given, given.alphabet({}, bounds).worlds, bounds)
        walked = automaton or Automaton(system.spec, info.drives, decided)
        run = cls.with_guide(given, subject, info, walked, guide, without=frozenset(without), **options)
        run.ledger.notes += (f"{one} is not known: it is not used" for one in info.unknown)
        return run

    @classmethod
    def with_guide(
        cls,
        system: System,
        subject: Subject,
        info: AdapterInfo,
        automaton: Automaton,
        guide: Guide,
        **options: Any,  # noqa: ANN401 - the other attributes
    ) -> Self:
        """A run that shares an automaton and a guide with others."""
        partner = Partner(system, subject, info, names={} if info.soft_reset else None)
        return cls(partner, Narrowing(automaton), guide.bounds, guide, **options)

    @property
    def system(self) -> System:
        """The system, as far as the implementation has it."""
        return self.partner.system

    @property
    def conversation(self) -> Conversation:
        """The conversation that was begun last."""
        assert self.last is not None, "a conversation has begun"  # noqa: S101 - whoever asks has begun one
        return self.last

    def alphabet(self, world: JSON) -> Alphabet:
        """What is worth trying in a world."""
        key = repr(world)
        if key not in self._alphabets:
            self._alphabets[key] = self.system.alphabet(world, self.bounds)
        return self._alphabets[key]

    def simpler(self, world: JSON, method: str) -> tuple[Input, ...]:
        """Plain requests that may stand in for a call."""
        return tuple(one for one in self.alphabet(world).core_inputs if one.method == method)

    # Having conversations.

    def start(self, world: JSON, *, narrowly: bool = False) -> Conversation:
        """Begin a new conversation in a world; narrowly: under the readings that other conversations have left."""
        self.over = False
        automaton = self.narrowing.choose(self.ledger.readings, at_once=narrowly)
        self.last = Conversation(self.partner, world, automaton)
        return self.last

    def do(self, method: str, params: JSON = None, name: NameRef | str | None = None, picks: Bindings = ()) -> bool:
        """Do something in the last conversation. False once a violation is found that is not expected."""
        done = self.conversation.actions
        return self.perform(Action(abs(done[-1].serial) + 1 if done else 1, method, params, name, picks))

    def settle(self) -> bool:
        """Wait until everything has settled; see `do`."""
        return self.do(SETTLE)

    def follow(self, proposal: Proposal, *, counts: bool = True) -> bool:
        """Do what the guide proposed. The guide remembers it if it counts."""
        if counts:
            self.guide.note(proposal)
        return self.do(proposal.method, proposal.params, proposal.name, proposal.picks)

    def perform(self, action: Action) -> bool:
        """Perform an action in the last conversation; see `do`.

        If the implementation may have done more by itself than can be followed, everything has to settle first; where
        that does not help, the conversation ends early.
        """
        if action.method == SETTLE or self.over or not self.narrowing.is_lost_in(self.conversation):
            return self._step(action)
        if not self._step(Action(-action.serial, SETTLE)):
            return False
        if not self.over and self.narrowing.is_lost_in(self.conversation):
            self.ledger.left += 1
            self.over = True
        return self._step(action)

    def _step(self, action: Action) -> bool:
        if self.over:
            return True
        last = self.conversation
        self.ledger.steps += action.method != SETTLE
        if self.reach is not None and last.right and last.may(action):
            self.reach.note(last, action)
        if last.perform(action):
            self.narrowing.look(last)
            return True
        return self._is_explained_otherwise(last) or self._ends_here()

    def _is_explained_otherwise(self, last: Conversation) -> bool:
        """Judge the last conversation in the other automaton, if it is not explained in this one or costs too much."""
        if last.judge.exhausted:
            before = self.narrowing.current
            after = self.narrowing.choose(self.ledger.readings, at_once=True)
            self.last = last.under(after) if after is not before else last
        elif self.narrowing.narrow is not None:
            self.last = last.under(self.narrowing.wide)
            if self.last.right:
                # It is explained alone, but not together with those before: a contradiction, if one ambiguity shows it.
                known = len(self.ledger.aside)
                if not self.record():
                    return False
                self.over = len(self.ledger.aside) > known
                if self.over:
                    return True
                self.last = last
                return False
        return self.conversation.right

    def _ends_here(self) -> bool:
        """End the last conversation, which cannot be explained. Returns whether that is known and the run goes on."""
        if self.ledger.contradiction is not None:
            return False
        if self.knows(self.conversation):
            self.over = True
            return True
        if self.conversation.judge.exhausted and self._may_give_up():
            self.ledger.undecided += 1
            self.over = True
            return True
        self.found = self.conversation
        self.record()
        return False

    def _may_give_up(self) -> bool:
        """Whether a conversation that cannot be decided is left as it is: a few are."""
        one_in = ONE_IN_UNDRIVEN if self.narrowing.unwatched else ONE_IN
        return self.ledger.undecided < max(FEW, self.ledger.examples // one_in)

    def _is_strained(self) -> bool:
        """Whether an implementation that moves by itself, in which nothing was found, was followed for long enough."""
        ledger = self.ledger
        strain = ledger.events + EARLY * ledger.left
        return ledger.left >= LEFT and strain >= STRAIN and self.found is None and ledger.contradiction is None

    def knows(self, conversation: Conversation) -> bool:
        """Whether what is wrong with a conversation is expected."""
        if self.expects is None or conversation.judge.exhausted:
            return False
        violation = conversation.judge.violation
        return violation is not None and self.expects(violation)

    def converse(self, world: JSON, actions: tuple[Action, ...]) -> bool:
        """Have a whole conversation under the readings that others have left. False once a new violation is found.

        It shows more than a conversation that is judged by itself.
        """
        self.start(world, narrowly=True)
        for action in actions:
            if self.enough():
                return True
            if not self.perform(action):
                return False
        return self.record()

    def record(self) -> bool:
        """Enter the last conversation into the ledger. False if it contradicts the readings of those before."""
        done = self.conversation
        self.ledger.count(done)
        self.progress(self)
        if not done.right:
            return True
        for name in self.ledger.enter(done):
            self.ledger.contradiction = name
            if self.expects is None or not self.expects(self.ledger.inconsistency()):
                return False
            self.ledger.contradiction = None
            self.ledger.set_aside(name)
            self.narrowing.drop()  # it assumes what turned out to be wrong
        return True

    def replay(self, world: JSON, actions: tuple[Action, ...], automaton: Automaton | None = None) -> Conversation:
        """Do these actions in a new conversation, until it cannot be explained any more or the run is to stop."""
        conversation = Conversation(self.partner, world, automaton or self.narrowing.wide)
        for action in actions:
            if self.enough() or not conversation.perform(action):
                break
        return conversation
