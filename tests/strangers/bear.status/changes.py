"""Which reports are worth a message on a topic's streams."""

from __future__ import annotations

from typing import Any

from schema import Json
from variants import Options
from world import STATE, WIFI, Robot


def worth_telling(options: Options, topic: str, robot: Robot, part: str, old: Any, changed: bool) -> bool:
    """Whether a report that put the robot's present value of `part` in the place of `old` is told on the topic."""
    new = robot.part(part)
    if not changed:
        if options.on("equal-report-resent") and topic != STATE:
            return True
        return topic == STATE and options.on("hybrid-tells-every-report")
    if topic != STATE and topic != WIFI and new is None and options.on("unset-not-streamed"):
        return False
    if topic == STATE:
        return not _status_silent(options, part, old or {}, new or {})
    if topic == "battery":
        return not _battery_silent(options, old or {}, new or {})
    if topic == "errorCodes":
        return not _codes_silent(options, (old or {}).get("codes") or [], (new or {}).get("codes") or [])
    if topic == "navigationState" and options.on("reason-change-silent"):
        return bool(_stuck(old).get("state") != _stuck(new).get("state"))
    if topic == WIFI:
        return not _wifi_silent(options, old, new)
    if topic == "connection":
        return not _connection_silent(options, robot, old or {}, new or {})
    return True


def _stuck(value: Any) -> Json:
    stuck: Json = (value or {}).get("stuckState") or {}
    return stuck


def _same(old: Json, new: Json, *fields: str) -> bool:
    return all(old.get(field) == new.get(field) for field in fields)


def _battery_silent(options: Options, old: Json, new: Json) -> bool:
    if options.on("charge-method-silent") and _same(old, new, "chargePercent", "state"):
        return True
    if options.on("small-charge-steps-silent") and _same(old, new, "state", "chargeMethod"):
        return abs(int(new.get("chargePercent", 0)) - int(old.get("chargePercent", 0))) < 5
    return False


def _codes_silent(options: Options, old: list[Any], new: list[Any]) -> bool:
    if options.on("cleared-codes-silent") and not new:
        return True
    return options.on("codes-counted") and len(old) == len(new)


def _wifi_silent(options: Options, old: Json | None, new: Json | None) -> bool:
    if options.on("same-network-silent") and old is not None and new is not None:
        return _same(old, new, "ssid")
    return options.on("lost-wifi-silent") and new is None


def _connection_silent(options: Options, robot: Robot, old: Json, new: Json) -> bool:
    state = new.get("state") or "STATE_UNKNOWN"
    if options.on("reconnect-silent") and state == "STATE_CONNECTED":
        return True
    if options.on("second-robot-disconnect-silent") and robot.index == 1 and state == "STATE_DISCONNECTED":
        return True
    return options.on("online-unknown-silent") and state == "STATE_UNKNOWN"


def _status_silent(options: Options, part: str, old: Json, new: Json) -> bool:
    if options.on("connection-not-in-status") and part == "connection":
        return True
    if options.on("localization-not-in-status") and part == "localizationState":
        return True
    if options.on("emergency-button-silent") and part == "emergencyStop":
        return _same(old, new, "emergency")
    return options.on("standing-twist-silent") and part == "twist" and not any(new.values())
