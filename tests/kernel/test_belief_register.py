"""A register with calls that race: the belief is linearizability, checked just in time."""

from __future__ import annotations

import itertools

import pytest
from attrs import frozen
from hypothesis import given, settings
from hypothesis import strategies as st
from toys import REGISTER, Request

from missionfsm.kernel.history import Answer, Called, Event, Returned
from missionfsm.kernel.rules import DEADLINE_EXCEEDED, OK
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.successors import Successors

AUTOMATON = Automaton(REGISTER)


@frozen
class Operation:
    """One call of a history: when it was sent and answered, in places of the history; `end` None: it never was."""

    start: int
    request: Request
    end: int | None
    code: str | None = None
    value: object = None


def applied(value: int, request: Request) -> tuple[int, object]:
    """The register after a request, and what is answered."""
    match request:
        case ("write", new):
            return new, None
        case ("swap", old, new):
            return (new, True) if value == old else (value, False)
        case _:
            return value, value


def linearizable(operations: list[Operation]) -> bool:
    """Whether some order of the calls explains all answers: all orders of all subsets are tried.

    Every answered call is in the order; one without an answer, and one whose deadline passed, may be. No call stands
    before one that was answered before it was sent. A call whose deadline passed may come at any time after its start.
    """
    answered = [one for one in operations if one.code == OK]
    open_ended = [one for one in operations if one.code != OK and one.request[0] != "read"]
    for size in range(len(open_ended) + 1):
        for chosen in itertools.combinations(open_ended, size):
            for order in itertools.permutations((*answered, *chosen)):
                if _explains(order):
                    return True
    return False


def _explains(order: tuple[Operation, ...]) -> bool:
    value = 0
    for at, one in enumerate(order):
        if any(later.code == OK and later.end is not None and later.end < one.start for later in order[at + 1 :]):
            return False
        value, answer = applied(value, one.request)
        if one.code == OK and answer != one.value:
            return False
    return True


def accepted(events: list[Event]) -> bool:
    """Whether the belief explains a history."""
    belief = Belief(AUTOMATON, 0)
    return all(belief.observe(event) for event in events)


REQUESTS: tuple[Request, ...] = (("write", 1), ("write", 2), ("swap", 1, 2), ("swap", 2, 1), ("read",), ("read",))

ANSWERS: dict[str, list[object]] = {"write": [None], "swap": [True, False], "read": [0, 1, 2]}


@st.composite
def histories(draw: st.DrawFn) -> tuple[list[Event], list[Operation]]:
    """Up to five calls that overlap at random, answered at random, lost, left open or given up at their deadline."""
    events: list[Event] = []
    operations: dict[int, Operation] = {}
    pending: list[int] = []
    for _ in range(draw(st.integers(2, 10))):
        if pending and draw(st.integers(0, 2)) > 0:
            number = pending.pop(draw(st.integers(0, len(pending) - 1)))
            sent = operations[number]
            answers: list[object] = ANSWERS[sent.request[0]]
            late = sent.request[0] != "read" and not draw(st.integers(0, 4))
            answer = Answer(DEADLINE_EXCEEDED) if late else Answer(OK, draw(st.sampled_from(answers)))
            operations[number] = Operation(sent.start, sent.request, len(events), answer.code, answer.shape)
            events.append(Returned(("call", number), answer))
        elif len(operations) < 5:
            number, lost = len(operations), not draw(st.integers(0, 5))
            request = draw(st.sampled_from(REQUESTS))
            operations[number] = Operation(len(events), request, None)
            if not lost:
                pending.append(number)
            events.append(Called(("call", number), request, lost=lost))
    return events, list(operations.values())


@settings(max_examples=400, deadline=None)
@given(histories())
def test_a_history_is_accepted_exactly_if_it_is_linearizable(history: tuple[list[Event], list[Operation]]) -> None:
    """The verdict on a history is that of trying every order of its calls."""
    events, operations = history
    assert accepted(events) == linearizable(operations)


def call(number: int, *request: object, lost: bool = False) -> Called:
    """A call."""
    return Called(("call", number), request, lost=lost)


def answer(number: int, shape: object = None, code: str = OK) -> Returned:
    """Its answer."""
    return Returned(("call", number), Answer(code, shape))


@pytest.mark.parametrize(
    ("says", "events", "verdict"),
    [
        ("a write is read", [call(0, "write", 1), answer(0), call(1, "read"), answer(1, 1)], True),
        ("a write is forgotten", [call(0, "write", 1), answer(0), call(1, "read"), answer(1, 0)], False),
        ("a write is read before its answer", [call(0, "write", 1), call(1, "read"), answer(1, 1), answer(0)], True),
        ("a pending write is not read yet", [call(0, "write", 1), call(1, "read"), answer(1, 0), answer(0)], True),
        (
            "a pending write is read and then not",
            [call(0, "write", 1), call(1, "read"), answer(1, 1), call(2, "read"), answer(2, 0)],
            False,
        ),
        ("a lost write is read", [call(0, "write", 1, lost=True), call(1, "read"), answer(1, 1)], True),
        ("a lost write is never read", [call(0, "write", 1, lost=True), call(1, "read"), answer(1, 0)], True),
        (
            "a lost write takes effect once",
            [
                call(0, "write", 1, lost=True),
                *(call(1, "read"), answer(1, 1), call(2, "write", 2), answer(2), call(3, "read"), answer(3, 1)),
            ],
            False,
        ),
        (
            "a lost write takes effect late",
            [
                call(0, "write", 1, lost=True),
                *(call(1, "write", 2), answer(1), call(2, "read"), answer(2, 2), call(3, "read"), answer(3, 1)),
            ],
            True,
        ),
        (
            "a deadline passes and the write comes after it",
            [
                call(0, "write", 1),
                answer(0, code=DEADLINE_EXCEEDED),
                *(call(1, "read"), answer(1, 0), call(2, "read"), answer(2, 1)),
            ],
            True,
        ),
        (
            "a write is read before its deadline passes",
            [call(0, "write", 1), call(1, "read"), answer(1, 1), answer(0, code=DEADLINE_EXCEEDED)],
            True,
        ),
        (
            "a write that was read before its deadline passed comes again",
            [
                *(call(0, "write", 1), call(1, "read"), answer(1, 1), answer(0, code=DEADLINE_EXCEEDED)),
                *(call(2, "write", 2), answer(2), call(3, "read"), answer(3, 1)),
            ],
            False,
        ),
        ("a value from nowhere", [call(0, "read"), answer(0, 2)], False),
        ("an answer to nothing", [answer(0, 0)], False),
        ("an answer comes twice", [call(0, "read"), answer(0, 0), answer(0, 0)], False),
        (
            "an answer that was right while the call was in flight",
            [call(0, "read"), call(1, "write", 1), answer(1), answer(0, 0)],
            True,
        ),
    ],
    ids=lambda one: one.replace(" ", "-") if isinstance(one, str) else "",
)
def test_histories_are_judged(says: str, events: list[Event], verdict: bool) -> None:  # noqa: ARG001, FBT001
    """Known histories get the verdict that they deserve."""
    assert accepted(events) is verdict


def test_a_state_is_known_again_by_what_it_is() -> None:
    """What an operation changes in a state does not depend on which of two equal states was asked about first."""
    first, second = int("1000"), int("1000")
    assert first is not second
    successors, read = Successors(REGISTER), ("read",)
    steps = successors.outcomes(first, read, ())
    assert (successors.effects(second, read, ()), successors.idle(second, read, ())) == ((), steps)
