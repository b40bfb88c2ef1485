"""What the conversations of a run have shown so far: the readings that are left, and what ruled the others out."""

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
    """What all conversations of a run show together.

    Attributes:
        system: the system.
        steps: how many calls and drives were done.
        events: how many events were observed.
        examples: how many conversations were had.
        succeeded: how many calls were answered OK.
        answers: for each operation, how often it was answered with each status.
        undecided: how many conversations were given up at an event that had too many explanations.
        left: how many ended early, all of them judged, since what happens by itself could be too many things.
        oddities: what is explained and belongs to no reading, but is worth a line of the verdict.
        readings: for each ambiguity that mattered, the readings that explain every conversation so far.
        ruled_out_by: for each ambiguity id and letter that was ruled out, the first conversation that did it.
        eliminations: the same, with the event in that conversation.
        contradiction: the ambiguity of which no reading is left, although each conversation follows one.
        aside: ambiguities that are known to be read differently in different conversations.
        departing: for each conversation whose every explanation departs from the text, what its explanations assume.
        notes: lines for the verdict about how the run went.
    """

    system: System
    steps: int = 0
    events: int = 0
    examples: int = 0
    succeeded: int = 0
    undecided: int = 0
    left: int = 0
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
        """Add a line to the notes, once."""
        if says not in self.notes:
            self.notes.append(says)

    @property
    def remarks(self) -> tuple[str, ...]:
        """The notes, and how many conversations were given up or ended early."""
        notes = tuple(self.notes)
        if self.undecided:
            says = f"{self.undecided} of {self.examples} conversations were given up"
            notes += (f"{says} at an event with too many explanations: what followed there was not judged",)
        if self.left:
            says = f"{self.left} of {self.examples} conversations ended early"
            notes += (f"{says}: too much may have happened by itself to follow what comes next",)
        return notes

    def count(self, done: Conversation) -> None:
        """Count a conversation that has ended."""
        self.events += done.judge.events
        self.examples += 1
        self.succeeded += done.succeeded
        for name, codes in done.judge.answers.items():
            self.answers.setdefault(name, Counter()).update(codes)
        self.oddities.update(dict.fromkeys(done.judge.oddities))

    def enter(self, done: Conversation) -> list[str]:
        """Enter the readings of an explained conversation. Returns the ambiguities of which no reading is left."""
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
        """Look at an ambiguity no longer: it is known to be read differently in different conversations."""
        self.aside.add(name)
        del self.readings[name]

    def inconsistency(self) -> Violation:
        """The violation of following no single reading of the contradiction's ambiguity."""
        spec = self.system.spec
        ambiguity = next(one for one in spec.ambiguities if one.id == self.contradiction)
        evidence = {letter: done.judge for (name, letter), done in self.ruled_out_by.items() if name == ambiguity.id}
        return inconsistent(spec, ambiguity, evidence)
