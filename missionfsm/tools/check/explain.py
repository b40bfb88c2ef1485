"""Why nothing explains an event, in words: what was allowed in its place, by which rule, in which document."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.history import Driven, Ended, Event, Name, Received, Returned, Settled
from missionfsm.kernel.rules import OK
from missionfsm.kernel.sequence import STALE
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Mismatch
from missionfsm.kernel.terms import Topic
from missionfsm.kernel.text import printable
from missionfsm.kernel.transport import TR_05
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.explanation import Channel, Explanation, Owed
from missionfsm.oracle.successors import Successor
from missionfsm.oracle.symbols import relations_of
from missionfsm.tools.check import causes
from missionfsm.tools.check.candidates import (
    CODE,
    FAILED,
    LEFT_OUT,
    NAME,
    READING,
    SHAPE,
    UNDRIVEN,
    UNOWED,
    VALUE,
    AnsweredCall,
    Candidate,
    Circumstances,
    Problem,
)
from missionfsm.tools.check.nearest import Nearest
from missionfsm.tools.check.phrases import answer_words, described, event_words, name_words, rules_in_words
from missionfsm.tools.check.untimely import untimely
from missionfsm.tools.check.verdict import Allowed, Violation
from missionfsm.tools.check.wrongcode import wrong_code

MAX_ALTERNATIVES = 8
"""How many alternatives a person is shown."""

MAX_RULES = 3
"""How many rules a violation names at most, the nearest first."""

NOT_HAPPENED = 'that it does not happen: an adapter answers {"happened": false}'
"""What is right instead of a drive that cannot happen."""

MAX_NOTES = 4
"""How many reasons a person is told."""

MAX_CALLS, MAX_STATES = 3, 2
"""How many calls, and how many states, stand in one reason."""


def violation(belief: Belief, event: Event, about: Circumstances = Circumstances()) -> Violation:  # noqa: B008 - a value
    """What is wrong with the event that left a belief without explanations."""
    spec = belief.automaton.spec
    nearest = Nearest(belief, about)
    observed = event_words(spec, event)
    if isinstance(event, Returned):
        if about.request is not None:
            observed = f"{described(spec, about.request)} was {observed}"
        found = _against_answer(nearest, event)
    elif isinstance(event, Received):
        found = _against_message(nearest, event)
    elif isinstance(event, Settled):
        found = _still_due(nearest)
    elif isinstance(event, Ended):
        found = _against_end(nearest, event)
    else:
        observed += " happened" if isinstance(event, Driven) else ""
        found = _against_drive(nearest, event)
    expected, rules, notes = found
    notes = [*notes, *_taken_for_granted(nearest)]
    operation = _operation(nearest, event, expected)
    named = list(dict.fromkeys(rule for rule in rules if rule))[:MAX_RULES] or _implied(spec, event, operation)
    return Violation(
        rules_in_words(spec, named, operation),
        observed,
        _allowed(spec, expected, operation),
        tuple(dict.fromkeys(printable(note) for note in notes if note))[:MAX_NOTES],
    )


def _taken_for_granted(nearest: Nearest) -> list[str]:
    """That only a restart of what is judged explains what came before; the line that shows it may be wrong itself."""
    here = nearest.belief.node.explanations
    elimination = nearest.about.eliminations.get((TR_05.id, "a"))
    if elimination is None or any("a" in TR_05.possible(one.assumed) for one in here):
        return []
    return [f"unless it has restarted, nothing explains an earlier line: {elimination}"]


def _implied(spec: Spec, event: Event, operation: str) -> list[str]:
    """The implied rule of the drive, or of the operation that was answered or that opens streams (`Spec.implied`)."""
    if isinstance(event, Driven):
        place = [event.event.name]  # type: ignore[attr-defined]
    elif isinstance(event, Returned) or operation:
        place = [operation]
    else:
        place = [one.name for one in spec.operations.values() if one.streaming]
    return [rule for name in place[:1] for rule in spec.implied if rule.split("/")[1] == name]


Accusation = tuple[Sequence[Candidate], Iterable[str], Iterable[str]]
"""What could have come, the rules that are broken, and the reasons in words."""


def _operation(nearest: Nearest, event: Event, expected: Iterable[Candidate]) -> str:
    """The operation that an event is about: the one that was answered, or that opened the channel; empty if unknown."""
    spec = nearest.spec
    if isinstance(event, Returned):
        return "" if nearest.about.request is None else spec.request_operation(nearest.about.request)
    topics = [one.owed[0].topic for one in expected if one.owed is not None]
    if isinstance(event, Received | Ended):
        topics = _topics(nearest, event)
    return next((spec.delivery(topic).operation for topic in topics), "")


def _allowed(spec: Spec, candidates: Iterable[Candidate], operation: str) -> tuple[Allowed, ...]:
    """What could have come, each once, with the fewest assumptions; the candidates come in order."""
    merged: dict[str, Candidate] = {}
    for one in candidates:
        before = merged.get(one.what)
        if one.what and one.allowed and (before is None or len(one.assumes) < len(before.assumes)):
            merged[one.what] = one
    return tuple(
        Allowed(one.what, rules_in_words(spec, one.rules, operation), one.assumes)
        for one in list(merged.values())[:MAX_ALTERNATIVES]
    )


def _lightest(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Those with the least problems."""
    least = min((one.weight for one in candidates), default=0)
    return [one for one in candidates if one.weight == least]


ODD, MOST_ODD = 2, 3
"""What an unusual reading adds to the weight of a message, and how many of them count at most."""


def _likeliest_first(candidates: Iterable[Candidate]) -> list[Candidate]:
    """Messages, first those with the least problems and the most usual readings, before which least happened unseen."""
    found = list(candidates)
    usual = min((one.unusual for one in found), default=0)
    return sorted(found, key=lambda one: (_unlikely(one, usual), len(one.unseen)))


def _unlikely(candidate: Candidate, usual: int) -> int:
    return candidate.weight + ODD * min(candidate.unusual - usual, MOST_ODD)


def _likeliest(candidates: Sequence[Candidate]) -> list[Candidate]:
    """The first of them, with all that are as likely but for what happened unseen."""
    usual = min(one.unusual for one in candidates)
    return [one for one in candidates if _unlikely(one, usual) == _unlikely(candidates[0], usual)]


def _problems(candidates: Iterable[Candidate]) -> list[Problem]:
    """The problems of all of them."""
    return [problem for one in candidates for problem in one.problems]


def _broken(candidates: Iterable[Candidate]) -> Iterator[str]:
    """The rules that their problems break."""
    return (rule for problem in _problems(candidates) for rule in problem.rules)


# An answer.


def _against_answer(nearest: Nearest, event: Returned) -> Accusation:
    candidates = sorted(nearest.answers(event), key=lambda one: (one.weight, one.early, one.departs, one.unusual))
    said = answer_words(event.answer, tuple(map(name_words, event.names)))
    lightest = sorted(_lightest(candidates), key=lambda one: abs(len(one.what) - len(said)))
    literal = [one for one in candidates if one.allowed and not one.departs]
    if literal and event.answer.code == OK and all(one.departs for one in lightest):
        # What is wrong with it by a reading that departs from the text is not as near as that it had to be refused.
        return sorted(candidates, key=lambda one: one.departs), *wrong_code(nearest, event, literal)
    if not lightest or lightest[0].weight < CODE:
        return candidates, *_wrong_in_it(nearest, event, candidates, lightest)
    return candidates, *wrong_code(nearest, event, [one for one in candidates if one.allowed] or candidates)


def _wrong_in_it(
    nearest: Nearest, event: Returned, candidates: Sequence[Candidate], lightest: Sequence[Candidate]
) -> tuple[Iterable[str], Iterable[str]]:
    """The rules and reasons against an answer whose code is allowed, while something else in it is wrong."""
    rules = _alternately(*(_accused(nearest.spec, problem, one) for one in lightest for problem in one.problems))
    due = any(problem.weight >= SHAPE and not problem.by_itself for problem in _problems(lightest))
    if due and not _malformed(event):
        rules = _alternately(rules, _before(nearest))
    contradicts = all(problem.weight == READING for problem in _problems(lightest))
    if not contradicts and _was_right(nearest, candidates):
        rules = _alternately(causes.since_last_answer(nearest.belief), rules)
    rules = _beside_other_codes(rules, candidates, contradicts=contradicts and event.answer.code != OK)
    notes = [*(problem.says for problem in _problems(lightest[:1])), *_given_twice(event)]
    return rules or _about_the_answer(nearest.spec, (rule for one in lightest for rule in one.rules)), notes


def _given_twice(event: Returned) -> Iterator[str]:
    twice = [name for name, times in Counter(event.names).items() if times > 1]
    if twice:
        yield f"each thing has a name of its own, and {', '.join(map(name_words, twice))} is given twice"


def _of_other_codes(candidates: Iterable[Candidate]) -> list[str]:
    """The rules of allowed answers with another code, of those before which least has happened unseen."""
    due = [one for one in candidates if one.allowed and one.weight >= CODE]
    nearest = min(((one.early, len(one.unseen), one.unusual) for one in due), default=None)
    near = (one for one in due if (one.early, len(one.unseen), one.unusual) == nearest)
    return list(dict.fromkeys(rule for one in near for rule in one.rules))


def _beside_other_codes(rules: list[str], candidates: Sequence[Candidate], *, contradicts: bool) -> list[str]:
    """The rules, and those of other codes that the answer could have had.

    A refusal that contradicts an earlier one breaks the rule by which that was right, where it holds here as well.
    """
    others = _of_other_codes(candidates)
    return _alternately(others, rules) if contradicts else _alternately(rules, others)


def _was_right(nearest: Nearest, candidates: Sequence[Candidate]) -> bool:
    """Whether the same request was answered last, and that answer would be right now as well."""
    last = nearest.about.recent[-1] if nearest.about.recent else None
    if last is None or last.request != nearest.about.request:
        return False
    return answer_words(last.answer, tuple(map(name_words, last.names))) in {
        one.what for one in candidates if one.allowed
    }


def _malformed(event: Returned) -> bool:
    return isinstance(event.answer.shape, Malformed)


def _alternately(*lists: Sequence[str]) -> list[str]:
    """The first of each list, then the second of each, and so on: the nearest of each list come first."""
    return list(dict.fromkeys(one for row in itertools.zip_longest(*lists) for one in row if one is not None))


def _accused(spec: Spec, problem: Problem, candidate: Candidate) -> list[str]:
    """The rules that a problem of an answer breaks; if it contradicts an earlier event, a rule of that as well."""
    if problem.since:
        return _alternately(candidate.rules or problem.rules, problem.since[:1])
    about = [rule for rule in problem.rules if rule in candidate.rules]
    return about or [*problem.rules] or _about_the_answer(spec, candidate.rules)


def _about_the_answer(spec: Spec, rules: Iterable[str]) -> list[str]:
    """Rules, first those that say which names an answer has: it breaks them itself, others what comes of it."""
    known = spec.rules_by_id
    return sorted(rules, key=lambda rule: rule not in known or not known[rule].names)


# A message.


def _against_message(nearest: Nearest, event: Received) -> Accusation:
    wrong = _wrong_mark(nearest, event)
    if wrong is not None:
        meant = _meant_for_another(nearest, event)
        told = [*_broken(meant), wrong.rule], [*(problem.says for problem in _problems(meant)), wrong.says]
        return meant, *told
    candidates = _likeliest_first(nearest.messages(event))
    if not candidates:
        return (), nearest.spec.unopened, [f"{name_words(event.channel)} is not open"]
    lightest = _likeliest(candidates)
    weights = [problem.weight for problem in lightest[0].problems]
    rules = _by_weight(nearest, lightest, weights)
    notes = [problem.says for problem in _problems(lightest)]
    nothing_is_due = lightest[0].owed is None and max(weights, default=0) >= UNOWED
    refusal = _refused_last(nearest) if nothing_is_due else None
    if refusal is not None:
        rules = list(dict.fromkeys(_broken(lightest)))  # nothing else has happened since
        notes.append(f"the last call was refused, which changes nothing: {refusal.words(nearest.spec)}")
        return candidates, rules or list(_broken(candidates)), notes
    if isinstance(event.content, Malformed):
        return _staying(candidates), rules, notes[:1]
    refused = untimely(nearest, event) if max(weights, default=0) >= VALUE else None
    if refused is not None:
        return candidates, refused[0], [refused[1]]
    return candidates, rules or list(_broken(candidates)), [*notes, *_strangers(nearest, event)]


def _meant_for_another(nearest: Nearest, event: Received) -> list[Candidate]:
    """Of a stream about several things: what is due about another of them, if it is told of the wrong one.

    Its number is then one of those of the other, and says less.
    """
    if isinstance(event.content, Malformed) or len(_topics(nearest, event)) < 2:
        return []
    likeliest = _likeliest_first(nearest.messages(event))[:1]
    return [one for one in likeliest if one.allowed and SHAPE <= one.weight < UNOWED]


def _topics(nearest: Nearest, event: Received | Ended) -> list[Topic]:
    """What the channel that an event is on is about."""
    number = nearest.belief.number(event.channel)
    here = nearest.belief.node.explanations
    return list(dict.fromkeys(channel.topic for one in here for channel in one.channels if channel.name == number))


def _staying(candidates: list[Candidate]) -> list[Candidate]:
    """Those that cannot be passed over, if there are any."""
    return [one for one in candidates if not one.passing] or candidates


def _by_weight(nearest: Nearest, lightest: list[Candidate], weights: list[int]) -> list[str]:
    """The rules that a message breaks, and those of what should have happened before it."""
    rules = list(dict.fromkeys(_broken(lightest)))
    if UNDRIVEN in weights:
        # The last thing that happened has another effect; or the message shows something that did not happen.
        return _alternately(causes.latest(nearest.belief), rules)
    right_so_far = FAILED not in weights and not any(SHAPE <= weight < UNOWED for weight in weights)
    if right_so_far and max(weights, default=0) >= LEFT_OUT:
        # Either the message shows wrongly what happened, or something else happened than should have.
        return _alternately(rules, _before(nearest, lightest[0], made_only=max(weights) == NAME))
    return rules


def _refused_last(nearest: Nearest) -> AnsweredCall | None:
    """The call that was answered last, if that refused it."""
    last = nearest.about.recent[-1] if nearest.about.recent else None
    if last is None or last.answer.code == OK:
        return None
    operation = nearest.spec.operations[nearest.spec.request_operation(last.request)]
    return last if any(rule.code == last.answer.code for rule in operation.refusals) else None


def _wrong_mark(nearest: Nearest, event: Received) -> Mismatch | None:
    """What is wrong with the numbers of a message, or else with when it came, whatever it shows."""
    belief = nearest.belief
    relations = relations_of(belief.symbol(event)[0])
    for relation in relations[len(event.marks) :]:
        if relation == STALE:
            continue  # that the numbers are equal says it
        wrong = nearest.spec.sequence(relation)
        if isinstance(wrong, Mismatch):
            return wrong
    for relation, (track, number) in zip(relations, event.marks, strict=False):
        wrong = nearest.spec.sequence(relation)
        if isinstance(wrong, Mismatch):
            before = belief.last_mark(event.channel, track)
            compared = f"{number}" if before is None else f"{number} after {before}"
            return Mismatch(wrong.rule, f"{wrong.says}: {compared}")
    return None


NOBODYS = "no call was answered with"
"""How a note begins on names that nobody in the log was told."""


def _strangers(nearest: Nearest, event: Received) -> list[str]:
    """Names in a message that no call was answered with, and the calls that were answered last."""
    elsewhere = nearest.spec.anywhere or nearest.spec.others  # they may come from calls that are not in the log
    unknown = [] if elsewhere else _never_answered(nearest, event)
    if not unknown or not nearest.about.recent:
        return []
    calls = ", ".join(call.words(nearest.spec) for call in nearest.about.recent[-MAX_CALLS:])
    return [f"{NOBODYS} {', '.join(map(name_words, unknown))}; the last calls were {calls}"]


def _never_answered(nearest: Nearest, event: Received) -> list[Name]:
    """Names in a message that no call was answered with.

    Names of a kind that no call was answered with come from elsewhere, those of missions in lines for example.
    """
    answered = {name for call in nearest.about.recent for name in call.names}
    kinds = {name[0] for name in answered if isinstance(name, tuple)}
    foreign = [name for name in event.names if isinstance(name, tuple) and name[0] not in kinds]
    number = nearest.belief.number
    return [name for name in event.names if number(name) < 0 and name not in {*answered, *foreign}]


def _before(nearest: Nearest, candidate: Candidate | None = None, *, made_only: bool = False) -> list[str]:
    """The rules of the steps that made a message due; if none did, those of the last steps.

    Args:
        made_only: whether only steps count that somebody has made happen: others have no part in a wrong name.
    """
    owing = None if candidate is None else _owing(nearest, candidate, made_only=made_only)
    unseen = reversed(candidate.unseen) if candidate and not made_only else ()
    return list(dict.fromkeys((*unseen, *(causes.latest(nearest.belief) if owing is None else owing))))


def _owing(nearest: Nearest, candidate: Candidate, *, made_only: bool = False) -> tuple[str, ...] | None:
    """The rules of the steps that made a message due, if it is one, and any step is known to have."""
    if candidate.owed is None:
        return None
    channel, owed = candidate.owed
    first = nearest.spec.delivery(channel.topic).first if channel.last is None else ()
    return first or causes.owing(nearest.belief, owed.view, channel.topic, made_only=made_only)


def _due(here: Explanation) -> list[tuple[Channel, Owed]]:
    """The last message that each channel still owes."""
    owed = ((channel, [one for one in channel.owed if not one.passing]) for channel in here.channels)
    return [(channel, due[-1]) for channel, due in owed if due]


def _owing_most_surely(nearest: Nearest) -> list[tuple[Successor, list[tuple[Channel, Owed]]]]:
    """What is owed in each explanation: best what was not shown yet, where nothing can happen any more."""
    ways = [(one, _due(one.explanation)) for one in nearest.ways()]
    missed = [
        (one, [(channel, owed) for channel, owed in due if not nearest.is_told(one.explanation, channel)])
        for one, due in ways
    ]
    found = [(one, due) for one, due in missed if due] or [(one, due) for one, due in ways if due]
    return [way for way in found if nearest.at_rest(way[0].explanation)] or found


def _still_due(nearest: Nearest) -> Accusation:
    """Things have settled although messages are owed: what is owed in the explanations that owe least.

    Those are accused that need the fewest unusual readings.
    """
    ways = _owing_most_surely(nearest)
    least = min((len(due) for _, due in ways), default=0)
    ways = sorted((way for way in ways if len(way[1]) == least), key=lambda way: nearest.unusual(way[0].explanation))
    found: list[Candidate] = []
    rules: list[str] = []
    notes: list[str] = []
    for successor, due in ways:
        usual = nearest.unusual(successor.explanation) == nearest.unusual(ways[0][0].explanation)
        for channel, owed in due:
            where = _called(nearest, channel)
            delivery = nearest.spec.delivery(channel.topic)
            shows = f"{where} shows {described(nearest.spec, owed.view)}"
            found.append(Candidate(what=shows, unseen=successor.rules, owed=(channel, owed)))
            if usual:
                rules += nearest.missing(delivery, owed.view, at_first=channel.last is None)
                notes.append(f"{where} did not show {_shown(nearest, owed)}{_shown_last(nearest, channel, owed)}")
    if not found:
        rules, notes = _nothing_new(nearest)
        return found, _alternately(list(dict.fromkeys(rules)), _before(nearest)), notes[:2]
    # What was seen last has no part in it, unless it made the message due.
    before = [*reversed(found[0].unseen), *(_owing(nearest, found[0]) or ())]
    return found, _alternately(list(dict.fromkeys(rules)), before), notes[:2]


def _nothing_new(nearest: Nearest) -> tuple[list[str], list[str]]:
    """What was shown before the last call, and nothing after it: that a message is missing is known from later ones.

    Streams show what calls do; on other channels lines come when it is time for them.
    """
    shown = _that_show(nearest)
    if not shown or not nearest.about.recent:
        return [], []
    rules = [rule for one in shown for rule in nearest.spec.delivery(one.topic).unowed]
    lasts = [(_called(nearest, one), _shown(nearest, one.last)) for one in shown if one.last is not None]
    if not all(nearest.spec.delivery(one.topic).operation for one in shown):
        last = "; ".join(f"{where} showed {last} last" for where, last in lasts)
        return rules, [f"a line is due that does not come; {last}"]
    call = nearest.about.recent[-1].words(nearest.spec)
    return rules, [f"after {call} {where} showed nothing new; it showed {last} last" for where, last in lasts]


def _that_show(nearest: Nearest) -> list[Channel]:
    """The channels that have shown something, where everything is at rest."""
    here = next((one for one in nearest.reachable() if nearest.at_rest(one)), None)
    return [one for one in here.channels if one.last is not None] if here is not None else []


def _shown_last(nearest: Nearest, channel: Channel, owed: Owed) -> str:
    """What a channel has shown last, behind what it owes."""
    if channel.last is None:
        return ""
    again = (channel.last.view, channel.last.names) == (owed.view, owed.names)
    return " again" if again else f"; it showed {_shown(nearest, channel.last)} last"


def _shown(nearest: Nearest, owed: Owed) -> str:
    """What is owed, or was shown, with the names of what it is about."""
    names = [name_words(known) for one in owed.names if (known := nearest.belief.name(one)) is not None]
    about = f" ({', '.join(names)})" if names else ""
    return f"{described(nearest.spec, owed.view)}{about}"


def _called(nearest: Nearest, channel: Channel) -> str:
    name = nearest.belief.name(channel.name)
    return "a stream" if name is None else name_words(name)


# An end, and a drive.


def _against_end(nearest: Nearest, event: Ended) -> Accusation:
    """The rules that the end of a channel breaks: those of its topic, or those about a channel that is not open."""
    spec = nearest.spec
    topics = _topics(nearest, event)
    if not topics:
        return (), spec.unopened, [f"{name_words(event.channel)} is not open"]
    ways = [spec.delivery(topic) for topic in topics]
    codes = ", ".join(dict.fromkeys(code for way in ways for code in way.ends))
    note = f"the stream has to go on; it may only end with {codes}" if codes else "the stream has to go on"
    return (), [rule for way in ways for rule in way.unending], [note]


def _against_drive(nearest: Nearest, event: Event) -> Accusation:
    drive = nearest.spec.drives[event.event.name] if isinstance(event, Driven) else None  # type: ignore[attr-defined]
    reachable = list(nearest.reachable())
    rest = [one for one in reachable if nearest.at_rest(one)] or reachable
    states = dict.fromkeys(described(nearest.spec, one.state) for one in rest)
    note = f"it cannot happen here: {' or '.join(list(states)[:MAX_STATES])}"
    return [Candidate(what=NOT_HAPPENED)], drive.impossible if drive else (), [note]
