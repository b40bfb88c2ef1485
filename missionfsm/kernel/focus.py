"""What an observation can tell of what happened silently before it: a partial-order reduction by the specification.

What a system does by itself may fall into parts that do not touch one another. All orders of all of them are very many;
an observation tells only of the part that it is about. What happens elsewhere happens as well, and is thought of when
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
    """What is observed.

    Attributes:
        kind: what it is.
        what: the request that was answered, or the event that was driven.
        refs: the positions of its names among those of the state, as for outcomes.
        answer: the answer, where a request was answered.
        topics: of the channels that may be those of a message or of an end; where everything has settled, of those that
            owe what has to be seen: nothing settles that does not rid them of it.
        calls: the requests in flight, which may take effect before it, each with the positions of its names.
        aside: whether it leaves the state as it is, and is about no channel that a call in flight may have opened.
    """

    kind: Kind
    what: Hashable = None
    refs: Refs = ()
    answer: Answer | None = None
    topics: tuple[Hashable, ...] = ()
    calls: tuple[tuple[Hashable, Refs], ...] = ()
    aside: bool = False
