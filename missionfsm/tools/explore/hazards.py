"""What comes of a call that is repeated because it failed, although it may have taken effect.

Documents advise clients to retry after a failure. Every state within bounds is tried, every call that succeeds there,
and every failure that it may be answered with in the place of success: what does the same call do then, at once, or
after something has happened in between? Of states in which the same can be done the nearest is tried, and the shortest
example of each kind is kept.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from attrs import field, frozen

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Name
from missionfsm.kernel.readings import meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Request
from missionfsm.tools.explore.explore import Actions, bindings
from missionfsm.tools.reference.model import Reference, Reply, Snapshot

ONCE = "it had no effect, so the retry is the first call"
AGAIN = "answered OK once more, and nothing more is done"
TWICE = "done twice"
REFUSED = "refused with {}, although it was done"


@frozen
class Hazard:
    """What a retry of a call can lead to.

    Attributes:
        operation: the call; `code`: the failure that it was answered with.
        outcome: what the retry comes to.
        trace: the shortest way there, a line a step.
        harmful: whether more was done than was asked for once.
    """

    operation: str
    code: str
    outcome: str
    trace: tuple[str, ...] = ()

    @property
    def harmful(self) -> bool:
        """Whether more was done than was asked for once."""
        return self.outcome == TWICE

    def __str__(self) -> str:
        lines = [f"{self.operation}, {self.code}: {self.outcome}"]
        lines += [f"  {number}. {step}" for number, step in enumerate(self.trace, 1)]
        return "\n".join(lines)


@frozen
class Hazards:
    """What retries can lead to, for every call and every failure of its Errors table."""

    system: str
    bounds: Bounds
    found: tuple[Hazard, ...] = field(factory=tuple)

    @property
    def unsafe(self) -> tuple[str, ...]:
        """The calls of which a retry may do more than was asked for."""
        return tuple(dict.fromkeys(one.operation for one in self.found if one.harmful))

    def to_json(self) -> JSON:
        """The hazards as the command line writes them."""
        return {
            "system": self.system,
            "unsafe": list(self.unsafe),
            "hazards": [
                {"operation": one.operation, "code": one.code, "outcome": one.outcome, "trace": list(one.trace)}
                for one in self.found
            ],
        }

    def __str__(self) -> str:
        unsafe = ", ".join(self.unsafe) or "no call"
        safe = dict.fromkeys(one.operation for one in self.found if one.operation not in self.unsafe)
        return "\n".join(
            [
                f"{self.system} within {self.bounds}, what a retry can lead to",
                f"  may be done twice: {unsafe}",
                f"  never done twice: {', '.join(safe) or 'no call'}",
                *map(str, self.found),
            ]
        )


@frozen
class _Place:
    """A state, the names in it, and how it was reached."""

    here: Snapshot
    path: tuple[str, ...] = ()


def hazards(system: System, bounds: Bounds | None = None, choice: Mapping[str, str] | None = None) -> Hazards:
    """What a retry can lead to, under one choice of readings.

    Args:
        choice: ambiguity id to letter; the others follow their defaults.

    Raises:
        ValueError: `choice` names a reading that does not exist.
    """
    bounds = bounds or Bounds()
    world = system.alphabet({}, bounds).worlds[0]
    alphabet = system.alphabet(world, bounds)
    actions = Actions.from_alphabet(system, alphabet.core_inputs, alphabet.core_drives)
    model = Reference(system, choice)
    search = _Search(system, model, actions, bounds)
    return Hazards(system.name, bounds, search.run(world))


class _Search:
    def __init__(self, system: System, model: Reference, actions: Actions, bounds: Bounds) -> None:
        self._system = system
        self._model = model
        self._actions = actions
        self._most = bounds.size
        self._found: dict[tuple[str, str, str], Hazard] = {}

    def run(self, world: JSON) -> tuple[Hazard, ...]:
        """Visit every state within the bounds, nearest first."""
        first = self._model.start(self._system.codec.read_world(world))
        key = self._system.spec.abstraction.enabled_key
        seen = {key(first.state)}
        todo = [_Place(first)]
        for place in todo:  # grows while it is walked
            for request, names, after, reply in self._calls(place.here):
                self._retry(place, request, names, after, reply)
                self._add(todo, seen, place, after, self._says(request, reply))
            for says, after in self._events(place.here):
                self._add(todo, seen, place, after, says)
        order = list(self._system.spec.operations)
        return tuple(sorted(self._found.values(), key=lambda one: (order.index(one.operation), one.code, one.outcome)))

    def _add(self, todo: list[_Place], seen: set[Any], place: _Place, after: Snapshot, says: str) -> None:
        key = self._system.spec.abstraction.enabled_key(after.state)
        if key not in seen and self._system.spec.explore_size(after.state) <= self._most:
            seen.add(key)
            todo.append(_Place(after, (*place.path, says)))

    def _calls(self, here: Snapshot) -> Iterator[tuple[Any, tuple[Name, ...], Snapshot, Reply]]:
        """Every call that succeeds and opens no stream."""
        spec = self._system.spec
        for request, free in self._actions.requests:
            if spec.operations[spec.request_operation(request)].streaming:
                continue
            for refs in bindings(spec, here.state, free):
                if all(ref is not None and ref >= 0 for ref in refs):
                    names = tuple(here.names[ref] for ref in refs if ref is not None)
                    after, reply = self._model.call(here, request, names)
                    if reply.answer is not None and reply.answer.code == OK:
                        yield request, names, after, reply

    def _events(self, here: Snapshot) -> Iterator[tuple[str, Snapshot]]:
        """Everything that the surroundings may do and that names nobody."""
        for event, free in self._actions.events:
            if not free:
                after, reply = self._model.drive(here, event)
                if reply.happened and after.state != here.state:
                    yield self._system.spec.describe(event), after

    def _says(self, request: Request, reply: Reply) -> str:
        code = reply.answer.code if reply.answer is not None else OK
        return f"{self._system.spec.describe(request)} → {code}"

    def _retry(
        self,
        place: _Place,
        request: Request,
        names: tuple[Name, ...],
        done: Snapshot,
        reply: Reply,
    ) -> None:
        """What the same call does once more, where its success was not heard of."""
        spec = self._system.spec
        operation = spec.operations[spec.request_operation(request)]
        for code in operation.failures:
            failure = spec.failing(request, code)
            if failure is None or not meet(self._model.choice, failure.assumes):
                continue
            says = f"{spec.describe(request)} → {code}"
            if not failure.open_ended:
                again = self._says(request, reply)
                self._keep(Hazard(operation.name, code, ONCE, (*place.path, f"{says}, without effect", again)))
                continue
            path = (*place.path, f"{says}, though it took effect")
            for later in self._later(_Place(done, path)):
                self._repeated(operation.name, code, request, names, later)

    def _later(self, place: _Place) -> Iterator[_Place]:
        """A place, and those that the surroundings lead to from there, nearest first."""
        key = self._system.spec.abstraction.enabled_key
        seen = {key(place.here.state)}
        todo = [place]
        for one in todo:  # grows while it is walked
            yield one
            for says, after in self._events(one.here):
                if key(after.state) not in seen:
                    seen.add(key(after.state))
                    todo.append(_Place(after, (*one.path, says)))

    def _repeated(self, operation: str, code: str, request: Request, names: tuple[Name, ...], place: _Place) -> None:
        after, reply = self._model.call(place.here, request, names)
        answer = reply.answer.code if reply.answer is not None else OK
        done = AGAIN if after.state == place.here.state else TWICE
        outcome = done if answer == OK else REFUSED.format(answer)
        self._keep(Hazard(operation, code, outcome, (*place.path, self._says(request, reply))))

    def _keep(self, hazard: Hazard) -> None:
        key = hazard.operation, hazard.code, hazard.outcome
        known = self._found.get(key)
        if known is None or len(hazard.trace) < len(known.trace):
            self._found[key] = hazard
