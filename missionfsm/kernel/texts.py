"""Lines of a history that say again what one said before, known by their text.

Most lines of a long log differ from others in nothing but the number of a call. To know such a line by the bytes after
that number is several times as fast as to read it.
"""

from __future__ import annotations

from typing import Any

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer, Called, Driven, Event, Returned, Settled
from missionfsm.kernel.transcript import REMEMBERED, Transcript

_CALL, _RETURN, _STREAM = b'{"call":', b'{"return":', b'{"stream":'
"""How nearly all lines begin that call, return or show a message; no two messages are alike."""
_MOST_DIGITS = 19
LONG = 1_000
"""Bytes of a line that is too long to be remembered."""


class Texts:
    """The lines that a transcript has read, to know them again. Names are never remembered: they do not come again.

    It is for lines that say neither a time nor a robot.
    """

    def __init__(self, transcript: Transcript) -> None:
        self._transcript = transcript
        self._pending = transcript.pending
        self._calls: dict[bytes, tuple[str, Any]] = {}
        self._answers: dict[tuple[str | None, bytes], Answer] = {}
        self._others: dict[bytes, tuple[Event, ...]] = {}

    def again(self, text: bytes) -> tuple[Event, ...] | None:
        """The events of a line that says what one said before; None where it has to be read.

        Raises:
            UnreadableError: the call was sent before.
        """
        if text.startswith(_STREAM):
            return None
        if text.startswith(_CALL):
            end = text.find(b",")
            called = self._calls.get(text[end:])
            if called is None or not _is_number(text[8:end]):
                return None
            return self._transcript.sends(int(text[8:end]), *called)
        if text.startswith(_RETURN):
            end = text.find(b",")
            if not _is_number(text[10:end]):
                return None
            number = int(text[10:end])
            waiting = self._pending.get(number)
            answer = None if waiting is None else self._answers.get((waiting[0], text[end:]))
            return None if answer is None else self._transcript.answers(number, answer)
        return self._others.get(text)

    def read(self, text: bytes, line: JSON) -> tuple[Event, ...]:
        """The events of a line that was not known. Raises UnreadableError."""
        number = line.get("return") if isinstance(line, dict) else None
        waiting = self._pending.get(number) if type(number) is int else None
        events = self._transcript.read(line)
        if len(text) <= LONG and len(events) == 1:
            self._remember(text, line, events[0], waiting and waiting[0])
        return events

    def _remember(self, text: bytes, line: JSON, event: Event, method: str | None) -> None:
        if len(self._calls) + len(self._answers) + len(self._others) >= REMEMBERED:
            for known in (self._calls, self._answers, self._others):
                known.clear()
        if type(event) is Called and not event.names:
            rest = _rest(text, _CALL, line["call"])
            if rest:
                self._calls[rest] = line["method"], event.request
        elif type(event) is Returned and not event.names and method is not None:
            rest = _rest(text, _RETURN, line["return"])
            if rest:
                self._answers[method, rest] = event.answer
        elif type(event) is Settled or (type(event) is Driven and not event.names):
            self._others[text] = (event,)


def _rest(text: bytes, begins: bytes, number: int) -> bytes:
    """What comes after the number of a line; empty if the line is written in another way, or has the key twice."""
    end = text.find(b",")
    rest = text[end:]
    usual = text.startswith(begins) and text[len(begins) : end] == b"%d" % number and begins[1:-1] not in rest
    return rest if usual else b""


def _is_number(digits: bytes) -> bool:
    """Whether digits are a number as nearly all are written: positive, and not too long for JSON."""
    return digits.isdigit() and digits[0] != ord("0") and len(digits) < _MOST_DIGITS


__all__ = ["Texts"]
