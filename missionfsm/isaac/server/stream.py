"""What is seen of a mission server: the statuses that it shows, and the lines that it sends."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.readings import (
    AI_02,
    AI_04,
    AI_25_HEADER,
    AI_28_CONFIG,
)
from missionfsm.isaac.server.rules import OPERATIONS
from missionfsm.isaac.server.state import (
    Mission,
    Sends,
    Server,
    Status,
)
from missionfsm.isaac.server.time import calmed
from missionfsm.isaac.shared.line import LineContent
from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.history import Answer
from missionfsm.kernel.rules import OK
from missionfsm.kernel.step import Match, Mismatch, Step

_CANCELED = {"a": "canceled", "b": "failed", "c": "canceled"}
_ABORTED = {"a": "aborted", "b": "failed", "c": "timed out"}
"""AI-02: how missions are called that were cancelled and that were aborted."""


def _word(mission: Mission, names: str, waiting: str) -> str:
    """How a mission is shown under AI-02 read as `names` and AI-04 as `waiting`."""
    if mission.status is Status.CANCELED:
        return _CANCELED[names]
    if mission.status is Status.ABORTED:
        return _ABORTED[names]
    if mission.status is Status.QUEUED and (mission.waits or mission.doomed):
        return {"a": "queued", "b": "created"}[waiting]
    return "lost" if mission.status is Status.LOST else mission.status.value.lower()


def shown(server: Server) -> Iterator[Step]:
    """The answers to ``statuses``, one for each way in which the readings name what is there."""
    found: dict[tuple[str, ...], tuple[str, str]] = {}
    for names, waiting in itertools.product(AI_02.readings, AI_04.readings):
        shape = tuple(_word(one, names, waiting) for one in server.missions)
        before = found.get(shape, ("", ""))
        found[shape] = (before[0] + names * (names not in before[0]), before[1] + waiting * (waiting not in before[1]))
    handles = tuple(2 * index for index in range(len(server.missions)))
    told = tuple(rule.id for rule in OPERATIONS["statuses"].promises)
    quiet = calmed(server)
    for shape, letters in sorted(found.items(), key=lambda one: AI_02.default not in one[1][0]):
        assumes = tuple(
            question[tuple(kept)]
            for question, kept in zip((AI_02, AI_04), letters, strict=True)
            if len(kept) < len(question.readings)
        )
        yield Step(quiet, answer=Answer(OK, shape), refs=handles, rules=told, assumes=assumes)


def agrees(allowed: object, came: object) -> tuple[Match, ...] | Mismatch:
    """Whether an answer is one that is allowed; how a mission is called whose robot was lost is nowhere said."""
    if isinstance(came, Malformed):
        return Mismatch(OPERATIONS["statuses"].promises[0].id, came.says)
    if allowed == came:
        return (Match(),)
    if not isinstance(allowed, tuple) or not isinstance(came, tuple) or len(came) != len(allowed):
        return Mismatch(OPERATIONS["statuses"].promises[0].id, "not every mission is shown, or too many are")
    wrong = [
        (one, other)
        for one, other in zip(allowed, came, strict=True)
        if one != other and not (one == "lost" and other in ("failed", "aborted"))
    ]
    if not wrong:
        return (Match(),)
    one, other = next((pair for pair in wrong if pair[1] == "canceled"), wrong[0])
    besides = ", though no upstream of it has failed" if other == "canceled" else ""
    return Mismatch(_broken(one, other), f"a mission that is {one} is shown as {other}{besides}")


_GIVEN_UP = ("aborted", "timed out")
_REPORTED = ("success", "failed")


def _broken(one: str, other: str) -> str:
    """The rule that a server breaks that shows a mission as `other` where it is `one`."""
    pair = {one, other}
    if "canceled" in pair:
        return rules.CANCELED.id
    if not pair.isdisjoint(_GIVEN_UP):
        return (rules.OVERRUN if "running" in pair else rules.ABORTED).id
    if "lost" in pair:
        return rules.DROPPED.id
    if not pair.isdisjoint(_REPORTED):
        return (rules.LATE if pair <= set(_REPORTED) else rules.FINAL).id
    if pair == {"started", "running"}:
        return rules.RUNNING.id
    return (OPERATIONS["statuses"].promises[0] if pair == {"queued", "created"} else rules.SENT).id


def matches(view: Sends, content: LineContent | Malformed) -> tuple[Match, ...] | Mismatch:
    """Whether a line is the MissionProto that is owed, with what it assumes."""
    if isinstance(content, Malformed):
        return Mismatch(rules.ENVELOPE.id, content.says)
    if content.kind != "mission":
        return Mismatch(rules.SENT.id, f"a mission is due, not a {content.kind} message")
    wrong = [path for path in content.bare if path != "header.uuid"]
    if wrong:
        return Mismatch(rules.INTEGERS.id, f"{wrong[0]} is a number", near=True)
    if content.channel != view.channel:
        says = f"the mission came on channel {content.channel!r}, not {view.channel!r}"
        return Mismatch(rules.CHANNEL.id, says, near=content.what == view.config)
    if content.what != view.config:
        return Mismatch(rules.CONFIG.id, f"the configuration is {content.what}, not {view.config}", near=True)
    assumes = (AI_28_CONFIG["b" if content.form == "text" else "a"], AI_25_HEADER["n" if content.bare else "s"])
    told = (rules.CHANNEL.id, rules.CONFIG.id, rules.ENVELOPE.id, rules.INTEGERS.id)
    return (Match(assumes, ((0, 0),) if content.named else (), told),)


def may_be_called(mission: Mission, word: object) -> bool:
    """Whether a mission that stands where it stands is called so under some reading."""
    words = {_word(mission, names, waiting) for names in AI_02.readings for waiting in AI_04.readings}
    return word in words or ("lost" in words and word in ("failed", "aborted"))
