"""Refusals: the documented errors, by name and by gRPC number."""

from __future__ import annotations

CODES = {
    "INVALID_ARGUMENT": 3,
    "DEADLINE_EXCEEDED": 4,
    "NOT_FOUND": 5,
    "ALREADY_EXISTS": 6,
    "PERMISSION_DENIED": 7,
    "FAILED_PRECONDITION": 9,
    "UNIMPLEMENTED": 12,
    "INTERNAL": 13,
    "UNAVAILABLE": 14,
}


class Refusal(Exception):
    """A call is answered with a documented error."""

    def __init__(self, status: str, message: str) -> None:
        """Keep the name of the status and a text for people."""
        super().__init__(message)
        self.status = status
        self.message = message

    @property
    def code(self) -> int:
        """The gRPC number of the status."""
        return CODES[self.status]


def invalid(message: str) -> Refusal:
    """Make the refusal of a malformed request."""
    return Refusal("INVALID_ARGUMENT", message)


def not_now(message: str) -> Refusal:
    """Make the refusal of a request that does not fit the robot's state."""
    return Refusal("FAILED_PRECONDITION", message)


def not_found(message: str) -> Refusal:
    """Make the refusal of a request that names what is not there."""
    return Refusal("NOT_FOUND", message)
