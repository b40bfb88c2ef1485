"""How a log is to be judged: what its reader says of it, besides what its own first line says."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from attrs import evolve, field, frozen

from missionfsm.kernel.system import System
from missionfsm.kernel.transport import over_transport
from missionfsm.systems import system


@frozen
class Asked:
    """How a log is to be judged.

    Attributes:
        readings: ambiguity id to the letter of the only reading that is to hold.
        no_flagged: whether nothing may depart from the letter of the text.
        strict: whether nothing was lost, doubled or made up on the way, whatever the first line says.
        eager: whether everything that a transport does is thought of at every event, not only where it is needed.
        only: the robots that are to be judged; all if there are none.
    """

    readings: Mapping[str, str] = field(factory=dict)
    no_flagged: bool = False
    strict: bool = False
    eager: bool = False
    only: frozenset[str | None] = frozenset()


@functools.cache
def judged_system(name: str, *, strict: bool) -> System:
    """The system with a name as a log of it is judged: seen through the transport, unless that is strict.

    What has no streams has none that could lose anything: Isaac's lines travel over one TCP connection.

    Raises:
        UnreadableError: there is no such system.
    """
    found = system(name)
    return found if strict or not found.codec.streams else evolve(found, spec=over_transport(found.spec))
