"""Where the page can be read in more than one way as to the robot's side; ``specs/isaac-robot.md`` argues each."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.kernel.readings import Ambiguity, declared

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
AI_25_HEADER = Ambiguity(
    "AI-25.header",
    "How are the halves of the header's uuid sent?",
    {"s": "as strings, like every 64-bit integer", "n": "as numbers, as the shipped software does"},
    flagged="n",
    rule="64-bit-integers-are-strings",
)
AI_27_TYPE = Ambiguity(
    "AI-27.type",
    "What is a message of another type on the mission channel?",
    {"a": "nothing to the codelet", "b": "a mission without a configuration: only the channel counts"},
    flagged="b",
    rule="what-is-no-mission-has-no-effect",
)
AI_27_UUID = Ambiguity(
    "AI-27.uuid",
    "Whose is the uuid in a header?",
    {"a": "the message's own, another one for each", "b": "the mission's, or the same again for the next message"},
    flagged="b",
    rule="a-line-is-one-message",
)
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
_TICK = {"a": "at once", "b": "on the codelet's own tick"}
AI_31_END = Ambiguity(
    "AI-31.end", "When is the final status sent?", _TICK, alike="AI-31", rule="one-success-at-the-end"
)
AI_31_PREEMPTED = Ambiguity(
    "AI-31.preempted",
    "When is the FAILURE of a preempted mission sent?",
    _TICK,
    alike="AI-31",
    rule="a-new-mission-preempts",
)
AI_31_UNUSABLE = Ambiguity(
    "AI-31.unusable",
    "When is the FAILURE of a mission sent whose configuration cannot be used?",
    _TICK,
    alike="AI-31",
    rule="an-unusable-configuration-fails-the-mission",
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
AI_33_NULL = Ambiguity(
    "AI-33.null",
    "What is a configuration that is null?",
    {"a": "an empty one", "b": "one that cannot be used: the mission fails", "c": "a reason to pass over the mission"},
    flagged="c",
    rule="an-unusable-configuration-fails-the-mission",
)
AI_33_BLANK = Ambiguity(
    "AI-33.blank",
    "What is a configuration that is an empty text?",
    {"a": "an empty one", "b": "one that cannot be used: the mission fails", "c": "a reason to pass over the mission"},
    flagged="c",
    rule="an-unusable-configuration-fails-the-mission",
)
AI_33_VALUE = Ambiguity(
    "AI-33.value",
    "What is a configuration that is JSON, but no object?",
    {
        "a": "one that cannot be used: the mission fails",
        "b": "one with nothing to set",
        "c": "a reason to pass over the mission",
    },
    flagged="c",
    rule="an-unusable-configuration-fails-the-mission",
)
AI_33_NODE = Ambiguity(
    "AI-33.node",
    "What is a configuration in which something is no node with components?",
    {
        "a": "one that can be used",
        "b": "one that cannot be used, as in the shipped software: the mission fails",
        "c": "a reason to pass over the mission",
    },
    flagged="c",
    rule="an-unusable-configuration-fails-the-mission",
)
AI_33_UNKNOWN = Ambiguity(
    "AI-33.unknown",
    "What is a configuration of nodes of which nobody says whether the robot has them?",
    {
        "a": "one that can be used",
        "b": "one that cannot be used: the mission fails",
        "c": "a reason to pass over the mission",
    },
    flagged="bc",
    rule="an-unusable-configuration-fails-the-mission",
)
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
_PREEMPTS = {"a": "it is preempted all the same", "b": "it goes on"}
AI_33_PREEMPTS = Ambiguity(
    "AI-33.preempts",
    "What becomes of a mission that runs when one comes whose configuration is no JSON?",
    _PREEMPTS,
    alike="AI-33.preempts",
    rule="a-new-mission-preempts",
)
AI_33_PREEMPTS_NULL = Ambiguity(
    "AI-33.preempts-null",
    "What becomes of a mission that runs when one comes that does not run since its configuration is null?",
    _PREEMPTS,
    alike="AI-33.preempts",
    rule="a-new-mission-preempts",
)
AI_33_PREEMPTS_BLANK = Ambiguity(
    "AI-33.preempts-blank",
    "What becomes of a mission that runs when one comes that does not run since its configuration is an empty text?",
    _PREEMPTS,
    alike="AI-33.preempts",
    rule="a-new-mission-preempts",
)
AI_33_PREEMPTS_VALUE = Ambiguity(
    "AI-33.preempts-value",
    "What becomes of a mission that runs when one comes that does not run since its configuration is no object?",
    _PREEMPTS,
    alike="AI-33.preempts",
    rule="a-new-mission-preempts",
)
AI_33_PREEMPTS_NODE = Ambiguity(
    "AI-33.preempts-node",
    "What becomes of a mission that runs when one comes that does not run since something in it is no node?",
    _PREEMPTS,
    alike="AI-33.preempts",
    rule="a-new-mission-preempts",
)
AI_33_PREEMPTS_UNKNOWN = Ambiguity(
    "AI-33.preempts-unknown",
    "What becomes of a mission that runs when one comes that does not run since its nodes are unknown?",
    _PREEMPTS,
    alike="AI-33.preempts",
    rule="a-new-mission-preempts",
)
AI_33_PREEMPTS_WRITTEN = Ambiguity(
    "AI-33.preempts-written",
    "What becomes of a mission that runs when one comes that fails since it is written otherwise?",
    _PREEMPTS,
    alike="AI-33.preempts",
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
