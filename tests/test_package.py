"""What is published: a wheel and an sdist that are whole, and the README as a package index shows it."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
import tarfile
import zipfile
from email import message_from_bytes
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MAIN = re.search(r"<!-- ci: main -->\n```bash\n(.*?)\n```", (ROOT / "README.md").read_text(), re.DOTALL)
REPOSITORY = "https://example.org/robots/missionfsm"
RELATIVE = re.compile(r"\]\((?!https?:)")


def ran(*command: str | Path, cwd: Path) -> str:
    """What a command says; it succeeds."""
    found = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False, timeout=300)
    assert found.returncode == 0, found.stdout + found.stderr
    return found.stdout


def sources(*folders: str) -> set[str]:
    """The files of some folders that belong to the project, as paths from its root."""
    found = (path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file())
    own = (path.relative_to(ROOT) for path in found)
    unwanted = {"__pycache__", "node_modules", "target"}
    return {str(path) for path in own if not unwanted & set(path.parts) and not any(p[0] == "." for p in path.parts)}


def test_the_readme_on_an_index_leads_to_the_repository_that_is_named() -> None:
    """Links and picture have the address; without one the text of links is left, and no link or picture is broken."""
    hook = runpy.run_path(str(ROOT / "hatch_build.py"))
    readme = (ROOT / "README.md").read_text()
    without, within = hook["shown"](readme, ""), hook["shown"](readme, REPOSITORY)
    assert (RELATIVE.findall(without), RELATIVE.findall(within), "<!--" in without + within) == ([], [], False)
    assert ("demo.svg" in without, f"]({REPOSITORY}/raw/HEAD/docs/demo.svg)\n\n" in within) == (False, True)
    paths = re.findall(rf"\]\({REPOSITORY}/(?:blob|raw)/HEAD/([^)#]*)", within)
    assert len(paths) > 10
    assert [path for path in paths if not (ROOT / path).exists()] == []
    # What an index shows is the README but for where its links lead.
    assert re.sub(rf"{REPOSITORY}/(?:blob|raw)/HEAD/", "", within) == re.sub(r"<!-- [^>]* -->\n", "", readme)
    assert hook["urls"]("") == {}
    assert set(hook["urls"](REPOSITORY)) == {"Repository", "Issues", "Documentation", "Changelog"}


@pytest.mark.long
def test_what_is_built_is_whole_and_works_where_nothing_else_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sdist has tests, pages and specifications, and the wheel made from it is installed and does the main job."""
    assert MAIN is not None
    monkeypatch.setenv("MISSIONFSM_REPOSITORY", REPOSITORY)
    ran(sys.executable, "-m", "build", "--no-isolation", "--outdir", tmp_path, ROOT, cwd=tmp_path)
    (sdist,), (wheel,) = tmp_path.glob("*.tar.gz"), tmp_path.glob("*.whl")
    ran(sys.executable, "-m", "twine", "check", "--strict", sdist, wheel, cwd=tmp_path)
    with tarfile.open(sdist) as archive:
        packed = {name.partition("/")[2] for name in archive.getnames()}
    assert sources("tests", "docs", "specs", "examples", "diagrams", "missionfsm") - packed == set()
    with zipfile.ZipFile(wheel) as archive:
        installed = set(archive.namelist())
        (metadata,) = (name for name in installed if name.endswith("/METADATA"))
        about = message_from_bytes(archive.read(metadata))
        shown = about.get_payload()
    assert sources("missionfsm") - installed == set()
    assert {name.partition("/")[0] for name in installed if ".dist-info" not in name} == {"missionfsm"}
    # Relative links lead nowhere on an index, and relative pictures are broken ones.
    assert isinstance(shown, str)
    assert (shown.startswith("# missionfsm\n"), RELATIVE.findall(shown), "<!--" in shown) == (True, [], False)
    assert f"Repository, {REPOSITORY}" in about.get_all("Project-URL", [])

    job = MAIN[1].rpartition(" && ")[2]
    assert job.startswith(".venv/bin/missionfsm conform")
    clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    script = f"{sys.executable} -m venv .venv && .venv/bin/pip install -q {wheel} && {job} --seed 1 --examples 2"
    said = subprocess.run(
        ["sh", "-ec", script], cwd=tmp_path, env=clean, capture_output=True, text=True, check=False, timeout=300
    )
    assert (said.returncode, said.stdout.startswith("conforms")) == (0, True), said.stderr
