"""Logs in which nobody commands time or connections: what those do by themselves is no violation."""

import pytest
from server_history import History

from missionfsm.tools.check.verdict import Outcome

SEEN = ("connect", "line", "disconnect")
"""The drives of a log that only tells when its lines were."""


def _sent(*drives: str, **limits: float) -> History:
    return History(*drives).submit(1, **limits).robot(1).sends(1, 1)


@pytest.mark.parametrize(
    ("seconds", "outcome"), [(8, Outcome.CONFORMS), (4.5, Outcome.CONFORMS), (2, Outcome.VIOLATES)]
)
def test_a_limit_may_have_run_out_by_the_times_of_the_lines(seconds: float, outcome: Outcome) -> None:
    """A start limit of 5 s may have run out 4.5 s or 8 s after the line before, and not after 2 s."""
    history = _sent(*SEEN).at(0).shows("FAILED_TIMEDOUT").at(seconds)
    assert history.judged().outcome is outcome


def test_a_limit_that_has_run_out_by_the_times_of_the_lines_need_not_have_been_noticed() -> None:
    """The times of lines do not force a limit to have run out."""
    assert _sent(*SEEN).at(0).shows("STARTED").at(8).judged().outcome is Outcome.CONFORMS


def test_a_run_limit_counts_from_the_line_that_began_it() -> None:
    """A run limit of 60 s has not run out 30 s after the first report, and may have after 61 s."""
    begun = _sent(*SEEN, timeout=60).at(0).reports(1, 1, "running").at(1)
    for second in range(2, 30):
        begun.reports(1, 1, "running").at(second)
    late = History(*SEEN)
    late.lines, late.calls = list(begun.lines), begun.calls
    assert begun.shows("FAILED_TIMEDOUT").at(31).judged(readings={"AI-10": "b"}).outcome is Outcome.VIOLATES
    assert late.shows("FAILED_TIMEDOUT").at(62).judged().outcome is Outcome.CONFORMS


def test_without_times_any_limit_may_have_run_out() -> None:
    """If lines have no times, any amount of time may have passed between two."""
    assert _sent(*SEEN).settles.shows("STARTED").settles.shows("FAILED_TIMEDOUT").judged().outcome is Outcome.CONFORMS


def test_a_log_that_says_when_time_passes_says_all_of_it() -> None:
    """Once a line lets time pass, or a tester commands time, no other time passes."""
    history = _sent(*SEEN).waits(1).shows("FAILED_TIMEDOUT")
    told = History().submit(1).robot(1).sends(1, 1).waits(1).shows("FAILED_TIMEDOUT")
    assert told.judged().outcome is Outcome.VIOLATES
    history.lines.insert(0, {"drive": {"event": "advance", "seconds": 0}})
    assert history.judged().outcome is Outcome.VIOLATES


def test_time_that_passes_by_itself_is_no_event_of_the_log() -> None:
    """Time that is inserted is not counted among the events of the verdict."""
    verdict = _sent(*SEEN).at(0).shows("STARTED").at(8).judged()
    assert verdict.events == 7


def test_a_server_that_looks_once_a_second_sends_later_by_the_times_of_the_lines() -> None:
    """A scheduling pass may have come between two lines that are a second apart."""
    history = History(*SEEN).submit(1).robot(1).settles.at(0).sends(1, 1).at(1).shows("STARTED").at(1)
    assert history.judged().outcome is Outcome.CONFORMS


@pytest.mark.parametrize(
    ("drives", "outcome"),
    [(("connect", "line", "advance"), Outcome.CONFORMS), ((*SEEN, "advance"), Outcome.VIOLATES)],
)
def test_a_connection_drops_by_itself_only_where_nobody_commands_it(drives: tuple[str, ...], outcome: Outcome) -> None:
    """A disconnection may be unseen unless the tester has a drive for it."""
    history = _sent(*drives).settles.reports(1, 1, "running").settles.waits(3).settles.shows("FAILED_DISCONNECTED")
    assert history.judged().outcome is outcome


def test_what_comes_on_a_connection_shows_that_it_has_not_dropped() -> None:
    """A line on a connection contradicts that the connection dropped before."""
    history = _sent("connect", "line", "advance").settles.shows("FAILED_DISCONNECTED").reports(1, 1, "running")
    assert history.judged().outcome is Outcome.VIOLATES


def test_a_limit_that_ran_out_long_ago_by_the_times_of_the_lines_was_noticed() -> None:
    """Whoever says after how long something is late is told of a limit that nobody keeps to."""
    late = _sent(*SEEN).at(0).shows("STARTED").at(600)
    assert late.judged(no_flagged=True).outcome is Outcome.CONFORMS
    assert late.judged(no_flagged=True, settled_after=5).outcome is Outcome.VIOLATES
    assert late.judged(no_flagged=True, settled_after=1000).outcome is Outcome.CONFORMS
    runs = _sent(*SEEN, timeout=60).at(0)
    for second in range(1, 100):
        runs.reports(1, 1, "running").at(second)
    still, over = History(*SEEN), History(*SEEN)
    still.lines, still.calls, over.lines, over.calls = list(runs.lines), runs.calls, list(runs.lines), runs.calls
    assert still.shows("RUNNING").at(100).judged(settled_after=5).outcome is Outcome.VIOLATES
    assert over.shows("FAILED_TIMEDOUT").at(100).judged(settled_after=5).outcome is Outcome.CONFORMS


@pytest.mark.parametrize(("seconds", "outcome"), [(30, Outcome.CONFORMS), (7200, Outcome.VIOLATES)])
def test_a_mission_that_is_never_sent_is_late_by_the_times_of_the_lines(seconds: float, outcome: Outcome) -> None:
    """With `--settled-after`, a mission may wait for its robot for some seconds, and not for hours."""
    history = History(*SEEN).submit(1).at(0).robot(1).at(1).shows("QUEUED").at(seconds)
    assert history.judged(settled_after=60).outcome is outcome


@pytest.mark.parametrize("letter", "bcd")
def test_a_start_limit_of_0_may_be_over_when_a_mission_could_first_be_sent(letter: str) -> None:
    """Whatever it counts from, the mission need not be sent first, and the next one is sent at once."""
    at_once = {"AI-05": letter, "AI-39": "a", "AI-39.limits": "a"}
    led = History().robot(1).submit(1, start_timeout=0).waits(0.2).shows("FAILED_TIMEDOUT").submit(2, start_timeout=1.9)
    led.sends(1, 2).settles.shows("FAILED_TIMEDOUT", "STARTED")
    assert led.waits(0.2).settles.judged(readings=at_once).conforms
    log = History(*SEEN).submit(1, start_timeout=0).robot(1).at(0.5).shows("FAILED_TIMEDOUT")
    log.submit(2, start_timeout=1.9).sends(1, 2).submit(3, start_timeout=0.5).at(0.7)
    log.shows("FAILED_TIMEDOUT", "STARTED", "FAILED_TIMEDOUT").at(1.3)
    for seconds in (1.5, 21.5):
        log.shows("FAILED_TIMEDOUT", "STARTED" if seconds < 2 else "FAILED_TIMEDOUT", "FAILED_TIMEDOUT").at(seconds)
    assert log.judged(readings=at_once, settled_after=2.5).conforms
