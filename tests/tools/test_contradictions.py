"""Conversations that no single choice of readings explains: all of them are shown, recorded and judged alike."""

from __future__ import annotations

import functools
from pathlib import Path

import orjson
import pytest
from broken import MISSION, Fickle
from commandline import CommandLine

from missionfsm import check
from missionfsm.cli.reports import write_record
from missionfsm.kernel.codec import JSON
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.contradiction import recorded

HEAD: JSON = {"missionfsm": 1, "system": "bear.mission", "world": {}}
CLEARED = {"call": 1, "method": "ClearMissionStatus", "params": {}}


@functools.cache
def found() -> Verdict:
    """A robot that answers one question in one way and, after the next reset, in another."""
    return conform(MISSION, Fickle("AM-33.fresh", "ab"), drawn=2, tours=18, steps=20, seed=2, advice=False)


def violation(verdict: Verdict) -> Violation:
    assert verdict.violation is not None, str(verdict)
    return verdict.violation


@pytest.mark.slow
def test_the_record_of_a_contradiction_is_judged_alike() -> None:
    """It has every conversation that it takes; each by itself is explained, together they are the same violation."""
    shown = violation(found())
    assert len(shown.sides) > 1
    assert [check(side.history).violation for side in shown.sides] == [None] * len(shown.sides)
    again = check(recorded(shown))
    assert again.outcome is Outcome.VIOLATES
    assert (violation(again).observed, {rule.id for rule in violation(again).rules}) == (
        shown.observed,
        {rule.id for rule in shown.rules},
    )


def test_no_two_calls_of_a_record_have_one_number() -> None:
    """As a history wants it, however many conversations it has."""
    calls = [line["call"] for line in recorded(violation(found())) if "call" in line]
    assert (len(calls) > 1, len(calls)) == (True, len(set(calls)))


def test_the_story_of_a_contradiction_has_every_conversation_with_its_world() -> None:
    """A heading for each says what it rules out; then its world, and what was done."""
    told = found().story.splitlines()
    headings = [line for line in told if line.startswith("conversation ")]
    assert len(headings) == len(violation(found()).sides)
    assert [line.partition(": not ")[0] for line in headings] == [
        f"conversation {one + 1}" for one in range(len(headings))
    ]
    assert sum(line.startswith("  0. in the ") for line in told) == len(headings)


def test_the_evidence_of_a_reading_says_the_situation() -> None:
    """Not only what was answered, but where the robot stood: here it had no mission."""
    notes = violation(found()).notes
    assert [
        note for note in notes if "ClearMissionStatus() was answered" in note and not note.endswith(" in [no mission]")
    ] == []


def shown(number: int, state: str, **more: JSON) -> JSON:
    """A message that lists one mission."""
    goals = [{"destinationId": "table-1"}]
    mission = {"missionId": "m", "state": state, "goals": goals, "missionType": {"baseType": "BASE_TYPE_NAVIGATE"}}
    metadata = {"timestamp": "2025-04-01T15:30:00Z", "sequenceNumber": number}
    return {
        "stream": 1,
        "message": {
            "metadata": metadata,
            "missionStates": {"missions": [{**mission, **more}], "currentMissionIndex": 0},
        },
    }


def ended(event: str, state: str, index: int, **feedback: JSON) -> list[JSON]:
    """A mission runs and ends; which index the last message has, and what the mission feeds back while it runs."""
    goal = {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}
    last = shown(3, state)
    last["message"]["missionStates"]["currentMissionIndex"] = index
    return [
        {**HEAD, "drives": [event]},
        {"call": 1, "method": "CreateMission", "params": {"mission": goal}},
        {"return": 1, "result": {"missionId": "m"}},
        {"settled": True},
        {"call": 2, "method": "SubscribeMissionStatus", "params": {}},
        {"return": 2, "result": {"stream": 1}},
        shown(2, "STATE_RUNNING", missionFeedback=feedback),
        {"drive": {"event": event}},
        last,
        {"settled": True},
    ]


BASE_OR_SERVI = ({"baseFeedback": {"status": 1}}, {"serviFeedback": {"status": 1}})


@pytest.mark.parametrize(
    ("conversations", "rule"),
    [
        (
            [ended("missionFailed", "STATE_FAILED", 0), ended("missionSucceeded", "STATE_SUCCEEDED", -1)],
            "the-current-mission-index-is-the-active-mission",
        ),
        (
            [ended("missionFailed", "STATE_FAILED", -1, **feedback) for feedback in BASE_OR_SERVI],
            "the-feedback-fits-the-mission",
        ),
    ],
)
def test_a_contradiction_accuses_what_the_question_is_about(conversations: list[list[JSON]], rule: str) -> None:
    """Not all that was promised of the messages: which index is shown, or whose feedback."""
    verdict = check([line for lines in conversations for line in lines])
    assert [one.id for one in violation(verdict).rules] == [f"bear.mission/SubscribeMissionStatus/{rule}"]


def test_several_conversations_in_one_file_are_judged_together(tmp_path: Path, command_line: CommandLine) -> None:
    """Those that agree conform, with the events of all; those that do not are told with both."""
    refused = {"return": 1, "error": {"status": "FAILED_PRECONDITION", "message": ""}}
    alike = [HEAD, CLEARED, refused, HEAD, {**CLEARED, "call": 2}, {**refused, "return": 2}]
    apart = [*alike[:5], {"return": 2, "result": {"missionIds": []}}]
    for lines, status in ((alike, 0), (apart, 1)):
        path = tmp_path / "several.jsonl"
        path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
        ended = command_line("check", path, "--json", "-")
        verdict = orjson.loads(ended.out)
        verdict = verdict[0] if isinstance(verdict, list) else verdict
        assert (ended.status, verdict["events"]) == (status, 4), ended.out
        if status:
            assert len(verdict["violation"]["conversations"]) == 2


@pytest.mark.parametrize("name", ["found.jsonl", "test_found.py"])
def test_what_is_recorded_has_all_conversations(tmp_path: Path, command_line: CommandLine, name: str) -> None:
    """`check` of a recorded history ends with 1, and the function for pytest fails."""
    path = tmp_path / name
    write_record(str(path), MISSION, found())
    if path.suffix == ".jsonl":
        assert command_line("check", path).status == 1
        return
    space: dict[str, object] = {}
    exec(compile(path.read_text(), str(path), "exec"), space)  # noqa: S102 - it is made to be run
    function = space["test_found"]
    assert callable(function)
    with pytest.raises(AssertionError, match="follows no single reading of"):
        function()
