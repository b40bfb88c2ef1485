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

    It decides where a tester looks and what it says of where it has been; what is right it does not change.

    Attributes:
        situation: (state, what is open) to the name of the situation; None for one that nobody counts. What is open
            are the topics of the channels of each stream or connection.
        columns: (state, what is open, request or event, positions of its names among those of the state) to the names
            of the kinds of actions that it is an example of; none for what does not matter.
        ways: name of a situation to scripts that lead there from the start, in any world.
        bounds: how large what is asked may be.
        pause: a step after which a situation that was not sure may be: what a system has yet to do has happened then.
    """

    situation: Callable[[State, Open], str | None]
    columns: Callable[[State, Open, Request | Incident, Refs], tuple[str, ...]]
    ways: Mapping[str, tuple[tuple[ScriptStep, ...], ...]]
    bounds: Bounds
    pause: ScriptStep | None = None
