"""The monitor of bare mission messages: what no message may show, whatever was asked of the robot."""

from __future__ import annotations

from typing import Any

import pytest
from traffic import readings_at_random, walk

from missionfsm.bear.mission.monitor import CHECKED, MissionMonitor


def mission(name: str = "A", state: str = "STATE_RUNNING", **more: Any) -> Any:
    goals = [{"destinationId": "table-1"}, {"destinationId": "table-2"}]
    shown = {"missionId": name, "state": state, "goals": goals, "currentGoalIndex": 0}
    return {**shown, "missionType": {"serviType": "SERVI_TYPE_SERVING"}, "owner": "api", **more}


def message(number: int, *missions: Any, index: int = 0, **more: Any) -> Any:
    metadata = {"timestamp": f"2025-04-01T17:05:00.{number:03}Z", "sequenceNumber": number}
    return {"metadata": metadata, "missionStates": {"missions": list(missions), "currentMissionIndex": index}, **more}


ENDED = mission(state="STATE_SUCCEEDED")
WAITS = mission("B", "STATE_DEFAULT")
PAUSED = mission(state="STATE_PAUSED")
NAVIGATES = {"missionType": {"baseType": "BASE_TYPE_NAVIGATE"}}
OVER = {"state": "STATE_SUCCEEDED"}
WRONG: dict[str, tuple[list[Any], str]] = {
    "a number that goes back": ([message(2, mission()), message(1, ENDED, index=-1)], "sequence-numbers-grow"),
    "a number twice": ([message(2, mission()), message(2, ENDED, index=-1)], "sequence-numbers-grow"),
    "no metadata": ([{"missionStates": {}}], "messages-are-well-formed"),
    "a list for the missions": ([{**message(1), "missionStates": []}], "messages-are-well-formed"),
    "no id": ([message(1, mission(""))], "all-missions-are-listed"),
    "an id twice": ([message(1, ENDED, mission(), index=1)], "all-missions-are-listed"),
    "an index of nothing": ([message(1, mission(), index=3)], "the-current-mission-index-is-the-active-mission"),
    "an index where nothing runs": (
        [message(1, ENDED, mission("B", "STATE_FAILED"), index=0)],
        "the-current-mission-index-is-the-active-mission",
    ),
    "two that run": ([message(1, mission(), mission("B"))], "the-state-is-reported"),
    "one that waits before one that runs": (
        [message(1, WAITS, mission(missionType={"baseType": "BASE_TYPE_NAVIGATE"}), index=1)],
        "the-state-is-reported",
    ),
    "a state that does not exist": ([message(1, mission(state=77), index=-1)], "the-state-is-reported"),
    "one that ended and runs": ([message(1, ENDED, index=-1), message(2, mission())], "the-state-is-reported"),
    "one that ran and waits": (
        [message(1, mission()), message(2, mission(state="STATE_DEFAULT"), index=-1)],
        "the-state-is-reported",
    ),
    "places that change": (
        [message(1, mission(), WAITS), message(2, mission("B", "STATE_FAILED"), mission(), index=1)],
        "all-missions-are-listed",
    ),
    "one that waits, is not listed and waits": (
        [message(1, mission(), WAITS), message(2, mission()), message(3, mission(), WAITS)],
        "all-missions-are-listed",
    ),
    "one that was cleared and is back": (
        [message(1, ENDED, index=-1), message(2, index=-1), message(3, mission("B")), message(4, ENDED, index=-1)],
        "all-missions-are-listed",
    ),
    "one that runs under another id for a while": (
        [message(1, mission()), message(2, mission("X")), message(3, mission())],
        "all-missions-are-listed",
    ),
    "an index where nothing is listed": ([message(1)], "the-current-mission-index-is-the-active-mission"),
    "one that is new in front of one that runs": (
        [message(1, mission()), message(2, mission("B", "STATE_FAILED", missionType={}), mission(), index=1)],
        "all-missions-are-listed",
    ),
    "one that is new, no charge, in front of one that waits": (
        [
            message(1, ENDED, WAITS, index=-1),
            message(2, ENDED, {**WAITS, **NAVIGATES, "missionId": "C"}, WAITS, index=-1),
        ],
        "all-missions-are-listed",
    ),
    "one that ran, was paused and waits": (
        [message(1, mission()), message(2, PAUSED), message(3, mission(state="STATE_DEFAULT"), index=-1)],
        "the-state-is-reported",
    ),
    "one that was paused and waits": (
        [message(1, PAUSED), message(2, mission(state="STATE_DEFAULT"), index=-1)],
        "the-state-is-reported",
    ),
    "one that ran, is paused and not active": (
        [message(1, mission()), message(2, PAUSED, index=-1)],
        "the-current-mission-index-is-the-active-mission",
    ),
    "one that ran and waits, with the feedback that it had": (
        [
            message(1, mission(missionFeedback={"serviFeedback": {"status": "STATUS_NAVIGATING"}})),
            message(
                2,
                mission(state="STATE_DEFAULT", missionFeedback={"serviFeedback": {"status": "STATUS_NAVIGATING"}}),
                index=-1,
            ),
        ],
        "the-state-is-reported",
    ),
    "a goal that vanishes": (
        [message(1, mission()), message(2, mission(goals=[{"destinationId": "table-1"}]))],
        "the-goals-are-those-requested",
    ),
    "another type": ([message(1, mission()), message(2, mission(missionType={}))], "the-type-is-that-requested"),
    "a goal index of nothing": ([message(1, mission(currentGoalIndex=2))], "the-current-goal-index-is-the-active-goal"),
    "feedback of one that waits": (
        [message(1, mission(), {**WAITS, "missionFeedback": {"baseFeedback": {"status": "STATUS_NAVIGATING"}}})],
        "the-feedback-fits-the-mission",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_no_robot_shows_is_told(case: str) -> None:
    """Of messages with one thing wrong, the last is told by the rule that it breaks, and by no other."""
    messages, rule = WRONG[case]
    monitor = MissionMonitor()
    found = [[problem.rule.rpartition("/")[2] for problem in monitor.feed(one)] for one in messages]
    assert found == [[]] * (len(messages) - 1) + [[rule]]


def test_a_mission_may_fail_while_it_waits() -> None:
    """AM-43 b: when one fails that cannot be done nothing says, so it may be listed behind the one that runs."""
    failed = {**WAITS, "state": "STATE_FAILED"}
    lines = [message(1, mission(), WAITS), message(2, mission(), failed), message(3, ENDED, failed, index=-1)]
    monitor = MissionMonitor()
    assert [monitor.feed(line) for line in lines] == [(), (), ()]


def test_what_cannot_have_become_of_a_mission_is_told_first() -> None:
    """The index is wrong as well where an ended mission runs again, and follows from it."""
    monitor = MissionMonitor()
    monitor.feed(message(1, ENDED, index=-1))
    found = [problem.says for problem in monitor.feed(message(2, mission(), index=-1))]
    assert found == [
        "mission A is STATE_RUNNING, and was STATE_SUCCEEDED before",
        "current_mission_index is -1, expected 0",
    ]


@pytest.mark.parametrize("types", [{}, {"serviType": "SERVI_TYPE_BUSSING"}], ids=["a charge", "a workflow"])
@pytest.mark.parametrize("state", ["STATE_RUNNING", "STATE_PAUSED"])
def test_what_was_assigned_last_may_have_its_turn_first(types: Any, state: str) -> None:
    """AM-07, AM-37: before the missions of a halted queue, and listed behind them."""
    monitor = MissionMonitor()
    first = mission("C", state, missionType=types)
    shown = [message(1, ENDED, WAITS, first, index=2), message(2, ENDED, mission("B"), {**first, **OVER}, index=1)]
    assert [monitor.feed(one) for one in shown] == [(), ()]


ODD: dict[str, tuple[list[Any], str]] = {
    "an index where all have ended": ([message(1, ENDED)], "current_mission_index is 0, and no mission is active"),
    "an index of one that waits": (
        [message(1, ENDED, WAITS, index=1)],
        "current_mission_index is 1, and no mission is active",
    ),
    "a goal index that goes back": (
        [message(1, mission(currentGoalIndex=1)), message(2, mission())],
        "mission A went back from goal 1 to 0, and is no patrol",
    ),
    "a goal index that goes back in a pause": (
        [message(1, mission(currentGoalIndex=1)), message(2, PAUSED)],
        "mission A went back from goal 1 to 0, and is no patrol",
    ),
}


@pytest.mark.parametrize("case", ODD)
def test_what_only_a_reading_explains_is_flagged(case: str) -> None:
    """AM-14, AM-64: told with the first message that shows it, as something that is tolerated, and once."""
    messages, says = ODD[case]
    monitor = MissionMonitor()
    found = [[(problem.says, problem.flagged) for problem in monitor.feed(one)] for one in messages]
    assert found == [[]] * (len(messages) - 1) + [[(says, True)]]
    if len(messages) == 1:
        last = messages[-1]
        assert monitor.feed({**last, "metadata": message(9)["metadata"]}) == ()


RIGHT: dict[str, list[Any]] = {
    "a charge comes before what waits": [
        message(1, ENDED, WAITS, index=-1),
        message(2, ENDED, mission("C", missionType={}, goals=[]), WAITS, index=1),
    ],
    "one that waits is shown as paused, then as waiting where the index points at it": [
        message(1, mission(), mission("B", "STATE_PAUSED")),
        message(2, ENDED, mission("B", "STATE_DEFAULT"), index=-1),
    ],
    "a patrol goes round": [
        message(number, mission(currentGoalIndex=goal, missionType={"serviType": "SERVI_TYPE_SERVING_PATROL"}))
        for number, goal in enumerate((0, 1, 0), start=1)
    ],
    "an empty list as one that waits": [message(1, {"state": "STATE_DEFAULT"})],
    "one that has ended and lies at goal 0": [message(1, mission(currentGoalIndex=1)), message(2, ENDED, index=-1)],
    "a robot that has restarted gives an id anew": [
        message(7, ENDED, index=-1),
        message(8, index=-1),
        message(0, index=-1),
        message(1, mission()),
    ],
    "an empty list as one that waits, time and again": [
        message(1, {"state": "STATE_DEFAULT"}),
        message(2, ENDED, index=-1),
        message(3, {"state": "STATE_DEFAULT"}),
        message(4, mission("B")),
        message(5, {"state": "STATE_DEFAULT"}),
    ],
    "others take the place of those that went": [
        message(1, ENDED, index=-1),
        message(2, mission("B"), mission("C", "STATE_DEFAULT")),
    ],
}


@pytest.mark.parametrize("case", RIGHT)
def test_what_some_reading_allows_is_not_told(case: str) -> None:
    """What no flagged reading is needed for is no oddity."""
    monitor = MissionMonitor()
    assert [monitor.feed(one) for one in RIGHT[case]] == [()] * len(RIGHT[case])


def test_every_rule_that_is_said_to_be_checked_can_be_broken() -> None:
    """Each rule that the monitor counts as checked is broken by one of the wrong messages."""
    assert {rule for _, rule in WRONG.values()} == {rule.id.rpartition("/")[2] for rule in CHECKED}


def test_a_redelivery_is_counted() -> None:
    """The same message again, number, timestamp and content, is no problem unless the transport is strict."""
    monitor, strict = MissionMonitor(), MissionMonitor(strict=True)
    again = [message(7, mission()), message(7, mission()), message(8, ENDED, index=-1)]
    assert [monitor.feed(one) for one in again] == [(), (), ()]
    assert [len(strict.feed(one)) for one in again] == [0, 1, 0]
    assert (monitor.redelivered, monitor.repeats, monitor.messages) == (1, 0, 3)


@pytest.mark.parametrize("seed", range(40))
def test_what_the_reference_shows_is_right(seed: int) -> None:
    """Whatever the readings, no message of the reference is told, on any of its streams."""
    log = walk(seed, 40, readings_at_random(seed))
    monitors = {stream: MissionMonitor() for stream in log.streams}
    shown = [line for line in log.lines if "message" in line]
    found = [problem for one in shown for problem in monitors[one["stream"]].feed(one["message"])]
    assert [problem for problem in found if not problem.flagged] == []
    assert sum(monitor.messages for monitor in monitors.values()) == len(shown) > 0
