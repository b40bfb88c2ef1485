"""What a run has found out so far: the readings that are left, what ruled the others out, and how much was done."""

from __future__ import annotations

from collections import Counter

from attrs import define, field

from missionfsm.kernel.readings import departs
from missionfsm.kernel.system import System
from missionfsm.tools.check.basis import Flagged
from missionfsm.tools.check.eliminations import Elimination
from missionfsm.tools.check.verdict import Violation
from missionfsm.tools.conform.contradiction import inconsistent
from missionfsm.tools.conform.conversation import Conversation


@define(eq=False)
class Ledger:
    """What all conversations of a run together come to.

    Attributes:
        steps: calls and drives so far; `events` that were observed, `examples` of conversations, and `succeeded` calls.
        answers: operation to status name to how often it was answered so.
        oddities: what is explained, and yet belongs to no reading: a line each.
        readings: the readings that every conversation so far can be explained by.
        ruled_out_by: ambiguity and letter to the first conversation that ruled it out.
        eliminations: ambiguity and letter to the event in that conversation.
        contradiction: the ambiguity whose last reading was ruled out, though each conversation had one.
        aside: ambiguities of which it is known that no single reading is followed.
        departing: of each conversation whose every explanation departs from the text somewhere, what these assume.
        notes: what else there is to know about how the run went.
    """

    system: System
    steps: int = 0
    events: int = 0
    examples: int = 0
    succeeded: int = 0
    answers: dict[str, Counter[str]] = field(factory=dict)
    oddities: dict[Flagged, None] = field(factory=dict)
    readings: dict[str, tuple[str, ...]] = field(factory=dict)
    ruled_out_by: dict[tuple[str, str], Conversation] = field(factory=dict)
    eliminations: dict[tuple[str, str], Elimination] = field(factory=dict)
    contradiction: str | None = None
    aside: set[str] = field(factory=set)
    departing: dict[frozenset[int], None] = field(factory=dict)
    notes: list[str] = field(factory=list)

    def note(self, says: str) -> None:
        """Say something with the verdict, once."""
        if says not in self.notes:
            self.notes.append(says)

    def count(self, done: Conversation) -> None:
        """Count a conversation that has ended."""
        self.events += done.judge.events
        self.examples += 1
        self.succeeded += done.succeeded
        for name, codes in done.judge.answers.items():
            self.answers.setdefault(name, Counter()).update(codes)
        self.oddities.update(dict.fromkeys(done.judge.oddities))

    def enter(self, done: Conversation) -> list[str]:
        """Enter the readings of a conversation that is explained; the ambiguities of which none is left by now."""
        contradicted = []
        left = done.judge.belief.readings
        ways = frozenset(one.assumed for one in done.judge.belief.node.explanations)
        if all(departs(self.system.spec.ambiguities, way) for way in ways):
            self.departing[ways] = None
        for ambiguity in self.system.spec.ambiguities:
            letters = left.get(ambiguity.id)
            if letters is None or ambiguity.id in self.aside:
                continue
            possible = self.readings.get(ambiguity.id) or tuple(ambiguity.readings)
            for letter in possible:
                if letter not in letters:
                    self._rule_out(ambiguity.id, letter, done)
            self.readings[ambiguity.id] = tuple(letter for letter in possible if letter in letters)
            if not self.readings[ambiguity.id]:
                contradicted.append(ambiguity.id)
        return contradicted

    def _rule_out(self, name: str, letter: str, done: Conversation) -> None:
        self.ruled_out_by.setdefault((name, letter), done)
        if (name, letter) in done.judge.eliminations.found:
            self.eliminations.setdefault((name, letter), done.judge.eliminations.found[name, letter])

    def set_aside(self, name: str) -> None:
        """An ambiguity is known to be answered now in one way and now in another."""
        self.aside.add(name)
        del self.readings[name]

    def inconsistency(self) -> Violation:
        """What is wrong with an implementation that follows no single reading of the contradiction's ambiguity."""
        spec = self.system.spec
        ambiguity = next(one for one in spec.ambiguities if one.id == self.contradiction)
        evidence = {letter: done.judge for (name, letter), done in self.ruled_out_by.items() if name == ambiguity.id}
        return inconsistent(spec, ambiguity, evidence)
