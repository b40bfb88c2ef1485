"""A recorded history to a verdict: which event cannot be explained, what was allowed instead, by which rule."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Any

from attrs import evolve

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Event, Returned
from missionfsm.kernel.readings import constrain
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.system import System
from missionfsm.oracle.belief import Automaton, Belief, Tally
from missionfsm.oracle.successors import ExhaustedError
from missionfsm.oracle.transcript import Head, Transcript
from missionfsm.tools.check.eliminations import Rulings, by_ambiguity
from missionfsm.tools.check.explain import violation
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
        fingerprint, lost: see `missionfsm.oracle.transcript.Transcript`.
        keep: how many lines are kept to be shown.
        apart: whether what is exercised is counted apart from what other judges see who share the automaton.

    Attributes:
        right: whether everything so far is explained, within the budget.
        exhausted: whether it was not within the budget.
        read, events, succeeded: how many lines and events were taken into account, and answers were OK.
    """

    def __init__(  # noqa: PLR0913 - all but the first two have a default
        self,
        system: System,
        head: Head,
        automaton: Automaton | None = None,
        *,
        readings: Mapping[str, str] | None = None,
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
            system.spec, head.drives, constrain(system.spec.ambiguities, readings or {})
        )
        self._tally: Tally = defaultdict(int) if apart else self.automaton.tally
        self.belief = Belief(self.automaton, system.codec.world(head.world), self._tally)
        self.rulings = Rulings(self.belief)
        self._seen = self.rulings.seen
        self.transcript = Transcript(system.codec, fingerprint, lost)
        self.lines: deque[JSON] = deque(maxlen=keep)
        self.read = 0
        self.events = 0
        self.succeeded = 0
        self.right = True
        self.exhausted = False
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
            if type(event) is Returned and event.answer.code == OK:
                self.succeeded += 1
        return True

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
        return Verdict(
            outcome,
            self.system.name,
            events=self.events,
            readings=self.belief.readings,
            exercised=exercised,
            uncovered=uncovered(self.system.spec, exercised, self.belief.readings),
            violation=self.violation,
            because=because,
            flagged=flagged(self.system.spec, self.belief.readings),
            ruled_out=by_ambiguity(self.system.spec.ambiguities, self.rulings.found),
        )

    @property
    def exercised(self) -> dict[str, int]:
        """How often each rule was exercised: here, or by all that walk the automaton."""
        return self.automaton.exercised(self._tally)


def uncovered(spec: Spec, exercised: Mapping[str, int], readings: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """The ids of the rules that were not exercised, though the readings that are followed have them."""
    return tuple(
        rule.id
        for rule in spec.all_rules
        if rule.id not in exercised
        and (rule.under is None or set(rule.under.letters) & set(readings.get(rule.under.of.id, rule.under.letters)))
    )


def flagged(spec: Spec, readings: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Where the letter of the text is departed from for certain: the readings that may be followed there."""
    return tuple(
        f"{ambiguity.id}={'|'.join(letters)}: {ambiguity.question} "
        + "; or: ".join(ambiguity.readings[letter] for letter in letters)
        for ambiguity in spec.ambiguities
        if (letters := readings.get(ambiguity.id, ())) and set(letters) <= ambiguity.flagged
    )


def check(system: System, head: Head, lines: Iterable[JSON], **options: Any) -> Verdict:  # noqa: ANN401 - see Judge
    """Judge a whole history. Raises UnreadableError for a line that is not of the format."""
    judge = Judge(system, head, **options)
    for line in lines:
        if not judge.feed(line):
            break
    return judge.verdict()
