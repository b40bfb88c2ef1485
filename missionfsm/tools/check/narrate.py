"""What happened, for people: one line for each thing that was done, with its answer, up to the one that is wrong."""

from __future__ import annotations

import contextlib
import itertools
import json
from collections.abc import Iterable, Iterator

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Called, Driven, Ended, Event, Name, Received, Returned, Settled
from missionfsm.kernel.system import System
from missionfsm.kernel.text import printable, shortened
from missionfsm.oracle.transcript import Transcript
from missionfsm.tools.check.phrases import answer_words, event_words, name_words
from missionfsm.tools.check.verdict import Violation

MAX_NAME = 20
"""How many digits of a name are read; in place of longer ones a story numbers them."""

MAX_LINE = 300
"""How many characters of one thing that happened a story has room for."""

MAX_CHARACTERS = 240
"""How many characters of a world a story has room for."""


def story(system: System, history: tuple[JSON, ...]) -> str:
    """A history in numbered lines. A call and its answer share a line, and so do passing time and the event after it.

    A world that is not the usual one comes before the lines.
    """
    folded = (_folded(line, len(list(same))) for line, same in itertools.groupby(_lines_of(system, history)))
    lines = [f"{number:>3}. {shortened(line, MAX_LINE)}" for number, line in enumerate(folded, 1)]
    unusual = _unusual(system, history[0].get("world") or {}) if history else ""
    return "\n".join([f"  0. in the world {unusual}", *lines] if unusual else lines)


def _folded(line: str, times: int) -> str:
    return line if times == 1 else f"{line}, {times} times"


def story_of(system: System, violation: Violation) -> str:
    """The conversation that shows a violation; if several do, each of them with what it shows and its world."""
    if not violation.sides:
        return story(system, violation.history)
    parts = []
    for number, side in enumerate(violation.sides, 1):
        usual = "" if _unusual(system, side.history[0].get("world") or {}) else "  0. in the usual world\n"
        parts.append(f"conversation {number}: {printable(side.says)}\n{usual}{story(system, side.history)}")
    return "\n\n".join(parts)


def _unusual(system: System, world: JSON) -> str:
    """The members of a world that are not as in the usual one, as JSON of moderate length; empty if it is that."""
    read = system.codec.read_world
    if read(world) == read(system.alphabet({}, Bounds()).worlds[0]):
        return ""
    differs = dict(world)
    for name in world:
        with contextlib.suppress(UnreadableError):  # what must be said cannot be usual
            rest = {other: value for other, value in differs.items() if other != name}
            differs = rest if read(rest) == read(world) else differs
    text = printable(json.dumps(differs, ensure_ascii=False))
    return text if len(text) <= MAX_CHARACTERS else f"{text[: MAX_CHARACTERS - 1]}…"


def _events(system: System, history: Iterable[JSON]) -> Iterator[Event]:
    transcript = Transcript(system.codec)
    for line in history:
        yield from transcript.read(line)


def _lines_of(system: System, history: tuple[JSON, ...]) -> Iterator[str]:
    """The lines of a story. Time that passes is told with the next event, unless that is more time or settling."""
    passing: Driven | None = None
    for words, event in _lines(system, history):
        later = _later(system, passing) if passing is not None else ""
        if passing is not None and (isinstance(event, Settled) or _later(system, event)):
            yield event_words(system.spec, passing)
            later = ""
        passing = event if isinstance(event, Driven) and _later(system, event) else None
        if passing is None:
            yield f"{later}, {words}" if later else words
    if passing is not None:
        yield event_words(system.spec, passing)


def _later(system: System, event: Event) -> str:
    """The words for time that passes, before what comes next; empty for all other events."""
    later = system.spec.drives[event.event.name].later if isinstance(event, Driven) else None  # type: ignore[attr-defined]
    return later(event.event) if later is not None and isinstance(event, Driven) else ""


def _lines(system: System, history: tuple[JSON, ...]) -> Iterator[tuple[str, Event]]:
    """A line for each event; an answer that comes at once shares the line of its call."""
    asked: Called | None = None
    spec = system.spec
    known: dict[Name, int] = {}

    def call(asked: Called) -> str:
        about = f" of {', '.join(map(name_words, asked.names))}" if asked.names else ""
        return event_words(spec, asked) + about

    for event in _events(system, history[1:]):
        if asked is not None and isinstance(event, Returned) and event.call == asked.call:
            yield f"{call(asked)} → {answer_words(event.answer, tuple(map(name_words, event.names)))}", event
            asked = None
            continue
        if asked is not None:
            yield call(asked), asked
        asked = event if isinstance(event, Called) else None
        if asked is None:
            said = event_words(spec, event) + _long_names(event, known)
            yield "(settled)" if isinstance(event, Settled) else said, event
    if asked is not None:
        yield call(asked), asked


def _long_names(event: Event, known: dict[Name, int]) -> str:
    """Names that are too long to be told from each other, by the order in which they come: the first, the second."""
    if not isinstance(event, Driven | Received):
        return ""
    long = [one for one in event.names if isinstance(one, tuple) and len(str(one[-1])) > MAX_NAME]
    return "".join(f" ({one[0]} no. {known.setdefault(one, len(known) + 1)})" for one in dict.fromkeys(long))


def as_pytest(history: tuple[JSON, ...], name: str) -> str:
    """A pytest function that judges the history again."""
    body = "\n".join(f"    {json.dumps(line, ensure_ascii=False)!r}," for line in history)
    return (
        "from missionfsm import check\n\n"
        f"HISTORY = (\n{body}\n)\n\n\n"
        f"def test_{name}() -> None:\n"
        '    """The recorded conversation can be explained."""\n'
        "    verdict = check(HISTORY)\n"
        "    assert verdict.violation is None, str(verdict)\n"
    )


def as_mermaid(system: System, history: tuple[JSON, ...]) -> str:
    """A Mermaid sequence diagram of the history."""
    lines = ["sequenceDiagram", "    participant C as client", "    participant S as implementation"]
    for event in _events(system, history[1:]):
        words = event_words(system.spec, event).replace(";", ",").replace("#", "no. ")
        if isinstance(event, Called):
            lines.append(f"    C->>S: {words}")
        elif isinstance(event, Returned | Received | Ended):
            lines.append(f"    S-->>C: {words}")
        elif isinstance(event, Driven):
            lines.append(f"    Note over S: {words}")
        else:
            lines.append(f"    Note over C,S: {words}")
    return "\n".join(lines) + "\n"
