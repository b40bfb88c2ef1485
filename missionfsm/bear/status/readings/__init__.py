"""Where the Robot Status page can be read in more than one way, by themes; ``specs/bear-status.md`` argues each entry.

A name is that of its entry, and letters are those of the entry. An entry with several independent questions has an
ambiguity for each, with a word after its number; one that is asked in several calls has a part for each, with the name
of the call at its end (``AS-03.unknown.SubscribeBatteryStatus``): every call has a table of its own, and no sentence of
the page says that two calls answer alike. Readings that would be violations are not offered. The files import the
kernel and what a state is. Begin with `selecting`.
"""

from __future__ import annotations

from missionfsm.bear.status.readings import selecting, streams, unknown, values
from missionfsm.bear.status.readings.waived import WAIVED
from missionfsm.kernel.readings import Ambiguity, declared

__all__ = ["AMBIGUITIES", "WAIVED"]

AMBIGUITIES: tuple[Ambiguity, ...] = tuple(
    sorted(
        (one for theme in (selecting, streams, unknown, values) for one in declared(vars(theme), Ambiguity)),
        key=lambda one: one.id.partition(".")[0],
    )
)
"""In the order of the entries."""
