"""What an observation tells of a system of which nothing was known, or that others have brought somewhere else.

`missionfsm.oracle.transition` asks this of explanations whose state is `Unknown`: nothing is judged but whether some
state allows an answer, until a message shows the state. Where nothing explains an event, `unforeseen` says how others
can have brought it about, which assumes a reading of `missionfsm.kernel.middle`.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterable, Iterator

from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.history import Answer, Driven, Received, Returned, Settled
from missionfsm.kernel.middle import ANY, LOG_01, LOG_02, Unknown
from missionfsm.kernel.readings import Assumption, meet
from missionfsm.kernel.spec import Glimpses, Spec
from missionfsm.kernel.step import Match, Mismatch
from missionfsm.kernel.terms import Content, State
from missionfsm.oracle.explanation import (
    GONE,
    Channel,
    Explanation,
    InFlight,
    Names,
    Owed,
    Ready,
    fresh,
    tidy,
)
from missionfsm.oracle.successors import Successor, Successors
from missionfsm.oracle.symbols import Arrival, Part

WILD = Ready(Answer("*"), (), (), ())
"""The answer of a call that took effect, or was refused, while nothing was known: any that some state allows."""
_FREE = Owed(ANY, (), passing=True, optional=True)


def is_unknown(explanation: Explanation) -> bool:
    """Whether nothing is known of the state."""
    return type(explanation.state) is Unknown


def _glimpses(successors: Successors) -> Glimpses | None:
    return successors.spec.middle.glimpses if successors.spec.middle else None


def plausible(
    successors: Successors, explanation: Explanation, call: InFlight, answer: Answer
) -> Iterator[tuple[Hashable, ...]]:
    """The topics of the channels that such an answer opens, once for each way in which some state allows it."""
    glimpses = _glimpses(successors)
    state = explanation.state
    if glimpses is not None and not is_unknown(explanation):
        state = Unknown(glimpses.world(state))
    yield from dict.fromkeys(
        tuple(one.topic for one in step.opens)
        for step in successors.outcomes(state, call.request, (None,) * len(call.args))
        if step.answer is not None
        and meet(explanation.assumed, step.assumes)
        and successors.agreements(step.answer, answer)
    )


def answered(
    successors: Successors, here: Explanation, position: int, answer: Answer, names: Names
) -> Iterator[Successor]:
    """The explanations in which a call is answered as some state allows, of which nothing more is known."""
    call = here.calls[position]
    rest = here.replace(calls=(*here.calls[:position], *here.calls[position + 1 :]))
    known = {channel.name for channel in rest.channels}
    for topics in plausible(successors, here, call, answer):
        opened = (Channel(name, topic, None, (_FREE,)) for name, topic in zip(names, topics, strict=False))
        channels = (*rest.channels, *(one for one in opened if one.name not in known))
        yield Successor(tidy(rest.replace(channels=channels)))


def states_shown(
    successors: Successors, here: Explanation, arrival: Arrival, *, then: bool = False
) -> Iterator[Successor]:
    """The explanations in which a message shows the state, whatever it was before.

    Args:
        then: whether it has to be one that the state before may have become.
    """
    spec, glimpses = successors.spec, _glimpses(successors)
    content, names = arrival.content, arrival.names
    if glimpses is None:
        return
    if GONE in names:
        if is_unknown(here):
            yield Successor(here)  # it shows what was before
        return
    world = here.state.world if is_unknown(here) else glimpses.world(here.state)
    for state, view in glimpses.states(world, content):
        matches = spec.matches(view, content)
        if isinstance(matches, Mismatch):
            continue
        for match in matches:
            successors.spend()
            assumed = meet(here.assumed, match.assumes)
            own = _names(spec, here, state, match, names)
            if assumed and not (then and not glimpses.follows(here.state, here.names, state, own)):
                last = Owed(view, own, shown_as=spec.remembered(view, content))
                after = _standing(here, state, Channel(arrival.channel, glimpses.topic(content), last))
                yield Successor(tidy(after.replace(assumed=assumed)), match.rules)


def _names(spec: Spec, here: Explanation, state: State, match: Match, names: Names) -> Names:
    known = {ref: names[at] for ref, at in match.names}
    unseen = fresh(here)
    return tuple(known[ref] if ref in known else next(unseen) for ref in range(spec.names(state)))


def _all_wild(calls: tuple[InFlight, ...]) -> tuple[InFlight, ...]:
    """The calls, each of which may have been answered anything."""
    return tuple(
        one if WILD in one.ready else InFlight(one.name, one.request, one.args, (*one.ready, WILD), one.done)
        for one in calls
    )


def _standing(here: Explanation, state: State, showing: Channel) -> Explanation:
    """The explanation in that state, shown on one channel; the others may show it as well, or what was on its way."""
    last = showing.last
    assert last is not None, "a channel that shows something"  # noqa: S101
    channels = [
        Channel(one.name, one.topic, one.last, (_FREE, Owed(last.view, last.names, passing=True)))
        for one in here.channels
        if one.name != showing.name
    ]
    calls = _all_wild(here.calls)
    gone = tuple(one for one in here.gone if one not in last.names)
    return Explanation(state, last.names, here.assumed, calls, here.lost, (showing, *channels), gone)


def joined(successors: Successors, here: Explanation, channel: int, content: Content) -> tuple[Explanation, bool]:
    """The explanation with a channel that was opened before the log began, and whether its message is no more judged.

    Such a channel may show anything first; where nobody can tell what it is to show, it is not followed.
    """
    if isinstance(content, Malformed) or channel in {one.name for one in here.channels}:
        return here, False
    glimpses = _glimpses(successors)
    if glimpses is None:
        return here, True
    return here.replace(channels=(*here.channels, Channel(channel, glimpses.topic(content), None, (_FREE,)))), False


def unforeseen(
    successors: Successors,
    explanations: Iterable[Explanation],
    assumed: Iterable[Assumption],
    kind: type,
    *what: Part,
) -> Iterator[Successor]:
    """How somebody whose calls are not in the log, or who called before it began, can have brought an event about.

    Args:
        assumed: what is assumed where the numbers of a message compare so with those before.
    """
    spec = successors.spec
    if _glimpses(successors) is None:
        return
    acted = LOG_02["b"] if spec.others else LOG_01["b"]
    for one in explanations:
        agreed = meet(one.assumed, (acted, *assumed))
        here = one.replace(assumed=agreed)
        if not agreed or is_unknown(here):
            continue
        if kind is Received:
            content, names, _, channel = what
            yield from states_shown(successors, here, Arrival(channel, content, names), then=True)
            yield from _late(here, channel, content)
        elif kind is Returned:
            answer, names, call = what
            place = next((place for place, each in enumerate(here.calls) if each.name == call), None)
            if place is not None:
                for after in answered(successors, here, place, answer, names):
                    yield Successor(_lost_sight(successors, after.explanation))
        elif kind is Driven or (kind is Settled and spec.anywhere):
            yield Successor(_lost_sight(successors, here))


def _late(here: Explanation, name: int, content: Content) -> Iterator[Successor]:
    """The explanation in which a channel that was opened before the log began still shows what was before."""
    channels = (channel for channel in here.channels if channel.name == name)
    if not isinstance(content, Malformed) and any(one.last and one.last.view is ANY for one in channels):
        yield Successor(here)


def _lost_sight(successors: Successors, here: Explanation) -> Explanation:
    """The explanation in which nothing is known of the state any more."""
    glimpses = _glimpses(successors)
    assert glimpses is not None, "asked only of systems that can be judged so"  # noqa: S101
    channels = tuple(Channel(one.name, one.topic, Owed(ANY, ()), (_FREE,)) for one in here.channels)
    calls = _all_wild(here.calls)
    unknown = Unknown(glimpses.world(here.state))
    return tidy(Explanation(unknown, (), here.assumed, calls, here.lost, channels, here.gone))


def wild(
    successors: Successors, here: Explanation, position: int, answer: Answer, names: Names
) -> Iterator[Explanation]:
    """The explanation in which a call took effect, or was refused, while nothing was known, and is answered so."""
    call = here.calls[position]
    if WILD in call.ready:
        known = {channel.name for channel in here.channels}
        for topics in itertools.islice(plausible(successors, here, call, answer), 1):
            if all(name in known for name in names[: len(topics)]):
                yield here.replace(calls=(*here.calls[:position], *here.calls[position + 1 :]))


__all__ = ["answered", "is_unknown", "joined", "states_shown", "unforeseen", "wild"]
