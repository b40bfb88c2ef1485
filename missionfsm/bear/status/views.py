"""Messages of the Robot Status page as values: what they are about, what they show, and what they say."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum

from attrs import evolve, frozen

from missionfsm.bear.status.messages import (
    BatteryState,
    ConnectionState,
    ErrorCodes,
    NavigationState,
    RobotConnection,
    RobotState,
    StuckState,
)
from missionfsm.bear.status.readings.unknown import AS_27_OFFLINE, AS_27_UNKNOWN
from missionfsm.bear.status.state import (
    GET,
    LOCALIZATION,
    TOPICAL,
    Endpoint,
    Robot,
    Value,
)
from missionfsm.bear.status.values import brief_value
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.terms import Content

Assumed = tuple[Assumption, ...]


@frozen(cache_hash=True)
class Topic:
    """What a channel is about: one robot on one stream.

    Attributes:
        robot: empty for a channel that keeps a stream without robots.
        location: the location by which the stream was asked for, None for one by robot ids.
        member: whether the robot belonged to the stream at its start; always so for one by robot ids.
        partly: somebody else's robots were asked for as well (AS-01).
    """

    endpoint: Endpoint
    robot: str
    location: str | None = None
    member: bool = True
    partly: bool = False


class Tie(Enum):
    """How a robot belongs to a stream, once robots have moved (AS-25)."""

    NAMED = "it is one of the robot ids that were asked for"
    STAYED = "it was at the location at the stream's start, and is there"
    GONE = "it was at the location at the stream's start, and is elsewhere"
    COME = "it is at the location, and was not at the stream's start"
    PASSED = "it has been at the location, neither at the stream's start nor now"


MEMBERS = (Tie.NAMED, Tie.STAYED, Tie.GONE)
"""The ties of a robot that belonged to a stream at its start."""


@frozen(cache_hash=True)
class About:
    """The topic of an emission: one part of one robot.

    Attributes:
        endpoint: the subscription that shows the part.
        robot: the id of the robot.
        location: the location where the robot is.
        left: the locations that the robot has left.
        ties: which streams show it, by how the robot belongs to them.
    """

    endpoint: Endpoint
    robot: str
    location: str
    left: tuple[str, ...] = ()
    ties: tuple[Tie, ...] = MEMBERS


def concerns(channel: Topic, emission: About) -> bool:
    """Whether a channel gets an emission."""
    if channel.robot != emission.robot or channel.endpoint is not emission.endpoint:
        return False
    return _tie(channel, emission) in emission.ties


def _tie(channel: Topic, emission: About) -> Tie | None:
    """How the robot of an emission belongs to the stream of a channel about it; None for not at all."""
    if channel.location is None:
        return Tie.NAMED
    if channel.location == emission.location:
        return Tie.STAYED if channel.member else Tie.COME
    if channel.member:
        return Tie.GONE
    return Tie.PASSED if channel.location in emission.left else None


@frozen(cache_hash=True)
class View:
    """What a message shows of a robot.

    Attributes:
        value: the part that the stream is about, the whole state, or the network (None: it has none).
        unheard: any value may have been reported; `value` is None.
        unlinked: for a network: the ambiguity about it if the robot is not known to be connected, else None.
        got: it is what GetRobotStatus answers, and no message.
    """

    robot: str
    endpoint: Endpoint
    value: Value = None
    unheard: bool = False
    unlinked: Ambiguity | None = None
    got: bool = False

    @property
    def call(self) -> str:
        """The call that shows it."""
        return GET if self.got else self.endpoint.value

    @property
    def offline(self) -> bool:
        """Whether it is the state of a robot that is known to be disconnected."""
        connection = self.value.connection if isinstance(self.value, RobotState) else None
        return connection is not None and connection.state is ConnectionState.STATE_DISCONNECTED


def view(robot: Robot, endpoint: Endpoint) -> View | None:
    """What a subscriber is shown of a robot; None where nothing is known."""
    if endpoint is Endpoint.NETWORK:
        unlinked = AS_27_OFFLINE if robot.offline else None if robot.connection else AS_27_UNKNOWN
        return View(robot.id, endpoint, robot.wifi, unlinked=unlinked)
    value = robot.topic(endpoint) if endpoint in TOPICAL else robot.state if robot.seen else None
    return None if value is None else View(robot.id, endpoint, value)


def blank(robot: Robot, endpoint: Endpoint) -> View:
    """UNKNOWN values, where nothing is known that could be shown."""
    return View(robot.id, endpoint, BLANK[endpoint])


@frozen(cache_hash=True)
class Seen:
    """A message about one robot without its metadata, as it came.

    Attributes:
        endpoint: None where it carries nothing that would tell.
        value: as in `View`; what is absent has its default.
        wrapped: the goals of the mission are wrapped (AS-22); None where there are none.
        timed: whether the metadata says when it was recorded (AS-14).
    """

    robot: str
    endpoint: Endpoint | None
    value: Value = None
    wrapped: bool | None = None
    timed: bool = True

    def __str__(self) -> str:
        return brief_value(self.value)


@frozen(cache_hash=True)
class Promised:
    """What GetRobotStatus is to answer: a view, and one way to show it."""

    view: View
    shown: Seen

    def __str__(self) -> str:
        return brief_value(self.view.value) if not self.view.unheard else "any state"


BLANK = {
    Endpoint.BATTERY: BatteryState(),
    Endpoint.ERRORS: ErrorCodes(),
    Endpoint.NAVIGATION: NavigationState(StuckState()),
    Endpoint.ONLINE: RobotConnection(),
    Endpoint.ROBOT: RobotState(),
}


def canonical(part: str, value: Content) -> Content:
    """A part in the form in which it is compared: what is absent has its default, codes have an order."""
    if part == LOCALIZATION or value is None:
        return None
    if isinstance(value, ErrorCodes):
        return ErrorCodes(tuple(sorted(value.codes, key=lambda one: (one.code, int(one.severity), one.message))))
    if isinstance(value, NavigationState) and value.stuck_state is None:
        return NavigationState(StuckState())
    return value


def canonical_state(state: RobotState) -> RobotState:
    """A whole state in the form in which it is compared."""
    return evolve(
        state,
        error_codes=canonical("error_codes", state.error_codes),
        navigation_state=canonical("navigation_state", state.navigation_state),
    )


def each(robots: Iterable[Robot]) -> Iterator[tuple[Endpoint, Robot]]:
    """Every robot on every subscription."""
    return ((endpoint, robot) for robot in robots for endpoint in Endpoint)
