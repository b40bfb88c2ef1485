"""JSON Schemas of the drives that both systems have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from missionfsm.kernel.shapes import TEXT, record

SECONDS = {"type": "number", "minimum": 0}


def drive(event: str, required: tuple[str, ...] = (), **fields: object) -> dict[str, Any]:
    """The schema of a drive."""
    return record({"event": {"const": event}, **fields}, ("event", *required))


LINE_DRIVES: Mapping[str, Any] = {
    "line": drive("line", ("line",), line=TEXT),
    "advance": drive("advance", ("seconds",), seconds=SECONDS),
}
