"""The machines of this folder are a second opinion: they were written from the pages, and see nothing of the rules."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).parent

OPEN = re.compile(
    r"missionfsm(\.fakes(\.\w+)?|\.bear\.wire\.\w+|\.bear\.status\.messages|\.isaac\.(runtime|wire)\.\w+)?"
)
"""What may be imported: the fakes, what they are told and say, and the server and robot that ship."""


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or "."


def test_no_machine_sees_the_rules() -> None:
    """Of the project only fakes, messages and what ships are imported: no rules, readings, specifications or tools."""
    found = [
        f"{path.name}: {name}"
        for path in sorted(HERE.glob("*.py"))
        for name in imported(path)
        if name.partition(".")[0] == "missionfsm" and OPEN.fullmatch(name) is None
    ]
    assert found == []


def test_every_file_fits_in_the_head() -> None:
    """No file of the folder has 400 lines or more."""
    assert [path.name for path in HERE.glob("*.py") if len(path.read_text(encoding="utf-8").splitlines()) >= 400] == []
