"""What lies between an implementation and a log of it: a transport that loses, repeats and ends things by itself.

A page says what a robot does; a log holds what came through. Each way in which the two differ is an ambiguity of its
own: it did not happen (a), or it did (b), which is flagged. The oracle assumes "b" only if nothing else explains an
event, and a verdict says where that was. If there is no transport in between, as over stdin and stdout, the plain
specification judges, which has none of this.
"""

from __future__ import annotations

from attrs import evolve

from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.rules import (
    CANCELLED,
    DEADLINE_EXCEEDED,
    OK,
    RESOURCE_EXHAUSTED,
    UNAUTHENTICATED,
    UNAVAILABLE,
    UNKNOWN,
)
from missionfsm.kernel.spec import Failure, Spec


def _reading(number: int, question: str, happened: str) -> Ambiguity:
    readings = {"a": "no", "b": happened}
    return Ambiguity(f"TR-{number:02}", question, readings, default="a", flagged="b")


TR_01 = _reading(
    1,
    "Did a stream end that nothing on the page ends?",
    "yes, cleanly or with the client's own DEADLINE_EXCEEDED, as streams do that have lasted long enough",
)
TR_02 = _reading(
    2, "Did a message come twice?", "yes, the same number, timestamp and content again: that is a redelivery"
)
TR_03 = _reading(
    3, "Was a message lost?", "yes, one that was owed never came; never the first of a stream, which shows the state"
)
TR_04 = _reading(
    4,
    "Did a client or a gateway make the status of an answer by itself?",
    "yes, so the call may have taken effect or not, at once or later",
)
TR_05 = _reading(5, "Did the robot restart?", "yes: its list is empty, and its numbers start over at 0")
TR_06 = _reading(
    6,
    "Is the robot's software older than a call?",
    "yes, so it refuses every call that came later with FAILED_PRECONDITION",
)
TRANSPORT = (TR_01, TR_02, TR_03, TR_04, TR_05, TR_06)
"""All of them, in the order of their numbers."""

MADE_BY_CLIENTS = frozenset(
    {
        DEADLINE_EXCEEDED,
        CANCELLED,
        UNAVAILABLE,
        UNAUTHENTICATED,
        RESOURCE_EXHAUSTED,
        UNKNOWN,
    }
)
"""The statuses that any gRPC client or gateway may make by itself, on every call."""

MADE_UP = Failure((TR_04["b"],), open_ended=True)
"""An answer with such a status, which leaves open what becomes of the call."""

TOO_OLD = Failure((TR_06["b"],))
"""A refusal of a call that the robot's software does not know yet."""

REDELIVERED = "redelivered"
"""The relation of a message to the one before if number, timestamp and content are the same."""

ENDS = frozenset({OK, DEADLINE_EXCEEDED})
"""How a transport ends a stream that has lasted long enough."""


def over_transport(spec: Spec) -> Spec:
    """The same system, seen through a transport that is not perfect."""
    decided = spec.decided
    unwatched = (one.unwatched.reading for one in spec.drives.values() if one.unwatched)
    return evolve(
        spec,
        transport=True,
        ambiguities=(*spec.ambiguities, *TRANSPORT, *unwatched),
        decided=None if decided is None else lambda assumed: over_transport(decided(assumed)),
        rebuilt=None,
    )


__all__ = ["ENDS", "MADE_BY_CLIENTS", "MADE_UP", "REDELIVERED", "TOO_OLD", "TRANSPORT", "over_transport"]
