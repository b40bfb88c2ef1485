"""Why a message is due: the rules of the step that owes it, which is found among the last events.

A message that does not come breaks a rule about messages. The rules of the step say which message that was.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterator
from typing import Any

from missionfsm.kernel.history import Called, Driven, Received, Returned, Settled
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Step
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.explanation import Explanation

MAX_LOOKED_AT = 20
"""How many explanations of each event are searched."""


def owing(belief: Belief, view: object, topic: Hashable) -> tuple[str, ...] | None:
    """Ids of the rules of the latest step that owes a view to a topic and says why; None if no step is known to owe it.

    A step whose rules only say that the view is sent, as it is again and again, does not say why.
    """
    found = False
    for symbol, node in belief.walked:
        rules: dict[str, None] = {}
        for here in node.explanations[:MAX_LOOKED_AT]:
            for step in _steps(belief, symbol, here):
                if any(one.view == view and one.topic == topic for one in step.emits):
                    found = True
                    sent = delivering(belief.spec, step)
                    rules.update(dict.fromkeys(rule for rule in step.rules if rule not in sent))
        if rules:
            return tuple(rules)
    return () if found else None


def delivering(spec: Spec, step: Step) -> set[str]:
    """Ids of the rules of a step that only say that its messages are sent."""
    return {rule for one in step.emits for rule in spec.undelivered(one.view)} if spec.undelivered else set()


def latest(belief: Belief) -> tuple[str, ...]:
    """Ids of the rules that the last event since things settled has exercised.

    Rules of messages are left out, and so are refusals: a refusal changes nothing that could be shown.
    """
    known = belief.spec.rules_by_id
    for (kind, *_), exercises in belief.exercised_last:
        if kind is Settled:
            break
        rules = [one for one in exercises if one not in known or known[one].code is None]
        if rules and kind is not Received:
            return tuple(rules)
    return ()


def since_last_answer(belief: Belief) -> tuple[str, ...]:
    """Ids of the rules of what was made happen since the last answer; none where it was nothing."""
    for symbol, _ in belief.walked:
        if symbol[0] is Returned:
            return ()
        if symbol[0] is Driven:
            return driven(belief)
    return ()


def driven(belief: Belief) -> tuple[str, ...]:
    """Ids of the rules by which what was made happen last has an effect."""
    successors, spec = belief.automaton.successors, belief.spec
    successors.reset()
    rules: dict[str, None] = {}
    for (kind, *what), node in belief.walked:
        if kind is Driven:
            event, names = what
            for way in itertools.islice(successors.closure(node.explanations, None), MAX_LOOKED_AT):
                refs = successors.refs(way.explanation, names)
                for step in spec.drives[event.name].steps(way.explanation.state, event, refs):
                    rules.update(dict.fromkeys(step.rules))
            break
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
