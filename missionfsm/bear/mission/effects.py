"""What the operations of the Mission page do where they are not refused.

Everything is said for a `Situation` and as an `Edit`: what is decided does not depend on the missions that have ended,
nor on how many wait. That makes it worth remembering, and every outcome is computed once.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator, Mapping

from attrs import evolve

from missionfsm.bear.mission.adding import append, charge, create, create_workflow
from missionfsm.bear.mission.edits import Edit, Op
from missionfsm.bear.mission.inputs import Call, Request, Target
from missionfsm.bear.mission.operations import COMMANDED, OPERATIONS
from missionfsm.bear.mission.outcome import ACTIVE, GONE, NOBODY, STREAM, Assumed, Outcome, Way
from missionfsm.bear.mission.ranking import decisions
from missionfsm.bear.mission.readings.clearing import AM_34
from missionfsm.bear.mission.readings.goals import AM_45_AGAIN, AM_45_WHEN
from missionfsm.bear.mission.readings.messages import AM_35, AM_36, AM_36_CLEARED
from missionfsm.bear.mission.readings.queue import AM_09, AM_09_SKIP, AM_10, AM_10_START
from missionfsm.bear.mission.readings.scope import part_of
from missionfsm.bear.mission.readings.skipping import AM_17_LAST, AM_17_PATROL, AM_18, AM_19, AM_19_RETURN
from missionfsm.bear.mission.readings.starting import AM_53
from missionfsm.bear.mission.readings.unlisted import AM_61
from missionfsm.bear.mission.readings.updating import AM_29, AM_30, AM_64, AM_64_AUTOMATIC
from missionfsm.bear.mission.rules.aspects import ABILITY
from missionfsm.bear.mission.rules.situations import waiting
from missionfsm.bear.mission.rules.skipping import LAST_GOAL, WHILE_CHARGING
from missionfsm.bear.mission.state import (
    AUTOMATIC,
    GOALLESS,
    NOT_CHOSEN,
    PATROLS,
    SYSTEM_NAME,
    Kind,
    Mission,
    Robot,
    Situation,
    World,
    free_goal,
)
from missionfsm.bear.mission.unwatched import worlds
from missionfsm.bear.wire.codes import UNLISTED
from missionfsm.bear.wire.messages import Command, Goal, State
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.rules import (
    CANCELLED,
    DEADLINE_EXCEEDED,
    FAILED_PRECONDITION,
    INTERNAL,
    OK,
    UNAVAILABLE,
    Operation,
    Rule,
)
from missionfsm.kernel.spec import Failure
from missionfsm.kernel.step import ONCE_HAD
from missionfsm.kernel.terms import Refs


@functools.lru_cache(maxsize=100_000)
def outcomes(operation: Operation, robot: Situation, call: Call) -> tuple[Outcome, ...]:
    """Every answer that the rules of an operation allow to a call, success first."""
    found = dict.fromkeys(_outcomes(operation, robot, call))
    for seen, unseen in worlds(robot.world, _looked_at(robot, call))[1:]:
        elsewhere = _outcomes(operation, evolve(robot, world=seen), call)
        found |= dict.fromkeys(evolve(one, assumes=(*one.assumes, *unseen)) for one in elsewhere if one not in found)
    return tuple(sorted(found, key=lambda one: one.code != OK))


def _looked_at(robot: Situation, call: Call) -> tuple[Goal, ...]:
    """The goals of which it matters to a call whether they are free."""
    wanted = (one.goals for one in call.request.wanted if one.kind in AUTOMATIC)
    active = robot.active
    moves = active is not None and active.kind in AUTOMATIC and call.request.operation in ("SkipGoal", "UpdateMission")
    return (*itertools.chain.from_iterable(wanted), *(active.goals if active is not None and moves else ()))


def _outcomes(operation: Operation, robot: Situation, call: Call) -> Iterator[Outcome]:
    """Every answer that the rules of an operation allow to a call in the world as it is."""
    found: list[Outcome] = []
    for decision in decisions(operation.blocking(robot, call), robot, call):
        if decision.code is None:
            promises = tuple(rule.id for rule in operation.promises)
            found += (
                evolve(one, assumes=(*decision.assumes, *one.assumes), rules=one.rules or promises)
                for one in _effects(robot, call)
            )
        else:
            rules = tuple(rule.id for rule in decision.rules)
            found.append(Outcome(decision.code, assumes=decision.assumes, rules=rules))
        if robot.world.blocked and operation.name in AM_53 and all(rule.looks_at == ABILITY for rule in decision.rules):
            # The request was accepted, and a robot that is unable to start does not confirm.
            late = (*decision.assumes, AM_53[operation.name]["t"])
            found.append(Outcome(DEADLINE_EXCEEDED, assumes=late, applied=False))
    for one in found:
        yield from _with_fault(robot, one, operation.failures)


def _with_fault(robot: Situation, outcome: Outcome, failures: tuple[str, ...]) -> Iterator[Outcome]:
    """The outcome, or the failure that a tester has armed in its place."""
    fault = robot.fault
    if fault is None or outcome.code != OK or fault.status not in failures or outcome.whose == STREAM:
        yield outcome
        return
    disarmed: Edit = ((Op.ARM, None),)
    edit = outcome.edit + disarmed if fault.applied else disarmed
    yield Outcome(fault.status, edit, NOBODY, outcome.assumes)


def failing(request: Request, code: str) -> Failure | None:
    """Codes that may come at any time. After a passed deadline the call may take effect or not (AM-20 to AM-24).

    SkipGoal answers INTERNAL instead of a deadline, so its INTERNAL leaves that open as well. AM-61 is about codes of
    the transport and of authentication, which no table lists.
    """
    operation = OPERATIONS[request.operation]
    if code in operation.failures:
        # No tester can drive a subscription to fail.
        open_ended = code == DEADLINE_EXCEEDED or request.operation == "SkipGoal"
        return Failure(open_ended=open_ended, drive=None if operation.streaming else "fault")
    if code in UNLISTED:
        return Failure((AM_61["b"],), open_ended=code in (UNAVAILABLE, CANCELLED))
    return None


def _effects(robot: Situation, call: Call) -> Iterator[Outcome]:
    return _EFFECTS[call.request.operation](robot, call)


# Missions that end.


def _with_queue(robot: Situation, how: Ambiguity, ended: Edit) -> Iterator[Way]:
    """AM-09, AM-10: the waiting missions go on, halt, are cancelled too, vanish, or fail too."""
    if not robot.queued:
        yield ended, ()
        return
    yield ended, (how["a"],)
    yield (*ended, (Op.HALT, True)), (how["b"],)
    yield (*ended, (Op.END_QUEUE, "cancel with the queue")), (how["c"],)
    yield (*ended, (Op.DROP_QUEUE, None)), (how["d"],)
    if "e" in how.readings:
        yield (*ended, (Op.END_QUEUE, "fail with the queue")), (how["e"],)


def end(mission: Mission, trigger: str) -> Edit:
    """The active mission ends by a move of its lifecycle."""
    return ((Op.END, mission.moved(trigger)),)


def become(mission: Mission) -> Edit:
    """The active mission becomes another."""
    return ((Op.BECOME, mission),)


def _cancelled(robot: Situation, mission: Mission) -> Iterator[Way]:
    return _with_queue(robot, AM_09, end(mission, "cancel"))


def failed(robot: Situation, mission: Mission, how: Ambiguity = AM_10) -> Iterator[Way]:
    """The ways in which the active mission fails."""
    return _with_queue(robot, how, end(mission, "fail"))


def failed_to_start(robot: Situation, mission: Mission) -> Iterator[Way]:
    """The ways in which a mission that cannot be done fails as it starts."""
    return failed(robot, mission, AM_10_START)


def _clear(robot: Situation, _: Call) -> Iterator[Outcome]:
    if robot.fresh:
        yield Outcome(OK, (), GONE, (AM_36["a", "c"],))
        yield Outcome(OK, (), GONE, (AM_36["b"], AM_36_CLEARED["a"]))
        yield Outcome(OK, ((Op.CLEAR, None),), GONE, (AM_36["b"], AM_36_CLEARED["d"], AM_35["a"]))
        yield Outcome(OK, (), GONE, (AM_36["b"], AM_36_CLEARED["d"], AM_35.besides("a")))
    elif not robot.queued:
        yield Outcome(OK, ((Op.CLEAR, None),) if robot.ended else (), GONE)
    else:
        which = AM_34[waiting(robot)]
        yield Outcome(OK, ((Op.CLEAR, None),), GONE, (which["a"],))
        yield Outcome(OK, ((Op.FORGET_ENDED, None),) if robot.ended else (), GONE, (which["b"],))


# The active mission.


def _cited(rule: Rule) -> tuple[str, ...]:
    return (rule.registered(SYSTEM_NAME, "SkipGoal").id,)


def _skip(robot: Situation, _: Call) -> Iterator[Outcome]:
    mission = robot.active
    assert mission is not None, "without an active mission it is refused"  # noqa: S101 - as above
    if mission.kind in GOALLESS:
        how = AM_19 if mission.kind is Kind.CHARGE else AM_19_RETURN
        yield from _skip_last(robot, mission, how, WHILE_CHARGING, ())
        if "g" in how.readings:  # one of several goals that nobody was told
            yield Outcome(OK, (), ACTIVE)
    elif mission.kind in AUTOMATIC:
        yield from _skip_automatic(robot, mission)
    elif mission.goal + 1 < len(mission.goals) and not mission.finishing:
        yield Outcome(OK, become(evolve(mission, goal=mission.goal + 1)), ACTIVE)
    elif mission.kind in PATROLS and not mission.finishing:
        yield from _skip_last(robot, mission, AM_17_PATROL[part_of(mission.kind)], LAST_GOAL, ())
    else:
        yield from _skip_last(robot, mission, _last(mission), LAST_GOAL, ())


def _last(mission: Mission) -> Ambiguity:
    """AM-17: what skipping the last goal does; a patrol that is finishing does not wrap."""
    return {**AM_17_LAST, **AM_17_PATROL}[part_of(mission.kind)]


def _skip_automatic(robot: Situation, mission: Mission) -> Iterator[Outcome]:
    free = free_goal(mission.goals, robot.world, mission.goal)
    follows = mission.goal + 1 < len(mission.goals) and mission.goal != NOT_CHOSEN
    how = AM_18[part_of(mission.kind)]
    for letter, goal in (("a", free), ("b", mission.goal + 1 if follows else NOT_CHOSEN), ("c", NOT_CHOSEN)):
        if goal == NOT_CHOSEN or mission.finishing:
            yield from _skip_last(robot, mission, _last(mission), LAST_GOAL, (how[letter],))
        else:
            yield Outcome(OK, become(evolve(mission, goal=goal)), ACTIVE, (how[letter],))


def _skip_last(
    robot: Situation, mission: Mission, how: Ambiguity, refusals: Mapping[str, Rule], assumes: Assumed
) -> Iterator[Outcome]:
    succeeded = evolve(mission, state=State.STATE_RUNNING).moved("succeed")
    yield Outcome(OK, ((Op.END, succeeded),), ACTIVE, (*assumes, how["a"]))
    for code, letter in ((FAILED_PRECONDITION, "b"), (INTERNAL, "c")):
        yield Outcome(code, assumes=(*assumes, how[letter]), rules=_cited(refusals[code]))
    for edit, queue in _with_queue(robot, AM_09_SKIP, end(mission, "cancel")):
        yield Outcome(OK, edit, ACTIVE, (*assumes, how["d"], *queue))
    if "f" in how.readings:
        again = evolve(mission, goal=0)
        yield Outcome(OK, () if again == mission else become(again), ACTIVE, (*assumes, how["f"]))


def _update(robot: Situation, call: Call) -> Iterator[Outcome]:
    mission, command = robot.active, call.request.command
    if mission is None or call.target is not Target.ACTIVE or command is None:
        return
    promised = (COMMANDED[command],)
    for edit, assumes in _COMMAND_EFFECTS[command](robot, mission):
        yield Outcome(OK, edit, NOBODY, assumes, promised)


def _pause(_: Situation, mission: Mission) -> Iterator[Way]:
    if mission.state is State.STATE_PAUSED:
        yield (), (AM_29["pause"]["b"],)
    else:
        yield become(evolve(mission, state=State.STATE_PAUSED)), ()


def _resume(robot: Situation, mission: Mission) -> Iterator[Way]:
    if mission.state is State.STATE_RUNNING:
        yield (), (AM_29["resume"]["b"],)
        return
    running = evolve(mission, state=State.STATE_RUNNING)
    if mission.kind in AUTOMATIC:
        yield from reselected(robot.world, running, resumed=True)
    elif mission.goal:
        yield become(running), (AM_64["a"],)
        yield become(evolve(running, goal=0)), (AM_64["b"],)
    else:
        yield become(running), ()


def reselected(world: World, mission: Mission, *, resumed: bool = False) -> Iterator[Way]:
    """AM-45, AM-64: a NavigateAuto mission keeps its goal, or selects again on the way or when it is resumed."""
    best = free_goal(mission.goals, world)
    if mission.goal in (best, NOT_CHOSEN):
        yield become(mission), ()
        return
    when = AM_45_WHEN[part_of(mission.kind)]
    turned = tuple(turned_away(world, mission))
    stays = when["h", "i"] if turned and not resumed else when["h", "i", "o"]
    yield become(mission), (stays, AM_64_AUTOMATIC["a"]) if resumed else (stays,)
    yield from turned
    for edit, assumes in _selected_anew(mission, best):
        yield edit, (when["j"], *assumes)
        if resumed:
            yield edit, (when["h", "i", "o"], AM_64_AUTOMATIC["c"], *assumes)


def turned_away(world: World, mission: Mission) -> Iterator[Way]:
    """AM-45 read as o: where another robot takes its goal, a NavigateAuto mission goes to the best that is free."""
    best = free_goal(mission.goals, world)
    if NOT_CHOSEN not in (best, mission.goal) and mission.goals[mission.goal].destination_id in world.occupied:
        yield become(evolve(mission, goal=best)), (AM_45_WHEN[part_of(mission.kind)]["o"],)


def _selected_anew(mission: Mission, best: int) -> Iterator[Way]:
    """AM-45: it goes to the best goal; where none is free it waits, there or nowhere, fails or takes the first."""
    if best != NOT_CHOSEN:
        yield become(evolve(mission, goal=best)), ()
        return
    none = AM_45_AGAIN[part_of(mission.kind)]
    yield become(mission), (none["a"],)
    yield become(evolve(mission, goal=NOT_CHOSEN)), (none["a"],)
    yield become(evolve(mission, doomed=True)), (none["b"],)
    yield become(evolve(mission, goal=0)), (none["d"],)


def _finish(_: Situation, mission: Mission) -> Iterator[Way]:
    yield end(mission, "finish"), (AM_30["a"],)
    yield ((), (AM_30["b"],)) if mission.finishing else (become(evolve(mission, finishing=True)), (AM_30["b"],))


_COMMAND_EFFECTS: Mapping[Command, Callable[[Situation, Mission], Iterator[Way]]] = {
    Command.COMMAND_CANCEL: _cancelled,
    Command.COMMAND_PAUSE: _pause,
    Command.COMMAND_RESUME: _resume,
    Command.COMMAND_FINISH: _finish,
}


def _subscribe(_: Situation, __: Call) -> Iterator[Outcome]:
    yield Outcome(OK, (), STREAM)


_EFFECTS: Mapping[str, Callable[[Situation, Call], Iterator[Outcome]]] = {
    "CreateMission": create,
    "CreateMissionBatch": create,
    "CreateMissionWorkflow": create_workflow,
    "AppendMission": append,
    "AppendMissionBatch": append,
    "ChargeRobot": charge,
    "ClearMissionStatus": _clear,
    "SkipGoal": _skip,
    "UpdateMission": _update,
    "SubscribeMissionStatus": _subscribe,
}


def target(robot: Robot, ref: int | None) -> Target:
    """Where the mission with a position in the list stands."""
    if ref is None:
        return Target.UNKNOWN
    if ref == ONCE_HAD:
        return Target.CLEARED
    if ref < len(robot.done):
        return Target.ENDED
    return Target.ACTIVE if robot.active is not None and ref == len(robot.done) else Target.QUEUED


def call_of(robot: Robot, request: Request, refs: Refs) -> Call:
    """The call that a request is for this robot: it says where the named mission stands."""
    return Call(request, target(robot, refs[0]) if refs else None)
