"""Judge recorded histories: a file at a time, a robot at a time, a line at a time."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path

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
from missionfsm.cli.watched import subscription, watch_messages
from missionfsm.kernel.belief import Automaton
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.readings import constrain
from missionfsm.kernel.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check import KEPT, Judge
from missionfsm.tools.verdict import Verdict


def check_file(
    path: str, readings: Mapping[str, str] | None = None, tell: Callable[[str], None] = lambda _: None
) -> list[tuple[str | None, Verdict]]:
    """The verdict for each robot that a history speaks of, in the order of their first lines.

    A line without a robot belongs to the one conversation of the file. A file that begins with a message of a status
    subscription is the bare messages of that subscription; what is wrong with one is told at once.

    Raises:
        UnreadableError: there is no such file, or a line is not of the format; the message says where and what.
        ValueError: `readings` names something that does not exist.
    """
    lost = lost_calls(path)
    # What can be read again is not kept while it is read.
    keep = 0 if Path(path).is_file() else KEPT
    source = open_history(path)
    try:
        numbered = lines(source, path)
        number, line = next(numbered, (0, None))
        if not number:
            message = f"{'stdin' if path == STDIN else path}: the history is empty"
            raise UnreadableError(message)
        watched = subscription(line)
        if watched:
            return [(None, watch_messages(watched, itertools.chain([(number, line)], numbered), tell))]
        try:
            first = head(line)
            stamps = Stamps()
            stamps.robot(line)
            judged = system(first.system)
            automaton = Automaton(judged.spec, first.drives, constrain(judged.spec.ambiguities, readings or {}))

            def new_judge(robot: str | None) -> Judge:
                calls = lost.get(robot, frozenset())
                return Judge(judged, first, automaton, fingerprint=fingerprint, lost=calls, keep=keep)

            nobody = new_judge(None)
        except UnreadableError as error:
            raise wrong_line(path, number, error) from None
        feed = nobody.feed  # nearly all lines name neither a time nor a robot
        judges: dict[str | None, Judge] = {}
        stopped: dict[str | None, int] = {}
        for number, line in numbered:
            try:
                if type(line) is dict and "at" not in line and "robot" not in line and None in judges:
                    if not feed(line):
                        stopped.setdefault(None, number)
                    continue
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
    found = [(robot, located(verdict, stopped.get(robot))) for robot, verdict in verdicts]
    return found if keep else [(robot, _retold(verdict, path, robot)) for robot, verdict in found]


def _retold(verdict: Verdict, path: str, robot: str | None) -> Verdict:
    """The verdict with the last lines before its violation, read again."""
    if verdict.violation is None:
        return verdict
    kept: deque[JSON] = deque(maxlen=KEPT)
    with open_history(path) as source:
        for number, line in lines(source, path):
            if number > 1 and line.get("robot") == robot:
                kept.append(line)
            if number == verdict.violation.at:
                break
    told = (*verdict.violation.history, *kept)
    return evolve(verdict, violation=evolve(verdict.violation, history=told))


def located(verdict: Verdict, line: int | None) -> Verdict:
    """The verdict with the line of the file in which the violation is."""
    if verdict.violation is None or line is None:
        return verdict
    return evolve(verdict, violation=evolve(verdict.violation, at=line, where=f"line {line}: "))
