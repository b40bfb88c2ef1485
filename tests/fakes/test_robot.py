"""The robot to test client code with: it answers as the page says, and the oracle agrees."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import attrs
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from missionfsm import (
    ApiError,
    Command,
    DeadlineExceeded,
    FailedPrecondition,
    Goal,
    Internal,
    InvalidArgument,
    NotFound,
    Pose,
    Robot,
    State,
    missions,
    workflows,
)
from missionfsm.bear.mission.system import SYSTEM
from missionfsm.bear.wire.messages import MissionState, MissionStatus
from missionfsm.bear.wire.protojson import write
from missionfsm.fakes.errors import ERRORS
from missionfsm.kernel.alphabet import ANY_NAME, Bounds
from missionfsm.kernel.rules import STATUS_NUMBERS
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.transcript import Head
from missionfsm.tools.check.judge import Judge

TABLE, KITCHEN = missions.navigate("table-1"), missions.navigate("table-3")


def states(robot: Robot) -> list[str]:
    return [mission.state.name.removeprefix("STATE_") for mission in robot.status.missions]


def busy(robot: Robot | None = None) -> tuple[Robot, str]:
    robot = robot or Robot()
    return robot, robot.create_mission(missions.delivery("table-1", "table-2"))


def paused() -> tuple[Robot, str]:
    robot, first = busy()
    robot.pause(first)
    return robot, first


def test_a_robot_under_test_in_ten_lines() -> None:
    """A client is tested by giving it a robot, letting things happen, and looking at the robot."""
    robot = Robot(family="servi", destinations=["kitchen", "table-1", "table-2"])
    updates = robot.updates()
    first = robot.create_mission(missions.delivery("table-1", "table-2"))
    second = robot.append_mission(missions.navigate("kitchen"))
    with pytest.raises(FailedPrecondition, match="a first mission cannot be created"):
        robot.create_mission(missions.navigate("kitchen"))
    while robot.goal_reached():
        pass
    assert robot.mission(first).state is robot.mission(second).state is State.STATE_SUCCEEDED
    assert [len(update.mission_states.missions) for update in updates if update.mission_states] == [0, 1, 2, 2, 2, 2, 2]


DOCUMENTED: list[tuple[Callable[[], Any], type[ApiError], str, str]] = [
    (
        lambda: busy()[0].create_mission(TABLE),
        FailedPrecondition,
        "CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued",
        "Mission › CreateMission › Errors",
    ),
    (
        lambda: Robot().create_mission(missions.navigate("nowhere")),
        InvalidArgument,
        "CreateMission/INVALID_ARGUMENT/a-destination-is-not-on-the-map",
        "Mission › CreateMission › Request",
    ),
    (
        lambda: Robot().create_mission(missions.delivery()),
        InvalidArgument,
        "CreateMission/INVALID_ARGUMENT/the-goals-do-not-match-the-mission-type",
        "Mission › CreateMission › Errors",
    ),
    (
        lambda: Robot().create_mission(missions.navigate(Pose(float("nan")))),
        InvalidArgument,
        "CreateMission/INVALID_ARGUMENT/a-goal-is-invalid",
        "Mission › CreateMission › Errors",
    ),
    (
        lambda: Robot("base").create_mission(missions.delivery("table-1")),
        InvalidArgument,
        "CreateMission/INVALID_ARGUMENT/the-mission-is-for-another-family",
        "Mission › CreateMission › Request",
    ),
    (
        lambda: Robot(blocked=True).create_mission_batch([TABLE]),
        FailedPrecondition,
        "CreateMissionBatch/FAILED_PRECONDITION/the-robot-is-unable-to-start",
        "Mission › CreateMissionBatch › Errors",
    ),
    (
        lambda: Robot().create_mission_batch([]),
        InvalidArgument,
        "CreateMissionBatch/INVALID_ARGUMENT/the-request-is-empty",
        "Mission › CreateMissionBatch › Errors",
    ),
    (
        lambda: Robot("carti").create_mission_workflow(workflows.birthday("table-1")),
        InvalidArgument,
        "CreateMissionWorkflow/INVALID_ARGUMENT/the-workflow-is-for-another-family",
        "Mission › CreateMissionWorkflow › Errors",
    ),
    (
        lambda: busy()[0].create_mission_workflow(workflows.hosting("table-1")),
        FailedPrecondition,
        "CreateMissionWorkflow/FAILED_PRECONDITION/another-mission-is-active",
        "Mission › CreateMissionWorkflow › Errors",
    ),
    (
        lambda: Robot().append_mission(TABLE),
        FailedPrecondition,
        "AppendMission/FAILED_PRECONDITION/the-mission-queue-is-empty",
        "Mission › AppendMission › Errors",
    ),
    (
        lambda: Robot().append_mission_batch([TABLE]),
        FailedPrecondition,
        "AppendMissionBatch/FAILED_PRECONDITION/the-mission-queue-is-empty",
        "Mission › AppendMissionBatch › Errors",
    ),
    (
        lambda: busy()[0].charge_robot(),  # noqa: PLW0108 - the robot is made when it is asked
        FailedPrecondition,
        "ChargeRobot/FAILED_PRECONDITION/a-mission-is-running",
        "Mission › ChargeRobot › Errors",
    ),
    (
        lambda: Robot(charging_location=False).charge_robot(),
        NotFound,
        "ChargeRobot/NOT_FOUND/the-map-has-no-charging-location",
        "Mission › ChargeRobot › Errors",
    ),
    (
        lambda: busy()[0].clear_mission_status(),  # noqa: PLW0108 - the robot is made when it is asked
        FailedPrecondition,
        "ClearMissionStatus/FAILED_PRECONDITION/a-mission-is-running-or-paused",
        "Mission › ClearMissionStatus › Errors",
    ),
    (
        lambda: Robot().skip_goal(),
        FailedPrecondition,
        "SkipGoal/FAILED_PRECONDITION/the-robot-is-not-on-a-mission",
        "Mission › SkipGoal › Errors",
    ),
    (
        lambda: paused()[0].skip_goal(),  # noqa: PLW0108 - the robot is made when it is asked
        FailedPrecondition,
        "SkipGoal/FAILED_PRECONDITION/the-mission-is-paused",
        "Mission › SkipGoal › Errors",
    ),
    (
        lambda: (robot := busy()[0]).cancel(robot.append_mission(TABLE)),
        NotFound,
        "UpdateMission/NOT_FOUND/the-mission-is-still-queued",
        "Mission › UpdateMission › Errors",
    ),
    (
        lambda: Robot().cancel("mission-1"),
        FailedPrecondition,
        "UpdateMission/FAILED_PRECONDITION/the-robot-never-had-a-mission",
        "Mission › UpdateMission › Errors",
    ),
    (
        lambda: busy()[0].update_mission("mission-1", "COMMAND_DANCE"),
        InvalidArgument,
        "UpdateMission/INVALID_ARGUMENT/the-request-is-malformed",
        "Mission › UpdateMission › Errors",
    ),
    (
        lambda: busy()[0].update_mission("mission-1", Command.COMMAND_UNKNOWN),
        InvalidArgument,
        "UpdateMission/INVALID_ARGUMENT/the-command-is-not-set",
        "Mission › UpdateMission › Errors",
    ),
    (
        lambda: (given := paused())[0].pause(given[1]),
        FailedPrecondition,
        "UpdateMission/FAILED_PRECONDITION/the-mission-is-already-paused",
        "Mission › UpdateMission › Errors",
    ),
]


@pytest.mark.parametrize(("act", "kind", "rule", "place"), DOCUMENTED, ids=[rule for _, _, rule, _ in DOCUMENTED])
def test_a_refusal_is_the_documented_error(act: Callable[[], Any], kind: type[ApiError], rule: str, place: str) -> None:
    """A refused call raises the class of its code, with the rule and its place on the page, in words."""
    with pytest.raises(ApiError) as caught:
        act()
    refusal = caught.value
    assert (type(refusal), refusal.rule, refusal.citation) == (kind, f"bear.mission/{rule}", place)
    assert refusal.operation == rule.partition("/")[0]
    assert refusal.number == STATUS_NUMBERS[refusal.code]
    assert refusal.message == SYSTEM.spec.rule(f"bear.mission/{rule}").says
    assert str(refusal) == f"{refusal.operation}: {refusal.code}: {refusal.message} [{place}]"


@pytest.mark.parametrize(
    ("method", "place"),
    [
        ("CreateMission", "CreateMission › Errors"),
        ("CreateMissionBatch", "CreateMissionBatch › Errors"),
        ("AppendMission", "AppendMission › Errors"),
        ("UpdateMission", "UpdateMission › Errors"),
        ("ClearMissionStatus", "ClearMissionStatus › Errors"),
        ("SkipGoal", "SkipGoal › Request"),
        ("ChargeRobot", "ChargeRobot › Request"),
    ],
)
def test_what_cannot_be_decoded_is_cited_from_the_table_of_its_call(method: str, place: str) -> None:
    """Calls whose table has no such row are cited from what the page says of their request: it has no fields."""
    with pytest.raises(InvalidArgument) as caught:
        Robot().call(method, [1])
    assert caught.value.citation == f"Mission › {place}"


def test_every_status_has_an_error_that_can_be_copied() -> None:
    """There is one class for each status of a specification, and its errors survive copying and pickling."""
    for code, kind in ERRORS.items():
        original = kind("CreateMission", None, "Mission › CreateMission › Errors", "no")
        assert original.code == code
        for again in (copy.copy(original), pickle.loads(pickle.dumps(original))):  # noqa: S301 - our own
            assert (type(again), vars(again)) == (kind, vars(original))


def test_a_refusal_changes_nothing() -> None:
    """After a refusal the robot stands where it stood, and nobody is told anything."""
    robot, _ = busy()
    updates, before = robot.updates(), robot.snapshot()
    list(updates)
    for method, params in (("CreateMission", {}), ("ChargeRobot", {}), ("AppendMission", {"mission": {}})):
        with pytest.raises(ApiError):
            robot.call(method, params)
    assert robot.snapshot().here == before.here
    assert list(updates) == []


def test_a_call_can_be_made_to_fail() -> None:
    """The next call that would succeed fails as told, with its effect or without; then all is as before."""
    robot = Robot()
    robot.fail_next("INTERNAL")
    with pytest.raises(FailedPrecondition):
        robot.append_mission(TABLE)
    with pytest.raises(Internal) as lost:
        robot.create_mission(TABLE)
    assert (lost.value.rule, lost.value.citation) == (None, "Mission › CreateMission › Errors")
    assert states(robot) == []
    robot.fail_next("DEADLINE_EXCEEDED", applied=True)
    with pytest.raises(DeadlineExceeded):
        robot.create_mission(TABLE)
    assert states(robot) == ["RUNNING"]
    assert robot.append_mission(KITCHEN) in {mission.mission_id for mission in robot.status.missions}
    with pytest.raises(ValueError, match="a fault has status INTERNAL or DEADLINE_EXCEEDED"):
        robot.fail_next("NOT_FOUND")


def test_the_robot_does_what_it_is_told_happened() -> None:
    """Goals are reached, missions succeed and fail, the world changes; what does not apply does not happen."""
    robot, first = busy()
    assert robot.goal_reached()
    assert robot.mission(first).current_goal_index == 1
    robot.pause(first)
    assert not robot.goal_reached()
    assert not robot.mission_succeeded()
    assert robot.mission_failed()
    assert not robot.mission_failed()
    robot.world(blocked=True, occupied=["table-1"], destinations=["table-1", "table-2", "bar"])
    with pytest.raises(FailedPrecondition):
        robot.create_mission(TABLE)
    robot.world(blocked=False)
    auto = robot.create_mission(missions.navigate_auto("table-1", "bar"))
    assert robot.mission(auto).current_goal_index == 1
    robot.finish(auto)
    robot.world(contact_dock=False, charging_location=False)
    with pytest.raises(NotFound):
        robot.charge_robot()
    assert states(robot) == ["FAILED", "SUCCEEDED"]
    assert robot.clear_mission_status() == (first, auto)


@pytest.mark.parametrize(
    ("family", "mission", "wire"),
    [
        (
            "base",
            missions.navigate("table-1"),
            {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}},
        ),
        (
            "base",
            missions.navigate(Pose(4.2, 7.8, 1.57)),
            {
                "baseMission": {
                    "navigateMission": {"goal": {"pose": {"xMeters": 4.2, "yMeters": 7.8, "headingRadians": 1.57}}}
                }
            },
        ),
        (
            "servi",
            missions.navigate_auto("table-1", Goal("table-2"), family="servi"),
            {
                "serviMission": {
                    "navigateAutoMission": {"goals": [{"destinationId": "table-1"}, {"destinationId": "table-2"}]}
                }
            },
        ),
        (
            "servi",
            missions.delivery("table-1", trays={"top": "table-1"}),
            {
                "serviMission": {
                    "deliveryMission": {
                        "goals": [{"destinationId": "table-1"}],
                        "params": {"trayMappings": [{"trayName": "top", "goal": {"destinationId": "table-1"}}]},
                    }
                }
            },
        ),
        ("servi", missions.navigate("table-1", family="servi"), None),
        ("servi", missions.delivery_patrol("table-1", "table-2"), None),
        ("servi", missions.bussing("table-1"), None),
        ("servi", missions.bussing_patrol("table-1"), None),
        ("carti", missions.traverse("table-1"), None),
        ("carti", missions.traverse_patrol("table-1"), None),
        ("carti", missions.navigate("table-1", family="carti"), None),
        ("carti", missions.navigate_auto("table-1", family="carti"), None),
    ],
)
def test_a_mission_is_its_protobuf_json(family: str, mission: Any, wire: Any) -> None:
    """Every mission that can be made is one that its family runs, as a message or as protobuf JSON."""
    typed, raw = Robot(family), Robot(family)
    assert wire in (None, write(mission))
    assert typed.create_mission(mission) == raw.create_mission(write(mission))
    assert typed.status == raw.status
    assert raw.call("AppendMission", {"mission": write(mission)}) == {"missionId": "mission-2"}


@pytest.mark.parametrize(
    ("family", "workflow"),
    [
        ("servi", workflows.delivery("table-1", "table-2")),
        ("servi", workflows.delivery_patrol("table-1")),
        ("servi", workflows.bussing("table-1")),
        ("servi", workflows.bussing_patrol("table-1")),
        ("servi", workflows.birthday("table-1")),
        ("servi", workflows.hosting("table-1")),
        ("servi", workflows.hosting_patrol("table-1")),
        ("carti", workflows.traverse("table-1")),
        ("carti", workflows.traverse_patrol("table-1")),
    ],
)
def test_a_workflow_runs_on_its_family(family: str, workflow: Any) -> None:
    """Every preset runs on its family and creates one mission, and is refused by the base family."""
    robot = Robot(family)
    (made,) = robot.create_mission_workflow(workflow)
    assert robot.mission(made).state is State.STATE_RUNNING
    with pytest.raises(InvalidArgument):
        Robot("base").create_mission_workflow(workflow)


def test_the_ten_calls_answer_as_promised() -> None:
    """Batches answer ids in order, a skip names its mission, commands answer nothing, a clear names what is gone."""
    robot = Robot()
    batch = robot.create_mission_batch([missions.delivery("table-1", "table-2"), KITCHEN])
    more = robot.append_mission_batch([TABLE, KITCHEN])
    assert tuple(mission.mission_id for mission in robot.status.missions) == batch + more
    assert robot.skip_goal() == batch[0]
    robot.pause(batch[0])
    assert states(robot)[0] == "PAUSED"
    robot.resume(batch[0])
    robot.finish(batch[0])
    robot.cancel(batch[1])
    assert states(robot) == ["SUCCEEDED", "CANCELED", "RUNNING", "DEFAULT"]
    assert robot.goal_reached()
    assert robot.goal_reached()
    assert robot.clear_mission_status() == batch + more
    charge = robot.charge_robot()
    assert robot.mission(charge).state is State.STATE_RUNNING
    with pytest.raises(KeyError, match=f"no mission '{batch[0]}' is listed; listed: {charge}"):
        robot.mission(batch[0])


@pytest.mark.parametrize(
    ("letter", "left"),
    [("a", ["CANCELED", "RUNNING"]), ("b", ["CANCELED", "DEFAULT"]), ("c", ["CANCELED"] * 2), ("d", ["CANCELED"])],
)
def test_readings_change_behaviour(letter: str, left: list[str]) -> None:
    """A robot follows the readings that it is given: here, what becomes of the queue after a cancellation."""
    robot, first = busy(Robot(readings={"AM-09": letter}))
    robot.append_mission(TABLE)
    robot.cancel(first)
    assert states(robot) == left


def test_readings_change_what_is_seen() -> None:
    """Readings of the stream hold for updates and for the status alike."""
    robot = Robot(readings={"AM-08": "b", "AM-36": "c", "AM-47.repeat": "c"})
    updates = robot.updates()
    assert (len(updates), updates.latest) == (0, None)
    robot.create_mission(TABLE)
    robot.append_mission(TABLE)
    assert states(robot) == ["RUNNING", "UNKNOWN"]
    assert [update.mission_states for update in updates][-2:] == [robot.status, robot.status]


def test_what_does_not_exist_is_refused() -> None:
    """A family, a reading or a call that does not exist, and a text for a list, are mistakes of the test."""
    with pytest.raises(ValueError, match=r"world\.family: 'moxi' is none of base, servi, carti"):
        Robot("moxi")
    with pytest.raises(ValueError, match="AM-09 has no reading z"):
        Robot(readings={"AM-09": "z"})
    with pytest.raises(TypeError, match="one text, not several"):
        Robot(destinations="kitchen")
    for method in ("Dance", "SubscribeMissionStatus"):
        with pytest.raises(ValueError, match="is no call of the mission API with one answer"):
            Robot().call(method, {})


def test_updates_stream() -> None:
    """A subscription starts with the latest state; each `for` takes what came since, numbered and unchangeable."""
    robot, first = busy()
    updates = robot.updates()
    (latest,) = updates
    assert latest.mission_states == robot.status
    assert list(updates) == []
    robot.pause(first)
    robot.resume(first)
    assert len(updates) == 2
    seen = [latest]
    for update in updates:
        seen.append(update)
        robot.goal_reached()
    assert [current(one).state.name for one in seen] == [
        "STATE_RUNNING",
        "STATE_PAUSED",
        "STATE_RUNNING",
        "STATE_RUNNING",
        "STATE_SUCCEEDED",
    ]
    numbers = [one.metadata.sequence_number for one in seen if one.metadata]
    assert numbers == sorted(set(numbers))
    assert updates.latest is seen[-1]
    with pytest.raises(attrs.exceptions.FrozenInstanceError):
        current(latest).state = State.STATE_FAILED  # type: ignore[misc]


def current(update: MissionStatus) -> MissionState:
    assert update.mission_states
    return update.mission_states.missions[-1]


def test_a_callback_gets_updates_as_they_come() -> None:
    """A callback is called with every update in order, with those that it causes itself as well; then no more."""
    robot = Robot()
    seen: list[str] = []

    def react(update: MissionStatus) -> None:
        listed = update.mission_states.missions if update.mission_states else ()
        seen.append(" ".join(mission.state.name.removeprefix("STATE_") for mission in listed))
        if len(listed) == 1:
            robot.append_mission(KITCHEN)

    updates, other = robot.updates(react), robot.updates()
    robot.create_mission(TABLE)
    robot.goal_reached()
    assert seen == ["", "RUNNING", "RUNNING DEFAULT", "SUCCEEDED DEFAULT", "SUCCEEDED RUNNING"]
    assert len(other) == len(seen)
    updates.cancel()
    robot.goal_reached()
    assert len(seen) == 5
    assert len(other) == 6


def test_a_robot_can_go_back() -> None:
    """A robot goes back to a snapshot, updates not yet taken included; what was given up since stays given up."""
    robot, first = busy()
    updates = robot.updates()
    before, status = robot.snapshot(), robot.status
    robot.append_mission(TABLE)
    robot.cancel(first)
    later = robot.updates()
    list(updates)
    after = robot.snapshot()
    robot.restore(before)
    assert robot.snapshot() == before
    assert robot.status == status
    assert not later.open
    assert [update.mission_states for update in updates] == [status]
    robot.append_mission(TABLE)
    robot.cancel(first)
    assert after.here.state == robot.snapshot().here.state
    list(updates)
    updates.cancel()
    robot.restore(before)
    assert not updates.open
    assert robot.goal_reached()
    assert list(updates) == []


def test_a_robot_says_where_it_stands() -> None:
    """Its repr shows the family and the missions, shortly."""
    robot, _ = busy()
    robot.append_mission(KITCHEN)
    assert repr(robot) == "<Robot servi: [RUNNING at goal 0, WAITING]>"


# The oracle's opinion of it.

AUTOMATA: dict[tuple[str, ...], Automaton] = {}


class Walk:
    """A robot with a judge that sees everything that can be seen of it."""

    def __init__(self, family: str, readings: dict[str, str]) -> None:
        self.robot = Robot(family, readings=readings)
        drives = tuple(SYSTEM.spec.drives)
        automaton = AUTOMATA.setdefault(drives, Automaton(SYSTEM.spec, drives))
        self.judge = Judge(SYSTEM, Head(SYSTEM.name, {"family": family}, drives), automaton)
        self.calls = 0
        self.ids: list[str] = ["no-such-mission"]
        self.see("SubscribeMissionStatus", {}, lambda: {"stream": 1})
        self.updates = self.robot.updates()
        self.settle()

    def see(self, method: str, params: Any, ask: Callable[[], Any]) -> None:
        self.calls += 1
        self.feed({"call": self.calls, "method": method, "params": params})
        try:
            self.feed({"return": self.calls, "result": ask()})
        except ApiError as refusal:
            error = {"status": refusal.code, "message": refusal.message}
            self.feed({"return": self.calls, "error": error})

    def call(self, method: str, params: Any) -> None:
        self.see(method, params, lambda: self.robot.call(method, params))
        self.settle()

    def drive(self, event: str) -> None:
        if getattr(self.robot, event)():
            head, *rest = event.split("_")
            self.feed({"drive": {"event": head + "".join(map(str.capitalize, rest))}})
        self.settle()

    def settle(self) -> None:
        for update in self.updates:
            self.feed({"stream": 1, "message": write(update)})
        self.feed({"settled": True})
        self.ids = ["no-such-mission", *(one.mission_id for one in self.robot.status.missions if one.mission_id)]

    def feed(self, line: Any) -> None:
        assert self.judge.feed(line), self.judge.verdict()


UNARY = {family: SYSTEM.alphabet({"family": family}, Bounds()).inputs for family in ("base", "servi", "carti")}
CHOICES = [{}] + [
    {ambiguity.id: letter}
    for ambiguity in SYSTEM.spec.ambiguities
    for letter in ambiguity.readings
    if letter != ambiguity.default and (ambiguity.id, letter) != ("AM-50.shape", "b")
]
"""One reading at a time; feedback as a bare enum (AM-50) has no typed value that could be put on the wire."""


def test_a_first_mission_is_seen_when_the_gap_shows_the_mission_before() -> None:
    """Where the gap shows the mission before, a first mission has none before it, and is seen all the same."""
    robot = Robot(readings={"AM-14.gap": "d"})
    updates = robot.updates()
    mission = robot.create_mission(TABLE)
    shown = [[one.mission_id for one in update.mission_states.missions] for update in updates]
    assert shown[-1] == [mission]


@given(st.sampled_from(sorted(UNARY)), st.sampled_from(CHOICES), st.data())
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
def test_the_oracle_accepts_every_walk(family: str, readings: dict[str, str], data: st.DataObject) -> None:
    """Whatever is asked of a robot and happens to it, under any reading, the oracle finds it conforming."""
    walk = Walk(family, readings)
    prompts = [prompt for prompt in UNARY[family] if prompt.method != "SubscribeMissionStatus"]
    plain = SYSTEM.alphabet({"family": family}, Bounds()).core_inputs
    for _ in range(data.draw(st.integers(1, 20), label="steps")):
        if data.draw(st.booleans(), label="is a drive"):
            walk.drive(data.draw(st.sampled_from(["goal_reached", "mission_succeeded", "mission_failed"])))
            continue
        some = data.draw(st.sampled_from([prompts, [one for one in plain if one.method != "SubscribeMissionStatus"]]))
        prompt = data.draw(st.sampled_from(some))
        named = data.draw(st.sampled_from(walk.ids))
        walk.call(prompt.method, _filled(prompt.params, named))
    assert walk.judge.verdict().conforms


def _filled(params: Any, name: str) -> Any:
    if isinstance(params, dict):
        return {key: _filled(value, name) for key, value in params.items()}
    return name if params == ANY_NAME else params
