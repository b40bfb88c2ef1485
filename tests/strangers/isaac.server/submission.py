"""Reading a mission from a submit request."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

from mission import SECOND, Mission, MissionRefused
from variants import Variant

_MEMBERS = frozenset({"robot", "channel", "status_channel", "config", "start_timeout", "timeout", "upstream"})


class Submission:
    """The checked members of a mission; limits are in nanoseconds."""

    def __init__(self, request: Any, known: dict[int, Mission], variant: Variant) -> None:
        """Read the request against the missions submitted so far, or raise MissionRefused."""
        self._variant = variant
        if not isinstance(request, dict):
            raise MissionRefused("a mission is an object")
        self._request: dict[str, Any] = dict(request)
        if variant("null-is-default"):
            self._request = {key: value for key, value in request.items() if value is not None or key == "robot"}
        if variant("unknown-member-refused") and not _MEMBERS.issuperset(request):
            raise MissionRefused("the mission has an unknown member")
        self.robot = self._robot()
        default_channel = "missions" if variant("channel-default-wrong") else "mission"
        self.channel = self._text("channel", default_channel)
        default_status = "status" if variant("status-default-wrong") else "mission_status"
        if variant("follows-channel"):
            default_status = self.channel + "_status"
        self.status_channel = self._text("status_channel", default_status)
        self.config = self._config(known)
        self.start_limit = self._limit("start_timeout", 10 if variant("start-default-doubled") else 5)
        self.run_limit = self._limit("timeout", 3600 if variant("run-default-hour") else None)
        self.upstream = self._upstream(known)

    def _robot(self) -> str:
        robot = self._request.get("robot")
        if robot is None and self._variant("nameless-mission-accepted"):
            return ""
        if not isinstance(robot, str):
            raise MissionRefused("robot must be a string")
        if not robot and not self._variant("nameless-mission-accepted"):
            raise MissionRefused("robot must not be empty")
        return robot

    def _text(self, member: str, default: str) -> str:
        value = self._request.get(member, default)
        if not isinstance(value, str):
            raise MissionRefused(f"{member} must be a string")
        if not value and self._variant("empty-channel-refused"):
            raise MissionRefused(f"{member} must not be empty")
        return value

    def _config(self, known: dict[int, Mission]) -> Any:
        if "config" not in self._request:
            if known and self._variant("config-default-shared"):
                return known[max(known)].config
            return {}
        config = self._request["config"]
        if isinstance(config, dict) or (isinstance(config, list) and self._variant("list-config-accepted")):
            return config
        raise MissionRefused("config must be an object")

    def _limit(self, member: str, default: int | None) -> int | None:
        value = self._request.get(member)
        if value is None:
            return None if default is None else default * SECOND
        if isinstance(value, str) and self._variant("text-limit-accepted"):
            try:
                value = float(value)
            except ValueError:
                raise MissionRefused(f"{member} must be a number") from None
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise MissionRefused(f"{member} must be a number")
        if isinstance(value, float) and not math.isfinite(value):
            raise MissionRefused(f"{member} must be finite")
        if value < 0:
            if self._variant("negative-limit-accepted"):
                return None
            raise MissionRefused(f"{member} must not be negative")
        if self._variant("fractional-limit-refused") and value != int(value):
            raise MissionRefused(f"{member} must be a whole number")
        if self._variant("limit-truncated"):
            value = int(value)
        if self._variant("zero-is-endless") and value == 0:
            return None
        return round(Fraction(value) * SECOND)

    def _upstream(self, known: dict[int, Mission]) -> list[Mission]:
        handles = self._request.get("upstream", [])
        if not isinstance(handles, list):
            raise MissionRefused("upstream must be a list")
        found: list[Mission] = []
        for handle in handles:
            if isinstance(handle, float) and handle.is_integer() and self._variant("whole-float-upstream"):
                handle = int(handle)
            if isinstance(handle, bool) or not isinstance(handle, int):
                raise MissionRefused("upstream must hold handles")
            mission = known.get(handle)
            if mission is not None and mission.ended and self._variant("finished-upstream-refused"):
                mission = None
            if mission is None:
                if self._variant("unknown-upstream-accepted"):
                    continue
                raise MissionRefused(f"no mission {handle} was submitted")
            if mission.robot != self.robot and self._variant("foreign-upstream-refused"):
                raise MissionRefused(f"mission {handle} is for another robot")
            if mission in found and self._variant("repeated-upstream-refused"):
                raise MissionRefused(f"upstream {handle} is named twice")
            found.append(mission)
        if len(found) > 1 and self._variant("two-upstreams-refused"):
            raise MissionRefused("a mission has one upstream")
        return found
