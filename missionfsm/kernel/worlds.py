"""Worlds that are values of an attrs class: its attributes say which parameters there are, and what they may be."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from typing import get_args, get_origin, get_type_hints

from attrs import field, fields, frozen

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.shapes import BOOLEAN, TEXT
from missionfsm.kernel.terms import World
from missionfsm.kernel.text import brief

_NAME = {**TEXT, "minLength": 1}
_TEXTS = {"type": "array", "items": TEXT}


@frozen
class WorldForm:
    """The JSON of worlds: each attribute of a class is a parameter, with its name in camel case, and has a default.

    Attributes may be non-empty texts, truth values, members of an enum, and tuples of texts. An attribute that is None
    is left out; it is written as null if its default is something else.

    Attributes:
        kind: the class.
        without: names of attributes that are no parameters.
        parameters: each parameter with its attribute, and the type of that.
        untold: the parameters that may be null, since their attributes may be None but have another default.
    """

    kind: type
    without: tuple[str, ...] = ()
    parameters: Mapping[str, tuple[str, type]] = field(init=False)
    untold: frozenset[str] = field(init=False)

    def __attrs_post_init__(self) -> None:
        hints = get_type_hints(self.kind)
        names = (one.name for one in fields(self.kind) if one.name not in self.without)
        found = {_camel(name): (name, _told(hints[name])) for name in names}
        object.__setattr__(self, "parameters", found)
        defaults = {one.name: one.default for one in fields(self.kind)}
        untold = (
            name
            for name, (attribute, _) in found.items()
            if type(None) in get_args(hints[attribute]) and defaults[attribute] is not None
        )
        object.__setattr__(self, "untold", frozenset(untold))

    @property
    def members(self) -> dict[str, Mapping[str, JSON]]:
        """JSON Schemas of the parameters."""
        found = {name: _schema(kind) for name, (_, kind) in self.parameters.items()}
        return found | {name: {"anyOf": [dict(found[name]), {"type": "null"}]} for name in self.untold}

    def attributes(self, given: JSON) -> dict[str, object]:
        """The attributes that some parameters set. Raises UnreadableError for an unknown parameter or a wrong value."""
        given = {} if given is None else given
        if not isinstance(given, dict):
            raise UnreadableError(f"world: {brief(given)} is not an object")
        known, found = self.parameters, {}
        for name, value in given.items():
            if name not in known:
                raise UnreadableError(f"world.{name}: there is no such field; there are {', '.join(known)}")
            attribute, kind = known[name]
            null = value is None and name in self.untold
            found[attribute] = None if null else _read(value, kind, f"world.{name}")
        return found

    def read(self, given: JSON) -> World:
        """The world with some parameters; the others have their defaults."""
        return self.kind(**self.attributes(given))

    def write(self, world: World) -> JSON:
        """The parameters of a world."""
        values = {name: getattr(world, attribute) for name, (attribute, _) in self.parameters.items()}
        return {name: _written(value) for name, value in values.items() if value is not None or name in self.untold}


def _camel(name: str) -> str:
    first, *rest = name.split("_")
    return "".join((first, *map(str.capitalize, rest)))


def _told(hint: type) -> type:
    """The type of an attribute that is not None: a text for a text or None, a tuple for a tuple of texts."""
    if type(None) in get_args(hint):
        hint = next(one for one in get_args(hint) if one is not type(None))
    return get_origin(hint) or hint


def _schema(kind: type) -> Mapping[str, JSON]:
    if kind is bool:
        return BOOLEAN
    if kind is str:
        return _NAME
    return {"enum": [one.value for one in kind]} if issubclass(kind, enum.Enum) else _TEXTS


def _read(value: JSON, kind: type, where: str) -> object:
    if issubclass(kind, enum.Enum):
        if value not in [one.value for one in kind]:
            raise UnreadableError(f"{where}: {brief(value)} is none of {', '.join(one.value for one in kind)}")
        return kind(value)
    if kind is bool:
        if not isinstance(value, bool):
            raise UnreadableError(f"{where}: {brief(value)} is not true or false")
        return value
    if kind is str:
        if not isinstance(value, str) or not value:
            raise UnreadableError(f"{where}: {brief(value)} is not a text with something in it")
        return value
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise UnreadableError(f"{where}: {brief(value)} is not a list of texts")
    return tuple(value)


def _written(value: object) -> JSON:
    if isinstance(value, enum.Enum):
        return value.value
    return list(value) if isinstance(value, tuple) else value
