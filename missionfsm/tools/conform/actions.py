"""What a tester does, as values: in a form that can be done again with a fresh instance, and with some of it left out.

Names are not in it: an action refers to a name by the action that was answered with it.
"""

from __future__ import annotations

from attrs import frozen

from missionfsm.kernel.alphabet import ANY_NAME, Input, pick
from missionfsm.kernel.codec import JSON

WRONG_NAME = "no-such-name"
"""A name that nothing has."""

SETTLE = "settle"
CANCEL = Input("cancel", {"stream": pick("stream")})
"""To give up a stream; every system that has streams has it."""


@frozen
class NameRef:
    """A name, as the position-th that the action with a serial number was answered with."""

    by: int
    position: int


Bindings = tuple[tuple[int, NameRef], ...]
"""For slots of a template the names that are meant."""


@frozen
class Action:
    """Something that a tester does.

    Attributes:
        serial: tells it from the others of its conversation; below 0 where the tester only waited, for itself.
        method: a documented call, or ``drive``, ``settle``, ``cancel``.
        params: its JSON, with `ANY_NAME` where `name` goes.
        name: the name that is meant: one that was given, or a text that nothing is called.
        picks: for each slot of the params (see `missionfsm.kernel.alphabet.pick`) the name that was given; a slot that
            is not here gets a name that is never anything's.
    """

    serial: int
    method: str
    params: JSON = None
    name: NameRef | str | None = None
    picks: Bindings = ()


def length(actions: tuple[Action, ...] | list[Action]) -> int:
    """How many things are done; to wait is none."""
    return sum(action.method != SETTLE for action in actions)


def filled(params: JSON, name: object) -> JSON:
    """Params with a name in place of every `ANY_NAME`."""
    if params == ANY_NAME:
        return name
    if isinstance(params, dict):
        return {key: filled(value, name) for key, value in params.items()}
    return [filled(value, name) for value in params] if isinstance(params, list) else params
