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
RUN_LOGS = re.compile(r"<!-- run: logs -->\n```(python|console)\n(.*?)```", re.DOTALL)
RUN_SQL = re.compile(r"<!-- run: sql -->\n```sql\n(.*?)```", re.DOTALL)
LINK = re.compile(r"\[[^\]]*\]\((?!https?:)([^)#\s]*)(#[^)\s]*)?\)")


HOUSE = ROOT / "docs" / "architecture.md"


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
        if page == "tutorial.md" and "fault.jsonl" in script:  # which story is found depends on who answers first
            assert len(re.findall(r"^(?:fault.jsonl: )?violates: bear.mission", ran.stdout, re.MULTILINE)) == 2
            assert ran.stdout.count("exit status 1") == 2
            assert re.search(r"stream \d+ showed \[.*CANCELED", ran.stdout)
            accused = {line for line in text.splitlines() if line.startswith("    - ") and line.endswith("]")}
            assert accused & set(ran.stdout.splitlines())
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


MARKED = re.compile(r"(?:<!-- (.*) -->\n)?```(bash|console|python|sql)\n")
RUNS = {
    "run": "tests/test_docs.py",
    "run: shell": "tests/test_docs.py",
    "run: logs": "tests/test_docs.py",
    "run: sql": "tests/test_docs.py",
    "run: lamp": "tests/test_newsystem.py",
    "run: grpcurl": "tests/grpc/test_grpc_page.py",
    "console": "tests/test_readme.py",
    "suite": "tests/test_readme.py",
    "ci: main": ".ci/run",
    "ci: test": ".ci/run",
}
"""What stands before a block that is run, and the file that runs it."""
NOT_RUN = re.compile(r"not run: .*?(tests/[\w/.]+|\.ci/run)")


@pytest.mark.parametrize("page", sorted(EVERY_PAGE), ids=lambda path: str(path.relative_to(ROOT)))
def test_every_block_is_run_or_says_why_not(page: Path) -> None:
    """Before each block of code stands by what it is run, or why it is not, and then what runs in its place."""
    for marker, kind in MARKED.findall(page.read_text()):
        instead = NOT_RUN.match(marker)
        by = instead[1] if instead else RUNS.get(marker)
        assert by is not None, f"{kind} after {marker!r}"
        assert (ROOT / by).exists(), by
        assert instead or f"<!-- {marker.partition(':')[0]}" in (ROOT / by).read_text(), by


@pytest.fixture
def logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder `logs` with what conforms and what does not, where the reader stands."""
    (tmp_path / "logs").mkdir()
    for verdict in ("conform", "violate"):
        some = sorted((ROOT / "tests" / "bear" / "edges" / verdict).glob("*.jsonl"))[:2]
        for one in some:
            (tmp_path / "logs" / one.name).write_bytes(one.read_bytes())
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.long
@pytest.mark.parametrize(("kind", "text"), [found for path in PAGES for found in RUN_LOGS.findall(path.read_text())])
def test_what_is_shown_of_logs_runs(kind: str, text: str, logs: Path, command_line: CommandLine) -> None:
    """Logs are judged as the page shows it: every file has a verdict, whatever judges it."""
    files = sorted(one.name for one in (logs / "logs").iterdir())
    if "dask" in text or "fleet" in text:
        pytest.importorskip("distributed", reason="the extra fleet is not installed")
    if "parquet" in text:
        pytest.importorskip("pyarrow", reason="the extra parquet is not installed")
    if kind == "python":
        (logs / "shown.py").write_text(text)
        command = [sys.executable, "shown.py"]
        told = subprocess.run(command, cwd=logs, capture_output=True, text=True, check=True, timeout=120).stdout
        assert [name for name in files if name not in told] == []
        return
    for line in text.splitlines():
        ended = command_line(*shlex.split(line.removeprefix("$ missionfsm ")))
        assert (ended.status, ended.err) == (1, "")
        assert f"{len(files)} " in ended.out


def test_the_question_to_the_table_is_answered(logs: Path, command_line: CommandLine) -> None:
    """The SQL that is shown finds the rules that are broken in the table that `--parquet` writes."""
    pytest.importorskip("pyarrow", reason="the extra parquet is not installed")
    duckdb = pytest.importorskip("duckdb", reason="DuckDB is not installed")
    command_line("check", "logs", "--parquet", "verdicts.parquet", "--json", "verdicts.json")
    verdicts = json.loads((logs / "verdicts.json").read_text())
    broken = {one["violation"]["rules"][0] for one in verdicts if one["violation"]}
    for text in (text for path in PAGES for text in RUN_SQL.findall(path.read_text())):
        assert {row[0] for row in duckdb.sql(text).fetchall()} == broken


def test_the_servers_that_share_robots_are_those_of_the_simulation() -> None:
    """The table of `docs/scale.md` is what `docs/scale.py` computes: every mission ends as under one server."""
    path = ROOT / "docs" / "scale.py"
    scale = runpy.run_path(str(path))
    rows = scale["shared"](scale["Plan"].drawn(scale["ROBOTS"], scale["MISSIONS"]))
    assert "\n\n" + "\n".join(rows) + "\n\n" in path.with_suffix(".md").read_text()
    assert [row.split("|")[-2].strip() for row in rows[2:]] == ["yes"] * len(scale["SHARDS"])


def robot_row() -> str:
    """What `docs/glue.py` counts for `isaac.robot`."""
    glue = runpy.run_path(str(ROOT / "docs" / "glue.py"))
    return str(glue["rows"](glue["texts"]([*glue["ROOMS"]], None))[-1])


def test_what_a_system_costs_is_counted() -> None:
    """The page says of `isaac.robot` what is counted, and at most a tenth of it says nothing about the system."""
    row = robot_row()
    assert f"\n{row}\n" in HOUSE.read_text(), f"python {Path(__file__).name} writes it"
    assert float(row.partition("(")[2].partition("%")[0]) <= 10


def test_glue_is_told_from_what_says_something() -> None:
    """Imports, what is put together, listings and forwarding are glue, and nothing else is."""
    glue = runpy.run_path(str(ROOT / "docs" / "glue.py"))["glue"]
    text = (
        "import a\n"  # 1: glue
        "X = 3\n"
        "SPEC = Spec(\n"  # 3: glue
        "    one,\n"  # 4: glue
        "    title='a lamp',\n"
        ")\n"  # 6: glue
        "BOTH = (a, X)\n"  # 7: glue
        "def passed(it):\n    return a(it)\n"  # 8, 9: glue
        "def said(it):\n    return a(it + 1)\n"
    )
    assert glue(text) == {1, 3, 4, 6, 7, 8, 9}


if __name__ == "__main__":
    for path in PAGES:
        path.write_text(regenerate(path.read_text()))
    HOUSE.write_text(re.sub(r"\| all \| .*", robot_row(), HOUSE.read_text()))
