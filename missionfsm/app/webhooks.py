"""Bare messages of subscriptions and bodies of webhooks: which subscription and robot each belongs to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from attrs import frozen

from missionfsm.bear.mission.promises import CURRENT, GOAL_INDEX
from missionfsm.bear.status.state import MAPS, SINGLES
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.text import brief

MISSIONS = "SubscribeMissionStatus"
_SNAKE = str.maketrans({capital: f"_{capital.lower()}" for capital in "ABCDEFGHIJKLMNOPQRSTUVWXYZ"})
_FIELDS: dict[str, str] = {
    name: topic
    for topic, carrier in (
        (MISSIONS, "missionStates"),
        *((endpoint.value, carrier) for endpoint, carrier in (*MAPS.items(), *SINGLES.items())),
    )
    for name in (carrier, carrier.translate(_SNAKE))
}
"""Each field that carries states, in both of its spellings, with the subscription whose messages have it."""

_MAPPED = frozenset(name for carrier in MAPS.values() for name in (carrier, carrier.translate(_SNAKE)))
_ENVELOPE = frozenset({"metadata", "robotId", "robot_id"})


def subscription(message: JSON) -> str | None:
    """The subscription of a message or of the body of a webhook; None for anything else."""
    if not isinstance(message, dict) or "missionfsm" in message:
        return None
    if isinstance(message.get("state"), dict) and message.keys() & {"robot_id", "robotId"}:
        state = message["state"]
        return MISSIONS if "missions" in state else next((_FIELDS[name] for name in state if name in _FIELDS), None)
    return next((_FIELDS[name] for name in message if name in _FIELDS), None)


def unwrapped(message: JSON) -> tuple[str, JSON]:
    """The robot that a message or a webhook names in its envelope, and the message as a subscription sends it."""
    robot = message.get("robot_id") or message.get("robotId") or ""
    if isinstance(message.get("state"), dict):
        return _posted(robot, message["state"])
    if subscription(message) == MISSIONS and isinstance(robot, str):  # a message of a mission stream names no robot
        return robot, {name: value for name, value in message.items() if name not in ("robotId", "robot_id")}
    return "", message


def _posted(robot: JSON, state: JSON) -> tuple[str, JSON]:
    """The robot, unless it is in the message, and the message of a subscription that a webhook's `state` stands for."""
    known = {name: value for name, value in state.items() if name not in ("current_mission", "current_goal")}
    metadata = {"metadata": known.pop("metadata")} if "metadata" in known else {}
    if "missions" in known:
        return str(robot), {**metadata, "missionStates": known}
    name = next((name for name in known if name in _MAPPED), None)
    if name is not None:
        entry = known[name] if isinstance(known[name], dict) else {name: known[name]}
        return "", {name: {robot: {**metadata, **entry}}}
    return "", {**metadata, "robotId": robot, **known}


@frozen
class Contradiction:
    """What the body of a webhook says of the current mission that differs from its list of missions.

    Attributes:
        rule: the rule that it breaks.
        says: what it is, in words.
        flagged: whether it is an oddity: it names the same mission and goal, or none that the list has.
    """

    rule: Rule
    says: str
    flagged: bool = True


def contradictions(message: JSON) -> Iterator[Contradiction]:
    """What the body of a webhook repeats otherwise than it says it."""
    state = _without_nulls(message.get("state"))
    missions = state.get("missions", []) if isinstance(state, dict) else None
    if not isinstance(missions, list):
        return
    at = state.get("current_mission_index", state.get("currentMissionIndex", 0))
    mission = _at(missions, at)
    shown = state.get("current_mission")
    if shown is not None and shown != mission:
        says = f"current_mission is not the one in missions at current_mission_index {at}"
        other = next((f": it is {one}, not {two}" for one, two in _told(shown, mission) if one != two), "")
        yield Contradiction(CURRENT, says + other, flagged=not other)
        mission = shown
    of = mission if isinstance(mission, dict) else {}
    index = of.get("current_goal_index", of.get("currentGoalIndex", 0))
    goal, goals = state.get("current_goal"), of.get("goals")
    goals = goals if isinstance(goals, list) else []
    if goal is not None and goal != _at(goals, index):
        says = "current_goal is not the one in goals at current_goal_index"
        active = of.get("state") in ("STATE_RUNNING", "STATE_PAUSED") and _at(goals, index) is not None
        named = active and goal in goals
        yield Contradiction(
            GOAL_INDEX, f"{says} {index}: it is the one at {goals.index(goal)}" if named else says, flagged=not named
        )


def _told(shown: JSON, listed: JSON) -> Iterator[tuple[str, str]]:
    """The id of a mission as it is shown twice, and its state, where both say it."""
    if isinstance(shown, dict) and isinstance(listed, dict):
        for names in (("mission_id", "missionId"), ("state",)):
            one, two = (next((it[name] for name in names if name in it), None) for it in (shown, listed))
            if one is not None and two is not None:
                yield brief(one), brief(two)


def _at(listed: JSON, index: JSON) -> JSON:
    return listed[index] if isinstance(listed, list) and type(index) is int and 0 <= index < len(listed) else None


def _without_nulls(value: JSON) -> JSON:
    """A value without the members that are null, which are unset."""
    if isinstance(value, dict):
        return {name: _without_nulls(one) for name, one in value.items() if one is not None}
    return [_without_nulls(one) for one in value] if isinstance(value, list) else value


def topic_of(message: JSON, known: Iterable[str]) -> str:
    """The subscription of a message. A message without a payload belongs to the only subscription so far.

    Args:
        message: the message.
        known: the subscriptions so far.

    Raises:
        UnreadableError: it is no message of a subscription.
    """
    topic = subscription(message)
    if topic is not None:
        return topic
    topics = tuple(known)
    if len(topics) == 1 and (not message or message.keys() & _ENVELOPE):
        return topics[0]
    says = f"{brief(message)} is no message of a subscription: it has none of {', '.join(tuple(_FIELDS)[::2])}"
    raise UnreadableError(says)
