"""The written specifications: their clauses, the rules and the readings of the program are about the same things.

``python tests/test_specs.py`` writes the computed parts of every page anew.
"""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Mapping
from pathlib import Path

import pytest
from attrs import frozen

from missionfsm.kernel import transcript
from missionfsm.kernel.system import System
from missionfsm.systems import system
from missionfsm.tools.check import check
from missionfsm.tools.specpages import base, citing, clauses, entries, named, regenerate

SPECS = Path(__file__).parent.parent / "specs"


@frozen
class Page:
    """A page, the system that it specifies, where its readings are, and the entries that it has to answer for."""

    name: str
    about: str
    readings: str
    letters: str
    last: int

    @property
    def text(self) -> str:
        return (SPECS / self.name).read_text(encoding="utf-8")

    @property
    def system(self) -> System:
        return system(self.about)

    @property
    def waived(self) -> Mapping[str, str]:
        found: Mapping[str, str] = importlib.import_module(self.readings).WAIVED
        return found

    @property
    def range(self) -> list[str]:
        return [f"{self.letters}-{number:02d}" for number in range(1, self.last + 1)]


HOUSE = (
    Page("bear-mission.md", "bear.mission", "missionfsm.bear.mission_readings", "AM", 64),
    Page("bear-status.md", "bear.status", "missionfsm.bear.status_readings", "AS", 35),
    Page("isaac-server.md", "isaac.server", "missionfsm.isaac.server_readings", "AI", 39),
    Page("isaac-robot.md", "isaac.robot", "missionfsm.isaac.robot_readings", "AI", 39),
)
"""The pages that there are to be; those that are written are looked at."""

PAGES = [pytest.param(page, id=page.name) for page in HOUSE if (SPECS / page.name).exists()]
pages = pytest.mark.parametrize("page", PAGES)


def test_every_page_is_looked_at() -> None:
    """No page stands in specs/ without being held to its program."""
    assert {path.name for path in SPECS.glob("*.md")} <= {page.name for page in HOUSE}


@pages
def test_every_rule_is_named_by_a_clause(page: Page) -> None:
    """Every rule is named by some clause, and by one about the very place that the rule cites."""
    spec = page.system.spec
    by_clause = citing(page.text, spec)
    assert [rule for rule, some in by_clause.items() if not some] == []
    rules = spec.rules_by_id
    strays = {
        rule: str(rules[rule].cite)
        for rule, some in by_clause.items()
        if str(rules[rule].cite) not in {clause.place for clause in some}
    }
    assert strays == {}


@pages
def test_every_clause_is_checked_or_says_why_not(page: Page) -> None:
    """Clauses are numbered once and in order; each names rules that exist, or says why it names none."""
    found = clauses(page.text)
    numbers = [int(clause.number.partition("-")[2]) for clause in found]
    assert numbers == list(range(1, len(found) + 1))
    unknown = [(one.number, rule) for one in found for rule in one.rules if not named(rule, page.system.spec)]
    assert unknown == []
    bare = [one.number for one in found if bool(one.rules) == ("*Not a rule:*" in one.text)]
    assert bare == []


@pages
def test_every_number_that_is_mentioned_exists(page: Page) -> None:
    """A clause or an entry that the page refers to is one that it has."""
    known = {clause.number for clause in clauses(page.text)} | set(page.range)
    prefix = next(clause.number for clause in clauses(page.text)).partition("-")[0]
    mentioned = set(re.findall(rf"\b(?:{prefix}-\d+|{page.letters}-\d\d)\b", page.text))
    assert mentioned - known == set()


@pages
def test_every_entry_is_an_ambiguity_or_waived(page: Page) -> None:
    """Every entry of the readings has ambiguities or is waived as a whole, not both, and has a section of its own."""
    ambiguous = {base(one.id) for one in page.system.spec.ambiguities}
    waived = {base(part) for part in page.waived}
    whole = {part for part in page.waived if part == base(part)}
    assert sorted(ambiguous | waived) == page.range
    assert ambiguous & whole == set()
    assert list(entries(page.text)) == page.range


@pages
def test_every_ambiguity_concerns_a_clause(page: Page) -> None:
    """Every entry is named by some clause; every rule under a reading by a clause that names its entry."""
    found = clauses(page.text)
    assert set(page.range) - {entry for clause in found for entry in clause.entries} == set()
    by_clause = citing(page.text, page.system.spec)
    unsaid = [
        rule.id
        for rule in page.system.spec.all_rules
        if rule.under and not any(base(rule.under.of.id) in clause.entries for clause in by_clause[rule.id])
    ]
    assert unsaid == []


@pages
def test_the_computed_parts_are_current(page: Page) -> None:
    """What is computed from the program stands on the page as it would be computed now."""
    assert page.text == regenerate(page.text, page.system, page.waived), "run python tests/test_specs.py"


@pages
def test_lines_are_not_too_long(page: Page) -> None:
    """Text is wrapped; tables and examples are not."""
    long = [line for line in page.text.splitlines() if len(line) > 120 and line[0] not in "|{-"]
    assert long == []


def test_a_part_that_cannot_be_computed_is_refused() -> None:
    """A computed part of an unknown kind, or about nothing, is an error and not an empty place."""
    for part, says in (("poem", "has no computed part 'poem'"), ("rules Dance", "nothing to say in .* rules 'Dance'")):
        with pytest.raises(ValueError, match=says):
            regenerate(f"<!-- generated: {part} -->\n<!-- end -->", system("bear.mission"))


def test_the_worked_example_comes_out_as_it_is_told() -> None:
    """The history on the page conforms and tells the readings that the page says; its changed endings do as well."""
    text = (SPECS / "bear-mission.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```jsonl\n(.*?)```", text, re.DOTALL)
    head, *lines = [json.loads(line) for line in block.splitlines()]
    mission = system("bear.mission")
    verdict = check(mission, transcript.head(head), lines)
    assert verdict.conforms
    assert verdict.readings["AM-09"] == ("a",)
    assert verdict.readings["AM-17.last"] == ("a", "d")
    refused = {"error": {"status": "FAILED_PRECONDITION"}}
    ending = [line if line.get("return") != 5 else {"return": 5, **refused} for line in lines]
    other = check(mission, transcript.head(head), ending)
    assert other.conforms
    assert other.readings["AM-09"] == ("a", "b", "c", "d")
    wrong = [line if line.get("return") != 2 else {"return": 2, "result": {"missionId": "C"}} for line in lines]
    violation = check(mission, transcript.head(head), wrong).violation
    assert violation
    assert [rule.id for rule in violation.rules] == [
        "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued"
    ]


def rewrite() -> None:
    """Write the computed parts of every page anew."""
    for page in HOUSE:
        path = SPECS / page.name
        if path.exists():
            path.write_text(regenerate(page.text, page.system, page.waived), encoding="utf-8")


if __name__ == "__main__":
    rewrite()
