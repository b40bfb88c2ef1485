"""Recorded histories on the edge of what the page allows, each with what they are about as their name."""

from __future__ import annotations

from pathlib import Path

import orjson
import pytest

from missionfsm.app.recorded import check_file
from missionfsm.kernel.codec import JSON
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Outcome, Verdict
from missionfsm.tools.reference.subject import ReferenceSubject

EDGES = Path(__file__).parent / "edges"


@pytest.mark.parametrize("path", sorted(EDGES.rglob("*.jsonl")), ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_history_is_judged_right(path: Path) -> None:
    """What some consistent choice of readings explains conforms; the rest violates."""
    ((_, verdict),) = check_file(str(path))
    assert verdict.outcome.value == f"{path.parent.name}s"


def judged(tmp_path: Path, *lines: JSON) -> Verdict:
    """The verdict on lines about a Servi robot of which nothing is driven."""
    path = tmp_path / "log.jsonl"
    first = {"missionfsm": 1, "system": "bear.mission", "world": {"family": "servi"}}
    path.write_bytes(b"\n".join(map(orjson.dumps, (first, *lines))))
    ((_, verdict),) = check_file(str(path))
    return verdict


BASE = {"navigateAutoMission": {"goals": [{"destinationId": "table-1"}, {"destinationId": "table-2"}]}}
MISSIONS = {
    "that select a goal": {"baseMission": BASE},
    "with a destination that is missing": {"baseMission": {"navigateMission": {"goal": {"destinationId": "nowhere"}}}},
    "of another family, too": {"cartiMission": {"traverseMission": {"goals": [{"destinationId": "nowhere"}]}}},
}


@pytest.mark.parametrize(
    ("of", "taken"),
    [(of, taken) for of in MISSIONS for taken in (True, False) if taken or of != "that select a goal"],
)
def test_a_batch_may_be_long(tmp_path: Path, of: str, *, taken: bool) -> None:
    """All missions of a batch follow the same readings, so that many are no more ways than one."""
    missions = [{"mission": MISSIONS[of]}] * 300
    ids = [f"m-{number}" for number in range(300)]
    answer = {"result": {"missionIds": ids}} if taken else {"error": {"status": "INVALID_ARGUMENT"}}
    create = {"call": 1, "method": "CreateMissionBatch", "params": {"missions": missions}}
    assert judged(tmp_path, create, {"return": 1, **answer}).conforms


@pytest.mark.parametrize("waiting", [2, 8])
def test_a_wrong_answer_ends_a_log_of_which_nothing_is_driven(tmp_path: Path, waiting: int) -> None:
    """It is found however many missions wait, whose ends nobody has been shown: no message comes any more."""
    goal = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
    robot = ReferenceSubject(system("bear.mission"))
    robot.exchange("reset", {"world": {}})
    lines: list[JSON] = []
    for number, method in enumerate(("SubscribeMissionStatus", "CreateMission", *["AppendMission"] * waiting)):
        params = goal if number else {}
        came = robot.exchange(method, params)
        lines += [{"call": number, "method": method, "params": params}, {"return": number, "result": came.result}]
        lines += [{"stream": 1, "message": one.params["message"]} for one in came.after]
    wrong = [{"call": 99, "method": "SkipGoal"}, {"return": 99, "error": {"status": "NOT_FOUND"}}]
    assert judged(tmp_path, *lines).conforms
    verdict = judged(tmp_path, *lines, *wrong)
    assert verdict.violation is not None
    assert (verdict.outcome, verdict.violation.line) == (Outcome.VIOLATES, len(lines) + 3)


@pytest.mark.parametrize("ids", [["m", "m"], ["m", "n", "m"], ["m", "m", "m"]])
def test_one_mission_is_not_cleared_twice(tmp_path: Path, ids: list[str]) -> None:
    """Whichever of the missions that a lost batch created it is, and whatever is still to be shown."""
    goal = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
    verdict = judged(
        tmp_path,
        {"call": 1, "method": "SubscribeMissionStatus"},
        {"return": 1, "result": {"stream": 1}},
        {"call": 2, "method": "CreateMissionBatch", "params": {"missions": [goal] * len(ids)}},
        {"return": 2, "error": {"status": "DEADLINE_EXCEEDED"}},
        {"call": 3, "method": "AppendMission", "params": goal},
        {"call": 4, "method": "ClearMissionStatus"},
        {"return": 4, "result": {"missionIds": ids}},
    )
    assert verdict.outcome is Outcome.VIOLATES


@pytest.mark.parametrize("count", [3, 12, 60])
def test_one_way_to_name_missions_is_enough(tmp_path: Path, count: int) -> None:
    """What is cleared and was never named can be any of the missions that a lost batch created, in any order."""
    goal = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
    verdict = judged(
        tmp_path,
        {"call": 1, "method": "SubscribeMissionStatus"},
        {"return": 1, "result": {"stream": 1}},
        {"call": 2, "method": "CreateMissionBatch", "params": {"missions": [goal] * count}},
        {"return": 2, "error": {"status": "DEADLINE_EXCEEDED"}},
        {"call": 3, "method": "ClearMissionStatus"},
        {"return": 3, "result": {"missionIds": [f"m-{number}" for number in range(count)]}},
    )
    assert verdict.outcome is Outcome.CONFORMS
