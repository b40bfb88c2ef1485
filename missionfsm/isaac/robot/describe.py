"""The values of a robot in words, for people."""

from __future__ import annotations

from missionfsm.isaac.robot.inputs import BLANK, NULL, ODD, SHALLOW, UNUSABLE, USABLE, Arrives
from missionfsm.isaac.robot.state import Codelet, Earlier, Introduction, Other, Report
from missionfsm.isaac.shared.drives import Passes
from missionfsm.isaac.shared.line import MICROSECONDS, LineContent
from missionfsm.kernel.language import Happening, Malformed

_CONFIGURED = {
    USABLE: "a mission",
    NULL: "a mission with the configuration null",
    BLANK: "a mission with an empty text as configuration",
    SHALLOW: "a mission with a configuration in which something is no node",
    ODD: "a mission with a configuration that is no object",
    UNUSABLE: "a mission with a configuration that is no JSON",
}
_HAPPENS = {
    "behaviorSucceeded": "the behavior tree reports success",
    "behaviorFailed": "the behavior tree reports failure",
    "connect": "the connection is there again",
    "disconnect": "the connection drops",
}


def describe(value: object) -> str:
    """A state, an event, a view or a line in a few words."""
    if isinstance(value, Codelet):
        where = "" if value.connected else ", without a connection"
        return ("a mission runs" if value.running else "no mission runs") + where
    if isinstance(value, Report):
        return f"{value.status.upper()} of its mission on {value.channel}"
    if isinstance(value, Earlier):
        return f"a status of a mission from before the log on {value.channel}"
    if isinstance(value, Introduction):
        return f"the name{'' if value.name is None else f' {value.name!r}'} on {value.channel}"
    if isinstance(value, Other):
        return "whatever else is sent on other channels"
    if isinstance(value, LineContent):
        return _said(value)
    if isinstance(value, Malformed):
        return f"a malformed line: {value.says}"
    if isinstance(value, Arrives):
        return _arrives(value)
    if isinstance(value, Passes):
        return f"{value.time / MICROSECONDS:g} s pass"
    return _HAPPENS[value.name] if isinstance(value, Happening) else str(value)


def _said(line: LineContent) -> str:
    if line.kind == "status":
        return f"{line.what.upper()} on {line.channel}"
    if line.kind == "other":
        return f"a message of {f'type {line.what}' if line.what else 'no known type'} on {line.channel}"
    return f"the text {line.what!r} on {line.channel}" if line.kind == "text" else f"a mission on {line.channel}"


def _arrives(event: Arrives) -> str:
    if event.mission is not None:
        return f"{_CONFIGURED[event.mission]} arrives on {event.channel}"
    where = f" on {event.channel}" if event.channel else ""
    return f"a message that is no mission arrives{where}" if event.channel else "a line arrives that is no message"
