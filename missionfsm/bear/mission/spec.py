"""The Mission page as a `Spec`: the rules and effects of the other modules, put together."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping

from attrs import evolve

from missionfsm.bear.mission.compiled import Shortcut, forget_ended
from missionfsm.bear.mission.describe import describe
from missionfsm.bear.mission.edits import Edit, Op, apply, renumber
from missionfsm.bear.mission.effects import call_of, failing, outcomes, target
from missionfsm.bear.mission.events import Event, apply_event, by_itself, due, unwatched_choices
from missionfsm.bear.mission.foresight import foresees, succeeds
from missionfsm.bear.mission.glimpse import MIDDLE
from missionfsm.bear.mission.inputs import Request
from missionfsm.bear.mission.operations import OPERATIONS
from missionfsm.bear.mission.outcome import ACTIVE, ADDED, GONE, STREAM, Outcome
from missionfsm.bear.mission.promises import ALL_LISTED, ANSWERS_FOR, GOALS, OWED, SEQUENCE, TYPE, WELL_FORMED
from missionfsm.bear.mission.promises import RULES as STATUS_RULES
from missionfsm.bear.mission.properties import INVARIANTS, POSSIBILITIES
from missionfsm.bear.mission.readings import AMBIGUITIES
from missionfsm.bear.mission.readings.messages import AM_36, AM_47_REPEAT, AM_47_SKIP, AM_52, AM_54
from missionfsm.bear.mission.readings.unlisted import AM_58_SENT, AM_61
from missionfsm.bear.mission.shelving import SHELVING
from missionfsm.bear.mission.state import (
    AUTOMATIC,
    LIFECYCLE,
    MISSION,
    PATROLS,
    SYSTEM_NAME,
    Kind,
    Robot,
    situation,
    without_place,
)
from missionfsm.bear.mission.stream import GOALS_CHANGED, OWNER_CHANGED, TYPE_CHANGED, lasting, matches
from missionfsm.bear.mission.unwatched import UNWATCHED
from missionfsm.bear.mission.views import MORE, TOPIC, listing
from missionfsm.bear.wire.codes import UNLISTED
from missionfsm.kernel.abstraction import Abstraction
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import UNCONSTRAINED, Assumption, meet
from missionfsm.kernel.rules import INTERNAL, OK, Operation, Waiver, promise
from missionfsm.kernel.spec import Delivery, Drive, Spec
from missionfsm.kernel.step import Emission, Match, Mismatch, Opening, Step
from missionfsm.kernel.terms import Refs

_MOVES = {
    trigger: promise(trigger.replace(" ", "-"), says, cite=MISSION["MissionState", "State enum"]).registered(
        SYSTEM_NAME, "lifecycle"
    )
    for trigger, says in (
        ("start", "A mission that waits runs when its turn comes."),
        ("succeed", "A mission that was completed has succeeded, and only then."),
        ("fail", "A mission that could not be completed has failed, and only then."),
    )
}
"""The moves of the lifecycle that no call makes."""

_NEXT_GOAL = promise(
    "goals-are-taken-up-in-order", "A mission goes from goal to goal in order.", cite=MISSION["MissionState"]
).registered(SYSTEM_NAME, "lifecycle")
RULES = (*_MOVES.values(), _NEXT_GOAL, *STATUS_RULES)


def _edited(
    robot: Robot, edit: Edit, call: str = ""
) -> tuple[Robot, tuple[int, ...] | None, tuple[Emission, ...], tuple[int, ...]]:
    """What an edit does to a robot, to its names and to those who watch, and the names that vanish.

    Args:
        call: the operation that makes it.
    """
    if not edit:
        return robot, None, (), ()
    names, gone = renumber(edit, robot)
    after = apply(edit, robot, names)
    before, shown = listing(robot), listing(after)
    if after.pending and not (robot.active or robot.pending or robot.world.blocked):
        shown = evolve(shown, created=call)
    emits: tuple[Emission, ...] = ()
    if not shown.looks_like(before):
        # Where a goal was selected that the index may have shown already, nobody can tell.
        may_look_like = shown.may_look_like(before)
        emits = (*_ending(robot, edit), Emission(TOPIC, shown, after.listed(names), optional=may_look_like))
    return after, names, emits, gone


def _ending(robot: Robot, edit: Edit) -> Iterator[Emission]:
    """AM-09, AM-10: a mission may be seen to have ended before those that wait end or vanish with it."""
    if robot.active is None:
        return
    kept = tuple((op, what) for op, what in edit if op not in (Op.END_QUEUE, Op.DROP_QUEUE))
    if len(kept) < len(edit) and any(op is Op.END for op, _ in kept):
        names, _ = renumber(kept, robot)
        yield _shown(apply(kept, robot, names), names, optional=True)


def _shown(robot: Robot, names: tuple[int, ...], *, only: Assumption | None = None, optional: bool = False) -> Emission:
    """What a subscriber is shown of a robot, whose missions have these names in the order of their turns."""
    return Emission(TOPIC, listing(robot), robot.listed(names), only, optional)


def _step(robot: Robot, edit: Edit, assumes: tuple[Assumption, ...] = (), rules: tuple[str, ...] = ()) -> Step:
    after, names, emits, _ = _edited(robot, edit)
    return Step(after, names=names, emits=emits, assumes=assumes, rules=rules)


def _indistinct(step: Step) -> Step:
    """The step without the goals at which missions have ended."""
    robot = step.after
    done = without_place(robot.done)
    if done is robot.done:
        for one in step.emits:
            if _without_place(one) is not one:
                break
        else:
            return step
    after = robot if done is robot.done else evolve(robot, done=done)
    return evolve(step, after=after, emits=tuple(map(_without_place, step.emits)))


def _without_place(emission: Emission) -> Emission:
    missions = without_place(emission.view.missions)
    if missions is emission.view.missions:
        return emission
    return evolve(emission, view=evolve(emission.view, missions=missions))


WAIVERS = (
    Waiver(
        "one-number-stands-for-one-state",
        "Numbers are compared within one stream; that two streams show one state under one number is not checked.",
        MISSION["SubscribeMissionStatus", "EventMetadata"],
        ("SubscribeMissionStatus",),
    ),
    Waiver(
        "timestamps-that-go-on",
        "A timestamp has to be a time that exists; one that stands still or goes back is not compared.",
        MISSION["SubscribeMissionStatus", "EventMetadata"],
        ("SubscribeMissionStatus",),
    ),
)

_answer = functools.cache(Answer)


def _answered(robot: Robot, request: Request, outcome: Outcome) -> Step:
    after, names, emits, refs = _edited(robot, outcome.edit, request.operation)
    if outcome.whose == ADDED:
        before = len(robot.turns)
        refs = tuple(sorted(name for name in names or () if name >= before))
        if request.operation in AM_54:
            emits = (*_growing(robot, outcome.edit, AM_54[request.operation]["b"]), *emits)
    elif outcome.whose == ACTIVE:
        refs = (len(robot.done),)
    elif outcome.whose != GONE:
        refs = ()
    answer = _answer(outcome.code, unordered=outcome.whose == GONE)
    return Step(
        after,
        names=names,
        emits=emits,
        rules=outcome.rules,
        assumes=outcome.assumes,
        answer=answer,
        refs=refs,
        applied=outcome.applied,
    )


LARGEST_SEEN_STARTING = 12
"""The size of a batch up to which it is imagined that its first mission runs before it is complete: each size more
makes a message more to be imagined."""


def _growing(robot: Robot, edit: Edit, only: Assumption) -> Iterator[Emission]:
    """AM-54: what a subscriber may see of several new missions before they are complete: the first may run already."""
    added = next((what for op, what in edit if op is Op.ADD), ())
    # What overtakes the others is there before the rest.
    fewest = 0 if any(op is Op.OVERTAKE for op, _ in edit) else 1
    for size in range(fewest, len(added)):
        part = tuple((op, what[:size]) if op is Op.ADD else (op, what) for op, what in edit)
        names, _ = renumber(part, robot)
        grown = apply(part, robot, names)
        yield _shown(grown, names, only=only)
        if grown.active is None and len(added) <= LARGEST_SEEN_STARTING:
            for start, _ in due(grown.world, None, grown.pending[0], halted=grown.halted, queued=True):
                if any(op is Op.START for op, _ in start):
                    yield _shown(apply(start, grown), names, only=only)


def _opened(robot: Robot, outcome: Outcome) -> Iterator[Step]:
    """A subscription: the latest state is owed at once, unless (AM-36) there never was one."""
    stream = len(robot.turns)
    first = _shown(robot, tuple(range(stream)))
    ways: list[tuple[tuple[Emission, ...], tuple[Assumption, ...]]] = [((first,), ())]
    if robot.fresh:
        ways = [((first,), (AM_36["a", "b"],)), ((), (AM_36["c"],))]
    for owed, assumes in ways:
        yield Step(
            robot,
            opens=(Opening(TOPIC, stream, owed),),
            rules=outcome.rules,
            assumes=(*outcome.assumes, *assumes),
            answer=Answer(OK),
            refs=(stream,),
        )


def _outcomes(operation: Operation, robot: Robot, request: Request, refs: Refs, assumed: int) -> tuple[Step, ...]:
    found: list[Step] = []
    for outcome in outcomes(operation, situation(robot), call_of(robot, request, refs)):
        if not meet(assumed, outcome.assumes):
            continue
        if outcome.whose == STREAM:
            found += _opened(robot, outcome)
        else:
            found.append(_answered(robot, request, outcome))
    return tuple(found)


def _urgent(robot: Robot) -> tuple[Step, ...]:
    head = robot.pending[0] if robot.pending else None
    ways = due(robot.world, robot.active, head, halted=robot.halted, queued=head is not None)
    starts = robot.active is None
    rules = (_MOVES["start"].id,) if starts else ()
    return tuple(_step(robot, edit, assumes, rules) for edit, assumes in ways)


def _spontaneous(robot: Robot) -> tuple[Step, ...]:
    head = robot.pending[0] if robot.pending else None
    queued = len(robot.pending) > (robot.active is None)
    ways = by_itself(robot.world, robot.active, head, halted=robot.halted, queued=queued)
    failing = (_step(robot, edit, assumes, (_MOVES["fail"].id,)) for edit, assumes in ways)
    anew = (_step(robot, edit, assumes) for edit, assumes in unwatched_choices(robot.world, robot.active))
    return (*failing, *(evolve(step, alone=True) for step in anew))


def _restarted(robot: Robot) -> Step:
    """The robot with nothing in its list."""
    after = Robot(robot.world, fault=robot.fault)
    return Step(after, names=(), emits=(_shown(after, ()),))


_JUSTIFIED = {
    "goalReached": (_NEXT_GOAL.id,),
    "missionSucceeded": (_MOVES["succeed"].id,),
    "missionFailed": (_MOVES["fail"].id,),
}


def _drive(robot: Robot, event: Event, _: Refs) -> tuple[Step, ...]:
    rules = _JUSTIFIED.get(event.name, ())
    return tuple(_step(robot, edit, assumes, rules) for edit, assumes in apply_event(situation(robot), event))


_CHANGED = {TYPE_CHANGED: TYPE.id, GOALS_CHANGED: GOALS.id}


def _sequence(relation: str) -> tuple[Assumption, ...] | Mismatch:
    if relation in ("first", "larger", "zero"):
        return ()
    if relation == OWNER_CHANGED:
        return (AM_52["b"],)
    if relation in _CHANGED:
        return Mismatch(_CHANGED[relation], f"a mission that was listed before has its {relation}")
    return Mismatch(SEQUENCE.id, f"the sequence number is {relation}")


def _answers(_: object, given: object) -> tuple[Match, ...] | Mismatch:
    """AM-58: an answer may have fields that are not documented."""
    if given == MORE:
        return (Match((AM_58_SENT["answers"]["b"],)),)
    return Mismatch("", str(given))


@functools.cache
def _delivery(_: object) -> Delivery:
    # A stream may break down (INTERNAL is documented) or be cut off by the transport; it never just ends.
    ends = {INTERNAL: (), **dict.fromkeys(UNLISTED, (AM_61["b"],))}
    first = tuple(rule.id for rule in OPERATIONS["SubscribeMissionStatus"].promises)
    return Delivery(
        skips=AM_47_SKIP["b"],
        repeats=AM_47_REPEAT["c"],
        ends=ends,
        unowed=(OWED.id,),
        named=(ALL_LISTED.id,),
        first=first,
        malformed=(WELL_FORMED.id,),
        stands=True,
        lasts=True,
        operation="SubscribeMissionStatus",
    )


def _search_key(robot: Robot) -> tuple[object, ...]:
    """What a search tells robots apart by: what they are at, not where they are to go."""
    active = robot.active
    at = active and (
        active.kind in PATROLS,
        active.kind in AUTOMATIC,
        active.kind is Kind.CHARGE,
        active.state,
        min(active.goal, 1),
        len(active.goals) - active.goal,
        active.finishing,
    )
    return (at, min(len(robot.pending), 2), bool(robot.done), robot.halted, robot.fresh, robot.fault, robot.world)


def specification(operations: Mapping[str, Operation] = OPERATIONS, assumed: int = UNCONSTRAINED) -> Spec:
    """The system, with other operations if some rule is to be tried without or with another condition.

    Calls have no outcomes that contradict what is assumed.
    """
    return Spec(
        system=SYSTEM_NAME,
        title="one robot's missions",
        initial=Robot,
        operations=operations,
        outcomes=lambda robot, request, refs: _outcomes(operations[request.operation], robot, request, refs, assumed),
        failing=failing,
        drives={
            one.name: one
            for one in (
                *(Drive(name, _drive, (Event(name),), impossible=rules) for name, rules in _JUSTIFIED.items()),
                # A map is what it is said to be, and failures that nobody arms are outcomes of their own.
                Drive("world", _drive, unwatched=UNWATCHED),
                Drive("fault", _drive, waits=lambda robot: robot.fault is not None),
            )
        },
        urgent=_urgent,
        spontaneous=_spontaneous,
        matches=matches,
        # Whether a mission was ever assigned nobody sees in an empty list.
        remembered=lambda view, content: None if view.missions else content,
        answers=_answers,
        lasting=lasting,
        recalls=True,
        waived=WAIVERS,
        delivery=_delivery,
        sequence=_sequence,
        names=lambda robot: len(robot.turns),
        request_operation=lambda request: request.operation,
        ambiguities=AMBIGUITIES,
        answers_for={**ANSWERS_FOR, "AM-30": (f"{SYSTEM_NAME}/UpdateMission/finish",), "AM-45.none.refused": ()},
        describe=describe,
        rules=RULES,
        charts=(LIFECYCLE,),
        invariants=INVARIANTS,
        possibilities=POSSIBILITIES,
        foresees=foresees,
        succeeds=succeeds,
        abstraction=Abstraction(
            enabled_key=lambda robot: (situation(robot), len(robot.done), len(robot.pending)),
            search_key=_search_key,
            phase=lambda robot: robot.active and robot.active.state,
            name_key=target,
            forget_ended=forget_ended,
            indistinct=_indistinct,
            compiled=Shortcut,
        ),
        used=lambda world: Robot(world, fresh=False),
        decided=lambda decided: specification(operations, decided),
        rebuilt=specification,
        restarted=_restarted,
        added=frozenset({"CreateMissionBatch", "AppendMissionBatch", "ClearMissionStatus"}),
        middle=MIDDLE,
        shelving=SHELVING,
    )


SPEC = specification()
__all__ = ["SPEC"]
