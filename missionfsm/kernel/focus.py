"""Which silent steps an observation can tell of: a partial-order reduction that the specification provides.

What a system does by itself may fall into parts that do not touch one another, and steps of all parts in all orders are
too many to consider. An observation tells only of the part that it is about. Steps of other parts are considered when
something is observed there.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Final, Literal

from missionfsm.kernel.history import Answer
from missionfsm.kernel.terms import Refs
from missionfsm.kernel.values import value

Kind = Literal["received", "returned", "driven", "ended", "settled"]
"""What is observed, after the events of `missionfsm.kernel.history`."""

RECEIVED: Final = "received"
RETURNED: Final = "returned"
DRIVEN: Final = "driven"
ENDED: Final = "ended"
SETTLED: Final = "settled"


@value(cache_hash=True)
class Focus:
    """An observation.

    Attributes:
        kind: which kind of event it is.
        what: the request that was answered, or the event that was driven.
        refs: the positions of its names among those of the state, as for outcomes.
        answer: the answer, if a request was answered.
        topics: for a message or an end: the topics of the channels that it may be on. For `SETTLED`: the topics of the
            channels that owe a message, since only steps that withdraw it let things settle.
        calls: the requests in flight, which may take effect before it, each with the positions of its names.
        aside: whether it leaves the state as it is, and is on no channel that a call in flight may have opened.
    """

    kind: Kind
    what: Hashable = None
    refs: Refs = ()
    answer: Answer | None = None
    topics: tuple[Hashable, ...] = ()
    calls: tuple[tuple[Hashable, Refs], ...] = ()
    aside: bool = False
