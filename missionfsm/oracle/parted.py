"""The belief of a system that falls into parts which do not touch one another: a belief for each part.

What is observed of one robot of a fleet says nothing about another one, but for the readings that both follow. One
belief over all would multiply what each may be doing; a belief for each adds it up. An event goes to the part that it
is about, or to all.

The readings that the parts leave are met: where no reading of some ambiguity is left to all of them, nothing explains
what was observed. That is exact for each ambiguity taken by itself. Where one part leaves (a, a) and (b, b) of two
ambiguities and another one (a, b) and (b, a), nothing is left to both, and that is not noticed: what is accepted is
never less than it should be.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable

from missionfsm.kernel.history import Called, Event, Name, Returned
from missionfsm.kernel.readings import UNCONSTRAINED
from missionfsm.kernel.spec import Parting, Spec
from missionfsm.oracle.automaton import Automaton, Node
from missionfsm.oracle.belief import Belief


class Parted:
    """Where one observed conversation stands, for each part by itself.

    Args:
        spec: the system; it has a `parting`.
        world: where it begins.
        driven: names of the drives that a tester commands.
        assumed: readings that are decided from the start.
        budget: how many explanations a single event may cost a part.

    Attributes:
        beliefs: the belief of each part.
        of_last_event: that of the part which the last event was about; of the one that did not explain it, where one
            did not.
        broken: whether nothing explains what was observed.
        presumed: as that of a belief; no part presumes anything.
    """

    presumed: Belief | None = None

    def __init__(self, spec: Spec, world: object, driven: Iterable[str], assumed: int, budget: int) -> None:
        parting = spec.parting
        assert parting is not None, "whoever asks for parts knows that there are some"  # noqa: S101
        driven = tuple(driven)
        self._parting: Parting = parting
        self.spec = spec
        self.beliefs: dict[Hashable, Belief] = {
            part: Belief(Automaton(parting.part(spec, part), driven, assumed, budget), world)
            for part in parting.parts(world, frozenset(driven))
        }
        self._calls: dict[Name, Hashable] = {}
        self._left: dict[Hashable, int] = {}
        self._common = UNCONSTRAINED
        self.of_last_event = next(iter(self.beliefs.values()))
        self.broken = False

    def nothing_is_late(self) -> None:
        """From now on nothing that was on its way when the log began explains an event."""
        for belief in self.beliefs.values():
            belief.nothing_is_late()

    def observe(self, event: Event) -> bool:
        """Take one event into account; False when nothing explains it.

        Raises:
            ExhaustedError: it costs too much to decide.
        """
        if self.broken:
            return False
        if type(event) is Returned and event.call in self._calls:
            part: Hashable = self._calls.pop(event.call)
        else:
            part = self._parting.whose(event)
            if part is not None and type(event) is Called:
                self._calls[event.call] = part
        if part is not None and part not in self.beliefs:
            part = next(iter(self.beliefs))  # nobody knows it: any of them says so
        for one in list(self.beliefs) if part is None else [part]:
            self.of_last_event = belief = self.beliefs[one]
            if not (belief.observe(event) and self._meet(one, belief)):
                self.broken = True
                return False
        return True

    def _meet(self, part: Hashable, belief: Belief) -> bool:
        """Whether every ambiguity has a reading left that all parts may follow."""
        left = belief.left
        if self._left.get(part, UNCONSTRAINED) == left:
            return True
        self._left[part] = left
        self._common &= left
        return all(self._common & ambiguity.group for ambiguity in self.spec.ambiguities)

    @property
    def awaits(self) -> bool:
        """Whether more has to be seen of some part before everything was, unless something was lost on the way."""
        return any(belief.awaits for belief in self.beliefs.values())

    @property
    def node(self) -> Node:
        """Where the part stands that the last event was about."""
        return self.of_last_event.node

    def name(self, number: int) -> Name | None:
        """The observed name with a number, to the part that the last event was about."""
        return self.of_last_event.name(number)

    @property
    def left(self) -> int:
        """The bits of all readings that every part may still follow."""
        return self._common

    @property
    def readings(self) -> dict[str, tuple[str, ...]]:
        """For every ambiguity that mattered so far: the readings that every part may still follow."""
        mattered = {name for belief in self.beliefs.values() for name in belief.readings}
        return {one.id: one.possible(self._common) for one in self.spec.ambiguities if one.id in mattered}

    @property
    def ways(self) -> list[int]:
        """What is assumed in each of the ways in which all of it can have come about, as far as that is told apart."""
        return [self._common]

    @property
    def exercised(self) -> dict[str, int]:
        """How often each rule was exercised."""
        times: dict[str, int] = {}
        for belief in self.beliefs.values():
            for rule, count in belief.automaton.exercised().items():
                times[rule] = times.get(rule, 0) + count
        return times
