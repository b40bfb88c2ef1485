"""What is seen of a mission server: the statuses that it shows, and the lines that it sends."""

from __future__ import annotations

from collections.abc import Iterator

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.alike import told_apart
from missionfsm.isaac.server.deciding import assumed as decided_between
from missionfsm.isaac.server.readings import (
    AI_02_ABORTED,
    AI_02_CANCELED,
    AI_04,
    AI_04_NEW,
    AI_04_ROBOT,
    AI_04_SENT,
    AI_10,
    AI_25_HEADER,
    AI_27_UUID,
    AI_28_CONFIG,
    AI_28_UUID,
    AI_39,
    AI_39_REPORTS,
)
from missionfsm.isaac.server.rules import OPERATIONS
from missionfsm.isaac.server.state import Closes, Mission, Sends, Server, Status, handle_ref
from missionfsm.isaac.server.striking import all_settled
from missionfsm.isaac.server.unseen import nothing_open_happened
from missionfsm.isaac.shared.line import LineContent
from missionfsm.isaac.shared.stream import miswritten
from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import UNCONSTRAINED, Assumption, meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.step import Match, Mismatch, Step
from missionfsm.kernel.text import differing

_ABORTED = {"c": "timed out", "a": "aborted", "b": "failed"}
"""AI-02.aborted: how missions are called that were aborted."""

_LOST_IS_CALLED = ("failed", "aborted")
"""What a mission may be called whose robot was lost: it is said nowhere."""

Called = tuple[tuple[str, tuple[Assumption, ...]], ...]


def _called_queued(server: Server, mission: Mission) -> Called:
    """What a mission that is queued may be shown as."""
    reasons = []
    if mission.waits or mission.doomed:
        reasons.append((AI_04["a"], AI_04["b"]))
    if server.serving(mission.robot) is None:
        reasons.append((AI_04_ROBOT["q"], AI_04_ROBOT["r"]))
    queued = [reason[0] for reason in reasons]
    created = [reason[1] for reason in reasons]
    if mission.new is not None:
        queued += [AI_04_NEW["a"]] if mission.new else []  # else a pass may have come
        created.append(AI_04_NEW["b"])
    return ("queued", tuple(queued)), *(("created", (reason,)) for reason in created)


def _called(server: Server, mission: Mission) -> Called:
    """What a mission may be shown as, each with what that assumes."""
    status = mission.status
    if mission.was is not None:
        earlier = _called(server, evolve(mission, status=mission.was[0], was=None))
        unlooked = tuple((word, (*assumes, AI_39["b"], AI_39_REPORTS["b"])) for word, assumes in earlier)
        fresh = (AI_39_REPORTS["a"],) if mission.was[2] else ()
        now = _called(server, evolve(mission, was=None))
        return (*((word, (*assumes, *fresh)) for word, assumes in now), *unlooked)
    if status is Status.STARTED:
        return ("started", (AI_04_SENT["s"],)), ("queued", (AI_04_SENT["t"],))
    if status is Status.CANCELED:
        return ("canceled", (AI_02_CANCELED["a"],)), ("failed", (AI_02_CANCELED["b"],))
    if status is Status.ABORTED:
        return tuple((word, (AI_02_ABORTED[letter],)) for letter, word in _ABORTED.items())
    if status is Status.QUEUED:
        return _called_queued(server, mission)
    return (("lost" if status is Status.LOST else status.value.lower(), ()),)


def status_answers(server: Server) -> Iterator[Step]:
    """The answers to ``statuses``, one for each way in which the readings name what is there."""
    for base in all_settled(nothing_open_happened(server)):
        yield from _answers(server, base)


def _answers(before: Server, server: Server) -> Iterator[Step]:
    """The answers where things stand so, and what has been decided about a server as it was before."""
    before_it = decided_between(before, server)
    found: dict[tuple[tuple[str, ...], int], tuple[Assumption, ...]] = {((), UNCONSTRAINED): before_it}
    for mission in server.missions:
        longer: dict[tuple[tuple[str, ...], int], tuple[Assumption, ...]] = {}
        for (words, assumed), assumes in found.items():
            for word, more in _called(server, mission):
                agreed = meet(assumed, more)
                if agreed:
                    both = tuple(dict.fromkeys((*assumes, *more)))
                    longer.setdefault(((*words, word), agreed), both)
        found = longer
    handles = tuple(handle_ref(index) for index in range(len(server.missions)))
    promised = tuple(rule.id for rule in OPERATIONS["statuses"].promises)
    for (words, _), assumes in found.items():
        after = told_apart(_looked_at(server, words), words)
        yield Step(after, answer=Answer(OK, words), refs=handles, rules=promised, assumes=assumes)


def _looked_at(server: Server, words: tuple[str, ...]) -> Server:
    """A scheduling pass has looked at the missions that are not shown as CREATED (AI-04.new b)."""
    looked = {at for at, one in enumerate(server.missions) if one.new is not None and words[at] != "created"}
    missions = (evolve(one, new=None) if at in looked else one for at, one in enumerate(server.missions))
    return evolve(server, missions=tuple(missions)) if looked else server


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
        if one != other and not (one == "lost" and other in _LOST_IS_CALLED)
    ]
    if not wrong:
        return (Match(),)
    one, other = min(wrong, key=_comes_first)
    besides = ", though no upstream of it has failed" if other == "canceled" else ""
    return Mismatch(_broken(one, other), f"a mission that is {one} is shown as {other}{besides}")


def _comes_first(pair: tuple[str, str]) -> int:
    """Which of several missions that are shown otherwise is told of: one that failed may have cancelled others."""
    other = pair[1]
    return 0 if other in (*_GIVEN_UP, "lost", "failed") else 1 if other == "canceled" else 2


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


def matches(view: Sends | Closes, content: LineContent | Malformed) -> tuple[Match, ...] | Mismatch:
    """Whether a line is the MissionProto that is owed, with what it assumes."""
    if isinstance(content, Malformed):
        return Mismatch(rules.ENVELOPE.id, content.says)
    if isinstance(view, Closes):
        return Mismatch(rules.SENT.id, "the connection has to end")
    if content.kind != "mission":
        return Mismatch(rules.SENT.id, f"a mission is due, not a {content.kind} message")
    wrong = miswritten(content, rules.ENVELOPE, rules.INTEGERS)
    if wrong:
        return wrong
    if content.channel != view.channel:
        says = f"the mission came on channel {content.channel!r}, not {view.channel!r}"
        return Mismatch(rules.CHANNEL.id, says, near=content.what == view.config)
    if content.what != view.config:
        came, due = differing(str(content.what), view.config)
        return Mismatch(rules.CONFIG.id, f"the configuration is {came}, not {due}", near=True)
    assumes = (
        AI_28_CONFIG["b" if content.form == "text" else "a"],
        AI_25_HEADER["n" if content.bare else "s"],
        AI_28_UUID["y" if content.named else "n"],
    )
    justified = (rules.CHANNEL.id, rules.CONFIG.id, rules.ENVELOPE.id, rules.INTEGERS.id)
    return tuple(Match((*assumes, *whose), ((0, 0),) if content.named else (), justified) for whose in _header(content))


def _header(content: LineContent) -> tuple[tuple[Assumption, ...], ...]:
    """What the uuid in the header of a mission assumes: where a server goes by it, it is the mission's (AI-10 c)."""
    if content.borrowed:
        return (AI_27_UUID["b"],), (AI_10["c"],)
    return ((AI_10.besides("c"),),) if content.named else ((),)


def may_be_called(server: Server, index: int, word: object) -> bool:
    """Whether a mission is called so under some reading as things stand."""
    words = {word for one in all_settled(server) for word, _ in _called(one, one.missions[index])}
    return word in words or ("lost" in words and word in _LOST_IS_CALLED)
