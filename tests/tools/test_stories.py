"""What was found, as a story: short, judged alike by `check`, and in forms that others can use."""

from __future__ import annotations

import functools
import sys
from pathlib import Path

import orjson
import pytest
from broken import BUSY, EMPTY, MISSION, Fickle, answering
from commandline import CommandLine

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange
from missionfsm.oracle.transcript import head
from missionfsm.pages.report import LabelledVerdict, report
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.narrate import as_mermaid, as_pytest, story
from missionfsm.tools.check.suspects import ineffective_drives, suspects
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.actions import length
from missionfsm.tools.conform.conform import conform, search
from missionfsm.tools.conform.conversation import Conversation
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.shortening import shorten
from missionfsm.tools.conform.shortest import everything
from missionfsm.tools.mutate.mutants import mutants
from missionfsm.tools.reference.subject import ReferenceSubject

HEAD: JSON = {"missionfsm": 1, "system": "bear.mission", "world": {}}


@functools.cache
def found(code: str, *rules: str) -> Verdict:
    """What is found first of such an implementation, with a seed by which it is wrong within one conversation."""
    return conform(MISSION, answering(code, *rules), drawn=5, tours=60, steps=20, seed=1, advice=False)


def history(verdict: Verdict) -> tuple[JSON, ...]:
    assert verdict.violation is not None, str(verdict)
    return verdict.violation.history


BROKEN = [("NOT_FOUND", BUSY), ("PERMISSION_DENIED", BUSY), ("FAILED_PRECONDITION", EMPTY), ("INTERNAL", EMPTY)]


@pytest.mark.slow
@pytest.mark.parametrize(("code", "rule"), BROKEN)
def test_the_history_of_a_story_is_judged_alike(code: str, rule: str) -> None:
    """`check` finds the same violation in it, at its last line."""
    verdict = found(code, rule)
    first, *lines = history(verdict)
    again = check(MISSION, head(first), lines)
    assert again.violation is not None
    assert (again.violation.observed, again.violation.rules) == (
        verdict.violation and verdict.violation.observed,
        verdict.violation and verdict.violation.rules,
    )
    assert check(MISSION, head(first), lines[:-1]).violation is None


@pytest.mark.parametrize(("code", "rule"), BROKEN)
def test_nothing_can_be_left_out_of_a_story(code: str, rule: str) -> None:
    """Without any one of the calls or drives in it the implementation, asked again, does nothing wrong any more."""
    first, *lines = history(found(code, rule))
    done = [line for line in lines if "call" in line or "drive" in line or "settled" in line]
    for left_out in done:
        assert _had(first, [one for one in done if one is not left_out], answering(code, rule)).violation is None
    assert _had(first, done, answering(code, rule)).violation is not None


HARMED = (
    "SubscribeMissionStatus/INVALID_ARGUMENT/a-field-is-unknown is answered FAILED_PRECONDITION",
    "UpdateMission/FAILED_PRECONDITION/a-paused-mission-cannot-be-finished holds always",
    "SubscribeMissionStatus/the-goals-are-those-requested reverses the goals",
    "lifecycle/fail is not shown",
)


@pytest.mark.long
def test_no_story_is_longer_than_the_shortest() -> None:
    """Whatever is broken, a rule, a move, a message, an effect: no shorter conversation of anything shows anything."""
    told = []
    named = {mutant.name.removeprefix("bear.mission/"): mutant for mutant in mutants(MISSION)}
    for mutant in (named[name] for name in HARMED):
        run = Run.against(MISSION, mutant.subject(MISSION))
        search(run, Plan(20, 60, 80, 20), 1)
        shorten(run)
        assert run.found is not None, mutant.name
        told.append(length(run.found.actions))
        assert _shortest(run, run.found, told[-1] - 1) is None, mutant.name
        if told[-1] < 3:
            assert _shortest(run, run.found, told[-1]) is not None, mutant.name
    assert told == [1, 2, 2, 3]


def test_a_story_asks_for_nothing_that_has_no_part_in_it() -> None:
    """What is wrong with a request all the same is told by it without its other members."""
    busy = "bear.mission/CreateMissionWorkflow/FAILED_PRECONDITION/another-mission-is-active"
    workflow = {"serviWorkflow": {"hosting": {"goals": [{"destinationId": "table-1"}]}}}
    run = Run.against(MISSION, answering("PERMISSION_DENIED", busy))
    run.start({})
    assert run.do("CreateMissionWorkflow", {"missionWorkflow": workflow})
    assert not run.do("CreateMissionWorkflow", {"missionWorkflow": workflow, "urgency": "high"})
    shorten(run)
    assert run.found is not None
    assert run.found.actions[-1].params == {"missionWorkflow": workflow}


def _shortest(run: Run, found: Conversation, depth: int) -> Conversation | None:
    """The shortest that is found by having all conversations in the same world, whatever they are of."""
    alphabet = run.system.alphabet(found.world, run.bounds)
    return everything(functools.partial(run.replay, found.world), alphabet, depth)


def _had(first: JSON, done: list[JSON], subject: object) -> Verdict:
    """The verdict on a conversation in which these things are done again, in this order."""
    ask = subject.exchange  # type: ignore[attr-defined]
    ask("initialize", {"protocolVersion": 1, "system": "bear.mission"})
    ask("reset", {"world": first["world"]})
    lines: list[JSON] = []
    for one in done:
        if "call" in one:
            exchange: Exchange = ask(one["method"], one["params"])
            came = {"result": exchange.result} if exchange.error is None else {"error": exchange.error}
            lines += ({**one, "call": len(lines)}, {"return": len(lines), **came})
        elif "drive" in one:
            exchange = ask("drive", one["drive"])
            lines.append(one)
        else:
            exchange = ask("settle", {})
            lines.append(one)
        lines += ({"stream": sent.params["stream"], "message": sent.params["message"]} for sent in exchange.after)
    return check(MISSION, head(first), lines)


def test_a_story_has_a_line_for_each_thing_that_was_done() -> None:
    """Calls and their answers share one."""
    told = story(MISSION, history(found("NOT_FOUND", BUSY))).splitlines()
    assert [line[:4] for line in told] == [f"{number:>3}." for number in range(1, len(told) + 1)]
    assert told[-1].endswith(" → NOT_FOUND")


def test_calls_that_overlap_have_lines_of_their_own() -> None:
    """So that one sees what came between."""
    lines = (
        HEAD,
        {"call": 1, "method": "ClearMissionStatus", "params": {}},
        {"call": 2, "method": "SkipGoal", "params": {}},
        {"return": 2, "error": {"status": "FAILED_PRECONDITION"}},
        {"return": 1, "result": {"missionIds": []}},
        {"settled": True},
    )
    assert [line[5:] for line in story(MISSION, lines).splitlines()] == [
        "ClearMissionStatus()",
        "SkipGoal() → FAILED_PRECONDITION",
        "answered OK",
        "(settled)",
    ]


def test_an_answer_that_was_excused_before_is_suspected() -> None:
    """Where the last excuse dies late, the answer without which everything is explained is named."""
    create = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
    lines: tuple[JSON, ...] = (
        {**HEAD, "drives": ["world", "fault"]},
        {"call": 1, "method": "CreateMission", "params": create},
        {"return": 1, "result": {"missionId": "m1"}},
        {"settled": True},
        {"call": 2, "method": "SkipGoal", "params": {}},
        {"return": 2, "error": {"status": "FAILED_PRECONDITION"}},
        {
            "call": 3,
            "method": "UpdateMission",
            "params": {"missionCommand": {"missionId": "m1", "command": "COMMAND_PAUSE"}},
        },
        {"return": 3, "result": {}},
    )
    readings = {one.id: one.default for one in MISSION.spec.ambiguities}
    assert check(MISSION, head(lines[0]), lines[1:-2], readings=readings).violation is None
    assert check(MISSION, head(lines[0]), lines[1:], readings=readings).violation is not None
    assert [one.says for one in suspects(MISSION, lines, readings)][-1:] == [
        "SkipGoal() was answered FAILED_PRECONDITION"
    ]


def test_what_comes_again_and_again_is_one_line() -> None:
    """A message that comes five times is told once, with how often; a long one is cut in its middle."""
    said = {"stream": 1, "message": {"missionStates": {"missions": []}}}
    told = story(MISSION, (HEAD, {"settled": True}, said, said, said, {"settled": True})).splitlines()
    assert [line.partition(". ")[2] for line in told] == ["(settled)", f"{told[1].partition('. ')[2]}", "(settled)"]
    assert told[1].endswith(", 3 times")
    long = {"call": 1, "method": "CreateMission", "params": {"mission": {"baseMission": {"x" * 900: 1}}}}
    (line,) = story(MISSION, (HEAD, long)).splitlines()
    assert len(line) < 350


def test_what_had_no_effect_is_told() -> None:
    """A codelet that never runs the mission that arrives is right but for that: the line had no effect."""
    robot = system("isaac.robot")
    broken = next(one for one in mutants(robot) if one.name.endswith("a-mission-starts-the-behavior-tree is not run"))
    verdict = conform(robot, broken.subject(robot), drawn=2, tours=8, steps=20, seed=1, advice=False)
    found = ineffective_drives(robot, history(verdict))
    assert [(one.says, one.rules) for one in found] == [("a mission arrives on mission", (broken.rule,))]
    assert verdict.violation is not None
    assert [one.id for one in verdict.violation.rules][-1:] == [broken.rule]


def test_the_pytest_function_fails_for_what_was_found(tmp_path: Path) -> None:
    """It judges the same history; that of the right reference passes."""
    wrong = history(found("NOT_FOUND", BUSY))
    first, *lines = wrong
    done = [line for line in lines if "call" in line or "drive" in line or "settled" in line]
    subject = ReferenceSubject(MISSION, {})
    right = [first]
    subject.exchange("reset", {"world": first["world"]})
    for line in done:
        assert "call" in line, "this story has calls alone"
        exchange = subject.exchange(line["method"], line["params"])
        right += (line, {"return": line["call"], "error": exchange.error})
        if exchange.error is None:
            right[-1] = {"return": line["call"], "result": exchange.result}
    for lines_of, passes in ((wrong, False), (tuple(right), True)):
        text = as_pytest(lines_of, "robot")
        space: dict[str, object] = {}
        exec(compile(text, str(tmp_path / "test_robot.py"), "exec"), space)  # noqa: S102 - it is made to be run
        function = space["test_robot"]
        assert callable(function)
        try:
            function()
            passed = True
        except AssertionError as error:
            passed = False
            assert "was answered NOT_FOUND" in str(error)  # noqa: PT017 - that it fails is looked at below
        assert passed == passes


def test_the_sequence_diagram_has_a_line_for_every_event() -> None:
    """Calls go to the implementation, what it sends comes back, drives and pauses are notes; nothing breaks Mermaid."""
    lines: tuple[JSON, ...] = (
        HEAD,
        {"call": 1, "method": "SubscribeMissionStatus", "params": {}},
        {"return": 1, "result": {"stream": 1}},
        {"drive": {"event": "goalReached"}},
        {"settled": True},
        {"stream": 1, "closed": True},
    )
    drawn = as_mermaid(MISSION, lines).splitlines()
    assert drawn[:3] == ["sequenceDiagram", "    participant C as client", "    participant S as implementation"]
    assert [line.split(":")[0].strip() for line in drawn[3:]] == [
        "C->>S",
        "S-->>C",
        "Note over S",
        "Note over C,S",
        "S-->>C",
    ]
    assert not any(mark in line for line in drawn for mark in ";#")


def test_an_implementation_without_a_single_reading_has_both_events_told() -> None:
    """Every reading of the question is ruled out by an event, and each conversation says once by which."""
    verdict = conform(MISSION, Fickle("AM-36", "ab"), drawn=2, tours=12, steps=20, seed=1, advice=False)
    assert verdict.violation is not None
    assert verdict.violation.notes == ()
    says = [side.says.partition(": ") for side in verdict.violation.sides]
    assert [letter for letter, _, _ in says] == ["not a, c", "not b"]
    assert ["showed []" in event for _, _, event in says] == [False, True]
    page = report([LabelledVerdict(verdict)], system)
    # What both begin with is folded away.
    assert page.count('<div class="side">') == 2
    assert (page.count("2 lines that both begin with"), page.count("Here the conversations part:")) == (1, 1)


@pytest.mark.long
def test_a_violation_is_recorded_in_the_form_that_is_asked_for(tmp_path: Path, command_line: CommandLine) -> None:
    """A history that `check` reads, a pytest function, a sequence diagram: by the name of the file."""
    for name in ("found.jsonl", "test_found.py", "found.mmd"):
        ended = command_line(
            *("conform", "bear.mission", "--seed", 1, "--examples", 40, "--record", tmp_path / name, "--json", "-"),
            *("--", sys.executable, Path(__file__).parent / "wrong_adapter.py"),
        )
        assert (ended.status, orjson.loads(ended.out)["story"][-1].endswith("→ NOT_FOUND")) == (1, True)
    assert command_line("check", tmp_path / "found.jsonl").status == 1
    assert "def test_found() -> None:" in (tmp_path / "test_found.py").read_text()
    assert (tmp_path / "found.mmd").read_text().startswith("sequenceDiagram\n")
