"""A connection that the server closes is seen to close, and what was sent on it before is seen to come."""

import json
from typing import Any

import pytest
from server_history import SERVER, History

from missionfsm.isaac.wire.messages import Uuid
from missionfsm.tools.check.verdict import Outcome
from missionfsm.tools.reference.subject import ReferenceSubject

ABORTS = {"AI-08": "c", "AI-29": "d"}
"""An abort closes the connection of its robot, and nothing else does."""


def test_a_mission_that_was_never_sent_is_not_excused_by_a_close_that_nobody_saw() -> None:
    """A mission to a connected robot has to be sent: that its connection was closed is assumed only if seen."""
    history = History().submit(1).settles.robot(1).settles.waits(60).settles
    assert history.shows("FAILED_TIMEDOUT").judged().outcome is Outcome.VIOLATES


def test_an_abort_that_closes_the_connection_is_flagged() -> None:
    """AI-08 c: an abort may close the robot's connection, which departs from the text."""
    history = History().submit(1).robot(1).sends(1, 1).settles.waits(9).closes(1).settles.shows("FAILED_TIMEDOUT")
    returns = history.submit(2).robot(2).sends(2, 2).settles
    verdict = returns.judged()
    assert (verdict.outcome, [one.reading for one in verdict.flagged]) == (Outcome.CONFORMS, ["AI-08=c"])


@pytest.mark.parametrize("seen", [True, False])
def test_a_close_has_to_be_seen(*, seen: bool) -> None:
    """Under AI-08 c an abort conforms if the connection is seen to close, and not otherwise."""
    history = History().submit(1).robot(1).sends(1, 1).settles.waits(9)
    history = (history.closes(1) if seen else history).settles.shows("FAILED_TIMEDOUT")
    assert history.judged(readings=ABORTS).conforms is seen


def test_nothing_is_heard_on_a_connection_that_is_closed() -> None:
    """A report that comes after the abort does not keep the server from having closed the connection before it."""
    history = History().submit(1).robot(1).sends(1, 1).settles.waits(9).reports(1, 1, "running").closes(1)
    assert not history.settles.judged(readings=ABORTS).conforms


def test_what_the_server_has_closed_does_not_drop() -> None:
    """A connection that the server has closed cannot drop afterwards."""
    history = History().submit(1).robot(1).sends(1, 1).settles.waits(9).closes(1).settles
    assert not history.drive("disconnect", connection=1).judged(readings=ABORTS).conforms


def test_the_reference_tells_that_a_connection_ends() -> None:
    """The reference reports `closed` when an abort closes a connection."""
    subject = ReferenceSubject(SERVER, {**ABORTS, "AI-39": "a"})
    subject.exchange("reset", {"world": {}})
    subject.exchange("submit", {"mission": {"robot": "r"}})
    history = History().robot(1)
    for line in history.lines:
        subject.exchange("drive", line["drive"])
    told = subject.exchange("drive", {"event": "advance", "seconds": 9})
    assert [(one.method, one.params) for one in told.after] == [("closed", {"connection": 1})]


def _never_counted(header: Uuid | None) -> History:
    history = History().submit(1).robot(1).sends(1, 1)
    line = json.loads(history.lines[-1]["line"])
    if header is not None:
        line["header"]["uuid"] = {"lower": str(header.lower), "upper": str(header.upper)}
    history.lines[-1] = {"connection": 1, "line": json.dumps(line)}
    history = history.settles.reports(1, 1, "running").settles
    return history.waits(3).settles.reports(1, 1, "success").settles.shows("STARTED")


def test_a_status_that_is_never_counted_is_wrong() -> None:
    """AI-10 c: a server that goes by the uuid in a header says it there, else it would never hear of any mission."""
    assert _never_counted(None).judged().outcome is Outcome.VIOLATES
    verdict = _never_counted(Uuid(1, 1 << 61 | 1)).judged()
    assert [one.reading for one in verdict.flagged] == ["AI-10=c"]


@pytest.mark.parametrize("timeout", [{}, {"timeout": 100}])
def test_a_mission_that_was_acknowledged_does_not_miss_its_start(timeout: Any) -> None:
    """A mission that its robot reports as running every second cannot time out before its run limit."""
    history = History().submit(1, **timeout).robot(1).sends(1, 1).settles.reports(1, 1, "running").settles
    for _ in range(8):
        history = history.waits(1).reports(1, 1, "running").settles
    assert history.shows("FAILED_TIMEDOUT").judged().outcome is Outcome.VIOLATES


RUBBISH = {"event": "line", "connection": 1, "line": "no json"}


@pytest.mark.parametrize("closes", [True, False])
@pytest.mark.parametrize("shown", ["RUNNING", "FAILED_DISCONNECTED"])
def test_a_connection_that_a_bad_line_closes_is_seen_to_close(shown: str, *, closes: bool) -> None:
    """AI-26 f: a mission is not lost with a connection of which nobody has seen the end."""
    history = History().submit(1).robot(1).sends(1, 1).settles.reports(1, 1, "running").settles.drive(**RUBBISH)
    history = (history.closes(1) if closes else history).settles.shows(shown)
    at_once = {"AI-29": "d", "AI-15": "c", "AI-15.when": "n"}
    assert history.judged(readings=at_once).conforms is ((shown == "RUNNING") is not closes)


@pytest.mark.parametrize("again", ["s", "r"])
def test_a_connection_that_a_name_closes_is_seen_to_close(again: str) -> None:
    """AI-17 d, AI-16 d: a second name, or a second connection with it, is closed before anybody's eyes."""
    history = History().submit(1).robot(1).sends(1, 1).settles.reports(1, 1, "running").settles
    history = history.says(1, "s") if again == "s" else history.robot(2)
    closed = 1 if again == "s" else 2
    lost = ("FAILED_DISCONNECTED",) if again == "s" else ("RUNNING",)
    assert history.closes(closed).settles.shows(*lost).judged(readings={"AI-29": "d"}).conforms
    if again == "s":
        unseen = History().submit(1).robot(1).sends(1, 1).settles.reports(1, 1, "running").settles.says(1, "s")
        late = unseen.settles.shows(*lost)
        assert not late.judged(readings={"AI-29": "d", "AI-17": "ad"}).conforms


@pytest.mark.parametrize(("waits", "conforms"), [(0, True), (5, False)])
def test_nothing_is_sent_on_a_connection_that_dropped_long_ago(waits: float, *, conforms: bool) -> None:
    """AI-39.order s: a server that has yet to look may send in vain, which is seen until things settle."""
    history = History().submit(1).robot(1).drive("disconnect", connection=1).settles
    history = history.waits(waits).settles if waits else history
    assert history.sends(1, 1).settles.judged().conforms is conforms


def test_the_type_id_of_a_mission_is_signed() -> None:
    """A number above the signed ones is none, though it has the same bits."""
    history = History().submit(1).robot(1).sends(1, 1)
    line = json.loads(history.lines[-1]["line"])
    line["header"]["proto"] = "9410896613310777529"
    history.lines[-1] = {"connection": 1, "line": json.dumps(line)}
    assert history.settles.judged().outcome is Outcome.VIOLATES
