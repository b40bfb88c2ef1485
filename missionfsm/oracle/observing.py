"""From the explanations before an event to those after it: what an event of each kind tells.

Messages and answers, which tell most, are in `missionfsm.oracle.receiving` and `missionfsm.oracle.answering`.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator

from attrs import evolve

from missionfsm.kernel.focus import ENDED
from missionfsm.kernel.history import Called, Cancelled, Driven, Ended, Received, Returned, Settled
from missionfsm.oracle import lenient
from missionfsm.oracle.answering import Answering
from missionfsm.oracle.explanation import (
    GONE,
    Explanation,
    InFlight,
    Names,
    channel_names,
    outlived,
    tidy,
    undrained,
    unify,
    with_lost,
)
from missionfsm.oracle.focusing import before_drive, before_message, before_settling
from missionfsm.oracle.middle import is_unknown
from missionfsm.oracle.receiving import Receiving
from missionfsm.oracle.successors import Seen, Successor, Successors
from missionfsm.oracle.symbols import Observer, Part
from missionfsm.oracle.unsaid import Unsaid


class Observing:
    """What becomes of explanations when something is observed.

    Args:
        successors: what one explanation can become.
        level: how much of what only a transport does is thought of: 0 nothing, 1 that streams end and messages are
            lost, 2 that the robot has restarted as well.

    Attributes:
        receiving: what becomes of them when a message comes.
    """

    def __init__(self, successors: Successors, level: int) -> None:
        self._successors = successors
        self._spec = successors.spec
        self._level = level
        self._unsaid = Unsaid(successors, level)
        self.receiving = Receiving(successors, level, self._unsaid)
        self._observers: dict[type, Observer[Iterator[Successor]]] = {
            Called: self._called,
            Returned: Answering(successors, level).returned,
            Received: self.receiving.received,
            Ended: self._ended,
            Cancelled: self._cancelled,
            Driven: self._driven,
            Settled: self._settled,
        }

    def explained(self, explanations: Iterable[Explanation], kind: type, *what: Part) -> Iterator[Successor]:
        """Explanations of an event, one by one, the nearest first, some of them more than once.

        Args:
            explanations: those of what was observed before.
            kind: the class of the event in `missionfsm.kernel.history`.
            what: its fields, with names as numbers (see `Explanation`).
        """
        return self._observers[kind](explanations, *what)

    def _called(
        self,
        explanations: Iterable[Explanation],
        request: Hashable,
        args: Names,
        lost: bool,  # noqa: FBT001 - a field of the event
        call: int,
    ) -> Iterator[Successor]:
        for explanation in explanations:
            if lost:
                yield Successor(explanation.replace(lost=with_lost(explanation.lost, request, args)))
            else:
                yield Successor(explanation.replace(calls=(*explanation.calls, InFlight(call, request, args))))

    def _ended(self, explanations: Iterable[Explanation], code: str, name: int) -> Iterator[Successor]:
        known: list[Explanation] = []
        others: list[Explanation] = []
        for explanation in explanations:
            (known if name in channel_names(explanation) else others).append(explanation)
        if self._spec.anywhere:  # it was opened before the log began
            yield from map(Successor, others)
        # A stream that nothing is known of yet is that of a call whose answer has not come.
        unknown = [one for one in others if not is_unknown(one)]
        if self._spec.closing is not None:
            yield from self._closed((*known, *unknown), name)
        about = before_message(self._successors, ENDED, name)
        for successor in (*map(Successor, known), *self._successors.closure(unknown, focus=about)):
            here = successor.explanation
            for own in _named_so(here, name):
                assumed = self._may_end(here, own, code)
                bound = unify(here, [(own, name)]) if assumed else None
                if bound:
                    rest = tuple(channel for channel in bound.channels if channel.name != name)
                    ended = bound.replace(assumed=assumed, channels=rest, gone=outlived(bound, (name,)))
                    yield Successor(tidy(ended), successor.rules)

    def _closed(self, explanations: Iterable[Explanation], name: int) -> Iterator[Successor]:
        """The explanations in which a step has closed the channel of that name, or closes it now.

        Where all of them have closed it, its name is carried no more.
        """
        assert self._spec.closing is not None  # noqa: S101 - the caller has looked
        for successor in self._successors.closure(explanations, focus=before_message(self._successors, ENDED, name)):
            here = successor.explanation
            if name == GONE or name in here.gone:
                yield Successor(undrained(here, name), successor.rules)
            for channel in here.channels:
                for step in self._spec.closing(here.state, channel.topic) if channel.name == name else ():
                    taken = self._successors.advance(here, step)
                    if taken:
                        yield Successor(tidy(undrained(taken[0], name)), successor.rules + step.rules)

    def _may_end(self, here: Explanation, name: int, code: str) -> int:
        """The readings under which the channels with a name may end so; 0 where they may not."""
        assumed = here.assumed
        for topic in (channel.topic for channel in here.channels if channel.name == name):
            assumes = self._spec.delivery(topic).ends.get(code)
            if self._spec.transport and (assumes is None or self._level):
                assumes = lenient.ends(code)
            assumed = self._successors.meet(assumed, assumes) if assumes is not None else 0
        return assumed

    def _cancelled(self, explanations: Iterable[Explanation], name: int) -> Iterator[Successor]:
        for explanation in explanations:
            rest = tuple(channel for channel in explanation.channels if channel.name != name)
            left = explanation
            if len(rest) < len(explanation.channels):
                left = explanation.replace(channels=rest, gone=outlived(explanation, (name,)))
            yield Successor(tidy(left))

    def _driven(self, explanations: Iterable[Explanation], event: Hashable, names: Names) -> Iterator[Successor]:
        drive = self._spec.drives[event.name]  # type: ignore[attr-defined]

        for successor in self._successors.closure(explanations, focus=before_drive(self._successors, event, names)):
            here = successor.explanation
            steps = drive.steps(here.state, event, tuple(here.ref(name) for name in names))
            for number, step in enumerate(steps):
                if number:  # the first is paid for with the explanation; what is worked out one by one may be many
                    self._successors.spend()
                taken = self._successors.advance(here, step, names)
                if taken:
                    yield Successor(tidy(taken[0]), successor.rules + step.rules)

    def _settled(self, explanations: Iterable[Explanation]) -> Iterator[Successor]:
        # What is urgent need not be what happened: a call or the surroundings may have come before it.
        about = before_settling(self._successors, self._unsaid)
        seen: Seen = {}
        todo = [Successor(explanation) for explanation in explanations]
        while todo:
            later: list[Successor] = []
            for successor in todo:
                here = successor.explanation
                if is_unknown(here):
                    yield successor
                    continue
                if self._successors.outdone(seen, here):
                    continue
                rests = () if self._successors.urgent(here.state) else tuple(self._unsaid.nothing_owed(here))
                for rest in rests:
                    yield Successor(self._calmed(rest), successor.rules)
                if here.assumed in (rest.assumed for rest in rests):
                    self._successors.rely()
                else:
                    silent = self._successors.silent(here, focus=about)
                    later += (Successor(one.explanation, successor.rules + one.rules) for one in silent)
            todo = later

    def _calmed(self, explanation: Explanation) -> Explanation:
        state, known = self._spec.calmed(explanation.state), explanation.all_known or self._spec.anywhere
        if state is explanation.state and known is explanation.all_known:
            return explanation
        return evolve(explanation, state=state, all_known=known)


def _named_so(explanation: Explanation, name: int) -> tuple[int, ...]:
    """The names under which the channel with an observed name may be known: its own, or any that nobody has seen."""
    names = dict.fromkeys(channel.name for channel in explanation.channels)
    return (name,) if name in names else tuple(one for one in names if one < GONE)
