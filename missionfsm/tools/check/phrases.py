"""Events, answers, names and rules in words. Each is one line, whatever an implementation put into it."""

from __future__ import annotations

from collections.abc import Iterable

from missionfsm.kernel.history import Answer, Called, Driven, Ended, Event, Name, Received, Returned, Settled
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.text import printable
from missionfsm.tools.check.verdict import CitedRule


def rules_in_words(spec: Spec, rule_ids: Iterable[str], operation: str = "") -> tuple[CitedRule, ...]:
    """Rules in words, each once.

    Args:
        spec: the system.
        rule_ids: their ids.
        operation: the operation at hand: a rule that stands in several sections is cited from that operation's.
    """
    named = list(dict.fromkeys(rule_ids))
    known = spec.rules_by_id
    if not known.keys() >= set(named):
        known = {**spec.implied, **known}
    found = (known[one] for one in named if one in known)
    return tuple(CitedRule(rule.id, rule.says, str(rule.place(operation))) for rule in found)


def described(spec: Spec, value: object) -> str:
    """A value of a system in a few words, on one line."""
    return printable(spec.describe(value))


def event_words(spec: Spec, event: Event) -> str:
    """An event in a few words."""
    if isinstance(event, Called):
        return described(spec, event.request)
    if isinstance(event, Returned):
        return "answered " + answer_words(event.answer, tuple(map(name_words, event.names)))
    if isinstance(event, Received):
        return f"{name_words(event.channel)} showed {described(spec, event.content)}"
    if isinstance(event, Ended):
        return f"{name_words(event.channel)} ended" + (f" with {event.code}" if event.code != OK else " cleanly")
    if isinstance(event, Driven):
        return described(spec, event.event)
    return "everything settled" if isinstance(event, Settled) else "a stream was cancelled"


def answer_words(answer: Answer, names: tuple[str, ...]) -> str:
    """An answer with its names."""
    return printable(f"{answer}{' ' + ', '.join(names) if names else ''}")


def name_words(name: Name) -> str:
    """A name as a person reads it."""
    return printable(" ".join(map(str, name)) if isinstance(name, tuple) else str(name))
