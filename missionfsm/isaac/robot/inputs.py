"""What happens to a robot, as values: lines that arrive, time, and what has a name only."""

from __future__ import annotations

from attrs import frozen

from missionfsm.isaac.shared.drives import Passes
from missionfsm.kernel.codec import Happening

USABLE, NULL, SHALLOW, ODD, UNUSABLE = CONFIGURATIONS = ("usable", "null", "shallow", "odd", "unusable")
"""What a configuration is: an object of nodes; ``null``, or none at all; an object in which something is no node with
components; any other JSON; no JSON."""


@frozen(cache_hash=True)
class Arrives:
    """A line arrives: a mission with a configuration of one of the `CONFIGURATIONS`, or something else (None).

    `numeric` says that 64-bit integers in it are numbers, `foreign` that it is a message of another type.
    """

    mission: str | None = None
    named: bool = False
    numeric: bool = False
    foreign: bool = False
    channel: str = ""
    name: str = "line"


Event = Arrives | Passes | Happening
