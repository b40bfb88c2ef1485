"""Logs of several clients at once, of a robot that nobody drives: never a false alarm, and nearly always decided."""

from __future__ import annotations

from pathlib import Path

import orjson
import pytest
from attrs import evolve
from busy import Habits, busy
from traffic import MISSION, SUBSCRIBE, Recorder, hourly, navigate, readings_at_random

from missionfsm.app.recorded import check_file
from missionfsm.bear.mission.promises import GOALS

ROUGH = Habits(lost=0.12, late=0.12, ends=0.05, slow=0.8)
"""Where much is lost or late, and little comes at once."""


@pytest.mark.parametrize("habits", [Habits(), ROUGH], ids=["usual", "rough"])
@pytest.mark.parametrize("seed", range(6))
def test_a_busy_log_conforms(tmp_path: Path, seed: int, habits: Habits) -> None:
    """Clients that overlap, calls that are lost or late and streams that end are explained, under any readings."""
    choice = readings_at_random(seed) if seed % 2 else None
    path = tmp_path / "log"
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in busy(seed, 40, habits, choice)))
    ((_, verdict),) = check_file(str(path))
    assert verdict.conforms, str(verdict)


@pytest.mark.parametrize(("clients", "seed"), [(5, 1), (5, 33), (4, 12), (6, 1)])
def test_a_log_of_clients_whose_calls_are_lost_is_decided(tmp_path: Path, clients: int, seed: int) -> None:
    """Where what was wrong comes out long after, other ways of what came before are followed beside the nearest one."""
    path = tmp_path / "log"
    lines = busy(seed, 100, Habits(clients=clients), readings_at_random(seed) if seed % 2 else None)
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    ((_, verdict),) = check_file(str(path))
    assert verdict.conforms, str(verdict)


@pytest.mark.parametrize("shows", [True, False])
def test_a_subscription_that_nobody_answers_may_show_something(tmp_path: Path, *, shows: bool) -> None:
    """Calls that wait are decided beside a subscription without an answer, whether its stream shows anything or not."""
    robot = Recorder(drives=False)
    for _ in range(2):
        robot.call(SUBSCRIBE)
    for number in range(6):
        robot.call("CreateMission", navigate(f"table-{number % 3 + 1}"))
        robot.drive(event="goalReached")
    _, silent = robot.streams
    told = [line for line in robot.history if line.get("return") != 2 and (shows or line.get("stream") != silent)]
    slow = sorted(told[3:], key=lambda line: ("message" in line, "return" in line))
    path = tmp_path / "log"
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in [*told[:3], *slow]))
    ((_, verdict),) = check_file(str(path))
    assert verdict.conforms, str(verdict)


@pytest.mark.parametrize("seed", [0, 1, 3])
def test_a_busy_log_that_is_cut_anywhere_is_no_violation(tmp_path: Path, seed: int) -> None:
    """However much is missing at the beginning of a busy log, what is left is never a violation."""
    first, *lines = busy(seed, 40, Habits(), readings_at_random(seed) if seed % 2 else None)
    wrong = {}
    for cut in range(1 + seed, len(lines), 6):
        path = tmp_path / "log"
        left = [{**first, "begins": "anywhere"}, *lines[cut:]]
        path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in left))
        ((_, verdict),) = check_file(str(path))
        if verdict.violation is not None:
            wrong[cut] = str(verdict)
    assert wrong == {}


@pytest.mark.parametrize("seed", range(3))
def test_a_log_of_streams_that_end_is_no_violation_wherever_it_is_cut(tmp_path: Path, seed: int) -> None:
    """A log of streams that end again and again conforms, and is no violation whatever is missing at its beginning."""
    first, *lines = hourly(seed).history
    path = tmp_path / "log"
    found = []
    for cut in range(len(lines)):
        left = [{**first, **({"begins": "anywhere"} if cut else {})}, *lines[cut:]]
        path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in left))
        ((_, verdict),) = check_file(str(path))
        found.append(verdict)
    assert found[0].conforms
    assert [str(one) for one in found if one.violation is not None] == []


@pytest.mark.parametrize("missions", [3, 6])
def test_a_robot_may_get_far_ahead_of_its_stream(tmp_path: Path, missions: int) -> None:
    """Each mission is created once the one before has ended, which the stream shows only after the last answer."""
    robot = Recorder(drives=False)
    for number in range(missions):
        robot.call("CreateMission", navigate("table-1"))
        if number == 0:
            robot.call(SUBSCRIBE)
        robot.drive(event="goalReached")
    late = sorted(robot.history, key=lambda line: "message" in line)
    path = tmp_path / "log"
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in late))
    ((_, verdict),) = check_file(str(path), strict=True)
    assert (verdict.conforms, verdict.flagged) == (True, ()), str(verdict)


LAGGING = Habits(lost=0, late=0, ends=0)
"""Where nothing is lost, but streams never catch up with the robot."""

CLOSE = evolve(LAGGING, behind=8)


@pytest.mark.parametrize(("habits", "clients"), [(CLOSE, 3), (CLOSE, 6), (LAGGING, 3), (LAGGING, 6)])
def test_a_busy_log_is_decided(tmp_path: Path, habits: Habits, clients: int) -> None:
    """Three hundred lines of clients that overlap are decided, also where streams never catch up with the robot."""
    path = tmp_path / "log"
    lines = busy(clients, 300, evolve(habits, clients=clients))
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    ((_, verdict),) = check_file(str(path))
    assert verdict.conforms, str(verdict)


@pytest.mark.parametrize(("habits", "clients", "lines", "seed"), [(CLOSE, 3, 300, 37), (LAGGING, 5, 300, 38)])
def test_many_unusual_readings_are_learned(tmp_path: Path, habits: Habits, clients: int, lines: int, seed: int) -> None:
    """A quarter of all questions answered in any way, by a robot that many follow: which ones, is found out."""
    path = tmp_path / "log"
    log = busy(seed, lines, evolve(habits, clients=clients), readings_at_random(seed))
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in log))
    ((_, verdict),) = check_file(str(path))
    assert verdict.conforms, str(verdict)


@pytest.mark.parametrize("place", [0.5, 1])
@pytest.mark.parametrize("clients", [3, 6])
def test_a_wrong_message_of_a_busy_log_is_accused(tmp_path: Path, clients: int, place: float) -> None:
    """A mission that a stream shows with other goals than before, amid others or at the end, is what is wrong."""
    log = busy(clients, 200, evolve(CLOSE, clients=clients))
    shown = [at for at, line in enumerate(log) if line.get("message", {}).get("missionStates", {}).get("missions")]
    at = shown[int(place * (len(shown) - 1))]
    log[at] = orjson.loads(orjson.dumps(log[at]))
    log[at]["message"]["missionStates"]["missions"][0]["goals"] = [{"destinationId": "elsewhere"}]
    path = tmp_path / "log"
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in log))
    ((_, verdict),) = check_file(str(path))
    assert verdict.violation is not None, str(verdict)
    accused = [one.id for one in verdict.violation.rules]
    assert (verdict.violation.at, accused) == (at + 1, [GOALS.id]), str(verdict)


@pytest.mark.parametrize("shown", [1, 5])
def test_a_stream_may_show_nothing_any_more(tmp_path: Path, shown: int) -> None:
    """Whoever has stopped to read hides what the robot does by itself; nothing else has to explain what it does."""
    robot = Recorder(drives=False)
    robot.call(SUBSCRIBE)
    for _ in range(40):
        robot.call("CreateMission", navigate("table-1"))
        robot.drive(event="goalReached")
    messages = [line for line in robot.history if "message" in line]
    lines = [line for line in robot.history if line not in messages[shown:]]
    path = tmp_path / "log"
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    ((_, verdict),) = check_file(str(path))
    assert (verdict.conforms, verdict.flagged) == (True, ()), str(verdict)


@pytest.mark.parametrize("clients", [3, 4, 5])
def test_a_busy_log_needs_no_transport(tmp_path: Path, clients: int) -> None:
    """A robot that does all as by default is explained where nothing is lost on the way, whatever is in flight."""
    path = tmp_path / "log"
    lines = busy(clients, 90, evolve(CLOSE, clients=clients))
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    ((_, verdict),) = check_file(str(path), {one.id: one.default for one in MISSION.spec.ambiguities}, strict=True)
    assert (verdict.conforms, verdict.flagged) == (True, ()), str(verdict)
