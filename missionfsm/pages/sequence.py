"""A history as the rows of a sequence diagram: who did what, in which order, up to the line that is wrong."""

from __future__ import annotations

import enum
import json
from collections.abc import Iterator, Sequence
from typing import Any

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Called, Event
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief
from missionfsm.oracle.transcript import Transcript
from missionfsm.tools.check.phrases import event_words, name_words

SHOWN = 60
"""How many of the last rows are shown at once; those before are folded away."""


class Way(enum.Enum):
    """Where the arrow of a row points, if it is one."""

    ASKS = "asks"
    ANSWERS = "answers"
    HAPPENS = "happens"


@frozen
class Row:
    """One line of a history.

    Attributes:
        kind: what sort of line it is, for people.
        words: what it says; `line` is the line itself.
        wrong: nothing explains it.
    """

    number: int
    way: Way
    kind: str
    words: str
    line: JSON
    wrong: bool = False

    @property
    def text(self) -> str:
        """The line as it stands in the history."""
        return json.dumps(self.line, ensure_ascii=False)


_KINDS = {
    "call": (Way.ASKS, "call"),
    "return": (Way.ANSWERS, "answer"),
    "stream": (Way.ANSWERS, "message"),
    "connection": (Way.ANSWERS, "line"),
    "drive": (Way.HAPPENS, "environment"),
    "settled": (Way.HAPPENS, "settled"),
}


def rows(system: System, history: Sequence[JSON], *, violation: bool) -> tuple[Row, ...]:
    """The rows of a history, its first line left out. In the history of a violation the last is the wrong one."""
    found = tuple(_rows(system, history[1:]))
    return (*found[:-1], evolve(found[-1], wrong=True)) if found and violation else found


def _rows(system: System, lines: Sequence[JSON]) -> Iterator[Row]:
    transcript = Transcript(system.codec)
    for number, line in enumerate(lines, 1):
        way, kind = next((_KINDS[key] for key in _KINDS if key in line), (Way.HAPPENS, ""))
        try:
            words = "; ".join(_event(system, event) for event in transcript.read(line))
        except UnreadableError:
            # A long history is kept without its beginning, and an answer may be left without its call.
            words = brief(line)
        yield Row(number, way, kind, words or brief(line), line)


def _event(system: System, event: Event) -> str:
    words = event_words(system.spec, event)
    names: tuple[Any, ...] = event.names if isinstance(event, Called) else ()
    return f"{words} of {', '.join(map(name_words, names))}" if names else words
