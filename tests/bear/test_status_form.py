"""What messages of bear.status may look like, and robots that nobody drives, by histories written by hand."""

from __future__ import annotations

from typing import Any

import pytest
from status_helpers import (
    BATTERY,
    FIRST,
    ONLINE,
    R1,
    ROBOT,
    SETTLED,
    SUBSCRIBED,
    battery,
    battery_message,
    broken,
    by_ids,
    conforms,
    judge,
    metadata,
    opened,
    refused,
    report,
    robot_message,
)

from missionfsm.tools.check.verdict import Outcome

# Form.


@pytest.mark.parametrize(
    "message",
    [
        7,
        {"robotId": "r1", "batteryState": FIRST},
        {"metadata": {"sequenceNumber": "many"}, "robotId": "r1", "batteryState": FIRST},
        {"metadata": {"timestamp": "yesterday", "sequenceNumber": 6}, "robotId": "r1", "batteryState": FIRST},
        {"metadata": metadata(6), "robotId": "r1", "batteryState": {**FIRST, "state": "CHARGING"}},
        {"metadata": metadata(6), "robotId": "r1", "batteryState": "full"},
        {"metadata": metadata(6), "robotId": "r1", "robotState": {"battery": FIRST}},
        {"metadata": metadata(6), "robotId": "r1", "batteryState": FIRST, "navigationState": {}},
    ],
)
def test_a_message_has_the_documented_form(message: Any) -> None:
    """Anything else is a violation that says what is wrong, never a failure of the tools."""
    lines = [*SUBSCRIBED, report("r1", "battery", battery(50)), {"stream": 1, "message": message}]
    assert "messages-are-well-formed" in broken(*lines)


def test_names_and_numbers_may_be_written_in_every_way_of_protobuf_json() -> None:
    """snake_case, enums by number and 64-bit integers as text mean the same; zeros may be left out (AS-14)."""
    lines = [
        *opened(1, BATTERY, by_ids("r1")),
        {
            "stream": 1,
            "message": {
                "metadata": {"timestamp": "2025-04-01T16:45:00.123456789+02:00", "sequence_number": "5"},
                "robot_id": "r1",
                "battery_state": {"charge_percent": 78, "state": 1, "charge_method": 3},
            },
        },
        report(
            "r1", "battery", {"chargePercent": 0, "state": "STATE_UNKNOWN", "chargeMethod": "CHARGE_METHOD_UNKNOWN"}
        ),
        {"stream": 1, "message": {"metadata": {"sequenceNumber": 6}, "robotId": "r1"}},
        SETTLED,
    ]
    assert conforms(*lines)


def test_floats_are_compared_as_they_travel() -> None:
    """A pose in 32 bits is the pose that was reported."""
    state = {**R1["state"], "pose": {"xMeters": 0.1, "yMeters": 2.8, "headingRadians": 0.78}}
    shown = {**state, "pose": {"xMeters": 0.10000000149011612, "yMeters": 2.799999952316284, "headingRadians": 0.78}}
    lines = [
        *opened(1, ROBOT, by_ids("r1")),
        robot_message(1, "r1", 1, R1["state"]),
        report("r1", "pose", state["pose"]),
    ]
    assert conforms(*lines, robot_message(1, "r1", 2, shown), SETTLED)
    wrong = {**shown, "pose": {**shown["pose"], "xMeters": 0.1001}}
    assert broken(*lines, robot_message(1, "r1", 2, wrong))[0] == "values-are-those-reported"


# Robots that nobody drives.


def test_where_nobody_drives_the_reports_any_value_may_come() -> None:
    """A recorded log without drives is held to what its messages show by themselves."""
    lines = [*SUBSCRIBED, *(battery_message(1, "r1", 6 + step, battery(20 + step)) for step in range(20)), SETTLED]
    assert conforms(*lines, drives=())
    assert not conforms(*lines)


@pytest.mark.parametrize(
    ("value", "rule"),
    [
        (battery(101), "the-charge-is-a-percentage"),
        (battery(50, "STATE_FULL"), "a-full-battery-is-charged"),
        ({**FIRST, "state": 9}, "enum-values-are-documented"),
    ],
)
def test_where_nobody_drives_the_reports_values_are_still_judged(value: Any, rule: str) -> None:
    """Ranges, enums and contradictions are wrong whatever the robot reported."""
    assert rule in broken(*SUBSCRIBED, battery_message(1, "r1", 6, value), drives=())


def test_where_nobody_drives_the_reports_numbers_and_robots_are_still_judged() -> None:
    """The sequence rule and the selection do not depend on values."""
    assert broken(*SUBSCRIBED, battery_message(1, "r1", 5, battery(50)), drives=()) == ["sequence-numbers-grow"]
    assert not conforms(*SUBSCRIBED, battery_message(1, "r2", 5, battery(50)), drives=())
    assert not conforms(*opened(1, ONLINE, by_ids("r1")), SETTLED, drives=())


def test_where_nobody_drives_the_reports_an_answer_may_have_any_state() -> None:
    """GetRobotStatus is held to the same rules."""
    call = {"call": 1, "method": "GetRobotStatus", "params": {"robotId": "r1"}}
    subscribed = [*SUBSCRIBED[:1], SUBSCRIBED[1], SUBSCRIBED[2], battery_message(1, "r1", 6, battery(1))]
    call["call"] = 2
    right = {"return": 2, "result": {"robotState": {"battery": battery(3)}}}
    wrong = {"return": 2, "result": {"robotState": {"battery": battery(-3)}}}
    assert conforms(*subscribed, call, right, drives=())
    assert not conforms(*subscribed, call, wrong, drives=())


def test_a_refusal_leaves_the_streams_alone() -> None:
    """Another subscription's refusal changes nothing for those that are open."""
    lines = [*SUBSCRIBED, *refused(BATTERY, by_ids("x1"), "PERMISSION_DENIED"), report("r1", "battery", battery(50))]
    assert conforms(*lines, battery_message(1, "r1", 6, battery(50)), SETTLED)


def test_a_subscription_may_break_down_at_once() -> None:
    """INTERNAL is listed for every subscription: a history of nothing else conforms, whoever drives what."""
    lines = refused(BATTERY, by_ids("r1"), "INTERNAL")
    assert conforms(*lines)
    assert conforms(*lines, drives=())


def test_a_request_that_always_breaks_down_exercises_nothing() -> None:
    """GetRobotStatus that answers INTERNAL again and again tells nothing about the robot."""
    lines = refused("GetRobotStatus", {"robotId": "r1"}, "INTERNAL")
    assert judge(lines, drives=()).verdict().outcome is Outcome.INCONCLUSIVE
