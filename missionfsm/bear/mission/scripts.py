"""Conversations with a robot that are worth having whole: every command in every state, and what patrols do.

Chance seldom keeps one mission in sight long enough to command it in each state that it can be in.
"""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.bear.mission.samples import CANCEL, COMMANDS, FINISH, PAUSE, RESUME, TABLES, auto, base, of_family
from missionfsm.kernel.alphabet import ANY_NAME, Line
from missionfsm.kernel.codec import JSON

_SETTLE = Line("settle")
_SUBSCRIBE = Line("SubscribeMissionStatus", {})


def _drive(event: str, **fields: JSON) -> tuple[Line, ...]:
    return (Line("drive", {"event": event, **fields}), _SETTLE)


def _call(method: str, params: JSON = None) -> tuple[Line, ...]:
    return (Line(method, params or {}), _SETTLE)


def _command(mission: int, command: str) -> tuple[Line, ...]:
    """A command to the how-many-th mission that was created, from 0."""
    params = {"missionCommand": {"missionId": ANY_NAME, "command": command}}
    return (Line("UpdateMission", params, ((0, mission),)), _SETTLE)


_SINGLE: JSON = {"mission": base({"destinationId": TABLES[0]})}
_AUTO: JSON = {"mission": auto(*TABLES)}


def _several(which: str) -> JSON:
    return {"mission": of_family("servi", which, *TABLES)}


_CREATED = (_SUBSCRIBE, *_call("CreateMission", _several("deliveryMission")))
_BEHIND = _call("AppendMission", _SINGLE)

_ALIVE: tuple[tuple[Line, ...], ...] = (
    _CREATED,
    (*_CREATED, *_drive("goalReached")),
    (*_CREATED, *_command(0, PAUSE)),
)
"""Ways to a first mission that has not ended."""

_ENDED: tuple[tuple[Line, ...], ...] = (
    (*_CREATED, *_drive("missionSucceeded")),
    (*_CREATED, *_drive("missionFailed")),
    (*_CREATED, *_command(0, CANCEL)),
    (*_CREATED, *_drive("goalReached"), *_command(0, FINISH)),
)
"""Ways to a first mission that has ended."""


def _commands() -> Iterator[tuple[Line, ...]]:
    for way in _ALIVE:
        for command in COMMANDS:
            yield (*way, *_command(0, command), *_drive("goalReached"))
            yield (*way, *_BEHIND, *_command(0, command), *_drive("goalReached"))
            yield (*way, *_BEHIND, *_command(1, command), *_drive("missionSucceeded"), *_drive("goalReached"))
    for way in _ENDED:
        for command in COMMANDS:
            yield (*way, *_command(0, command), *_call("CreateMission", _SINGLE))
            yield (*way, *_call("CreateMission", _SINGLE), *_command(0, command), *_drive("goalReached"))


def _patrols() -> Iterator[tuple[Line, ...]]:
    """A patrol goes round until it is told otherwise, and what is appended waits for that."""
    for which in ("deliveryPatrolMission", "bussingPatrolMission"):
        begun = (_SUBSCRIBE, *_call("CreateMission", _several(which)))
        round_once = (*_drive("goalReached"), *_drive("goalReached"), *_drive("goalReached"))
        yield (*begun, *round_once, *_drive("goalReached"), *_call("SkipGoal"), *_call("SkipGoal"))
        yield (*begun, *_BEHIND, *round_once, *_call("SkipGoal"), *round_once, *_command(0, FINISH))
        for command in COMMANDS:
            yield (*begun, *round_once, *_command(0, command), *_drive("goalReached"), *_call("SkipGoal"))


def _choices() -> Iterator[tuple[Line, ...]]:
    """Which goal is taken where some are not free: at the start, after a skip, and when that changes on the way."""
    for taken in (["table-1"], ["table-2"], ["table-1", "table-2"]):
        occupied = _drive("world", occupied=taken)
        yield (_SUBSCRIBE, *occupied, *_call("CreateMission", _AUTO), *_call("SkipGoal"), *_call("SkipGoal"))
        yield (_SUBSCRIBE, *_call("CreateMission", _AUTO), *occupied, *_call("SkipGoal"), *_drive("goalReached"))
        behind = (*_call("CreateMission", _SINGLE), *_call("AppendMission", _AUTO))
        yield (_SUBSCRIBE, *behind, *occupied, *_drive("missionSucceeded"), *_call("SkipGoal"))


def _again() -> Iterator[tuple[Line, ...]]:
    """What was done once is done once more: pauses, skips, and calls that fail on the way."""
    four = of_family("servi", "deliveryMission", *TABLES, TABLES[0])
    begun = (_SUBSCRIBE, *_call("CreateMission", {"mission": four}))
    pause, resume, skip, reached = _command(0, PAUSE), _command(0, RESUME), _call("SkipGoal"), _drive("goalReached")
    yield (*begun, *pause, *resume, *pause, *resume, *reached, *pause, *resume, *reached, *reached, *reached)
    yield (*begun, *skip, *skip, *skip, *skip)
    yield (*begun, *reached, *pause, *skip, *resume, *skip, *reached, *reached)
    for status in ("INTERNAL", "DEADLINE_EXCEEDED"):
        fault = _drive("fault", status=status, applied=False)
        for command in COMMANDS:
            yield (*begun, *reached, *fault, *_command(0, command), *_command(0, command), *reached)
        batch = {"missions": [_SINGLE, {"mission": four}, _SINGLE]}
        yield (*begun, *fault, *_call("AppendMissionBatch", batch), *_drive("missionSucceeded"), *reached)
        yield (_SUBSCRIBE, *fault, *_call("CreateMissionBatch", batch), *reached, *reached)


def _impossible() -> Iterator[tuple[Line, ...]]:
    """Missions that should have been refused are followed to their end, if they were not."""
    foreign = of_family("carti", "traverseMission", *TABLES)
    nowhere = of_family("servi", "deliveryMission", *TABLES, "nowhere")
    for mission in (foreign, nowhere):
        on = (*_drive("goalReached") * 4, *_drive("missionSucceeded"))
        batch = {"missions": [_SINGLE, {"mission": mission}]}
        yield (_SUBSCRIBE, *_call("CreateMission", {"mission": mission}), *on)
        yield (_SUBSCRIBE, *_call("CreateMissionBatch", batch), *_drive("missionSucceeded"), *on)
        begun = (_SUBSCRIBE, *_call("CreateMission", _SINGLE))
        yield (*begun, *_call("AppendMission", {"mission": mission}), *_drive("missionSucceeded"), *on)
        yield (
            *begun,
            *_call("AppendMissionBatch", batch),
            *_drive("missionSucceeded"),
            *_drive("missionSucceeded"),
            *on,
        )


SCRIPTS = (*_choices(), *_commands(), *_patrols(), *_again(), *_impossible())
