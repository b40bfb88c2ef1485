"""A monitor that takes the messages of one live mission subscription and says what is wrong with each of them.

It knows nothing of the robot but its messages, and nothing of the calls. A message is compared with the rules of the
specification and with the messages before it. As messages may be lost in between, only what no sequence of steps can
bring about is wrong.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from operator import itemgetter

from missionfsm.bear.mission.codec import read_content, split_message
from missionfsm.bear.mission.promises import (
    ALL_LISTED,
    CURRENT,
    FEEDBACK,
    GOAL_INDEX,
    GOALS,
    SEQUENCE,
    STATE,
    TYPE,
    WELL_FORMED,
)
from missionfsm.bear.mission.state import ENDED, LIFECYCLE
from missionfsm.bear.mission.views import Seen
from missionfsm.bear.wire.messages import BaseType, CartiType, MissionState, MissionType, ServiType, State
from missionfsm.bear.wire.problem import Problem
from missionfsm.kernel.codec import JSON, Malformed
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.sequence import relation

CHECKED = (WELL_FORMED, SEQUENCE, ALL_LISTED, CURRENT, STATE, GOALS, GOAL_INDEX, FEEDBACK, TYPE)
"""The rules that a bare message can break."""

Found = tuple[Rule, str]
_WAITING = frozenset({State.STATE_DEFAULT, State.STATE_UNKNOWN})
_MAY_WAIT = frozenset({State.STATE_DEFAULT, State.STATE_PAUSED})
_AUTOMATIC = (
    MissionType(base_type=BaseType.BASE_TYPE_NAVIGATE_AUTO),
    MissionType(servi_type=ServiType.SERVI_TYPE_NAVIGATE_AUTO),
    MissionType(carti_type=CartiType.CARTI_TYPE_NAVIGATE_AUTO),
)
"""The types of missions that select their goal themselves, some time after they have started."""

_BY_THEMSELVES = (
    *_AUTOMATIC,
    MissionType(base_type=BaseType.BASE_TYPE_NAVIGATE),
    MissionType(servi_type=ServiType.SERVI_TYPE_NAVIGATE),
    MissionType(carti_type=CartiType.CARTI_TYPE_NAVIGATE),
)
"""The types of missions that are neither charges nor made by workflows."""

_ONCE_ROUND = (
    MissionType(servi_type=ServiType.SERVI_TYPE_SERVING),
    MissionType(servi_type=ServiType.SERVI_TYPE_BUSSING),
    MissionType(carti_type=CartiType.CARTI_TYPE_TRAVERSE),
)
"""The types of missions that go from goal to goal and are no patrols."""


def _reached() -> dict[State, frozenset[State]]:
    """For each state of a mission, the states in which it may be seen later, whatever was not seen in between."""
    found: dict[State, frozenset[State]] = {}
    for state in LIFECYCLE.states:
        reached, todo = {state}, [state]
        while todo:
            here = todo.pop()
            later = {after for _, before, after in LIFECYCLE.table if before is here} - reached
            reached |= later
            todo += later
        found[state] = frozenset(reached)
    # AM-08: one that waits may be shown as paused as long as the index does not point at it.
    found[State.STATE_PAUSED] |= {State.STATE_DEFAULT}
    return found


_REACHED = _reached()


MAX_GONE = 50_000
"""How many missions a monitor remembers that are no longer listed."""


class MissionMonitor:
    """Judges the messages of one robot's stream as they come.

    Args:
        robot: the robot that they are about, if that is known.
        strict: whether a message is wrong that was delivered twice.

    Attributes:
        messages: how many messages came.
        repeats: how many of them list the same missions in the same way as the one before.
        redelivered: how many of them equal the one before, with its number and timestamp.
    """

    def __init__(self, robot: str = "", *, strict: bool = False) -> None:
        self.robot = robot
        self.messages = 0
        self.repeats = 0
        self.redelivered = 0
        self._strict = strict
        self._number: int | None = None
        self._last: JSON = None
        self._missions: dict[object, MissionState] = {}
        self._gone: dict[object, None] = {}
        self._begun: frozenset[object] = frozenset()
        self._odd: frozenset[Found] = frozenset()

    def feed(self, message: JSON) -> tuple[Problem, ...]:
        """What is wrong with the next message; nothing, usually."""
        self.messages += 1
        ((names, marks, rest),) = split_message(message)
        if marks and marks[0][1] == self._number and message == self._last and not self._strict:
            self.redelivered += 1
            return ()
        found = list(self._numbered(marks[0][1])) if marks else []
        self._last = message
        seen = read_content(rest)
        if isinstance(seen, Malformed):
            found.append((WELL_FORMED, seen.says))
        elif isinstance(seen, Seen):
            found += self._shown(seen, names)
        problems = [Problem(self.messages, self.robot, rule.id, says) for rule, says in found]
        if isinstance(seen, Seen):
            odd = frozenset(self._departing(seen, names))
            broken = {rule for rule, _ in found}
            new = sorted((one for one in odd - self._odd if one[0] not in broken), key=itemgetter(1))
            problems += (Problem(self.messages, self.robot, rule.id, says, flagged=True) for rule, says in new)
            self._odd = odd
            self._missions = dict(zip(names, seen.states.missions, strict=False))
            self._begun = self._have_begun(seen, names)
        return tuple(problems)

    def _shown(self, seen: Seen, names: tuple[object, ...]) -> Iterator[Found]:
        """What is wrong with a list of missions by itself, and after the list before it."""
        missions = dict(zip(names, seen.states.missions, strict=False))
        self.repeats += missions == self._missions and self.messages > 1
        # What cannot have become of a mission comes first: where it is wrong, its place and the index are as well.
        yield from self._goes_on(missions)
        yield from _listed(seen, names, self._begun)
        yield from self._come_back(seen, names)
        if all(seen.named):
            yield from self._put_in_front(missions)

    def _come_back(self, seen: Seen, names: tuple[object, ...]) -> Iterator[Found]:
        """Missions that were no longer listed, and are again: they were removed, and an id is that of one mission.

        A robot that restarts, which is told by its number, may give ids anew.
        """
        listed = dict.fromkeys(name for name, named in zip(names, seen.named, strict=False) if named)
        for name in listed:
            if name in self._gone:
                yield ALL_LISTED, f"mission {name} is listed again, after messages in which it was not"
                del self._gone[name]
        self._gone.update(dict.fromkeys(name for name in self._missions if name not in listed))
        while len(self._gone) > MAX_GONE:
            del self._gone[next(iter(self._gone))]

    def _have_begun(self, seen: Seen, names: tuple[object, ...]) -> frozenset[object]:
        """The missions that messages have shown to have begun, and not to have ended.

        AM-08: a waiting mission may be shown as paused, unless the index points at it.
        """
        index = seen.states.current_mission_index
        return frozenset(
            name
            for place, (name, one) in enumerate(zip(names, seen.states.missions, strict=False))
            if one.state is State.STATE_RUNNING
            or (one.state is State.STATE_PAUSED and (place == index or name in self._begun))
        )

    def _put_in_front(self, missions: dict[object, MissionState]) -> Iterator[Found]:
        """New missions that are listed before an old one, although they may not be.

        A charge or a mission of a workflow may be listed before one that waited (AM-07, AM-37).
        """
        old = [name for name in missions if name in self._missions]
        listed = list(missions)
        for name, mission in missions.items():
            if name in self._missions:
                continue
            behind = next((one for one in old if listed.index(one) > listed.index(name)), None)
            if behind is None:
                return
            waited = _stage(self._missions[behind]) in _MAY_WAIT and behind not in self._begun
            if mission.mission_type in _BY_THEMSELVES or not waited:
                yield ALL_LISTED, f"mission {name} is new, and listed before {behind}"

    def _departing(self, seen: Seen, names: tuple[object, ...]) -> Iterator[Found]:
        """What departs from the text in a way that a reading, or a message that was lost, may explain."""
        index, missions = seen.states.current_mission_index, seen.states.missions
        active = any(one.state in (State.STATE_RUNNING, State.STATE_PAUSED) for one in missions)
        if 0 <= index < len(missions) and not active and all(seen.named):
            yield CURRENT, f"current_mission_index is {index}, and no mission is active"
        for name, mission in zip(names, missions, strict=False):
            before = self._missions.get(name)
            if (
                before is not None
                and name in self._begun
                and mission.state in (State.STATE_RUNNING, State.STATE_PAUSED)
                and mission.mission_type in _ONCE_ROUND
                and 0 <= mission.current_goal_index < before.current_goal_index
            ):
                goals = f"from goal {before.current_goal_index} to {mission.current_goal_index}"
                yield GOAL_INDEX, f"mission {name} went back {goals}, and is no patrol"

    def _numbered(self, number: int) -> Iterator[Found]:
        compared = relation(self._number, number)
        if compared != "larger":
            self._gone.clear()  # the robot has restarted, or the message is an old one
        if compared not in ("first", "larger", "zero"):
            yield SEQUENCE, f"the sequence number is {compared} ({number} after {self._number})"
        self._number = number

    def _goes_on(self, missions: dict[object, MissionState]) -> Iterator[Found]:
        """Changes of the missions that were listed before which cannot have come about."""
        both = [name for name in missions if name in self._missions]
        if both != [name for name in self._missions if name in missions]:
            yield ALL_LISTED, "the missions have changed places"
        for name in both:
            before, after = self._missions[name], missions[name]
            if before.mission_type != after.mission_type:
                yield TYPE, f"mission {name} has another type than before"
            if before.goals != after.goals:
                yield GOALS, f"mission {name} has other goals than before"
            allowed = _REACHED.get(_stage(before), frozenset())
            if name in self._begun:
                allowed -= {State.STATE_DEFAULT}
            if allowed and isinstance(after.state, State) and _stage(after) not in allowed:
                yield STATE, f"mission {name} is {after.state.name}, and was {_name(before.state)} before"


def _stage(mission: MissionState) -> State:
    """The state of the lifecycle that a message shows. AM-08: a waiting mission may be shown as unknown."""
    state = mission.state
    return State(state) if isinstance(state, State) and state not in _WAITING else State.STATE_DEFAULT


def _name(state: int) -> str:
    return state.name if isinstance(state, State) else f"state {state}"


def _listed(seen: Seen, names: tuple[object, ...], begun: frozenset[object]) -> Iterator[Found]:
    """What is wrong with a list of missions by itself, given those that are known to have begun."""
    missions = seen.states.missions
    placeholder = len(missions) == 1 and not seen.named[0] and _stage(missions[0]) is State.STATE_DEFAULT
    if not placeholder:  # AM-35, AM-36: one without an id stands for an empty list
        if not all(seen.named):
            yield ALL_LISTED, f"mission {seen.named.index(False)} has no id"
        if len(set(names)) < len(names):
            yield ALL_LISTED, "a mission is listed twice"
    for index, mission in enumerate(missions):
        if not isinstance(mission.state, State):
            yield STATE, f"mission {index} is {_name(mission.state)}"
        yield from _one(index, mission, begun=names[index] in begun if index < len(names) else False)
    yield from _ordered(seen, {place for place, name in enumerate(names) if name in begun})


def _ordered(seen: Seen, begun: set[int]) -> Iterator[Found]:
    """What is wrong with the order (ended missions, then a running one, then the others) and with the current index.

    A mission that is shown as paused is the active one or waits (AM-08). A charge or the missions of a workflow may
    have had their turns before missions that were assigned earlier (AM-07, AM-37). When a mission fails that cannot be
    done nothing says, so it may have failed while it waited (AM-43 b).
    """
    missions, index = seen.states.missions, seen.states.current_mission_index
    stages = [0 if one.state in ENDED else 1 if one.state is State.STATE_RUNNING else 2 for one in missions]
    in_turn = [stage for stage, one in zip(stages, missions, strict=True) if _waits_its_turn(one)]
    if any(before > after for before, after in pairwise(in_turn)) or stages.count(1) > 1:
        yield STATE, "the missions are not in the order ended, active, waiting"
        return
    paused = {place for place in begun if missions[place].state is State.STATE_PAUSED}
    allowed = paused if paused and 1 not in stages else _active_places(missions, stages)
    if index not in allowed:
        values = " or ".join(str(value) for value in sorted(allowed))
        yield CURRENT, f"current_mission_index is {index}, expected {values}"


def _active_places(missions: tuple[MissionState, ...], stages: list[int]) -> set[int]:
    """The places that the active mission may have in a list with these stages; -1 if none need be active."""
    if not missions:
        return {-1}
    if 1 in stages:
        return {stages.index(1)}
    last = max((place for place, stage in enumerate(stages) if stage == 0), default=-1)
    paused = {place for place, one in enumerate(missions) if one.state is State.STATE_PAUSED and _may_overtake(one)}
    return paused | ({-1, last, stages.index(2)} if 2 in stages else {-1, max(last, 0)})


def _may_overtake(mission: MissionState) -> bool:
    """Whether a mission may be a charge or one of a workflow that has had its turn."""
    return mission.state not in _WAITING and mission.mission_type not in _BY_THEMSELVES


def _waits_its_turn(mission: MissionState) -> bool:
    """Whether a mission is what it is only after all that were listed before it have had their turns."""
    return mission.state is not State.STATE_FAILED and not _may_overtake(mission)


def _one(index: int, mission: MissionState, *, begun: bool) -> Iterator[Found]:
    """What is wrong with the goal index and the feedback of one mission.

    Where one that has begun is shown as waiting, that is wrong and not its feedback.
    """
    goal, goals = mission.current_goal_index, len(mission.goals)
    chooses = goals < 2 or mission.mission_type in _AUTOMATIC
    if not -1 <= goal <= goals or (mission.state is State.STATE_RUNNING and not chooses and not 0 <= goal < goals):
        yield GOAL_INDEX, f"mission {index} has current_goal_index {goal} and {goals} goals"
    feedback = mission.mission_feedback
    statuses = (feedback.base_feedback, feedback.servi_feedback, feedback.carti_feedback) if feedback else ()
    if mission.state in _WAITING and not begun and any(one is not None and one.status for one in statuses):
        yield FEEDBACK, f"mission {index} waits and has feedback"
