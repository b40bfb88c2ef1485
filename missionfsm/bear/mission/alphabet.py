"""What is worth trying on a robot: missions of every kind, well-formed and not, commands, what happens around it."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.bear.mission.events import PLAIN_EVENTS
from missionfsm.bear.mission.samples import COMMANDS, TABLES, auto, base, goals_at, of_family
from missionfsm.bear.mission.scripts import APART, CREATED, SCRIPTS
from missionfsm.kernel.alphabet import ANY_NAME, Alphabet, Bounds, Input, ScriptStep
from missionfsm.kernel.codec import JSON


def _tables(count: int) -> tuple[str, ...]:
    return tuple(TABLES[index % len(TABLES)] for index in range(count))


def _missions(family: str, goals: int) -> Iterator[JSON]:
    """The missions that a robot of the family can run."""
    some = _tables(goals)
    yield base({"destinationId": TABLES[0]})
    yield base({"pose": {"xMeters": 4.25, "yMeters": 7.75, "headingRadians": 1.5}})
    yield auto(*some)
    if family == "servi":
        yield of_family("servi", "deliveryMission", *some)
        yield of_family("servi", "deliveryPatrolMission", *some)
        yield of_family("servi", "bussingMission", *reversed(some))
        yield of_family("servi", "bussingPatrolMission", TABLES[1])
        yield of_family("servi", "navigateAutoMission", *some)
        yield {"serviMission": {"navigateMission": {"goal": {"destinationId": TABLES[1]}}}}
    if family == "carti":
        yield of_family("carti", "traverseMission", *some)
        yield of_family("carti", "traversePatrolMission", *some)
        yield of_family("carti", "navigateAutoMission", *some)
        yield {"cartiMission": {"navigateMission": {"goal": {"destinationId": TABLES[2]}}}}


_DEFECTIVE: tuple[JSON, ...] = (
    None,
    {},
    {"baseMission": {}},
    base({}),
    base({"destinationId": ""}),
    base({"destinationId": "nowhere"}),
    base({"pose": {"xMeters": "NaN"}}),
    base({"destinationId": 7}),
    {"baseMission": {"navigateMission": {}}},
    auto(),
    {**base({"destinationId": TABLES[0]}), "serviMission": {"deliveryMission": {"goals": goals_at(TABLES[0])}}},
    {"baseMission": {"navigateMission": "now"}},
    base({"destinationId": TABLES[0], "pose": {"xMeters": 1.0}}),
    of_family("servi", "deliveryMission"),
    of_family("carti", "traverseMission", "nowhere"),
)
"""Missions that no robot should accept, whatever its family."""

_FORMS: tuple[JSON, ...] = (
    *_DEFECTIVE,
    {"serviMission": {"deliveryMission": {"goals": [*goals_at(TABLES[0]), {}]}}},
    {"baseMission": {"navigateAutoMission": {"goals": [*goals_at(TABLES[0]), {}]}}},
    {"baseMission": {"navigateMission": {"goals": goals_at(TABLES[0])}}},
    {"baseMission": {"navigateAutoMission": {"goal": goals_at(TABLES[0])[0]}}},
    of_family("servi", "deliveryPatrolMission"),
    base({"destinationId": TABLES[0][:-1]}),
    base({"destinationId": TABLES[0].upper()}),
)
"""The same, and others that are wrong for a reason that they have."""

_FOREIGN: dict[str, tuple[JSON, ...]] = {
    "base": (of_family("servi", "deliveryMission", TABLES[0]), of_family("carti", "traverseMission", TABLES[0])),
    "servi": (of_family("carti", "traverseMission", TABLES[0]),),
    "carti": (of_family("servi", "bussingMission", TABLES[0]),),
}
_SEVERAL = {"servi": "deliveryMission", "carti": "traverseMission"}


def _odd(family: str) -> Iterator[JSON]:
    """Missions that are wrong, or may be taken for it, in a way of the robot's family: late in a list, or twice."""
    yield auto(TABLES[0], TABLES[0])
    yield auto(TABLES[0], "nowhere")
    if family in _SEVERAL:
        which = _SEVERAL[family]
        yield of_family(family, which, TABLES[0], TABLES[1], TABLES[0])
        yield of_family(family, which, *TABLES, "nowhere")
        yield of_family(family, which, TABLES[0], "")
        goals = {"goals": goals_at(TABLES[0])}
        yield {f"{family}Mission": {which: goals, "navigateMission": {"goal": goals_at(TABLES[1])[0]}}}
        yield {f"{family}Mission": {which: goals, "navigateAutoMission": goals}}
        yield {**of_family(family, which, TABLES[0]), **base({"destinationId": TABLES[1]})}


_WORKFLOWS: dict[str, tuple[str, ...]] = {
    "base": (),
    "servi": ("delivery", "deliveryPatrol", "bussing", "bussingPatrol", "hosting", "hostingPatrol"),
    "carti": ("traverse", "traversePatrol"),
}


def _workflows(family: str, goals: int) -> Iterator[JSON]:
    for name in _WORKFLOWS[family]:
        yield {f"{family}Workflow": {name: {"goals": goals_at(*_tables(goals))}}}
    if family == "servi":
        yield {"serviWorkflow": {"birthday": {"goal": {"destinationId": TABLES[0]}}}}


_DEFECTIVE_WORKFLOWS: tuple[JSON, ...] = (
    None,
    {},
    {"serviWorkflow": {}},
    {"serviWorkflow": {"delivery": {"goals": []}}},
    {"serviWorkflow": {"delivery": {"goals": goals_at("nowhere")}}},
    {"serviWorkflow": {"birthday": {}}},
    {"cartiWorkflow": {"traverse": {"goals": [{}]}}},
    {"serviWorkflow": {"delivery": {"goals": goals_at(TABLES[0])}}, "cartiWorkflow": {}},
    {"serviWorkflow": []},
    {"serviWorkflow": {"bussing": {"goals": goals_at(TABLES[0], TABLES[0])}}},
    {"serviWorkflow": {"delivery": {"goals": goals_at(TABLES[0])}, "bussing": {"goals": goals_at(TABLES[1])}}},
    {"cartiWorkflow": {"traverse": {"goals": goals_at(TABLES[0])}, "traversePatrol": {"goals": goals_at(TABLES[1])}}},
    {"serviWorkflow": {"delivery": {"goals": goals_at(*TABLES, "nowhere")}}},
    {"cartiWorkflow": {"traverse": {"goals": goals_at(TABLES[0])}}},
    {"serviWorkflow": {"hosting": {"goals": goals_at(TABLES[0])}}},
)

_OTHER_WORKFLOWS: tuple[JSON, ...] = (
    {"serviWorkflow": {"delivery": {"goals": [*goals_at(TABLES[0]), {}]}}},
    {"serviWorkflow": {"birthday": {"goals": goals_at(TABLES[0])}}},
    {"serviWorkflow": {"deliveryPatrol": {"goals": []}}},
    {"serviWorkflow": {"delivery": {"goals": goals_at(TABLES[0].upper())}}},
)
"""More requests that are invalid, for the same reasons."""


def _updates() -> Iterator[Input]:
    for command in COMMANDS:
        yield Input("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": command}})
    yield Input("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": "COMMAND_UNKNOWN"}})
    yield Input("UpdateMission", {"missionCommand": {"missionId": ANY_NAME}})
    yield Input("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": "COMMAND_DANCE"}})
    yield Input("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": 9}})
    yield Input("UpdateMission", {"missionCommand": {"command": "COMMAND_CANCEL"}})
    yield Input("UpdateMission", {})
    yield Input("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": "COMMAND_PAUSE"}, "x": 1})


def _wrapped(mission: JSON) -> JSON:
    return {} if mission is None else {"mission": mission}


def _prompts(family: str, bounds: Bounds) -> Iterator[Input]:
    good = tuple(_missions(family, bounds.get("goals")))
    bad = (*_DEFECTIVE, *_FOREIGN[family], *_odd(family))
    for method in ("CreateMission", "AppendMission"):
        yield from (Input(method, _wrapped(mission)) for mission in (*good, *bad))
        yield Input(method, {"mission": good[0], "urgency": "high"})
    for method in ("CreateMissionBatch", "AppendMissionBatch"):
        for size in range(1, bounds.get("batch") + 1):
            for first in range(0, len(good), 2):
                batch = [_wrapped(good[(first + index) % len(good)]) for index in range(size)]
                yield Input(method, {"missions": batch})
        yield from (Input(method, {"missions": [_wrapped(good[0]), _wrapped(mission)]}) for mission in bad)
        for wrong in (_DEFECTIVE[5], _FOREIGN[family][0]):
            yield Input(method, {"missions": [_wrapped(wrong), _wrapped(good[0])]})
            yield Input(method, {"missions": [*map(_wrapped, good[:3]), _wrapped(wrong)]})
        yield Input(method, {"missions": []})
        yield Input(method, {})
        yield Input(method, {"missions": [good[0]]})
    for workflow in (*_workflows(family, bounds.get("goals")), *_DEFECTIVE_WORKFLOWS):
        yield Input("CreateMissionWorkflow", {} if workflow is None else {"missionWorkflow": workflow})
    yield Input("CreateMissionWorkflow", {"missionWorkflow": _DEFECTIVE_WORKFLOWS[-1], "urgency": "high"})
    yield from _updates()
    for method in ("ChargeRobot", "ClearMissionStatus", "SkipGoal", "SubscribeMissionStatus"):
        yield Input(method, {})
        yield Input(method, {"x": 1})


def _plain(family: str, bounds: Bounds) -> Iterator[Input]:
    goals = _tables(bounds.get("goals"))
    kind = {"base": auto, "servi": None, "carti": None}[family]
    several = (
        kind(*goals)
        if kind
        else of_family(family, "deliveryMission" if family == "servi" else "traverseMission", *goals)
    )
    patrol = (
        [of_family(family, "deliveryPatrolMission" if family == "servi" else "traversePatrolMission", *goals)]
        if family != "base"
        else []
    )
    for mission in (base({"destinationId": TABLES[0]}), several, *patrol):
        yield Input("CreateMission", {"mission": mission})
        yield Input("AppendMission", {"mission": mission})
    if bounds.get("batch") > 1:
        batch = [
            {"mission": several},
            *({"mission": base({"destinationId": TABLES[0]})} for _ in range(bounds.get("batch") - 1)),
        ]
        yield Input("CreateMissionBatch", {"missions": batch})
        yield Input("AppendMissionBatch", {"missions": batch})
    if family != "base":
        name = "delivery" if family == "servi" else "traverse"
        yield Input(
            "CreateMissionWorkflow", {"missionWorkflow": {f"{family}Workflow": {name: {"goals": goals_at(*goals)}}}}
        )
    for command in COMMANDS:
        yield Input("UpdateMission", {"missionCommand": {"missionId": ANY_NAME, "command": command}})
    for method in ("ChargeRobot", "ClearMissionStatus", "SkipGoal", "SubscribeMissionStatus"):
        yield Input(method, {})


_CORE_DRIVES: tuple[JSON, ...] = tuple({"event": name} for name in PLAIN_EVENTS)
_DRIVES: tuple[JSON, ...] = (
    *_CORE_DRIVES,
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
_MAPS: tuple[JSON, ...] = (
    {"event": "world", "destinations": [TABLES[0], TABLES[2]]},
    {"event": "world", "destinations": list(TABLES)},
)
"""Other maps, where the bound `maps` asks for them."""
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


def _refused() -> Iterator[tuple[ScriptStep, ...]]:
    """Each form of a request that is wrong, also where others are wrong for the same reason."""
    yield _wrong("CreateMission")
    yield _wrong("CreateMissionBatch")
    yield tuple(
        ScriptStep("CreateMissionWorkflow", {} if one is None else {"missionWorkflow": one})
        for one in (*_DEFECTIVE_WORKFLOWS[:7], *_OTHER_WORKFLOWS)
    )
    yield (*CREATED, *_wrong("AppendMission"))
    yield (*CREATED, *_wrong("AppendMissionBatch"))
    yield (*CREATED, *(ScriptStep(one.method, one.params, ((0, 0),)) for one in _updates() if _is_no_command(one)))


def _wrong(method: str) -> tuple[ScriptStep, ...]:
    """A call with each mission that is of no documented form, by itself or in a batch."""
    missions = map(_wrapped, _FORMS)
    return tuple(ScriptStep(method, {"missions": [one]} if method.endswith("Batch") else one) for one in missions)


def _is_no_command(update: Input) -> bool:
    command = update.params.get("missionCommand", {})
    return "missionId" in command and command.get("command") not in COMMANDS


def alphabet(world: JSON, bounds: Bounds) -> Alphabet:
    """What is worth trying on a robot in a world."""
    family = (world or {}).get("family", "servi")
    return Alphabet(
        inputs=tuple(_prompts(family, bounds)),
        core_inputs=tuple(_plain(family, bounds)),
        drives=(*_DRIVES, *_MAPS[: bounds.get("maps", 0)]),
        core_drives=_CORE_DRIVES,
        worlds=_WORLDS,
        wrong_names=("no-such-mission",),
        scripts=(*SCRIPTS, *_refused()),
        apart=APART.get(family, ()),
    )
