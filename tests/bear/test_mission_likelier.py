"""Where a log contradicts itself, the answer is accused without which all is explained, also what comes after."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from test_mission_told import Log, command, mission, rules

from missionfsm.app.recorded import check_file
from missionfsm.tools.check.verdict import Violation

A = ("table-1", "table-2", "table-3")
WAITS = (("m2", "delivery", "DEFAULT", ("table-3",)), ("m3", "delivery", "DEFAULT", ("table-1",)))


def told(log: Log, path: Path) -> Violation:
    """What is wrong with the file that holds a log, and lines after it."""
    path.write_text("".join(f"{line}\n" for line in map(json.dumps, (log.head, *log.lines))))
    ((_, verdict),) = check_file(str(path))
    assert verdict.violation is not None
    return verdict.violation


def begun(update: str) -> Log:
    """A log that begins while the first of three missions is paused; that the second be cancelled is refused."""
    log = Log(begins="anywhere", transport="strict").shows(("m1", "delivery", "PAUSED", A), *WAITS, at=1)
    return log.asks("UpdateMission", command("m2", "CANCEL"), update)


def resumed(log: Log) -> Log:
    return log.asks("UpdateMission", command("m1", "RESUME")).shows(("m1", "delivery", "RUNNING", A), *WAITS, at=1)


def ended(log: Log) -> Log:
    log.asks("UpdateMission", command("m1", "FINISH"))
    after = (("m1", "delivery", "SUCCEEDED", A), ("m2", "delivery", "RUNNING", ("table-3",)), WAITS[1])
    return log.shows(*after, index=1).settles()


def test_a_wrong_code_that_only_what_comes_after_contradicts(tmp_path: Path) -> None:
    """That the waiting mission has ended, or the first one, could explain the code; but the first goes on."""
    found = told(ended(resumed(begun("FAILED_PRECONDITION"))), tmp_path / "log")
    says = "line 6 is likelier to be wrong, UpdateMission(COMMAND_CANCEL) was answered FAILED_PRECONDITION"
    assert found.notes[0] == f"{says}: with NOT_FOUND the rest is explained"
    assert rules(found)[0] == "UpdateMission/NOT_FOUND/the-mission-is-still-queued"


@pytest.mark.parametrize("other", ["m2", "m3"])
def test_a_wrong_id_that_only_what_comes_after_contradicts(other: str, tmp_path: Path) -> None:
    """A skip that answers the id of a mission that waits: that this one ran explains it, and nothing after it."""
    log = resumed(begun("NOT_FOUND")).asks("SkipGoal", missionId=other)
    found = told(ended(log.shows(("m1", "delivery", "RUNNING", A), *WAITS, at=2)), tmp_path / "log")
    assert found.notes[0].endswith(f"SkipGoal() was answered OK {other}: with OK m1 the rest is explained")
    assert rules(found)[0] == "SkipGoal/the-next-goal-is-taken-up"


def test_a_line_without_which_all_is_explained_is_accused_itself(tmp_path: Path) -> None:
    """No answer before it is, whatever stands behind it."""
    log = resumed(begun("NOT_FOUND")).asks("AppendMission", mission("delivery", "table-3"), missionId="m1")
    alone, found = told(log, tmp_path / "alone"), told(ended(log), tmp_path / "log")
    assert (found.notes, rules(found)) == (alone.notes, rules(alone))
