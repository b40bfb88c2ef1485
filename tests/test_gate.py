"""The gate says what happened: it ends with 0 when all is well, and with what failed otherwise."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

GATE = Path(__file__).resolve().parent.parent / ".ci/run"

if not GATE.exists() or not shutil.which("bash"):  # the sdist has the tests without the gate
    pytest.skip("there is no gate here", allow_module_level=True)

OPENING, _, REST = GATE.read_text(encoding="utf-8").partition("scratch=$(mktemp -d)\n")
[SHELL] = [line for line in OPENING.splitlines() if line.startswith("set ")]
[LEAVING] = [line for line in REST.splitlines() if line.startswith("trap ")]


@pytest.mark.parametrize(
    ("does", "status"),
    [("true", 0), ("false", 1), ("(exit 7)", 7), ("sleep 60 &", 0), ("sleep 60 & (exit 7)", 7), ("true & wait $!", 0)],
    ids=["nothing", "fails", "seven", "left", "left-and-seven", "ended"],
)
def test_the_gate_ends_with_what_its_last_command_said(tmp_path: Path, does: str, status: int) -> None:
    """Whether something still runs in the background changes neither the exit status nor that all is tidied up."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    script = "\n".join((SHELL, f"scratch={scratch}", LEAVING, does))
    assert subprocess.run(["bash", "-c", script], check=False, timeout=30).returncode == status
    assert not scratch.exists()
