"""The errors that a documented call may be answered with, as exceptions: one class for every gRPC status."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from missionfsm.kernel.rules import STATUS_NUMBERS, Citation, Operation, Rule


class ApiError(Exception):
    """A call is refused, or fails.

    Attributes:
        code: the name of the gRPC status, such as ``FAILED_PRECONDITION``; `number` is its number.
        operation: the call that is answered.
        rule: the id of the rule that justifies it; None for a failure that no rule of the document asks for.
        citation: the place in the document, such as ``Mission › CreateMission › Errors``.
        message: what is wrong, for people.
    """

    code: ClassVar[str] = "UNKNOWN"

    def __init__(self, operation: str, rule: str | None, citation: str, message: str) -> None:
        super().__init__(operation, rule, citation, message)
        self.operation = operation
        self.rule = rule
        self.citation = citation
        self.message = message

    @property
    def number(self) -> int:
        """The number of the gRPC status."""
        return STATUS_NUMBERS[self.code]

    def __str__(self) -> str:
        return f"{self.operation}: {self.code}: {self.message} [{self.citation}]"


# The names are those of the statuses, as gRPC's own bindings have them.


class Cancelled(ApiError):  # noqa: N818 - see above
    """The call was given up."""

    code = "CANCELLED"


class InvalidArgument(ApiError):  # noqa: N818 - see above
    """The request is wrong whatever the system does: send another."""

    code = "INVALID_ARGUMENT"


class DeadlineExceeded(ApiError):  # noqa: N818 - see above
    """No confirmation came in time: whether the call took effect is open."""

    code = "DEADLINE_EXCEEDED"


class NotFound(ApiError):  # noqa: N818 - see above
    """What the request is about does not exist here."""

    code = "NOT_FOUND"


class PermissionDenied(ApiError):  # noqa: N818 - see above
    """What the request is about belongs to somebody else."""

    code = "PERMISSION_DENIED"


class ResourceExhausted(ApiError):  # noqa: N818 - see above
    """Too much was asked for."""

    code = "RESOURCE_EXHAUSTED"


class FailedPrecondition(ApiError):  # noqa: N818 - see above
    """The system is not in a state that allows the call: bring it into one first."""

    code = "FAILED_PRECONDITION"


class Unimplemented(ApiError):  # noqa: N818 - see above
    """The call does not exist here."""

    code = "UNIMPLEMENTED"


class Internal(ApiError):  # noqa: N818 - see above
    """The call failed inside the system, without effect: send it again."""

    code = "INTERNAL"


class Unavailable(ApiError):  # noqa: N818 - see above
    """The system cannot be reached."""

    code = "UNAVAILABLE"


class Unauthenticated(ApiError):  # noqa: N818 - see above
    """The caller is nobody that the system knows."""

    code = "UNAUTHENTICATED"


ERRORS: Mapping[str, type[ApiError]] = {
    kind.code: kind
    for kind in (
        Cancelled,
        InvalidArgument,
        DeadlineExceeded,
        NotFound,
        PermissionDenied,
        ResourceExhausted,
        FailedPrecondition,
        Unimplemented,
        Internal,
        Unavailable,
        Unauthenticated,
    )
}
"""The class of every status that a specification knows, by its name."""


def error(code: str, operation: Operation, rules: tuple[Rule, ...]) -> ApiError:
    """The exception for an answer.

    Args:
        code: the status, one of `ERRORS`.
        operation: what was called.
        rules: those that justify the answer, the first of which is named; none for a failure that just comes.
    """
    kind = ERRORS[code]
    if not rules:
        table = Citation(operation.cite.document, (*operation.cite.headings, "Errors"))
        return kind(operation.name, None, str(table), _FAILURES.get(code, "The call failed."))
    return kind(operation.name, rules[0].id, str(rules[0].cite), " ".join(rule.says for rule in rules))


_FAILURES: Mapping[str, str] = {
    Internal.code: "The call failed inside the system; it may be sent again.",
    DeadlineExceeded.code: "No confirmation came in time; whether the call took effect is not known.",
}
