"""What several tests of the Isaac oracle need: runs against subjects, by scripts or by search."""

from __future__ import annotations

import json
import random
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from missionfsm.adapters.stdio import Child
from missionfsm.kernel.subject import Subject
from missionfsm.oracle.automaton import Automaton
from missionfsm.systems import system
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.tour import play, tour

SUBJECTS = Path(__file__).parent.parent / "subjects"
NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="no Node.js to run the independent implementations")


def run_of(name: str, subject: Subject, automaton: Automaton | None = None) -> Run:
    """A run against a subject that has not begun."""
    return Run.against(system(name), subject, automaton=automaton)


def explained(run: Run, tours: int, steps: int, seed: int = 1) -> bool:
    """Whether the scripts, and then so many systematic conversations, can all be explained by one set of readings."""
    return play(run) and tour(run, random.Random(seed), tours, steps)


@contextmanager
def node(name: str, *options: str) -> Iterator[Child]:
    """The independent implementation of a system, as a child process."""
    script = SUBJECTS / f"{name.replace('.', '_')}.mjs"
    child = Child([str(NODE), str(script), *options])
    try:
        yield child
    finally:
        child.close()


def breaks(name: str) -> list[str]:
    """The ways in which the independent implementation can be told to deviate."""
    if NODE is None:
        return []
    script = SUBJECTS / f"{name.replace('.', '_')}.mjs"
    listed = subprocess.run([NODE, str(script), "--list-breaks"], capture_output=True, check=True, text=True)
    return list(json.loads(listed.stdout))
