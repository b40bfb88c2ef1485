"""How an implementation of the status API may break its promises: one wrong thing at a time, for the oracle's teeth."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator

from attrs import evolve

from missionfsm.bear.status import values
from missionfsm.bear.status.messages import RobotState
from missionfsm.bear.status.rules import OPERATIONS
from missionfsm.bear.status.state import GET, MAPS, SINGLES, Endpoint
from missionfsm.bear.status.stream import SELECTED, SEQUENCE, UPDATES, VALUES, WELL_FORMED
from missionfsm.bear.status.views import Promised
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.mutations import MessageMutation, StepMutation
from missionfsm.kernel.step import Step

Change = Callable[[dict[str, JSON]], None]


def _entries(message: JSON) -> Iterator[dict[str, JSON]]:
    """What of a message is about one robot: itself, or each entry of its map."""
    for name in MAPS.values():
        if name in message:
            yield from message[name].values()
            return
    yield message


def _each(change: Change) -> Callable[[JSON], JSON]:
    """A change of everything in a message that is about one robot."""

    def mutate_message(message: JSON) -> JSON:
        changed = copy.deepcopy(message)
        for entry in _entries(changed):
            change(entry)
        return changed

    return mutate_message


def _numbered(number: Callable[[int], int]) -> Callable[[JSON], JSON]:
    def change(entry: dict[str, JSON]) -> None:
        entry["metadata"]["sequenceNumber"] = number(entry["metadata"]["sequenceNumber"])

    return _each(change)


def _of(endpoint: Endpoint, change: Change) -> Callable[[JSON], JSON]:
    """A change of the messages of one subscription; of others nothing."""
    field = SINGLES.get(endpoint) or MAPS[endpoint]

    def mutate_message(message: JSON) -> JSON:
        if field not in message:
            return message
        changed = copy.deepcopy(message)
        for entry in [changed[field]] if endpoint in SINGLES else changed[field].values():
            change(entry)
        return changed

    return mutate_message


def _elsewhere(message: JSON) -> JSON:
    """The same about a robot that nobody has."""
    changed = copy.deepcopy(message)
    for name in MAPS.values():
        if name in changed:
            changed[name] = {f"{robot}-twin": entry for robot, entry in changed[name].items()}
            return changed
    changed["robotId"] += "-twin"
    return changed


def _battery(**fields: JSON) -> Callable[[JSON], JSON]:
    return _of(Endpoint.BATTERY, lambda battery: battery.update(fields))


def _stuck(state: str, reason: str) -> Callable[[JSON], JSON]:
    stuck = {"stuckState": {"state": state, "reason": reason}}
    return _of(Endpoint.NAVIGATION, lambda navigation: navigation.update(stuck))


def _poor(entry: dict[str, JSON]) -> None:
    if "connectedWifi" in entry:
        entry["connectedWifi"]["linkQuality"] += 71


def _unnetworked(entry: dict[str, JSON]) -> None:
    entry.pop("connectedWifi", None)


def _sleeping(state: dict[str, JSON]) -> None:
    state["mission"] = {"missionId": "none", "state": "STATE_RUNNING", "goals": [], "currentGoalIndex": 5}


def _moving(state: dict[str, JSON]) -> None:
    state["twist"] = {"linearVelocity": 9.0}
    state["navigationState"] = {"stuckState": {"state": "STATE_STUCK"}}


MESSAGE_MUTATIONS = (
    MessageMutation(WELL_FORMED.id, "has no metadata", _each(lambda entry: entry.pop("metadata"))),
    MessageMutation(WELL_FORMED.id, "has a battery in words", _battery(chargePercent="half")),
    MessageMutation(SEQUENCE.id, "never changes", _numbered(lambda _: 7)),
    MessageMutation(SEQUENCE.id, "goes down", _numbered(lambda number: 10**6 - number)),
    MessageMutation(SEQUENCE.id, "is negative", _numbered(lambda number: -number)),
    MessageMutation(SELECTED.id, "is about another robot", _elsewhere),
    MessageMutation(
        UPDATES.id, "shows a battery that nobody reported", _battery(chargePercent=33, state="STATE_CHARGING")
    ),
    MessageMutation(VALUES["SubscribeBatteryStatus"].id, "is always discharging", _battery(state="STATE_DISCHARGING")),
    MessageMutation(
        VALUES["SubscribeErrorCodes"].id,
        "shows no errors",
        _of(Endpoint.ERRORS, lambda entry: entry.update(codes=[])),
    ),
    MessageMutation(
        VALUES["SubscribeNavigationStatus"].id, "is never stuck", _stuck("STATE_NOT_STUCK", "REASON_UNKNOWN")
    ),
    MessageMutation(VALUES["SubscribeNetworkStatus"].id, "shows no network", _of(Endpoint.NETWORK, _unnetworked)),
    MessageMutation(
        VALUES["SubscribeOnlineStatus"].id,
        "is always connected",
        _of(Endpoint.ONLINE, lambda entry: entry.update(connection={"state": "STATE_CONNECTED"})),
    ),
    MessageMutation(
        VALUES["SubscribeRobotStatus"].id,
        "leaves out the emergency stop",
        _of(Endpoint.ROBOT, lambda state: state.pop("emergencyStop", None)),
    ),
    MessageMutation(values.enum_values_are_documented.rule.id, "invents a state", _battery(state=4)),
    MessageMutation(values.the_charge_is_a_percentage.rule.id, "counts in tenths", _battery(chargePercent=780)),
    MessageMutation(values.the_link_quality_is_in_its_range.rule.id, "is above 70", _of(Endpoint.NETWORK, _poor)),
    MessageMutation(
        values.only_a_stuck_robot_has_a_reason.rule.id,
        "has a reason while it is free",
        _stuck("STATE_NOT_STUCK", "REASON_PATH_BLOCKED"),
    ),
    MessageMutation(values.a_stuck_state_is_known.rule.id, "is unknown", _stuck("STATE_UNKNOWN", "REASON_UNKNOWN")),
    MessageMutation(
        values.reserved_reasons_are_not_used.rule.id,
        "has a reserved reason",
        _stuck("STATE_STUCK", "REASON_DESTINATION_UNREACHABLE"),
    ),
    MessageMutation(
        values.one_type_of_robot_at_a_time.rule.id,
        "has two types",
        _of(Endpoint.ROBOT, lambda state: state.update(serviState={}, cartiState={})),
    ),
    MessageMutation(
        values.the_goal_index_is_one_of_the_goals.rule.id, "is past the goals", _of(Endpoint.ROBOT, _sleeping)
    ),
    MessageMutation(
        values.a_full_battery_is_charged.rule.id, "is full at once", _battery(chargePercent=50, state="STATE_FULL")
    ),
    MessageMutation(
        values.a_discharging_battery_is_on_no_charger.rule.id,
        "discharges on a wire",
        _battery(state="STATE_DISCHARGING", chargeMethod="CHARGE_METHOD_WIRED"),
    ),
    MessageMutation(
        values.a_charging_battery_is_on_a_charger.rule.id,
        "charges on nothing",
        _battery(state="STATE_CHARGING", chargeMethod="CHARGE_METHOD_NONE"),
    ),
    MessageMutation(values.a_stuck_robot_stands.rule.id, "moves while it is stuck", _of(Endpoint.ROBOT, _moving)),
)
"""Ways to send wrong messages; every promise about messages has one."""


def _without_battery(_: object, step: Step) -> Step:
    if step.answer is None or not isinstance(step.answer.shape, Promised):
        return step
    promised = step.answer.shape
    if not isinstance(promised.shown.value, RobotState):
        return step
    shown = evolve(promised.shown, value=evolve(promised.shown.value, battery=None))
    return evolve(step, answer=evolve(step.answer, shape=evolve(promised, shown=shown)))


(_ANSWERED,) = OPERATIONS[GET].promises
STEP_MUTATIONS = (StepMutation(VALUES[GET].id, "leaves out the battery", _without_battery, at=_ANSWERED.id),)
"""Ways to take wrong steps that show in no message."""
