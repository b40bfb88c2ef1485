"""What only a transport explains: streams that end, messages that are lost or come twice, robots that restart.

`missionfsm.oracle.transition` asks for it only where nothing else is left, so that it costs nothing where it is not
needed and explains nothing that something else explains. Each way assumes a reading of `missionfsm.kernel.transport`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from attrs import evolve

from missionfsm.kernel.middle import ANY
from missionfsm.kernel.readings import Assumption, meet
from missionfsm.kernel.rules import FAILED_PRECONDITION
from missionfsm.kernel.spec import Failure, Spec
from missionfsm.kernel.transport import ENDS, MADE_BY_CLIENTS, TOO_OLD, TR_01, TR_02, TR_03, TR_04, TR_05, TR_06
from missionfsm.oracle.explanation import Channel, Explanation, Owed, tidy
from missionfsm.oracle.successors import Successor, Successors

LOSES = TR_03["b"]
"""That messages are lost."""
_RENEWED = frozenset({"zero", "first"})
"""How the number of the first message after a restart may compare with those before."""


def ends(code: str) -> tuple[Assumption, ...] | None:
    """What is assumed where a stream ends with a status that its page does not list; None for one that is not made up.

    A status that clients make by themselves may end a stream as it may be the answer to a call.
    """
    if code in ENDS:
        return (TR_01["b"],)
    return (TR_04["b"],) if code in MADE_BY_CLIENTS else None


def too_old(spec: Spec, operation: str, code: str) -> Failure | None:
    """That a robot refuses a call which its software does not know yet; None where that is not how it would."""
    return TOO_OLD if code == FAILED_PRECONDITION and operation in spec.added else None


def up_to_date(successors: Successors, explanations: Iterable[Explanation], call: int) -> Iterator[Explanation]:
    """The explanations where a call has succeeded: software that knows one of those that came later knows them all."""
    for explanation in explanations:
        asked = next((one.request for one in explanation.calls if one.name == call), None)
        if asked is None or successors.spec.request_operation(asked) not in successors.spec.added:
            yield explanation
            continue
        assumed = successors.meet(explanation.assumed, (TR_06["a"],))
        if assumed:
            yield explanation.replace(assumed=assumed)


def redelivered(explanations: Iterable[Explanation], channel: int) -> Iterator[Successor]:
    """The explanations in which a message came twice, after which everything is as before."""
    for explanation in explanations:
        assumed = meet(explanation.assumed, (TR_02["b"],))
        if assumed and any(one.name == channel and one.last for one in explanation.channels):
            yield Successor(explanation.replace(assumed=assumed))


def given_up(channel: Channel) -> Channel:
    """The channel whose messages were lost: what was to be seen last counts as seen, so that nothing older can come."""
    last = channel.owed[-1]
    return Channel(channel.name, channel.topic, Owed(last.view, last.names))


def restarted(
    successors: Successors, spec: Spec, explanations: Iterable[Explanation], relations: tuple[str, ...] = ("first",)
) -> Iterator[Explanation]:
    """The explanations in which the robot has restarted; a channel that goes on shows that first.

    Args:
        relations: how the numbers of the message that is to be explained compare with those before.
    """
    if spec.restarted is None or _RENEWED.isdisjoint(relations):
        return
    for explanation in explanations:
        assumed = meet(explanation.assumed, (TR_05["b"],))
        step = spec.restarted(explanation.state) if assumed else None
        taken = step and successors.advance(explanation.replace(assumed=assumed), step)
        if taken:
            after = taken[0]
            yield tidy(after.replace(channels=tuple(map(_renewed, after.channels))))


def _renewed(channel: Channel) -> Channel:
    """The channel, whose last message shows the restart; what is known to have been on its way may still come."""
    if not channel.owed:  # a stream that has ended is shown nothing
        return channel
    *before, last = channel.owed
    known = (evolve(one, passing=True) for one in before if one.view is not ANY)
    return Channel(channel.name, channel.topic, None, (*known, last))


def skips(channel: Channel, otherwise: Assumption | None) -> Assumption | None:
    """Under what a channel passes over what it owes: it was lost, but for the first message, which shows the state."""
    return LOSES if channel.last else otherwise


__all__ = ["LOSES", "ends", "given_up", "redelivered", "restarted", "skips", "too_old", "up_to_date"]
