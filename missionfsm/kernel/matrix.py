"""In which situations a tester should have asked what: every cell of situation × action several times in a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from attrs import frozen

from missionfsm.kernel.alphabet import Bounds, ScriptStep
from missionfsm.kernel.terms import Incident, Refs, Request, State, Topic

Open = tuple[tuple[Topic, ...], ...]
"""The streams or connections that are open, each as the topics of its channels."""


@frozen(eq=False)
class Matrix:
    """The situations of a system and the kinds of actions that matter in each.

    It decides where a tester looks, and what the report says of that. It does not change what is right.

    Attributes:
        situation: (state, open streams and connections) → the name of the situation; None if it is not counted.
        columns: (state, open streams and connections, request or event, positions of its names among those of the
            state) → the kinds of actions that it is an example of; none if it does not matter.
        ways: the name of each situation, with scripts that lead there from the start, in any world.
        bounds: how large requests may be.
        pause: a step after which the situation is sure, because the system has done then what it still had to do.
    """

    situation: Callable[[State, Open], str | None]
    columns: Callable[[State, Open, Request | Incident, Refs], tuple[str, ...]]
    ways: Mapping[str, tuple[tuple[ScriptStep, ...], ...]]
    bounds: Bounds
    pause: ScriptStep | None = None
