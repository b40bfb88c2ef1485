"""A lifecycle, declared once as a literal table of (trigger, source, destination).

The core moves by the compiled table; `machine` gives the same table as a `transitions` machine to those who want to
attach callbacks to objects of their own; the diagrams are drawn from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Generic, TypeVar

from attrs import field, frozen
from transitions import Machine

S = TypeVar("S")


@frozen(eq=False)
class Chart(Generic[S]):
    """A finite lifecycle.

    Args:
        name: what has the lifecycle, such as ``mission``.
        initial: the state that it starts in.
        table: every move as (trigger, source, destination). States are enum members or plain text.
        notes: trigger → what a picture says of its moves, such as the reading under which they happen.

    Raises:
        ValueError: two moves with one trigger leave one state, or a state cannot be reached.
    """

    name: str
    initial: S
    table: tuple[tuple[str, S, S], ...]
    notes: Mapping[str, str] = field(factory=dict)
    _compiled: dict[tuple[str, S], S] = field(init=False, factory=dict, repr=False)

    def __attrs_post_init__(self) -> None:
        for trigger, source, destination in self.table:
            if (trigger, source) in self._compiled:
                message = f"chart {self.name}: {trigger} leaves {source} twice"
                raise ValueError(message)
            self._compiled[trigger, source] = destination
        lost = [state for state in self.states if state not in self._reachable()]
        if lost:
            message = f"chart {self.name}: {lost[0]} cannot be reached from {self.initial}"
            raise ValueError(message)

    def _reachable(self) -> set[S]:
        found, todo = {self.initial}, [self.initial]
        while todo:
            here = todo.pop()
            for _, source, destination in self.table:
                if source == here and destination not in found:
                    found.add(destination)
                    todo.append(destination)
        return found

    @property
    def states(self) -> tuple[S, ...]:
        """Every state once, in the order in which the table mentions it."""
        ends = (state for _, source, destination in self.table for state in (source, destination))
        return tuple(dict.fromkeys((self.initial, *ends)))

    @property
    def triggers(self) -> tuple[str, ...]:
        """Every trigger once, in the order of the table."""
        return tuple(dict.fromkeys(trigger for trigger, _, _ in self.table))

    @property
    def final(self) -> tuple[S, ...]:
        """The states that nothing leaves."""
        sources = {source for _, source, _ in self.table}
        return tuple(state for state in self.states if state not in sources)

    def after(self, trigger: str, state: S) -> S | None:
        """Where a trigger leads from a state, or None where it is not a move."""
        return self._compiled.get((trigger, state))

    def machine(self, model: Any = None, **options: Any) -> Machine:  # noqa: ANN401 - as transitions takes it
        """The same lifecycle as a `transitions` machine, without the automatic ``to_X`` triggers.

        State names are the names of enum members, or the text itself. Options go to `transitions.Machine`.
        """
        return Machine(
            model=model if model is not None else Machine.self_literal,
            states=[_label(state) for state in self.states],
            initial=_label(self.initial),
            transitions=[[trigger, _label(source), _label(end)] for trigger, source, end in self.table],
            auto_transitions=False,
            **options,
        )


def _label(state: object) -> str:
    return str(getattr(state, "name", state))
