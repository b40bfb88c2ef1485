"""How an implementation may break its promises: one wrong thing at a time, to test the oracle.

A system says what only it can get wrong; what breaks rules of any system is in ``tools/mutate/mutants.py``.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.step import Emission, Step
from missionfsm.kernel.terms import State

StepMutator = Callable[[State, Step], Step | None]
"""(state, step from there) → the wrong step; None if the step is not taken at all."""

Which = Callable[[Emission], bool]


@frozen
class MessageMutation:
    """A way to send wrong messages: the rule that it breaks, what it does, and how it changes a message's JSON."""

    rule: str
    says: str
    mutate_message: Callable[[JSON], JSON]


@frozen
class StepMutation:
    """A way to take wrong steps: the rule that it breaks, what it does, and how it changes a step.

    `mutate_step` takes the state before and a step that the rule justifies; where the rule that is broken justifies
    none (it is about what steps show), a step that the rule `at` justifies.
    """

    rule: str
    says: str
    mutate_step: StepMutator
    at: str = ""


def breaks(rule: Rule, at: Rule | None = None, **mutations: StepMutator) -> tuple[StepMutation, ...]:
    """Ways to break a rule: what is done, its words joined by ``_``, to the mutation.

    It is done in the steps that the rule justifies; for one that justifies none, in those of the rule `at`.
    """
    return tuple(
        StepMutation(rule.id, says.replace("_", " "), mutate_step, at=(at or rule).id)
        for says, mutate_step in mutations.items()
    )


# What is sent, wrongly.


def _any(_: object) -> bool:
    return True


def on_topic(topic: Hashable) -> Which:
    """What is sent about a topic."""
    return lambda emission: emission.topic == topic


def unsent(which: Which = _any, when: Callable[[State], bool] = _any) -> StepMutator:
    """Some of what is sent is left out, if the state before was such a one."""
    return lambda before, step: (
        evolve(step, emits=tuple(itertools.filterfalse(which, step.emits))) if when(before) else step
    )


def sent_twice(which: Which = _any) -> StepMutator:
    """Some of what is sent comes once more, behind all of it."""
    return lambda _, step: evolve(step, emits=(*step.emits, *filter(which, step.emits)))


def sent_last(which: Which) -> StepMutator:
    """Some of what is sent comes behind all the rest."""
    return lambda _, step: evolve(step, emits=(*itertools.filterfalse(which, step.emits), *filter(which, step.emits)))


def each_sent(change: Callable[[Emission], Emission]) -> StepMutator:
    """Everything that is sent is changed."""
    return lambda _, step: evolve(step, emits=tuple(map(change, step.emits)))


# What is done wrongly, whatever the system.


def without_effect(state: State, step: Step) -> Step | None:
    """It is answered, and nothing comes of it; where nothing is answered it does not happen."""
    if step.answer is None:
        return None
    return evolve(step, after=state, names=None, emits=(), opens=())


def turned(_: State, step: Step) -> Step | None:
    """Its answer has the names that it should have, the other way round."""
    return evolve(step, refs=step.refs[::-1]) if len(step.refs) > 1 else None


def unshown(_: State, step: Step) -> Step:
    """Nothing is sent about it."""
    return evolve(step, emits=(), opens=tuple(evolve(one, owed=()) for one in step.opens))
