"""How a line shows what a robot owes: which status, which name, and what is wrong with one that does not."""

from __future__ import annotations

from collections.abc import Hashable

from attrs import evolve

from missionfsm.isaac.robot import rules
from missionfsm.isaac.robot.due import FINAL
from missionfsm.isaac.robot.readings import AI_10, AI_25_HEADER, AI_27_UUID, AI_28_STATUS
from missionfsm.isaac.robot.state import Codelet, Earlier, Introduction, Other, Report
from missionfsm.isaac.shared.line import LineContent
from missionfsm.isaac.shared.stream import miswritten
from missionfsm.kernel.language import Assumption, Delivery, Malformed, Match, Mismatch, Refs

RULES = {"running": rules.RUNNING, **FINAL}
_KINDS = {"mission": "a mission", "status": "a status", "text": "a text", "other": "a message of another type"}
_FORMS = {"upper": "c", "lower": "d", "number": "e"}


def matches(
    view: Report | Introduction | Other | Earlier, content: LineContent | Malformed
) -> tuple[Match, ...] | Mismatch:
    """The ways in which a line shows what is owed, or why it does not."""
    if isinstance(content, Malformed):
        return Mismatch(rules.ENVELOPE.id, content.says)
    wrong = miswritten(content, rules.TYPES, rules.INTEGERS)
    if wrong:
        return wrong
    assumes = (AI_25_HEADER["n" if content.bare else "s"],) if content.stamped else ()
    if content.borrowed:
        assumes = (*assumes, AI_27_UUID["b"])
    common = (rules.ENVELOPE.id, rules.INTEGERS.id, rules.TYPES.id)
    if isinstance(view, Other):
        return _goes_its_own_way(view, content, assumes)
    if isinstance(view, Introduction):
        return _introduces(view, content, assumes, common)
    if isinstance(view, Earlier):
        return _is_earlier(view, content, assumes, common)
    return _reports(view, content, assumes, common)


def _goes_its_own_way(
    view: Other, content: LineContent, assumes: tuple[Assumption, ...]
) -> tuple[Match, ...] | Mismatch:
    if content.kind not in ("other", "text") or content.channel in view.channels:
        return Mismatch(rules.ENVELOPE.id, f"{_KINDS[content.kind]} on {content.channel!r} is no affair of others")
    return (Match(assumes),)


def _introduces(
    view: Introduction, content: LineContent, assumes: tuple[Assumption, ...], common: tuple[str, ...]
) -> tuple[Match, ...] | Mismatch:
    if content.kind == "status" and content.what in RULES:
        return Mismatch(RULES[content.what].id, f"no {content.what.upper()} is due, only the robot's name is")
    if content.kind != "text":
        return Mismatch(rules.NAMED.id, f"the robot's name is due, not a {content.kind} message")
    if content.channel != view.channel:
        return Mismatch(rules.NAMED.id, f"the name came on channel {content.channel!r}, not {view.channel!r}")
    if not content.what or view.name not in (None, content.what):
        return Mismatch(rules.NAMED.id, f"the robot is called {view.name!r}, not {content.what!r}")
    return (Match(assumes, rules=(rules.NAMED.id, *common)),)


def _reports(
    view: Report, content: LineContent, assumes: tuple[Assumption, ...], common: tuple[str, ...]
) -> tuple[Match, ...] | Mismatch:
    rule = RULES[view.status]
    if content.kind != "status":
        return Mismatch(rule.id, f"{view.status} is due, not a {content.kind} message")
    if content.channel != view.channel:
        near = content.what == view.status
        says = f"the status came on channel {content.channel!r}, not {view.channel!r}"
        return Mismatch(rules.CHANNEL.id, says, near=near)
    if content.what != view.status:
        return Mismatch(rule.id, f"{view.status.upper()} is due, not {content.what.upper()}")
    assumes = (AI_28_STATUS[_FORMS[content.form]], *assumes)
    if not view.named:
        return (Match(assumes, rules=(rule.id, *common)),)
    if not content.named:
        return (Match((*assumes, AI_10["a"]), rules=(rule.id, *common)),)
    return (Match((*assumes, AI_10["b"]), ((0, 0),), (rule.id, rules.ABOUT.id, rules.CHANNEL.id, *common)),)


def _is_earlier(
    view: Earlier, content: LineContent, assumes: tuple[Assumption, ...], common: tuple[str, ...]
) -> tuple[Match, ...] | Mismatch:
    if content.kind != "status" or content.channel != view.channel or content.what not in RULES:
        return Mismatch(rules.ABOUT.id, "a status of a mission from before the log may come, nothing else")
    names = (AI_10["b"],) if content.named else ()  # one without may be of a mission without
    return (Match((AI_28_STATUS[_FORMS[content.form]], *names, *assumes), rules=common),)


def undelivered(view: Report | Introduction | Other | Earlier) -> tuple[str, ...]:
    """What is broken where a line is owed and does not come."""
    if isinstance(view, Other | Earlier):
        return ()
    return (rules.NAMED.id,) if isinstance(view, Introduction) else (RULES[view.status].id,)


def unowed(here: Codelet, topic: Hashable, content: LineContent | Malformed, _: Refs) -> tuple[str, ...]:
    """What is broken by a line that nothing owes: a final status comes once, and nothing without a connection."""
    if not here.connected and here.begun:
        return (rules.LINKED.id,)
    if topic == "others":
        return (rules.ENVELOPE.id,)
    if topic == "names" or not isinstance(content, LineContent) or content.what not in RULES:
        return ()
    return (RULES[content.what].id,)


_ANY = Delivery(unending=(rules.ENVELOPE.id,), malformed=(rules.ENVELOPE.id,), every_time=True)
_NAMES = evolve(_ANY, unowed=(rules.NAMED.id,))
_OTHERS = evolve(_ANY, unowed=(rules.ENVELOPE.id,))
_STATUSES = evolve(_ANY, unowed=(rules.RUNNING.id,), named=(rules.ABOUT.id,))


def delivery(topic: Hashable) -> Delivery:
    """What is broken by a line that nothing owes, or by one that does not come: RUNNING and the name come again."""
    return {"names": _NAMES, "others": _OTHERS}.get(str(topic), _STATUSES)
