"""Ambiguities and what an execution has assumed."""

from __future__ import annotations

import functools
import itertools
import re
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionfsm.kernel.readings import (
    UNCONSTRAINED,
    Ambiguity,
    Assumption,
    asked_of_each,
    by_bit,
    choose,
    clashes,
    constrain,
    declared,
    meet,
    merge,
    unflagged,
)

COLOUR = Ambiguity("R-1", "Which colour?", {"a": "red", "b": "green", "c": "blue"}, "b")
DAY = Ambiguity("R-2.day", "Which day?", {"a": "Monday", "b": "Friday"}, "a")
HOUR = Ambiguity("R-2.hour", "Which hour?", {"b": "noon", "c": "midnight"}, "c")
ALL = (COLOUR, DAY, HOUR)
GROUPS = by_bit(ALL)
Choices = frozenset[tuple[str, ...]]

assumptions = st.sampled_from(ALL).flatmap(
    lambda one: st.sets(st.sampled_from(sorted(one.readings)), min_size=1).map(lambda some: one[tuple(sorted(some))])
)


def choices(assumed: int) -> Choices:
    """The full choices that a set of assumptions stands for."""
    return frozenset(itertools.product(*(one.possible(assumed) for one in ALL)))


def allowed_by(assumption: Assumption) -> Choices:
    """The full choices that agree with one assumption."""
    at = ALL.index(assumption.ambiguity)
    return frozenset(choice for choice in choices(UNCONSTRAINED) if choice[at] in assumption.letters)


@given(st.lists(assumptions, max_size=4))
def test_meet_leaves_the_choices_that_agree_with_all(some: list[Assumption]) -> None:
    """What is assumed together stands for the choices that agree with each; 0 where there is none."""
    expected = functools.reduce(frozenset.intersection, map(allowed_by, some), choices(UNCONSTRAINED))
    assumed = meet(UNCONSTRAINED, some)
    assert (choices(assumed), assumed == 0) == (expected, not expected)


@given(st.lists(assumptions, max_size=3), st.lists(assumptions, max_size=3))
def test_merge_stands_for_exactly_the_two(first: list[Assumption], second: list[Assumption]) -> None:
    """Two sets of assumptions become one exactly where their choices together are a box."""
    one, other = meet(UNCONSTRAINED, first), meet(UNCONSTRAINED, second)
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


def test_an_id_speaks_for_what_is_below_it() -> None:
    """An id decides the ambiguity that has it and every part of it, however deep; one that names more decides last."""
    whole, part, deep, other = (
        Ambiguity(name, "Which?", {"a": "this", "b": "that"}, default="a")
        for name in ("R-2", "R-2.part", "R-2.part.deep", "R-22")
    )
    ambiguities = (whole, part, deep, other)

    def chosen(**choice: str) -> str:
        names = {name.replace("_", "."): letter for name, letter in choice.items()}
        assumed = choose(ambiguities, {name.replace("R2", "R-2"): letter for name, letter in names.items()})
        return "".join("".join(one.possible(assumed)) for one in ambiguities)

    assert (chosen(R2="b"), chosen(R2_part="b"), chosen(R2_part_deep="b")) == ("bbba", "abba", "aaba")
    assert (chosen(R2="b", R2_part="a"), chosen(R2_part="a", R2="b")) == ("baaa", "baaa")


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


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        ("AM-9", "there is no ambiguity AM-9; is AM-90 meant?"),
        ("x", f"there is no ambiguity x; there are {', '.join(f'AM-{90 + one}' for one in range(10))}"),
    ],
)
def test_of_many_the_one_that_is_meant_is_named(wish: str, message: str) -> None:
    """Where there are too many to be read, the nearest is named, or else the entries without their questions."""
    many = [Ambiguity(f"AM-{90 + one}.{part}", "?", {"a": "1", "b": "2"}, "a") for one in range(10) for part in "pq"]
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        choose(many, {wish: "a"})


@pytest.mark.parametrize("extra", [{"default": "z"}, {"flagged": frozenset("z")}, {"json_only": frozenset("z")}])
def test_every_letter_is_a_reading(extra: dict[str, object]) -> None:
    """An ambiguity whose default, or a letter of which something is said, is none of its readings cannot be made."""
    with pytest.raises(ValueError, match="R-5: every letter of it must be one of its readings, a, b"):
        Ambiguity("R-5", "?", {"a": "yes", "b": "no"}, **{"default": "a", **extra})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("write", "message"),
    [
        (lambda: COLOUR["z"], "R-1 has no reading 'z'; it has a, b, c"),
        (lambda: COLOUR["a", "ab"], "R-1 has no reading 'ab'; it has a, b, c"),
        (lambda: COLOUR.besides("d"), "R-1 has no reading 'd'; it has a, b, c"),
        (lambda: COLOUR.besides("a", "b", "c"), "R-1 has no reading ''; it has a, b, c"),
    ],
)
def test_a_letter_is_checked_when_it_is_written(write: Callable[[], Assumption], message: str) -> None:
    """An assumption about a letter that is no reading, or about none, is refused where it is written."""
    with pytest.raises(ValueError, match=f"^{message}$"):
        write()


FIRST, SECOND, THIRD = (
    Ambiguity(f"R-3.{call}", "Which code?", {"a": "this", "b": "that", **more}, "a", alike="R-3")
    for call, more in (("create", {"c": "both"}), ("append", {}), ("skip", {"c": "both"}))
)


def test_alike_parts_that_share_no_letter_clash() -> None:
    """An execution that reads alike parts differently is found, pair by pair; one that still can agree is not."""
    asked = (*ALL, FIRST, SECOND, THIRD)
    differing = meet(UNCONSTRAINED, (FIRST["a"], SECOND["b"], THIRD["b", "c"]))
    agreeing = meet(UNCONSTRAINED, (FIRST["a", "b"], SECOND["b"], COLOUR["a"], DAY["b"]))
    assert (clashes(asked, differing), clashes(asked, agreeing), clashes(asked, UNCONSTRAINED)) == (
        ((FIRST, SECOND), (FIRST, THIRD)),
        (),
        (),
    )


def test_unflagged_leaves_what_the_text_says() -> None:
    """Without departures from the text every flagged letter is ruled out and no other."""
    odd = Ambiguity("R-4", "Odd?", {"a": "no", "b": "yes", "c": "very"}, "a", flagged=frozenset("bc"))
    left = unflagged((*ALL, odd))
    assert (odd.possible(left), choices(left)) == (("a",), choices(UNCONSTRAINED))


def test_a_question_that_is_asked_of_each_part_has_an_ambiguity_for_each() -> None:
    """Each part has its name in the id and its words in the question; several are alike, unless that is not meant."""
    rooms = asked_of_each("R-5", "Which lamp in the {}?", {"a": "red"}, {"hall": "great hall", "attic": "attic"})
    lone = asked_of_each("R-5", "Which lamp in the {}?", {"a": "red"}, ("hall",), flagged="a")
    free = asked_of_each("R-5", "Which lamp in the {}?", {"a": "red"}, ("hall", "attic"), alike=False)
    assert [(part, one.id, one.question, one.alike) for part, one in rooms.items()] == [
        ("hall", "R-5.hall", "Which lamp in the great hall?", "R-5"),
        ("attic", "R-5.attic", "Which lamp in the attic?", "R-5"),
    ]
    assert [(one.question, one.flagged, one.alike) for one in lone.values()] == [
        ("Which lamp in the hall?", frozenset("a"), None)
    ]
    assert {one.alike for one in free.values()} == {None}


def test_what_a_module_declares_is_what_it_names_in_public() -> None:
    """Values are found by themselves and in mappings, each once, in their order; private names declare nothing."""
    names = {"COLOUR": COLOUR, "_DAY": DAY, "BY_DAY": {"first": HOUR, "inner": {"second": COLOUR}}, "OTHER": "red"}
    assert declared(names, Ambiguity) == (COLOUR, HOUR)
