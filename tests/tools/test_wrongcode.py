"""Which rules are said to be broken by an answer with a code that nothing allows: no more than are needed."""

from __future__ import annotations

import pytest

from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check

FIRST = {"missionfsm": 1, "system": "bear.mission", "world": {"family": "servi"}}
DRIVEN = {**FIRST, "drives": ["goalReached", "missionSucceeded", "missionFailed", "world", "fault"]}
SETTLED = {"settled": True}
SUCCEEDED = {"drive": {"event": "missionSucceeded"}}


def call(number: int, method: str, params: JSON, **answer: JSON) -> list[JSON]:
    """The lines of a call and its answer."""
    return [{"call": number, "method": method, "params": params}, {"return": number, **answer}]


def navigate(destination: str = "table-1") -> JSON:
    return {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": destination}}}}}


def refused(status: str) -> JSON:
    return {"status": status, "message": ""}


def accused(lines: list[JSON], first: JSON = DRIVEN) -> list[str]:
    """What a violation names, without the name of the system."""
    violation = check(system("bear.mission"), head(first), lines).violation
    assert violation is not None
    return [one.id.partition("/")[2] for one in violation.rules]


BUSY = [*call(1, "CreateMission", navigate(), result={"missionId": "m1"}), SETTLED]
ENDED = [*BUSY, SUCCEEDED, SETTLED]
NO_FIRST = "CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued"
CREATED = "CreateMission/the-answer-names-the-new-mission"


@pytest.mark.parametrize("status", ["INVALID_ARGUMENT", "NOT_FOUND", "PERMISSION_DENIED"])
@pytest.mark.parametrize("first", [FIRST, DRIVEN], ids=["as recorded", "driven"])
def test_a_busy_robot_that_gives_another_reason_breaks_the_row_of_its_state(status: str, first: JSON) -> None:
    """The row that holds and is not given is what is broken, also where the mission may have ended unseen."""
    lines = [*BUSY, *call(2, "CreateMission", navigate(), error=refused(status))]
    assert accused(lines, first) == [NO_FIRST]


def test_a_busy_robot_that_does_it_all_the_same_breaks_that_row() -> None:
    """What is done although it has to be refused breaks the refusal alone."""
    assert accused([*BUSY, *call(2, "CreateMission", navigate(), result={"missionId": "m2"})]) == [NO_FIRST]


@pytest.mark.parametrize("settled", [(), (SETTLED,)], ids=["at once", "settled"])
def test_what_starts_at_once_has_started(settled: tuple[JSON, ...]) -> None:
    """A robot that was just told to charge is busy: that it may be about to start comes after that, if at all."""
    lines = [*call(1, "ChargeRobot", {}, result={"missionId": "m1"}), *settled]
    lines += call(2, "ClearMissionStatus", {}, error=refused("INVALID_ARGUMENT"))
    assert accused(lines)[0] == "ClearMissionStatus/FAILED_PRECONDITION/a-mission-is-running-or-paused"


def test_a_row_that_held_a_while_ago_is_the_first() -> None:
    """An idle robot that says it is busy: the row that held before, then what should have been done."""
    lines = [*ENDED, *call(2, "CreateMission", navigate(), error=refused("FAILED_PRECONDITION"))]
    assert accused(lines) == [NO_FIRST, CREATED]


def test_of_rows_that_differ_in_their_code_the_usual_one_is_named() -> None:
    """An unknown id may be refused in three ways; that it is not refused breaks one row, that of the usual reading."""
    command = {"missionCommand": {"missionId": "x", "command": "COMMAND_CANCEL"}}
    lines = [*BUSY, *call(2, "UpdateMission", command, result={})]
    assert accused(lines) == ["UpdateMission/INVALID_ARGUMENT/the-mission-is-not-listed-and-another-is-active"]


def test_a_refusal_is_due_before_what_only_a_departure_allows() -> None:
    """A destination that is not on the map is refused by its own row, although a reading that is unusual accepts it."""
    lines = call(1, "CreateMission", navigate("nowhere"), error=refused("NOT_FOUND"))
    assert accused(lines) == ["CreateMission/INVALID_ARGUMENT/a-destination-is-not-on-the-map"]


def test_a_refusal_of_what_should_be_done_breaks_what_is_promised() -> None:
    """An idle robot that refuses: what should have been done, and no row, since nothing speaks for any of them."""
    assert accused(call(1, "CreateMission", navigate(), error=refused("INVALID_ARGUMENT"))) == [CREATED]


def test_the_row_that_would_hold_of_another_mission_is_the_nearest() -> None:
    """A command to the running mission that is refused as if it were queued: that row, and of whom it would hold."""
    queued = call(2, "AppendMission", navigate("table-2"), result={"missionId": "m2"})
    pause = {"missionCommand": {"missionId": "m1", "command": "COMMAND_PAUSE"}}
    lines = [*BUSY, *queued, SETTLED, *call(3, "UpdateMission", pause, error=refused("NOT_FOUND"))]
    violation = check(system("bear.mission"), head(DRIVEN), lines).violation
    assert violation is not None
    assert violation.rules[0].id.endswith("NOT_FOUND/the-mission-is-still-queued")
    says, _, why = violation.notes[0].partition(" (The mission still waits behind the active one,")
    assert says == "no refusal with NOT_FOUND is due: of the rows with that code none applies"
    assert why.endswith("; the first would if it were about m2")


def lists(number: int, state: str, index: int) -> JSON:
    """A message that lists the one mission."""
    shown = {"missionId": "m1", "state": f"STATE_{state}", "goals": [{"destinationId": "table-1"}]}
    states = {"missions": [{**shown, "missionType": {"baseType": "BASE_TYPE_NAVIGATE"}}], "currentMissionIndex": index}
    metadata = {"timestamp": "2025-04-01T17:05:00.001Z", "sequenceNumber": number}
    return {"stream": 1, "message": {"metadata": metadata, "missionStates": states}}


WATCHED = [*BUSY, *call(7, "SubscribeMissionStatus", {}, result={"stream": 1})]
CLOSED = {"stream": 1, "closed": True, "error": refused("NOT_FOUND")}
AS_DOCUMENTED = "SubscribeMissionStatus/it-answers-as-documented"
PAUSE = {"missionCommand": {"missionId": "m1", "command": "COMMAND_PAUSE"}}


@pytest.mark.parametrize(
    ("lines", "rules"),
    [
        ([lists(1, "RUNNING", -1)], ["SubscribeMissionStatus/the-current-mission-index-is-the-active-mission"]),
        ([lists(1, "RUNNING", 0), CLOSED], [AS_DOCUMENTED]),
        ([lists(1, "RUNNING", 0), {**CLOSED, "error": refused("INTERNAL")}, lists(2, "RUNNING", 0)], [AS_DOCUMENTED]),
        (
            [
                lists(1, "RUNNING", 0),
                *call(8, "UpdateMission", PAUSE, error=refused("INTERNAL")),
                lists(2, "PAUSED", 0),
            ],
            ["SubscribeMissionStatus/updates-follow-the-state", "UpdateMission/pause"],
        ),
    ],
    ids=["an index", "an end", "a message after the end", "a call that failed and took effect"],
)
def test_what_has_led_to_it_is_accused_only_where_it_may_be_what_is_wrong(lines: list[JSON], rules: list[str]) -> None:
    """The rule of what is wrong in a message, in an end; not that of the mission that was created before."""
    first = {**FIRST, "drives": ["goalReached", "missionSucceeded", "missionFailed", "world"]}
    assert accused([*WATCHED, *lines], first) == rules


def test_an_armed_fault_does_not_come_to_a_call_that_has_to_be_refused() -> None:
    """What is said is that, and not that nobody made it fail."""
    armed = {"drive": {"event": "fault", "status": "INTERNAL", "applied": False}}
    lines = [*BUSY, armed, *call(2, "CreateMission", navigate(), error=refused("INTERNAL"))]
    violation = check(system("bear.mission"), head(DRIVEN), lines).violation
    assert violation is not None
    says = "INTERNAL comes in the place of OK where a drive makes a call fail, and this one has to be refused"
    assert violation.notes == (says,)
    assert accused(lines) == [NO_FIRST]
