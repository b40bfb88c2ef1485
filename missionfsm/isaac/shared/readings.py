"""What the page leaves open of every line, whoever sends it; each system has these questions among its own."""

from __future__ import annotations

from missionfsm.kernel.readings import Ambiguity

AI_25_HEADER = Ambiguity(
    "AI-25.header",
    "How are the halves of the header's uuid sent?",
    {"s": "as strings, like every 64-bit integer", "n": "as numbers, as the shipped software does"},
    flagged="n",
    rule="64-bit-integers-are-strings",
)
AI_27_UUID = Ambiguity(
    "AI-27.uuid",
    "Whose is the uuid in a header?",
    {"a": "the message's own, another one for each", "b": "the mission's, or the same again for the next message"},
    flagged="b",
    rule="a-line-is-one-message",
)
