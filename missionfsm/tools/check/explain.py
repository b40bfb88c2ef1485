"""Why nothing explains an event, in words: what was allowed in its place, by which rule, in which document."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from attrs import frozen

from missionfsm.kernel.history import Answer, Called, Driven, Ended, Event, Received, Returned, Settled
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Mismatch, Spec
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.explanation import Explanation
from missionfsm.oracle.successors import ExhaustedError, Moves
from missionfsm.tools.check.verdict import Allowed, Broken, Violation

MOST = 12
"""How many alternatives a person is shown."""


def told(spec: Spec, rule_ids: Iterable[str]) -> tuple[Broken, ...]:
    """Rules as a person is told them, each once."""
    known = spec.rules_by_id
    found = (known[one] for one in dict.fromkeys(rule_ids) if one in known)
    return tuple(Broken(rule.id, rule.says, str(rule.cite)) for rule in found)


def event_words(spec: Spec, event: Event) -> str:
    """An event in a few words."""
    if isinstance(event, Called):
        return spec.describe(event.request)
    if isinstance(event, Returned):
        return "answered " + answer_words(event.answer, tuple(map(name_words, event.names)))
    if isinstance(event, Received):
        return f"{name_words(event.channel)} showed {spec.describe(event.content)}"
    if isinstance(event, Ended):
        return f"{name_words(event.channel)} ended" + (f" with {event.code}" if event.code != OK else " cleanly")
    if isinstance(event, Driven):
        return spec.describe(event.event)
    return "everything settled" if isinstance(event, Settled) else "a stream was cancelled"


def answer_words(answer: Answer, names: tuple[str, ...]) -> str:
    """An answer with its names."""
    return f"{answer}{' ' + ', '.join(names) if names else ''}"


def name_words(name: Any) -> str:  # noqa: ANN401 - a name
    """A name as a person reads it."""
    return " ".join(map(str, name)) if isinstance(name, tuple) else str(name)


@frozen
class _Option:
    what: str
    rules: tuple[str, ...]
    assumes: tuple[str, ...]


def violation(belief: Belief, event: Event, request: Any) -> Violation:  # noqa: ANN401 - of any system
    """What is wrong with the event that left a belief without explanations.

    Args:
        request: what was asked, if the event is an answer.
    """
    spec, moves = belief.automaton.spec, belief.automaton.moves
    moves.reset()
    observed = event_words(spec, event)
    if isinstance(event, Returned):
        if request is not None:
            observed = f"{spec.describe(request)} was {observed}"
        options = list(_answers(belief, moves, event))
        rules, notes = _against_answer(spec, event, options, request)
    elif isinstance(event, Received):
        options, rules, notes = _against_message(belief, moves, event)
    elif isinstance(event, Settled):
        options, rules, notes = _still_due(belief, moves)
    elif isinstance(event, Ended):
        options, rules, notes = [], _unending(belief, event), ("the stream had to go on",)
    else:
        drive = spec.drives[event.event.name] if isinstance(event, Driven) else None  # type: ignore[attr-defined]
        options, rules, notes = (
            [],
            list(drive.impossible if drive else ()),
            ("nothing that is in a state for it was there",),
        )
    merged: dict[str, _Option] = {}
    for option in options:
        before = merged.get(option.what)
        if before is None or len(option.assumes) < len(before.assumes):
            merged[option.what] = option
    expected = tuple(
        Allowed(option.what, told(spec, option.rules), option.assumes) for option in list(merged.values())[:MOST]
    )
    return Violation(told(spec, rules), observed, expected, tuple(dict.fromkeys(notes))[:MOST])


def _reachable(moves: Moves, explanation: Explanation, besides: int | None = None) -> Iterator[Explanation]:
    try:
        for sighting in moves.closure([explanation], besides):
            yield sighting.explanation
    except ExhaustedError:
        return


def _answers(belief: Belief, moves: Moves, event: Returned) -> Iterator[_Option]:
    number = belief.symbol(event)[0][3]
    for explanation in belief.node.explanations:
        for here in _reachable(moves, explanation, besides=number):
            call = next((one for one in here.calls if one.name == number), None)
            if call is None:
                continue
            if call.done:
                yield _Option(_known(belief, call.done.answer, call.done.names), call.done.rules, ())
                continue
            refs = tuple(here.ref(arg) for arg in call.args)
            for step in moves.outcomes(here.state, call.request, refs):
                if step.answer is None or not _compatible(here, step.assumes):
                    continue
                names = tuple(here.names[ref] if ref < len(here.names) else -2 for ref in step.refs)
                yield _Option(_known(belief, step.answer, names), step.rules, tuple(map(str, step.assumes)))


def _compatible(here: Explanation, assumes: tuple[Assumption, ...]) -> bool:
    return all(here.assumed & one.group & one.keeps for one in assumes)


def _known(belief: Belief, answer: Answer, names: tuple[int, ...]) -> str:
    said = tuple(name_words(belief.name(name) or "a new name") for name in names)
    return answer_words(answer, said)


def _against_answer(
    spec: Spec,
    event: Returned,
    options: list[_Option],
    request: Any,  # noqa: ANN401 - of any system
) -> tuple[list[str], tuple[str, ...]]:
    codes = {option.what.split(" ")[0] for option in options}
    code = event.answer.code
    if code in codes:
        note = "the code is right, the names in the answer are not"
        if event.answer.shape is not None:
            note = f"the result is malformed: {event.answer.shape}"
        return [rule for option in options if option.what.startswith(code) for rule in option.rules], (note,)
    rules = [rule for option in options for rule in option.rules]
    if code != OK and request is not None:
        operation = spec.operations[spec.request_operation(request)]
        mine = [rule for rule in operation.refusals if rule.code == code]
        if not mine:
            return rules, (f"{code} is not documented for {operation.name}",)
        conditions = "; ".join(dict.fromkeys(rule.says for rule in mine[:4]))
        return rules + [rule.id for rule in mine], (f"{code} needs a reason, and none holds: {conditions}",)
    return rules, ()


def _against_message(belief: Belief, moves: Moves, event: Received) -> tuple[list[_Option], list[str], tuple[str, ...]]:
    spec = belief.automaton.spec
    symbol, _ = belief.symbol(event)
    _, content, _, relations, channel_name = symbol
    options: list[_Option] = []
    rules: list[str] = []
    notes: list[str] = []
    for relation in relations:
        wrong = spec.sequence(relation)
        if isinstance(wrong, Mismatch):
            return [], [wrong.rule], (wrong.says,)
    for explanation in belief.node.explanations:
        found = False
        for here in _reachable(moves, explanation):
            for channel in here.channels:
                if channel.name != channel_name and channel.name >= 0:
                    continue
                found = True
                for owed in channel.owed:
                    options.append(_Option(spec.describe(owed.view), (), ()))
                    matched = moves.matches(owed, content)
                    if isinstance(matched, Mismatch):
                        rules.append(matched.rule)
                        notes.append(matched.says)
                    else:
                        notes.append("the content is right, the names in it or the readings that it follows are not")
                if not channel.owed:
                    rules += spec.delivery(channel.topic).unowed
                    notes.append("the stream has nothing to show: nothing changed since its last message")
            if len(options) > MOST:
                break
        if not found:
            rules += spec.unopened
            notes.append(f"{name_words(event.channel)} is not open")
    return options, rules, tuple(notes)


def _unending(belief: Belief, event: Ended) -> list[str]:
    """The rules that are broken by the end of a channel: those of its topic, or of a channel that is not open."""
    spec = belief.automaton.spec
    (_, _, number), _ = belief.symbol(event)
    topics = dict.fromkeys(
        channel.topic
        for explanation in belief.node.explanations
        for channel in explanation.channels
        if channel.name == number
    )
    ways = [spec.delivery(topic) for topic in topics]
    return [rule for way in ways for rule in way.unending or way.unowed] or list(spec.unopened)


def _still_due(belief: Belief, moves: Moves) -> tuple[list[_Option], list[str], tuple[str, ...]]:
    spec = belief.automaton.spec
    options: list[_Option] = []
    rules: list[str] = []
    notes: list[str] = []
    for explanation in belief.node.explanations:
        for here in _reachable(moves, explanation):
            for channel in here.channels:
                due = [owed for owed in channel.owed if not owed.passing]
                if due:
                    name = belief.name(channel.name)
                    where = name_words(name) if name else "a stream"
                    options.append(_Option(f"{where} shows {spec.describe(due[-1].view)}", (), ()))
                    notes.append(f"{where} did not show {spec.describe(due[-1].view)}")
                    rules += spec.delivery(channel.topic).unowed
            if len(options) > MOST:
                break
    return options, rules, tuple(notes[:3])
