"""What was judged, as a page: verdicts with their stories, the rules that were exercised, the map of the document."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Sequence

from attrs import frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.middle import MIDDLE
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.system import System
from missionfsm.kernel.transport import over_transport
from missionfsm.pages.outline import (
    MEANINGS,
    Evidence,
    RuleLine,
    Section,
    Standing,
    document_map,
    rule_line,
)
from missionfsm.pages.render import rendered
from missionfsm.pages.sequence import SHOWN, Row, rows
from missionfsm.tools.check.experiment import Experiment
from missionfsm.tools.check.narrate import as_pytest
from missionfsm.tools.check.verdict import Outcome, Side, Verdict

_NUMBER = re.compile(r"\d+")
_GRAVITY = (Outcome.VIOLATES, Outcome.INCONCLUSIVE, Outcome.CONFORMS)
_REACHED = (Standing.VIOLATED, Standing.AMBIGUOUS, Standing.EXERCISED)


@frozen
class LabelledVerdict:
    """A verdict, and what it is about: the file that was read, the robot in it."""

    verdict: Verdict
    file: str = ""
    robot: str = ""

    @property
    def about(self) -> str:
        """What was judged, in a few words."""
        return " ".join(filter(None, (self.file, self.robot))) or self.verdict.implementation or self.verdict.system


@frozen
class Answer:
    """One reading of an ambiguity.

    Attributes:
        letter: its letter.
        says: what it says.
        possible: whether the observations fit it.
        ruled_out_by: the event that does not fit it, in words, if one is known.
    """

    letter: str
    says: str
    possible: bool
    default: bool
    departs: bool
    ruled_out_by: str


@frozen
class Asked:
    """An ambiguity that mattered, and what would tell the readings apart that are left of it."""

    id: str
    question: str
    answers: tuple[Answer, ...]
    experiments: tuple[Experiment, ...]

    @property
    def decided(self) -> bool:
        """Whether one reading is left."""
        return sum(one.possible for one in self.answers) == 1


@frozen
class Topic:
    """The rules of an operation or of another topic, with how they fared."""

    name: str
    rules: tuple[RuleLine, ...]

    @property
    def reached(self) -> int:
        """How many were put to the test."""
        return sum(rule.standing in _REACHED for rule in self.rules)

    @property
    def applicable(self) -> int:
        """How many belong to a reading that may be followed."""
        return sum(rule.standing is not Standing.OTHERWISE for rule in self.rules)

    @property
    def violated(self) -> int:
        """How many are broken."""
        return sum(rule.standing is Standing.VIOLATED for rule in self.rules)


@frozen
class Conversation:
    """One of several conversations that contradict one another.

    Attributes:
        says: what it shows.
        alike: the rows that all of them begin with; `apart`: those from where they part.
    """

    says: str
    alike: tuple[Row, ...]
    apart: tuple[Row, ...]


@frozen
class Story:
    """A verdict as the page tells it.

    Attributes:
        sides: the conversations that contradict one another, if the violation is that.
        earlier: the rows that are folded away.
        history: the history as text, to be copied; `test`: as a pytest module.
    """

    judged: LabelledVerdict
    earlier: tuple[Row, ...]
    rows: tuple[Row, ...]
    asked: tuple[Asked, ...]
    history: str
    test: str
    sides: tuple[Conversation, ...] = ()


@frozen
class Chapter:
    """The part of a page about one system."""

    spec: Spec
    topics: tuple[Topic, ...]
    outline: tuple[Section, ...]

    @property
    def reached(self) -> int:
        """How many rules were put to the test."""
        return sum(topic.reached for topic in self.topics)

    @property
    def applicable(self) -> int:
        """How many rules belong to a reading that may be followed."""
        return sum(topic.applicable for topic in self.topics)

    @property
    def violated(self) -> int:
        """How many are broken."""
        return sum(topic.violated for topic in self.topics)


def report(judged: Sequence[LabelledVerdict], system: Callable[[str], System], made: str = "") -> str:
    """The page on some verdicts, the gravest first.

    Args:
        system: a system's name to the system.
        made: when, by which version and by which command the page is made.
    """
    judged = sorted(judged, key=lambda one: _GRAVITY.index(one.verdict.outcome))
    by_system: dict[str, list[LabelledVerdict]] = {}
    for one in judged:
        by_system.setdefault(one.verdict.system, []).append(one)
    chapters = [_chapter(system(name), some) for name, some in by_system.items()]
    outcomes = [one.verdict.outcome for one in judged]
    return rendered(
        "report.html",
        outcome=next(one for one in _GRAVITY if one in outcomes),
        stories=[_story(system(one.verdict.system), one) for one in judged],
        counts={one: outcomes.count(one) for one in Outcome},
        chapters=chapters,
        meanings=MEANINGS,
        Standing=Standing,
        made=made,
    )


def _story(system: System, judged: LabelledVerdict) -> Story:
    violation = judged.verdict.violation
    history = violation.history if violation else ()
    # One that follows no single reading is wrong in no one place.
    lines = rows(system, history, violation=bool(violation and violation.at))
    return Story(
        judged,
        lines[:-SHOWN],
        lines[-SHOWN:],
        readings_asked(system.spec, judged.verdict),
        "".join(f"{_line(line)}\n" for line in history),
        as_pytest(history, "the_recorded_conversation_is_explained") if history else "",
        _parted(system, violation.sides) if violation else (),
    )


def _parted(system: System, sides: Sequence[Side]) -> tuple[Conversation, ...]:
    """Conversations with what they begin with alike; names that somebody chose do not count."""
    by_look: dict[tuple[tuple[str, str], ...], tuple[list[str], tuple[Row, ...]]] = {}
    for side in sides:
        lines = rows(system, side.history, violation=False)
        look = tuple((row.kind, _NUMBER.sub("0", row.words)) for row in lines)
        by_look.setdefault(look, ([], lines))[0].append(side.says)
    alike = 0
    while all(alike < len(look) - 1 for look in by_look) and len({look[alike] for look in by_look}) == 1:
        alike += 1
    return tuple(Conversation("; ".join(says), lines[:alike], lines[alike:]) for says, lines in by_look.values())


def _line(line: JSON) -> str:
    return json.dumps(line, ensure_ascii=False, separators=(",", ":"))


def readings_asked(spec: Spec, verdict: Verdict) -> tuple[Asked, ...]:
    """The ambiguities that mattered in a verdict, each with all its readings.

    Those of a system as its transport and its log may show it are among them.
    """
    every = {one.id: one for one in (*over_transport(spec).ambiguities, *MIDDLE)}
    return tuple(
        Asked(
            ambiguity.id,
            ambiguity.question,
            tuple(
                Answer(
                    letter,
                    says,
                    letter in verdict.readings[ambiguity.id],
                    letter == ambiguity.default,
                    letter in ambiguity.flagged,
                    verdict.ruled_out.get(ambiguity.id, {}).get(letter, ""),
                )
                for letter, says in ambiguity.readings.items()
            ),
            tuple(one for one in verdict.experiments if one.ambiguity == ambiguity.id),
        )
        for ambiguity in every.values()
        if ambiguity.id in verdict.readings
    )


def _chapter(system: System, judged: Iterable[LabelledVerdict]) -> Chapter:
    evidence = Evidence.of(one.verdict for one in judged)
    lines = (rule_line(rule, evidence) for rule in system.spec.all_rules)
    return Chapter(system.spec, topics(lines), document_map(system.spec, evidence))


def topics(lines: Iterable[RuleLine]) -> tuple[Topic, ...]:
    """Rules by operation or topic, in the order in which they are declared."""
    ordered: dict[str, list[RuleLine]] = {}
    for line in lines:
        ordered.setdefault(line.operation, []).append(line)
    return tuple(Topic(name, tuple(some)) for name, some in ordered.items())
