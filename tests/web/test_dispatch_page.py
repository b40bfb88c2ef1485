"""The status page of the mission server: what it serves, and what is seen in a real browser."""

from __future__ import annotations

import asyncio
import json
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import Any

import pytest
from browsing import expect
from conftest import SIZES

from missionfsm.adapters.isaac.settings import Settings
from missionfsm.app.dispatch import Dispatch
from missionfsm.isaac.runtime.log import Entry
from missionfsm.isaac.runtime.missionfile import MissionEntry, MissionFile


@pytest.fixture
def address() -> Iterator[str]:
    """The page of a server with three missions in a row, whose robots are away."""
    missions = (MissionEntry("a"), MissionEntry("b<script>", upstream=(0,)), MissionEntry("c", upstream=(1,)))
    work = Dispatch(MissionFile(missions), Settings(port=0, http=0))
    found: list[str] = []
    ready = threading.Event()
    loop = asyncio.new_event_loop()

    def tell(entry: Entry) -> None:
        if entry.event == "status-page":
            found.append(str(entry.fields["address"]))
            loop.call_soon(ready.set)

    thread = threading.Thread(target=lambda: loop.run_until_complete(work.run(tell)))
    thread.start()
    assert ready.wait(10)
    yield found[0]
    loop.call_soon_threadsafe(work._done.set)
    thread.join()
    loop.close()


def got(address: str) -> tuple[str, str]:
    with urllib.request.urlopen(address, timeout=10) as answer:  # noqa: S310 - the address is ours
        return answer.headers["Content-Type"], answer.read().decode()


def test_dispatch_page_json_and_metrics_say_where_all_stands(address: str) -> None:
    """Missions with robot, status and upstream; counts by status; nothing else is there, and nothing can be written."""
    kind, text = got(address + "status.json")
    now = json.loads(text)
    assert kind == "application/json"
    assert now["missions"][1] == {"mission": 1, "robot": "b<script>", "status": "QUEUED", "upstream": [0]}
    assert now["counts"]["QUEUED"] == 3
    assert now["robots"] == [{"robot": name, "peer": None} for name in ("a", "b<script>", "c")]
    metrics = got(address + "metrics")[1].splitlines()
    assert 'missionfsm_missions{status="QUEUED"} 3' in metrics
    assert "missionfsm_robots_connected 0" in metrics
    with pytest.raises(urllib.error.HTTPError, match="404"):
        got(address + "../etc/passwd")
    with pytest.raises(urllib.error.HTTPError, match="501"):
        urllib.request.urlopen(urllib.request.Request(address, method="POST"), timeout=10)  # noqa: S310 - ours


@pytest.mark.parametrize("size", SIZES)
def test_dispatch_page_shows_the_graph(browser: Any, address: str, size: str) -> None:
    """Every mission is a box with its status, joined to what it waits for; the page is no wider than the window.

    The list says what each waits for, in lines whose head is not broken.
    """
    width, height = SIZES[size]
    page = browser.new_page(viewport={"width": width, "height": height})
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(address)
    page.wait_for_selector("g[data-mission='2'][data-status='QUEUED']")
    expect(page.locator("svg path")).to_have_count(2)
    expect(page.locator("#list")).to_contain_text("b<script>", use_inner_text=True)
    expect(page.locator("#counts")).to_have_text("3 QUEUED", use_inner_text=True)
    assert page.locator("#list td:last-child").all_inner_texts() == ["its robot", "0", "1"]
    heights = page.locator("#list tr").evaluate_all("rows => rows.map((row) => row.getBoundingClientRect().height)")
    assert len(set(map(round, heights))) == 1
    assert not page.evaluate("document.documentElement.scrollWidth > window.innerWidth")
    assert complaints == []
    page.close()
