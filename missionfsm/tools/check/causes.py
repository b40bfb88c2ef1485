"""Why a message is due: the rules of the step that owes it, which is found among the last events.

A message that does not come breaks a rule about messages. The rules of the step say which message that was.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterator, Sequence
from typing import Any

from attrs import evolve

from missionfsm.kernel.history import Called, Driven, Received, Returned, Settled
from missionfsm.kernel.readings import meet
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Step
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.explanation import Explanation
from missionfsm.oracle.successors import ExhaustedError

MAX_LOOKED_AT = 20
"""How many explanations of each event are searched."""


def owing(belief: Belief, view: object, topic: Hashable, *, made_only: bool = False) -> tuple[str, ...] | None:
    """Ids of the rules of the latest step that owes a view to a topic and says why; None if no step is known to owe it.

    A step whose rules only say that the view is sent does not say why, unless somebody has just made it happen. Of the
    steps at one event only those count that need the fewest unusual readings: of all, then of those not ruled out.

    Args:
        made_only: whether only steps count that somebody has made happen, also those that are ruled out.
    """
    found = False
    for symbol, node in belief.walked:
        rules: dict[str, None] = {}
        begun = False
        ways = _become(belief, node.explanations)
        steps = itertools.chain.from_iterable(_owing_steps(belief, symbol, here, view, topic) for here in ways)
        owed = list(filter(_is_made, steps)) if made_only else list(steps)
        left = [] if made_only else [one.assumed for one in belief.node.explanations]
        for step, made in (*_most_usual(owed, ()), *_most_usual(owed, left)):
            found, begun = True, begun or made
            sent = delivering(belief.spec, step)
            rules.update(dict.fromkeys(rule for rule in step.rules if rule not in sent))
        if rules or begun:
            return tuple(rules)
    return () if found else None


def _is_made(owed: tuple[Step, bool]) -> bool:
    _, made = owed
    return made


def _owing_steps(
    belief: Belief, symbol: tuple[Any, ...], here: Explanation, view: object, topic: Hashable
) -> Iterator[tuple[Step, bool]]:
    """The steps at an event that owe a view, each with whether somebody made it happen, other than by passing time."""
    for step, made in _steps(belief, symbol, here):
        if any(one.view == view and one.topic == topic for one in step.emits):
            yield step, made


def _most_usual(steps: Sequence[tuple[Step, bool]], left: Sequence[int]) -> list[tuple[Step, bool]]:
    """Of these steps those that need the fewest unusual readings, of those that are not ruled out if there are any."""
    oddity = [_unusual(step, left) for step, _ in steps]
    return [one for one, odd in zip(steps, oddity, strict=True) if odd == min(oddity)]


def _become(belief: Belief, before: Sequence[Explanation]) -> Sequence[Explanation]:
    """Explanations, and what they can become before an event: some of them, the nearest first."""
    successors = belief.automaton.successors
    successors.reset()
    try:
        return [way.explanation for way in itertools.islice(successors.closure(tuple(before), None), MAX_LOOKED_AT)]
    except ExhaustedError:
        return before[:MAX_LOOKED_AT]


def _unusual(step: Step, left: Sequence[int]) -> tuple[bool, int]:
    """Whether a step needs readings that are ruled out, and how many that are not usual."""
    possible = any(meet(one, step.assumes) for one in left)
    return not possible, sum(one.ambiguity.default not in one.letters for one in step.assumes)


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


def _steps(belief: Belief, symbol: tuple[Any, ...], here: Explanation) -> Iterator[tuple[Step, bool]]:
    """What can have happened at an event, in an explanation of what was before; whether somebody made it happen."""
    successors, spec = belief.automaton.successors, belief.spec
    kind, *what = symbol
    if kind is Driven:
        event, names = what
        drive = spec.drives[event.name]
        steps = drive.steps(here.state, event, successors.refs(here, names))
        yield from ((step, drive.later is None) for step in steps)
    elif kind is Called:
        request, names, *_ = what
        promised = tuple(one.id for one in spec.operations[spec.request_operation(request)].promises)
        for step in successors.outcomes(here.state, request, successors.refs(here, names)):
            # A call that took effect and failed all the same says no rule: those count by which it takes effect.
            yield (step if step.rules else evolve(step, rules=promised)), True
    for call in here.calls:
        if call.done is None:
            steps = successors.outcomes(here.state, call.request, successors.refs(here, call.args))
            yield from ((step, False) for step in steps)
    yield from ((step, False) for step in successors.urgent(here.state))
    yield from ((step, False) for step in successors.unseen(here.state))
