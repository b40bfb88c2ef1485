"""A conversation, written down step after step: what `scripts` and `matrix` are made of."""

from __future__ import annotations

from missionfsm.isaac.server.samples import ROBOTS, header, introduction, robot_line
from missionfsm.isaac.wire.messages import MissionStatusProto
from missionfsm.kernel.alphabet import ScriptStep, member, pick
from missionfsm.kernel.codec import JSON

A, B = ROBOTS

PAUSE = 1.3
"""Seconds: more than a server takes that looks about once a second, and no part of any timeout."""

MISSION, OTHER, LINK, UUID = 0, 1, 2, 3
"""The slots: two missions that are named as upstreams, a connection, and the mission that a status is about."""


class Script:
    """Writes a script down, step after step.

    Missions, connections and identifiers are numbered from 0 in the order of coming.
    """

    def __init__(self) -> None:
        self.lines: list[ScriptStep] = []

    def submit(self, robot: str, *upstream: int, **fields: JSON) -> Script:
        """A mission for a robot, after others."""
        if upstream:
            fields["upstream"] = [pick("mission", slot) for slot in range(len(upstream))]
        picks = tuple(enumerate(upstream))
        self.lines.append(ScriptStep("submit", {"mission": {"robot": robot, **fields}}, picks))
        return self

    def odd(self, *missions: JSON) -> Script:
        """Submissions with which something is wrong."""
        self.lines += [ScriptStep("submit", {"mission": mission}) for mission in missions]
        return self

    def refused(self, *upstream: JSON) -> Script:
        """A submission that names missions which do not exist."""
        self.lines.append(ScriptStep("submit", {"mission": {"robot": A, "upstream": list(upstream)}}, ((MISSION, 0),)))
        return self

    def look(self) -> Script:
        """Everything settles, and the statuses are asked for."""
        self.lines += [ScriptStep("settle"), ScriptStep("statuses", {})]
        return self

    def wait(self, seconds: float = PAUSE) -> Script:
        """Time passes; then a look."""
        self.lines.append(ScriptStep("drive", {"event": "advance", "seconds": seconds}))
        return self.look()

    def connect(self) -> Script:
        """A connection is opened."""
        self.lines.append(ScriptStep("drive", {"event": "connect"}))
        return self

    def name(self, link: int, robot: str, channel: str = "name", **more: JSON) -> Script:
        """A name is said on a connection; then a look."""
        self.lines.append(ScriptStep("drive", introduction(robot, channel, LINK, **more), ((LINK, link),)))
        return self.look()

    def robot(self, link: int, robot: str) -> Script:
        """A robot connects, says its name, and is noticed."""
        return self.connect().name(link, robot).wait()

    def report(
        self, link: int, mission: int, status: str, channel: str = "mission_status", *, by: str = "header payload"
    ) -> Script:
        """A status is said, and has been noticed."""
        return self.say(link, mission, status, channel, by=by).wait()

    def say(
        self, link: int, mission: int, status: str, channel: str = "mission_status", *, by: str = "header payload"
    ) -> Script:
        """A status is said."""
        uuid = {"uuid": pick("uuid", UUID)}
        head = header(MissionStatusProto, channel, **(uuid if "header" in by else {}))
        payload = {"missionStatus": status, **(uuid if "payload" in by else {})}
        self.lines.append(ScriptStep("drive", robot_line(head, payload, LINK), ((LINK, link), (UUID, mission))))
        return self

    def half(self, link: int, mission: int, status: str, half: str) -> Script:
        """A status is said of nobody's mission, whose identifier is half that of another; then a look."""
        uuid = {"lower": "3", "upper": "4", half: member(half, pick("uuid", UUID))}
        head = header(MissionStatusProto, "mission_status", uuid=uuid)
        drive = robot_line(head, {"missionStatus": status, "uuid": uuid}, LINK)
        self.lines.append(ScriptStep("drive", drive, ((LINK, link), (UUID, mission))))
        return self.look()

    def raw(self, link: int, text: str) -> Script:
        """Any text is sent as a line; then a look."""
        params = {"event": "line", "connection": pick("connection", LINK), "line": text}
        self.lines.append(ScriptStep("drive", params, ((LINK, link),)))
        return self.look()

    def drop(self, link: int) -> Script:
        """A connection drops, and that has been noticed."""
        params = {"event": "disconnect", "connection": pick("connection", LINK)}
        self.lines.append(ScriptStep("drive", params, ((LINK, link),)))
        return self.look().wait()
