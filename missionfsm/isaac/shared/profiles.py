"""What is known of the shipped software, as choices of readings: ambiguity id to the letters that are left.

What nothing is known of stays open. That one unreadable line ends the shipped server's service is a fault.
"""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.kernel.readings import Ambiguity, to_the_letter

DOCUMENTED, AS_SHIPPED = "documented", "as-shipped"
"""The names of the profiles: nothing departs from the text, or all is as the shipped software does it."""

SHIPPED_SERVER: Mapping[str, str] = {
    "AI-02.canceled": "a",
    "AI-02.aborted": "c",
    "AI-03": "a",
    "AI-03.when": "p",
    "AI-04": "a",
    "AI-04.new": "a",
    "AI-04.robot": "q",
    "AI-04.sent": "s",
    "AI-05": "a",
    "AI-11": "a",
    "AI-12": "b",
    "AI-13": "a",
    "AI-14.status": "b",
    "AI-15": "c",
    "AI-15.sent": "c",
    "AI-15.when": "p",
    "AI-16": "n",
    "AI-16.older": "v",
    "AI-16.under-way": "m",
    "AI-16.back": "r",
    "AI-16.again": "t",
    "AI-22.started": "ij",
    "AI-24": "a",
    "AI-24.whole": "w",
    "AI-25.header": "n",
    "AI-27.uuid": "a",
    "AI-28.config": "b",
    "AI-28.uuid": "y",
    "AI-31": "b",
    "AI-39": "b",
    "AI-39.reports": "a",
}
"""The mission server (2020.2): names, drops, time-outs and cancellations are noticed in a pass once a second."""

SHIPPED_ROBOT: Mapping[str, str] = {
    "AI-31.preempted": "a",
    "AI-33.null": "a",
    "AI-33.node": "b",
    "AI-33.preempts": "a",
    "AI-33.preempts-value": "a",
    "AI-33.preempts-node": "a",
    "AI-33.unusable": "a",
}
"""The mission codelet: FAILURE of the old mission first; `null` runs, a node without a component object fails."""


def profiles(ambiguities: tuple[Ambiguity, ...], shipped: Mapping[str, str]) -> Mapping[str, Mapping[str, str]]:
    """The profiles of a system by name."""
    return {DOCUMENTED: to_the_letter(ambiguities), AS_SHIPPED: shipped}
