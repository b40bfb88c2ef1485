"""How states are told apart where not all of them can be looked at: by a search, and by an exploration."""

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
        """The steps that some requests and events take, under some readings.

        Args:
            requests: each with what may be the name of something there, of each of its names.
            events: what may happen.
            assumed: the readings that are possible.
            most: how large a state may be (see `Abstraction.explore_size`).
            forget_ended: what has ended is only counted.
        """


@frozen
class Abstraction:
    """How a search and an exploration look at states: which they tell apart, and how large they take them to be.

    It decides where they look; what a system does, it does not change.

    Attributes:
        enabled_key: state to what of it decides its steps: in states with the same key the same calls have the same
            outcomes, and the same events happen in the same ways.
        search_key: state to what a search tells it apart by; coarser than `enabled_key` where that has too many.
        idle_search_key: the same for what changes nothing; None where it is `search_key`.
        rules_key: state to what of it decides what the rules say to a call, and whether that changes anything; None
            where that is `search_key`.
        phase: state to the phase of its lifecycle that it is in; what is seldom done is counted by phase.
        name_key: (state, position of a name) to what a search tells it apart by.
        search_size: state to how large it is for a search, against `Bounds.size`; None where that is the number of its
            names.
        explore_size: the same for exploration; None where that is the number of its names.
        canonical: state to the one that stands for it in exploration: without what it remembers of times, and of
            readings, since every step may follow any; None where states remember neither.
        forget_ended: state to the one that stands for it where what has ended is only counted: it goes on in the same
            ways, but for what is forgotten.
        indistinct: step that changes the state to one after which nobody can ever tell the difference, the same for all
            those; None where nothing of a state stays hidden for good.
        compiled: what makes the steps of the system again, only faster; of states that go on in the same ways it may
            keep one.
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
