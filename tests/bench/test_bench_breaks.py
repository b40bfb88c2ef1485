"""Every break and every reading that the reference can have, over gRPC: which are found, and which are accepted.

    pytest -o addopts= tests/bench/test_bench_breaks.py -s

It takes an hour; EVERY=20 in the environment takes every twentieth.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from missionfsm.app.serve import serve
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.mutate.teeth import mutants

sys.path.insert(0, str(Path(__file__).parents[1] / "grpc"))
from brokenserver import Searcher
from onwire import accepted, alternatives, proxied, recorded, unsaid

EVERY = int(os.environ.get("EVERY", "1"))


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_breaks_that_binary_carries_are_found_over_grpc(name: str) -> None:
    """Of each break: whether it is found in process with binary requests only, and whether over gRPC as well."""
    searcher = Searcher(system(name))
    carried, found = [], []
    every = tuple(mutants(searcher.system))[::EVERY]
    for mutant in every:
        if searcher.in_process(mutant):
            carried.append(mutant.name)
            found += [mutant.name] if searcher.over_grpc(mutant) else []
    print(f"\n{name}: of {len(every)} breaks {len(carried)} show in binary requests, {len(found)} found over gRPC")
    assert found == carried


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_only_readings_that_only_json_says_have_no_binary_form(name: str) -> None:
    """A conversation is had again under every reading: what cannot be encoded is said under those that say so, only."""
    of = system(name)
    every = [(one, letter) for one in of.spec.ambiguities for letter in one.readings if letter != one.default]
    asked = recorded(of)
    for one, letter in every[::EVERY]:
        assert bool(unsaid(of, {one.id: letter}, asked)) <= (letter in one.json_only), f"{one.id}={letter}"
    marked = [(one, letter) for one, letter in every if letter in one.json_only]
    assert all(unsaid(of, {one.id: letter}, asked) for one, letter in marked)


@pytest.mark.parametrize("judged", [accepted, proxied], ids=["alone", "proxied"])
@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_every_single_reading_is_accepted_over_grpc(name: str, judged: Callable[[str, str], Verdict]) -> None:
    """The reference under each alternative reading conforms over gRPC; which took longest is told."""
    taken = {}
    for reading in alternatives(system(name))[::EVERY]:
        begun = time.perf_counter()
        with serve(name, readings=dict([reading])) as robot:
            verdict = judged(name, robot.target)
        taken["=".join(reading)] = time.perf_counter() - begun
        assert verdict.violation is None, f"{reading}: {verdict}"
    slowest = ", ".join(f"{reading} {taken[reading]:.1f} s" for reading in sorted(taken, key=taken.__getitem__)[:-6:-1])
    print(f"\n{name}: {len(taken)} readings accepted over gRPC in {sum(taken.values()):.0f} s; slowest: {slowest}")
