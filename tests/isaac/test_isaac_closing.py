"""A connection that the server closes is seen to close, and what was sent on it before is seen to come."""

import pytest
from server_history import SERVER, History

from missionfsm.tools.check.verdict import Outcome
from missionfsm.tools.reference.subject import ReferenceSubject

ABORTS = {"AI-08": "c", "AI-29": "d"}
"""An abort closes the connection of its robot, and nothing else does."""


def test_a_mission_that_was_never_sent_is_not_excused_by_a_close_that_nobody_saw() -> None:
    history = History().submit(1).settles.robot(1).settles.waits(60).settles
    assert history.shows("FAILED_TIMEDOUT").judged().outcome is Outcome.VIOLATES


def test_an_abort_that_closes_the_connection_is_flagged() -> None:
    history = History().submit(1).robot(1).sends(1, 1).settles.waits(9).closes(1).settles.shows("FAILED_TIMEDOUT")
    returns = history.submit(2).robot(2).sends(2, 2).settles
    verdict = returns.judged()
    assert (verdict.outcome, [one.reading for one in verdict.flagged]) == (Outcome.CONFORMS, ["AI-08=c"])


@pytest.mark.parametrize("seen", [True, False])
def test_a_close_has_to_be_seen(*, seen: bool) -> None:
    history = History().submit(1).robot(1).sends(1, 1).settles.waits(9)
    history = (history.closes(1) if seen else history).settles.shows("FAILED_TIMEDOUT")
    assert history.judged(readings=ABORTS).conforms is seen


def test_nothing_is_heard_on_a_connection_that_is_closed() -> None:
    history = History().submit(1).robot(1).sends(1, 1).settles.waits(9).reports(1, 1, "running").closes(1)
    assert not history.settles.judged(readings=ABORTS).conforms


def test_what_the_server_has_closed_does_not_drop() -> None:
    history = History().submit(1).robot(1).sends(1, 1).settles.waits(9).closes(1).settles
    assert not history.drive("disconnect", connection=1).judged(readings=ABORTS).conforms


def test_the_reference_tells_that_a_connection_ends() -> None:
    subject = ReferenceSubject(SERVER, {**ABORTS, "AI-39": "a"})
    subject.exchange("reset", {"world": {}})
    subject.exchange("submit", {"mission": {"robot": "r"}})
    history = History().robot(1)
    for line in history.lines:
        subject.exchange("drive", line["drive"])
    told = subject.exchange("drive", {"event": "advance", "seconds": 9})
    assert [(one.method, one.params) for one in told.after] == [("closed", {"connection": 1})]


def test_a_status_that_is_never_counted_is_flagged() -> None:
    """AI-10 c: the uuid in a header is the message's own, so that nothing would ever be counted."""
    history = History().submit(1).robot(1).sends(1, 1).settles.reports(1, 1, "running").settles
    verdict = history.waits(3).settles.reports(1, 1, "success").settles.shows("STARTED").judged()
    assert [one.reading for one in verdict.flagged] == ["AI-10=c"]
