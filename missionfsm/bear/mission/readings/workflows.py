"""What `CreateMissionWorkflow` makes (AM-25 to AM-27)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import WORKFLOWS, part_of
from missionfsm.bear.mission.state import Kind
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_25 = asked_of_each(
    "AM-25",
    "How many missions does a {} workflow create?",
    {
        "a": "one",
        "b": "the main one and a return",
        "c": "one for each goal",
        "d": "one for each goal and a return",
        "x": "others, among which the goals of the request stand in their order",
    },
    {part_of(kind): kind.value for kind in WORKFLOWS},
    alike=False,
)
UNNAMED = (Kind.SERVI_BIRTHDAY, Kind.SERVI_HOSTING, Kind.SERVI_HOSTING_PATROL)
"""Workflows whose types no enum names (AM-26)."""

AM_26 = {
    kind: Ambiguity(
        f"AM-26.{part_of(kind).removeprefix('servi-')}",
        f"Which servi_type does a {kind.value.removeprefix('servi ')} workflow report?",
        {"a": "SERVI_TYPE_UNKNOWN or none", "b": "a number that is not documented", "c": "a documented type"},
    )
    for kind in UNNAMED
}
AM_27 = asked_of_each(
    "AM-27",
    "Is the automatically selected return point among the goals of a {} workflow's mission?",
    {"a": "no, the goals are those of the request", "b": "yes, it follows them"},
    {part_of(kind): kind.value for kind in WORKFLOWS},
    alike=False,
)
