"""The systematic conversations of a run: scripts, and tours that go where the run has been least."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from attrs import define

from missionfsm.kernel.alphabet import Alphabet, ScriptStep
from missionfsm.tools.conform.actions import WRONG_NAME, NameRef
from missionfsm.tools.conform.guide import Proposal
from missionfsm.tools.conform.reach import Reach
from missionfsm.tools.conform.run import Run
from missionfsm.tools.placeholders import kind_of, slots

Scripts = tuple[tuple[int, tuple[ScriptStep, ...]], ...]
"""Scripts, each with the number of the world that it begins in."""

SETTLED = 0.6
"""How likely a tour is to wait for everything to settle after a step."""

RARE, RAREST = 0.4, 3
"""How likely a tour is to turn to what the rules have said least in the whole run, and among how many it draws."""

FAVOURED = 0.5
"""How likely a tour that has a favourite is to turn to it."""


def written(alphabets: Sequence[Alphabet]) -> Scripts:
    """The scripts of the first world, which is the usual one, and those that other worlds have apart from it."""
    found = [(0, script) for script in alphabets[0].scripts]
    apart: list[tuple[ScriptStep, ...]] = []
    for world, alphabet in enumerate(alphabets):
        more = [script for script in alphabet.apart if script not in apart]
        found += ((world, script) for script in more)
        apart += more
    return tuple(found)


def some(scripts: Scripts, most: int | None) -> Scripts:
    """All scripts, or so many: spread over those of the usual world, and then those of other worlds."""
    if most is None or most >= len(scripts):
        return scripts
    usual = tuple(one for one in scripts if one[0] == 0)
    if most >= len(usual):
        return scripts[:most]
    return tuple(usual[at * len(usual) // most] for at in range(most))


def play(run: Run, most: int | None = None) -> bool:
    """Have the scripts of the alphabets. Returns whether all could be explained.

    Args:
        run: the run.
        most: how many of them, spread over all; None: all of them.
    """
    for world, script in some(written(run.guide.alphabets), most):
        if run.enough():
            break
        run.start(run.guide.worlds[world])
        for line in script:
            if run.enough():
                break
            if not follow(run, line):
                return False
        if not run.settle() or not run.record():
            return False
    return True


def follow(run: Run, line: ScriptStep) -> bool:
    """Take one step of a script. Returns whether everything could be explained."""
    wanted = slots(line.params)
    picks = tuple(_named(run, wanted, line.picks))
    # A pick without a slot of its own is the name that takes the place of `ANY_NAME`.
    name = None if wanted or not line.picks else picks[0][1] if picks else WRONG_NAME
    return run.do(line.method, line.params, name, picks if wanted else ())


def _named(run: Run, wanted: dict[int, str], picks: tuple[tuple[int, int], ...]) -> Iterator[tuple[int, NameRef]]:
    for slot, position in picks:
        known = [given for given, name in run.conversation.given.items() if kind_of(name) == wanted.get(slot)]
        if position < len(known):
            yield slot, known[position]


def fill_gaps(run: Run, draw: random.Random, conversations: int, steps: int) -> bool:
    """Conversations that go where it was asked too seldom, in every world; whether all could be explained.

    Each is led into a situation, and goes on as long as there is something to do where it comes to.

    Args:
        conversations: how many of them, at most.
        steps: calls and drives in each after that, at most.
    """
    reach = run.reach
    if reach is None:
        return True
    left = iter(range(conversations))
    for world in range(len(run.guide.worlds)):
        for situation, ways in reach.matrix.ways.items():
            turn = in_vain = 0
            # The first time nobody knows what could be done there; after that, as long as something is lacking.
            while in_vain < len(ways) and (not turn or reach.lacks(situation)):
                if run.enough() or next(left, None) is None:
                    return True
                # Where nothing could be done, it may not have been sure where that was: what is known makes it surer.
                run.start(run.guide.worlds[world], narrowly=in_vain > 0)
                done = _filled(run, reach, draw, world, ways[turn % len(ways)], steps)
                if done is None:
                    return False
                turn, in_vain = turn + 1, 0 if done else in_vain + 1
    return True


def _filled(
    run: Run, reach: Reach, draw: random.Random, world: int, way: tuple[ScriptStep, ...], steps: int
) -> int | None:
    """How much was done where it was done too seldom; None where something cannot be explained."""
    streams = run.system.codec.streams
    if len(streams) == 1 and not run.do(streams[0], {}):
        return None
    if not all(follow(run, line) for line in way):
        return None
    before = reach.met
    for _ in range(steps):
        one = None if run.over or run.enough() else reach.choose(run.conversation, world, draw)
        if one is None:
            break
        if not (run.do(one.method, one.params, one.name, one.picks) and run.settle()):
            return None
    return reach.met - before if run.record() else None


def look(run: Run, world: int) -> bool:
    """Wait for everything to settle, and ask for the state if the system has a call for that."""
    asked = run.guide.alphabets[world].look
    return run.settle() and (asked is None or run.do(asked.method, asked.params))


def tour(
    run: Run,
    draw: random.Random,
    conversations: int,
    steps: int,
    favour: str | None = None,
    repeats: float = 0.0,
) -> bool:
    """Have conversations in which every step walks the edge that was walked least, mostly with a stream open.

    Args:
        run: the run.
        draw: where chance comes from.
        conversations: how many conversations.
        steps: calls and drives in each, at most.
        favour: an operation or drive to turn to again and again.
        repeats: how likely a drive is to be repeated at once, if that leads elsewhere.

    Returns:
        whether everything could be explained.
    """
    return _Tour(run, draw, steps, favour, repeats).run_all(conversations)


@define(eq=False)
class _Tour:
    run: Run
    draw: random.Random
    steps: int
    favour: str | None
    repeats: float

    def run_all(self, conversations: int) -> bool:
        return all(self._conversation(number) for number in range(conversations) if not self.run.enough())

    def _conversation(self, number: int) -> bool:
        run, world = self.run, number % len(self.run.guide.worlds)
        streams = run.system.codec.streams
        run.start(run.guide.worlds[world])
        if len(streams) == 1 and number % 4 != 3 and not run.do(streams[0], {}):
            return False
        left = iter(range(self.steps))
        for _ in left:
            proposal = self._next(world, self.favour if number % 2 else None)
            if proposal is None or run.over or run.enough():
                break
            if not run.follow(proposal):
                return False
            if self.draw.random() < SETTLED and not look(run, world):
                return False
            if not self._repeated(proposal, world, left):
                return False
        return run.settle() and run.record()

    def _repeated(self, done: Proposal, world: int, left: Iterator[int]) -> bool:
        """Repeat a drive as often as chance has it. Returns whether everything could be explained."""
        run = self.run
        while self.repeats and self.draw.random() < self.repeats and not run.over:
            more = self._once_more(done, world)
            if more is None or run.enough() or next(left, None) is None:
                break
            if not (run.follow(more) and run.settle()):
                return False
        return True

    def _once_more(self, done: Proposal, world: int) -> Proposal | None:
        """The same drive again, if it leads elsewhere: some faults show only many goals later."""
        if done.method != "drive":
            return None
        found = self.run.guide.proposals(self.run.conversation, world, done.params["event"])
        same = (one for one in found if one.params == done.params and one.leads_to != one.edge[0])
        return next(same, None)

    def _next(self, world: int, favour: str | None) -> Proposal | None:
        guide, conversation, draw = self.run.guide, self.run.conversation, self.draw
        if draw.random() < RARE:
            proposals = guide.proposals(conversation, world, rare=True)[:RAREST]
            return proposals[draw.randrange(len(proposals))] if proposals else None
        wanted = favour if favour and draw.random() < FAVOURED else None
        proposals = guide.proposals(conversation, world, wanted) or guide.proposals(conversation, world)
        if not proposals:
            return None
        least = guide.walked[proposals[0].edge]
        equal = [one for one in proposals if guide.walked[one.edge] == least]
        if guide.system.spec.abstraction.idle_search_key is not None and draw.random() < FAVOURED:
            # In a system in which most of what can be said has no effect, what leads elsewhere comes first.
            rare = guide.visited[equal[0].leads_to]
            equal = [one for one in equal if guide.visited[one.leads_to] == rare]
        return equal[draw.randrange(len(equal))]
