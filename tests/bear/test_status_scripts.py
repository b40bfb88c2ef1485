"""The scripts of `bear.status` reach what chance seldom does: one field of many that changes alone."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from attrs import evolve

from missionfsm.adapters.stdio import Child
from missionfsm.app.foreign import subjects
from missionfsm.bear.status.samples import SHORT
from missionfsm.bear.status.scripts import APART, SHOWN
from missionfsm.bear.status.system import SYSTEM
from missionfsm.bear.wire.fields import MESSAGES
from missionfsm.bear.wire.protojson import camel
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.tour import follow, play
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


def merged(before: Any, report: Any) -> Any:
    """What becomes of a report that is merged into the one before, member by member."""
    if isinstance(before, dict) and isinstance(report, dict):
        return {**before, **{name: merged(before.get(name), one) for name, one in report.items()}}
    if isinstance(before, list) and isinstance(report, list):
        return [merged(*pair) for pair in itertools.zip_longest(before[: len(report)], report)]
    return report


def test_of_every_part_a_report_leaves_members_out() -> None:
    """Who merges it into the one before, in whatever depth, shows what was not reported; also of other families."""
    several = {part for part, kind in PARTS.items() if len(list(leaves(part, kind))) > 1 or part == "errorCodes"}
    assert several == set(SHORT)
    for part, values in SHORT.items():
        assert all(merged(APART[part][0], value) != value for value in values), part


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


STRANGERS = {one.name: one for one in subjects(Path(__file__).parent.parent / "strangers" / SYSTEM.name)}
LEADS_TO = {
    "get-cached": ("GetRobotStatus",),
    "twist-kept": ("GetRobotStatus",),
    "lost-wifi-silent": ("SubscribeNetworkStatus", "guests"),
    "offline-location-not-found": ("SubscribeBatteryStatus", "DISCONNECTED"),
    "reconnect-leaves-deaf": ("SubscribeBatteryStatus", "DISCONNECTED"),
    "cancel-ends-topic": ("SubscribeBatteryStatus", "cancel"),
    "moved-robot-lost": ("SubscribeBatteryStatus", "move"),
    "restart-counter-stuck": ("SubscribeBatteryStatus", "restart"),
    "updates-reversed": ("SubscribeBatteryStatus", "restart"),
}
"""Faults that chance was late to meet, each with words of the scripts that lead there."""


def led(name: str, words: tuple[str, ...]) -> bool:
    """Whether all that a stranger says in the scripts with some words can be explained."""
    scripts = [one for one in SYSTEM.alphabet({}, Bounds()).scripts if all(word in str(one) for word in words)]
    child = Child(STRANGERS[name].command, folder=STRANGERS[name].folder)
    run = Run.against(SYSTEM, child)
    try:
        for script in scripts:
            run.start(run.guide.worlds[0])
            if not all(follow(run, step) for step in script) or not run.settle():
                return False
    finally:
        child.close()
    assert scripts
    return True


@pytest.mark.parametrize("fault", LEADS_TO)
def test_scripts_lead_to_a_fault(fault: str) -> None:
    """What happens to a robot or a stream is tried with all subscriptions, and what comes after it is looked at."""
    assert not led(f"bug-{fault}", LEADS_TO[fault])


@pytest.mark.parametrize("words", sorted(set(LEADS_TO.values())), ids="-".join)
def test_scripts_lead_to_no_false_alarm(words: tuple[str, ...]) -> None:
    """Nor do they find anything in those that are right."""
    assert led("base", words)
