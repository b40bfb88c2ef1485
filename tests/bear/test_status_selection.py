"""Which robots a stream of bear.status shows, and how it ends, by histories written by hand."""

from __future__ import annotations

import copy

import pytest
from status_helpers import (
    BATTERY,
    BOTH,
    FIRST,
    ONLINE,
    R1,
    ROBOT,
    SECOND,
    SETTLED,
    SUBSCRIBED,
    UNPLUGGED,
    WORLDS,
    at,
    battery,
    battery_message,
    by_ids,
    conforms,
    judge,
    online_message,
    opened,
    readings_of,
    report,
    robot_message,
)

from missionfsm.app.asked import judged_system
from missionfsm.bear.status.system import SYSTEM
from missionfsm.kernel.alphabet import Bounds
from missionfsm.oracle.transcript import Head
from missionfsm.tools.check.judge import Judge

# Selection.


@pytest.mark.parametrize("robot", ["r2", "x1", "nobody", ""])
def test_only_selected_robots_are_shown(robot: str) -> None:
    """Neither another of the account's robots nor somebody else's may come."""
    lines = [*SUBSCRIBED, report("r2", "battery", battery(50)), battery_message(1, robot, 8, battery(50))]
    assert not conforms(*lines)


def test_an_own_robot_at_somebody_elses_location_is_asked_for_and_not_shown() -> None:
    """AS-03: the location is not the account's, whoever is there. The last world that is tried has such a robot."""
    world = WORLDS[-1]
    (script,) = SYSTEM.alphabet(world, Bounds()).apart
    asked = [step.params for step in script if step.method == ONLINE]
    assert asked == [at("L3")]
    call = {"call": 1, "method": ONLINE, "params": asked[0]}
    found = judge([call, {"return": 1, "result": {"stream": 1}}], world).violation
    assert found is not None
    refused = f"bear.status/{ONLINE}/PERMISSION_DENIED/the-location-is-somebody-elses"
    assert refused in [rule.id for rule in found.rules]
    assert judge([call, {"return": 1, "error": {"status": "PERMISSION_DENIED"}}], world).right


def test_a_robot_that_is_elsewhere_is_told_from_those_that_are_not_shown() -> None:
    """What is said of it is where it is, not that somebody else's robot could have been shown instead."""
    lines = [*opened(1, BATTERY, at("L1")), battery_message(1, "r1", 1, FIRST), battery_message(1, "r2", 1, SECOND)]
    found = judge([*lines, report("r3", "battery", battery(50)), battery_message(1, "r3", 5, battery(50))]).violation
    assert found is not None
    assert found.notes == ("robot 'r3' is at 'L2', and 'L1' was selected",)


def test_somebody_elses_robot_at_an_own_location_may_be_shown_and_is_flagged() -> None:
    """AS-03: a location selects all robots that are there; x1 is, x2 is not. What is shown is what it reports."""
    lines = [
        *opened(1, BATTERY, at("L1")),
        battery_message(1, "r1", 1, FIRST),
        battery_message(1, "r2", 1, SECOND),
    ]
    assert conforms(*lines, SETTLED)
    changed = report("x1", "battery", battery(50))
    shown = [battery_message(1, "x1", number, value) for number, value in ((1, SECOND), (2, battery(50)))]
    served = judge([*lines, shown[0], changed, shown[1], SETTLED])
    assert (readings_of(served, "AS-03.served"), served.violation) == (("s",), None)
    assert [line.partition(" ")[0] for line in served.verdict().flagged] == [f"AS-03.served.{BATTERY}=s"]
    assert conforms(*lines, changed, SETTLED)
    assert not conforms(*lines, battery_message(1, "x1", 1, battery(50)))
    assert not conforms(*lines, battery_message(1, "x2", 1, SECOND))


MOVED = {"drive": {"event": "move", "robotId": "r3", "locationId": "L1"}}


@pytest.mark.parametrize(("letter", "shown"), [("a", False), ("b", True)])
def test_a_location_that_gains_a_robot_may_show_it_or_not(letter: str, shown: bool) -> None:  # noqa: FBT001
    """AS-25: both are accepted, and one choice holds from then on."""
    lines = [
        *opened(1, BATTERY, at("L1")),
        battery_message(1, "r1", 1, FIRST),
        battery_message(1, "r2", 1, SECOND),
        MOVED,
        *([battery_message(1, "r3", 1, WORLDS[0]["robots"][2]["state"]["battery"])] if shown else []),
        report("r3", "battery", battery(50)),
        *([battery_message(1, "r3", 2, battery(50))] if shown else []),
        SETTLED,
    ]
    assert letter in readings_of(judge(lines), "AS-25")
    assert ("b" in readings_of(judge(lines), "AS-25")) is shown


@pytest.mark.parametrize("shown", ["STATE_UNKNOWN", "STATE_DISCONNECTED"])
def test_a_robot_that_joins_a_location_is_shown_as_a_new_stream_would_show_it(shown: str) -> None:
    """AS-09, AS-25: of a robot that never said that it is connected a stream that it joins may show that it is not."""
    never = copy.deepcopy(WORLDS[0])
    never["robots"][2]["state"].pop("connection", None)
    there = online_message(1, r1=(1, "STATE_CONNECTED"), r2=(1, "STATE_CONNECTED"))
    lines = [*opened(1, ONLINE, at("L1")), there, MOVED]
    assert conforms(*lines, online_message(1, r3=(1, shown)), SETTLED, world=never)
    assert conforms(*lines, SETTLED, world=never)
    assert not conforms(*lines, online_message(1, r3=(1, "STATE_CONNECTED")), SETTLED, world=never)


def test_a_location_that_loses_a_robot_may_go_on_showing_it_or_not() -> None:
    """AS-25: the robots at the start, those that are there, or those at the start until they leave."""
    lines = [
        *opened(1, BATTERY, at("L2")),
        battery_message(1, "r3", 1, WORLDS[0]["robots"][2]["state"]["battery"]),
        MOVED,
        report("r3", "battery", battery(50)),
    ]
    assert readings_of(judge([*lines, battery_message(1, "r3", 2, battery(50)), SETTLED]), "AS-25") == ("a", "d")
    assert readings_of(judge([*lines, SETTLED]), "AS-25") == ("b", "c", "e")


@pytest.mark.parametrize("left", [False, True])
def test_a_robot_that_has_come_to_a_location_may_stay_in_its_stream(left: bool) -> None:  # noqa: FBT001
    """AS-25 d: one that came and has left again goes on being shown; one that was never there is not."""
    away = {"drive": {"event": "move", "robotId": "r3", "locationId": "L2"}}
    first = WORLDS[0]["robots"][2]["state"]["battery"]
    opening = [
        *opened(1, BATTERY, at("L1")),
        battery_message(1, "r1", 1, FIRST),
        battery_message(1, "r2", 1, SECOND),
    ]
    changes = [report("r3", "battery", battery(50)), battery_message(1, "r3", 2, battery(50)), SETTLED]
    come = [*opening, MOVED, battery_message(1, "r3", 1, first), *([away] if left else [])]
    assert readings_of(judge([*come, *changes]), "AS-25") == (("d",) if left else ("b", "d"))
    assert readings_of(judge([*come, changes[0], SETTLED]), "AS-25") == (("b", "d") if left else ("d",))
    assert not conforms(*opening, *changes)


@pytest.mark.parametrize("shown", [False, True])
def test_a_robot_that_comes_back_may_have_left_for_good(shown: bool) -> None:  # noqa: FBT001
    """AS-25 c: nothing is owed of it to the stream of the location, but to one by its id."""
    away, back = ({"drive": {"event": "move", "robotId": "r3", "locationId": place}} for place in ("L1", "L2"))
    first = WORLDS[0]["robots"][2]["state"]["battery"]
    lines = [
        *opened(1, BATTERY, at("L2")),
        battery_message(1, "r3", 1, first),
        *opened(2, BATTERY, by_ids("r3")),
        battery_message(2, "r3", 1, first),
        away,
        back,
        report("r3", "battery", battery(50)),
        battery_message(2, "r3", 2, battery(50)),
        *([battery_message(1, "r3", 2, battery(50))] if shown else []),
        SETTLED,
    ]
    assert "c" in readings_of(judge(lines), "AS-25")
    without = [one for one in lines if one != battery_message(2, "r3", 2, battery(50))]
    assert not conforms(*without)


def test_the_stream_of_a_location_may_end_with_its_last_robot() -> None:
    """AS-25 e: pointed out; a stream that was asked for by ids may not end so."""
    away = {"drive": {"event": "move", "robotId": "r3", "locationId": "L1"}}
    ended = {"stream": 1, "closed": True, "error": {"status": "NOT_FOUND"}}
    shown = battery_message(1, "r3", 1, WORLDS[0]["robots"][2]["state"]["battery"])
    verdict = judge([*opened(1, BATTERY, at("L2")), shown, away, ended, SETTLED]).verdict()
    assert verdict.conforms
    assert [one.partition(" ")[0] for one in verdict.flagged] == [f"AS-25.{BATTERY}=e"]
    assert not conforms(*opened(1, BATTERY, by_ids("r3")), shown, away, ended, SETTLED)


def test_a_robot_that_comes_back_may_be_shown_under_the_number_that_it_had() -> None:
    """AS-11, AS-25: as a new stream would show it; one that did not move may not, nor may its numbers go back."""
    away, back = ({"drive": {"event": "move", "robotId": "r3", "locationId": place}} for place in ("L1", "L2"))
    shown = [battery_message(1, "r3", number, WORLDS[0]["robots"][2]["state"]["battery"]) for number in (4, 5, 6)]
    lines = [*opened(1, BATTERY, at("L2")), shown[1]]
    assert conforms(*lines, away, back, shown[1], SETTLED)
    assert conforms(*lines, away, back, shown[2], SETTLED)
    assert not conforms(*lines, away, back, shown[0], SETTLED)
    assert not conforms(*lines, shown[1], SETTLED)


def test_a_stream_served_in_part_may_end_with_permission_denied() -> None:
    """AS-01: own robots are served and the others left out, and then (c) the stream may be refused."""
    lines = [*opened(1, BATTERY, by_ids("r1", "x1")), battery_message(1, "r1", 5, FIRST), SETTLED]
    assert readings_of(judge(lines), "AS-01") == ("b", "c")
    ended = {"stream": 1, "closed": True, "error": {"status": "PERMISSION_DENIED"}}
    assert readings_of(judge([*lines, ended]), "AS-01") == ("c",)
    assert not conforms(*SUBSCRIBED, ended)


# Ends.


def test_a_stream_may_break_down_and_owes_nothing_then() -> None:
    """AS-26: INTERNAL ends it for all of its robots; a new subscription starts afresh."""
    ended = {"stream": 1, "closed": True, "error": {"status": "INTERNAL"}}
    lines = [*BOTH, report("r1", "battery", battery(50)), ended, report("r2", "battery", battery(60)), SETTLED]
    assert conforms(*lines)
    again = [*opened(2, BATTERY, by_ids("r1")), battery_message(2, "r1", 1, battery(50)), SETTLED]
    assert conforms(*lines, *again)
    assert not conforms(*lines, battery_message(1, "r1", 9, battery(50)))


def test_a_message_without_a_timestamp_is_pointed_out() -> None:
    """AS-14: that a later message does not say when it was recorded is a departure, on streams of either form."""
    untimed = battery_message(1, "r1", 6, UNPLUGGED)
    del untimed["message"]["metadata"]["timestamp"]
    found = judge([*SUBSCRIBED, report("r1", "battery", UNPLUGGED), untimed, SETTLED])
    assert (readings_of(found, "AS-14.timestamp"), len(found.verdict().flagged)) == (("b",), 1)

    online = online_message(2, r1=(3, "STATE_CONNECTED"))
    del online["message"]["onlineStates"]["r1"]["metadata"]["timestamp"]
    found = judge([*opened(2, "SubscribeOnlineStatus", by_ids("r1")), online, SETTLED])
    assert len(found.verdict().flagged) == 1


def test_an_unknown_stuck_state_of_a_robot_that_nobody_drives_is_pointed_out() -> None:
    """AS-18: nobody knows whether such a robot has unset it since, but the text has clients treat it as an error."""
    unknown = {**R1["state"], "navigationState": {"stuckState": {"state": "STATE_UNKNOWN"}}}
    found = judge([*opened(1, ROBOT, by_ids("r1")), robot_message(1, "r1", 1, unknown), SETTLED], drives=())
    assert (readings_of(found, "AS-18"), len(found.verdict().flagged)) == (("b",), 1)


def test_a_state_of_the_type_that_is_left_out_is_pointed_out() -> None:
    """AS-32: the page's example leaves it out, and its table lists it: accepted, and flagged."""
    reported = report("r1", "serviState", {"trayStates": {"trayStates": []}})
    lines = [*opened(1, ROBOT, by_ids("r1")), robot_message(1, "r1", 1, R1["state"]), reported, SETTLED]
    found = judge(lines)
    assert (readings_of(found, "AS-32"), len(found.verdict().flagged)) == (("b",), 1)


def test_a_robot_that_was_not_selected_is_told_as_that() -> None:
    """In a log that begins anywhere as well, where nothing is known of the robot that was."""
    head = Head("bear.status", WORLDS[0], anywhere=True)
    found = Judge(judged_system("bear.status", strict=False, anywhere=True), head)
    for line in (*SUBSCRIBED, battery_message(1, "r2", 5, FIRST)):
        found.feed(line)
    assert found.violation is not None
    assert "robot 'r2' was not selected" in found.violation.notes
    assert found.violation.rules[0].id.endswith("only-selected-robots-are-shown")


def test_what_was_asked_since_has_no_part_in_a_message_that_is_missing() -> None:
    """However long ago the change was that no message shows, and whatever was answered last."""
    state = WORLDS[0]["robots"][1]["state"]
    asked = [
        line
        for call in range(5, 60)
        for line in (
            {"call": call, "method": "GetRobotStatus", "params": {"robotId": "r2"}},
            {"return": call, "result": {"robotState": state}},
        )
    ]
    found = judge([*SUBSCRIBED, report("r1", "battery", UNPLUGGED), *asked, SETTLED])
    assert found.violation is not None
    assert [rule.id for rule in found.violation.rules] == ["bear.status/messages/updates-follow-the-state"]


def test_a_robot_elsewhere_is_told_as_that() -> None:
    """A stream by location shows the robots that are there: where one is instead is said."""
    begun = [report("r3", "battery", FIRST), *opened(1, BATTERY, at("L2")), battery_message(1, "r3", 1, FIRST)]
    found = judge([*begun, report("r1", "battery", SECOND), battery_message(1, "r1", 5, SECOND)])
    assert found.violation is not None
    assert "robot 'r1' is at 'L1', and 'L2' was selected" in found.violation.notes
    assert found.violation.rules[0].id.endswith("only-selected-robots-are-shown")


def test_a_stream_does_not_just_end() -> None:
    """AS-26: a clean end without a cause is a departure from the text, and said to be one."""
    found = judge([*SUBSCRIBED, {"stream": 1, "closed": True}])
    assert (readings_of(found, "AS-26"), len(found.verdict().flagged)) == (("b",), 1)


def test_what_comes_on_a_cancelled_stream_means_nothing() -> None:
    """After cancel nothing is due on it and nothing is wrong with what still comes; after its answer it is flagged."""
    call, answer = {"call": 2, "method": "cancel", "params": {"stream": 1}}, {"return": 2, "result": {}}
    changed, message = report("r1", "battery", battery(50)), battery_message(1, "r1", 1, battery(50))
    on_its_way = judge([*SUBSCRIBED, changed, call, message, answer, SETTLED]).verdict()
    late = judge([*SUBSCRIBED, call, answer, changed, message, SETTLED]).verdict()
    assert (on_its_way.conforms, on_its_way.flagged) == (True, ())
    assert (late.conforms, late.flagged) == (True, ("a stream showed more after its cancel was answered",))
    assert conforms(*SUBSCRIBED, call, answer, changed, SETTLED)
