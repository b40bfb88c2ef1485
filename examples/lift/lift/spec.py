"""What the page in README.md says, sentence by sentence: refusals, steps, what is shown."""

from __future__ import annotations

from attrs import evolve, frozen

from missionfsm.kernel.language import (
    DEADLINE_EXCEEDED,
    FAILED_PRECONDITION,
    INVALID_ARGUMENT,
    NOT_FOUND,
    OK,
    RESOURCE_EXHAUSTED,
    Ambiguity,
    Answer,
    Decision,
    Delivery,
    Document,
    Drive,
    Emission,
    Failure,
    Happening,
    Invariant,
    Match,
    Mismatch,
    Opening,
    Operation,
    Spec,
    Step,
    decide,
    promise,
    refusal,
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

# The state: the floors of all rides, the first called first, and whether the first of them is under way. The names of
# the rides are not in it; they are referred to by their places.


@frozen
class Lift:
    """Rides in the order of their calls; `moving` says that the first is under way."""

    floors: tuple[int, ...] = ()
    moving: bool = False

    @property
    def waiting(self) -> tuple[int, ...]:
        """The floors of the rides that are not under way."""
        return self.floors[self.moving :]


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


QUEUED = promise("a-ride-is-queued", "A ride that is called is the last of those that wait.", cite=PAGE["Call"])
SHARED = promise(
    "a-ride-is-shared", "A second call to a floor is answered with the ride there (L-02).", cite=PAGE["Call"]
)
TAKEN_OFF = promise("a-ride-is-cancelled", "A ride that is cancelled is there no more.", cite=PAGE["Cancel"])
WATCHED = promise(
    "the-rides-are-shown", "Whoever watches is shown all rides at once, then every change.", cite=PAGE["Watch"]
)
SHOWN = promise(
    "rides-are-shown-in-order", "Rides are shown as they are, in the order of calls.", cite=PAGE["Watch"]
).registered(NAME)
DEPARTS = promise(
    "the-lift-departs", "An idle lift departs at once for the ride that waits longest.", cite=PAGE["Rides"]
).registered(NAME)
ARRIVES = promise("a-ride-ends", "With the arrival at its floor a ride ends.", cite=PAGE["Rides"]).registered(NAME)

OPERATIONS = {
    operation.name: operation
    for operation in (
        Operation.with_rules(
            "Call",
            NAME,
            PAGE["Call"],
            refusals=[there_is_no_such_floor, enough_rides_wait],
            promises=[QUEUED, SHARED],
            failures=[DEADLINE_EXCEEDED],
        ),
        Operation.with_rules(
            "Cancel",
            NAME,
            PAGE["Cancel"],
            refusals=[there_is_no_such_ride, the_ride_is_under_way],
            promises=[TAKEN_OFF],
            failures=[DEADLINE_EXCEEDED],
        ),
        Operation.with_rules("Watch", NAME, PAGE["Watch"], promises=[WATCHED], streaming=True),
    )
}

# What happens where nothing refuses. Every change is owed to all who watch: the view, and the names of all rides.


def shown(lift: Lift) -> tuple[Emission, ...]:
    """The message that a change owes."""
    return (Emission("rides", lift),)


def called(lift: Lift, asked: Asked, one: Decision) -> tuple[Step, ...]:
    """A ride is added; or, as L-02 can be read, the one to that floor is found."""
    floor = asked.floor if asked.floor is not None else FLOORS[0]  # one without a floor is refused
    after = evolve(lift, floors=(*lift.floors, floor))
    names = tuple(range(len(after.floors)))
    waits = floor in lift.waiting
    added = Step(
        after,
        names=names,
        emits=shown(after),
        answer=Answer(OK),
        refs=names[-1:],
        rules=(f"{NAME}/Call/{QUEUED.name}",),
        assumes=(*one.assumes, *((SAME_FLOOR["a"],) if waits else ())),
        kinds=("ride",),
    )
    if not waits:
        return (added,)
    there = lift.floors.index(floor, int(lift.moving))
    found = Step(
        lift,
        answer=Answer(OK),
        refs=(there,),
        rules=(f"{NAME}/Call/{SHARED.name}",),
        assumes=(*one.assumes, SAME_FLOOR["b"]),
    )
    return added, found


def cancelled(lift: Lift, asked: Asked, one: Decision) -> tuple[Step, ...]:
    """A ride is taken off; if it was under way, the lift is idle."""
    kept = tuple(place for place in range(len(lift.floors)) if place != asked.at)
    after = Lift(tuple(lift.floors[place] for place in kept), lift.moving and asked.at != 0)
    rules = (f"{NAME}/Cancel/{TAKEN_OFF.name}",)
    return (Step(after, names=kept, emits=shown(after), answer=Answer(OK), rules=rules, assumes=one.assumes),)


def watched(lift: Lift, _: Asked, one: Decision) -> tuple[Step, ...]:
    """A stream is opened; its name comes after those of the rides."""
    stream, rides = len(lift.floors), tuple(range(len(lift.floors)))
    opens = Opening("rides", stream, (Emission("rides", lift, rides),))
    rules = (f"{NAME}/Watch/{WATCHED.name}",)
    return (Step(lift, opens=(opens,), answer=Answer(OK), refs=(stream,), rules=rules, assumes=one.assumes),)


EFFECTS = {"Call": called, "Cancel": cancelled, "Watch": watched}


def outcomes(lift: Lift, asked: Asked, refs: tuple[int | None, ...]) -> tuple[Step, ...]:
    """Every answer that the page allows to a call in a state, with the state after it."""
    asked = evolve(asked, at=refs[0] if refs else None)
    steps: list[Step] = []
    for one in decide(OPERATIONS[asked.operation].blocking(lift, asked)):
        if one.code:
            rules = tuple(rule.id for rule in one.rules)
            steps.append(Step(lift, answer=Answer(one.code), rules=rules, assumes=one.assumes))
        else:
            steps += EFFECTS[asked.operation](lift, asked, one)
    return tuple(steps)


def departs(lift: Lift) -> tuple[Step, ...]:
    """What must have happened once things have settled: an idle lift has departed if a ride waits."""
    if lift.moving or not lift.floors:
        return ()
    after = evolve(lift, moving=True)
    return (Step(after, emits=shown(after), rules=(DEPARTS.id,), label="departs"),)


def arrives(lift: Lift, _event: Happening, _refs: object) -> tuple[Step, ...]:
    """The lift arrives at the floor of the ride that is under way."""
    if not lift.moving:
        return ()
    after = Lift(lift.floors[1:])
    names = tuple(range(1, len(lift.floors)))
    return (Step(after, names=names, emits=shown(after), rules=(ARRIVES.id,), label="arrives"),)


def fails(asked: Asked, code: str) -> Failure | None:
    """A call whose deadline passes may take effect all the same, at once or later."""
    late = code == DEADLINE_EXCEEDED and asked.operation != "Watch"
    return Failure(open_ended=True) if late else None


def matches(view: Lift, content: object) -> tuple[Match, ...] | Mismatch:
    """A message shows a state if it says the same of it, ride by ride."""
    if view == content:
        return (Match(names=tuple((place, place) for place in range(len(view.floors)))),)
    return Mismatch(SHOWN.id, f"it shows {describe(content)}, and due is {describe(view)}")


def describe(thing: object) -> str:
    """A request, an event or a state in a few words."""
    if isinstance(thing, Asked):
        return thing.operation if thing.operation != "Call" else f"Call({'?' if thing.floor is None else thing.floor})"
    if not isinstance(thing, Lift):
        return thing.name if isinstance(thing, Happening) else str(thing)
    rides = ", ".join(f"to {floor}" for floor in thing.floors) or "none"
    return f"rides {rides}; the lift is {'moving' if thing.moving else 'idle'}"


SPEC = Spec(
    system=NAME,
    title="a lift",
    initial=lambda _world: Lift(),
    operations=OPERATIONS,
    outcomes=outcomes,
    drives=[Drive("arrive", arrives, by_itself=(Happening("arrive"),))],
    urgent=departs,
    matches=matches,
    delivery=lambda _topic: Delivery(unowed=(SHOWN.id,), named=(SHOWN.id,)),
    names=lambda lift: len(lift.floors),
    failing=fails,
    ambiguities=(UNDER_WAY, SAME_FLOOR),
    describe=describe,
    rules=(SHOWN, DEPARTS, ARRIVES),
    invariants=(
        Invariant("no-more-wait-than-may", "At most three rides wait.", lambda lift: len(lift.waiting) <= MAX_WAITING),
        Invariant(
            "who-moves-has-a-ride", "A lift that moves has a ride.", lambda lift: bool(lift.floors) or not lift.moving
        ),
    ),
    possibilities=(
        Invariant(
            "all-may-wait", "Three rides wait and one is under way.", lambda lift: len(lift.floors) > MAX_WAITING
        ),
    ),
)
