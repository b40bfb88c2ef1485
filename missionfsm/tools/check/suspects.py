"""Answers before a violation that may be what is wrong: the event that nothing explains only shows it."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.rules import OK
from missionfsm.kernel.system import System
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.explain import MAX_RULES
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.phrases import described, rules_in_words
from missionfsm.tools.check.verdict import Violation

MAX_SUSPECTS = 2
"""Of how many answers it is told that everything would be explained without one of them; more of them say nothing."""


@frozen
class Suspect:
    """An answer without which everything is explained.

    Attributes:
        says: the call and its answer, in words.
        code: the status name of the answer.
        rules: ids of the rules by which it was allowed.
    """

    says: str
    code: str
    rules: tuple[str, ...]


def suspects(
    system: System, history: tuple[JSON, ...], readings: Mapping[str, str] | None = None
) -> tuple[Suspect, ...]:
    """Answers before the last event without which everything can be explained: perhaps one of those was wrong.

    A violation shows where the last explanation died. Where an earlier answer was explained by an assumption that only
    the last event refuted, that answer is the one to look at.
    """
    first, lines = head(history[0]), history[1:]
    found = []
    methods = system.codec.methods
    answered = {line["call"] for line in lines if line.get("method") in methods}
    for at, line in enumerate(lines[:-1]):
        if line.get("return") not in answered:
            continue
        judge = Judge(system, first, readings=readings, lost=frozenset({line["return"]}))
        if all(judge.feed(one) for one in (*lines[:at], *lines[at + 1 :])):
            found.append(_suspect(system, history, at, readings))
    return tuple(found)


def _suspect(system: System, history: tuple[JSON, ...], at: int, readings: Mapping[str, str] | None) -> Suspect:
    """The answer on a line, with the rules by which it was allowed."""
    lines = history[1:]
    line = lines[at]
    call = next(one for one in lines if one.get("call") == line["return"])
    code = OK if "result" in line else line["error"]["status"]
    request = system.codec.read_request(
        call["method"], system.codec.split_request(call["method"], call.get("params", {}))[1]
    )
    judge = Judge(system, head(history[0]), readings=readings, apart=True)
    for one in lines[:at]:
        judge.feed(one)
    before = judge.exercised
    judge.feed(line)
    rules = tuple(rule for rule, times in judge.exercised.items() if times > before.get(rule, 0))
    return Suspect(f"{described(system.spec, request)} was answered {code}", code, rules)


def with_suspects(system: System, violation: Violation, readings: Mapping[str, str] | None = None) -> Violation:
    """The violation with a note on answers before it that may be the ones that are wrong.

    Where it is an answer that is wrong, an earlier one that was OK is no suspect: without what it made there would be
    nothing to be wrong about. Where it is what is shown, the rules of the only suspect come first. `readings` are those
    that the implementation has to follow.
    """
    if not violation.history:
        return violation
    answered = "return" in violation.history[-1]
    found = [one for one in suspects(system, violation.history, readings) if not answered or one.code != OK]
    if not found or len(found) > MAX_SUSPECTS:
        return violation
    notes = tuple(f"without this answer everything is explained: {one.says}" for one in found)
    rules = violation.rules
    if len(found) == 1 and not answered:
        own = rules_in_words(system.spec, found[0].rules)
        rules = tuple(dict.fromkeys((*own, *rules)))[:MAX_RULES]
    return evolve(violation, rules=rules, notes=(*violation.notes, *notes))
