"""A fleet's logs: many files on several cores, large ones by their robots, on a cluster, as a table."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import orjson
import pytest
from commandline import CommandLine
from pyarrow import parquet
from traffic import walk

from missionfsm import fleet
from missionfsm.app import many
from missionfsm.kernel.codec import UnreadableError
from missionfsm.reports.parquet import COLUMNS

EXAMPLE = Path(__file__).parent.parent / "examples" / "fleet" / "fleet.py"
FIRST = {"missionfsm": 1, "system": "bear.mission", "world": {}}
RIGHT = [{"call": 1, "method": "ClearMissionStatus", "params": {}}, {"return": 1, "result": {"missionIds": []}}]
WRONG = [{"call": 1, "method": "SkipGoal", "params": {}}, {"return": 1, "result": {}}]
SKIPPED = "bear.mission/SkipGoal/FAILED_PRECONDITION/the-robot-is-not-on-a-mission"


def written(path: Path, *lines: Any) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    return path


def of_robots(names: str, *, wrong: str = "") -> Iterator[Any]:
    """A day of several robots, whose lines alternate; each of `wrong` says at the end what no robot may."""
    days = {name: walk(ord(name), 6).lines for name in names}
    yield walk(0, 0).head
    for at in range(max(map(len, days.values()))):
        yield from ({**day[at], "robot": name} for name, day in days.items() if at < len(day))
    for name in wrong:
        yield from (
            {**line, "robot": name} for line in ({**WRONG[0], "call": 999}, {"return": 999, "result": {"no": 1}})
        )


def as_json(judged: many.Judged) -> Any:
    return judged.path, judged.trouble, [(robot, verdict.to_json()) for robot, verdict in judged.verdicts]


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every file is worth a process."""
    monkeypatch.setattr(many, "WORTH_A_PROCESS", 1)


@pytest.mark.usefixtures("small")
def test_a_large_file_is_judged_by_its_robots(tmp_path: Path) -> None:
    """Pieces of a file have its robots apart, with about as many lines each; together they come to the same."""
    path = str(written(tmp_path / "day.jsonl", *of_robots("abcde", wrong="cb")))
    whole = many.judge_piece(many.Piece(path), {}, {})
    ((*cut,),) = many.pieces([path], 2)
    lines = many.robots(path)
    assert list(lines) == list("abcde")
    assert sorted(robot for piece in cut for _, robot in piece.robots) == sorted(lines)
    assert abs(sum((-1) ** at * lines[robot] for at, piece in enumerate(cut) for _, robot in piece.robots)) < max(
        lines.values()
    )
    together = many.merged_results(cut, [many.judge_piece(piece, {}, {}) for piece in reversed(cut)])
    assert as_json(together) == as_json(whole)
    assert [robot for robot, verdict in whole.verdicts if not verdict.conforms] == ["b", "c"]


@pytest.mark.usefixtures("small")
def test_of_what_is_wrong_with_a_file_the_first_is_told(tmp_path: Path) -> None:
    """A file in pieces is refused for the same line as one that is judged in one piece."""
    path = str(written(tmp_path / "day.jsonl", *of_robots("ab"), {"robot": "b", "no": 1}, {"robot": "a", "no": 1}))
    ((*cut,),) = many.pieces([path], 2)
    whole = many.judge_piece(many.Piece(path), {}, {})
    assert (len(cut), whole.verdicts, whole.trouble.startswith(f"{path}:")) == (2, (), True)
    assert as_json(many.merged_results(cut, [many.judge_piece(piece, {}, {}) for piece in cut])) == as_json(whole)


def test_what_names_no_robots_is_judged_in_one_piece(tmp_path: Path) -> None:
    """Bare messages, several histories in one file, a file that is malformed or is not there."""
    bare = written(tmp_path / "a.jsonl", {"metadata": {}, "missionStates": {"missions": []}})
    torn = written(tmp_path / "b.jsonl", FIRST, 7)
    two = written(tmp_path / "c.jsonl", FIRST, {**RIGHT[0], "robot": "a"}, FIRST, {**RIGHT[0], "robot": "b"})
    for path in (bare, torn, two, tmp_path / "none"):
        assert many.robots(str(path)) == {}
        assert many.pieces([str(path)], 2) == [(many.Piece(str(path)),)]


@pytest.mark.usefixtures("small")
def test_a_file_that_names_no_robot_is_not_read_for_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever shares files out among workers reads the lines of those alone that may speak of several robots."""
    alone = str(written(tmp_path / "alone.jsonl", FIRST, *RIGHT))
    several = str(written(tmp_path / "several.jsonl", *of_robots("ab")))
    read: list[str] = []
    monkeypatch.setattr(many, "robots", lambda path: read.append(path) or {})
    many.pieces([alone, several], 2)
    assert read == [several]


def test_patterns_are_taken_where_no_file_has_that_name(command_line: CommandLine, tmp_path: Path) -> None:
    """`**` goes into folders; what several arguments name is judged once; a name with brackets is a name."""
    for name in ("a/1.jsonl", "a/b/2.jsonl", "c[1].jsonl"):
        written(tmp_path / name, FIRST, *RIGHT)
    found = many.histories([f"{tmp_path}/**/*.jsonl", str(tmp_path / "a"), f"{tmp_path}/c[1].jsonl"])
    assert [os.path.relpath(path, tmp_path) for path in found] == ["a/1.jsonl", "a/b/2.jsonl", "c[1].jsonl"]
    twice = command_line("check", tmp_path / "c[1].jsonl", tmp_path / "c[1].jsonl")
    assert (twice.status, twice.out.count(": conforms in part: ")) == (0, 1)
    ended = command_line("check", f"{tmp_path}/*.log")
    assert (ended.status, ended.err) == (2, f"missionfsm: {tmp_path}/*.log: no file fits this pattern\n")


def test_a_log_that_is_missing_is_said_to_be(command_line: CommandLine, tmp_path: Path) -> None:
    """A link that leads nowhere is told, a folder that is called like a log is looked into, and the rest is judged."""
    written(tmp_path / "day.jsonl" / "a.jsonl", FIRST, *RIGHT)
    (tmp_path / "b.jsonl").symlink_to("nowhere")
    ended = command_line("check", tmp_path)
    assert (ended.status, ended.err) == (2, f"missionfsm: {tmp_path}/b.jsonl: No such file or directory\n")
    assert ended.out.startswith("1 judged: 1 conforms, ")


def test_five_hundred_robots_are_summed_up_in_twenty_lines(command_line: CommandLine, tmp_path: Path) -> None:
    """One file of many robots is summed up as a folder is: how many conform, what is broken where first."""
    path = written(
        tmp_path / "day.jsonl",
        FIRST,
        *({**line, "robot": f"r{n}"} for n in range(500) for line in (WRONG if n % 100 == 7 else RIGHT)),
    )
    ended = command_line("check", path)
    assert (ended.status, len(ended.out.splitlines()) <= 20) == (1, True)
    assert ended.out.startswith("500 judged: 495 conforms, 5 violates, 0 inconclusive; 0 flagged\n1,000 events in ")
    assert "1,000 events in 0.0 s" not in ended.out
    assert [line.split() for line in ended.out.splitlines() if line.startswith("bear.")] == [
        [SKIPPED, "5", "day.jsonl,", "r7,", "line", "17"]
    ]


def test_verdicts_are_a_table(command_line: CommandLine, tmp_path: Path) -> None:
    """``--parquet`` writes a row for each file and robot: what is broken, in which line, how much there was."""
    path = written(tmp_path / "a.jsonl", FIRST, *({**line, "robot": "r1"} for line in WRONG))
    other = written(tmp_path / "b.jsonl", FIRST, *RIGHT)
    out = tmp_path / "out.parquet"
    ended = command_line("check", path, other, "--parquet", out)
    table = parquet.read_table(out)
    assert (ended.status, ended.err, table.column_names) == (1, "", list(COLUMNS))
    broken, fine = table.to_pylist()
    assert 0 < broken.pop("seconds") < 60
    assert 0 < fine.pop("seconds") < 60
    assert broken == {
        "file": str(path),
        "robot": "r1",
        "system": "bear.mission",
        "verdict": "violates",
        "rule": SKIPPED,
        "line": 3,
        "observed": "SkipGoal() was answered OK (malformed: a mission id is missing)",
        "because": None,
        "events": 2,
        "flagged": [],
    }
    nothing = dict.fromkeys(("robot", "rule", "line", "observed", "because"))
    assert fine == {
        "file": str(other),
        "system": "bear.mission",
        "verdict": "conforms",
        "events": 2,
        "flagged": [],
        **nothing,
    }


@pytest.mark.parametrize(
    ("module", "option", "says"),
    [
        ("pyarrow", ("--parquet", "out"), "pyarrow is not installed: install missionfsm[parquet] to write Parquet"),
        (
            "distributed",
            ("--dask", "local"),
            "Dask is not installed: install missionfsm[fleet] to judge on its workers",
        ),
    ],
)
def test_without_an_extra_it_is_said_what_to_install(
    command_line: CommandLine,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    module: str,
    option: tuple[str, ...],
    says: str,
) -> None:
    """One line, before anything is judged."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, module, None)
    ended = command_line("check", written(tmp_path / "a.jsonl", FIRST, *RIGHT), *option)
    assert (ended.status, ended.out, ended.err) == (2, "", f"missionfsm: {says}\n")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--dask", "local", "-"), "--dask: stdin can be read in this process alone"),
        (
            ("--dask", "tcp://[::1]:1", "--jobs", 2, EXAMPLE),
            "--jobs: how many workers there are is up to the scheduler",
        ),
    ],
)
def test_what_a_cluster_cannot_do_is_said(command_line: CommandLine, arguments: tuple[Any, ...], says: str) -> None:
    """Bad usage in one line."""
    ended = command_line("check", *arguments)
    assert (ended.status, ended.out, ended.err.startswith(f"missionfsm: {says}")) == (2, "", True)


def test_where_no_scheduler_answers_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """One line with the address."""
    monkeypatch.setattr(fleet, "PATIENCE", "1s")
    with pytest.raises(UnreadableError, match=r"^tcp://127.0.0.1:1: no scheduler of Dask answers there"):
        list(fleet.judge([str(EXAMPLE)], scheduler="tcp://127.0.0.1:1"))


@pytest.mark.long
@pytest.mark.usefixtures("small")
@pytest.mark.filterwarnings("default")
def test_a_worker_that_is_killed_loses_nothing(tmp_path: Path) -> None:
    """Two workers, one of which is killed while both judge: every robot has its one verdict, as in one process."""
    from distributed import Client, LocalCluster  # noqa: PLC0415 - slow to load

    for number in range(10):
        written(tmp_path / f"{number}.jsonl", *of_robots("abcdef", wrong="b" if number == 3 else ""))
    files = many.histories([str(tmp_path)])
    alone = [as_json(one) for one in many.judge_files(files, {}, jobs=1)]
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        before = client.run(os.getpid)
        shares: list[float] = []

        def killing(share: float) -> None:
            shares.append(share)
            if len(shares) == 5:
                os.kill(next(iter(before.values())), signal.SIGKILL)

        judged = [as_json(one) for one in fleet.judge(files, scheduler=cluster.scheduler_address, progress=killing)]
        after = client.run(os.getpid)
    assert judged == alone
    assert sum(shares) == pytest.approx(len(files))
    assert len(set(after.values()) & set(before.values())) == 1


@pytest.mark.long
@pytest.mark.filterwarnings("default")
def test_workers_that_are_started_here_judge_the_same(command_line: CommandLine, tmp_path: Path) -> None:
    """``--dask local`` says what ``--jobs`` says, whatever folder it runs in, of files that cannot be read as well."""
    written(tmp_path / "a.jsonl", *of_robots("ab", wrong="a"))
    written(tmp_path / "b.jsonl", FIRST, 7)
    there = command_line("check", tmp_path, "--dask", "local", "--jobs", 2)
    here = command_line("check", tmp_path, "--jobs", 1)
    assert (
        (there.status, there.err)
        == (here.status, here.err)
        == (2, f"missionfsm: {tmp_path}/b.jsonl:2: 7 is not an object\n")
    )
    assert [line for line in there.out.splitlines() if " events in " not in line] == [
        line for line in here.out.splitlines() if " events in " not in line
    ]


def example() -> Any:
    """The example, as a module."""
    found = spec_from_file_location("fleet_example", EXAMPLE)
    assert found is not None
    assert found.loader is not None
    module = module_from_spec(found)
    sys.modules["fleet_example"] = module  # its processes look for it there
    found.loader.exec_module(module)
    return module


def test_the_example_finds_what_it_plants(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """A fleet's logs by the reference, three of them with a fault: those three are found, and nothing else."""
    monkeypatch.syspath_prepend(EXAMPLE.parent)
    example().main(["--robots", "6", "--lines", "100", "--ways", "1"])
    told = capsys.readouterr().out
    assert [line.split()[-3:] for line in told.splitlines() if line.startswith("one core")] == [["3", "of", "3"]]
    assert "6 judged: 3 conforms, 3 violates, 0 inconclusive" in told


@pytest.mark.long
def test_the_example_finds_the_same_in_every_way(capsys: pytest.CaptureFixture[str]) -> None:
    """On one core, on two, and with two workers of Dask."""
    example().main(["--robots", "12", "--lines", "400"])
    told = capsys.readouterr().out.splitlines()
    assert sum(line.split()[-3:] == ["3", "of", "3"] for line in told if line.startswith(("one ", "two "))) == 3
