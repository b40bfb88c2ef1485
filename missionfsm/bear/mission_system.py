"""The system ``bear.mission``: its specification, its JSON, and what is worth trying on it."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.bear.mission_breaks import BENDS, REACHING, TWISTS
from missionfsm.bear.mission_json import CODEC
from missionfsm.bear.mission_scripts import COMMANDS, SCRIPTS
from missionfsm.bear.mission_sketches import SKETCHES
from missionfsm.bear.mission_spec import SPEC
from missionfsm.kernel.alphabet import ANY_NAME, Alphabet, Bounds, Prompt
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System

_TABLES = ("table-1", "table-2", "table-3")


def _goals(*names: str) -> list[JSON]:
    return [{"destinationId": name} for name in names]


def _base(goal: JSON) -> JSON:
    return {"baseMission": {"navigateMission": {"goal": goal}}}


def _auto(*names: str) -> JSON:
    return {"baseMission": {"navigateAutoMission": {"goals": _goals(*names)}}}


def _of(family: str, which: str, *names: str) -> JSON:
    return {f"{family}Mission": {which: {"goals": _goals(*names)}}}


def _tables(count: int) -> tuple[str, ...]:
    return tuple(_TABLES[index % len(_TABLES)] for index in range(count))


def _missions(family: str, goals: int) -> Iterator[JSON]:
    """The missions that a robot of the family can run."""
    some = _tables(goals)
    yield _base({"destinationId": _TABLES[0]})
    yield _base({"pose": {"xMeters": 4.25, "yMeters": 7.75, "headingRadians": 1.5}})
    yield _auto(*some)
    if family == "servi":
        yield _of("servi", "deliveryMission", *some)
        yield _of("servi", "deliveryPatrolMission", *some)
        yield _of("servi", "bussingMission", *reversed(some))
        yield _of("servi", "bussingPatrolMission", _TABLES[1])
        yield _of("servi", "navigateAutoMission", *some)
        yield {"serviMission": {"navigateMission": {"goal": {"destinationId": _TABLES[1]}}}}
    if family == "carti":
        yield _of("carti", "traverseMission", *some)
        yield _of("carti", "traversePatrolMission", *some)
        yield _of("carti", "navigateAutoMission", *some)
        yield {"cartiMission": {"navigateMission": {"goal": {"destinationId": _TABLES[2]}}}}


_DEFECTIVE: tuple[JSON, ...] = (
    None,
    {},
    {"baseMission": {}},
    _base({}),
    _base({"destinationId": ""}),
    _base({"destinationId": "nowhere"}),
    _base({"pose": {"xMeters": "NaN"}}),
    _base({"destinationId": 7}),
    {"baseMission": {"navigateMission": {}}},
    _auto(),
    {**_base({"destinationId": _TABLES[0]}), "serviMission": {"deliveryMission": {"goals": _goals(_TABLES[0])}}},
    {"baseMission": {"navigateMission": "now"}},
    _base({"destinationId": _TABLES[0], "pose": {"xMeters": 1.0}}),
    _of("servi", "deliveryMission"),
    _of("carti", "traverseMission", "nowhere"),
)
"""Missions that no robot should accept, whatever its family."""

_FOREIGN: dict[str, tuple[JSON, ...]] = {
    "base": (_of("servi", "deliveryMission", _TABLES[0]), _of("carti", "traverseMission", _TABLES[0])),
    "servi": (_of("carti", "traverseMission", _TABLES[0]),),
    "carti": (_of("servi", "bussingMission", _TABLES[0]),),
}
_TWICE = _auto(_TABLES[0], _TABLES[0])

_WORKFLOWS: dict[str, tuple[str, ...]] = {
    "base": (),
    "servi": ("delivery", "deliveryPatrol", "bussing", "bussingPatrol", "hosting", "hostingPatrol"),
    "carti": ("traverse", "traversePatrol"),
}


def _workflows(family: str, goals: int) -> Iterator[JSON]:
    for name in _WORKFLOWS[family]:
        yield {f"{family}Workflow": {name: {"goals": _goals(*_tables(goals))}}}
    if family == "servi":
        yield {"serviWorkflow": {"birthday": {"goal": {"destinationId": _TABLES[0]}}}}


_DEFECTIVE_WORKFLOWS: tuple[JSON, ...] = (
    None,
    {},
    {"serviWorkflow": {}},
    {"serviWorkflow": {"delivery": {"goals": []}}},
    {"serviWorkflow": {"delivery": {"goals": _goals("nowhere")}}},
    {"serviWorkflow": {"birthday": {}}},
    {"cartiWorkflow": {"traverse": {"goals": [{}]}}},
    {"serviWorkflow": {"delivery": {"goals": _goals(_TABLES[0])}}, "cartiWorkflow": {}},
    {"serviWorkflow": []},
    {"serviWorkflow": {"bussing": {"goals": _goals(_TABLES[0], _TABLES[0])}}},
    {"cartiWorkflow": {"traverse": {"goals": _goals(_TABLES[0])}}},
    {"serviWorkflow": {"hosting": {"goals": _goals(_TABLES[0])}}},
)


def _updates() -> Iterator[Prompt]:
    for command in COMMANDS:
        yield Prompt("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": command}})
    yield Prompt("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": "COMMAND_UNKNOWN"}})
    yield Prompt("UpdateMission", {"missionCommand": {"missionId": ANY_NAME}})
    yield Prompt("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": "COMMAND_DANCE"}})
    yield Prompt("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": 9}})
    yield Prompt("UpdateMission", {"missionCommand": {"command": "COMMAND_CANCEL"}})
    yield Prompt("UpdateMission", {})
    yield Prompt("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": "COMMAND_PAUSE"}, "x": 1})


def _wrapped(mission: JSON) -> JSON:
    return {} if mission is None else {"mission": mission}


def _prompts(family: str, bounds: Bounds) -> Iterator[Prompt]:
    good = tuple(_missions(family, bounds.goals))
    bad = (*_DEFECTIVE, *_FOREIGN[family], _TWICE)
    for method in ("CreateMission", "AppendMission"):
        yield from (Prompt(method, _wrapped(mission)) for mission in (*good, *bad))
        yield Prompt(method, {"mission": good[0], "urgency": "high"})
        yield Prompt(method, [])
    for method in ("CreateMissionBatch", "AppendMissionBatch"):
        for size in range(1, bounds.batch + 1):
            for first in range(0, len(good), 2):
                batch = [_wrapped(good[(first + index) % len(good)]) for index in range(size)]
                yield Prompt(method, {"missions": batch})
        yield from (Prompt(method, {"missions": [_wrapped(good[0]), _wrapped(mission)]}) for mission in bad)
        yield Prompt(method, {"missions": [_wrapped(bad[5]), _wrapped(good[0])]})
        yield Prompt(method, {"missions": []})
        yield Prompt(method, {})
        yield Prompt(method, {"missions": [good[0]]})
    for workflow in (*_workflows(family, bounds.goals), *_DEFECTIVE_WORKFLOWS):
        yield Prompt("CreateMissionWorkflow", {} if workflow is None else {"missionWorkflow": workflow})
    yield Prompt("CreateMissionWorkflow", {"missionWorkflow": _DEFECTIVE_WORKFLOWS[-1], "urgency": "high"})
    yield from _updates()
    for method in ("ChargeRobot", "ClearMissionStatus", "SkipGoal", "SubscribeMissionStatus"):
        yield Prompt(method, {})
        yield Prompt(method, {"x": 1})
        yield Prompt(method, "all")


def _plain(family: str, bounds: Bounds) -> Iterator[Prompt]:
    goals = _tables(bounds.goals)
    kind = {"base": _auto, "servi": None, "carti": None}[family]
    several = (
        kind(*goals) if kind else _of(family, "deliveryMission" if family == "servi" else "traverseMission", *goals)
    )
    patrol = (
        [_of(family, "deliveryPatrolMission" if family == "servi" else "traversePatrolMission", *goals)]
        if family != "base"
        else []
    )
    for mission in (_base({"destinationId": _TABLES[0]}), several, *patrol):
        yield Prompt("CreateMission", {"mission": mission})
        yield Prompt("AppendMission", {"mission": mission})
    if bounds.batch > 1:
        batch = [
            {"mission": several},
            *({"mission": _base({"destinationId": _TABLES[0]})} for _ in range(bounds.batch - 1)),
        ]
        yield Prompt("CreateMissionBatch", {"missions": batch})
        yield Prompt("AppendMissionBatch", {"missions": batch})
    if family != "base":
        name = "delivery" if family == "servi" else "traverse"
        yield Prompt(
            "CreateMissionWorkflow", {"missionWorkflow": {f"{family}Workflow": {name: {"goals": _goals(*goals)}}}}
        )
    for command in COMMANDS:
        yield Prompt("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": command}})
    for method in ("ChargeRobot", "ClearMissionStatus", "SkipGoal", "SubscribeMissionStatus"):
        yield Prompt(method, {})


_DRIVES: tuple[JSON, ...] = (
    {"event": "goalReached"},
    {"event": "missionSucceeded"},
    {"event": "missionFailed"},
    {"event": "world", "blocked": True},
    {"event": "world", "blocked": False},
    {"event": "world", "occupied": ["table-1"]},
    {"event": "world", "occupied": ["table-1", "table-2", "table-3"]},
    {"event": "world", "occupied": []},
    {"event": "world", "chargingLocation": False},
    {"event": "world", "contactDock": False},
    {"event": "world", "contactDock": True, "chargingLocation": True},
    {"event": "fault", "status": "INTERNAL", "applied": False},
    {"event": "fault", "status": "INTERNAL", "applied": True},
    {"event": "fault", "status": "DEADLINE_EXCEEDED", "applied": False},
    {"event": "fault", "status": "DEADLINE_EXCEEDED", "applied": True},
)
_WORLDS: tuple[JSON, ...] = (
    {"family": "servi"},
    {"family": "base"},
    {"family": "carti"},
    {"family": "servi", "occupied": ["table-1"]},
    {"family": "base", "occupied": ["table-1", "table-2", "table-3"]},
    {"family": "carti", "contactDock": False},
    {"family": "servi", "chargingLocation": False},
    {"family": "servi", "blocked": True},
)


def alphabet(world: JSON, bounds: Bounds) -> Alphabet:
    """What is worth trying on a robot in a world."""
    family = (world or {}).get("family", "servi")
    return Alphabet(
        prompts=tuple(_prompts(family, bounds)),
        plain=tuple(_plain(family, bounds)),
        drives=_DRIVES,
        plain_drives=_DRIVES[:3],
        worlds=_WORLDS,
        wrong_names=("no-such-mission",),
        scripts=SCRIPTS,
    )


SYSTEM = System(SPEC.system, SPEC, CODEC, alphabet, bends=BENDS, twists=TWISTS, reaching=REACHING, sketches=SKETCHES)
