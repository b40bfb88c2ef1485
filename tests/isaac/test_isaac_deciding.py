"""Moves that differ only in what they decided are made few, and none that was decided is lost or added."""

from __future__ import annotations

import itertools
import random

from missionfsm.isaac.server.deciding import merged
from missionfsm.isaac.server.readings import AI_05, AI_06, AI_07
from missionfsm.isaac.server.state import Move, Server

QUESTIONS = (AI_05, AI_06, AI_07)


def _move(letters: tuple[str, ...]) -> Move:
    left = tuple((one.id, chosen) for one, chosen in zip(QUESTIONS, letters, strict=True))
    return Move(Server(left=left))


def _worlds(moves: tuple[Move, ...]) -> set[tuple[str, ...]]:
    return {
        chosen
        for move in moves
        for chosen in itertools.product(*(move.state.letters(question) for question in QUESTIONS))
    }


def test_everything_that_can_be_decided_is_nothing_decided() -> None:
    """All combinations of three questions, each decided, are one move that leaves all of them open."""
    everything = list(itertools.product(*(question.readings for question in QUESTIONS)))
    random.Random(1).shuffle(everything)
    assert [move.state.left for move in merged(map(_move, everything))] == [()]


def test_what_is_merged_leaves_what_was_left() -> None:
    """Of random combinations the same are left after as before, in no more moves."""
    everything = list(itertools.product(*(question.readings for question in QUESTIONS)))
    for seed in range(50):
        some = random.Random(seed).sample(everything, 20)
        found = merged(map(_move, some))
        assert _worlds(found) == set(some)
        assert len(found) < len(some)
