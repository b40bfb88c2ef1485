"""The scripts of `bear.status` reach what chance seldom does: one field of many that changes alone."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

from missionfsm.bear.status.scripts import APART, SHOWN
from missionfsm.bear.wire.fields import MESSAGES
from missionfsm.bear.wire.protojson import camel

UNMOVED = {
    "mission.missionType",
    "mission.owner",
    "mission.missionFeedback",
}
"""What is reported of a mission has no such field: bear.mission judges them."""
PARTS = {"wifi": "core.Wifi", **{camel(one.name): one.type for one in MESSAGES["core.RobotState"]}}


def leaves(place: str, kind: str) -> Iterator[str]:
    """Every field below a message that has no fields of its own, by its path; of a oneof the first alternative."""
    for _, fields in itertools.groupby(MESSAGES[kind], key=lambda one: one.oneof or one.name):
        field = next(fields)
        path = f"{place}.{camel(field.name)}"
        if path not in UNMOVED:
            yield from leaves(path, field.type) if field.type in MESSAGES and not field.oneof else (path,)


def differences(place: str, one: Any, other: Any) -> Iterator[str]:
    """The paths at which two JSON values differ."""
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for pair in zip(one, other, strict=True):
            yield from differences(place, *pair)
    elif isinstance(one, dict) and isinstance(other, dict):
        for name in dict.fromkeys((*one, *other)):
            yield from differences(f"{place}.{name}", one.get(name), other.get(name))
    elif one != other:
        yield place


def test_every_field_of_a_status_changes_alone() -> None:
    """For each part, each field that a message about it has is somewhere the only one that a report changes."""
    alone = {
        found[0]
        for part, values in APART.items()
        for pair in itertools.pairwise(values)
        if len(found := list(differences(part, *pair))) == 1
    }
    wanted = {path for part, kind in PARTS.items() if part in APART for path in leaves(part, kind)}
    assert wanted - alone == set()
    assert {part for parts in SHOWN.values() for part in parts} == set(APART)
