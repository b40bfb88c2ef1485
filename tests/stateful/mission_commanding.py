"""Mission › ClearMissionStatus, SkipGoal, UpdateMission, in the order of the page."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st
from hypothesis.stateful import precondition, rule
from mission_base import BUSY, IDLE, IDS, SELDOM, MissionBase
from mission_model import CANCELED, ENDED, PAUSED, RUNNING, SUCCEEDED, WAITING, active, ends, indices, put
from mission_requests import BAD_COMMANDS, MALFORMED_COMMANDS

NO_FIELDS = st.sampled_from([[], ["kitchen"], 7, "all"])
"""What is no message at all, for calls whose request has no fields."""

COMMANDS = ("COMMAND_UNKNOWN", "COMMAND_CANCEL", "COMMAND_PAUSE", "COMMAND_RESUME", "COMMAND_FINISH")
"""By their numbers. Mission › UpdateMission › Command enum."""


class Commanding(MissionBase):
    """The calls that change missions."""

    # ClearMissionStatus

    @BUSY
    @SELDOM
    @rule()
    def clear_mission_status_of_a_busy_robot(self) -> None:
        """ClearMissionStatus › Errors › FAILED_PRECONDITION: the robot is on a running or paused mission."""
        self.refuse("ClearMissionStatus", {}, {"FAILED_PRECONDITION"})

    @precondition(lambda self: self.missions and active(self.missions) is None)  # without missions: `clear_nothing`
    @rule()
    def clear_mission_status(self) -> None:
        """ClearMissionStatus: the missions are listed no more, and the answer has their ids."""
        # Whether missions that wait, though nothing is active, have to end first is open.
        waiting = indices(self.missions, WAITING)
        answer = self.ask("ClearMissionStatus", {}, set(), {"FAILED_PRECONDITION"} if waiting else ())
        # ClearMissionStatus › Errors › INTERNAL: in `ask`.
        if not answer.effect:
            self.stays()
            return
        before = [one.mission_id for one in self.missions]
        self.becomes([], [self.missions[index] for index in waiting])
        gone = set(before) - {one.mission_id for one in self.missions}
        if answer.code == "OK":
            assert set(answer.message["missionIds"]) == gone
        self.cleared |= {one for one in gone if one is not None}

    def clear_nothing(self) -> None:
        """ClearMissionStatus: no row speaks of a robot that has no missions listed; nothing is cleared."""
        assert self.ask("ClearMissionStatus", {}, set()).message == {"missionIds": []}
        self.stays()

    @SELDOM
    @rule(request=NO_FIELDS)
    def clear_mission_status_malformed(self, request: Any) -> None:
        """ClearMissionStatus › Errors › INVALID_ARGUMENT: the request is no message at all."""
        busy = {"FAILED_PRECONDITION"} if active(self.missions) is not None else set()
        self.refuse("ClearMissionStatus", request, {"INVALID_ARGUMENT"} | busy)

    # SkipGoal

    @IDLE
    @rule()
    def skip_goal_of_an_idle_robot(self) -> None:
        """SkipGoal › Errors › FAILED_PRECONDITION: the robot is not on a mission."""
        self.refuse("SkipGoal", {}, {"FAILED_PRECONDITION"})

    @BUSY
    @rule()
    def skip_goal(self) -> None:
        """SkipGoal: the running mission goes on to its next goal, and the answer names it.

        Open: what becomes of a mission whose last goal is skipped, of one that selects its goal by itself, of a charge.
        """
        running = next(iter(indices(self.missions, RUNNING)), None)
        if running is None:
            # SkipGoal › Errors › FAILED_PRECONDITION: the mission is not running.
            self.refuse("SkipGoal", {}, {"FAILED_PRECONDITION"})
            return
        mission = self.missions[running]
        last = mission.kind in ("one", "auto", "charge", "other") or mission.at == len(mission.goals or ()) - 1
        answer = self.ask("SkipGoal", {}, set(), {"FAILED_PRECONDITION"} if last else ())
        # SkipGoal › Errors › INTERNAL: in `ask`.
        if not answer.effect:
            self.stays()
            return
        if answer.code == "OK":
            assert answer.message == {"missionId": mission.mission_id}
        assert mission.at is not None
        if not last:
            self.becomes(put(self.missions, running, RUNNING, mission.at + 1))
            return
        around = put(self.missions, running, RUNNING, 0 if mission.kind == "patrol" else None)
        self.becomes(around, *ends(self.world, self.missions, running, *ENDED))

    # UpdateMission

    def about(self, mission_id: str) -> tuple[set[str], set[str]]:
        """The rows of UpdateMission that apply for the mission that is named, and what is open beside them."""
        found = next((one for one in self.missions if one.mission_id == mission_id), None)
        on_a_mission = active(self.missions) is not None
        if found is None and mission_id not in self.cleared:
            # UpdateMission › Errors › INVALID_ARGUMENT: incorrect mission ID; NOT_FOUND: not the active mission.
            return {"INVALID_ARGUMENT", "NOT_FOUND"} | (set() if on_a_mission else {"FAILED_PRECONDITION"}), set()
        if found is None or found.state in ENDED:
            # UpdateMission › Errors › FAILED_PRECONDITION: one in a terminal state cannot be updated. That it is not
            # the active one (NOT_FOUND), or that its ID is incorrect by now (INVALID_ARGUMENT), is true as well.
            return {"FAILED_PRECONDITION"}, {"NOT_FOUND", "INVALID_ARGUMENT"}
        if found.state is WAITING:
            # UpdateMission › Errors › NOT_FOUND: it is still queued.
            return {"NOT_FOUND"}, set()
        return set(), set()

    def update(self, mission_id: str, command: int | str) -> None:
        """A command that is one, by name or number."""
        refused, perhaps = self.about(mission_id)
        index = active(self.missions)
        state = None if index is None else self.missions[index].state
        name = COMMANDS.index(command) if isinstance(command, str) else command
        if not refused and (state, name) in ((PAUSED, 2), (RUNNING, 3)):
            # UpdateMission › Errors › FAILED_PRECONDITION: invalid for the state: to pause what is paused, to resume
            # what runs.
            refused = {"FAILED_PRECONDITION"}
        if (state, name) == (PAUSED, 4):
            perhaps = perhaps | {"FAILED_PRECONDITION"}  # whether a paused mission may be finished is open
        answer = self.ask(
            "UpdateMission", {"missionCommand": {"missionId": mission_id, "command": command}}, refused, perhaps
        )
        # UpdateMission › Errors › INTERNAL, DEADLINE_EXCEEDED: in `ask`.
        if not answer.effect:
            self.stays()
            return
        assert answer.message == {}, "UpdateMission › Response has no fields"
        assert index is not None
        match name:
            case 1:  # COMMAND_CANCEL
                self.becomes(*ends(self.world, self.missions, index, CANCELED))
            case 2:  # COMMAND_PAUSE
                self.becomes(put(self.missions, index, PAUSED))
            case 3:  # COMMAND_RESUME
                self.becomes(put(self.missions, index, RUNNING))
            case _:  # COMMAND_FINISH
                self.becomes(*ends(self.world, self.missions, index, SUCCEEDED))

    @rule(
        mission_id=IDS,
        command=st.sampled_from([*COMMANDS[1:], 1, 2, 3, 4]),
    )
    def update_mission(self, mission_id: str, command: int | str) -> None:
        """UpdateMission of any mission that there ever was: active, queued, ended, cleared."""
        self.update(mission_id, command)

    @BUSY
    @rule(data=st.data())
    def update_the_active_mission(self, data: st.DataObject) -> None:
        """UpdateMission of the active mission, so that missions are paused and resumed often."""
        index = active(self.missions)
        assert index is not None
        mission = self.missions[index]
        assert mission.mission_id is not None
        likely = [2, 2, 2, 3, 1, 4] if mission.state is RUNNING else [3, 3, 2, 1, 4]
        self.update(mission.mission_id, data.draw(st.sampled_from(likely)))

    @SELDOM
    @rule(mission_id=IDS, command=st.sampled_from(BAD_COMMANDS))
    def update_mission_with_no_command(self, mission_id: str, command: object) -> None:
        """UpdateMission › Errors › INVALID_ARGUMENT: invalid commands. Other rows may apply to the mission as well."""
        refused, perhaps = self.about(mission_id)
        params = {"missionCommand": {"missionId": mission_id, "command": command}}
        self.refuse("UpdateMission", params, {"INVALID_ARGUMENT"} | refused, perhaps)

    @SELDOM
    @rule(request=st.sampled_from(MALFORMED_COMMANDS))
    def update_no_mission(self, request: dict[str, Any]) -> None:
        """UpdateMission › Errors › INVALID_ARGUMENT: empty requests, no mission ID.

        A robot that is not on a mission may say that first (FAILED_PRECONDITION).
        """
        on_a_mission = active(self.missions) is not None
        self.refuse(
            "UpdateMission", request, {"INVALID_ARGUMENT"} | (set() if on_a_mission else {"FAILED_PRECONDITION"})
        )

    @SELDOM
    @rule(mission_id=st.sampled_from(["no such mission", "00000000-0000-0000-0000-000000000000"]))
    def update_an_unknown_mission(self, mission_id: str) -> None:
        """UpdateMission › Errors › INVALID_ARGUMENT or NOT_FOUND: an ID that no mission ever had."""
        self.seldom += 1
        self.update(mission_id, "COMMAND_CANCEL")
