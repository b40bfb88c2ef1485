"""The written specifications: their clauses, the rules and the readings of the program are about the same things.

``python tests/test_specs.py`` writes the computed parts of every page anew.
"""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from attrs import frozen

from missionfsm.kernel.system import System
from missionfsm.oracle import transcript
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
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
    Page("bear-mission.md", "bear.mission", "missionfsm.bear.mission.readings", "AM", 64),
    Page("bear-status.md", "bear.status", "missionfsm.bear.status.readings", "AS", 35),
    Page("isaac-server.md", "isaac.server", "missionfsm.isaac.server.readings", "AI", 39),
    Page("isaac-robot.md", "isaac.robot", "missionfsm.isaac.robot.readings", "AI", 39),
)
"""The pages that there are to be; those that are written are looked at."""

LEADING = {"isaac-missions.md"}
"""Pages without clauses, to be read first."""

PAGES = [pytest.param(page, id=page.name) for page in HOUSE if (SPECS / page.name).exists()]
pages = pytest.mark.parametrize("page", PAGES)


def test_every_page_is_looked_at() -> None:
    """No page stands in specs/ without being held to its program, unless it only leads to others."""
    assert {path.name for path in SPECS.glob("*.md")} <= {page.name for page in HOUSE} | LEADING


def test_pages_that_lead_to_others_lead_somewhere() -> None:
    """Whatever such a page links to is there."""
    for name in LEADING:
        links = re.findall(r"\]\(([^)#]+)", (SPECS / name).read_text(encoding="utf-8"))
        assert links
        assert [link for link in links if not (SPECS / link).exists()] == []


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
        if rule.assumes and not any(base(rule.assumes.ambiguity.id) in clause.entries for clause in by_clause[rule.id])
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
    assert verdict.readings["AM-17.last.base-navigate"] == ("a", "d")
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


# What the page says of entries without an ambiguity, tried out. One letter is one mission; a message is written as the
# states of the listed missions, `r` running, `p` paused, `w` waiting, `s` succeeded, and current_mission_index.

STATES = {"r": "STATE_RUNNING", "p": "STATE_PAUSED", "w": "STATE_DEFAULT", "s": "STATE_SUCCEEDED"}
GO = {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}
CREATE, BATCH = ("CreateMission", {"mission": GO}), ("CreateMissionBatch", {"missions": [{"mission": GO}] * 2})
APPEND, SKIP, CLEAR = ("AppendMission", {"mission": GO}), ("SkipGoal", {}), ("ClearMissionStatus", {})
PAUSE = ("UpdateMission", {"missionCommand": {"missionId": "A", "command": "COMMAND_PAUSE"}})
TWICE = ("CreateMission", {"mission": {**GO, "serviMission": {"deliveryMission": {"goals": [{}]}}}})
BARE = ("CreateMissionBatch", {"missions": [GO]})
REACHED, BLOCKED = {"drive": {"event": "goalReached"}}, {"drive": {"event": "world", "blocked": True}}
END, CLEAN = {"stream": 1, "closed": True, "error": {"status": "INTERNAL"}}, {"stream": 1, "closed": True}
SETTLED = {"settled": True}
MADE = (CREATE, "A", "r0")
"""One mission was created, and a subscriber has seen it run."""


def history(*steps: Any) -> list[Any]:
    """A history of calls (each followed by its ids or its status), messages and other lines."""
    lines: list[Any] = [
        {"call": 0, "method": "SubscribeMissionStatus", "params": {}},
        {"return": 0, "result": {"stream": 1}},
    ]
    answers = iter(enumerate(("-1", *steps), 1))
    for number, step in answers:
        if isinstance(step, dict):
            lines.append({"stream": 1, "message": shown("r0", number, **step["with"])} if "with" in step else step)
        elif isinstance(step, tuple):
            lines.append({"call": number, "method": step[0], "params": step[1]})
            ids = next(answers)[1]
            result = {"missionIds": list(ids)} if step[0].endswith(("Batch", "Status")) else {"missionId": ids}
            refused = {"error": {"status": ids}}
            lines.append({"return": number, **(refused if len(ids) > 3 else {"result": result})})
        else:
            lines.append({"stream": 1, "message": shown(step, number)})
    return [*lines, SETTLED]


def shown(message: str, number: int, **changed: Any) -> Any:
    """A status message; what is `changed` is so in its first mission."""
    letters, index = re.fullmatch(r"([a-z]*)(-?\d)", message).groups()  # type: ignore[union-attr]
    missions = [
        {
            "missionId": "ABCDEF"[place],
            "state": STATES[letter],
            "goals": [{"destinationId": "table-1"}],
            "missionType": {"baseType": 1},
            **(changed if place == 0 else {}),
        }
        for place, letter in enumerate(letters)
    ]
    states = {"missions": missions, "currentMissionIndex": int(index)}
    return {"metadata": {"sequenceNumber": number}, "missionStates": states}


@pytest.mark.parametrize(
    ("entry", "steps", "conforms"),
    [
        ("AM-05", (*MADE, REACHED, "s-1", CREATE, "B", "sr1"), True),
        ("AM-15", (CREATE, "A", {"with": {"currentGoalIndex": 1}}), False),
        pytest.param("AM-20", (CREATE, "DEADLINE_EXCEEDED", "r0"), True),
        pytest.param("AM-20", (CREATE, "DEADLINE_EXCEEDED", CREATE, "A", "r0"), True),
        pytest.param("AM-20", (CREATE, "DEADLINE_EXCEEDED", SETTLED, "r0"), True),
        ("AM-20", (CREATE, "DEADLINE_EXCEEDED", "r0", SETTLED, "-1"), False),
        pytest.param("AM-21", (*MADE, CREATE, "INTERNAL"), True),
        ("AM-21", (CREATE, "INTERNAL", "r0"), False),
        pytest.param("AM-22", (*MADE, APPEND, "DEADLINE_EXCEEDED", "rw0", APPEND, "C", "rww0"), True),
        ("AM-22", (*MADE, APPEND, "DEADLINE_EXCEEDED", "rw0", APPEND, "C", "rww0", "rwww0"), False),
        pytest.param("AM-23", (BATCH, "DEADLINE_EXCEEDED", "rw0"), True),
        ("AM-23", (BATCH, "DEADLINE_EXCEEDED", "r0"), False),
        pytest.param("AM-24", (*MADE, SKIP, "INTERNAL", "s-1"), True),
        ("AM-24", (*MADE, PAUSE, "INTERNAL", "p0"), False),
        ("AM-24", (*MADE, REACHED, "s-1", CLEAR, "INTERNAL", "-1"), False),
        ("AM-32", (CREATE, "A"), False),
        ("AM-48", (CREATE, "A", {"with": {"goals": [{"destinationId": "table-1"}] * 2}}), False),
        ("AM-49", (CREATE, "A", {"with": {"state": 2, "current_goal_index": "0"}}), True),
        ("AM-52", ("r0",), False),
        ("AM-52", (CREATE, "A", {"with": {"owner": "anybody"}}), True),
        ("AM-55", (TWICE, "INVALID_ARGUMENT", BARE, "INVALID_ARGUMENT"), True),
        ("AM-55", (BARE, "A", "r0"), False),
        ("AM-59", (*MADE, REACHED, "s-1", SETTLED, "-1"), False),
        ("AM-60", (*MADE, APPEND, "B", "rw0", REACHED, "sw-1"), False),
        ("AM-60", (*MADE, APPEND, "B", "rw0", BLOCKED, REACHED, "sw-1"), True),
        ("AM-61", (END,), True),
        ("AM-61", (CLEAN,), False),
        ("AM-62", (CREATE, "A", {"with": {"state": "STATE_CANCELLED"}}), False),
    ],
)
def test_what_is_waived_is_treated_as_the_page_says(entry: str, steps: tuple[Any, ...], *, conforms: bool) -> None:
    """Entries without an ambiguity are decided, and the oracle decides them as the page says."""
    mission = system("bear.mission")
    head = transcript.Head("bear.mission", {}, ("goalReached", "missionFailed", "missionSucceeded", "world"))
    assert f"### {entry} " in (SPECS / "bear-mission.md").read_text(encoding="utf-8")
    verdict = check(mission, head, history(*steps))
    assert verdict.conforms == conforms, verdict


def rewrite() -> None:
    """Write the computed parts of every page anew."""
    for page in HOUSE:
        path = SPECS / page.name
        if path.exists():
            path.write_text(regenerate(page.text, page.system, page.waived), encoding="utf-8")


if __name__ == "__main__":
    rewrite()
