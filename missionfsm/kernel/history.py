"""What can be observed of an implementation, as values.

Values that servers and adapters choose (mission ids, stream numbers, call ids) are *names*: an observation carries
them beside its content, in the order in which they occur, and the content refers to them by position. What is left is
drawn from a small alphabet, so that the oracle can know an event again when it comes with other names.
"""

from __future__ import annotations

from collections.abc import Hashable

from missionfsm.kernel.values import value

Name = Hashable
"""A mission id (text), ``("stream", 3)``, ``("call", 7)``, ``("connection", 1)``: names of two kinds never meet."""

Mark = tuple[Hashable, int]
"""A number that is only ever compared with its predecessor on the same track: (track, number)."""


@value(cache_hash=True)
class Answer:
    """What came back: a status name, and for OK the shape of the result without its names.

    `unordered` answers list their names in an order that means nothing.
    """

    code: str
    shape: Hashable = None
    unordered: bool = False

    def __str__(self) -> str:
        return self.code if self.shape is None else f"{self.code} {self.shape}"


@value
class Called:
    """A call is sent. `request` is a value of the system; `lost` says that no answer is known to come."""

    call: Name
    request: Hashable
    names: tuple[Name, ...] = ()
    lost: bool = False


@value
class Returned:
    """The answer to a call arrives."""

    call: Name
    answer: Answer
    names: tuple[Name, ...] = ()


@value
class Received:
    """A message arrives on a stream, or a line on a connection.

    It `repeats_last` if it says the same as the last one, and is `stale` if all that it says came on the stream before,
    by its numbers: also where this event is only a part of the message.
    """

    channel: Name
    content: Hashable
    names: tuple[Name, ...] = ()
    marks: tuple[Mark, ...] = ()
    repeats_last: bool = False
    stale: bool = False


@value
class Ended:
    """A stream ends by itself, with a status name or, cleanly, with OK; the other end closes a connection (OK)."""

    channel: Name
    code: str


@value
class Cancelled:
    """The subscriber gave a stream up: what still comes on it means nothing."""

    channel: Name


@value
class Driven:
    """The environment is known to have done this."""

    event: Hashable
    names: tuple[Name, ...] = ()


@value
class Settled:
    """All that was caused before has been seen."""


Event = Called | Returned | Received | Ended | Cancelled | Driven | Settled
