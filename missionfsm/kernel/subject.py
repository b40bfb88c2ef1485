"""An implementation under test, as the tools see it."""

from __future__ import annotations

from typing import Protocol

from attrs import frozen

from missionfsm.kernel.codec import JSON


class SubjectError(Exception):
    """The adapter failed: it said something that the protocol does not allow, or nothing. Never a violation."""


class GibberishError(SubjectError):
    """What the adapter said is of the protocol, but cannot be read."""


class MissingMethodError(SubjectError):
    """The adapter does not have the method that it was asked for."""


@frozen
class Notification:
    """Something that the implementation sent unasked: a ``message``, ``closed`` or a ``line``.

    A subject that lives in real time knows more than what it is asked to do: a ``history`` is a line of the history,
    such as that some time has passed.
    """

    method: str
    params: JSON


@frozen
class Exchange:
    """A request's answer, and what had arrived before it was made, before its answer, and with that."""

    result: JSON = None
    error: JSON = None
    before: tuple[Notification, ...] = ()
    after: tuple[Notification, ...] = ()
    earlier: tuple[Notification, ...] = ()


class Subject(Protocol):
    """Something that speaks the adapter protocol: a child process, or an object in this one."""

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Send a request and wait for its answer. Raises SubjectError."""

    def close(self) -> None:
        """Let go of it."""
