"""The values of the mission API in words, for people: short, and never a whole state where a difference will do."""

from __future__ import annotations

from missionfsm.bear.mission.events import Event
from missionfsm.bear.mission.inputs import Request, Wanted
from missionfsm.bear.mission.state import NOT_CHOSEN, Fault, Mission, Robot
from missionfsm.bear.mission.views import Listing, Seen
from missionfsm.bear.wire.messages import Goal, MissionState, State


def describe(value: object) -> str:
    """A request, a state, a view, a message or an event in a few words."""
    if isinstance(value, Request):
        return _request(value)
    if isinstance(value, Robot):
        shown = _missions(value.listed(value.turns)) if value.turns else "[no mission]"
        return shown + (", halted" if value.halted else "")
    if isinstance(value, Listing):
        return f"{_missions(value.missions)}, current_mission_index {-1 if value.active is None else value.active}"
    if isinstance(value, Seen):
        shown = ", ".join(map(_message, value.states.missions))
        return f"[{shown}], current_mission_index {value.states.current_mission_index}"
    if isinstance(value, Event):
        return _event(value)
    return str(value)


def _missions(missions: tuple[Mission, ...]) -> str:
    return "[" + ", ".join(map(_mission, missions)) + "]"


def _mission(mission: Mission) -> str:
    state = "WAITING" if mission.state is State.STATE_DEFAULT else mission.state.name.removeprefix("STATE_")
    if mission.state in (State.STATE_RUNNING, State.STATE_PAUSED) and mission.goals:
        return f"{state} at goal {'?' if mission.goal == NOT_CHOSEN else mission.goal}"
    return state


def _message(message: MissionState) -> str:
    state = message.state.name.removeprefix("STATE_") if isinstance(message.state, State) else str(message.state)
    if message.state in (State.STATE_RUNNING, State.STATE_PAUSED) and message.goals:
        return f"{state} at goal {message.current_goal_index}"
    return state


def _goals(goals: tuple[Goal, ...]) -> str:
    return ", ".join(repr(goal.destination_id) if goal.pose is None else str(goal) for goal in goals)


def _wanted(wanted: Wanted) -> str:
    kind = "nothing" if wanted.kind is None else wanted.kind.value
    return f"{kind} to {_goals(wanted.goals)}" if wanted.goals else kind


def _request(request: Request) -> str:
    parts = [_wanted(wanted) for wanted in request.wanted]
    if request.command is not None:
        parts.append(request.command.name)
    if request.says:
        parts.append(f"malformed: {request.says}")
    elif request.defects:
        parts.append(", ".join(defect.value for defect in request.defects))
    return f"{request.operation}({'; '.join(parts)})"


def _event(event: Event) -> str:
    what = event.what
    if isinstance(what, Fault):
        return f"fault {what.status}, {'applied' if what.applied else 'not applied'}"
    if isinstance(what, tuple):
        return f"{event.name} " + ", ".join(f"{name} {_plain(value)}" for name, value in what)
    return event.name


def _plain(value: object) -> str:
    return str(list(value)) if isinstance(value, tuple) else str(value)


__all__ = ["describe"]
