"""Recorded histories on the edge of what the page allows, each with what they are about as their name."""

from __future__ import annotations

from pathlib import Path

import pytest

from missionfsm.cli.recorded import check_file

EDGES = Path(__file__).parent / "edges"


@pytest.mark.parametrize("path", sorted(EDGES.rglob("*.jsonl")), ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_history_is_judged_right(path: Path) -> None:
    """What some consistent choice of readings explains conforms; the rest violates."""
    ((_, verdict),) = check_file(str(path))
    assert verdict.outcome.value == f"{path.parent.name}s"
