"""Every violation names a rule, also of a system of one's own that says no more than `missionfsm new` does."""

from __future__ import annotations

import pytest

from missionfsm.app.lamp import SYSTEM as LAMP
from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import check

HEAD: JSON = {"missionfsm": 1, "system": "lamp", "world": {}, "drives": ["timeIsUp"]}
SWITCH: JSON = {"call": 1, "method": "Switch", "params": {}}
OFF, ON, DIM = ({"stream": 1, "message": {"light": light}} for light in ("off", "on", "dim"))
WATCH: tuple[JSON, ...] = ({"call": 9, "method": "Watch", "params": {}}, {"return": 9, "result": {"stream": 1}})


def refused(code: str) -> JSON:
    return {"return": 1, "error": {"status": code, "message": ""}}


@pytest.mark.parametrize(
    ("lines", "rule"),
    [
        ((SWITCH, refused("NOT_FOUND")), "Switch/it-answers-as-documented"),
        ((SWITCH, refused("FAILED_PRECONDITION")), "Switch/it-answers-as-documented"),
        ((SWITCH, {"return": 1, "result": {"light": "on"}}), "Switch/it-answers-as-documented"),
        ((WATCH[0], {"return": 9, "result": {}}), "Watch/it-answers-as-documented"),
        (({**SWITCH, "method": "Dim"}, {"return": 1, "result": {}}), "Dim/FAILED_PRECONDITION/there-is-no-light"),
        (({"drive": {"event": "timeIsUp"}},), "timeIsUp/it-happens-only-where-it-can"),
        ((OFF,), "Watch/the-light-is-shown"),
        ((*WATCH, {"settled": True}), "Watch/the-light-is-shown"),
        ((*WATCH, ON), "Watch/the-light-is-shown"),
        ((*WATCH, {"stream": 1, "message": {"light": 7}}), "Watch/the-light-is-shown"),
        ((*WATCH, OFF, OFF), "Watch/the-light-is-shown"),
        ((*WATCH, OFF, {"stream": 1, "closed": True}), "Watch/the-light-is-shown"),
        ((*WATCH, OFF, SWITCH, {"return": 1, "result": {}}, {"settled": True}), "Watch/the-light-is-shown"),
        ((*WATCH, OFF, SWITCH, {"return": 1, "result": {}}, DIM), "Watch/the-light-is-shown"),
    ],
)
def test_a_lamp_that_is_wrong_breaks_one_rule(lines: tuple[JSON, ...], rule: str) -> None:
    """Where no rule of the page is broken, it is the one that goes without saying of what was asked or happened."""
    found = check(LAMP, head(HEAD), lines).violation
    assert found is not None
    assert [one.id for one in found.rules] == [f"lamp/{rule}"]
