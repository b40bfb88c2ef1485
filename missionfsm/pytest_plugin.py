"""The pytest plugin: recorded histories are tests, and robots are served for tests.

Files named ``*.history.jsonl`` are tests, ``--missionfsm-examples`` says how much suites try, and the fixture
``missionfsm_serve`` serves the reference over gRPC.

pytest loads it wherever missionfsm is installed, so it loads nothing itself until there is something to judge.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from missionfsm.app.serve import Served
    from missionfsm.tools.check.verdict import Verdict

SUFFIX = ".history.jsonl"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option."""
    parser.getgroup("missionfsm").addoption(
        "--missionfsm-examples",
        type=int,
        default=None,
        metavar="N",
        help="conversations that each suite of missionfsm.testing has in all; the suites say how many otherwise",
    )


@pytest.fixture
def missionfsm_serve() -> Iterator[Callable[..., Served]]:
    """Serves the reference over gRPC until the test ends: ``missionfsm_serve("bear.mission", auto=0.1)``.

    Takes what `missionfsm.serve` takes and returns what its ``with`` block is given; needs the extra ``grpc``.
    """
    from missionfsm.app.serve import serve  # noqa: PLC0415 - see above

    with contextlib.ExitStack() as stack:
        yield lambda *arguments, **options: stack.enter_context(serve(*arguments, **options))


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Take recorded histories for tests."""
    return HistoryFile.from_parent(parent, path=file_path) if file_path.name.endswith(SUFFIX) else None


class UnexplainedError(Exception):
    """A recorded history is not judged right; the message is what there is to say."""


class HistoryFile(pytest.File):
    """A recorded history."""

    def collect(self) -> Iterator[pytest.Item]:
        """One test for the whole file, whomever it speaks of."""
        yield HistoryItem.from_parent(self, name=self.path.name.removesuffix(SUFFIX))


class HistoryItem(pytest.Item):
    """The test that a recorded history can be explained."""

    def runtest(self) -> None:
        """Judge the history."""
        from missionfsm.app.recorded import check_file  # noqa: PLC0415 - see above
        from missionfsm.kernel.codec import UnreadableError  # noqa: PLC0415
        from missionfsm.kernel.text import printable  # noqa: PLC0415

        try:
            verdicts = check_file(str(self.path))
        except UnreadableError as error:
            raise UnexplainedError(str(error)) from None
        wrong = [
            f"{printable(robot) + ': ' if robot else ''}{_text(verdict)}"
            for robot, verdict in verdicts
            if not verdict.conforms
        ]
        if wrong:
            raise UnexplainedError("\n\n".join(wrong))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], *args: object, **options: object) -> str:
        """What is wrong, without a traceback: nobody's code is at fault but that of the implementation."""
        if isinstance(excinfo.value, UnexplainedError):
            return str(excinfo.value)
        return str(super().repr_failure(excinfo, *args, **options))  # type: ignore[arg-type]

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Where the test is, and what it is called."""
        return self.path, None, f"history {self.name}"


def _text(verdict: Verdict) -> str:
    """A verdict with the story before it; the story of a long history is left out, since its beginning is not kept."""
    from attrs import evolve  # noqa: PLC0415 - see above

    from missionfsm.kernel.codec import UnreadableError  # noqa: PLC0415
    from missionfsm.systems import system  # noqa: PLC0415
    from missionfsm.tools.check.narrate import story  # noqa: PLC0415

    if verdict.violation is None:
        return str(verdict)
    try:
        return str(evolve(verdict, story=story(system(verdict.system), verdict.violation.history)))
    except UnreadableError:
        return str(verdict)
