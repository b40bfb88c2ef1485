"""A whole fleet on loopback, the server as a process of its own: memory, missions a second, what a mission costs.

Run with ``pytest -o addopts= tests/bench/test_bench_isaac_fleet.py -s``; ``MISSIONFSM_FLEET=10000x100000`` sets how
many robots and missions there are at most (each robot is two open files: see ``ulimit -n``).
"""

import os
import resource
from pathlib import Path
from typing import Any

from fleet import Size, doubled, mission_file, run

SIZE = Size.read(os.environ.get("MISSIONFSM_FLEET", "1000x10000"))


def processor() -> float:
    """Seconds of processor time of all child processes so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def test_bench_isaac_a_fleet_on_loopback(benchmark: Any, tmp_path: Path) -> None:
    """As many robots with no mission, a tenth of the missions, all of them: what a mission costs does not grow."""
    found: dict[int, tuple[float, float, float]] = {}

    def fleets() -> None:
        for missions in (1, SIZE.missions // 10, SIZE.missions):
            folder = tmp_path / str(missions)
            folder.mkdir()
            before = processor()
            file = mission_file(Size(SIZE.robots, missions), seed=1, start_timeout=600.0)
            outcome = run(folder, file, SIZE.robots, "--log-level", "error")
            assert (outcome.status, len(outcome.sent), doubled(outcome)) == (0, missions, [])
            memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
            found[missions] = (processor() - before, outcome.seconds, memory)

    benchmark.pedantic(fleets, rounds=1)
    (idle, _, _), *busy = found.values()
    print(f"\n{SIZE.robots:,} robots; the server alone, without its start:")
    for missions, (used, seconds, memory) in zip([*found][1:], busy, strict=True):
        cost = (used - idle) / missions * 1e6
        print(f"{missions:>9,} missions: {cost:,.0f} µs each, {missions / seconds:,.0f} a second, {memory:,.0f} MB")
