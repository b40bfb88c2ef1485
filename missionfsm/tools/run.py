"""One run against one implementation: conversations, what they came to, and the systematic ones among them."""

from __future__ import annotations

import random
from collections.abc import Callable

from attrs import define, field

from missionfsm.kernel.alphabet import Bounds, Prompt
from missionfsm.kernel.belief import Automaton
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Subject
from missionfsm.kernel.system import System
from missionfsm.tools.conversation import Action, Conversation, Given, Introduced, Picks
from missionfsm.tools.guide import Guide, Proposal
from missionfsm.tools.shrink import shrink

SETTLED = 0.6
"""How often a tour waits for everything to settle after a step."""

FAVOURED = 0.5
"""How often a tour that has a favourite turns to it."""


@define(eq=False)
class Run:
    """One run against one implementation, and what it gathers.

    Attributes:
        found: the conversation that could not be explained.
        readings: the readings that every conversation so far can be explained by.
        settled_by: ambiguity and letter to the number of the first conversation that ruled it out.
        contradiction: the ambiguity whose last reading was ruled out, though each conversation had one.
    """

    system: System
    subject: Subject
    about: Introduced
    automaton: Automaton
    bounds: Bounds
    progress: Callable[[], None] = lambda: None
    guide: Guide = field(default=None)  # type: ignore[assignment] - made below where none is given
    last: Conversation | None = None
    found: Conversation | None = None
    events: int = 0
    examples: int = 0
    succeeded: int = 0
    readings: dict[str, tuple[str, ...]] = field(factory=dict)
    settled_by: dict[tuple[str, str], Conversation] = field(factory=dict)
    contradiction: str | None = None

    def __attrs_post_init__(self) -> None:
        if self.guide is not None:
            return
        worlds = self.system.alphabet({}, self.bounds).worlds
        self.guide = Guide(self.system, worlds, self.bounds, self.about.drives)

    def start(self, world: JSON) -> Conversation:
        """Begin a new conversation in a world."""
        self.last = Conversation(self.system, self.subject, self.about, world, self.automaton)
        return self.last

    def act(
        self, method: str, params: JSON = None, name: Given | str | None = None, picks: Picks = ()
    ) -> bool:
        """Do something in the conversation that was begun last; False once it cannot be explained."""
        last = self.last
        assert last is not None, "a conversation has begun"  # noqa: S101 - whoever acts has begun one
        if last.perform(Action(len(last.actions) + 1, method, params, name, picks)):
            return True
        self.found = last
        self.gather()
        return False

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
        self.examples += 1
        self.succeeded += done.succeeded
        self.progress()
        if not done.right:
            return True
        for name, letters in done.judge.belief.readings.items():
            known = self.readings.get(name)
            everything = known or next(one for one in self.system.spec.ambiguities if one.id == name).readings
            for letter in everything:
                if letter not in letters:
                    self.settled_by.setdefault((name, letter), done)
            left = tuple(one for one in everything if one in letters)
            self.readings[name] = left
            if not left:
                self.contradiction = name
                return False
        return True

    def tour(self, draw: random.Random, conversations: int, steps: int, favour: str | None = None) -> bool:
        """Systematic conversations: every step walks the edge that was walked least, mostly with a stream watched.

        Args:
            favour: an operation or drive to turn to again and again.

        Returns:
            whether everything could be explained.
        """
        streams = self.system.codec.streams
        for number in range(conversations):
            world = number % len(self.guide.worlds)
            self.start(self.guide.worlds[world])
            if len(streams) == 1 and number % 4 != 3 and not self.act(streams[0], {}):  # noqa: PLR2004 - every fourth
                return False
            for _ in range(steps):
                proposal = self._next(draw, world, favour if number % 2 else None)
                if proposal is None:
                    break
                if not self.take_up(proposal):
                    return False
                if draw.random() < SETTLED and not self._look(world):
                    return False
            if not self.act("settle") or not self.gather():
                return False
        return True

    def _look(self, world: int) -> bool:
        """Wait for everything to settle and see where things stand."""
        look = self.guide.alphabets[world].look
        return self.act("settle") and (look is None or self.act(look.method, look.params))

    def _next(self, draw: random.Random, world: int, favour: str | None) -> Proposal | None:
        assert self.last is not None, "a conversation has begun"  # noqa: S101 - tour has begun one
        wanted = favour if favour and draw.random() < FAVOURED else None
        proposals = self.guide.proposals(self.last, world, wanted) or self.guide.proposals(self.last, world)
        if not proposals:
            return None
        least = self.guide.walked[proposals[0].edge]
        equal = [one for one in proposals if self.guide.walked[one.edge] == least]
        if self.guide.system.spec.idle_shape is not None and draw.random() < FAVOURED:
            # Where most of what can be said has no effect, what leads elsewhere comes first.
            rare = self.guide.visited[equal[0].leads_to]
            equal = [one for one in equal if self.guide.visited[one.leads_to] == rare]
        return equal[draw.randrange(len(equal))]

    def attempt(self, world: JSON, actions: tuple[Action, ...]) -> Conversation:
        """These actions in a new conversation, until it cannot be explained any more."""
        conversation = Conversation(self.system, self.subject, self.about, world, self.automaton)
        for action in actions:
            if not conversation.perform(action):
                break
        return conversation

    def shorten(self) -> None:
        """Make what was found as short as can be, asking the implementation again each time."""
        if self.found is not None and not self.found.judge.exhausted:
            self.found = shrink(self.found, self.attempt, self._simpler)

    def _simpler(self, world: JSON, method: str) -> tuple[Prompt, ...]:
        return tuple(one for one in self.system.alphabet(world, self.bounds).plain if one.method == method)
