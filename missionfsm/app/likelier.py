"""An answer that is likelier to be wrong than the line that nothing explains: what comes after tells.

A log in which missions may end unseen explains a wrong answer by what nobody saw, and contradicts itself only later.
Where all is explained without that answer, and not without the line at which it shows, that answer is to be looked at.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable, Iterator, Sequence

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Event, Returned
from missionfsm.kernel.system import System
from missionfsm.oracle.transcript import answered_with
from missionfsm.tools.check.candidates import Circumstances
from missionfsm.tools.check.explain import MAX_RULES
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.nearest import Nearest
from missionfsm.tools.check.phrases import answer_words, described, name_words, rules_in_words
from missionfsm.tools.check.verdict import Violation

LONGEST, FURTHER = 60, 40
"""How many lines a log may have before its violation, and how many after it are looked at."""

MOST = 12
"""How many of the last answers before a violation are looked at."""

Numbered = tuple[int, JSON]
"""A line and its number in the file."""

JudgeOf = Callable[[frozenset[int]], Judge]
"""A new judge of the log, to which answers to these calls are known not to come."""


@frozen
class _Log:
    """The lines of a log around a violation, without its first.

    Attributes:
        lines: the lines, of which the one at `at` is the one that nothing explains.
        at: its place.
        judge_of: makes judges of it.
        prompt: makes one that explains each line at once.
    """

    lines: Sequence[Numbered]
    at: int
    judge_of: JudgeOf
    prompt: Callable[[], Judge]

    def explained_without(self, at: int) -> bool:
        """Whether all lines but one can be explained. An answer that is left out counts as lost on the way."""
        line = self.lines[at][1]
        judge = self.judge_of(frozenset({line["return"]}) if "return" in line else frozenset())
        return _explained(judge, (one for place, (_, one) in enumerate(self.lines) if place != at))

    def explained_with(self, at: int, line: JSON) -> bool:
        """Whether all lines can be explained where another one stands in the place of one."""
        lines = (line if place == at else one for place, (_, one) in enumerate(self.lines))
        return _explained(self.judge_of(frozenset()), lines)

    def read(self, at: int, line: JSON) -> list[Event]:
        """The events of all lines before one, and of what stands in its place."""
        transcript = self.judge_of(frozenset()).transcript
        before = (one for _, one in self.lines[:at])
        return [event for one in (*before, line) for event in transcript.read(one)]

    def rules_of(self, at: int, answer: JSON) -> tuple[str, ...]:
        """The ids of the rules by which an answer would be right on a line, where least has happened unseen."""
        judge = self.prompt()
        if not all(judge.feed(one) for _, one in self.lines[:at]):
            return ()
        (event,) = (one for one in judge.transcript.read(answer) if isinstance(one, Returned))
        nearest = Nearest(judge.belief.of_last_event, Circumstances(judge.transcript.answered))
        right = [one for one in nearest.answers(event) if one.allowed and not one.problems]
        return min(right, key=lambda one: (one.early, len(one.unseen), one.unusual)).rules if right else ()


def _explained(judge: Judge, lines: Iterable[JSON]) -> bool:
    """Whether a judge can explain these lines as well."""
    return all(judge.feed(line) for line in lines) and judge.verdict().violation is None and not judge.exhausted


def with_likelier(
    system: System,
    violation: Violation,
    lines: Sequence[Numbered],
    judge_of: JudgeOf,
    prompt: Callable[[], Judge],
) -> Violation:
    """The violation with the one answer before it without which all is explained, if the line itself is not such a one.

    Args:
        system: the system, as the log is judged.
        violation: the violation.
        lines: the lines of the log after its first, to some way behind the violation.
        judge_of: makes judges of the log.
        prompt: makes a judge of it that explains each line at once.
    """
    at = next((place for place, (number, _) in enumerate(lines) if number == violation.at), None)
    if at is None:
        return violation
    log = _Log(lines, at, judge_of, prompt)
    try:
        doubtful = _doubtful(system, log)
    except UnreadableError:  # a line behind the violation is not of the format: nobody has looked at it before
        return violation
    found = [place for place, instead in doubtful.items() if instead is not None] or list(doubtful)
    return _accusing(system, violation, log, found[0], doubtful[found[0]]) if len(found) == 1 else violation


def _doubtful(system: System, log: _Log) -> dict[int, JSON]:
    """The places of the answers without which all is explained, each with what would be right there, if that is known.

    Empty where the line of the violation is the last, or is wrong itself.
    """
    if log.at + 1 == len(log.lines) or _is_wrong_itself(system, log):
        return {}
    answers = [place for place in range(log.at) if _is_answer(system, log.lines, place)][-MOST:]
    return {place: _right(system, log, place) for place in answers if log.explained_without(place)}


def _is_wrong_itself(system: System, log: _Log) -> bool:
    """Whether all is explained where the line of the violation is another, or is not there.

    A call that was done and whose answer is lost may have been done at any time later: that would explain too much.
    """
    if answered_with(log.lines[log.at][1]) == "result" and _is_answer(system, log.lines, log.at):
        return _right(system, log, log.at) is not None
    return log.explained_without(log.at)


def _right(system: System, log: _Log, at: int) -> JSON:
    """The answer with which all lines are explained, in the place of another; None where none is found."""
    return next((one for one in _others(system, log, at) if log.explained_with(at, one)), None)


def _is_answer(system: System, lines: Sequence[Numbered], at: int) -> bool:
    line = lines[at][1]
    return "return" in line and _call(lines, at).get("method") in system.codec.methods


def _call(lines: Sequence[Numbered], at: int) -> JSON:
    """The call that is answered on a line."""
    return next((one for _, one in lines[:at] if one.get("call") == lines[at][1]["return"]), {})


def _accusing(system: System, violation: Violation, log: _Log, at: int, instead: JSON) -> Violation:
    """The violation that accuses an answer before it: what would have been right in its place, and by which rules."""
    number, line = log.lines[at]
    call = _call(log.lines, at)
    request = system.codec.read_request(
        call["method"], system.codec.split_request(call["method"], call.get("params", {}))[1]
    )
    asked = described(system.spec, request)
    all_is = "without it" if instead is None else f"with {_words(log, at, instead)}"
    was = f"{asked} was answered {_words(log, at, line)}"
    says = f"line {number} is likelier to be wrong, {was}: {all_is} the rest is explained"
    rules = () if instead is None else log.rules_of(at, instead)
    cited = rules_in_words(system.spec, rules, system.spec.request_operation(request))
    once = {one.id: one for one in (*cited, *violation.rules)}
    return evolve(violation, rules=tuple(once.values())[:MAX_RULES], notes=(says, *violation.notes))


def _words(log: _Log, at: int, answer: JSON) -> str:
    """An answer in words."""
    *_, event = (one for one in log.read(at, answer) if isinstance(one, Returned))
    return answer_words(event.answer, tuple(map(name_words, event.names)))


def _others(system: System, log: _Log, at: int) -> Iterator[JSON]:
    """What could have come in the place of an answer: another name, or another code of its operation."""
    line = log.lines[at][1]
    operation = system.spec.operations.get(_call(log.lines, at)["method"])
    if answered_with(line) == "result":
        text, names = json.dumps(line["result"]), _names(log, at)
        named = [name for name in names if json.dumps(name) in text]
        for name, other in itertools.product(named, (one for one in names if one not in named)):
            yield {**line, "result": json.loads(text.replace(json.dumps(name), json.dumps(other)))}
    codes = dict.fromkeys(rule.code for rule in (operation.refusals if operation else ()))
    for code in codes:
        yield {"return": line["return"], "error": {"status": code, "message": ""}}


def _names(log: _Log, at: int) -> list[str]:
    """The names that stand in the lines up to one, as texts."""
    events = log.read(at, log.lines[at][1])
    found = dict.fromkeys(name for event in events for name in getattr(event, "names", ()))
    return [name for name in found if isinstance(name, str)]
