"""What the page promises of the mission codelet and of the lines that it sends. ``MissionSubmission``."""

from __future__ import annotations

from missionfsm.isaac.robot.state import SYSTEM_NAME
from missionfsm.isaac.shared import promises
from missionfsm.isaac.shared.line import MISSION_SUBMISSION as PAGE
from missionfsm.isaac.shared.promises import CLIENT
from missionfsm.kernel.language import Citation, Rule, declared, promise

CODELET = PAGE["Mission Codelet"]


def _promise(topic: str, name: str, says: str, cite: Citation, argues: str = "") -> Rule:
    return promise(name, says, cite=cite, argues=argues).registered(SYSTEM_NAME, topic)


STARTS = _promise(
    "codelet", "a-mission-starts-the-behavior-tree", "A MissionProto that arrives starts a mission.", CODELET
)
LISTENS = _promise(
    "codelet",
    "a-mission-can-follow-another",
    "When a mission has ended, the codelet listens for the next one.",
    PAGE["Mission Codelet", "step 5"],
)
PREEMPTS = _promise(
    "codelet",
    "a-new-mission-preempts",
    "A MissionProto that arrives during a mission stops that mission, which is reported as FAILURE, and then runs.",
    PAGE["Mission Codelet", "preemption"],
    "AI-32: the FAILURE of the old mission comes before anything about the new one.",
)
UNUSABLE = _promise(
    "codelet",
    "an-unusable-configuration-fails-the-mission",
    "A mission whose configuration cannot be used is reported as FAILURE at once.",
    PAGE["Mission Codelet", "step 1"],
    "Known of the shipped codelet; the page says only that the configuration is used (AI-33.unusable).",
)
IGNORES = _promise(
    "codelet",
    "what-is-no-mission-has-no-effect",
    "A line that is no MissionProto on the mission channel changes nothing.",
    CODELET,
    "AI-26 e: a line that cannot be read is skipped.",
)
RUNNING = _promise(
    "status",
    "running-while-the-tree-runs",
    "RUNNING is reported while the behavior tree runs, periodically, and never else.",
    PAGE["Mission Codelet", "step 3"],
    "AI-31: no period is documented; at the latest it comes within the bound that the tester keeps to.",
)
SUCCESS = _promise(
    "status",
    "one-success-at-the-end",
    "When the behavior tree reports success, one final SUCCESS is sent.",
    PAGE["Mission Codelet", "step 4"],
)
FAILURE = _promise(
    "status",
    "one-failure-at-the-end",
    "When the behavior tree reports failure, or is preempted, one final FAILURE is sent.",
    PAGE["Mission Codelet", "step 4"],
)
ABOUT = _promise(
    "status", "a-status-is-about-its-mission", "A status that names a mission names the one that it is about.", CODELET
)
CHANNEL = _promise(
    "status",
    "statuses-go-to-the-status-channel",
    'A MissionStatusProto is sent on the status channel, "mission_status" unless something else is said.',
    PAGE["Sample Usage", "status_channel"],
)
NAMED = _promise(
    "connection",
    "the-name-is-said-again-and-again",
    "The robot says its name on the name channel, again and again: on every connection, whether a mission runs or not.",
    PAGE["JsonMockup"],
    "No period is documented; at the latest it comes within the bound that the tester keeps to.",
)
LINKED = _promise(
    "connection",
    "nothing-is-said-without-a-connection",
    "While there is no connection nothing arrives and nothing is said.",
    CLIENT,
    "AI-15: what becomes of the mission that runs and of its statuses.",
)
ENVELOPE = promises.ENVELOPE.registered(SYSTEM_NAME, "line")
TYPES = _promise(
    "line",
    "a-type-id-is-signed",
    "The type id in a header is the payload's, as a signed 64-bit integer.",
    CLIENT,
    "A fact of the wire; a header that has none is understood by its payload. Whose its uuid is: AI-27.uuid.",
)
INTEGERS = promises.INTEGERS.registered(SYSTEM_NAME, "line")
RULES = declared(globals(), Rule)
