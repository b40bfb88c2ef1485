"""How a robot may break its promises: one wrong thing at a time, to test the oracle."""

from __future__ import annotations

from attrs import evolve

from missionfsm.isaac.robot import rules
from missionfsm.isaac.robot.due import NAMES, STATUSES, introduction
from missionfsm.isaac.robot.state import Codelet, Introduction, Report
from missionfsm.isaac.shared.mutations import line_mutations, mission_type, spoils, swapped, unsigned_type
from missionfsm.kernel.language import Emission, Step
from missionfsm.kernel.mutations import StepMutator, breaks, each_sent, on_topic, sent_last, sent_twice, unsent

MESSAGE_MUTATIONS = (
    *spoils(rules.ABOUT, swaps_the_halves_of_the_identifier=swapped),
    *spoils(rules.TYPES, sends_the_type_id_unsigned=unsigned_type, sends_the_type_id_of_a_mission=mission_type),
    *line_mutations(rules.ENVELOPE.id, rules.INTEGERS.id, rules.CHANNEL.id),
)


def _never_run(_: Codelet, step: Step) -> Step:
    """The mission that arrives is not run."""
    idle = evolve(step.after, running=False, named=False)
    return evolve(step, after=idle, names=(), emits=tuple(one for one in step.emits if _about_old(one)))


def _about_old(emission: Emission) -> bool:
    return isinstance(emission.view, Report) and 0 in (emission.refs or ())


def _final(emission: Emission) -> bool:
    return isinstance(emission.view, Report) and emission.view.status != "running"


def _speaks_up(before: Codelet, step: Step) -> Step:
    """The name is said although there is no connection."""
    return evolve(step, emits=(*step.emits, introduction(before.world)))


def _renamed(emission: Emission) -> Emission:
    view = emission.view
    return evolve(emission, view=evolve(view, name=f"{view.name}-2")) if isinstance(view, Introduction) else emission


def _said_as(status: str) -> StepMutator:
    """Final statuses are another one."""
    return each_sent(lambda one: evolve(one, view=evolve(one.view, status=status)) if _final(one) else one)


def _running_after(_: Codelet, step: Step) -> Step:
    """RUNNING comes once more after the final status."""
    final = next(filter(_final, step.emits), None)
    if final is None:
        return step
    return evolve(step, emits=(*step.emits, evolve(final, view=evolve(final.view, status="running"))))


def _ends_what_runs(before: Codelet, step: Step) -> Step:
    """What means nothing fails the mission that runs."""
    if not before.running or step.after != before:
        return step
    report = Report("failure", before.named, before.world.status_channel)
    idle = evolve(before, running=False, named=False, used=True)
    return evolve(step, after=idle, names=(), emits=(Emission(STATUSES, report, before.mission, certain=True),))


STEP_MUTATIONS = (
    *breaks(rules.STARTS, is_not_run=_never_run),
    *breaks(rules.LISTENS, is_not_run=_never_run),
    *breaks(
        rules.PREEMPTS,
        is_not_run=_never_run,
        drops_the_old_one_silently=unsent(_final),
        says_that_the_old_one_succeeded=_said_as("success"),
        reports_the_old_one_last=sent_last(_final),
    ),
    *breaks(rules.UNUSABLE, is_not_reported=unsent(_final), is_reported_as_a_success=_said_as("success")),
    *breaks(rules.IGNORES, fails_the_mission_that_runs=_ends_what_runs),
    *breaks(rules.RUNNING, is_never_reported=unsent(on_topic(STATUSES))),
    *breaks(rules.RUNNING, at=rules.SUCCESS, goes_on_after_the_end=_running_after),
    *breaks(
        rules.NAMED,
        is_never_said=unsent(on_topic(NAMES)),
        is_not_said_during_a_mission=unsent(on_topic(NAMES), lambda before: before.running),
        is_another_one=each_sent(_renamed),
    ),
    *breaks(rules.LINKED, is_forgotten=_speaks_up),
    *breaks(
        rules.SUCCESS,
        is_not_reported=unsent(_final),
        is_reported_twice=sent_twice(_final),
        is_reported_as_a_failure=_said_as("failure"),
    ),
    *breaks(
        rules.FAILURE,
        is_not_reported=unsent(_final),
        is_reported_twice=sent_twice(_final),
        is_reported_as_a_success=_said_as("success"),
    ),
)
