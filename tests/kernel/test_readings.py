"""Ambiguities and what an execution has assumed."""

from __future__ import annotations

import functools
import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionfsm.kernel.readings import ANYTHING, Ambiguity, Assumption, choose, constrain, meet, merge

COLOUR = Ambiguity("R-1", "Which colour?", {"a": "red", "b": "green", "c": "blue"}, "b")
DAY = Ambiguity("R-2.day", "Which day?", {"a": "Monday", "b": "Friday"}, "a")
HOUR = Ambiguity("R-2.hour", "Which hour?", {"b": "noon", "c": "midnight"}, "c")
ALL = (COLOUR, DAY, HOUR)
GROUPS = tuple(one.group for one in ALL)
Choices = frozenset[tuple[str, ...]]

assumptions = st.sampled_from(ALL).flatmap(
    lambda one: st.sets(st.sampled_from(sorted(one.readings)), min_size=1).map(lambda some: one[tuple(sorted(some))])
)


def choices(assumed: int) -> Choices:
    """The full choices that a set of assumptions stands for."""
    return frozenset(itertools.product(*(one.possible(assumed) for one in ALL)))


def allowed_by(assumption: Assumption) -> Choices:
    """The full choices that agree with one assumption."""
    at = ALL.index(assumption.of)
    return frozenset(choice for choice in choices(ANYTHING) if choice[at] in assumption.letters)


@given(st.lists(assumptions, max_size=4))
def test_meet_leaves_the_choices_that_agree_with_all(some: list[Assumption]) -> None:
    """What is assumed together stands for the choices that agree with each; 0 where there is none."""
    expected = functools.reduce(frozenset.intersection, map(allowed_by, some), choices(ANYTHING))
    assumed = meet(ANYTHING, some)
    assert (choices(assumed), assumed == 0) == (expected, not expected)


@given(st.lists(assumptions, max_size=3), st.lists(assumptions, max_size=3))
def test_merge_stands_for_exactly_the_two(first: list[Assumption], second: list[Assumption]) -> None:
    """Two sets of assumptions become one exactly where their choices together are a box."""
    one, other = meet(ANYTHING, first), meet(ANYTHING, second)
    if not one or not other:
        return
    union = choices(one) | choices(other)
    sides = [sorted({choice[at] for choice in union}) for at in range(len(ALL))]
    merged = merge(one, other, GROUPS)
    assert (None if merged is None else choices(merged)) == (
        union if union == frozenset(itertools.product(*sides)) else None
    )


def test_an_assumption_says_its_letters() -> None:
    """An assumption is written with the letters that are left; `besides` and `where` make the same ones."""
    found = [str(one) for one in (COLOUR["a"], COLOUR["c", "a"], COLOUR.besides("a"), COLOUR.where(DAY.group))]
    assert found == ["R-1=a", "R-1=a|c", "R-1=b|c", "R-1="]


def test_choose_follows_the_defaults() -> None:
    """Without a wish every question has its default; a wish decides its own question alone."""
    assert choices(choose(ALL)) == {("b", "a", "c")}
    assert choices(choose(ALL, {"R-1": "c"})) == {("c", "a", "c")}


def test_an_entry_speaks_for_all_its_parts() -> None:
    """The id of an entry decides every part that has the letter, and leaves the default to those that do not."""
    assert choices(choose(ALL, {"R-2": "b"})) == {("b", "b", "b")}
    assert choices(choose(ALL, {"R-2": "a"})) == {("b", "a", "c")}
    assert choices(constrain(ALL, {"R-2": "c"})) == {
        (colour, day, "c") for colour in COLOUR.readings for day in DAY.readings
    }


def test_an_exact_id_speaks_for_itself_alone() -> None:
    """Where an ambiguity has the id of an entry, that id decides it and not the parts."""
    hour = Ambiguity("R-2", "Which?", {"a": "this", "b": "that"}, default="a")
    part = Ambiguity("R-2.part", "Which part?", {"a": "this", "b": "that"}, default="a")
    both = choose((hour, part), {"R-2": "b"})
    assert (hour.possible(both), part.possible(both)) == (("b",), ("a",))


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        ({"R-9": "a"}, "there is no ambiguity R-9; there are R-1, R-2.day, R-2.hour"),
        ({"R-2": "z"}, "R-2 has no reading z: R-2.day has a, b; R-2.hour has b, c"),
        ({"R-2.day": "c"}, "R-2.day has no reading c: R-2.day has a, b"),
    ],
)
def test_a_wish_that_does_not_exist_is_refused(wish: dict[str, str], message: str) -> None:
    """An unknown entry or letter is refused with a line that says what there is."""
    with pytest.raises(ValueError, match="^" + message.replace(".", r"\.") + "$"):
        choose(ALL, wish)


@pytest.mark.parametrize("extra", [{"default": "z"}, {"default": "a", "flagged": frozenset("z")}])
def test_the_default_and_the_flagged_are_readings(extra: dict[str, object]) -> None:
    """An ambiguity whose default or flagged letter is none of its readings cannot be made."""
    with pytest.raises(ValueError, match="R-5: the default and the flagged letters must be readings, a, b"):
        Ambiguity("R-5", "?", {"a": "yes", "b": "no"}, **extra)  # type: ignore[arg-type]
