"""What has made a message due: the rules of the step that owes it, found among the last events.

A rule about how messages come is broken where one does not; the rule of what happened says which message that was.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from typing import Any

from missionfsm.kernel.history import Called, Driven, Received, Settled
from missionfsm.kernel.step import Step
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.explanation import Explanation

MAX_LOOKED_AT = 20
"""In how many explanations of each event it is looked for."""


def owing(belief: Belief, view: object, topic: Hashable) -> tuple[str, ...]:
    """Ids of the rules of the latest step that owes a view to a topic; none where it was long ago."""
    for symbol, node in belief.walked:
        rules: dict[str, None] = {}
        for here in node.explanations[:MAX_LOOKED_AT]:
            for step in _steps(belief, symbol, here):
                if any(one.view == view and one.topic == topic for one in step.emits):
                    rules.update(dict.fromkeys(step.rules))
        if rules:
            return tuple(rules)
    return ()


def exercised(belief: Belief) -> tuple[str, ...]:
    """Ids of the rules that were exercised since things settled last, the latest first.

    Those of messages are left out, and those of refusals: a refusal changes nothing that could be shown.
    """
    known = belief.spec.rules_by_id
    rules: dict[str, None] = {}
    for (kind, *_), exercises in belief.exercised_last:
        if kind is Settled:
            break
        if kind is not Received:
            rules.update(dict.fromkeys(one for one in exercises if one not in known or known[one].code is None))
    return tuple(rules)


def _steps(belief: Belief, symbol: tuple[Any, ...], here: Explanation) -> Iterator[Step]:
    """What can have happened at an event, in one explanation of what was before."""
    successors, spec = belief.automaton.successors, belief.spec
    kind, *what = symbol
    if kind is Driven:
        event, names = what
        yield from spec.drives[event.name].steps(here.state, event, successors.refs(here, names))
    elif kind is Called:
        request, names, *_ = what
        yield from successors.outcomes(here.state, request, successors.refs(here, names))
    for call in here.calls:
        if call.done is None:
            yield from successors.outcomes(here.state, call.request, successors.refs(here, call.args))
    yield from successors.urgent(here.state)
    yield from successors.unseen(here.state)
