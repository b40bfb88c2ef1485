"""Proof, within bounds, that an implementation does nothing that the documents forbid.

An implementation that is a model can be explored. If every step that it takes in every state that it reaches is among
those that the spec allows there, under readings that agree with one another, then every conversation with it can be
explained: the explanation takes the very same steps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import ANYTHING, meet
from missionfsm.kernel.spec import Mismatch, Step
from missionfsm.kernel.system import System
from missionfsm.tools.explore import Labels, references
from missionfsm.tools.model import Model

BOUNDS = Bounds(missions=2, goals=1, batch=2)


def straight(message: JSON) -> JSON:
    """The message itself."""
    return message


class _GuiltyError(Exception):
    """A step is allowed under no reading that agrees with those assumed before."""


def excuse(  # noqa: PLR0913 - what an implementation is made of
    system: System,
    model: Model,
    honest: Model,
    operation: str | None,
    bend: Callable[[JSON], JSON],
    worlds: tuple[JSON, ...],
) -> str:
    """The readings under which everything that a model does within bounds is allowed; empty if there are none.

    Args:
        model: the implementation.
        honest: the reference under the same readings, from which it may differ by a twist, and in the rules of one
            operation.
        operation: that operation.
        bend: what it does to its messages.
        worlds: those that it is explored in.
    """
    assumed = ANYTHING
    states = 0
    explorer = _Explorer(system, model, honest, operation, bend)
    try:
        for world in worlds:
            assumed, seen = explorer.run(world, assumed)
            states += seen
    except _GuiltyError:
        return ""
    followed = {one.id: one.possible(assumed) for one in system.spec.ambiguities}
    own = {one.id: one.possible(model.choice)[0] for one in system.spec.ambiguities}
    others = [f"{name}={'|'.join(letters)}" for name, letters in followed.items() if own[name] not in letters]
    why = f"which {', '.join(others)} allows" if others else "which its own readings allow"
    return f"it only does, in the {states} states that it reaches, {why}"


class _Explorer:
    def __init__(
        self, system: System, model: Model, honest: Model, operation: str | None, bend: Callable[[JSON], JSON]
    ) -> None:
        self.system = system
        self.spec = system.spec
        self.model = model
        self.honest = honest
        self.operation = operation
        self.bend = bend

    def run(self, world: JSON, assumed: int) -> tuple[int, int]:
        """What is assumed once a world has been explored as well, and how many states it has."""
        alphabet = self.system.alphabet(world, BOUNDS)
        plain = Labels.of(self.system, alphabet.plain, alphabet.plain_drives)
        own = [one for one in alphabet.prompts if one.method == self.operation]
        # The world stays as it is: the others are explored from their own start.
        thorough = Labels.of(self.system, (*alphabet.plain, *own), alphabet.plain_drives)
        start = self.spec.initial(self.system.codec.world(world))
        found, todo, situations = {start}, [start], set()
        for here in todo:
            situation = self.spec.situation(here)
            labels = plain if situation in situations else thorough
            situations.add(situation)
            for taken, allowed in self._taken(here, labels):
                if allowed is None:
                    # The reference's own step: allowed, and under what is known.
                    assumed = meet(assumed, taken.assumes)
                    if not assumed:
                        raise _GuiltyError
                    passing = self.bend is straight
                else:
                    passing = self.model.urgent(taken.after) is not None
                    assumed = _allowed(taken, allowed, assumed, here, passing=passing)
                if not passing:
                    assumed = _shown(self.system, self.model, self.bend, taken, assumed)
                if taken.after not in found and self.spec.names(taken.after) <= BOUNDS.missions:
                    found.add(taken.after)
                    todo.append(taken.after)
        return assumed, len(found)

    def _taken(self, here: Any, labels: Labels) -> Iterator[tuple[Step, tuple[Step, ...] | None]]:  # noqa: ANN401
        """Every step that the model takes in a state, with those that it might take there; urgent ones come first."""
        urgent = tuple(step for step in self.spec.urgent(here) if meet(self.model.choice, step.assumes))
        taken = self.model.urgent(here)
        if taken is not None:
            yield taken, self.spec.urgent(here)
            return
        if urgent:
            raise _GuiltyError
        for request, free in labels.requests:
            for refs in references(self.spec, here, free):
                taken = self._answer(here, request, refs)
                own = taken is self.honest.outcome(here, request, refs)
                yield taken, None if own else self.spec.outcomes(here, request, refs)
        for event, free in labels.events:
            for refs in references(self.spec, here, free):
                happened = self.model.happening(here, event, refs)
                if happened is not None:
                    yield happened, self.spec.drives[event.name].steps(here, event, refs)

    def _answer(self, here: Any, request: Any, refs: tuple[int | None, ...]) -> Step:  # noqa: ANN401
        try:
            if self.spec.request_operation(request) == self.operation:
                return self.model.outcome(here, request, refs)
            step = self.model.twist(here, self.honest.outcome(here, request, refs))
        except (IndexError, AssertionError, AttributeError, TypeError, ValueError, StopIteration):
            raise _GuiltyError from None
        if step is None:
            raise _GuiltyError
        return step


def _allowed(taken: Step, allowed: tuple[Step, ...], assumed: int, here: Any, *, passing: bool) -> int:  # noqa: ANN401
    found = 0
    for step in allowed:
        # What shows a state that does not last may be left out.
        silent = passing and not taken.emits
        if _seen(step, here, silent=silent) == _seen(taken, here, silent=silent):
            agreed = meet(assumed, step.assumes)
            # The one that leaves the most open; where two leave different things open the first is taken.
            found = agreed if agreed and not found else (agreed if agreed & found == found and agreed else found)
    if not found:
        raise _GuiltyError
    return found


def _seen(step: Step, here: Any, *, silent: bool) -> Any:  # noqa: ANN401 - what matters of a step
    names = None if step.after is here else step.names
    return (step.answer, step.after, names, () if silent else step.emits, step.opens, step.refs)


def _shown(system: System, model: Model, bend: Callable[[JSON], JSON], step: Step, assumed: int) -> int:
    for emission in (*step.emits, *(owed for opening in step.opens for owed in opening.owed)):
        if emission.only and not meet(model.choice, (emission.only,)):
            continue
        count = 1 + max((*(emission.refs or ()), system.spec.names(step.after) - 1), default=0)
        names = tuple(f"n{number}" for number in range(count if emission.refs is None else len(emission.refs)))
        message = bend(system.codec.write_message(emission.view, names, model.choice, 1, 0.0))
        for _, _, rest in system.codec.strip(message):
            matches = system.spec.matches(emission.view, system.codec.content(rest))
            if isinstance(matches, Mismatch):
                raise _GuiltyError
            agreed = next((both for match in matches if (both := meet(assumed, match.assumes))), 0)
            if not agreed:
                if meet(model.choice, [one for match in matches for one in match.assumes]):
                    raise _GuiltyError
                continue
            assumed = agreed
    return assumed
