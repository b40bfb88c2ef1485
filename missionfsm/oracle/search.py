"""A search for explanations of recorded events, for where a belief would have to imagine too much.

The belief holds all explanations at once. That is right while they are few. Where calls that are lost, timed out or
overlap make them many, a window of the events is searched instead: some explanations are followed as far as they go,
nearest first, and the others only where those fail. What was tried once is not tried again: the same calls have taken
effect, the state is the same, and no more is assumed. A `Lookahead` leaves out what cannot lead on.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from attrs import define, field

from missionfsm.oracle.explanation import Explanation
from missionfsm.oracle.lookahead import Lookahead, Message, Symbol
from missionfsm.oracle.subsumption import sift
from missionfsm.oracle.successors import Moves, Seen, Sighting
from missionfsm.oracle.transition import Oracle

WIDTH = 16
"""How many explanations are followed at once."""


@define(eq=False)
class Layer:
    """Some explanations of all events before one, and those after it that were not looked at yet.

    Attributes:
        rules: what was exercised by the event before.
        more: what else explains the event as well; None where that is all.
    """

    explanations: tuple[Explanation, ...]
    rules: tuple[str, ...] = ()
    more: Iterator[Sighting] | None = field(default=None, repr=False)
    begun: bool = False


class Search:
    """Looks for explanations of a window of events.

    Args:
        oracle: the transition function.
        start: all explanations of what was before.
        symbols: the events of the window.
        latest: what each channel showed last before the window.
        budget: how many explanations may be looked at.

    Attributes:
        width: how many explanations are followed at once.
        layers: the explanations that were found: at position n of the first n events.
        reached: how many events were explained that have some more behind them in mind.
    """

    def __init__(
        self,
        oracle: Oracle,
        start: Sequence[Explanation],
        symbols: Sequence[Symbol],
        latest: Mapping[int, Message],
        budget: int,
    ) -> None:
        self.oracle = oracle
        self.moves: Moves = oracle.moves
        self._start = tuple(start)
        self._symbols = symbols
        self._latest = latest
        self._budget = budget
        self.width = WIDTH
        self.layers: list[Layer] = []
        self.reached = 0

    def explain(self, horizon: int) -> bool:
        """Whether the first events up to a horizon are explained.

        Raises:
            ExhaustedError: it costs more than the budget.
        """
        ahead = Lookahead(self.oracle.spec, self._symbols, horizon, self._latest)
        budget, self.moves.budget = self.moves.budget, self._budget
        self.moves.ahead = ahead
        self.moves.reset()
        try:
            return self._explain(ahead, horizon)
        finally:
            self.moves.ahead, self.moves.budget = None, budget
            self.moves.reset()

    def _explain(self, ahead: Lookahead, horizon: int) -> bool:
        layers = self.layers = [Layer(tuple(one for one in self._start if ahead.leads(one)))]
        tried: list[Seen] = [{} for _ in range(horizon + 1)]
        while len(layers) <= horizon:
            if not layers:
                return False
            here = layers[-1]
            position = len(layers) - 1
            ahead.at = position
            found = self._next(here, position, ahead, tried[position + 1])
            if found:
                rules = tuple(dict.fromkeys(rule for one in found for rule in one.rules))
                layers.append(Layer(tuple(one.explanation for one in found), rules))
            else:
                self.reached = max(self.reached, position)
                layers.pop()
        return True

    def _next(self, here: Layer, position: int, ahead: Lookahead, tried: Seen) -> tuple[Sighting, ...]:
        """Some more explanations of the next event; none where there are no others."""
        if not here.begun:
            here.begun = True
            kind, *what = self._symbols[position]
            here.more = self.oracle.explained(here.explanations, kind, *what)
        found: list[Sighting] = []
        while here.more is not None and not found:
            for one in here.more:
                ahead.at = position + 1
                if ahead.leads(one.explanation) and not self.moves.outdone(tried, one.explanation):
                    found.append(one)
                ahead.at = position
                if len(found) >= self.width:
                    break
            else:
                here.more = None
        return sift(self.moves, found)

    def first_unexplained(self) -> int | None:
        """The position of the first event that nothing explains, given those before it; None where all are explained.

        The layers are those of the events before it.
        """
        if self.explain(len(self._symbols)):
            return None
        good, bad, stride = self.reached, len(self._symbols), 1
        while good + 1 < bad:
            middle = min(good + stride, (good + bad) // 2) if stride else (good + bad) // 2
            if self.explain(middle):
                good, stride = middle, stride * 2
            else:
                bad, stride = middle, 0
        self.explain(good)
        return good

    @property
    def exact(self) -> bool:
        """Whether the last layer has every explanation there is."""
        return all(layer.more is None for layer in self.layers[:-1])
