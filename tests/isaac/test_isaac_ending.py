"""A mission server may end, and its connections with it: once its missions are done, or stopped at any time."""

import pytest
from server_history import History

from missionfsm.tools.check.verdict import Outcome


def _done(status: str = "success") -> History:
    return History().submit(1).robot(1).sends(1, 1).settles.reports(1, 1, status).settles


@pytest.mark.parametrize("status", ["success", "failure"])
def test_a_server_ends_once_its_missions_are_done(status: str) -> None:
    """A server may end when all its missions have ended, well or not."""
    verdict = _done(status).closes(1).settles.judged(no_flagged=True)
    assert verdict.outcome is Outcome.CONFORMS


def test_a_server_that_is_stopped_before_is_flagged() -> None:
    """AI-29 s: a server that ends while a mission is under way was stopped, which is flagged."""
    history = _done().submit(2).sends(1, 2).settles.robot(2, "q").settles.closes(1).closes(2).settles
    verdict = history.judged()
    assert verdict.outcome is Outcome.CONFORMS
    assert [one.reading for one in verdict.flagged] == ["AI-29=s"]
    assert history.judged(no_flagged=True).outcome is Outcome.VIOLATES


def test_a_server_that_has_ended_takes_no_mission_and_no_connection() -> None:
    """A server that has ended, and closed all connections, accepts nothing more."""
    assert _done().closes(1).submit(2).judged().outcome is Outcome.VIOLATES
    assert _done().closes(1).settles.drive("connect", connection=2).judged().outcome is Outcome.VIOLATES
    assert _done().robot(2, "q").closes(1).submit(2, robot="q").sends(2, 2).judged().outcome is Outcome.VIOLATES


def test_a_server_that_was_stopped_answers_nothing() -> None:
    """A server that was stopped does not answer a request for the statuses."""
    stopped = History().submit(1).robot(1).sends(1, 1).settles.closes(1)
    assert stopped.shows("STARTED").judged().outcome is Outcome.VIOLATES


def test_what_a_robot_still_says_to_a_server_that_has_ended_means_nothing() -> None:
    """Lines and drops on connections of a server that has ended change nothing."""
    history = _done().robot(2, "q").closes(1).says(2, "q").drive("disconnect", connection=2).waits(9).settles
    assert history.shows("SUCCESS").judged().outcome is Outcome.CONFORMS
