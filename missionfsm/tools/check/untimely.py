"""A message that shows what a call has done that was answered OK, and had to be refused.

Where nobody says what a system does by itself, an answer OK is explained by something that has happened unseen: the
mission before has ended, so that another could be created. The message after it shows that nothing has.
"""

from __future__ import annotations

import difflib
import itertools
from collections.abc import Iterator

from missionfsm.kernel.history import Received, Returned
from missionfsm.kernel.rules import OK
from missionfsm.kernel.step import Step
from missionfsm.kernel.terms import Request
from missionfsm.oracle.explanation import Explanation, InFlight
from missionfsm.oracle.symbols import Symbol, call_of
from missionfsm.tools.check.nearest import WORD, Nearest
from missionfsm.tools.check.phrases import described

MAX_EVENTS, MAX_LOOKED_AT = 12, 20
"""How many events are looked back, and at how many explanations of each."""


def untimely(nearest: Nearest, event: Received) -> tuple[list[str], str] | None:
    """The rules by which a call had to be refused whose effect a message shows, and that in words."""
    for symbol, node in itertools.islice(nearest.belief.walked, MAX_EVENTS):
        for here in node.explanations[:MAX_LOOKED_AT]:
            call = _succeeds(nearest, symbol, here)
            if call is None or not (_adds_only(nearest, here, event) and _is_named(nearest, call.request, event)):
                continue
            refs = nearest.successors.refs(here, call.args)
            answers = list(nearest.successors.outcomes(here.state, call.request, refs))
            rules = [] if any(map(_is_ok, answers)) else list(_refusing(nearest, answers))
            if rules:
                says = nearest.spec.rules_by_id[rules[0]].says.rstrip(".")
                words = described(nearest.spec, call.request)
                return rules, f"it shows what {words} has done, which was answered OK and had to be refused: {says}"
    return None


def _is_named(nearest: Nearest, request: Request, event: Received) -> bool:
    """Whether a message has a name that such a request was answered with."""
    answered = (one for one in nearest.about.recent if one.request == request and one.answer.code == OK)
    return any(not {*one.names}.isdisjoint(event.names) for one in answered)


def _adds_only(nearest: Nearest, here: Explanation, event: Received) -> bool:
    """Whether a message shows all that its channel showed before, and something besides: nothing else happened."""
    number = nearest.belief.number(event.channel)
    now = (channel for one in nearest.belief.node.explanations for channel in one.channels)
    topics = {channel.topic for channel in now if channel.name == number}
    after = WORD.findall(described(nearest.spec, event.content))
    lasts = [one.last.view for one in here.channels if one.topic in topics and one.last is not None]
    return any(_adds(WORD.findall(described(nearest.spec, last)), after) for last in lasts)


def _adds(before: list[str], after: list[str]) -> bool:
    changes = difflib.SequenceMatcher(None, before, after, autojunk=False).get_opcodes()
    return {kind for kind, *_ in changes} == {"equal", "insert"}


def _succeeds(nearest: Nearest, symbol: Symbol, here: Explanation) -> InFlight | None:
    """The call that a symbol answers with OK, if it has yet to take effect and opens no stream."""
    if symbol[0] is not Returned or symbol[1].code != OK:
        return None
    call = next((one for one in here.calls if one.name == call_of(symbol)), None)
    if call is None or call.done is not None:
        return None
    operation = nearest.spec.operations.get(nearest.spec.request_operation(call.request))
    return None if operation is None or operation.streaming else call


def _refusing(nearest: Nearest, steps: list[Step]) -> Iterator[str]:
    """The refusals that are due in the usual reading, each once."""
    usual = [step for step in steps if all(one.ambiguity.default in one.letters for one in step.assumes)]
    known = nearest.spec.rules_by_id
    rules = dict.fromkeys(rule for step in usual for rule in step.rules)
    return (rule for rule in rules if rule in known and known[rule].code is not None)


def _is_ok(step: Step) -> bool:
    return step.answer is not None and step.answer.code == OK
