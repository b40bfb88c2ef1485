"""How names are written in JSON, and made up: identifiers as two decimal strings, all others by their number."""

from __future__ import annotations

from typing import Any

from missionfsm.isaac.shared.line import new_uuid, uuid_json
from missionfsm.kernel.alphabet import Naming
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Name


def _write(name: Any) -> JSON:  # noqa: ANN401 - a name of these systems, a pair
    return uuid_json(name) if name[0] == "uuid" else name[1]


MESSAGE = "message"
"""The kind of the identifier that a message has itself, whatever it is about: nothing else is called so."""

_OF_MESSAGES = 1 << 32
"""From which serial number on identifiers are those of messages."""


def _make(kind: str, serial: int) -> Name:
    if kind == MESSAGE:
        return new_uuid(_OF_MESSAGES + serial)
    return new_uuid(serial) if kind == "uuid" else (kind, serial)


NAMING = Naming(_write, _make, new_uuid)
"""Identifiers as two decimal strings, all other names by their number."""
