"""Time that passes in a log by itself: as much as the times of its lines say, or any amount if they say nothing."""

from __future__ import annotations

from missionfsm.kernel.history import Driven, Ended, Event, Received, Returned
from missionfsm.kernel.spec import Drive

_SEEN = (Received, Returned, Ended)
"""Events that may show an effect of time."""


class Elapsing:
    """Inserts the time that has passed before the events of a conversation's lines.

    Once a line lets time pass itself, the log is taken to say all of it, and nothing is inserted any more.

    Args:
        drive: the drive that lets time pass.

    Attributes:
        at: the time of the next line, in seconds; None if it does not say.
    """

    def __init__(self, drive: Drive, late: float | None) -> None:
        self._drive = drive
        self._late = late
        self._last: float | None = None
        self._told = False
        self.at: float | None = None

    def before(self, events: tuple[Event, ...]) -> tuple[Event, ...]:
        """The time that has passed before the events of a line, as an event; nothing if it makes no difference."""
        at, self.at = self.at, None
        self._told = self._told or any(type(one) is Driven and self._lets_pass(one) for one in events)
        if self._told:
            return ()
        passed = None
        if at is not None:
            passed = 0 if self._last is None else at - self._last
            self._last = at
        elif self._last is not None:
            passed = 0
        if passed == 0 or (passed is None and not any(type(one) in _SEEN for one in events)):
            return ()
        assert self._drive.elapses is not None, "such a drive lets time pass"  # noqa: S101
        return (Driven(self._drive.elapses(passed, self._late)),)

    def _lets_pass(self, event: Driven) -> bool:
        return bool(event.event.name == self._drive.name)  # type: ignore[attr-defined]


def elapsing(drives: tuple[Drive, ...], late: float | None = None) -> Elapsing | None:
    """What inserts the time that passes by itself; None if none of these drives, which nobody commands, does that."""
    found = [one for one in drives if one.elapses is not None]
    return Elapsing(found[0], late) if found else None


__all__ = ["Elapsing", "elapsing"]
