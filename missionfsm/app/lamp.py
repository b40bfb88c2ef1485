"""A lamp with a timer: what ``missionfsm new`` writes for a start. Put your own page in the place of the manual's."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from attrs import frozen

from missionfsm.kernel.language import (
    FAILED_PRECONDITION,
    Ambiguity,
    Codec,
    Document,
    Drive,
    Happening,
    Operation,
    Spec,
    Step,
    System,
    every_state,
    promise,
    reads,
    refusal,
    shown_whole,
)

NAME = "lamp"
PAGE = Document("Lamp", "The lamp's manual")

# What the page leaves open: the first reading is the one that the reference follows.

DIM = Ambiguity("LA-01", "What does Dim do to a light that is dim?", {"a": "it is full again", "b": "nothing"})


@frozen
class Lamp:
    """How the light is: all that a lamp remembers, and all that a message shows."""

    light: Literal["off", "dim", "on"]


# What the page refuses, and what it promises to those who watch.


@refusal(FAILED_PRECONDITION, cite=PAGE["Dim", "Errors"])
def there_is_no_light(lamp: Lamp, _: str) -> bool:
    """The light is off, and only light can be dimmed."""
    return lamp.light == "off"


SHOWN = promise("the-light-is-shown", "A stream shows the light at once, then every change.", cite=PAGE["Watch"])

# What happens where nothing refuses.


def switch(lamp: Lamp, *_: object) -> Iterator[Step]:
    """There was light, or there is light now."""
    yield Step(Lamp("on" if lamp.light == "off" else "off"))


def dim(lamp: Lamp, *_: object) -> Iterator[Step]:
    """Full light becomes dim; what becomes of dim light is LA-01."""
    if lamp.light == "on":
        yield Step(Lamp("dim"))
    else:
        yield Step(Lamp("on"), assumes=(DIM["a"],))
        yield Step(lamp, assumes=(DIM["b"],))


def time_is_up(lamp: Lamp, *_: object) -> tuple[Step, ...]:
    """The timer turns the light off: a tester may be able to make that happen, and it happens by itself as well."""
    return () if lamp.light == "off" else (Step(Lamp("off"), label="the time is up"),)


SPEC = Spec(
    NAME,
    title="a lamp with a timer",
    initial=lambda _world: Lamp("off"),
    operations=[
        Operation("Switch", PAGE["Switch"], effect=switch),
        Operation("Dim", PAGE["Dim"], refusals=[there_is_no_light], effect=dim),
        Operation("Watch", PAGE["Watch"], streaming=True),
    ],
    drives=[Drive("timeIsUp", time_is_up, by_itself=(Happening("timeIsUp"),))],
    ambiguities=(DIM,),
)
CODEC = Codec(read_content=reads(Lamp))
SYSTEM = System(NAME, shown_whole(SPEC, SHOWN), CODEC, sketches=(every_state(SPEC),))
