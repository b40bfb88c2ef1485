"""What a mission server is told and what it says: requests, statuses and effects, as values."""

import enum
import math
from typing import Final

import attrs
from attrs import validators

from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import I64, U64, MissionProto, Uuid, stamp

DEFAULT_CHANNEL: Final = "mission"
DEFAULT_STATUS_CHANNEL: Final = "mission_status"
DEFAULT_START_TIMEOUT: Final = 5.0
TOKEN_CHANNEL: Final = "token"  # noqa: S105 - a channel
"""Where a robot says its token before its name, if the server asks for tokens; no channel of the documents."""


class Status(enum.Enum):
    """Where a mission stands in the server.

    The first four are the documented incomplete ones (``MissionSubmission › Sample Usage``); SUCCESS and FAILED are
    what the robot reported; the others say why a mission was given up: its robot's connection, a timeout, an upstream,
    somebody who cancelled it.
    """

    CREATED = "CREATED"
    QUEUED = "QUEUED"
    STARTED = "STARTED"
    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILED = "FAILED"
    FAILED_DISCONNECTED = "FAILED_DISCONNECTED"
    FAILED_TIMEDOUT = "FAILED_TIMEDOUT"
    FAILED_UPSTREAM = "FAILED_UPSTREAM"
    FAILED_CANCELLED = "FAILED_CANCELLED"

    @property
    def terminal(self) -> bool:
        """True where nothing more is expected of the mission."""
        return self not in INCOMPLETE


INCOMPLETE: Final = (Status.CREATED, Status.QUEUED, Status.STARTED, Status.RUNNING)
"""The statuses of a mission that has not ended, as the page's sample lists them."""


def _not_nan(_: object, attribute: "attrs.Attribute[float]", value: float) -> None:
    if math.isnan(value):
        msg = f"{attribute.name} is not a number"
        raise ValueError(msg)


@attrs.frozen
class MissionRequest:
    """A mission as its author describes it. MissionSubmission › Sample Usage (the table of keys).

    `robot` None is the documented default. `status_channel` None is whatever the server's default is. `config` is JSON
    text. Timeouts are seconds, 0 … inf. `upstream` are missions made earlier. ValueError outside of these ranges.
    """

    robot: str | None = None
    channel: str = DEFAULT_CHANNEL
    status_channel: str | None = None
    config: str = "{}"
    start_timeout: float = attrs.field(
        default=DEFAULT_START_TIMEOUT, converter=float, validator=[_not_nan, validators.ge(0.0)]
    )
    timeout: float = attrs.field(default=math.inf, converter=float, validator=[_not_nan, validators.ge(0.0)])
    upstream: tuple[Uuid, ...] = ()


def too_long(channel: str, config: str, limit: int) -> str | None:
    """What is wrong with a mission whose line, without its end, is longer than `limit` bytes; None for any other.

    The numbers in the line are taken to be as long as they can be.
    """
    longest = Uuid(U64 - 1, U64 - 1)
    line = encode(stamp(MissionProto(longest, config), channel, pubtime=I64 - 1, uuid=longest))
    size = len(line) - 1
    return None if size <= limit else f"makes a line of {size:,} bytes; the limit is {limit:,}"


@attrs.frozen
class Refused:
    """A mission was not taken, and nothing has changed."""

    problem: str

    def __str__(self) -> str:
        return self.problem


@attrs.frozen
class Send:
    """The mission goes to the robot on this connection, on this channel; the adapter stamps the header.

    The uuid in the header is `header`, or a fresh one.
    """

    connection: int
    channel: str
    payload: MissionProto
    mission: Uuid
    header: Uuid | None = None


@attrs.frozen
class RobotTakenOver:
    """Another connection says the name of a robot that has one, and is the robot from now on."""

    robot: str
    before: int
    connection: int


@attrs.frozen
class Close:
    """The connection is to be closed. The server has forgotten it already."""

    connection: int
    reason: str


@attrs.frozen
class StatusChanged:
    """A mission has another status than before."""

    mission: Uuid
    before: Status
    status: Status


@attrs.frozen
class RobotOnline:
    """A connection has said who it is."""

    robot: str
    connection: int


@attrs.frozen
class RobotOffline:
    """A robot has no connection any more."""

    robot: str
    connection: int


@attrs.frozen
class Ignored:
    """Something arrived that has no effect, and why."""

    connection: int
    reason: str


Effect = Send | Close | StatusChanged | RobotOnline | RobotOffline | RobotTakenOver | Ignored


RESUME: Final = ("rerun", "fail")
"""What becomes of a mission that was under way when the server died: it is run again, or has failed."""


@attrs.frozen
class Snapshot:
    """A mission as it is kept over a restart of the server.

    `attempt` is what the robot knows it by, another for every retry. `number` is its place in the order of submission;
    -1 for a mission that was made known and not submitted.
    """

    uuid: Uuid
    request: MissionRequest
    status: Status
    attempt: Uuid
    number: int


@attrs.frozen
class RobotView:
    """A robot as the server sees it: its connection if any, how many missions have not ended, which it was sent."""

    robot: str
    connection: int | None
    unfinished: int
    running: tuple[Uuid, ...]
