"""The tester keeps the protocol: a strict adapter fails on anything that docs/adapter.md does not allow."""

from __future__ import annotations

import itertools
from typing import Any

import pytest
from attrs import define, field
from broken import BUSY, MISSION, answering

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification, Subject, SubjectError
from missionfsm.tools.check.verdict import Outcome
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.finding import NOT_CARRIED
from missionfsm.tools.reference.subject import ReferenceSubject

DRIVES = ("goalReached", "missionSucceeded", "missionFailed", "world", "fault")
OWN = ("initialize", "reset", "settle", "drive", "cancel")


@define
class Strict:
    """An adapter that has some of the drives and calls, and fails on what the protocol does not allow."""

    subject: Subject
    declared: dict[str, Any]
    sent: list[str] = field(factory=list)
    armed: str | None = None

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Answer, or fail where the tester does what it may not."""
        self.sent.append(method)
        assert isinstance(params, dict), f"{method} with params {params!r}"
        methods = self.declared.get("methods")
        assert methods is None or method in (*OWN, *methods), f"{method} was not declared"
        if method == "drive":
            assert params["event"] in self.declared["drives"], f"{params} was not declared"
            assert params["event"] != "fault" or self.armed is None, "a fault waits already"
        if method == "reset":
            assert params["world"] == self.declared.get("world", params["world"]), f"there is no world {params}"
            self.armed = None
        found = self.subject.exchange(method, params)
        if method == "initialize":
            return Exchange({**found.result, **self.declared})
        if method == "drive" and params["event"] == "fault" and found.result["happened"]:
            self.armed = params["status"]
        if found.error is not None and found.error["status"] == self.armed:
            self.armed = None
        return found

    def close(self) -> None:
        """Nothing is held."""


SUBSETS = [
    *(DRIVES, ("missionFailed", "fault")),
    *(pytest.param(one, marks=pytest.mark.long) for one in ((), ("fault",), ("goalReached", "world"), DRIVES[:4])),
]


@pytest.mark.slow
@pytest.mark.parametrize("drives", SUBSETS, ids="-".join)
def test_only_what_is_declared_is_driven(drives: tuple[str, ...]) -> None:
    """Whatever drives an adapter has: none other is sent, and no second fault while one waits, to a right one."""
    adapter = Strict(ReferenceSubject(MISSION, {}), {"drives": list(drives)})
    verdict = conform(MISSION, adapter, drawn=3, tours=4, steps=15, seed=2, advice=False)
    assert verdict.outcome is Outcome.CONFORMS


@pytest.mark.slow
@pytest.mark.parametrize("drives", SUBSETS, ids="-".join)
def test_a_story_is_made_short_with_what_is_declared(drives: tuple[str, ...]) -> None:
    """A violation is found and made short without a drive that the adapter has not."""
    adapter = Strict(answering("NOT_FOUND", BUSY), {"drives": list(drives)})
    verdict = conform(MISSION, adapter, drawn=5, tours=20, steps=20, seed=2, advice=False)
    assert verdict.outcome is Outcome.VIOLATES


def test_calls_that_are_not_declared_are_not_made() -> None:
    """An adapter that says which calls it has is asked for those alone."""
    methods = ["CreateMission", "SubscribeMissionStatus"]
    adapter = Strict(ReferenceSubject(MISSION, {}), {"drives": list(DRIVES), "methods": methods})
    verdict = conform(MISSION, adapter, drawn=2, tours=4, steps=15, seed=1, advice=False)
    assert verdict.outcome is Outcome.CONFORMS
    assert set(adapter.sent) <= {*OWN, *methods}


def test_no_world_but_the_fixed_one_is_asked_for() -> None:
    """An adapter whose world is fixed is reset to that one every time."""
    declared = {"drives": list(DRIVES), "worlds": "fixed", "world": {"family": "base"}}
    verdict = conform(
        MISSION, Strict(ReferenceSubject(MISSION, {}), declared), drawn=2, tours=4, steps=15, seed=1, advice=False
    )
    assert verdict.outcome is Outcome.CONFORMS


@pytest.mark.parametrize("requests", ["json", "binary"])
def test_what_only_json_can_carry_is_told_with_the_way_round_it(requests: str) -> None:
    """A wrong answer to two members of a oneof comes with the word that ends such questions, which does end them."""
    malformed = "bear.mission/CreateMission/INVALID_ARGUMENT/the-request-is-malformed"
    declared = {"drives": [], "methods": ["CreateMission"], **({"requests": "binary"} if requests == "binary" else {})}
    adapter = Strict(answering("NOT_FOUND", malformed), declared)
    verdict = conform(MISSION, adapter, drawn=20, tours=5, steps=10, seed=1, advice=False)
    is_json = requests == "json"
    assert (verdict.outcome is Outcome.VIOLATES, NOT_CARRIED in verdict.notes) == (is_json, is_json)


@pytest.mark.slow
def test_an_adapter_that_fails_later_loses_no_violation() -> None:
    """What was found is told, though the adapter dies while the story is made short."""
    subject = answering("NOT_FOUND", BUSY)
    left = itertools.count(150, -1)
    found: list[bool] = []

    def exchange(method: str, params: JSON) -> Exchange:
        answer = type(subject).exchange(subject, method, params)
        if answer.error is not None and answer.error["status"] == "NOT_FOUND" and method == "CreateMission":
            found.append(True)
        if found and next(left) <= 0:
            message = "the adapter is gone"
            raise SubjectError(message)
        return answer

    adapter = Strict(subject, {"drives": list(DRIVES)})
    adapter.subject = type("Dying", (), {"exchange": staticmethod(exchange)})()
    verdict = conform(MISSION, adapter, drawn=5, tours=6, steps=20, seed=2, advice=False)
    assert verdict.outcome is Outcome.VIOLATES
    assert any("the adapter is gone" in note for note in verdict.notes)


def test_what_is_wrong_before_anything_is_asked_ends() -> None:
    """A message on a stream that nobody opened, right after the reset, is a violation and no endless search."""
    reference = ReferenceSubject(MISSION, {})

    def exchange(method: str, params: JSON) -> Exchange:
        answer = reference.exchange(method, params)
        if method != "reset":
            return answer
        message = {"stream": 99, "message": {}}
        return Exchange(answer.result, after=(Notification("message", message),))

    adapter = Strict(reference, {"drives": list(DRIVES)})
    adapter.subject = type("Early", (), {"exchange": staticmethod(exchange)})()
    verdict = conform(MISSION, adapter, drawn=1, tours=2, steps=10, seed=1, advice=False)
    assert verdict.outcome is Outcome.VIOLATES
