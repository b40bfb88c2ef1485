"""What the parts of the mission machine share: a robot, what is known of it, and how to ask it something."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from hypothesis.stateful import Bundle, RuleBasedStateMachine, precondition
from mission_model import ROWS, Listed, Missions, World, active

from missionfsm import ApiError, Robot
from missionfsm.bear.wire.messages import MissionStatus

IDS = Bundle("ids")
"""Ids of missions that were created, whatever has become of them."""
STREAMS = Bundle("streams")
"""Subscriptions that were opened."""


SELDOM = precondition(lambda self: self.seldom < 6)
"""A few times in an example: what is malformed, and changes of the world; the rest is for what goes on."""
BUSY = precondition(lambda self: active(self.missions) is not None)
"""A mission is running or paused."""
IDLE = precondition(lambda self: active(self.missions) is None and self.seldom < 6)
"""None is; what needs one is tried a few times."""


class Fault(NamedTuple):
    """The next call that would succeed fails, with or without its effect."""

    code: str
    applied: bool


class Answer(NamedTuple):
    """What a call was answered, and whether it took effect all the same."""

    code: str
    message: dict[str, Any]
    effect: bool


class Subscription:
    """A subscription, and all the messages of it that came."""

    def __init__(self, robot: Robot) -> None:
        self.messages: list[MissionStatus] = []
        self.updates = robot.updates(self.messages.append)


class MissionBase(RuleBasedStateMachine):
    """A robot, and in plain lists what the page says of it."""

    make_robot: type[Robot] = Robot

    robot: Robot
    world: World
    missions: Missions
    cleared: set[str]
    fault: Fault | None
    subscriptions: list[Subscription]
    seldom: int

    def refuse(self, method: str, params: Any, refused: set[str], perhaps: Iterable[str] = ()) -> None:
        """Call the robot with what is malformed: a row of the Errors table is the answer, and nothing changes."""
        self.seldom += 1
        assert not self.ask(method, params, refused, perhaps).effect
        self.stays()

    def ask(self, method: str, params: Any, refused: set[str], perhaps: Iterable[str] = ()) -> Answer:
        """Call the robot: the answer has to be one of those that are allowed.

        Args:
            refused: the rows of the Errors table that apply; where there are any it is one of them.
            perhaps: further codes that the page leaves open.
        """
        assert refused <= ROWS[method], "a row that the table does not have"
        allowed = {*refused, *perhaps} | (set() if refused else {"OK"})
        fault = self.fault if "OK" in allowed and self.fault and self.fault.code in ROWS[method] else None
        if fault is not None:
            allowed = (allowed - {"OK"}) | {fault.code}
        try:
            code, message = "OK", self.robot.call(method, params)
        except ApiError as refusal:
            code, message = refusal.code, {}
        assert code in allowed, f"{method} {params}: {code}, not {' or '.join(sorted(allowed))}"
        if fault is not None and code == fault.code:
            self.fault = None
            return Answer(code, {}, fault.applied)
        assert isinstance(message, dict)
        return Answer(code, message, code == "OK")

    def becomes(self, *lists: Missions) -> None:
        """The robot shows one of some lists; it is what is known of it from now on."""
        shown = [
            Listed(one.mission_id, "", one.goals, one.state, one.current_goal_index)
            for one in self.robot.status.missions
        ]
        for wanted in lists:
            if len(wanted) == len(shown) and all(map(_fits, wanted, shown)):
                self.missions = [
                    have._replace(kind=one.kind, early=one.early) for one, have in zip(wanted, shown, strict=True)
                ]
                return
        raise AssertionError(f"shown: {shown}\nwanted: one of {list(lists)}")

    def stays(self) -> None:
        """Nothing has changed."""
        self.becomes(self.missions)


def _fits(wanted: Listed, shown: Listed) -> bool:
    if wanted.state is not shown.state:
        return False
    pairs = ((wanted.mission_id, shown.mission_id), (wanted.goals, shown.goals), (wanted.at, shown.at))
    return all(one is None or one == other for one, other in pairs)
