"""What the oracle says about the JSON examples of the page itself, their oddities included."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from status_helpers import SETTLED, WORLDS, judge, opened

from missionfsm.bear.status.monitor import StreamMonitor
from missionfsm.tools.check.verdict import Outcome

POSE = {"xMeters": 5.2, "yMeters": 3.1, "headingRadians": 0.0}
CODES = [
    {"code": 1001, "severity": "SEVERITY_MEDIUM", "message": "Low battery warning"},
    {"code": 2042, "severity": "SEVERITY_HIGH", "message": "Camera connection lost"},
]
CHARGING = {"chargePercent": 78, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_CONTACT"}
FREE = {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"}
GET: Any = {
    "connection": {"state": "STATE_CONNECTED"},
    "battery": {**CHARGING, "chargePercent": 85},
    "emergencyStop": FREE,
    "mission": {"missionId": "mission-123", "state": "STATE_RUNNING", "goals": [], "currentGoalIndex": 0},
    "pose": {"xMeters": 1.5, "yMeters": 2.8, "headingRadians": 0.78},
    "errorCodes": {"codes": CODES},
    "twist": {"linearVelocity": 0.5, "angularVelocity": 0.0},
    "navigationState": {"stuckState": {"state": "STATE_NOT_STUCK", "reason": "REASON_UNKNOWN"}},
    "serviState": {
        "trayStates": {
            "trayStates": [
                {"trayName": "top", "loadState": "LOAD_STATE_LOADED", "weightKg": 2.5, "loadRatio": 0.8},
                {"trayName": "middle", "loadState": "LOAD_STATE_EMPTY", "weightKg": 0.0, "loadRatio": 0.0},
            ]
        }
    },
}
ROBOT: Any = {
    "connection": {"state": "STATE_CONNECTED"},
    "battery": {**CHARGING, "chargePercent": 75},
    "emergencyStop": FREE,
    "mission": {
        "missionId": "mission-456",
        "state": "STATE_RUNNING",
        "goals": [{"goal": {"pose": POSE}}],
        "currentGoalIndex": 1,
    },
    "pose": {"xMeters": 2.1, "yMeters": 1.8, "headingRadians": 1.2},
    "errorCodes": {"codes": CODES},
    "twist": {"linearVelocity": 0.3, "angularVelocity": 0.0},
    "navigationState": {"stuckState": {"state": "STATE_STUCK", "reason": "REASON_PATH_BLOCKED"}},
}


def _metadata(second: str, number: int) -> Any:
    return {"timestamp": f"2025-04-01T{second}Z", "sequenceNumber": number}


def _navigation(state: str, reason: str) -> Any:
    return {"stuckState": {"state": state, "reason": reason}}


WIFI = {
    "ssid": "BearRobotics-Office",
    "signalLevelDbm": -45,
    "linkQuality": 65,
    "security": "SECURITY_PASSWORD_SECURED",
}
EXAMPLES: dict[str, list[Any]] = {
    "SubscribeBatteryStatus": [
        {"metadata": _metadata("16:45:00", 112), "robotId": "pennybot-123abc", "batteryState": CHARGING},
        {
            "metadata": _metadata("16:45:02", 113),
            "robotId": "pennybot-abc123",
            "batteryState": {"chargePercent": 42, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"},
        },
    ],
    "SubscribeErrorCodes": [
        {
            "errorCodes": {
                "pennybot-abc123": {"metadata": _metadata("17:10:00", 215), "codes": CODES},
                "pennybot-123abc": {"metadata": _metadata("17:10:00", 216), "codes": []},
            }
        }
    ],
    "SubscribeNavigationStatus": [
        {
            "metadata": _metadata("17:20:00", 87),
            "robotId": "pennybot-abc123",
            "navigationState": _navigation("STATE_STUCK", "REASON_PATH_BLOCKED"),
        },
        {
            "metadata": _metadata("17:20:03", 88),
            "robotId": "pennybot-123abc",
            "navigationState": _navigation("STATE_NOT_STUCK", "REASON_UNKNOWN"),
        },
    ],
    "SubscribeNetworkStatus": [
        {
            "networkStates": {
                "pennybot-abc123": {"metadata": _metadata("16:00:00", 105), "connectedWifi": WIFI},
                "pennybot-123abc": {"metadata": _metadata("16:00:00", 106)},
            }
        }
    ],
    "SubscribeOnlineStatus": [
        {
            "onlineStates": {
                "pennybot-abc123": {
                    "metadata": _metadata("17:40:00", 12),
                    "connection": {"state": "STATE_CONNECTED"},
                },
                "pennybot-123abc": {
                    "metadata": _metadata("17:40:01", 9),
                    "connection": {"state": "STATE_DISCONNECTED"},
                },
            }
        }
    ],
    "SubscribeRobotStatus": [
        {"metadata": _metadata("17:05:00", 211), "robotId": "pennybot-123abc", "robotState": ROBOT}
    ],
}


def world_of(*robots: tuple[str, Any, Any]) -> Any:
    """A world in which robots report this."""
    return {
        "robots": [
            {"robotId": robot, "locationId": "L1", "owned": True, "state": state, "wifi": wifi}
            for robot, state, wifi in robots
        ],
        "locations": [{"locationId": "L1", "owned": True}],
    }


WORLD = world_of(
    (
        "pennybot-abc123",
        {
            "connection": {"state": "STATE_CONNECTED"},
            "battery": EXAMPLES["SubscribeBatteryStatus"][1]["batteryState"],
            "errorCodes": {"codes": CODES},
            "navigationState": _navigation("STATE_STUCK", "REASON_PATH_BLOCKED"),
        },
        WIFI,
    ),
    (
        "pennybot-123abc",
        {
            "connection": {"state": "STATE_DISCONNECTED"},
            "battery": CHARGING,
            "errorCodes": {"codes": []},
            "navigationState": _navigation("STATE_NOT_STUCK", "REASON_UNKNOWN"),
        },
        None,
    ),
)


@pytest.mark.parametrize("method", [one for one in EXAMPLES if one != "SubscribeRobotStatus"])
def test_the_examples_of_the_streams_with_one_topic_conform(method: str) -> None:
    """Each is what a stream shows first of two robots that have reported just that."""
    lines = [
        *opened(1, method, {"selector": {"locationId": "L1"}}),
        *({"stream": 1, "message": message} for message in EXAMPLES[method]),
        SETTLED,
    ]
    found = judge(lines, WORLD).verdict()
    assert (found.outcome, found.violation) == (Outcome.CONFORMS, None)


def test_the_example_of_get_robot_status_conforms() -> None:
    """A mission without goals, and HIGH severity beside a running mission, are the robot's own affair."""
    world = world_of(("pennybot-123abc", GET, None))
    lines = [
        {"call": 1, "method": "GetRobotStatus", "params": {"robotId": "pennybot-123abc"}},
        {"return": 1, "result": {"robotState": GET}},
    ]
    assert judge(lines, world).verdict().outcome is Outcome.CONFORMS


def test_the_example_of_subscribe_robot_status_has_wrapped_goals() -> None:
    """AS-22: its goals are wrapped, which is a reading of its own, and its index is the number of goals."""
    world = world_of(("pennybot-123abc", ROBOT, None))
    lines = [
        *opened(1, "SubscribeRobotStatus", {"selector": {"robotIds": {"ids": ["pennybot-123abc"]}}}),
        {"stream": 1, "message": EXAMPLES["SubscribeRobotStatus"][0]},
        SETTLED,
    ]
    found = judge(lines, world).verdict()
    assert (found.outcome, found.readings["AS-22.SubscribeRobotStatus"]) == (Outcome.CONFORMS, ("b",))


@pytest.mark.parametrize("method", list(EXAMPLES))
def test_the_monitor_finds_nothing_wrong_with_any_example_by_itself(method: str) -> None:
    """Each message is possible: that two robots seem to share a counter (AS-10) is nobody's business."""
    monitor = StreamMonitor(method)
    assert [monitor.feed(copy.deepcopy(message)) for message in EXAMPLES[method]] == [()] * len(EXAMPLES[method])


def test_the_robot_of_the_example_that_is_stuck_must_not_go_on_moving() -> None:
    """AS-30: stuck at 0.3 m/s is tolerated in one message, and a problem once it lasts."""
    monitor = StreamMonitor("SubscribeRobotStatus")
    first = copy.deepcopy(EXAMPLES["SubscribeRobotStatus"][0])
    second = copy.deepcopy(first)
    second["metadata"]["sequenceNumber"] += 1
    assert monitor.feed(first) == ()
    assert [one.says for one in monitor.feed(second)] == ["STATE_STUCK at 0.3 m/s, for the second time"]


def test_the_page_s_robots_are_no_part_of_the_usual_world() -> None:
    """An answer for a robot that does not exist here needs a PERMISSION_DENIED."""
    lines = [
        {"call": 1, "method": "GetRobotStatus", "params": {"robotId": "pennybot-123abc"}},
        {"return": 1, "result": {"robotState": GET}},
    ]
    assert judge(lines, WORLDS[0]).verdict().outcome is Outcome.VIOLATES
