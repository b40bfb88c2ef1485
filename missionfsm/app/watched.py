"""Judges bare messages of live subscriptions and bodies of webhooks, one a line, and says at once what is wrong.

One file may hold the messages of several subscriptions and robots. What a message carries tells which it belongs to;
messages of different subscriptions are never compared.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable

from attrs import define, field

from missionfsm.adapters.addresses import Addresses
from missionfsm.app.webhooks import MISSIONS, contradictions, topic_of, unwrapped
from missionfsm.bear.mission import monitor as mission_monitor
from missionfsm.bear.mission.monitor import MissionMonitor
from missionfsm.bear.mission.spec import SPEC as MISSION
from missionfsm.bear.status.monitor import CHECKED, StreamMonitor
from missionfsm.bear.status.spec import SPEC as STATUS
from missionfsm.bear.status.state import Endpoint
from missionfsm.bear.wire.problem import Problem
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.text import counted
from missionfsm.kernel.transport import TR_02
from missionfsm.tools.check.basis import Flagged, Untested
from missionfsm.tools.check.phrases import rules_in_words
from missionfsm.tools.check.verdict import Allowed, Outcome, Verdict, Violation

Numbered = tuple[int, JSON]
_RIGHT = Allowed("a message that keeps the rule")


@define
class _Subscription:
    """The messages of one subscription so far.

    Attributes:
        topic: the name of the subscription.
        strict: whether a message is wrong that was delivered twice.
        status: its monitor, unless it is about missions.
        missions: the monitor of each robot, if it is about missions.
        events: how many messages came.
        problems: how many problems they had that break a rule.
        flagged: how many problems they had that a reading tolerates.
        odd: the first tolerated problem of each rule.
        first: the first problem that breaks a rule, with its line.
    """

    topic: str
    strict: bool
    status: StreamMonitor | None = None
    missions: dict[str, MissionMonitor] = field(factory=dict)
    events: int = 0
    problems: int = 0
    flagged: int = 0
    odd: dict[str, Flagged] = field(factory=dict)
    first: tuple[int, Problem] | None = None

    def __attrs_post_init__(self) -> None:
        if self.topic != MISSIONS:
            self.status = StreamMonitor(Endpoint(self.topic), strict=self.strict)

    def feed(self, robot: str, message: JSON) -> tuple[Problem, ...]:
        """What is wrong with the next message."""
        self.events += 1
        if self.status is not None:
            return self.status.feed(message)
        monitor = self.missions.get(robot)
        if monitor is None:
            monitor = self.missions[robot] = MissionMonitor(robot, strict=self.strict)
        return monitor.feed(message)

    def note(self, number: int, problem: Problem) -> None:
        """Remember a problem of the message in a line."""
        if problem.flagged:
            self.flagged += 1
            says = f"{problem.says} [{problem.rule}] (first in line {number})"
            self.odd.setdefault(problem.rule, Flagged(says, about=problem.rule))
        else:
            self.problems += 1
            self.first = self.first or (number, problem)

    def _robots(self) -> str:
        robots = self.status.robots if self.status else len(self.missions)
        return counted(robots, "robot")

    def verdict(self) -> Verdict:
        """The verdict on the messages so far."""
        spec: Spec = STATUS if self.status else MISSION
        checked = CHECKED if self.status else mission_monitor.CHECKED
        monitors = (self.status,) if self.status else tuple(self.missions.values())
        redelivered = sum(one.redelivered for one in monitors)
        concerned = _concerned(spec, self.topic)
        unchecked = [rule for rule in concerned if rule not in checked]
        repeats = sum(one.repeats for one in monitors)
        notes = [
            f"{self._robots()}, {counted(repeats, 'message')} that {'says' if repeats == 1 else 'say'} nothing new, "
            f"{counted(self.flagged, 'tolerated oddity', 'tolerated oddities')}",
            f"not checked, since no bare message can break them: {counted(len(unchecked), 'rule')}",
        ]
        if self.problems > 1:
            notes.append(f"{self.problems - 1} more problems in this stream")
        twice = (Flagged(f"{TR_02.id}=b: {TR_02.question} {TR_02.readings['b']}"),) if redelivered else ()
        violation = None
        if self.first is not None:
            number, problem = self.first
            rules = rules_in_words(spec, (problem.rule,), self.topic)
            violation = Violation(rules, str(problem), (_RIGHT,), at=number, where=f"line {number}: ")
        return Verdict(
            Outcome.CONFORMS if violation is None else Outcome.VIOLATES,
            spec.system,
            f"a stream of {self.topic}",
            events=self.events,
            violation=violation,
            readings={TR_02.id: ("b",)} if redelivered else {},
            flagged=(*twice, *self.odd.values()),
            unchecked=tuple(f"{rule.id}: no bare message can break it" for rule in unchecked),
            untested=Untested(drives=tuple(spec.drives), unseen=True, all_drives=len(spec.drives)),
            notes=tuple(notes),
            uncounted=_looked_at(concerned, unchecked, self.events),
        )


def _looked_at(concerned: Iterable[Rule], unchecked: Collection[Rule], messages: int) -> frozenset[str]:
    """The ids of the rules that the messages were compared with, if there were any."""
    return frozenset(rule.id for rule in concerned if messages and rule not in unchecked)


def _concerned(spec: Spec, topic: str) -> tuple[Rule, ...]:
    """The rules about a subscription and its messages."""
    operation = spec.operations[topic]
    others = {f"{spec.system}/{name}/" for name in spec.operations if name != topic}
    shared = (rule for rule in spec.rules if not rule.id.startswith(tuple(others)))
    return tuple(dict.fromkeys((*operation.refusals, *operation.promises, *shared)))


def watch_messages(numbered: Iterable[Numbered], tell: Callable[[str], None], *, strict: bool = False) -> list[Verdict]:
    """Judge all messages, and give the verdict on each subscription, those with violations first.

    Args:
        numbered: the lines, each with its number.
        tell: is given every problem as soon as its message is read. A problem that a reading tolerates breaks no rule.
        strict: whether a message is wrong that was delivered twice.

    Raises:
        UnplacedError: a line is no message.
    """
    found: dict[str, _Subscription] = {}
    addresses = Addresses()
    for number, line in numbered:
        try:
            robot, message = addresses.whose(line)
            topic = topic_of(message, found)
        except UnreadableError as error:
            raise UnplacedError(number, str(error)) from None
        one = found.get(topic)
        if one is None:
            one = found[topic] = _Subscription(topic, strict)
        repeated = tuple(contradictions(message)) if topic == MISSIONS and "state" in message else ()
        named, message = unwrapped({name: value for name, value in message.items() if name not in ("at", "robot")})
        problems = list(one.feed(robot or named, message))
        problems += (
            Problem(one.events, robot or named, other.rule.id, other.says, flagged=other.flagged) for other in repeated
        )
        for problem in problems:
            tell(f"line {number}: {problem}" + (" (tolerated)" if problem.flagged else ""))
            one.note(number, problem)
    return sorted((one.verdict() for one in found.values()), key=lambda verdict: verdict.conforms)


class UnplacedError(UnreadableError):
    """A line is no message. Whoever knows the file adds its name."""

    def __init__(self, number: int, says: str) -> None:
        super().__init__(says)
        self.number = number
