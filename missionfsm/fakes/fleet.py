"""A fleet to test client code with: it answers the status API as the Robot Status page says, in this process.

    fleet = Fleet(["r1", "r2"])
    updates = fleet.battery_status(robots=["r1"])
    fleet.report("r1", "battery", BatteryState(78, BatteryMode.STATE_CHARGING, ChargeMethod.CHARGE_METHOD_CONTACT))
    [update.value.charge_percent for update in updates]

A call returns what the page promises or raises the documented error (`missionfsm.fakes.errors`), which names the
rule and its place on the page. What robots do is the test's to decide: they report values, they restart, they move.
Where the page can be read in several ways, `readings` says which the fleet follows (``missionfsm readings bear.status``
lists them). There is no clock and no chance. A fleet is for one thread at a time; `missionfsm.Shared` makes it one for
several.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from datetime import timedelta
from typing import Any, Generic, TypeVar

import attrs
from attrs import frozen

from missionfsm.bear.status.codec import EPOCH
from missionfsm.bear.status.describe import describe
from missionfsm.bear.status.messages import (
    BatteryState,
    ErrorCodes,
    NavigationState,
    RobotConnection,
    RobotState,
    Wifi,
)
from missionfsm.bear.status.state import GET, Endpoint
from missionfsm.bear.status.stream import rendered
from missionfsm.bear.status.system import SYSTEM
from missionfsm.bear.status.views import Promised
from missionfsm.bear.wire.messages import EventMetadata
from missionfsm.bear.wire.protojson import Int64, Timestamp, camel, write
from missionfsm.fakes.fake import Fake
from missionfsm.fakes.updates import Updates as AnyUpdates
from missionfsm.kernel.codec import JSON
from missionfsm.tools.reference.model import Reply

T = TypeVar("T")


@frozen
class Member:
    """A robot as it is at the start.

    Attributes:
        location: where it is; empty for nowhere.
        owned: whether it is the account's.
        state: what it reports.
        wifi: the network that it is connected to.
    """

    robot_id: str
    location: str = ""
    owned: bool = True
    state: RobotState = RobotState()
    wifi: Wifi | None = None


@frozen
class Update(Generic[T]):
    """What a subscription shows of one robot.

    Attributes:
        metadata: when it was, and its number in the robot's sequence on this subscription.
        value: the state; of a network None where the robot has none.
    """

    robot_id: str
    metadata: EventMetadata
    value: T


class Updates(AnyUpdates[Update[T]]):
    """A subscription: a ``for`` loop over it takes the updates since the last loop.

    The first updates are the latest known states when the subscription was made; every change adds one.
    """

    def __init__(self) -> None:
        super().__init__()
        self._numbers: dict[str, int] = {}

    def _show(self, robot: str, timestamp: str, value: T) -> None:
        if self.open:
            number = self._numbers[robot] = self._numbers.get(robot, -1) + 1
            self._come(Update(robot, EventMetadata(Timestamp(timestamp), Int64(number)), value))

    def _restart(self, robot: str) -> None:
        self._numbers.pop(robot, None)


class Fleet(Fake[Updates[Any]]):
    """The robots of an account, and those of others, as the status API shows them.

    Args:
        robots: ids of the account's own robots of which nothing is known yet, or `Member`s.
        locations: ids of the account's locations, or pairs of an id and whether it is the account's. A location of a
            robot that is not among them is the account's.
        readings: ambiguity id to letter, such as ``{"AS-03.empty": "d"}``; the others follow their defaults.
        clock: seconds since the epoch of 1970, for the timestamps of updates; without one there is a second for every
            update.

    Raises:
        ValueError: an ambiguity or a letter that does not exist, or an id that comes twice.
    """

    def __init__(
        self,
        robots: Iterable[Member | str],
        locations: Iterable[str | tuple[str, bool]] = (),
        *,
        readings: Mapping[str, str] | None = None,
        clock: Callable[[], float] | None = None,
    ) -> None:
        members = [Member(one) if isinstance(one, str) else one for one in robots]
        places = dict((one, True) if isinstance(one, str) else one for one in locations)
        for one in members:
            if one.location:
                places.setdefault(one.location, True)
        world = {
            "robots": [
                {
                    "robotId": one.robot_id,
                    "locationId": one.location,
                    "owned": one.owned,
                    "state": write(one.state),
                    "wifi": None if one.wifi is None else write(one.wifi),
                }
                for one in members
            ],
            "locations": [{"locationId": place, "owned": owned} for place, owned in places.items()],
        }
        super().__init__(SYSTEM, world, readings)
        self._clock = clock
        self._shown_so_far = 0

    def __repr__(self) -> str:
        return f"<Fleet: {describe(self._here.state)}>"

    # The calls of the page.

    def get_status(self, robot_id: str) -> RobotState:
        """GetRobotStatus: the latest state of a robot.

        Raises:
            InvalidArgument: the id is empty.
            PermissionDenied: the robot is not the account's.
            Internal: the robot cannot be reached (see `fail_next`).
        """
        reply = self._ask(GET, {"robotId": robot_id})
        assert reply.answer is not None, "a call is answered"  # noqa: S101 - a model always answers
        assert isinstance(reply.answer.shape, Promised), "the answer has a state"  # noqa: S101 - as above
        found: RobotState = reply.answer.shape.shown.value
        return found

    def battery_status(
        self, robots: Iterable[str] | None = None, *, location: str | None = None
    ) -> Updates[BatteryState]:
        """SubscribeBatteryStatus for robots by their ids, or for all at a location.

        Raises:
            InvalidArgument: nothing is selected, or robots and a location are.
            NotFound: there are no robots at the location.
            PermissionDenied: a robot or the location is not the account's.
        """
        return self._subscribe(Endpoint.BATTERY, robots, location)

    def error_codes(self, robots: Iterable[str] | None = None, *, location: str | None = None) -> Updates[ErrorCodes]:
        """SubscribeErrorCodes; as `battery_status`."""
        return self._subscribe(Endpoint.ERRORS, robots, location)

    def navigation_status(
        self, robots: Iterable[str] | None = None, *, location: str | None = None
    ) -> Updates[NavigationState]:
        """SubscribeNavigationStatus; as `battery_status`."""
        return self._subscribe(Endpoint.NAVIGATION, robots, location)

    def network_status(
        self, robots: Iterable[str] | None = None, *, location: str | None = None
    ) -> Updates[Wifi | None]:
        """SubscribeNetworkStatus; as `battery_status`."""
        return self._subscribe(Endpoint.NETWORK, robots, location)

    def online_status(
        self, robots: Iterable[str] | None = None, *, location: str | None = None
    ) -> Updates[RobotConnection]:
        """SubscribeOnlineStatus; as `battery_status`."""
        return self._subscribe(Endpoint.ONLINE, robots, location)

    def robot_status(self, robots: Iterable[str] | None = None, *, location: str | None = None) -> Updates[RobotState]:
        """SubscribeRobotStatus; as `battery_status`."""
        return self._subscribe(Endpoint.ROBOT, robots, location)

    def _subscribe(self, endpoint: Endpoint, robots: Iterable[str] | None, location: str | None) -> Updates[Any]:
        if isinstance(robots, str):
            message = f"{robots!r} is one text, not several: write [{robots!r}]"
            raise TypeError(message)
        selector: dict[str, JSON] = {}
        if robots is not None:
            selector["robotIds"] = {"ids": list(robots)}
        if location is not None:
            selector["locationId"] = location
        found: Updates[Any] = Updates()
        reply = self._ask(endpoint.value, {"selector": selector}, found)
        self._subscriptions[reply.names[0]] = found
        return found

    # What robots do.

    def report(self, robot: str, part: str, value: object) -> bool:
        """A robot reports a part of its state. False, and nothing happens, where there is no such robot.

        Args:
            part: a field of `RobotState`, or ``wifi``.
            value: the message of that part, its protobuf JSON, or None where it is not reported any more.

        Raises:
            ValueError: there is no such part, or the value is not one of it.
        """
        given = write(value) if attrs.has(type(value)) else value
        return self._drive({"event": "report", "robotId": robot, "part": camel(part), "value": given})

    def restart(self, robot: str) -> bool:
        """A robot restarts: its sequence numbers start over at 0 on every subscription. False if there is none."""
        for updates in self._subscriptions.values():
            updates._restart(robot)  # noqa: SLF001 - a subscription is filled here and nowhere else
        return self._drive({"event": "restart", "robotId": robot})

    def move(self, robot: str, location: str) -> bool:
        """A robot is at another location from now on. False if there is no such robot."""
        return self._drive({"event": "move", "robotId": robot, "locationId": location})

    def fail_next(self) -> None:
        """Let the next `get_status` fail that would succeed."""
        self._drive({"event": "fault", "status": "INTERNAL"})

    def _deliver(self, reply: Reply, opened: Updates[Any] | None = None) -> None:
        """Hand out what was sent."""
        now = None if self._clock is None else self._clock() - EPOCH.timestamp()
        for sent in reply.sent:
            updates = self._subscriptions.get(sent.channel, opened)
            if updates is not None:
                self._shown_so_far += 1
                seconds = self._shown_so_far if now is None else now
                timestamp = (EPOCH + timedelta(seconds=seconds)).isoformat().replace("+00:00", "Z")
                shown = rendered(sent.view, self._model.choice)
                updates._show(shown.robot, timestamp, shown.value)  # noqa: SLF001 - as above
