"""The page on broken implementations in a browser: the score, and for every rule what came of breaking it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from browsing import Opener, expect, missionfsm

pytestmark = pytest.mark.slow


@pytest.fixture(scope="session")
def bitten(tmp_path_factory: pytest.TempPathFactory) -> Path:
    page = tmp_path_factory.mktemp("teeth") / "teeth.html"
    ended = missionfsm("teeth", "isaac.robot", "--json", page.with_suffix(".json"), "--html", page)
    assert ended.err == ""
    return page


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", ["desktop", "phone"])
def test_it_tells_what_was_noticed(size: str, scheme: str, bitten: Path, open_page: Opener) -> None:
    """The score is that of the command, and every mutant has a line with what came of it."""
    found = json.loads(bitten.with_suffix(".json").read_text())
    seen = open_page(bitten, size, scheme)
    assert not seen.overflows()
    expect(seen.page.locator(".score")).to_have_text(f"{100 * found['score']:.0f} %", use_inner_text=True)
    seen.page.get_by_role("button", name="Unfold all").click()
    assert not seen.overflows()
    marks = seen.page.locator(".bitten li .mark").all_inner_texts()
    assert found["mutants"] > 0
    assert marks.count("noticed") == found["killed"]
    assert marks.count("allowed") == len(found["allowed"])
    assert marks.count("missed") == len(found["missed"])
    assert len(marks) == found["mutants"] + len(found["untested"])
