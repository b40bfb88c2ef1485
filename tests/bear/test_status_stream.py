"""Streams of bear.status, by histories written by hand: what is accepted, and which rule everything else breaks."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from status_helpers import (
    DRIVES,
    SETTLED,
    WORLDS,
    at,
    battery,
    battery_message,
    by_ids,
    judge,
    metadata,
    online_message,
    opened,
    refused,
    report,
    robot_message,
)

from missionfsm.app.asked import judged_system
from missionfsm.oracle.transcript import Head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.verdict import Outcome

BATTERY, ONLINE, ROBOT = "SubscribeBatteryStatus", "SubscribeOnlineStatus", "SubscribeRobotStatus"
ERRORS = "SubscribeErrorCodes"
R1 = WORLDS[0]["robots"][0]
FIRST = R1["state"]["battery"]
SECOND = WORLDS[0]["robots"][1]["state"]["battery"]
UNPLUGGED = battery(77, "STATE_DISCHARGING", "CHARGE_METHOD_NONE")
SUBSCRIBED = [*opened(1, BATTERY, by_ids("r1")), battery_message(1, "r1", 5, FIRST)]
BOTH = [
    *opened(1, BATTERY, by_ids("r1", "r2")),
    battery_message(1, "r2", 7, SECOND),
    battery_message(1, "r1", 5, FIRST),
]


def conforms(*lines: Any, **options: Any) -> bool:
    return judge(lines, **options).verdict().outcome is Outcome.CONFORMS


def broken(*lines: Any, **options: Any) -> list[str]:
    """The names of the rules that a history breaks; at least it must break some."""
    found = judge(lines, **options)
    assert found.violation is not None
    return [one.id.rpartition("/")[2] for one in found.violation.rules]


def readings(found: Judge, entry: str) -> tuple[str, ...]:
    """What is left of the one part of an entry that mattered."""
    assert found.violation is None
    [letters] = [left for one, left in found.verdict().readings.items() if f"{one}.".startswith(f"{entry}.")]
    return letters


def _errors(stream: int, robot: str, number: int, codes: Any) -> Any:
    return {"stream": stream, "message": {"errorCodes": {robot: {"metadata": metadata(number), "codes": codes}}}}


def test_what_looks_like_the_message_before_is_not_due() -> None:
    """An empty error list and none look the same: who saw one is owed nothing at the other; who saw codes is."""
    watched = opened(1, ERRORS, by_ids("r3"))
    never = [*watched, _errors(1, "r3", 1, []), report("r3", "errorCodes", {"codes": []}), SETTLED]
    assert conforms(*never, world=WORLDS[1])
    code = {"code": 7, "severity": "SEVERITY_LOW", "message": ""}
    assert not conforms(*never, report("r3", "errorCodes", {"codes": [code]}), SETTLED, world=WORLDS[1])
    withheld = [*watched, SETTLED, report("r3", "errorCodes", {"codes": []})]
    assert conforms(*withheld, _errors(1, "r3", 1, []), SETTLED, world=WORLDS[1])
    assert not conforms(*withheld, SETTLED, world=WORLDS[1])


def test_topics_may_differ_in_what_they_show_of_what_was_never_reported() -> None:
    """AS-09: a battery may be withheld where an empty error list is shown; one topic is read in one way."""
    battery_first = [*opened(1, BATTERY, by_ids("r3")), SETTLED]
    codes = [*opened(2, ERRORS, by_ids("r3")), _errors(2, "r3", 1, []), SETTLED]
    assert conforms(*battery_first, *codes, world=WORLDS[1])
    again = [*opened(3, ERRORS, by_ids("r3")), SETTLED]
    assert not conforms(*battery_first, *codes, *again, world=WORLDS[1])


def test_a_robot_that_was_never_connected_may_be_shown_as_disconnected() -> None:
    """AS-09: it is offline or unreachable, so that STATE_DISCONNECTED is true of it, before any report and after."""
    unseen = [*opened(1, ONLINE, by_ids("r3")), online_message(1, r3=(1, "STATE_DISCONNECTED")), SETTLED]
    assert conforms(*unseen, world=WORLDS[1])
    gone = [*opened(1, ONLINE, by_ids("r1")), online_message(1, r1=(1, "STATE_CONNECTED"))]
    gone += [report("r1", "connection", None), online_message(1, r1=(2, "STATE_DISCONNECTED")), SETTLED]
    assert conforms(*gone)


def test_an_offline_robot_without_errors_may_be_withheld_where_one_that_is_not_offline_is_shown() -> None:
    """AS-09: a robot that is offline and has never reported the topic is a situation of its own."""
    shown = [*opened(1, ERRORS, by_ids("r3")), _errors(1, "r3", 1, []), SETTLED]
    offline = [report("r3", "connection", {"state": "STATE_DISCONNECTED"}), *opened(2, ERRORS, by_ids("r3")), SETTLED]
    assert conforms(*shown, *offline, world=WORLDS[1])


def test_an_empty_arm_of_a_selector_may_be_no_arm() -> None:
    """AS-04: the list of ids and the location are two situations, each read by itself."""
    no_location = {"selector": {"robotIds": {"ids": ["r1"]}, "locationId": ""}}
    no_ids = {"selector": {"robotIds": {"ids": []}, "locationId": "L2"}}
    served = [*opened(1, BATTERY, no_location), battery_message(1, "r1", 5, FIRST), SETTLED]
    assert conforms(*served, *refused(BATTERY, no_ids, "INVALID_ARGUMENT"))
    assert not conforms(*served, *refused(BATTERY, no_location, "INVALID_ARGUMENT"))


@pytest.mark.parametrize("drives", [(), DRIVES])
def test_internal_may_come_to_a_subscription_whoever_drives_faults(drives: tuple[str, ...]) -> None:
    """It stands in the table of every subscription, and faults are armed for GetRobotStatus alone."""
    assert conforms(*refused(BATTERY, by_ids("r1"), "INTERNAL"), *SUBSCRIBED, drives=drives)


# The first message.


def test_the_latest_state_comes_at_once() -> None:
    """A subscription that has settled has shown the latest state."""
    assert conforms(*SUBSCRIBED, SETTLED)
    assert not conforms(*opened(1, BATTERY, by_ids("r1")), SETTLED)


def test_the_first_message_of_every_selected_robot_is_due() -> None:
    """One of two robots is not enough; their order is free."""
    assert conforms(*BOTH, SETTLED)
    assert not conforms(*BOTH[:-1], SETTLED)


def test_the_first_message_shows_the_latest_of_what_was_reported() -> None:
    """What a robot reported before the subscription is shown, not what it reported at its start."""
    lines = [report("r1", "battery", battery(12)), *opened(1, BATTERY, by_ids("r1"))]
    assert conforms(*lines, battery_message(1, "r1", 9, battery(12)), SETTLED)
    assert broken(*lines, battery_message(1, "r1", 9, FIRST))[:1] == ["values-are-those-reported"]


def test_online_shows_a_robot_that_is_offline() -> None:
    """AS-09: whatever the others do, SubscribeOnlineStatus says DISCONNECTED at once."""
    world = WORLDS[1]
    lines = opened(1, ONLINE, at("L1"))
    both = online_message(1, r1=(1, "STATE_CONNECTED"), r2=(4, "STATE_DISCONNECTED"))
    assert conforms(*lines, both, SETTLED, world=world)
    assert not conforms(*lines, online_message(1, r1=(1, "STATE_CONNECTED")), SETTLED, world=world)


@pytest.mark.parametrize(("letter", "value"), [("a", SECOND), ("c", {}), ("b", None)])
def test_a_robot_that_is_offline_may_be_shown_in_three_ways(letter: str, value: Any) -> None:
    """AS-09: its last known values, UNKNOWN values, or nothing; the verdict says which."""
    lines = opened(1, BATTERY, by_ids("r2"))
    shown = [] if value is None else [battery_message(1, "r2", 3, value)]
    found = judge([*lines, *shown, SETTLED], WORLDS[1])
    assert readings(found, "AS-09.offline") == (letter,)


@pytest.mark.parametrize(("letter", "value"), [("b", None), ("c", {})])
def test_a_robot_that_was_never_seen_is_withheld_or_unknown(letter: str, value: Any) -> None:
    """AS-09: nothing comes until something is known, or UNKNOWN values do."""
    shown = [] if value is None else [battery_message(1, "r3", 3, value)]
    found = judge([*opened(1, BATTERY, by_ids("r3")), *shown, SETTLED], WORLDS[1])
    assert readings(found, "AS-09.unknown") == (letter,)


def test_what_was_withheld_is_shown_once_it_is_known() -> None:
    """AS-09: a robot that reports for the first time is shown on the streams that are there."""
    lines = [*opened(1, BATTERY, by_ids("r3")), SETTLED, report("r3", "battery", battery())]
    assert conforms(*lines, battery_message(1, "r3", 0, battery()), SETTLED, world=WORLDS[1])
    assert not conforms(*lines, SETTLED, world=WORLDS[1])


# Updates.


def test_a_change_is_streamed_to_every_subscriber() -> None:
    """Two subscriptions with different selectors both get it; one that does not is noticed."""
    lines = [
        *SUBSCRIBED,
        *opened(2, BATTERY, at("L1")),
        battery_message(2, "r1", 5, FIRST),
        battery_message(2, "r2", 7, SECOND),
        report("r1", "battery", UNPLUGGED),
    ]
    told = [battery_message(stream, "r1", 6, UNPLUGGED) for stream in (1, 2)]
    assert conforms(*lines, *told, SETTLED)
    assert conforms(*lines, *reversed(told), SETTLED)
    assert not conforms(*lines, told[0], SETTLED)


def test_robots_of_one_stream_may_come_in_any_order() -> None:
    """AS-33: the updates of two robots interleave freely; those of one do not."""
    lines = [
        *BOTH,
        report("r1", "battery", battery(50)),
        report("r2", "battery", battery(60)),
        report("r1", "battery", battery(51)),
    ]
    one, two, three = (
        battery_message(1, "r1", 6, battery(50)),
        battery_message(1, "r2", 8, battery(60)),
        battery_message(1, "r1", 7, battery(51)),
    )
    assert conforms(*lines, one, two, three, SETTLED)
    assert conforms(*lines, two, one, three, SETTLED)
    assert conforms(*lines, one, three, two, SETTLED)
    swapped = [battery_message(1, "r1", 6, battery(51)), battery_message(1, "r1", 7, battery(50))]
    assert not conforms(*lines, *swapped, two, SETTLED)


def test_updates_may_be_conflated_but_the_last_one_counts() -> None:
    """AS-13: only the latest of several is sure to come, and it must."""
    full = battery(100, "STATE_FULL")
    lines = [*SUBSCRIBED, *(report("r1", "battery", value) for value in (UNPLUGGED, FIRST, full))]
    found = judge([*lines, battery_message(1, "r1", 6, full), SETTLED])
    assert readings(found, "AS-13.skip") == ("c",)
    assert not conforms(*lines, battery_message(1, "r1", 6, UNPLUGGED), SETTLED)
    assert not conforms(*lines, SETTLED)


def test_small_changes_may_be_left_out_where_only_the_state_counts() -> None:
    """AS-13: that a percentage alone is not streamed is a reading, and pointed out."""
    found = judge([*SUBSCRIBED, report("r1", "battery", battery(50)), SETTLED])
    assert (readings(found, "AS-13.fields"), len(found.verdict().flagged)) == (("b",), 1)
    assert not conforms(*SUBSCRIBED, report("r1", "battery", UNPLUGGED), SETTLED)


def test_a_state_that_is_back_where_it_was_may_stay_unsaid() -> None:
    """AS-13: where only the latest counts, there and back again is nothing."""
    lines = [*SUBSCRIBED, report("r1", "battery", UNPLUGGED), report("r1", "battery", FIRST), SETTLED]
    assert readings(judge(lines), "AS-13.skip") == ("c",)
    assert not conforms(*lines, readings={"AS-13.skip": "d"})


def test_a_report_of_the_same_value_needs_no_message() -> None:
    """Nothing changes, so nothing is due; a message about it repeats the one before (AS-12)."""
    lines = [*SUBSCRIBED, report("r1", "battery", FIRST)]
    assert conforms(*lines, SETTLED)
    found = judge([*lines, battery_message(1, "r1", 6, FIRST), SETTLED])
    assert (readings(found, "AS-12.event"), found.verdict().flagged != ()) == (("b",), True)


def test_whole_states_may_be_repeated() -> None:
    """AS-12: in hybrid mode a state may come again, and that is no departure."""
    lines = [*opened(1, ROBOT, by_ids("r1")), robot_message(1, "r1", 1, R1["state"])]
    found = judge([*lines, robot_message(1, "r1", 2, R1["state"]), SETTLED])
    assert (readings(found, "AS-12.hybrid"), found.verdict().flagged) == (("a", "b"), ())


@pytest.mark.parametrize("part", ["connection", "battery", "emergencyStop", "mission", "navigationState", "errorCodes"])
def test_a_change_of_any_part_is_a_change_of_the_state(part: str) -> None:
    """SubscribeRobotStatus shows every part; a change of one alone is due."""
    value = {
        "connection": {"state": "STATE_DISCONNECTED"},
        "battery": battery(3),
        "emergencyStop": {"emergency": "EMERGENCY_ENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"},
        "mission": {"missionId": "m", "state": "STATE_PAUSED", "goals": [], "currentGoalIndex": 0},
        "navigationState": {"stuckState": {"state": "STATE_STUCK", "reason": "REASON_PATH_BLOCKED"}},
        "errorCodes": {"codes": []},
    }[part]
    lines = [
        *opened(1, ROBOT, by_ids("r1")),
        robot_message(1, "r1", 1, R1["state"]),
        report("r1", part, value),
    ]
    assert conforms(*lines, robot_message(1, "r1", 2, {**R1["state"], part: value}), SETTLED)
    assert not conforms(*lines, SETTLED)


def test_codes_are_a_set_that_is_sent_whole() -> None:
    """AS-29: their order means nothing, an empty list says that none is active, and a part of them is wrong."""
    one = {"code": 1, "severity": "SEVERITY_LOW", "message": "one"}
    two = {"code": 2, "severity": "SEVERITY_HIGH", "message": "two"}

    def codes(number: int, *active: Any) -> Any:
        return {"stream": 1, "message": {"errorCodes": {"r1": {"metadata": metadata(number), "codes": list(active)}}}}

    lines = [
        *opened(1, "SubscribeErrorCodes", by_ids("r1")),
        codes(1, *R1["state"]["errorCodes"]["codes"]),
        report("r1", "errorCodes", {"codes": [one, two]}),
    ]
    assert conforms(*lines, codes(2, two, one), SETTLED)
    assert broken(*lines, codes(2, two))[:1] == ["values-are-those-reported"]
    cleared = [*lines, codes(2, one, two), report("r1", "errorCodes", {"codes": []})]
    assert conforms(*cleared, codes(3), SETTLED)
    assert not conforms(*cleared, SETTLED)


def test_a_network_that_is_gone_is_shown_as_unset() -> None:
    """connected_wifi is left out once there is none, and only then."""

    def network(number: int, wifi: Any) -> Any:
        entry = {"metadata": metadata(number), **({"connectedWifi": wifi} if wifi else {})}
        return {"stream": 1, "message": {"networkStates": {"r1": entry}}}

    lines = [*opened(1, "SubscribeNetworkStatus", by_ids("r1")), network(1, R1["wifi"]), report("r1", "wifi", None)]
    assert conforms(*lines, network(2, None), SETTLED)
    assert not conforms(*lines, SETTLED)
    assert broken(*lines, network(2, {**R1["wifi"], "ssid": "another"}))[:1] == ["values-are-those-reported"]


# Maps.


def test_a_map_may_bring_the_robots_that_have_not_changed() -> None:
    """AS-08: entries that have not changed come with their old numbers, 0 included."""
    lines = [
        *opened(1, ONLINE, by_ids("r1", "r2")),
        online_message(1, r1=(0, "STATE_CONNECTED"), r2=(4, "STATE_CONNECTED")),
        report("r1", "connection", {"state": "STATE_DISCONNECTED"}),
        online_message(1, r1=(1, "STATE_DISCONNECTED"), r2=(4, "STATE_CONNECTED")),
        report("r2", "connection", {"state": "STATE_DISCONNECTED"}),
        online_message(1, r1=(1, "STATE_DISCONNECTED"), r2=(5, "STATE_DISCONNECTED")),
        SETTLED,
    ]
    assert readings(judge(lines), "AS-08.update") == ("c",)


def test_an_entry_that_has_changed_must_not_keep_its_number() -> None:
    """AS-08: an old number stands for the old entry."""
    lines = [
        *opened(1, ONLINE, by_ids("r1")),
        online_message(1, r1=(3, "STATE_CONNECTED")),
        report("r1", "connection", {"state": "STATE_DISCONNECTED"}),
        online_message(1, r1=(3, "STATE_DISCONNECTED")),
    ]
    assert not conforms(*lines)


def test_a_map_without_entries_says_nothing() -> None:
    """AS-09: a first message about robots that are withheld is empty."""
    lines = [*opened(1, ONLINE, by_ids("r3")), {"stream": 1, "message": {"onlineStates": {}}}, SETTLED]
    assert conforms(*lines, world=WORLDS[1])


def test_the_entries_of_a_map_may_come_apart() -> None:
    """AS-08: a first message for all robots or one for each is the same."""
    lines = opened(1, ONLINE, by_ids("r1", "r2"))
    apart = [online_message(1, r2=(4, "STATE_CONNECTED")), online_message(1, r1=(0, "STATE_CONNECTED"))]
    assert conforms(*lines, *apart, SETTLED)


# Sequence numbers.


@pytest.mark.parametrize(("number", "right"), [(6, True), (99, True), (0, True), (5, False), (4, False), (-1, False)])
def test_a_number_is_larger_than_the_one_before_or_zero(number: int, right: bool) -> None:  # noqa: FBT001
    """Never equal, never smaller, never negative."""
    lines = [*SUBSCRIBED, report("r1", "battery", battery(50)), battery_message(1, "r1", number, battery(50))]
    assert conforms(*lines, SETTLED) is right
    if not right:
        assert broken(*lines) == ["sequence-numbers-grow"]


def test_numbers_of_two_robots_are_not_compared() -> None:
    """AS-10: one robot's numbers say nothing about another's, nor one stream's about another's."""
    assert conforms(*BOTH, *opened(2, BATTERY, by_ids("r2")), battery_message(2, "r2", 1, SECOND), SETTLED)


@pytest.mark.parametrize("number", [0, 1, 5, 6])
def test_the_first_number_after_a_restart_is_free(number: int) -> None:
    """AS-11: only one stream can carry the 0, so any number may come first, and from there they grow."""
    restart = {"drive": {"event": "restart", "robotId": "r1"}}
    lines = [*SUBSCRIBED, restart, report("r1", "battery", battery(50))]
    later = [report("r1", "battery", battery(49)), battery_message(1, "r1", number + 1, battery(49)), SETTLED]
    assert conforms(*lines, battery_message(1, "r1", number, battery(50)), *later)
    assert not conforms(*lines, battery_message(1, "r1", -1, battery(50)))


def test_a_restart_frees_one_number_of_one_robot() -> None:
    """Another robot's numbers go on, and so do those after the first that is smaller."""
    restart = {"drive": {"event": "restart", "robotId": "r1"}}
    other = [*BOTH, restart, report("r2", "battery", battery(50)), battery_message(1, "r2", 3, battery(50))]
    assert broken(*other) == ["sequence-numbers-grow"]
    twice = [
        *SUBSCRIBED,
        restart,
        report("r1", "battery", battery(50)),
        battery_message(1, "r1", 3, battery(50)),
        report("r1", "battery", battery(49)),
        battery_message(1, "r1", 2, battery(49)),
    ]
    assert broken(*twice) == ["sequence-numbers-grow"]


def test_what_was_under_way_at_a_restart_may_still_come_with_its_old_number() -> None:
    """A message from before the restart does not use up the freedom of the first one after it."""
    lines = [
        *SUBSCRIBED,
        report("r1", "battery", battery(50)),
        {"drive": {"event": "restart", "robotId": "r1"}},
        report("r1", "battery", battery(49)),
        battery_message(1, "r1", 6, battery(50)),
        battery_message(1, "r1", 2, battery(49)),
        SETTLED,
    ]
    assert conforms(*lines)


def test_a_robot_that_restarts_may_announce_itself() -> None:
    """The same state under a new number is no repeat then."""
    lines = [*SUBSCRIBED, {"drive": {"event": "restart", "robotId": "r1"}}, battery_message(1, "r1", 0, FIRST), SETTLED]
    assert conforms(*lines, readings={"AS-12.event": "a"})


# Selection.


@pytest.mark.parametrize("robot", ["r2", "x1", "nobody", ""])
def test_only_selected_robots_are_shown(robot: str) -> None:
    """Neither another of the account's robots nor somebody else's may come."""
    lines = [*SUBSCRIBED, report("r2", "battery", battery(50)), battery_message(1, robot, 8, battery(50))]
    assert not conforms(*lines)


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
    assert (readings(served, "AS-03.served"), served.violation) == (("s",), None)
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
    assert letter in readings(judge(lines), "AS-25")
    assert ("b" in readings(judge(lines), "AS-25")) is shown


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
    assert readings(judge([*lines, battery_message(1, "r3", 2, battery(50)), SETTLED]), "AS-25") == ("a", "d")
    assert readings(judge([*lines, SETTLED]), "AS-25") == ("b", "c", "e")


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
    assert readings(judge([*come, *changes]), "AS-25") == (("d",) if left else ("b", "d"))
    assert conforms(*come, changes[0], SETTLED) is left
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
    assert "c" in readings(judge(lines), "AS-25")
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
    assert readings(judge(lines), "AS-01") == ("b", "c")
    ended = {"stream": 1, "closed": True, "error": {"status": "PERMISSION_DENIED"}}
    assert readings(judge([*lines, ended]), "AS-01") == ("c",)
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
    assert (readings(found, "AS-14.timestamp"), len(found.verdict().flagged)) == (("b",), 1)

    online = online_message(2, r1=(3, "STATE_CONNECTED"))
    del online["message"]["onlineStates"]["r1"]["metadata"]["timestamp"]
    found = judge([*opened(2, "SubscribeOnlineStatus", by_ids("r1")), online, SETTLED])
    assert len(found.verdict().flagged) == 1


def test_a_state_of_the_type_that_is_left_out_is_pointed_out() -> None:
    """AS-32: the page's example leaves it out, and its table lists it: accepted, and flagged."""
    reported = report("r1", "serviState", {"trayStates": {"trayStates": []}})
    lines = [*opened(1, ROBOT, by_ids("r1")), robot_message(1, "r1", 1, R1["state"]), reported, SETTLED]
    found = judge(lines)
    assert (readings(found, "AS-32"), len(found.verdict().flagged)) == (("b",), 1)


def test_a_robot_that_was_not_selected_is_told_as_that() -> None:
    """In a log that begins anywhere as well, where nothing is known of the robot that was."""
    head = Head("bear.status", WORLDS[0], anywhere=True)
    found = Judge(judged_system("bear.status", strict=False, anywhere=True), head)
    for line in (*SUBSCRIBED, battery_message(1, "r2", 5, FIRST)):
        found.feed(line)
    assert found.violation is not None
    assert "robot 'r2' was not selected" in found.violation.notes
    assert found.violation.rules[0].id.endswith("only-selected-robots-are-shown")


def test_a_stream_does_not_just_end() -> None:
    """AS-26: a clean end without a cause is a departure from the text, and said to be one."""
    found = judge([*SUBSCRIBED, {"stream": 1, "closed": True}])
    assert (readings(found, "AS-26"), len(found.verdict().flagged)) == (("b",), 1)


def test_what_comes_on_a_cancelled_stream_means_nothing() -> None:
    """After cancel nothing is due on it and nothing is wrong with what still comes; after its answer it is flagged."""
    call, answer = {"call": 2, "method": "cancel", "params": {"stream": 1}}, {"return": 2, "result": {}}
    changed, message = report("r1", "battery", battery(50)), battery_message(1, "r1", 1, battery(50))
    on_its_way = judge([*SUBSCRIBED, changed, call, message, answer, SETTLED]).verdict()
    late = judge([*SUBSCRIBED, call, answer, changed, message, SETTLED]).verdict()
    assert (on_its_way.conforms, on_its_way.flagged) == (True, ())
    assert (late.conforms, late.flagged) == (True, ("a stream showed more after its cancel was answered",))
    assert conforms(*SUBSCRIBED, call, answer, changed, SETTLED)


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
