"""Other robots take and leave goals with no line of the log that says so."""

from __future__ import annotations

from functools import cache
from random import Random
from typing import Any

import pytest
from traffic import MISSION, SUBSCRIBE, Recorder, navigate, readings_at_random

from missionfsm.app.asked import judged_system
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import PATIENCE, Judge

TABLES = ("table-1", "table-2", "table-3")
HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {"family": "servi"}}


def auto(*tables: str, family: str = "base") -> Any:
    goals = [{"destinationId": table} for table in tables]
    return {"mission": {f"{family}Mission": {"navigateAutoMission": {"goals": goals}}}}


@cache
def automaton(drives: tuple[str, ...], budget: int, *, strict: bool) -> Automaton:
    return Automaton(judged_system("bear.mission", strict=strict).spec, drives, budget=budget)


def judged(first: Any, lines: list[Any], *, waits: bool = True) -> Judge:
    said = head(first)
    walked = automaton(said.drives, PATIENCE if waits else 20_000, strict=said.strict)
    judge = Judge(judged_system("bear.mission", strict=said.strict), said, walked, apart=True, waits=waits)
    for line in lines:
        if not judge.feed(line):
            break
    return judge


def among_others(seed: int, steps: int) -> list[Any]:
    """What is seen of a robot among others: of what those take and leave there is no line."""
    random = Random(seed)
    log = Recorder(readings_at_random(seed))
    log.call(SUBSCRIBE)
    for _ in range(steps):
        what = random.randrange(14)
        tables = random.sample(TABLES, random.randint(1, 3))
        mission = auto(*tables, family=random.choice(("base", "servi")))
        if what < 3:
            log.call("CreateMission", mission)
        elif what < 5:
            log.call("AppendMission", mission)
        elif what == 5:
            log.call(random.choice(("CreateMissionBatch", "AppendMissionBatch")), {"missions": [mission, mission]})
        elif what < 8 and log.missions:
            command = random.choice(("CANCEL", "PAUSE", "RESUME", "RESUME", "FINISH"))
            params = {"missionCommand": {"missionId": log.missions[-1], "command": f"COMMAND_{command}"}}
            log.call("UpdateMission", params)
        elif what == 8:
            log.call(random.choice(("SkipGoal", "SkipGoal", "ClearMissionStatus")))
        elif what == 9:
            log.drive(event=random.choice(("goalReached", "missionFailed")))
        elif what == 10:
            log.settle()
        else:
            log.drive(event="world", occupied=random.sample(TABLES, random.randint(0, 3)))
    log.settle()
    return [line for line in log.lines if line.get("drive", {}).get("event") != "world"]


@pytest.mark.parametrize("drives", [[], ["goalReached", "missionSucceeded", "missionFailed"]], ids=["none", "some"])
@pytest.mark.parametrize("seed", range(12))
def test_a_robot_among_others_is_no_violation(seed: int, drives: list[str]) -> None:
    """Whatever others take and leave unseen, and whenever, a robot that goes by it is never a violation."""
    lines = [line for line in among_others(seed, 16) if drives or "drive" not in line]
    judge = judged({**HEAD, "drives": drives}, lines)
    verdict = judge.verdict()
    assert (verdict.violation, judge.exhausted) == (None, False), str(verdict)


@pytest.mark.parametrize("seed", range(12))
def test_a_robot_among_others_is_no_violation_live(seed: int) -> None:
    """The same where a tester drives all but the world and knows nothing of what comes later."""
    first = {**HEAD, "drives": ["goalReached", "missionSucceeded", "missionFailed"]}
    judge = judged(first, among_others(seed, 16), waits=False)
    verdict = judge.verdict()
    assert (verdict.violation, judge.exhausted) == (None, False), str(verdict)


EMPTY = {"metadata": {"timestamp": "2025-04-01T17:05:00Z", "sequenceNumber": 1}, "missionStates": {"missions": []}}
EMPTY["missionStates"]["currentMissionIndex"] = -1


def call(number: int, method: str, params: Any, answer: Any) -> list[Any]:
    return [{"call": number, "method": method, "params": params}, {"return": number, **answer}]


def shown(number: int, goal: int, *goals: str, state: str = "RUNNING") -> Any:
    mission = {
        "missionId": "A",
        "state": f"STATE_{state}",
        "missionType": {"baseType": "BASE_TYPE_NAVIGATE_AUTO"},
        "goals": [{"destinationId": one} for one in goals],
        "currentGoalIndex": goal,
    }
    states = {"missions": [mission], "currentMissionIndex": 0 if state == "RUNNING" else -1}
    metadata = {"timestamp": "2025-04-01T17:05:00Z", "sequenceNumber": number}
    return {"stream": 1, "message": {"metadata": metadata, "missionStates": states}}


WATCHED = [*call(1, SUBSCRIBE, {}, {"result": {"stream": 1}}), {"stream": 1, "message": EMPTY}]
BEGUN = [*WATCHED, *call(2, "CreateMission", auto(*TABLES), {"result": {"missionId": "A"}})]
REFUSED = {"error": {"status": "FAILED_PRECONDITION", "message": ""}}
SKIPPED = {"result": {"missionId": "A"}}
UNSEEN = {
    "it passes over the first goal": [*BEGUN, shown(2, 1, *TABLES)],
    "it goes elsewhere on the way, again and again": [
        *BEGUN,
        *(shown(2 + at, goal, *TABLES) for at, goal in enumerate((0, 2, 1, 0, 2, 0))),
    ],
    "a skip passes over the next goal": [
        *BEGUN,
        shown(2, 0, *TABLES),
        *call(3, "SkipGoal", {}, SKIPPED),
        shown(3, 2, *TABLES),
    ],
    "no goal was free when it was created": [*WATCHED, *call(2, "CreateMission", auto(*TABLES), REFUSED)],
}
WRONG = {
    "a goal that is none of the mission's": [*BEGUN, shown(2, 0, "table-9", *TABLES)],
    "a mission to one goal passes over it": [
        *WATCHED,
        *call(2, "CreateMission", navigate("table-1"), {"result": {"missionId": "A"}}),
        {"settled": True},
        shown(2, 1, "table-1", "table-2"),
    ],
    "a goal that is on the map is refused": [
        *WATCHED,
        *call(2, "CreateMission", navigate("table-1"), {"error": {"status": "INVALID_ARGUMENT", "message": ""}}),
    ],
}


@pytest.mark.parametrize("case", UNSEEN)
def test_what_others_hold_unseen_is_an_explanation_and_flagged(case: str) -> None:
    """A robot that went by what others held conforms where nobody says what they did, and LOG-03 says so."""
    verdict = judged(HEAD, UNSEEN[case]).verdict()
    assert verdict.conforms, str(verdict)
    assert [line.partition("=")[0] for line in verdict.flagged] == ["LOG-03"]


@pytest.mark.parametrize("case", UNSEEN)
@pytest.mark.parametrize(
    "known", [{"drives": list(MISSION.spec.drives)}, {"transport": "strict"}], ids=["driven", "strict"]
)
def test_where_the_world_is_known_nothing_happens_to_it_unseen(case: str, known: Any) -> None:
    """Where the tester commands the world, or nothing can be missing in the log, the same is wrong."""
    verdict = judged({**HEAD, **known}, UNSEEN[case]).verdict()
    assert verdict.violation is not None, str(verdict)


@pytest.mark.parametrize("case", WRONG)
def test_others_explain_nothing_but_the_choice_of_a_goal(case: str) -> None:
    """What others hold does not change the map, what is listed, nor a mission that has one goal to go to."""
    assert judged(HEAD, WRONG[case]).verdict().violation is not None


def test_what_is_watched_is_no_field_of_the_protocol() -> None:
    """A world that nobody watches is written as it is, and nobody can ask for one by a field."""
    world = MISSION.codec.read_world({"occupied": ["table-1"]})
    drive = MISSION.spec.drives["world"]
    assert drive.unwatched is not None
    assert MISSION.codec.write_world(drive.unwatched.world(world)) == MISSION.codec.write_world(world)
    assert "unwatched" not in MISSION.codec.write_world(world)
