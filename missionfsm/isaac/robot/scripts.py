"""Conversations worth having with a robot, and what they are made of: each goes where chance seldom does."""

from __future__ import annotations

from missionfsm.isaac.shared.naming import MESSAGE
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionProto, signed
from missionfsm.kernel.language import JSON, ScriptStep, as_text, new, pick


def mission(config: str, uuid: JSON, channel: str = "mission") -> JSON:
    """The drive by which a mission arrives, in a message of its own each time: a robot may pass over repeats."""
    header = {
        "channel": channel,
        "pubtime": "1700000000000000000",
        "acqtime": "1700000000000000000",
        "proto": str(signed(TYPE_IDS[MissionProto])),
        "uuid": new(MESSAGE),
    }
    line = {"header": header, "payload": {"uuid": uuid, "config": {"serialized": config}}}
    return {"event": "line", "line": as_text(line)}


EVENTS: dict[str, JSON] = {
    "succeeds": {"event": "behaviorSucceeded"},
    "fails": {"event": "behaviorFailed"},
    "tick": {"event": "advance", "seconds": 0.05},
    "1s": {"event": "advance", "seconds": 1},
    "40s": {"event": "advance", "seconds": 40},
    "90s": {"event": "advance", "seconds": 90},
    "drops": {"event": "disconnect"},
    "connects": {"event": "connect"},
}
"""What happens besides lines, by the words of scripts."""

_DOUBTFUL = {
    "unusable": "no json",
    "null": "null",
    "blank": "",
    "shallow": '{"a":1}',
    "odd": "[1,2]",
    "unknown": '{"a":{"b":{"c":1}}}',
}
"""Configurations that a robot may be unable to use, by what is wrong with them."""


_WORDS = {
    "settle": ScriptStep("settle"),
    "mission": ScriptStep("drive", mission("{}", new("uuid"))),
    "again": ScriptStep("drive", mission("{}", pick("uuid")), ((0, 0),)),
    **{word: ScriptStep("drive", event) for word, event in EVENTS.items()},
    **{word: ScriptStep("drive", mission(config, new("uuid"))) for word, config in _DOUBTFUL.items()},
}


def script(text: str) -> tuple[ScriptStep, ...]:
    """A script from its words, for the usual world."""
    return tuple(_WORDS[word] for word in text.split())


SCRIPTS = tuple(
    map(
        script,
        (
            # The mission that runs arrives again; it ends, and arrives once more.
            "mission 1s settle again settle 1s settle succeeds 1s settle again 1s settle fails 1s settle",
            # Missions that cannot be used, with and without one that runs, and what runs then ends.
            *(
                f"{word} settle 1s settle mission 1s settle {word} settle 1s settle succeeds settle 1s settle"
                for word in _DOUBTFUL
            ),
            # Missions preempt one another faster than a tick.
            "mission tick mission mission settle 1s settle fails mission settle 1s settle",
            # A connection drops while nothing runs, while a mission runs, and while it ends.
            "90s settle drops settle connects settle 90s settle mission 1s settle drops settle 1s settle connects "
            "settle 90s settle drops succeeds settle connects settle 90s settle mission settle 90s settle fails "
            "settle 90s settle",
        ),
    )
)
