"""The other readings that a server can take: what each changes. One test a reading."""

import attrs
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isaac_helpers import FAILURE, RUNNING, SUCCESS, Driver, says_name, says_status, uuid

from missionfsm.isaac.runtime.missions import Close, Refused
from missionfsm.isaac.runtime.profile import AS_SHIPPED, DOCUMENTED, PROFILES, Profile
from missionfsm.isaac.wire.framing import WireError
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto


def reading(*choices: str, **settings: float) -> Driver:
    profile = attrs.evolve(DOCUMENTED, **settings)  # type: ignore[arg-type]
    for entry, letter in (choice.split("=") for choice in choices):
        profile = profile.choosing(entry, letter)
    return Driver(profile)


def test_isaac_profiles_by_entry() -> None:
    """Both profiles, entry by entry."""
    documented = {
        "AI-03": "an", "AI-04": "a", "AI-05": "a", "AI-06": "a", "AI-07": "a", "AI-08": "a", "AI-09": "a",
        "AI-10": "a", "AI-11": "a", "AI-12": "a", "AI-13": "a", "AI-15": "cn", "AI-16": "alq", "AI-17": "a",
        "AI-18": "ac", "AI-19": "c", "AI-21": "a", "AI-22": "ae", "AI-24": "ax", "AI-25": "a", "AI-26": "ec",
        "AI-31": "b", "AI-36": "a", "AI-37": "a", "AI-38": "b",
    }  # fmt: skip
    assert DOCUMENTED.readings() == documented
    assert AS_SHIPPED.readings() == {
        **documented, "AI-03": "ap", "AI-10": "b", "AI-12": "b", "AI-15": "cp", "AI-16": "nmr", "AI-21": "b",
        "AI-22": "be", "AI-24": "aw",
    }  # fmt: skip
    assert PROFILES == {"documented": DOCUMENTED, "as-shipped": AS_SHIPPED}


def test_isaac_profiles_choose_by_entry_and_letter() -> None:
    """A letter finds its question; one that no entry has is refused by name."""
    assert DOCUMENTED.choosing("AI-22", "c").choosing("AI-22", "d").readings()["AI-22"] == "cd"
    for entry, letter in (("AI-12", "x"), ("AI-99", "a"), ("AI-16", "c")):
        with pytest.raises(ValueError, match=f"^a mission server has no reading {entry} {letter}; there are AI-03"):
            DOCUMENTED.choosing(entry, letter)
    with pytest.raises(ValueError, match="ai_15"):
        Profile(ai_15="z")


def test_isaac_reading_03_b_only_a_reported_failure_cancels_and_only_directly() -> None:
    """An aborted upstream leaves its downstream waiting, as does a cancelled one."""
    server = reading("AI-03=b")
    server.connect(1, "r")
    server.add()
    server.add(upstream=[0])
    server.add(upstream=[1])
    server.wait(5)
    server.add(upstream=[0])
    assert server.statuses() == ["FAILED_TIMEDOUT", "QUEUED", "QUEUED", "QUEUED"]
    server.add()
    server.add(upstream=[4])
    server.add(upstream=[5])
    server.report(1, 4, FAILURE)
    assert server.statuses()[4:] == ["FAILED", "FAILED_UPSTREAM", "QUEUED"]


def test_isaac_reading_03_c_cancellation_does_not_cascade() -> None:
    """Direct downstream is cancelled, grandchildren wait."""
    server = reading("AI-03=c")
    server.connect(1, "r")
    server.add()
    server.add(upstream=[0])
    server.add(upstream=[1])
    server.wait(5)
    assert server.statuses() == ["FAILED_TIMEDOUT", "FAILED_UPSTREAM", "QUEUED"]


def test_isaac_reading_04_b_waiting_for_an_upstream_is_created() -> None:
    """QUEUED is said when the upstreams are done."""
    server = reading("AI-04=b")
    server.add()
    server.add(upstream=[0])
    assert server.statuses() == ["QUEUED", "CREATED"]
    server.connect(1, "r")
    server.report(1, 0, SUCCESS)
    assert server.changes()[-2:] == [(1, "QUEUED"), (1, "STARTED")]


def test_isaac_reading_05_b_the_start_timeout_counts_from_submission() -> None:
    """Without a robot, and without its upstream, a mission expires."""
    server = reading("AI-05=b")
    server.add()
    server.add(upstream=[0])
    server.wait(5)
    assert server.statuses() == ["FAILED_TIMEDOUT", "FAILED_UPSTREAM"]
    assert server.connect(1, "r") == []


def test_isaac_reading_05_c_the_start_timeout_counts_from_the_upstreams_end() -> None:
    """Without its upstream a mission waits; without its robot it expires."""
    server = reading("AI-05=c")
    server.connect(1, "r")
    server.add(start_timeout=100)
    server.add("s", [0])
    server.wait(50)
    server.report(1, 0, SUCCESS)
    server.wait(4.9)
    assert server.statuses() == ["SUCCESS", "QUEUED"]
    server.wait(0.1)
    assert server.statuses() == ["SUCCESS", "FAILED_TIMEDOUT"]


def test_isaac_reading_05_d_the_start_timeout_counts_from_the_connection() -> None:
    """A mission that waits its turn expires five seconds after the robot came, or after it was submitted; while the
    robot is away nothing counts.
    """
    server = reading("AI-05=d")
    server.add(start_timeout=100)
    server.add()
    server.wait(50)
    assert server.connect(1, "r") == [0]
    server.wait(4)
    server.drop(1)
    server.wait(50)
    assert server.statuses() == ["FAILED_DISCONNECTED", "QUEUED"]
    assert server.connect(2, "r") == [1]
    server.wait(4.9)
    assert server.statuses()[1] == "STARTED"
    server.wait(0.1)
    assert server.statuses()[1] == "FAILED_TIMEDOUT"


@pytest.mark.parametrize(("letter", "ends"), [("a", 13.0), ("b", 12.0), ("c", 10.0)])
def test_isaac_reading_06_where_the_run_timeout_starts(letter: str, ends: float) -> None:
    """Submitted at 0, sent at 2, acknowledged at 3 with a timeout of 10: each reading ends the mission at its time."""
    server = reading(f"AI-06={letter}")
    server.add(timeout=10)
    server.wait(2)
    server.connect(1, "r")
    server.wait(1)
    server.report(1, 0, RUNNING)
    server.wait(ends - 3.125)
    assert server.statuses() == ["RUNNING"]
    server.wait(0.125)
    assert server.statuses() == ["FAILED_TIMEDOUT"]


def test_isaac_reading_07_b_only_running_acknowledges() -> None:
    """A final status before RUNNING is not heard, so the mission times out."""
    server = reading("AI-07=b")
    server.add()
    server.connect(1, "r")
    server.report(1, 0, SUCCESS)
    assert server.statuses() == ["STARTED"]
    server.wait(5)
    assert server.statuses() == ["FAILED_TIMEDOUT"]


def test_isaac_reading_07_c_sending_acknowledges() -> None:
    """No start timeout ever comes, not even one of zero; the run timeout counts from the sending."""
    server = reading("AI-07=c")
    server.add(start_timeout=0, timeout=9)
    assert server.connect(1, "r") == [0]
    server.wait(8.5)
    assert server.statuses() == ["STARTED"]
    server.report(1, 0, RUNNING)
    server.wait(0.5)
    assert server.statuses() == ["FAILED_TIMEDOUT"]


def test_isaac_reading_08_c_an_abort_closes_the_connection() -> None:
    """The robot loses its connection, and gets the next mission on a new one."""
    server = reading("AI-08=c")
    server.connect(1, "r")
    server.add()
    server.add()
    assert server.wait(5) == []
    assert Close(1, f"mission {uuid(0)} was aborted") in server.effects
    assert server.connect(2, "r") == [1]


@pytest.mark.parametrize(("letter", "expected"), [("b", ["FAILED", "SUCCESS"]), ("c", ["SUCCESS", "SUCCESS"])])
def test_isaac_reading_09_late_statuses_are_believed(letter: str, expected: list[str]) -> None:
    """b: the last final status wins. c: only the first after an abort. Downstream stays cancelled under both."""
    server = reading(f"AI-09={letter}")
    server.connect(1, "r")
    server.add()
    server.report(1, 0, SUCCESS, FAILURE, RUNNING)
    server.add()
    server.add(upstream=[1])
    server.wait(5)
    server.report(1, 1, SUCCESS)
    if letter == "c":
        server.report(1, 1, FAILURE)
    assert server.statuses() == [*expected, "FAILED_UPSTREAM"]
    assert server.core.unfinished == 0


def test_isaac_reading_10_b_a_status_without_a_mission_is_nobodys() -> None:
    """Only the identifier in the payload counts."""
    server = reading("AI-10=b")
    server.connect(1, "r")
    server.add()
    server.report(1, None, SUCCESS)
    assert server.statuses() == ["STARTED"]
    server.report(1, 0, SUCCESS)
    assert server.statuses() == ["SUCCESS"]


def test_isaac_reading_10_c_the_header_names_the_mission() -> None:
    """Only the identifier in the header counts."""
    server = reading("AI-10=c")
    server.connect(1, "r")
    server.add()
    server.report(1, 0, SUCCESS)
    assert server.statuses() == ["STARTED"]
    server.hear(1, Message(Header("mission_status", uuid=uuid(0)), MissionStatusProto(None, SUCCESS)))
    assert server.statuses() == ["SUCCESS"]


def test_isaac_reading_11_b_all_that_are_ready_are_sent_at_once() -> None:
    """Every ready mission goes out on connection, in order; what waits for an upstream does not."""
    server = reading("AI-11=b")
    server.add()
    server.add()
    server.add(upstream=[0])
    assert server.connect(1, "r") == [0, 1]
    assert server.report(1, 0, SUCCESS) == [2]
    server.report(1, None, RUNNING)
    assert server.statuses() == ["SUCCESS", "STARTED", "RUNNING"]


def test_isaac_reading_11_c_one_at_a_time_per_channel() -> None:
    """Channels do not wait for each other; within one the order holds."""
    server = reading("AI-11=c")
    for channel in ("x", "y", "x", "y"):
        server.add(channel=channel)
    assert server.connect(1, "r") == [0, 1]
    assert server.report(1, 1, SUCCESS) == [3]
    server.drop(1)
    assert server.statuses() == ["FAILED_DISCONNECTED", "SUCCESS", "QUEUED", "FAILED_DISCONNECTED"]


def test_isaac_reading_11_c_a_drop_may_cancel_missions_of_other_channels() -> None:
    """A drop that fails a mission cancels what depends on it on a channel that was never used."""
    server = reading("AI-11=c")
    server.add(channel="x")
    server.add(upstream=[0], channel="y")
    server.connect(1, "r")
    server.drop(1)
    assert server.statuses() == ["FAILED_DISCONNECTED", "FAILED_UPSTREAM"]


def test_isaac_reading_12_b_a_waiting_mission_holds_up_those_behind() -> None:
    """The order of submission is kept, whatever it costs."""
    server = reading("AI-12=b")
    server.add("s")
    server.add("r", [0])
    server.add("r")
    assert server.connect(1, "r") == []
    server.connect(2, "s")
    assert server.report(2, 0, SUCCESS) == [1]
    assert server.report(1, 1, SUCCESS) == [2]


def test_isaac_reading_12_b_a_cancelled_head_lets_the_next_go() -> None:
    """What has ended does not hold up anybody."""
    server = reading("AI-12=b")
    server.add("s")
    server.add("r", [0])
    server.add("r")
    server.connect(1, "r")
    server.connect(2, "s")
    assert server.report(2, 0, FAILURE) == [2]


def test_isaac_reading_13_b_any_ready_mission_may_go() -> None:
    """Here the last submitted does."""
    server = reading("AI-13=b")
    for _ in range(3):
        server.add()
    assert server.connect(1, "r") == [2]


@pytest.mark.parametrize("when", ["sent", "running"])
def test_isaac_reading_15_a_a_drop_changes_nothing(when: str) -> None:
    """The mission goes on, is not sent again, and may end on the next connection; timeouts decide otherwise."""
    server = reading("AI-15=a")
    server.add(timeout=60)
    server.add()
    server.connect(1, "r")
    if when == "running":
        server.report(1, 0, RUNNING)
    server.drop(1)
    server.wait(4)
    assert server.connect(2, "r") == []
    assert server.report(2, 0, SUCCESS) == [1]
    server.drop(2)
    server.wait(1000)
    assert server.statuses() == ["SUCCESS", "FAILED_TIMEDOUT"]


@pytest.mark.parametrize("order", ["AI-12=a", "AI-12=b"])
@pytest.mark.parametrize("when", ["sent", "running"])
def test_isaac_reading_15_b_a_drop_has_the_mission_sent_again(when: str, order: str) -> None:
    """Before all others, with its clocks at zero."""
    server = reading("AI-15=b", order)
    server.add(timeout=5)
    server.add()
    server.connect(1, "r")
    if when == "running":
        server.report(1, 0, RUNNING)
    server.drop(1)
    server.wait(100)
    assert server.statuses() == ["QUEUED", "QUEUED"]
    assert server.connect(2, "r") == [0]
    server.wait(4)
    server.report(2, 0, RUNNING)
    server.wait(4)
    assert server.report(2, 0, SUCCESS) == [1]


def test_isaac_reading_16_b_the_oldest_connection_keeps_the_name() -> None:
    """The newcomer is the robot when the oldest has gone and it says its name again."""
    server = reading("AI-16=b")
    server.connect(1, "r")
    server.connect(2, "r")
    assert server.add() == [0]
    assert server.report(2, 0, SUCCESS) == []
    server.add()
    server.drop(1)
    assert server.hear(2, says_name("r")) == [1]
    assert server.statuses() == ["FAILED_DISCONNECTED", "STARTED"]


def test_isaac_reading_16_d_the_newcomer_is_refused() -> None:
    """Its connection is closed."""
    server = reading("AI-16=d")
    server.connect(1, "r")
    server.connect(2, "r")
    assert server.effects[-1] == Close(2, "another connection has that name")
    assert server.add() == [0]
    server.drop(2)
    assert server.report(1, 0, RUNNING) == []
    assert server.statuses() == ["RUNNING"]


def test_isaac_reading_17_b_another_name_binds_again() -> None:
    """The connection leaves the old robot, whose mission fails, and is the new one."""
    server = reading("AI-17=b")
    server.connect(1, "r")
    server.add("r")
    server.add("s")
    assert server.hear(1, says_name("s")) == [1]
    assert server.statuses() == ["FAILED_DISCONNECTED", "STARTED"]


def test_isaac_reading_18_b_statuses_before_the_name_are_kept() -> None:
    """They count as soon as the name is known; no more than 64 are kept."""
    server = reading("AI-18=b", "AI-15=a")
    server.connect(1, "r")
    server.add()
    server.drop(1)
    server.connect(2)
    server.report(2, 0, *[RUNNING] * 64, SUCCESS)
    server.hear(2, says_name("r"))
    assert server.statuses() == ["RUNNING"]
    server.drop(2)
    server.connect(3)
    server.report(3, 0, *[RUNNING] * 63, SUCCESS)
    server.hear(3, says_name("r"))
    assert server.statuses() == ["SUCCESS"]


def test_isaac_reading_18_d_a_silent_connection_is_closed() -> None:
    """After the name timeout, unless it has said its name."""
    server = reading("AI-18=d", name_timeout=2)
    server.connect(1, "r")
    server.connect(2)
    server.wait(1.9)
    server.connect(3)
    server.wait(0.1)
    assert [effect for effect in server.effects if isinstance(effect, Close)] == [
        Close(2, "it did not say its name in time")
    ]


def test_isaac_reading_19_a_a_mission_for_nobody_waits_for_ever() -> None:
    """It is taken and never sent, whatever a robot calls itself."""
    server = reading("AI-19=a")
    server.add(None)
    assert server.connect(1, "") + server.connect(2, "None") == []
    assert server.statuses() == ["QUEUED"]


def test_isaac_reading_22_b_an_unsubmitted_upstream_is_refused() -> None:
    """The upstream is named; submitted in order, both are taken."""
    server = reading("AI-22=b")
    server.make()
    server.make(upstream=[0])
    assert server.core.submit(uuid(1), 0.0) == Refused(f"upstream[0]: mission {uuid(0)} was not submitted")
    server.submit(0)
    server.submit(1)


def test_isaac_reading_22_c_an_unsubmitted_upstream_is_submitted_too() -> None:
    """All upstreams are, before the mission itself, each once."""
    server = reading("AI-22=c")
    server.connect(1, "r")
    server.make()
    server.make(upstream=[0])
    server.make(upstream=[0])
    server.make(upstream=[2, 1])
    assert server.submit(3) == [0]
    assert server.report(1, 0, SUCCESS) == [2]
    assert server.report(1, 2, SUCCESS) == [1]
    assert server.report(1, 1, SUCCESS) == [3]


def test_isaac_reading_22_d_a_second_submission_is_ignored() -> None:
    """It runs once."""
    server = reading("AI-22=d")
    server.add()
    assert server.submit(0) == []
    assert server.connect(1, "r") == [0]
    assert server.report(1, 0, SUCCESS) + server.submit(0) == []


def test_isaac_reading_24_b_a_timeout_of_zero_is_none() -> None:
    """Neither clock ever comes."""
    server = reading("AI-24=b")
    server.add(start_timeout=0, timeout=0)
    assert server.connect(1, "r") == [0]
    server.wait(1e6)
    server.report(1, 0, RUNNING)
    server.wait(1e6)
    assert server.statuses() == ["RUNNING"]


def test_isaac_reading_24_a_a_run_timeout_of_zero_ends_at_the_acknowledgement() -> None:
    """RUNNING is the end, SUCCESS at once is not too late."""
    server = reading()
    server.connect(1, "r")
    server.add(timeout=0)
    server.report(1, 0, RUNNING)
    server.add(timeout=0)
    server.report(1, 1, SUCCESS)
    assert server.statuses() == ["FAILED_TIMEDOUT", "SUCCESS"]


@pytest.mark.parametrize(("entry", "kind"), [("AI-26=f", "syntax"), ("AI-38=d", "type")])
def test_isaac_reading_26_f_and_38_d_a_bad_line_ends_the_connection(entry: str, kind: str) -> None:
    """The kind of line that the reading is about closes; the other kind does not."""
    server = reading(entry)
    server.connect(1, "r")
    server.add()
    other = "shape" if kind == "type" else "type"
    server.core.received(1, WireError(1, 0, "", "other", other), 0.0)  # type: ignore[arg-type]
    assert server.statuses() == ["STARTED"]
    effects = server.core.received(1, WireError(2, 0, "", "bad", kind), 0.0)  # type: ignore[arg-type]
    assert effects[0] == Close(1, "line 2, byte 0: bad")
    assert server.statuses() == ["FAILED_DISCONNECTED"]


def test_isaac_reading_31_a_running_that_stops_is_a_loss() -> None:
    """Silence is counted from the last RUNNING."""
    server = reading("AI-31=a", silence_timeout=3)
    server.connect(1, "r")
    server.add()
    server.report(1, 0, RUNNING)
    for _ in range(10):
        server.wait(2.5)
        server.report(1, 0, RUNNING)
    server.wait(2.9)
    assert server.statuses() == ["RUNNING"]
    server.wait(0.1)
    assert server.statuses() == ["FAILED_TIMEDOUT"]


def test_isaac_reading_36_b_cancellation_waits_for_all_upstreams() -> None:
    """The mission is cancelled when the last upstream has ended, not when the first has failed."""
    server = reading("AI-36=b")
    server.connect(1, "r")
    server.connect(2, "s")
    server.add("r")
    server.add("s")
    server.add("r", [0, 1])
    server.report(1, 0, FAILURE)
    server.add("r", [0, 1])
    assert server.statuses() == ["FAILED", "STARTED", "QUEUED", "QUEUED"]
    assert server.report(2, 1, SUCCESS) == []
    assert server.statuses() == ["FAILED", "SUCCESS", "FAILED_UPSTREAM", "FAILED_UPSTREAM"]


@pytest.mark.parametrize(
    ("letter", "same"), [("a", {"carter"}), ("b", {"carter", " carter "}), ("c", {"carter", "CARTER"})]
)
def test_isaac_reading_37_when_names_are_the_same(letter: str, same: set[str]) -> None:
    """Exact, trimmed, or in any case."""
    found = set()
    for name in ("carter", " carter ", "CARTER"):
        server = reading(f"AI-37={letter}")
        server.add("carter")
        if server.connect(1, name):
            found.add(name)
    assert found == same


def test_isaac_reading_39_scheduling_in_passes() -> None:
    """With a period, missions are sent at its multiples and at no other time."""
    server = reading(scheduling_period=1.0)
    server.add()
    server.wait(0.25)
    assert server.connect(1, "r") == []
    assert server.wait(0.5) == []
    assert server.wait(0.25) == [0]
    assert server.report(1, 0, SUCCESS) == []
    server.add()
    assert server.core.next_deadline() == 2.0
    assert server.wait(1.0) == [1]


def test_isaac_as_shipped_deviations() -> None:
    """The status channel follows the channel, timeouts are whole seconds under a day, a STARTED upstream fails."""
    server = Driver(AS_SHIPPED)
    server.connect(1, "r")
    server.add(channel="m", start_timeout=1.5)
    assert server.wait(1.0) == [0]
    server.add(upstream=[0])
    assert server.statuses() == ["STARTED", "QUEUED"]
    server.wait(1.9)
    server.hear(1, says_status(0, RUNNING, "m_status"))
    assert server.statuses() == ["RUNNING", "QUEUED"]
    server.hear(1, says_status(0, SUCCESS, "m_status"))
    server.wait(0.1)
    assert server.statuses() == ["SUCCESS", "FAILED_UPSTREAM"]
    server.add(start_timeout=86_399.0)
    server.add(start_timeout=1.5)
    assert server.wait(1) == [2]
    server.wait(10 * 86_400)
    assert server.statuses()[2:] == ["STARTED", "QUEUED"]
    server.report(1, 2, SUCCESS)
    assert server.wait(1) == [3]
    server.wait(1.9)
    assert server.statuses()[3] == "STARTED"
    server.wait(0.1)
    assert server.statuses()[3] == "FAILED_TIMEDOUT"


def test_isaac_as_shipped_what_waits_for_a_pass() -> None:
    """What waits for a pass is given up, run again and forgotten like everything else."""
    server = Driver(AS_SHIPPED)
    server.connect(1, "r")
    server.add()
    server.add(upstream=[0])
    server.wait(1)
    server.report(1, 0, FAILURE)
    assert server.core.cancel(uuid(0), server.now) == Refused(f"mission {uuid(0)} has ended: FAILED")
    server.wait(1)
    assert server.statuses() == ["FAILED", "FAILED_UPSTREAM"]
    assert not isinstance(server.core.retry(uuid(0), uuid(9), server.now), Refused)
    assert server.wait(1) == [9]
    server.report(1, 9, SUCCESS)
    assert server.wait(1) == [1]
    server.drop(1)
    assert server.statuses() == ["SUCCESS", "STARTED"]
    server.wait(1)
    assert server.statuses() == ["SUCCESS", "FAILED_DISCONNECTED"]
    assert server.core.forget(uuid(1)) is None
    assert server.core.unfinished == 0


@st.composite
def profiles(draw: st.DrawFn) -> Profile:
    letters = {field.name: field.metadata.get("letters") for field in attrs.fields(Profile)}
    choice = {name: draw(st.sampled_from(options)) for name, options in letters.items() if options}
    return Profile(**choice, scheduling_period=draw(st.sampled_from([0.0, 0.75])))


@given(profiles(), st.data())
def test_isaac_invariants_hold_under_every_profile(  # noqa: PLR0915 - one walk through all events
    profile: Profile, data: st.DataObject
) -> None:
    """Whatever the readings and the events: nothing is sent before its upstreams have succeeded, nor twice save by
    AI-15 b, a status never goes back save by AI-15 b and AI-09, the count of unfinished missions is right, cutting
    virtual time into pieces changes nothing.
    """
    whole, pieces = Driver(profile), Driver(profile)
    robots = [*("r", "s", "t")[: data.draw(st.integers(1, 3))]]
    sent: list[int] = []
    upstream_of: list[list[int]] = []
    order = ["CREATED", "QUEUED", "STARTED", "RUNNING"]
    connections: list[int] = []
    succeeded: set[int] = set()
    for _ in range(data.draw(st.integers(1, 25))):
        event = data.draw(st.sampled_from(["add", "add", "connect", "name", "drop", "report", "report", "wait"]))
        before = whole.statuses()
        new: list[int] = []
        if event == "add":
            settings = {
                "start_timeout": data.draw(st.sampled_from([0.0, 1.0, 5.0])),
                "timeout": data.draw(st.sampled_from([0.0, 2.0, float("inf")])),
                "channel": data.draw(st.sampled_from(["x", "y"])),
            }
            upstream = data.draw(st.lists(st.integers(0, max(whole.made - 1, 0)), max_size=2 if whole.made else 0))
            robot = data.draw(st.sampled_from(robots))
            upstream_of.append(upstream)
            new = whole.add(robot, upstream, **settings)
            assert pieces.add(robot, upstream, **settings) == new
        elif event == "connect":
            connections.append(len(connections))
            new = whole.connect(connections[-1])
            assert pieces.connect(connections[-1]) == new
        elif event == "wait":
            new = whole.wait(2.25)
            assert [one for _ in range(3) for one in pieces.wait(0.75)] == new
        elif connections:
            connection = data.draw(st.sampled_from(connections))
            if event == "drop":
                new = whole.drop(connection)
                assert pieces.drop(connection) == new
            elif event == "name":
                name = says_name(data.draw(st.sampled_from(robots)))
                new = whole.hear(connection, name)
                assert pieces.hear(connection, name) == new
            else:
                about = data.draw(st.none() | st.integers(0, whole.made))
                status = says_status(about, data.draw(st.sampled_from([RUNNING, SUCCESS, FAILURE])))
                new = whole.hear(connection, status)
                assert pieces.hear(connection, status) == new
        sent += new
        succeeded |= {mission for mission, status in whole.changes() if status == "SUCCESS"}
        assert all(set(upstream_of[mission]) <= succeeded for mission in new)
        after = whole.statuses()
        assert after == pieces.statuses()
        for old, now in zip(before, after, strict=False):
            if profile.ai_15 != "b" and now in order:
                assert old in order
                assert order.index(old) <= order.index(now)
            if profile.ai_09 == "a" and old not in order:
                assert old == now
    if profile.ai_15 != "b":
        assert len(sent) == len(set(sent))
    assert whole.core.unfinished == sum(status in order for status in whole.statuses())
