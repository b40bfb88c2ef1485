"""The stream monitor of bear.status: what it says of single messages, and that it says what the specification says."""

from __future__ import annotations

import copy
import random
from typing import Any

import pytest
from status_helpers import WORLDS, Walk, battery, metadata, reference

from missionfsm.bear.status.codec import CODEC
from missionfsm.bear.status.monitor import StreamMonitor, watch
from missionfsm.bear.status.spec import SPEC
from missionfsm.bear.status.state import Endpoint
from missionfsm.bear.status.stream import matches
from missionfsm.bear.status.values import CHECKS
from missionfsm.bear.status.views import Seen, View
from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.step import Mismatch
from missionfsm.oracle.automaton import Automaton

BATTERY, NAVIGATION, NETWORK = "SubscribeBatteryStatus", "SubscribeNavigationStatus", "SubscribeNetworkStatus"
ROBOT, ERRORS, ONLINE = "SubscribeRobotStatus", "SubscribeErrorCodes", "SubscribeOnlineStatus"
DRAINING_ON_A_WIRE = battery(50, "STATE_DISCHARGING", "CHARGE_METHOD_WIRED")
CHARGING_ON_NOTHING = battery(50, "STATE_CHARGING", "CHARGE_METHOD_NONE")


def of(robot: str, number: int, **payload: Any) -> Any:
    return {"metadata": metadata(number), "robotId": robot, **payload}


def stuck(state: str, reason: str = "REASON_UNKNOWN") -> Any:
    return {"stuckState": {"state": state, "reason": reason}}


def entry(field: str, robot: str, number: int, **payload: Any) -> Any:
    return {field: {robot: {"metadata": metadata(number), **payload}}}


def rules(endpoint: str, *messages: Any) -> list[tuple[int, str]]:
    """The problems that messages have, as (message, name of the rule)."""
    return [(one.message, one.rule.rpartition("/")[2]) for one in watch(endpoint, copy.deepcopy(messages))]


MOVING = {"linearVelocity": 0.3, "angularVelocity": 0.0}
CASES: list[tuple[str, str, list[Any]]] = [
    ("the-charge-is-a-percentage", BATTERY, [of("a", 1, batteryState=battery(101))]),
    ("a-full-battery-is-charged", BATTERY, [of("a", 1, batteryState=battery(94, "STATE_FULL"))]),
    ("enum-values-are-documented", BATTERY, [of("a", 1, batteryState={"state": 4})]),
    ("messages-are-well-formed", BATTERY, [of("a", 1, batteryState={"state": "CHARGING"})]),
    ("messages-are-well-formed", BATTERY, [{"robotId": "a", "batteryState": battery()}]),
    ("sequence-numbers-grow", BATTERY, [of("a", -1, batteryState=battery())]),
    (
        "a-discharging-battery-is-on-no-charger",
        BATTERY,
        [of("a", 1, batteryState=DRAINING_ON_A_WIRE), of("a", 2, batteryState=DRAINING_ON_A_WIRE)],
    ),
    (
        "a-charging-battery-is-on-a-charger",
        BATTERY,
        [of("a", 1, batteryState=CHARGING_ON_NOTHING), of("a", 2, batteryState=CHARGING_ON_NOTHING)],
    ),
    (
        "only-a-stuck-robot-has-a-reason",
        NAVIGATION,
        [of("a", 1, navigationState=stuck("STATE_NOT_STUCK", "REASON_PATH_BLOCKED"))],
    ),
    (
        "reserved-reasons-are-not-used",
        NAVIGATION,
        [of("a", 1, navigationState=stuck("STATE_STUCK", "REASON_DESTINATION_OBSTRUCTED"))],
    ),
    (
        "a-stuck-state-is-known",
        NAVIGATION,
        [of("a", 1, navigationState=stuck("STATE_STUCK")), of("a", 2, navigationState=stuck("STATE_UNKNOWN"))],
    ),
    ("the-link-quality-is-in-its-range", NETWORK, [entry("networkStates", "a", 1, connectedWifi={"linkQuality": 71})]),
    ("one-type-of-robot-at-a-time", ROBOT, [of("a", 1, robotState={"serviState": {}, "cartiState": {}})]),
    (
        "the-goal-index-is-one-of-the-goals",
        ROBOT,
        [of("a", 1, robotState={"mission": {"missionId": "m", "state": "STATE_RUNNING", "currentGoalIndex": 2}})],
    ),
    (
        "a-stuck-robot-stands",
        ROBOT,
        [of("a", n, robotState={"twist": MOVING, "navigationState": stuck("STATE_STUCK")}) for n in (1, 2)],
    ),
]


@pytest.mark.parametrize(("rule", "endpoint", "messages"), CASES, ids=[f"{one[0]}-{n}" for n, one in enumerate(CASES)])
def test_each_rule_fires_on_the_last_message_and_on_no_other(rule: str, endpoint: str, messages: list[Any]) -> None:
    """What is wrong is said of the message that is wrong, and only that is said."""
    assert rules(endpoint, *messages) == [(len(messages), rule)]


def test_every_check_has_a_case() -> None:
    """No rule about values is without a message that breaks it."""
    assert {one.rule.name for one in CHECKS} <= {rule for rule, _, _ in CASES}


@pytest.mark.parametrize(
    ("endpoint", "messages"),
    [
        (BATTERY, [of("a", 1, batteryState=battery(100, "STATE_FULL")), of("a", 2, batteryState=battery(0))]),
        (BATTERY, [of("a", 1, batteryState=battery(95, "STATE_FULL")), of("a", 0, batteryState=battery())]),
        (BATTERY, [of("a", 1, batteryState=DRAINING_ON_A_WIRE), of("a", 2, batteryState=battery())]),
        (BATTERY, [of("b", 5, batteryState=DRAINING_ON_A_WIRE), of("a", 1, batteryState=DRAINING_ON_A_WIRE)]),
        (BATTERY, [of("a", 1), of("b", 1, batteryState=battery()), of("a", 2, batteryState=battery())]),
        (NAVIGATION, [of("a", n, navigationState=stuck("STATE_STUCK", "REASON_PATH_BLOCKED")) for n in (1, 2)]),
        (NETWORK, [entry("networkStates", "a", 1), entry("networkStates", "a", 1), {"networkStates": {}}, {}]),
        (ERRORS, [entry("errorCodes", "a", 4, codes=[]), entry("errorCodes", "b", 4, codes=[])]),
        (ONLINE, [entry("onlineStates", "a", 0, connection={"state": "STATE_CONNECTED"}) for _ in range(3)]),
        (
            ROBOT,
            [of("a", n, robotState={"twist": MOVING, "navigationState": stuck("STATE_NOT_STUCK")}) for n in (1, 2)],
        ),
        (ROBOT, [of("a", n, robotState={"twist": MOVING}) for n in (1, 2)]),
    ],
)
def test_nothing_is_wrong_with_what_the_page_allows(endpoint: str, messages: list[Any]) -> None:
    """Restarts with 0, one transient mix, several robots, old entries in a map, and what is left out."""
    assert rules(endpoint, *messages) == []


@pytest.mark.parametrize(
    "message", [None, 7, [], "x", {"robotId": 3}, {"metadata": 3, "robotId": "a"}, {"robotId": ""}]
)
def test_any_json_gets_a_verdict(message: Any) -> None:
    """A message of no documented form is a problem, never an exception."""
    for endpoint in (BATTERY, ROBOT):
        assert [rule for _, rule in rules(endpoint, message)] == ["messages-are-well-formed"]


def test_random_json_never_raises() -> None:
    """Whatever is put in the place of a part of a message, the monitor answers."""
    chance = random.Random(7)
    junk: list[Any] = [
        None,
        True,
        -1,
        2.5,
        "x",
        [],
        {},
        [1],
        {"state": []},
        {"a": {"metadata": {}}},
        float("nan"),
        2**70,
    ]
    usual = [
        of("a", 1, batteryState=battery()),
        of("a", 2, robotState=WORLDS[0]["robots"][0]["state"]),
        of("a", 3, navigationState=stuck("STATE_STUCK")),
        entry("networkStates", "a", 4, connectedWifi=WORLDS[0]["robots"][0]["wifi"]),
        entry("errorCodes", "a", 5, codes=[{"code": 1}]),
    ]

    def spoiled(value: Any) -> Any:
        if chance.random() < 0.1:
            return chance.choice(junk)
        if isinstance(value, dict):
            return {name: spoiled(content) for name, content in value.items()}
        return [spoiled(one) for one in value] if isinstance(value, list) else value

    monitors = [StreamMonitor(one) for one in (BATTERY, NAVIGATION, NETWORK, ERRORS, ONLINE, ROBOT)]
    for _ in range(3_000):
        message = spoiled(chance.choice(usual))
        for monitor in monitors:
            assert isinstance(monitor.feed(copy.deepcopy(message)), tuple)


def test_a_message_is_left_as_it_was() -> None:
    """Feeding does not change what is fed."""
    message = entry("networkStates", "a", 4, connectedWifi=WORLDS[0]["robots"][0]["wifi"])
    before = copy.deepcopy(message)
    StreamMonitor(NETWORK).feed(message)
    assert message == before


def test_the_selection_can_be_told_to_the_monitor() -> None:
    """A robot that was not selected is a problem then."""
    found = watch(BATTERY, [of("b", 1, batteryState=battery())], robots=["a"])
    assert [one.rule.rpartition("/")[2] for one in found] == ["only-selected-robots-are-shown"]


def test_a_restart_that_is_told_frees_the_next_number() -> None:
    """AS-11: otherwise a number that is smaller and not 0 is a problem."""
    messages = [of("a", n, batteryState=battery()) for n in (9, 3)]
    assert [number for number, _ in rules(BATTERY, *messages)] == [2]
    monitor = StreamMonitor(BATTERY)
    monitor.feed(messages[0])
    monitor.restarted("a")
    assert monitor.feed(messages[1]) == ()


@pytest.mark.parametrize("endpoint", [ONLINE, ERRORS, NETWORK])
def test_a_map_of_nothing_new_is_a_problem_unless_it_was_delivered_twice(endpoint: str) -> None:
    """AS-08: entries that have not changed come along with one that has, and not by themselves."""
    name, payload = {
        ONLINE: ("onlineStates", {"connection": {"state": "STATE_CONNECTED"}}),
        ERRORS: ("errorCodes", {"codes": []}),
        NETWORK: ("networkStates", {}),
    }[endpoint]

    def shown(**numbers: int) -> Any:
        return {name: {robot: of("", number, **payload) for robot, number in numbers.items()}}

    def problems(*messages: Any, strict: bool) -> int:
        monitor = StreamMonitor(endpoint, strict=strict)
        return sum(len(monitor.feed(copy.deepcopy(one))) for one in messages)

    first = shown(a=3, b=5)
    for robot in first[name].values():
        del robot["robotId"]
    later = copy.deepcopy(first)
    later[name]["b"]["metadata"]["sequenceNumber"] = 6
    assert problems(first, later, strict=True) == 0
    assert problems(first, first, strict=True) == 1
    assert problems(first, {name: {"a": first[name]["a"]}}, strict=True) == 1
    assert problems(first, first, strict=False) == 0


def test_repeats_are_counted() -> None:
    """AS-12: tolerated on an event stream, but counted."""
    monitor = StreamMonitor(BATTERY)
    for number in range(1, 6):
        monitor.feed(of("a", number, batteryState=battery()))
    assert (monitor.messages, monitor.robots, monitor.repeats) == (5, 1, 4)


def test_what_is_tolerated_is_flagged() -> None:
    """AS-18, AS-19: an unknown stuck state at the start, and a reserved reason, are problems of lesser weight."""
    early = list(watch(NAVIGATION, [of("a", 1, navigationState=stuck("STATE_UNKNOWN"))]))
    reserved = list(
        watch(NAVIGATION, [of("a", 1, navigationState=stuck("STATE_STUCK", "REASON_DESTINATION_OBSTRUCTED"))])
    )
    assert [one.flagged for one in (*early, *reserved)] == [True, True]


def test_a_problem_reads_as_a_sentence() -> None:
    """Which message, whom it is about, what is wrong, and by which rule."""
    (found,) = watch(BATTERY, [of("a", 1, batteryState=battery(101))])
    assert str(found) == (
        "message 1 about a: charge_percent is 101, expected 0 to 100 "
        "[bear.status/BatteryState/the-charge-is-a-percentage]"
    )


def test_the_name_of_a_oneof_is_no_field() -> None:
    """AS-32: where it stands is said once."""
    (found,) = watch(ROBOT, [of("a", 1, robotState={"typedStatus": {}})])
    assert found.says.endswith("typedStatus: is the name of a oneof, not of a field")
    assert "robotState.robotState" not in found.says


def test_the_monitor_and_the_specification_agree_on_single_messages() -> None:
    """What the oracle refuses of a robot that nobody drives, the monitor calls a problem, by the same rule."""
    for rule, endpoint, messages in CASES:
        if len(messages) > 1 or rule == "sequence-numbers-grow":
            continue
        (part,) = CODEC.split_message(copy.deepcopy(messages[0]))
        content = CODEC.read_content(part[2])
        assert isinstance(content, Seen | Malformed)
        robot = content.robot if isinstance(content, Seen) else "a"
        found = matches(View(robot, Endpoint(endpoint), unheard=True), content)
        name = found.rule.rpartition("/")[2] if isinstance(found, Mismatch) else "reserved-reasons-are-not-used"
        assert name == rule


OF_ROBOTS = {one.rule.id for one in CHECKS if one.robots}
"""What the tester's own reports may be guilty of."""


def test_what_an_honest_server_sends_is_no_problem() -> None:
    """Every message of the reference, on random walks through all worlds, passes the monitor."""
    automaton = Automaton(SPEC, tuple(SPEC.drives))
    for seed in range(12):
        subject = reference()
        one = Walk(subject, automaton, WORLDS[seed % len(WORLDS)], tuple(SPEC.drives), seed)
        monitors: dict[int, StreamMonitor] = {}
        for _ in range(60):
            one.turn()
        methods = {line["call"]: line["method"] for line in one.judge.history if "call" in line}
        for line in one.judge.history:
            if "return" in line and "stream" in line.get("result", {}):
                monitors[line["result"]["stream"]] = StreamMonitor(methods[line["return"]])
            if "message" in line:
                found = monitors[line["stream"]].feed(line["message"])
                assert [one for one in found if one.rule not in OF_ROBOTS] == []
