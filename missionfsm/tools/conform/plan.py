"""How many conversations of each kind a run has."""

from __future__ import annotations

from attrs import frozen

from missionfsm.kernel.system import System
from missionfsm.tools.conform.run import BOUNDS
from missionfsm.tools.conform.tour import some, written

DRAWN, TOURS, STEPS = 100, 60, 40
"""By default: how many conversations are drawn, how many are tours, and how many calls and drives each has at most."""

SCRIPTS = 240
"""The most scripts of a default run: more than any system has, so that all are played."""

FILLS = 500
"""The most conversations that go to situations which were asked too seldom, in a system that has a matrix."""

LED = 0.4
"""Which part of the tours such a system has: tours need not find those situations by themselves."""


@frozen
class Plan:
    """How many conversations of each kind a run has.

    Attributes:
        drawn: conversations that Hypothesis draws.
        tours: conversations that walk where the run has been least.
        scripts: the most conversations of those that the system's alphabet has written down.
        steps: the most calls and drives in each.
        fills: the most conversations that go to situations that were asked too seldom, if the system has a matrix.
    """

    drawn: int = DRAWN
    tours: int = TOURS
    scripts: int = SCRIPTS
    steps: int = STEPS
    fills: int = FILLS

    @classmethod
    def beside(cls, drawn: int, tours: int, steps: int) -> Plan:
        """So many drawn conversations and so many tours, and as many of the other kinds as go with them."""
        fills = FILLS if tours >= TOURS else tours - round(LED * tours)
        scripts = SCRIPTS if drawn >= DRAWN and tours >= TOURS else drawn + tours
        return cls(drawn, tours, scripts, steps, fills)

    @classmethod
    def of(cls, conversations: int | None, steps: int = STEPS) -> Plan:
        """So many conversations in all, or the default plan for None."""
        return cls(steps=steps) if conversations is None else cls.sharing(conversations, steps)

    @classmethod
    def sharing(cls, conversations: int, steps: int = STEPS) -> Plan:
        """So many conversations in all, shared among the kinds as by default."""
        whole = cls(scripts=DRAWN + TOURS)
        total = whole.scripts + whole.tours + whole.drawn
        scripts, drawn = (conversations * part // total for part in (whole.scripts, whole.drawn))
        tours = conversations - scripts - drawn
        return cls(drawn, tours, scripts, steps, tours - round(LED * tours))

    def led(self, system: System) -> tuple[int, int]:
        """How many tours a system has, and how many conversations go to situations that were asked too seldom."""
        return (self.tours, 0) if system.matrix is None else (round(LED * self.tours), self.fills)

    def conversations(self, system: System) -> int:
        """How many conversations a system has at most, if nothing is found."""
        alphabets = [system.alphabet(world, BOUNDS) for world in system.alphabet({}, BOUNDS).worlds]
        return len(some(written(alphabets), self.scripts)) + sum(self.led(system)) + self.drawn
