"""The reference, whatever readings it follows, conforms; and what it follows is among what is reported."""

from __future__ import annotations

import pytest

from missionfsm.kernel.alphabet import Bounds
from missionfsm.systems import system
from missionfsm.tools.conform import conform
from missionfsm.tools.subject import Reference

MISSION = system("bear.mission")
ALTERNATIVES = [
    (ambiguity.id, letter)
    for ambiguity in MISSION.spec.ambiguities
    for letter in ambiguity.readings
    if letter != ambiguity.default
]


@pytest.mark.slow
@pytest.mark.parametrize(("ambiguity", "letter"), ALTERNATIVES, ids=[f"{one}={letter}" for one, letter in ALTERNATIVES])
def test_the_reference_under_an_alternative_reading_conforms(ambiguity: str, letter: str) -> None:
    """A reference that follows a single alternative conforms; the reading is reported as possible, if it mattered."""
    verdict = conform(
        MISSION, Reference(MISSION, {ambiguity: letter}), examples=6, steps=25, seed=1, bounds=Bounds(2, 2, 2)
    )
    assert verdict.conforms, str(verdict)
    assert letter in verdict.readings.get(ambiguity, (letter,))
    for one in MISSION.spec.ambiguities:
        if one.id != ambiguity:
            assert one.default in verdict.readings.get(one.id, (one.default,))


def test_the_reference_conforms_under_its_own_readings() -> None:
    """The reference conforms where its readings are demanded, and does not where another is."""
    demanded = {one.id: one.default for one in MISSION.spec.ambiguities}
    conforming = conform(MISSION, Reference(MISSION), examples=10, steps=25, seed=1, readings=demanded)
    assert conforming.conforms, str(conforming)
    violating = conform(MISSION, Reference(MISSION), examples=40, steps=25, seed=1, readings={"AM-09": "b"})
    assert violating.outcome.value == "violates"


def test_the_same_seed_gives_the_same_verdict() -> None:
    """Whatever a verdict says, it says again for the same seed; another seed exercises other things."""
    verdicts = [
        conform(MISSION, Reference(MISSION, {"AM-09": "b"}), examples=10, steps=20, seed=seed) for seed in (5, 5, 6)
    ]
    assert verdicts[0].to_json() == verdicts[1].to_json()
    assert verdicts[0].exercised != verdicts[2].exercised
