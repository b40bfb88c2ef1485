"""Readings in a belief: kept apart where they must be, merged where they can be, reported."""

from __future__ import annotations

import itertools

import pytest
from toys import BUTTONS, QUESTIONS

from missionfsm.kernel.history import Answer, Called, Returned
from missionfsm.kernel.readings import UNCONSTRAINED, constrain
from missionfsm.kernel.rules import FAILED_PRECONDITION, OK
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief

AUTOMATON = Automaton(BUTTONS)
Asked = tuple[tuple[object, ...], object]
"""A request and what it is answered: the shape of an OK, or a code in brackets."""


def pressed(*asked: Asked, automaton: Automaton = AUTOMATON) -> tuple[Belief, list[bool]]:
    """A belief that saw these answers, and whether each was explained."""
    belief, verdicts = Belief(automaton, 0), []
    for number, (request, shape) in enumerate(asked):
        answer = Answer(FAILED_PRECONDITION) if shape == "refused" else Answer(OK, shape)
        belief.observe(Called(("call", number), request))
        verdicts.append(belief.observe(Returned(("call", number), answer)))
    return belief, verdicts


def test_a_run_that_follows_one_reading_is_explained() -> None:
    """A button that always says the same follows one reading, which is reported."""
    belief, verdicts = pressed((("button", 0), "a"), (("button", 0), "a"), (("button", 1), "c"))
    assert (verdicts, belief.readings) == ([True, True, True], {"Q-0": ("a",), "Q-1": ("c",)})


def test_a_run_may_not_follow_two_readings() -> None:
    """A button that says what two readings say is refuted, and stays so."""
    belief, verdicts = pressed((("button", 0), "a"), (("button", 0), "b"), (("button", 0), "a"))
    assert (verdicts, belief.broken) == ([True, False, False], True)


def test_a_set_of_readings_is_one_explanation() -> None:
    """What leaves two readings open is explained once, and either may follow."""
    belief, verdicts = pressed((("either", 0), "a or b"))
    assert (verdicts, belief.readings, len(belief.node.explanations)) == ([True], {"Q-0": ("a", "b")}, 1)
    assert [pressed((("either", 0), "a or b"), (("button", 0), letter))[1] for letter in "abc"] == [
        [True, True],
        [True, True],
        [True, False],
    ]


def test_what_every_reading_allows_decides_nothing() -> None:
    """Answers that come under each reading leave one explanation with all of them; there is nothing to report."""
    belief, verdicts = pressed(*((("quiet", number), None) for number in range(8)))
    assert (all(verdicts), len(belief.node.explanations), belief.readings) == (True, 1, {})
    assert belief.node.explanations[0].assumed == UNCONSTRAINED


def test_independent_questions_are_no_cross_product() -> None:
    """Eight half-decided questions are eight assumptions of one explanation."""
    belief, _ = pressed(*((("either", number), "a or b") for number in range(8)))
    assert [one.assumed for one in belief.node.explanations] == [
        constrain_all([QUESTIONS[number]["a", "b"].kept for number in range(8)])
    ]


def constrain_all(kept: list[int]) -> int:
    """All of these assumptions at once."""
    assumed = UNCONSTRAINED
    for one in kept:
        assumed &= one
    return assumed


def test_readings_that_lead_apart_are_explanations_of_their_own() -> None:
    """A turn whose effect depends on the reading leaves one explanation for each effect, merged by effect.

    The question mattered, so it is reported; none of its readings is excluded.
    """
    belief, _ = pressed((("turn", 0), None))
    found = {(one.state, QUESTIONS[0].possible(one.assumed)) for one in belief.node.explanations}
    assert (found, belief.readings) == ({(1, ("a",)), (0, ("b", "c"))}, {"Q-0": ("a", "b", "c")})


def test_a_question_that_mattered_stays_reported() -> None:
    """Once everything is as before under every reading, one explanation is left, and the question is still reported."""
    belief, _ = pressed((("turn", 0), None), (("reset",), None))
    assert (len(belief.node.explanations), belief.readings) == (1, {"Q-0": ("a", "b", "c")})


@pytest.mark.parametrize(("letter", "verdict"), [("a", True), ("b", True), ("c", False)])
def test_one_point_is_reached_under_several_readings(letter: str, verdict: bool) -> None:  # noqa: FBT001
    """A call in flight may have taken effect under either of two readings, and under no third."""
    belief = Belief(AUTOMATON, 0)
    events = (
        Called(("call", 1), ("jump", 0)),
        *(Called(("call", 2), ("read",)), Returned(("call", 2), Answer(OK, 1))),
        *(Called(("call", 3), ("button", 0)), Returned(("call", 3), Answer(OK, letter))),
    )
    assert [belief.observe(event) for event in events] == [True, True, True, True, verdict]


def test_what_is_the_same_again_is_merged() -> None:
    """Turns under k questions lead to k + 1 states; explanations that a state has no box for stay apart."""
    sizes = []
    for count in range(1, 6):
        belief, _ = pressed(*((("turn", number), None) for number in range(count)))
        sizes.append((len({one.state for one in belief.node.explanations}), len(belief.node.explanations)))
    assert sizes == [(2, 2), (3, 4), (4, 8), (5, 16), (6, 32)]


def test_a_refusal_excludes_readings() -> None:
    """A refusal under one reading decides for it, in every explanation at once."""
    belief, verdicts = pressed((("turn", 0), None), (("turn", 0), "refused"))
    assert (verdicts, belief.readings, len(belief.node.explanations)) == ([True, True], {"Q-0": ("c",)}, 1)


def test_what_is_assumed_from_the_start_counts() -> None:
    """With a reading decided from the start the others are violations."""
    automaton = Automaton(BUTTONS, assumed=constrain(QUESTIONS, {"Q-0": "a"}))
    assert [pressed((("button", 0), letter), automaton=automaton)[1] for letter in "abc"] == [[True], [False], [False]]


@pytest.mark.parametrize("letters", list(itertools.product("ab", repeat=3)), ids="".join)
def test_every_consistent_choice_is_explained(letters: tuple[str, ...]) -> None:
    """Whatever the letters are, a run that follows them is explained and the report has exactly them."""
    asked = [(("button", number), letter) for number, letter in enumerate(letters)]
    belief, verdicts = pressed(*asked, *asked)
    assert (all(verdicts), belief.readings) == (True, {f"Q-{at}": (letter,) for at, letter in enumerate(letters)})


def test_rules_are_counted_as_often_as_they_were_exercised() -> None:
    """The rules behind the answers are counted, by all walks together."""
    automaton = Automaton(BUTTONS)
    pressed((("button", 0), "a"), (("button", 0), "a"), automaton=automaton)
    pressed((("button", 0), "a"), (("button", 1), "b"), automaton=automaton)
    assert automaton.exercised() == {"says-a": 3, "says-b": 1}
