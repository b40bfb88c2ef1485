"""Streams that show the whole state: once they are opened, and whenever it changes."""

from __future__ import annotations

from collections.abc import Iterable

from attrs import evolve

from missionfsm.kernel.rules import Operation, Rule
from missionfsm.kernel.spec import Delivery, Spec
from missionfsm.kernel.step import Emission, Match, Mismatch, Opening, Step
from missionfsm.kernel.terms import Content, Refs, Request, State, View

TOPIC = "state"
"""What all channels of such streams are about."""


def shown_whole(spec: Spec, rule: Rule) -> Spec:
    """The same system, whose streaming operations each open a stream that shows the whole state and its names.

    Every step that changes the state owes it to all subscribers. The rule promises that: it is added to the system, at
    the operation that streams. A subject that shows something else, or nothing, breaks it.
    """
    streaming = next((name for name, one in spec.operations.items() if one.streaming), TOPIC)
    rule = rule if rule.id else rule.registered(spec.system, streaming)

    def seen(before: State, step: Step) -> Step:
        if step.names is None and step.after == before:
            return step
        return evolve(step, emits=(*step.emits, Emission(TOPIC, step.after)), rules=(*step.rules, rule.id))

    def watched(operation: Operation) -> Operation:
        promised = tuple(one.id for one in operation.promises)

        def effect(state: State, request: Request, refs: Refs) -> Iterable[Step]:
            for step in operation.effect(state, request, refs):
                justified = evolve(step, rules=step.rules or promised)
                yield _opened(state, spec.names(state), justified) if operation.streaming else seen(state, justified)

        return evolve(operation, effect=effect)

    def all_seen(before: State, steps: Iterable[Step]) -> tuple[Step, ...]:
        return tuple(seen(before, step) for step in steps)

    def matches(view: View, content: Content) -> tuple[Match, ...] | Mismatch:
        if view == content:
            return (Match(names=tuple((place, place) for place in range(spec.names(view)))),)
        return Mismatch(rule.id, f"it shows {spec.describe(content)}, and due is {spec.describe(view)}")

    return evolve(
        spec.with_steps(all_seen),
        operations=[watched(one) for one in spec.operations.values()],
        matches=matches,
        delivery=lambda _topic: Delivery(unowed=(rule.id,), named=(rule.id,), unending=(rule.id,)),
        undelivered=lambda _view: (rule.id,),
        unopened=(rule.id,),
        rules=(*spec.rules, rule),
    )


def _opened(state: State, names: int, step: Step) -> Step:
    """The step, with a stream whose name comes after those of the state."""
    first = Emission(TOPIC, state, tuple(range(names)))
    return evolve(step, opens=(Opening(TOPIC, names, (first,)),), refs=(names,))
