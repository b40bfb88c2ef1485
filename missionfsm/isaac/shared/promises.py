"""What the page promises of every line, whoever sends it. ``MissionSubmission › JsonTcpClient Codelet``."""

from __future__ import annotations

from missionfsm.isaac.shared.line import MISSION_SUBMISSION
from missionfsm.kernel.rules import promise

CLIENT = MISSION_SUBMISSION["JsonTcpClient Codelet"]

ENVELOPE = promise(
    "a-line-is-one-message",
    "Every line is one JSON object with a header and a payload, of a type that is documented.",
    cite=CLIENT,
)
INTEGERS = promise(
    "64-bit-integers-are-strings",
    "Every 64-bit integer of a message is a string.",
    cite=CLIENT,
    argues="AI-25.header: the shipped software sends the halves of the header's uuid as numbers.",
)
