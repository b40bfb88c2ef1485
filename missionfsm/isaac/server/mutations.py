"""How a mission server may break its promises: one wrong thing at a time, to test the oracle."""

from __future__ import annotations

from collections.abc import Callable

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.state import DOOM, ENDED, UNDER_WAY, Mission, Server, Status, topic
from missionfsm.isaac.shared.mutations import line_mutations, spoils
from missionfsm.kernel.mutations import StepMutator, breaks, sent_twice, unsent
from missionfsm.kernel.step import Step

MESSAGE_MUTATIONS = (
    *spoils(
        rules.CONFIG,
        sends_another_configuration=lambda message: message["payload"].update(config={"serialized": '{"other":{}}'}),
    ),
    *line_mutations(rules.ENVELOPE.id, rules.INTEGERS.id, rules.CHANNEL.id),
)


def _nothing(before: Server, step: Step) -> Step:
    return evolve(step, after=before, names=None, emits=(), drains=())


def _each(change: Callable[[Mission, Mission], Mission]) -> StepMutator:
    """A change of every mission that was there before: it takes that one and how it would be after the step."""

    def mutate_step(before: Server, step: Step) -> Step:
        after: Server = step.after
        old = (*before.missions, *after.missions[len(before.missions) :])
        missions = tuple(change(one, other) for one, other in zip(old, after.missions, strict=True))
        return evolve(step, after=evolve(after, missions=missions))

    return mutate_step


def _became(status: Status, change: Callable[[Mission, Mission], Mission]) -> StepMutator:
    """A change of every mission that a step gives this status."""
    return _each(lambda old, new: change(old, new) if new.status is status is not old.status else new)


def _sent_elsewhere(before: Server, step: Step) -> Step:
    """What is sent goes to the connection that was made first, whosever it is."""
    first = topic(before.links[0].slot) if before.links else None
    return evolve(step, emits=tuple(evolve(one, topic=first or one.topic) for one in step.emits))


def _has(status: Status) -> Callable[[Mission, Mission], Mission]:
    return lambda _, new: evolve(new, status=status)


def _goes_on(old: Mission, _: Mission) -> Mission:
    """Nothing has happened to it, and its clocks do not run any more."""
    return evolve(old, clocks=())


def _freed(_: Mission, mission: Mission) -> Mission:
    """It waits for no upstream, and none that failed is still to be noticed."""
    clocks = tuple(one for one in mission.clocks if one.kind != DOOM)
    return evolve(mission, waits=(), doomed=(), clocks=clocks)


def _failing(new: Mission) -> Mission:
    return evolve(new, status=Status.FAILED, clocks=())


def _revived(_: Server, step: Step) -> Step:
    """The mission that ended last runs again."""
    after: Server = step.after
    ended = [index for index, one in enumerate(after.missions) if one.status in ENDED and one.sent]
    if not ended:
        return step
    missions = list(after.missions)
    missions[ended[-1]] = evolve(missions[ended[-1]], status=Status.RUNNING)
    return evolve(step, after=evolve(after, missions=tuple(missions)))


STEP_MUTATIONS = (
    *breaks(rules.SENT, is_sent_twice=sent_twice(), is_not_sent=unsent()),
    *breaks(rules.UNNAMED, at=rules.SENT, goes_to_whoever_connected_first=_sent_elsewhere),
    *breaks(
        rules.UPSTREAM,
        at=rules.OPERATIONS["submit"].promises[0],
        does_not_wait_for_them=_each(_freed),
    ),
    *breaks(
        rules.CANCELED,
        is_not_cancelled=_became(Status.CANCELED, lambda old, new: _freed(new, old)),
        counts_as_a_success=_became(Status.CANCELED, _has(Status.SUCCESS)),
    ),
    *breaks(rules.NAMED, is_not_heard=_nothing),
    *breaks(
        rules.OTHER,
        fails_what_is_under_way=_each(lambda _, new: _failing(new) if new.status in UNDER_WAY else new),
    ),
    *breaks(
        rules.DROPPED,
        fails_what_is_queued=_each(lambda _, new: _failing(new) if new.status is Status.QUEUED else new),
    ),
    *breaks(rules.RUNNING, is_not_heard=_nothing, counts_as_a_success=_became(Status.RUNNING, _has(Status.SUCCESS))),
    *breaks(
        rules.FINAL,
        is_not_heard=_nothing,
        counts_success_as_failure=_became(Status.SUCCESS, _has(Status.FAILED)),
        counts_failure_as_success=_became(Status.FAILED, _has(Status.SUCCESS)),
    ),
    *breaks(rules.LATE, revives_the_mission=_revived),
    *breaks(
        rules.ABORTED,
        never_strikes=_became(Status.ABORTED, _goes_on),
        counts_as_a_success=_became(Status.ABORTED, _has(Status.SUCCESS)),
    ),
    *breaks(
        rules.OVERRUN,
        never_strikes=_became(Status.ABORTED, _goes_on),
        counts_as_a_success=_became(Status.ABORTED, _has(Status.SUCCESS)),
    ),
    *breaks(
        rules.SILENCE,
        is_a_loss_at_once=_each(lambda _, new: _failing(new) if new.status is Status.RUNNING else new),
    ),
)
