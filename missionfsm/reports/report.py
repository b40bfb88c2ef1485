"""What a report tells, whatever its format: what was judged, by what and when."""

from __future__ import annotations

from attrs import frozen

from missionfsm.kernel.codec import JSON
from missionfsm.tools.check.verdict import Verdict


@frozen
class Made:
    """When, by which version and by which command something was made.

    Attributes:
        date: in UTC, as RFC 3339 has it.
    """

    version: str
    date: str
    command: str

    def to_json(self) -> JSON:
        """The stamp as JSON files have it."""
        return {"version": self.version, "date": self.date, "command": self.command}

    def __str__(self) -> str:
        return f"missionfsm {self.version}, {self.date}: {self.command}"


@frozen
class Finding:
    """A verdict, and what it is about.

    Attributes:
        file: the history that was read; empty if an implementation was judged.
        robot: the robot that it is about, if the file names robots.
        seconds: how long it took to judge the file, all its robots together.
    """

    verdict: Verdict
    file: str = ""
    robot: str | None = None
    seconds: float = 0.0

    @property
    def subject(self) -> str:
        """What was judged, where no file says so."""
        return self.verdict.implementation or self.verdict.system


@frozen
class Report:
    """All that a command has judged.

    Attributes:
        stale: rules whose violation was expected and was not met.
        several: whether several verdicts were asked for, however many there are.
    """

    findings: tuple[Finding, ...]
    made: Made
    stale: tuple[str, ...] = ()
    several: bool = False
