"""Pages as texts: they follow from what they show, whole, and from nothing else."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from attrs import evolve

from missionfsm import systems
from missionfsm.app.recorded import check_file
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.readings import UNCONSTRAINED, constrain
from missionfsm.oracle.transcript import head
from missionfsm.pages.graph import BEYOND, HERE, Graph
from missionfsm.pages.outline import ClauseLine, Evidence, Section, Standing, document_map
from missionfsm.pages.render import prose, specification_page
from missionfsm.pages.report import LabelledVerdict, report
from missionfsm.pages.teeth import teeth_page
from missionfsm.tools.check.experiment import Experiment
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.explore.explore import explore
from missionfsm.tools.mutate.teeth import MutantResult, MutationReport
from missionfsm.tools.specpages import clauses

HEAD = {
    "missionfsm": 1,
    "system": "bear.mission",
    "world": {},
    "drives": ["goalReached", "missionFailed", "missionSucceeded"],
}
NAVIGATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
TWICE = (
    {"call": 1, "method": "CreateMission", "params": NAVIGATE},
    {"return": 1, "result": {"missionId": "m"}},
    {"call": 2, "method": "CreateMission", "params": NAVIGATE},
    {"return": 2, "error": {"status": "FAILED_PRECONDITION"}},
)
ACTIVE = "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued"

HASHED = """
import hashlib, sys
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.readings import UNCONSTRAINED
from missionfsm.pages.explorer import explorer_page
from missionfsm.systems import names, system
from missionfsm.tools.explore.explore import explore
for name in names():
    explored = explore(system(name), Bounds(0 if name == "isaac.server" else 1, goals=1, batch=1))
    page = explorer_page(system(name), explored, UNCONSTRAINED)
    print(name, hashlib.sha256(page.encode()).hexdigest())
"""


def _verdict(*lines: object) -> Verdict:
    return check(systems.system("bear.mission"), head(HEAD), lines)


def _lines(sections: tuple[Section, ...]) -> Iterator[tuple[str, ClauseLine]]:
    for section in sections:
        yield from ((section.heading, line) for line in section.lines)
        yield from _lines(section.sections)


@pytest.mark.long
def test_pages_are_the_same_under_any_hash_seed() -> None:
    """The explorer of every system is the same text whatever the hash seed is."""
    found = set()
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        command = [sys.executable, "-c", HASHED]
        ended = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        found.add(ended.stdout)
    assert len(found) == 1
    assert len(found.pop().splitlines()) == len(systems.names())


@pytest.mark.parametrize("name", systems.names())
def test_the_map_is_whole(name: str) -> None:
    """Every rule of a system is on its map, under a clause of the specification, and nothing is judged yet."""
    spec = systems.system(name).spec
    lines = [line for _, line in _lines(document_map(spec, Evidence()))]
    assert {rule.id for line in lines for rule in line.rules} == {rule.id for rule in spec.all_rules}
    assert {line.standing for line in lines} <= {Standing.NOT_REACHED, Standing.WAIVED}
    assert [line.number for line in lines if (line.standing is Standing.WAIVED) == bool(line.rules)] == []
    assert [line.number for line in lines if line.standing is Standing.WAIVED and not line.reason] == []
    tails = ("*Checked by*", "*Open:*", "*Not a rule:*")
    assert [line.number for line in lines if any(tail in line.text + line.reason for tail in tails)] == []


def test_the_map_is_coloured_by_what_was_seen() -> None:
    """A rule is exercised once it was, ambiguous while several readings fit, and violated once it is broken."""
    spec = systems.system("bear.mission").spec
    rule = spec.rules_by_id[ACTIVE]
    assert Evidence.of([_verdict(*TWICE[:2])]).standing(rule) is Standing.NOT_REACHED
    assert Evidence.of([_verdict(*TWICE)]).standing(rule) is Standing.EXERCISED
    broken = _verdict(*TWICE[:3], {"return": 2, "result": {"missionId": "n"}})
    assert Evidence.of([broken]).standing(rule) is Standing.VIOLATED
    assert Evidence.of([_verdict(*TWICE), broken]).standing(rule) is Standing.VIOLATED
    told = _lines(document_map(spec, Evidence.of([broken])))
    assert {line.number for _, line in told if line.standing is Standing.VIOLATED} == {
        clause.number
        for clause in clauses(specification_page("bear.mission"))
        if f"`{ACTIVE.partition('/')[2]}`" in clause.text
    }


def test_readings_decide_what_is_read_otherwise() -> None:
    """A rule of a reading that was ruled out is read otherwise; one of a reading that is still possible is not."""
    spec = systems.system("bear.mission").spec
    rule = next(one for one in spec.all_rules if one.assumes is not None and len(one.assumes.ambiguity.readings) > 1)
    assert rule.assumes is not None
    question = rule.assumes.ambiguity
    others = tuple(letter for letter in question.readings if letter not in rule.assumes.letters)
    assert Evidence(readings={question.id: others}).standing(rule) is Standing.OTHERWISE
    every = {question.id: tuple(question.readings)}
    assert Evidence(readings=every).standing(rule) is Standing.NOT_REACHED
    assert Evidence({rule.id: 1}, readings=every).standing(rule) is Standing.AMBIGUOUS


def test_a_page_fetches_nothing() -> None:
    """There is no address in a page, and a browser is told to fetch nothing whatever it finds."""
    page = report([LabelledVerdict(_verdict(*TWICE))], systems.system)
    assert re.findall(r"(?:https?:|//)[a-z]", page) == []
    assert "default-src 'none'" in page
    assert page == report([LabelledVerdict(_verdict(*TWICE))], systems.system)


def test_only_a_single_event_is_marked_as_wrong() -> None:
    """Where no one event is wrong (two readings are followed in turn), none is marked."""
    broken = _verdict(*TWICE[:3], {"return": 2, "result": {"missionId": "n"}})
    assert broken.violation is not None
    nowhere = evolve(broken, violation=evolve(broken.violation, at=0))
    marked = [
        report([LabelledVerdict(one)], systems.system).count('class="row answers wrong"') for one in (broken, nowhere)
    ]
    assert marked == [1, 0]


def test_everything_that_a_verdict_carries_is_told() -> None:
    """Events that ruled readings out, experiments, expected violations, rare rules and notes are on the page."""
    verdict = evolve(
        _verdict(*TWICE),
        readings={"AM-09": ("a", "b"), "AM-16": ("a",)},
        ruled_out={"AM-16": {"b": "SkipGoal() was answered OK"}},
        experiments=(Experiment("AM-09", "a", ("b",), "first this\nthen <that>"),),
        known={ACTIVE: 3},
        stale=("bear.mission/lifecycle/fail",),
        rare={"bear.mission/lifecycle/start": "it needs a rare state"},
        notes=("the time ran out",),
    )
    page = report([LabelledVerdict(verdict)], systems.system)
    for said in (
        "ruled out by: SkipGoal() was answered OK",
        "a, and not b, would show in",
        "then &lt;that&gt;",
        "Known violation, met 3 times",
        "was expected and was not met",
        "seldom: it needs a rare state",
        "the time ran out",
    ):
        assert said in page
    assert page.count(">still open<") == 1
    assert page.count(">followed<") == 1


def test_a_history_without_its_beginning_is_told() -> None:
    """Of a long history only the end is kept; an answer whose call is gone is shown as it stands."""
    pairs = [
        line
        for number in range(300)
        for line in (
            {"call": number, "method": "SkipGoal", "params": {}},
            {"return": number, "error": {"status": "FAILED_PRECONDITION"}},
        )
    ]
    wrong = ({"call": 300, "method": "SkipGoal", "params": {}}, {"return": 300, "error": {"status": "NOT_FOUND"}})
    page = report([LabelledVerdict(_verdict(*pairs, *wrong), "long.jsonl")], systems.system)
    assert "lines before" in page
    assert page.count('class="row answers wrong"') == 1


@pytest.mark.parametrize("name", systems.names())
def test_every_number_in_a_graph_means_something(name: str) -> None:
    """What a state refers to is there: doings, effects, states, parts of messages, rules and assumptions."""
    graph = Graph(
        systems.system(name), Bounds(0 if name == "isaac.server" else 1, goals=1, batch=1), UNCONSTRAINED
    ).data()
    states = graph["states"]
    assert states
    for _, seen, flat in states:
        assert len(seen) == len(graph["views"])
        assert all(one is None or one < len(graph["parts"]) for one in seen)
        for doing, effect, to in zip(flat[::3], flat[1::3], flat[2::3], strict=True):
            assert doing < len(graph["doings"])
            assert effect < len(graph["effects"])
            assert to in (BEYOND, HERE) or 0 <= to < len(states)
    for _, _, _, _, _, _, rules, assumes, *_ in graph["effects"]:
        assert all(rule < len(graph["rules"]) for rule in rules)
        assert assumes < len(graph["assumes"])


def test_a_demanded_reading_leaves_no_other() -> None:
    """Where a reading is demanded, no answer of the graph assumes another of that ambiguity."""
    explored = systems.system("bear.mission")
    free = Graph(explored, Bounds(1, goals=1, batch=1), UNCONSTRAINED).data()
    bound = Graph(
        explored, Bounds(1, goals=1, batch=1), constrain(explored.spec.ambiguities, {"AM-02.unknown": "a"})
    ).data()
    asked = [letters for some in free["assumes"] for name, letters in some if name == "AM-02.unknown.idle"]
    left = [letters for some in bound["assumes"] for name, letters in some if name == "AM-02.unknown.idle"]
    assert any("a" not in letters for letters in asked)
    assert all("a" in letters for letters in left)
    assert len(bound["effects"]) < len(free["effects"])


def test_survivors_are_told_apart() -> None:
    """A survivor that is excused shows why, one that is not is missed, and a rule that nothing broke is untested."""
    robot = systems.system("isaac.robot")
    first, second, third, *_ = (rule.id for rule in robot.spec.all_rules)
    results = (
        MutantResult(f"{first} is dropped", first, killed=True, length=4),
        MutantResult(f"{first} has no effect", first, killed=False, because="which <AI-01> allows"),
        MutantResult(f"{second} is dropped", second, killed=False),
    )
    page = teeth_page(robot, MutationReport("isaac.robot", results, (third,)))
    marks = re.findall(r'<li><span class="mark (\w+)">(\w+)</span>', page)
    assert marks == [
        ("exercised", "noticed"),
        ("otherwise", "allowed"),
        ("violated", "missed"),
        ("violated", "untested"),
    ]
    assert "which &lt;AI-01&gt; allows" in page
    assert ">50 %<" in page


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("plain", "plain"),
        ("a `b` c", "a <code>b</code> c"),
        ("`<i>`", "<code>&lt;i&gt;</code>"),
        ("a ` b <", "a ` b &lt;"),
    ],
)
def test_prose(text: str, told: str) -> None:
    """What stands between backticks is code, between asterisks emphasis; nothing else is markup."""
    assert prose(text) == told


@pytest.mark.parametrize("name", ["isaac.robot", "bear.mission"])
def test_a_page_counts_as_the_explorer_does(name: str) -> None:
    """The states that a page holds, and those of its shapes, are as many as an exploration finds."""
    one = systems.system(name)
    found = explore(one, Bounds(1, goals=1, batch=1))
    graph = Graph(one, found.bounds, UNCONSTRAINED).data()
    assert (graph["held"], sum(graph["shapes"].values())) == (found.states, found.states)
    assert set(graph["shapes"]) == {words for words, _, _ in graph["states"]}


def test_a_page_on_bare_messages_calls_nothing_unreached_that_it_looks_at(tmp_path: Path) -> None:
    """Rules that bare messages are held against are not counted, which is not to say that they were not reached."""
    log = tmp_path / "battery"
    log.write_text('{"metadata": {"sequenceNumber": "1"}, "batteryState": {"chargePercent": 50}}\n')
    ((_, verdict),) = check_file(str(log))
    evidence = Evidence.of([verdict])
    rules = {rule.id: rule for rule in systems.system("bear.status").spec.all_rules}
    broken = {rule.id for rule in verdict.violation.rules} if verdict.violation else set()
    assert {evidence.standing(rules[one]) for one in verdict.uncounted - broken} == {Standing.UNCOUNTED}
    others = {evidence.standing(rule) for one, rule in rules.items() if one not in verdict.uncounted | broken}
    assert others == {Standing.NOT_REACHED}
