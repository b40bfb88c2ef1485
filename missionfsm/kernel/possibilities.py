"""What some state has to come to, said of each of several values at once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable

from missionfsm.kernel.spec import Invariant
from missionfsm.kernel.terms import State


def each_met(
    values: Iterable[Hashable], met: Callable[[State], Iterable[Hashable]], name: str, says: str
) -> tuple[Invariant, ...]:
    """A possibility for each of some values, such as the states of a chart: that a state of the system has it.

    Args:
        values: texts, or members of an enum.
        met: state → the values that it has.
        name: what the possibilities are called, with `{}` for the value in lower case: ``a-mission-is-{}``.
        says: what they say, with `{}` for the value: ``Some mission is {}.``
    """

    def possibility(value: Hashable) -> Invariant:
        text = str(getattr(value, "name", value))
        return Invariant(name.format(text.lower()), says.format(text), lambda state: value in met(state))

    return tuple(map(possibility, values))
