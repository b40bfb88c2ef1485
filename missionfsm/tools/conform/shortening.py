"""Make what a run found as short as can be, asking the implementation again each time."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import SubjectError
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.check.verdict import Violation
from missionfsm.tools.conform.actions import SETTLE, Action, length
from missionfsm.tools.conform.contradiction import beside, essential
from missionfsm.tools.conform.conversation import Conversation
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.shortest import everything, shortest
from missionfsm.tools.conform.shrink import shrink, unexplained

TRIES = 4
"""How often a violation is tried again, to say how often it is seen. If it is not seen every time, each step of
shortening is tried as often before it counts as one that does not show it."""


def shorten(run: Run) -> None:
    """Make the conversation that a run found short, and say how often it shows the violation."""
    if run.found is not None and not run.found.judge.exhausted:
        run.found = shortened(run, run.found)


def shortened(run: Run, found: Conversation, *, known: Callable[[Conversation], bool] | None = None) -> Conversation:
    """The shortest conversation like one that cannot be explained.

    Whatever happens on the way, a violation is left: an adapter that fails while it is asked again, and an end of the
    time, leave what was the shortest until then.

    Args:
        known: whether what is wrong with a conversation is known: it is not what the story is shortened towards.
    """
    is_known = known or run.knows

    def shows(tried: Conversation) -> bool:
        return unexplained(tried) and not is_known(tried)

    best = [found]
    seen, tried = 0, 0
    try:
        again = run.replay(found.world, tuple(found.actions), found.judge.automaton)
        attempt = _Attempt(run, found, 1 if shows(again) else TRIES)
        _shorten(run, found, attempt, best, shows)
        while tried < TRIES and not run.enough():
            still_shows = shows(_again(run, best[0], found.judge.automaton))
            if run.enough() and not still_shows:
                break  # it was not had to its end
            tried, seen = tried + 1, seen + still_shows
    except SubjectError as error:
        run.ledger.note(f"the violation was found before the adapter failed while it was made short: {error}")
    if seen < tried:
        run.ledger.note(f"the violation comes and goes: it was seen {seen + 1} of {tried + 1} times")
    if run.enough():
        run.ledger.note("the violation was not made as short as can be: the time was up")
    return best[0]


def _again(run: Run, found: Conversation, automaton: Automaton) -> Conversation:
    """The same once more; what was seen before anything was waited for may this time take until all has settled."""
    tried = run.replay(found.world, tuple(found.actions), automaton)
    if tried.right and not run.enough():
        tried.perform(Action(1 + max((action.serial for action in found.actions), default=0), SETTLE))
    return tried


class _Attempt:
    """Has a conversation again, up to so many times until it shows something."""

    def __init__(self, run: Run, found: Conversation, times: int) -> None:
        self.run = run
        self.automaton = found.judge.automaton
        self.times = times

    def __call__(self, world: JSON, actions: tuple[Action, ...]) -> Conversation:
        for _ in range(self.times - 1):
            tried = self.run.replay(world, actions, self.automaton)
            if not tried.right:
                return tried
        return self.run.replay(world, actions, self.automaton)


def _shorten(
    run: Run,
    found: Conversation,
    attempt: _Attempt,
    best: list[Conversation],
    shows: Callable[[Conversation], bool],
) -> None:
    """Leave out, say simply, and look for shorter ones; `best` has the shortest so far at any time."""
    usual = run.guide.worlds[0]

    def keep(shorter: Conversation) -> None:
        best[0] = shorter

    shrink(found, attempt, run.simpler, usual, shows, keep=keep, enough=run.enough)
    alphabet = run.alphabet(best[0].world)
    # From some long conversations no part can go though there are shorter ones: of the same kinds of things, which
    # can be looked for deep, or of anything.
    for look in (functools.partial(shortest, best[0]), everything):
        if run.enough():
            return
        at_most = length(best[0].actions) - 1
        shorter = look(functools.partial(attempt, best[0].world), alphabet, at_most, shows=shows, enough=run.enough)
        if shorter is not None:
            keep(shorter)
            shrink(shorter, attempt, run.simpler, usual, shows, keep=keep, enough=run.enough)


def shorten_evidence(run: Run) -> None:
    """Make the conversations that ruled out the readings of a contradiction as short as can be."""
    if run.ledger.contradiction is not None:
        _shorten_those(run, [key for key in run.ledger.ruled_out_by if key[0] == run.ledger.contradiction])


def beside_others(run: Run, violation: Violation, *, asks_again: bool) -> Violation:
    """The violation of the conversation that a run found, with the others that it contradicts, if it takes any."""
    assert run.found is not None, "something was found"  # noqa: S101 - whoever calls this has found it
    ledger, judge = run.ledger, run.found.judge
    if not run.found.under(run.narrowing.wide).right:
        return violation
    needed = essential(run.system, judge, ledger.readings)
    keys = [key for key in ledger.ruled_out_by if key[0] in needed and key[1] not in needed[key[0]]]
    if asks_again:
        _shorten_those(run, keys)
    return beside(violation, needed, {key: ledger.ruled_out_by[key].judge for key in keys})


def _shorten_those(run: Run, keys: Iterable[tuple[str, str]]) -> None:
    """Make the conversations short that rule out these readings; one that rules out several stays one."""
    ledger = run.ledger
    by_conversation: dict[Conversation, list[tuple[str, str]]] = {}
    for key in keys:
        by_conversation.setdefault(ledger.ruled_out_by[key], []).append(key)
    for conversation, those in by_conversation.items():
        if run.enough():
            return

        def shows(tried: Conversation, those: list[tuple[str, str]] = those) -> bool:
            left = tried.judge.belief.readings
            return tried.right and all(letter not in left.get(name, (letter,)) for name, letter in those)

        def keep(shorter: Conversation, those: list[tuple[str, str]] = those) -> None:
            ledger.ruled_out_by.update(dict.fromkeys(those, shorter))

        try:
            shrink(conversation, run.replay, run.simpler, run.guide.worlds[0], shows, keep=keep, enough=run.enough)
        except SubjectError as error:
            ledger.note(f"the adapter failed while the evidence was made short: {error}")
            return
