"""Names, and the effect of single steps on one explanation."""

from __future__ import annotations

import itertools
import operator
from collections import Counter
from typing import Any

import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st

from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import Ambiguity, choose
from missionfsm.kernel.step import Emission, Opening, Step
from missionfsm.oracle.explanation import (
    DRAINED,
    GONE,
    Channel,
    Explanation,
    InFlight,
    Lost,
    Names,
    Owed,
    Ready,
    fresh,
    mentioned,
    rename,
    tidy,
    undrained,
    unify,
    with_lost,
    within,
    without_lost,
)
from missionfsm.oracle.taking import changes, take

OK = Answer("OK")
ASKED = Ambiguity("E-1", "?", {"a": "yes", "b": "no"}, "a")

own = st.integers(-5, 3).filter(lambda name: name != GONE)
some = st.lists(own, max_size=3).map(tuple)


@st.composite
def explanations(draw: st.DrawFn) -> Explanation:
    """Explanations with names everywhere."""
    names = tuple(draw(st.lists(own, max_size=3, unique=True)))
    ready = tuple(Ready(OK, one, (), ()) for one in draw(st.lists(some, max_size=2)))
    done = draw(st.none() | some.map(lambda one: Ready(OK, one, (), ())))
    calls = (InFlight(draw(own), "ask", draw(some), ready, done),) if draw(st.booleans()) else ()
    lost = tuple(("ask", one, 1) for one in draw(st.lists(some, max_size=1)))
    owed = tuple(Owed("view", one) for one in draw(st.lists(some, max_size=2)))
    last = draw(st.none() | some.map(lambda one: Owed("view", one)))
    channels = (Channel(draw(own.filter(lambda name: name not in names)), "topic", last, owed),)
    return Explanation("state", names, -1, calls, lost, channels if draw(st.booleans()) else ())


@given(explanations())
def test_tidy_numbers_unseen_names_by_first_mention(explanation: Explanation) -> None:
    """After `tidy` the unseen names are -2, -3… in the order of their first mention, and the observed ones stay."""
    before, after = list(mentioned(explanation)), list(mentioned(tidy(explanation)))
    unseen = list(dict.fromkeys(name for name in before if name < GONE))
    assert after == [name if name > GONE else GONE - 1 - unseen.index(name) for name in before]


@given(explanations(), st.permutations(range(-6, GONE)))
def test_explanations_that_differ_in_unseen_names_are_one(explanation: Explanation, numbers: list[int]) -> None:
    """However the names that nobody has seen are numbered, `tidy` makes the same explanation."""
    renamed = rename(explanation, dict(zip(range(-6, GONE), numbers, strict=True)))
    assert tidy(renamed) == tidy(explanation)


@given(explanations())
def test_fresh_names_are_new(explanation: Explanation) -> None:
    """The numbers for new names are unseen ones that the explanation does not mention."""
    numbers = list(itertools.islice(fresh(explanation), 4))
    assert len({*numbers} - {*mentioned(explanation)}) == 4
    assert max(numbers) < GONE


PAIR = Explanation("state", (0, -2, -3), channels=(Channel(1, "topic", owed=(Owed("view", (-2, 0)),)),), gone=(7,))


@pytest.mark.parametrize(
    ("pairs", "names"),
    [
        ([], (0, -2, -3)),
        ([(0, 0)], (0, -2, -3)),
        ([(-2, 5)], (0, 5, -3)),
        ([(-3, 5), (-2, 6)], (0, 6, 5)),
        ([(-2, 5), (-2, 5)], (0, 5, -3)),
        ([(0, 5)], None),
        ([(-2, 0)], None),
        ([(-2, 1)], None),
        ([(-2, 5), (-2, 6)], None),
        ([(-2, 5), (-3, 5)], None),
        ([(-2, 7)], None),
        ([(-2, GONE)], None),
    ],
    ids=str,
)
def test_names_are_bound_one_to_one(pairs: list[tuple[int, int]], names: Names | None) -> None:
    """An unseen name takes an observed one that nothing has, had or gets; a thing never has two names."""
    bound = unify(PAIR, pairs)
    assert (None if bound is None else bound.names) == names


def test_a_name_is_bound_everywhere() -> None:
    """What a channel owes mentions the name that was found out."""
    bound = unify(PAIR, [(-2, 5)])
    assert bound == evolve(PAIR, names=(0, 5, -3), channels=(Channel(1, "topic", owed=(Owed("view", (5, 0)),)),))


def test_the_name_of_what_is_no_more_is_spent() -> None:
    """A name found out for a thing that is gone already cannot become another's."""
    spent = unify(Explanation("state", (-2,)), [(-3, 4)])
    assert spent == Explanation("state", (-2,), gone=(4,))
    assert unify(spent, [(-2, 4)]) is None


def test_a_step_keeps_adds_and_drops_names() -> None:
    """Names are referred to by position; new ones are unseen, dropped ones that were observed are gone."""
    before = Explanation("state", (0, 1, -2))
    step = Step("next", names=(2, 3, 0), refs=(3, 1), answer=OK)
    after = take(before, step, (), passing=False, concerns=operator.eq)
    assert after == (Explanation("next", (-2, -3, 0), gone=(1,)), (-3, 1))


def test_given_names_count_from_minus_one() -> None:
    """-1 is the first name that an event brought along, -2 the second."""
    step = Step("next", names=(-2, 0, -1))
    after = take(Explanation("state", (0,)), step, (5, 6), passing=False, concerns=operator.eq)
    assert after == (Explanation("next", (6, 0, 5)), ())


def test_a_step_owes_messages_to_those_concerned() -> None:
    """An emission is owed to the channels of its topic, the ones opened by the same step get what they start with."""
    before = Explanation("state", (0,), channels=(Channel(1, "news"), Channel(2, "weather")))
    step = Step(
        "next",
        names=(0, 1),
        emits=(Emission("news", "all"), Emission("news", "new", (1,), only=ASKED["a"])),
        opens=(Opening("news", 2, (Emission("news", "first", ()),)),),
    )
    taken = take(before, step, (), passing=False, concerns=operator.eq)
    owed = (Owed("all", (0, -2)), Owed("new", (-2,), passing=True, only=ASKED["a"]))
    channels = (Channel(1, "news", owed=owed), Channel(2, "weather"), Channel(-3, "news", owed=(Owed("first", ()),)))
    assert taken is not None
    assert taken[0].names == (0, -2)
    assert [(one.topic, [(each.view, each.names, each.passing) for each in one.owed]) for one in taken[0].channels] == [
        (one.topic, [(each.view, each.names, each.passing) for each in one.owed]) for one in channels
    ]
    assert [one.name for one in taken[0].channels] == [1, 2, -3]


def test_what_a_passing_state_shows_may_be_left_out() -> None:
    """A step into a state that does not last owes messages that are passing."""
    before = Explanation("state", channels=(Channel(1, "news"),))
    step = Step("next", emits=(Emission("news", "view", ()),))
    after = take(before, step, (), passing=True, concerns=operator.eq)
    assert after == (Explanation("next", channels=(Channel(1, "news", owed=(Owed("view", (), passing=True),)),)), ())


def test_a_step_closes_channels() -> None:
    """The channels of a topic that a step closes are gone with what they owed, and so are their names."""
    before = Explanation("state", channels=(Channel(1, "news", owed=(Owed("v", ()),)), Channel(2, "weather")))
    after = take(before, Step("next", closes=("news",)), (), passing=False, concerns=operator.eq)
    assert after == (Explanation("next", channels=(Channel(2, "weather"),), gone=(1,)), ())


def test_what_is_on_its_way_on_a_drained_channel_may_be_seen_until_things_settle() -> None:
    """The channels of a topic that a step drains are gone, and so are their names; what they owe need not come."""
    channels = (Channel(1, "news", owed=(Owed("v", ()),)), Channel(2, "news"), Channel(3, "weather"))
    step = Step("next", emits=(Emission("news", "w", ()),), drains=("news",))
    after = take(Explanation("state", channels=channels), step, (), passing=False, concerns=operator.eq)
    last = Owed("w", (), passing=True)
    draining = (Channel(1, DRAINED, owed=(Owed("v", (), passing=True), last)), Channel(2, DRAINED, owed=(last,)))
    assert after == (Explanation("next", channels=(*draining, Channel(3, "weather")), gone=(1, 2)), ())
    assert undrained(after[0]) == Explanation("next", channels=(Channel(3, "weather"),), gone=(1, 2))
    assert undrained(after[0], 1) == Explanation("next", channels=(draining[1], Channel(3, "weather")), gone=(1, 2))


def test_a_step_that_assumes_too_much_does_not_happen() -> None:
    """A step under a reading that the explanation has excluded cannot be taken; another narrows what is assumed."""
    under_a = Explanation("state", assumed=choose([ASKED]))
    assert take(under_a, Step("next", assumes=(ASKED["b"],)), (), passing=False, concerns=operator.eq) is None
    taken = take(Explanation("state"), Step("next", assumes=(ASKED["a"],)), (), passing=False, concerns=operator.eq)
    assert taken == (Explanation("next", assumed=ASKED["a"].kept), ())


def test_a_step_that_nobody_can_tell_changes_nothing() -> None:
    """A step into the very same state that shows nothing leaves no trace; one that shows or renames something does."""
    here = Explanation("state", names=(7,))
    steps = [
        Step(here.state),
        Step(here.state, names=(0,)),
        Step("next"),
        Step(here.state, names=(1,)),
        Step(here.state, emits=(Emission("news", "v"),)),
        Step(here.state, closes=("n",)),
    ]
    assert [changes(here.state, step) for step in steps] == [False, False, True, True, True, True]


CALLS = st.lists(st.tuples(st.sampled_from(["ask", "tell"]), st.sampled_from([(), (0,)])), max_size=6)


def _lost(calls: list[tuple[str, tuple[int, ...]]]) -> Lost:
    lost: Lost = ()
    for request, args in calls:
        lost = with_lost(lost, request, args)
    return lost


def _counted(lost: Lost) -> Counter[tuple[object, tuple[int, ...]]]:
    return Counter({(request, args): times for request, args, times in lost})


@given(calls=CALLS, others=CALLS)
def test_lost_calls_are_a_multiset(calls: list[tuple[str, tuple[int, ...]]], others: list[Any]) -> None:
    """Calls are counted whatever their order, one at a time leaves, and one bag is in another as with counters."""
    lost = _lost(calls)
    assert (_counted(lost), len(lost)) == (Counter(calls), len(set(calls)))
    assert within(lost, _lost(others)) == (Counter(calls) <= Counter(others))
    for position, (request, args, _) in enumerate(lost):
        assert _counted(without_lost(lost, position)) == Counter(calls) - Counter([(request, args)])
