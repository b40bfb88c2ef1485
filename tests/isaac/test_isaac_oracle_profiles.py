"""What the oracle takes for right under each profile, side by side on the same inputs."""

from __future__ import annotations

from typing import Any

import attrs
import pytest
from commandline import CommandLine
from server_history import SERVER, History

from missionfsm.adapters.isaac.subjects import ServerSubject
from missionfsm.isaac.runtime.profile import DOCUMENTED
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import Header, Message, MissionProto, MissionStatusProto, Uuid, WireStatus
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Subject
from missionfsm.systems import names, system
from missionfsm.tools.check.narrate import story
from missionfsm.tools.check.verdict import Outcome
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.reference.subject import ReferenceSubject


def right(begun: History, seconds: float, *ends: tuple[str, ...]) -> dict[str, list[tuple[str, ...]]]:
    """For each profile: which of some statuses may be shown when so much time has passed."""
    found: dict[str, list[tuple[str, ...]]] = {}
    for profile, readings in SERVER.profiles.items():
        # How a header is written is another matter: the same lines are shown to both.
        chosen = {**readings, "AI-06": "a", "AI-07": "a", "AI-08": "a", "AI-10": "a", "AI-31": "b", "AI-25.header": "s"}
        for statuses in ends:
            history = History()
            history.lines, history.calls = list(begun.lines), begun.calls
            judged = history.waits(seconds).settles.shows(*statuses).judged(readings=chosen)
            found.setdefault(profile, [])
            if judged.conforms:
                found[profile].append(statuses)
    return found


def sent(seconds: float = 1.2, **mission: object) -> History:
    """A mission that was sent in so much time and not acknowledged."""
    return History().submit(1, **mission).robot(1).waits(seconds).sends(1, 1).settles


STARTED, RUNNING, LOST, ABORTED = ("STARTED",), ("RUNNING",), ("FAILED_DISCONNECTED",), ("FAILED_TIMEDOUT",)


@pytest.mark.parametrize(
    ("seconds", "documented", "shipped"),
    [
        (3.7, [STARTED], [STARTED]),
        (4.6, [STARTED, ABORTED], [STARTED]),
        (6.2, [ABORTED], [STARTED, ABORTED]),
        (8.1, [ABORTED], [ABORTED]),
    ],
)
def test_a_start_timeout_of_5_s(seconds: float, documented: object, shipped: object) -> None:
    """As documented it aborts once 5 s have passed; as shipped once 6 whole seconds have, and a pass has come."""
    assert right(sent(), seconds, STARTED, ABORTED) == {"documented": documented, "as-shipped": shipped}


def test_a_start_timeout_of_0() -> None:
    """As shipped the mission is sent, and aborted a second and a pass later; as documented it may be aborted unsent."""
    assert right(sent(0.9, start_timeout=0), 0.05, STARTED, ABORTED)["as-shipped"] == [STARTED]
    assert right(sent(0.9, start_timeout=0), 3.3, STARTED, ABORTED)["as-shipped"] == [ABORTED]
    unsent = History().submit(1, start_timeout=0).robot(1)
    assert right(unsent, 3, ("QUEUED",), ABORTED) == {"documented": [ABORTED], "as-shipped": []}


def test_a_timeout_of_more_than_a_day() -> None:
    """As shipped it never comes, since whole seconds are counted within a day."""
    begun = sent(timeout=90_000).reports(1, 1, "running").settles
    assert right(begun, 90_100, RUNNING, ABORTED) == {"documented": [ABORTED], "as-shipped": [RUNNING]}


@pytest.mark.parametrize(("seconds", "documented", "shipped"), [(0.5, [LOST], [STARTED, LOST]), (1.5, [LOST], [LOST])])
def test_a_connection_that_drops(seconds: float, documented: object, shipped: object) -> None:
    """As shipped the next pass notices; as documented (AI-15 c) the mission has failed at once."""
    begun = sent().drive("disconnect", connection=1).settles
    found = right(begun, seconds, STARTED, LOST)
    assert found["as-shipped"] == shipped
    assert set(documented) <= set(found["documented"])  # type: ignore[call-overload]


def test_a_downstream_whose_robot_is_away() -> None:
    """As shipped it stays QUEUED until its robot is there and idle; as documented it is cancelled."""
    begun = History().submit(1).submit(2, robot="s", upstream=[1]).robot(1).waits(1.2).sends(1, 1)
    begun = begun.reports(1, 1, "failure").settles
    queued, canceled = ("FAILED", "QUEUED"), ("FAILED", "FAILED_UPSTREAM")
    assert right(begun, 60, queued, canceled)["as-shipped"] == [queued]
    assert canceled in right(begun, 60, queued, canceled)["documented"]
    begun.robot(2, "s")
    assert right(begun, 2.2, queued, canceled)["as-shipped"] == [canceled]


def test_the_connection_that_said_the_name_later_is_served() -> None:
    """As shipped the later name counts, and what goes on on the older connection loses its timeouts."""
    begun = History().submit(1, timeout=3).submit(2).drive("connect", connection=1).robot(2).waits(1.2).sends(2, 1)
    begun.reports(2, 1, "running").says(1).waits(1.2)
    begun = begun.sends(1, 2).settles
    assert right(begun, 30, ("RUNNING", "FAILED_TIMEDOUT"))["as-shipped"] == [("RUNNING", "FAILED_TIMEDOUT")]


def test_a_pass_may_do_several_things() -> None:
    """As shipped one pass may time a mission out and cancel all that waits for it in an idle robot's queue."""
    begun = sent(1.3, start_timeout=3).submit(2, robot="s", upstream=[1]).submit(3, robot="s", upstream=[2])
    begun = begun.robot(2, "s").settles.waits(1.3).settles
    ends = [("FAILED_TIMEDOUT", *rest) for rest in (("QUEUED", "QUEUED"), ("FAILED_UPSTREAM", "FAILED_UPSTREAM"))]
    assert right(begun, 4, *ends)["as-shipped"] == ends


def test_a_cancellation_that_the_next_pass_notices() -> None:
    """It need not come at once, whoever is there, but within a second of time that passes (AI-03.when q)."""
    begun = History().submit(1).submit(2, robot="s", upstream=[1]).robot(1).waits(1).sends(1, 1).settles
    begun = begun.reports(1, 1, "failure").settles.shows("FAILED", "QUEUED")
    queued, canceled = ("FAILED", "QUEUED"), ("FAILED", "FAILED_UPSTREAM")
    assert right(begun, 0.9, queued, canceled)["documented"] == [queued, canceled]
    assert right(begun, 1.1, queued, canceled)["documented"] == [canceled]


def test_a_pass_may_time_out_and_cancel_whenever_it_is_looked() -> None:
    """What a pass has timed out it may cancel the downstreams of (AI-03.when q), also if it came before all settled."""
    begun = History().submit(1, start_timeout=3).submit(2, robot="s", upstream=[1]).robot(1).settles
    begun = (
        begun.waits(1.3)
        .sends(1, 1)
        .waits(1.3)
        .waits(1.3)
        .waits(1.3)
        .settles.shows("FAILED_TIMEDOUT", "FAILED_UPSTREAM")
    )
    readings = {**SERVER.profiles["documented"], "AI-03.when": "q", "AI-39": "b"}
    assert begun.judged(readings=readings).conforms


def test_a_drop_is_noticed_in_no_time_by_nobody() -> None:
    """As shipped a pass notices a drop, and none comes while no time passes."""
    begun = sent().drive("disconnect", connection=1).settles
    assert right(begun, 0.001, STARTED, LOST)["as-shipped"] == [STARTED, LOST]
    chosen = {**SERVER.profiles["as-shipped"], "AI-25.header": "s"}
    assert not begun.shows("FAILED_DISCONNECTED").judged(readings=chosen).conforms


def test_a_take_over_that_no_pass_noticed() -> None:
    """The newer connection is gone before a pass comes: the mission may keep its timeouts or lose them."""
    begun = sent(start_timeout=2).drive("connect", connection=2).says(2).drive("disconnect", connection=2).settles
    assert right(begun, 6, STARTED, ABORTED)["as-shipped"] == [STARTED, ABORTED]
    noticed = sent(start_timeout=2).drive("connect", connection=2).says(2).waits(1.1)
    noticed = noticed.drive("disconnect", connection=2).settles
    assert right(noticed, 6, STARTED, ABORTED)["as-shipped"] == [STARTED]


def test_the_known_fault_is_named_with_the_upstream_rule() -> None:
    """A downstream fails whose upstream was STARTED when it was made: as shipped; as documented in a short story."""
    for late in (False, True):
        begun = History().submit(1).robot(1).waits(1).sends(1, 1).submit(2, upstream=[1]).settles
        begun.reports(1, 1, "success")
        begun = begun.waits(1) if late else begun
        begun.settles.shows("SUCCESS", "FAILED_UPSTREAM")
        verdict = begun.judged(readings=SERVER.profiles["documented"])
        assert verdict.violation is not None
        broken = (
            "a-mission-waits-for-its-upstreams" if late else "a-failed-upstream-cancels"
        )  # it should be sent by then
        assert f"isaac.server/dependencies/{broken}" in [one.id for one in verdict.violation.rules]


@pytest.mark.parametrize(
    "late",
    [{}, pytest.param({"ai_03_when": "q", "scheduling_period": 1.0}, marks=pytest.mark.long)],
    ids=["at once", "in a pass"],
)
def test_the_known_fault_is_found_in_a_short_story(late: dict[str, Any]) -> None:
    """The tester finds it under documented and names the upstream's rule, whenever the cancellation comes."""
    faulty = ServerSubject(attrs.evolve(DOCUMENTED, started_upstream_fails=True, **late))
    readings = SERVER.profiles["documented"]
    verdict = conform(SERVER, faulty, plan=Plan(0, 0, 40, 20), seed=1, advice=False, readings=readings)
    assert verdict.violation is not None
    assert verdict.violation.rules[0].id == "isaac.server/dependencies/a-failed-upstream-cancels"
    assert len(verdict.story.splitlines()) == 6


def test_time_that_passes_stands_before_what_comes_next() -> None:
    """A story has no line of its own for it, but where time passes twice, or all has settled then, or nothing comes."""
    begun = History().submit(1).robot(1).waits(0.5).waits(1).sends(1, 1).waits(2).settles.shows("STARTED").waits(3)
    assert story(SERVER, ({"missionfsm": 1, "system": "isaac.server", "world": {}}, *begun.lines)).splitlines() == [
        "  1. submit(robot r, channel mission) → OK mission 1",
        "  2. a robot connects",
        "  3. a robot says its name, 'r'",
        "  4. 0.5 s pass",
        "  5. 1 s later, connection 1 showed a mission on mission with {} (uuid no. 1)",
        "  6. 2 s pass",
        "  7. (settled)",
        "  8. statuses() → OK ('started',) mission 1",
        "  9. 3 s pass",
    ]


class AtOnce:
    """A subject that tells everything that a request causes before it answers it."""

    def __init__(self, inner: Subject) -> None:
        self.inner = inner

    def exchange(self, method: str, params: JSON) -> Exchange:
        found = self.inner.exchange(method, params)
        return attrs.evolve(found, before=(*found.before, *found.after), after=())

    def close(self) -> None:
        self.inner.close()


def test_what_a_drop_causes_on_other_connections_may_come_before_its_answer() -> None:
    """The robot whose older connection drops is free with that, and is sent the next mission on the newer one."""
    server = AtOnce(ReferenceSubject(SERVER, {"AI-16.under-way": "k"}))
    verdict = conform(SERVER, server, plan=Plan(0, 0, 40, 0), seed=1, advice=False)
    assert verdict.conforms, str(verdict)


def test_a_name_that_is_said_again_may_do_nothing_and_yet_count_when_the_other_drops() -> None:
    """The connection named later is the robot, though the other says its name again; once it drops, the other is."""
    begun = History().drive("connect", connection=1).robot(2).says(1).says(2).submit(1).sends(1, 1).settles
    verdict = begun.reports(1, 1, "success").drive("disconnect", connection=1).submit(2).sends(2, 2).settles.judged()
    assert verdict.conforms, str(verdict)
    assert "n" in verdict.readings["AI-16"]
    apart = begun.judged(readings={"AI-16": "n"})
    assert [apart.readings[name] for name in ("AI-16.back", "AI-16.again")] == [("p",), ("t",)]


@pytest.mark.parametrize("heir", [1, 2])
def test_of_several_connections_with_a_name_any_may_be_the_next_robot(heir: int) -> None:
    """Three said the name, and the last of them drops: the newest of the others may be it, or the next to last."""
    begun = History().drive("connect", connection=1).robot(2).says(1).robot(3)
    known = {"AI-16": "n", "AI-16.back": "p", "AI-39": "a"}
    verdict = begun.drive("disconnect", connection=3).settles.submit(1).sends(heir, 1).settles.judged(readings=known)
    assert verdict.conforms, str(verdict)


@pytest.mark.parametrize(("back", "served"), [("q", True), ("s", False)])
def test_a_connection_that_another_took_over_keeps_its_name_or_has_none(back: str, *, served: bool) -> None:
    """Another name that it says then is its first (q), or a second one that does nothing (s, AI-17 a)."""
    known = {"AI-16": "n", "AI-16.back": back, "AI-17": "a", "AI-39": "a"}
    for sent in (True, False):
        begun = History().robot(1).robot(2).says(1, "other").submit(1, robot="other")
        verdict = (begun.sends(1, 1) if sent else begun).settles.judged(readings=known)
        assert (verdict.outcome is not Outcome.VIOLATES) is (sent is served), str(verdict)


def test_two_connections_of_a_robot_may_share_its_missions() -> None:
    """AI-16 s: pointed out; each mission is sent once all the same, and the one that drops leaves the other."""
    begun = History().robot(1).robot(2).submit(1).sends(1, 1).submit(2).sends(2, 2).settles
    verdict = begun.drive("disconnect", connection=1).submit(3).settles.judged(readings={"AI-39": "a", "AI-15": "c"})
    assert verdict.outcome is not Outcome.VIOLATES, str(verdict)
    assert "AI-16=s" in [one.partition(" ")[0] for one in verdict.flagged]
    twice = History().robot(1).robot(2).submit(1).sends(1, 1).sends(2, 1).settles
    assert twice.judged().outcome is Outcome.VIOLATES


def test_a_mission_may_have_timed_out_before_its_robot_is_there() -> None:
    """A start_timeout of 0 that counts from submission has elapsed: the robot that comes is sent nothing."""
    begun = History().submit(1, start_timeout=0).settles.robot(1).settles
    verdict = begun.judged(readings={"AI-05": "b", "AI-39": "a"})
    assert verdict.conforms, str(verdict)


def test_a_mission_may_be_cancelled_once_it_heads_an_idle_robots_queue() -> None:
    """At once, without a pass: while the robot is busy its doomed missions wait; they go before the next is sent."""
    begun = History().submit(1).submit(2, upstream=[1]).submit(3).robot(1).sends(1, 1).settles
    begun = begun.reports(1, 1, "failure").sends(1, 3).settles.submit(4, upstream=[1]).settles
    begun = begun.shows("FAILED", "FAILED_UPSTREAM", "STARTED", "QUEUED").waits(2).settles
    begun = begun.shows("FAILED", "FAILED_UPSTREAM", "STARTED", "QUEUED").reports(1, 3, "success").settles
    verdict = begun.shows("FAILED", "FAILED_UPSTREAM", "SUCCESS", "FAILED_UPSTREAM").judged()
    assert (verdict.conforms, verdict.readings["AI-03.when"]) == (True, ("h",)), str(verdict)
    assert [one.partition(" ")[0] for one in verdict.flagged] == ["AI-03.when=h"]


@pytest.mark.parametrize(("again", "served"), [("t", 2), ("u", 1)])
def test_what_a_name_that_is_said_again_does_is_a_question_of_its_own(again: str, served: int) -> None:
    """Under every reading of what follows a drop, saying it again does nothing, or what it did at first."""
    for back in "pqrs":
        known = {"AI-16": "n", "AI-16.back": back, "AI-16.again": again, "AI-39": "a"}
        begun = History().robot(1).robot(2).says(1).submit(1)
        assert begun.sends(served, 1).settles.judged(readings=known).conforms, back
        other = History().robot(1).robot(2).says(1).submit(1).sends(3 - served, 1).judged(readings=known)
        assert other.outcome is Outcome.VIOLATES, back


def _aborted(status: str | None = None, *, named: int = 1) -> History:
    """A mission of two was aborted; the robot may have said since how the first ended, or something like it."""
    begun = History().submit(1, start_timeout=1).submit(2, config={"a": 1}).robot(1).sends(1, 1).settles
    begun = begun.waits(1.5).settles.shows("FAILED_TIMEDOUT", "QUEUED")
    return begun if status is None else begun.reports(1, named, status)


def test_a_robot_may_be_busy_with_an_aborted_mission_until_it_says_how_that_ended() -> None:
    """It is sent nothing after the abort, and the next once it has reported FAILURE of the old one: this is flagged."""
    verdict = _aborted("failure").sends(1, 2, '{"a":1}').settles.shows("FAILED_TIMEDOUT", "STARTED").judged()
    assert (verdict.outcome, verdict.readings["AI-08"]) == (Outcome.CONFORMS, ("d",))
    assert [one.partition(" ")[0] for one in verdict.flagged] == ["AI-08=d"]


@pytest.mark.parametrize("heard", [False, True])
def test_a_robot_may_be_busy_with_an_aborted_mission_that_it_has_begun(*, heard: bool) -> None:
    """AI-08 e: of one that it never spoke of the server waits for nothing; this is flagged."""
    known = {"AI-08": "e", "AI-10": "a", "AI-39": "a", "AI-06": "a", "AI-07": "a", "AI-31": "b"}
    begun = History().submit(1, start_timeout=1, timeout=3).submit(2, config={"a": 1}).robot(1).sends(1, 1).settles
    begun = (begun.reports(1, 1, "running") if heard else begun).waits(4).settles
    assert (begun.judged(readings=known).outcome is not Outcome.VIOLATES) is heard
    verdict = begun.reports(1, 1, "failure").sends(1, 2, '{"a":1}').settles.judged(readings=known)
    assert (verdict.outcome is not Outcome.VIOLATES) is heard, str(verdict)


@pytest.mark.parametrize("freed", ["success", "failure", "drop"])
def test_a_robot_that_said_how_its_aborted_mission_ended_is_sent_the_next(freed: str) -> None:
    """Nothing but RUNNING keeps it busy: after a final status, or after it has come back, the next mission is due."""
    known = {"AI-08": "d", "AI-10": "a", "AI-39": "a"}
    begun = _aborted().drive("disconnect", connection=1).robot(2) if freed == "drop" else _aborted(freed)
    assert begun.settles.judged(readings=known).outcome is Outcome.VIOLATES
    still = _aborted("running").settles
    assert still.judged(readings=known).conforms
    assert still.judged(readings={**known, "AI-08": "a"}).outcome is Outcome.VIOLATES


def test_a_line_may_be_seen_after_the_drop_that_it_was_sent_before() -> None:
    """The mission was sent, and is shown only when everything settles; after that nothing comes on the connection."""
    begun = History().submit(1).robot(1).drive("disconnect", connection=1)
    assert begun.sends(1, 1).settles.shows("FAILED_DISCONNECTED").judged().conforms
    late = History().submit(1).robot(1).drive("disconnect", connection=1).settles.sends(1, 1)
    late = late.judged(readings={"AI-39": "a"})
    assert late.outcome is Outcome.VIOLATES
    unseen = History().submit(1).robot(1).drive("disconnect", connection=1).settles.shows("FAILED_DISCONNECTED")
    assert unseen.judged().conforms


def test_after_the_server_has_ended_a_connection_nothing_is_seen_on_it() -> None:
    """A mission may be seen after the line that cannot be read and before the end, and not after the end."""
    begun = History().submit(1).robot(1).drive("line", connection=1, line="{")
    assert begun.sends(1, 1).closes(1).settles.judged().conforms
    late = History().submit(1).robot(1).drive("line", connection=1, line="{").closes(1).sends(1, 1)
    assert late.judged().outcome is Outcome.VIOLATES


def test_what_a_mission_is_called_that_waits_for_its_robot_or_for_an_acknowledgement() -> None:
    """CREATED while its robot is not there, QUEUED until it is acknowledged: both are taken, the second is flagged."""
    begun = History().submit(1).settles.shows("CREATED").robot(1).sends(1, 1).settles.shows("QUEUED")
    verdict = begun.reports(1, 1, "running").settles.shows("RUNNING").judged(readings={"AI-04.new": "a"})
    found = [verdict.readings[name] for name in ("AI-04.robot", "AI-04.sent")]
    assert (verdict.conforms, found) == (True, [("r",), ("t",)]), str(verdict)
    assert [one.partition(" ")[0] for one in verdict.flagged] == ["AI-04.sent=t"]
    back = (
        History()
        .submit(1)
        .robot(1)
        .submit(2)
        .sends(1, 1)
        .settles.shows("STARTED", "CREATED")
        .judged(readings={"AI-04.new": "a"})
    )
    assert back.outcome is Outcome.VIOLATES


def _line(uuid: int | None, own: int, config: str = "{}") -> dict[str, object]:
    """A MissionProto of some mission or of none, in a message with a uuid of its own."""
    payload = MissionProto(None if uuid is None else Uuid(uuid, 1), config)
    line = encode(Message(Header("mission", 1, 1, Uuid(own, 1)), payload)).decode().strip()
    return {"connection": 1, "line": line}


@pytest.mark.parametrize(
    ("first", "second", "flagged"),
    [
        ((1, 11), (2, 12), []),
        ((1, 11), (2, 11), ["AI-27.uuid=b"]),
        ((1, 1), (2, 2), ["AI-27.uuid=b"]),
        ((None, 11), (None, 12), ["AI-28.uuid=n"]),
    ],
)
def test_identifiers_that_the_wire_has_and_the_page_does_not_show(
    first: tuple[int | None, int], second: tuple[int | None, int], flagged: list[str]
) -> None:
    """A header's uuid that is the mission's, or the same for two messages, is flagged; so is a mission without one."""
    history = History().submit(1).submit(2, config={"a": 1}).robot(1)
    history.lines.append(_line(*first))
    line = encode(Message(Header("mission_status"), MissionStatusProto(None, WireStatus.SUCCESS))).decode().strip()
    history = history.settles.drive("line", connection=1, line=line)
    history.lines.append(_line(*second, '{"a":1}'))
    verdict = history.settles.shows("SUCCESS", "STARTED").judged()
    assert verdict.conforms, str(verdict)
    assert [one.partition(" ")[0] for one in verdict.flagged] == flagged


def test_a_pass_may_send_on_a_connection_that_another_took_over_from_before_it_dropped() -> None:
    """As shipped, of a server that sends first: it has noticed neither the other name nor the drop."""
    begun = History().submit(1).robot(1).settles.waits(1.3).settles.robot(2).drive("disconnect", connection=1)
    begun = begun.settles.shows("QUEUED").waits(1.3).sends(1, 1).settles.shows("FAILED_DISCONNECTED")
    chosen = {**SERVER.profiles["as-shipped"], "AI-25.header": "s", "AI-39.order": "s"}
    verdict = begun.judged(readings=chosen)
    assert verdict.conforms, str(verdict)


def test_who_comes_after_a_connection_that_an_abort_ends() -> None:
    """Another that has said the same name is sent the next mission, and loses its connection in the same way."""
    begun, known = History().robot(1).robot(2).submit(1).submit(2), {"AI-39.aborted": "a", "AI-39.limits": "a"}
    shown = begun.sends(2, 1).settles.waits(60).closes(2).sends(1, 2).closes(1).settles
    verdict = shown.judged(readings=known)
    assert (verdict.conforms, verdict.readings["AI-08"]) == (True, ("c",)), str(verdict)


def test_what_a_drop_does_may_depend_on_whether_the_mission_was_acknowledged() -> None:
    """What was only sent is queued again, what was acknowledged has failed: two questions, and neither is flagged."""
    begun = History().submit(1).submit(2).robot(1).sends(1, 1).drive("disconnect", connection=1).settles
    begun = begun.shows("QUEUED", "QUEUED").robot(2).sends(2, 1).reports(2, 1, "running").settles
    begun = begun.drive("disconnect", connection=2).settles.shows("FAILED_DISCONNECTED", "QUEUED")
    verdict = begun.judged()
    found = [verdict.readings[name] for name in ("AI-15.sent", "AI-15")]
    assert (verdict.conforms, found, verdict.flagged) == (True, [("b",), ("c",)], ()), str(verdict)


def test_the_connection_that_another_took_over_from_may_be_closed() -> None:
    """What was sent on it is lost then, as if it had dropped, and what is queued goes to the other."""
    begun = History().submit(1).submit(2).robot(1).sends(1, 1).settles.robot(2).closes(1).sends(2, 2).settles
    verdict = begun.shows("FAILED_DISCONNECTED", "STARTED").judged()
    assert (verdict.conforms, verdict.readings["AI-16.older"]) == (True, ("w",)), str(verdict)
    kept = History().robot(1).robot(2).closes(1).judged(readings={"AI-16.older": "v", "AI-29": "d"})
    assert kept.outcome is Outcome.VIOLATES


def test_profiles_of_systems() -> None:
    """Isaac's systems have two; a profile is overruled by what is asked for besides, and another one is refused."""
    assert {name: list(system(name).profiles) for name in names()} == {
        "bear.mission": [],
        "bear.status": [],
        "isaac.server": ["documented", "as-shipped"],
        "isaac.robot": ["documented", "as-shipped"],
    }
    assert SERVER.chosen("as-shipped", {"AI-39": "a"})["AI-39"] == "a"
    with pytest.raises(ValueError, match=r"^isaac.server has no profile shipped; there are documented, as-shipped$"):
        SERVER.chosen("shipped", {})


def test_a_profile_on_the_command_line(command_line: CommandLine) -> None:
    """Explore and adapter take a profile; a system that has none says so in one line."""
    ended = command_line("explore", "bear.mission", "--profile", "as-shipped")
    assert (ended.status, ended.err) == (
        2,
        "missionfsm: --profile: bear.mission has no profile as-shipped; there are none\n",
    )
