"""What servers of others do where the page is silent: each is accepted, and known by what it shows."""

from __future__ import annotations

import orjson
import pytest
from server_history import History

from missionfsm.isaac.server.losing import lost
from missionfsm.isaac.server.state import Link, Mission, Move, Server, Status
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto, TextProto, Uuid, WireStatus
from missionfsm.tools.check.verdict import Verdict

EXACT = {
    "AI-05": "a",
    "AI-06": "a",
    "AI-07": "a",
    "AI-10": "a",
    "AI-24.whole": "x",
    "AI-29": "d",
    "AI-39": "a",
    "AI-39.failed": "ab",
    "AI-39.limits": "ab",
}
"""Readings without which less can be told from a short history."""


def follows(verdict: Verdict, **readings: str) -> bool:
    """Whether a history conforms and tells these readings, written AI_02_aborted for AI-02.aborted."""
    told = {name.replace("_", "-", 1).replace("_", ".", 1).replace("_", "-"): one for name, one in readings.items()}
    return verdict.conforms and {name: "".join(verdict.readings[name]) for name in told} == told


def sent(**mission: object) -> History:
    """A mission that was sent at once."""
    return History().submit(1, **mission).robot(1).sends(1, 1).settles


def test_a_status_may_be_heard_from_anybody() -> None:
    """AI-10.from: of a mission that it names, on another robot's connection or on one without a name."""
    from_another = sent().robot(2, "s").reports(2, 1, "success").settles
    assert follows(from_another.shows("SUCCESS").judged(readings=EXACT), AI_10_from="w")
    from_nobody = sent().drive("connect", connection=2).reports(2, 1, "success").settles
    assert follows(from_nobody.shows("SUCCESS").judged(readings=EXACT), AI_10_from="w")
    unheard = sent().robot(2, "s").reports(2, 1, "success").settles
    assert follows(unheard.shows("STARTED").judged(readings=EXACT), AI_10_from="rn")
    about_nothing = sent().robot(2, "s").submit(2, robot="s").reports(2, 9, "success")
    assert not about_nothing.settles.shows("STARTED", "SUCCESS").judged().conforms


def named_twice(**mission: object) -> History:
    """A mission that was sent, a second connection that said the name of its robot, and another mission for that."""
    return sent(**mission).robot(2).submit(2)


def reports_nameless(history: History, connection: int, status: str) -> History:
    """A status that does not say of which mission it is."""
    message = Message(Header("mission_status"), MissionStatusProto(None, WireStatus(status)))
    return history.drive("line", connection=connection, line=encode(message).decode().strip())


@pytest.mark.parametrize(("robot", "given"), [("b", 1), ("n", 2)])
def test_a_status_may_be_heard_on_each_connection_of_its_robot(robot: str, given: int) -> None:
    """AI-10.from n: though the robot's missions go to another; but not of somebody else."""
    known = {**EXACT, "AI-16": robot, "AI-16.under-way": "k", "AI-16.back": "p"}
    heard = named_twice(start_timeout=50).reports(2, 1, "failure").sends(given, 2).settles.shows("FAILED", "STARTED")
    assert follows(heard.judged(readings=known), AI_10_from="nw")
    assert not heard.judged(readings={**known, "AI-10.from": "r"}).conforms
    apart = heard.robot(3, "s").reports(3, 2, "success").settles.shows("FAILED", "STARTED")
    assert follows(apart.judged(readings=known), AI_10_from="n")
    unheard = named_twice(start_timeout=50).reports(2, 1, "failure").settles.shows("STARTED", "QUEUED")
    assert follows(unheard.judged(readings=known), AI_10_from="r")


def test_a_status_that_names_no_mission_may_be_heard_on_each_connection_of_its_robot() -> None:
    """AI-10.from n: it is about the robot's current one; whoever hears anybody may take it or not."""
    known = {**EXACT, "AI-16": "b", "AI-16.back": "p"}
    heard = reports_nameless(named_twice(), 2, "success").sends(1, 2).settles.shows("SUCCESS", "STARTED")
    assert follows(heard.judged(readings=known), AI_10_from="nw")
    unheard = reports_nameless(named_twice(), 2, "success").settles.shows("STARTED", "QUEUED")
    assert follows(unheard.judged(readings=known), AI_10_from="rw")
    stranger = reports_nameless(sent().robot(2, "s"), 2, "success").settles
    assert not stranger.shows("SUCCESS").judged(readings=known).conforms


def test_a_status_before_the_name_may_be_heard_where_another_connection_is_the_robot() -> None:
    """AI-10.from n, AI-18.early b: it is kept until the name is known."""
    kept = sent().drive("connect", connection=2).reports(2, 1, "success").settles.shows("STARTED").says(2).settles
    known = {**EXACT, "AI-16": "b", "AI-16.back": "p"}
    assert follows(
        kept.shows("SUCCESS").judged(readings={**known, "AI-10.from": "rn"}), AI_10_from="n", AI_18_early="b"
    )
    assert not kept.shows("SUCCESS").judged(readings={**known, "AI-18.early": "a"}).conforms


def test_a_drop_that_is_found_out_when_the_robot_is_back() -> None:
    """AI-15.when r: until then the mission stands as it stood, and the robot's next one waits."""
    begun = sent().submit(2).drive("disconnect", connection=1).waits(3).settles.shows("STARTED", "QUEUED")
    begun = begun.robot(2).sends(2, 2).settles.shows("FAILED_DISCONNECTED", "STARTED")
    assert follows(begun.judged(readings=EXACT), AI_15_when="rg", AI_15_sent="c")


def test_a_robot_may_have_time_to_come_back() -> None:
    """AI-15.when g: a mission goes on whose robot is back soon, and fails if it stays away."""
    begun = sent().drive("disconnect", connection=1).waits(3).settles.shows("STARTED")
    begun = begun.robot(2).settles.shows("STARTED").reports(2, 1, "running").settles.shows("RUNNING")
    begun = begun.drive("disconnect", connection=2).settles.shows("RUNNING").waits(11).settles
    assert follows(begun.shows("FAILED_DISCONNECTED").judged(readings={**EXACT, "AI-15.sent": "c"}), AI_15_when="g")


def test_a_mission_may_pass_to_the_newer_connection() -> None:
    """AI-16.under-way n: although a mission fails whose connection drops; the older one is not listened to."""
    begun = sent().robot(2).settles.shows("STARTED").reports(1, 1, "success").settles.shows("STARTED")
    begun = begun.reports(2, 1, "running").settles.shows("RUNNING").drive("disconnect", connection=2).settles
    verdict = begun.shows("FAILED_DISCONNECTED").judged(readings=EXACT)
    assert follows(verdict, AI_15="c")
    assert "n" in verdict.readings["AI-16.under-way"]


def test_a_mission_that_outlived_its_connection_may_stay_where_its_robot_was_back() -> None:
    """AI-16.under-way k: a newer connection takes over; it is heard there too, or only the one between is (AI-15 a)."""

    def begin() -> History:
        begun = sent(start_timeout=60).drive("disconnect", connection=1).robot(2).submit(2).robot(3).settles
        return begun.shows("STARTED", "QUEUED").reports(3, 1, "success")

    known = {**EXACT, "AI-16": "a", "AI-16.under-way": "k"}
    unheard = begin().settles.shows("STARTED", "QUEUED").reports(2, 1, "success").sends(3, 2).settles
    assert unheard.shows("SUCCESS", "STARTED").judged(readings=known).conforms
    assert begin().sends(3, 2).settles.shows("SUCCESS", "STARTED").judged(readings=known).conforms
    assert not begin().settles.shows("SUCCESS", "QUEUED").judged(readings=known).conforms


def test_a_robot_may_be_held_to_what_was_aborted_on_an_older_connection() -> None:
    """AI-08 d: the older one drops, and the robot is free, or only once it has said how that one ended."""

    def begin() -> History:
        begun = sent().submit(2).robot(2).settles.waits(5).settles.shows("FAILED_TIMEDOUT", "QUEUED")
        return begun.drive("disconnect", connection=1)

    known = {**EXACT, "AI-08": "d", "AI-16": "a", "AI-16.under-way": "k", "AI-39.limits": "a"}
    held = begin().settles.shows("FAILED_TIMEDOUT", "QUEUED")
    assert held.judged(readings=known).conforms
    assert held.reports(2, 1, "failure").sends(2, 2).settles.judged(readings=known).conforms
    assert begin().sends(2, 2).settles.shows("FAILED_TIMEDOUT", "STARTED").judged(readings=known).conforms
    assert not held.judged(readings={**known, "AI-08": "a"}).conforms


def test_another_name_may_cost_the_connection() -> None:
    """AI-17 d: like a line that cannot be read."""
    begun = sent().says(1, "s").closes(1).settles.shows("FAILED_DISCONNECTED")
    assert follows(begun.judged(readings={**EXACT, "AI-17": "ad"}), AI_17="d", AI_15_sent="c")


def test_a_mission_may_go_on_under_another_name() -> None:
    """AI-17.under-way k: although a mission fails whose connection drops."""
    begun = sent().submit(2, robot="s").says(1, "s").sends(1, 2).reports(1, 1, "running")
    begun = begun.settles.shows("RUNNING", "STARTED").drive("disconnect", connection=1).settles
    verdict = begun.shows("FAILED_DISCONNECTED", "FAILED_DISCONNECTED").judged(readings=EXACT)
    assert follows(verdict, AI_17="b", AI_17_under_way="k", AI_15="c")


@pytest.mark.parametrize("refused", [True, False])
def test_an_upstream_that_is_named_twice(*, refused: bool) -> None:
    """AI-20.repeated: it is refused, or is one upstream; that the mission waits for ever is a violation."""

    def begin() -> History:
        begun = History().submit(1).submit(2, robot="s", upstream=[1, 1], refused=refused).robot(1).sends(1, 1)
        return begun.robot(2, "s").reports(1, 1, "success")

    begun = begin() if refused else begin().sends(2, 2)
    assert refused or not begin().settles.shows("SUCCESS", "QUEUED").judged(readings=EXACT).conforms
    verdict = begun.settles.shows("SUCCESS", *(() if refused else ("STARTED",))).judged(readings=EXACT)
    assert follows(verdict, AI_20_repeated="a" if refused else "c")


def test_a_name_that_is_empty() -> None:
    """AI-37.empty: it is nothing, or it is the name for which the connection is known from then on."""
    served = History().submit(1).robot(1, "").says(1).sends(1, 1).settles.shows("STARTED")
    assert follows(served.judged(readings={**EXACT, "AI-17": "a"}), AI_37_empty="d")
    unserved = History().submit(1).robot(1, "").says(1).settles.shows("QUEUED")
    assert follows(unserved.judged(readings=EXACT), AI_37_empty="n", AI_17="a")


def test_timeouts_that_are_looked_at_now_and_then() -> None:
    """AI-39.limits b: a server that sends at once may abort up to a second late, and not before."""
    late = sent().waits(5.9).settles
    assert follows(late.shows("STARTED").judged(readings=EXACT), AI_39_limits="b")
    assert not sent().waits(6.1).settles.shows("STARTED").judged(readings=EXACT).conforms
    assert not sent().waits(4.9).settles.shows("FAILED_TIMEDOUT").judged(readings=EXACT).conforms


@pytest.mark.parametrize("letter", ["b", "d"])
def test_run_timeouts_from_the_sending_that_are_looked_at_now_and_then(letter: str) -> None:
    """AI-39.limits b: with AI-06 b or d too they may be noticed up to a second late, and not before or later."""
    known = {**EXACT, "AI-06": letter, "AI-31": "b"}

    def begin() -> History:
        return sent(timeout=20).waits(2).reports(1, 1, "running").settles.waits(17.5).settles.shows("RUNNING")

    late = begin().waits(1.4).settles.shows("RUNNING")
    assert late.judged(readings=known).conforms
    assert not late.judged(readings={**known, "AI-39.limits": "a"}).conforms
    assert late.waits(0.2).settles.shows("FAILED_TIMEDOUT").judged(readings=known).conforms
    assert not begin().waits(1.6).settles.shows("RUNNING").judged(readings=known).conforms
    assert not begin().waits(0.4).settles.shows("FAILED_TIMEDOUT").judged(readings=known).conforms


def test_texts_that_a_server_sends() -> None:
    """To greet a robot or to confirm its name; one that is no message as documented is a violation all the same."""
    line = encode(Message(Header("name", 1, 1, Uuid(3, 4)), TextProto(""))).decode().strip()
    history = History().submit(1).drive("connect", connection=1)
    history.lines.append({"connection": 1, "line": line})
    assert history.says(1).sends(1, 1).settles.shows("STARTED").judged().conforms
    wrong = orjson.loads(line)
    wrong["header"]["pubtime"] = 1
    history.lines.append({"connection": 1, "line": orjson.dumps(wrong).decode()})
    assert not history.settles.judged().conforms


RESTS = {**EXACT, "AI-39.succeeded": "ab", "AI-39.aborted": "ab"}
"""Readings where it is open whether a robot rests after a mission."""


@pytest.mark.parametrize(
    ("end", "status", "question"),
    [("failure", "FAILED", "AI-39.failed"), ("success", "SUCCESS", "AI-39.succeeded")],
)
def test_a_robot_may_rest_after_a_mission(end: str, status: str, question: str) -> None:
    """AI-39.failed b, .succeeded b: its next one may come up to a second later, no later; others come at once."""

    def begin() -> History:
        return sent().submit(2).settles.reports(1, 1, end).settles.shows(status, "QUEUED")

    rests, at_once = {question.replace("-", "_").replace(".", "_"): letter for letter in "b"}, {**RESTS, question: "a"}
    assert follows(begin().waits(1.1).sends(1, 2).settles.judged(readings=RESTS), **rests)
    assert not begin().judged(readings=at_once).conforms
    assert not begin().waits(1.1).settles.shows(status, "QUEUED").judged(readings=RESTS).conforms
    rested = begin().waits(1.1).sends(1, 2).reports(1, 2, end).waits(1.1).submit(3).sends(1, 3)
    assert rested.settles.shows(status, status, "STARTED").judged(readings=RESTS).conforms
    prompt = sent().submit(2).settles.reports(1, 1, end).sends(1, 2).settles.judged(readings=RESTS)
    assert (prompt.conforms, prompt.readings[question]) == (True, ("a",))
    assert (
        not begin()
        .waits(1.1)
        .sends(1, 2)
        .submit(3)
        .reports(1, 2, end)
        .sends(1, 3)
        .settles.judged(readings=RESTS)
        .conforms
    )


def test_a_robot_may_rest_after_a_mission_that_timed_out() -> None:
    """AI-39.aborted b: its next mission may come up to a second after the limit, and no later."""
    known = {**RESTS, "AI-08": "a", "AI-39.limits": "a"}

    def begin() -> History:
        return sent(start_timeout=2).submit(2).settles.waits(2.5)

    rests = begin().settles.shows("FAILED_TIMEDOUT", "QUEUED").waits(0.6).sends(1, 2).settles
    assert follows(rests.judged(readings=known), AI_39_aborted="b")
    late = begin().settles.waits(0.6).settles.shows("FAILED_TIMEDOUT", "QUEUED")
    assert not late.judged(readings=known).conforms
    at_once = begin().sends(1, 2).settles.shows("FAILED_TIMEDOUT", "STARTED").submit(3).waits(7)
    assert at_once.sends(1, 3).settles.shows(*["FAILED_TIMEDOUT"] * 2, "STARTED").judged(readings=known).conforms


def test_a_robot_rests_though_it_connects_anew() -> None:
    """AI-39.failed b: what it lost with its connection keeps it from the next one on another for up to a second."""

    def begin() -> History:
        return sent().submit(2).drive("disconnect", connection=1).settles.waits(0.5).robot(2).settles

    known = {**EXACT, "AI-15.sent": "c", "AI-15.when": "n"}
    rests = begin().shows("FAILED_DISCONNECTED", "QUEUED").waits(1).sends(2, 2).settles
    assert follows(rests.judged(readings=known), AI_39_failed="b")
    late = begin().waits(1).settles.shows("FAILED_DISCONNECTED", "QUEUED")
    assert not late.judged(readings=known).conforms


def test_a_robot_may_rest_that_has_lost_a_mission_with_one_of_its_connections() -> None:
    """AI-39.failed b: the next mission may come up to a second later on the other connection, and no later."""

    def begin() -> History:
        begun = History().submit(1).submit(2).robot(1).sends(1, 1).robot(2).shows("STARTED", "QUEUED")
        return begun.drive("disconnect", connection=1).settles.shows("FAILED_DISCONNECTED", "QUEUED")

    known = {**EXACT, "AI-15": "c", "AI-16": "b", "AI-16.back": "p"}
    assert follows(begin().waits(1.1).sends(2, 2).settles.judged(readings=known), AI_39_failed="b")
    assert not begin().waits(1.1).settles.shows("FAILED_DISCONNECTED", "QUEUED").judged(readings=known).conforms


def test_a_period_of_grace_is_one() -> None:
    """AI-15.when g: a mission whose robot drops again before it was given up has no second clock for that."""
    link = Link(0, "carter", serves=True)
    left = (("AI-15", "c"), ("AI-15.when", "g"))
    mission = Mission("carter", "mission", None, "{}", None, None, status=Status.RUNNING, sent_on=0, sent=True)
    once = next(iter(lost(Move(Server(missions=(mission,), links=(link,), left=left)), link)))
    again = next(iter(lost(once, link)))
    assert len(once.state.missions[0].clocks) == 1
    assert again.state.missions == once.state.missions


@pytest.mark.parametrize("gone", [1, 2])
def test_a_robot_with_two_connections_is_there_until_both_have_dropped(gone: int) -> None:
    """AI-16 s: a start limit that counts from when the robot is connected counts on while one of them is open."""
    history = History().robot(1).robot(2).submit(1).sends(1, 1).submit(2).sends(2, 2).submit(3, start_timeout=3)
    history = history.settles.waits(1).drive("disconnect", connection=gone).settles.waits(1.5).settles
    others = ["STARTED", "STARTED"]
    others[gone - 1] = "FAILED_DISCONNECTED"
    shared = {"AI-16": "s", "AI-05": "d"}
    assert (
        history.shows(*others, "QUEUED")
        .waits(1)
        .settles.shows(*others, "FAILED_TIMEDOUT")
        .judged(readings=shared)
        .conforms
    )


def test_a_robot_is_connected_once_though_it_connects_twice() -> None:
    """AI-16 s: a start limit that counts from when the robot is connected begins with the first connection."""
    history = History().submit(1).submit(2).submit(3, start_timeout=3).robot(1).sends(1, 1).settles.waits(1)
    history = history.robot(2).sends(2, 2).settles.waits(1.5).settles.shows("STARTED", "STARTED", "QUEUED").waits(1)
    late = history.settles.shows("STARTED", "STARTED", "FAILED_TIMEDOUT")
    assert late.judged(readings={"AI-16": "s", "AI-05": "d"}).conforms


def test_a_robot_that_took_another_name_is_gone() -> None:
    """AI-17 b, under-way k: a start limit that counts from when the robot is connected stops for what waits for it."""
    history = History().robot(1).submit(1).sends(1, 1).submit(2, start_timeout=3).settles.waits(1).says(1, "q")
    readings = {"AI-05": "d", "AI-17": "b", "AI-17.under-way": "k"}
    assert history.waits(5).settles.shows("STARTED", "QUEUED").judged(readings=readings).conforms


def _heard(status: str = "running") -> History:
    begun = History().submit(1).robot(1).settles.waits(1).sends(1, 1).settles
    return begun.reports(1, 1, status).settles


def test_a_report_may_be_worked_off_in_the_next_pass() -> None:
    """AI-39.reports b: a second later it is shown at the latest."""
    later = _heard().shows("STARTED").waits(1).settles.shows("RUNNING").reports(1, 1, "success").settles
    later = later.shows("RUNNING").waits(1).settles.shows("SUCCESS")
    assert follows(later.judged(no_flagged=True), AI_39_reports="b")
    assert not _heard().shows("STARTED").waits(1).settles.shows("STARTED").judged(readings={"AI-10": "ab"}).conforms


def test_what_is_shown_at_once_is_not_worked_off_in_a_pass() -> None:
    """AI-39.reports a: a server that shows one report at once may not keep the next one for a pass."""
    begun = _heard().shows("RUNNING")
    assert follows(begun.judged(no_flagged=True), AI_39_reports="a")
    mixed = begun.reports(1, 1, "success").settles.shows("RUNNING")
    assert not mixed.judged(readings={"AI-10": "ab"}).conforms


def test_a_server_that_sends_at_once_shows_reports_at_once() -> None:
    """A server without scheduling passes (AI-39 a) has none in which it could work off reports."""
    begun = History().submit(1).robot(1).sends(1, 1).settles.reports(1, 1, "running").settles.shows("STARTED")
    assert not begun.judged(readings={"AI-10": "ab"}).conforms


def test_a_dependant_is_sent_in_the_pass_that_works_off_the_report() -> None:
    """AI-39.reports b: the pass that shows that an upstream succeeded sends what waited for it."""
    begun = History().submit(1).submit(2, robot="q", upstream=[1]).robot(1).robot(2, "q").settles.waits(1).sends(1, 1)
    begun = begun.settles.reports(1, 1, "success").settles.shows("STARTED", "QUEUED").waits(1).sends(2, 2).settles
    assert begun.shows("SUCCESS", "STARTED").judged(no_flagged=True).conforms


def test_a_mission_may_be_created_until_the_server_looks() -> None:
    """AI-04.new b: CREATED until a scheduling pass, whenever that is, and never again after that."""

    def looked() -> History:
        return History().submit(1).shows("CREATED").waits(1.3).shows("QUEUED")

    assert follows(looked().judged(no_flagged=True), AI_04_new="b", AI_04_robot="q")
    once = History().submit(1).shows("CREATED").submit(2).waits(0.3).shows("QUEUED", "CREATED")
    assert follows(once.waits(1.3).shows("QUEUED", "QUEUED").judged(no_flagged=True), AI_04_new="b", AI_04_robot="q")
    assert follows(History().submit(1).shows("QUEUED").judged(), AI_04_new="a")
    back = History().submit(1).shows("CREATED").waits(0.3).shows("QUEUED").shows("CREATED")
    later = looked().shows("CREATED")
    at_once = looked().submit(2).shows("QUEUED", "QUEUED")
    for wrong in (back, later, at_once):
        assert not wrong.judged().conforms
    again = looked().robot(1).sends(1, 1).settles.drive("disconnect", connection=1).shows("CREATED")
    assert not again.judged(readings={"AI-15.sent": "b"}).conforms


def test_all_that_is_ready_may_go_when_its_robot_is_named_and_later_one_at_a_time() -> None:
    """AI-11 d: the sentence is about the naming of a connection alone."""

    def later() -> History:
        named = History().submit(1).submit(2).submit(3).robot(1).sends(1, 1).sends(1, 2).sends(1, 3).settles
        return named.submit(4).settles.submit(5).settles

    def ended() -> History:
        return later().reports(1, 1, "success").reports(1, 2, "success").reports(1, 3, "success")

    known = {**EXACT, "AI-15.sent": "c", "AI-12": "a", "AI-13": "a", "AI-08": "a"}
    assert follows(later().judged(readings=known), AI_11="d")
    assert follows(ended().sends(1, 4).settles.judged(readings=known), AI_11="d")
    assert not ended().settles.judged(readings=known).conforms
    assert not ended().sends(1, 4).sends(1, 5).settles.judged(readings=known).conforms
    dropped = ended().sends(1, 4).settles.drive("disconnect", connection=1).submit(6)
    again = dropped.robot(2).sends(2, 5).sends(2, 6).settles
    assert follows(again.judged(readings=known), AI_11="d")


def test_what_is_sent_when_a_robot_is_named_overtakes_what_waits() -> None:
    """AI-11 d: all that is ready then, though later what waits holds up those behind it (AI-12 b)."""
    known = {**EXACT, "AI-11": "abd", "AI-12": "b"}
    waits = History().submit(1, robot="s").submit(2, upstream=[1]).submit(3)
    assert follows(waits.robot(1).sends(1, 3).settles.judged(readings=known), AI_11="d")
    held = History().robot(1).submit(1, robot="s").submit(2, upstream=[1]).submit(3).settles
    assert held.judged(readings={**known, "AI-11": "d"}).conforms
    assert not held.sends(1, 3).judged(readings={**known, "AI-11": "d"}).conforms


def test_who_sends_all_at_once_when_a_robot_is_named_sends_all() -> None:
    """AI-11 d: not two of three."""
    some = History().submit(1).submit(2).submit(3).robot(1).sends(1, 1).sends(1, 2).settles
    assert not some.judged(readings={**EXACT, "AI-11": "bd"}).conforms


def test_who_goes_by_the_mission_in_the_payload_may_close_on_a_status_without_one() -> None:
    """AI-26 f: that is a line that cannot be read to it."""
    known = {**EXACT, "AI-10": "ab", "AI-15.sent": "c"}

    def closed() -> History:
        return reports_nameless(sent(), 1, "running").closes(1).settles.shows("FAILED_DISCONNECTED")

    assert follows(closed().judged(readings=known, no_flagged=True), AI_10="b", AI_26="f")
    assert not closed().judged(readings={**known, "AI-10": "a"}).conforms
    assert not closed().judged(readings={**known, "AI-26": "e"}).conforms
    read = reports_nameless(sent(), 1, "running").settles.shows("RUNNING")
    assert follows(read.judged(readings=known), AI_10="a")
