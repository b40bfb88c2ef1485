"""How a system puts things away that decide nothing any more, while nobody sees or names them."""

from __future__ import annotations

from collections.abc import Callable

from attrs import frozen

from missionfsm.kernel.terms import Request, State


@frozen
class Shelving:
    """Things at the front of the names of a state decide nothing but that there are some; one can stand for them.

    Steps leave them where they are, or forget all of them at once.

    Attributes:
        front: state → how many such things there are.
        things: (state, how many) → the first of them.
        shelf: state → the number of the shelf for which the first of them stands; None where it is what it is.
        put: (state, how many, number) → the state in which one thing stands for the first of them, which are put on the
            shelf with that number. It has the name of the last of them.
        brought: (state, things) → the state with these in the place of the one that stands for them.
        asks: request → whether its outcomes depend on which of them there are.
    """

    front: Callable[[State], int]
    things: Callable[[State, int], tuple[State, ...]]
    shelf: Callable[[State], int | None]
    put: Callable[[State, int, int], State]
    brought: Callable[[State, tuple[State, ...]], State]
    asks: Callable[[Request], bool]
