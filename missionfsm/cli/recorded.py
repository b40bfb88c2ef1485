"""Judge recorded histories: a file at a time, a robot at a time, a line at a time."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import evolve

from missionfsm.adapters.historyfile import (
    STDIN,
    Stamps,
    fingerprint,
    lines,
    lost_calls,
    open_history,
    wrong_line,
)
from missionfsm.kernel.belief import Automaton
from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.readings import constrain
from missionfsm.kernel.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check import Judge
from missionfsm.tools.verdict import Verdict


def check_file(path: str, readings: Mapping[str, str] | None = None) -> list[tuple[str | None, Verdict]]:
    """The verdict for each robot that a history speaks of, in the order of their first lines.

    A line without a robot belongs to the one conversation of the file.

    Raises:
        UnreadableError: there is no such file, or a line is not of the format; the message says where and what.
        ValueError: `readings` names something that does not exist.
    """
    lost = lost_calls(path)
    source = open_history(path)
    try:
        numbered = lines(source, path)
        number, line = next(numbered, (0, None))
        if not number:
            message = f"{'stdin' if path == STDIN else path}: the history is empty"
            raise UnreadableError(message)
        try:
            first = head(line)
            stamps = Stamps()
            stamps.robot(line)
            judged = system(first.system)
            automaton = Automaton(judged.spec, first.drives, constrain(judged.spec.ambiguities, readings or {}))

            def new_judge(robot: str | None) -> Judge:
                calls = lost.get(robot, frozenset())
                return Judge(judged, first, automaton, fingerprint=fingerprint, lost=calls)

            nobody = new_judge(None)
        except UnreadableError as error:
            raise wrong_line(path, number, error) from None
        judges: dict[str | None, Judge] = {}
        stopped: dict[str | None, int] = {}
        for number, line in numbered:
            try:
                robot = stamps.robot(line)
                judge = judges.get(robot)
                if judge is None:
                    judge = judges[robot] = nobody if robot is None else new_judge(robot)
                if not judge.feed(line):
                    stopped.setdefault(robot, number)
            except UnreadableError as error:
                raise wrong_line(path, number, error) from None
    finally:
        if path != STDIN:
            source.close()
    verdicts = ((robot, judge.verdict()) for robot, judge in (judges or {None: nobody}).items())
    return [(robot, located(verdict, stopped.get(robot))) for robot, verdict in verdicts]


def located(verdict: Verdict, line: int | None) -> Verdict:
    """The verdict with the line of the file in which the violation is."""
    if verdict.violation is None or line is None:
        return verdict
    return evolve(verdict, violation=evolve(verdict.violation, at=line, where=f"line {line}: "))
