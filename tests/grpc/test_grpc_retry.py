"""Retries: what the page's advice leads to, by exploration and over gRPC."""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import Any

from commandline import CommandLine

from missionfsm.systems import system
from missionfsm.tools.explore.hazards import hazards

ROOT = Path(__file__).parents[2]
"""The repository."""
EXAMPLE: dict[str, Any] = runpy.run_path(str(ROOT / "examples" / "retry" / "retry.py"), run_name="retry")


def test_retries_are_told_for_every_failure_row() -> None:
    """Of every call with failures it is told which may be done twice, with the shortest trace."""
    found = hazards(system("bear.mission"))
    assert found.unsafe == (
        "CreateMission",
        "CreateMissionBatch",
        "CreateMissionWorkflow",
        "AppendMission",
        "AppendMissionBatch",
        "ChargeRobot",
        "SkipGoal",
    )
    rows = {(one.operation, one.code) for one in found.found}
    operations = system("bear.mission").spec.operations.values()
    assert rows == {(one.name, code) for one in operations if not one.streaming for code in one.failures}
    trace = next(one.trace for one in found.found if one.operation == "AppendMission" and one.harmful)
    assert list(trace) == [
        "CreateMission(base navigate to 'table-1') → OK",
        "AppendMission(base navigate to 'table-1') → DEADLINE_EXCEEDED, though it took effect",
        "AppendMission(base navigate to 'table-1') → OK",
    ]


def test_hazards_is_an_option_of_explore(command_line: CommandLine, tmp_path: Path) -> None:
    """The command prints the hazards and writes them as JSON; what goes with it is said in one line."""
    file = tmp_path / "hazards.json"
    found = command_line("explore", "bear.status", "--hazards", "--json", str(file))
    assert found.status == 0
    assert found.out.startswith("bear.status within")
    assert json.loads(file.read_text())["unsafe"] == []
    assert command_line("explore", "bear.mission", "--hazards", "--forget-ended").status == 2


def test_an_append_that_timed_out_is_queued_twice_by_a_client_that_follows_the_advice() -> None:
    """Who retries has more missions than it wanted, who looks first has not; the robot conforms."""
    wanted = EXAMPLE["MISSIONS"]
    missions, verdict = EXAMPLE["study"](EXAMPLE["as_advised"], 1)
    assert (missions > wanted, verdict) == (True, "conforms")
    assert EXAMPLE["study"](EXAMPLE["after_a_look"], 1) == (wanted, "conforms")
