"""What the page says of values by themselves: ranges, enums, and which values cannot stand together.

A `Check` is one documented sentence: a rule and the function that says what is wrong. Most hold of every message that
anybody sends. Those that are the `robots` own are about what is true of the robot: where the reports are known the
server cannot help them, so they are looked at only where nothing else is known. One that `lasts` is wrong only when
the next message of the robot has it as well, since things change one after the other (AS-15 e, AS-30 e).
"""

from __future__ import annotations

import enum
import functools
import inspect
import struct
from collections.abc import Callable, Iterator
from typing import Any, get_args

import attrs
from attrs import evolve, frozen

from missionfsm.bear.status.messages import (
    BatteryMode,
    BatteryState,
    ChargeMethod,
    NavigationState,
    Reason,
    RobotState,
    Stuck,
    Wifi,
)
from missionfsm.bear.status.state import STATUS, SYSTEM_NAME
from missionfsm.bear.wire.messages import MissionState
from missionfsm.bear.wire.protojson import camel
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import Citation, Rule, promise
from missionfsm.kernel.terms import Content
from missionfsm.kernel.text import brief


@frozen(eq=False)
class Check:
    """A sentence about values.

    Attributes:
        wrong: a value to what is wrong with it, or None.
        of: the class of the values that it is about; None for all.
        robots: it is about the robot itself, not about what is sent of it.
        lasts: it is wrong only if it is so twice in a row.
        under: the reading under which it is right all the same.
    """

    rule: Rule
    wrong: Callable[[Any], str | None]
    of: type | None
    robots: bool = False
    lasts: bool = False
    under: Assumption | None = None


@frozen
class Fault:
    """What is wrong with a value, and by which rule."""

    rule: str
    says: str
    robots: bool = False
    lasts: bool = False


def check(
    *place: str, of: type | None, robots: bool = False, lasts: bool = False
) -> Callable[[Callable[[Any], str | None]], Check]:
    """Make a check of a function: its name is the rule's, the first line of its docstring what a person is told."""

    def register(wrong: Callable[[Any], str | None]) -> Check:
        says, _, argues = (inspect.getdoc(wrong) or "").partition("\n")
        cite: Citation = STATUS[place]
        name = wrong.__name__.replace("_", "-")
        topic = of.__name__ if of else "enums"
        registered = promise(name, says, cite=cite, argues=" ".join(argues.split())).registered(SYSTEM_NAME, topic)
        return Check(registered, wrong, of, robots, lasts)

    return register


@check("SubscribeBatteryStatus", "BatteryState", of=BatteryState)
def the_charge_is_a_percentage(battery: BatteryState) -> str | None:
    """charge_percent is between 0 and 100."""
    percent = battery.charge_percent
    return None if 0 <= percent <= 100 else f"charge_percent is {percent}, expected 0 to 100"


@check("SubscribeNetworkStatus", "Wifi", of=Wifi)
def the_link_quality_is_in_its_range(wifi: Wifi) -> str | None:
    """link_quality is between 0 and 70."""
    return None if 0 <= wifi.link_quality <= 70 else f"link_quality is {wifi.link_quality}, expected 0 to 70"


@check("GetRobotStatus", "StuckState", of=NavigationState)
def only_a_stuck_robot_has_a_reason(navigation: NavigationState) -> str | None:
    """The reason is REASON_UNKNOWN unless the state is STATE_STUCK."""
    stuck = navigation.stuck_state
    if stuck is None or stuck.state == Stuck.STATE_STUCK or stuck.reason == Reason.REASON_UNKNOWN:
        return None
    return f"the reason is {named(stuck.reason)} with {named(stuck.state)}, expected REASON_UNKNOWN"


@check("GetRobotStatus", "StuckState", "(StuckState) Reason enum", of=NavigationState)
def reserved_reasons_are_not_used(navigation: NavigationState) -> str | None:
    """A reserved reason is not emitted.

    AS-19: "currently" leaves room for one that is; that is accepted as a reading and pointed out.
    """
    stuck = navigation.stuck_state
    if stuck is None or stuck.reason not in RESERVED:
        return None
    return f"the reason is {named(stuck.reason)}, which is reserved"


@check("GetRobotStatus", "StuckState", "(StuckState) State enum", of=NavigationState)
def a_stuck_state_is_known(navigation: NavigationState) -> str | None:
    """A stuck state is STATE_NOT_STUCK or STATE_STUCK.

    AS-18: STATE_UNKNOWN is an error, except for a robot of which nothing is known yet.
    """
    known = navigation.stuck_state is not None and navigation.stuck_state.state != Stuck.STATE_UNKNOWN
    return None if known else "the stuck state is STATE_UNKNOWN"


@check("GetRobotStatus", "typed_status oneof", of=RobotState)
def one_type_of_robot_at_a_time(state: RobotState) -> str | None:
    """Only one of servi_state and carti_state is set."""
    both = state.servi_state is not None and state.carti_state is not None
    return "servi_state and carti_state are both set" if both else None


@check("GetRobotStatus", "MissionState", of=MissionState)
def the_goal_index_is_one_of_the_goals(mission: MissionState) -> str | None:
    """current_goal_index is between -1 and the number of goals.

    AS-22: the page's own example has index 1 with one goal, so the index may be the number of goals as well.
    """
    index, last = mission.current_goal_index, len(mission.goals)
    return None if -1 <= index <= last else f"current_goal_index is {index}, expected -1 to {last}"


@check("GetRobotStatus", "enums", of=None)
def enum_values_are_documented(value: object) -> str | None:
    """The value of an enum is one that the page lists."""
    found = _undocumented(value)
    return None if found is None else f"{found[0]} is {found[1]}, which is not documented"


@check("SubscribeBatteryStatus", "State enum", of=BatteryState, robots=True)
def a_full_battery_is_charged(battery: BatteryState) -> str | None:
    """STATE_FULL comes with 95 percent at least (AS-15)."""
    low = battery.state == BatteryMode.STATE_FULL and battery.charge_percent < FULL_ENOUGH
    return f"STATE_FULL at {battery.charge_percent} percent, expected {FULL_ENOUGH} at least" if low else None


@check("SubscribeBatteryStatus", "ChargeMethod enum", of=BatteryState, robots=True, lasts=True)
def a_discharging_battery_is_on_no_charger(battery: BatteryState) -> str | None:
    """STATE_DISCHARGING does not last with a charging method (AS-15)."""
    both = battery.state == BatteryMode.STATE_DISCHARGING and battery.charge_method in CHARGERS
    return f"STATE_DISCHARGING with {named(battery.charge_method)}" if both else None


@check("SubscribeBatteryStatus", "ChargeMethod enum", of=BatteryState, robots=True, lasts=True)
def a_charging_battery_is_on_a_charger(battery: BatteryState) -> str | None:
    """STATE_CHARGING does not last with CHARGE_METHOD_NONE (AS-15)."""
    both = battery.state == BatteryMode.STATE_CHARGING and battery.charge_method == ChargeMethod.CHARGE_METHOD_NONE
    return "STATE_CHARGING with CHARGE_METHOD_NONE" if both else None


@check("GetRobotStatus", "StuckState", of=RobotState, robots=True, lasts=True)
def a_stuck_robot_stands(state: RobotState) -> str | None:
    """A robot that is stuck does not go on moving forward (AS-30)."""
    stuck = state.navigation_state.stuck_state if state.navigation_state else None
    if stuck is None or stuck.state != Stuck.STATE_STUCK or state.twist is None or not state.twist.linear_velocity:
        return None
    return f"STATE_STUCK at {state.twist.linear_velocity:.3g} m/s"


RESERVED = (Reason.REASON_DESTINATION_OBSTRUCTED, Reason.REASON_DESTINATION_UNREACHABLE)
CHARGERS = (ChargeMethod.CHARGE_METHOD_WIRED, ChargeMethod.CHARGE_METHOD_CONTACT)
FULL_ENOUGH = 95
"""The charge, in percent, from which a battery may be called full."""

CHECKS = (
    enum_values_are_documented,
    the_charge_is_a_percentage,
    the_link_quality_is_in_its_range,
    only_a_stuck_robot_has_a_reason,
    a_stuck_state_is_known,
    reserved_reasons_are_not_used,
    one_type_of_robot_at_a_time,
    the_goal_index_is_one_of_the_goals,
    a_full_battery_is_charged,
    a_discharging_battery_is_on_no_charger,
    a_charging_battery_is_on_a_charger,
    a_stuck_robot_stands,
)


def named(value: object) -> str:
    """An enum's value by name, or the number that it has not."""
    return value.name if isinstance(value, enum.Enum) else f"number {value}"


@functools.cache
def _enums(kind: type[attrs.AttrsInstance]) -> tuple[tuple[str, bool], ...]:
    """The fields of a message class, and whether each holds an enum."""
    attrs.resolve_types(kind)
    found = []
    for attribute in attrs.fields(kind):
        declared = get_args(attribute.type) or (attribute.type,)
        is_enum = any(isinstance(one, type) and issubclass(one, enum.IntEnum) for one in declared)
        found.append((attribute.name, is_enum))
    return tuple(found)


def _undocumented(value: Content) -> tuple[str, int] | None:
    """The first enum in a message, and in those inside it, whose number has no name."""
    if isinstance(value, tuple):
        return next(filter(None, map(_undocumented, value)), None)
    if not attrs.has(type(value)):
        return None
    for name, is_enum in _enums(value.__class__):
        content = getattr(value, name)
        if is_enum and isinstance(content, int) and not isinstance(content, enum.IntEnum):
            return camel(name), content
        inner = None if is_enum else _undocumented(content)
        if inner:
            return f"{camel(name)}.{inner[0]}", inner[1]
    return None


def within(value: Content) -> Iterator[Content]:
    """A value of a message and every message that it holds."""
    if isinstance(value, tuple):
        for one in value:
            yield from within(one)
    elif attrs.has(type(value)):
        yield value
        for attribute in attrs.fields(type(value)):
            yield from within(getattr(value, attribute.name))


@functools.lru_cache(maxsize=100_000)
def faults(value: object) -> tuple[Fault, ...]:
    """The faults of a value, and of the values in it."""
    found = []
    wrong = enum_values_are_documented.wrong(value)
    if wrong:
        found.append(_fault(enum_values_are_documented, wrong))
    for part in within(value):
        for one in CHECKS:
            says = one.wrong(part) if one.of is type(part) else None
            if says:
                found.append(_fault(one, says))
    return tuple(found)


def _fault(one: Check, says: str) -> Fault:
    return Fault(one.rule.id, says, one.robots, one.lasts)


def clamped(value: Content) -> Content:
    """AS-28: a battery or a network with its numbers brought into their ranges; the same object if they are in them."""
    if isinstance(value, BatteryState) and the_charge_is_a_percentage.wrong(value):
        return evolve(value, charge_percent=min(max(value.charge_percent, 0), 100))
    if isinstance(value, Wifi) and the_link_quality_is_in_its_range.wrong(value):
        return evolve(value, link_quality=min(max(value.link_quality, 0), 70))
    return value


def single(value: Content) -> Content:
    """A message with its floats as they are on the wire, in 32 bits: equal ones are equal however they are written."""
    if isinstance(value, float):
        try:
            rounded: float = struct.unpack("<f", struct.pack("<f", value))[0]
        except OverflowError:
            return float("inf") if value > 0 else float("-inf")
        return rounded
    if isinstance(value, tuple):
        return tuple(map(single, value))
    if attrs.has(type(value)):
        old = {one.name: getattr(value, one.name) for one in attrs.fields(type(value))}
        new = {name: single(content) for name, content in old.items()}
        changed = {name: content for name, content in new.items() if content is not old[name]}
        return evolve(value, **changed) if changed else value
    return value


def difference(wanted: Content, shown: Content) -> str:
    """In what a value differs from the one expected, in a few words."""
    if attrs.has(type(wanted)) and type(wanted) is type(shown):
        for attribute in attrs.fields(type(wanted)):
            one, other = getattr(wanted, attribute.name), getattr(shown, attribute.name)
            if one != other:
                inner = difference(one, other)
                return f"{attribute.name}{'.' if attrs.has(type(one)) and attrs.has(type(other)) else ' '}{inner}"
    return f"is {brief_value(shown)}, expected {brief_value(wanted)}"


def brief_value(value: Content) -> str:
    """A value as a message shows it: what is set, in short."""
    if value is None:
        return "unset"
    if isinstance(value, tuple):
        return "[" + ", ".join(map(brief_value, value[:3])) + (", …]" if len(value) > 3 else "]")
    if attrs.has(type(value)):
        fields = attrs.fields(type(value))
        parts = [(one.name, getattr(value, one.name)) for one in fields if getattr(value, one.name) is not None]
        return "{" + ", ".join(f"{name}: {brief_value(content)}" for name, content in parts) + "}"
    return named(value) if hasattr(value, "name") else brief(value)
