"""What an observation tells of a system of which nothing was known, or that others have brought somewhere else.

`missionfsm.oracle.transition` asks this of explanations whose state is `Unknown`: nothing is judged but whether some
state allows an answer, until a message shows the state. Where nothing explains an event, `unforeseen` says how others
can have brought it about, which assumes a reading of `missionfsm.kernel.middle`.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterable, Iterator

from attrs import evolve

from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.history import Answer, Driven, Received, Returned, Settled
from missionfsm.kernel.middle import ANY, LOG_01, LOG_02, Unknown, imaginable
from missionfsm.kernel.readings import Assumption, meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Glimpses, Spec, Things
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
    channel_names,
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


def world_of(glimpses: Glimpses, state: State) -> Hashable:
    """The world of a state, of which nothing more may be known."""
    return state.world if type(state) is Unknown else glimpses.world(state)


def _past(glimpses: Glimpses, here: Explanation) -> tuple[Things, ...]:
    """What is known of the things that there were, each with its name."""
    if not is_unknown(here):
        return (glimpses.things(here.state, here.names),)
    names = iter(here.names)
    return tuple(tuple(zip(itertools.islice(names, len(one)), one, strict=True)) for one in here.state.past)


def plausible(
    successors: Successors, explanation: Explanation, call: InFlight, answer: Answer, names: Names
) -> Iterator[tuple[tuple[Hashable, ...], Things]]:
    """The topics of the channels that such an answer opens and what it says was made, for each way that is allowed.

    What is made has a name that nothing had, unless somebody may have shown it before the answer came.
    """
    glimpses = _glimpses(successors)
    assert glimpses is not None, "asked only of systems that can be judged so"  # noqa: S101
    seen = set() if WILD in call.ready else {*explanation.names, *explanation.gone, GONE}
    ways = imaginable(successors.spec, world_of(glimpses, explanation.state), call.request, len(call.args))
    found: dict[tuple[tuple[Hashable, ...], Things], None] = {}
    for one in ways:
        answered = one.step.answer
        topics = tuple(opening.topic for opening in one.step.opens)
        told = names[len(topics) :]
        assert answered is not None, "an answer that some state allows"  # noqa: S101
        if not (answered.unordered or _fits(one.known, told, seen)):
            continue
        if meet(explanation.assumed, one.step.assumes) and successors.agreements(answered, answer):
            new = [name for name, known in zip(told, one.known, strict=False) if not known]
            found[topics, tuple(zip(new, one.made, strict=False))] = None
    yield from found


def _fits(known: tuple[bool, ...], told: Names, seen: set[int]) -> bool:
    """Whether an answer mentions as many names as it has to, once each where they are new."""
    new = [name for name, there in zip(told, known, strict=False) if not there]
    return len(known) == len(told) and len(set(new)) == len(new) and seen.isdisjoint(new)


def answered(
    successors: Successors, here: Explanation, position: int, answer: Answer, names: Names
) -> Iterator[Successor]:
    """The explanations in which a call is answered as some state allows, after which that is all that is known."""
    call = here.calls[position]
    rest = here.without_call(position)
    known = {channel.name for channel in rest.channels}
    for topics, made in plausible(successors, here, call, answer, names):
        opened = (Channel(name, topic, None, (_FREE,)) for name, topic in zip(names, topics, strict=False))
        channels = (*rest.channels, *(one for one in opened if one.name not in known))
        after = rest.replace(channels=channels)
        yield Successor(tidy(_knowing(after if is_unknown(here) else _lost_sight(successors, after), made)))


MAX_PAST = 64
"""Of how many things it is known what they were, where no message shows which are there."""


def _knowing(here: Explanation, made: Things) -> Explanation:
    """The explanation in which it is known what else there was, if the state does not say so."""
    new = [(name, thing) for name, thing in made if name not in here.names]
    if not new or not is_unknown(here) or len(here.names) + len(new) > MAX_PAST:
        return here  # what is known of fewer things is less, and never wrong
    past = (*here.state.past, tuple(thing for _, thing in new))
    return evolve(here, state=Unknown(here.state.world, past), names=(*here.names, *(name for name, _ in new)))


def states_shown(
    successors: Successors, here: Explanation, arrival: Arrival, *, then: bool = False
) -> Iterator[Successor]:
    """The explanations in which a message shows the state, whatever it was before.

    Args:
        then: whether it has to be one that the state before may have become.
    """
    spec, glimpses = successors.spec, _glimpses(successors)
    content, names = arrival.content, arrival.names
    if glimpses is None or arrival.channel == GONE or arrival.channel in here.gone:
        return
    if GONE in names:
        if is_unknown(here):
            yield Successor(here)  # it shows what was before
        return
    world = world_of(glimpses, here.state)
    agreed = _goes_on(glimpses, here, arrival) if then or is_unknown(here) else here.assumed
    for state, view in glimpses.states(world, content) if agreed else ():
        matches = spec.matches(view, content)
        if isinstance(matches, Mismatch):
            continue
        for match in matches:
            successors.spend()
            assumed = meet(agreed, match.assumes)
            own = _names(spec, here, state, match, names)
            if assumed:
                last = Owed(view, own, shown_as=spec.remembered(view, content))
                showing = Channel(arrival.channel, glimpses.topic(content), last)
                after = _standing(here, state, showing, all_seen=not spec.anywhere)
                yield Successor(tidy(after.replace(assumed=assumed)), match.rules)


def shown_meanwhile(
    successors: Successors, explanations: Iterable[Explanation], assumed: Iterable[Assumption], arrival: Arrival
) -> Iterator[Successor]:
    """The explanations in which a message shows an older state than the one of which nothing is known.

    Args:
        assumed: what is assumed where the numbers of the message compare so with those before.
    """
    glimpses, assumed = _glimpses(successors), tuple(assumed)
    for here in explanations:
        gone = {GONE, *here.gone}
        if glimpses is None or not is_unknown(here) or not gone.isdisjoint((*arrival.names, arrival.channel)):
            continue
        agreed = meet(_goes_on(glimpses, here, arrival), assumed)
        for state, view in glimpses.states(here.state.world, arrival.content) if agreed else ():
            matches = successors.spec.matches(view, arrival.content)
            found = () if isinstance(matches, Mismatch) else matches
            after = [meet(agreed, match.assumes) for match in found]
            if any(after):
                names = arrival.names[: successors.spec.names(state)]
                last = Owed(view, names, shown_as=successors.spec.remembered(view, arrival.content))
                channels = tuple(_showing(one, last) if one.name == arrival.channel else one for one in here.channels)
                agreed = next(filter(None, after))
                at_last = here.replace(assumed=agreed, channels=channels, calls=_all_wild(here.calls))
                rules = next(match.rules for match, assumes in zip(found, after, strict=True) if assumes)
                yield Successor(tidy(_knowing(at_last, glimpses.things(state, names))), rules)
                break


def _showing(channel: Channel, last: Owed) -> Channel:
    return Channel(channel.name, channel.topic, last, channel.owed, channel.foretold, channel.done)


def _goes_on(glimpses: Glimpses, here: Explanation, arrival: Arrival) -> int:
    """What is assumed where a message shows what the things that were there have become; 0 where they cannot have.

    What was shown before on its channel tells in which state they were; elsewhere it may have been shown later, but not
    in another order.
    """
    if any(_turned_round(one, arrival) for one in here.channels):
        return 0
    world, assumed = world_of(glimpses, here.state), here.assumed
    lasts = (one.last for one in here.channels if one.name == arrival.channel)
    shown = (glimpses.shown(one.view, one.names) for one in lasts if one and one.view is not ANY)
    for before in (*_past(glimpses, here), *shown):
        follows = glimpses.follows(world, before, arrival.content, arrival.names)
        assumed = 0 if follows is None else meet(assumed, follows)
        if not assumed:
            return 0
    return assumed


def _turned_round(channel: Channel, arrival: Arrival) -> bool:
    """Whether a channel has shown last some of the things of a message in another order."""
    last = channel.last
    if last is None or last.view is ANY:
        return False
    places = {name: place for place, name in enumerate(arrival.names)}
    kept = [places[name] for name in last.names if name in places]
    return kept != sorted(kept)


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


def _standing(here: Explanation, state: State, showing: Channel, *, all_seen: bool) -> Explanation:
    """The explanation in that state, shown on one channel; the others may show it as well, or what was on its way.

    Args:
        all_seen: whether every call and every channel is known that there is.
    """
    last = showing.last
    assert last is not None, "a channel that shows something"  # noqa: S101
    channels = [
        Channel(one.name, one.topic, one.last, (_FREE, Owed(last.view, last.names, passing=True)))
        for one in here.channels
        if one.name != showing.name
    ]
    calls = _all_wild(here.calls)
    # What is listed no more is gone, where no call can be answered with it and no other channel shows what was before.
    ended = here.names if all_seen and not (here.calls or channels) else ()
    gone = tuple(sorted({*here.gone, *(one for one in ended if one > GONE)}.difference(last.names)))
    channels = [showing, *channels]
    return Explanation(state, last.names, here.assumed, calls, here.lost, tuple(channels), gone, here.all_known)


def joined(successors: Successors, here: Explanation, channel: int, content: Content) -> tuple[Explanation, bool]:
    """The explanation with a channel that was opened before the log began, and whether its message is no more judged.

    Such a channel may show anything first; where nobody can tell what it is to show, it is not followed.
    """
    if isinstance(content, Malformed) or channel == GONE or channel in {*channel_names(here), *here.gone}:
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
        if not here.all_known or spec.others:
            yield from _brought_about(successors, here, kind, *what)
        elif kind is Received:
            yield from _late(here, what[3], what[0])


def _brought_about(successors: Successors, here: Explanation, kind: type, *what: Part) -> Iterator[Successor]:
    """How somebody may have brought an event about in one explanation."""
    if kind is Received:
        content, names, _, channel = what
        yield from states_shown(successors, here, Arrival(channel, content, names), then=True)
        yield from _late(here, channel, content)
    elif kind is Returned:
        answer, names, call = what
        place = here.place_of(call)
        if place is not None and _may_succeed(successors.spec, here, here.calls[place], answer, names):
            yield from answered(successors, here, place, answer, names)
    elif kind is Driven or (kind is Settled and successors.spec.anywhere):
        yield Successor(_lost_sight(successors, here))


def _may_succeed(spec: Spec, here: Explanation, call: InFlight, answer: Answer, names: Names) -> bool:
    """Whether a call may be answered so in a state that the one which is known can become, whoever does what.

    A call that was sent before that state was known may have taken effect before it.
    """
    if answer.code != OK or spec.succeeds is None or WILD in call.ready:
        return True
    return spec.succeeds(here.state, here.names, call.request, call.args, names)


def _late(here: Explanation, name: int, content: Content) -> Iterator[Successor]:
    """The explanation in which a channel that was opened before the log began still shows what was before."""
    channels = (channel for channel in here.channels if channel.name == name)
    if not isinstance(content, Malformed) and any(one.last and one.last.view is ANY for one in channels):
        yield Successor(here)


def _lost_sight(successors: Successors, here: Explanation) -> Explanation:
    """The explanation in which nothing is known of the state any more."""
    glimpses = _glimpses(successors)
    assert glimpses is not None, "asked only of systems that can be judged so"  # noqa: S101
    last = Owed(ANY, ())
    channels = tuple(
        Channel(one.name, one.topic, one.last or last if successors.spec.others else last, (_FREE,))
        for one in here.channels
    )
    calls = _all_wild(here.calls)
    things = glimpses.things(here.state, here.names)[-MAX_PAST:]
    unknown = Unknown(glimpses.world(here.state), (tuple(thing for _, thing in things),) if things else ())
    names = tuple(name for name, _ in things)
    return tidy(Explanation(unknown, names, here.assumed, calls, here.lost, channels, here.gone, here.all_known))


def wild(
    successors: Successors, here: Explanation, position: int, answer: Answer, names: Names
) -> Iterator[Explanation]:
    """The explanation in which a call took effect, or was refused, while nothing was known, and is answered so."""
    call = here.calls[position]
    if WILD in call.ready:
        known = {channel.name for channel in here.channels}
        ways = plausible(successors, here, call, answer, names)
        if any(all(name in known for name in names[: len(topics)]) for topics, _ in ways):
            yield here.without_call(position)


__all__ = ["answered", "is_unknown", "joined", "states_shown", "unforeseen", "wild", "world_of"]
