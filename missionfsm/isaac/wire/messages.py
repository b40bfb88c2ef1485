"""The three messages that a mission server and a robot exchange, as values.

Nothing here knows how they look as bytes; that is :mod:`missionfsm.isaac.wire.framing`. Place in the document:
``MissionSubmission › JsonTcpClient Codelet`` for header and payload, ``MissionSubmission › Mission Codelet`` for what
the payloads mean.
"""

import enum
from typing import Final

import attrs
from attrs import validators

U64: Final = 1 << 64
I64: Final = 1 << 63


@attrs.frozen(cache_hash=True)
class Uuid:
    """A 128-bit identifier, carried as two unsigned 64-bit halves: ``upper * 2**64 + lower``."""

    lower: int = attrs.field(validator=[validators.ge(0), validators.lt(U64)])
    upper: int = attrs.field(validator=[validators.ge(0), validators.lt(U64)])

    @classmethod
    def of(cls, value: int) -> "Uuid":
        """The identifier with this 128-bit value; ValueError outside 0 … 2**128-1."""
        upper, lower = divmod(value, U64)
        return cls(lower, upper)

    @property
    def value(self) -> int:
        """The 128-bit value."""
        return self.upper * U64 + self.lower

    def __str__(self) -> str:
        digits = f"{self.value:032x}"
        return "-".join((digits[:8], digits[8:12], digits[12:16], digits[16:20], digits[20:]))


class WireStatus(enum.Enum):
    """What a robot says about a mission: it goes on, or how it ended.

    In the order in which the schema numbers them (0, 1, 2). MissionSubmission › Mission Codelet.
    """

    RUNNING = "running"
    SUCCESS = "success"
    FAILURE = "failure"


@attrs.frozen
class MissionProto:
    """A mission for a robot: who it is, and the configuration that makes it this mission.

    ``config`` is JSON text. It is not parsed here: text that is no JSON object is a legal message, and the codelet's
    affair (it fails the mission). ``uuid`` is None where the sender gave none.
    """

    uuid: Uuid | None
    config: str


@attrs.frozen
class MissionStatusProto:
    """What a robot reports of the mission ``uuid``; None where the robot named no mission (AI-10)."""

    uuid: Uuid | None
    mission_status: WireStatus


@attrs.frozen
class TextProto:
    """A text. On the name channel it is the robot's name. MissionSubmission › Robot Identification."""

    text: str


Payload = MissionProto | MissionStatusProto | TextProto


@attrs.frozen
class Header:
    """What is said about a message: where it goes, when it was made, and the message's own identifier.

    Only the channel is needed to route it (AI-27). ``pubtime`` and ``acqtime`` are nanoseconds, signed 64 bits. The
    type id that travels in the header too is not kept: it is the payload's class.
    """

    channel: str
    pubtime: int | None = attrs.field(
        default=None, validator=validators.optional([validators.ge(-I64), validators.lt(I64)])
    )
    acqtime: int | None = attrs.field(
        default=None, validator=validators.optional([validators.ge(-I64), validators.lt(I64)])
    )
    uuid: Uuid | None = None


@attrs.frozen
class Message:
    """One line of the connection."""

    header: Header
    payload: Payload


TYPE_IDS: Final[dict[type[MissionProto] | type[MissionStatusProto] | type[TextProto], int]] = {
    MissionProto: 9410896613310777529,
    MissionStatusProto: 10387078701227607428,
    TextProto: 10961607615765939303,
}
"""The id of each payload type, unsigned."""

DATA_BUFFER_TYPES: Final = ("TensorProto", "ImageProto")
"""Types that the document names as unsupported because they use data buffers."""


def signed(value: int) -> int:
    """An unsigned 64-bit value as the signed one with the same bits, which is how a type id travels."""
    return value - U64 if value >= I64 else value


def unsigned(value: int) -> int:
    """A signed 64-bit value as the unsigned one with the same bits."""
    return value + U64 if value < 0 else value


def stamp(payload: Payload, channel: str, *, pubtime: int, uuid: Uuid) -> Message:
    """The payload on its way: published on `channel` at `pubtime` (ns) under a fresh message identifier."""
    return Message(Header(channel, pubtime, pubtime, uuid), payload)
