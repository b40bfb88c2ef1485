"""A minute of ten busy clients behind a proxy: what is lost, what a call takes longer, and what the verdict is.

    pytest -o addopts= tests/bench/test_bench_busy.py -s

The robot and the clients share one process; the proxy, and what records and judges, have one each.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from missionfsm.app.recorded import check_file

sys.path.insert(0, str(Path(__file__).parents[1] / "grpc"))
from busyclients import run
from test_grpc_busy import BREAK, lost

SECONDS = 60


@pytest.mark.parametrize("broken", ["", BREAK], ids=["right", "broken"])
def test_a_minute_of_ten_busy_clients(tmp_path: Path, broken: str) -> None:
    """Nothing is lost; what the proxy says of it is told, and what ``check`` says is right."""
    begun = time.perf_counter()
    ran = run(tmp_path, SECONDS, pause=0.2, broken=broken, patience=600)
    calls = sum(sum(one.answers.values()) for one in ran.clients)
    messages = sum(len(one.numbers) for one in ran.clients)
    print(f"\n{calls} calls, {messages} messages in {SECONDS} s; all over after {time.perf_counter() - begun:.0f} s")
    print(f"lost: {lost(ran) or 'nothing'}; exit status {ran.status}, {ran.verdict and ran.verdict['verdict']}")
    print(sum((one.answers for one in ran.clients), Counter[tuple[str, str]]()))
    begun = time.perf_counter()
    ((_, verdict),) = check_file(str(tmp_path / "busy.jsonl"))
    print(f"check: {verdict.outcome.value} in {time.perf_counter() - begun:.0f} s")
    assert (verdict.violation is not None) == bool(broken), str(verdict)
    assert lost(ran) == []
