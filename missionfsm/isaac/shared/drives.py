"""The drives that both systems have: lines that arrive, and time that passes."""

from __future__ import annotations

import math

from missionfsm.isaac.shared.line import MICROSECONDS
from missionfsm.kernel.codec import JSON, DriveForm, UnreadableError
from missionfsm.kernel.text import brief
from missionfsm.kernel.values import value

MAX_SECONDS = 1e300
"""Of what is longer the microseconds are more than a float can be."""


@value(cache_hash=True)
class Passes:
    """Time passes, in microseconds."""

    time: int
    name: str = "advance"


@value(cache_hash=True)
class Elapsed:
    """Time has passed that nobody let pass: at most so many microseconds, or any number where it is None.

    What is due for longer than `late` microseconds has happened by then; None: nothing has to have happened.
    """

    time: int | None
    late: int | None = None
    name: str = "advance"


def elapses(given: float | None, late: float | None) -> Elapsed:
    """The event of so many seconds between two lines of a log, or of any number; after how many something is late."""
    if given is None:
        return Elapsed(None)
    return Elapsed(in_microseconds(given, "at"), None if late is None else in_microseconds(late, "--settled-after"))


def later(event: Passes | Elapsed) -> str:
    """Time that passes, in words that stand before what comes next."""
    if event.time is None:
        return "some time later"
    return f"{event.time / MICROSECONDS:g} s later"


def seconds(given: JSON, where: str = "drive.seconds") -> int:
    """Some seconds in microseconds. Raises UnreadableError for what is no time that can pass."""
    if isinstance(given, bool) or not isinstance(given, int | float) or not 0 <= given < math.inf:
        raise UnreadableError(f"{where}: {brief(given)} is no number of seconds from 0 on")
    return in_microseconds(given, where)


def in_microseconds(given: float, where: str) -> int:
    """A finite number of seconds in microseconds. Raises UnreadableError for one that is too large to be told."""
    if abs(given) > MAX_SECONDS:
        raise UnreadableError(f"{where}: {brief(given)} is more than {MAX_SECONDS:g} seconds, the most that is counted")
    return round(given * MICROSECONDS)


def text_line(given: JSON) -> str:
    """A drive's line. Raises UnreadableError for what is no text."""
    line = given.get("line")
    if not isinstance(line, str):
        raise UnreadableError(f"drive.line: {brief(line)} is not a text")
    return line


SECONDS = {"type": "number", "minimum": 0}
ADVANCE = DriveForm(
    lambda given: (Passes(seconds(given.get("seconds"))), ()),
    lambda event, _: {"seconds": event.time / MICROSECONDS},
    {"seconds": SECONDS},
    ("seconds",),
)
"""The JSON of time that passes."""
