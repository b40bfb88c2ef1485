"""The judges of a recorded file, one for each robot that it speaks of."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Iterator, Mapping

from attrs import evolve

from missionfsm.adapters.addresses import Addresses
from missionfsm.adapters.historyfile import Lines, called, fingerprint, wrong_line
from missionfsm.app.asked import Asked, judged_system
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.line_cache import Texts
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import PATIENCE, Judge
from missionfsm.tools.check.scope import assumed
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.explore.undriven import missed_without

Lost = Mapping[str | None, frozenset[int]]
"""For each robot the ids of the calls that are never answered."""

Early = Callable[[bool], Mapping[str | None, int] | None]
"""Says how many answers a file has to calls from before it, for each robot; None where nobody knows.

It is told whether the params of a call may say for which robot it is.
"""

SECOND_PATIENCE = 2_000
"""How many explanations an event may cost in the second reading of a file, before the first verdict stands."""

LOOK = 16
"""How many lines a call may wait for its answer before the file is searched for calls that never get one."""

KEPT_NODES = 5_000
"""How many nodes an automaton may have to be kept for other files."""


class UndecidedError(Exception):
    """Calls wait for answers that may never come: the file is to be judged again, knowing which."""

    def __init__(self, *, by_params: bool) -> None:
        super().__init__()
        self.by_params = by_params


@functools.lru_cache(maxsize=2)
def automaton_of(seen: tuple[str, bool, bool, bool], how: tuple[tuple[str, ...], int, int, bool], _: int) -> Automaton:
    """The automaton of logs of a kind, which the files of a folder share.

    Args:
        seen: the name of the system, and how it is seen: the arguments of `judged_system`.
        how: the other arguments of the automaton.
        _: the thread, since no two may walk the same automaton at a time.
    """
    name, strict, anywhere, others = seen
    drives, decided, patience, eager = how
    spec = judged_system(name, strict=strict, anywhere=anywhere, others=others).spec
    return Automaton(spec, drives, decided, patience, eager=eager)


class Judges:
    """The judges of a file, one for each robot that it speaks of.

    Args:
        line: the first line.
        asked: how the file is to be judged.
        lost: the calls that are never answered; None: not known yet.
        keep: how many lines are kept to be shown. If none, lines that come again are recognised by their text.
        early: asked of a file that begins anywhere.

    Raises:
        UnreadableError: that is no first line.
    """

    def __init__(self, line: JSON, asked: Asked, lost: Lost | None, keep: int, early: Early) -> None:
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
        self._readings = readings = self.system.chosen(asked.profile, asked.readings)
        decided = assumed(self.system.spec, readings, no_flagged=asked.no_flagged)
        self._only, self._settled_after = asked.only, asked.settled_after
        self._waits = not asked.eager
        patience = PATIENCE if self._waits else SECOND_PATIENCE
        self._automaton = automaton_of(
            (first.system, first.strict, first.anywhere, first.others),
            (self._head.drives, decided, patience, asked.eager),
            threading.get_ident(),
        )
        self._no_flagged = asked.no_flagged
        self._lost = lost
        self._keep = keep
        self._early = early(self.system.codec.robot_in_params) if first.anywhere else None
        self._nobody = self._new(None)
        self._texts = Texts(self._nobody.transcript, fingerprint)
        self._judges: dict[str | None, Judge] = {}
        self._stopped: dict[str | None, int] = {}
        self._waiting: dict[Judge, int | None] = {}

    def _new(self, robot: str | None) -> Judge:
        return self.another(robot, (self._lost or {}).get(robot, frozenset()))

    def another(self, robot: str | None, calls: frozenset[int]) -> Judge:
        """A judge of a robot's lines that has read none, to which answers to these calls are known not to come."""
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
            early=self._early_of(robot),
        )

    def prompt(self, robot: str | None) -> Judge:
        """A judge of a robot's lines that has read none, and explains each at once, however much that costs."""
        return Judge(
            self.system,
            self._head,
            readings=self._readings,
            no_flagged=self._no_flagged,
            fingerprint=fingerprint,
            waits=False,
            early=self._early_of(robot),
        )

    def _early_of(self, robot: str | None) -> int | None:
        return None if self._early is None else self._early.get(robot, 0)

    @property
    def nodes(self) -> int:
        """How many nodes their automaton has."""
        return self._automaton.size[0]

    def read(self, path: str, texts: Lines, numbered: Iterator[tuple[int, bytes]]) -> tuple[int, JSON] | None:
        """Take all lines into account, up to the first line of another conversation.

        Returns:
            that line and its number; None if the file ends before.

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
                elif not take(known, number):  # a line without a time and a robot, as most are
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
        """Raise UndecidedError where a judge waits for the same call as when this was last asked."""
        oldest = next(iter(judge.transcript.pending), None)
        if oldest is not None and self._waiting.get(judge) == oldest:
            raise UndecidedError(by_params=self.addresses.by_call)
        self._waiting[judge] = oldest

    def verdicts(self, path: str) -> list[tuple[str | None, Verdict]]:
        """The verdict for each robot, in the order of their first lines.

        Raises:
            UndecidedError: calls wait for answers that may never come.
            UnreadableError: the file does not say what `settled_after` needs.
        """
        return [(robot, verdict) for robot, _, verdict in self.judgements(path)]

    def judgements(self, path: str) -> list[tuple[str | None, Judge, Verdict]]:
        """The judge and the verdict for each robot, in the order of their first lines; see `verdicts`."""
        judges = self._judges or {None: self._nobody}
        if self._lost is None and any(judge.transcript.pending or judge.exhausted for judge in judges.values()):
            raise UndecidedError(by_params=self.addresses.by_call)
        if self._settled_after is not None and not any(judge.quiet and judge.quiet.timed for judge in judges.values()):
            says = "no line says when it was (`at`), so nobody can tell what is late (--settled-after)"
            message = f"{called(path)}: {says}"
            raise UnreadableError(message)
        return [
            (robot, judge, located(self._completed(judge.verdict()), self._stopped.get(robot, judge.place)))
            for robot, judge in judges.items()
        ]

    def _completed(self, verdict: Verdict) -> Verdict:
        """The verdict; if it conforms, with the rules that may be missed for want of drives."""
        if not verdict.conforms:
            return verdict
        missed = missed_without(system(self._head.system), frozenset(verdict.untested.drives))
        return evolve(verdict, untested=evolve(verdict.untested, refusals=missed.refusals, promises=missed.promises))


def located(verdict: Verdict, line: int | None) -> Verdict:
    """The verdict, with the line of the file in which the violation is."""
    if verdict.violation is None or line is None:
        return verdict
    return evolve(verdict, violation=evolve(verdict.violation, at=line, where=f"line {line}: "))
