"""What a spec says of states, calls and messages, remembered, so that it is worked out once."""

from __future__ import annotations

import operator
from collections.abc import Hashable, Iterable

from missionfsm.kernel.focus import Focus
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import UNCONSTRAINED, meet
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Match, Mismatch, Step
from missionfsm.kernel.terms import Refs, Request, State
from missionfsm.oracle.explanation import Owed
from missionfsm.oracle.memory import EACH_NAME, ENTRY, STEPS
from missionfsm.oracle.taking import changes

_EQUAL = (Match(),)
"""The one way in which equal answers agree."""


class Said:
    """What a spec says, remembered.

    But for `live` it holds caches and nothing that could change an answer. While it is `live`, nobody can be asked what
    comes later; it is said before the first question, since it decides which steps are told apart.

    Args:
        spec: the system.
        driven: the drives that a tester commands; what the others do may happen at any time by itself.
        assumed: what every explanation assumes; steps that contradict it are left out from the start.
        memory: of how many bytes it may take its share (see `missionfsm.oracle.memory`).
    """

    def __init__(self, spec: Spec, driven: Iterable[str], assumed: int, memory: int) -> None:
        self.spec = spec.decided(assumed) if spec.decided and assumed != UNCONSTRAINED else spec
        self.driven = frozenset(driven) - (spec.middle.undriven if spec.middle and spec.anywhere else frozenset())
        self.assumed = assumed
        self._room = memory // STEPS
        self.bytes = 0
        self.live = True
        self._outcomes: dict[Hashable, tuple[Step, ...]] = {}
        self._effects: dict[Hashable, tuple[Step, ...]] = {}
        self._idle: dict[Hashable, tuple[Step, ...]] = {}
        self._urgent: dict[Hashable, tuple[Step, ...]] = {}
        self._unseen: dict[Hashable, tuple[Step, ...]] = {}
        self._focused: dict[Hashable, tuple[Step, ...]] = {}
        self._matches: dict[Hashable, tuple[Match, ...] | Mismatch] = {}

    def forget(self) -> None:
        """Drop what the spec said; it will say the same again."""
        self.bytes = 0
        for memory in (
            self._outcomes,
            self._effects,
            self._idle,
            self._urgent,
            self._unseen,
            self._focused,
            self._matches,
        ):
            memory.clear()

    def outcomes(self, state: State, request: Request, refs: Refs) -> tuple[Step, ...]:
        """Every answer to a request in a state."""
        key = (state, request, refs)
        found = self._outcomes.get(key)
        if found is None:
            found = self._possible(state, self.spec.outcomes(state, request, refs))
            self._make_room(state, found)
            self._outcomes[key] = found
        return found

    def _make_room(self, state: State, steps: tuple[Step, ...]) -> None:
        """Count what is going to be remembered of a state; forget the rest where that becomes too much."""
        others = sum([step.after is not state for step in steps])
        self.bytes += ENTRY + (ENTRY + EACH_NAME * self.spec.names(state)) * others
        if self.bytes > self._room:
            self.forget()

    def _possible(self, state: State, steps: Iterable[Step]) -> tuple[Step, ...]:
        """Those steps that do not contradict what everybody assumes.

        Where the events are recorded, steps that nobody can tell apart become one; whoever chooses what is tried next
        sees them as they are.
        """
        possible = tuple([step for step in steps if meet(self.assumed, step.assumes)])
        indistinct = self.spec.abstraction.indistinct
        if indistinct is None or self.live:
            return possible
        merged = [step if step.after is state else indistinct(step) for step in possible]
        return possible if all(map(operator.is_, merged, possible)) else tuple(dict.fromkeys(merged))

    def effects(self, state: State, request: Request, refs: Refs) -> tuple[Step, ...]:
        """The outcomes of a request in a state that change something."""
        key = (state, request, refs)
        found = self._effects.get(key)
        if found is None:
            steps = self.outcomes(state, request, refs)
            found = self._effects[key] = tuple(step for step in steps if changes(state, step))
        return found

    def idle(self, state: State, request: Request, refs: Refs) -> tuple[Step, ...]:
        """The outcomes of a request in a state that have an answer and change nothing."""
        key = (state, request, refs)
        found = self._idle.get(key)
        if found is None:
            found = self._idle[key] = tuple(
                step
                for step in self.outcomes(state, request, refs)
                if step.answer is not None and step.applied and not changes(state, step)
            )
        return found

    def urgent(self, state: State) -> tuple[Step, ...]:
        """What must happen before things have settled."""
        found = self._urgent.get(state)
        if found is None:
            found = self._possible(state, self.spec.urgent(state))
            self._make_room(state, found)
            self._urgent[state] = found
        return found

    def unseen(self, state: State) -> tuple[Step, ...]:
        """What may happen at any time although nobody asked for it."""
        found = self._unseen.get(state)
        if found is None:
            steps = list(self.spec.spontaneous(state))
            for drive in self.spec.drives.values():
                if drive.name not in self.driven:
                    for event in drive.by_itself:
                        steps += drive.steps(state, event, ())
            found = self._possible(state, steps)
            self._make_room(state, found)
            self._unseen[state] = found
        return found

    def unseen_before(self, state: State, focus: Focus) -> tuple[Step, ...]:
        """What may happen without a call as far as what is observed next can tell, where the spec says that."""
        assert self.spec.silent_for is not None, "asked of such a spec"  # noqa: S101
        key = (state, focus)
        found = self._focused.get(key)
        if found is None:
            found = self._possible(state, self.spec.silent_for(state, focus))
            self._make_room(state, found)
            self._focused[key] = found
        return found

    def matches(self, owed: Owed, content: Hashable) -> tuple[Match, ...] | Mismatch:
        """The ways in which a message shows what is owed."""
        key = (owed.view, content)
        found = self._matches.get(key)
        if found is None:
            found = self._matches[key] = self.spec.matches(owed.view, content)
        return found

    def agreements(self, allowed: Answer, given: Answer) -> tuple[Match, ...]:
        """The ways in which an answer is the one that is allowed."""
        if allowed == given:
            return _EQUAL
        if self.spec.answers is None or (allowed.code, allowed.unordered) != (given.code, given.unordered):
            return ()
        key = (allowed, given)
        found = self._matches.get(key)
        if found is None:
            found = self._matches[key] = self.spec.answers(allowed.shape, given.shape)
        return () if isinstance(found, Mismatch) else found
