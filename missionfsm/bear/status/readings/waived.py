"""The entries without a rule, and the readings that are not offered."""

from __future__ import annotations

from collections.abc import Mapping

WAIVED: Mapping[str, str] = {
    "AS-02 c": "an unknown id that is left out in silence: it would be a violation",
    "AS-04 c, d": "union and intersection of the two arms: they would be deviations",
    "AS-05 b": "each message twice under one number breaks the sequence rule",
    "AS-09 d": "INTERNAL may be answered to a subscription at any time",
    "AS-08 a, b": "a map is read entry by entry, so that one first message and several are the same",
    "AS-10": "numbers are compared within one stream and one robot alone, which is right in all three readings",
    "AS-11": "the first number after a restart is free on every stream; that none comes twice is the rule itself",
    "AS-13 latency": "no bound is documented; what has settled is judged",
    "AS-14 a, b": "the published definitions name the field, and protobuf JSON may leave out zeros",
    "AS-15 c to g": "combinations are the robot's own doing; where nobody drives it, those that last are reported",
    "AS-16": "what an emergency stop does to a mission or to wheels cannot be told from what is reported",
    "AS-17 e, f": "the sign of a rotation can be told only by somebody who sees the robot",
    "AS-19 a to c": "which reason stands in for an obstructed destination is the robot's own choice",
    "AS-20": "nothing follows from SEVERITY_HIGH alone: the examples show it with a running mission",
    "AS-21 c": "the mission is whatever the robot reports as such",
    "AS-22 c, d": "no verdict on current_goal_index beyond its range, -1 to the number of goals",
    "AS-23": "both kinds of stream are held to what was reported, so they agree once things have settled",
    "AS-24": "localization_state is not defined on the page: its content is not looked at",
    "AS-26 ownership": "nobody can drive that a robot changes its owner; INTERNAL may end a stream at any time",
    "AS-29 b": 'a list of changes is no reading of "currently active"',
    "AS-30": "what a stuck robot does is its own doing; that it goes on moving is reported once it lasts",
    "AS-31": "no bound for noticing that a robot is gone is documented; the sequence rule holds all the same",
    "AS-33": "robots of one stream are never ordered against one another",
    "AS-35": "how charging looks in the battery state is the robot's own doing",
}
"""Entries without a rule, and readings that are not offered, with the reason."""
