"""How the machines of this folder are run: with few examples, or with ``--hypothesis-profile long`` with many."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, Phase, Verbosity, settings
from hypothesis.stateful import RuleBasedStateMachine, run_state_machine_as_test

STEPS = 40
"""Calls and drives of one example: long enough for a queue to fill, drain and be cleared."""


def holds(machine: type[RuleBasedStateMachine], share: int) -> None:
    """Run a machine; its first failure is made short and raised.

    Args:
        share: the examples of the profile that is loaded are divided by it.
    """
    run_state_machine_as_test(
        machine,
        settings=settings(
            max_examples=settings().max_examples // share,
            stateful_step_count=STEPS,
            derandomize=True,
            database=None,
            suppress_health_check=list(HealthCheck),
        ),
    )


def fails(machine: type[RuleBasedStateMachine], examples: int = 600) -> None:
    """Run a machine against something broken: it has to fail, by an assertion, within some examples."""
    with pytest.raises(AssertionError):
        run_state_machine_as_test(
            machine,
            settings=settings(
                max_examples=examples,
                stateful_step_count=STEPS,
                derandomize=True,
                database=None,
                report_multiple_bugs=False,
                phases=[Phase.generate],
                verbosity=Verbosity.quiet,
                suppress_health_check=list(HealthCheck),
            ),
        )
