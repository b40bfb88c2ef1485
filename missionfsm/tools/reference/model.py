"""The deterministic reference of a spec: an implementation that follows one choice of readings.

A `Snapshot` is an immutable value: a state, the names it has given out, its open channels. From a snapshot and a call
or a drive a `Reference` computes the next snapshot, and everything that an observer sees. It keeps nothing but a memo.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Any

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer, Name
from missionfsm.kernel.readings import choose, meet
from missionfsm.kernel.step import ONCE_HAD, Emission, Match, Mismatch, Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Incident, Refs, State, View

MAX_STEPS = 1_000
"""How many steps a reference remembers. States may be large: some list everything that has ended."""
_UNKNOWN = Step(None)
"""What the memo has for a question that was not asked yet; None stands for a step that no reading allows."""


@frozen
class Open:
    """An open channel."""

    name: Name
    topic: Hashable


@frozen
class Sent:
    """A message that a channel of a topic shows: its number, the view and the names in it."""

    channel: Name
    topic: Hashable
    number: int
    view: View
    names: tuple[Name, ...]


@frozen
class Snapshot:
    """The state of a reference, with everything that it has to remember.

    Attributes:
        state: the state.
        names: the names of the state, in its order.
        channels: the open channels.
        minted: how many names have been given out.
        numbered: the number of the last event; the beginning has 1. Every stream shows an event under its number.
        gone: names that the state no longer has, if that matters (see `Spec.recalls`).
    """

    state: State
    names: tuple[Name, ...] = ()
    channels: tuple[Open, ...] = ()
    minted: int = 0
    numbered: int = 1
    gone: frozenset[Name] = frozenset()

    def ref(self, name: Name) -> int | None:
        """The position of a name, as `Spec.outcomes` takes it."""
        if name in self.names:
            return self.names.index(name)
        return ONCE_HAD if name in self.gone else None


@frozen
class Reply:
    """What comes of something: the answer (None for a drive), its names, the messages in order, and why.

    `happened` is False for a drive that does not apply.
    """

    answer: Answer | None
    names: tuple[Name, ...] = ()
    sent: tuple[Sent, ...] = ()
    rules: tuple[str, ...] = ()
    happened: bool = True


StepMutator = Callable[[Any, Step | None], Step | None]
"""(state, step) to the step that is taken in its place; for implementations with one thing broken."""


def unchanged_step(_: State, step: Step | None) -> Step | None:
    """The step itself: nothing is broken."""
    return step


def recognised(
    system: System,
    view: View,
    names: tuple[Name, ...],
    choice: int,
    mutate_message: Callable[[JSON], JSON] = lambda message: message,
) -> tuple[tuple[Match, ...] | Mismatch, ...]:
    """For each part of the message that is made of a view: the ways in which it shows the view, or what is wrong.

    Args:
        choice: the readings under which it is made.
        mutate_message: what becomes of it on the way.
    """
    codec = system.codec
    message = codec.write_message(view, names, choice, 1, 0.0)
    if message is None:  # the channel ends, which no message shows
        return ()
    message = mutate_message(message)
    return tuple(system.spec.matches(view, codec.read_content(rest)) for _, _, rest in codec.split_message(message))


class Reference:
    """The reference of a system under one choice of readings.

    Args:
        system: the system.
        choice: ambiguity id to letter; the others follow their defaults.
        mint: serial number to a name that was never given out; by default as the system has it.
        mutate_step: what is broken, if anything.

    Raises:
        ValueError: `choice` names an ambiguity or a letter that does not exist.
    """

    def __init__(
        self,
        system: System,
        choice: Mapping[str, str] | None = None,
        mint: Callable[[int], Name] | None = None,
        mutate_step: StepMutator = unchanged_step,
    ) -> None:
        self.system = system
        self.choice = choose(system.spec.ambiguities, choice)
        self._mint = mint or system.naming.given
        self.mutate_step = mutate_step
        self._chosen: dict[Any, Step | None] = {}

    def start(self, world: object) -> Snapshot:
        """A fresh instance in a world."""
        state = self.system.spec.initial(world)
        named, minted = self._names(self.system.spec.names(state), 0)
        return self._settle(Snapshot(state, named, minted=minted), [])[0]

    def _names(self, count: int, minted: int) -> tuple[tuple[Name, ...], int]:
        return tuple(self._mint(minted + 1 + index) for index in range(count)), minted + count

    def call(self, here: Snapshot, request: object, names: tuple[Name, ...] = ()) -> tuple[Snapshot, Reply]:
        """Answer a call: the snapshot after it, and the reply."""
        step = self.outcome(here.state, request, tuple(map(here.ref, names)))
        after, sent, mentioned = self._take(here, step, ())
        after, sent = self._settle(after, sent)
        return after, Reply(step.answer, mentioned, tuple(sent), step.rules)

    def outcome(self, state: State, request: object, refs: Refs = ()) -> Step:
        """What the reference answers in a state: the first outcome that its readings allow."""
        key = (state, request, refs)
        step = self._chosen.get(key)  # inlined, since every call comes by here
        if step is None:
            step = self._remembered(key, self.system.spec.outcomes, state, request, refs)
        if step is None:
            message = f"{self.system.name}: no outcome under this choice of readings for {request!r}"
            raise AssertionError(message)
        return step

    def drive(self, here: Snapshot, event: Incident, names: tuple[Name, ...] = ()) -> tuple[Snapshot, Reply]:
        """Make something happen; the reply says whether it applied."""
        step = self.driven(here.state, event, tuple(map(here.ref, names)))
        if step is None:
            return here, Reply(None, happened=False)
        here, names = self._brought(here, step, names)
        after, sent, _ = self._take(here, step, names)
        after, sent = self._settle(after, sent)
        return after, Reply(None, names, tuple(sent), step.rules)

    def _brought(self, here: Snapshot, step: Step, names: tuple[Name, ...]) -> tuple[Snapshot, tuple[Name, ...]]:
        """The names that an event brings along. Names of channels that it opens are made up if they are missing."""
        kinds = {opening.ref: opening.kind for opening in step.opens if opening.ref < 0}
        while -len(names) - 1 in kinds:
            here = evolve(here, minted=here.minted + 1)
            names = (*names, (kinds[-len(names) - 1], here.minted))
        return here, names

    def urgent(self, state: State) -> Step | None:
        """What the reference does by itself at once, if anything."""
        return self._remembered((state,), self.system.spec.urgent, state)

    def driven(self, state: State, event: Incident, refs: Refs) -> Step | None:
        """How something that the environment does comes about; None where it does not apply."""
        steps = self.system.spec.drives[event.name].steps
        return self._remembered((state, "drive", event, refs), steps, state, event, refs)

    def cancel(self, here: Snapshot, channel: Name) -> Snapshot:
        """Give a stream up; one that does not exist is no error."""
        return evolve(here, channels=tuple(one for one in here.channels if one.name != channel))

    def _remembered(
        self, key: tuple[Hashable, ...], steps: Callable[..., Iterable[Step]], *arguments: object
    ) -> Step | None:
        """The first of some steps that the readings allow; `key` begins with the state, and says which steps."""
        step = self._chosen.get(key, _UNKNOWN)
        if step is _UNKNOWN:
            allowed = next((step for step in steps(*arguments) if meet(self.choice, step.assumes)), None)
            if len(self._chosen) >= MAX_STEPS:
                self._chosen.clear()
            step = self._chosen[key] = self.mutate_step(key[0], allowed)
        return step

    def _settle(self, here: Snapshot, sent: list[Sent]) -> tuple[Snapshot, list[Sent]]:
        """Take everything urgent at once."""
        while True:
            step = self.urgent(here.state)
            if step is None:
                return here, self._delivered(sent)
            here, more, _ = self._take(here, step, ())
            sent = sent + more

    def _take(
        self, here: Snapshot, step: Step, given: tuple[Name, ...]
    ) -> tuple[Snapshot, list[Sent], tuple[Name, ...]]:
        made = self._made(here, step)
        pool = [*here.names, *made, *reversed(given)]
        names = here.names if step.names is None else tuple(pool[ref] for ref in step.names)
        lapsed = set(here.names).difference(names) if self.system.spec.recalls else ()
        gone = here.gone.union(lapsed) if lapsed else here.gone
        left = tuple(one for one in here.channels if one.topic not in step.ends) if step.ends else here.channels
        after = evolve(here, state=step.after, names=names, minted=here.minted + len(made), gone=gone, channels=left)
        sent: list[Sent] = []
        passing = self.urgent(step.after) is not None if step.emits else False
        concerns = self.system.spec.concerns
        for emission in step.emits:
            listening = [one for one in after.channels if concerns(one.topic, emission.topic)]
            after = evolve(after, numbered=after.numbered + 1)
            after = self._send(after, listening, emission, pool, sent, passing=passing)
        for opening in step.opens:
            channel = Open(pool[opening.ref], opening.topic)
            after = evolve(after, channels=(*after.channels, channel))
            for emission in opening.owed:
                after = self._send(after, [channel], emission, pool, sent, passing=False)
        return after, sent, tuple(pool[ref] for ref in step.refs)

    def _made(self, here: Snapshot, step: Step) -> list[Name]:
        """The names that a step adds: each of its kind, channels by their numbers."""
        channels = {opening.ref: opening.kind for opening in step.opens}
        kinds = itertools.chain(step.kinds, itertools.repeat(""))
        made: list[Name] = []
        for at in range(step.adds(len(here.names))):
            ref, kind, number = len(here.names) + at, next(kinds), here.minted + at + 1
            if ref in channels:
                made.append((channels[ref], number))
            else:
                made.append(self.system.naming.make(kind, number) if kind else self._mint(number))
        return made

    def _send(
        self,
        here: Snapshot,
        channels: list[Open],
        emission: Emission,
        pool: list[Name],
        sent: list[Sent],
        *,
        passing: bool,
    ) -> Snapshot:
        """Show the last event on channels under its number; repeat it under the next one if a reading says so."""
        names = here.names if emission.refs is None else tuple(pool[ref] for ref in emission.refs)
        if emission.only and not meet(self.choice, (emission.only,)):
            return here
        if passing and not emission.certain and not self._would_show(emission.view, names):
            return here
        sent += (Sent(one.name, one.topic, here.numbered, emission.view, names) for one in channels)
        again = [one for one in channels if self._repeats(one.topic)]
        if again:
            here = evolve(here, numbered=here.numbered + 1)
            sent += (Sent(one.name, one.topic, here.numbered, emission.view, names) for one in again)
        return here

    def _repeats(self, topic: Hashable) -> bool:
        repeats = self.system.spec.delivery(topic).repeats
        return bool(repeats and meet(self.choice, (repeats,)))

    def _would_show(self, view: object, names: tuple[Name, ...]) -> bool:
        """Whether the readings allow that a state which does not last is shown."""
        matches = recognised(self.system, view, names, self.choice)[0]
        return not isinstance(matches, Mismatch) and any(meet(self.choice, match.assumes) for match in matches)

    def _delivered(self, sent: list[Sent]) -> list[Sent]:
        """What is really sent of what was caused at once: under some readings only the latest."""
        last = {(one.channel, one.topic): one for one in sent}
        return [one for one in sent if last[one.channel, one.topic] is one or not self._skips(one.topic)]

    def _skips(self, topic: Hashable) -> bool:
        skips = self.system.spec.delivery(topic).skips
        return bool(skips and meet(self.choice, (skips,)))
