"""The entries without an ambiguity, and the letters that are not offered."""

from __future__ import annotations

from collections.abc import Mapping

WAIVED: Mapping[str, str] = {
    "AM-05": "whose state it is cannot matter: any active or waiting mission forbids the calls, and ended ones do not",
    "AM-08 d": "a waiting mission that is reported as running is not actively running",
    "AM-11 c": "a mission that is accepted and never starts is a defect, and a blocked robot is another question",
    "AM-13 c": "no bound is documented",
    "AM-14 g": "a paused mission is active: it is to be finished or cancelled before a clear, as an active one is",
    "AM-15": "the index is judged where there is an active goal; elsewhere -1 to the number of goals will do",
    "AM-16 c": "a skip that resumes is documented nowhere",
    "AM-17 e": "OK would claim a skip that did not happen",
    "AM-20": "no choice to make: such a call took effect, takes it later, or never, and the stream tells",
    "AM-21": "a request that failed had no effect, but for SkipGoal (AM-24)",
    "AM-22": "no choice to make: each attempt whose effect is open may have had it once, and copies are counted so",
    "AM-23": "the page calls batches atomic without an exception: all or nothing under every code",
    "AM-24": "no choice to make: DEADLINE_EXCEEDED leaves the effect open, and so does INTERNAL for SkipGoal alone",
    "AM-28": "nobody outside sees weight: a patrol wraps to its first goal and may end well at any time while it runs",
    "AM-30 c": "a mission marked as completed is not cancelled",
    "AM-32": "no choice to make: answers and messages are not ordered, but both are owed once things have settled",
    "AM-35 b": "updates are promised for changes, and a clear is one",
    "AM-39": "type, place and end of a charge are not described: any type and at most one goal that stay, any end",
    "AM-40 b": "the page calls it a mission and reports it among them, so it can be appended to",
    "AM-42": "the number of goals is all that can be told from this page; kinds of destinations are not on it",
    "AM-43 c": "NOT_FOUND is in no table of these calls",
    "AM-45 f, g": "what others claim is part of the world that a tester sets; a robot's own queue claims nothing",
    "AM-45 l": "the page says that lower indices are preferred",
    "AM-46": "numbers are compared within one stream alone, which is right under every scope; an equal one is invalid",
    "AM-48": "the example is careless: a mission lists the goals of its request, one for Navigate",
    "AM-49 a, b": "the encoding tells nothing about the robot: both forms are read everywhere",
    "AM-50 e, f": "feedback after the end may be kept or cleared; nothing follows from it",
    "AM-52 a to d": "owners are free texts, and the adapter protocol has no touchscreen to start missions with",
    "AM-55": "two members of a oneof are malformed JSON and cannot be said in binary; a bare mission is an empty entry",
    "AM-56": "a history is explained by some order of the calls or not at all; two racing creates that win have none",
    "AM-57": "a conversation is with one robot; whoever records several marks the lines with the robot's name",
    "AM-58 c": "which robot is addressed is not part of a request",
    "AM-59": "ended missions stay until they are cleared or replaced (AM-13); no bound and no restart is documented",
    "AM-60": "the next mission starts once things have settled, unless the queue is halted or the robot blocked",
    "AM-62": "two spellings of one state: STATE_CANCELED on the wire",
}
"""Entries without an ambiguity, and letters that are not offered, with the reason."""
