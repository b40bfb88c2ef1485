"""The pages in ``docs/``: computed parts are as the program has them, code runs, links hold.

Run as a program it writes the computed parts: ``python tests/test_docs.py``.
"""

from __future__ import annotations

import json
import os
import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import click
import pytest
import typer
from commandline import CommandLine

from missionfsm.app.docpages import regenerate
from missionfsm.cli import app
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check

ROOT = Path(__file__).parent.parent
PAGES = sorted((ROOT / "docs").glob("*.md"))
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
RUN_SHELL = re.compile(r"<!-- run: shell -->\n```bash\n(.*?)```", re.DOTALL)
RUN_PYTHON = re.compile(r"<!-- run -->\n```python\n(.*?)```", re.DOTALL)
LINK = re.compile(r"\[[^\]]*\]\((?!https?:)([^)#\s]*)(#[^)\s]*)?\)")


def named(path: Path) -> str:
    return path.name


def blocks(kind: str) -> list[tuple[str, str]]:
    return [(path.name, text) for path in PAGES for found, text in BLOCK.findall(path.read_text()) if found == kind]


def anchors(path: Path) -> set[str]:
    """The anchors of a page, as the usual hosts make them."""
    text = path.read_text()
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    named = {f"#{name}" for name in re.findall(r'<a (?:id|name)="([^"]+)"', text)}
    return named | {"#" + re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_there_are_pages() -> None:
    """The pages that others point to are there, so that the tests below test something."""
    assert {"adapter.md", "architecture.md", "embedding.md", "history.md", "tutorial.md"} <= {
        path.name for path in PAGES
    }


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_computed_parts_are_computed(page: Path) -> None:
    """What is computed is as the program computes it."""
    assert page.read_text() == regenerate(page.read_text()), "run python tests/test_docs.py"


EVERY_PAGE = [*PAGES, *ROOT.glob("*.md"), *(ROOT / "specs").glob("*.md"), *(ROOT / "examples").rglob("*.md")]


@pytest.mark.parametrize("page", sorted(EVERY_PAGE), ids=lambda path: str(path.relative_to(ROOT)))
def test_links_hold(page: Path) -> None:
    """Every link to a file of the project, and to a heading of a page, leads somewhere."""
    broken = []
    for target, anchor in LINK.findall(page.read_text()):
        found = (page.parent / target).resolve() if target else page
        if not found.exists() or (anchor and found.suffix == ".md" and anchor not in anchors(found)):
            broken.append(target + anchor)
    assert broken == []


@pytest.mark.parametrize("text", [text for _, text in (*blocks("json"), *blocks("jsonl"))])
def test_json_that_is_shown_is_json(text: str) -> None:
    """A block of JSON is one value, or one on each line."""
    try:
        json.loads(text)
    except ValueError:
        for line in text.splitlines():
            json.loads(line)


def test_toml_that_is_shown_is_options(
    command_line: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A table of pyproject.toml that is shown has options that exist."""
    for _, text in blocks("toml"):
        (tmp_path / "pyproject.toml").write_text(text)
        monkeypatch.chdir(tmp_path)
        assert command_line("rules", "isaac.robot").status == 0


def test_the_history_that_is_shown_conforms() -> None:
    """The example of the history format is a history, and it conforms."""
    (text,) = [text for page, text in blocks("jsonl") if page == "history.md"]
    first, *lines = map(json.loads, text.splitlines())
    verdict = check(system("bear.mission"), head(first), lines)
    assert verdict.conforms
    assert verdict.events >= 10


@pytest.mark.parametrize("script", [script for path in PAGES for script in RUN_SHELL.findall(path.read_text())])
def test_shell_that_is_shown_runs(script: str, tmp_path: Path) -> None:
    """What a reader copies into a shell works."""
    tools = {**os.environ, "PATH": os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))}
    for name in ("examples", "tests"):
        if (ROOT / name).exists():
            (tmp_path / name).symlink_to(ROOT / name)
    ran = subprocess.run(
        ["sh", "-ec", script], cwd=tmp_path, env=tools, capture_output=True, text=True, check=False, timeout=120
    )
    assert ran.returncode == 0, ran.stderr + ran.stdout
    assert ran.stdout
    for page, text in blocks("text"):
        if page == "tutorial.md" and "fault.jsonl" in script:  # how the story goes depends on who answers first
            *_, found = text.split("\n\n")
            found = found[: found.index("\n", found.index("the state that it is in"))]
            assert re.sub(r"\d+", "N", found) in re.sub(r"\d+", "N", ran.stdout)
            assert ran.stdout.startswith("violates: bear.mission missionfsm reference 1")
            assert "\nfault.jsonl: violates: bear.mission" in ran.stdout


ENDS = frozenset(("|", "||", "&&", ">", "--", ";"))
"""Where a shell, or an adapter, goes on."""


def shown_commands(text: str) -> list[list[str]]:
    """The words of our commands in the shell and console blocks of a page, each up to where a shell goes on."""
    found = []
    for kind, block in BLOCK.findall(text):
        if kind not in ("bash", "console"):
            continue
        for line in block.replace("\\\n", " ").splitlines():
            after = re.match(r"(?:\$ )?(missionfsm .*)", line)
            if after:
                words = shlex.split(after[1], comments=True)
                end = min(
                    (at for at, one in enumerate(words) if one in ("|", "||", "&&", ">", "--", ";")), default=None
                )
                found.append(words[1:end])
    return found


@pytest.mark.parametrize("page", sorted(EVERY_PAGE), ids=lambda path: str(path.relative_to(ROOT)))
def test_every_command_that_is_shown_is_one(page: Path) -> None:
    """What a page shows of the command line is a command that there is, with options that it has."""
    group = typer.main.get_group(app)
    for name, *rest in shown_commands(page.read_text()):
        if name.startswith("-"):
            continue
        command = group.commands[name]
        assert [one for one in rest if one.startswith("--") and one not in known(command)] == [], (name, *rest)


def known(command: click.Command) -> set[str]:
    return {option for one in command.params for option in (*one.opts, *one.secondary_opts)}


def test_commands_that_are_shown_are_found() -> None:
    """There are such commands, so that the test above tests something."""
    assert len([one for page in EVERY_PAGE for one in shown_commands(page.read_text())]) > 30


@pytest.mark.parametrize("script", [script for path in PAGES for script in RUN_PYTHON.findall(path.read_text())])
def test_python_that_is_shown_runs(script: str) -> None:
    """What a reader copies into Python works."""
    exec(compile(script, "docs", "exec"), {})  # noqa: S102 - the page's own code


def test_the_servers_that_share_robots_are_those_of_the_simulation() -> None:
    """The table of `docs/scale.md` is what `docs/scale.py` computes: every mission ends as under one server."""
    path = ROOT / "docs" / "scale.py"
    scale = runpy.run_path(str(path))
    rows = scale["shared"](scale["Plan"].drawn(scale["ROBOTS"], scale["MISSIONS"]))
    assert "\n\n" + "\n".join(rows) + "\n\n" in path.with_suffix(".md").read_text()
    assert [row.split("|")[-2].strip() for row in rows[2:]] == ["yes"] * len(scale["SHARDS"])


if __name__ == "__main__":
    for path in PAGES:
        path.write_text(regenerate(path.read_text()))
