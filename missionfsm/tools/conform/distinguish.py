"""Tell readings apart that are still open: the shortest conversations in which one shows that another does not allow.

The references under the readings of one ambiguity, all others alike, are walked side by side through the product of
their states, nearest first. Where they are seen to differ, the conversation is judged: a reading is told from another
if what the reference does under it cannot be explained under the other, whatever is still open besides. That is an
*experiment*; an implementation that it is tried on shows which of the two it follows.
"""

from __future__ import annotations

from missionfsm.kernel.readings import Ambiguity, meet
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.trials import EFFORT, Lab, Trial

THOUGHT, LEAST = 3, 6_000
"""How many all searches may take where experiments are only told, for each step that the run took, and in any case."""

ROUNDS = 2
"""How often experiments are looked for anew with what others have decided meanwhile."""


def open_questions(run: Run) -> list[tuple[Ambiguity, tuple[str, ...]]]:
    """The ambiguities that a run has touched and not decided, with the readings that are left."""
    found = ((one, run.ledger.readings.get(one.id, ())) for one in run.system.spec.ambiguities)
    return [(one, letters) for one, letters in found if len(letters) > 1]


def lab_of(run: Run, effort: int = EFFORT) -> Lab:
    """A lab that assumes the readings that a run has left."""
    decided = (
        one[run.ledger.readings[one.id]] for one in run.system.spec.ambiguities if run.ledger.readings.get(one.id)
    )
    assumed = meet(run.narrowing.wide.assumed, decided)
    current = run.narrowing.current
    automaton = current if current.assumed == assumed else Automaton(run.system.spec, run.partner.info.drives, assumed)
    return Lab(run.guide, run.partner.info, automaton, run.ledger.readings, effort, run.enough)


def proposed(run: Run) -> tuple[Trial, ...]:
    """For every reading that a run has left open, the experiments that would tell it from others."""
    questions = open_questions(run)
    lab = lab_of(run)
    left, found = max(LEAST, THOUGHT * run.ledger.steps), list[Trial]()
    for position, (ambiguity, letters) in enumerate(questions):
        # What one search does not need is there for those after it.
        lab.effort = left // (len(questions) - position)
        found += lab.trials(ambiguity, letters)
        left -= lab.spent
    return tuple(found)


def distinguish(run: Run, only: str | None = None) -> bool:
    """Try experiments on the implementation until what can be told apart is; False if something is found by it.

    Args:
        only: the id of the one ambiguity to decide; all that are open by default.
    """
    for _ in range(ROUNDS):
        before, lab = dict(run.ledger.readings), lab_of(run)
        for ambiguity, _ in open_questions(run):
            if only in (None, ambiguity.id) and not _decide(run, lab, ambiguity):
                return False
        if run.ledger.readings == before or run.enough():
            break
    return True


def _decide(run: Run, lab: Lab, ambiguity: Ambiguity) -> bool:
    """Try the experiments on one ambiguity, each only as long as it may still tell something."""
    for trial in lab.trials(ambiguity, run.ledger.readings[ambiguity.id]):
        left = run.ledger.readings.get(ambiguity.id, ())
        if trial.follows not in left or not set(trial.against) & set(left):
            continue
        if run.enough():
            return True
        if not run.converse(trial.world, trial.actions):
            return False
    return True
