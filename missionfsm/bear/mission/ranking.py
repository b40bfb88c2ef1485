"""Which of the refusals that hold together is answered, and what that assumes (AM-01, AM-04, AM-38)."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping

from missionfsm.bear.mission.inputs import Call
from missionfsm.bear.mission.readings.charging import AM_38_BUSY, DOCK, LOCATION
from missionfsm.bear.mission.readings.codes import AM_01, AM_01_BLOCKED, AM_04, AM_04_NO_ID
from missionfsm.bear.mission.rules import charging
from missionfsm.bear.mission.rules.aspects import ABILITY, EITHER, FORM, GOALS, SHAPE, STATE, TAKEN
from missionfsm.bear.mission.rules.updating import id_situation
from missionfsm.bear.mission.state import Situation
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.rules import INVALID_ARGUMENT, Decision, Rule, decide

Ranked = Iterator[tuple[str, tuple[Assumption, ...]]]
"""The codes that may be answered, each with the readings that this assumes."""


def decisions(holding: tuple[Rule, ...], robot: Situation, call: Call) -> tuple[Decision, ...]:
    """What may be answered where some rules hold, and what that assumes about AM-01, AM-04 or AM-38."""
    operation = call.request.operation
    return _decisions(operation, id_situation(robot, call) if operation == "UpdateMission" else "", holding)


@functools.lru_cache(maxsize=10_000)
def _decisions(operation: str, about: str, holding: tuple[Rule, ...]) -> tuple[Decision, ...]:
    if operation == "UpdateMission":
        return decide(holding, functools.partial(_rank_update, about))
    if operation == "ChargeRobot":
        return decide(holding, _rank_charge)
    return decide(holding, functools.partial(_rank_format_and_state, operation))


def _codes(holding: Iterable[Rule]) -> Iterator[str]:
    return iter(dict.fromkeys(str(one.code) for one in holding))


def _rank_format_and_state(operation: str, holding: tuple[Rule, ...]) -> Ranked:
    """AM-01: the format first, the state first, or the state between shape and goals.

    Where no state forbids the call, there is nothing that could come first. What cannot be decoded is
    INVALID_ARGUMENT whatever is looked at first, since there is no request to look at anything for; what others have
    taken may be looked at whenever an implementation likes.
    """
    forbidding = tuple(_forbidding(operation, holding))
    looked_at = {one.looks_at for one in holding if one.code == INVALID_ARGUMENT} - {ABILITY}
    invalid = looked_at - {TAKEN}
    if not forbidding or not invalid:
        yield from ((code, ()) for code in _codes(holding))
        return
    if not looked_at.isdisjoint((FORM, TAKEN)):
        yield INVALID_ARGUMENT, ()
    sure = not invalid.isdisjoint((FORM, SHAPE))  # of EITHER nobody knows whether it is noticed so early
    early = sure or EITHER in invalid
    about = dict.fromkeys(ambiguity for _, ambiguity in forbidding)
    yield INVALID_ARGUMENT, tuple(_format_first(one, early=early) for one in about)
    if FORM not in invalid:
        yield from _of_the_family(holding)
    for code, one in forbidding:
        yield code, (one["b"] if sure or "c" not in one.readings else one["b", "c"],)


def _format_first(ambiguity: Ambiguity, *, early: bool) -> Assumption:
    """The readings of a part of AM-01 under which a format that is looked at so early comes before the state."""
    return ambiguity["a", "c"] if early and "c" in ambiguity.readings else ambiguity["a"]


def _of_the_family(holding: tuple[Rule, ...]) -> Ranked:
    """AM-41: what is told by the family of the robot is neither the format nor the state of its missions."""
    yield from (
        (code, ()) for code in _codes(one for one in holding if one.looks_at == EITHER and one.code != INVALID_ARGUMENT)
    )


def _forbidding(operation: str, holding: tuple[Rule, ...]) -> Iterator[tuple[str, Ambiguity]]:
    """The codes by which a state forbids the call, each with the part of AM-01 that ranks it against the format."""
    for looked_at, ambiguity in ((STATE, AM_01[operation]), (ABILITY, AM_01_BLOCKED.get(operation))):
        if ambiguity is not None:
            yield from ((code, ambiguity) for code in _codes(one for one in holding if one.looks_at == looked_at))


def _rank_update(situation: str, holding: tuple[Rule, ...]) -> Ranked:
    """AM-04: the command or the id is answered for."""
    about = AM_04_NO_ID if situation == AM_04_NO_ID.id.partition(".")[2] else AM_04.get(situation)
    for code, looked_at in dict.fromkeys((str(one.code), one.looks_at) for one in holding):
        if about is None or looked_at == FORM:
            yield code, ()
        else:
            yield code, (about["a"] if looked_at == SHAPE else about.besides("a"),)


_BUSY = {
    charging.a_mission_is_running.name: "running",
    charging.a_mission_is_paused.name: "paused",
}
"""What forbids to charge whatever the robot is equipped with: parts of AM-38.

Missions that wait and a robot that is unable to start one are not ranked: they are seldom met together with a charger
that is missing, and each may be read in several ways already.
"""


def _rank_charge(holding: tuple[Rule, ...]) -> Ranked:
    """AM-38: the mission is answered for, or what is missing."""
    left = tuple(one for one in holding if one.looks_at != FORM)
    late: tuple[Assumption, ...] = ()
    if left != holding:
        yield INVALID_ARGUMENT, ()
        late = (AM_01["ChargeRobot"]["b"],)
    yield from ((code, (*late, *assumes)) for code, assumes in _rank_busy(left))


def _rank_busy(holding: tuple[Rule, ...]) -> Ranked:
    busy = {_BUSY[one.name]: str(one.code) for one in holding if one.name in _BUSY}
    missing = {_missing(one): str(one.code) for one in holding if one.looks_at == GOALS}
    ranked = busy and missing
    others = [one for one in holding if not (ranked and (one.looks_at == GOALS or one.name in _BUSY))]
    yield from ((code, ()) for code in _codes(others))
    if ranked:
        yield from _busy_or_missing(busy, missing)


def _busy_or_missing(busy: Mapping[str, str], missing: Mapping[str, str]) -> Ranked:
    """AM-38 for what a robot is busy with and what it lacks, each with its code."""
    for code in busy.values():
        yield code, tuple(AM_38_BUSY[state][what]["e"] for what in missing for state in busy)
    for what, code in missing.items():
        yield code, tuple(AM_38_BUSY[state][what]["f"] for state in busy)


def _missing(rule: Rule) -> str:
    """What a robot lacks of which a rule says that it cannot charge: its dock, or its location."""
    return DOCK if rule.name == charging.NO_DOCK[0].name else LOCATION
