"""All pictures, and what the programs that diagrams are written for make of them."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from missionfsm import systems
from missionfsm.kernel.picture import Plan
from missionfsm.tools.draw.gallery import FORMATS, Picture, Wanted, of_plan, pictures
from missionfsm.tools.draw.machines import event

NPM = Path(__file__).parent / "npm"
ODD = (
    "a",
    'b"c',
    "<b>",
    "</table>",
    r"d\ne",
    "f;g",
    "#h",
    "`i`",
    "[j]",
    "{k}",
    "l|m",
    "ö→☃",
    "n\no",
    "--> p",
    "&amp;",
    "%% q",
)
_COLOUR = re.compile(r"-\[#\w+\]->")


@pytest.fixture(scope="session")
def gallery() -> dict[str, Picture]:
    """Every picture that is drawn where nothing is asked for in particular, by its id."""
    return {one.id: one for name in systems.names() for one in pictures(systems.system(name), Wanted())}


@pytest.fixture(scope="session")
def charts(gallery: dict[str, Picture]) -> dict[str, Picture]:
    """Those that show a lifecycle."""
    return {name: one for name, one in gallery.items() if one.chart}


@pytest.fixture(scope="session")
def odd() -> Picture:
    """A plan whose robots are called what means something in one format or another."""
    missions = tuple((name, f"{name}{name}") for name in ODD)
    return of_plan("isaac.server", Plan("odd", 'names | like "these"', missions, ((), *((0,) for _ in missions[1:]))))


@pytest.fixture(scope="session")
def readers(gallery: dict[str, Picture], charts: dict[str, Picture], odd: Picture) -> dict[str, dict[str, Any]]:
    """What Mermaid, a parser of PlantUML, SCION and XState understood of every picture."""
    if not shutil.which("node"):
        pytest.skip("Node.js is not installed, which runs the readers of Mermaid, PlantUML, SCXML and XState")
    if not (NPM / "node_modules").is_dir():
        pytest.skip("the npm packages are not installed: npm install --no-package-lock in tests/diagrams/npm")
    drawn = {**gallery, odd.id: odd}
    job: dict[str, Any] = {
        form: {name: FORMATS[form].write(one) for name, one in some.items()}
        for form, some in (("mermaid", drawn), ("plantuml", drawn), ("scxml", charts), ("xstate", charts))
    }
    # The parser on npm knows no colours; plantuml itself does.
    job["plantuml"] = {name: _COLOUR.sub("-->", text) for name, text in job["plantuml"].items()}
    job["events"] = {name: [event(one) for one in shown.chart.triggers] for name, shown in charts.items()}
    done = subprocess.run(
        ["node", str(NPM / "readers.mjs")], input=json.dumps(job), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, dict[str, Any]] = json.loads(done.stdout)
    return found
