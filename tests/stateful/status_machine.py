"""The Robot Status page as a machine of plain rules, in its order: GetRobotStatus, then the subscriptions.

The model is a dict of dicts: what each robot reported last. Nothing of how the project models it is known here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from attrs import evolve
from hypothesis import strategies as st
from hypothesis.stateful import (
    Bundle,
    RuleBasedStateMachine,
    consumes,
    initialize,
    invariant,
    multiple,
    precondition,
    rule,
)
from status_values import PARTS

from missionfsm import ApiError
from missionfsm.bear.status.messages import ErrorCodes, RobotState
from missionfsm.fakes.fleet import Fleet, Member, Update, Updates

STREAMS = Bundle("streams")

OWN = ("servi-1", "carti-1", "servi-2")
OTHERS = ("stranger", "nobody", "")
"""Ids that the account does not own: another's robot, none at all, the empty one."""

CALLS = {
    "battery_status": "battery",
    "error_codes": "error_codes",
    "navigation_status": "navigation_state",
    "network_status": "wifi",
    "online_status": "connection",
    "robot_status": None,
}
"""SubscribeBatteryStatus, …ErrorCodes, …NavigationStatus, …NetworkStatus, …OnlineStatus, …RobotStatus: what each
shows of a robot; None for all that RobotState has."""


SELDOM = precondition(lambda self: self.seldom < 6)
"""A few times in an example; the rest is for reports and subscriptions."""


class Selector(NamedTuple):
    """RobotSelector: robots by ids, or all at a location; a well-formed one has one of them."""

    robots: tuple[str, ...] | None
    location: str | None


SELECTORS = st.one_of(
    st.builds(Selector, st.lists(st.sampled_from(OWN), min_size=1, max_size=3).map(tuple), st.none()),
    st.builds(Selector, st.none(), st.sampled_from(["L1", "L2"])),
    st.builds(
        Selector,
        st.none() | st.lists(st.sampled_from(OWN + OTHERS), max_size=3).map(tuple),
        st.none() | st.sampled_from(["L1", "L2", "unused", "foreign", "nowhere", ""]),
    ),
)


class Stream:
    """A subscription, and what it showed last of every robot.

    Attributes:
        robots: those that it has to show.
        loose: those that came to or left its location since: whether it shows them is open.
    """

    def __init__(self, call: str, selector: Selector, robots: set[str], updates: Updates[Any]) -> None:
        self.call = call
        self.selector = selector
        self.robots = robots
        self.updates = updates
        self.loose: set[str] = set()
        self.shown: dict[str, Any] = {}
        self.numbers: dict[str, int] = {}
        self.restarted: set[str] = set()


class StatusMachine(RuleBasedStateMachine):
    """A fleet, what its robots reported, and who subscribed."""

    make_fleet: Callable[..., Fleet] = Fleet

    @initialize(target=STREAMS)
    def a_fleet(self) -> Any:
        """Three robots of the account at two locations, one of somebody else, and a location without robots.

        One subscription of each kind is there from the beginning.
        """
        self.where = {"servi-1": "L1", "carti-1": "L1", "servi-2": "L2"}
        members = [Member(robot, place) for robot, place in self.where.items()]
        members.append(Member("stranger", "foreign", owned=False))
        self.fleet = self.make_fleet(members, ["L1", "L2", "unused", ("foreign", False)])
        self.reported: dict[str, dict[str, Any]] = {robot: {} for robot in OWN}
        self.known: dict[str, dict[str, list[Any]]] = {robot: {} for robot in OWN}
        self.streams: list[Stream] = []
        self.seldom = 0
        return multiple(*[stream for call in CALLS for stream in self.subscribe_to(call, Selector(OWN, None))])

    def state(self, robot: str) -> RobotState:
        """All that a robot reported, as RobotState."""
        parts = {part: value for part, value in self.reported[robot].items() if part != "wifi"}
        return RobotState(**parts)

    # GetRobotStatus

    @rule(robot=st.sampled_from(OWN))
    def get_robot_status(self, robot: str) -> None:
        """GetRobotStatus: the latest state; what is not reported is left out (Twist)."""
        assert _same(self.fleet.get_status(robot)) == _same(self.state(robot))

    @SELDOM
    @rule(robot=st.sampled_from(OWN))
    def get_status_of_one_that_cannot_be_reached(self, robot: str) -> None:
        """The next call that would succeed fails, and only that one."""
        self.seldom += 1
        self.fleet.fail_next()
        assert _code(lambda: self.fleet.get_status("nobody")) == "PERMISSION_DENIED"
        # GetRobotStatus › Errors › INTERNAL: the robot cannot be reached.
        assert _code(lambda: self.fleet.get_status(robot)) == "INTERNAL"
        assert _code(lambda: self.fleet.get_status(robot)) == "OK"

    @SELDOM
    @rule(robot=st.sampled_from(OTHERS))
    def get_status_of_another(self, robot: str) -> None:
        """A robot that is not the account's, or none."""
        self.seldom += 1
        # GetRobotStatus › Errors › INVALID_ARGUMENT: robot_id is empty.
        # GetRobotStatus › Errors › PERMISSION_DENIED: a robot_id that is not owned, a misspelt one included.
        wanted = "PERMISSION_DENIED" if robot else "INVALID_ARGUMENT"
        assert _code(lambda: self.fleet.get_status(robot)) == wanted

    # SubscribeBatteryStatus, SubscribeErrorCodes, SubscribeNavigationStatus, SubscribeNetworkStatus,
    # SubscribeOnlineStatus, SubscribeRobotStatus

    def rows(self, selector: Selector) -> set[str]:
        """The rows that apply. All six tables are the same.

        Errors › INTERNAL, an error of the server, cannot be brought about for a subscription to this fleet.
        """
        found = set()
        robots, location = selector
        if (robots is None) == (location is None) or robots == () or location == "":
            # Errors › INVALID_ARGUMENT: no selector, no robot_ids, no location_id; both of them.
            found.add("INVALID_ARGUMENT")
        if robots is not None and "" in robots:
            found |= {"INVALID_ARGUMENT", "PERMISSION_DENIED"}  # which is told of an empty id in a list is open
        if location in ("unused", "nowhere") or (location in ("L1", "L2") and location not in self.where.values()):
            # Errors › NOT_FOUND: no robots at the location.
            found.add("NOT_FOUND")
        if location in ("foreign", "nowhere") or not set(robots or ()) <= {*OWN, ""}:
            # Errors › PERMISSION_DENIED: a robot_id or location_id that is not owned, a misspelt one included.
            found.add("PERMISSION_DENIED")
        return found

    @precondition(lambda self: len(self.streams) < 12)
    @rule(target=STREAMS, calls=st.sets(st.sampled_from([*CALLS]), min_size=2), selector=SELECTORS)
    def subscribe(self, calls: set[str], selector: Selector) -> Any:
        """Some of the six: the latest known state of each selected robot is sent at once."""
        return multiple(*[stream for call in sorted(calls) for stream in self.subscribe_to(call, selector)])

    def subscribe_to(self, call: str, selector: Selector) -> list[Stream]:
        """One subscription, or none if it is refused."""
        rows = self.rows(selector)
        robots = None if selector.robots is None else list(selector.robots)
        opened: list[Updates[Any]] = []
        code = _code(lambda: opened.append(getattr(self.fleet, call)(robots, location=selector.location)))
        assert code in (rows or {"OK"}), f"{call} {selector}: {code}, not one of {sorted(rows)}"
        if rows:
            return []
        wanted = set(selector.robots or (robot for robot in OWN if self.where[robot] == selector.location))
        stream = Stream(call, selector, wanted, opened[0])
        self.streams.append(stream)
        self.latest_state_is_shown()
        return [stream]

    @rule(stream=consumes(STREAMS))
    def unsubscribe(self, stream: Stream) -> None:
        """Who gives a subscription up is sent nothing more."""
        stream.updates.cancel()
        self.streams.remove(stream)
        for robot in OWN:
            self.fleet.report(robot, "twist", None)
            self.reported[robot].pop("twist", None)
        assert list(stream.updates) == []

    # What robots do by themselves.

    @rule(robot=st.sampled_from(OWN), parts=st.sets(st.sampled_from([*PARTS]), min_size=1, max_size=6), data=st.data())
    def report(self, robot: str, parts: set[str], data: st.DataObject) -> None:
        """A robot reports parts of its state: new values, the same again, or that it does not have them any more."""
        family = f"{robot.partition('-')[0]}_state"  # typed_status: that of its own family
        for name in sorted(parts):
            part = family if name in ("servi_state", "carti_state") else name
            again = st.just(self.reported[robot].get(part))
            value = data.draw(st.one_of(st.none(), again, *[PARTS[part]] * 4))
            assert self.fleet.report(robot, part, value)
            self.reported[robot][part] = value
            self.known[robot].setdefault(part, []).append(value)
            self.latest_state_is_shown()

    @SELDOM
    @rule(part=st.sampled_from(["battery", "connection"]), data=st.data())
    def somebody_elses_robot_reports(self, part: str, data: st.DataObject) -> None:
        """What another's robot reports is shown to nobody here; a robot that does not exist reports nothing."""
        self.seldom += 1
        value = data.draw(PARTS[part])
        assert self.fleet.report("stranger", part, value)
        assert not self.fleet.report("nobody", part, value)

    @SELDOM
    @rule(robot=st.sampled_from(OWN))
    def restart(self, robot: str) -> None:
        """A robot restarts: sequence numbers may start over. EventMetadata › sequence_number."""
        self.seldom += 1
        assert self.fleet.restart(robot)
        for stream in self.streams:
            stream.restarted.add(robot)

    @SELDOM
    @rule(robot=st.sampled_from(OWN), location=st.sampled_from(["L1", "L2"]))
    def move(self, robot: str, location: str) -> None:
        """A robot is at another location. Open: whether subscriptions to either location show it from now on."""
        self.seldom += 1
        assert self.fleet.move(robot, location)
        for stream in self.streams:
            if stream.selector.location in (self.where[robot], location) and self.where[robot] != location:
                stream.loose.add(robot)
        self.where[robot] = location

    # What holds at all times.

    @invariant()
    def latest_state_is_shown(self) -> None:
        """Every subscriber knows the latest state of each selected robot, and of no other.

        Open: what is shown of a part that is not reported (nothing, an empty message, the old one).
        """
        for stream in self.streams:
            for update in stream.updates:
                self.is_sound(stream, update)
            part = CALLS[stream.call]
            for robot in stream.robots - stream.loose:
                now = self.state(robot) if part is None else self.reported[robot].get(part)
                if now not in (None, RobotState(), ErrorCodes()):
                    assert robot in stream.shown, f"{stream.call}: nothing of {robot}"
                    assert _same(stream.shown[robot]) == _same(now), f"{stream.call} of {robot}"

    def is_sound(self, stream: Stream, update: Update[Any]) -> None:
        """One message: a robot that was selected, a time, a number that fits, and what the robot reported."""
        robot, metadata, value = update.robot_id, update.metadata, update.value
        assert robot in stream.robots | stream.loose
        assert metadata.timestamp is not None
        # EventMetadata › sequence_number: never negative; larger than the last of this robot, or 0.
        number, last = metadata.sequence_number, stream.numbers.get(robot)
        assert number >= 0
        assert last is None or number > last or number == 0 or robot in stream.restarted
        stream.numbers[robot] = number
        stream.restarted.discard(robot)
        stream.shown[robot] = value
        part = CALLS[stream.call]
        now = self.state(robot) if part is None else self.reported[robot].get(part)
        if now is not None:
            assert _same(value) == _same(now)
        else:
            old = self.known[robot].get(part or "", [])
            assert value is None or value == type(value)() or value in old, "nothing is made up"


def _code(call: Callable[[], object]) -> str:
    try:
        call()
    except ApiError as refusal:
        return refusal.code
    return "OK"


def _same(value: Any) -> Any:
    """The value; the order of error codes means nothing, and none is as good as no list of them."""
    if isinstance(value, RobotState):
        return evolve(value, error_codes=_same(value.error_codes or ErrorCodes()))
    if isinstance(value, ErrorCodes):
        return ErrorCodes(tuple(sorted(value.codes, key=str)))
    return value
