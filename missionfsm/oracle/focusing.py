"""What is observed, seen from what is to explain it: what a search for silent steps before it has in mind."""

from __future__ import annotations

from collections.abc import Hashable

from missionfsm.kernel.focus import DRIVEN, RECEIVED, RETURNED, SETTLED, Focus, Kind
from missionfsm.kernel.history import Answer, Driven, Ended, Received
from missionfsm.kernel.terms import Refs
from missionfsm.oracle.explanation import GONE, Explanation, Names
from missionfsm.oracle.successors import FocusOf, Successors
from missionfsm.oracle.symbols import Part
from missionfsm.oracle.unsaid import Unsaid


def after_event(successors: Successors, kind: type, *what: Part) -> FocusOf:
    """What was observed by an event; of an answer no part is told more than before."""
    if kind is Driven:
        return before_drive(successors, *what)
    return before_message(successors, RECEIVED, what[-1]) if kind in (Received, Ended) else before_rest(successors)


def before_rest(successors: Successors) -> FocusOf:
    """That everything settles."""

    def about(here: Explanation) -> Focus:
        return Focus(SETTLED, calls=_in_flight(successors, here))

    return about


def before_settling(successors: Successors, unsaid: Unsaid) -> FocusOf:
    """The same where it has just been observed: channels that owe something yet have to be rid of it first."""

    def about(here: Explanation) -> Focus:
        topics = tuple(one.topic for one in here.channels if unsaid.keeps_from_rest(one))
        return Focus(SETTLED, topics=topics, calls=_in_flight(successors, here))

    return about


def before_drive(successors: Successors, event: Hashable, names: Names) -> FocusOf:
    """That the surroundings do something."""

    def about(here: Explanation) -> Focus:
        return Focus(DRIVEN, event, tuple(map(here.ref, names)), calls=_in_flight(successors, here))

    return about


def before_message(successors: Successors, kind: Kind, name: int) -> FocusOf:
    """That something comes on a channel of that name, or on one whose name is not known yet."""

    def about(here: Explanation) -> Focus:
        topics = tuple(one.topic for one in here.channels if one.name == name or one.name < GONE)
        opened = any(one.name == name for one in here.channels)
        return Focus(kind, topics=topics, calls=_in_flight(successors, here), aside=opened)

    return about


def before_answer(successors: Successors, call: int, answer: Answer) -> FocusOf:
    """That a call is answered."""

    def about(here: Explanation) -> Focus:
        asked = next(one for one in here.calls if one.name == call)
        refs = successors.refs(here, asked.args)
        aside = successors.only_opens(here, asked)
        return Focus(
            RETURNED, asked.request, refs, answer, calls=_in_flight(successors, here, besides=call), aside=aside
        )

    return about


def _in_flight(
    successors: Successors, here: Explanation, besides: int | None = None
) -> tuple[tuple[Hashable, Refs], ...]:
    """The calls that may still take effect, with the positions of their names."""
    return tuple(
        (one.request, successors.refs(here, one.args)) for one in here.calls if one.done is None and one.name != besides
    )
