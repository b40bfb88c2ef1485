"""Rules, and what they allow together."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.rules import (
    Citation,
    Decision,
    Document,
    Operation,
    Ranking,
    Rule,
    decide,
    promise,
    refusal,
    unranked,
)

PAGE = Document("Toy", "A toy page")
SHAPE = Ambiguity("D-1", "Does shape count?", {"a": "yes", "b": "no", "c": "sometimes"}, "a")
STATE = Ambiguity("D-2", "Does state count?", {"a": "yes", "b": "no"}, "a")
ORDER = Ambiguity("D-3", "What is checked first?", {"a": "nothing", "b": "BAD before WORSE"}, "a")
ALL = (SHAPE, STATE, ORDER)
CODES = ("BAD", "WORSE", "WORST")
CONDITIONS: tuple[Assumption | None, ...] = (
    None,
    None,
    SHAPE["a"],
    SHAPE["a", "b"],
    SHAPE["c"],
    SHAPE.besides("a"),
    STATE["a"],
    STATE["b"],
)


def ranked(holding: tuple[Rule, ...]) -> tuple[tuple[str, tuple[Assumption, ...]], ...]:
    """Under D-3 b, BAD comes before WORSE; otherwise any code may be answered."""
    codes = {str(one.code) for one in holding}
    if not {"BAD", "WORSE"} <= codes:
        return tuple((code, ()) for code in sorted(codes))
    return tuple((code, (ORDER["a"],) if code == "WORSE" else ()) for code in sorted(codes))


def holds_under(choice: dict[str, str], assumptions: tuple[Assumption, ...]) -> bool:
    """Whether a full choice of readings agrees with what is assumed."""
    return all(choice[one.ambiguity.id] in one.letters for one in assumptions)


def evaluated(rules: tuple[Rule, ...], rank: Ranking, choice: dict[str, str]) -> dict[str | None, frozenset[str]]:
    """What the rules allow under one full choice: every code with the names of the rules that justify it."""
    active = tuple(one for one in rules if one.assumes is None or holds_under(choice, (one.assumes,)))
    if not active:
        return {None: frozenset()}
    codes = {one.code for one in active}
    if len(codes) > 1:
        codes = {code for code, assumes in rank(active) if holds_under(choice, assumes)}
    return {code: frozenset(one.name for one in active if one.code == code) for code in codes}


@given(
    st.lists(st.tuples(st.sampled_from(CODES), st.sampled_from(CONDITIONS)), max_size=5),
    st.sampled_from((unranked, ranked)),
)
def test_decide_allows_what_the_rules_allow_under_every_choice(
    table: list[tuple[str, Assumption | None]], rank: Ranking
) -> None:
    """Under every full choice of readings the decisions give the codes that evaluating the rules under it gives."""
    rules = tuple(
        Rule(f"rule-{number}", "", "", PAGE["Errors"], code, assumes=under)
        for number, (code, under) in enumerate(table)
    )
    decisions = decide(rules, rank)
    letters = [[(one.id, letter) for letter in one.readings] for one in ALL]
    for choice in map(dict, itertools.product(*letters)):
        allowed: dict[str | None, set[str]] = {}
        for one in decisions:
            if holds_under(choice, one.assumes):
                allowed.setdefault(one.code, set()).update(rule.name for rule in one.rules)
        expected = evaluated(rules, rank, choice)
        assert allowed.keys() == expected.keys()
        if len(expected) > 1:
            assert allowed == {code: set(names) for code, names in expected.items()}


def test_decide_tells_readings_apart_only_where_the_rules_do() -> None:
    """Two letters that no rule at hand tells apart stay one case."""
    only_c = Rule("only-c", "", "", PAGE["Errors"], "BAD", assumes=SHAPE["c"])
    found = [(one.code, [str(assumed) for assumed in one.assumes]) for one in decide((only_c,))]
    assert found == [("BAD", ["D-1=c"]), (None, ["D-1=a|b"])]


def test_decide_ignores_readings_that_change_nothing() -> None:
    """Where a rule refuses under every reading, one of the same code under a reading adds no case."""
    always = Rule("always", "", "", PAGE["Errors"], "BAD")
    under = Rule("under", "", "", PAGE["Errors"], "BAD", assumes=SHAPE["a"])
    assert decide((under, always)) == (Decision("BAD", (always,), ()),)


def test_decide_without_rules_lets_the_operation_take_effect() -> None:
    """No rule that holds means success, under any reading."""
    assert decide(()) == (Decision(None, (), ()),)


@refusal("BAD", cite=PAGE["Create", "Errors"], assumes=SHAPE["a"], looks_at="shape")
def _the_number_is_odd(state: int, call: int) -> bool:
    """The number is odd.

    D-1: odd numbers
    are refused.
    """
    return (state + call) % 2 == 1


def test_a_rule_is_made_of_its_function() -> None:
    """The name, the message, the argument and the condition of a rule come from one function."""
    found = (
        _the_number_is_odd.name,
        _the_number_is_odd.says,
        _the_number_is_odd.argues,
        str(_the_number_is_odd.cite),
        _the_number_is_odd(1, 2),
        _the_number_is_odd(1, 1),
    )
    cite = "Toy › Create › Errors"
    assert found == ("the-number-is-odd", "The number is odd.", "D-1: odd numbers are refused.", cite, True, False)


def test_a_rule_without_a_message_is_refused() -> None:
    """A condition without a docstring is no rule: nobody could be told."""

    def silent(_: object, __: object) -> bool:
        return True

    with pytest.raises(TypeError, match="silent has no docstring"):
        refusal("BAD", cite=PAGE["Errors"])(silent)


def test_an_operation_registers_its_rules() -> None:
    """Rules get their ids where they are registered: with the code for a refusal, without for a promise."""
    order = promise("in-order", "Answers come in order.", cite=PAGE["Create"])
    create = Operation.with_rules("Create", "toy", PAGE["Create"], refusals=[_the_number_is_odd], promises=[order])
    ids = [one.id for one in (*create.refusals, *create.promises)]
    assert ids == ["toy/Create/BAD/the-number-is-odd", "toy/Create/in-order"]
    assert (create.blocking(0, 1), create.blocking(1, 1)) == (create.refusals, ())


def test_a_document_cites_headings() -> None:
    """One heading or several make a citation."""
    assert (PAGE["Errors"], str(PAGE["a", "b"])) == (Citation("Toy", ("Errors",)), "Toy › a › b")
