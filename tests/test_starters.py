"""The starter adapters in ``examples/adapters``: short, and they conform as far as they declare."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from attrs import evolve

from missionfsm import conform
from missionfsm.adapters.stdio import Child
from missionfsm.bear.mission.inputs import Defect
from missionfsm.kernel.alphabet import Alphabet, Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System
from missionfsm.systems import system

STARTERS = Path(__file__).parent.parent / "examples" / "adapters"
GSON = Path("/usr/share/java/gson.jar")
CRATES = Path("/usr/share/cargo/registry")
NO_CODE = re.compile(r"\s*(//.*|#.*|/\*\*.*)?$")


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


def declared(command: list[str]) -> dict[str, Any]:
    """What a starter says of itself."""
    child = Child(command)
    try:
        return dict(child.exchange("initialize", {"protocolVersion": 1, "system": "bear.mission"}).result)  # type: ignore[arg-type]
    finally:
        child.close()


def as_declared(judged: System, has: dict[str, Any]) -> System:
    """The system with no more to try than a starter declares."""

    def sayable(method: str, params: JSON) -> bool:
        wrong = judged.codec.request(method, params).defects if method in judged.codec.methods else ()
        return method in (*has["methods"], "settle", "cancel") and not {Defect.FORMAT, Defect.FIELD} & set(wrong)

    def alphabet(world: JSON, bounds: Bounds) -> Alphabet:
        whole = judged.alphabet(world, bounds)
        return evolve(
            whole,
            prompts=tuple(one for one in whole.prompts if sayable(one.method, one.params)),
            plain=tuple(one for one in whole.plain if sayable(one.method, one.params)),
            worlds=(has["world"],),
            scripts=(),
        )

    return evolve(judged, alphabet=alphabet)


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_a_starter_conforms(language: str, tmp_path: Path) -> None:
    """Where its toolchain is installed, a starter is built and conforms, and nothing about it is flagged."""
    command, program, library = LANGUAGES[language]
    if shutil.which(program) is None or (library is not None and not library.exists()):
        pytest.skip(f"{program} or its JSON library is not installed")
    starts = command(tmp_path)
    verdict = conform(as_declared(system("bear.mission"), declared(starts)), starts, examples=2, tours=3, seed=1)
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
    """A starter is read in a few minutes: so many lines of code, without blank lines and comments."""
    lines = (STARTERS / path).read_text().splitlines()
    assert sum(not NO_CODE.match(line) for line in lines) < most
    assert max(map(len, lines)) <= 120
