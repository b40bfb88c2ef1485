"""The scripts of `bear.status` reach what chance seldom does: one field of many that changes alone."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator
from typing import Any

from attrs import evolve

from missionfsm.bear.status.scripts import APART, SHOWN
from missionfsm.bear.status.system import SYSTEM
from missionfsm.bear.wire.fields import MESSAGES
from missionfsm.bear.wire.protojson import camel
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.tour import play
from missionfsm.tools.reference.subject import ReferenceSubject

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


class Shared:
    """The reference with a fault: what a message says of several robots has the metadata of the first of them."""

    def __init__(self) -> None:
        self.right = ReferenceSubject(SYSTEM)
        self.reports: Counter[str] = Counter()

    def exchange(self, method: str, params: JSON) -> Exchange:
        done = self.right.exchange(method, params)
        if method == "drive":
            self.reports[params["robotId"]] += 1
        first: dict[int, str] = {}

        def shared(said: Notification) -> Notification:
            [(name, entries)] = said.params["message"].items()
            robot = first.setdefault(said.params["stream"], next(iter(entries)))
            number = {"timestamp": "2025-04-01T16:45:00Z", "sequenceNumber": 1 + self.reports[robot]}
            entries = {name: {**entry, "metadata": number} for name, entry in entries.items()}
            return Notification(said.method, {**said.params, "message": {name: entries}})

        said = (shared(one) if len(one.params.get("message", ())) == 1 else one for one in done.after)
        return evolve(done, after=tuple(said))

    def close(self) -> None:
        """Nothing is held."""


def test_metadata_that_robots_share_are_noticed() -> None:
    """A robot that is shown with the number of another, which has counted further, is seen to count down."""
    run = Run.against(SYSTEM, Shared())
    assert not play(run)
    assert run.found is not None
    assert run.found.judge.violation is not None
    assert [one.id for one in run.found.judge.violation.rules] == ["bear.status/messages/sequence-numbers-grow"]
