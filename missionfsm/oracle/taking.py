"""What a step makes of an explanation: its names, what its channels owe then, and which of them are there."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Iterable

from attrs import evolve

from missionfsm.kernel.readings import meet
from missionfsm.kernel.step import Emission, Step
from missionfsm.kernel.terms import State
from missionfsm.oracle.explanation import DRAINED, GONE, Channel, Explanation, Names, Owed, fresh, outlived


def owes(emission: Emission, pool: Names, after: Names, *, passing: bool) -> Owed:
    """The message that an emission owes, with its names looked up."""
    names = after if emission.refs is None else tuple(pool[ref] for ref in emission.refs)
    optional = emission.optional or emission.stays
    passing = (passing and not emission.certain) or optional or emission.fleeting or emission.only is not None
    return Owed(emission.view, names, passing, emission.only, optional, emission.stays)


def _owing(channel: Channel, added: Iterable[Owed]) -> Channel:
    """The channel with more to show; an offer that it makes already is not made twice."""
    if channel.done:
        return channel
    owed = channel.owed
    for one in added:
        if not (one.stays and owed and owed[-1] == one):
            owed = (*owed, one)
    return channel.owing(owed)


def _relieved(channel: Channel, step: Step) -> Channel:
    """The channel without what a step makes void."""
    if channel.topic in step.clears:
        return channel.owing() if channel.owed else channel
    if channel.topic in step.lingers and channel.owed:
        return channel.owing(tuple(evolve(one, passing=True, optional=False) for one in channel.owed))
    if channel.topic in step.withdraws and channel.owed:
        return channel.owing(tuple(one for one in channel.owed if not one.optional))
    return channel


def _drained(channel: Channel) -> Channel:
    """A channel that is gone, with what was on its way."""
    owed = tuple(evolve(one, passing=True, optional=False, stays=False) for one in channel.owed)
    return Channel(channel.name, DRAINED, channel.last, owed)


def take(
    explanation: Explanation,
    step: Step,
    given: Names,
    *,
    passing: bool,
    concerns: Callable[[Hashable, Hashable], bool],
) -> tuple[Explanation, Names] | None:
    """The explanation after a step, and the names that its answer mentions; None where the step assumes too much.

    Args:
        given: the names that the event brought along.
        passing: whether the state after it does not last, so that what it shows may never be seen.
        concerns: `Spec.concerns`.
    """
    assumed = meet(explanation.assumed, step.assumes)
    if not assumed:
        return None
    pool = _pool(explanation, step, given)
    names, gone = _carried(explanation, step, pool)

    def owing(emission: Emission) -> Owed:
        return owes(emission, pool, names, passing=passing)

    channels = _channels_after(explanation.channels, step, owing, concerns)
    if step.opens:
        opened = (Channel(pool[one.ref], one.topic, None, tuple(map(owing, one.owed))) for one in step.opens)
        channels = (*channels, *opened)
    here = explanation
    after = Explanation(step.after, names, assumed, here.calls, here.lost, channels, gone, here.all_known)
    return after, tuple([pool[ref] for ref in step.refs])


def _pool(explanation: Explanation, step: Step, given: Names) -> Names:
    """The names to which a step refers by position: those of the state, new ones, and those that were given."""
    pool = explanation.names
    referred = step.names or ()
    if step.refs:
        referred += step.refs
    if step.opens:
        referred += tuple([one.ref for one in step.opens])
    added = max(referred) + 1 - len(pool) if referred else 0
    if added > 0:
        pool = (*pool, *itertools.islice(fresh(explanation), added))
    # References below zero count from the front of what was given: -1 is the first.
    return (*pool, *reversed(given)) if given else pool


def _carried(explanation: Explanation, step: Step, pool: Names) -> tuple[Names, Names]:
    """The names of the state after a step, and those that are gone then."""
    names, gone = explanation.names, explanation.gone
    if step.names is not None:
        names, before = tuple([pool[ref] for ref in step.names]), explanation.names
        if names[: len(before)] != before:
            lapsed = [name for name in set(before).difference(names) if name > GONE]
            if lapsed:
                gone = outlived(explanation, lapsed)
    if step.ends:
        ended = [one.name for one in explanation.channels if one.topic in step.ends and one.name > GONE]
        gone = tuple(sorted({*gone, *ended}))
    return names, gone


def _channels_after(
    channels: tuple[Channel, ...],
    step: Step,
    owing: Callable[[Emission], Owed],
    concerns: Callable[[Hashable, Hashable], bool],
) -> tuple[Channel, ...]:
    """The channels that were there, after a step, with what it shows."""
    if step.closes:
        channels = tuple(one for one in channels if one.topic not in step.closes)
    if step.clears or step.lingers or step.withdraws:
        channels = tuple(_relieved(channel, step) for channel in channels)
    if step.emits and channels:
        shown = [(emission.topic, owing(emission)) for emission in step.emits]
        channels = tuple(
            [_owing(one, [owed for topic, owed in shown if concerns(one.topic, topic)]) for one in channels]
        )
    return _without_drained(channels, step) if step.drains else channels


def _without_drained(channels: tuple[Channel, ...], step: Step) -> tuple[Channel, ...]:
    """The channels, where some are gone and only what was on its way may still be seen, the step's own messages too."""
    left = tuple(_drained(one) if one.topic in step.drains else one for one in channels)
    return tuple(one for one in left if one.topic != DRAINED or one.owed)


def changes(state: State, step: Step) -> bool:
    """Whether anybody could ever tell that the step was taken from the state."""
    moved = step.after is not state and step.after != state
    renamed = step.names is not None and step.names != tuple(range(len(step.names)))  # another in the place of one
    return (
        moved or renamed or bool(step.emits or step.opens or step.ends or step.clears or step.lingers or step.withdraws)
    )
