"""Implementations that were made from the pages alone (tests/strangers): a sample of them is judged as it deserves."""

from __future__ import annotations

from pathlib import Path

import pytest

from missionfsm import systems
from missionfsm.app.foreign import judge_all, subjects

STRANGERS = Path(__file__).parent / "strangers"
SAMPLE = 60
"""Of so many faults one is judged, that in the middle; all are for `missionfsm teeth SYSTEM --subjects FOLDER`."""
SECONDS = 90.0
"""How long one is judged at most; making a story short may take longer."""


@pytest.mark.long
@pytest.mark.parametrize("name", systems.names())
def test_a_sample_of_their_faults_is_noticed(name: str) -> None:
    """Each of the sample is a violation, and names a rule."""
    faults = [one for one in subjects(STRANGERS / name) if one.verdict == "violates"]
    report = judge_all(name, faults[SAMPLE // 2 :: SAMPLE], seed=1, seconds=SECONDS, jobs=1)
    assert [str(one) for one in report.wrong] == []
    assert all(one.rules for one in report.judged if not one.only_flagged)


@pytest.mark.parametrize("name", systems.names())
def test_each_of_them_is_named_once(name: str) -> None:
    """A folder for every system, with one that is right and has no fault first, other right ones, and faults."""
    found = subjects(STRANGERS / name)
    assert (found[0].name, found[0].verdict) == ("base", "conforms")
    assert {one.verdict for one in found[1:]} == {"conforms", "violates"}
    assert all((STRANGERS / name / one.command[1]).is_file() for one in found)
