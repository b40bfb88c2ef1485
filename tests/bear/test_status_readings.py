"""Every reading of bear.status that may be followed is accepted, and a contradictory mixture is not."""

from __future__ import annotations

import pytest
from status_helpers import SYSTEM, reference, walk

from missionfsm.bear.status.readings import AMBIGUITIES
from missionfsm.bear.status.readings.waived import WAIVED
from missionfsm.tools.check.verdict import Outcome

ALTERNATIVES = list(
    dict.fromkeys(
        (one.alike or one.id, letter) for one in AMBIGUITIES for letter in one.readings if letter != one.default
    )
)
"""Questions that are asked in several calls are answered alike in all of them here."""


@pytest.mark.long
@pytest.mark.parametrize(("entry", "letter"), ALTERNATIVES)
def test_every_single_alternative_reading_is_accepted(entry: str, letter: str) -> None:
    """The reference that follows it conforms on random walks, and the reading is never ruled out."""
    verdict = walk(reference({entry: letter}), walks=9, steps=30).verdict()
    assert verdict.outcome is Outcome.CONFORMS
    assert all(letter in verdict.readings.get(one, letter) for one in parts(entry, letter))


def parts(entry: str, letter: str) -> list[str]:
    """The ids of the ambiguities that an id speaks for, as far as they have the letter."""
    return [one.id for one in AMBIGUITIES if f"{one.id}.".startswith(f"{entry}.") and letter in one.readings]


@pytest.mark.parametrize(
    ("entry", "letter"),
    [
        ("AS-01", "b"),
        ("AS-02", "b"),
        ("AS-03.unknown", "b"),
        ("AS-05", "c"),
        ("AS-06.empty", "b"),
        ("AS-07.offline", "b"),
        ("AS-12.event", "b"),
        ("AS-22", "b"),
    ],
)
def test_an_implementation_that_follows_another_reading_than_it_has_to_is_caught(entry: str, letter: str) -> None:
    """Where the default is demanded, the alternative is a violation: the readings are told apart."""
    default = next(one.default for one in AMBIGUITIES if one.id in parts(entry, letter))
    found = walk(reference({entry: letter}), walks=40, readings={entry: default})
    assert found.verdict().outcome is Outcome.VIOLATES


def test_the_reference_conforms_with_and_without_its_drives() -> None:
    """What an adapter cannot drive the oracle does not expect to know."""
    assert walk(reference(), walks=12).verdict().outcome is Outcome.CONFORMS
    assert walk(reference(), walks=6, drives=()).verdict().outcome is Outcome.CONFORMS


def test_every_entry_is_an_ambiguity_or_waived() -> None:
    """AS-01 to AS-35, none left out."""
    known = {one.id.partition(".")[0] for one in AMBIGUITIES} | {part.partition(" ")[0] for part in WAIVED}
    assert sorted(known) == [f"AS-{number:02}" for number in range(1, 36)]
    assert SYSTEM.spec.ambiguities == AMBIGUITIES
