"""Lines of a history that say again what one said before, known by their text.

Most lines of a long log differ from others in nothing but the number of a call. To know such a line by the bytes after
that number is several times as fast as to read it.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable

from attrs import evolve

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer, Called, Driven, Event, Name, Received, Returned, Settled
from missionfsm.kernel.terms import Content, Request
from missionfsm.oracle.memory import ENTRY, MEMORY, TEXT, TEXTS, Room
from missionfsm.oracle.transcript import Transcript

_CALL, _RETURN, _STREAM, _MESSAGE = b'{"call":', b'{"return":', b'{"stream":', b',"message":'
_AFTER_CALL, _AFTER_RETURN, _AFTER_STREAM, _MESSAGE_LENGTH = map(len, (_CALL, _RETURN, _STREAM, _MESSAGE))
"""How nearly all lines begin that call, return or show a message."""
_MAX_DIGITS, _ZERO = 19, ord("0")
_NOBODY: tuple[Name, ...] = ()
FORMS = 100
"""How many different texts around a name are remembered."""
NAMES = 1_000
"""How many names are remembered with the texts that they have in messages."""
LONG = 16_000
"""Bytes of a line that is too long to be remembered."""


class Texts:
    """The lines that a transcript has read, to know them again, with any name where one name was.

    It is for lines that say neither a time nor a robot. But for messages, with several names in it none is known again.

    Args:
        transcript: what reads the lines.
        write: JSON as a text, in the way that nearly all lines are written.
    """

    def __init__(self, transcript: Transcript, write: Callable[[JSON], bytes]) -> None:
        self._room = Room(MEMORY // TEXTS)
        self._transcript = transcript
        self._write = write
        self._skim = transcript.codec.skim
        self._pending = transcript.pending
        self._begins, self._sends, self._answers_to = transcript.begins, transcript.sends, transcript.answers
        self._calls: dict[bytes, tuple[str, Request]] = {}
        self._answers: dict[tuple[str | None, bytes], Answer] = {}
        self._others: dict[bytes, tuple[Event, ...]] = {}
        self._contents: dict[bytes, Hashable] = {}
        self._names: dict[bytes, Name] = {}
        self._latest: dict[int, bytes] = {}
        self._called = _Named()
        self._answered = _Named()

    def known(self, text: bytes) -> tuple[Event, ...] | None:
        """The events of a line that says what one said before; None where it has to be read.

        Raises:
            UnreadableError: the call was sent before.
        """
        if text.startswith(_STREAM):
            return self._message(text)
        if text.startswith(_CALL):
            end = text.find(b",")
            rest, names = text[end:], _NOBODY
            called = self._calls.get(rest)
            if called is None:
                called, names = self._called.find(None, rest)
            number = _number(text[_AFTER_CALL:end])
            if called is None or not number:
                return None
            method, request = called
            self._begins(number)
            return self._sends(number, method, request, names)
        if text.startswith(_RETURN):
            end = text.find(b",")
            number = _number(text[_AFTER_RETURN:end])
            waiting = self._pending.get(number) if number else None
            if waiting is None:
                return None
            rest, names = text[end:], _NOBODY
            answer = self._answers.get((waiting[0], rest))
            if answer is None:
                answer, names = self._answered.find(waiting[0], rest)
            return None if answer is None else self._answers_to(number, answer, names)
        events = self._others.get(text)
        if events and type(events[0]) is Driven:
            self._transcript.drives()
        return events

    def _message(self, text: bytes) -> tuple[Event, ...] | None:
        end = text.find(b",")
        number = _number(text[_AFTER_STREAM:end])
        if not number or not text.startswith(_MESSAGE, end) or not text.endswith(b"}"):
            return None
        skimmed = self._skim(text[end + _MESSAGE_LENGTH : -1])
        if skimmed is None:
            return None
        found, marks, rest = skimmed
        content = self._contents.get(rest)
        if content is None:
            return None
        names = tuple(map(self._names.get, found))
        if None in names:
            names = tuple(map(self._name, found))
            if None in names:
                return None
        repeats_last = self._latest.get(number) == text
        self._latest[number] = text
        channel = "stream", number
        stale = self._transcript.is_stale(channel, marks)
        return (Received(channel, content, names, marks, repeats_last, stale),)

    def _name(self, written: bytes) -> Name | None:
        """The name that is written so; None unless it is written just as it is."""
        name = written.decode("ascii", "replace")
        if not _is_plain(name):
            return None
        if len(self._names) >= NAMES:
            self._names.clear()
        self._names[written] = name
        return name

    def read(self, text: bytes, line: JSON) -> tuple[Event, ...]:
        """The events of a line that was not known. Raises UnreadableError."""
        number = line.get("return") if isinstance(line, dict) else None
        waiting = self._pending.get(number) if type(number) is int else None
        events = self._transcript.read(line)
        if "stream" in line:
            if self._latest.get(line["stream"]) == text:
                events = tuple(
                    evolve(one, repeats_last=True) if type(one) is Received and one.marks else one for one in events
                )
            self._latest[line["stream"]] = text
        if len(text) <= LONG and len(events) == 1:
            self._remember(text, line, events[0], waiting and waiting[0])
        return events

    def _remember(self, text: bytes, line: JSON, event: Event, method: str | None) -> None:
        if self._room.overflows(ENTRY + TEXT * len(text)):
            self._forget()
        if type(event) is Called:
            self._remember_call(_rest(text, _CALL, line["call"]), line["method"], event)
        elif type(event) is Returned and method is not None:
            rest = _rest(text, _RETURN, line["return"])
            if rest and event.names:
                self._answered.add(method, rest, event.names, event.answer)
            elif rest:
                self._answers[method, rest] = event.answer
        elif type(event) is Settled or (type(event) is Driven and not event.names):
            self._others[text] = (event,)
        elif type(event) is Received and text == self._write(line):
            self._remember_message(text, event)

    def _remember_call(self, rest: bytes, method: str, event: Called) -> None:
        if rest and event.names:
            self._called.add(None, rest, event.names, (method, event.request))
        elif rest:
            self._calls[rest] = method, event.request

    def _forget(self) -> None:
        self._calls.clear()
        self._answers.clear()
        self._others.clear()
        self._contents.clear()

    def _remember_message(self, text: bytes, event: Received) -> None:
        """Remember what a message shows that is written as nearly all are: in such a text nothing comes twice."""
        begins, found, message = text.partition(_MESSAGE)
        skimmed = self._skim(message[:-1])
        if not found or not begins.startswith(_STREAM) or skimmed is None:
            return
        names, marks, rest = skimmed
        if tuple(map(self._name, names)) == event.names and marks == event.marks:
            self._contents[rest] = event.content


class _Named:
    """What texts say that have one name in them: what comes before it, what comes after it, and what that says."""

    def __init__(self) -> None:
        self._said: dict[tuple[str | None, bytes, bytes], Content] = {}
        self._lengths: tuple[int, ...] = ()

    def find(self, method: str | None, rest: bytes) -> tuple[Content, tuple[Name, ...]]:
        """What a text says, and its name; None for one that is not known."""
        for length in self._lengths:
            end = rest.find(b'"', length)
            said = self._said.get((method, rest[:length], rest[end:]))
            if said is not None:
                name = rest[length:end].decode("ascii", "replace")
                return (said, (name,)) if _is_plain(name) else (None, _NOBODY)
        return None, _NOBODY

    def add(self, method: str | None, rest: bytes, names: tuple[Name, ...], said: Content) -> None:
        """Remember what a text says, if it has one name and that is written as it is, once."""
        name = names[0]
        if len(names) > 1 or not isinstance(name, str) or not _is_plain(name) or b"\\" in rest:
            return
        begun, found, end = rest.partition(b'"%b"' % name.encode())
        if not found or found in end or len(self._said) >= FORMS:
            return
        self._said[method, begun + b'"', b'"' + end] = said
        self._lengths = tuple(dict.fromkeys((*self._lengths, len(begun) + 1)))


def _is_plain(name: str) -> bool:
    """Whether a name is written in JSON just as it is."""
    return bool(name) and name.isascii() and name.isprintable() and "\\" not in name and '"' not in name


def _rest(text: bytes, begins: bytes, number: int) -> bytes:
    """What comes after the number of a line; empty if the line is written in another way, or has the key twice."""
    end = text.find(b",")
    rest = text[end:]
    usual = (
        text.startswith(begins)
        and text[len(begins) : end] == b"%d" % number
        and begins[1:-1] not in rest
        and b"\\" not in rest
    )
    return rest if usual else b""


def _number(digits: bytes) -> int:
    """The number that is written as nearly all are, positive and not too long for JSON; 0 where it is not."""
    return int(digits) if digits.isdigit() and len(digits) < _MAX_DIGITS and digits[0] != _ZERO else 0


__all__ = ["Texts"]
