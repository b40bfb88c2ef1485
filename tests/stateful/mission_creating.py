"""Mission › CreateMission, CreateMissionBatch, CreateMissionWorkflow, AppendMission, AppendMissionBatch, ChargeRobot.

In the order of the page. The two rows that each table of a call with an effect has are asserted in
`mission_base.MissionBase.ask`, for they concern every call:

- Errors › INTERNAL: what would succeed fails inside the robot.
- Errors › DEADLINE_EXCEEDED: no confirmation in time; what was asked may have been done.
"""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st
from hypothesis.stateful import multiple, precondition, rule
from mission_base import IDS, SELDOM, Answer, MissionBase
from mission_model import RUNNING, WAITING, Listed, active, added, indices
from mission_requests import MALFORMED_MISSIONS, MALFORMED_WORKFLOWS, MISSIONS, PRESETS, TYPES, Asked

CALLS_OF_ONE = st.sampled_from(["CreateMission", "AppendMission"])
CALLS_OF_MANY = st.sampled_from(["CreateMissionBatch", "AppendMissionBatch"])


class Creating(MissionBase):
    """The calls that make missions."""

    def not_accepted(self, mission: Asked) -> set[str]:
        """The rows that apply to a well-formed mission for what it asks: INVALID_ARGUMENT, or none."""
        other_family = mission.family not in ("base", self.world.family)
        return {"INVALID_ARGUMENT"} if other_family or not self.world.knows(mission.goals) else set()

    def not_now(self, method: str) -> set[str]:
        """The rows that apply for what the robot is doing: FAILED_PRECONDITION, or none."""
        busy = active(self.missions) is not None
        queued = bool(indices(self.missions, WAITING))
        match method:
            case "CreateMission":
                # CreateMission › Errors › FAILED_PRECONDITION: a mission is executed, or one is queued.
                refused = busy or queued
            case "CreateMissionBatch":
                # CreateMissionBatch › Errors › FAILED_PRECONDITION: as above, or the robot cannot start a mission.
                refused = busy or queued or self.world.blocked
            case "CreateMissionWorkflow":
                # CreateMissionWorkflow › Errors › FAILED_PRECONDITION: a mission is executed. Of a queue that stands
                # still nothing is said: see `open_now`.
                refused = busy
            case "ChargeRobot":
                # ChargeRobot › Errors › FAILED_PRECONDITION: a mission is executed. Of the queue as above.
                refused = busy
            case _:
                # AppendMission, AppendMissionBatch › Errors › FAILED_PRECONDITION: there is no mission in the queue.
                refused = not self.missions
        return {"FAILED_PRECONDITION"} if refused else set()

    def open_now(self, method: str) -> set[str]:
        """Codes that the page leaves open for what the robot is doing."""
        found = set()
        if self.world.blocked:
            # Only CreateMissionBatch has a word for it; the others may say so as well, or not.
            found.add("FAILED_PRECONDITION")
        if method in ("CreateMissionWorkflow", "ChargeRobot") and indices(self.missions, WAITING):
            found.add("FAILED_PRECONDITION")
        if method.startswith("Append") and active(self.missions) is None:
            # Whether missions that have ended are "in the queue" is open.
            found.add("FAILED_PRECONDITION")
        return found

    def perhaps(self, method: str, missions: list[Asked]) -> set[str]:
        """All that is open: what the robot is doing, and a NavigateAuto mission without a free goal."""
        none_free = any(one.kind == "auto" and self.world.first_free(one.goals) is None for one in missions)
        return self.open_now(method) | ({"FAILED_PRECONDITION", "INVALID_ARGUMENT"} if none_free else set())

    def listed(self, mission: Asked, mission_id: str | None) -> Listed:
        """A new mission of the list: it waits at first."""
        early = self.world.first_free(mission.goals) if mission.kind == "auto" else None
        return Listed(mission_id, mission.kind, mission.goals, WAITING, None, early)

    def types_are_shown(self, count: int, missions: list[Asked]) -> None:
        """SubscribeMissionStatus › MissionType: the last `count` missions show the type that was asked for."""
        shown = self.robot.status.missions[-count:]
        for one, mission in zip(shown, missions, strict=True):
            kind = one.mission_type
            assert kind is not None
            wanted = [None, None, None]
            wanted[("base", "servi", "carti").index(mission.family)] = TYPES[mission.family, mission.name]
            assert [kind.base_type, kind.servi_type, kind.carti_type] == wanted

    def created(self, answer: Answer, missions: list[Asked], ids: list[str]) -> Any:
        """The call took effect: the missions are at the end of the list, in their order, under the ids of the answer.

        Without an answer (DEADLINE_EXCEEDED, INTERNAL) they are there under ids that nobody was told.
        """
        if not answer.effect:
            assert ids == []
            self.stays()
            return multiple()
        told: list[str | None] = [*ids] if answer.code == "OK" else [None] * len(missions)
        assert len(told) == len(missions)
        new = [self.listed(mission, mission_id) for mission, mission_id in zip(missions, told, strict=True)]
        self.becomes(*added(self.world, self.missions, new))
        self.types_are_shown(len(missions), missions)
        return multiple(*ids)

    def create(self, method: str, mission: Asked) -> Any:
        """CreateMission and AppendMission, whose messages are the same."""
        refused = self.not_now(method) | self.not_accepted(mission)
        answer = self.ask(method, {"mission": mission.mission}, refused, self.perhaps(method, [mission]))
        return self.created(answer, [mission], [answer.message["missionId"]] if answer.code == "OK" else [])

    def create_batch(self, method: str, missions: list[Asked]) -> Any:
        """CreateMissionBatch and AppendMissionBatch: all or none."""
        # CreateMissionBatch, AppendMissionBatch › Errors › INVALID_ARGUMENT: a single invalid mission is enough; that
        # none is created then is what `created` sees.
        refused = self.not_now(method).union(*map(self.not_accepted, missions))
        params = {"missions": [{"mission": one.mission} for one in missions]}
        answer = self.ask(method, params, refused, self.perhaps(method, missions))
        return self.created(answer, missions, answer.message["missionIds"] if answer.code == "OK" else [])

    # CreateMission

    @rule(target=IDS, data=st.data())
    def create_mission(self, data: st.DataObject) -> Any:
        """CreateMission of one that, most times, fits the robot's family.

        CreateMission › Errors › INVALID_ARGUMENT: also what another family does, or a goal that is not on the map.
        """
        return self.create("CreateMission", data.draw(MISSIONS[self.world.family]))

    @SELDOM
    @rule(method=CALLS_OF_ONE, request=st.sampled_from(MALFORMED_MISSIONS))
    def malformed_mission(self, method: str, request: dict[str, Any]) -> None:
        """CreateMission, AppendMission › Errors › INVALID_ARGUMENT: empty requests, invalid goals, other format errors.

        Which row is told where FAILED_PRECONDITION applies as well is open.
        """
        self.refuse(method, request, {"INVALID_ARGUMENT"} | self.not_now(method), self.open_now(method))

    # CreateMissionBatch

    @rule(target=IDS, data=st.data())
    def create_mission_batch(self, data: st.DataObject) -> Any:
        """CreateMissionBatch: one to four missions."""
        missions = data.draw(st.lists(MISSIONS[self.world.family], min_size=1, max_size=4))
        return self.create_batch("CreateMissionBatch", missions)

    @SELDOM
    @rule(
        method=CALLS_OF_MANY,
        good=st.lists(MISSIONS["base"], max_size=2),
        bad=st.sampled_from([None, *MALFORMED_MISSIONS]),
        after=st.lists(MISSIONS["base"], max_size=1),
    )
    def malformed_batch(self, method: str, good: list[Asked], bad: dict[str, Any] | None, after: list[Asked]) -> None:
        """CreateMissionBatch, AppendMissionBatch › Errors › INVALID_ARGUMENT: no missions, or one that is malformed.

        Wherever the malformed one stands, no mission is created.
        """
        entries = [[{"mission": one.mission} for one in some] for some in (good, after)]
        missions = [] if bad is None else [*entries[0], bad, *entries[1]]
        self.refuse(method, {"missions": missions}, {"INVALID_ARGUMENT"} | self.not_now(method), self.open_now(method))

    # CreateMissionWorkflow

    @rule(target=IDS, data=st.data())
    def create_mission_workflow(self, data: st.DataObject) -> Any:
        """CreateMissionWorkflow: one or more missions, which have the goals that were asked for in their order.

        How many there are, and which goals a preset adds by itself (an automatic return), is open.
        """
        method = "CreateMissionWorkflow"
        workflow = data.draw(PRESETS[self.world.family])
        refused = self.not_now(method)
        if workflow.family != self.world.family or not self.world.knows(workflow.goals):
            # CreateMissionWorkflow › Errors › INVALID_ARGUMENT: a type that the robot's family does not support.
            refused = refused | {"INVALID_ARGUMENT"}
        answer = self.ask(method, {"missionWorkflow": workflow.workflow}, refused, self.open_now(method))
        if not answer.effect:
            self.stays()
            return multiple()
        shown = self.robot.status.missions
        count = len(shown) - len(self.missions)
        if count <= 0:  # what has ended is listed no more
            count = len(shown)
        ids: list[str] = answer.message.get("missionIds", [])
        assert answer.code != "OK" or len(ids) == count >= 1
        new = []
        for one, told in zip(shown[-count:], ids or [None] * count, strict=True):
            whole = one.goals == workflow.goals
            new.append(Listed(told, workflow.kind if whole else "other", one.goals, WAITING))
        self.becomes(*added(self.world, self.missions, new))
        goals = iter(goal for one in new for goal in one.goals or ())
        assert all(goal in goals for goal in workflow.goals), "the goals that were asked for, in their order"
        return multiple(*ids)

    @SELDOM
    @rule(request=st.sampled_from(MALFORMED_WORKFLOWS))
    def malformed_workflow(self, request: dict[str, Any]) -> None:
        """CreateMissionWorkflow › Errors › INVALID_ARGUMENT: none, neither Servi's nor Carti's, or malformed."""
        method = "CreateMissionWorkflow"
        self.refuse(method, request, {"INVALID_ARGUMENT"} | self.not_now(method), self.open_now(method))

    # AppendMission

    @rule(target=IDS, data=st.data())
    def append_mission(self, data: st.DataObject) -> Any:
        """AppendMission: it goes to the end of the queue.

        AppendMission › Errors › INVALID_ARGUMENT: as for CreateMission.
        """
        return self.create("AppendMission", data.draw(MISSIONS[self.world.family]))

    # AppendMissionBatch

    @rule(target=IDS, data=st.data())
    def append_mission_batch(self, data: st.DataObject) -> Any:
        """AppendMissionBatch: one to three missions, also behind others that wait."""
        missions = data.draw(st.lists(MISSIONS[self.world.family], min_size=1, max_size=3))
        return self.create_batch("AppendMissionBatch", missions)

    # ChargeRobot

    @precondition(lambda self: active(self.missions) is None or self.seldom < 6)
    @rule(target=IDS)
    def charge_robot(self) -> Any:
        """ChargeRobot: a mission that is executed like others."""
        method = "ChargeRobot"
        self.seldom += active(self.missions) is not None
        refused, perhaps = self.not_now(method), self.open_now(method)
        if not self.world.charging_location:
            # ChargeRobot › Errors › NOT_FOUND: no contact charger on the map.
            refused = refused | {"NOT_FOUND"}
        if not self.world.contact_dock:
            # The call is for robots with a contact dock; which row a robot without one answers with is open.
            refused = refused | {"NOT_FOUND"}
            perhaps = perhaps | {"FAILED_PRECONDITION"}
        answer = self.ask(method, {}, refused, perhaps)
        if not answer.effect:
            self.stays()
            return multiple()
        told = answer.message["missionId"] if answer.code == "OK" else None
        self.becomes(*added(self.world, self.missions, [Listed(told, "charge", None, WAITING)]))
        assert active(self.missions) is None or self.missions[-1].state in (RUNNING, WAITING)
        return multiple() if told is None else told
