"""missionfsm as a library: its public names, and judging from Python."""

from __future__ import annotations

import ast
import importlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import missionfsm
from missionfsm import SubjectError, UnreadableError, check, check_robots, conform, explore
from missionfsm.tools.reference.subject import ReferenceSubject

HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {}}
CREATE = {"call": 1, "method": "CreateMission", "params": {"mission": {"baseMission": {"navigateMission": {}}}}}
REFUSED = {"return": 1, "error": {"status": "INVALID_ARGUMENT"}}
WRONG = {"return": 1, "error": {"status": "NOT_FOUND"}}


def declared() -> list[tuple[str, str]]:
    """What a type checker is told: the module and the name of everything that is imported for it alone."""
    tree = ast.parse(Path(missionfsm.__file__).read_text(encoding="utf-8"))
    told = next(one for one in tree.body if isinstance(one, ast.If))
    return [
        (one.module or "", alias.name) for one in told.body if isinstance(one, ast.ImportFrom) for alias in one.names
    ]


def test_what_a_type_checker_sees_is_there() -> None:
    """The names that are declared are those of ``__all__``, and each is at run time the very thing that is declared."""
    assert sorted([name for _, name in declared()] + ["__version__"]) == sorted(missionfsm.__all__)
    for module, name in declared():
        there = importlib.import_module(module)
        expected = getattr(there, name, None) or importlib.import_module(f"{module}.{name}")
        assert getattr(missionfsm, name) is expected
    assert missionfsm.__version__ == importlib.metadata.version("missionfsm")
    assert set(missionfsm.__all__) <= set(dir(missionfsm))
    with pytest.raises(AttributeError, match="no attribute 'Robots'"):
        missionfsm.Robots  # type: ignore[attr-defined]  # noqa: B018 - asking is the test


def test_the_package_costs_nothing_until_it_is_used() -> None:
    """Importing it loads nothing of itself or of others; a verdict on a history needs none of what is slow to load."""
    script = """
import sys, missionfsm
print([name for name in sys.modules if name.startswith(("missionfsm.", "attr"))])
missionfsm.Robot, missionfsm.check
print(sorted({"hypothesis", "rich", "jinja2", "graphviz", "typer", "pytest"} & set(sys.modules)))
"""
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.split("\n") == ["[]", "[]", ""]


@pytest.mark.parametrize("as_text", [False, True], ids=["values", "texts"])
def test_a_history_is_judged_as_a_file_or_as_lines(tmp_path: Path, *, as_text: bool) -> None:
    """The verdict on a file and on its lines, as values or as texts, is the same value."""
    for answer, conforms in ((REFUSED, True), (WRONG, False)):
        lines = [HEAD, CREATE, answer]
        texts = [json.dumps(line) for line in lines]
        path = tmp_path / "history.jsonl"
        path.write_text("\n".join(texts) + "\n")
        of_file = check(path)
        assert of_file.conforms == conforms
        assert check(texts if as_text else lines) == of_file == check(str(path))


def test_a_fleets_history_has_a_verdict_for_each_robot() -> None:
    """Whoever asks for one verdict says about whom; `check_robots` has them all."""
    lines = [HEAD]
    for robot, answer in (("left", REFUSED), ("right", WRONG)):
        lines += ({**CREATE, "robot": robot}, {**answer, "robot": robot})
    verdicts = check_robots(lines)
    assert {robot: verdict.conforms for robot, verdict in verdicts.items()} == {"left": True, "right": False}
    assert check(lines, robot="right") == verdicts["right"]
    with pytest.raises(ValueError, match=r"robot: None is not one of those that the history speaks of, .* left, right"):
        check(lines)


def test_readings_may_be_demanded() -> None:
    """What one reading explains conforms where that one is demanded, and violates where another is."""
    empty = {"call": 1, "method": "UpdateMission", "params": {}}
    lines = [HEAD, empty, {"return": 1, "error": {"status": "FAILED_PRECONDITION"}}]
    assert check(lines).readings == {"AM-04.no-id": ("c",)}
    assert check(lines, readings={"AM-04": "c"}).conforms
    assert not check(lines, readings={"AM-04": "a"}).conforms
    with pytest.raises(ValueError, match="there is no ambiguity AM-99"):
        check(lines, readings={"AM-99": "a"})


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ([], "the history is empty"),
        ([HEAD, "no json"], "line 2: "),
        ([HEAD, {"call": 1}], "line 2: "),
        ([{**HEAD, "system": "bear.dance"}], "there is no system 'bear.dance'"),
    ],
)
def test_what_cannot_be_read_is_said_with_its_line(lines: list[Any], says: str) -> None:
    """Bad input raises one exception whose message says what and where, and no name of a file that nobody knows."""
    with pytest.raises(UnreadableError) as caught:
        check(lines)
    assert says in str(caught.value)
    assert "/" not in str(caught.value)


def test_an_implementation_is_judged_in_process_or_behind_a_command() -> None:
    """An object, nothing at all, and the command that starts the reference are asked the same and do as well."""
    few: dict[str, Any] = {"examples": 6, "steps": 10, "seed": 3}
    robot = missionfsm.systems.system("isaac.robot")
    inside = conform(robot, ReferenceSubject(robot), **few)
    assert inside.conforms
    assert conform("isaac.robot", **few) == inside
    behind = conform("isaac.robot", [sys.executable, "-m", "missionfsm", "adapter", "isaac.robot"], **few)
    assert (behind.outcome, behind.events, behind.readings) == (inside.outcome, inside.events, inside.readings)
    stopped = conform("isaac.robot", seconds=0.0)
    assert stopped.examples == 0
    assert not stopped.conforms


def test_what_conform_is_given_is_looked_at_first() -> None:
    """A command in one text, an unknown rule, an unknown system and a program that is not there are said at once."""
    with pytest.raises(TypeError, match=r"a command is a list, such as \['node', 'robot.mjs'\]"):
        conform("bear.mission", "node robot.mjs")
    with pytest.raises(ValueError, match=r"expected: bear.mission has no rule 'bear.mission/dance'"):
        conform("bear.mission", expected=["bear.mission/dance"])
    with pytest.raises(UnreadableError, match=r"there is no system 'bear.dance'"):
        conform("bear.dance")
    with pytest.raises(SubjectError, match="cannot start /nowhere/robot"):
        conform("bear.mission", ["/nowhere/robot"])


def test_a_system_is_explored_within_bounds() -> None:
    """The size and the system's own bounds say how far it goes."""
    small = explore("bear.mission", size=1, goals=1, batch=1)
    assert small.counterexample is None
    assert small.states < explore("bear.mission", size=1, goals=2, batch=1).states


def test_what_is_known_of_a_log_is_said_with_it() -> None:
    """What the command line's options say of a log may be said to `check` as well."""
    stream = {"return": 1, "result": {"stream": 1}}
    states = {"missions": [], "currentMissionIndex": -1}
    message = {"metadata": {"timestamp": "2025-04-01T17:05:00Z", "sequenceNumber": 7}, "missionStates": states}
    head = {"missionfsm": 1, "system": "bear.mission", "world": {}}
    shown = {"stream": 1, "message": message}
    opened = [head, {"call": 1, "method": "SubscribeMissionStatus", "params": {}}, stream, shown]
    closed = {"stream": 1, "closed": True}
    assert (check([*opened, closed]).conforms, check([*opened, closed], strict=True).conforms) == (True, False)
    assert (check([head, shown]).conforms, check([head, shown], anywhere=True).conforms) == (False, True)
