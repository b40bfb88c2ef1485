"""Events whose explanation waits until more of them are known.

Where an event costs a belief too much, it is held back with those that follow. What comes later shows which calls took
effect and in which order; then the whole window is searched, and the belief goes on behind it.
"""

from __future__ import annotations

import itertools

from missionfsm.kernel.history import Called, Event, Returned
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.explanation import Explanation, with_lost
from missionfsm.oracle.lookahead import Symbol
from missionfsm.oracle.search import Search
from missionfsm.oracle.successors import Sighting

BUDGET = 400_000
"""How many explanations a window may cost before it is given up."""


class Window:
    """Events after those that a belief has observed, to be explained together.

    Args:
        belief: what was observed before; it does not learn of the events before `close`.

    Attributes:
        events: the events.
        positions: of each event that means something its position among all.
    """

    def __init__(self, belief: Belief) -> None:
        self._belief = belief
        self._lookout = belief.lookout()
        self._latest = belief.latest
        self._symbols: list[Symbol] = []
        self.positions: list[int] = []
        self.events: list[Event] = []

    def add(self, event: Event) -> None:
        """Hold back one event more."""
        symbol = self._lookout.foresee(event)
        if symbol is not None:
            self._symbols.append(symbol)
            self.positions.append(len(self.events))
        self.events.append(event)

    def search(self, *, whole: bool) -> Search:
        """A search through the window; it has not begun yet.

        Args:
            whole: no further events come, so that a call without an answer never gets one.
        """
        start, symbols = self._belief.node.explanations, self._symbols
        if whole:
            answered = {what[2] for kind, *what in symbols if kind is Returned}
            start = tuple(self._given_up(one, answered) for one in start)
            symbols = [self._lost(symbol, answered) for symbol in symbols]
        return Search(self._belief.automaton.oracle, start, symbols, self._latest, BUDGET)

    def _streams(self, request: object) -> bool:
        """Whether a request subscribes: what the stream shows tells that it was opened."""
        spec = self._belief.automaton.spec
        operation = spec.operations.get(spec.request_operation(request))
        return operation is None or operation.streaming

    def _lost(self, symbol: Symbol, answered: set[int]) -> Symbol:
        if symbol[0] is not Called or symbol[4] in answered or self._streams(symbol[1]):
            return symbol
        return (*symbol[:3], True, symbol[4])

    def _given_up(self, explanation: Explanation, answered: set[int]) -> Explanation:
        """The explanation without the calls in flight that never come back; those that wait may still take effect."""
        lost, calls = explanation.lost, []
        for call in explanation.calls:
            if call.name in answered or self._streams(call.request):
                calls.append(call)
            elif call.done is None:
                lost = with_lost(lost, call.request, call.args)
        return explanation.but(calls=tuple(calls), lost=lost)

    def close(self, search: Search) -> None:
        """Let the belief go on behind the events, all of which the search has explained."""
        belief, automaton, layers = self._belief, self._belief.automaton, search.layers
        for before, after in itertools.pairwise(layers):
            belief.touched |= automaton.touched(before.explanations, after.explanations)
        for layer in layers[:-1]:
            if layer.more is not None:
                for one in layer.explanations:
                    belief.unfollowed |= one.assumed
        found = tuple(Sighting(one) for one in layers[-1].explanations)
        belief.leap(self._lookout, found, [layer.rules for layer in layers[1:]])
