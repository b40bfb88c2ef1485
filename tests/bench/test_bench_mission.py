"""How fast the mission API's model and its oracle are.

Run with ``pytest -o addopts= tests/bench/test_bench_mission.py -s``; skipped otherwise. Nothing is asserted of times.
"""

from __future__ import annotations

import sys
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import orjson
import pytest
from days import HEAD, MISSION, WORLD, day
from transitions import Machine

from missionfsm.adapters.historyfile import fingerprint
from missionfsm.app.many import histories, judge_files
from missionfsm.app.recorded import check_file
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.chart import Chart
from missionfsm.kernel.history import Event
from missionfsm.kernel.readings import UNCONSTRAINED, choose
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.transcript import Head, Transcript
from missionfsm.tools.check.judge import check
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.explore.explore import Actions, reachable, steps
from missionfsm.tools.reference.model import Reference
from missionfsm.tools.reference.subject import ReferenceSubject

SPEC = MISSION.spec
DEFAULT = choose(SPEC.ambiguities)
LINES = 200_000


def rate(times: int, work: Callable[[], object]) -> float:
    """How often something is done a second, at best of five."""
    took = []
    for _ in range(5):
        began = time.perf_counter()
        work()
        took.append(time.perf_counter() - began)
    return times / min(took)


# The model against `transitions`.


def triggers(times: int) -> Callable[[], None]:
    """So many triggers with one condition of a `transitions` machine."""
    chart = Chart("switch", "off", (("turn", "off", "on"), ("turn", "on", "off")))
    machine = Machine(
        states=["off", "on"],
        initial="off",
        transitions=[[trigger, source, end, lambda: True] for trigger, source, end in chart.table],
        auto_transitions=False,
    )

    def run() -> None:
        for _ in range(times):
            machine.turn()

    return run


def asked(*, whole: bool, times: int) -> Callable[[], None]:
    """So many requests to the model: what it answers in a state, or the whole next snapshot with what is seen of it."""
    model = Reference(MISSION)
    here = model.start(MISSION.codec.read_world(WORLD))
    names, rest = MISSION.codec.split_request("SkipGoal", {})
    params = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
    create = MISSION.codec.read_request("CreateMission", params)
    here, _ = model.call(here, create)
    skip = MISSION.codec.read_request("SkipGoal", rest)
    assert names == ()

    def steps_alone() -> None:
        state = here.state
        for _ in range(times):
            model.outcome(state, skip)

    def calls() -> None:
        for _ in range(times):
            model.call(here, skip)

    return calls if whole else steps_alone


def test_bench_mission_a_step_of_the_model(benchmark: Any) -> None:
    """A step of the model against a trigger with one condition of `transitions`, in the same run."""
    times = 20_000
    trigger = rate(times, triggers(times))
    step = rate(times, asked(whole=False, times=times))
    call = rate(times, asked(whole=True, times=times))
    benchmark.pedantic(asked(whole=False, times=times), rounds=5)
    print(
        f"\na trigger {trigger:,.0f}/s; a step of the model {step:,.0f}/s, {step / trigger:.1f} times that;"
        f" a whole call {call:,.0f}/s, {call / trigger:.1f} times that"
    )


# Exploration.


@pytest.mark.parametrize(
    ("bounds", "assumed", "forgetting"),
    [
        (Bounds(3, goals=2, batch=2), DEFAULT, False),
        (Bounds(4, goals=2, batch=2), DEFAULT, False),
        (Bounds(3, goals=2, batch=2), UNCONSTRAINED, False),
        (Bounds(6, goals=2, batch=2), DEFAULT, True),
        (Bounds(6, goals=2, batch=2), UNCONSTRAINED, True),
    ],
    ids=[
        "3 missions",
        "4 missions",
        "3 missions, all readings",
        "6 missions, counted",
        "6 missions, counted, all readings",
    ],
)
def test_bench_mission_exploration(benchmark: Any, bounds: Bounds, assumed: int, *, forgetting: bool) -> None:
    """Distinct states a second, every refusal tried in every situation; and with every state read as a value."""
    alphabet = MISSION.alphabet(WORLD, bounds)
    actions = Actions.from_alphabet(MISSION, alphabet.core_inputs, alphabet.core_drives)
    start = SPEC.initial(MISSION.codec.read_world(WORLD))
    found = benchmark.pedantic(
        reachable, (SPEC, start, actions, bounds.size, assumed), {"forget_ended": forgetting}, rounds=3
    )
    began = time.perf_counter()
    states = len(set(found))
    reading = time.perf_counter() - began
    best = benchmark.stats.stats.min
    looked_at = states / (best + reading)
    print(f"\n{states:,} states, {states / best:,.0f} a second; {looked_at:,.0f} when all are looked at")


def test_bench_mission_exploration_step_by_step(benchmark: Any) -> None:
    """Distinct states a second without the shortcut: every outcome of every call as a step with names and messages."""
    bounds = Bounds(2, goals=2, batch=2)
    alphabet = MISSION.alphabet(WORLD, bounds)
    actions = Actions.from_alphabet(MISSION, alphabet.core_inputs, alphabet.core_drives)
    start = SPEC.initial(MISSION.codec.read_world(WORLD))
    states = list(reachable(SPEC, start, actions, bounds.size, DEFAULT))

    def every_step() -> int:
        return sum(1 for here in states for _ in steps(SPEC, here, actions))

    taken = benchmark.pedantic(every_step, rounds=3)
    best = benchmark.stats.stats.min
    print(f"\n{len(states) / best:,.0f} states a second, {taken / best:,.0f} steps a second")


# Histories.


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A day's log of one robot."""
    return written(tmp_path_factory.mktemp("logs") / "day.jsonl", LINES)


def written(path: Path, lines: int) -> Path:
    with path.open("wb") as file:
        file.writelines(orjson.dumps(line) + b"\n" for line in (HEAD, *day(lines)))
    return path


def observed(automaton: Automaton, events: list[Event]) -> None:
    belief = Belief(automaton, MISSION.codec.read_world(WORLD))
    for event in events:
        assert belief.observe(event)


def test_bench_mission_events_in_memory(benchmark: Any) -> None:
    """Events a second on an automaton that knows them."""
    transcript = Transcript(MISSION.codec, fingerprint)
    events = [event for line in day(LINES) for event in transcript.read(line)]
    automaton = Automaton(SPEC, HEAD["drives"])
    observed(automaton, events)
    benchmark.pedantic(observed, (automaton, events), rounds=5)
    print(f"\n{len(events) / benchmark.stats.stats.min:,.0f} events a second, {automaton.size} nodes and edges")


def test_bench_mission_events_from_a_file(benchmark: Any, log: Path) -> None:
    """Lines a second from a JSONL file to a verdict."""
    ((_, verdict),) = benchmark.pedantic(check_file, (str(log),), rounds=5)
    assert verdict.conforms
    print(f"\n{LINES / benchmark.stats.stats.min:,.0f} lines a second")


@pytest.mark.parametrize("known", ["anywhere", "others"])
def test_bench_mission_events_of_a_log_that_has_not_all(benchmark: Any, log: Path, known: str) -> None:
    """The same where the log may begin anywhere, or others use the robot, as a ratio to one of which all is known."""
    whole = rate(1, lambda: check_file(str(log)))
    ((_, verdict),) = benchmark.pedantic(check_file, (str(log),), {known: True}, rounds=3)
    assert verdict.conforms
    print(
        f"\n{LINES / benchmark.stats.stats.min:,.0f} lines a second, {1 / benchmark.stats.stats.min / whole:.2f} times"
    )


@pytest.mark.parametrize("robots", ["files", "in one file"])
def test_bench_mission_a_folder_of_days(benchmark: Any, tmp_path: Path, robots: str) -> None:
    """Four robots' logs, each a file or all in one, in two processes: as a ratio to the same in one process."""
    if robots == "files":
        for robot in range(4):
            written(tmp_path / f"{robot}.jsonl", LINES // 4)
    else:
        days = [({**line, "robot": f"r{robot}"} for line in day(LINES // 4)) for robot in range(4)]
        with (tmp_path / "day.jsonl").open("wb") as file:
            file.write(orjson.dumps(HEAD) + b"\n")
            file.writelines(orjson.dumps(line) + b"\n" for lines in zip(*days, strict=True) for line in lines)
    files = histories([str(tmp_path)])
    alone = rate(LINES, lambda: list(judge_files(files, {}, jobs=1)))
    found = benchmark.pedantic(lambda: list(judge_files(files, {}, jobs=2)), rounds=3)
    assert [verdict.conforms for one in found for _, verdict in one.verdicts] == [True] * 4
    together = LINES / benchmark.stats.stats.min
    print(f"\n{alone:,.0f} lines a second in one process, {together:,.0f} in two: {together / alone:.2f} times")


def test_bench_mission_memory_of_a_long_file(benchmark: Any, tmp_path: Path) -> None:
    """The most memory that judging a file needs, for a file and for one ten times as long (up to a million lines)."""
    peaks = {}
    for lines in (100_000, 1_000_000):
        path = tmp_path / f"{lines}.jsonl"
        with path.open("wb") as file:
            file.write(orjson.dumps(HEAD) + b"\n")
            for line in day(lines):
                file.write(orjson.dumps(line) + b"\n")
        tracemalloc.start()
        check_file(str(path))
        peaks[lines] = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        path.unlink()
    benchmark.pedantic(lambda: None, rounds=1)
    print("\n" + ", ".join(f"{lines:,} lines: {peak / 1e6:.2f} MB at most" for lines, peak in peaks.items()))


# Calls that are never answered.


def _delivery(number: int) -> Any:
    goals = [{"destinationId": f"table-{number % 3 + 1}"}]
    return {"mission": {"serviMission": {"deliveryMission": {"goals": goals}}}}


def twelve_lost(*, appends: bool) -> tuple[list[Any], frozenset[int]]:
    """Two hundred calls, among them twelve that are never answered."""
    lines: list[Any] = []
    lost = []
    for number in range(47):
        name, base = f"m{number}", 10 * number
        lines.append({"call": base + 1, "method": "CreateMission", "params": _delivery(number)})
        lines.append({"return": base + 1, "result": {"missionId": name}})
        if number < 12:
            lost.append(base + 2)
            method = "AppendMission" if appends and number % 2 else "SkipGoal"
            lines.append({"call": base + 2, "method": method, "params": _delivery(1) if method != "SkipGoal" else {}})
        for serial, command in ((3, "PAUSE"), (4, "CANCEL")):
            params = {"missionCommand": {"missionId": name, "command": f"COMMAND_{command}"}}
            lines.append({"call": base + serial, "method": "UpdateMission", "params": params})
            lines.append({"return": base + serial, "result": {}})
        lines.append({"call": base + 5, "method": "ClearMissionStatus", "params": {}})
        lines.append({"return": base + 5, "result": {"missionIds": [name]}})
    return lines, frozenset(lost)


@pytest.mark.parametrize("appends", [False, True], ids=["skips", "skips and appends"])
@pytest.mark.parametrize("decided", [True, False], ids=["default readings", "all readings"])
def test_bench_mission_twelve_lost_among_two_hundred(benchmark: Any, *, appends: bool, decided: bool) -> None:
    """How long it takes to decide two hundred calls of which twelve were never answered."""
    lines, lost = twelve_lost(appends=appends)
    readings = {one.id: one.default for one in SPEC.ambiguities} if decided else {}
    head = Head(SPEC.system, WORLD, tuple(SPEC.drives))
    verdict = benchmark.pedantic(check, (MISSION, head, lines), {"lost": lost, "readings": readings}, rounds=3)
    print(f"\n{verdict.outcome.value} in {benchmark.stats.stats.min * 1e3:.1f} ms")


def test_bench_mission_sixteen_lost_and_an_impossible_answer(benchmark: Any) -> None:
    """How long it takes to refute an answer that sixteen lost calls do not explain."""
    lines: list[Any] = [
        {"call": number, "method": "CreateMission", "params": _delivery(number)} for number in range(1, 17)
    ]
    lines.append({"call": 20, "method": "ClearMissionStatus", "params": {}})
    lines.append({"return": 20, "result": {"missionIds": [f"m{number}" for number in range(17)]}})
    head = Head(SPEC.system, WORLD, tuple(SPEC.drives))
    verdict = benchmark.pedantic(check, (MISSION, head, lines), {"lost": frozenset(range(1, 17))}, rounds=3)
    print(f"\n{verdict.outcome.value} in {benchmark.stats.stats.min * 1e3:.1f} ms")


def test_bench_mission_conform(benchmark: Any) -> None:
    """Events a second of a whole run of ``conform`` with the reference in this process, search included."""
    verdict = benchmark.pedantic(conform, (MISSION, ReferenceSubject(MISSION)), {"drawn": 50, "seed": 1}, rounds=1)
    print(f"\n{verdict.events / benchmark.stats.stats.min:,.0f} events a second on {sys.platform}")
