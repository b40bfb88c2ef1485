"""The codelet and the simulated robot around it. Each test states one claim."""

import itertools
import json

import attrs
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isaac_helpers import FAILURE, RUNNING, SUCCESS, uuid

from missionfsm.isaac.runtime import codelet as machine
from missionfsm.isaac.runtime.codelet import (
    TABLE,
    Codelet,
    Configure,
    Report,
    StartBehavior,
    State,
    StopBehavior,
    Trigger,
    apply,
    behavior_stops,
    mission_arrives,
    time_passes,
)
from missionfsm.isaac.runtime.robot import Behavior, Did, RobotCore, ScriptProblem, Transmit, parse_script
from missionfsm.isaac.wire.framing import WireError
from missionfsm.isaac.wire.messages import Header, Message, MissionProto, MissionStatusProto, TextProto, WireStatus


def report(number: int | None, status: WireStatus) -> Report:
    return Report(MissionStatusProto(None if number is None else uuid(number), status))


def mission(number: int, config: str = "{}", channel: str = "mission") -> Message:
    return Message(Header(channel), MissionProto(uuid(number), config))


def test_isaac_codelet_reports_running_then_one_final_status() -> None:
    """A mission is configured, started, reported RUNNING at once and every period, and SUCCESS or FAILURE once."""
    codelet, actions = mission_arrives(Codelet(period=0.5), MissionProto(uuid(1), '{"n": {"c": {"p": 1}}}'), 10.0)
    assert actions == (Configure('{"n":{"c":{"p":1}}}'), StartBehavior(), report(1, RUNNING))
    assert time_passes(codelet, 10.25) == (codelet, ())
    codelet, actions = time_passes(codelet, 10.5)
    assert actions == (report(1, RUNNING),)
    for late, following in ((11.5, 12.0), (99.0, 99.5)):  # one period missed, then many: said once all the same
        codelet, actions = time_passes(codelet, late)
        assert (actions, codelet.next_report) == ((report(1, RUNNING),), following)
    idle, actions = behavior_stops(codelet, success=False)
    assert actions == (report(1, FAILURE),)
    assert (idle.state, idle.mission, idle.next_report) == (State.IDLE, None, None)
    assert behavior_stops(codelet, success=True)[1] == (report(1, SUCCESS),)
    for success in (True, False):
        assert behavior_stops(idle, success=success) == (idle, ())
    assert time_passes(idle, 1e9) == (idle, ())


def test_isaac_codelet_preemption_fails_the_old_mission_first() -> None:
    """The tree is stopped and FAILURE said of the old mission before anything is said of the new one."""
    codelet, _ = mission_arrives(Codelet(), MissionProto(uuid(1), "{}"), 0.0)
    codelet, actions = mission_arrives(codelet, MissionProto(uuid(2), "{}"), 1.0)
    assert actions == (StopBehavior(), report(1, FAILURE), Configure("{}"), StartBehavior(), report(2, RUNNING))
    assert (codelet.mission, codelet.next_report) == (uuid(2), 1.1)


@pytest.mark.parametrize("config", ["", "nonsense", "[]", "5", "null", '{"a": NaN}', '{"a": 1, "a": 2}', "[" * 9999])
def test_isaac_codelet_a_config_that_cannot_be_used_fails_at_once(config: str) -> None:
    """FAILURE and nothing else, whether idle or not; one that ran has been preempted."""
    idle, actions = mission_arrives(Codelet(), MissionProto(uuid(1), config), 0.0)
    assert (idle, actions) == (Codelet(), (report(1, FAILURE),))
    running, _ = mission_arrives(Codelet(), MissionProto(uuid(1), "{}"), 0.0)
    after, actions = mission_arrives(running, MissionProto(None, config), 1.0)
    assert (after, actions) == (Codelet(), (StopBehavior(), report(1, FAILURE), report(None, FAILURE)))


def test_isaac_codelet_configurations_lie_over_one_another() -> None:
    """Parameters that a mission does not name persist, or (AI-33 b) are as at first; what is deeper is one value."""
    first = '{"n": {"c": {"p": {"deep": 1}, "q": 1}}, "m": {}}'
    second = '{"n": {"c": {"p": {"other": 2}}, "d": 3}}'
    overlay = {"n": {"c": {"p": {"other": 2}, "q": 1}, "d": 3}, "m": {}}
    for letter, expected in (("a", overlay), ("b", json.loads(second))):
        codelet, _ = mission_arrives(Codelet(ai_33=letter), MissionProto(uuid(1), first), 0.0)
        codelet, _ = mission_arrives(codelet, MissionProto(uuid(2), second), 0.0)
        assert json.loads(codelet.configuration) == expected
    assert apply(first, "{}") == '{"n":{"c":{"p":{"deep":1},"q":1}},"m":{}}'


def test_isaac_codelet_the_table_is_what_the_functions_do() -> None:
    """Every (trigger, source) is tried: those in the table go where it says, the others change nothing."""
    running, _ = mission_arrives(Codelet(), MissionProto(uuid(1), "{}"), 0.0)
    sources = {State.IDLE: Codelet(), State.RUNNING: running}
    found = {}
    for state, codelet in sources.items():
        for trigger, (after, actions) in {
            Trigger.MISSION: mission_arrives(codelet, MissionProto(uuid(2), "{}"), 1.0),
            Trigger.UNUSABLE_MISSION: mission_arrives(codelet, MissionProto(uuid(2), "x"), 1.0),
            Trigger.SUCCEEDED: behavior_stops(codelet, success=True),
            Trigger.FAILED: behavior_stops(codelet, success=False),
            Trigger.PERIOD: time_passes(codelet, 1.0),
        }.items():
            if actions:
                found[trigger, state] = after.state
            else:
                assert after == codelet
    assert {(trigger, source): destination for trigger, source, destination in TABLE} == found
    assert len(TABLE) == len(found)


@pytest.mark.parametrize("period", [0.0, -1.0, float("inf"), float("nan")])
def test_isaac_codelet_a_period_is_a_number_of_seconds_more_than_zero(period: float) -> None:
    """Anything else cannot be asked for."""
    with pytest.raises(ValueError, match="period"):
        Codelet(period=period)
    with pytest.raises(ValueError, match="name_period"):
        RobotCore("r", name_period=period)


@given(st.lists(st.sampled_from(["mission", "unusable", "success", "failure", "time"]), max_size=30))
def test_isaac_codelet_every_mission_has_exactly_one_final_status_after_all_its_running(events: list[str]) -> None:
    """Over any events: one final status a mission, in the order of arrival, and RUNNING only between the two ends."""
    codelet, now, arrived, said = Codelet(period=1.0), 0.0, 0, []
    for event in events:
        now += 0.75
        if event in {"mission", "unusable"}:
            config = "{}" if event == "mission" else "]"
            codelet, actions = mission_arrives(codelet, MissionProto(uuid(arrived), config), now)
            arrived += 1
        elif event == "time":
            codelet, actions = time_passes(codelet, now)
        else:
            codelet, actions = behavior_stops(codelet, success=event == "success")
        said += [(a.status.uuid, a.status.mission_status) for a in actions if isinstance(a, Report)]
    if codelet.state is State.RUNNING:
        codelet, actions = behavior_stops(codelet, success=True)
        said += [(a.status.uuid, a.status.mission_status) for a in actions if isinstance(a, Report)]
    assert [about for about, status in said if status is not RUNNING] == [uuid(number) for number in range(arrived)]
    current = [about.lower for about, _ in said if about is not None]
    assert current == sorted(current)
    for (one, status), (other, _) in itertools.pairwise(said):
        assert (one == other) == (status is RUNNING)


def test_isaac_robot_says_its_name_on_connection_and_then_periodically() -> None:
    """The name goes out at once and every period, on every connection, and not without one."""
    robot = RobotCore("r", name_period=0.25)
    name = Transmit("name", TextProto("r"))
    assert robot.next_deadline() is None
    assert robot.connected(1.0) == (name,)
    assert robot.next_deadline() == 1.25
    assert robot.advance(1.25) == (name,)
    assert robot.advance(9.0) == (name,)
    assert robot.next_deadline() == 9.25
    assert robot.disconnected(9.1) == ()
    assert (robot.next_deadline(), robot.advance(20.0)) == (None, ())
    assert robot.connected(20.0) == (name,)


def test_isaac_robot_follows_its_script() -> None:
    """Missions go as scripted, the last step for all that follow."""
    robot = RobotCore("r", script=(Behavior("fail", 2.0), Behavior("succeed", 0.0)), name_period=1e6)
    robot.connected(0.0)
    said = []
    for number in range(3):
        robot.received(mission(number), number * 10.0)
        ended = robot.advance(number * 10.0 + 2.0)
        said += [effect.payload for effect in ended if isinstance(effect, Transmit)]
    assert said == [report(0, FAILURE).status, report(1, SUCCESS).status, report(2, SUCCESS).status]


def test_isaac_robot_hangs_until_it_is_told() -> None:
    """A hanging behavior ends only by hand, or by preemption."""
    robot = RobotCore("r", script=(Behavior("hang"),), codelet=Codelet(period=100.0), name_period=1e6)
    robot.connected(0.0)
    robot.received(mission(1), 0.0)
    assert robot.advance(99.0) == ()
    assert robot.behavior_stops(99.0, success=True) == (
        Did(report(1, SUCCESS)),
        Transmit("mission_status", report(1, SUCCESS).status),
    )


def test_isaac_robot_a_preempted_behavior_does_not_end_the_next_mission() -> None:
    """The old script step is forgotten when its tree is stopped."""
    robot = RobotCore("r", script=(Behavior("fail", 1.0), Behavior("hang")), codelet=Codelet(period=100.0))
    robot.received(mission(1), 0.0)
    robot.received(mission(2), 0.5)
    assert robot.advance(50.0) == ()
    assert robot.codelet.mission == uuid(2)


def test_isaac_robot_keeps_final_statuses_for_a_server_that_is_away() -> None:
    """RUNNING is dropped, the end is told on the next connection, after the name and once."""
    robot = RobotCore("r", script=(Behavior("succeed", 1.0),), name_period=1e6)
    robot.connected(0.0)
    robot.received(mission(1), 0.0)
    robot.disconnected(0.5)
    robot.advance(1.0)
    assert robot.connected(2.0) == (
        Transmit("name", TextProto("r")),
        Transmit("mission_status", report(1, SUCCESS).status),
    )
    assert robot.disconnected(3.0) + robot.connected(4.0) == (Transmit("name", TextProto("r")),)


def test_isaac_robot_listens_to_missions_on_its_channel_only() -> None:
    """Other channels, other messages and errors have no effect."""
    robot = RobotCore("r")
    for item in (
        mission(1, channel="other"),
        Message(Header("mission"), TextProto("x")),
        Message(Header("mission"), MissionStatusProto(uuid(1), RUNNING)),
        WireError(1, 0, "", "bad", "syntax"),
    ):
        assert robot.received(item, 0.0) == ()
    assert robot.codelet == attrs.evolve(Codelet(), period=machine.DEFAULT_PERIOD)


def test_isaac_robot_scripts() -> None:
    """A script is steps of outcome and seconds; what is none is said."""
    assert parse_script("succeed:0.5, fail ,hang:3", 2.0) == (
        Behavior("succeed", 0.5),
        Behavior("fail", 2.0),
        Behavior("hang", 3.0),
    )
    for text, step in (("", "step 1, ''"), ("succeed,fly", "step 2, 'fly'"), ("fail:-1", "step 1, 'fail:-1'")):
        problem = parse_script(text)
        assert isinstance(problem, ScriptProblem)
        assert str(problem) == f"{step}: wanted succeed|fail|hang, or with seconds as in fail:0.5"
