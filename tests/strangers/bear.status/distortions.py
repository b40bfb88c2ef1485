"""Faults in single values: what a part of a robot's state is turned into before it is shown.

Each entry names the bug, where it acts (`get` is GetRobotStatus, otherwise a topic; `*` is everywhere), the part,
and a function from the part's value, which it may change, to the value that is shown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from schema import Json
from variants import Options

Change = Callable[[Json], Any]


@dataclass(frozen=True)
class Distortion:
    """One fault in a value."""

    name: str
    scopes: tuple[str, ...]
    part: str
    change: Change


def _swapped(one: str, other: str) -> Change:
    def change(value: Json) -> Json:
        pair = {one: value.get(other), other: value.get(one)}
        rest = {name: member for name, member in value.items() if name not in pair}
        return rest | {name: member for name, member in pair.items() if member is not None}

    return change


def _replaced(field: str, table: dict[Any, Any]) -> Change:
    def change(value: Json) -> Json:
        if value.get(field) in table:
            value[field] = table[value[field]]
        return value

    return change


def _computed(field: str, compute: Callable[[Any], Any]) -> Change:
    def change(value: Json) -> Json:
        if isinstance(value.get(field), (int, float)):
            value[field] = compute(value[field])
        return value

    return change


def _renamed(old: str, new: str) -> Change:
    def change(value: Json) -> Json:
        if old in value:
            value[new] = value.pop(old)
        return value

    return change


def _stuck(inner: Change) -> Change:
    def change(value: Json) -> Json:
        if isinstance(value.get("stuckState"), dict):
            value["stuckState"] = inner(value["stuckState"])
        return value

    return change


def _reason_made_up(value: Json) -> Json:
    if value.get("state") == "STATE_NOT_STUCK":
        value["reason"] = "REASON_PATH_BLOCKED"
    return value


def _severity_from_code(value: Json) -> Json:
    for code in value.get("codes") or []:
        code["severity"] = "SEVERITY_HIGH" if int(code.get("code", 0)) >= 2000 else "SEVERITY_MEDIUM"
    return value


def _most_severe(value: Json) -> Json:
    order = {"SEVERITY_LOW": 1, "SEVERITY_MEDIUM": 2, "SEVERITY_HIGH": 3}
    codes = sorted(value.get("codes") or [], key=lambda code: -order.get(str(code.get("severity")), 0))
    return value | {"codes": codes[:1]}


def _message_dropped(value: Json) -> Json:
    for code in value.get("codes") or []:
        code.pop("message", None)
    return value


_RESERVED = {"REASON_PATH_BLOCKED": "REASON_DESTINATION_OBSTRUCTED"}
_SECURITY = {
    "SECURITY_PASSWORD_SECURED": "SECURITY_USERNAME_PASSWORD_SECURED",
    "SECURITY_USERNAME_PASSWORD_SECURED": "SECURITY_PASSWORD_SECURED",
}

DISTORTIONS: tuple[Distortion, ...] = (
    Distortion("twist-sign-turned", ("*",), "twist", _computed("angularVelocity", lambda value: -value)),
    Distortion("reverse-as-forward", ("state",), "twist", _computed("linearVelocity", abs)),
    Distortion("estop-swapped", ("*",), "emergencyStop", _swapped("emergency", "buttonPressed")),
    Distortion(
        "get-always-connected",
        ("get",),
        "connection",
        _replaced("state", {"STATE_DISCONNECTED": "STATE_CONNECTED"}),
    ),
    Distortion("charge-capped", ("battery",), "battery", _computed("chargePercent", lambda value: min(value, 99))),
    Distortion("charge-counted-down", ("get",), "battery", _computed("chargePercent", lambda value: 100 - value)),
    Distortion("full-as-charging", ("battery",), "battery", _replaced("state", {"STATE_FULL": "STATE_CHARGING"})),
    Distortion(
        "contact-as-wired",
        ("*",),
        "battery",
        _replaced("chargeMethod", {"CHARGE_METHOD_CONTACT": "CHARGE_METHOD_WIRED"}),
    ),
    Distortion(
        "no-charge-method-unset",
        ("battery",),
        "battery",
        _replaced("chargeMethod", {"CHARGE_METHOD_NONE": "CHARGE_METHOD_UNKNOWN"}),
    ),
    Distortion("severity-from-code", ("*",), "errorCodes", _severity_from_code),
    Distortion("worst-code-only", ("errorCodes",), "errorCodes", _most_severe),
    Distortion("code-message-dropped", ("errorCodes",), "errorCodes", _message_dropped),
    Distortion("link-quality-in-percent", ("*",), "wifi", _computed("linkQuality", lambda value: value * 100 // 70)),
    Distortion("signal-without-sign", ("*",), "wifi", _computed("signalLevelDbm", abs)),
    Distortion("signal-field-misnamed", ("*",), "wifi", _renamed("signalLevelDbm", "signalLevel")),
    Distortion("security-mixed-up", ("*",), "wifi", _replaced("security", _SECURITY)),
    Distortion("reason-without-stuck", ("*",), "navigationState", _stuck(_reason_made_up)),
    Distortion(
        "reason-lost",
        ("navigationState",),
        "navigationState",
        _stuck(lambda value: value | {"reason": "REASON_UNKNOWN"}),
    ),
    Distortion(
        "restricted-as-blocked",
        ("*",),
        "navigationState",
        _stuck(_replaced("reason", {"REASON_INSIDE_RESTRICTED_AREA": "REASON_PATH_BLOCKED"})),
    ),
    Distortion("reserved-reason-used", ("*",), "navigationState", _stuck(_replaced("reason", _RESERVED))),
    Distortion(
        "not-stuck-as-unknown",
        ("navigationState",),
        "navigationState",
        _stuck(_replaced("state", {"STATE_NOT_STUCK": "STATE_UNKNOWN"})),
    ),
    Distortion("pose-swapped", ("state",), "pose", _swapped("xMeters", "yMeters")),
    Distortion("navigation-missing", ("get",), "navigationState", lambda value: None),
    Distortion("localization-missing", ("state",), "localizationState", lambda value: None),
    Distortion("mission-missing", ("get",), "mission", lambda value: None),
    Distortion("carti-missing", ("get", "state"), "cartiState", lambda value: None),
)


def distort(options: Options, scope: str, part: str, value: Any) -> Any:
    """The value of a part as the faults in force show it in that scope."""
    if value is None:
        return None
    for entry in DISTORTIONS:
        if entry.part == part and options.on(entry.name) and ("*" in entry.scopes or scope in entry.scopes):
            value = entry.change(value)
    return value
