"""How an implementation of the mission API may break its promises: one wrong thing at a time, to test the oracle."""

from __future__ import annotations

import copy
from collections.abc import Callable

from attrs import evolve

from missionfsm.bear.mission import promises
from missionfsm.bear.mission.spec import SPEC
from missionfsm.bear.mission.state import Mission, Robot
from missionfsm.bear.mission.views import listing
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.mutations import MessageMutation, StepMutation
from missionfsm.kernel.step import Step


def _each(change: Callable[[JSON], None]) -> Callable[[JSON], JSON]:
    """A change of every listed mission of a message."""

    def mutate_message(message: JSON) -> JSON:
        changed = copy.deepcopy(message)
        for mission in changed["missionStates"]["missions"]:
            change(mission)
        return changed

    return mutate_message


def _whole(change: Callable[[JSON], None]) -> Callable[[JSON], JSON]:
    def mutate_message(message: JSON) -> JSON:
        changed = copy.deepcopy(message)
        change(changed)
        return changed

    return mutate_message


def _running_as_paused(mission: JSON) -> None:
    if mission["state"] == "STATE_RUNNING":
        mission["state"] = "STATE_PAUSED"


def _failed_as_succeeded(mission: JSON) -> None:
    if mission["state"] in ("STATE_FAILED", "STATE_CANCELED"):
        mission["state"] = "STATE_SUCCEEDED"


def _waiting_as_running(mission: JSON) -> None:
    if mission["state"] == "STATE_DEFAULT":
        mission["state"] = "STATE_RUNNING"


def _another_type(mission: JSON) -> None:
    if "missionType" in mission:
        mission["missionType"] = {"baseType": "BASE_TYPE_UNKNOWN"}


def _wrong_feedback(mission: JSON) -> None:
    mission["missionFeedback"] = {"baseFeedback": {"status": "STATUS_NAVIGATING"}, "cartiFeedback": {"status": 1}}


def _next_index(mission: JSON) -> None:
    mission["currentGoalIndex"] = mission["currentGoalIndex"] + 1


def _twice(message: JSON) -> None:
    message["missionStates"]["missions"] *= 2


MESSAGE_MUTATIONS = (
    MessageMutation(
        promises.WELL_FORMED.id, "has an unknown state", _each(lambda one: one.update(state="STATE_DANCING"))
    ),
    MessageMutation(
        promises.WELL_FORMED.id,
        "has a text for an index",
        _whole(lambda one: one["missionStates"].update(currentMissionIndex="first")),
    ),
    MessageMutation(
        promises.SEQUENCE.id, "never changes", _whole(lambda one: one["metadata"].update(sequenceNumber=7))
    ),
    MessageMutation(
        promises.SEQUENCE.id,
        "goes down",
        _whole(lambda one: one["metadata"].update(sequenceNumber=10**6 - one["metadata"]["sequenceNumber"])),
    ),
    MessageMutation(promises.SEQUENCE.id, "is negative", _whole(lambda one: one["metadata"].update(sequenceNumber=-1))),
    MessageMutation(
        promises.ALL_LISTED.id,
        "leaves out the last",
        _whole(lambda one: one["missionStates"].update(missions=one["missionStates"]["missions"][:-1])),
    ),
    MessageMutation(
        promises.ALL_LISTED.id, "lists in reverse", _whole(lambda one: one["missionStates"]["missions"].reverse())
    ),
    MessageMutation(promises.ALL_LISTED.id, "lists twice", _whole(_twice)),
    MessageMutation(
        promises.CURRENT.id,
        "is one too high",
        _whole(
            lambda one: one["missionStates"].update(currentMissionIndex=one["missionStates"]["currentMissionIndex"] + 1)
        ),
    ),
    MessageMutation(
        promises.CURRENT.id, "is always 0", _whole(lambda one: one["missionStates"].update(currentMissionIndex=0))
    ),
    MessageMutation(promises.STATE.id, "shows running as paused", _each(_running_as_paused)),
    MessageMutation(promises.STATE.id, "shows failed as succeeded", _each(_failed_as_succeeded)),
    MessageMutation(promises.STATE.id, "shows waiting as running", _each(_waiting_as_running)),
    MessageMutation(promises.GOALS.id, "drops the last goal", _each(lambda one: one.update(goals=one["goals"][:-1]))),
    MessageMutation(promises.GOALS.id, "reverses the goals", _each(lambda one: one["goals"].reverse())),
    MessageMutation(promises.GOAL_INDEX.id, "is one too high", _each(_next_index)),
    MessageMutation(promises.GOAL_INDEX.id, "never moves", _each(lambda one: one.update(currentGoalIndex=0))),
    MessageMutation(promises.FEEDBACK.id, "has two members", _each(_wrong_feedback)),
    MessageMutation(promises.TYPE.id, "has another type", _each(_another_type)),
)


def _last_added_left_out(_: Robot, step: Step) -> Step:
    """The last of several new missions is not listed, though its id is answered."""
    robot: Robot = step.after
    if len(step.refs) < 2 or not robot.pending:
        return step
    return evolve(
        step, after=evolve(robot, pending=robot.pending[:-1], assigned=()), names=(step.names or ())[:-1], emits=()
    )


def _put_first(before: Robot, step: Step) -> Step:
    """New missions wait before the others instead of behind them."""
    robot: Robot = step.after
    kept = len(before.pending)
    if not kept or len(robot.pending) <= kept:
        return step
    fixed = len(robot.turns) - len(robot.pending)
    names = step.names or ()
    return evolve(
        step,
        after=evolve(robot, pending=(*robot.pending[kept:], *robot.pending[:kept])),
        names=(*names[:fixed], *names[fixed + kept :], *names[fixed : fixed + kept]),
        emits=(),
    )


def _ended(state: State) -> Callable[[Robot, Step], Step]:
    """A mission ends in another state than it should."""

    def mutate_step(_: Robot, step: Step) -> Step:
        robot: Robot = step.after
        if not robot.done or robot.active is not None:
            return step
        done = (*robot.done[:-1], evolve(robot.done[-1], state=state))
        return evolve(step, after=evolve(robot, done=done), emits=())

    return mutate_step


def _goal(change: Callable[[Mission], int]) -> Callable[[Robot, Step], Step]:
    def mutate_step(_: Robot, step: Step) -> Step:
        robot: Robot = step.after
        if robot.active is None or not robot.active.goals:
            return step
        return evolve(step, after=evolve(robot, active=evolve(robot.active, goal=change(robot.active))), emits=())

    return mutate_step


def _skips_one(mission: Mission) -> int:
    return min(mission.goal + 1, len(mission.goals) - 1)


def _start_last(_: Robot, step: Step) -> Step:
    """The last waiting mission starts instead of the first; they are listed as they were."""
    robot: Robot = step.after
    if not robot.pending or robot.active is None:
        return step
    fixed = len(robot.done)
    names, listed = step.names or (), robot.assigned or tuple(range(len(robot.turns)))
    last = evolve(robot.pending[-1], state=State.STATE_RUNNING, goal=max(robot.pending[-1].goal, 0))
    waiting = evolve(robot.active, state=State.STATE_DEFAULT, goal=0)
    return evolve(
        step,
        after=evolve(
            robot,
            active=last,
            pending=(waiting, *robot.pending[:-1]),
            assigned=(*listed[:fixed], listed[-1], *listed[fixed:-1]),
        ),
        names=(*names[:fixed], names[-1], *names[fixed:-1]),
        emits=(),
    )


def _showing_it(mutate_step: Callable[[Robot, Step], Step]) -> Callable[[Robot, Step], Step]:
    """The twisted step, showing subscribers what it really did."""

    def twisted_openly(before: Robot, step: Step) -> Step:
        twisted = mutate_step(before, step)
        if twisted is step or not step.emits:
            return twisted
        view = listing(twisted.after)
        return evolve(
            twisted, emits=(evolve(step.emits[-1], view=view, refs=twisted.after.listed(twisted.names or ())),)
        )

    return twisted_openly


def _rule(*place: str) -> str:
    return "/".join((SPEC.system, *place))


STEP_MUTATIONS = (
    *(
        StepMutation(
            _rule(operation, "the-answer-names-the-new-missions-in-order"),
            "leaves out the last",
            _showing_it(_last_added_left_out),
        )
        for operation in ("CreateMissionBatch", "AppendMissionBatch")
    ),
    *(
        StepMutation(_rule(operation, "missions-are-appended-at-the-end"), "puts them first", _showing_it(_put_first))
        for operation in ("AppendMission", "AppendMissionBatch")
    ),
    StepMutation(_rule("UpdateMission", "cancel"), "ends it as failed", _showing_it(_ended(State.STATE_FAILED))),
    StepMutation(_rule("UpdateMission", "finish"), "ends it as cancelled", _showing_it(_ended(State.STATE_CANCELED))),
    StepMutation(_rule("UpdateMission", "finish"), "ends it as failed", _showing_it(_ended(State.STATE_FAILED))),
    StepMutation(_rule("UpdateMission", "pause"), "goes to the next goal", _showing_it(_goal(_skips_one))),
    StepMutation(_rule("UpdateMission", "resume"), "goes to the next goal", _showing_it(_goal(_skips_one))),
    StepMutation(_rule("SkipGoal", "the-next-goal-is-taken-up"), "skips two", _showing_it(_goal(_skips_one))),
    StepMutation(_rule("lifecycle", "goals-are-taken-up-in-order"), "skips one", _showing_it(_goal(_skips_one))),
    StepMutation(
        _rule("lifecycle", "goals-are-taken-up-in-order"), "ends as failed", _showing_it(_ended(State.STATE_FAILED))
    ),
    StepMutation(_rule("lifecycle", "succeed"), "ends it as cancelled", _showing_it(_ended(State.STATE_CANCELED))),
    StepMutation(_rule("lifecycle", "fail"), "ends it as succeeded", _showing_it(_ended(State.STATE_SUCCEEDED))),
    StepMutation(_rule("lifecycle", "start"), "starts the last", _showing_it(_start_last)),
    StepMutation(
        _rule("ClearMissionStatus", "the-answer-names-the-cleared-missions"),
        "answers no ids",
        lambda _, step: evolve(step, refs=()),
    ),
    StepMutation(
        _rule("ClearMissionStatus", "the-answer-names-the-cleared-missions"),
        "leaves out an id",
        lambda _, step: evolve(step, refs=step.refs[:-1]),
    ),
)
_HALTED = {"AM-09": "b"}
REACHING = {
    "another-mission-is-queued": _HALTED,
    "a-mission-is-queued": _HALTED,
    "the-queue-is-halted": _HALTED,
    "a-mission-waits-in-a-halted-queue": _HALTED,
    # What a skip comes to where there is nothing to skip to.
    _rule("SkipGoal", "FAILED_PRECONDITION/there-is-no-next-goal"): {"AM-17.last": "b"},
    _rule("SkipGoal", "INTERNAL/there-is-no-next-goal"): {"AM-17.last": "c"},
    _rule("SkipGoal", "FAILED_PRECONDITION/charging-has-no-goals"): {"AM-19": "b"},
    _rule("SkipGoal", "INTERNAL/charging-has-no-goals"): {"AM-19": "c"},
}
"""The readings under which a rule can come up, for those that never do under the defaults."""
