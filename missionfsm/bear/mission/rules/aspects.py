"""What a refusal looks at: readings that rank refusals go by it (AM-01, AM-04, AM-38).

What is wrong with the request is ranked against the state where its code is INVALID_ARGUMENT: a refusal of SHAPE or
GOALS with another code is not.
"""

from __future__ import annotations

FORM = "form"
"""Whether the request can be decoded at all: whoever looks at something else first has no request to do so for."""

SHAPE = "shape"
"""What a decoded request says by itself."""

GOALS = "goals"
"""What is there in the world of what the request is about: destinations, a dock, a charging location."""

EITHER = "either"
"""What may be checked with the shape or with the goals; AM-01 read as c has the state between them."""

TAKEN = "taken"
"""Goals that others have taken: neither the request nor the missions, so it is looked at first, last or between."""

STATE = "state"
"""The robot's missions."""

ABILITY = "ability"
"""Whether the robot is able to start a mission."""
