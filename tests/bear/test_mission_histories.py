"""Histories of several clients: what some order explains is accepted, what none explains is refused; calls get lost."""

from __future__ import annotations

from pathlib import Path

import orjson
import pytest

from missionfsm.app.recorded import check_file
from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Verdict

MISSION = system("bear.mission")
DRIVES = tuple(MISSION.spec.drives)


def delivery(*tables: str) -> JSON:
    goals = [{"destinationId": table} for table in tables or ("table-1",)]
    return {"mission": {"serviMission": {"deliveryMission": {"goals": goals}}}}


def command(mission: str, what: str) -> JSON:
    return {"missionCommand": {"missionId": mission, "command": f"COMMAND_{what}"}}


def call(number: int, method: str, params: JSON = None) -> JSON:
    return {"call": number, "method": method, "params": params or {}}


def created(number: int, *missions: str) -> JSON:
    """The answer that names a mission, or several."""
    return {
        "return": number,
        "result": {"missionId": missions[0]} if len(missions) == 1 else {"missionIds": [*missions]},
    }


def cleared(number: int, *missions: str) -> JSON:
    return {"return": number, "result": {"missionIds": [*missions]}}


def refused(number: int, status: str = "FAILED_PRECONDITION") -> JSON:
    return {"return": number, "error": {"status": status}}


def driven(event: str) -> JSON:
    return {"drive": {"event": event}}


SETTLED = {"settled": True}
RUNNING = (call(1, "CreateMission", delivery()), created(1, "one"), SETTLED)


DEFAULT = {one.id: one.default for one in MISSION.spec.ambiguities}


def judged(
    *lines: JSON,
    drives: tuple[str, ...] = DRIVES,
    lost: frozenset[int] = frozenset(),
    readings: dict[str, str] | None = None,
) -> Verdict:
    return check(MISSION, Head("bear.mission", {}, drives), lines, lost=lost, readings=readings)


# Each race: what was sent, and the answers (in the order in which they come) that can and that cannot be explained.
TWO_CREATES = (call(1, "CreateMission", delivery()), call(2, "CreateMission", delivery("table-2")))
AFTER_A_CLEAR = (call(5, "ClearMissionStatus"), call(6, "CreateMission", delivery()))
RACES = {
    "two creates, the first wins": ((*TWO_CREATES, created(1, "one"), refused(2)), True),
    "two creates, the second wins": ((*TWO_CREATES, refused(1), created(2, "two")), True),
    "two creates, both win": ((*TWO_CREATES, created(1, "one"), created(2, "two")), False),
    "two creates, both lose": ((*TWO_CREATES, refused(1), refused(2)), False),
    "two creates, one after the other, the second wins": (
        (TWO_CREATES[0], refused(1), TWO_CREATES[1], created(2, "two")),
        False,
    ),
    "two creates under one name": ((*TWO_CREATES, created(1, "one"), created(2, "one")), False),
    "append after the last mission's end": (
        (*RUNNING, call(2, "AppendMission", delivery()), driven("missionSucceeded"), created(2, "two"), SETTLED),
        True,
    ),
    "append before the end, and the mission named waits": (
        (
            *RUNNING,
            call(2, "AppendMission", delivery()),
            created(2, "two"),
            call(3, "UpdateMission", command("two", "PAUSE")),
            refused(3, "NOT_FOUND"),
        ),
        True,
    ),
    "append before the end, and the mission named was never listed": (
        (
            *RUNNING,
            call(2, "AppendMission", delivery()),
            created(2, "two"),
            call(3, "UpdateMission", command("three", "PAUSE")),
            created(3, "three"),
        ),
        False,
    ),
    "append while the missions are cleared, before": (
        (
            *RUNNING,
            driven("missionSucceeded"),
            call(2, "ClearMissionStatus"),
            call(3, "AppendMission", delivery()),
            created(3, "two"),
            cleared(2, "one"),
        ),
        False,
    ),
    "append while the missions are cleared, too late": (
        (
            *RUNNING,
            driven("missionSucceeded"),
            call(2, "ClearMissionStatus"),
            call(3, "AppendMission", delivery()),
            refused(3),
            cleared(2, "one"),
        ),
        True,
    ),
    "append while the missions are cleared, neither": (
        (
            *RUNNING,
            driven("missionSucceeded"),
            call(2, "ClearMissionStatus"),
            call(3, "AppendMission", delivery()),
            refused(3),
            refused(2),
        ),
        False,
    ),
    "clear before create": (
        (*RUNNING, driven("missionFailed"), *AFTER_A_CLEAR, created(6, "two"), cleared(5, "one"), SETTLED),
        True,
    ),
    "create before clear": ((*RUNNING, driven("missionFailed"), *AFTER_A_CLEAR, created(6, "two"), refused(5)), True),
    "clear and create, and the new one is cleared": (
        (*RUNNING, driven("missionFailed"), *AFTER_A_CLEAR, created(6, "two"), cleared(5, "two")),
        False,
    ),
    "clear and create, and create is refused": (
        (*RUNNING, driven("missionFailed"), *AFTER_A_CLEAR, cleared(5, "one"), refused(6)),
        False,
    ),
    "pause and cancel": (
        (
            *RUNNING,
            call(2, "UpdateMission", command("one", "CANCEL")),
            call(3, "UpdateMission", command("one", "PAUSE")),
            {"return": 3, "result": {}},
            {"return": 2, "result": {}},
        ),
        True,
    ),
    "two cancels, both win": (
        (
            *RUNNING,
            call(2, "UpdateMission", command("one", "CANCEL")),
            call(3, "UpdateMission", command("one", "CANCEL")),
            {"return": 3, "result": {}},
            {"return": 2, "result": {}},
        ),
        False,
    ),
}


@pytest.mark.parametrize("race", RACES)
def test_races_are_judged_both_ways(race: str) -> None:
    """Calls that overlap may take effect in any order, others in theirs alone (default readings)."""
    lines, right = RACES[race]
    verdict = judged(*lines, readings=DEFAULT)
    assert verdict.conforms is right, str(verdict)


LOST_CREATE = call(7, "CreateMission", delivery())
CALLS_WITHOUT_ANSWER = {
    "it happened": ((LOST_CREATE, call(8, "CreateMission", delivery()), refused(8)), True),
    "it did not happen": ((LOST_CREATE, call(8, "CreateMission", delivery()), created(8, "two")), True),
    "it happened later": (
        (
            LOST_CREATE,
            call(8, "SkipGoal"),
            refused(8),
            SETTLED,
            call(9, "AppendMission", delivery()),
            created(9, "two"),
        ),
        True,
    ),
    "it happened once": (
        (
            LOST_CREATE,
            call(8, "CreateMission", delivery()),
            refused(8),
            driven("missionSucceeded"),
            call(9, "CreateMission", delivery()),
            refused(9),
        ),
        False,
    ),
    "it cannot have happened before it was sent": (
        (call(8, "CreateMission", delivery()), refused(8), LOST_CREATE),
        False,
    ),
    "its mission can be named, by one name": (
        (LOST_CREATE, call(8, "UpdateMission", command("one", "PAUSE")), {"return": 8, "result": {}}),
        True,
    ),
    "its mission has no two names": (
        (
            LOST_CREATE,
            call(8, "UpdateMission", command("one", "PAUSE")),
            {"return": 8, "result": {}},
            call(9, "UpdateMission", command("two", "RESUME")),
            {"return": 9, "result": {}},
        ),
        False,
    ),
}


@pytest.mark.parametrize("known", [True, False], ids=["known to be lost", "pending"])
@pytest.mark.parametrize("case", CALLS_WITHOUT_ANSWER)
def test_a_call_without_an_answer_may_have_happened(case: str, *, known: bool) -> None:
    """A call without an answer happened once at some time after it was sent, or never."""
    lines, right = CALLS_WITHOUT_ANSWER[case]
    verdict = judged(*lines, lost=frozenset({7}) if known else frozenset())
    assert verdict.conforms is right, str(verdict)


def test_a_deadline_that_passed_leaves_open_what_happened() -> None:
    """After DEADLINE_EXCEEDED a mission may be there or not; after INTERNAL it is not, unless a fault was armed."""
    for status, there, right in (
        ("DEADLINE_EXCEEDED", True, True),
        ("DEADLINE_EXCEEDED", False, True),
        ("INTERNAL", True, False),
        ("INTERNAL", False, True),
    ):
        answer = refused(8) if there else created(8, "two")
        lines = (LOST_CREATE, refused(7, status), call(8, "CreateMission", delivery()), answer)
        verdict = judged(*lines, drives=("goalReached", "missionSucceeded", "missionFailed", "world"))
        assert verdict.conforms is right, (status, there, str(verdict))


def long_history(rounds: int, lost: int) -> tuple[list[JSON], frozenset[int]]:
    """So many rounds of create, cancel, clear; in the first ones a skip or an append is lost."""
    lines: list[JSON] = []
    for number in range(rounds):
        name, base = f"m{number}", 10 * number
        lines += [call(base + 1, "CreateMission", delivery()), created(base + 1, name)]
        if number < lost:
            lines.append(call(base + 2, "AppendMission", delivery()) if number % 2 else call(base + 2, "SkipGoal"))
        lines += [call(base + 3, "UpdateMission", command(name, "PAUSE")), {"return": base + 3, "result": {}}]
        lines += [call(base + 4, "UpdateMission", command(name, "CANCEL")), {"return": base + 4, "result": {}}]
        lines += [call(base + 5, "ClearMissionStatus"), cleared(base + 5, name)]
    return lines, frozenset(10 * number + 2 for number in range(lost))


def test_twelve_lost_calls_among_two_hundred() -> None:
    """Twelve calls among two hundred that are never answered are no obstacle to a verdict."""
    lines, lost = long_history(47, 12)
    assert sum("call" in line for line in lines) == 200
    verdict = judged(*lines, lost=lost, readings=DEFAULT)
    assert (verdict.conforms, verdict.events) == (True, len(lines)), str(verdict)


def test_sixteen_lost_calls_and_an_impossible_answer() -> None:
    """Sixteen creates that were never answered explain no seventeenth mission: an impossible answer is refuted."""
    lines = [call(number, "CreateMission", delivery(f"table-{number % 3 + 1}")) for number in range(1, 17)]
    impossible = [call(20, "ClearMissionStatus"), cleared(20, *(f"m{number}" for number in range(17)))]
    verdict = judged(*lines, *impossible, lost=frozenset(range(1, 17)))
    assert verdict.outcome.value == "violates", str(verdict)
    possible = judged(*lines, call(20, "ClearMissionStatus"), refused(20), lost=frozenset(range(1, 17)))
    assert possible.conforms, str(possible)


# The same from files, where nobody says which calls are lost.


def written(path: Path, lines: list[JSON]) -> str:
    head = {"missionfsm": 1, "system": "bear.mission", "world": {}, "drives": DRIVES}
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in (head, *lines)))
    return str(path)


@pytest.mark.parametrize("rounds", [13, 47])
def test_lost_calls_are_found_in_a_file(tmp_path: Path, rounds: int) -> None:
    """A file that never answers twelve calls is judged as if somebody had said which."""
    lines, lost = long_history(rounds, 12)
    known = judged(*lines, lost=lost, readings=DEFAULT)
    ((_, found),) = check_file(written(tmp_path / "log.jsonl", lines), DEFAULT)
    assert (found.outcome, found.events, found.exercised) == (known.outcome, known.events, known.exercised)


def test_an_impossible_answer_after_lost_calls_is_found_in_a_file(tmp_path: Path) -> None:
    """The line is named, and what is shown of the history before it is all of it."""
    lines = [call(number, "CreateMission", delivery(f"table-{number % 3 + 1}")) for number in range(1, 17)]
    lines += [call(20, "ClearMissionStatus"), cleared(20, *(f"m{number}" for number in range(17)))]
    ((_, found),) = check_file(written(tmp_path / "log.jsonl", lines))
    assert found.violation is not None
    assert (found.violation.at, len(found.violation.history)) == (19, 19)


@pytest.mark.parametrize("answered", [True, False])
def test_calls_that_wait_long_are_not_lost(tmp_path: Path, *, answered: bool) -> None:
    """A call may be answered hundreds of lines later, or not before the file ends."""
    lines, _ = long_history(40, 0)
    lines = [call(9001, "SkipGoal"), *lines, *([{"return": 9001, "result": {}}] if answered else [])]
    known = judged(*lines, lost=frozenset() if answered else frozenset({9001}))
    ((_, found),) = check_file(written(tmp_path / "log.jsonl", lines), strict=True)
    assert (found.outcome, found.events, found.readings) == (known.outcome, known.events, known.readings)
    # Nothing answers a skip with OK and without the name of a mission.
    assert found.conforms is not answered


def test_that_a_robot_cannot_start_is_no_fault_of_a_workflow_s_format() -> None:
    """A blocked robot may find a workflow invalid (AM-53) and, while a mission runs, look at that first or last.

    Neither says whether the format of a request or the state of the missions is looked at first (AM-01).
    """
    blocked = {"drive": {"event": "world", "blocked": True}}

    def workflow(table: str) -> JSON:
        return {"missionWorkflow": {"serviWorkflow": {"delivery": {"goals": [{"destinationId": table}]}}}}

    for first in ("FAILED_PRECONDITION", "INVALID_ARGUMENT"):
        for format_first in ("FAILED_PRECONDITION", "INVALID_ARGUMENT"):
            told = judged(
                call(1, "CreateMission", delivery()),
                created(1, "one"),
                SETTLED,
                call(2, "CreateMissionWorkflow", workflow("nowhere")),
                refused(2, format_first),
                blocked,
                call(3, "CreateMissionWorkflow", workflow("table-1")),
                refused(3, first),
                {"drive": {"event": "missionSucceeded"}},
                call(4, "CreateMissionWorkflow", workflow("table-1")),
                refused(4, "INVALID_ARGUMENT"),
            )
            assert told.conforms, (first, format_first)
            assert told.readings["AM-53.CreateMissionWorkflow"] == ("v",)
