"""The oracle as one would write it down: no laziness, no pruning, no merging, no interning, no assumptions.

Every full choice of readings is a world of its own. In each, a set of configurations is closed under everything that
can happen unseen before the next event, and the event keeps those in which it is the case. Things have numbers, names
are bound to them for good.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterable, Iterator

from attrs import evolve, frozen

from missionfsm.kernel.history import (
    Answer,
    Called,
    Cancelled,
    Driven,
    Ended,
    Event,
    Name,
    Received,
    Returned,
    Settled,
)
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Emission, Mismatch, Step

Things = tuple[int, ...]


@frozen(cache_hash=True)
class Call:
    """A call in flight; `answer` is set from the moment at which it was decided."""

    name: Name
    request: Hashable
    args: tuple[Name, ...]
    answer: Answer | None = None
    things: Things = ()


@frozen(cache_hash=True)
class Message:
    """What a channel owes; one that is `optional` may be left out, one that `stays` may be shown again and again."""

    view: Hashable
    things: Things
    optional: bool = False
    stays: bool = False


@frozen(cache_hash=True)
class Stream:
    """A channel."""

    thing: int
    topic: Hashable
    last: Message | None = None
    owed: tuple[Message, ...] = ()


@frozen(cache_hash=True)
class Configuration:
    """One way in which things can stand."""

    state: Hashable
    things: Things
    made: int
    bound: frozenset[tuple[Name, int]] = frozenset()
    calls: tuple[Call, ...] = ()
    lost: tuple[tuple[Hashable, tuple[Name, ...]], ...] = ()
    streams: tuple[Stream, ...] = ()
    given_up: frozenset[Name] = frozenset()

    def thing(self, name: Name) -> int | None:
        """The thing that has a name."""
        return dict(self.bound).get(name)

    def bind(self, pairs: Iterable[tuple[int, Name]]) -> Configuration | None:
        """With these things named so; None where a name or a thing would have two."""
        bound = self.bound | {(name, thing) for thing, name in pairs}
        one_to_one = len({name for name, _ in bound}) == len(bound) == len({thing for _, thing in bound})
        return evolve(self, bound=bound) if one_to_one else None


class World:
    """One full choice of readings."""

    def __init__(self, spec: Spec, driven: Iterable[str], choice: dict[str, str]) -> None:
        self.spec = spec
        self.driven = frozenset(driven)
        self.choice = choice

    def agrees(self, assumptions: Iterable[Assumption]) -> bool:
        """Whether the choice is among what is assumed."""
        return all(self.choice[one.ambiguity.id] in one.letters for one in assumptions)

    # What can happen unseen.

    def moves(self, here: Configuration) -> Iterator[Configuration]:
        """Everything that can be the case after one more thing happened unseen."""
        own = list(self.spec.urgent(here.state)) + list(self.spec.spontaneous(here.state))
        for drive in self.spec.drives.values():
            if drive.name not in self.driven:
                own += [step for event in drive.by_itself for step in drive.steps(here.state, event, ())]
        for step in own:
            yield from (after for after, _ in self.take(here, step))
        for at, (request, args) in enumerate(here.lost):
            rest = evolve(here, lost=(*here.lost[:at], *here.lost[at + 1 :]))
            for where, refs in self.addressed(rest, args):
                for step in self.spec.outcomes(where.state, request, refs):
                    if not step.opens:  # nobody gets to know of a stream whose call was lost
                        yield from (after for after, _ in self.take(where, step))
        for at, call in enumerate(here.calls):
            if call.answer is None:
                for where, refs in self.addressed(here, call.args):
                    for step in self.spec.outcomes(where.state, call.request, refs):
                        for after, things in self.take(where, step):
                            decided = evolve(call, answer=step.answer, things=things)
                            lost = after.lost if step.applied else (*after.lost, (call.request, call.args))
                            yield evolve(after, calls=(*here.calls[:at], decided, *here.calls[at + 1 :]), lost=lost)

    def addressed(
        self, here: Configuration, args: tuple[Name, ...]
    ) -> Iterator[tuple[Configuration, tuple[int | None, ...]]]:
        """A name that was not seen yet may be that of anything whose name was not seen yet."""
        named = {thing for _, thing in here.bound}
        unnamed: list[int | None] = [None, *(thing for thing in here.things if thing not in named)]
        fresh = [arg for arg in dict.fromkeys(args) if here.thing(arg) is None]
        for guess in itertools.product(unnamed, repeat=len(fresh)):
            pairs = [(thing, arg) for thing, arg in zip(guess, fresh, strict=True) if thing is not None]
            where = here.bind(pairs)
            if where:
                things = [where.thing(arg) for arg in args]
                yield where, tuple(where.things.index(one) if one in where.things else None for one in things)

    def take(
        self, here: Configuration, step: Step, given: tuple[Name, ...] = ()
    ) -> Iterator[tuple[Configuration, Things]]:
        """The configuration after a step, and the things that its answer mentions."""
        if not self.agrees(step.assumes):
            return
        made, pool = here.made, dict(enumerate(here.things))
        for at, name in enumerate(given):
            thing = here.thing(name)
            if thing is None:
                thing, made = made, made + 1
                bound = here.bind([(thing, name)])
                assert bound
                here = bound
            pool[-1 - at] = thing
        wanted = (*(step.names or ()), *step.refs, *(one.ref for one in step.opens))
        for ref in sorted(set(wanted)):
            if ref not in pool:
                pool[ref], made = made, made + 1
        things = here.things if step.names is None else tuple(pool[ref] for ref in step.names)
        passing = any(self.agrees(one.assumes) for one in self.spec.urgent(step.after))

        def owed(emission: Emission) -> tuple[Message, ...]:
            if emission.only is not None and not self.agrees([emission.only]):
                return ()
            about = things if emission.refs is None else tuple(pool[ref] for ref in emission.refs)
            optional = passing or emission.optional or emission.only is not None
            return (Message(emission.view, about, optional, emission.stays),)

        assert not step.drains, "no toy has connections"
        streams = [one for one in here.streams if one.topic not in step.closes]
        for emission in step.emits:
            streams = [
                evolve(one, owed=one.owed + owed(emission)) if self.spec.concerns(one.topic, emission.topic) else one
                for one in streams
            ]
        for opening in step.opens:
            first = tuple(message for emission in opening.owed for message in owed(emission))
            streams.append(Stream(pool[opening.ref], opening.topic, None, first))
        after = evolve(here, state=step.after, things=things, made=made, streams=tuple(streams))
        yield after, tuple(pool[ref] for ref in step.refs)

    def closure(self, start: Iterable[Configuration]) -> set[Configuration]:
        """All that can be the case before the next event."""
        found = set(start)
        todo = list(found)
        while todo:
            for after in self.moves(todo.pop()):
                if after not in found:
                    found.add(after)
                    todo.append(after)
        return found

    # What is observed.

    def observe(self, here: Configuration, event: Event, relations: tuple[str, ...] = ()) -> Iterator[Configuration]:
        """The configurations that the event leaves of one (of a closed set)."""
        match event:
            case Called(call, request, names, lost):
                if lost:
                    yield evolve(here, lost=(*here.lost, (request, names)))
                else:
                    yield evolve(here, calls=(*here.calls, Call(call, request, names)))
            case Returned(name, answer, names):
                for call in here.calls:
                    if call.name == name and call.answer == answer and len(call.things) == len(names):
                        rest = evolve(here, calls=tuple(one for one in here.calls if one is not call))
                        orders = itertools.permutations(names) if answer.unordered else [names]
                        yield from self._bound(rest, ([*zip(call.things, order, strict=True)] for order in orders))
            case Received():
                yield from self.received(here, event, relations)
            case Ended(channel, _) if channel in here.given_up:
                yield here
            case Ended(channel, code):
                for thing in {stream.thing for stream in here.streams}:
                    ended = [one for one in here.streams if one.thing == thing]
                    assumes = [self.spec.delivery(one.topic).ends.get(code) for one in ended]
                    if all(one is not None and self.agrees(one) for one in assumes):
                        rest = evolve(here, streams=tuple(one for one in here.streams if one not in ended))
                        yield from self._bound(rest, [[(thing, channel)]])
            case Cancelled(channel):
                streams = tuple(one for one in here.streams if one.thing != here.thing(channel))
                yield evolve(here, streams=streams, given_up=here.given_up | {channel})
            case Driven(what, names):
                things = [here.thing(name) for name in names]
                refs = tuple(here.things.index(one) if one in here.things else None for one in things)
                for step in self.spec.drives[what.name].steps(here.state, what, refs):  # type: ignore[attr-defined]
                    yield from (after for after, _ in self.take(here, step, names))
            case Settled():
                if not any(self.agrees(step.assumes) for step in self.spec.urgent(here.state)) and all(
                    self.told(stream) for stream in here.streams
                ):
                    offers = [tuple(each for each in one.owed[-1:] if each.stays) for one in here.streams]
                    left = (evolve(one, owed=offer) for one, offer in zip(here.streams, offers, strict=True))
                    yield evolve(here, streams=tuple(left))

    def _bound(self, here: Configuration, ways: Iterable[list[tuple[int, Name]]]) -> Iterator[Configuration]:
        for pairs in ways:
            bound = here.bind(pairs)
            if bound:
                yield bound

    def may_skip(self, stream: Stream, messages: Iterable[Message]) -> bool:
        """Whether messages can be left out: they show nothing new, or later ones follow."""
        skips = self.spec.delivery(stream.topic).skips
        return all(one.optional or unchanged(stream, one) for one in messages) or (
            skips is not None and self.agrees([skips])
        )

    def told(self, stream: Stream) -> bool:
        """Whether the subscriber knows where things stand."""
        due = [one for one in stream.owed if not one.optional]
        if all(unchanged(stream, one) for one in due):
            return True
        return unchanged(stream, due[-1]) and self.may_skip(stream, due)

    def received(self, here: Configuration, event: Received, relations: tuple[str, ...]) -> Iterator[Configuration]:
        """The configurations in which a message shows what its stream owes, or what it showed last."""
        if event.channel in here.given_up:
            yield here
            return
        for at, stream in enumerate(here.streams):
            delivery = self.spec.delivery(stream.topic)
            echo = "equal" in relations and delivery.echoes is not None
            judged = [one for one in relations if not (one == "equal" and echo)]
            once_more = [delivery.repeats] if not echo else []
            once_more += [delivery.echoes] if not {"equal", "zero"}.isdisjoint(relations) else []
            if any(isinstance(right, Mismatch) or not self.agrees(right) for right in map(self.spec.sequence, judged)):
                continue
            shown: list[tuple[Message, tuple[Message, ...]]] = []
            if stream.last and any(again is not None and self.agrees([again]) for again in once_more):
                shown.append((stream.last, stream.owed))
            if not echo:
                shown += [
                    (one, stream.owed[index if one.stays else index + 1 :])
                    for index, one in enumerate(stream.owed)
                    if self.may_skip(stream, stream.owed[:index])
                ]
            for message, left in shown:
                matches = self.spec.matches(message.view, event.content)
                for match in () if isinstance(matches, Mismatch) else matches:
                    if self.agrees(match.assumes):
                        after = evolve(stream, last=evolve(message, optional=False, stays=False), owed=left)
                        streams = (*here.streams[:at], after, *here.streams[at + 1 :])
                        pairs = [(message.things[ref], event.names[to]) for ref, to in match.names]
                        yield from self._bound(evolve(here, streams=streams), [[(stream.thing, event.channel), *pairs]])


def unchanged(stream: Stream, message: Message) -> bool:
    """Whether a message shows what the stream showed last, so that its subscriber could not tell it."""
    return stream.last is not None and (message.view, message.things) == (stream.last.view, stream.last.things)


class BruteForce:
    """Where one observed conversation stands, in every world."""

    def __init__(self, spec: Spec, world: object, driven: Iterable[str] = ()) -> None:
        state = spec.initial(world)
        count = spec.names(state)
        start = frozenset({Configuration(state, tuple(range(count)), count)})
        letters = [[(one.id, letter) for letter in one.readings] for one in spec.ambiguities]
        self.worlds = {World(spec, driven, dict(choice)): start for choice in itertools.product(*letters)}
        self._closed: dict[World, set[Configuration]] | None = None
        self._numbers: dict[tuple[Name, Hashable], int] = {}

    @property
    def closed(self) -> dict[World, set[Configuration]]:
        """All that can be the case now."""
        if self._closed is None:
            self._closed = {world: world.closure(start) for world, start in self.worlds.items()}
        return self._closed

    def _relations(self, event: Event) -> tuple[str, ...]:
        if not isinstance(event, Received):
            return ()
        found = []
        for track, number in event.marks:
            before = self._numbers.get((event.channel, track))
            if number <= 0:
                found.append("zero" if number == 0 else "negative")
            elif before is None:
                found.append("first")
            else:
                found.append("equal" if number == before else "larger" if number > before else "smaller")
        return tuple(found)

    def after(self, event: Event) -> dict[World, frozenset[Configuration]]:
        """What the event would leave; worlds without any configuration are left out."""
        relations = self._relations(event)
        left = {
            world: frozenset(after for here in closed for after in world.observe(here, event, relations))
            for world, closed in self.closed.items()
        }
        return {world: start for world, start in left.items() if start}

    def explains(self, event: Event) -> bool:
        """Whether the event would leave anything."""
        relations = self._relations(event)
        return any(
            True
            for world, closed in self.closed.items()
            for here in closed
            for _ in world.observe(here, event, relations)
        )

    def observe(self, event: Event) -> bool:
        """Take an event into account; whether anything explains it."""
        self.worlds = self.after(event)
        self._closed = None
        if isinstance(event, Received):
            self._numbers |= {(event.channel, track): number for track, number in event.marks}
        return bool(self.worlds)

    @property
    def choices(self) -> set[tuple[str, ...]]:
        """The choices that are left, each as its letters in the order of the spec's ambiguities."""
        return {tuple(world.choice.values()) for world in self.worlds}
