"""A robot that restarts while calls are on their way: decided, wherever the restart is seen."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import orjson
import pytest
from commandline import CommandLine
from traffic import SUBSCRIBE, delivery, navigate

from missionfsm.app import recorded
from missionfsm.app.recorded import check_file
from missionfsm.kernel.history import Answer, Received, Returned
from missionfsm.kernel.transport import REDELIVERED
from missionfsm.oracle.restarts import NONE, Restarts, apparent_restarts
from missionfsm.tools.check.verdict import Verdict

HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {"family": "servi"}}
CLEAR = ("ClearMissionStatus", {})
PENDING: list[tuple[str, Any]] = [
    ("SkipGoal", {}),
    ("CreateMission", delivery("table-2")),
    CLEAR,
    ("AppendMission", navigate("table-3")),
    ("CreateMission", navigate("table-2")),
    ("ChargeRobot", {}),
]


def called(number: int, method: str, params: Any) -> Any:
    return {"call": number, "method": method, "params": params}


def made(number: int, name: str) -> Any:
    return {"return": number, "result": {"missionId": name}}


def refused(number: int) -> Any:
    return {"return": number, "error": {"status": "FAILED_PRECONDITION", "message": ""}}


def shows(stream: int, number: int, *missions: tuple[str, str, int]) -> Any:
    """A message that lists missions to the table of a number, each with its name and state; one is active at most."""
    listed = [
        {
            "missionId": name,
            "state": f"STATE_{state}",
            "missionType": {"baseType": "BASE_TYPE_NAVIGATE"},
            "goals": [{"destinationId": f"table-{table}"}],
            "currentGoalIndex": 0,
            "owner": "api",
        }
        for name, state, table in missions
    ]
    active = next((at for at, (_, state, _) in enumerate(missions) if state == "RUNNING"), -1)
    metadata = {"timestamp": "2026-05-01T10:00:00Z", "sequenceNumber": number}
    return {
        "stream": stream,
        "message": {"metadata": metadata, "missionStates": {"missions": listed, "currentMissionIndex": active}},
    }


def opened(call: int, stream: int) -> list[Any]:
    return [called(call, SUBSCRIBE, {}), {"return": call, "result": {"stream": stream}}]


BEFORE = [
    HEAD,
    *opened(1, 1),
    shows(1, 1),
    called(2, "CreateMission", navigate("table-1")),
    made(2, "A"),
    shows(1, 2, ("A", "RUNNING", 1)),
]
AFTER = [called(90, "CreateMission", navigate("table-3")), made(90, "Z"), shows(1, 1, ("Z", "RUNNING", 3))]


def judged(path: Path, lines: list[Any]) -> Verdict:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    ((_, verdict),) = check_file(str(path))
    return verdict


def flags(verdict: Verdict) -> set[str]:
    return {one.partition("=")[0] for one in verdict.flagged}


@pytest.mark.parametrize("many", [0, 3, 5, 6])
def test_a_restart_is_seen_however_many_calls_are_on_their_way(tmp_path: Path, many: int) -> None:
    """Calls that a restart finds on their way are refused behind it; nothing but the restart is flagged."""
    calls = [called(10 + at, *one) for at, one in enumerate(PENDING[:many])]
    answers = [refused(10 + at) for at in range(many)]
    log = [*BEFORE, *calls, shows(1, 0), *AFTER, *answers, {"settled": True}]
    verdict = judged(tmp_path / "log", log)
    assert (verdict.conforms, flags(verdict)) == (True, {"TR-05"}), str(verdict)


def test_what_comes_over_a_pipe_is_judged_a_second_time(
    command_line: CommandLine, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A list that a call may have emptied was emptied by a restart, as a later answer shows, if the log can be kept."""
    calls = [called(10 + at, *one) for at, one in enumerate(PENDING[:3])]
    lines = [*BEFORE, *calls, shows(1, 0), *AFTER, *(refused(10 + at) for at in range(3)), {"settled": True}]
    log = b"".join(orjson.dumps(line) + b"\n" for line in lines)
    assert command_line("check", "-", stdin=log).status == 0
    monkeypatch.setattr(recorded, "MOST_KEPT", len(log) - 1)
    assert command_line("check", "-", stdin=log).status == 1


EARLIER = [called(20, "CreateMission", navigate("table-3")), called(21, *CLEAR), made(20, "Z"), refused(21)]
BEHIND = {
    "what is shown behind it": (shows(1, 1, ("Z", "RUNNING", 3)), True),
    "what was before is listed again": (shows(1, 1, ("A", "RUNNING", 1), ("Z", "DEFAULT", 3)), False),
    "what nobody made is listed": (shows(1, 1, ("Y", "RUNNING", 3)), False),
}


@pytest.mark.parametrize("case", BEHIND)
def test_a_restart_may_come_before_answers_that_are_seen_first(tmp_path: Path, case: str) -> None:
    """An answer names what is made after a restart before the list is seen to be empty; what was before is gone."""
    line, right = BEHIND[case]
    pending = [called(10 + at, *one) for at, one in enumerate(PENDING[:2])]
    answers = [refused(10 + at) for at, _ in enumerate(PENDING[:2])]
    log = [*BEFORE, *pending, *EARLIER, shows(1, 0), line, *answers, {"settled": True}]
    verdict = judged(tmp_path / "log", log)
    if right:
        assert (verdict.conforms, flags(verdict)) == (True, {"TR-05"}), str(verdict)
    else:
        assert not verdict.conforms


def test_a_slow_stream_shows_what_was_before_a_restart_that_another_has_shown(tmp_path: Path) -> None:
    """What was on its way when the robot restarted comes later on another stream, and then the empty list as well."""
    second = [*opened(3, 2), shows(2, 2, ("A", "RUNNING", 1))]
    ended = ("A", "SUCCEEDED", 1)
    first = [shows(1, 3, ended), shows(1, 0), *AFTER]
    slow = [shows(2, 3, ended), shows(2, 0), shows(2, 1, ("Z", "RUNNING", 3)), {"settled": True}]
    verdict = judged(tmp_path / "log", [*BEFORE, *second, *first, *slow])
    assert (verdict.conforms, flags(verdict)) == (True, {"TR-05"}), str(verdict)
    too_late = [*slow[1:3], slow[0]]
    assert not judged(tmp_path / "log", [*BEFORE, *second, *first, *too_late]).conforms


def test_calls_of_several_clients_are_told_apart_through_three_restarts(tmp_path: Path) -> None:
    """A message came twice, a gateway made a status up, streams lag: few unusual readings, each where it is needed."""

    def create(number: int, table: int) -> Any:
        return called(number, "CreateMission", navigate(f"table-{table}"))

    def append(number: int, table: int) -> Any:
        return called(number, "AppendMission", navigate(f"table-{table}"))

    def update(number: int, mission: str, command: str) -> Any:
        return called(
            number, "UpdateMission", {"missionCommand": {"missionId": mission, "command": f"COMMAND_{command}"}}
        )

    def batch(number: int, method: str, *tables: int) -> Any:
        missions = [navigate(f"table-{table}") for table in tables]
        return called(number, f"{method}MissionBatch", {"missions": missions})

    def workflow(number: int) -> Any:
        goals = [{"destinationId": "table-3"}, {"destinationId": "table-2"}]
        return called(
            number, "CreateMissionWorkflow", {"missionWorkflow": {"serviWorkflow": {"bussingPatrol": {"goals": goals}}}}
        )

    def unavailable(number: int) -> Any:
        return {"return": number, "error": {"status": "UNAVAILABLE", "message": ""}}

    first = [("a", "SUCCEEDED", 1)]
    last = [("d", "SUCCEEDED", 3), ("e", "RUNNING", 2)]
    lines = [
        called(1, SUBSCRIBE, {}),
        {"return": 1, "result": {"stream": 1}},
        *(
            shows(1, 3),
            append(2, 2),
            batch(3, "Append", 1, 2),
            batch(4, "Create", 1),
            shows(1, 0),
            shows(1, 0),
            update(5, "a", "RESUME"),
        ),
        *(
            shows(1, 2, ("a", "RUNNING", 1)),
            refused(3),
            {"return": 4, "result": {"missionIds": ["a"]}},
            append(6, 1),
            refused(5),
            refused(2),
        ),
        *(shows(1, 3, *first), called(7, *CLEAR), create(8, 1), shows(1, 4, *first, ("b", "RUNNING", 1))),
        *(made(8, "b"), create(9, 1), refused(9), made(6, "c"), update(10, "b", "RESUME")),
        *(shows(1, 5, *first, ("b", "RUNNING", 1), ("c", "DEFAULT", 1)), workflow(11), refused(10), refused(7)),
        *(unavailable(11), shows(1, 6, *first, ("b", "SUCCEEDED", 1), ("c", "RUNNING", 1))),
        *(create(12, 2), create(13, 2), called(14, *CLEAR), made(12, "f"), refused(14), refused(13)),
        *(create(15, 3), shows(1, 0), append(16, 1), create(17, 2), made(15, "d"), shows(1, 1, ("f", "RUNNING", 2))),
        *(refused(17), append(18, 2), update(19, "d", "FINISH"), shows(1, 2, ("f", "SUCCEEDED", 2)), made(18, "e")),
        *(shows(1, 0), update(20, "e", "RESUME"), made(16, "g"), refused(20), create(21, 3), refused(19)),
        *(shows(1, 1, ("d", "RUNNING", 3)), update(22, "e", "RESUME"), shows(1, 2, ("d", "SUCCEEDED", 3)), refused(21)),
        *(create(23, 3), unavailable(22), refused(23), shows(1, 3, *last), shows(1, 4, *last, ("g", "DEFAULT", 1))),
        {"settled": True},
    ]
    assert judged(tmp_path / "log.jsonl", [HEAD, *lines]).conforms


def message(channel: int, relation: str, *names: int) -> tuple[Any, ...]:
    return Received, "content", names, (relation,), channel


def answer(call: int, *names: int) -> tuple[Any, ...]:
    return Returned, Answer("OK"), names, call


def test_restarts_are_apparent_where_numbers_start_anew() -> None:
    """The list is empty and the number 0; answers may have come between, and one that names what follows has."""
    events = [
        message(0, "larger", 7),
        answer(1),
        message(0, "zero"),
        message(0, "larger", 8),
        answer(2),
        answer(3, 9),
        answer(4),
        message(0, "zero"),
        (Received, "content", (), ("zero", REDELIVERED), 0),
        message(5, "larger", 8),
        message(5, "zero"),
        message(0, "larger", 9),
    ]
    expected = Restarts(frozenset({2, 7, 10}), frozenset({1, 4, 5}), frozenset({5}))
    assert apparent_restarts(events, [0, 5]) == expected
    assert [at for at in range(len(events)) if at in expected] == [1, 2, 4, 5, 7, 10]


def test_where_no_number_is_ever_set_none_starts_anew() -> None:
    """A robot that leaves its numbers out shows nothing of a restart."""
    assert apparent_restarts([message(0, "zero"), message(0, "zero", 7), message(0, "zero")], []) == NONE
