"""No text of an implementation puts a line of its own into what people read, nor anything that a terminal obeys."""

from __future__ import annotations

from typing import Any

import pytest
from broken import MISSION

from missionfsm import check
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.reference.subject import ReferenceSubject

MARKS = ("\n", "\r\n", "\x85", "\u2028", "\x1b[2J\x1b[31m", "\x07", "\u202e")
FORGED = "".join(f"a{mark}forged: conforms" for mark in MARKS)
CREATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
HEAD: JSON = {"missionfsm": 1, "system": "bear.mission", "world": {}}


def spoiled(value: Any) -> Any:
    """The same with something after every id that an implementation may choose."""
    if isinstance(value, dict):
        return {
            key: one + FORGED if key == "missionId" and isinstance(one, str) else spoiled(one)
            for key, one in value.items()
        }
    return [spoiled(one) for one in value] if isinstance(value, list) else value


class Hostile:
    """A reference whose names are chosen to be printed; what is wrong with it is `broken`."""

    def __init__(self, broken: str) -> None:
        self._broken = broken
        self._inner = ReferenceSubject(MISSION)

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Ask the reference, and spoil what it says."""
        if method == "UpdateMission":
            return Exchange(error={"status": "INTERNAL", "message": FORGED})
        found = self._inner.exchange(method, params)
        if method == "initialize":
            own = {"implementation": {"name": FORGED, "version": FORGED}, "drives": [FORGED, "goalReached"]}
            world = {"destinations": [f"table-1{FORGED}"], "family": "carti"}
            return Exchange({**found.result, **own, "worlds": "fixed", "world": world})
        if method == self._broken:
            return Exchange(error={"status": "NOT_FOUND", "message": FORGED})
        return Exchange(spoiled(found.result), found.error)

    def close(self) -> None:
        """Nothing is held."""


def forged(text: str) -> list[str]:
    """The lines that an implementation has made, or with which it would do something to a terminal."""
    return [line for line in text.split("\n") if line.startswith("forged") or not line.isprintable()]


@pytest.mark.parametrize("broken", ["SkipGoal", "ChargeRobot", "AppendMission"])
def test_a_verdict_has_no_line_of_an_implementation(broken: str) -> None:
    """Names, versions, drives, worlds, ids, codes and messages are text that is shown, whatever is in them."""
    verdict = conform(MISSION, Hostile(broken), drawn=2, tours=8, steps=20, seed=1, advice=False)
    assert not verdict.conforms
    assert "forged" in verdict.text(verbose=True)
    assert forged(verdict.text(verbose=True)) == []


def recorded(*lines: JSON) -> Verdict:
    return check((HEAD, *lines))


def test_a_record_has_no_line_of_an_implementation_in_its_verdict() -> None:
    """The same of a history: ids, codes, messages, and names that no call was answered with."""
    name = f"m{FORGED}"
    create = {"call": 1, "method": "CreateMission", "params": CREATE}
    subscribe = {"call": 2, "method": "SubscribeMissionStatus", "params": {}}
    message = {"missionStatuses": [{"missionId": f"other{FORGED}", "state": FORGED}], "metadata": {"sequenceNumber": 0}}
    for lines in (
        (create, {"return": 1, "error": {"status": "NOT_FOUND", "message": FORGED}}),
        (create, {"return": 1, "result": {"missionId": name, FORGED: 1}}),
        (
            create,
            {"return": 1, "result": {"missionId": name}},
            {"call": 3, "method": "CreateMission", "params": CREATE},
            {"return": 3, "result": {"missionId": name}},
        ),
        (
            create,
            {"return": 1, "result": {"missionId": name}},
            subscribe,
            {"return": 2, "result": {"stream": 1}},
            {"stream": 1, "message": message},
        ),
    ):
        verdict = recorded(*lines)
        assert forged(verdict.text(verbose=True)) == [], verdict
