"""The typed embedding of bear.status."""

from __future__ import annotations

import pytest

from missionfsm.bear.status.messages import (
    BatteryMode,
    BatteryState,
    ChargeMethod,
    ConnectionState,
    ErrorCode,
    ErrorCodes,
    RobotConnection,
    RobotState,
    Severity,
    Wifi,
)
from missionfsm.fakes.errors import Internal, InvalidArgument, NotFound, PermissionDenied
from missionfsm.fakes.fleet import Fleet, Member

CHARGING = BatteryState(78, BatteryMode.STATE_CHARGING, ChargeMethod.CHARGE_METHOD_CONTACT)
FULL = BatteryState(100, BatteryMode.STATE_FULL, ChargeMethod.CHARGE_METHOD_CONTACT)
STATE = RobotState(connection=RobotConnection(ConnectionState.STATE_CONNECTED), battery=CHARGING)


def fleet(**readings: str) -> Fleet:
    return Fleet(
        [Member("r1", "L1", state=STATE), Member("r2", "L1"), Member("x1", "L2", owned=False, state=STATE)],
        locations=[("L2", False), "L3"],
        readings=readings,
    )


def test_get_status_answers_the_latest_state() -> None:
    """What was reported is what is answered, part by part."""
    one = fleet()
    one.report("r1", "error_codes", ErrorCodes((ErrorCode(7, Severity.SEVERITY_LOW, "seven"),)))
    one.report("r1", "battery", FULL)
    expected = RobotState(
        connection=STATE.connection,
        battery=FULL,
        error_codes=ErrorCodes((ErrorCode(7, Severity.SEVERITY_LOW, "seven"),)),
    )
    assert one.get_status("r1") == expected


def test_a_subscription_is_an_iterator_of_values() -> None:
    """The latest state comes first, then every change; what was taken does not come again."""
    one = fleet()
    updates = one.battery_status(["r1"])
    one.report("r1", "battery", FULL)
    one.report("r1", "battery", FULL)
    assert [(each.robot_id, each.metadata.sequence_number, each.value) for each in updates] == [
        ("r1", 0, CHARGING),
        ("r1", 1, FULL),
    ]
    assert list(updates) == []


def test_a_location_selects_its_robots() -> None:
    """A robot of which nothing is known is withheld until it reports; JSON is as good as messages."""
    one = fleet()
    updates = one.battery_status(location="L1")
    one.report("r2", "battery", {"chargePercent": 5, "state": "STATE_DISCHARGING"})
    assert [(each.robot_id, each.value.charge_percent) for each in updates] == [("r1", 78), ("r2", 5)]


def test_a_network_that_is_gone_is_none() -> None:
    """Unset says that there is no Wi-Fi."""
    one = fleet()
    updates = one.network_status(["r1"])
    one.report("r1", "wifi", Wifi("office", -40, 70))
    one.report("r1", "wifi", None)
    assert [each.value for each in updates] == [None, Wifi("office", -40, 70), None]


def test_a_restart_starts_the_numbers_over() -> None:
    """The first number after it is 0 on every subscription."""
    one = fleet()
    first, second = one.battery_status(["r1"]), one.online_status(["r1"])
    one.report("r1", "battery", FULL)
    one.restart("r1")
    one.report("r1", "battery", CHARGING)
    assert [each.metadata.sequence_number for each in first] == [0, 1, 0, 1]
    assert [each.metadata.sequence_number for each in second] == [0, 0]


@pytest.mark.parametrize(
    ("ask", "expected", "rule"),
    [
        (lambda one: one.get_status(""), InvalidArgument, "the-robot-id-is-empty"),
        (lambda one: one.get_status("x1"), PermissionDenied, "the-robot-is-somebody-elses"),
        (lambda one: one.get_status("nobody"), PermissionDenied, "there-is-no-such-robot"),
        (lambda one: one.battery_status([]), InvalidArgument, "the-list-of-robot-ids-is-empty"),
        (lambda one: one.battery_status(), InvalidArgument, "the-selector-is-not-set"),
        (lambda one: one.online_status(["r1", "x1"]), PermissionDenied, "some-robots-are-somebody-elses"),
        (lambda one: one.robot_status(location="L2"), PermissionDenied, "the-location-is-somebody-elses"),
        (lambda one: one.robot_status(location="L3"), NotFound, "no-robot-is-at-the-location"),
        (lambda one: one.error_codes(["r1"], location="L1"), InvalidArgument, "the-selector-has-both-arms"),
    ],
)
def test_a_refusal_is_the_documented_error(ask: object, expected: type[Exception], rule: str) -> None:
    """It carries the code, the rule and the place on the page."""
    with pytest.raises(expected) as caught:
        ask(fleet())  # type: ignore[operator]
    assert caught.value.rule.endswith(rule)  # type: ignore[attr-defined]
    assert caught.value.citation.startswith("Robot Status")  # type: ignore[attr-defined]


def test_the_next_get_status_can_be_made_to_fail() -> None:
    """It fails once, and then answers again."""
    one = fleet()
    one.fail_next()
    with pytest.raises(Internal):
        one.get_status("r1")
    assert one.get_status("r1") == STATE


def test_a_fleet_follows_the_readings_it_is_given() -> None:
    """AS-03, AS-07: an empty location gives a silent stream; INTERNAL is answered for a robot that is offline."""
    one = fleet(**{"AS-03.empty": "d", "AS-07": "b"})
    assert list(one.battery_status(location="L3")) == []
    one.report("r1", "connection", RobotConnection(ConnectionState.STATE_DISCONNECTED))
    with pytest.raises(Internal):
        one.get_status("r1")
    with pytest.raises(ValueError, match="no reading q"):
        fleet(**{"AS-07": "q"})


def test_a_robot_that_moves_is_followed_where_that_is_the_reading() -> None:
    """AS-25: a location's stream gains it, or does not."""
    for letter, expected in (("a", ["r1"]), ("b", ["r1", "r3", "r3"])):
        one = Fleet([Member("r1", "L1", state=STATE), Member("r3", "L2", state=STATE)], readings={"AS-25": letter})
        updates = one.battery_status(location="L1")
        assert one.move("r3", "L1")
        one.report("r3", "battery", FULL)
        assert [each.robot_id for each in updates] == expected


def test_a_cancelled_subscription_gets_nothing_more() -> None:
    """What came before stays to be taken."""
    one = fleet()
    updates = one.battery_status(["r1"])
    updates.cancel()
    one.report("r1", "battery", FULL)
    assert [each.value for each in updates] == [CHARGING]


def test_what_is_wrong_with_a_report_is_said() -> None:
    """A part that there is not, or a value that is none of it, is a ValueError; an unknown robot is False."""
    one = fleet()
    with pytest.raises(ValueError, match="is not a part"):
        one.report("r1", "mood", None)
    with pytest.raises(ValueError, match="chargePercent"):
        one.report("r1", "battery", {"chargePercent": "lots"})
    assert not one.report("nobody", "battery", FULL)
    assert repr(one) == "<Fleet: 3 robots at 3 locations>"
