"""Judging from Python: what the commands `check`, `conform` and `explore` do, as functions that return their verdict.

    from missionfsm import check, conform, explore

    assert check("today.jsonl").conforms
    verdict = conform("bear.mission", ["node", "my_robot.mjs"], examples=200)
    print(verdict)

None of them prints, and none raises for a negative answer.
"""

from __future__ import annotations

import json
import os
import shlex
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, TypedDict, Unpack

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.readings import constrain
from missionfsm.kernel.system import System
from missionfsm.systems import system as system_named

if TYPE_CHECKING:
    from missionfsm.kernel.subject import Subject
    from missionfsm.tools.check.verdict import Verdict
    from missionfsm.tools.explore.explore import Exploration

History = str | os.PathLike[str] | Iterable[JSON | bytes]
"""The path of a history, or its lines: each a JSON text, or what one stands for."""


class Log(TypedDict, total=False):
    """What is known of a log besides what its first line says.

    Attributes:
        strict: whether nothing was lost, doubled or made up on the way.
        anywhere: whether it begins while the system is in use.
        others: whether others, whose calls are not in it, use the system as well.
        settled_after: how many seconds (of `at`) after its cause something is late.
    """

    strict: bool
    anywhere: bool
    others: bool
    settled_after: float


def check(
    history: History,
    *,
    robot: str | None = None,
    readings: Mapping[str, str] | None = None,
    no_flagged: bool = False,
    **log: Unpack[Log],
) -> Verdict:
    """Judge a recorded history.

    Args:
        history: the path of a file, or the lines of one, the first line included.
        robot: about which of the robots that it speaks of the verdict is to be; needed where there are several.
        readings: ambiguity id to the letter that has to be followed, such as ``{"AM-09": "a"}``; the rest is open.
        no_flagged: whether what departs from the letter of the text is held against the implementation.
        log: what is known of the log itself, see `Log`.

    Raises:
        UnreadableError: there is no such file, or a line is not of the format; the message says where and what.
        ValueError: there is no such robot or reading, or `robot` does not say which of several is meant.
    """
    verdicts = check_robots(history, readings=readings, no_flagged=no_flagged, **log)
    if robot is None and len(verdicts) == 1:
        return next(iter(verdicts.values()))
    if robot in verdicts:
        return verdicts[robot]
    there = ", ".join(sorted(name for name in verdicts if name is not None)) or "none"
    message = f"robot: {robot!r} is not one of those that the history speaks of, which are {there}"
    raise ValueError(message)


def check_robots(
    history: History, *, readings: Mapping[str, str] | None = None, no_flagged: bool = False, **log: Unpack[Log]
) -> dict[str | None, Verdict]:
    """Judge a recorded history that speaks of several robots: the verdict on each, by name.

    The one key of a history that names no robot is None. Arguments and errors are those of `check`.
    """
    from missionfsm.app.recorded import check_file  # noqa: PLC0415 - each function loads what it needs

    if isinstance(history, str | os.PathLike):
        return dict(check_file(os.fspath(history), readings, no_flagged=no_flagged, **log))
    with tempfile.TemporaryDirectory() as folder:  # so that lines are judged in the one way in which files are
        path = os.path.join(folder, "history")  # noqa: PTH118 - it is given on as text
        with open(path, "wb") as file:  # noqa: PTH123 - as above
            file.writelines(map(_line, history))
        try:
            return dict(check_file(path, readings, no_flagged=no_flagged, **log))
        except UnreadableError as error:
            says = str(error).removeprefix(f"{path}:")
            raise UnreadableError(f"line {says}" if says[:1].isdigit() else says.strip()) from None


def _line(line: JSON | bytes) -> bytes:
    """A line of a file."""
    if not isinstance(line, str | bytes):
        line = json.dumps(line)
    return (line.encode() if isinstance(line, str) else line).rstrip(b"\n") + b"\n"


def conform(  # noqa: PLR0913 - every one but the first has a default
    system: str | System,
    implementation: Sequence[str] | Subject | None = None,
    *,
    examples: int | None = None,
    steps: int | None = None,
    seed: int = 0,
    seconds: float | None = None,
    timeout: float = 10.0,
    readings: Mapping[str, str] | None = None,
    no_flagged: bool = False,
    expected: Iterable[str] = (),
    distinguish: bool = False,
) -> Verdict:
    """Judge an implementation by having conversations with it.

    Args:
        system: the system that it implements, or its name.
        implementation: the command that starts its adapter, which is stopped at the end; or an object that has the
            two methods of `missionfsm.kernel.subject.Subject`, which is left alone; by default the built-in reference.
        examples: how many conversations there are in all, of every kind (written down for the system, led where the
            run has been least, drawn); by default as many as the command line has.
        steps: calls and drives in a conversation, at most; by default as many as the command line has.
        seed: the same seed asks the same of the same implementation.
        seconds: how long it may take altogether; by default as long as it takes.
        timeout: seconds that an answer may take.
        readings: ambiguity id to the letter that has to be followed; the rest is found out.
        no_flagged: whether what departs from the letter of the text is held against the implementation.
        expected: ids of rules that are known to be broken.
        distinguish: whether to try at the end what would tell readings apart that are still open.

    Raises:
        SubjectError: the adapter cannot be started, or does not keep to the protocol.
        UnreadableError: there is no system of that name.
        ValueError: `readings` or `expected` names something that does not exist.
        TypeError: the command is one text, and no list.
    """
    from missionfsm.adapters.stdio import Child  # noqa: PLC0415 - each function loads what it needs
    from missionfsm.tools.conform.conform import conform as have_conversations  # noqa: PLC0415
    from missionfsm.tools.conform.plan import STEPS, Plan  # noqa: PLC0415
    from missionfsm.tools.reference.subject import ReferenceSubject  # noqa: PLC0415

    judged = _system(system)
    expected = tuple(expected)
    unknown = [rule for rule in expected if rule not in {**judged.spec.rules_by_id, **judged.spec.implied}]
    if unknown:
        message = f"expected: {judged.name} has no rule {unknown[0]!r}"
        raise ValueError(message)
    end = None if seconds is None else time.monotonic() + seconds

    def enough() -> bool:
        return end is not None and time.monotonic() > end

    own: Child | None = None
    if implementation is None:
        subject: Subject = ReferenceSubject(judged)
    elif isinstance(implementation, str):
        message = f"a command is a list, such as {shlex.split(implementation)}"
        raise TypeError(message)
    elif isinstance(implementation, Sequence):
        subject = own = Child(implementation, timeout, stopped=enough)
    else:
        subject = implementation
    try:
        return have_conversations(
            judged,
            subject,
            plan=Plan.of(examples, STEPS if steps is None else steps),
            seed=seed,
            readings=readings,
            no_flagged=no_flagged,
            expected=expected,
            distinguish=distinguish,
            enough=enough,
        )
    finally:
        if own is not None:
            own.close()


def explore(
    system: str | System,
    *,
    readings: Mapping[str, str] | None = None,
    forget_ended: bool = False,
    size: int = 2,
    **own: int,
) -> Exploration:
    """Visit every state that a system can reach within bounds.

    Args:
        system: the system, or its name.
        readings: ambiguity id to the letter that is followed; of the rest, every reading at every step.
        forget_ended: only count what has ended: far fewer states, in which the same can be done.
        size: how large a state may be at most: for most systems, how many missions are listed.
        own: bounds of the system itself, such as ``goals=3`` and ``batch=1``.

    Raises:
        UnreadableError: there is no system of that name.
        ValueError: `readings` names something that does not exist.
    """
    from missionfsm.tools.explore import explore as explorer  # noqa: PLC0415 - each function loads what it needs

    explored = _system(system)
    assumed = constrain(explored.spec.ambiguities, readings or {})
    return explorer.explore(explored, Bounds(size, **own), assumed=assumed, forget_ended=forget_ended)


def _system(system: str | System) -> System:
    return system_named(system) if isinstance(system, str) else system
