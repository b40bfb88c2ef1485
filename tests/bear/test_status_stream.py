"""Streams of bear.status: first messages, updates, maps and numbers, by histories written by hand."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import pytest
from status_helpers import (
    BATTERY,
    BOTH,
    DRIVES,
    ERRORS,
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
    broken,
    by_ids,
    conforms,
    errors_message,
    judge,
    metadata,
    online_message,
    opened,
    readings_of,
    refused,
    report,
    robot_message,
)


def test_what_looks_like_the_message_before_is_not_due() -> None:
    """An empty error list and none look the same: who saw one is owed nothing at the other; who saw codes is."""
    watched = opened(1, ERRORS, by_ids("r3"))
    never = [*watched, errors_message(1, "r3", 1, []), report("r3", "errorCodes", {"codes": []}), SETTLED]
    assert conforms(*never, world=WORLDS[1])
    code = {"code": 7, "severity": "SEVERITY_LOW", "message": ""}
    assert not conforms(*never, report("r3", "errorCodes", {"codes": [code]}), SETTLED, world=WORLDS[1])
    withheld = [*watched, SETTLED, report("r3", "errorCodes", {"codes": []})]
    assert conforms(*withheld, errors_message(1, "r3", 1, []), SETTLED, world=WORLDS[1])
    assert not conforms(*withheld, SETTLED, world=WORLDS[1])


def test_topics_may_differ_in_what_they_show_of_what_was_never_reported() -> None:
    """AS-09: a battery may be withheld where an empty error list is shown; one topic is read in one way."""
    battery_first = [*opened(1, BATTERY, by_ids("r3")), SETTLED]
    codes = [*opened(2, ERRORS, by_ids("r3")), errors_message(2, "r3", 1, []), SETTLED]
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
    shown = [*opened(1, ERRORS, by_ids("r3")), errors_message(1, "r3", 1, []), SETTLED]
    offline = [report("r3", "connection", {"state": "STATE_DISCONNECTED"}), *opened(2, ERRORS, by_ids("r3")), SETTLED]
    assert conforms(*shown, *offline, world=WORLDS[1])


def test_a_topic_that_is_reported_no_more_may_be_shown_where_one_that_never_was_is_withheld() -> None:
    """AS-09: that a value is unset is known where a robot said so; each of the two is read in one way."""
    never = [*opened(1, ONLINE, by_ids("r3")), SETTLED]
    ceased = [report("r1", "connection", None), *opened(2, ONLINE, by_ids("r1"))]
    shown = [online_message(2, r1=(7, "STATE_UNKNOWN")), SETTLED]
    assert conforms(*never, *ceased, *shown, world=WORLDS[1])
    assert not conforms(*never, *ceased, *shown, *opened(3, ONLINE, by_ids("r1")), SETTLED, world=WORLDS[1])
    assert not conforms(
        *never,
        *ceased,
        *shown,
        *opened(3, ONLINE, by_ids("r3")),
        online_message(3, r3=(1, "STATE_UNKNOWN")),
        world=WORLDS[1],
    )


@pytest.mark.parametrize("shown", [[], [online_message(2, r3=(1, "STATE_UNKNOWN"))]], ids=["withheld", "unknown"])
def test_what_is_shown_of_a_robot_that_says_of_itself_what_nobody_knew_is_free(shown: list[Any]) -> None:
    """AS-09: that it does not report a topic may be news, or not; nothing that it did not report is shown."""
    never = [*opened(1, ONLINE, by_ids("r3")), SETTLED]
    told = [report("r3", "connection", None), *opened(2, ONLINE, by_ids("r3"))]
    assert conforms(*never, *told, *shown, SETTLED, world=WORLDS[1])
    assert not conforms(*never, *told, online_message(2, r3=(1, "STATE_CONNECTED")), SETTLED, world=WORLDS[1])


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
    assert readings_of(found, "AS-09.offline") == (letter,)


@pytest.mark.parametrize(("letter", "value"), [("b", None), ("c", {})])
def test_a_robot_that_was_never_seen_is_withheld_or_unknown(letter: str, value: Any) -> None:
    """AS-09: nothing comes until something is known, or UNKNOWN values do."""
    shown = [] if value is None else [battery_message(1, "r3", 3, value)]
    found = judge([*opened(1, BATTERY, by_ids("r3")), *shown, SETTLED], WORLDS[1])
    assert readings_of(found, "AS-09.unknown") == (letter,)


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
    assert readings_of(found, "AS-13.skip") == ("c",)
    assert not conforms(*lines, battery_message(1, "r1", 6, UNPLUGGED), SETTLED)
    assert not conforms(*lines, SETTLED)


def test_small_changes_may_be_left_out_where_only_the_state_counts() -> None:
    """AS-13: that a percentage alone is not streamed is a reading, and pointed out."""
    found = judge([*SUBSCRIBED, report("r1", "battery", battery(50)), SETTLED])
    assert (readings_of(found, "AS-13.fields"), len(found.verdict().flagged)) == (("b",), 1)
    assert not conforms(*SUBSCRIBED, report("r1", "battery", UNPLUGGED), SETTLED)


def test_a_state_that_is_back_where_it_was_may_stay_unsaid() -> None:
    """AS-13: where only the latest counts, there and back again is nothing."""
    lines = [*SUBSCRIBED, report("r1", "battery", UNPLUGGED), report("r1", "battery", FIRST), SETTLED]
    assert readings_of(judge(lines), "AS-13.skip") == ("c",)
    assert not conforms(*lines, readings={"AS-13.skip": "d"})


def test_a_report_of_the_same_value_needs_no_message() -> None:
    """Nothing changes, so nothing is due; a message about it repeats the one before (AS-12)."""
    lines = [*SUBSCRIBED, report("r1", "battery", FIRST)]
    assert conforms(*lines, SETTLED)
    found = judge([*lines, battery_message(1, "r1", 6, FIRST), SETTLED])
    assert (readings_of(found, "AS-12.event"), found.verdict().flagged != ()) == (("b",), True)


def test_what_is_due_of_another_robot_is_told_before_its_number() -> None:
    """A message about the wrong robot has a number of its own, which may be that of the robot it names."""
    lines = [*opened(1, BATTERY, at("L1")), battery_message(1, "r1", 5, FIRST)]
    about_another = ["only-selected-robots-are-shown", "sequence-numbers-grow"]
    assert broken(*lines, battery_message(1, "r1", 5, SECOND)) == about_another
    assert broken(*lines, battery_message(1, "r1", 5, battery(50))) == ["sequence-numbers-grow"]


def test_somebody_elses_robot_is_not_told_of_where_another_is_shown_wrongly() -> None:
    """A stream of a location may serve x1; a message about r2 that shows neither is one about r2."""
    world = deepcopy(WORLDS[0])
    theirs = next(robot for robot in world["robots"] if not robot["owned"])
    theirs["locationId"] = "L1"
    lines = [*opened(1, BATTERY, at("L1")), battery_message(1, "r1", 5, FIRST), battery_message(1, "r2", 7, SECOND)]
    told = broken(*lines, battery_message(1, "r2", 8, battery(43)), world=world)
    assert "only-selected-robots-are-shown" not in told


def test_whole_states_may_be_repeated() -> None:
    """AS-12: in hybrid mode a state may come again, and that is no departure."""
    lines = [*opened(1, ROBOT, by_ids("r1")), robot_message(1, "r1", 1, R1["state"])]
    found = judge([*lines, robot_message(1, "r1", 2, R1["state"]), SETTLED])
    assert (readings_of(found, "AS-12.hybrid"), found.verdict().flagged) == (("a", "b"), ())


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
    missing = judge([*lines, SETTLED]).violation
    assert missing is not None
    assert [one.what for one in missing.expected] == ["stream 1 shows r1: unset"]
    assert not conforms(*lines, SETTLED)
    assert broken(*lines, network(2, {**R1["wifi"], "ssid": "another"}))[:1] == ["values-are-those-reported"]


@pytest.mark.parametrize(("missed", "told"), [("r1", "r2"), ("r2", "r1")])
def test_what_was_shown_last_is_not_said_to_be_missing(missed: str, told: str) -> None:
    """AS-27: the network of a robot that was offline for a while is as before, so that no message need come."""
    networks = {one["robotId"]: one["wifi"] for one in WORLDS[0]["robots"]}

    def shown(number: int, robot: str, **wifi: Any) -> Any:
        return {"stream": 1, "message": {"networkStates": {robot: {"metadata": metadata(number), **wifi}}}}

    lines = [
        *opened(1, "SubscribeNetworkStatus", by_ids(missed, told)),
        *(shown(1, one, **({"connectedWifi": networks[one]} if networks[one] else {})) for one in (missed, told)),
        report(told, "connection", {"state": "STATE_DISCONNECTED"}),
        report(told, "connection", {"state": "STATE_CONNECTED"}),
        report(missed, "wifi", {**R1["wifi"], "ssid": "another"}),
        SETTLED,
    ]
    violation = judge(lines).violation
    assert violation is not None
    words = [str(one) for one in (*violation.expected, *violation.notes)]
    assert all(missed in one and told not in one for one in words), words


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
    assert readings_of(judge(lines), "AS-08.update") == ("c",)


@pytest.mark.parametrize("robots", [("r1",), ("r2",), ("r1", "r2"), ("r2", "r1")])
@pytest.mark.parametrize(
    ("call", "field", "entry"),
    [
        (ONLINE, "onlineStates", lambda robot: {"connection": robot["state"]["connection"]}),
        (ERRORS, "errorCodes", lambda robot: robot["state"]["errorCodes"]),
        ("SubscribeNetworkStatus", "networkStates", lambda robot: {"connectedWifi": robot["wifi"]}),
    ],
)
def test_a_map_of_nothing_new_is_no_update(call: str, field: str, entry: Any, robots: tuple[str, ...]) -> None:
    """AS-08: what has not changed comes along with what has; by itself it breaks the rule of its numbers."""
    known = {name: WORLDS[0]["robots"][place] for place, name in enumerate(("r1", "r2"))}

    def shown(**numbers: int) -> Any:
        entries = {name: {"metadata": metadata(number), **entry(known[name])} for name, number in numbers.items()}
        return {"stream": 1, "message": {field: entries}}

    lines = [*opened(1, call, by_ids("r1", "r2")), shown(r1=4, r2=7)]
    assert conforms(*lines, SETTLED)
    assert broken(*lines, shown(**{name: {"r1": 4, "r2": 7}[name] for name in robots})) == ["sequence-numbers-grow"]


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
