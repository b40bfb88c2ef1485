"""What a verdict rests on: what was flagged, and what was not put to the test."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Self

from attrs import field, frozen

from missionfsm.kernel.codec import JSON

MAX_NAMED = 4
"""How many calls, drives or readings a line has room for."""


class Flagged(str):
    """A line about something that is explained, but departs from the letter of the text or is incoherent.

    Attributes:
        reading: the reading that departs from the text, as ``AM-09=b``; empty if it is something else.
        about: what such lines are counted by: the ambiguity, or the pair of ambiguities.
    """

    __slots__ = ("about", "reading")
    reading: str
    about: str

    def __new__(cls, says: str, reading: str = "", about: str = "") -> Self:
        """A line; by default it is about the ambiguity of its reading, or about its words before the first comma."""
        line = super().__new__(cls, says)
        line.reading, line.about = reading, about or reading.partition("=")[0] or says.partition(",")[0]
        return line


@frozen
class Untested:
    """What a verdict says nothing of.

    Attributes:
        calls: for operations by name, why nothing is known of them.
        rules: for rules by id, why they were not put to the test.
        drives: names of the drives that nobody commanded.
        refusals: ids of refusals that could be missed because of that: such a drive may have happened unseen before.
        promises: ids of other rules that only those drives lead to.
        unseen: whether some of those drives may also happen by themselves.
        operations: how many operations the system has.
        all_drives: how many drives the system has.
        shown: whether a stream showed what the system did.
    """

    calls: Mapping[str, str] = field(factory=dict)
    rules: Mapping[str, str] = field(factory=dict)
    drives: tuple[str, ...] = ()
    refusals: tuple[str, ...] = ()
    promises: tuple[str, ...] = ()
    unseen: bool = False
    operations: int = 0
    all_drives: int = 0
    shown: bool = False

    def to_json(self) -> JSON:
        """The gaps as the command line writes them."""
        return {
            "calls": dict(self.calls),
            "rules": dict(self.rules),
            "drives": list(self.drives),
            "refusals": list(self.refusals),
            "promises": list(self.promises),
        }

    @property
    def something(self) -> bool:
        """Whether a call or a drive is missing."""
        return bool(self.calls or self.drives)

    def calls_line(self, *, all_names: bool = False) -> str:
        """What the calls of the system came to; empty for a system without any."""
        return f"calls: {self._calls(all_names=all_names)}" if self.operations else ""

    def drives_line(self, *, all_names: bool = False) -> str:
        """What the drives of the system came to; empty for a system without any."""
        return f"drives: {self._drives(all_names=all_names)}" if self.all_drives else ""

    def _calls(self, *, all_names: bool) -> str:
        if not self.calls:
            return f"all {self.operations} succeeded"
        by_reason: dict[str, list[str]] = {}
        for name, why in self.calls.items():
            reason, _, codes = why.partition(": ")
            text = f"{name} ({codes})" if codes and reason != NOT_THERE else name
            by_reason.setdefault(_SAID.get(reason, reason), []).append(text)
        missing = (f"{why}: {_few(names, all_names=all_names)}" for why, names in by_reason.items())
        return "; ".join((f"{self.operations - len(self.calls)} of {self.operations} succeeded", *missing))

    def _drives(self, *, all_names: bool) -> str:
        if not self.drives:
            return f"all {self.all_drives} commanded"
        missing = _few(self.drives, all_names=all_names)
        text = f"{len(self.drives)} of {self.all_drives} missing ({missing})"
        if self.unseen:
            text += "; what they do may have happened unseen"
        rules = len(self.refusals) + len(self.promises)
        if not rules:
            return text
        count = "1 rule" if rules == 1 else f"{rules} rules"
        if self.shown and self.unseen:
            return f"{text}, so that {count} could be tested only where a stream showed whether it had"
        return f"{text}, so that {count} could not be tested"


OFTEN = 3
"""How often every kind of action should be met in every situation."""


@frozen
class MatrixCoverage:
    """How often a run met each kind of action in each situation, where the system says which there are.

    Attributes:
        cells: how many pairs of a situation and a kind of action could be met.
        holes: those that were met less often than `OFTEN`, to how often.
        never: situations that never came about.
    """

    cells: int
    holes: Mapping[str, int] = field(factory=dict)
    never: tuple[str, ...] = ()

    def to_json(self) -> JSON:
        """The reach as the command line writes it."""
        return {"cells": self.cells, "holes": dict(self.holes), "never": list(self.never)}

    def lines(self, *, all_names: bool = False) -> list[str]:
        """What the run came to, and where it did not."""
        met = self.cells - len(self.holes)
        text = [f"situations × actions: {met} of {self.cells} met {OFTEN} times or more"]
        if self.never:
            text.append(f"  never came about: {_few(self.never, all_names=all_names)}")
        if self.holes:
            holes = (f"{cell} ({times})" for cell, times in sorted(self.holes.items(), key=lambda one: one[1]))
            text.append(f"  too seldom: {_few(holes, all_names=all_names)}")
        return text


NOT_TRIED, NOT_THERE, NEVER_SUCCEEDED = "was not tried", "is not there", "never succeeded"
"""Why nothing is known of a call."""
_SAID = {NOT_TRIED: "not tried", NOT_THERE: "not there"}


def departing(flagged: Iterable[Flagged]) -> tuple[str, ...]:
    """The readings, as ``AM-09=b``, that depart from the text."""
    return tuple(line.reading for line in flagged if line.reading)


def readings_line(
    readings: Mapping[str, tuple[str, ...]], flagged: tuple[Flagged, ...], *, all_names: bool = False
) -> str:
    """What the readings that mattered came to, in a line."""
    still_open = sum(len(letters) > 1 for letters in readings.values())
    against = departing(flagged)
    others = len(flagged) - len(against)
    if against:
        verb = "departs" if len(against) == 1 else "depart"
        text = f"{len(against)} {verb} from the text ({_few(against, all_names=all_names)})"
    else:
        text = "none departs from the text"
    besides = f"; {others} besides that {'is' if others == 1 else 'are'} flagged" if others else ""
    mattered = f"{len(readings)} mattered, {still_open} of them still open" if readings else "none mattered"
    return f"readings: {text}{besides}; {mattered}"


def _few(names: Iterable[str], *, all_names: bool) -> str:
    listed = list(names)
    if all_names or len(listed) <= MAX_NAMED + 1:
        return ", ".join(listed)
    return f"{', '.join(listed[:MAX_NAMED])} and {len(listed) - MAX_NAMED} more"


__all__ = [
    "NEVER_SUCCEEDED",
    "NOT_THERE",
    "NOT_TRIED",
    "OFTEN",
    "Flagged",
    "MatrixCoverage",
    "Untested",
    "departing",
    "readings_line",
]
