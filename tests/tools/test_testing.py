"""`missionfsm.testing` and the pytest plugin, as users meet them: in a pytest of their own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import orjson
import pytest
from attrs import frozen

HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {}}
CALL = {"call": 1, "method": "ClearMissionStatus", "params": {}}
RIGHT = (HEAD, CALL, {"return": 1, "result": {"missionIds": []}})
WRONG = (HEAD, CALL, {"return": 1, "error": {"status": "PERMISSION_DENIED", "message": ""}})
BROKEN = "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued"

SUITE = """
from attrs import evolve

from missionfsm.kernel.history import Answer
from missionfsm.systems import system
from missionfsm.testing import Suite
from missionfsm.tools.reference.subject import ReferenceSubject

RULE = {rule!r}


def broken(_, step):
    return evolve(step, answer=Answer("NOT_FOUND")) if step is not None and RULE in step.rules else step


class TestRight(Suite):
    system = "bear.mission"
    examples = 24

    def subject(self):
        return ReferenceSubject(system(self.system))


class TestWrong(TestRight):
    def subject(self):
        return ReferenceSubject(system(self.system), mutate_step=broken)


class TestKnown(TestWrong):
    known = (RULE,)


class TestStale(TestRight):
    known = (RULE,)


class TestCounted(TestRight):
    steps = 3

    def test_count(self, found):
        print(f"had {{found.verdict.examples}} conversations")
"""


@frozen
class Run:
    """What a pytest came to: its exit status, its report, and what became of each test."""

    status: int
    out: str

    def outcome(self, test: str) -> str:
        """What became of a test."""
        return next(line.split()[1] for line in self.out.splitlines() if line.split(" ")[0].endswith(test))


def pytest_in(folder: Path, *options: str) -> Run:
    """Run pytest in a folder, with the plugin and no other."""
    environment = {**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    command = [sys.executable, "-m", "pytest", "-p", "missionfsm.pytest_plugin", "-p", "no:cacheprovider", *options]
    ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment, check=False)
    return Run(ended.returncode, ended.stdout + ended.stderr)


def write(path: Path, lines: tuple[object, ...]) -> None:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))


def test_recorded_histories_are_tests(tmp_path: Path) -> None:
    """Files named ``*.history.jsonl`` pass or fail; what fails tells its story, and no traceback."""
    write(tmp_path / "good.history.jsonl", RIGHT)
    write(tmp_path / "bad.history.jsonl", WRONG)
    write(tmp_path / "cut.history.jsonl", (*RIGHT, {"return": 1, "result": {}}))
    write(tmp_path / "other.jsonl", WRONG)
    run = pytest_in(tmp_path, "-v")
    assert (run.status, run.outcome("::good"), run.outcome("::bad"), run.outcome("::cut")) == (
        1,
        "PASSED",
        "FAILED",
        "FAILED",
    )
    assert "1. ClearMissionStatus() → PERMISSION_DENIED" in run.out
    assert "cut.history.jsonl:4: return 1: no call with this id is waiting" in run.out
    assert "Traceback" not in run.out
    assert "other" not in run.out


@pytest.fixture(scope="module")
def suites(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """The suites above, run."""
    folder = tmp_path_factory.mktemp("suites")
    (folder / "test_robot.py").write_text(SUITE.format(rule=BROKEN))
    return pytest_in(folder, "-v", "-rA")


@pytest.mark.slow
def test_a_suite_has_a_test_for_every_operation_and_every_group_of_rules(suites: Run) -> None:
    """Ten operations and three groups of rules, all right for the reference."""
    right = [line for line in suites.out.splitlines() if "TestRight::" in line and "%]" in line]
    names = [line.split("::")[2].split(" ")[0] for line in right]
    assert (len(names), len([one for one in names if one.startswith("test_operation[")])) == (len(set(names)), 10)
    assert {line.split()[1] for line in right} <= {"PASSED", "SKIPPED"}
    assert suites.outcome("TestRight::test_operation[CreateMission]") == "PASSED"


@pytest.mark.long
def test_a_broken_rule_fails_the_test_of_its_operation_alone(suites: Run) -> None:
    """The other operations pass, since the search goes on after what it finds."""
    wrong = [line.split()[0] for line in suites.out.splitlines() if "TestWrong::" in line and " FAILED " in line]
    assert [one.split("::")[2] for one in wrong if "%]" not in one] == ["test_operation[CreateMission]"]
    assert "was answered NOT_FOUND" in suites.out
    assert ("Traceback" not in suites.out, "Warning" in suites.out) == (True, False)


@pytest.mark.slow
def test_an_adapter_that_fails_is_said_to(tmp_path: Path) -> None:
    """Every test says what is wrong with it, in one line."""
    lines = ["from missionfsm.testing import Suite", "class TestNone(Suite):", "    system = 'bear.mission'"]
    (tmp_path / "test_none.py").write_text("\n".join([*lines, "    command = ('no-such-adapter',)", ""]))
    run = pytest_in(tmp_path, "-q", "-k", "everything")
    assert (run.status, "the adapter failed: " in run.out, "Traceback" in run.out) == (1, True, False)


@pytest.mark.long
def test_what_is_known_to_be_broken_does_not_fail(suites: Run) -> None:
    """It is expected to fail; known of something that is not broken, it fails the test of everything."""
    assert suites.outcome("TestKnown::test_operation[CreateMission]") == "XFAIL"
    assert suites.outcome("TestStale::test_everything_is_explained") == "FAILED"
    assert f"known to be broken, and not broken any more: {BROKEN}" in suites.out


@pytest.mark.slow
def test_the_number_of_examples_is_an_option(tmp_path: Path) -> None:
    """It goes before what the suite says; what nothing was tried of is skipped, and the report says so."""
    (tmp_path / "test_robot.py").write_text(SUITE.format(rule=BROKEN))
    run = pytest_in(tmp_path, "-v", "-rsP", "-k", "TestCounted", "--missionfsm-examples", "4")
    assert (run.status, "had 4 conversations" in run.out) == (0, True)
    assert "was exercised in 4 conversations" in run.out


def test_the_plugin_loads_nothing(tmp_path: Path) -> None:
    """A pytest that does not use it pays for neither the systems nor Hypothesis nor the command line."""
    code = (
        "import sys, pytest\nbefore = set(sys.modules)\nimport missionfsm.pytest_plugin\n"
        "print(sorted(name for name in set(sys.modules) - before if '.' not in name or 'missionfsm' in name))"
    )
    ended = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ended.stdout.strip() == "['missionfsm', 'missionfsm.pytest_plugin']"
