"""Violations that are known do not end a search, and do not fail it; one that is not met any more does."""

from __future__ import annotations

from pathlib import Path

import orjson
import pytest
from broken import BUSY, EMPTY, MISSION, NEVER, Fickle, answering
from commandline import CommandLine

from missionfsm.kernel.subject import Subject
from missionfsm.tools.check.baseline import read_expected
from missionfsm.tools.check.verdict import Outcome, Verdict
from missionfsm.tools.conform.conform import conform

HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {}}
CREATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
HISTORY = (
    HEAD,
    {"call": 1, "method": "CreateMission", "params": CREATE},
    {"return": 1, "result": {"missionId": "m1"}},
    {"call": 2, "method": "CreateMission", "params": CREATE},
    {"return": 2, "error": {"status": "NOT_FOUND", "message": ""}},
)


def judged(subject: Subject, *expected: str) -> Verdict:
    return conform(MISSION, subject, drawn=2, tours=18, steps=20, seed=2, expected=expected, advice=False)


@pytest.mark.long
def test_a_search_goes_on_after_a_violation_that_is_known() -> None:
    """It ends well, has had all its conversations, and says how often it met the violation."""
    verdict = judged(answering("NOT_FOUND", BUSY), BUSY)
    assert (verdict.outcome, verdict.examples >= 14, verdict.violation) == (Outcome.CONFORMS, True, None)
    assert verdict.known[BUSY] >= 1
    assert f"known violation, met {verdict.known[BUSY]} times: {BUSY}" in str(verdict)


@pytest.mark.slow
def test_another_violation_is_found_behind_one_that_is_known() -> None:
    """Knowing the one does not hide the other."""
    verdict = judged(answering("NOT_FOUND", BUSY, EMPTY), BUSY)
    assert verdict.outcome is Outcome.VIOLATES
    assert verdict.violation is not None
    assert EMPTY in [rule.id for rule in verdict.violation.rules]


@pytest.mark.long
def test_an_expectation_that_is_not_met_fails_the_run() -> None:
    """An implementation that does right by now has to be taken off the list."""
    verdict = judged(answering("NOT_FOUND", BUSY), BUSY, NEVER)
    assert (verdict.outcome, verdict.stale) == (Outcome.INCONCLUSIVE, (NEVER,))
    assert f"a violation of {NEVER} was expected and was not met: take it off the list" in str(verdict)


@pytest.mark.long
def test_readings_that_contradict_one_another_may_be_known_as_well() -> None:
    """What speaks for each of two readings is one violation; where it is known, the question is set aside."""
    found = judged(Fickle("AM-33.fresh", "ab"))
    assert found.violation is not None
    assert "follows no single reading of AM-33.fresh" in found.violation.observed
    rules = [rule.id for rule in found.violation.rules]
    verdict = judged(Fickle("AM-33.fresh", "ab"), *rules)
    assert (verdict.conforms, "AM-33.fresh" in verdict.readings, list(verdict.known)) == (True, False, rules)


def listed(path: Path, *lines: str) -> Path:
    path.write_text("\n".join((*lines, "")))
    return path


def history(path: Path) -> Path:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in HISTORY))
    return path


def test_check_takes_a_list_of_known_violations(tmp_path: Path, command_line: CommandLine) -> None:
    """A known violation does not fail a file; the list has comments and empty lines."""
    log = history(tmp_path / "log.jsonl")
    known = listed(tmp_path / "known", "# since March", "", f"{BUSY}  # to be mended")
    right = command_line("check", log, "--expect-violations", known, "--json", "-")
    assert (right.status, orjson.loads(right.out)["known"]) == (0, {BUSY: 1})
    assert "a known violation: CreateMission" in orjson.loads(right.out)["notes"][0]
    assert command_line("check", log).status == 1


def test_check_fails_for_an_expectation_that_is_not_met(tmp_path: Path, command_line: CommandLine) -> None:
    """One line says which, in text and in JSON."""
    log, known = history(tmp_path / "log.jsonl"), listed(tmp_path / "known", BUSY, NEVER)
    ended = command_line("check", log, "--expect-violations", known, "--json", tmp_path / "out")
    assert (ended.status, ended.out.splitlines()[-1]) == (
        1,
        f"a violation of {NEVER} was expected and was not met: take it off the list",
    )
    assert orjson.loads((tmp_path / "out").read_bytes())["stale"] == [NEVER]


@pytest.mark.parametrize("command", ["check", "conform"])
def test_a_list_that_names_no_rule_is_bad_input(tmp_path: Path, command_line: CommandLine, command: str) -> None:
    """It says in which line; so does a list that is not there."""
    log, known = history(tmp_path / "log.jsonl"), listed(tmp_path / "known", BUSY, "bear.mission/CreateMision")
    subject = log if command == "check" else "bear.mission"
    wrong = command_line(command, subject, "--expect-violations", known)
    assert (wrong.status, f"{known}:2: there is no rule 'bear.mission/CreateMision'" in wrong.err) == (2, True)
    missing = command_line(command, subject, "--expect-violations", tmp_path / "none")
    assert (missing.status, "No such file" in missing.err) == (2, True)
    known.write_bytes(b"# a comment\n\xff")
    binary = command_line(command, subject, "--expect-violations", known)
    assert (binary.status, binary.err) == (2, f"missionfsm: {known}:2: byte 0xff is not UTF-8\n")


def test_each_rule_of_a_list_counts_once() -> None:
    """Whoever lists a rule twice expects it once."""
    assert read_expected(f"{BUSY}\n# no\n{BUSY}\n{NEVER}", [MISSION.spec]) == (BUSY, NEVER)
