"""JSON as values of attrs classes, whose annotations say what is right: `cattrs` reads them, strictly."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Literal, get_args, get_origin

import cattrs
from attrs import has
from cattrs import transform_error
from cattrs.gen import make_dict_structure_fn

from missionfsm.kernel.codec import JSON, Malformed
from missionfsm.kernel.text import brief

_CONVERTER = cattrs.Converter()


def _strictly(*kinds: type) -> Callable[[JSON, object], JSON]:
    """A value is what it is: no text is a number, and neither is a truth value."""

    def read(value: JSON, _: object) -> JSON:
        if type(value) in kinds:
            return value
        raise TypeError(f"{brief(value)} is no {kinds[-1].__name__}")

    return read


def _one_of(value: JSON, kind: type) -> JSON:
    choices = get_args(kind)
    if isinstance(value, Hashable) and value in choices:
        return value
    raise ValueError(f"{brief(value)} is none of {', '.join(map(str, choices))}")


def _sequence(value: JSON, kind: type) -> tuple[object, ...]:
    if not isinstance(value, list):
        raise TypeError(f"{brief(value)} is no list")
    return tuple(_CONVERTER.structure(one, get_args(kind)[0]) for one in value)


def _object(kind: type) -> Callable[[JSON, object], object]:
    structure: Callable[[JSON, type], object] = make_dict_structure_fn(kind, _CONVERTER)

    def read(value: JSON, _: object) -> object:
        if not isinstance(value, dict):
            raise TypeError(f"{brief(value)} is no object")
        return structure(value, kind)

    return read


def _is(form: object) -> Callable[[object], bool]:
    return lambda kind: get_origin(kind) is form


_CONVERTER.register_structure_hook(str, _strictly(str))
_CONVERTER.register_structure_hook(bool, _strictly(bool))
_CONVERTER.register_structure_hook(int, _strictly(int))
_CONVERTER.register_structure_hook(float, _strictly(int, float))
_CONVERTER.register_structure_hook_func(_is(Literal), _one_of)
_CONVERTER.register_structure_hook_func(_is(tuple), _sequence)
_CONVERTER.register_structure_hook_factory(has, _object)


def reads(kind: type[Hashable]) -> Callable[[JSON], Hashable]:
    """What reads JSON as values of a class; what is not of its form becomes `Malformed`, with every reason why.

    Attributes are texts, numbers, truth values, a ``Literal`` of some texts, other such classes, or a tuple of any
    number of those. One with a default may be missing; what the class does not have means nothing. A name, which
    stands beside the value, is ``"-"``.
    """

    def read(value: JSON) -> Hashable:
        try:
            return _CONVERTER.structure(value, kind)
        except (cattrs.BaseValidationError, TypeError) as error:
            return Malformed("; ".join(transform_error(error, format_exception=_says)))

    return read


def _says(error: BaseException, _: type | None) -> str:
    return f"{error.args[0]} is missing" if isinstance(error, KeyError) else str(error)
