"""The pure mission server under the documented readings. Each test states one claim."""

import math

import pytest
from isaac_helpers import FAILURE, RUNNING, SUCCESS, Driver, request, says_name, says_status, uuid

from missionfsm.isaac.runtime.missions import (
    Ignored,
    MissionRequest,
    Refused,
    RobotOffline,
    RobotOnline,
    RobotView,
    Send,
    Status,
    StatusChanged,
)
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire.framing import WireError
from missionfsm.isaac.wire.messages import Header, Message, MissionProto, TextProto


def test_isaac_server_a_mission_from_creation_to_success() -> None:
    """One mission passes through CREATED, QUEUED, STARTED, RUNNING and SUCCESS, and is sent once."""
    core = MissionServerCore()
    assert core.create(MissionRequest("r", config='{"a":1}'), uuid(0)) is None
    assert core.status(uuid(0)) is Status.CREATED
    assert core.submit(uuid(0), 0.0) == (StatusChanged(uuid(0), Status.CREATED, Status.QUEUED),)
    assert core.connected(1, 0.0) == ()
    assert core.received(1, says_name("r"), 0.0) == (
        RobotOnline("r", 1),
        Send(1, "mission", MissionProto(uuid(0), '{"a":1}'), uuid(0)),
        StatusChanged(uuid(0), Status.QUEUED, Status.STARTED),
    )
    assert core.next_deadline() == 5.0
    assert core.received(1, says_status(0, RUNNING), 1.0) == (StatusChanged(uuid(0), Status.STARTED, Status.RUNNING),)
    assert core.next_deadline() is None
    assert core.received(1, says_status(0, RUNNING), 2.0) == ()
    assert core.robots() == (RobotView("r", 1, 1, (uuid(0),)),)
    assert core.received(1, says_status(0, SUCCESS), 3.0) == (StatusChanged(uuid(0), Status.RUNNING, Status.SUCCESS),)
    assert core.unfinished == 0
    assert core.disconnected(1, 4.0) == (RobotOffline("r", 1),)
    assert core.robots() == ()


def test_isaac_server_downstream_waits_for_all_upstreams_on_any_robot() -> None:
    """A mission with two upstreams on two robots is sent when the second has succeeded, not before."""
    server = Driver()
    server.add("a")
    server.add("b")
    server.add("c", [0, 1, 0])
    assert server.connect(3, "c") == []
    assert server.connect(1, "a") == [0]
    assert server.connect(2, "b") == [1]
    assert server.report(1, 0, RUNNING, SUCCESS) == []
    assert server.report(2, 1, RUNNING) == []
    assert server.report(2, 1, SUCCESS) == [2]


def test_isaac_server_forklifts_and_arm() -> None:
    """The page's example of two forklifts and an arm runs in the order of its dependencies."""
    server = Driver()
    for robot, upstream in (
        ("fork01", []), ("fork02", []), ("arm01", [0, 1]), ("fork01", [2]), ("fork02", [2]),
    ):  # fmt: skip
        server.add(robot, upstream)
    assert [server.connect(number, name) for number, name in enumerate(("fork01", "fork02", "arm01"))] == [[0], [1], []]
    assert [server.report(0, 0, SUCCESS), server.report(1, 1, SUCCESS)] == [[], [2]]
    assert server.report(2, 2, RUNNING, SUCCESS) == [3, 4]


@pytest.mark.parametrize("how", ["failure", "start timeout", "run timeout", "disconnection"])
def test_isaac_server_everything_downstream_of_a_failure_is_cancelled(how: str) -> None:
    """Whatever the failure is, all that depends on it ends as FAILED_UPSTREAM unsent; what does not goes on."""
    server = Driver()
    server.connect(1, "r")
    server.add(timeout=10.0)
    server.add("s", [0])
    server.add("s", [1])
    server.add("s", [0, 2])
    server.add("r")
    server.connect(2, "s")
    if how == "failure":
        sent = server.report(1, 0, RUNNING, FAILURE)
    elif how == "start timeout":
        sent = server.wait(5.0)
    elif how == "run timeout":
        server.report(1, 0, RUNNING)
        assert server.wait(9.9) == []
        sent = server.wait(0.1)
    else:
        sent = server.drop(1) + server.connect(3, "r")
    assert sent == [4]
    first = {"failure": "FAILED", "disconnection": "FAILED_DISCONNECTED"}.get(how, "FAILED_TIMEDOUT")
    assert server.statuses() == [first, "FAILED_UPSTREAM", "FAILED_UPSTREAM", "FAILED_UPSTREAM", "STARTED"]


def test_isaac_server_one_mission_at_a_time_in_the_order_of_submission() -> None:
    """A robot gets the next mission after the final status of the last, the first submitted first."""
    server = Driver()
    for _ in range(3):
        server.add()
    assert server.connect(1, "r") == [0]
    assert server.report(1, 0, RUNNING) == []
    assert server.report(1, 0, FAILURE) == [1]
    assert server.report(1, 1, SUCCESS) == [2]


def test_isaac_server_a_waiting_mission_is_overtaken() -> None:
    """A mission that waits for another robot does not hold up the one behind it, and goes first when it can."""
    server = Driver()
    server.add("s")
    server.add("r", [0])
    server.add("r")
    server.add("r")
    assert server.connect(1, "r") == [2]
    assert server.connect(2, "s") == [0]
    assert server.report(2, 0, SUCCESS) == []
    assert server.report(1, 2, SUCCESS) == [1]


def test_isaac_server_the_start_timeout_counts_from_dispatch() -> None:
    """Waiting for a robot or an upstream costs nothing; five silent seconds after dispatch do."""
    server = Driver()
    server.add()
    server.wait(100)
    assert server.connect(1, "r") == [0]
    server.wait(4.999)
    assert server.statuses() == ["STARTED"]
    server.wait(0.001)
    assert server.statuses() == ["FAILED_TIMEDOUT"]


def test_isaac_server_a_status_at_the_very_moment_of_the_timeout_is_late() -> None:
    """Acknowledged means before the timeout has elapsed."""
    server = Driver()
    server.add()
    server.connect(1, "r")
    server.now = 5.0
    server.report(1, 0, RUNNING)
    assert server.statuses() == ["FAILED_TIMEDOUT"]


def test_isaac_server_a_final_status_needs_no_running_before_it() -> None:
    """SUCCESS at once acknowledges and completes."""
    server = Driver()
    server.add()
    server.connect(1, "r")
    server.report(1, 0, SUCCESS)
    assert server.changes() == [(0, "QUEUED"), (0, "STARTED"), (0, "SUCCESS")]


def test_isaac_server_a_start_timeout_of_zero_fails_unsent() -> None:
    """Nothing can be acknowledged in no time, so nothing is sent, and the next mission goes."""
    server = Driver()
    server.add(start_timeout=0)
    server.add(upstream=[0])
    server.add()
    assert server.connect(1, "r") == [2]
    assert server.statuses() == ["FAILED_TIMEDOUT", "FAILED_UPSTREAM", "STARTED"]


def test_isaac_server_a_thousand_expired_missions_in_a_row_are_no_matter() -> None:
    """Ends are worked off one by one, not by recursion: chains of any length cancel, queues of any length expire."""
    server = Driver()
    for _ in range(3000):
        server.add("q", start_timeout=0)
    server.add()
    for number in range(3000, 6000):
        server.add(upstream=[number])
    server.connect(1, "q")
    server.connect(2, "r")
    server.report(2, 3000, FAILURE)
    assert server.core.unfinished == 0


@pytest.mark.parametrize("status", [RUNNING, SUCCESS, FAILURE])
def test_isaac_server_statuses_after_the_end_are_ignored(status: object) -> None:
    """A mission that has ended stays as it is, whether it succeeded, failed or was aborted."""
    server = Driver()
    server.connect(1, "r")
    for _ in range(3):
        server.add()
    server.report(1, 0, SUCCESS)
    server.report(1, 1, FAILURE)
    server.wait(5.0)
    before = server.statuses()
    for number in range(3):
        server.report(1, number, status)  # type: ignore[arg-type]
    assert server.statuses() == before == ["SUCCESS", "FAILED", "FAILED_TIMEDOUT"]


def test_isaac_server_a_stale_failure_does_not_touch_the_next_mission() -> None:
    """After an abort the robot is preempted and says so; that is not the new mission's failure."""
    server = Driver()
    server.connect(1, "r")
    server.add()
    server.add()
    assert server.wait(5.0) == [1]
    server.report(1, 0, FAILURE)
    server.report(1, 1, RUNNING)
    assert server.statuses() == ["FAILED_TIMEDOUT", "RUNNING"]


def test_isaac_server_statuses_that_mean_nothing_are_ignored_and_said_to_be() -> None:
    """Unknown, foreign, unsent and misdirected statuses change nothing."""
    server = Driver()
    server.connect(1, "r")
    server.connect(2, "s")
    server.connect(3)
    server.add("r")
    server.add("r")
    server.effects.clear()
    server.report(1, 99, SUCCESS)
    server.report(2, 0, SUCCESS)
    server.report(1, 1, SUCCESS)
    server.report(3, 0, SUCCESS)
    server.report(2, None, SUCCESS)
    server.hear(1, says_status(0, SUCCESS, "mission"))
    server.hear(1, Message(Header("mission"), MissionProto(uuid(0), "{}")))
    server.hear(1, Message(Header("chat"), TextProto("hello")))
    assert [type(effect) for effect in server.effects] == [Ignored] * 8
    assert server.statuses() == ["STARTED", "QUEUED"]


def test_isaac_server_a_status_that_names_no_mission_is_the_current_one_on_its_channel() -> None:
    """Without an identifier the status channel decides."""
    server = Driver()
    server.connect(1, "r")
    server.add(status_channel="s")
    server.report(1, None, RUNNING)
    assert server.statuses() == ["STARTED"]
    server.hear(1, says_status(None, RUNNING, "s"))
    assert server.statuses() == ["RUNNING"]


def test_isaac_server_nothing_is_sent_before_the_name() -> None:
    """A connection without a name, or with an empty one, gets nothing."""
    server = Driver()
    server.add("r")
    assert server.connect(1) == server.hear(1, says_name("")) == server.hear(1, says_name("r", "other")) == []
    assert server.hear(1, says_name("R")) == server.hear(1, says_name("r")) == []  # "R" is somebody else, for good
    assert server.connect(2, "r") == [0]


def test_isaac_server_saying_the_name_again_changes_nothing() -> None:
    """A name is said periodically; the mission is sent once."""
    server = Driver()
    server.add()
    server.connect(1, "r")
    assert [server.hear(1, says_name("r")) for _ in range(5)] == [[]] * 5
    assert len(server.effects) == 4


def test_isaac_server_the_newest_connection_is_the_robot() -> None:
    """A second connection of one name takes over, and the first, though it says its name again, does not."""
    server = Driver()
    server.connect(1, "r")
    server.add()
    server.add()
    assert server.connect(2, "r") == [1]
    assert server.hear(1, says_name("r")) == []
    server.report(1, 1, SUCCESS)
    assert server.statuses() == ["FAILED_DISCONNECTED", "STARTED"]
    server.add()
    assert server.drop(2) == []
    assert server.hear(1, says_name("r")) == [2]


def test_isaac_server_queued_missions_wait_for_the_robot_to_come_back() -> None:
    """A drop fails what runs and keeps what is queued."""
    server = Driver()
    server.add()
    server.add()
    server.connect(1, "r")
    server.report(1, 0, RUNNING)
    server.drop(1)
    assert server.statuses() == ["FAILED_DISCONNECTED", "QUEUED"]
    assert server.connect(2, "r") == [1]


def test_isaac_server_events_of_closed_connections_are_no_matter() -> None:
    """What comes from a connection that is gone, or never was, has no effect."""
    server = Driver()
    server.connect(1, "r")
    server.drop(1)
    server.add()
    server.effects.clear()
    server.drop(1)
    server.report(1, 0, SUCCESS)
    server.hear(9, says_name("r"))
    assert server.effects == []
    with pytest.raises(ValueError, match="connection 2 is open already"):
        server.connect(2) + server.connect(2)


def test_isaac_server_refusals_change_nothing() -> None:
    """Each odd submission is refused with its reason, and the server is as before."""
    core = MissionServerCore()
    assert core.create(request("r"), uuid(0)) is None
    assert core.create(request("r"), uuid(0)) == Refused(f"mission {uuid(0)} exists already")
    assert core.create(request(None), uuid(1)) == Refused("the mission has no robot")
    assert core.create(request("r", [0, 1]), uuid(1)) == Refused(f"upstream[1]: there is no mission {uuid(1)} yet")
    assert core.submit(uuid(1), 0.0) == Refused(f"there is no mission {uuid(1)}")
    assert not isinstance(core.submit(uuid(0), 0.0), Refused)
    assert core.submit(uuid(0), 0.0) == Refused(f"mission {uuid(0)} was submitted before")
    assert list(core.statuses()) == [(uuid(0), Status.QUEUED)]


def test_isaac_server_upstreams_that_have_ended_decide_at_once() -> None:
    """Submitted after its upstream succeeded a mission goes; after it failed, it is cancelled."""
    server = Driver()
    server.connect(1, "r")
    server.add()
    server.report(1, 0, SUCCESS)
    server.add()
    server.report(1, 1, FAILURE)
    assert server.add(upstream=[0]) == [2]
    assert server.add(upstream=[0, 1]) == []
    assert server.statuses()[3] == "FAILED_UPSTREAM"


def test_isaac_server_an_unsubmitted_upstream_is_waited_for() -> None:
    """A mission whose upstream was not submitted waits, and goes when it was and succeeded."""
    server = Driver()
    server.connect(1, "r")
    first = server.make()
    assert server.add(upstream=[first]) == []
    assert server.submit(first) == [0]
    assert server.report(1, 0, SUCCESS) == [1]


def test_isaac_server_a_line_that_cannot_be_read_is_skipped() -> None:
    """An error is noted, and the connection goes on."""
    server = Driver()
    server.connect(1, "r")
    error = WireError(3, 0, "header", "is missing", "shape")
    assert server.core.received(1, error, 0.0) == (Ignored(1, "line 3, byte 0, header: is missing"),)
    assert server.add() == [0]


@pytest.mark.parametrize("value", [-1.0, math.nan])
def test_isaac_server_timeouts_are_seconds_from_zero(value: float) -> None:
    """Negative and undefined timeouts cannot be asked for."""
    with pytest.raises(ValueError, match="timeout"):
        MissionRequest("r", start_timeout=value)
    with pytest.raises(ValueError, match="timeout"):
        MissionRequest("r", timeout=value)


def test_isaac_server_the_clock_does_not_run_backwards() -> None:
    """An earlier time is taken for the latest one told."""
    server = Driver()
    server.connect(1, "r")
    server.wait(10)
    server.now = 2.0
    server.add()
    assert server.core.next_deadline() == 15.0


def test_isaac_server_robots_are_forgotten_when_they_go_and_nothing_waits_for_them() -> None:
    """Names that come and go leave nothing behind."""
    server = Driver()
    for number in range(100):
        server.connect(number, f"robot {number}")
        server.drop(number)
    assert server.core.robots() == ()


def test_isaac_server_void_deadlines_do_not_pile_up() -> None:
    """Ten thousand acknowledged missions leave a short queue of deadlines."""
    server = Driver()
    server.connect(1, "r")
    for number in range(10_000):
        server.add(timeout=1e6)
        server.report(1, number, SUCCESS)
    assert len(server.core._scheduler.deadlines) < 200
