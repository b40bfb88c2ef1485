"""The oracle against the same thing written down without any cleverness: they must agree on every next event."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

import pytest
from attrs import frozen
from bruteforce import BruteForce
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from toys import FLAKY_LAMP, LAMP, NEWS, PLAIN_TICKETS, REGISTER, TICKETS, Event

from missionfsm.kernel import history
from missionfsm.kernel.history import Answer, Called, Cancelled, Driven, Ended, Name, Received, Returned, Settled
from missionfsm.kernel.rules import (
    DEADLINE_EXCEEDED,
    FAILED_PRECONDITION,
    NOT_FOUND,
    OK,
    RESOURCE_EXHAUSTED,
    UNAVAILABLE,
)
from missionfsm.kernel.spec import Spec
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief

NAMES = ("x", "y", "z")
STREAMS: tuple[Name, ...] = (("stream", 1), ("stream", 2))
MOST = 1_500
"""A conversation with so many configurations is not followed further."""
DEADLINE = (Answer(DEADLINE_EXCEEDED), 0)

Requests = dict[tuple[object, ...], tuple[int, tuple[tuple[Answer, int], ...]]]
"""Every request with the number of names that it takes, and its answers with the number of theirs."""


@frozen(eq=False)
class Alphabet:
    """What may be observed of a toy.

    Attributes:
        requests: what may be asked, and answered.
        contents: of messages, each with the number of names.
        marks: the numbers that a message may carry.
    """

    name: str
    spec: Spec
    worlds: tuple[object, ...]
    requests: Requests
    contents: tuple[tuple[object, int], ...] = ()
    drives: tuple[Event, ...] = ()
    ends: tuple[str, ...] = ()
    marks: tuple[int, ...] = ()
    calls: int = 3

    @property
    def driven(self) -> frozenset[str]:
        """The drives that a tester commands."""
        return frozenset(event.name for event in self.drives)


def _answers(codes: tuple[str, ...] = (), *shapes: object) -> tuple[tuple[Answer, int], ...]:
    return (*((Answer(OK, shape=shape), 0) for shape in shapes), *((Answer(code), 0) for code in codes))


REGISTERS = Alphabet(
    "register",
    REGISTER,
    (0,),
    {
        ("write", 1): (0, (*_answers((), None), DEADLINE)),
        ("write", 2): (0, (*_answers((), None), DEADLINE)),
        ("swap", 1, 2): (0, (*_answers((), *(True, False)), DEADLINE)),
        ("read",): (0, _answers((), 0, 1, 2)),
    },
    calls=5,
)

_TICKET_REQUESTS: Requests = {
    ("take", "red"): (0, ((Answer(OK), 1), (Answer(RESOURCE_EXHAUSTED), 0), DEADLINE)),
    ("take", "blue"): (0, ((Answer(OK), 1), DEADLINE)),
    ("drop",): (1, ((Answer(OK), 0), (Answer(NOT_FOUND), 0), (Answer(FAILED_PRECONDITION), 0))),
    ("peek",): (1, (*_answers((NOT_FOUND,), "red", "blue"),)),
    ("clear",): (0, tuple((Answer(OK, unordered=True), size) for size in range(4))),
    ("watch",): (0, ((Answer(OK), -1),)),
}
_BOARDS = (((), 0), (("red",), 1), (("blue",), 1), (("red", "blue"), 2), (("blue", "red"), 2), (("red", "red"), 2))
PLAIN = Alphabet("plain tickets", PLAIN_TICKETS, ((), ("red", "blue")), _TICKET_REQUESTS, _BOARDS)
SERVED = Alphabet("tickets", TICKETS, ((), ("red", "blue")), _TICKET_REQUESTS, _BOARDS, calls=3)
DRIVEN = Alphabet("driven tickets", TICKETS, ((), ("red", "blue")), _TICKET_REQUESTS, _BOARDS, (Event("serve"),))

_LAMP_REQUESTS: Requests = {
    ("press",): (0, (*_answers((FAILED_PRECONDITION, UNAVAILABLE), None), DEADLINE)),
    ("look",): (0, _answers((), "off", "warming", "on", "dead")),
    ("unplug",): (0, _answers((), None)),
    ("watch", "lamp"): (0, ((Answer(OK), -1),)),
    ("watch", "all"): (0, ((Answer(OK), -1),)),
}
_LIGHTS = (("off", 0), ("warming", 0), ("on", 0), ("dead", 0), ("click", 0))
_ENDS = (UNAVAILABLE, OK)
LAMPS = Alphabet("lamp", LAMP, ("off",), _LAMP_REQUESTS, _LIGHTS, (Event("nudge"),), _ENDS, (1, 2), calls=3)
FLAKY = Alphabet("flaky lamp", FLAKY_LAMP, ("off",), _LAMP_REQUESTS, _LIGHTS, (Event("nudge"),), _ENDS, calls=3)

_NEWS_REQUESTS: Requests = {
    ("flip", "left"): (0, _answers((), None)),
    ("flip", "right"): (0, _answers((), None)),
    ("hint",): (0, _answers((), None)),
    ("watch",): (0, ((Answer(OK), -1),)),
}
_HEADLINES = tuple(((side, what), 0) for side, whats in (("left", (0, 1, "hint")), ("right", (0, 1))) for what in whats)
PAPERS = Alphabet("news", NEWS, (0,), _NEWS_REQUESTS, _HEADLINES, ends=(UNAVAILABLE,), calls=4)


class Conversation:
    """What was called so far: decides which events make sense next."""

    def __init__(self, alphabet: Alphabet) -> None:
        self.alphabet = alphabet
        self.called = 0
        self.pending: dict[Name, tuple[object, ...]] = {}
        self.seen: dict[Name, None] = {}

    @property
    def known(self) -> list[Name]:
        """The names of tickets that were seen: whoever asks for one has seen it."""
        return [name for name in self.seen if name in NAMES]

    def sorts(self) -> list[list[history.Event]]:
        """Every event that may be tried next, by sort."""
        a = self.alphabet
        sorts: list[list[history.Event]] = [[Settled()]]
        if self.called < a.calls:
            name = ("call", self.called)
            for lost in (False, True):
                sorts += [
                    [
                        Called(name, request, names, lost)
                        for request, (size, _) in a.requests.items()
                        for names in itertools.permutations(self.known, size)
                    ]
                ]
        sorts += (
            [Returned(name, *answer) for answer in self.answers(request)] for name, request in self.pending.items()
        )
        contents = [(content, names) for content, size in a.contents for names in itertools.permutations(NAMES, size)]
        for stream in STREAMS:
            marks: list[tuple[history.Mark, ...]] = [(("", mark),) for mark in a.marks] or [()]
            sorts.append([Received(stream, *what, mark) for what in contents for mark in marks])
        sorts.append([Driven(event) for event in a.drives])
        sorts.append([Ended(stream, code) for stream in STREAMS for code in a.ends])
        sorts.append([Cancelled(stream) for stream in STREAMS if stream in self.seen])
        return [sort for sort in sorts if sort]

    def answers(self, request: tuple[object, ...]) -> Iterator[tuple[Answer, tuple[Name, ...]]]:
        """Everything that a request might be answered."""
        for answer, size in self.alphabet.requests[request][1]:
            for names in itertools.permutations(NAMES, size) if size >= 0 else ((stream,) for stream in STREAMS):
                yield answer, names

    def note(self, event: history.Event) -> None:
        """That this happened."""
        if isinstance(event, Called):
            self.called += 1
            if not event.lost:
                self.pending[event.call] = event.request  # type: ignore[assignment]
        elif isinstance(event, Returned):
            del self.pending[event.call]
            self.seen |= dict.fromkeys(event.names)
        elif isinstance(event, Received):
            self.seen |= dict.fromkeys((event.channel, *event.names))


def replayed(automaton: Automaton, world: object, events: list[history.Event]) -> Belief:
    """A belief that observed these events."""
    belief = Belief(automaton, world)
    for event in events:
        belief.observe(event)
    return belief


def choices(alphabet: Alphabet, belief: Belief) -> set[tuple[str, ...]]:
    """The full choices of readings that some explanation still allows."""
    return {
        choice
        for one in belief.node.explanations
        for choice in itertools.product(*(each.possible(one.assumed) for each in alphabet.spec.ambiguities))
    }


def check(alphabet: Alphabet, automaton: Automaton, data: st.DataObject, steps: int = 9) -> None:
    """Walk a random history that is explained, and compare all events that could come at every point of it."""
    world = data.draw(st.sampled_from(alphabet.worlds))
    slow = BruteForce(alphabet.spec, world, alphabet.driven)
    conversation = Conversation(alphabet)
    events: list[history.Event] = []
    for _ in range(steps):
        sorts = conversation.sorts()
        explained: list[list[history.Event]] = []
        for sort in sorts:
            right = [event for event in sort if slow.explains(event)]
            fast = [event for event in sort if replayed(automaton, world, events).observe(event)]
            assert (events, fast) == (events, right)
            if right:
                explained.append(right)
        if not explained or sum(map(len, slow.closed.values())) > MOST:
            return
        event = data.draw(st.sampled_from(data.draw(st.sampled_from(explained))))
        events.append(event)
        conversation.note(event)
        slow.observe(event)
        belief = replayed(automaton, world, events)
        assert (events, choices(alphabet, belief)) == (events, slow.choices)


ALPHABETS = (REGISTERS, PLAIN, SERVED, DRIVEN, LAMPS, FLAKY, PAPERS)


@pytest.mark.parametrize("alphabet", ALPHABETS, ids=lambda one: one.name)
def test_the_belief_accepts_what_brute_force_accepts(alphabet: Alphabet) -> None:
    """On every event that could come next, at every point of a history, the belief decides as brute force does."""
    automaton = Automaton(alphabet.spec, alphabet.driven)

    @settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
    @given(st.data())
    def compare(data: st.DataObject) -> None:
        check(alphabet, automaton, data)

    run: Callable[[], None] = compare
    run()
