"""The mission status as clients see it."""

from __future__ import annotations

import copy

from model import Json, Mission, RobotData, State


class StatusView(RobotData):
    """Renders the missions as a MissionStates message."""

    def mission_states(self) -> Json:
        """All missions and which of them is active."""
        missions = [self.mission_state(mission) for mission in self.listed()]
        return {"missions": missions, "currentMissionIndex": self.current_index()}

    def listed(self) -> list[Mission]:
        """The missions to show, in the order in which they were assigned."""
        return list(self.missions)

    def current_index(self) -> int:
        """The place of the active mission in the list, or -1."""
        for index, mission in enumerate(self.listed()):
            if mission is self.current:
                return index
        return -1

    def mission_state(self, mission: Mission) -> Json:
        """One mission."""
        shown: Json = {
            "missionId": self.shown_id(mission),
            "state": self.shown_state(mission).value,
            "goals": self.shown_goals(mission),
            "currentGoalIndex": self.shown_goal_index(mission),
            "missionFeedback": self.shown_feedback(mission),
            "missionType": self.shown_type(mission),
            "owner": self.shown_owner(mission),
        }
        return {name: value for name, value in shown.items() if value != {}}

    def shown_id(self, mission: Mission) -> str:
        """The id."""
        return mission.mission_id

    def shown_state(self, mission: Mission) -> State:
        """The state; a mission that waits has not been run."""
        return mission.state

    def shown_goals(self, mission: Mission) -> list[Json]:
        """All goals as they were requested."""
        return copy.deepcopy(mission.goals)

    def shown_goal_index(self, mission: Mission) -> int:
        """Which goal is the active one."""
        return mission.goal_index

    def shown_feedback(self, mission: Mission) -> Json:
        """The latest feedback, or nothing before there is any."""
        status = self.feedback_status(mission)
        return {f"{self.feedback_member(mission)}Feedback": {"status": status}} if status else {}

    def feedback_status(self, mission: Mission) -> str:
        """The status in the feedback; empty where there is none."""
        return mission.feedback

    def feedback_member(self, mission: Mission) -> str:
        """Whose feedback message it is."""
        return mission.kind.member

    def shown_type(self, mission: Mission) -> Json:
        """The type; a charge has none of the documented ones."""
        if not mission.kind.type_name:
            return {}
        return {f"{mission.kind.member}Type": mission.kind.type_name}

    def shown_owner(self, mission: Mission) -> str:
        """Who had the mission created."""
        return mission.owner
