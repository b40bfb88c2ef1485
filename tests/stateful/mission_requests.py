"""What is asked of a robot: missions and workflows of every family, well formed and not. Mission › CreateMission."""

from __future__ import annotations

from typing import Any, NamedTuple

from hypothesis import strategies as st

from missionfsm import Goal, Pose
from missionfsm.bear.wire.messages import BaseType, CartiType, ServiType

Json = dict[str, Any]

FAMILIES = ("base", "servi", "carti")
PLACES = ("kitchen", "table-1", "table-2", "table-3")
NOWHERE = "attic"
"""A display name that no map has. Mission › CreateMission › Request, the note on destination_id."""

KINDS = {
    # Mission › CreateMission › BaseMission: one goal, or the first of several that is free.
    "base": {"navigateMission": "one", "navigateAutoMission": "auto"},
    # Mission › ServiType enum: serving and bussing go through their goals, patrols go round them.
    "servi": {
        "deliveryMission": "list",
        "deliveryPatrolMission": "patrol",
        "bussingMission": "list",
        "bussingPatrolMission": "patrol",
        "navigateMission": "one",
        "navigateAutoMission": "auto",
    },
    # Mission › CartiType enum.
    "carti": {
        "traverseMission": "list",
        "traversePatrolMission": "patrol",
        "navigateMission": "one",
        "navigateAutoMission": "auto",
    },
}
"""For each family its mission types, and how each goes through its goals."""

TYPES = {
    ("base", "navigateMission"): BaseType.BASE_TYPE_NAVIGATE,
    ("base", "navigateAutoMission"): BaseType.BASE_TYPE_NAVIGATE_AUTO,
    ("servi", "deliveryMission"): ServiType.SERVI_TYPE_SERVING,
    ("servi", "deliveryPatrolMission"): ServiType.SERVI_TYPE_SERVING_PATROL,
    ("servi", "bussingMission"): ServiType.SERVI_TYPE_BUSSING,
    ("servi", "bussingPatrolMission"): ServiType.SERVI_TYPE_BUSSING_PATROL,
    ("servi", "navigateMission"): ServiType.SERVI_TYPE_NAVIGATE,
    ("servi", "navigateAutoMission"): ServiType.SERVI_TYPE_NAVIGATE_AUTO,
    ("carti", "traverseMission"): CartiType.CARTI_TYPE_TRAVERSE,
    ("carti", "traversePatrolMission"): CartiType.CARTI_TYPE_TRAVERSE_PATROL,
    ("carti", "navigateMission"): CartiType.CARTI_TYPE_NAVIGATE,
    ("carti", "navigateAutoMission"): CartiType.CARTI_TYPE_NAVIGATE_AUTO,
}
"""What MissionState.mission_type shows of each. Mission › SubscribeMissionStatus › MissionType."""

WORKFLOWS = {
    # Mission › CreateMissionWorkflow › Servi workflow types.
    "servi": {
        "delivery": "list",
        "deliveryPatrol": "patrol",
        "bussing": "list",
        "bussingPatrol": "patrol",
        "birthday": "one",
        "hosting": "list",
        "hostingPatrol": "patrol",
    },
    # Mission › CreateMissionWorkflow › Carti workflow types.
    "carti": {"traverse": "list", "traversePatrol": "patrol"},
}


class Asked(NamedTuple):
    """A mission or workflow that is well formed; whether it fits robot and map is another matter."""

    family: str
    name: str
    kind: str
    goals: tuple[Goal, ...]

    @property
    def json(self) -> Json:
        """The inner message: one goal or several, as its type has them."""
        goals = [_json(goal) for goal in self.goals]
        single = self.name in ("navigateMission", "birthday")
        return {self.name: {"goal": goals[0]} if single else {"goals": goals}}

    @property
    def mission(self) -> Json:
        """The Mission message."""
        return {f"{self.family}Mission": self.json}

    @property
    def workflow(self) -> Json:
        """The MissionWorkflow message."""
        return {f"{self.family}Workflow": self.json}


def _json(goal: Goal) -> Json:
    if goal.pose is None:
        return {"destinationId": goal.destination_id}
    pose = goal.pose
    return {"pose": {"xMeters": pose.x_meters, "yMeters": pose.y_meters, "headingRadians": pose.heading_radians}}


_GOALS = st.sampled_from(
    [Goal(destination_id=name) for name in PLACES * 6]
    + [Goal(pose=Pose(4.25, 7.75, 1.5)), Goal(destination_id=NOWHERE)]
)


def asked(kinds: dict[str, dict[str, str]]) -> st.SearchStrategy[Asked]:
    """Any of some types, with one to four goals."""
    types = [(family, name, kind) for family, names in kinds.items() for name, kind in names.items()]
    return st.builds(
        lambda of, goals: Asked(*of, goals=tuple(goals[:1] if of[2] == "one" else goals)),
        st.sampled_from(types),
        st.lists(_GOALS, min_size=1, max_size=4),
    )


ANY_MISSION = asked(KINDS)
MISSIONS = {
    family: st.one_of(*[asked({name: KINDS[name] for name in ("base", family)})] * 4, ANY_MISSION)
    for family in FAMILIES
}
"""Missions for a robot of a family: most of them fit it."""

ANY_WORKFLOW = asked(WORKFLOWS)
PRESETS = {
    "base": ANY_WORKFLOW,
    **{family: st.one_of(*[asked({family: WORKFLOWS[family]})] * 4, ANY_WORKFLOW) for family in WORKFLOWS},
}
"""Workflows for a robot of a family: most of them fit it, but for a Base unit, which has none."""

A_GOAL = {"destinationId": "kitchen"}

MALFORMED_MISSIONS: tuple[Json, ...] = (
    {},  # an empty request
    {"mission": {}},  # no mission type
    {"mission": {"baseMission": {}}},
    {"mission": {"baseMission": {"navigateMission": {}}}},  # no goal
    {"mission": {"baseMission": {"navigateMission": {"goal": {}}}}},
    {"mission": {"baseMission": {"navigateAutoMission": {"goals": []}}}},
    {"mission": {"baseMission": {"navigateAutoMission": {"goals": [A_GOAL, {}]}}}},
    {"mission": {"servi_mission": {"delivery_mission": {"goals": []}}}},
    {"mission": {"cartiMission": {"traverseMission": {}}}},
    # One mission type at a time: two families, two types, two ways to name a goal.
    {"mission": {"baseMission": {"navigateMission": {"goal": A_GOAL}}, "serviMission": {}}},
    {
        "mission": {
            "baseMission": {"navigateMission": {"goal": A_GOAL}, "navigateAutoMission": {"goals": [A_GOAL]}},
        }
    },
    {"mission": {"baseMission": {"navigateMission": {"goal": {**A_GOAL, "pose": {}}}}}},
    # Wrong types.
    {"mission": "navigate"},
    {"mission": {"baseMission": {"navigateMission": {"goal": "kitchen"}}}},
)
"""CreateMissionRequest and AppendMissionRequest that are INVALID_ARGUMENT on every robot and every map."""

MALFORMED_WORKFLOWS: tuple[Json, ...] = (
    {},
    {"missionWorkflow": {}},
    {"missionWorkflow": {"serviWorkflow": {}}},
    {"missionWorkflow": {"baseWorkflow": {"delivery": {"goals": [A_GOAL]}}}},  # neither Servi nor Carti
    {"missionWorkflow": {"serviWorkflow": {"delivery": {"goals": []}}}},
    {"missionWorkflow": {"serviWorkflow": {"birthday": {}}}},
    {"missionWorkflow": {"serviWorkflow": {"bussing": {"goals": [A_GOAL]}, "hosting": {"goals": [A_GOAL]}}}},
    {"missionWorkflow": {"cartiWorkflow": {"traverse": 3}}},
)
"""CreateMissionWorkflowRequest that are INVALID_ARGUMENT on every robot and every map."""

MALFORMED_COMMANDS: tuple[Json, ...] = (
    {},
    {"missionCommand": {}},
    {"missionCommand": {"missionId": "", "command": "COMMAND_CANCEL"}},
    {"missionCommand": {"missionId": 7, "command": "COMMAND_CANCEL"}},
    {"missionCommand": "COMMAND_CANCEL"},
)
"""UpdateMissionRequest that name no mission."""

BAD_COMMANDS = ("COMMAND_UNKNOWN", "COMMAND_EXPLODE", 0, 9, None)
"""What is no command: the default that is never to be used, unknown names and numbers, none at all."""
