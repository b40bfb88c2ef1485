"""An answer with a code that nothing allows: which rules it breaks, the nearest first.

Two things can be wrong: what should have been answered is not, and what was answered has no reason. What should have
been answered is what needs least to have happened unseen, but for what happens at once, and the fewest readings that
are not usual. Of the rows of the Errors table with the code that came none holds, so that none is named but where
something speaks for it: the call should have taken effect, and the row held for this request a while ago, as for
whoever looks at a state that is no more, or would hold if the call were about another thing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from missionfsm.kernel.history import Returned
from missionfsm.kernel.readings import meet
from missionfsm.kernel.rules import OK, Rule
from missionfsm.kernel.step import Step
from missionfsm.oracle.explanation import Explanation, InFlight, Ready
from missionfsm.oracle.symbols import call_of
from missionfsm.tools.check.candidates import Candidate
from missionfsm.tools.check.nearest import Nearest
from missionfsm.tools.check.phrases import described, name_words

MAX_LOOKED_AT = 20
"""In how many explanations of each event it is looked whether a row held."""

CONDITIONS = 3
"""How many conditions that do not hold a person is told."""


def wrong_code(nearest: Nearest, event: Returned, allowed: Sequence[Candidate]) -> tuple[list[str], list[str]]:
    """Ids of the rules that are broken and why, in words; none of the candidates has the code of the answer."""
    spec, request, code = nearest.spec, nearest.about.request, event.answer.code
    refused, done, is_done = _parted(allowed)
    wanted = done if is_done else refused
    if code == OK or request is None:
        return refused or wanted, []
    operation = spec.operations[spec.request_operation(request)]
    if code in operation.failures:
        return _failed_wrongly(nearest, event, wanted, is_done=is_done)
    reasons = [rule for rule in operation.refusals if rule.code == code]
    if not reasons:
        # It refuses: what may be refused comes first, also where some reading would have it done.
        return [*refused, *(done if is_done else ())], [f"{code} is not documented for {operation.name}"]
    held = _held_last(nearest, event, reasons)
    others, about = ([], "") if held else _held_of_another(nearest, event, reasons)
    reasons = [*held, *others, *sorted(reasons, key=lambda rule: rule.assumes is not None)]
    note = f"no refusal with {code} is due: of the rows with that code none applies ({_conditions(reasons)})"
    note += "; the first did before" if held else f"; the first would if it were about {about}" if others else ""
    if is_done:  # what may be done is refused without a reason; or it is refused for another one, with a wrong code
        return [*(rule.id for rule in (*held, *others)[:1]), *done[:1], *refused[:1], *done], [note]
    return refused, [note]  # what has to be refused is refused wrongly


def _conditions(rules: Iterable[Rule]) -> str:
    return "; ".join(list(dict.fromkeys(rule.says.rstrip(".") for rule in rules))[:CONDITIONS])


def _parted(allowed: Sequence[Candidate]) -> tuple[list[str], list[str], bool]:
    """The rules of the refusals that are due and of what may be done instead, and whether that is likelier."""
    due = sorted(allowed, key=_likely)
    # What would need more to have happened unseen is no reason to accuse anything, where there is what needs less.
    due = [one for one in due if _likely(one)[:2] == _likely(due[0])[:2]]
    refused = _once_each(rule for one in due if not _succeeds(one) for rule in one.rules)
    done = list(dict.fromkeys(rule for one in due if _succeeds(one) for rule in one.rules))
    return refused, done, not refused or _succeeds(due[0])


def _succeeds(candidate: Candidate) -> bool:
    return candidate.code == OK


def _likely(candidate: Candidate) -> tuple[bool, int, int, int]:
    return candidate.early, len(candidate.unseen), candidate.unusual, candidate.weight


def _once_each(rules: Iterable[str]) -> list[str]:
    """Ids of refusals, of those that differ in their code alone only the first."""
    first: dict[tuple[str, str], str] = {}
    for rule in rules:
        place, _, condition = rule.rpartition("/")
        first.setdefault((place.rpartition("/")[0], condition), rule)
    return list(first.values())


def _held_last(nearest: Nearest, event: Returned, reasons: Sequence[Rule]) -> list[Rule]:
    """Those rows whose condition held for this request when one of them did last, as far as it is remembered.

    A request with names is not looked at: what they stood for then is not known any more.
    """
    belief, successors, request = nearest.belief, nearest.successors, nearest.about.request
    if any(call.args for _, call in _asking(nearest, event)):
        return []
    ids = {rule.id for rule in reasons}
    for _, node in belief.walked:
        looked_at = node.explanations[:MAX_LOOKED_AT]
        steps = (step for here in looked_at for step in successors.outcomes(here.state, request, ()))
        held = _rules_of(steps, event.answer.code)
        if held & ids:
            return [rule for rule in reasons if rule.id in held]
    return []


def _held_of_another(nearest: Nearest, event: Returned, reasons: Sequence[Rule]) -> tuple[list[Rule], str]:
    """Those rows that would hold if a call about one thing were about another, and which one, in words."""
    successors = nearest.successors
    for here, call in _asking(nearest, event):
        if len(call.args) != 1:
            continue
        own = successors.refs(here, call.args)
        for ref in (*range(len(here.names)), None):
            steps = successors.outcomes(here.state, call.request, (ref,)) if (ref,) != own else ()
            would = _rules_of((step for step in steps if meet(here.assumed, step.assumes)), event.answer.code)
            found = [rule for rule in reasons if rule.id in would]
            if found:
                name = None if ref is None else nearest.belief.name(here.names[ref])
                return found, "an unknown name" if name is None else name_words(name)
    return [], ""


def _rules_of(steps: Iterable[Step], code: str) -> set[str]:
    """The rules by which steps are answered with a code."""
    return {rule for step in steps if step.answer is not None and step.answer.code == code for rule in step.rules}


def _asking(nearest: Nearest, event: Returned) -> list[tuple[Explanation, InFlight]]:
    """The explanations in which the call that was answered is still in flight, each with it."""
    number = call_of(nearest.belief.symbol(event)[0])
    explanations = nearest.belief.node.explanations
    return [(here, call) for here in explanations for call in here.calls if call.name == number]


def _failed_wrongly(
    nearest: Nearest, event: Returned, rules: list[str], *, is_done: bool
) -> tuple[list[str], list[str]]:
    """A failure that is documented and yet cannot be: the call took effect, is refused, or nobody made it fail."""
    code, spec = event.answer.code, nearest.spec
    number = call_of(nearest.belief.symbol(event)[0])
    explanations = nearest.belief.node.explanations
    done = [(one, answer) for one in explanations if (answer := _took_effect(one, number)) is not None]
    if not done and not is_done:
        return rules, [
            f"{code} comes in the place of OK where a drive makes a call fail, and this one has to be refused"
        ]
    if not done or len(done) < len(explanations):
        return rules, [
            f"{code} comes to this call only where a drive makes it fail (the log says all of those), and none did"
        ]
    explanation, answer = done[0]
    unowed = [rule for channel in explanation.channels for rule in spec.delivery(channel.topic).unowed]
    says = f"{code} is documented, but a call that failed has no effect, and {_effect(nearest, explanation, answer)}"
    return unowed or rules, [says]


def _effect(nearest: Nearest, explanation: Explanation, answer: Ready) -> str:
    """What a call has done, and where that was shown."""
    shown = [
        f"{name_words(nearest.belief.name(channel.name))} showed {described(nearest.spec, channel.last.view)}"
        for channel in explanation.channels
        if channel.last is not None and channel.name >= 0
    ]
    names = ", ".join(name_words(known) for one in answer.names if (known := nearest.belief.name(one)) is not None)
    what = f"{names} is there" if names else "it took effect"
    return f"{what}: {'; '.join(shown)}" if shown else what


def _took_effect(explanation: Explanation, number: int) -> Ready | None:
    """What a call is to be answered that has taken effect already; None where it has not."""
    return next((call.done for call in explanation.calls if call.name == number), None)
