"""The belief automata of a run: one that assumes nothing, and one that assumes the readings that are left."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import define

from missionfsm.kernel.readings import meet
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.conform.conversation import Conversation

WIDE = 48
"""With more explanations than that, the next conversation assumes the readings that are left."""


@define(eq=False)
class Narrowing:
    """Which automaton judges a conversation.

    If a conversation has many explanations, those after it are judged by an automaton that assumes the readings that
    are left. A conversation that is not explained there may still be explained by itself.

    Attributes:
        wide: the automaton that assumes no more than was asked for.
        narrow: the automaton that assumes the readings that are left, if there is one.
        widest: the most explanations that a conversation has had since the automaton was chosen.
    """

    wide: Automaton
    narrow: Automaton | None = None
    widest: int = 0
    _before: dict[str, int] | None = None

    @property
    def current(self) -> Automaton:
        """The one that judges now."""
        return self.narrow or self.wide

    @property
    def asked_for(self) -> dict[str, str]:
        """The letters that were left at the start, for each ambiguity of which some were excluded then."""
        left = {one: one.possible(self.wide.assumed) for one in self.wide.spec.ambiguities}
        return {one.id: "".join(letters) for one, letters in left.items() if len(letters) < len(one.readings)}

    def look(self, conversation: Conversation) -> None:
        """Take into account how many explanations a conversation has."""
        self.widest = max(self.widest, len(conversation.judge.belief.node.explanations))

    @property
    def unwatched(self) -> bool:
        """Whether the implementation may do by itself what nobody commands."""
        return not self.wide.successors.driven.issuperset(self.wide.spec.drives)

    def is_lost_in(self, conversation: Conversation) -> bool:
        """Whether an implementation that moves by itself has too many explanations to be followed further."""
        return self.unwatched and len(conversation.judge.belief.node.explanations) > WIDE

    def choose(self, readings: Mapping[str, tuple[str, ...]], *, at_once: bool = False) -> Automaton:
        """The automaton for the next conversation.

        Args:
            readings: those that are left.
            at_once: assume them, however few explanations there are.
        """
        if self.widest > WIDE or at_once:
            self.widest = 0
            ambiguities = self.wide.spec.ambiguities
            assumed = meet(self.wide.assumed, (one[readings[one.id]] for one in ambiguities if readings.get(one.id)))
            if assumed and assumed != self.current.assumed:
                self.drop()
                self.narrow = Automaton(self.wide.spec, self.wide.successors.driven, assumed)
        return self.current

    def drop(self) -> None:
        """Give up the narrow automaton. The rules that were exercised in it still count."""
        if self.narrow is not None:
            self._before = _added(self._before or {}, self.narrow.exercised())
            self.narrow = None

    def exercised(self) -> dict[str, int]:
        """How often each rule was exercised, in all automata that were walked."""
        found = _added(self._before or {}, self.wide.exercised())
        return _added(found, self.narrow.exercised()) if self.narrow is not None else found


def _added(times: Mapping[str, int], others: Mapping[str, int]) -> dict[str, int]:
    found = dict(times)
    for rule, count in others.items():
        found[rule] = found.get(rule, 0) + count
    return found
