"""Conversations with a mission server that contradict one another, where events wait or are too dear to decide."""

from __future__ import annotations

import pytest
from server_history import SERVER, History

from missionfsm.app.conversations import verdicts_by_robot
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import UNCONSTRAINED
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.successors import EVENT_BUDGET
from missionfsm.oracle.transcript import Head
from missionfsm.tools.check.judge import PATIENCE, Judge
from missionfsm.tools.check.verdict import Outcome
from missionfsm.tools.conform.contradiction import irreconcilable


def called(word: str) -> list[JSON]:
    """A conversation with a mission server in which a mission that waits is cancelled, and called so or otherwise."""
    history = History().submit(1).submit(2, upstream=[1]).robot(1).sends(1, 1).settles
    return history.reports(1, 1, "failure").settles.shows("FAILED", word).lines


@pytest.mark.parametrize("patience", [1, PATIENCE])
def test_what_an_event_that_waits_rules_out_contradicts_as_well(patience: int) -> None:
    """Where events wait for those after them, conversations that no choice of readings explains together are told."""
    given = Head("isaac.server", {}, ("connect", "line", "disconnect", "advance"))
    judges = []
    for word in ("FAILED_UPSTREAM", "FAILED"):
        judges.append(Judge(SERVER, given, Automaton(SERVER.spec, given.drives, UNCONSTRAINED, patience)))
        assert all(judges[-1].feed(line) for line in called(word))
        assert judges[-1].verdict().conforms
    assert [one.held_back for one in judges] == [patience == 1] * 2
    found = irreconcilable(SERVER, judges)
    assert found is not None
    assert "AI-02.canceled" in found.observed


def test_conversations_of_which_one_is_undecided_come_to_nothing() -> None:
    """A conversation that has too many explanations is not passed over because another conforms."""
    given = Head("isaac.server", {}, ("connect", "line", "disconnect", "advance"))
    judgements = []
    for patience in (EVENT_BUDGET, 1):
        automaton = Automaton(SERVER.spec, given.drives, UNCONSTRAINED, patience)
        judge = Judge(SERVER, given, automaton, waits=False)
        for line in called("FAILED_UPSTREAM"):
            judge.feed(line)
        judgements.append((SERVER, None, judge, judge.verdict()))
    ((_, verdict),) = verdicts_by_robot(judgements)
    assert verdict.outcome is Outcome.INCONCLUSIVE
