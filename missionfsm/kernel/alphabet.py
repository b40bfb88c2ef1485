"""What is worth trying on a system: the requests, drives and worlds that exploration and generation draw from."""

from __future__ import annotations

from collections.abc import Callable

from attrs import Factory, field, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Name

ANY_NAME = "$name"
"""Stands in an input's params for a name that the tester picks: one seen so far, or a wrong one."""


def pick(kind: str, slot: int = 0) -> JSON:
    """Stands in params for a name of a kind that the tester picks: one seen so far, or a wrong one.

    Where one name is meant twice the slot is the same.
    """
    return {"$pick": kind, "slot": slot}


def new(kind: str) -> JSON:
    """Stands in params for a name of a kind that was never used."""
    return {"$new": kind}


def upcoming(kind: str) -> JSON:
    """Stands in params for the name that an implementation that counts would give next."""
    return {"$next": kind}


def member(key: str, of: JSON) -> JSON:
    """Stands in params for a member of what such a stand-in stands for, where names are objects."""
    return {"$member": key, "of": of}


def as_text(value: JSON) -> JSON:
    """Stands in params for the JSON text of a value that may hold such stand-ins."""
    return {"$text": value}


def _plainly(name: Name) -> JSON:
    return name[1] if isinstance(name, tuple) else name


def _made_up(kind: str, serial: int) -> Name:
    """Streams and connections have numbers, whatever a system names has a text."""
    return kind, serial if kind in ("stream", "connection") else f"{kind}-{serial}"


@frozen
class Naming:
    """How a tester writes names into params, and what names it may make up.

    A name is ``(kind, value)``.

    Attributes:
        write: a name to its JSON.
        make: (kind, serial number) to a name; the number is 0 for one that is never anything's.
        in_message: serial number to a name as messages carry it.
        given: serial number to a name that the reference gives out where its kind is not known.
    """

    write: Callable[[Name], JSON] = _plainly
    make: Callable[[str, int], Name] = _made_up
    in_message: Callable[[int], Name] = lambda serial: f"n{serial}"
    given: Callable[[int], Name] = lambda serial: f"name-{serial}"


@frozen(init=False)
class Bounds:
    """How far exploration goes: ``Bounds(2, goals=3)``.

    Attributes:
        size: how large a state may be at most, as the system's `Abstraction` counts; that is how many names it has,
            or how many missions are listed.
        own: other bounds of the system by name, such as how many goals a mission has at most.
    """

    size: int
    own: tuple[tuple[str, int], ...]

    def __init__(self, size: int = 2, **own: int) -> None:
        self.__attrs_init__(size, tuple(own.items()))

    def get(self, name: str, default: int = 2) -> int:
        """One of the system's own bounds."""
        return dict(self.own).get(name, default)

    def __str__(self) -> str:
        return ", ".join(f"{name} {most}" for name, most in (("size", self.size), *self.own))


@frozen
class Input:
    """One call worth trying: its method and the JSON of its params, with `ANY_NAME` where a name goes."""

    method: str
    params: JSON


@frozen
class ScriptStep:
    """One thing that is done in a script.

    `picks` says for each slot of the params which name goes there: the how-many-th of its kind that came up, from 0.
    """

    method: str
    params: JSON = None
    picks: tuple[tuple[int, int], ...] = ()


@frozen
class Alphabet:
    """What is worth trying.

    Attributes:
        inputs: calls, malformed ones included.
        core_inputs: those that bring the system on: few, well-formed, each with a meaning of its own; for exploration.
            All of them, where nothing is said; so for drives.
        drives: what to make happen, as JSON.
        core_drives: those among them that bring the system on.
        worlds: the worlds to try it in, as JSON, the usual one first.
        wrong_names: names that nothing has.
        scripts: conversations worth having in the usual world, whole.
        apart: others that are worth having in this world, and in worlds like it alone.
        look: a call that shows where things stand and changes nothing; systematic conversations ask it again and again.
    """

    inputs: tuple[Input, ...] = ()
    core_inputs: tuple[Input, ...] = field(default=Factory(lambda self: self.inputs, takes_self=True))
    drives: tuple[JSON, ...] = ()
    core_drives: tuple[JSON, ...] = field(default=Factory(lambda self: self.drives, takes_self=True))
    worlds: tuple[JSON, ...] = ({},)
    wrong_names: tuple[str, ...] = ()
    look: Input | None = None
    scripts: tuple[tuple[ScriptStep, ...], ...] = ()
    apart: tuple[tuple[ScriptStep, ...], ...] = ()
