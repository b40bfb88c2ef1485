"""Events of a recorded history that wait for those that follow, since these show how they have to be explained."""

from __future__ import annotations

from typing import Any

from attrs import frozen

from missionfsm.kernel.history import Event
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.successors import ExhaustedError
from missionfsm.oracle.window import Window

FIRST, TIMES = 64, 4
"""How many events wait before they are looked at for the first time; then so many times as many, and so on."""


@frozen
class HeldEvent:
    """An event that waits.

    Attributes:
        asked: the request that it answers, if it is an answer.
        read: how many lines were read with it.
        place: where its line stands.
        open_calls: whether calls had no answer then.
    """

    event: Event
    asked: Any
    read: int
    place: int
    open_calls: bool


@frozen
class Presumed:
    """An answer that nothing but a restart explains which nobody has seen yet.

    Attributes:
        belief: what was believed before it; it presumes no restart.
        line: the answer.
        events: how many events there were with it.
    """

    belief: Belief
    line: HeldEvent
    events: int


@frozen
class Explained:
    """What came of explaining events that waited.

    Attributes:
        whole: whether all of them are explained.
        exact: whether all of their explanations are known, or it is known that one has none.
    """

    whole: bool
    exact: bool


class Held:
    """Events that wait to be explained together.

    Attributes:
        lines: the events, each with where it stands.
        unexplained: the position of the first one that nothing explains, once that is known.
        reached: how many of them were explained before it became too much.
    """

    def __init__(self, belief: Belief) -> None:
        self._belief = belief
        self._window = Window(belief)
        self._size = FIRST
        self.lines: list[HeldEvent] = []
        self.unexplained = 0
        self.reached = 0

    def add(self, line: HeldEvent) -> None:
        """One event more waits."""
        self._window.add(line.event)
        self.lines.append(line)

    @property
    def due(self) -> bool:
        """Whether it is time to look at them."""
        return len(self.lines) >= self._size

    def wait(self) -> None:
        """Let so many more events come that looking at all of them anew costs little beside looking at the last."""
        self._size = TIMES * len(self.lines)

    def explain(self, *, whole: bool) -> Explained:
        """Explain the events. The belief goes on behind them, or before the first one that nothing explains.

        Args:
            whole: whether no further events come.

        Raises:
            ExhaustedError: it costs too much, and no further events come that tell more.
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
        again.explain(len(before.positions))
        before.close(again)
        self._belief.broken = True
        return Explained(whole=False, exact=True)
