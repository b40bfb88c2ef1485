"""Where the page can be read in more than one way as to the robot's side; ``specs/isaac-robot.md`` argues each."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.isaac.shared import readings as shared
from missionfsm.kernel.readings import Ambiguity, asked_of_each, declared

AI_10 = Ambiguity(
    "AI-10",
    "How does a status say which mission it is about?",
    {"a": "it does not: there is one mission at a time", "b": "by the mission's uuid in the payload"},
    default="b",
    rule="a-status-is-about-its-mission",
)
AI_15_MISSION = Ambiguity(
    "AI-15.mission",
    "What becomes of the mission that runs when the robot's connection drops?",
    {
        "a": "it goes on",
        "b": "it is given up without a word",
        "c": "it fails, which is told once the connection is there again",
    },
    rule="nothing-is-said-without-a-connection",
)
AI_15_STATUS = Ambiguity(
    "AI-15.status",
    "What becomes of a status that is due while there is no connection?",
    {"a": "it is lost", "b": "it is sent once the connection is there again"},
    rule="nothing-is-said-without-a-connection",
)
AI_25_TAKEN = Ambiguity(
    "AI-25.taken",
    "Is a mission understood whose 64-bit integers are numbers instead of strings?",
    {"a": "yes, both are", "b": "no, strings only: it is no message", "c": "no: it is a mission that fails"},
    rule="a-mission-starts-the-behavior-tree",
)
AI_25_HEADER = shared.AI_25_HEADER
AI_27_TYPE = Ambiguity(
    "AI-27.type",
    "What is a message of another type on the mission channel?",
    {"a": "nothing to the codelet", "b": "a mission without a configuration: only the channel counts"},
    flagged="b",
    rule="what-is-no-mission-has-no-effect",
)
AI_27_UUID = shared.AI_27_UUID
AI_27_TAKEN = Ambiguity(
    "AI-27.taken",
    "Is a mission understood whose header has no type id, or an unsigned one?",
    {"a": "yes", "b": "no, it is no message", "c": "no: it is a mission that fails"},
    rule="a-mission-starts-the-behavior-tree",
)
AI_28_TAKEN = Ambiguity(
    "AI-28.taken",
    "What is a mission whose configuration is JSON itself instead of a text that holds it?",
    {"a": "one with that configuration", "b": "one whose configuration cannot be used", "c": "no message"},
    rule="a-mission-starts-the-behavior-tree",
)
AI_28_STATUS = Ambiguity(
    "AI-28.status",
    "How is a status written?",
    {"c": "by its name in capitals", "d": "by its name in lower case", "e": "by its number"},
    default="d",
    flagged="e",
    rule="a-line-is-one-message",
)
AI_31_SENT = {
    status: Ambiguity(
        f"AI-31.{status}", question, {"a": "at once", "b": "on the codelet's own tick"}, alike="AI-31", rule=rule
    )
    for status, question, rule in (
        ("end", "When is the final status sent?", "one-success-at-the-end"),
        ("preempted", "When is the FAILURE of a preempted mission sent?", "a-new-mission-preempts"),
        (
            "unusable",
            "When is the FAILURE of a mission sent whose configuration cannot be used?",
            "an-unusable-configuration-fails-the-mission",
        ),
    )
}
"""By the status that is due."""

AI_31_READ = Ambiguity(
    "AI-31.read",
    "When is a message read?",
    {"a": "as it arrives", "b": "on the codelet's own tick, once it was reported that the tree had stopped before"},
    rule="a-new-mission-preempts",
)
AI_31_IDLE = Ambiguity(
    "AI-31.idle",
    "What is it where the behavior tree stops while no mission runs?",
    {"a": "it does not happen: a mission starts the tree", "b": "nothing to the codelet"},
    flagged="b",
    rule="a-mission-starts-the-behavior-tree",
)
AI_32_SAME = Ambiguity(
    "AI-32.same",
    "What is a MissionProto with the uuid of the mission that runs?",
    {"a": "a mission that preempts it, like any other", "b": "nothing: that mission runs already"},
    rule="a-new-mission-preempts",
)
_USED, _FAILS, _PASSED = (
    "one that can be used",
    "one that cannot be used: the mission fails",
    "a reason to pass over the mission",
)
AI_33_CONFIGURED = {
    what: Ambiguity(
        f"AI-33.{what}",
        f"What is a configuration {says}?",
        dict(zip("abc", answers, strict=True)),
        flagged=flagged,
        rule="an-unusable-configuration-fails-the-mission",
    )
    for what, says, answers, flagged in (
        ("null", "that is null", ("an empty one", _FAILS, _PASSED), "c"),
        ("blank", "that is an empty text", ("an empty one", _FAILS, _PASSED), "c"),
        ("value", "that is JSON, but no object", (_FAILS, "one with nothing to set", _PASSED), "c"),
        (
            "node",
            "in which something is no node with components",
            (_USED, "one that cannot be used, as in the shipped software: the mission fails", _PASSED),
            "c",
        ),
        ("unknown", "of nodes of which nobody says whether the robot has them", (_USED, _FAILS, _PASSED), "bc"),
    )
}
"""By what the configuration is."""

AI_33_UNUSABLE = Ambiguity(
    "AI-33.unusable",
    "What becomes of a mission whose configuration is no JSON?",
    {
        "a": "it fails at once",
        "b": "it runs with the configuration as it is",
        "c": "it is passed over, and nothing is said of it",
    },
    flagged="bc",
    rule="an-unusable-configuration-fails-the-mission",
)
AI_33_RUNNING = Ambiguity(
    "AI-33.running",
    "Is RUNNING said of a mission whose configuration cannot be used?",
    {"a": "no, only FAILURE", "b": "yes, before the FAILURE"},
    rule="an-unusable-configuration-fails-the-mission",
)
AI_33_PREEMPTS = asked_of_each(
    "AI-33",
    "What becomes of a mission that runs when one comes {}?",
    {"a": "it is preempted all the same", "b": "it goes on"},
    {
        "preempts": "whose configuration is no JSON",
        "preempts-null": "that does not run since its configuration is null",
        "preempts-blank": "that does not run since its configuration is an empty text",
        "preempts-value": "that does not run since its configuration is no object",
        "preempts-node": "that does not run since something in it is no node",
        "preempts-unknown": "that does not run since its nodes are unknown",
        "preempts-written": "that fails since it is written otherwise",
    },
    rule="a-new-mission-preempts",
)

AMBIGUITIES = declared(globals(), Ambiguity)

_SERVER = "the mission server's affair"
_PROGRAM = "about the program around the mission server"

WAIVED: Mapping[str, str] = {
    **dict.fromkeys((f"AI-{number:02d}" for number in range(1, 10)), _SERVER),
    **dict.fromkeys((f"AI-{number:02d}" for number in (11, 12, 13, 14, 16, 17, 18, 19)), _SERVER),
    "AI-20": _PROGRAM,
    "AI-21": _SERVER,
    "AI-22": _SERVER,
    "AI-23": "not observable: slips in the sample",
    "AI-24": _SERVER,
    "AI-26": "the adapter protocol frames lines and cannot close a connection: what is no message is skipped",
    "AI-29": _PROGRAM,
    "AI-30": _PROGRAM,
    "AI-27 a": "other fields of a header may be missing; that a uuid comes again after others is not noticed",
    "AI-31 a, b": "no period is documented; RUNNING has to come within the stated bound, however often it does",
    "AI-32 a": "one reading is left: FAILURE for the old mission comes before anything about the new one",
    "AI-33 a, b": "whether earlier values persist cannot be seen from outside",
    "AI-34": "the three states are those of the wire; the others are the server's",
    "AI-35": _SERVER,
    "AI-36": _SERVER,
    "AI-37": "the name is compared with the one that the world tells; where that is null, any is right",
    "AI-38": "no message with data buffers is sent to a robot",
    "AI-39": _SERVER,
}
"""Entries, or readings of them, that make no ambiguity of the robot's side, each with the reason."""
