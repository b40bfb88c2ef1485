"""How a system is drawn small enough to be looked at: quotients of its explored graph, and plans of missions."""

from __future__ import annotations

from collections.abc import Callable

from attrs import field, frozen

from missionfsm.kernel.alphabet import Input
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.terms import Incident, Refs, Request, State, View


@frozen
class Part:
    """Some of what is done in a system, which is drawn by itself where the whole is too much for one picture.

    Attributes:
        name: what it shows, in a word; the files of the picture are called after it.
        title: the same in a few words.
        labels: what doing that is called.
    """

    name: str
    title: str
    labels: tuple[str, ...]


@frozen(eq=False)
class Sketch:
    """A quotient of the explored graph: which states are one node, and what a step between them is called.

    Attributes:
        name: what it shows, in a word.
        title: the same in a few words.
        node: state → the name of its node, which says what all states of the node have in common; None if the state is
            not in the picture.
        label: (state, request or event, refs) → the label of the arrow for doing that there; None if it is not shown.
        within: state → whether the exploration goes on from there.
        simple: (state, readings that are followed) → the state that stands for it: under these readings the same can
            be done there, with the same names.
        shows: view → the label for sending it; None if it is not shown.
        inputs, drives: what is tried.
        world: the world that it starts in.
        contrasts: readings, such as ``AM-09=b``, that are worth a picture beside that of the reference's reading.
        parts: how it is divided if it is too large for one picture. By default what ends everything is drawn apart.
    """

    name: str
    title: str
    node: Callable[[State], str | None]
    label: Callable[[State, Request | Incident, Refs], str | None]
    within: Callable[[State], bool]
    simple: Callable[[State, int], State] = lambda state, _: state
    shows: Callable[[View], str | None] = lambda _: None
    inputs: tuple[Input, ...] = ()
    drives: tuple[JSON, ...] = ()
    world: JSON = field(factory=dict)
    contrasts: tuple[str, ...] = ()
    parts: tuple[Part, ...] = ()


def every_state(spec: Spec, inputs: tuple[Input, ...] | None = None) -> Sketch:
    """A picture in which each state is a node, for a system with few states.

    Args:
        spec: the system.
        inputs: what is asked; by default every operation with empty params.
    """
    return Sketch(
        "states",
        f"every state of {spec.title}",
        node=spec.describe,
        label=lambda _state, asked, _refs: spec.describe(asked),
        within=lambda _state: True,
        shows=spec.describe,
        inputs=tuple(Input(method, {}) for method in spec.operations) if inputs is None else inputs,
        drives=tuple({"event": name} for name in spec.drives),
    )


@frozen
class Plan:
    """Missions that wait for one another.

    Attributes:
        name: what the files of the picture are called.
        title: what it shows, in a few words.
        missions: each in a few lines.
        upstream: for each mission, the indices of the missions that it waits for.
    """

    name: str
    title: str
    missions: tuple[tuple[str, ...], ...]
    upstream: tuple[tuple[int, ...], ...]
