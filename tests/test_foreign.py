"""``missionfsm teeth --subjects``: implementations of others, each with the verdict that it deserves."""

from __future__ import annotations

import sys
from pathlib import Path

import orjson
import pytest
from commandline import CommandLine

from missionfsm.app import foreign

FAULTY = """
import json, sys
for line in sys.stdin:
    asked = json.loads(line)
    own = {"initialize": {"implementation": {"name": "faulty"}, "drives": []}}
    result = own.get(asked["method"], {"robotState": 5} if asked["method"] == "GetRobotStatus" else {"stream": 1})
    print(json.dumps({"jsonrpc": "2.0", "id": asked["id"], "result": result}), flush=True)
"""


def table(folder: Path, *rows: tuple[str, list[str], str]) -> Path:
    """A folder with an adapter that is wrong, and a table of subjects."""
    (folder / "faulty.py").write_text(FAULTY)
    (folder / "subjects.toml").write_text(
        "".join(
            f"[[subject]]\nname = {orjson.dumps(name).decode()}\ncommand = {orjson.dumps(command).decode()}\n"
            f"verdict = {orjson.dumps(verdict).decode()}\n"
            for name, command, verdict in rows
        )
    )
    return folder


RIGHT = [sys.executable, "-m", "missionfsm", "adapter", "bear.status"]
WRONG = [sys.executable, "faulty.py"]


@pytest.mark.long
def test_subjects_are_judged_as_they_deserve(command_line: CommandLine, tmp_path: Path) -> None:
    """A right one is accepted, one with a fault is noticed; commands run in the folder, and the status is 0."""
    folder = table(tmp_path, ("theirs", RIGHT, "conforms"), ("its mutant", WRONG, "violates"))
    ended = command_line("teeth", "bear.status", "--subjects", folder, "--time", 120, "--jobs", 1, "--json", "-")
    found = orjson.loads(ended.out)
    assert ended.status == 0, ended.out
    assert [(one["name"], one["verdict"], one["right"]) for one in found["subjects"]] == [
        ("theirs", "conforms", True),
        ("its mutant", "violates", True),
    ]
    assert [bool(one["rules"]) for one in found["subjects"]] == [False, True]


def test_a_wrong_verdict_is_named(command_line: CommandLine, tmp_path: Path) -> None:
    """Of every second one: whoever deserves another verdict, and who gives none, is named, and the status is 1."""
    gone = [sys.executable, "-c", "raise SystemExit('no')"]
    rows = [("said to be right", WRONG, "conforms"), ("left out", gone, "violates"), ("dies", gone, "violates")]
    folder = table(tmp_path, *rows)
    ended = command_line("teeth", "bear.status", "--subjects", folder, "--every", 2, "--time", 30, "--jobs", 2)
    assert ended.status == 1
    first, _, *wrong = ended.out.splitlines()
    assert first == "bear.status: 0 of 1 that are right accepted, 0 of 1 that have a fault noticed"
    assert wrong[0].split(",")[0].strip() == "said to be right: violates"
    assert "dies: no verdict (" in wrong[1]


def test_what_is_flagged_of_the_right_one_too_notices_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fault that conforms is noticed by what is flagged of it alone."""
    flags = {"right": {"AM-09=b"}, "its mutant": {"AM-09=b"}, "another": {"AM-09=b", "an unknown member"}}

    def judge(_name: str, subject: foreign.Subject, _seed: int, _seconds: float) -> foreign.SubjectResult:
        return foreign.SubjectResult(subject, "conforms", frozenset(flags[subject.name]))

    monkeypatch.setattr(foreign, "judge", judge)
    given = [foreign.Subject(name, (), "conforms" if name == "right" else "violates", ".") for name in flags]
    report = foreign.judge_all("bear.status", given, seed=1, seconds=1.0, jobs=1)
    assert [one.right for one in report.judged] == [True, False, True]
    assert str(report).splitlines()[0] == (
        "bear.status: 1 of 1 that are right accepted, 1 of 2 that have a fault noticed (1 of them flagged)"
    )


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "subjects.toml: No such file or directory"),
        ("[[subject", "subjects.toml: "),
        ("", "it has no [[subject]]"),
        ("subject = [3]", "subject 1: 3 is not a table"),
        ("[[subject]]\nname = 3", "subject 1: its name is 3, not a text"),
        ('[[subject]]\nname = "a"\ncommand = "python3 a.py"', "its command is 'python3 a.py', not a list of texts"),
        ('[[subject]]\nname = "a"\ncommand = ["a"]\nverdict = "right"', "its verdict is 'right', not conforms or"),
        ('[[subject]]\nname = "a"\ncommand = ["a"]\nexpected = 1', "there is no 'expected'; there are name, command"),
        ('[[subject]]\nname = "a"\ncommand = ["a"]\nverdict = "violates"\n' * 2, "two subjects are called 'a'"),
    ],
)
def test_a_bad_table_is_bad_input(command_line: CommandLine, tmp_path: Path, text: str | None, says: str) -> None:
    """A table that is missing or malformed is one line that says what and where, and exit status 2."""
    if text is not None:
        (tmp_path / "subjects.toml").write_text(text)
    ended = command_line("teeth", "bear.status", "--subjects", tmp_path)
    assert (ended.status, ended.err.count("\n"), says in ended.err) == (2, 1, True), ended.err
