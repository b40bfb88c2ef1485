"""What may come of a call to a robot of the Mission page: a code, an edit of the robot, and what that assumes."""

from __future__ import annotations

from missionfsm.bear.mission.edits import Edit
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.values import value

Assumed = tuple[Assumption, ...]

Way = tuple[Edit, Assumed]
"""One way in which something takes effect, with what it assumes."""

ADDED, ACTIVE, GONE, NOBODY, STREAM = "those added", "the active one", "those that vanish", "none", "a stream"
"""Which ids an answer has."""


@value
class Outcome:
    """One answer that is allowed in a situation, with the edit that comes with it."""

    code: str
    edit: Edit = ()
    whose: str = NOBODY
    assumes: Assumed = ()
    rules: tuple[str, ...] = ()
    applied: bool = True
    """See `missionfsm.kernel.step.Step`."""
