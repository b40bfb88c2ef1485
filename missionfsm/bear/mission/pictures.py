"""What of the mission API is drawn besides the lifecycle: the robot's queue, and what each call does to it."""

from __future__ import annotations

from missionfsm.bear.mission.compiled import forget_ended
from missionfsm.bear.mission.events import Event
from missionfsm.bear.mission.inputs import Request
from missionfsm.bear.mission.state import Robot
from missionfsm.kernel.alphabet import ANY_NAME, Input
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.picture import Part, Sketch
from missionfsm.kernel.terms import Refs

_MAX_LISTED = 4
"""Listed missions: enough for two to wait behind one, after another has ended."""

_COMMANDS = ("PAUSE", "RESUME", "CANCEL", "FINISH")
_GOALS: JSON = {"goals": [{"destinationId": "table-1"}, {"destinationId": "table-2"}]}
_MISSION: JSON = {"mission": {"serviMission": {"deliveryMission": _GOALS}}}
_PROMPTS = (
    Input("CreateMission", _MISSION),
    Input("CreateMissionBatch", {"missions": [_MISSION, _MISSION]}),
    Input("CreateMissionWorkflow", {"missionWorkflow": {"serviWorkflow": {"delivery": _GOALS}}}),
    Input("AppendMission", _MISSION),
    Input("AppendMissionBatch", {"missions": [_MISSION, _MISSION]}),
    Input("ChargeRobot", {}),
    *(
        Input("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": f"COMMAND_{command}"}})
        for command in _COMMANDS
    ),
    Input("SkipGoal", {}),
    Input("ClearMissionStatus", {}),
    Input("SubscribeMissionStatus", {}),
)
_DRIVES: tuple[JSON, ...] = ({"event": "goalReached"}, {"event": "missionSucceeded"}, {"event": "missionFailed"})
_HAPPENS = {
    "goalReached": "the goal is reached",
    "missionSucceeded": "the mission succeeds",
    "missionFailed": "the mission fails",
}
_COME = Part(
    "come",
    "how they come and are forgotten",
    tuple(dict.fromkeys(prompt.method for prompt in _PROMPTS if prompt.method not in ("UpdateMission", "SkipGoal"))),
)
_END = Part(
    "end",
    "how they are held and end",
    (*(f"UpdateMission {command}" for command in _COMMANDS), "SkipGoal", *_HAPPENS.values()),
)


def _node(robot: Robot) -> str:
    """What the active mission is at, and whether others wait."""
    if robot.active is not None:
        return robot.active.state.name.removeprefix("STATE_") + (", others wait" if robot.pending else "")
    if robot.pending:
        return f"{'halted' if robot.halted else 'none is active'}, missions wait"
    return "all have ended" if robot.done else "no mission"


def _label(robot: Robot, what: Request | Event, refs: Refs) -> str | None:
    if isinstance(what, Event):
        return _HAPPENS[what.name]
    if what.command is None:
        return what.operation
    command = what.command.name.removeprefix("COMMAND_")
    active = len(robot.done) if robot.active is not None else None
    if refs == (active,) and active is not None:
        return f"{what.operation} {command}"
    return f"{what.operation} of {_whose(robot, refs[0])}"


def _whose(robot: Robot, ref: int | None) -> str:
    if ref is None:
        return "no such mission"
    return "an ended mission" if ref < len(robot.done) else "a waiting mission"


SKETCHES = (
    Sketch(
        "queue",
        "a robot's missions",
        node=_node,
        label=_label,
        within=lambda robot: len(robot.turns) <= _MAX_LISTED,
        simple=lambda robot, _: forget_ended(robot),
        inputs=_PROMPTS,
        drives=_DRIVES,
        contrasts=("AM-09=b", "AM-09=c", "AM-10=b"),
        parts=(_COME, _END),
    ),
)
