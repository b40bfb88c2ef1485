"""Quotients of the explored graph: every state within the bounds of a sketch, and what of it can be told apart there.

A system is drawn settled: a step is followed by everything urgent, so that what lies between is no node.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from attrs import frozen

from missionfsm.kernel.picture import Sketch
from missionfsm.kernel.readings import meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import State
from missionfsm.tools.explore.explore import Actions, bindings

BY_ITSELF = "by itself"


@frozen
class Move:
    """One way from node to node.

    Attributes:
        label: what is done.
        code: the code of the answer; empty if it is no call.
        shows: the messages that it causes, in order.
        refused: whether it is a call that is refused, and changes nothing.
    """

    source: str
    label: str
    code: str
    shows: tuple[str, ...]
    target: str
    refused: bool

    def __str__(self) -> str:
        answered = f"{self.label} → {self.code}" if self.code not in ("", OK) else self.label
        return f"{answered} / {', '.join(self.shows)}" if self.shows else answered


@frozen
class Quotient:
    """What a sketch makes of the explored graph.

    Attributes:
        nodes, moves: in the order of exploration.
        starts: the nodes that are entered first.
        labels: what is done, in the order in which it is tried.
    """

    nodes: tuple[str, ...]
    starts: tuple[str, ...]
    moves: tuple[Move, ...]
    labels: tuple[str, ...]


def quotient(system: System, sketch: Sketch, assumed: int) -> Quotient:
    """The quotient of a system by a sketch, where these readings are followed."""
    return _Explorer(system, sketch, assumed).quotient()


@frozen
class _Way:
    """A settled state that a step leads to, and what is sent on the way."""

    after: State
    shows: tuple[str, ...] = ()


class _Explorer:
    """Walks the graph once."""

    def __init__(self, system: System, sketch: Sketch, assumed: int) -> None:
        self._spec: Spec = system.spec
        self._sketch = sketch
        self._assumed = assumed
        self._actions = Actions.from_alphabet(system, sketch.inputs, sketch.drives)
        self._first = self._spec.initial(system.codec.read_world(sketch.world))

    def quotient(self) -> Quotient:
        node = self._sketch.node
        found = dict.fromkeys(way.after for way in self._settled(_Way(self._first)))
        todo = list(found)
        nodes: dict[str, None] = {}
        starts = dict.fromkeys(name for name in map(node, todo) if name is not None)
        moves: dict[Move, None] = {}
        tried: dict[str, int] = {}
        for here in todo:  # grows while it is walked
            source = node(here)
            if source is not None:
                nodes.setdefault(source)
            for number, label, step in self._steps(here):
                for way in self._settled(_Way(step.after, self._rendered(step))):
                    if not self._sketch.within(way.after):
                        continue
                    if way.after not in found:
                        found[way.after] = None
                        todo.append(way.after)
                    target = node(way.after)
                    if target is None:
                        continue
                    if source is None:
                        starts.setdefault(target)
                    elif label is not None:
                        code = step.answer.code if step.answer else ""
                        tried.setdefault(label, number)
                        refused = code not in ("", OK) and step.after == here
                        moves.setdefault(Move(source, label, code, way.shows, target, refused))
        return Quotient(tuple(nodes), tuple(starts), tuple(moves), tuple(sorted(tried, key=tried.__getitem__)))

    def _steps(self, here: State) -> Iterator[tuple[int, str | None, Step]]:
        """Every step, with what doing it is called and the number of what is tried."""
        spec, label = self._spec, self._sketch.label
        requests, events = self._actions.requests, self._actions.events
        for number, (request, free) in enumerate(requests):
            for refs in bindings(spec, here, free):
                for step in self._possible(spec.outcomes(here, request, refs)):
                    yield number, label(here, request, refs), step
        for number, (event, free) in enumerate(events, len(requests)):
            for refs in bindings(spec, here, free):
                for step in self._possible(spec.drives[event.name].steps(here, event, refs)):
                    yield number, label(here, event, refs), step
        for step in self._possible(spec.spontaneous(here)):
            yield len(requests) + len(events), BY_ITSELF, step

    def _possible(self, steps: Iterable[Step]) -> Iterator[Step]:
        return (step for step in steps if meet(self._assumed, step.assumes))

    def _settled(self, start: _Way) -> tuple[_Way, ...]:
        """What a way comes to once nothing urgent is left to do."""
        simple = self._sketch.simple
        found: dict[_Way, None] = {}
        seen, todo = {start.after}, [start]
        while todo:
            here = todo.pop()
            steps = tuple(self._possible(self._spec.urgent(here.after)))
            if not steps:
                found.setdefault(_Way(simple(here.after, self._assumed), here.shows))
            ways = (_Way(step.after, here.shows + self._rendered(step)) for step in reversed(steps))
            fresh = [way for way in ways if way.after not in seen]
            seen.update(way.after for way in fresh)
            todo += fresh
        return tuple(found)

    def _rendered(self, step: Step) -> tuple[str, ...]:
        """What of a step has to be sent, as far as the sketch shows it."""
        due = (
            one.view
            for one in step.emits
            if not (one.optional or one.stays) and (one.only is None or meet(self._assumed, [one.only]))
        )
        return tuple(words for words in map(self._sketch.shows, due) if words is not None)
