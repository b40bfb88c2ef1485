"""Judge the bare messages of one live subscription to a robot's status, a line each: what is wrong is told at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from missionfsm.bear.status.monitor import Problem, StreamMonitor
from missionfsm.bear.status.spec import SPEC
from missionfsm.bear.status.state import MAPS, SINGLES, Endpoint
from missionfsm.kernel.codec import JSON
from missionfsm.tools.check.explain import told
from missionfsm.tools.check.verdict import Allowed, Outcome, Verdict, Violation

Numbered = tuple[int, JSON]

_SNAKE = str.maketrans({capital: f"_{capital.lower()}" for capital in "ABCDEFGHIJKLMNOPQRSTUVWXYZ"})
_FIELDS: dict[str, Endpoint] = {
    name: endpoint for endpoint, field in (*MAPS.items(), *SINGLES.items()) for name in (field, field.translate(_SNAKE))
}
"""The field that carries the states, in both of its spellings, to the subscription whose messages have it."""
_RIGHT = Allowed("a message that keeps the rule")


def subscription(message: JSON) -> Endpoint | None:
    """The subscription that a message is of; None for what is no status message."""
    fields = message if isinstance(message, dict) and "missionfsm" not in message else ()
    return next((_FIELDS[name] for name in fields if name in _FIELDS), None)


def watch_messages(endpoint: Endpoint, numbered: Iterable[Numbered], tell: Callable[[str], None]) -> Verdict:
    """The verdict on the messages of one stream; every problem is told as soon as its message is there.

    What only departs from the letter of the page, in a way that a reading tolerates, is told, but breaks nothing.
    """
    monitor = StreamMonitor(endpoint)
    first: tuple[int, Problem] | None = None
    problems = flagged = 0
    for number, message in numbered:
        for problem in monitor.feed(message):
            tell(f"line {number}: {problem}" + (" (tolerated)" if problem.flagged else ""))
            flagged += problem.flagged
            if not problem.flagged:
                problems += 1
                first = first or (number, problem)
    notes = (f"{monitor.robots} robots, {monitor.repeats} messages that say nothing new, {flagged} tolerated oddities",)
    about = f"a stream of {endpoint.value}"
    if first is None:
        return Verdict(Outcome.CONFORMS, SPEC.system, about, events=monitor.messages, notes=notes)
    number, problem = first
    more = (f"{problems - 1} more problems in this stream",) if problems > 1 else ()
    violation = Violation(
        told(SPEC, (problem.rule,)), str(problem), (_RIGHT,), more, at=number, where=f"line {number}: "
    )
    return Verdict(Outcome.VIOLATES, SPEC.system, about, events=monitor.messages, violation=violation, notes=notes)
