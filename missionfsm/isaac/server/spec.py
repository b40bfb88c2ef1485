"""The mission server as a `Spec`: what a correct one may do, under any consistent choice of readings."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from attrs import evolve

from missionfsm.isaac.server import effects, rules
from missionfsm.isaac.server.abstraction import canonical, explore_size, idle_search_key, search_key, search_size
from missionfsm.isaac.server.describe import describe
from missionfsm.isaac.server.foresight import foresees, heeded
from missionfsm.isaac.server.properties import INVARIANTS, POSSIBILITIES
from missionfsm.isaac.server.readings import AI_39, AMBIGUITIES
from missionfsm.isaac.server.rules import OPERATIONS, RULES
from missionfsm.isaac.server.silent import silent_for, spontaneous_steps, urgent_steps
from missionfsm.isaac.server.state import LIFECYCLE, PASS_PERIOD, SYSTEM_NAME, Server
from missionfsm.isaac.server.stream import agrees, matches
from missionfsm.isaac.server.unowed import unowed
from missionfsm.isaac.server.unseen import calmed
from missionfsm.isaac.shared.drives import elapses, later
from missionfsm.isaac.shared.stream import sequence
from missionfsm.kernel.abstraction import Abstraction
from missionfsm.kernel.readings import UNCONSTRAINED
from missionfsm.kernel.rules import Operation
from missionfsm.kernel.spec import Delivery, Drive, Spec

_DELIVERY = Delivery(
    unowed=(rules.SENT.id,), unending=(rules.OTHER.id,), malformed=(rules.ENVELOPE.id,), every_time=True
)
"""What is broken by a line that nothing owes, by one that does not come, and by a connection that is ended."""


def _begins(server: Server) -> Server:
    """A server that has just begun: when in its first period the passes begin is not said."""
    return evolve(server, slow=PASS_PERIOD) if "b" in server.letters(AI_39) else server


def specification(operations: Mapping[str, Operation] = OPERATIONS, decided: int = UNCONSTRAINED) -> Spec:
    """The mission server with the rules of these operations, and with these readings decided from the start."""
    left = tuple(
        (one.id, "".join(letters))
        for one in sorted(AMBIGUITIES, key=lambda one: one.id)
        if len(letters := one.possible(decided)) < len(one.readings)
    )
    return Spec(
        system=SYSTEM_NAME,
        title="a mission server",
        initial=lambda world: _begins(
            Server(world.name_channel, left=left, tolerance=world.tolerance, unsteady=world.unsteady)
        ),
        operations=operations,
        outcomes=functools.partial(effects.outcomes, operations),
        drives=(
            Drive("connect", effects.connect, heeded=heeded),
            Drive("line", effects.line, impossible=(rules.NAMED.id,), heeded=heeded),
            Drive(
                "disconnect",
                effects.disconnect,
                ends=True,
                impossible=(rules.DROPPED.id,),
                undriven=lambda world: evolve(world, unsteady=True),
                heeded=heeded,
            ),
            Drive("advance", effects.advance, later=later, elapses=elapses),
        ),
        urgent=urgent_steps,
        spontaneous=spontaneous_steps,
        silent_for=silent_for,
        calmed=calmed,
        matches=matches,
        delivery=lambda _: _DELIVERY,
        closing=effects.closing,
        foresees=foresees,
        unopened=(rules.UNNAMED.id,),
        unowed=unowed,
        sequence=sequence,
        names=effects.names_of,
        ambiguities=AMBIGUITIES,
        describe=describe,
        rules=RULES,
        charts=(LIFECYCLE,),
        invariants=INVARIANTS,
        possibilities=POSSIBILITIES,
        answers=agrees,
        abstraction=Abstraction(
            search_key=search_key,
            idle_search_key=idle_search_key,
            search_size=search_size,
            explore_size=explore_size,
            canonical=canonical,
        ),
        decided=functools.partial(specification, operations),
        rebuilt=specification,
    )


SPEC = specification()
