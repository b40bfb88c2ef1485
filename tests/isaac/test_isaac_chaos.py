"""Robots that drop, hang and split their lines, and a server that is killed: every mission ends exactly once.

``MISSIONFSM_CHAOS=200x5000`` sets how many robots and missions there are.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from fleet import BAD, Size, doubled, mission_file, run

from missionfsm.isaac.runtime.missions import RESUME, Status

SIZE = Size.read(os.environ.get("MISSIONFSM_CHAOS", "20x200"))
KILLS = 3


@pytest.mark.long
@pytest.mark.parametrize("resume", RESUME)
def test_every_mission_ends_exactly_once_whatever_robots_do_and_whenever_the_server_dies(
    tmp_path: Path, resume: str
) -> None:
    """Killed three times and started again on its journal, it loses no mission, ends none twice and runs none twice."""
    missions = mission_file(SIZE, seed=3, start_timeout=1.0, timeout=1.0)
    run_through = run(tmp_path, missions, SIZE.robots, "--resume", resume, temper=BAD, kills=KILLS, seed=5)
    assert (run_through.status, run_through.kills) == (1, KILLS)  # some missions failed
    final = [one.status for one in run_through.journal]
    assert len(final) == SIZE.missions
    assert [number for number, status in enumerate(final) if not status.terminal] == []
    told = {number: (final[number].value,) for number in run_through.ends}
    assert run_through.ends == told
    assert doubled(run_through) == []
    numbers = {one.attempt: number for number, one in enumerate(run_through.journal)}
    by_uuid = {one.uuid: status for one, status in zip(run_through.journal, final, strict=True)}
    for uuid, mood in run_through.sent:
        if uuid in numbers:  # an attempt that was under way when the server died is nobody's under rerun
            one = run_through.journal[numbers[uuid]]
            assert {by_uuid[upstream] for upstream in one.request.upstream} <= {Status.SUCCESS}
            assert mood == "success" or one.status is not Status.SUCCESS
