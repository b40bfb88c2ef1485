"""What happens to a robot, as values: lines that arrive, time, and what has a name only."""

from __future__ import annotations

from attrs import frozen

from missionfsm.isaac.shared.drives import Passes
from missionfsm.kernel.codec import Happening

USABLE, NULL, BLANK, SHALLOW, ODD, UNUSABLE = "usable", "null", "blank", "shallow", "odd", "unusable"
"""What a configuration is: an object of nodes; ``null``; an empty text; an object in which something is no node with
components; any other JSON; no JSON."""


@frozen(cache_hash=True)
class Arrives:
    """A line arrives: a mission, by what its configuration is, or something else (None).

    Attributes:
        numeric: whether 64-bit integers in it are numbers.
        foreign: whether it is a message of another type, or (garbled) a mission whose header says so.
        untyped: whether its header has no type id, or an unsigned one.
        misplaced: whether its configuration is no text that holds JSON, but the JSON itself.
        garbled: whether something else in it is not written as documented: a field that nobody knows, no
            configuration, a number with leading zeros, a value of another type or out of range. It is a mission, or
            nothing.
        nodes: whether its configuration says something of nodes, of which nobody knows whether the robot has them.
    """

    mission: str | None = None
    named: bool = False
    numeric: bool = False
    foreign: bool = False
    channel: str = ""
    untyped: bool = False
    misplaced: bool = False
    garbled: bool = False
    nodes: bool = False
    name: str = "line"


Event = Arrives | Passes | Happening
