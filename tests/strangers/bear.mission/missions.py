"""The mission queue: how missions are taken in, begin, go on and end."""

from __future__ import annotations

import uuid

from model import Json, Mission, Plan, State
from stream import Publisher


class MissionQueue(Publisher):
    """Runs one mission after the other, in the order in which they were assigned."""

    def new_id(self) -> str:
        """An id that no other mission has."""
        return str(uuid.uuid4())

    def make(self, plan: Plan) -> Mission:
        """A mission for a plan; it waits."""
        return Mission(self.new_id(), plan.kind, list(plan.goals))

    def take_in(self, plans: list[Plan]) -> list[Mission]:
        """Put missions at the end of the list."""
        missions = [self.make(plan) for plan in plans]
        self.missions.extend(missions)
        return missions

    def create(self, plans: list[Plan]) -> list[str]:
        """Take in missions on a free robot, and begin."""
        missions = self.take_in(plans)
        self.launch(missions[0])
        self.changed()
        return [mission.mission_id for mission in missions]

    def launch(self, mission: Mission) -> None:
        """Start a mission that was created, if none is active."""
        if self.current is None:
            self.start(mission)

    def append(self, plans: list[Plan]) -> list[str]:
        """Take in missions behind those that are there."""
        missions = self.take_in(plans)
        self.begin()
        self.changed()
        return [mission.mission_id for mission in missions]

    def next_mission(self) -> Mission | None:
        """The mission whose turn it is."""
        return next(iter(self.queued()), None)

    def begin(self) -> None:
        """Start the next mission if none is active."""
        mission = self.next_mission()
        if self.current is None and mission is not None:
            self.start(mission)

    def start(self, mission: Mission) -> None:
        """Start a mission at its first goal, or at the one that it selects."""
        self.current = mission
        mission.state = State.RUNNING
        mission.goal_index = 0
        mission.feedback = self.first_feedback(mission)
        if mission.kind.auto:
            choice = self.select_goal(mission)
            if choice is None:
                self.nothing_free(mission)
            else:
                mission.goal_index = choice

    def first_feedback(self, mission: Mission) -> str:
        """The feedback of a mission that has just started."""
        return "STATUS_NAVIGATING"

    def is_free(self, goal: Json) -> bool:
        """Whether no other robot holds or claims a goal."""
        return goal.get("destinationId") not in self.world.occupied

    def select_goal(self, mission: Mission) -> int | None:
        """The first goal that is free."""
        for index, goal in enumerate(mission.goals):
            if self.is_free(goal):
                return index
        return None

    def nothing_free(self, mission: Mission) -> None:
        """No goal of a NavigateAuto mission is free when it starts."""
        self.end(mission, State.FAILED)

    def go_on(self, mission: Mission) -> None:
        """Turn from the current goal to the next, or end."""
        if not mission.kind.auto and not mission.on_last_goal:
            mission.goal_index += 1
        elif mission.kind.patrol:
            mission.goal_index = 0
        else:
            self.end(mission, State.SUCCEEDED)

    def end(self, mission: Mission, state: State) -> None:
        """End a mission in a terminal state."""
        mission.state = state
        self.current = None
        self.after_end(mission)

    def after_end(self, mission: Mission) -> None:
        """What follows on the end of a mission: the next one."""
        self.begin()

    def clear(self) -> list[str]:
        """Forget all missions."""
        ids = [mission.mission_id for mission in self.missions]
        self.missions = []
        self.changed()
        return ids
