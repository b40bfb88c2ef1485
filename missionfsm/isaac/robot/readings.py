"""Where the page can be read in more than one way as to the robot's side; ``specs/isaac-robot.md`` argues each."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.kernel.readings import Ambiguity

AI_10 = Ambiguity(
    "AI-10",
    "How does a status say which mission it is about?",
    {"a": "it does not: there is one mission at a time", "b": "by the mission's uuid in the payload"},
    default="b",
)
AI_25_TAKEN = Ambiguity(
    "AI-25.taken",
    "Is a mission understood whose 64-bit integers are numbers instead of strings?",
    {"a": "yes, both are", "b": "no, strings only"},
    default="a",
)
AI_25_HEADER = Ambiguity(
    "AI-25.header",
    "How are the halves of the header's uuid sent?",
    {"s": "as strings, like every 64-bit integer", "n": "as numbers, as the shipped software does"},
    default="s",
    flagged=frozenset("n"),
)
AI_27_TYPE = Ambiguity(
    "AI-27.type",
    "What is a message of another type on the mission channel?",
    {"a": "nothing to the codelet", "b": "a mission without a configuration: only the channel counts"},
    default="a",
    flagged=frozenset("b"),
)
AI_28_STATUS = Ambiguity(
    "AI-28.status",
    "How is a status written?",
    {"c": "by its name in capitals", "d": "by its name in lower case", "e": "by its number"},
    default="d",
)
AI_33_NULL = Ambiguity(
    "AI-33.null",
    "What is a configuration that is null?",
    {"a": "an empty one", "b": "one that cannot be used"},
    default="a",
)
AI_33_UNUSABLE = Ambiguity(
    "AI-33.unusable",
    "What becomes of a mission whose configuration cannot be used?",
    {"a": "it fails at once", "b": "it runs with the configuration as it is"},
    default="a",
    flagged=frozenset("b"),
)

AMBIGUITIES = (AI_10, AI_25_TAKEN, AI_25_HEADER, AI_27_TYPE, AI_28_STATUS, AI_33_NULL, AI_33_UNUSABLE)

_SERVER = "the mission server's affair"
_PROGRAM = "about the program around the mission server"

WAIVED: Mapping[str, str] = {
    **dict.fromkeys((f"AI-{number:02d}" for number in range(1, 10)), _SERVER),
    **dict.fromkeys((f"AI-{number:02d}" for number in range(11, 20)), _SERVER),
    "AI-20": _PROGRAM,
    "AI-21": _SERVER,
    "AI-22": _SERVER,
    "AI-23": "not observable: slips in the sample",
    "AI-24": _SERVER,
    "AI-26": "the adapter protocol frames lines and cannot close a connection: what is no message is skipped",
    "AI-29": _PROGRAM,
    "AI-30": _PROGRAM,
    "AI-31": "no period is documented; RUNNING has to come within the stated bound, however often it does",
    "AI-32": "one reading is left: FAILURE for the old mission comes before anything about the new one",
    "AI-33 a, b": "whether earlier values persist cannot be seen from outside",
    "AI-34": "the three states are those of the wire; the others are the server's",
    "AI-35": _SERVER,
    "AI-36": _SERVER,
    "AI-37": "the robot's name is said to the server, and nothing here knows what it should be",
    "AI-38": "no message with data buffers is sent to a robot",
    "AI-39": _SERVER,
}
"""Entries, or readings of them, that make no ambiguity of the robot's side, each with the reason."""
