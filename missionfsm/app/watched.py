"""Judge bare messages of live subscriptions, or bodies of webhooks, a line each: what is wrong is told at once.

One file may hold the messages of several subscriptions and robots: what a message carries tells them apart, and what
comes on one is never compared with what comes on another.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator

from attrs import define, field

from missionfsm.adapters.addresses import Addresses
from missionfsm.bear.mission import monitor as mission_monitor
from missionfsm.bear.mission.monitor import MissionMonitor
from missionfsm.bear.mission.promises import CURRENT, GOAL_INDEX
from missionfsm.bear.mission.spec import SPEC as MISSION
from missionfsm.bear.status.monitor import CHECKED, StreamMonitor
from missionfsm.bear.status.spec import SPEC as STATUS
from missionfsm.bear.status.state import MAPS, SINGLES, Endpoint
from missionfsm.bear.wire.problem import Problem
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.text import brief, counted
from missionfsm.kernel.transport import TR_02
from missionfsm.tools.check.basis import Flagged, Untested
from missionfsm.tools.check.phrases import rules_in_words
from missionfsm.tools.check.verdict import Allowed, Outcome, Verdict, Violation

Numbered = tuple[int, JSON]

MISSIONS = "SubscribeMissionStatus"
_SNAKE = str.maketrans({capital: f"_{capital.lower()}" for capital in "ABCDEFGHIJKLMNOPQRSTUVWXYZ"})
_FIELDS: dict[str, str] = {
    name: topic
    for topic, carrier in (
        (MISSIONS, "missionStates"),
        *((endpoint.value, carrier) for endpoint, carrier in (*MAPS.items(), *SINGLES.items())),
    )
    for name in (carrier, carrier.translate(_SNAKE))
}
"""The field that carries the states, in both of its spellings, to the subscription whose messages have it."""
_MAPPED = frozenset(name for carrier in MAPS.values() for name in (carrier, carrier.translate(_SNAKE)))
_ENVELOPE = frozenset({"metadata", "robotId", "robot_id"})
_RIGHT = Allowed("a message that keeps the rule")


def subscription(message: JSON) -> str | None:
    """The subscription that a message, or the body of a webhook, is of; None for what is no such message."""
    if not isinstance(message, dict) or "missionfsm" in message:
        return None
    if isinstance(message.get("state"), dict) and message.keys() & {"robot_id", "robotId"}:
        state = message["state"]
        return MISSIONS if "missions" in state else next((_FIELDS[name] for name in state if name in _FIELDS), None)
    return next((_FIELDS[name] for name in message if name in _FIELDS), None)


def _unwrapped(message: JSON) -> tuple[str, JSON]:
    """The robot that a message names outside of its documented fields, and the message as a subscription sends it."""
    robot = message.get("robot_id") or message.get("robotId") or ""
    if isinstance(message.get("state"), dict):
        return _posted(robot, message["state"])
    if subscription(message) == MISSIONS and isinstance(robot, str):  # a message of a mission stream names no robot
        return robot, {name: value for name, value in message.items() if name not in ("robotId", "robot_id")}
    return "", message


def _posted(robot: JSON, state: JSON) -> tuple[str, JSON]:
    """What the body of a webhook says: its `state` is a message of the subscription, without the envelope."""
    known = {name: value for name, value in state.items() if name not in ("current_mission", "current_goal")}
    metadata = {"metadata": known.pop("metadata")} if "metadata" in known else {}
    if "missions" in known:
        return str(robot), {**metadata, "missionStates": known}
    name = next((name for name in known if name in _MAPPED), None)
    if name is not None:
        entry = known[name] if isinstance(known[name], dict) else {name: known[name]}
        return "", {name: {robot: {**metadata, **entry}}}
    return "", {**metadata, "robotId": robot, **known}


def _contradictions(message: JSON) -> Iterator[tuple[Rule, str]]:
    """What the body of a webhook repeats of the current mission, and its list of missions says otherwise."""
    state = _without_nulls(message.get("state"))
    missions = state.get("missions", []) if isinstance(state, dict) else None
    if not isinstance(missions, list):
        return
    mission = _at(missions, state.get("current_mission_index", state.get("currentMissionIndex", 0)))
    shown = state.get("current_mission")
    if shown is not None and shown != mission:
        yield CURRENT, "current_mission is not the one in missions at current_mission_index"
        mission = shown
    of = mission if isinstance(mission, dict) else {}
    index = of.get("current_goal_index", of.get("currentGoalIndex", 0))
    goal = state.get("current_goal")
    if goal is not None and goal != _at(of.get("goals"), index):
        yield GOAL_INDEX, "current_goal is not the one in goals at current_goal_index"


def _at(listed: JSON, index: JSON) -> JSON:
    return listed[index] if isinstance(listed, list) and type(index) is int and 0 <= index < len(listed) else None


def _without_nulls(value: JSON) -> JSON:
    """A value without its members that are null: those are unset."""
    if isinstance(value, dict):
        return {name: _without_nulls(one) for name, one in value.items() if one is not None}
    return [_without_nulls(one) for one in value] if isinstance(value, list) else value


@define
class _Subscription:
    """What came of one subscription so far."""

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
        """Remember a problem, of the message in a line."""
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
        """The judgement of what came."""
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
    """The ids of the rules that messages were held against, if there were any."""
    return frozenset(rule.id for rule in concerned if messages and rule not in unchecked)


def _concerned(spec: Spec, topic: str) -> tuple[Rule, ...]:
    """The rules about a subscription and what it shows."""
    operation = spec.operations[topic]
    others = {f"{spec.system}/{name}/" for name in spec.operations if name != topic}
    shared = (rule for rule in spec.rules if not rule.id.startswith(tuple(others)))
    return tuple(dict.fromkeys((*operation.refusals, *operation.promises, *shared)))


def watch_messages(numbered: Iterable[Numbered], tell: Callable[[str], None], *, strict: bool = False) -> list[Verdict]:
    """The verdict on each subscription, those with violations first; every problem is told when its message is there.

    What only departs from the letter of the page, in a way that a reading tolerates, is told, but breaks nothing.

    Args:
        strict: whether a message that is only delivered twice is wrong.

    Raises:
        UnreadableError: a line is no message, with the number of the line first.
    """
    found: dict[str, _Subscription] = {}
    addresses = Addresses()
    for number, line in numbered:
        try:
            robot, message = addresses.whose(line)
            topic = _topic(message, found)
        except UnreadableError as error:
            raise UnplacedError(number, str(error)) from None
        one = found.get(topic)
        if one is None:
            one = found[topic] = _Subscription(topic, strict)
        repeated = tuple(_contradictions(message)) if topic == MISSIONS and "state" in message else ()
        named, message = _unwrapped({name: value for name, value in message.items() if name not in ("at", "robot")})
        problems = list(one.feed(robot or named, message))
        problems += (Problem(one.events, robot or named, rule.id, says, flagged=True) for rule, says in repeated)
        for problem in problems:
            tell(f"line {number}: {problem}" + (" (tolerated)" if problem.flagged else ""))
            one.note(number, problem)
    return sorted((one.verdict() for one in found.values()), key=lambda verdict: verdict.conforms)


class UnplacedError(UnreadableError):
    """A line is no message; who knows the file says where."""

    def __init__(self, number: int, says: str) -> None:
        super().__init__(says)
        self.number = number


def _topic(message: JSON, known: Iterable[str]) -> str:
    """The subscription of a message; one without a payload is of the only subscription that there is."""
    topic = subscription(message)
    if topic is not None:
        return topic
    topics = tuple(known)
    if len(topics) == 1 and (not message or message.keys() & _ENVELOPE):
        return topics[0]
    says = f"{brief(message)} is no message of a subscription: it has none of {', '.join(tuple(_FIELDS)[::2])}"
    raise UnreadableError(says)
