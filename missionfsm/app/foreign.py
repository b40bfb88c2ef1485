"""Implementations of others with the verdict that each deserves: the teeth of the oracle, measured on strangers."""

from __future__ import annotations

import multiprocessing
import statistics
import time
import tomllib
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from attrs import evolve, frozen

from missionfsm.adapters.stdio import Child
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.subject import SubjectError
from missionfsm.kernel.text import brief
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Outcome
from missionfsm.tools.conform.conform import conform

TABLE = "subjects.toml"
"""The file in a folder of subjects that names them."""
VERDICTS = ("conforms", "violates")


@frozen
class Subject:
    """An implementation of somebody else.

    Attributes:
        name: what it is called.
        command: the command that starts its adapter, in its folder.
        verdict: what it deserves: ``conforms`` or ``violates``.
        folder: where it is started.
    """

    name: str
    command: tuple[str, ...]
    verdict: str
    folder: str


@frozen
class SubjectResult:
    """The result of judging a subject.

    Attributes:
        subject: the subject.
        said: the outcome, or why there is none: what the adapter did.
        flags: what the verdict flags: readings by their names, everything else by its line.
        rules: ids of the rules that it breaks.
        lines: how many lines the history has that shows a violation.
        seconds: how long it took.
        usual: what is flagged of the folder's first right subject, so that it shows no fault.
    """

    subject: Subject
    said: str
    flags: frozenset[str] = frozenset()
    rules: tuple[str, ...] = ()
    lines: int | None = None
    seconds: float = 0.0
    usual: frozenset[str] = frozenset()

    @property
    def right(self) -> bool:
        """Whether the verdict is the deserved one; a fault counts as noticed if something unusual is flagged."""
        return self.said == self.subject.verdict or (self.subject.verdict == "violates" and self.only_flagged)

    @property
    def only_flagged(self) -> bool:
        """Whether it conforms, and something is flagged that is not flagged of the first right subject."""
        return self.said == Outcome.CONFORMS.value and not self.flags <= self.usual


@frozen
class ForeignReport:
    """The results of all subjects of a folder."""

    system: str
    judged: tuple[SubjectResult, ...]

    @property
    def wrong(self) -> tuple[SubjectResult, ...]:
        """The subjects with another verdict than they deserve."""
        return tuple(one for one in self.judged if not one.right)

    def _of(self, verdict: str) -> tuple[SubjectResult, ...]:
        return tuple(one for one in self.judged if one.subject.verdict == verdict)

    def to_json(self) -> JSON:
        """The report as the command line writes it."""
        return {
            "system": self.system,
            "subjects": [
                {
                    "name": one.subject.name,
                    "deserves": one.subject.verdict,
                    "verdict": one.said,
                    "flagged": bool(one.flags),
                    "right": one.right,
                    "rules": list(one.rules),
                    "lines": one.lines,
                    "seconds": round(one.seconds, 1),
                }
                for one in self.judged
            ],
        }

    def __str__(self) -> str:
        right, faulty = self._of("conforms"), self._of("violates")
        flagged = sum(one.only_flagged for one in faulty)
        lines = [
            f"{self.system}: {sum(one.right for one in right)} of {len(right)} that are right accepted, "
            f"{sum(one.right for one in faulty)} of {len(faulty)} that have a fault noticed"
            + (f" ({flagged} of them flagged)" if flagged else "")
        ]
        shown = [one.lines for one in faulty if one.lines is not None]
        took = statistics.median(one.seconds for one in self.judged)
        story = f", a fault in {statistics.median(shown):g} lines of history" if shown else ""
        lines.append(f"  in the median {took:.1f} s each{story}")
        lines += [
            f"  {one.subject.name}: {one.said}, deserves {one.subject.verdict}"
            + (f" (against {', '.join(one.rules)})" if one.rules else "")
            for one in self.wrong
        ]
        return "\n".join(lines)


def subjects(folder: Path) -> tuple[Subject, ...]:
    """The subjects that the table of a folder names.

    Raises:
        UnreadableError: there is no such table, or it is not of the form; the message says where and what.
    """
    path = folder / TABLE
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UnreadableError(f"{path}: {error.strerror}") from None
    except ValueError as error:
        raise UnreadableError(f"{path}: {error}") from None
    rows = table.get("subject")
    if not isinstance(rows, list) or not rows:
        raise UnreadableError(f"{path}: it has no [[subject]]")
    found = tuple(_subject(row, f"{path}: subject {number}", folder) for number, row in enumerate(rows, 1))
    names = [one.name for one in found]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise UnreadableError(f"{path}: two subjects are called {brief(twice)}")
    return found


def _subject(row: JSON, where: str, folder: Path) -> Subject:
    if not isinstance(row, dict):
        raise UnreadableError(f"{where}: {brief(row)} is not a table")
    name, command, verdict = row.get("name"), row.get("command"), row.get("verdict")
    unknown = next((key for key in row if key not in ("name", "command", "verdict")), None)
    if unknown is not None:
        raise UnreadableError(f"{where}: there is no {brief(unknown)}; there are name, command, verdict")
    if not isinstance(name, str) or not name:
        raise UnreadableError(f"{where}: its name is {brief(name)}, not a text")
    if not isinstance(command, list) or not command or not all(isinstance(one, str) for one in command):
        raise UnreadableError(f"{where}: its command is {brief(command)}, not a list of texts")
    if verdict not in VERDICTS:
        raise UnreadableError(f"{where}: its verdict is {brief(verdict)}, not conforms or violates")
    return Subject(name, tuple(command), verdict, str(folder))


def judge(name: str, subject: Subject, seed: int, seconds: float) -> SubjectResult:
    """Judge one subject as `conform` would, in at most so many seconds."""
    begin = time.monotonic()
    try:
        child = Child(subject.command, folder=subject.folder)
        try:
            found = conform(
                system(name), child, seed=seed, advice=False, enough=lambda: time.monotonic() - begin > seconds
            )
        finally:
            child.close()
    except SubjectError as error:
        return SubjectResult(subject, f"no verdict ({brief(str(error))})", seconds=time.monotonic() - begin)
    violation = found.violation
    return SubjectResult(
        subject,
        found.outcome.value,
        frozenset(line.reading or str(line) for line in found.flagged),
        tuple(rule.id for rule in violation.rules) if violation else (),
        len(violation.history) if violation else None,
        time.monotonic() - begin,
    )


def judge_all(
    name: str,
    given: Sequence[Subject],
    *,
    seed: int,
    seconds: float,
    jobs: int,
    progress: Callable[[], None] = lambda: None,
) -> ForeignReport:
    """Judge subjects of a system in so many processes; `progress` is called for each that was judged."""
    found: list[SubjectResult] = []
    if jobs == 1:
        for one in given:
            found.append(judge(name, one, seed, seconds))
            progress()
        return _reported(name, found)
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn")) as pool:
        for pending in [pool.submit(judge, name, one, seed, seconds) for one in given]:
            found.append(pending.result())
            progress()
    return _reported(name, found)


def _reported(name: str, found: Sequence[SubjectResult]) -> ForeignReport:
    usual = next((one.flags for one in found if one.subject.verdict == "conforms"), frozenset())
    return ForeignReport(name, tuple(evolve(one, usual=usual) for one in found))
