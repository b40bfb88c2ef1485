"""Every break and every reading that the reference can have, over gRPC: which are found, and which are accepted.

    pytest -o addopts= tests/bench/test_bench_breaks.py -s

EVERY=20 in the environment takes every twentieth, SHARD=2/8 the second of eight parts. tests/grpc has a sample.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from missionfsm.systems import system
from missionfsm.tools.mutate.mutants import mutants

sys.path.insert(0, str(Path(__file__).parents[1] / "grpc"))
from onwire import Searcher, asked, breaks_carried, readings_accepted, unsaid

EVERY = int(os.environ.get("EVERY", "1"))


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_breaks_that_binary_carries_are_found_over_grpc(name: str) -> None:
    """Of each break: whether it is found in process with binary requests only, and whether over gRPC as well."""
    begun = time.perf_counter()
    found = breaks_carried(system(name), mutants(system(name)), EVERY)
    print(f"\n{name}: {found} in {time.perf_counter() - begun:.0f} s")
    assert found.wrong == []


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_every_single_reading_is_accepted_over_grpc(name: str) -> None:
    """The reference under each alternative reading conforms over gRPC, alone and through a proxy, where it shows."""
    begun = time.perf_counter()
    found = readings_accepted(system(name), EVERY)
    print(f"\n{name}: {found} in {time.perf_counter() - begun:.0f} s")
    assert found.wrong == []


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_only_readings_that_only_json_says_have_no_binary_form(name: str) -> None:
    """A conversation is had again under every reading: what cannot be encoded is said under those that say so, only."""
    of = system(name)
    every = [(one, letter) for one in of.spec.ambiguities for letter in one.readings if letter != one.default]
    said = asked(of, Searcher(of).usual())
    for one, letter in every[::EVERY]:
        assert bool(unsaid(of, {one.id: letter}, said)) <= (letter in one.json_only), f"{one.id}={letter}"
    marked = [(one, letter) for one, letter in every if letter in one.json_only]
    assert all(unsaid(of, {one.id: letter}, said) for one, letter in marked)
