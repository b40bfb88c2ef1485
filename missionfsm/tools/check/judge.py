"""A recorded history to a verdict: which event cannot be explained, what was allowed instead, by which rule."""

from __future__ import annotations

from collections import Counter, defaultdict, deque
from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Any

from attrs import evolve

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Called, Event, Returned, Settled
from missionfsm.kernel.rules import OK
from missionfsm.kernel.system import System
from missionfsm.oracle.belief import Automaton, Belief, Tally
from missionfsm.oracle.successors import ExhaustedError
from missionfsm.oracle.transcript import Head, Transcript
from missionfsm.tools.check.eliminations import Rulings, by_ambiguity
from missionfsm.tools.check.explain import violation
from missionfsm.tools.check.scope import assumed, flagged, held_to_the_text, unchecked, uncovered, untested
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation

KEPT = 200
"""How many lines before a violation a verdict shows of a long history."""


class Judge:
    """Judges one conversation as its lines come.

    Args:
        system: the system.
        head: the first line of the history.
        automaton: a belief automaton to walk; its own is made where none is given. Sharing one makes many judges fast.
        readings: the readings to assume, in an automaton of its own.
        no_flagged: whether nothing may depart from the letter of the text.
        fingerprint, lost: see `missionfsm.oracle.transcript.Transcript`.
        keep: how many lines are kept to be shown.
        apart: whether what is exercised is counted apart from what other judges see who share the automaton.

    Attributes:
        right: whether everything so far is explained, within the budget.
        exhausted: whether it was not within the budget.
        read, events, succeeded: how many lines and events were taken into account, and answers were OK.
        answers: operation to status name to how often it was answered so.
    """

    def __init__(  # noqa: PLR0913 - all but the first two have a default
        self,
        system: System,
        head: Head,
        automaton: Automaton | None = None,
        *,
        readings: Mapping[str, str] | None = None,
        no_flagged: bool = False,
        fingerprint: Callable[[JSON], Hashable] = repr,
        lost: frozenset[int] = frozenset(),
        keep: int = KEPT,
        apart: bool = False,
    ) -> None:
        self.system = system
        self.head = head
        unknown = [drive for drive in head.drives if drive not in system.spec.drives]
        if unknown:
            message = f"drives: {system.name} has no {unknown[0]!r}; it has {', '.join(system.spec.drives)}"
            raise UnreadableError(message)
        self.automaton = automaton or Automaton(
            system.spec, head.drives, assumed(system.spec, readings, no_flagged=no_flagged)
        )
        self._no_flagged = no_flagged
        self._tally: Tally = defaultdict(int) if apart else self.automaton.tally
        self.belief = Belief(self.automaton, system.codec.world(head.world), self._tally)
        self.rulings = Rulings(self.belief)
        self._seen = self.rulings.seen
        self.transcript = Transcript(system.codec, fingerprint, lost)
        self.lines: deque[JSON] = deque(maxlen=keep)
        self.read = 0
        self.events = 0
        self.succeeded = 0
        self.answers: dict[str, Counter[str]] = {name: Counter() for name in system.spec.operations}
        self.right = True
        self.exhausted = False
        self._waits = self._unanswered = False
        self._unexplained: Event | None = None
        self._violation: Violation | None = None
        self._asked: Any = None

    def feed(self, line: JSON) -> bool:
        """Take a line into account; False once the verdict cannot get better.

        Raises:
            UnreadableError: the line is not of the format.
        """
        events = self.transcript.read(line)
        if self.right:
            self.lines.append(line)
        return self.take(events)

    def take(self, events: tuple[Event, ...]) -> bool:
        """Take the events of a line into account that was read already and need not be shown; see `feed`."""
        if not self.right:
            return False
        self.read += 1
        belief = self.belief
        for event in events:
            self.events += 1
            try:
                explained = belief.observe(event)
            except ExhaustedError:
                self.exhausted, self.right = True, False
                return False
            if not explained:
                self._unexplained, self.right = event, False
                self._asked = self.transcript.answered
                return False
            if belief.node not in self._seen:
                self.rulings.notice(event, self.transcript.answered)
            kind = type(event)
            if kind is Returned:
                self._count(event.answer.code)  # type: ignore[union-attr]
            elif kind is Settled:
                self._unanswered = self._unanswered or self._waits or len(self.transcript.pending) > 0
            elif kind is Called and event.lost:  # type: ignore[union-attr]
                self._waits = True
        return True

    def _count(self, code: str) -> None:
        if code == OK:
            self.succeeded += 1
        if self.transcript.answered is not None:  # that of a cancel is no call
            self.answers[self.system.spec.request_operation(self.transcript.answered)][code] += 1

    @property
    def violation(self) -> Violation | None:
        """What is wrong with the event that nothing explains; put into words when it is asked for."""
        if self._unexplained is not None and self._violation is None:
            found = violation(self.belief, self._unexplained, self._asked)
            self._violation = evolve(found, history=self.history, at=self.read + 1)
        return self._violation

    @property
    def history(self) -> tuple[JSON, ...]:
        """The lines that were read, the first line before them; of a long history only the last ones."""
        first = {"missionfsm": 1, "system": self.head.system, "world": self.head.world}
        if self.head.drives:
            first["drives"] = list(self.head.drives)
        return (first, *self.lines)

    def verdict(self) -> Verdict:
        """The judgement of what was fed so far."""
        outcome, because, exercised = Outcome.CONFORMS, "", self.exercised
        if self._unexplained is not None:
            outcome = Outcome.VIOLATES
        elif self.exhausted:
            outcome, because = Outcome.INCONCLUSIVE, f"event {self.events} has too many explanations to decide"
        elif not exercised:
            outcome, because = Outcome.INCONCLUSIVE, "nothing was exercised"
        spec, readings = self.system.spec, self.belief.readings
        left_out = uncovered(spec, exercised, readings)
        ways = [one.assumed for one in self.belief.node.explanations]
        used = (name for name, codes in self.answers.items() if codes)
        verdict = Verdict(
            outcome,
            self.system.name,
            events=self.events,
            readings=readings,
            exercised=exercised,
            uncovered=left_out,
            violation=self.violation,
            because=because,
            flagged=(*flagged(spec, readings, self.rulings.found, ways), *self.oddities),
            unchecked=unchecked(spec, (*used, *self.head.drives)),
            untested=untested(spec, self.answers, self.head.drives, left_out),
            ruled_out=by_ambiguity(spec.ambiguities, self.rulings.found),
        )
        return held_to_the_text(verdict) if self._no_flagged else verdict

    @property
    def oddities(self) -> tuple[str, ...]:
        """What is explained, and yet belongs to no reading: a line each."""
        return ("a call was not answered, or only after everything had settled",) if self._unanswered else ()

    @property
    def exercised(self) -> dict[str, int]:
        """How often each rule was exercised: here, or by all that walk the automaton."""
        return self.automaton.exercised(self._tally)


def check(system: System, head: Head, lines: Iterable[JSON], **options: Any) -> Verdict:  # noqa: ANN401 - see Judge
    """Judge a whole history. Raises UnreadableError for a line that is not of the format."""
    judge = Judge(system, head, **options)
    for line in lines:
        if not judge.feed(line):
            break
    return judge.verdict()
