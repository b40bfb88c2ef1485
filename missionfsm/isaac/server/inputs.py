"""What a caller asks of the mission server, and what happens to it: requests and events, as values."""

from __future__ import annotations

from missionfsm.isaac.shared.line import MICROSECONDS
from missionfsm.kernel.terms import Refs
from missionfsm.kernel.values import value

NAME, STATUS, NOISE, BLANK, BAD, FOREIGN = "name", "status", "noise", "blank", "bad", "foreign"
"""What a line can be: a name, a status, a message for nobody, empty, no message, one of another type."""

DEFAULT_CHANNEL = "mission"
"""The channel of a mission that names none."""

DEFAULT_START = 5 * MICROSECONDS
"""The time that a mission has to start if it does not say so, in microseconds."""


@value(cache_hash=True)
class Submission:
    """A mission that is submitted, or what is wrong with it; `upstream` says how many handles it names.

    Attributes:
        start, run: the timeouts in microseconds; None is infinite.
        defects: what is wrong with it by itself: words of `DEFECTS`.
    """

    robot: str | None = None
    channel: str = DEFAULT_CHANNEL
    status_channel: str | None = None
    config: str = "{}"
    start: int | None = DEFAULT_START
    run: int | None = None
    upstream: int = 0
    defects: tuple[str, ...] = ()
    operation: str = "submit"


MALFORMED, HANDLE, NEGATIVE, KEY, NULL, EMPTY, NO_NAME, NULL_CONFIG = DEFECTS = (
    "it is not of the documented form",
    "an upstream is no handle",
    "a timeout is negative",
    "a key is unknown",
    "a field is null",
    "a channel is empty",
    "the robot's name is empty",
    "the configuration is null",
)


@value(cache_hash=True)
class Ask:
    """A submission with the missions that its handles mean; None for a handle that is nobody's."""

    submission: Submission
    upstream: Refs = ()


@value(cache_hash=True)
class Statuses:
    """The statuses of all missions are asked for."""

    operation: str = "statuses"


@value(cache_hash=True)
class Connects:
    """A robot connects; the event's name is the connection's."""

    name: str = "connect"


@value(cache_hash=True)
class Drops:
    """A connection drops; the event's name is the connection's."""

    name: str = "disconnect"


@value(cache_hash=True)
class Incoming:
    """A line that a robot sends.

    It is a text (`NAME`, on whatever channel), a `STATUS`, `NOISE` (a message for nobody), `BLANK`, `BAD`, or of a
    `FOREIGN` type.

    Attributes:
        what: the name's text, or the status.
        named: whether the payload names a mission; its name is the event's second.
        header: whether the header has an identifier; its name is the event's last.
        numeric: whether 64-bit integers in it are numbers.
        untyped: whether its header has no type id, or an unsigned one.
        odd: whether it is a status in capitals, or a number.
        garbled: whether something else in it is not written as documented, so that it may be no message: a field that
            nobody knows, a number with leading zeros, of another type or out of range.
    """

    kind: str
    what: str = ""
    channel: str = ""
    named: bool = False
    header: bool = False
    numeric: bool = False
    untyped: bool = False
    odd: bool = False
    garbled: bool = False
    name: str = "line"
