"""The Errors tables of bear.status: every row fires where its sentence says so, and nowhere else."""

from __future__ import annotations

from typing import Any

import pytest
from attrs import evolve
from status_helpers import ALPHABET, SETTLED, WORLDS, at, by_ids, judge, opened, refused

from missionfsm.bear.status.codec import CODEC
from missionfsm.bear.status.readings import AMBIGUITIES
from missionfsm.bear.status.rules import OPERATIONS
from missionfsm.bear.status.spec import SPEC
from missionfsm.bear.status.state import GET, STATUS, Endpoint, initial, whose
from missionfsm.kernel.readings import choose, meet
from missionfsm.kernel.rules import INTERNAL, INVALID_ARGUMENT, NOT_FOUND, OK, PERMISSION_DENIED
from missionfsm.tools.check.verdict import Outcome

FLEET = initial(CODEC.read_world(WORLDS[0]))
IA, NF, PD = INVALID_ARGUMENT, NOT_FOUND, PERMISSION_DENIED
BOTH: Any = {"selector": {"robotIds": {"ids": ["r3"]}, "locationId": "L1"}}


def codes(method: str, params: Any, choice: dict[str, str] | None = None) -> set[str]:
    """What may be answered in the usual world besides the failures that can always come."""
    decided = choose(AMBIGUITIES, choice) if choice is not None else -1
    steps = SPEC.outcomes(FLEET, CODEC.read_request(method, params), ())
    always = {"UNAUTHENTICATED", "RESOURCE_EXHAUSTED", "UNIMPLEMENTED", "UNAVAILABLE", "CANCELLED"}
    return {
        one.answer.code
        for one in steps
        if one.answer and meet(decided, one.assumes) and one.label != "a failure that nobody caused"
    } - always


SUBSCRIPTIONS: list[tuple[Any, set[str], dict[str, set[str]]]] = [
    (by_ids("r1"), {OK}, {}),
    (by_ids("r1", "r2", "r3"), {OK}, {}),
    (at("L1"), {OK}, {}),
    ({}, {IA}, {}),
    ({"selector": {}}, {IA}, {}),
    ({"selector": None}, {IA}, {}),
    ({"selector": "r1"}, {IA}, {}),
    (by_ids(), {IA}, {}),
    (at(""), {IA}, {}),
    (by_ids("x1"), {PD}, {}),
    (by_ids("x1", "x2"), {PD}, {}),
    (by_ids("r1", "x1"), {PD}, {"AS-01=b": {OK}, "AS-01=c": {OK}}),
    (by_ids("nobody"), {PD}, {"AS-02=b": {NF}}),
    (by_ids("r1", "nobody"), {PD}, {"AS-02=b": {NF}}),
    (by_ids("x1", "nobody"), {PD}, {"AS-02=b": {PD, NF}}),
    (at("nowhere"), {NF}, {"AS-03.unknown=b": {PD}}),
    (at("L4"), {NF}, {"AS-03.empty=d": {OK}}),
    (at("L3"), {PD}, {"AS-03.foreign=f": {NF}}),
    (BOTH, {IA}, {"AS-04=b": {OK}}),
    (by_ids("r1", "r1"), {OK}, {"AS-05=c": {IA}}),
    (by_ids(""), {IA}, {"AS-06.empty=b": {PD}}),
    (by_ids("r1", ""), {IA}, {"AS-06.empty=b": {PD}}),
    (by_ids("", "x1"), {IA}, {"AS-06.order=b": {PD}}),
    ({**by_ids("r1"), "x": 1}, {OK}, {"AS-06.field=b": {IA}}),
]


def told(one: object) -> str:
    """A parameter in a few words, the same for every hash seed."""
    if isinstance(one, set):
        return " or ".join(sorted(one))
    return ", ".join(f"{name}: {told(code)}" for name, code in one.items())[:40] if isinstance(one, dict) else str(one)


@pytest.mark.parametrize("endpoint", [one.value for one in Endpoint])
@pytest.mark.parametrize(("params", "usual", "others"), SUBSCRIPTIONS, ids=told)
def test_a_subscription_is_answered_as_its_table_says(
    endpoint: str, params: Any, usual: set[str], others: dict[str, set[str]]
) -> None:
    """Under the default readings with the usual code, under each other reading with the code that it says."""
    assert codes(endpoint, params, {}) == usual
    for reading, expected in others.items():
        entry, _, letter = reading.partition("=")
        assert codes(endpoint, params, {entry: letter}) == expected


@pytest.mark.parametrize(
    ("params", "expected"),
    [
        ({"robotId": "r1"}, {OK}),
        ({"robotId": ""}, {IA}),
        ({}, {IA}),
        ({"robotId": 7}, {IA}),
        ([], {IA}),
        ({"robotId": "x1"}, {PD}),
        ({"robotId": "nobody"}, {PD, NF}),
        ({"robotId": "r1", "x": 1}, {OK, IA}),
    ],
)
def test_get_robot_status_is_answered_as_its_table_says(params: Any, expected: set[str]) -> None:
    """NOT_FOUND is none of its rows, and comes for an unknown robot under AS-02 b alone."""
    assert codes(GET, params) == expected


def test_every_refusal_fires_somewhere_and_not_everywhere() -> None:
    """In the usual world each condition holds for some input of the alphabet, and fails for another."""
    fires: dict[str, set[bool]] = {}
    for prompt in ALPHABET.inputs:
        request = CODEC.read_request(prompt.method, prompt.params)
        for rule in OPERATIONS[prompt.method].refusals:
            fires.setdefault(rule.id, set()).add(rule(FLEET, request))
    assert {rule for rule, seen in fires.items() if seen != {True, False}} == set()


def test_every_rule_cites_its_own_operation() -> None:
    """The six tables are alike; each rule names the one that it stands in, and ids are unique."""
    for operation in OPERATIONS.values():
        assert {rule.cite.headings[0] for rule in operation.refusals} == {operation.name}
    ids = [rule.id for rule in SPEC.all_rules]
    assert len(set(ids)) == len(ids)
    assert all(rule.cite.document == STATUS.name for rule in SPEC.all_rules)


@pytest.mark.parametrize("endpoint", Endpoint)
def test_what_every_subscription_promises_is_cited_in_the_section_of_the_one(endpoint: Endpoint) -> None:
    """A message of no form, one of another robot, and none at all: each is told with the place of its subscription."""
    lines = opened(1, endpoint.value, by_ids("r1"))
    wrong = [{"stream": 1, "message": 7}, {"stream": 1, "closed": True, "error": {"status": INVALID_ARGUMENT}}]
    for last, rest in zip(wrong, (("Response",), ()), strict=True):
        violation = judge([*lines, last]).violation
        assert violation is not None
        assert violation.rules[0].cite == str(STATUS[(endpoint.value, *rest)])


def test_a_refusal_without_a_reason_is_a_violation() -> None:
    """PERMISSION_DENIED for the account's own robots, NOT_FOUND for a place with robots."""
    for params, status in ((by_ids("r1"), PD), (at("L1"), NF), (by_ids("r1"), IA)):
        assert judge(refused("SubscribeBatteryStatus", params, status)).violation is not None


def test_a_request_that_is_to_be_refused_must_not_be_served() -> None:
    """An OK for a foreign robot is a violation, whatever comes on the stream."""
    for params in (by_ids("x1"), by_ids(), at("L3"), by_ids("r1", "nobody"), {}):
        assert judge(opened(1, "SubscribeBatteryStatus", params)).violation is not None


def test_a_failure_that_is_armed_comes_once() -> None:
    """The next GetRobotStatus that would succeed answers INTERNAL; a refusal does not use it up."""
    fault = {"drive": {"event": "fault", "status": "INTERNAL"}}
    get = refused(GET, {"robotId": "r1"}, INTERNAL, 2)
    denied = refused(GET, {"robotId": "x1"}, PD, 1)
    assert judge([fault, *denied, *get, SETTLED]).violation is None
    assert judge([fault, *get, *refused(GET, {"robotId": "r1"}, INTERNAL, 3)]).violation is not None
    assert judge(get).violation is not None


def test_a_failure_may_come_by_itself_where_nobody_drives_faults() -> None:
    """INTERNAL stands in every table."""
    drives = ("report", "restart")
    for method, params in ((GET, {"robotId": "r1"}), ("SubscribeOnlineStatus", by_ids("r1"))):
        assert judge(refused(method, params, INTERNAL), drives=drives).violation is None


@pytest.mark.parametrize(
    ("letter", "answer"),
    [
        ("a", {"result": {"robotState": WORLDS[1]["robots"][1]["state"]}}),
        ("b", {"error": {"status": "INTERNAL"}}),
        ("c", {"result": {"robotState": {"connection": {"state": "STATE_DISCONNECTED"}}}}),
    ],
)
def test_a_robot_that_is_offline_may_be_answered_for_in_three_ways(letter: str, answer: Any) -> None:
    """AS-07: its last values, INTERNAL, or its connection alone; never CONNECTED."""
    call = {"call": 1, "method": GET, "params": {"robotId": "r2"}}
    found = judge([call, {"return": 1, **answer}], WORLDS[1])
    assert found.verdict().readings["AS-07.offline"] == (letter,)
    state = {**WORLDS[1]["robots"][1]["state"], "connection": {"state": "STATE_CONNECTED"}}
    lie = {"return": 1, "result": {"robotState": state}}
    assert judge([call, lie], WORLDS[1]).verdict().outcome is Outcome.VIOLATES


def test_whose_the_robots_are_and_where_decides_every_refusal() -> None:
    """What robots report has no say in which rules refuse a request, so that it is decided without it."""
    requests = [CODEC.read_request(one.method, one.params) for one in ALPHABET.inputs]
    for world in WORLDS:
        fleet = initial(CODEC.read_world(world))
        assert whose(fleet) is whose(evolve(fleet, fault=True))
        assert not any(one.seen for one in whose(fleet).robots)
        for request in requests:
            operation = OPERATIONS[request.operation]
            assert operation.blocking(whose(fleet), request) == operation.blocking(fleet, request)
