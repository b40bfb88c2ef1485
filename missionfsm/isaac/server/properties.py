"""What holds of every mission server, and what some server can come to."""

from __future__ import annotations

from missionfsm.isaac.server.state import ENDED, LIFECYCLE, UNDER_WAY, Server
from missionfsm.kernel.possibilities import each_met
from missionfsm.kernel.spec import Invariant


def _one_serves(server: Server) -> bool:
    served = [one.name for one in server.links if one.serves]
    return len(served) == len(set(served)) and None not in served


INVARIANTS = (
    Invariant("one-connection-serves-a-robot", "No robot is served on two connections.", _one_serves),
    Invariant(
        "what-is-sent-has-no-open-upstream",
        "A mission that was sent waits for nothing, and no upstream of it has failed.",
        lambda server: all(not one.waits and not one.doomed for one in server.missions if one.sent),
    ),
    Invariant(
        "what-has-ended-has-no-clock",
        "No clock runs for a mission that has ended.",
        lambda server: all(not one.clocks for one in server.missions if one.status in ENDED),
    ),
    Invariant(
        "what-is-under-way-was-sent",
        "Only a mission that was sent is under way.",
        lambda server: all(one.sent for one in server.missions if one.status in UNDER_WAY),
    ),
)
POSSIBILITIES = each_met(
    LIFECYCLE.states, lambda server: (one.status for one in server.missions), "a-mission-is-{}", "Some mission is {}."
)
