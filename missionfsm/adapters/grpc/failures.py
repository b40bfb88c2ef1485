"""How the errors of gRPC calls are told."""

from __future__ import annotations

from typing import Any

from missionfsm.kernel.codec import JSON


def as_json(error: Any) -> JSON:  # noqa: ANN401 - grpc's errors are calls as well
    """The error as the adapter protocol has it."""
    return {"status": error.code().name, "message": error.details() or ""}


def in_words(error: Any) -> str:  # noqa: ANN401 - as above
    """The error for people; a stream may have come to an end without one."""
    code = getattr(error, "code", None)
    return f"{code().name}: {error.details()}" if callable(code) else "its end"
