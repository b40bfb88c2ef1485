"""Conversations with a robot that are worth having whole: every command in every state, and what patrols do.

Chance seldom keeps one mission in sight long enough to command it in each state that it can be in.
"""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.bear.mission.samples import (
    CANCEL,
    COMMANDS,
    FINISH,
    PAUSE,
    RESUME,
    TABLES,
    auto,
    base,
    goals_at,
    of_family,
)
from missionfsm.kernel.alphabet import ANY_NAME, ScriptStep
from missionfsm.kernel.codec import JSON

_SETTLE = ScriptStep("settle")
_SUBSCRIBE = ScriptStep("SubscribeMissionStatus", {})


def drive(event: str, **fields: JSON) -> tuple[ScriptStep, ...]:
    """Something happens, and all that it causes."""
    return (ScriptStep("drive", {"event": event, **fields}), _SETTLE)


def call(method: str, params: JSON = None) -> tuple[ScriptStep, ...]:
    """A call, and all that it causes."""
    return (ScriptStep(method, params or {}), _SETTLE)


def commanded(mission: int, command: str) -> tuple[ScriptStep, ...]:
    """A command to the how-many-th mission that was created, from 0."""
    params = {"missionCommand": {"missionId": ANY_NAME, "command": command}}
    return (ScriptStep("UpdateMission", params, ((0, mission),)), _SETTLE)


_SINGLE: JSON = {"mission": base({"destinationId": TABLES[0]})}
_AUTO: JSON = {"mission": auto(*TABLES)}


def _several(which: str, family: str = "servi") -> JSON:
    return {"mission": of_family(family, which, *TABLES)}


_BEGUN = (_SUBSCRIBE, *call("CreateMission", _several("deliveryMission")))
CREATED = call("CreateMission", _SINGLE)
APPENDED = call("AppendMission", _SINGLE)

_ALIVE: tuple[tuple[ScriptStep, ...], ...] = (
    _BEGUN,
    (*_BEGUN, *drive("goalReached")),
    (*_BEGUN, *commanded(0, PAUSE)),
)
"""Ways to a first mission that has not ended."""

_ENDED: tuple[tuple[ScriptStep, ...], ...] = (
    (*_BEGUN, *drive("missionSucceeded")),
    (*_BEGUN, *drive("missionFailed")),
    (*_BEGUN, *commanded(0, CANCEL)),
    (*_BEGUN, *drive("goalReached"), *commanded(0, FINISH)),
)
"""Ways to a first mission that has ended."""


def _commands() -> Iterator[tuple[ScriptStep, ...]]:
    for way in _ALIVE:
        for command in COMMANDS:
            yield (*way, *commanded(0, command), *drive("goalReached"))
            yield (*way, *APPENDED, *commanded(0, command), *drive("goalReached"))
            yield (*way, *APPENDED, *commanded(1, command), *drive("missionSucceeded"), *drive("goalReached"))
    for way in _ENDED:
        for command in COMMANDS:
            yield (*way, *commanded(0, command), *call("CreateMission", _SINGLE))
            yield (*way, *call("CreateMission", _SINGLE), *commanded(0, command), *drive("goalReached"))


def _patrols(family: str, *kinds: str) -> Iterator[tuple[ScriptStep, ...]]:
    """A patrol goes round until it is told otherwise, and what is appended waits for that."""
    for which in kinds:
        begun = (_SUBSCRIBE, *call("CreateMission", _several(which, family)))
        round_once = (*drive("goalReached"), *drive("goalReached"), *drive("goalReached"))
        yield (*begun, *round_once, *drive("goalReached"), *call("SkipGoal"), *call("SkipGoal"))
        yield (*begun, *APPENDED, *round_once, *call("SkipGoal"), *round_once, *commanded(0, FINISH))
        for command in COMMANDS:
            yield (*begun, *round_once, *commanded(0, command), *drive("goalReached"), *call("SkipGoal"))
        yield (*begun, *commanded(0, PAUSE), *commanded(0, RESUME), *round_once, *drive("goalReached"))


def _made(family: str, patrol: str, *workflows: str) -> Iterator[tuple[ScriptStep, ...]]:
    """A mission goes the same way whoever made it: a workflow, or a batch in which it is the second."""
    reached, skip = drive("goalReached"), call("SkipGoal")
    for name in workflows:
        workflow = {"missionWorkflow": {f"{family}Workflow": {name: {"goals": goals_at(*TABLES)}}}}
        begun = (_SUBSCRIBE, *call("CreateMissionWorkflow", workflow))
        yield (*begun, *reached, *reached, *reached, *reached, *skip, *skip)
        yield (*begun, *reached, *commanded(0, PAUSE), *commanded(0, RESUME), *reached, *reached, *commanded(0, FINISH))
        yield (*begun, *APPENDED, *skip, *reached, *reached, *reached, *drive("missionSucceeded"))
    ended = drive("missionSucceeded")
    batch = {"missions": [_SINGLE, {"mission": of_family(family, patrol, *TABLES)}, _SINGLE]}
    for begun in (
        (*call("CreateMissionBatch", batch), *ended),
        (*CREATED, *call("AppendMissionBatch", batch), *ended * 2),
    ):
        yield (_SUBSCRIBE, *begun, *reached, *reached, *reached, *reached, *skip, *skip, *ended)


def _choices() -> Iterator[tuple[ScriptStep, ...]]:
    """Which goal is taken where some are not free: at the start, after a skip, and when that changes on the way."""
    begun = (_SUBSCRIBE, *call("CreateMission", _AUTO))
    yield (*begun, *drive("world", occupied=["table-1"]), *drive("world", occupied=[]), *call("SkipGoal"))
    for taken in (["table-1"], ["table-2"], ["table-1", "table-2"]):
        occupied = drive("world", occupied=taken)
        yield (_SUBSCRIBE, *occupied, *call("CreateMission", _AUTO), *call("SkipGoal"), *call("SkipGoal"))
        yield (_SUBSCRIBE, *call("CreateMission", _AUTO), *occupied, *call("SkipGoal"), *drive("goalReached"))
        behind = (*call("CreateMission", _SINGLE), *call("AppendMission", _AUTO))
        yield (_SUBSCRIBE, *behind, *occupied, *drive("missionSucceeded"), *call("SkipGoal"))


def _again(family: str, which: str) -> Iterator[tuple[ScriptStep, ...]]:
    """What was done once is done once more: pauses, skips, and calls that fail on the way."""
    four = of_family(family, which, *TABLES, TABLES[0])
    begun = (_SUBSCRIBE, *call("CreateMission", {"mission": four}))
    pause, resume, skip, reached = commanded(0, PAUSE), commanded(0, RESUME), call("SkipGoal"), drive("goalReached")
    yield (*begun, *pause, *resume, *pause, *resume, *reached, *pause, *resume, *reached, *reached, *reached)
    yield (*begun, *pause, *pause, *resume, *reached, *resume, *reached)
    yield (*begun, *skip, *skip, *skip, *skip)
    yield (*begun, *reached, *pause, *skip, *resume, *skip, *reached, *reached)
    for status in ("INTERNAL", "DEADLINE_EXCEEDED"):
        fault = drive("fault", status=status, applied=False)
        for command in COMMANDS:
            yield (*begun, *reached, *fault, *commanded(0, command), *commanded(0, command), *reached)
        batch = {"missions": [_SINGLE, {"mission": four}, _SINGLE]}
        yield (*begun, *fault, *call("AppendMissionBatch", batch), *drive("missionSucceeded"), *reached)
        yield (_SUBSCRIBE, *fault, *call("CreateMissionBatch", batch), *reached, *reached)


def _left_behind(family: str, which: str) -> Iterator[tuple[ScriptStep, ...]]:
    """A mission that has come some way ends, in every way, and another as long has its turn: nothing of it is left."""
    long = _several(which, family)
    begun, reached = (_SUBSCRIBE, *call("CreateMission", long)), drive("goalReached")
    ends = (
        drive("missionSucceeded"),
        drive("missionFailed"),
        commanded(0, CANCEL),
        (*commanded(0, PAUSE), *commanded(0, CANCEL)),
        (*commanded(0, FINISH), *reached),
        (*reached, *reached),
    )
    for end in ends:
        yield (*begun, *reached, *end, *call("CreateMission", long), *reached, *call("SkipGoal"))
        yield (*begun, *call("AppendMission", long), *reached, *end, *reached, *call("SkipGoal"))


def _impossible() -> Iterator[tuple[ScriptStep, ...]]:
    """What should have been refused is followed to its end, if it was not: missions, and a command that is none."""
    for way in _ALIVE:
        yield (*way, *commanded(0, "COMMAND_UNKNOWN"), *drive("goalReached"))
    foreign = of_family("carti", "traverseMission", *TABLES)
    nowhere = of_family("servi", "deliveryMission", *TABLES, "nowhere")
    otherwise = of_family("servi", "deliveryMission", TABLES[0], TABLES[1].upper())
    for mission in (foreign, nowhere, otherwise):
        on = (*drive("goalReached") * 4, *drive("missionSucceeded"))
        batch = {"missions": [_SINGLE, {"mission": mission}]}
        yield (_SUBSCRIBE, *call("CreateMission", {"mission": mission}), *on)
        yield (_SUBSCRIBE, *call("CreateMissionBatch", batch), *drive("missionSucceeded"), *on)
        begun = (_SUBSCRIBE, *call("CreateMission", _SINGLE))
        yield (*begun, *call("AppendMission", {"mission": mission}), *drive("missionSucceeded"), *on)
        yield (
            *begun,
            *call("AppendMissionBatch", batch),
            *drive("missionSucceeded"),
            *drive("missionSucceeded"),
            *on,
        )


def _poses() -> Iterator[tuple[ScriptStep, ...]]:
    """Goals that are poses: the origin of the map, one to choose before what is free as well, some behind others."""
    origin: JSON = {"pose": {"xMeters": 0.0, "yMeters": 0.0, "headingRadians": 0.0}}
    pose: JSON = {"pose": {"xMeters": 2.5, "yMeters": 1.25, "headingRadians": 0.5}}
    mixed = {"goals": [*goals_at(TABLES[0]), pose, origin]}
    either: JSON = {"mission": {"baseMission": {"navigateAutoMission": {"goals": [pose, *goals_at(TABLES[0])]}}}}
    yield (
        _SUBSCRIBE,
        *call("CreateMission", {"mission": base(origin)}),
        *drive("missionSucceeded"),
        *call("CreateMission", either),
        *call("AppendMission", {"mission": base(origin)}),
        *drive("missionSucceeded"),
    )
    yield (
        _SUBSCRIBE,
        *call("CreateMission", {"mission": {"serviMission": {"deliveryMission": mixed}}}),
        *drive("goalReached"),
        *drive("missionSucceeded"),
        *call("CreateMissionWorkflow", {"missionWorkflow": {"serviWorkflow": {"hosting": mixed}}}),
    )


def _maps() -> Iterator[tuple[ScriptStep, ...]]:
    """The map of now decides: destinations come and go while nothing is under way, and ahead of a mission."""
    new = "table-4"
    to_new, to_gone = ({"mission": base({"destinationId": name})} for name in (new, TABLES[1]))
    changed, as_before = drive("world", destinations=[TABLES[0], new]), drive("world", destinations=[*TABLES])
    workflows = (
        {"missionWorkflow": {"serviWorkflow": {"delivery": {"goals": goals_at(at)}}}} for at in (TABLES[1], new)
    )
    yield (
        _SUBSCRIBE,
        *changed,
        *call("CreateMission", to_gone),
        *call("CreateMissionBatch", {"missions": [to_new, to_gone]}),
        *call("CreateMission", to_new),
        *call("AppendMission", to_gone),
        *call("AppendMission", to_new),
        *call("AppendMissionBatch", {"missions": [to_new, to_gone]}),
        *drive("missionSucceeded") * 2,
        *(step for one in workflows for step in call("CreateMissionWorkflow", one)),
        *drive("missionSucceeded"),
        *as_before,
        *call("CreateMission", to_new),
        *call("CreateMission", to_gone),
    )
    yield (*_BEGUN, *changed, *drive("goalReached") * 2, *as_before, *drive("goalReached"))


def _two_watch() -> Iterator[tuple[ScriptStep, ...]]:
    """Whatever happens is shown to all who watch, and to one who comes later."""
    yield (
        _SUBSCRIBE,
        *_BEGUN,
        *APPENDED,
        *commanded(0, PAUSE),
        *commanded(0, RESUME),
        *drive("goalReached"),
        _SUBSCRIBE,
        *call("SkipGoal"),
        *drive("missionFailed"),
        *drive("missionSucceeded"),
        *call("ClearMissionStatus"),
        *call("ChargeRobot"),
        *commanded(2, FINISH),
        *call("CreateMissionBatch", {"missions": [_SINGLE, _SINGLE]}),
        *commanded(3, CANCEL),
    )


SCRIPTS = (
    *_poses(),
    *_maps(),
    *_two_watch(),
    *_choices(),
    *_commands(),
    *_patrols("servi", "deliveryPatrolMission", "bussingPatrolMission"),
    *_again("servi", "deliveryMission"),
    *_made(
        "servi",
        "deliveryPatrolMission",
        "delivery",
        "deliveryPatrol",
        "bussing",
        "bussingPatrol",
        "hosting",
        "hostingPatrol",
    ),
    *_impossible(),
    *_left_behind("servi", "deliveryMission"),
)
APART = {
    "carti": (
        *_patrols("carti", "traversePatrolMission"),
        *_again("carti", "traverseMission"),
        *_made("carti", "traversePatrolMission", "traverse", "traversePatrol"),
        *_left_behind("carti", "traverseMission"),
    )
}
"""Of a family that is not the usual one: its robots, too, go round and do again what was done once."""
