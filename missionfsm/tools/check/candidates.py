"""What could nearly have been in the place of an event, as values: candidates, and the problems that each has."""

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
"""How much it takes to forgive a reading that was ruled out, a name, and so on; what is likeliest meant takes least.

FAILED is what a call would have done that failed.
LEFT_OUT is a message that comes before one that is due earlier, UNOWED one after all that were owed, UNBEGUN one before
any is. To SHAPE and VALUE is added, from 0 to 9, how far what came is from what was due; to UNOWED, of a message that
shows something else than the last one, what that takes to be forgiven.
"""

PASSING = 1
"""How much more it takes to be meant by a message that need not come."""


@frozen
class AnsweredCall:
    """A call that was answered: what was asked about which names, and the answer."""

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
        rulings: ambiguity id and letter to the event that ruled it out.
        recent: the calls that were answered last, the latest last.
    """

    request: Request = None
    rulings: Mapping[tuple[str, str], Elimination] = {}
    recent: tuple[AnsweredCall, ...] = ()


@frozen
class Problem:
    """Something that an explanation would have to be forgiven to explain the event.

    Attributes:
        says: what it is, in words.
        rules: ids of the rules that are broken by it, the nearest first.
        weight: how much it takes to forgive it.
        since: ids of the rules that an event before speaks about, which this one contradicts.
        by_itself: whether it is wrong whatever happened before.
    """

    says: str
    rules: tuple[str, ...]
    weight: int
    since: tuple[str, ...] = ()
    by_itself: bool = False


@frozen(kw_only=True)
class Candidate:
    """A way in which the event could nearly be explained.

    Attributes:
        what: what would have been right in the place of the event, in words.
        rules: ids of the rules by which it would have been.
        assumes: the readings under which it would have been.
        problems: what it would have to be forgiven.
        allowed: whether it could have come.
        passing: whether it is a message that need not come.
        unseen: ids of the rules of what has happened unseen before it would have come.
        owed: the channel and what it owes, where it is a message that is due.
        early: whether something that happens at once has still to happen where it would have come.
        unusual: how many readings it assumes that are not those of the reference, though those could be followed.
        code: of an answer, its code.
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

    @property
    def weight(self) -> int:
        """How much it takes to forgive all of it; where that is equal, what assumes least is nearest."""
        return sum(problem.weight for problem in self.problems) + PASSING * self.passing + len(self.assumes)
