"""The reference under random combinations of readings: no false alarm, and the readings that it follows are left."""

from __future__ import annotations

import functools

import pytest
from combinations import Bench, combination, wrong

from missionfsm.systems import names, system

COMBINATIONS, EXAMPLES, STEPS = 6, 30, 10


@functools.cache
def bench(name: str) -> Bench:
    return Bench.of(system(name))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(COMBINATIONS))
@pytest.mark.parametrize("name", names())
def test_a_combination_of_readings_is_recognised(name: str, seed: int) -> None:
    """Whatever the combination, every conversation is explained and what is reported holds the truth."""
    assert wrong(bench(name), combination(system(name), seed), seed, EXAMPLES, STEPS) == ""


def test_combinations_differ() -> None:
    """Seeds give combinations of their own, and the same one each time."""
    some = [combination(system("bear.mission"), seed) for seed in range(20)]
    assert len({tuple(one.items()) for one in some}) == 20
    assert some == [combination(system("bear.mission"), seed) for seed in range(20)]
