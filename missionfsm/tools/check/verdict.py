"""What a judgement comes to, as a value: for people with ``str``, for machines with `to_json`."""

from __future__ import annotations

import enum
import json
from collections.abc import Iterator, Mapping

from attrs import evolve, field, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.rules import INVALID_ARGUMENT
from missionfsm.kernel.text import counted, printable, shortened
from missionfsm.tools.check.basis import Flagged, MatrixCoverage, Untested, readings_line
from missionfsm.tools.check.experiment import Experiment

RATE, PER = 100, 10_000
"""How often each rule should be exercised, in how many steps."""

MAX_RARE = 10
"""How many of the rules that came up seldom a person is told."""

MAX_CHARACTERS = 72
"""How much of an event a line of the verdict has room for."""


class Outcome(enum.Enum):
    """How it came out."""

    CONFORMS = "conforms"
    VIOLATES = "violates"
    INCONCLUSIVE = "inconclusive"


MAX_LINE = 300
"""How many characters of the event, and of what was allowed, a person is shown; the JSON has all of it."""

MAX_SHOWN = 5
"""How many of the allowed events a person is shown."""


@frozen
class CitedRule:
    """A rule as a verdict cites it."""

    id: str
    says: str
    cite: str

    def __str__(self) -> str:
        return f"{self.says} [{self.cite}]"


@frozen
class Allowed:
    """Something that was allowed instead of what was observed."""

    what: str
    rules: tuple[CitedRule, ...] = ()
    assumes: tuple[str, ...] = ()

    def __str__(self) -> str:
        why = "; ".join(map(str, self.rules))
        under = f" (under {', '.join(self.assumes)})" if self.assumes else ""
        return f"{shortened(self.what, MAX_LINE)}{under}" + (f": {why}" if why else "")


@frozen
class Side:
    """One of several conversations that contradict one another: what it shows, and its lines."""

    says: str
    history: tuple[JSON, ...]


@frozen
class Violation:
    """An event that nothing explains.

    Attributes:
        rules: the rules that it breaks.
        observed: the event, for people.
        expected: what would have been right.
        notes: reasons why no explanation is left, a line each.
        history: the shortest history known that shows it, as lines of the history format.
        at: the number of the line of a file where it is (see `line`), or else of the event, from 1.
        where: the words before `observed` that name the line of the file; empty if there is no file.
        sides: the conversations that contradict one another, if no single one of them is wrong.
        listed: ids of the rules by which a list of known violations knows it, if those are not its own: a search meets
            it in a conversation that is longer than the one that is shown, and that may break other rules as well.
    """

    rules: tuple[CitedRule, ...]
    observed: str
    expected: tuple[Allowed, ...]
    notes: tuple[str, ...] = ()
    history: tuple[JSON, ...] = ()
    at: int = 0
    where: str = ""
    sides: tuple[Side, ...] = ()
    listed: tuple[str, ...] = ()

    @property
    def line(self) -> int | None:
        """The number of the line of the file where it is, from 1; None where there is no file."""
        return self.at if self.where else None

    @property
    def known_by(self) -> tuple[str, ...]:
        """Ids of the rules by which a list of known violations knows it, each once."""
        return self.listed or tuple(dict.fromkeys(rule.id for rule in self.rules))

    @property
    def sent(self) -> str:
        """The request as it was sent, as JSON, if it is in question whether it was valid; else empty."""
        doubtful = not self.sides and any(f"/{INVALID_ARGUMENT}/" in rule.id for rule in self.rules)
        answered = self.history[-1].get("return") if doubtful and self.history else None
        calls = (line for line in reversed(self.history) if answered is not None and line.get("call") == answered)
        call = next(calls, None)
        return "" if call is None else printable(json.dumps(call.get("params"), ensure_ascii=False))

    @property
    def explanation(self) -> str:
        """The violation in a few lines."""
        seen = f"{self.where}{shortened(self.observed, MAX_LINE)}"
        lines = [seen, *([f"  sent: {self.sent}"] if self.sent else []), *self._allowed]
        lines += [f"  {note}" for note in self.notes]
        if self.against:
            lines.append("  against:")
            lines += dict.fromkeys(f"    - {one}" for one in self.against)
        return "\n".join(lines)

    @property
    def _allowed(self) -> list[str]:
        """What could have come; rules that justify all of it are named once, before it."""
        if not self.expected:
            return ["  nothing was allowed here"]
        common = self.expected[0].rules if len({one.rules for one in self.expected}) == 1 < len(self.expected) else ()
        shown = [evolve(one, rules=()) if common else one for one in self.expected[:MAX_SHOWN]]
        more = len(self.expected) - len(shown)
        return [
            f"  allowed here{', by' if common else ''}: {'; '.join(map(str, common))}".rstrip(),
            *(f"    - {one}" for one in shown),
            *([f"    - and {more} more"] if more else []),
        ]

    @property
    def against(self) -> tuple[CitedRule, ...]:
        """The rules that are broken and are not told with what was allowed; before others the first is told again."""
        justified = {rule for one in self.expected for rule in one.rules}
        left = tuple(rule for rule in self.rules if rule not in justified)
        return (self.rules[0], *left) if left and self.rules[0] in justified else left


@frozen
class Verdict:
    """A judgement of one implementation or of one recorded history.

    Attributes:
        outcome: how it came out.
        system: the name of the system that was judged.
        implementation: what the adapter says it is, or what was judged instead of an implementation.
        seed: the seed of the random conversations; None if there were none.
        examples: how many conversations were had; 0 for a recorded history.
        events: how many events were judged.
        violation: what is wrong, if anything is.
        story: the conversation that shows it, or that could not be decided, in numbered lines.
        exercised: rule id to how often it was exercised.
        uncovered: ids of rules that were not.
        readings: ambiguity id to the readings that are still possible, for those that mattered.
        flagged: what is explained, and yet departs from the letter of the text or from itself: a line each, which is a
            text that says of what reading it is.
        unchecked: what the specification waives and could have shown, a line each.
        untested: what nothing can be said of.
        because: why it is inconclusive.
        ruled_out: ambiguity id to letter to the event that ruled it out, in words.
        experiments: for readings that are still open, what would tell them apart.
        known: ids of rules whose violation was expected, to how often it was met.
        stale: ids of rules whose violation was expected and was not met.
        rare: ids of rules that were exercised less often than they should be, to the reason.
        notes: what else there is to know about how the run went.
        uncounted: ids of rules that all that came was held against, without counting what put them to the test.
        reach: in which situations what was asked; None where the system does not say which there are.
        advised: whether it was thought about experiments and about what came up seldom.
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
    flagged: tuple[Flagged, ...] = ()
    unchecked: tuple[str, ...] = ()
    untested: Untested = field(factory=Untested)
    story: str = ""
    ruled_out: Mapping[str, Mapping[str, str]] = field(factory=dict)
    experiments: tuple[Experiment, ...] = ()
    known: Mapping[str, int] = field(factory=dict)
    stale: tuple[str, ...] = ()
    rare: Mapping[str, str] = field(factory=dict)
    notes: tuple[str, ...] = ()
    uncounted: frozenset[str] = frozenset()
    reach: MatrixCoverage | None = None
    advised: bool = True

    @property
    def conforms(self) -> bool:
        """Whether everything that was observed is explained or was expected, and something was observed."""
        return self.outcome is Outcome.CONFORMS

    def to_json(self) -> JSON:
        """The verdict as the command line writes it."""
        return {
            "verdict": self.outcome.value,
            "headline": self.headline,
            "rests_on": list(self.rests_on(all_names=True)),
            "system": self.system,
            "implementation": self.implementation,
            "seed": self.seed,
            "examples": self.examples,
            "events": self.events,
            "readings": {name: list(letters) for name, letters in self.readings.items()},
            "ruled_out": {name: dict(events) for name, events in self.ruled_out.items()},
            "experiments": [one.to_json() for one in self.experiments],
            "coverage": {
                "rules": dict(self.exercised),
                "uncovered": list(self.uncovered),
                "rare": dict(self.rare),
            },
            "flagged": list(self.flagged),
            "unchecked": list(self.unchecked),
            "untested": self.untested.to_json(),
            "known": dict(self.known),
            "stale": list(self.stale),
            "notes": list(self.notes),
            "reach": self.reach and self.reach.to_json(),
            "because": self.because,
            "story": self.story.splitlines(),
            "violation": None
            if self.violation is None
            else {
                "rules": [rule.id for rule in self.violation.rules],
                "known_by": list(self.violation.known_by),
                "expected": [str(one) for one in self.violation.expected],
                "observed": self.violation.observed,
                "explanation": self.violation.explanation,
                "history": list(self.violation.history),
                "conversations": [{"shows": side.says, "history": list(side.history)} for side in self.violation.sides],
            },
        }

    @property
    def headline(self) -> str:
        """The outcome in a few words: also whether it conforms only in part, or with something flagged."""
        if not self.conforms:
            return self.outcome.value
        part = " in part" if self.untested.something else ""
        flagged = ", flagged" if self.flagged else ""
        return f"{self.outcome.value}{part}{flagged}"

    def rests_on(self, *, all_names: bool = False) -> tuple[str, ...]:
        """What a verdict that conforms rests on, in at most three lines: calls, readings, drives.

        Args:
            all_names: whether all calls, readings and drives are named, not only a few.
        """
        if not self.conforms:
            return ()
        lines = (
            self.untested.calls_line(all_names=all_names),
            readings_line(self.readings, self.flagged, all_names=all_names),
            self.untested.drives_line(all_names=all_names),
        )
        return tuple(filter(None, lines))

    def __str__(self) -> str:
        return self.text(verbose=True)

    def text(self, *, verbose: bool = False) -> str:
        """The verdict for people, what is worst first.

        Args:
            verbose: whether readings that are decided, what would decide the others, and rules that came up seldom are
                told as well.
        """
        lines = [*self._head(verbose=verbose), *self._findings(), *self._readings(verbose=verbose)]
        if verbose:
            for experiment in self.experiments:
                lines += ["", str(experiment)]
        total = len(self.exercised) + len(self.uncovered)
        if total:
            lines += ["", f"rules exercised: {len(self.exercised)} of {total}"]
        if self.reach is not None:
            lines += self.reach.lines(all_names=verbose)
        if verbose:
            lines += self._rarely()
        elif folded := self._folded():
            lines.append(f"-v shows {folded}")
        return "\n".join(lines)

    def _head(self, *, verbose: bool) -> Iterator[str]:
        """The headline, and the lines about what the verdict rests on."""
        about = f"{self.system}{' ' + printable(self.implementation) if self.implementation else ''}"
        counted = f"{self.events} events" + (f" in {self.examples} examples" if self.examples else "")
        yield f"{self.headline}: {about}, {counted}" + (f", seed {self.seed}" if self.seed is not None else "")
        yield from (f"  {line}" for line in self.rests_on(all_names=verbose))
        if self.because:
            yield f"  because {printable(self.because)}"

    def _findings(self) -> Iterator[str]:
        """The violation, what is known of violations, and what departs from the text."""
        if self.story:
            yield from ("", self.story)
        if self.violation:
            yield from ("", self.violation.explanation, *self._rule_ids())
        yield from (f"  known violation, met {times} times: {rule}" for rule, times in self.known.items() if times)
        yield from (
            f"  a violation of {rule} was expected and was not met: take it off the list" for rule in self.stale
        )
        yield from (f"  {printable(note)}" for note in self.notes)
        if self.flagged:
            yield from ("", "flagged:", *(f"  {printable(one)}" for one in self.flagged))

    def _rule_ids(self) -> list[str]:
        """The rules that are broken as a list of known violations takes them."""
        if not self.violation or not self.violation.known_by:
            return []
        ids = self.violation.known_by
        shown = {rule.id for rule in self.violation.rules}
        longer = " (by the rules that it broke before it was made short)"
        met = "" if shown.issuperset(ids) else longer
        return [f"  as --expect-violations takes it{met}:", *(f"    {one}" for one in ids)]

    def _readings(self, *, verbose: bool) -> list[str]:
        """The readings that are left: those of open questions first, the others only if they are wanted."""
        left_open = {name: letters for name, letters in self.readings.items() if len(letters) != 1}
        decided = {name: letters for name, letters in self.readings.items() if len(letters) == 1}
        lines: list[str] = []
        for title, some in (("readings still open:", left_open), ("readings followed:", decided)):
            if some and (verbose or some is left_open):
                lines += ["", title]
                lines += [f"  {name} = {self._reading_text(name, letters)}" for name, letters in some.items()]
        return lines

    def _folded(self) -> str:
        """What is told only where it is wanted."""
        decided = sum(len(letters) == 1 for letters in self.readings.values())
        parts = (
            f"what decided {counted(decided, 'reading')}" if decided else "",
            "what would decide the others" if self.experiments or self._unadvised else "",
            f"{counted(len(self.rare), 'rule')} that came up seldom" if self.rare else "",
        )
        return ", ".join(filter(None, parts))

    @property
    def _unadvised(self) -> bool:
        """Whether nobody thought about readings that are still open."""
        return not self.advised and any(len(letters) > 1 for letters in self.readings.values())

    def _rarely(self) -> list[str]:
        """The rules that came up least, but for those that belong to readings that are not followed."""
        least = sorted(
            (rule for rule in self.rare if rule in self.exercised or rule in self.uncovered),
            key=lambda rule: self.exercised.get(rule, 0),
        )
        if not least:
            return []
        lines = [f"fewer than {RATE} times in {PER:,} steps: {len(least)} rules, the rarest of them"]
        lines += [f"  {rule}, {self.exercised.get(rule, 0)} times: {self.rare[rule]}" for rule in least[:MAX_RARE]]
        return lines

    def _reading_text(self, name: str, letters: tuple[str, ...]) -> str:
        """The readings of an ambiguity that are left, and what ruled out the others."""
        events: dict[str, list[str]] = {}
        for letter, event in self.ruled_out.get(name, {}).items():
            events.setdefault(event, []).append(letter)
        gone = "; ".join(f"not {', '.join(others)}: {_short(event)}" for event, others in events.items())
        return (" or ".join(letters) or "none") + (f" ({gone})" if gone else "")


def _short(text: str) -> str:
    return text if len(text) <= MAX_CHARACTERS else text[: MAX_CHARACTERS - 1] + "…"
