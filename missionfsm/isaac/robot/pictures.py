"""What of the robot's side is drawn besides the lifecycle of the codelet: what it reports, and when."""

from __future__ import annotations

from missionfsm.isaac.robot.inputs import UNUSABLE, Arrives, Event
from missionfsm.isaac.robot.state import RUNNING_BOUND, Codelet, Introduction, Report
from missionfsm.isaac.shared.drives import Passes
from missionfsm.isaac.shared.line import MICROSECONDS
from missionfsm.kernel.language import JSON, Refs, Sketch

_MISSION = '{"header":{"channel":"mission"},"payload":{"uuid":{"lower":"1","upper":"1"},"config":{"serialized":"%s"}}}'
_WAITING = 2
"""How many statuses wait for the codelet's tick in a picture; under some readings there is no end of them."""

_DRIVES: tuple[JSON, ...] = (
    {"event": "line", "line": _MISSION % "{}"},
    {"event": "line", "line": _MISSION % "no json"},
    {"event": "behaviorSucceeded"},
    {"event": "behaviorFailed"},
    {"event": "advance", "seconds": RUNNING_BOUND / MICROSECONDS},
)


def _node(codelet: Codelet) -> str:
    if codelet.running:
        return "a mission runs"
    return "waits for the next mission" if codelet.used else "waits for a first mission"


def _label(_: Codelet, event: Event, __: Refs) -> str:
    if isinstance(event, Arrives):
        return "an unusable mission arrives" if event.mission == UNUSABLE else "a mission arrives"
    if isinstance(event, Passes):
        return "time passes"
    return {"behaviorSucceeded": "the tree reports success", "behaviorFailed": "the tree reports failure"}[event.name]


def _shows(view: Report | Introduction) -> str:
    return view.status.upper() if isinstance(view, Report) else "its name"


SKETCHES = (
    Sketch(
        "reports",
        "what a robot reports of its missions",
        node=_node,
        label=_label,
        within=lambda codelet: len(codelet.waiting) <= _WAITING,
        shows=_shows,
        drives=_DRIVES,
        contrasts=("AI-33.unusable=b",),
    ),
)
