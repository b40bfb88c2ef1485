"""How readings are decided at the server: a move where a question is read in some way, and the one where it is not.

A clock that no reading that is left looks at runs no more: what differs only in such clocks is the same.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator

from attrs import evolve

from missionfsm.isaac.server.readings import (
    AI_05,
    AI_06,
    AI_07,
    AI_08,
    AI_11,
    AI_24_WHOLE,
    AI_31,
    AI_39,
    AI_39_ORDER,
    AMBIGUITIES,
)
from missionfsm.isaac.server.state import (
    DOOM,
    DROP,
    HEARD,
    SENT,
    SILENT,
    START,
    START_COUNTS_FROM,
    WAITS,
    Left,
    Mission,
    Move,
    Server,
)
from missionfsm.kernel.readings import Ambiguity, Assumption

_ABOUT_CLOCKS = frozenset(one.id for one in (AI_05, AI_06, AI_07, AI_24_WHOLE, AI_31))


def split(move: Move, question: Ambiguity, letters: str) -> tuple[Move | None, Move | None]:
    """What is left where the question is read in one of these ways, and where it is not; None where nothing is.

    Raises:
        ValueError: one of the letters is no reading.
    """
    question.checked(letters)
    left = move.state.letters(question)
    yes = "".join(letter for letter in left if letter in letters)
    no = "".join(letter for letter in left if letter not in letters)
    if not yes or not no:
        return (move, None) if yes else (None, move)
    return _narrowed(move, question, yes), _narrowed(move, question, no)


def _narrowed(move: Move, question: Ambiguity, letters: str) -> Move:
    left = dict(move.state.left)
    left[question.id] = letters
    server = move.state
    after = evolve(server, left=tuple(sorted(left.items())))
    if question.id == AI_39.id and "b" not in letters:
        after = evolve(_in_order(after), slow=0)
    if question.id == AI_39_ORDER.id and "s" not in letters:
        after = _in_order(after)
    missions = _missions_narrowed(after, question, letters)
    after = after if missions is after.missions else evolve(after, missions=missions)
    return Move(after, move.sent, move.rules, move.at)


def _missions_narrowed(server: Server, question: Ambiguity, letters: str) -> tuple[Mission, ...]:
    """The missions without what only the other letters of a question allow."""
    missions = server.missions
    if question.id == AI_08.id and "d" not in letters:
        over = (SENT,) if "e" in letters else (SENT, HEARD)
        return tuple(evolve(one, lingers="") if one.lingers in over else one for one in missions)
    if question.id == AI_11.id and "d" not in letters:
        return tuple(evolve(one, at_once=False) if one.at_once else one for one in missions)
    return tuple(_in_time(server, one) for one in missions) if question.id in _ABOUT_CLOCKS else missions


def _in_order(server: Server) -> Server:
    """A server that takes up names and drops before it sends, or all at once."""
    return evolve(
        server, gone=(), links=tuple(evolve(one, held=(0, 0)) if one.held[1] else one for one in server.links)
    )


def _in_time(server: Server, mission: Mission) -> Mission:
    """A mission without the clocks that nobody looks at any more."""
    clocks = tuple(one for one in mission.clocks if counts(server, one.kind, one.since, whole=one.whole))
    return mission if len(clocks) == len(mission.clocks) else evolve(mission, clocks=clocks)


def counts(state: Server, kind: str, since: str, *, whole: bool) -> bool:
    """Whether some reading that is left looks at such a clock (AI-05, AI-06, AI-07, AI-24.whole, AI-31)."""
    if kind in (DROP, DOOM):
        return True
    if kind == SILENT:
        return "a" in state.letters(AI_31)
    if ("w" if whole else "x") not in state.letters(AI_24_WHOLE):
        return False
    if kind == START:
        return START_COUNTS_FROM[since] in state.letters(AI_05)
    if since == "send":
        return "b" in state.letters(AI_06) or ("a" in state.letters(AI_06) and "c" in state.letters(AI_07))
    if since == WAITS:
        return "d" in state.letters(AI_06)
    return {"status": "a", "submit": "c"}[since] in state.letters(AI_06)


def ways(move: Move, question: Ambiguity, *groups: str) -> Iterator[tuple[str, Move]]:
    """For each group of letters that something is left of: the group, and the move where one of them is followed."""
    for letters in groups:
        yes, _ = split(move, question, letters)
        if yes is not None:
            yield letters, yes


def merged(moves: Iterable[Move]) -> tuple[Move, ...]:
    """The same moves, with those that come to the same under several readings of one question made one."""
    same: dict[object, list[Move]] = {}
    for move in moves:
        key = (move.state.missions, move.state.links, move.state.alike, move.sent, move.at)
        same.setdefault(key, []).append(move)
    return tuple(move for group in same.values() for move in _joined(group))


def _joined(group: list[Move]) -> list[Move]:
    """Moves that differ only in what they decided, as few as can be: any two are one that differ in one question."""
    while True:
        before = len(group)
        for name in sorted({name for one in group for name, _ in one.state.left}) if before > 1 else ():
            apart: dict[Left, list[Move]] = {}
            for one in group:
                apart.setdefault(tuple(left for left in one.state.left if left[0] != name), []).append(one)
            if len(apart) < len(group):
                group = [_either(alike, name, rest) if len(alike) > 1 else alike[0] for rest, alike in apart.items()]
        if len(group) == before:
            return group


def _either(moves: list[Move], name: str, rest: Left) -> Move:
    """The move for several that differ in what is left of one question; `rest` is what is left of the others."""
    question = _QUESTIONS[name]
    wanted = {letter for one in moves for letter in one.state.letters(question)}
    letters = "".join(letter for letter in question.readings if letter in wanted)
    left = rest if len(letters) == len(question.readings) else tuple(sorted((*rest, (name, letters))))
    rules = tuple(dict.fromkeys(rule for one in moves for rule in one.rules))
    return evolve(moves[0], state=evolve(moves[0].state, left=left), rules=rules)


_QUESTIONS = {one.id: one for one in AMBIGUITIES}


@functools.lru_cache(maxsize=20_000)
def unusual(left: Left) -> int:
    """How many questions cannot be read in their usual way any more, of those of which some readings are left."""
    return sum(_QUESTIONS[name].default not in letters for name, letters in left)


def assumed(before: Server, after: Server) -> tuple[Assumption, ...]:
    """What was decided between two states."""
    if before.left == after.left:
        return ()
    known = dict(before.left)
    return tuple(_QUESTIONS[name][tuple(letters)] for name, letters in after.left if known.get(name) != letters)
