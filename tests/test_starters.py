"""The starter adapters in ``examples/adapters``: short, and they conform as far as they declare."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from missionfsm import conform

STARTERS = Path(__file__).parent.parent / "examples" / "adapters"
GSON = Path("/usr/share/java/gson.jar")
CRATES = Path("/usr/share/cargo/registry")


def _built(*command: str | Path, **more: Any) -> None:
    ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300, **more)
    assert ran.returncode == 0, ran.stderr


def _python(_: Path) -> list[str]:
    return [sys.executable, str(STARTERS / "python" / "adapter.py")]


def _node(_: Path) -> list[str]:
    return ["node", str(STARTERS / "node" / "adapter.mjs")]


def _go(folder: Path) -> list[str]:
    _built("go", "build", "-o", folder / "adapter", STARTERS / "go" / "adapter.go")
    return [str(folder / "adapter")]


def _rust(folder: Path) -> list[str]:
    shutil.copytree(STARTERS / "rust", folder / "rust", ignore=shutil.ignore_patterns("target"))
    debian = "source.crates-io.replace-with='debian'", f"source.debian.directory='{CRATES}'"
    _built("cargo", "build", "--offline", "--config", debian[0], "--config", debian[1], cwd=folder / "rust")
    return [str(folder / "rust" / "target" / "debug" / "adapter")]


def _java(folder: Path) -> list[str]:
    _built("javac", "-cp", GSON, "-d", folder, STARTERS / "java" / "Adapter.java")
    return ["java", "-cp", f"{GSON}:{folder}", "Adapter"]


LANGUAGES: dict[str, tuple[Callable[[Path], list[str]], str, Path | None]] = {
    "python": (_python, "python3", None),
    "node": (_node, "node", None),
    "go": (_go, "go", None),
    "rust": (_rust, "cargo", CRATES),
    "java": (_java, "javac", GSON),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "language", [pytest.param(one, marks=pytest.mark.long) if one in ("rust", "java") else one for one in LANGUAGES]
)
def test_a_starter_conforms(language: str, tmp_path: Path) -> None:
    """Where its toolchain is installed, a starter is built and conforms, and nothing about it is flagged."""
    command, program, library = LANGUAGES[language]
    if shutil.which(program) is None or (library is not None and not library.exists()):
        pytest.skip(f"{program} or its JSON library is not installed")
    starts = command(tmp_path)
    verdict = conform("bear.mission", starts, examples=12, seed=1)
    assert (verdict.conforms, verdict.flagged) == (True, ())
    assert verdict.events > 50


@pytest.mark.parametrize(
    ("path", "most"),
    [
        ("python/adapter.py", 100),
        ("node/adapter.mjs", 100),
        ("go/adapter.go", 100),
        ("rust/src/main.rs", 150),
        ("java/Adapter.java", 150),
    ],
)
def test_a_starter_is_short(path: str, most: int) -> None:
    """A starter is read in a few minutes: so many lines, blank ones and comments among them."""
    lines = (STARTERS / path).read_text().splitlines()
    assert len(lines) < most
    assert max(map(len, lines)) <= 120
