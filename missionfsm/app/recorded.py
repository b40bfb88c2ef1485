"""Judges a recorded file: how often it is read, and which verdict stands."""

from __future__ import annotations

import functools
import io
import itertools
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import IO, Any

from attrs import evolve

from missionfsm.adapters.addresses import Addresses
from missionfsm.adapters.historyfile import (
    STDIN,
    Lines,
    called,
    early_answers,
    is_plain_file,
    lines,
    lost_calls,
    open_history,
    placed,
    wrong_line,
)
from missionfsm.app.advice import with_advice
from missionfsm.app.asked import Asked
from missionfsm.app.conversations import verdicts_by_robot
from missionfsm.app.likelier import FURTHER, LONGEST, with_likelier
from missionfsm.app.perrobot import KEPT_NODES, Judges, Lost, UndecidedError, automaton_of
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.tools.check.judge import MAX_LINES, Judge
from missionfsm.tools.check.scope import held_to_the_text
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.contradiction import MAX_KEPT


def check_file(
    path: str,
    readings: Mapping[str, str] | None = None,
    tell: Callable[[str], None] = lambda _: None,
    **how: Any,  # noqa: ANN401 - see `Asked`
) -> list[tuple[str | None, Verdict]]:
    """The verdict for each robot that a history speaks of, in the order of their first lines.

    A line without a robot belongs to the one conversation of the file. A file that begins with a message of a
    subscription, or with the body of a webhook, has bare messages: each subscription has a verdict.

    Args:
        path: the file; ``-`` is stdin.
        readings: the readings to assume.
        tell: is given every problem of a bare message as soon as it is read.
        how: how else the file is to be judged; see `missionfsm.app.asked.Asked`.

    Raises:
        UnreadableError: there is no such file, or a line is not of the format; the message says where and what.
        ValueError: `readings` names something that does not exist.
    """
    asked = Asked(readings or {}, **how)
    again: Callable[[Asked], list[tuple[str | None, Verdict]]]
    if is_plain_file(path):
        found = _read_twice(path, asked, tell)
        again = functools.partial(_read_twice, path, tell=_nobody)
    else:  # it can be read only once, but what was read can be kept
        kept = _Kept(open_history(path))
        found = _judged(path, asked, tell, {}, MAX_LINES, io.BufferedReader(kept))
        if kept.overflows:
            return found
        again = functools.partial(_judged_again, path, kept.content)
    # A violation may have its cause long before, in a message that was lost unnoticed. So such a file is judged once
    # more, with the faults of a transport considered at every event.
    doubtful = {robot for robot, verdict in found if verdict.violation and verdict.violation.at <= LONGEST_SECOND_LOOK}
    if not doubtful:
        return found
    # Verdicts on bare messages have no robot, and are told apart by their subscription.
    second = {
        (robot, verdict.implementation): verdict
        for robot, verdict in again(evolve(asked, eager=True, only=frozenset(doubtful)))
    }
    told = [(robot, _better(verdict, second.get((robot, verdict.implementation)))) for robot, verdict in found]
    return [(robot, _told_more(path, asked, robot, verdict)) for robot, verdict in told]


MOST_KEPT = 64_000_000
"""How many bytes of a pipe are kept, so that it can be judged a second time."""


class _Kept(io.RawIOBase):
    """A source that keeps what is read of it, unless that is too much.

    Attributes:
        content: what was read so far.
        overflows: whether it was too much.
    """

    def __init__(self, source: IO[bytes]) -> None:
        self._source = source
        self._read: Callable[[int], bytes] = getattr(source, "read1", source.read)
        self.content = bytearray()
        self.overflows = False

    def readable(self) -> bool:
        """It can be read."""
        return True

    def readinto(self, buffer: Any, /) -> int:  # noqa: ANN401 - whatever holds bytes
        """Read what there is, as far as it has room."""
        block = self._read(len(buffer))
        buffer[: len(block)] = block
        self.overflows = self.overflows or len(self.content) + len(block) > MOST_KEPT
        if self.overflows:
            self.content.clear()
        else:
            self.content += block
        return len(block)

    def close(self) -> None:
        """Close the source as well."""
        self._source.close()
        super().close()


def _judged_again(path: str, content: bytearray, asked: Asked) -> list[tuple[str | None, Verdict]]:
    """The verdicts on what was kept of a pipe."""
    return _judged(path, asked, _nobody, {}, MAX_LINES, io.BytesIO(content))


def _nobody(_: str) -> None:
    """Nobody is told."""


LONGEST_SECOND_LOOK = 20_000
"""The line up to which a violation makes the file be judged a second time."""


def _better(first: Verdict, second: Verdict | None) -> Verdict:
    """The verdict that explains more."""
    if first.violation is None or second is None:
        return first
    later = second.violation is not None and second.violation.at > first.violation.at
    return second if second.conforms or later else first


def _told_more(path: str, asked: Asked, robot: str | None, verdict: Verdict) -> Verdict:
    """The verdict, with an answer that is likelier to be wrong, and with the option that explains the line, if any."""
    violation = verdict.violation
    if violation is None or violation.at > LONGEST or verdict.implementation or not is_plain_file(path):
        return verdict
    early = functools.cache(functools.partial(_early_answers, path))
    with open_history(path) as source:
        numbered = itertools.islice(lines(source, path), violation.at + FURTHER)
        try:
            (_, first), *others = numbered
            judges = Judges(first, asked, {}, 0, early)
            own = [(number, line) for number, (whose, line) in _addressed(judges, others) if whose == robot]
        except UnreadableError:  # a line behind the violation is not of the format: nobody has looked at it before
            return verdict
    another, prompt = (functools.partial(one, robot) for one in (judges.another, judges.prompt))
    likelier = with_likelier(judges.system, violation, own, another, prompt)

    def judge_of(otherwise: Asked) -> Judge:
        return Judges(first, otherwise, {}, 0, early).another(robot, frozenset())

    upto = [line for number, line in own if number <= violation.at]
    return evolve(verdict, violation=with_advice(likelier, asked, upto, judge_of))


def _addressed(judges: Judges, numbered: Iterable[tuple[int, JSON]]) -> Iterator[tuple[int, tuple[str | None, JSON]]]:
    """Whose each line is, up to another conversation."""
    for number, line in numbered:
        if isinstance(line, dict) and "missionfsm" in line:
            break
        yield number, judges.addresses.whose(line)


def _read_twice(path: str, asked: Asked, tell: Callable[[str], None]) -> list[tuple[str | None, Verdict]]:
    """The verdicts on a file, which is read again if calls seem to be lost."""
    try:
        return _judged(path, asked, tell, None)
    except UndecidedError as undecided:
        return _judged(path, asked, tell, lost_calls(path, by_params=undecided.by_params))


FIRST_LINE = '{"missionfsm": 1, "system": …, "world": …}'
"""How a history begins."""


def _judged(
    path: str,
    asked: Asked,
    tell: Callable[[str], None],
    lost: Lost | None,
    keep: int = 0,
    source: IO[bytes] | None = None,
) -> list[tuple[str | None, Verdict]]:
    """The verdicts on one file, read once; see `check_file`.

    Args:
        path, asked, tell: see `check_file`.
        lost: the calls that are never answered; None: not known yet, so that `UndecidedError` may be raised.
        keep: how many lines are kept to be shown; if none, the file is read again to show them.
        source: where it is read from; None: the file.
    """
    source = open_history(path) if source is None else source
    early = functools.cache(functools.partial(_early_answers, path))
    parts: list[Judges] = []
    try:
        texts = Lines(source, path)
        numbered = iter(texts)
        number, text = next(numbered, (0, b""))
        if not number:
            message = f"{called(path)}: the history is empty"
            raise UnreadableError(message)
        with placed(path, number):
            line = texts.json(text)
        if _is_bare_message(line):
            return _watched(path, asked, tell, itertools.chain([(number, line)], texts.parsed(numbered)))
        with placed(path, number):
            _refuse_other_beginnings(line)
        following: tuple[int, JSON] | None = (number, line)
        while following is not None:
            with placed(path, following[0]):
                judges = Judges(following[1], asked, lost, keep, early)
            parts.append(judges)
            following = judges.read(path, texts, numbered)
    finally:
        if path != STDIN:
            source.close()
    if len(parts) > 1:  # several conversations are judged together, which takes their lines
        if not keep:
            return _judged(path, asked, tell, lost, MAX_KEPT)
        return verdicts_by_robot((part.system, *one) for part in parts for one in part.judgements(path))
    found = judges.verdicts(path)
    if judges.nodes > KEPT_NODES:
        automaton_of.cache_clear()
    by_params = judges.addresses.by_call
    return [
        (robot, verdict if keep else _retold(verdict, path, robot, by_params=by_params)) for robot, verdict in found
    ]


def _refuse_other_beginnings(line: JSON) -> None:
    """Raise UnreadableError for a line that begins neither a history nor bare messages."""
    if isinstance(line, list):
        message = f"the first line has to be {FIRST_LINE}; of a list, `jq -c '.[]'` makes lines"
        raise UnreadableError(message)
    if isinstance(line, dict) and "missionfsm" not in line:
        message = f"the first line has to be {FIRST_LINE}, or a message of a subscription, as all others then"
        raise UnreadableError(message)


def _early_answers(path: str, by_params: bool) -> Mapping[str | None, int] | None:  # noqa: FBT001 - `Early` has it so
    """How many answers a file has to calls from before it, for each robot; None where it can be read only once."""
    return early_answers(path, by_params=by_params) if is_plain_file(path) else None


def _is_bare_message(line: JSON) -> bool:
    """Whether a line is a message of a subscription, or the body of a webhook."""
    if isinstance(line, dict) and "missionfsm" in line:
        return False
    from missionfsm.app.webhooks import subscription  # noqa: PLC0415 - it loads all that has subscriptions

    return subscription(line) is not None


def _watched(
    path: str, asked: Asked, tell: Callable[[str], None], messages: Iterable[tuple[int, JSON]]
) -> list[tuple[str | None, Verdict]]:
    """The verdict on each subscription whose bare messages a file holds."""
    from missionfsm.app.watched import UnplacedError, watch_messages  # noqa: PLC0415 - as above

    _refuse_without_effect(path, asked)
    try:
        watched = watch_messages(messages, tell, strict=asked.strict)
    except UnplacedError as error:
        raise wrong_line(path, error.number, error) from None
    return [(None, held_to_the_text(one) if asked.no_flagged else one) for one in watched]


def _refuse_without_effect(path: str, asked: Asked) -> None:
    """Raise UnreadableError for an option that has no effect on bare messages."""
    given = {
        "--reading": asked.readings,
        "--profile": asked.profile,
        "--begins": asked.anywhere,
        "--others": asked.others,
        "--settled-after": asked.settled_after,
    }
    for option, value in given.items():
        if value:
            message = f"{called(path)}: {option} has no effect on bare messages, which are judged one by one"
            raise UnreadableError(message)


def _retold(verdict: Verdict, path: str, robot: str | None, *, by_params: bool) -> Verdict:
    """The verdict with the last lines before its violation, read again."""
    if verdict.violation is None:
        return verdict
    addresses = Addresses(by_params=by_params)
    kept: deque[JSON] = deque(maxlen=MAX_LINES)
    with open_history(path) as source:
        for number, line in lines(source, path):
            whose, rest = addresses.whose(line)
            if type(line) is dict and "missionfsm" in line:
                kept.clear()
            elif whose == robot:
                kept.append(rest)
            if number == verdict.violation.at:
                break
    history = (*verdict.violation.history, *kept)
    return evolve(verdict, violation=evolve(verdict.violation, history=history))
