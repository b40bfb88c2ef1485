"""Events of a recorded history that wait for the events after them, which show how they have to be explained."""

from __future__ import annotations

from typing import Any

from attrs import frozen

from missionfsm.kernel.history import Event
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.successors import ExhaustedError
from missionfsm.oracle.window import Window

FIRST, TIMES, TIMES_ANEW = 64, 4, 8
"""How many events wait before they are first looked at, and the factor by which that grows each time: where the search
goes on, and where it begins anew."""


@frozen
class HeldEvent:
    """An event that waits.

    Attributes:
        event: the event.
        asked: the request, if the event is an answer.
        read: how many lines were read, its own included.
        place: where its line stands.
        open_calls: whether calls had no answer before it.
    """

    event: Event
    asked: Any
    read: int
    place: int
    open_calls: bool


@frozen
class Presumed:
    """An answer that only a restart explains, while no message has shown that there was one.

    Attributes:
        belief: the belief before it, which presumes no restart.
        line: the answer.
        events: how many events there were, the answer included.
    """

    belief: Belief
    line: HeldEvent
    events: int


@frozen
class Explained:
    """What came of explaining events that waited.

    Attributes:
        whole: whether all of them are explained.
        exact: whether the search found all of their explanations, or an event that has none.
    """

    whole: bool
    exact: bool


class Held:
    """Events that wait to be explained together.

    Attributes:
        lines: the events, each with where it stands.
        unexplained: the position of the first event that nothing explains, once that is known.
        reached: how many of them were explained before the budget ran out.
        strictly: whether it ran out at what the system itself does not explain.
    """

    def __init__(self, belief: Belief) -> None:
        self._belief = belief
        self._window = Window(belief)
        self._size = FIRST
        self.lines: list[HeldEvent] = []
        self.unexplained = 0
        self.reached = 0
        self.strictly = False

    def add(self, line: HeldEvent) -> None:
        """Let one more event wait."""
        self._window.add(line.event)
        self.lines.append(line)

    @property
    def due(self) -> bool:
        """Whether it is time to look at them."""
        return len(self.lines) >= self._size

    def wait(self) -> None:
        """Let more events come before all of them are explained anew: few enough searches to cost little in sum."""
        self._size = (TIMES_ANEW if self._window.begins_anew else TIMES) * len(self.lines)

    def explain(self, *, whole: bool) -> Explained:
        """Explain the events, and move the belief after them, or before the first one that nothing explains.

        Args:
            whole: whether no further events come.

        Raises:
            ExhaustedError: it costs too much, and no further events come that could help.
        """
        try:
            return self._explain(whole=whole)
        except ExhaustedError:
            if whole:
                raise
            return Explained(whole=True, exact=False)

    def _explain(self, *, whole: bool) -> Explained:
        window = self._window
        lost = window.unanswered if whole else None
        search = window.search(lost)
        try:
            found = search.first_unexplained()
        finally:
            stopped_early = search.reached < len(window.positions)
            self.reached = window.positions[search.reached] if stopped_early else 0
            self.strictly = search.strictly is not None
        if found is None:
            if search.exact or whole:
                window.close(search)
            return Explained(whole=True, exact=search.exact)
        self.unexplained = window.positions[found]
        before = Window(self._belief)
        for line in self.lines[: self.unexplained]:
            before.add(line.event)
        again = before.search(lost)
        again.beyond = {position for position in search.beyond if position < found}
        again.restarts = search.restarts
        again.explain(len(before.positions))
        before.close(again)
        self._belief.broken = True
        return Explained(whole=False, exact=True)
