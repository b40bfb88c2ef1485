"""Ten busy clients behind a proxy: nothing is lost, and the verdict is right; tests/bench has a minute of it."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from busyclients import Ran, run

from missionfsm.app.recorded import check_file

BREAK = "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued"


def lost(ran: Ran) -> list[str]:
    """What the clients saw and the record has not, or the other way round."""
    asked = sum((one.answers for one in ran.clients), Counter[tuple[str, str]]())
    found = [] if asked == ran.recorded else [f"calls: {asked} asked, {ran.recorded} recorded"]
    seen, recorded = sorted(one.numbers for one in ran.clients), sorted(ran.streams)
    found += [] if seen == recorded else [f"messages: {seen} seen, {recorded} recorded"]
    return found + [f"{numbers}: not in order" for numbers in recorded if numbers != sorted(set(numbers))]


def test_ten_busy_clients_are_recorded_whole_and_judged_right(tmp_path: Path) -> None:
    """Every call and message of ten clients stands in the record once; it conforms, to the proxy and to ``check``."""
    ran = run(tmp_path, 3, pause=0.15)
    assert lost(ran) == []
    assert (ran.status, ran.verdict["verdict"]) == (0, "conforms"), ran.told
    ((_, verdict),) = check_file(str(tmp_path / "busy.jsonl"))
    assert verdict.conforms, str(verdict)
