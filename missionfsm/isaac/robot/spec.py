"""The robot's side of mission submission as a `Spec`: what a correct mission client may say on its connection."""

from __future__ import annotations

from missionfsm.isaac.robot import effects, readings, rules, stream
from missionfsm.isaac.robot.beginning import MIDDLE, begins
from missionfsm.isaac.robot.describe import describe
from missionfsm.isaac.robot.state import LIFECYCLE, SYSTEM_NAME, Codelet
from missionfsm.isaac.shared.drives import later
from missionfsm.isaac.shared.stream import sequence
from missionfsm.kernel.language import Abstraction, Drive, Happening, Invariant, Spec, each_met


def _canonical(here: Codelet) -> Codelet:
    """The codelet without the times: since when nothing may have been said."""
    return Codelet(here.world, here.begun, here.connected, here.running, here.named, here.used, here.waiting)


SPEC = Spec(
    SYSTEM_NAME,
    title="a robot's mission codelet",
    initial=Codelet,
    drives=(
        Drive("line", effects.arrives, revives=True, impossible=(rules.LINKED.id,)),
        Drive("behaviorSucceeded", effects.stops, (Happening("behaviorSucceeded"),), impossible=(rules.STARTS.id,)),
        Drive("behaviorFailed", effects.stops, (Happening("behaviorFailed"),), impossible=(rules.STARTS.id,)),
        Drive("advance", effects.passes, later=later),
        Drive("disconnect", effects.connection, ends=True, impossible=(rules.LINKED.id,)),
        Drive("connect", effects.connection, impossible=(rules.LINKED.id,)),
    ),
    urgent=begins,
    spontaneous=effects.ticks,
    matches=stream.matches,
    delivery=stream.delivery,
    unowed=stream.unowed,
    undelivered=stream.undelivered,
    sequence=sequence,
    names=lambda here: here.identifiers,
    ambiguities=readings.AMBIGUITIES,
    describe=describe,
    rules=rules.RULES,
    charts=(LIFECYCLE,),
    invariants=(
        Invariant(
            "only-missions-are-named", "An idle codelet has no mission.", lambda here: here.running or not here.named
        ),
        Invariant(
            "what-waits-is-final",
            "RUNNING does not wait.",
            lambda here: all(one.status != "running" for one in here.waiting),
        ),
    ),
    possibilities=(
        *each_met(LIFECYCLE.states, lambda here: (here.state,), "the-codelet-is-{}", "Some codelet is {}."),
        Invariant("a-mission-follows", "A mission runs after another.", lambda here: here.running and here.used),
        Invariant(
            "the-connection-drops",
            "Some robot is without a connection.",
            lambda here: here.begun and not here.connected,
        ),
    ),
    abstraction=Abstraction(enabled_key=_canonical, search_key=_canonical, canonical=_canonical),
    unopened=(rules.LINKED.id,),
    middle=MIDDLE,
)
