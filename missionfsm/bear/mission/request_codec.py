"""The JSON of the requests of the Mission page: which member of which oneof stands for which kind of mission."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import attrs
from attrs import evolve

from missionfsm.bear.mission.inputs import Defect, Request, Wanted
from missionfsm.bear.mission.state import Kind
from missionfsm.bear.wire import messages as wire
from missionfsm.bear.wire.messages import Command, Goal
from missionfsm.bear.wire.protojson import MalformedError, camel, key_of, read, unknown_fields, write
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Name
from missionfsm.kernel.text import brief

_MISSIONS: Mapping[tuple[str, str], Kind] = {
    ("base_mission", "navigate_mission"): Kind.BASE_NAVIGATE,
    ("base_mission", "navigate_auto_mission"): Kind.BASE_NAVIGATE_AUTO,
    ("servi_mission", "delivery_mission"): Kind.SERVI_DELIVERY,
    ("servi_mission", "delivery_patrol_mission"): Kind.SERVI_DELIVERY_PATROL,
    ("servi_mission", "bussing_mission"): Kind.SERVI_BUSSING,
    ("servi_mission", "bussing_patrol_mission"): Kind.SERVI_BUSSING_PATROL,
    ("servi_mission", "navigate_mission"): Kind.SERVI_NAVIGATE,
    ("servi_mission", "navigate_auto_mission"): Kind.SERVI_NAVIGATE_AUTO,
    ("carti_mission", "traverse_mission"): Kind.CARTI_TRAVERSE,
    ("carti_mission", "traverse_patrol_mission"): Kind.CARTI_TRAVERSE_PATROL,
    ("carti_mission", "navigate_mission"): Kind.CARTI_NAVIGATE,
    ("carti_mission", "navigate_auto_mission"): Kind.CARTI_NAVIGATE_AUTO,
}


_WORKFLOWS: Mapping[tuple[str, str], Kind] = {
    ("servi_workflow", "delivery"): Kind.SERVI_DELIVERY,
    ("servi_workflow", "delivery_patrol"): Kind.SERVI_DELIVERY_PATROL,
    ("servi_workflow", "bussing"): Kind.SERVI_BUSSING,
    ("servi_workflow", "bussing_patrol"): Kind.SERVI_BUSSING_PATROL,
    ("servi_workflow", "birthday"): Kind.SERVI_BIRTHDAY,
    ("servi_workflow", "hosting"): Kind.SERVI_HOSTING,
    ("servi_workflow", "hosting_patrol"): Kind.SERVI_HOSTING_PATROL,
    ("carti_workflow", "traverse"): Kind.CARTI_TRAVERSE,
    ("carti_workflow", "traverse_patrol"): Kind.CARTI_TRAVERSE_PATROL,
}


_SINGLE = frozenset({Kind.BASE_NAVIGATE, Kind.SERVI_NAVIGATE, Kind.CARTI_NAVIGATE, Kind.SERVI_BIRTHDAY})
"""Kinds with one goal of its own name instead of a list."""


def _set_member(message: attrs.AttrsInstance) -> tuple[str, Any]:
    """The member of a oneof that is set and its content; ("", None) if none is."""
    for attribute in attrs.fields(type(message)):
        content = getattr(message, attribute.name)
        if content is not None:
            return attribute.name, content
    return "", None


def _finite(goal: Goal) -> bool:
    return goal.pose is None or all(math.isfinite(number) for number in attrs.astuple(goal.pose))


def _wanted(
    wrapper: attrs.AttrsInstance | None, kinds: Mapping[tuple[str, str], Kind]
) -> tuple[Wanted, tuple[Defect, ...]]:
    """The mission that a wrapper of two oneofs asks for, and what is wrong with it."""
    family, inner = _set_member(wrapper) if wrapper is not None else ("", None)
    which, payload = _set_member(inner) if inner is not None else ("", None)
    if payload is None:
        return Wanted(), (Defect.EMPTY,)
    kind = kinds[family, which]
    given = ((payload.goal,) if payload.goal is not None else ()) if kind in _SINGLE else payload.goals
    defects: list[Defect] = []
    if not given:
        defects.append(Defect.MATCH)
    if any((goal.pose is None and not goal.destination_id) or not _finite(goal) for goal in given):
        defects.append(Defect.GOAL)
        given = tuple(goal for goal in given if _finite(goal))
    return Wanted(kind, given), tuple(defects)


def _one_mission(name: str, params: JSON) -> Request:
    wanted, defects = _wanted(read(wire.MissionRequest, params).mission, _MISSIONS)
    return Request(name, (wanted,), None, defects)


def _many_missions(name: str, params: JSON) -> Request:
    entries = [_wanted(entry.mission, _MISSIONS) for entry in read(wire.BatchRequest, params).missions]
    if not entries:
        return Request(name, (), None, (Defect.EMPTY,))
    defects = {defect for _, found in entries for defect in found}
    return Request(name, tuple(wanted for wanted, _ in entries), None, _ordered(defects))


def _workflow(name: str, params: JSON) -> Request:
    wanted, defects = _wanted(read(wire.WorkflowRequest, params).mission_workflow, _WORKFLOWS)
    return Request(name, (wanted,), None, defects)


def _nothing(name: str, params: JSON) -> Request:
    read(wire.Empty, params)
    return Request(name)


def _command(name: str, params: JSON) -> Request:
    command = read(wire.UpdateRequest, params).mission_command or wire.MissionCommand()
    defects: list[Defect] = []
    if not command.mission_id:
        defects.append(Defect.EMPTY)
    if command.command == Command.COMMAND_UNKNOWN or not isinstance(command.command, Command):
        defects.append(Defect.COMMAND)
    asked = command.command if isinstance(command.command, Command) else None
    return Request(name, (), asked, tuple(defects))


def _ordered(defects: set[Defect]) -> tuple[Defect, ...]:
    return tuple(defect for defect in Defect if defect in defects)


_READERS: Mapping[str, tuple[Callable[[str, JSON], Request], type]] = {
    "CreateMission": (_one_mission, wire.MissionRequest),
    "AppendMission": (_one_mission, wire.MissionRequest),
    "CreateMissionBatch": (_many_missions, wire.BatchRequest),
    "AppendMissionBatch": (_many_missions, wire.BatchRequest),
    "CreateMissionWorkflow": (_workflow, wire.WorkflowRequest),
    "UpdateMission": (_command, wire.UpdateRequest),
    "ChargeRobot": (_nothing, wire.Empty),
    "ClearMissionStatus": (_nothing, wire.Empty),
    "SkipGoal": (_nothing, wire.Empty),
    "SubscribeMissionStatus": (_nothing, wire.Empty),
}


REQUESTS: Mapping[str, type] = {method: kind for method, (_, kind) in _READERS.items()}
"""The message that a call takes."""


def split_request(method: str, params: JSON) -> tuple[tuple[Name, ...], JSON]:
    """The mission id of an UpdateMission and the params with a dash in its place; other requests have none."""
    if method != "UpdateMission" or not isinstance(params, dict):
        return (), params
    outer = key_of(params, "mission_command")
    command = params.get(outer)
    if not isinstance(command, dict):
        return (), params
    key = key_of(command, "mission_id")
    named = command.get(key)
    if not isinstance(named, str) or not named:
        return (), params
    return (named,), {**params, outer: {**command, key: "-"}}


def read_request(method: str, params: JSON) -> Request:
    """The request that a call makes, whatever its names are."""
    if method not in _READERS:
        message = f"{brief(method)} is not a method of bear.mission; those are {', '.join(_READERS)}"
        raise UnreadableError(message)
    reader, kind = _READERS[method]
    params = {} if params is None else params
    try:
        found = reader(method, params)
    except MalformedError as error:
        return Request(method, (), None, (Defect.FORMAT,), str(error))
    if unknown_fields(kind, params):
        found = evolve(found, defects=_ordered({*found.defects, Defect.FIELD}))
    return found


def write_request(asked: Request, names: tuple[Name, ...]) -> JSON:
    """The params of a well-formed request; of a defective one the part that can be said."""
    if asked.operation == "UpdateMission":
        command = {} if asked.command is None else {"command": asked.command.name}
        return {"missionCommand": {"missionId": str(names[0]) if names else "", **command}}
    if asked.operation == "CreateMissionWorkflow":
        return {"missionWorkflow": _write_wanted(asked.wanted[0], _WORKFLOWS)} if asked.wanted else {}
    missions = [{"mission": _write_wanted(wanted, _MISSIONS)} for wanted in asked.wanted]
    if asked.operation.endswith("Batch"):
        return {"missions": missions}
    return missions[0] if missions else {}


def _write_wanted(wanted: Wanted, kinds: Mapping[tuple[str, str], Kind]) -> JSON:
    place = next((place for place, kind in kinds.items() if kind is wanted.kind), None)
    if place is None:
        return {}
    goals = [write(goal) for goal in wanted.goals]
    payload = ({"goal": goals[0]} if goals else {}) if wanted.kind in _SINGLE else {"goals": goals}
    return {camel(place[0]): {camel(place[1]): payload}}
