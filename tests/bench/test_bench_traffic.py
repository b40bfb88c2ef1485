"""How fast logs of real traffic are decided, and in how much memory: each figure by a test of its own.

    pytest -o addopts= tests/bench/test_bench_traffic.py -s

Every log is judged by ``missionfsm check`` in a process of its own. Where ``MISSIONFSM_EARLIER`` names the Python of an
environment with an earlier missionfsm, that judges the same logs in the same run, up to `PATIENCE` seconds each, and
the ratio is printed. Seconds are the processor's, so that others on the machine do not count. Nothing is asserted of
times.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from random import Random
from typing import Any

import orjson
import pytest
from attrs import frozen
from busy import Habits, busy
from traffic import MISSION, SUBSCRIBE, Recorder, delivery, navigate, readings_at_random

from missionfsm.app.recorded import check_file
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.systems import system
from missionfsm.tools.reference.subject import ReferenceSubject

PATIENCE = 60
"""Seconds of the processor's time that a log may take."""

CHECK = """
import atexit, runpy, sys

def peak():
    with open("/proc/self/status") as status:
        print(*(line for line in status if line.startswith("VmHWM")), file=sys.stderr)

atexit.register(peak)
runpy.run_module("missionfsm", run_name="__main__", alter_sys=True)
"""
"""The command, which says in the end how many kilobytes it had: who waits for it is told those of its parent."""


@frozen
class Measured:
    """What ``missionfsm check`` came to: its verdict, the seconds of the processor's time, the megabytes."""

    verdict: str
    seconds: float
    megabytes: float


def measured(python: str, path: Path, *options: str) -> Measured:
    """Judge a log in a process of its own."""
    command = [python, "-c", CHECK, "check", str(path), *options]
    limit = ("prlimit", f"--cpu={PATIENCE}", "--")
    before = os.times()
    ended = subprocess.run([*limit, *command], capture_output=True, text=True, cwd=path.parent, check=False)
    after = os.times()
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    verdict = ended.stdout.split(": ")[1].partition(":")[0] if ": " in ended.stdout else "no answer"
    kilobytes = ended.stderr.rpartition("VmHWM:")[2].split()
    return Measured(verdict, seconds, int(kilobytes[0]) / 1e3 if kilobytes else 0.0)


def shown(name: str, path: Path, *options: str) -> None:
    """Print what judging a log takes, and how much more it took earlier."""
    lines = path.read_bytes().count(b"\n")
    now = measured(sys.executable, path, *options)
    rate = f"{lines / now.seconds:,.0f} lines/s, the start included"
    said = f"\n{name}, {lines} lines: {now.verdict} in {now.seconds:.1f} s, {rate}, at most {now.megabytes:.0f} MB"
    if earlier := os.environ.get("MISSIONFSM_EARLIER"):
        before = measured(earlier, path, *options)
        said += f"; earlier {before.verdict} in {before.seconds:.1f} s, {before.seconds / now.seconds:.1f} times that"
    print(said)


def written(path: Path, lines: Iterable[Any]) -> Path:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    return path


@pytest.mark.parametrize("behind", [2, 8, sys.maxsize], ids=["2 behind", "8 behind", "ever more behind"])
@pytest.mark.parametrize("readings", ["default", "all"])
@pytest.mark.parametrize(("clients", "lines"), [(3, 200), (4, 500), (6, 500), (3, 2_000), (6, 2_000)])
def test_bench_traffic_clients(tmp_path: Path, clients: int, lines: int, readings: str, behind: int) -> None:
    """Clients whose calls overlap, streams that lag, and a robot that moves by itself; nothing is lost."""
    habits = Habits(clients=clients, lost=0, late=0, ends=0, behind=behind)
    decided = [f"--reading={one.id}={one.default}" for one in MISSION.spec.ambiguities] if readings == "default" else []
    path = written(tmp_path / "log.jsonl", busy(clients, lines, habits))
    lag = f"streams up to {behind} behind" if behind < sys.maxsize else "streams ever more behind"
    shown(f"{clients} clients, {lag}, {readings} readings", path, *decided)


@pytest.mark.parametrize(("clients", "seeds"), [(2, 30), (3, 30), (5, 20)])
def test_bench_traffic_share_decided(clients: int, seeds: int, tmp_path: Path) -> None:
    """Of logs in which calls are lost or late and streams end, under random readings: how many are decided."""
    outcomes: Counter[str] = Counter()
    slowest = 0.0
    for seed in range(seeds):
        lines = busy(seed, 100, Habits(clients=clients), readings_at_random(seed) if seed % 2 else None)
        began = time.perf_counter()
        ((_, verdict),) = check_file(str(written(tmp_path / "log.jsonl", lines)))
        slowest = max(slowest, time.perf_counter() - began)
        outcomes[verdict.outcome.value] += 1
    print(f"\n{clients} clients, {seeds} logs of 100 lines: {dict(outcomes)}; the slowest took {slowest:.1f} s")


@pytest.mark.parametrize("many", [2, 4, 8])
def test_bench_traffic_restart(tmp_path: Path, many: int) -> None:
    """A robot restarts while calls are on their way, all of which it refuses behind it."""
    log = Recorder(drives=False)
    log.call(SUBSCRIBE)
    log.call("CreateMission", delivery("table-1", "table-2"))
    calls = [("SkipGoal", {}), ("CreateMission", navigate("table-2")), ("CreateMission", delivery("table-3"))]
    asked = [calls[number % len(calls)] for number in range(many)]
    sent = [{"call": 10 + at, "method": method, "params": params} for at, (method, params) in enumerate(asked)]
    metadata = {"timestamp": "2026-05-01T10:00:00Z", "sequenceNumber": 0}
    message = {"metadata": metadata, "missionStates": {"missions": [], "currentMissionIndex": -1}}
    refused = {"status": "FAILED_PRECONDITION", "message": ""}
    answers = [{"return": 10 + at, "error": refused} for at in range(many)]
    lines = [*log.history, *sent, {"stream": log.streams[0], "message": message}, *answers, {"settled": True}]
    shown(f"a restart while {many} calls wait", written(tmp_path / "log.jsonl", lines))


def unanswered(many: int, methods: tuple[str, ...]) -> Recorder:
    """Many calls of some operations behind a mission that runs, each with its answer and what it makes seen."""
    log = Recorder()
    log.call(SUBSCRIBE)
    first = log.call("CreateMission", delivery("table-1", "table-2")).result["missionId"]
    for number in range(many):
        method = methods[number % len(methods)]
        params: Any = navigate(f"table-{number % 3 + 1}") if method == "AppendMission" else {}
        if method == "UpdateMission":
            command = ("PAUSE", "RESUME")[number // len(methods) % 2]
            params = {"missionCommand": {"missionId": first, "command": f"COMMAND_{command}"}}
        log.call(method, params)
    log.settle()
    return log


MIXED = ("AppendMission", "UpdateMission", "SkipGoal", "AppendMission", "ClearMissionStatus", "UpdateMission")


@pytest.mark.parametrize(
    ("many", "methods"),
    [
        (20, ("AppendMission",)),
        (40, ("AppendMission",)),
        (100, ("AppendMission",)),
        (300, ("AppendMission",)),
        (48, MIXED),
    ],
    ids=["20 appends", "40 appends", "100 appends", "300 appends", "48 of several kinds"],
)
def test_bench_traffic_lost(tmp_path: Path, many: int, methods: tuple[str, ...]) -> None:
    """Calls that are never answered; the messages that they cause come."""
    log = unanswered(many, methods)
    lines = [line for line in log.history if line.get("return", 0) < 3]
    shown(f"{many} lost", written(tmp_path / "log.jsonl", lines))


def test_bench_traffic_timed_out(tmp_path: Path) -> None:
    """A hundred and fifty appends whose deadline passed, two in three of which took effect."""
    log = unanswered(150, ("AppendMission",))
    passed = {"status": "DEADLINE_EXCEEDED", "message": ""}
    lines = [{"return": one["return"], "error": passed} if one.get("return", 0) > 2 else one for one in log.history]
    for number in range(3, 220, 3):
        place = next((at for at, one in enumerate(lines) if one.get("return") == number), len(lines))
        more = [{"call": 1_000 + number, "method": "AppendMission", "params": navigate("table-2")}]
        lines[place:place] = [*more, {"return": 1_000 + number, "error": passed}]
    shown("appends that timed out", written(tmp_path / "log.jsonl", lines))


@pytest.mark.parametrize("alike", [True, False], ids=["alike", "of three kinds"])
def test_bench_traffic_overlapping(tmp_path: Path, *, alike: bool) -> None:
    """Twenty appends that are all on their way at once; their answers come in another order."""
    log = unanswered(20, ("AppendMission",))
    calls = [one for one in log.lines if one.get("call", 0) > 2]
    for one in calls if alike else ():
        one["params"] = navigate("table-1")
    answers = [one for one in log.lines if one.get("return", 0) > 2]
    messages = [one for one in log.lines if "message" in one][2:]
    for message in messages if alike else ():
        for mission in message["message"]["missionStates"]["missions"][1:]:
            mission["goals"] = [{"destinationId": "table-1"}]
    begun = log.history[: log.history.index(calls[0])]
    Random(1).shuffle(answers)
    shown("20 overlapping appends", written(tmp_path / "log.jsonl", [*begun, *calls, *answers, *messages]))


@pytest.mark.parametrize("robots", [50, 500])
def test_bench_traffic_fleet_stream(tmp_path: Path, robots: int) -> None:
    """One stream of the batteries of many robots, ten reports of each, nothing driven."""
    status = system("bear.status")
    names = [f"r{number}" for number in range(robots)]
    battery = {"chargePercent": 75, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"}
    state = {"connection": {"state": "STATE_CONNECTED"}, "battery": battery}
    world = {
        "robots": [
            {"robotId": name, "locationId": "L1", "owned": True, "state": state, "wifi": None} for name in names
        ],
        "locations": [{"locationId": "L1", "owned": True}],
    }
    reference = ReferenceSubject(status)
    reference.exchange("reset", {"world": world})
    params = {"selector": {"robotIds": {"ids": names}}}
    opened = reference.exchange("SubscribeBatteryStatus", params)
    lines: list[Any] = [{"missionfsm": 1, "system": "bear.status", "world": world}]
    lines += [{"call": 1, "method": "SubscribeBatteryStatus", "params": params}, {"return": 1, "result": opened.result}]
    lines += [one.params for one in opened.after]
    for percent in range(74, 64, -1):
        for name in names:
            report = {
                "event": "report",
                "robotId": name,
                "part": "battery",
                "value": {**battery, "chargePercent": percent},
            }
            lines += [one.params for one in reference.exchange("drive", report).after]
    shown(f"{robots} robots", written(tmp_path / "log.jsonl", lines))


def test_bench_traffic_independent_missions(tmp_path: Path) -> None:
    """A hundred missions of as many robots, none of which is there, and a minute that passes."""
    drives = ["connect", "line", "disconnect", "advance"]
    lines: list[Any] = [{"missionfsm": 1, "system": "isaac.server", "world": {}, "drives": drives}]
    for number in range(1, 101):
        lines.append({"call": number, "method": "submit", "params": {"mission": {"robot": f"r{number}"}}})
        lines.append({"return": number, "result": {"mission": number}})
    lines += [{"drive": {"event": "advance", "seconds": 60}}, {"settled": True}]
    shown("100 independent missions", written(tmp_path / "log.jsonl", lines))


@pytest.mark.parametrize("pairs", [4, 8, 16])
def test_bench_traffic_missions_in_pairs(tmp_path: Path, pairs: int) -> None:
    """Missions of one robot, each with one of another that waits for it, all of which may time out at one moment."""
    drives = ["connect", "line", "disconnect", "advance"]
    lines: list[Any] = [{"missionfsm": 1, "system": "isaac.server", "world": {}, "drives": drives}]
    for number in range(1, 2 * pairs + 1):
        mission = {"robot": "r"} if number <= pairs else {"robot": "q", "upstream": [number - pairs]}
        lines.append({"call": number, "method": "submit", "params": {"mission": mission}})
        lines.append({"return": number, "result": {"mission": number}})

    def said(connection: int, channel: str, payload: MissionStatusProto | TextProto) -> dict[str, Any]:
        line = encode(Message(Header(channel), payload)).decode().strip()
        return {"drive": {"event": "line", "connection": connection, "line": line}}

    for connection, robot in ((1, "r"), (2, "q")):
        lines.append({"drive": {"event": "connect", "connection": connection}})
        lines.append(said(connection, "name", TextProto(robot)))
    for number in range(1, pairs + 2):
        due = [(1, Uuid(number, 1))] if number <= pairs else []
        due += [(2, Uuid(number - 1, 2))] if number > 1 else []
        lines.append({"drive": {"event": "advance", "seconds": 1}})
        for connection, uuid in due:
            sent = Message(Header("mission", 1, 1, Uuid(len(lines), 3)), MissionProto(uuid, "{}"))
            lines.append({"connection": connection, "line": encode(sent).decode().strip()})
        for status in (WireStatus.RUNNING, WireStatus.SUCCESS):
            lines += [said(connection, "mission_status", MissionStatusProto(uuid, status)) for connection, uuid in due]
            lines.append({"drive": {"event": "advance", "seconds": 1}})
    shown(f"{pairs} pairs of missions", written(tmp_path / "log.jsonl", [*lines, {"settled": True}]))


@pytest.mark.parametrize("missions", [1_000, 2_000, 4_000])
def test_bench_traffic_list_that_nobody_watches(tmp_path: Path, missions: int) -> None:
    """Missions that are created one after another, every one of which stays listed; nothing else is known."""
    lines: list[Any] = [{"missionfsm": 1, "system": "bear.mission", "world": {"family": "servi"}}]
    for number in range(1, missions + 1):
        lines.append({"call": number, "method": "CreateMission", "params": navigate(f"table-{number % 3 + 1}")})
        lines.append({"return": number, "result": {"missionId": f"mission-{number}"}})
    shown(f"{missions} missions that nobody watches", written(tmp_path / "log.jsonl", lines))


def test_bench_traffic_list_that_is_never_cleared(tmp_path: Path) -> None:
    """2,400 missions one after another, every one of which stays listed, and now and then somebody looks."""
    log = Recorder(drives=True)
    path = tmp_path / "log.jsonl"
    with path.open("wb") as file:
        file.write(orjson.dumps(log.head) + b"\n")
        for number in range(2_400):
            log.call("CreateMission", navigate(f"table-{number % 3 + 1}"))
            log.drive(event="goalReached")
            if not number % 200:
                log.call(SUBSCRIBE)
                log.call("cancel", {"stream": log.streams[-1]})
            file.writelines(orjson.dumps(line) + b"\n" for line in log.lines)
            log.lines.clear()
    shown("2,400 missions", path)
