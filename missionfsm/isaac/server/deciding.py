"""How readings are decided at the server: a move where a question is read in some way, and the one where it is not.

A clock that no reading that is left looks at runs no more: what differs only in such clocks is the same.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator

from attrs import evolve

from missionfsm.isaac.server.readings import (
    AI_05,
    AI_06,
    AI_07,
    AI_08,
    AI_24_WHOLE,
    AI_31,
    AI_39,
    AI_39_ORDER,
    AMBIGUITIES,
)
from missionfsm.isaac.server.state import (
    DOOM,
    DROP,
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
    if question.id == AI_08.id and "d" not in letters:
        missions = tuple(evolve(one, lingers=False) if one.lingers else one for one in after.missions)
        after = evolve(after, missions=missions)
    if question.id in _ABOUT_CLOCKS:
        after = evolve(after, missions=tuple(_in_time(after, one) for one in after.missions))
    return Move(after, move.sent, move.rules, move.at)


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
        key = (move.state.missions, move.state.links, move.sent, move.at)
        same.setdefault(key, []).append(move)
    found: list[Move] = []
    for group in same.values():
        while len(group) > 1:
            pair = next(
                (
                    (one, other, left)
                    for one, other in itertools.combinations(group, 2)
                    if (left := _union(one.state.left, other.state.left)) is not None
                ),
                None,
            )
            if pair is None:
                break
            one, other, left = pair
            both = tuple(dict.fromkeys((*one.rules, *other.rules)))
            joined = evolve(one, state=evolve(one.state, left=left), rules=both)
            group = [joined if here is one else here for here in group if here is not other]  # noqa: PLW2901 - grows less
        found += group
    return tuple(found)


def _union(one: Left, other: Left) -> Left | None:
    """What is left under either of two choices, if they differ in one question at most."""
    if one == other:
        return one
    first, second = dict(one), dict(other)
    differing = [name for name in {**first, **second} if first.get(name) != second.get(name)]
    if len(differing) > 1:
        return None
    (name,) = differing
    if name not in first or name not in second:
        return one if name not in first else other
    everything = "".join(_QUESTIONS[name].readings)
    joined = "".join(letter for letter in everything if letter in first[name] or letter in second[name])
    rest = {**first, name: joined}
    if joined == everything:
        del rest[name]
    return tuple(sorted(rest.items()))


_QUESTIONS = {one.id: one for one in AMBIGUITIES}


def assumed(before: Server, after: Server) -> tuple[Assumption, ...]:
    """What was decided between two states."""
    if before.left == after.left:
        return ()
    known = dict(before.left)
    return tuple(_QUESTIONS[name][tuple(letters)] for name, letters in after.left if known.get(name) != letters)
