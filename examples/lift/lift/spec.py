"""What the page in README.md says, sentence by sentence: refusals, steps, what is shown."""

from __future__ import annotations

from collections.abc import Iterator

from attrs import evolve, frozen

from missionfsm.kernel.language import (
    DEADLINE_EXCEEDED,
    FAILED_PRECONDITION,
    INVALID_ARGUMENT,
    NAMED,
    NOT_FOUND,
    RESOURCE_EXHAUSTED,
    Ambiguity,
    Document,
    Drive,
    Failure,
    Happening,
    Invariant,
    Operation,
    Refs,
    Spec,
    Step,
    promise,
    refusal,
    shown_whole,
)

NAME = "lift"
PAGE = Document("Lift", "The lift's manual")
FLOORS = range(4)
MAX_WAITING = 3

UNDER_WAY = Ambiguity(
    "L-01",
    "What does Cancel do to the ride that is under way?",
    {"a": "it is refused", "b": "the lift gives it up, and the next one is its turn"},
    "a",
)
SAME_FLOOR = Ambiguity(
    "L-02",
    "What does Call do where a ride to that floor waits already?",
    {"a": "it makes another ride", "b": "it answers with the one that waits"},
    "a",
)

# The state, which is also what a message shows. The names of the rides are not in it: they stand beside it, and are
# referred to by their places.


@frozen
class Ride:
    """One ride: `NAMED` in the place of its name, and the floor that it goes to."""

    ride: str
    floor: int


@frozen
class Lift:
    """Rides in the order of their calls; `moving` says that the first is under way."""

    rides: tuple[Ride, ...]
    moving: bool

    @property
    def waiting(self) -> tuple[Ride, ...]:
        """The rides that are not under way."""
        return self.rides[self.moving :]


@frozen
class Asked:
    """A request: `floor` is None for one that is none; `at` is the place of the ride that is named, if it is there."""

    operation: str
    floor: int | None = None
    at: int | None = None


# What it refuses.


@refusal(INVALID_ARGUMENT, cite=PAGE["Call", "Errors"])
def there_is_no_such_floor(_: Lift, asked: Asked) -> bool:
    """The building has no such floor."""
    return asked.floor is None


@refusal(RESOURCE_EXHAUSTED, cite=PAGE["Call", "Errors"])
def enough_rides_wait(lift: Lift, _: Asked) -> bool:
    """Three rides wait already."""
    return len(lift.waiting) >= MAX_WAITING


@refusal(NOT_FOUND, cite=PAGE["Cancel", "Errors"])
def there_is_no_such_ride(_: Lift, asked: Asked) -> bool:
    """No ride of that name waits or is under way."""
    return asked.at is None


@refusal(FAILED_PRECONDITION, cite=PAGE["Cancel", "Errors"], assumes=UNDER_WAY["a"])
def the_ride_is_under_way(lift: Lift, asked: Asked) -> bool:
    """The ride is under way, and only one that waits can be cancelled (L-01)."""
    return lift.moving and asked.at == 0


QUEUED = promise(
    "a-ride-is-queued", "A ride that is called is the last of those that wait.", cite=PAGE["Call"]
).registered(NAME, "Call")
SHARED = promise(
    "a-ride-is-shared", "A second call to a floor is answered with the ride there (L-02).", cite=PAGE["Call"]
).registered(NAME, "Call")
TAKEN_OFF = promise("a-ride-is-cancelled", "A ride that is cancelled is there no more.", cite=PAGE["Cancel"])
WATCHED = promise(
    "the-rides-are-shown", "Whoever watches is shown all rides at once, then every change.", cite=PAGE["Watch"]
)
SHOWN = promise("rides-are-shown-in-order", "Rides are shown as they are, in the order of calls.", cite=PAGE["Watch"])
DEPARTS = promise(
    "the-lift-departs", "An idle lift departs at once for the ride that waits longest.", cite=PAGE["Rides"]
).registered(NAME)
ARRIVES = promise("a-ride-ends", "With the arrival at its floor a ride ends.", cite=PAGE["Rides"]).registered(NAME)

# What happens where nothing refuses.


def called(lift: Lift, asked: Asked, _: Refs) -> Iterator[Step]:
    """A ride is added; or, as L-02 can be read, the one to that floor is found."""
    ride = Ride(NAMED, asked.floor or FLOORS[0])  # one without a floor is refused
    names = tuple(range(len(lift.rides) + 1))
    after = evolve(lift, rides=(*lift.rides, ride))
    waits = ride in lift.waiting
    assumes = (SAME_FLOOR["a"],) if waits else ()
    yield Step(after, names=names, refs=names[-1:], rules=(QUEUED.id,), assumes=assumes, kinds=("ride",))
    if waits:
        there = lift.rides.index(ride, int(lift.moving))
        yield Step(lift, refs=(there,), rules=(SHARED.id,), assumes=(SAME_FLOOR["b"],))


def cancelled(lift: Lift, asked: Asked, _: Refs) -> Iterator[Step]:
    """A ride is taken off; if it was under way, the lift is idle."""
    kept = tuple(place for place in range(len(lift.rides)) if place != asked.at)
    yield Step(Lift(tuple(lift.rides[place] for place in kept), lift.moving and asked.at != 0), names=kept)


OPERATIONS = (
    Operation(
        "Call",
        PAGE["Call"],
        refusals=[there_is_no_such_floor, enough_rides_wait],
        promises=[QUEUED, SHARED],
        effect=called,
        failures=[DEADLINE_EXCEEDED],
    ),
    Operation(
        "Cancel",
        PAGE["Cancel"],
        refusals=[there_is_no_such_ride, the_ride_is_under_way],
        promises=[TAKEN_OFF],
        effect=cancelled,
        failures=[DEADLINE_EXCEEDED],
    ),
    Operation("Watch", PAGE["Watch"], promises=[WATCHED], streaming=True),
)


def departs(lift: Lift) -> tuple[Step, ...]:
    """What must have happened once things have settled: an idle lift has departed if a ride waits."""
    if lift.moving or not lift.rides:
        return ()
    return (Step(evolve(lift, moving=True), rules=(DEPARTS.id,), label="departs"),)


def arrives(lift: Lift, _event: Happening, _refs: Refs) -> tuple[Step, ...]:
    """The lift arrives at the floor of the ride that is under way."""
    if not lift.moving:
        return ()
    left = tuple(range(1, len(lift.rides)))
    return (Step(Lift(lift.rides[1:], moving=False), names=left, rules=(ARRIVES.id,), label="arrives"),)


def fails(asked: Asked, code: str) -> Failure | None:
    """A call whose deadline passes may take effect all the same, at once or later."""
    late = code == DEADLINE_EXCEEDED and asked.operation != "Watch"
    return Failure(open_ended=True) if late else None


def describe(thing: object) -> str:
    """A request, an event or a state in a few words."""
    if isinstance(thing, Asked):
        return thing.operation if thing.operation != "Call" else f"Call({'?' if thing.floor is None else thing.floor})"
    if not isinstance(thing, Lift):
        return str(thing)
    rides = ", ".join(f"to {one.floor}" for one in thing.rides) or "none"
    return f"rides {rides}; the lift is {'moving' if thing.moving else 'idle'}"


LIFT = Spec(
    system=NAME,
    title="a lift",
    initial=lambda _world: Lift((), moving=False),
    operations=OPERATIONS,
    placed=lambda asked, refs: evolve(asked, at=refs[0] if refs else None),
    drives=[Drive("arrive", arrives, by_itself=(Happening("arrive"),))],
    urgent=departs,
    names=lambda lift: len(lift.rides),
    failing=fails,
    ambiguities=(UNDER_WAY, SAME_FLOOR),
    describe=describe,
    rules=(DEPARTS, ARRIVES),
    invariants=(
        Invariant("no-more-wait-than-may", "At most three rides wait.", lambda lift: len(lift.waiting) <= MAX_WAITING),
        Invariant(
            "who-moves-has-a-ride", "A lift that moves has a ride.", lambda lift: bool(lift.rides) or not lift.moving
        ),
    ),
    possibilities=(
        Invariant("all-may-wait", "Three rides wait and one is under way.", lambda lift: len(lift.rides) > MAX_WAITING),
    ),
)

# Every change is owed to all who watch, with the names of all rides.

SPEC = shown_whole(LIFT, SHOWN)
