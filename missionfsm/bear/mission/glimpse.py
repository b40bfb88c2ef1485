"""Which robots a status message may show if nothing else is known of them: a log begins while the robot is in use.

What a message does not show is left open as long as that makes few robots: the kind of the active mission, whether it
was told to finish. Possibilities that are left out here are found later, and flagged (`missionfsm.kernel.middle`).
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Collection, Hashable, Iterable, Iterator, Sequence

from missionfsm.bear.mission.matching import FAMILY_TYPES, TYPES, same_mission
from missionfsm.bear.mission.readings.workflows import AM_26
from missionfsm.bear.mission.state import (
    AUTOMATIC,
    ENDED,
    FAMILY,
    GOALLESS,
    NOT_CHOSEN,
    PATROLS,
    Family,
    Fault,
    Kind,
    Mission,
    Robot,
    World,
)
from missionfsm.bear.mission.views import TOPIC, Listing, Seen, listing
from missionfsm.bear.wire.messages import Goal, MissionState, MissionType, State
from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import DEADLINE_EXCEEDED, INTERNAL
from missionfsm.kernel.spec import Glimpses, Middle, Things

MAX_STATES = 32
"""How many robots one message stands for at most."""


@functools.lru_cache(maxsize=1_000)
def states_shown(world: World, content: Seen | Malformed) -> tuple[tuple[Robot, Listing], ...]:
    """Robots that a message may show, the likeliest first, each with the view of it."""
    if isinstance(content, Malformed):
        return ()
    robots = itertools.islice(_robots(world, content), MAX_STATES)
    return tuple((robot, listing(robot)) for robot in dict.fromkeys(robots))


def _robots(world: World, content: Seen) -> Iterator[Robot]:
    missions = content.states.missions
    if not all(content.named) or not missions:
        yield Robot(world, fresh=False)
        yield Robot(world)
        return
    ended = next((place for place, one in enumerate(missions) if one.state not in ENDED), len(missions))
    # An ended mission does nothing any more, so it is taken for one of the kind of which least is known.
    done = tuple(Mission(Kind.RETURN, (), _state(one)) for one in missions[:ended])
    rest = missions[ended:]
    for active in (True, False) if rest and rest[0].state is State.STATE_PAUSED else (_runs(rest),):
        heads = tuple(_active(world, rest[0])) if active else (None,)
        waiting = rest[1:] if active else rest
        for pending in _queues(world, waiting):
            for head in heads:
                yield Robot(world, done, head, pending, fresh=False)
                if head is None and pending:
                    yield Robot(world, done, None, pending, halted=True, fresh=False)


def _runs(rest: tuple[MissionState, ...]) -> bool:
    return bool(rest) and rest[0].state is State.STATE_RUNNING


def _state(message: MissionState) -> State:
    return State(message.state)


def _active(world: World, message: MissionState) -> Iterator[Mission]:
    index = message.current_goal_index
    for kind in _kinds(world, message):
        goals = () if kind in GOALLESS else message.goals
        chosen = (0,) if kind in GOALLESS else (index,) if index in range(len(goals)) else ()
        for goal in (*chosen, NOT_CHOSEN) if kind in AUTOMATIC else chosen:
            for finishing in (False, True):
                yield Mission(kind, goals, _state(message), goal, finishing)


def _queues(world: World, waiting: Sequence[MissionState]) -> Iterable[tuple[Mission, ...]]:
    """The waiting missions: all of their likeliest kinds, or all of their least likely ones."""
    return dict.fromkeys(tuple(_waiting(world, one, which) for one in waiting) for which in (0, -1))


def _waiting(world: World, message: MissionState, which: int) -> Mission:
    kind = _kinds(world, message)[which]
    goals = () if kind in GOALLESS else message.goals
    return Mission(kind, goals, goal=NOT_CHOSEN if kind in AUTOMATIC else 0)


def _kinds(world: World, message: MissionState) -> tuple[Kind, ...]:
    """The kinds that a mission of this type may have, the likeliest first; of kinds that look and act alike, one."""
    stated = message.mission_type or MissionType()
    known = [
        kind for kind, types in TYPES.items() if stated in types or stated == FAMILY_TYPES.get((kind, world.family))
    ]
    known.sort(key=lambda kind: stated not in TYPES[kind])  # a kind that reports its own type assumes nothing
    if not known or stated == MissionType():
        known += [kind for kind in AM_26 if FAMILY[kind] in (None, world.family)]
    kinds = known if message.goals else []
    if not kinds:
        kinds = [Kind.RETURN] if len(message.goals) > 1 else [Kind.CHARGE, Kind.RETURN]
    alike = {
        (kind in PATROLS, kind in AUTOMATIC, kind in GOALLESS and kind, stated in TYPES.get(kind, ())): kind
        for kind in reversed(kinds)
    }
    return tuple(reversed(alike.values()))


@functools.lru_cache(maxsize=100)
def samples(world: World) -> tuple[Robot, ...]:
    """Robots that stand for all others: in any state, a request is answered as by one of them."""
    goals = tuple(Goal(destination_id=name) for name in world.destinations[:2]) or (Goal(destination_id="-"),)
    active = tuple(_under_way(world, goals))
    waits = Mission(Kind.BASE_NAVIGATE, goals[:1])
    over = Mission(Kind.BASE_NAVIGATE, goals[:1], State.STATE_SUCCEEDED)
    nothing = (Robot(world), Robot(world, fresh=False), Robot(world, (over,), fresh=False))
    waiting = (
        Robot(world, done, None, (waits,), halted=halted, fresh=False)
        for done, halted in itertools.product(((), (over,)), (False, True))
    )
    busy = (
        Robot(world, done, one, pending, fresh=False)
        for one, done, pending in itertools.product(active, ((), (over,)), ((), (waits,)))
    )
    armed = (
        Robot(one.world, one.done, one.active, one.pending, one.halted, one.fresh, Fault(status, applied))
        for one in (*nothing[1:], Robot(world, (), active[0], (waits,), fresh=False))
        for status, applied in itertools.product((INTERNAL, DEADLINE_EXCEEDED), (False, True))
    )
    return (*nothing, *waiting, *busy, *armed)


def _under_way(world: World, goals: tuple[Goal, ...]) -> Iterator[Mission]:
    """Every mission that may be active on a robot of this family, at each of its goals."""
    for kind in Kind:
        if FAMILY[kind] in (None, world.family):
            own = () if kind in GOALLESS else goals
            for state, goal, finishing in itertools.product(
                (State.STATE_RUNNING, State.STATE_PAUSED), range(len(own) or 1), (False, True)
            ):
                yield Mission(kind, own, state, goal, finishing)


def things(robot: Robot, names: tuple[int, ...]) -> Things:
    """The kind and the goals of each mission, in the order of the list."""
    return tuple(zip(robot.listed(names), robot.listed(tuple(map(_lasting, robot.turns))), strict=True))


@functools.lru_cache(maxsize=10_000)
def _lasting(mission: Mission) -> Mission:
    return Mission(mission.kind, mission.goals)


def shown(view: Listing, names: tuple[int, ...]) -> Things:
    """The missions that a message listed, each in the state that it had."""
    return tuple(zip(names, view.missions, strict=True))


def follows(
    world: World, before: Things, content: Seen | Malformed, names: tuple[int, ...]
) -> tuple[Assumption, ...] | None:
    """What is assumed if calls have made of some missions those of a message; None if no calls can have.

    Missions keep their order, their goals and their type; one that has ended stays as it ended, and one that has begun
    never waits again. While one goes on, those that wait stay listed.
    """
    if isinstance(content, Malformed):
        return None
    places = {name: place for place, name in enumerate(names)}
    kept = [(places[name], mission) for name, mission in before if name in places]
    if any(one >= other for (one, _), (other, _) in itertools.pairwise(kept)):
        return None
    listed = content.states.missions
    under_way = any(_was(one, _BEGUN) and listed[place].state in _BEGUN for place, one in kept)
    if under_way and not all(_was(one, ENDED) for name, one in before if name not in places):
        return None
    assumes: list[Assumption] = []
    for place, mission in kept:
        found = _goes_on(world.family, mission, listed[place])
        if found is None:
            return None
        assumes += found
    return tuple(dict.fromkeys(assumes))


def _was(before: Hashable, states: Collection[State]) -> bool:
    """Whether a mission was in one of these states."""
    return isinstance(before, Mission) and before.state in states


@functools.lru_cache(maxsize=10_000)
def _goes_on(family: Family, before: Mission, message: MissionState) -> tuple[Assumption, ...] | None:
    """What is assumed if a mission is listed like this later; None if it cannot be."""
    if before.state in ENDED and message.state is not before.state:
        return None
    if before.state in _BEGUN and message.state in (State.STATE_DEFAULT, State.STATE_UNKNOWN):
        return None
    return same_mission(family, before, message)


_BEGUN = {State.STATE_RUNNING, State.STATE_PAUSED}


MIDDLE = Middle(
    Glimpses(
        world=lambda robot: robot.world,
        states=states_shown,
        samples=samples,
        topic=lambda _: TOPIC,
        things=things,
        shown=shown,
        follows=follows,
    )
)


__all__ = ["MIDDLE"]
