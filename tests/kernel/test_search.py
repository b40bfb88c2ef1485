"""A search through a window of events against the belief that takes them one by one."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_belief_bruteforce import ALPHABETS, Alphabet, Conversation, choices

sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
from test_bench_register import Load
from test_bench_register import history as race
from toys import REGISTER

from missionfsm.kernel import history
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.search import Search
from missionfsm.oracle.successors import ExhaustedError
from missionfsm.oracle.window import Window


def walked(alphabet: Alphabet, automaton: Automaton, data: st.DataObject, steps: int) -> list[history.Event]:
    """A history that is mostly explained: of many events one that is, and now and then any."""
    world = data.draw(st.sampled_from(alphabet.worlds))
    conversation = Conversation(alphabet)
    belief = Belief(automaton, world)
    events: list[history.Event] = []
    for _ in range(steps):
        sort = data.draw(st.sampled_from(conversation.sorts()))
        some = data.draw(st.permutations(sort))[:12]
        reckless = data.draw(st.integers(0, 30)) == 0
        event = next((one for one in some if reckless or explained(automaton, world, [*events, one])), None)
        if event is not None:
            events.append(event)
            conversation.note(event)
            belief.observe(event)
    return [world, *events]  # type: ignore[list-item]  # the world comes first


def explained(automaton: Automaton, world: object, events: list[history.Event]) -> bool:
    """Whether the belief explains a history."""
    belief = Belief(automaton, world)
    return all(belief.observe(event) for event in events)


def searched(
    belief: Belief, events: list[history.Event], width: int, *, whole: bool, before: Iterable[int] = ()
) -> tuple[Window, Search]:
    """A window of events, to be searched; before so many of them come, it is searched up to there."""
    window = Window(belief)
    for at, event in enumerate(events):
        if at in before:
            earlier = window.search()
            earlier.width = width
            earlier.first_unexplained()
        window.add(event)
    search = window.search(window.unanswered if whole else None)
    search.width = width
    return window, search


def compare(alphabet: Alphabet, automaton: Automaton, data: st.DataObject) -> None:
    """One history, cut in two anywhere, searched from there."""
    world, *events = walked(alphabet, automaton, data, 12)
    cut = data.draw(st.integers(0, len(events)))
    width = data.draw(st.sampled_from([1, 2, 16]))
    whole, earlier = data.draw(st.booleans()), data.draw(st.sets(st.integers(0, 12), max_size=2))
    alone, before = Belief(automaton, world), Belief(automaton, world)
    right = next((position for position, event in enumerate(events) if not alone.observe(event)), None)
    if not all(before.observe(event) for event in events[:cut]):
        return
    window, search = searched(before, events[cut:], width, whole=whole, before=earlier)
    try:
        found = search.first_unexplained()
    except ExhaustedError:
        assert not whole, "only where more may come, that may be needed to decide"
        return
    assert (events, None if found is None else cut + window.positions[found]) == (events, right)
    if right is None:
        window.close(search)
        assert choices(alphabet, before) <= choices(alphabet, alone)
        assert choices(alphabet, alone) <= choices(alphabet, before) or not search.exact or whole
        left = before.left
        assert left | alone.left == left


@pytest.mark.parametrize("alphabet", ALPHABETS, ids=lambda one: one.name)
def test_a_search_finds_what_the_belief_finds(alphabet: Alphabet) -> None:
    """A window that is searched has its first unexplained event where the belief has it; no reading is lost.

    So it is where the search goes on with events that come later.
    """
    automaton = Automaton(alphabet.spec, alphabet.driven)

    @settings(max_examples=100, deadline=None, suppress_health_check=list(HealthCheck))
    @given(st.data())
    def run(data: st.DataObject) -> None:
        compare(alphabet, automaton, data)

    run()


def first_unexplained(events: list[history.Event], cut: int, *, calls_alone: bool) -> tuple[int | None, list[bool]]:
    """What a search finds from an event on, and whether it was one of calls alone, with a belief before it."""
    belief = Belief(Automaton(REGISTER), 0)
    assert all(map(belief.observe, events[:cut]))
    window, search = searched(belief, events[cut:], 1, whole=True)
    was = search.calls_alone
    search.calls_alone = calls_alone
    found = search.first_unexplained()
    if found is None:
        window.close(search)
        return None, [was]
    return window.positions[found], [was]


@pytest.mark.parametrize("seed", range(16))
@pytest.mark.parametrize("wrong", [False, True])
def test_a_search_through_calls_finds_what_any_search_finds(seed: int, *, wrong: bool) -> None:
    """Calls that race, some of them lost, are explained up to the same event, with a memo of their own and without."""
    events = race(Load(3 + seed % 3, 24, 2.5, lost=seed % 4, wrong=wrong), seed)
    cut = seed % 7
    alone, any_other = (first_unexplained(events, cut, calls_alone=one) for one in (True, False))
    assert alone == any_other
    assert alone[1] == [True]
