"""Earlier events that may be what is wrong, so that the event which nothing explains only shows it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Driven
from missionfsm.kernel.rules import OK
from missionfsm.kernel.system import System
from missionfsm.oracle.transcript import Transcript, answered_with, head
from missionfsm.tools.check import causes
from missionfsm.tools.check.explain import MAX_RULES
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.needed import needed
from missionfsm.tools.check.phrases import described, event_words, rules_in_words
from missionfsm.tools.check.verdict import CitedRule, Violation

MAX_SUSPECTS = 2
"""How many suspects are worth telling; more of them say nothing."""

MAX_DRIVES = 12
"""How many of the last drives are looked at."""


@frozen
class Suspect:
    """An answer or a drive without which everything is explained.

    Attributes:
        says: the call and its answer, or the drive, in words.
        code: the status of the answer; empty for a drive.
        rules: ids of the rules that allowed the answer, or by which the drive has an effect.
    """

    says: str
    code: str
    rules: tuple[str, ...]


def suspects(
    system: System, history: tuple[JSON, ...], readings: Mapping[str, str] | None = None
) -> tuple[Suspect, ...]:
    """Answers before the last event without which everything can be explained: perhaps one of those was wrong.

    A violation shows the event that ended the last explanation. If an earlier answer was explained by an assumption
    that only this event refuted, the earlier answer is the one to look at.
    """
    lines = history[1:]
    methods = system.codec.methods
    answered = {line["call"] for line in lines if line.get("method") in methods}
    return tuple(
        _of_answer(system, history, at, readings)
        for at, line in enumerate(lines[:-1])
        if line.get("return") in answered and _explained_without(system, history, at, readings)
    )


def ineffective_drives(
    system: System, history: tuple[JSON, ...], readings: Mapping[str, str] | None = None
) -> tuple[Suspect, ...]:
    """Drives before the last event without which everything can be explained: perhaps one of those had no effect."""
    drives = [at for at, line in enumerate(history[1:-1]) if "drive" in line and not _lets_time_pass(system, line)]
    return tuple(
        _of_drive(system, history, at, readings)
        for at in drives[-MAX_DRIVES:]
        if _explained_without(system, history, at, readings)
    )


def _lets_time_pass(system: System, line: JSON) -> bool:
    (event,) = Transcript(system.codec).read(line) or (None,)
    return isinstance(event, Driven) and system.spec.drives[event.event.name].later is not None  # type: ignore[attr-defined]


def _explained_without(system: System, history: tuple[JSON, ...], at: int, readings: Mapping[str, str] | None) -> bool:
    """Whether all lines but one can be explained. An answer that is left out counts as lost on the way."""
    lines = history[1:]
    lost = frozenset({lines[at]["return"]}) if "return" in lines[at] else frozenset[int]()
    judge = Judge(system, head(history[0]), readings=readings, lost=lost)
    return all(judge.feed(one) for one in (*lines[:at], *lines[at + 1 :]))


def _of_answer(system: System, history: tuple[JSON, ...], at: int, readings: Mapping[str, str] | None) -> Suspect:
    """The answer on a line, with the rules that allowed it."""
    line = history[1:][at]
    call = next(one for one in history[1:] if one.get("call") == line["return"])
    code = OK if answered_with(line) == "result" else line["error"]["status"]
    request = system.codec.read_request(
        call["method"], system.codec.split_request(call["method"], call.get("params", {}))[1]
    )
    judge = _led_to(system, history, at, readings)
    before = judge.exercised
    judge.feed(line)
    rules = tuple(rule for rule, times in judge.exercised.items() if times > before.get(rule, 0))
    return Suspect(f"{described(system.spec, request)} was answered {code}", code, rules)


def _of_drive(system: System, history: tuple[JSON, ...], at: int, readings: Mapping[str, str] | None) -> Suspect:
    """The drive on a line, with the rules by which it has an effect."""
    judge = _led_to(system, history, at, readings)
    events = judge.transcript.read(history[1:][at])
    judge.take(events)
    says = "; ".join(event_words(system.spec, one) for one in events)
    return Suspect(says, "", causes.driven(judge.belief.of_last_event))


def _led_to(system: System, history: tuple[JSON, ...], at: int, readings: Mapping[str, str] | None) -> Judge:
    """A judge that was fed all lines before one."""
    judge = Judge(system, head(history[0]), readings=readings, apart=True)
    for one in history[1:][:at]:
        judge.feed(one)
    return judge


def _shows_what_happened(violation: Violation) -> bool:
    """Whether the last event shows an effect of what happened before, so that this may be what is wrong.

    An answer with a code that is not allowed is wrong by itself.
    """
    last = violation.history[-1]
    if "return" not in last:
        return True
    return answered_with(last) == "result" and any(one.what.startswith(OK) for one in violation.expected)


def to_the_letter(system: System, history: tuple[JSON, ...]) -> Violation | None:
    """What is wrong with an answer before the last event for whoever takes the text by its letter; None if nothing is.

    Such an answer is explained only by a reading that departs from the text. In a conversation from which nothing can
    be left out, what comes of it later says less than that it came.
    """
    judge = Judge(system, head(history[0]), no_flagged=True)
    for line in history[1:-1]:
        if not judge.feed(line):
            return judge.violation if "return" in line else None
    return None


def with_suspects(system: System, violation: Violation, readings: Mapping[str, str] | None = None) -> Violation:
    """The violation with a note on earlier events that may be what is wrong.

    An earlier OK is no suspect if the last event is an answer, or if something is missing: without what it made there
    would be nothing to answer wrongly, or nothing due. The rules of a single suspect, and of a single drive that may
    have had no effect, come after the first rule of the violation, which is nearer. An answer that departs from the
    text comes before all of them.

    Args:
        system: the system.
        violation: the violation, with its history.
        readings: those that the implementation has to follow.
    """
    history = violation.history
    if not history:
        return violation
    answered, missing = "return" in history[-1], "settled" in history[-1]
    found = [one for one in suspects(system, history, readings) if not (answered or missing) or one.code != OK]
    idle = ineffective_drives(system, history, readings) if _shows_what_happened(violation) else ()
    accused = _with_answers(system, violation, found, answered=answered)
    accused = _with_drives(system, accused, idle)
    once: dict[str, CitedRule] = {}
    for one in accused.rules:
        once.setdefault(one.id, one)  # as it is cited where it is nearest
    accused = evolve(accused, rules=tuple(once.values()), notes=tuple(dict.fromkeys(accused.notes)))
    accused = evolve(accused, rules=needed(system, accused, readings)[:MAX_RULES])
    departs = None if readings else to_the_letter(system, history)
    return accused if departs is None else _before_all(departs, accused)


def _with_answers(system: System, accused: Violation, found: Sequence[Suspect], *, answered: bool) -> Violation:
    """The violation with the answers without which everything is explained, if they are few."""
    if len(found) not in range(1, MAX_SUSPECTS + 1):
        return accused
    notes = [f"without this answer everything is explained: {one.says}" for one in found]
    rules = accused.rules
    if len(found) == 1 and not answered:
        rules = (*rules[:1], *rules_in_words(system.spec, found[0].rules), *rules[1:])
        notes += ["a call that is refused changes nothing"] if found[0].code != OK else []
    return evolve(accused, rules=rules, notes=(*accused.notes, *notes))


def _with_drives(system: System, accused: Violation, idle: Sequence[Suspect]) -> Violation:
    """The violation with the drives that may have had no effect, if they are few."""
    if len(idle) not in range(1, MAX_SUSPECTS + 1):
        return accused
    notes = [f"everything is explained if this had no effect: {one.says}" for one in idle]
    own, rules = rules_in_words(system.spec, idle[-1].rules), accused.rules
    rules = (*rules[:1], *own, *rules[1:]) if len(idle) == 1 else (*rules, *own)
    return evolve(accused, rules=rules, notes=(*accused.notes, *notes))


def _before_all(departs: Violation, accused: Violation) -> Violation:
    """A violation behind what departs from the text before it."""
    rules = {one.id: one for one in (*departs.rules, *accused.rules)}
    says = f"only a reading that departs from the text explains this before it: {departs.observed}"
    return evolve(accused, rules=tuple(rules.values())[:MAX_RULES], notes=(says, *accused.notes))
