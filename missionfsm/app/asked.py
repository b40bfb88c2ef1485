"""How a log is to be judged: what the reader asks for, besides what its first line says."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from attrs import evolve, field, frozen

from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.middle import in_the_middle
from missionfsm.kernel.readings import constrain
from missionfsm.kernel.system import System
from missionfsm.kernel.transport import over_transport
from missionfsm.systems import system


@frozen
class Asked:
    """How a log is to be judged.

    Attributes:
        readings: ambiguity id to the letter of the only reading that is to hold.
        profile: the name of a choice of readings of the system (`System.profiles`); None for none.
        no_flagged: whether nothing may depart from the letter of the text.
        strict: whether nothing was lost, doubled or made up on the way, whatever the first line says.
        anywhere: whether the log begins while the system is in use, whatever the first line says.
        others: whether others use the system as well, whose calls are not in the log, whatever the first line says.
        settled_after: how many seconds (of `at`) after its cause a message is late; None: never.
        eager: whether faults of the transport are considered at every event, not only where nothing else explains it.
        only: the robots that are to be judged; all if there are none.
    """

    readings: Mapping[str, str] = field(factory=dict)
    profile: str | None = None
    no_flagged: bool = False
    strict: bool = False
    anywhere: bool = False
    others: bool = False
    settled_after: float | None = None
    eager: bool = False
    only: frozenset[str | None] = frozenset()


@functools.cache
def judged_system(name: str, *, strict: bool, anywhere: bool = False, others: bool = False) -> System:
    """The system as a log of it is judged: seen through its transport, unless that is strict.

    A system without streams has no such transport: Isaac's lines travel over one TCP connection.

    Args:
        anywhere: whether the log begins while the system is in use.
        others: whether others use it as well.

    Raises:
        UnreadableError: there is no such system, or no log of it can be judged so.
    """
    found = system(name)
    middle = found.spec.middle
    if (anywhere or others) and middle is None:
        says = "a log of it has to begin with its beginning" if anywhere else "it does not say what others may do"
        message = f"{name}: {says}"
        raise UnreadableError(message)
    spec = in_the_middle(found.spec, anywhere=anywhere, others=others)
    if anywhere or others:  # the situations of an unknown state are unknown
        found = evolve(found, matrix=None)
    return evolve(found, spec=spec if strict or not found.codec.streams else over_transport(spec))


def refuse_json_only(of: System, readings: Mapping[str, str]) -> None:
    """Raise ValueError for readings that nothing over gRPC can follow; its text names them."""
    bits = constrain(of.spec.ambiguities, readings)
    left = {one: one.possible(bits) for one in of.spec.ambiguities}
    only = [f"{one.id}={','.join(letters)}" for one, letters in left.items() if one.json_only.issuperset(letters)]
    if only:
        message = f"{' and '.join(only)}: only JSON can say it; over gRPC there is one form, and nothing follows it"
        raise ValueError(message)
