"""Where the page can be read in more than one way as to the robot's side; ``specs/isaac-missions.md`` argues each."""

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

WAIVED: Mapping[str, str] = {
    "AI-26": "lines are framed by the adapter protocol; a line that is no message is skipped, since nothing can close "
    "or reopen the one connection here",
    "AI-27": "only the channel is needed to route a message, so other header fields may be missing; what a message's "
    "type is worth is asked apart",
    "AI-31": "no period is documented; RUNNING has to come within the stated bound, however often it does",
    "AI-32": "one reading is left: FAILURE for the old mission comes before anything about the new one",
    "AI-33": "whether earlier values persist (a, b) cannot be seen from outside; null and unusable are asked apart",
    "AI-34": "the three states are those of the wire; the others are the server's",
    "AI-37": "the robot's name is said to the server, and nothing here knows what it should be",
    "AI-38": "no message with data buffers is sent to a robot",
}
"""Entries that the robot's side touches and that make no ambiguity, each with the reason."""
