"""An implementation that others wrote in another language, from the page alone: the oracle and it agree."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from status_helpers import walk

from missionfsm.adapters.stdio import Child
from missionfsm.tools.check.verdict import Outcome

SUBJECT = Path(__file__).parent.parent / "subjects" / "bear_status.mjs"
NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")
DRIVES = ("report", "restart", "fault")


def breaks() -> list[str]:
    """The ways in which the subject can be told to deviate."""
    if NODE is None:
        return []
    listed = subprocess.run([NODE, SUBJECT, "--list-breaks"], capture_output=True, check=True).stdout
    return list(json.loads(listed))


class Subject(Child):
    """The subject behind its protocol."""

    def __init__(self, *options: str) -> None:
        super().__init__([str(NODE), str(SUBJECT), *options])
        about = self.exchange("initialize", {"protocolVersion": 1, "system": "bear.status"})
        assert tuple(about.result["drives"]) == DRIVES


@pytest.fixture
def subject() -> Iterator[Any]:
    made: list[Subject] = []

    def make(*options: str) -> Subject:
        made.append(Subject(*options))
        return made[-1]

    yield make
    for one in made:
        one.close()


@needs_node
def test_the_subject_conforms(subject: Any) -> None:
    """Two readers of the page agree: nothing that it does is a violation."""
    found = walk(subject(), walks=25, drives=DRIVES)
    assert (found.verdict().outcome, found.verdict().flagged) == (Outcome.CONFORMS, ())


TOLERATED = {"stream-closes-cleanly": "AS-26.", "location-leaks-foreign-robot": "AS-03."}
"""What is not held against anybody, and the reading that says so."""


WRONG = [one for one in breaks() if one not in TOLERATED]
SOME = WRONG[::6]
"""The others are tried in the long tests."""


def caught(broken: Any) -> bool:
    return walk(broken, walks=300, steps=30, drives=DRIVES).verdict().outcome is Outcome.VIOLATES


@needs_node
@pytest.mark.slow
@pytest.mark.parametrize("name", SOME)
def test_a_break_is_caught(subject: Any, name: str) -> None:
    """What it is told to do wrong is found on random walks."""
    assert caught(subject("--break", name))


@needs_node
@pytest.mark.long
@pytest.mark.parametrize("name", [one for one in WRONG if one not in SOME])
def test_every_other_break_is_caught(subject: Any, name: str) -> None:
    """So is each of the others."""
    assert caught(subject("--break", name))


@needs_node
@pytest.mark.parametrize(("name", "reading"), TOLERATED.items())
def test_what_is_tolerated_is_flagged(subject: Any, name: str, reading: str) -> None:
    """Each of them is explained on random walks, and some verdict names what it departs from."""
    broken = subject("--break", name)
    found = [walk(broken, walks=1, steps=30, drives=DRIVES, seed=seed).verdict() for seed in range(12)]
    assert {one.outcome for one in found} == {Outcome.CONFORMS}
    assert any(line.startswith(reading) for one in found for line in one.flagged)
