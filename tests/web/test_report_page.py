"""The report in a browser: what was judged can be read, unfolded, followed and judged again."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import orjson
import pytest
from browsing import Opener, expect, missionfsm

from missionfsm.pages.outline import Standing
from missionfsm.pages.render import specification_page
from missionfsm.pages.report import readings_asked
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Outcome, Verdict
from missionfsm.tools.specpages import clauses

pytestmark = pytest.mark.slow

SUBJECT = Path(__file__).parent.parent / "subjects" / "bear_mission.mjs"
BROKEN = "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued"
MARKUP = "</script><script>window.hacked = 1</script><img src=x onerror='window.hacked = 2'>"
DELIVERY = {"mission": {"serviMission": {"deliveryMission": {"goals": [{"destinationId": "table-1"}]}}}}
HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {}}
GOOD = (HEAD, {"call": 1, "method": "CreateMission", "params": DELIVERY}, {"return": 1, "result": {"missionId": "m"}})
HOSTILE = (
    *({**one, "robot": MARKUP} for one in GOOD),
    {"robot": MARKUP, "call": 2, "method": "AppendMission", "params": DELIVERY},
    {"robot": MARKUP, "return": 2, "result": {"missionId": MARKUP}},
    {"robot": MARKUP, "call": 3, "method": "SkipGoal", "params": {}},
    {"robot": MARKUP, "return": 3, "error": {"status": "NOT_FOUND", "message": MARKUP}},
)


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("reports")


def _judged(folder: Path, name: str, examples: int, *options: object) -> Path:
    """The page on the subject with one thing broken or with none, with its verdict as JSON beside it."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("no Node.js to run the independent implementations")
    page = folder / f"{name}.html"
    asked = ("--seed", 3, "--examples", examples, "--steps", 20, "--json", page.with_suffix(".json"), "--html", page)
    ended = missionfsm("conform", "bear.mission", *asked, "--", node, SUBJECT, *options)
    assert ended.err == ""
    return page


@pytest.fixture(scope="session")
def violating(folder: Path) -> Path:
    return _judged(folder, "violating", 100, "--break", "create-while-queued")


@pytest.fixture(scope="session")
def conforming(folder: Path) -> Path:
    return _judged(folder, "conforming", 12)


def _history(path: Path, lines: tuple[object, ...]) -> Path:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    return path


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", ["desktop", "phone"])
@pytest.mark.parametrize("which", ["violating", pytest.param("conforming", marks=pytest.mark.long)])
def test_it_fits_the_window(
    which: str, size: str, scheme: str, open_page: Opener, request: pytest.FixtureRequest
) -> None:
    """Folded and unfolded the page is as wide as the window, and its colours are those that were asked for."""
    seen = open_page(request.getfixturevalue(which), size, scheme)
    assert not seen.overflows()
    seen.page.evaluate("for (const part of document.querySelectorAll('details')) part.open = true")
    assert not seen.overflows()
    background = seen.page.evaluate("getComputedStyle(document.body).backgroundColor")
    dark = sum(map(int, background.removeprefix("rgb(").removesuffix(")").split(","))) < 3 * 128
    assert dark == (scheme == "dark")


def test_it_tells_the_story(violating: Path, open_page: Opener) -> None:
    """The verdict, every line of the history in a row of its own, the last one wrong, and what was allowed."""
    verdict = json.loads(violating.with_suffix(".json").read_text())
    page = open_page(violating).page
    assert verdict["verdict"] == "violates"
    expect(page.locator(".verdict strong")).to_have_text("violates", use_inner_text=True)
    rows = page.locator(".sequence .row")
    expect(rows).to_have_count(len(verdict["violation"]["history"]) - 1)
    wrong = page.locator(".row.wrong")
    assert (wrong.count(), rows.last.get_attribute("class")) == (1, wrong.get_attribute("class"))
    expect(page.locator(".wrong-box")).to_contain_text(verdict["violation"]["observed"], use_inner_text=True)
    expect(page.locator(".allowed")).to_contain_text("FAILED_PRECONDITION", use_inner_text=True)
    line = wrong.locator("pre")
    expect(line).to_be_hidden()
    wrong.locator("summary").click()
    expect(line).to_be_visible()
    assert json.loads(line.inner_text()) == verdict["violation"]["history"][-1]


def test_its_links_lead_somewhere(violating: Path, open_page: Opener) -> None:
    """Every link leads to a part of the page, and unfolds what it is in."""
    page = open_page(violating).page
    targets = page.evaluate(
        "[...document.querySelectorAll('a')].map((a) => decodeURIComponent(a.getAttribute('href')))"
    )
    known = set(page.evaluate("[...document.querySelectorAll('[id]')].map((one) => '#' + one.id)"))
    assert len(targets) > 100
    assert set(targets) <= known
    rule = page.locator(f"[id='{BROKEN}']")
    expect(rule).to_be_hidden()
    page.locator(".wrong-box a").first.click()
    expect(rule).to_be_visible()
    expect(rule.locator(".mark")).to_have_text("violated", use_inner_text=True)
    # Folded again, the same link unfolds it again, though the address does not change.
    page.locator("button[data-folds='close']").first.click()
    expect(rule).to_be_hidden()
    page.locator(".wrong-box a").first.click()
    expect(rule).to_be_visible()


def test_its_map_has_every_clause(violating: Path, open_page: Opener) -> None:
    """Every clause of the specification is on the map once, in its colour, and the legend hides some on demand."""
    page = open_page(violating).page
    page.locator("nav a[href^='#map']").click()
    page.locator(".map button[data-folds='open']").click()
    numbers = page.locator(".clause .number").all_inner_texts()
    assert sorted(numbers) == sorted(clause.number for clause in clauses(specification_page("bear.mission")))
    guilty = page.locator(".clause.violated")
    assert "M-9" in guilty.locator(".number").all_inner_texts()
    page.locator("button[data-shows='violated']").click()
    expect(guilty.first).to_be_hidden()
    page.locator("button[data-shows='violated']").click()
    expect(guilty.first).to_be_visible()
    shown = {one.value for one in Standing}
    assert set(page.locator(".clause > header .mark").all_inner_texts()) <= shown
    square = page.locator(".strip a.violated:visible").first
    square.click()
    expect(page.locator(".clause:target")).to_have_count(1)


def test_its_history_is_judged_alike(violating: Path, open_page: Opener, tmp_path: Path) -> None:
    """What is copied is a history in which the same event is wrong, and a test that fails."""
    page = open_page(violating).page
    page.get_by_text("The history, to be judged again").click()
    page.get_by_role("button", name="Copy the history").click()
    history = tmp_path / "copied.jsonl"
    history.write_text(page.evaluate("window.clipped"))
    checked = missionfsm("check", history, "--json", tmp_path / "verdict.json")
    live = json.loads(violating.with_suffix(".json").read_text())
    found = json.loads((tmp_path / "verdict.json").read_text())
    assert (checked.status, found["violation"]["observed"]) == (1, live["violation"]["observed"])
    page.get_by_role("button", name="Copy as a pytest").click()
    scope: dict[str, object] = {}
    exec(page.evaluate("window.clipped"), scope)  # noqa: S102 - the text is what is tested
    (copied,) = (one for name, one in scope.items() if name.startswith("test_"))
    with pytest.raises(AssertionError, match="violates"):
        copied()  # type: ignore[operator]


def test_it_tells_what_is_followed(conforming: Path, open_page: Opener) -> None:
    """Of what conforms every ambiguity that mattered is told, with the readings that are left."""
    verdict = json.loads(conforming.with_suffix(".json").read_text())
    page = open_page(conforming).page
    expect(page.locator(".verdict strong")).to_have_text(verdict["headline"], use_inner_text=True)
    assert verdict["verdict"] == "conforms"
    expect(page.locator(".row.wrong")).to_have_count(0)
    told = page.evaluate("""Object.fromEntries([...document.querySelectorAll(".question")].map((one) => [
        one.querySelector("strong").textContent,
        [...one.querySelectorAll("li:not(.out) .letter")].map((letter) => letter.textContent),
    ]))""")
    assert told == verdict["readings"]
    assert len(told) > 3


@pytest.mark.parametrize("which", ["conforming", "violating"])
def test_it_fits_two_screens_of_a_phone(which: str, open_page: Opener, request: pytest.FixtureRequest) -> None:
    """What happened is there at once; readings, rules and the map are folded away, and a link to one unfolds it."""
    page = open_page(request.getfixturevalue(which), "phone").page
    screen, height = page.evaluate("[innerHeight, document.documentElement.scrollHeight]")
    assert height <= 2 * screen
    expect(page.locator("details.part[open]")).to_have_count(0)
    page.locator("nav a[href^='#map']").click()
    expect(page.locator("details.part[open] .map")).to_have_count(1)


def test_what_was_sent_is_text(open_page: Opener, tmp_path: Path) -> None:
    """Markup in names and messages of an implementation is shown as it is, and does nothing."""
    history = _history(tmp_path / "hostile.jsonl", HOSTILE)
    ended = missionfsm("check", history, "--html", tmp_path / "page.html")
    assert ended.status == 1
    page = open_page(tmp_path / "page.html").page
    assert page.evaluate("window.hacked") is None
    expect(page.locator(".sequence")).to_contain_text(MARKUP, use_inner_text=True)
    expect(page.locator("h1")).to_contain_text(MARKUP, use_inner_text=True)


def test_many_histories_share_a_page(open_page: Opener, tmp_path: Path) -> None:
    """A page on several files has a verdict for each, the gravest first and unfolded, and one map."""
    good = _history(tmp_path / "good.jsonl", GOOD)
    wrong = _history(tmp_path / "wrong.jsonl", (*GOOD[:2], {"return": 1, "error": {"status": "FAILED_PRECONDITION"}}))
    ended = missionfsm("check", good, wrong, "--html", tmp_path / "page.html")
    assert ended.status == 1
    seen = open_page(tmp_path / "page.html", "phone")
    page = seen.page
    assert not seen.overflows()
    assert page.locator("td .mark").all_inner_texts() == ["violates", "conforms"]
    expect(page.locator(".verdict strong").first).to_have_text("violates", use_inner_text=True)
    expect(page.locator(".map")).to_have_count(1)
    expect(page.locator("#story-1 .row.wrong")).to_be_visible()
    expect(page.locator("#story-2 .verdict")).to_be_hidden()
    page.get_by_role("link", name=str(good)).click()
    expect(page.locator("#story-2:target .verdict")).to_be_visible()


def test_nothing_half_written(tmp_path: Path) -> None:
    """A page that cannot be written ends with 2 and one line; stdout is not for pages."""
    good = _history(tmp_path / "good.jsonl", GOOD)
    nowhere = missionfsm("check", good, "--html", tmp_path / "no" / "page.html")
    assert (nowhere.status, nowhere.err.count("\n")) == (2, 1)
    assert missionfsm("check", good, "--html", "-").status == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["good.jsonl"]


def test_the_map_is_about_the_system() -> None:
    """The specification of every system is packaged with the pages."""
    assert [
        name for name in ("bear.mission", "bear.status", "isaac.server", "isaac.robot") if not specification_page(name)
    ] == []
    assert specification_page("no.such") == ""
    assert system("bear.mission").spec.rules_by_id[BROKEN].code == "FAILED_PRECONDITION"


@pytest.mark.parametrize("name", ["TR-01", "LOG-01", "LOG-03", "AM-02"])
def test_readings_of_transports_and_logs_are_told_like_others(name: str) -> None:
    """As many mattered on the page as in the headline."""
    spec = system("bear.mission").spec
    name = next((one.id for one in spec.ambiguities if one.id.startswith(name)), name)  # a part of one that is split
    verdict = Verdict(Outcome.CONFORMS, "bear.mission", readings={name: ("a", "b")})
    assert [one.id for one in readings_asked(spec, verdict)] == [name]
