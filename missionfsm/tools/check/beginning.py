"""The beginning of a log that does not hold all that was before it: when nothing from then is on its way any more."""

from __future__ import annotations

from missionfsm.kernel.history import Called, Driven, Event, Name, Received, Returned

MINUTE = 60.0
"""Seconds (of `at`) after which a call that was sent before a log has taken effect, if it ever does."""
NEVER = -1
"""The number of no act of a log."""


class Beginning:
    """Says when what was on its way as a log began has come.

    A stream that the log itself opens shows first what the robot's state is then, if nothing else was asked or driven
    meanwhile. After that nothing but a call that was sent before the log can change the state behind its back. Where
    all of a log can be read beforehand, it is known which of those are answered in it; elsewhere a minute has to pass.

    Args:
        early: how many answers the log has to calls that were sent before it; None where nobody knows.
    """

    def __init__(self, early: int | None) -> None:
        self._early = early
        self._began: float | None = None
        self._acts = 0
        self._pending: dict[Name, int] = {}
        self._opened: dict[Name, int] = {}
        self._joined = False

    def is_over(self, at: float | None, events: tuple[Event, ...], early: int) -> bool:
        """Whether nothing from before the log is on its way any more, after the events of a line.

        Args:
            at: when the line was, in seconds; None if it does not say.
            early: how many answers have come to calls that were sent before the log.
        """
        if self._began is None:
            self._began = at
        shown = [self._shows(event) for event in events]
        if self._joined or not any(shown):
            return False
        if self._early is not None:
            return early >= self._early
        return at is not None and self._began is not None and at - self._began >= MINUTE

    def _shows(self, event: Event) -> bool:
        """Note an event; whether it shows the state as it is."""
        if isinstance(event, Driven):
            self._acts += 1
        elif isinstance(event, Called):
            self._acts += 1
            self._pending[event.call] = NEVER if self._pending else self._acts
        elif isinstance(event, Returned):
            sent = self._pending.pop(event.call, NEVER)
            for name in event.names:
                self._opened.setdefault(name, sent)
        elif isinstance(event, Received):
            opened = self._opened.get(event.channel)
            self._joined = self._joined or opened is None
            self._opened[event.channel] = NEVER  # what it shows later may be old
            return opened == self._acts
        return False


__all__ = ["Beginning"]
