"""Judge recorded histories: a file at a time, a robot at a time, a line at a time."""

from __future__ import annotations

import functools
import itertools
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from attrs import evolve

from missionfsm.adapters.addresses import Addresses
from missionfsm.adapters.historyfile import (
    STDIN,
    Lines,
    called,
    fingerprint,
    is_plain_file,
    lines,
    lost_calls,
    open_history,
    placed,
    wrong_line,
)
from missionfsm.app.asked import Asked, judged_system
from missionfsm.app.conversations import verdicts_by_robot
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.line_cache import Texts
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import MAX_LINES, PATIENCE, Judge
from missionfsm.tools.check.scope import assumed, held_to_the_text
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.contradiction import MAX_KEPT
from missionfsm.tools.explore.undriven import missed_without

Lost = Mapping[str | None, frozenset[int]]
"""For each robot the ids of the calls that are never answered."""


def check_file(
    path: str,
    readings: Mapping[str, str] | None = None,
    tell: Callable[[str], None] = lambda _: None,
    **how: Any,  # noqa: ANN401 - see `Asked`
) -> list[tuple[str | None, Verdict]]:
    """The verdict for each robot that a history speaks of, in the order of their first lines.

    A line without a robot belongs to the one conversation of the file. A file that begins with a message of a
    subscription, or with the body of a webhook, has bare messages; what is wrong with one is told at once, and each
    subscription has a verdict.

    Args:
        how: what else the reader of the log says of it; see `missionfsm.app.asked.Asked`.

    Raises:
        UnreadableError: there is no such file, or a line is not of the format; the message says where and what.
        ValueError: `readings` names something that does not exist.
    """
    asked = Asked(readings or {}, **how)
    if not is_plain_file(path):  # it can be read only once
        return _judged(path, asked, tell, {}, MAX_LINES)
    found = _read_twice(path, asked, tell)
    # What nothing explains may have its cause long before, in a message that was lost unnoticed: it is judged once
    # more with all that a transport does in mind at every event.
    doubtful = {robot for robot, verdict in found if verdict.violation and verdict.violation.at <= LONGEST_SECOND_LOOK}
    if not doubtful:
        return found
    second = _read_twice(path, evolve(asked, eager=True, only=frozenset(doubtful)), lambda _: None)
    # Of bare messages each subscription has a verdict, and none of them a robot.
    again = {(robot, verdict.implementation): verdict for robot, verdict in second}
    return [(robot, _better(verdict, again.get((robot, verdict.implementation)))) for robot, verdict in found]


LONGEST_SECOND_LOOK = 20_000
"""The line up to which a violation is looked at for a second time."""
SECOND_PATIENCE = 2_000
"""How many explanations an event may cost then, before the first verdict stands."""


def _better(first: Verdict, second: Verdict | None) -> Verdict:
    """The verdict that explains more."""
    if first.violation is None or second is None:
        return first
    later = second.violation is not None and second.violation.at > first.violation.at
    return second if second.conforms or later else first


def _read_twice(path: str, asked: Asked, tell: Callable[[str], None]) -> list[tuple[str | None, Verdict]]:
    """The verdicts on a file, which is read again where calls seem to be lost."""
    try:
        return _judged(path, asked, tell, None)
    except _UndecidedError as undecided:
        return _judged(path, asked, tell, lost_calls(path, by_params=undecided.by_params))


class _UndecidedError(Exception):
    """Calls wait for answers that may never come: it pays to know beforehand which."""

    def __init__(self, *, by_params: bool) -> None:
        super().__init__()
        self.by_params = by_params


FIRST_LINE = '{"missionfsm": 1, "system": …, "world": …}'
"""How a history begins."""
LOOK = 16
"""How many lines a call may wait for its answer before the file is looked through for such as never get one."""


def _judged(
    path: str, asked: Asked, tell: Callable[[str], None], lost: Lost | None, keep: int = 0
) -> list[tuple[str | None, Verdict]]:
    """The verdicts on one file, read once; see `check_file`.

    Args:
        lost: which calls are never answered; None: hope that all are, or raise.
        keep: how many lines are kept to be shown; with none the file is one that can be read again.
    """
    source = open_history(path)
    parts: list[_Judges] = []
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
            if isinstance(line, list):
                message = f"the first line has to be {FIRST_LINE}; of a list, `jq -c '.[]'` makes lines"
                raise UnreadableError(message)
            if isinstance(line, dict) and "missionfsm" not in line:
                message = f"the first line has to be {FIRST_LINE}, or a message of a subscription, as all others then"
                raise UnreadableError(message)
        following: tuple[int, JSON] | None = (number, line)
        while following is not None:
            with placed(path, following[0]):
                judges = _Judges(following[1], asked, lost, keep)
            parts.append(judges)
            following = judges.read(path, texts, numbered)
    finally:
        if path != STDIN:
            source.close()
    if len(parts) > 1:  # they are judged together, for which their lines are needed
        if not keep:
            return _judged(path, asked, tell, lost, MAX_KEPT)
        return verdicts_by_robot((part.system, *one) for part in parts for one in part.judgements(path))
    found = judges.verdicts(path)
    if judges.nodes > KEPT_NODES:
        _automaton.cache_clear()
    # What was not kept while it was read is read again.
    by_params = judges.addresses.by_call
    return [
        (robot, verdict if keep else _retold(verdict, path, robot, by_params=by_params)) for robot, verdict in found
    ]


def _is_bare_message(line: JSON) -> bool:
    """Whether a line is a message of a subscription, or the body of a webhook."""
    if isinstance(line, dict) and "missionfsm" in line:
        return False
    from missionfsm.app.webhooks import subscription  # noqa: PLC0415 - it loads all that has subscriptions

    return subscription(line) is not None


def _watched(
    path: str, asked: Asked, tell: Callable[[str], None], messages: Iterable[tuple[int, JSON]]
) -> list[tuple[str | None, Verdict]]:
    """The verdict on each subscription of which a file has the bare messages."""
    from missionfsm.app.watched import UnplacedError, watch_messages  # noqa: PLC0415 - as above

    _refuse_without_effect(path, asked)
    try:
        watched = watch_messages(messages, tell, strict=asked.strict)
    except UnplacedError as error:
        raise wrong_line(path, error.number, error) from None
    return [(None, held_to_the_text(one) if asked.no_flagged else one) for one in watched]


def _refuse_without_effect(path: str, asked: Asked) -> None:
    """Raise UnreadableError where something is said of bare messages that has no effect on them."""
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


KEPT_NODES = 5_000
"""How many nodes an automaton may have that is kept for the files after this one."""


@functools.lru_cache(maxsize=2)
def _automaton(seen: tuple[str, bool, bool, bool], how: tuple[tuple[str, ...], int, int, bool], _: int) -> Automaton:
    """The automaton of logs of a kind: what one file of a folder has shown need not be found out for the next.

    Args:
        seen: of which system, and how it is seen, as for `judged_system`.
        how: what an automaton is made with besides.
        _: the thread; no two walk the same at a time.
    """
    name, strict, anywhere, others = seen
    drives, decided, patience, eager = how
    spec = judged_system(name, strict=strict, anywhere=anywhere, others=others).spec
    return Automaton(spec, drives, decided, patience, eager=eager)


class _Judges:
    """The judges of a file, one for each robot that it speaks of.

    Args:
        line: the first line.
        keep: how many lines are kept to be shown; with none, lines that come again are known by their text.

    Raises:
        UnreadableError: that is no first line.
    """

    def __init__(self, line: JSON, asked: Asked, lost: Lost | None, keep: int) -> None:
        first = head(line)
        self._head = first = evolve(
            first,
            strict=asked.strict or first.strict,
            anywhere=asked.anywhere or first.anywhere,
            others=asked.others or first.others,
        )
        self.system = judged_system(first.system, strict=first.strict, anywhere=first.anywhere, others=first.others)
        self.addresses = Addresses(by_params=self.system.codec.robot_in_params)
        self.addresses.whose(line)
        readings = self.system.chosen(asked.profile, asked.readings)
        decided = assumed(self.system.spec, readings, no_flagged=asked.no_flagged)
        self._only, self._settled_after = asked.only, asked.settled_after
        self._waits = not asked.eager
        patience = PATIENCE if self._waits else SECOND_PATIENCE
        self._automaton = _automaton(
            (first.system, first.strict, first.anywhere, first.others),
            (self._head.drives, decided, patience, asked.eager),
            threading.get_ident(),
        )
        self._no_flagged = asked.no_flagged
        self._lost = lost
        self._keep = keep
        self._nobody = self._new(None)
        self._texts = Texts(self._nobody.transcript, fingerprint)
        self._judges: dict[str | None, Judge] = {}
        self._stopped: dict[str | None, int] = {}
        self._waiting: dict[Judge, int | None] = {}

    def _new(self, robot: str | None) -> Judge:
        calls = (self._lost or {}).get(robot, frozenset())
        automaton, keep = self._automaton, self._keep
        return Judge(
            self.system,
            self._head,
            automaton,
            no_flagged=self._no_flagged,
            fingerprint=fingerprint,
            lost=calls,
            keep=keep,
            apart=True,
            waits=self._waits,
            settled_after=self._settled_after,
        )

    @property
    def nodes(self) -> int:
        """How many nodes the automaton has that they walked."""
        return self._automaton.size[0]

    def read(self, path: str, texts: Lines, numbered: Iterator[tuple[int, bytes]]) -> tuple[int, JSON] | None:
        """Take all lines into account, up to the first line of another conversation: its number and the line.

        Raises:
            UnreadableError: a line is not of the format.
        """
        as_known, take = self._texts.known, self._nobody.take
        read_again = not (self._keep or self._only or self._settled_after is not None)
        looks, nobody = self._lost is None, self._nobody
        for number, text in numbered:
            try:
                if looks and not number % LOOK:
                    self._look(nobody)
                known = as_known(text) if read_again and not self.addresses.by_call else None
                if known is None:
                    line = texts.json(text)
                    if type(line) is dict and "missionfsm" in line:
                        return number, line
                    self._take(number, text, line)
                elif not take(known, number):  # it names neither a time nor a robot, as most lines
                    self._stopped.setdefault(None, nobody.place or number)
            except UnreadableError as error:
                raise wrong_line(path, number, error) from None
        return None

    def _take(self, number: int, text: bytes, line: JSON) -> None:
        plain = type(line) is dict and "at" not in line and "robot" not in line
        robot, line = self.addresses.whose(line)
        if self._only and robot not in self._only:
            return
        judge = self._judge_of(robot)
        if self._lost is None and robot is not None and not judge.read % LOOK:
            self._look(judge)
        comes_again = plain and not self._keep and robot is None and judge.quiet is None
        right = judge.take(self._texts.read(text, line), number) if comes_again else judge.feed(line, number)
        if not right:
            self._stopped.setdefault(robot, judge.place or number)

    def _judge_of(self, robot: str | None) -> Judge:
        judge = self._judges.get(robot)
        if judge is None:
            judge = self._judges[robot] = self._nobody if robot is None else self._new(robot)
        return judge

    def _look(self, judge: Judge) -> None:
        """Raise _UndecidedError where a judge waits for the same call as when this was last asked."""
        oldest = next(iter(judge.transcript.pending), None)
        if oldest is not None and self._waiting.get(judge) == oldest:
            raise _UndecidedError(by_params=self.addresses.by_call)
        self._waiting[judge] = oldest

    def verdicts(self, path: str) -> list[tuple[str | None, Verdict]]:
        """What each judge says of its robot, in the order of their first lines.

        Raises UnreadableError where the file says too little for what is asked.
        """
        return [(robot, verdict) for robot, _, verdict in self.judgements(path)]

    def judgements(self, path: str) -> list[tuple[str | None, Judge, Verdict]]:
        """What each judge says of its robot, with the judge, in the order of their first lines; see `verdicts`."""
        judges = self._judges or {None: self._nobody}
        if self._lost is None and any(judge.transcript.pending or judge.exhausted for judge in judges.values()):
            raise _UndecidedError(by_params=self.addresses.by_call)
        if self._settled_after is not None and not any(judge.quiet and judge.quiet.timed for judge in judges.values()):
            says = "no line says when it was (`at`), so nobody can tell what is late (--settled-after)"
            message = f"{called(path)}: {says}"
            raise UnreadableError(message)
        return [
            (robot, judge, located(self._completed(judge.verdict()), self._stopped.get(robot, judge.place)))
            for robot, judge in judges.items()
        ]

    def _completed(self, verdict: Verdict) -> Verdict:
        """A verdict that conforms, with the rules that could be missed for want of drives."""
        if not verdict.conforms:
            return verdict
        missed = missed_without(system(self._head.system), frozenset(verdict.untested.drives))
        return evolve(verdict, untested=evolve(verdict.untested, refusals=missed.refusals, promises=missed.promises))


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


def located(verdict: Verdict, line: int | None) -> Verdict:
    """The verdict with the line of the file in which the violation is."""
    if verdict.violation is None or line is None:
        return verdict
    return evolve(verdict, violation=evolve(verdict.violation, at=line, where=f"line {line}: "))
