"""The example in ``examples/lift``: a system of somebody else, with an implementation whose bugs its oracle finds."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

LIFT = Path(__file__).parent.parent / "examples" / "lift"


@pytest.mark.long
def test_its_own_tests_pass(tmp_path: Path) -> None:
    """Installed like any package, the lift is known by name, its building conforms, and all nine bugs are found."""
    about = tmp_path / "lift-0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: lift\nVersion: 0\n")
    (about / "entry_points.txt").write_text("[missionfsm.systems]\nlift = lift.system:SYSTEM\n")
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"],
        cwd=LIFT,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (LIFT, tmp_path, LIFT.parent.parent)))},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert (ran.returncode, "14 passed" in ran.stdout) == (0, True), ran.stdout
