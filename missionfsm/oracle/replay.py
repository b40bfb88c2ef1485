"""What a search through calls has found, told event by event: which rules each exercises, and where it all leads."""

from __future__ import annotations

from attrs import define

from missionfsm.oracle.calls import ANSWERED, SENT, CallSearch, Standing
from missionfsm.oracle.explanation import Explanation, InFlight, Ready, with_lost, without_lost
from missionfsm.oracle.kinds import Kind

Rules = tuple[str, ...]


@define(eq=False, slots=True)
class _Flight:
    """A call in flight.

    Attributes:
        name: its number.
        kind: what it asks for, and is answered.
        ready: what it could have been answered without effect so far, or is given up with; if its answer is not known.
        idle: the rules by which it could have been answered as it is, without effect; None where it could not.
        done: what it is answered, once it has taken effect.
    """

    name: int
    kind: Kind
    ready: tuple[Ready, ...] = ()
    idle: Rules | None = None
    done: Ready | None = None


class Replay:
    """The order that a search has found, told again.

    Args:
        search: the search.
        end: where it stands behind all events.

    Attributes:
        start: the explanation of what was before the events.
        exercised: of each event the rules that it exercises.
        explanation: the explanation of all of them.
    """

    def __init__(self, search: CallSearch, end: Standing) -> None:
        self._kinds = search.kinds
        self._search = search
        self.start = start = search.start
        self._state, self._lost = start.state, start.lost
        self._flights: dict[int, _Flight] = {}
        for call, (bit, kind) in zip(start.calls, search.before, strict=True):
            ready = self._kinds.ready(call, kind)
            self._flights[bit] = _Flight(call.name, kind, call.ready, ready.rules if ready else None, call.done)
        steps: list[Standing] = []
        node: Standing | None = end
        while node is not None:
            if node.step is not None:
                steps.append(node)
            node = node.before
        self.exercised = self._exercised(steps)
        calls = tuple(InFlight(one.name, one.kind.request, (), one.ready, one.done) for one in self._flights.values())
        self.explanation = Explanation(
            self._state, assumed=start.assumed, calls=calls, lost=self._lost, all_known=start.all_known
        )

    def _exercised(self, steps: list[Standing]) -> list[Rules]:
        """Tell all events; `steps` are what takes effect before them, the last first."""
        found: list[Rules] = []
        for at, (event, bit, kind) in enumerate(self._search.moments):
            rules: Rules = ()
            while steps and steps[-1].since == at:
                rules += self._taken(steps.pop())
            if event == ANSWERED:
                rules += self._answered(self._flights.pop(bit))
            elif event == SENT:
                self._flights[bit] = _Flight(self._search.symbols[at][4], kind)
            else:
                self._lost = with_lost(self._lost, kind.request, ())
            found.append(rules)
        return found

    def _answered(self, flight: _Flight) -> Rules:
        """The rules by which a call is answered."""
        if flight.done:
            return flight.done.rules
        return self._kinds.effects(self._state, flight.kind).rules if flight.idle is None else flight.idle

    def _taken(self, node: Standing) -> Rules:
        """Tell that a call takes effect, or a lost one of a kind: those in flight remember what they could be answered.

        It is told in the end with which answer it did.
        """
        state, step, kinds = self._state, node.step, self._kinds
        assert step is not None and step.answer is not None, "calls are answered"  # noqa: S101, PT018
        if step.after is not state:
            for flight in self._flights.values():
                if flight.done is None:
                    self._notice(flight)
        if node.by < 0:
            request = self._search.lost[-1 - node.by].request
            position = next(at for at, (known, *_) in enumerate(self._lost) if known == request)
            self._lost = without_lost(self._lost, position)
        else:
            taken = self._flights[node.by]
            taken.done = Ready(step.answer, (), (), step.rules)
            taken.ready = ()
            if taken.kind.answer is None:
                call = InFlight(taken.name, taken.kind.request, ())
                taken.ready = tuple(kinds.successors.late_answers(Explanation(state), call, ()))
        self._state = step.after
        return step.rules

    def _notice(self, flight: _Flight) -> None:
        """Remember what a call could be answered without effect now."""
        effects = self._kinds.effects(self._state, flight.kind)
        if flight.kind.answer is not None:
            flight.idle = effects.rules if flight.idle is None and effects.idle else flight.idle
        elif effects.ready and effects.ready != flight.ready:
            flight.ready = tuple(dict.fromkeys((*flight.ready, *effects.ready)))
