"""Events whose explanation waits until more of them are known.

Where an event costs a belief too much, it is held back with those that follow. What comes later shows which calls took
effect and in which order; then the whole window is searched, and the belief goes on behind it.
"""

from __future__ import annotations

import itertools

from missionfsm.kernel.history import Called, Ended, Event, Received, Returned
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.coming import Excerpt
from missionfsm.oracle.explanation import GONE, Explanation, reopened, tidy, with_lost
from missionfsm.oracle.kinds import Kinds
from missionfsm.oracle.search import Search
from missionfsm.oracle.successors import Successor
from missionfsm.oracle.symbols import Symbol

WINDOW_BUDGET, EACH = 100_000, 200
"""How many explanations a window may cost before it is given up, and how many more for each of its events."""

FIRST, MORE = 2_000, 10
"""The same where further events may come that tell more: it is tried again with them."""


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
        self._search: Search | None = None
        self._kinds = Kinds(belief.automaton.successors)
        self.positions: list[int] = []
        self.events: list[Event] = []

    def add(self, event: Event) -> None:
        """Hold back one event more."""
        symbol = self._lookout.number_for_good(event)
        if symbol is not None:
            self._symbols.append(symbol)
            self.positions.append(len(self.events))
        self.events.append(event)

    @property
    def unanswered(self) -> frozenset[int]:
        """The numbers of the calls that the events do not answer.

        One that subscribes is none of them where a stream may be its own: what that shows tells that it was opened.
        """
        waiting = {call.name: call.request for one in self._belief.node.explanations for call in one.calls}
        for symbol in self._symbols:
            if symbol[0] is Called:
                if not symbol[3]:
                    waiting[symbol[4]] = symbol[1]
            elif symbol[0] is Returned:
                waiting.pop(symbol[3], None)
        if self._shows_what_nobody_opened:
            return frozenset(call for call, request in waiting.items() if not self._streams(request))
        return frozenset(waiting)

    @property
    def _shows_what_nobody_opened(self) -> bool:
        """Whether anything comes on a stream of which no answer has told: a call that waits may have opened it."""
        opened = {one.name for here in self._belief.node.explanations for one in here.channels}
        opened.update(self._latest, *(one[2] for one in self._symbols if one[0] is Returned))
        return any(one[-1] not in opened for one in self._symbols if one[0] is Received or one[0] is Ended)

    def search(self, lost: frozenset[int] | None = None) -> Search:
        """A search through the window, which goes on with what came since it was last asked for.

        Args:
            lost: where no further events come, the numbers of the calls that are never answered.
        """
        start, symbols = self._belief.node.explanations, self._symbols
        if lost:
            start = tuple(self._given_up(one, lost) for one in start)
            symbols = [(*one[:3], True, one[4]) if one[0] is Called and one[4] in lost else one for one in symbols]
        least, each = (FIRST, MORE) if lost is None else (WINDOW_BUDGET, EACH)
        budget = least + each * len(symbols)
        search = None if lost else self._search
        if search is None or self.begins_anew:
            transitions, memory = self._belief.automaton.transitions, self._belief.automaton.memory
            search = Search(transitions, start, Excerpt(symbols, self._latest), budget, memory, self._kinds)
        search.budget, search.whole = budget, lost is not None
        self._search = None if lost else search
        return search

    @property
    def begins_anew(self) -> bool:
        """Whether a search through more events makes no use of the one before."""
        return self._search is not None and self._search.calls_alone

    def _streams(self, request: object) -> bool:
        spec = self._belief.automaton.spec
        operation = spec.operations.get(spec.request_operation(request))
        return operation is None or operation.streaming

    def _given_up(self, explanation: Explanation, given_up: frozenset[int]) -> Explanation:
        """The explanation without the calls in flight that never come back; those that wait may still take effect.

        A stream that one of them has opened, and that shows nothing, is left out as well.
        """
        lost = explanation.lost
        for call in explanation.calls:
            if call.name in given_up and call.done is None:
                lost = with_lost(lost, call.request, call.args)
        silent = {name for call in explanation.calls if call.name in given_up and call.done for name in call.done.names}
        calls = tuple(call for call in explanation.calls if call.name not in given_up)
        channels = tuple(one for one in explanation.channels if one.name >= GONE or one.name not in silent)
        return tidy(explanation.replace(calls=calls, lost=lost, channels=channels))

    def close(self, search: Search) -> None:
        """Let the belief go on behind the events, all of which the search has explained."""
        belief, automaton = self._belief, self._belief.automaton
        layers, exercised = search.told()
        for before, after in itertools.pairwise(layers):
            belief.touched |= automaton.touched(before.explanations, after.explanations)
        for layer in layers[:-1]:
            if layer.unfinished:
                for one in layer.explanations:
                    belief.unfollowed |= one.assumed
        found = tuple(Successor(reopened(search.brought(one))) for one in layers[-1].explanations)
        belief.leap(self._lookout, found, exercised)
