"""Which states a search and an exploration treat as equal, since not all of them can be looked at."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from typing import Protocol

from attrs import frozen

from missionfsm.kernel.step import Step
from missionfsm.kernel.terms import Code, Incident, Request, State


class Shortcut(Protocol):
    """Every step of a system within bounds, on codes that stand for its states."""

    def encode(self, state: State, /) -> Code:
        """The code of a state."""

    def decode(self, code: Code, /) -> State:
        """The state with a code."""

    def successors(self, code: Code, /) -> list[Code]:
        """The codes after every step, in any order and perhaps some twice."""


class Compiled(Protocol):
    """What makes a `Shortcut`."""

    def __call__(
        self,
        requests: Iterable[tuple[Request, tuple[bool, ...]]],
        events: Iterable[Incident],
        assumed: int,
        most: int,
        /,
        *,
        forget_ended: bool = False,
    ) -> Shortcut:
        """The steps of some requests and events, under some readings.

        Args:
            requests: each with a flag for each of its names, whether it may be that of something in the state.
            events: the events.
            assumed: the readings that are possible.
            most: how large a state may be (see `Abstraction.explore_size`).
            forget_ended: whether ended things are only counted.
        """


@frozen
class Abstraction:
    """Which states a search and an exploration treat as equal, and how large they take states to be.

    It decides where they look, and does not change what a system does.

    Attributes:
        enabled_key: state → its key. In states with the same key, the same calls have the same outcomes, and the same
            events happen in the same ways.
        search_key: state → its key for a search; coarser than `enabled_key` if that has too many values.
        idle_search_key: the same for actions that change nothing; None if it is `search_key`.
        rules_key: state → its key for what the rules say to a call, and whether that changes anything; None if it is
            `search_key`.
        phase: state → the phase of its lifecycle; actions that are seldom done are counted by phase.
        name_key: (state, position of a name) → the key of the name for a search.
        search_size: state → its size for a search, which `Bounds.size` limits; None if it is the number of its names.
        explore_size: the same for an exploration.
        canonical: state → the state that stands for it in an exploration: without the times and the readings that it
            remembers, since every step may follow any reading. None if states remember neither.
        forget_ended: state → the state that stands for it if ended things are only counted.
        indistinct: step → the step that stands for all steps after which nobody can ever tell the difference; None if
            nothing of a state stays hidden for good.
        compiled: what computes the steps of the system faster. Of states that go on in the same ways it may keep one.
    """

    enabled_key: Callable[[State], Hashable] = lambda state: state
    search_key: Callable[[State], Hashable] = lambda state: state
    idle_search_key: Callable[[State], Hashable] | None = None
    rules_key: Callable[[State], Hashable] | None = None
    phase: Callable[[State], Hashable] = lambda _: None
    name_key: Callable[[State, int | None], Hashable] = lambda _, ref: ref
    search_size: Callable[[State], int] | None = None
    explore_size: Callable[[State], int] | None = None
    canonical: Callable[[State], State] | None = None
    forget_ended: Callable[[State], State] | None = None
    indistinct: Callable[[Step], Step] | None = None
    compiled: Compiled | None = None
