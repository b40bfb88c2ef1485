"""What could have come instead of an event, as values: candidates, and the problems that each has."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

from missionfsm.kernel.history import Answer, Name
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.terms import Request
from missionfsm.oracle.explanation import Channel, Owed
from missionfsm.tools.check.eliminations import Elimination
from missionfsm.tools.check.phrases import answer_words, described, name_words

READING, LEFT_OUT, NAME, FAILED, UNDRIVEN, SHAPE, UNOWED, VALUE, UNBEGUN, CODE = 2, 3, 4, 5, 6, 10, 30, 40, 50, 60
ELSE = 90
"""The weights of problems: a reading that was ruled out, a wrong name, and so on. The likeliest mistake weighs least.

FAILED: the message shows what a call would have done that failed. UNDRIVEN: it shows what a drive would have done that
nobody commanded. LEFT_OUT: it comes before a message that is due earlier. UNOWED: nothing is owed any more, UNBEGUN:
nothing is owed yet. ELSE: what it shows of one thing is not due of another either. SHAPE and VALUE grow by 0 to 9 with
the distance between what came and what was due; UNOWED grows by the weight of what is wrong with a message that shows
something else than the last one.
"""

PASSING = 1
"""The additional weight of a message that need not come."""


@frozen
class AnsweredCall:
    """A call that was answered: the request and the names in it, the answer and the names in that."""

    request: Request
    about: tuple[Name, ...]
    answer: Answer
    names: tuple[Name, ...]

    def words(self, spec: Spec) -> str:
        """The call and its answer in a few words."""
        return f"{described(spec, self.request)} → {answer_words(self.answer, tuple(map(name_words, self.names)))}"


@frozen
class Circumstances:
    """What is known of a conversation besides its belief.

    Attributes:
        request: what was asked, if the event is an answer.
        eliminations: for each ambiguity id and letter that was ruled out, the event that did it.
        recent: the last calls that were answered, the latest last.
    """

    request: Request = None
    eliminations: Mapping[tuple[str, str], Elimination] = {}
    recent: tuple[AnsweredCall, ...] = ()


@frozen
class Problem:
    """A reason why an explanation does not explain the event.

    Attributes:
        says: what it is, in words.
        rules: ids of the rules that it breaks, the nearest first.
        weight: how bad it is.
        since: ids of the rules of an earlier event that this one contradicts.
        by_itself: whether it is wrong whatever happened before.
    """

    says: str
    rules: tuple[str, ...]
    weight: int
    since: tuple[str, ...] = ()
    by_itself: bool = False


@frozen(kw_only=True)
class Candidate:
    """What could have come instead of the event, and the problems that keep the event from being that.

    Attributes:
        what: what would have been right, in words.
        rules: ids of the rules that justify it.
        assumes: the readings under which it is right.
        problems: what keeps the event from being it.
        allowed: whether it could have come; False if only its problems are of interest.
        passing: whether it is a message that need not come.
        unseen: ids of the rules of the steps that happened unseen before it.
        owed: for a message that is due, the channel and what it owes.
        early: whether an urgent step has still to happen at that point.
        unusual: how many readings it assumes that are not those of the reference, although those could be followed.
        code: the code, if it is an answer.
        departs: whether it assumes a reading that departs from the text.
    """

    what: str = ""
    rules: tuple[str, ...] = ()
    assumes: tuple[str, ...] = ()
    problems: tuple[Problem, ...] = ()
    allowed: bool = True
    passing: bool = False
    unseen: tuple[str, ...] = ()
    owed: tuple[Channel, Owed] | None = None
    early: bool = False
    unusual: int = 0
    code: str = ""
    departs: bool = False

    @property
    def weight(self) -> int:
        """How bad all of its problems are; of equals, the one that assumes least is nearest."""
        return sum(problem.weight for problem in self.problems) + PASSING * self.passing + len(self.assumes)
