"""From explanations of what was observed so far to those of what is observed next: exact, and only once for each.

`TransitionFunction.step` is the transition function of the belief automaton: from all explanations before an
event to all explanations after it. `missionfsm.oracle.belief` walks that automaton and remembers it; what an event of
each kind tells is in `missionfsm.oracle.observing`.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator

from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.history import Received, Returned
from missionfsm.kernel.transport import REDELIVERED
from missionfsm.oracle import lenient, middle
from missionfsm.oracle.explanation import Explanation
from missionfsm.oracle.focusing import after_event
from missionfsm.oracle.observing import Observing
from missionfsm.oracle.receiving import numbered_so
from missionfsm.oracle.restarts import shows_restart
from missionfsm.oracle.subsumption import prune
from missionfsm.oracle.successors import Successor, Successors
from missionfsm.oracle.symbols import Arrival, Part


class TransitionFunction:
    """The transition function of the belief automaton.

    Args:
        successors: what one explanation can become.
        eager: whether what only a transport does, and what others do before an answer, is thought of at every event,
            not only where nothing else is left.

    Attributes:
        presumes: whether nothing but a restart that nobody has seen yet explains the event of the last step.
        beyond_system: whether the system itself does not explain it.
    """

    def __init__(self, successors: Successors, *, eager: bool = False) -> None:
        self.successors = successors
        self.spec = successors.spec
        self.eager = eager and self.reckons
        self.presumes = self.beyond_system = False
        self._observing, *self._lenient = (Observing(successors, level) for level in range(3))

    def step(self, explanations: Iterable[Explanation], kind: type, *what: Part) -> tuple[Successor, ...]:
        """Every explanation of what was observed before and of this event.

        Args:
            explanations: those of what was observed before.
            kind: the class of the event in `missionfsm.kernel.history`.
            what: its fields, with names as numbers (see `Explanation`).

        Raises:
            ExhaustedError: the event costs more than the budget.
        """
        self.successors.reset()
        explanations = tuple(explanations)
        about = after_event(self.successors, kind, *what)
        kept: tuple[Successor, ...] = ()
        if self.eager and self.spec.others and kind is Received:
            kept = prune(self.successors, self._where_known(explanations, *what), about)
        if not kept:
            found: Iterable[Successor] = self._observing.explained(explanations, kind, *what)
            if self.eager:
                found = (*found, *self._eagerly(explanations, kind, *what))
            kept = prune(self.successors, found, about)
        self.presumes, self.beyond_system = False, not kept
        for restarts, more in () if kept else self._beyond(explanations, kind, *what):
            if not kept:
                kept = prune(self.successors, more, about)
                self.presumes = restarts and kind is Returned and bool(kept)
        return kept

    @property
    def reckons(self) -> bool:
        """Whether something besides the system itself may explain an event."""
        return self.spec.transport or self.spec.anywhere or self.spec.others

    def beyond(
        self,
        explanations: Iterable[Explanation],
        kind: type,
        *what: Part,
    ) -> Iterator[Successor]:
        """Explanations of an event that the system itself does not explain, one by one; see `step`."""
        return itertools.chain.from_iterable(found for _, found in self._beyond(tuple(explanations), kind, *what))

    def restarting(
        self, explanations: Iterable[Explanation], kind: type, *what: Part, surely: bool = False
    ) -> Iterator[Successor]:
        """Explanations of an event before which the robot may have restarted, one by one.

        What is shown after that is owed then, and need not be looked for any further.

        Args:
            surely: whether those come first where it has restarted just before.
        """
        before = tuple(explanations)
        if kind is Received:
            after = self._restarted(before)
            yield from self._observing.receiving.received_at_once((*before, *after), *what)
            return
        if surely:  # what is silent may have come before it
            for one in self.successors.closure(before):
                yield from self._observing.explained(self._restarted((one.explanation,)), kind, *what)
        yield from self._observing.explained(before, kind, *what)
        if not surely:
            yield from self._observing.explained(self._restarted(before), kind, *what)

    def _restarted(self, explanations: Iterable[Explanation]) -> tuple[Explanation, ...]:
        return tuple(lenient.restarted(self.successors, self.spec, explanations))

    def _beyond(
        self,
        explanations: tuple[Explanation, ...],
        kind: type,
        *what: Part,
    ) -> Iterator[tuple[bool, Iterable[Successor]]]:
        """What may have become of things on their way, or a robot that has restarted, or somebody not in the log.

        The second is said with it. Whether a robot restarted before an answer, or somebody did something, only what is
        shown later can tell.
        """
        unforeseen = tuple(self._unforeseen(explanations, kind, *what)) if kind is Returned else ()
        for restarts, leniently in enumerate(self._lenient) if self.spec.transport else ():
            also = unforeseen if restarts else ()
            yield bool(restarts and not also), itertools.chain(leniently.explained(explanations, kind, *what), also)
        yield False, unforeseen or self._unforeseen(explanations, kind, *what)

    def _eagerly(self, explanations: tuple[Explanation, ...], kind: type, *what: Part) -> Iterator[Successor]:
        """What may have become of messages, or what somebody not in the log did that only later messages show.

        Where a list is empty and the number is 0, a restart may have made it so, whatever else may have.
        """
        if self.spec.transport:
            yield from self._lenient[0].explained(explanations, kind, *what)
            if kind is Received and shows_restart((kind, *what)):
                yield from self.restarting(explanations, kind, *what)
        if kind is Returned:
            yield from self._unforeseen(explanations, kind, *what)

    def _where_known(self, explanations: tuple[Explanation, ...], *what: Part) -> Iterator[Successor]:
        """Explanations of a message where the state is known; where it is not, it need not be what is shown.

        Where somebody has acted of whom only later messages tell, what others show is older, or fits by chance.
        """
        known = tuple(one for one in explanations if not middle.is_unknown(one))
        yield from self._observing.explained(known, Received, *what)
        yield from self._eagerly(known, Received, *what)
        yield from self._meanwhile(explanations, *what)

    def _meanwhile(self, explanations: tuple[Explanation, ...], *what: Part) -> Iterator[Successor]:
        """The explanations in which a message is older than what nothing is known of."""
        content, names, relations, channel = what
        assumed = numbered_so(self.spec, (one for one in relations if one != REDELIVERED))
        if assumed is not None:
            yield from middle.shown_meanwhile(self.successors, explanations, assumed, Arrival(channel, content, names))

    def _unforeseen(self, explanations: tuple[Explanation, ...], kind: type, *what: Part) -> Iterator[Successor]:
        """What somebody who is not in the log may have brought about, if there can be anybody."""
        if self.spec.anywhere or self.spec.others:
            relations = (one for one in what[2] if one != REDELIVERED) if kind is Received else ()
            assumed = numbered_so(self.spec, relations)
            if assumed is not None:
                yield from middle.unforeseen(self.successors, explanations, assumed, kind, *what)

    def is_hopeless(self, kind: type, *what: Part, leniently: bool = False) -> bool:
        """Whether an event is wrong whatever came before it: then nobody has to look at all of that.

        The number of a message goes against those before, or an answer cannot be read.

        Args:
            leniently: whether a message may come twice.
        """
        if kind is Returned:
            return isinstance(what[0].shape, Malformed) and not (self.spec.anywhere or self.spec.others)
        if kind is not Received or (leniently and self.spec.transport and REDELIVERED in what[2]):
            return False
        relations = [one for one in what[2] if one not in ("equal", REDELIVERED)]
        return numbered_so(self.spec, relations) is None

    def explained(self, explanations: Iterable[Explanation], kind: type, *what: Part) -> Iterator[Successor]:
        """Explanations of an event, one by one, the nearest first, some of them more than once; see `step`.

        What only a transport does is left out.
        """
        return self._observing.explained(explanations, kind, *what)
