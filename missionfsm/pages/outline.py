"""The map of a document: its outline, and for every clause how it fared in a judgement.

The clauses are those of the written specification. A rule that no clause names, and every rule of a system without a
written specification, stands at the place that it cites, in its own words.
"""

from __future__ import annotations

import enum
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from attrs import field, frozen

from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.spec import Spec
from missionfsm.pages.render import specification_page
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.specpages import Clause, base, citing, clauses, named

_TAILS = re.compile(r"\*(Checked by|Not a rule:|Open:)\*")
_WAIVED = re.compile(r"^\| \[([^\]]+)\]\([^)]*\) \| (.*) \|$")
_WAIVED_PART = re.compile(r"<!-- generated: waived -->(.*?)<!-- end -->", re.DOTALL)
_SEPARATOR = " › "


class Standing(enum.Enum):
    """How a rule or a clause fared, the gravest first."""

    VIOLATED = "violated"
    AMBIGUOUS = "ambiguous"
    EXERCISED = "exercised"
    UNCOUNTED = "not counted"
    NOT_REACHED = "not reached"
    OTHERWISE = "read otherwise"
    WAIVED = "waived"

    @property
    def slug(self) -> str:
        """The name that the style sheet knows it by."""
        return self.name.lower().replace("_", "-")


MEANINGS: Mapping[Standing, str] = {
    Standing.VIOLATED: "something that was observed breaks it",
    Standing.AMBIGUOUS: "it was exercised, and what was observed fits several readings of it",
    Standing.EXERCISED: "it was put to the test, and kept",
    Standing.UNCOUNTED: "all messages were held against it, and nobody counted which of them could break it",
    Standing.NOT_REACHED: "nothing that was observed put it to the test",
    Standing.OTHERWISE: "it belongs to a reading that is not followed",
    Standing.WAIVED: "no rule follows from it; the specification says why",
}


@frozen
class Evidence:
    """What some verdicts on one system say together.

    Attributes:
        exercised: rule id to how often it was exercised.
        violated: ids of the rules that are broken.
        readings: ambiguity id to the readings that are still possible, for those that mattered.
        rare: rule id to why it was exercised less often than it should be.
        uncounted: ids of rules that are looked at in bare messages, without a count.
    """

    exercised: Mapping[str, int] = field(factory=dict)
    violated: frozenset[str] = frozenset()
    readings: Mapping[str, tuple[str, ...]] = field(factory=dict)
    rare: Mapping[str, str] = field(factory=dict)
    uncounted: frozenset[str] = frozenset()

    @classmethod
    def of(cls, verdicts: Iterable[Verdict]) -> Evidence:
        """The evidence of verdicts. Those on one file share their counts, so the largest count is the count."""
        exercised: dict[str, int] = {}
        readings: dict[str, tuple[str, ...]] = {}
        violated: set[str] = set()
        rare: dict[str, str] = {}
        uncounted: set[str] = set()
        for verdict in verdicts:
            for rule, times in verdict.exercised.items():
                exercised[rule] = max(times, exercised.get(rule, 0))
            for name, letters in verdict.readings.items():
                before = readings.get(name, letters)
                # Where two follow different readings, together they follow none in particular.
                both = tuple(letter for letter in before if letter in letters)
                readings[name] = both or tuple(dict.fromkeys((*before, *letters)))
            violated |= {rule for rule, times in verdict.known.items() if times}
            if verdict.violation:
                violated |= {rule.id for rule in verdict.violation.rules}
            rare |= verdict.rare
            uncounted |= verdict.uncounted
        return cls(exercised, frozenset(violated), readings, rare, frozenset(uncounted))

    def standing(self, rule: Rule) -> Standing:
        """How a rule fared."""
        if rule.id in self.violated:
            return Standing.VIOLATED
        if rule.assumes is not None:
            left = self.readings.get(rule.assumes.ambiguity.id)
            if left is not None and not set(left) & set(rule.assumes.letters):
                return Standing.OTHERWISE
            if rule.id in self.exercised and left is not None and len(left) > 1:
                return Standing.AMBIGUOUS
        if rule.id in self.exercised:
            return Standing.EXERCISED
        return Standing.UNCOUNTED if rule.id in self.uncounted else Standing.NOT_REACHED


@frozen
class RuleLine:
    """A rule as the map shows it."""

    id: str
    operation: str
    name: str
    says: str
    cite: str
    code: str
    under: str
    standing: Standing
    times: int
    rare: str


@frozen
class Sentence:
    """What one or several rules of a clause say in the same words, each for an operation of its own."""

    says: str
    under: str
    rules: tuple[RuleLine, ...]


@frozen
class Question:
    """An ambiguity that a clause depends on, the readings that are left of it, and whether one was decided."""

    id: str
    asks: str
    left: tuple[str, ...]

    @property
    def undecided(self) -> bool:
        """Whether it mattered, and what was observed fits several readings."""
        return len(self.left) > 1


@frozen
class ClauseLine:
    """A clause as the map shows it.

    Attributes:
        reason: why no rule follows from it, where none does.
        waived: parts of its open entries that are waived, each with the reason.
    """

    number: str
    text: str
    standing: Standing
    rules: tuple[RuleLine, ...] = ()
    questions: tuple[Question, ...] = ()
    reason: str = ""
    waived: tuple[tuple[str, str], ...] = ()

    @property
    def anchor(self) -> str:
        """Where a page has it."""
        return self.number or f"clause-{self.rules[0].id}"

    @property
    def sentences(self) -> tuple[Sentence, ...]:
        """Its rules, those together that say the same."""
        alike: dict[tuple[str, str], list[RuleLine]] = {}
        for rule in self.rules:
            alike.setdefault((rule.says, rule.under), []).append(rule)
        return tuple(Sentence(says, under, tuple(rules)) for (says, under), rules in alike.items())


@frozen
class Section:
    """A heading of the document with what stands under it."""

    heading: str
    lines: tuple[ClauseLine, ...] = ()
    sections: tuple[Section, ...] = ()

    @property
    def tally(self) -> tuple[tuple[Standing, int], ...]:
        """How many clauses here and below fared how, the gravest first."""
        counted = Counter(line.standing for line in (*self.lines, *self.below))
        return tuple((standing, counted[standing]) for standing in Standing if counted[standing])

    @property
    def worst(self) -> Standing:
        """The gravest standing of a clause here or below."""
        return self.tally[0][0]

    @property
    def below(self) -> tuple[ClauseLine, ...]:
        """The clauses under the headings below this one."""
        return tuple(line for section in self.sections for line in (*section.lines, *section.below))


def rule_line(rule: Rule, evidence: Evidence) -> RuleLine:
    """A rule with how it fared."""
    return RuleLine(
        rule.id,
        rule.id.split("/")[1],
        rule.name,
        rule.says,
        str(rule.cite),
        rule.code or "",
        str(rule.assumes) if rule.assumes else "",
        evidence.standing(rule),
        evidence.exercised.get(rule.id, 0),
        evidence.rare.get(rule.id, ""),
    )


def document_map(spec: Spec, evidence: Evidence) -> tuple[Section, ...]:
    """The outline of the document that a system models, in the order of its written specification."""
    text = specification_page(spec.system)
    waived = _waived(text)
    placed: list[tuple[tuple[str, ...], ClauseLine]] = [
        (tuple(clause.place.split(_SEPARATOR)), _clause_line(spec, clause, evidence, waived))
        for clause in clauses(text)
    ]
    named_by = citing(text, spec)
    for rule in spec.all_rules:
        if not named_by[rule.id]:
            line = rule_line(rule, evidence)
            place = (rule.cite.document, *rule.cite.headings)
            placed.append(
                (place, ClauseLine("", rule.says, line.standing, (line,), _questions(spec, (rule,), evidence)))
            )
    return _sections(placed, 0)


def _waived(text: str) -> Mapping[str, str]:
    part = _WAIVED_PART.search(text)
    rows = (_WAIVED.match(line) for line in part[1].splitlines()) if part else ()
    return {row[1]: row[2] for row in rows if row}


def _clause_line(spec: Spec, clause: Clause, evidence: Evidence, waived: Mapping[str, str]) -> ClauseLine:
    ids = dict.fromkeys(rule for pattern in clause.rules for rule in named(pattern, spec))
    rules = tuple(spec.rules_by_id[one] for one in ids)
    lines = tuple(rule_line(rule, evidence) for rule in rules)
    says, reason = _words(clause.text)
    questions = tuple(_question(one, evidence) for one in spec.ambiguities if base(one.id) in clause.entries)
    parts = tuple((part, why) for part, why in waived.items() if base(part) in clause.entries)
    return ClauseLine(clause.number, says, _standing(lines, questions), lines, questions, reason, parts)


def _words(text: str) -> tuple[str, str]:
    """What a clause says, and why no rule checks it; where its rules and entries stand is told otherwise."""
    says, *tails = _TAILS.split(text)
    reasons = dict(zip(tails[::2], tails[1::2], strict=True))
    return says.strip(), reasons.get("Not a rule:", "").strip()


def _questions(spec: Spec, rules: Iterable[Rule], evidence: Evidence) -> tuple[Question, ...]:
    concerned = {rule.assumes.ambiguity.id for rule in rules if rule.assumes}
    return tuple(_question(one, evidence) for one in spec.ambiguities if one.id in concerned)


def _question(ambiguity: Ambiguity, evidence: Evidence) -> Question:
    return Question(ambiguity.id, ambiguity.question, evidence.readings.get(ambiguity.id, ()))


def _standing(rules: tuple[RuleLine, ...], questions: tuple[Question, ...]) -> Standing:
    found = {rule.standing for rule in rules}
    if not found:
        return Standing.WAIVED
    if Standing.EXERCISED in found and any(one.undecided for one in questions):
        found.add(Standing.AMBIGUOUS)
    return next(one for one in Standing if one in found)


def _sections(placed: Sequence[tuple[tuple[str, ...], ClauseLine]], depth: int) -> tuple[Section, ...]:
    below: dict[str, list[tuple[tuple[str, ...], ClauseLine]]] = {}
    for place, line in placed:
        below.setdefault(place[depth], []).append((place, line))
    return tuple(
        Section(
            heading,
            tuple(line for place, line in some if len(place) == depth + 1),
            _sections([one for one in some if len(one[0]) > depth + 1], depth + 1),
        )
        for heading, some in below.items()
    )
