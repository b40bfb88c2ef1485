"""Messages of the Bear API to protobuf JSON and back."""

from __future__ import annotations

from typing import TypeVar

from missionfsm.bear.wire.protojson import read, write
from missionfsm.kernel.codec import JSON

T = TypeVar("T")


def to_json(message: object) -> JSON:
    """The protobuf JSON of a message, such as one of `missionfsm.missions`: every field that is not None."""
    return write(message)


def from_json(kind: type[T], value: JSON) -> T:
    """The message that protobuf JSON stands for: names in either case, enums by name or number, null for absent.

    Args:
        kind: the class of the message, such as ``type(missions.navigate("table-1"))``.

    Raises:
        ValueError: it is none; the text says where and what.
    """
    return read(kind, value)
