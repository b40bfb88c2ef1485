"""What a judgement comes to, as a value: for people with ``str``, for machines with `to_json`."""

from __future__ import annotations

import enum
from collections.abc import Mapping

from attrs import field, frozen

from missionfsm.kernel.codec import JSON


class Outcome(enum.Enum):
    """How it came out."""

    CONFORMS = "conforms"
    VIOLATES = "violates"
    INCONCLUSIVE = "inconclusive"


@frozen
class Broken:
    """A rule in question, as a person is told it."""

    id: str
    says: str
    cite: str

    def __str__(self) -> str:
        return f"{self.says} [{self.cite}]"


@frozen
class Allowed:
    """Something that would have been right in the place of what was observed."""

    what: str
    rules: tuple[Broken, ...] = ()
    assumes: tuple[str, ...] = ()

    def __str__(self) -> str:
        why = "; ".join(map(str, self.rules))
        under = f" (under {', '.join(self.assumes)})" if self.assumes else ""
        return f"{self.what}{under}" + (f": {why}" if why else "")


@frozen
class Violation:
    """An event that nothing explains.

    Attributes:
        rules: the rules that it breaks.
        observed: the event, for people.
        expected: what would have been right.
        notes: why explanations died, one line each.
        history: the shortest history known that shows it, as lines of the history format.
        at: where it is: the number of the event, or of the line in a file, from 1.
    """

    rules: tuple[Broken, ...]
    observed: str
    expected: tuple[Allowed, ...]
    notes: tuple[str, ...] = ()
    history: tuple[JSON, ...] = ()
    at: int = 0
    where: str = ""

    @property
    def explanation(self) -> str:
        """The violation in a few lines."""
        lines = [f"{self.where}{self.observed}"]
        if self.expected:
            lines.append("  allowed here:")
            lines += [f"    - {one}" for one in self.expected]
        else:
            lines.append("  nothing was allowed here")
        lines += [f"  {note}" for note in self.notes]
        if self.rules:
            lines.append("  against:")
            lines += [f"    - {one}" for one in self.rules]
        return "\n".join(lines)


@frozen
class Verdict:
    """A judgement of one implementation or of one recorded history.

    Attributes:
        exercised: rule id to how often it was exercised.
        uncovered: ids of rules that were not.
        readings: ambiguity id to the readings that are still possible, for those that mattered.
        flagged: readings among those followed that depart from the letter of the text.
        because: why it is inconclusive.
    """

    outcome: Outcome
    system: str
    implementation: str = ""
    seed: int | None = None
    examples: int = 0
    events: int = 0
    readings: Mapping[str, tuple[str, ...]] = field(factory=dict)
    exercised: Mapping[str, int] = field(factory=dict)
    uncovered: tuple[str, ...] = ()
    violation: Violation | None = None
    because: str = ""
    flagged: tuple[str, ...] = ()
    story: str = ""

    @property
    def conforms(self) -> bool:
        """Whether everything that was observed is explained, and something was."""
        return self.outcome is Outcome.CONFORMS

    def to_json(self) -> JSON:
        """The verdict as the command line writes it."""
        return {
            "verdict": self.outcome.value,
            "system": self.system,
            "implementation": self.implementation,
            "seed": self.seed,
            "examples": self.examples,
            "events": self.events,
            "readings": {name: list(letters) for name, letters in self.readings.items()},
            "coverage": {"rules": dict(self.exercised), "uncovered": list(self.uncovered)},
            "because": self.because,
            "violation": None
            if self.violation is None
            else {
                "rules": [rule.id for rule in self.violation.rules],
                "expected": [str(one) for one in self.violation.expected],
                "observed": self.violation.observed,
                "explanation": self.violation.explanation,
                "history": list(self.violation.history),
            },
        }

    def __str__(self) -> str:
        about = f"{self.system}{' ' + self.implementation if self.implementation else ''}"
        counted = f"{self.events} events" + (f" in {self.examples} examples" if self.examples else "")
        lines = [f"{self.outcome.value}: {about}, {counted}" + (f", seed {self.seed}" if self.seed is not None else "")]
        if self.because:
            lines.append(f"  because {self.because}")
        if self.violation:
            if self.story:
                lines += ["", self.story]
            lines += ["", self.violation.explanation]
        if self.readings:
            lines += ["", "readings followed:"]
            lines += [f"  {name} = {' or '.join(letters) or 'none'}" for name, letters in self.readings.items()]
        lines += [f"  departs from the text: {one}" for one in self.flagged]
        total = len(self.exercised) + len(self.uncovered)
        if total:
            lines += ["", f"rules exercised: {len(self.exercised)} of {total}"]
        return "\n".join(lines)
