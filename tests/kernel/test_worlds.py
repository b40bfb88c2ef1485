"""What the kernel makes of a class of worlds and of the forms of drives: JSON in and out, and its schemas."""

from __future__ import annotations

import enum
from typing import Any

import pytest
from attrs import frozen

from missionfsm.kernel.codec import Codec, DriveForm, Happening, UnreadableError
from missionfsm.kernel.spec import Drive, Spec
from missionfsm.kernel.system import System
from missionfsm.kernel.worlds import WorldForm


class Colour(enum.Enum):
    RED = "red"
    BLUE = "blue"


@frozen
class Room:
    wall_colour: Colour = Colour.RED
    owner: str | None = None
    doors: tuple[str, ...] = ("front",)
    locked: bool = False
    secret: int = 0


FORM = WorldForm(Room, without=("secret",))
SIZES = DriveForm(
    lambda given: (("grows", given["by"]), ()), lambda event, _: {"by": event.by}, {"by": {"type": "integer"}}, ("by",)
)


def test_a_world_is_read_and_written_by_its_attributes() -> None:
    """What is left out has its default, what is None is not told, and what is written is read again."""
    assert FORM.read({}) == FORM.read(None) == Room()
    assert FORM.write(Room()) == {"wallColour": "red", "doors": ["front"], "locked": False}
    blue = Room(Colour.BLUE, "Ann", (), locked=True)
    assert FORM.read(FORM.write(blue)) == blue


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ([], r"world: \[\] is not an object"),
        ({"secret": 1}, "world.secret: there is no such field; there are wallColour, owner, doors, locked"),
        ({"wallColour": "green"}, "world.wallColour: 'green' is none of red, blue"),
        ({"owner": ""}, "world.owner: '' is not a text with something in it"),
        ({"doors": "front"}, "world.doors: 'front' is not a list of texts"),
        ({"locked": 1}, "world.locked: 1 is not true or false"),
    ],
)
def test_what_is_no_world_is_refused(given: Any, says: str) -> None:
    """One line says which parameter is wrong, and what it may be."""
    with pytest.raises(UnreadableError, match=f"^{says}$"):
        FORM.read(given)


def test_the_schemas_of_parameters_are_those_of_the_attributes() -> None:
    """An enum is one of its values, a text has something in it."""
    assert FORM.members == {
        "wallColour": {"enum": ["red", "blue"]},
        "owner": {"type": "string", "minLength": 1},
        "doors": {"type": "array", "items": {"type": "string"}},
        "locked": {"type": "boolean"},
    }


def test_a_system_describes_its_drives() -> None:
    """Those with a form have its members; the others are but a name, and so they are read."""
    spec = Spec(
        "toy", title="a toy", initial=Room, drives=(Drive("grows", lambda *_: ()), Drive("stops", lambda *_: ()))
    )
    toy = System("toy", spec, Codec(drives={"grows": SIZES}))
    assert toy.codec.read_drive({"event": "grows", "by": 2}) == (("grows", 2), ())
    assert toy.codec.read_drive({"event": "stops"}) == (Happening("stops"), ())
    assert toy.codec.write_drive(Happening("stops")) == {"event": "stops"}
    assert {name: (one["properties"], one["required"]) for name, one in toy.shapes().drives.items()} == {
        "grows": ({"event": {"const": "grows"}, "by": {"type": "integer"}}, ["event", "by"]),
        "stops": ({"event": {"const": "stops"}}, ["event"]),
    }
    with pytest.raises(UnreadableError, match=r"^drive.event: 'flies' is not a drive; those are grows, stops$"):
        toy.codec.read_drive({"event": "flies"})
