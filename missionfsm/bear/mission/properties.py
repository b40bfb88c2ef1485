"""What holds of every robot, and what some robot can come to."""

from __future__ import annotations

from missionfsm.bear.mission.state import ENDED, GOALLESS, LIFECYCLE, NOT_CHOSEN, Mission
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.possibilities import each_met
from missionfsm.kernel.spec import Invariant


def _has_state(mission: Mission, *states: State) -> bool:
    return mission.state in states


INVARIANTS = (
    Invariant(
        "ended-missions-come-first",
        "Missions have their turns in the order ended, active, waiting.",
        lambda robot: (
            all(_has_state(one, *ENDED) for one in robot.done)
            and (robot.active is None or _has_state(robot.active, State.STATE_RUNNING, State.STATE_PAUSED))
            and all(_has_state(one, State.STATE_DEFAULT) for one in robot.pending)
        ),
    ),
    Invariant(
        "the-goal-index-is-a-goal",
        "The current goal of an active mission is one of its goals, or none has been selected.",
        lambda robot: (
            robot.active is None
            or robot.active.kind in GOALLESS
            or NOT_CHOSEN <= robot.active.goal < len(robot.active.goals)
        ),
    ),
    Invariant(
        "only-waiting-missions-halt",
        "A queue without missions is not halted.",
        lambda robot: bool(robot.pending) or not robot.halted,
    ),
    Invariant(
        "a-used-robot-is-not-fresh",
        "A robot that lists a mission was used.",
        lambda robot: not (robot.fresh and robot.turns),
    ),
)
POSSIBILITIES = (
    *each_met(
        LIFECYCLE.states,
        lambda robot: (one.state for one in robot.turns),
        "a-mission-is-{}",
        "Some mission is in {}.",
    ),
    Invariant("a-queue-forms", "Missions wait behind another.", lambda robot: bool(robot.active and robot.pending)),
    Invariant(
        "a-goal-is-left-behind",
        "A mission is past its first goal.",
        lambda robot: bool(robot.active and robot.active.goal > 0),
    ),
    Invariant("a-robot-is-cleared", "A used robot lists nothing.", lambda robot: not robot.fresh and not robot.turns),
)
