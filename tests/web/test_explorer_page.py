"""The explorer in a browser: the model is clicked through, and what was clicked is a history that conforms."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import pytest
from browsing import Opener, expect, missionfsm
from filelock import FileLock

from missionfsm import systems
from missionfsm.pages.graph import MAX_STATES

pytestmark = [pytest.mark.slow, pytest.mark.long]

# One mission of a server goes through as much as two of a robot.
MISSIONS = {"bear.mission": 2, "bear.status": 1, "isaac.server": 1, "isaac.robot": 1}

# Presses buttons at random, with a seed; says how many steps that made.
WANDER = """
async ([seed, steps]) => {
  let number = seed;
  const next = (bound) => (number = (number * 48271) % 2147483647) % bound;
  let taken = 0;
  while (taken < steps) {
    const buttons = [...document.querySelectorAll("button[data-move]:not(:disabled)")];
    if (!buttons.length) break;
    const moved = new Promise((resolve) => addEventListener("hashchange", () => resolve(), { once: true }));
    buttons[next(buttons.length)].click();
    await moved;
    await new Promise((resolve) => setTimeout(resolve));
    taken += 1;
  }
  return taken;
}
"""


class Explorers:
    """The explorer of every system, as the command line writes it when it is first asked for.

    Args:
        folder: where all processes of the run find them.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __getitem__(self, name: str) -> Path:
        path = self._folder / f"{name}.html"
        with FileLock(f"{path}.lock"):
            if not path.exists():
                ended = missionfsm("explore", name, "--missions", MISSIONS[name], "--batch", 1, "--html", path)
                assert (ended.status in (0, 1), ended.err) == (True, "")
        return path


@pytest.fixture(scope="session")
def explorers(tmp_path_factory: pytest.TempPathFactory) -> Explorers:
    """The explorer of every system."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "explorers"
    folder.mkdir(exist_ok=True)
    return Explorers(folder)


def _press(page: Any, group: str, asked: str, answer: str) -> None:
    """Press the button with an answer to something that can be asked."""
    doing = page.locator(f"[data-group='{group}'] .doing").filter(has_text=asked).first
    doing.get_by_role("button", name=answer).first.click()


def _queue(page: Any) -> list[str]:
    texts: list[str] = page.locator(".mission").all_inner_texts()
    return [" ".join(text.split()) for text in texts]


def _comes_to(page: Any, *queue: str) -> None:
    """The page shows a queue that begins so as soon as it is drawn anew; an empty one is empty."""
    for _ in range(50):
        if (shown := _queue(page))[: len(queue) or None] == list(queue):
            return
        page.wait_for_timeout(100)
    assert shown == list(queue)


def _walked(page: Any) -> None:
    """Create, start, append, be refused, pause: five steps, the second by itself."""
    _press(page, "CreateMission", "servi delivery to", "OK")
    _press(page, "by itself", "runs when its turn comes", "happens")
    _press(page, "AppendMission", "base navigate", "OK")
    _press(page, "CreateMission", "base navigate", "FAILED_PRECONDITION")
    _press(page, "UpdateMission", "COMMAND_PAUSE) of mission-1", "OK")


AFTER = ["mission-1 paused serving table-1 table-2", "mission-2 waiting navigate table-1"]


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", ["desktop", "phone"])
@pytest.mark.parametrize("name", systems.names())
def test_it_fits_the_window(name: str, size: str, scheme: str, explorers: Explorers, open_page: Opener) -> None:
    """At the start and on the way, folded and unfolded, the page is as wide as the window."""
    seen = open_page(explorers[name], size, scheme)
    assert not seen.overflows()
    assert seen.page.evaluate(WANDER, [7, 5]) == 5
    seen.page.evaluate("for (const part of document.querySelectorAll('details')) part.open = true")
    assert not seen.overflows()


def test_it_is_clicked_through(explorers: Explorers, open_page: Opener) -> None:
    """Steps lead on, a refusal changes nothing and says why, and the way can be gone back and forth."""
    page = open_page(explorers["bear.mission"]).page
    expect(page.locator("#path .nothing")).to_be_visible()
    _walked(page)
    _comes_to(page, *AFTER)
    expect(page.locator("#path li")).to_have_count(5)
    refused = page.locator("[data-group='CreateMission'] .answer").first
    expect(refused.locator("button")).to_have_text("FAILED_PRECONDITION", use_inner_text=True)
    expect(refused).to_contain_text("A mission is running, paused or waiting", use_inner_text=True)
    expect(refused).to_contain_text("[Mission › CreateMission › Errors]", use_inner_text=True)
    page.get_by_role("button", name="← Back").click()
    page.get_by_role("button", name="← Back").click()
    _comes_to(page, "mission-1 running serving table-1 table-2")
    expect(page.locator("#path li.ahead")).to_have_count(2)
    page.get_by_role("button", name="Forward →").click()
    page.get_by_role("button", name="Forward →").click()
    _comes_to(page, *AFTER)
    expect(page.get_by_role("button", name="Forward →")).to_be_disabled()
    page.locator("#path li button").first.click()
    _comes_to(page, "mission-1 waiting serving table-1 table-2")
    page.get_by_role("button", name="Start again").click()
    _comes_to(page)


def test_the_buttons_of_the_browser_work(explorers: Explorers, open_page: Opener) -> None:
    """Every step is an entry of the browser's own history."""
    page = open_page(explorers["bear.mission"]).page
    _walked(page)
    page.go_back()
    _comes_to(page, "mission-1 running serving table-1 table-2")
    page.go_forward()
    _comes_to(page, *AFTER)


def test_a_link_restores_the_position(explorers: Explorers, open_page: Opener) -> None:
    """A copied link shows the same state, the same way there and the same switches; a foreign one says so."""
    page = open_page(explorers["bear.mission"]).page
    _walked(page)
    switch = page.locator("#readings > .reading button[aria-pressed='true']").first
    key = switch.get_attribute("data-reading")
    switch.click()
    page.get_by_role("button", name="Copy a link").click()
    link = page.evaluate("window.clipped")
    fragment = "#" + link.partition("#")[2]
    again = open_page(explorers["bear.mission"], fragment=fragment).page
    _comes_to(again, *AFTER)
    assert again.locator("#path li").all_inner_texts() == page.locator("#path li").all_inner_texts()
    expect(again.locator(f"[data-reading='{key}']")).to_have_attribute("aria-pressed", "false")
    expect(again.locator("#told")).to_be_hidden()
    for wrong in (fragment.replace("g=", "g=0"), "#p=0.0.99999", "#p=rubbish&at=-1&off=AM-99=z"):
        stray = open_page(explorers["bear.mission"], fragment=wrong).page
        _comes_to(stray)
        expect(stray.locator("#told")).to_be_visible()
        expect(stray.locator("#told")).to_contain_text("leads to the start", use_inner_text=True)


def test_a_reading_that_is_switched_off_hides_its_answers(explorers: Explorers, open_page: Opener) -> None:
    """Only answers under readings that are on are there, and those that are hidden are counted."""
    page = open_page(explorers["bear.mission"]).page
    _press(page, "CreateMission", "servi delivery to", "OK")
    chips = page.locator(".assumes")
    asked = {text.partition(" = ")[0] for text in chips.all_inner_texts()}
    assert asked
    one = min(asked)
    every = page.locator(".answer").count()
    for letter in page.locator(f"[data-ambiguity='{one}'] button").all():
        letter.click()
    left = chips.all_inner_texts()
    assert [text for text in left if text.partition(" = ")[0] == one] == []
    expect(page.locator(".hidden-note")).not_to_have_count(0)
    assert page.locator(".answer").count() < every
    page.locator("#all-readings").click()
    expect(page.locator(".answer")).to_have_count(every)
    page.locator("#reference-readings").click()
    asked_alone = page.evaluate(
        "[...document.querySelectorAll('.doing')].map((one) => one.querySelectorAll('.answer').length)"
    )
    assert set(asked_alone) == {1}


def test_a_reading_is_explained(explorers: Explorers, open_page: Opener) -> None:
    """The name of a reading beside an answer leads to its words, also on a phone, also where they are folded away."""
    page = open_page(explorers["bear.mission"], "phone").page
    page.locator("#readings-card > summary").click()
    chip = page.locator(".assumes").first
    reading = page.locator(f"[data-ambiguity='{chip.inner_text().partition(' = ')[0]}']")
    expect(reading).to_be_hidden()
    chip.click()
    expect(reading).to_be_visible()
    top = reading.evaluate("(one) => one.getBoundingClientRect().top")
    assert 0 <= top < page.evaluate("innerHeight")


def test_a_step_rules_readings_out(explorers: Explorers, open_page: Opener) -> None:
    """After a step that assumes a reading the others of its ambiguity cannot be switched on any more."""
    page = open_page(explorers["bear.mission"]).page
    _press(page, "UpdateMission", "COMMAND_CANCEL", "FAILED_PRECONDITION")
    ruled_out = page.locator("[data-reading]:disabled")
    expect(ruled_out).not_to_have_count(0)
    expect(ruled_out.first).to_contain_text("ruled out by a step on the way", use_inner_text=True)


@pytest.mark.parametrize("name", systems.names())
def test_what_was_clicked_conforms(name: str, explorers: Explorers, open_page: Opener, tmp_path: Path) -> None:
    """The history of any walk, under whatever readings it assumed, is one that the oracle explains."""
    page = open_page(explorers[name]).page
    for seed in (1, 2):
        assert page.evaluate(WANDER, [seed, 20]) == 20
        page.get_by_role("button", name="Copy as a history").click()
        copied = tmp_path / f"{seed}.jsonl"
        copied.write_text(page.evaluate("window.clipped"))
        page.get_by_role("button", name="Start again").click()
    checked = missionfsm("check", *(tmp_path / f"{seed}.jsonl" for seed in (1, 2)))
    assert (checked.status, checked.err) == (0, ""), checked.out


def test_the_copied_test_passes(explorers: Explorers, open_page: Opener) -> None:
    """What was clicked can be copied as a test, which passes, and fails once the history is another."""
    page = open_page(explorers["bear.mission"]).page
    _walked(page)
    page.get_by_role("button", name="Copy as a pytest").click()
    text = page.evaluate("window.clipped")
    for source, fails in ((text, False), (text.replace("FAILED_PRECONDITION", "NOT_FOUND"), True)):
        scope: dict[str, Any] = {}
        exec(source, scope)  # noqa: S102 - the text is what is tested
        (copied,) = (one for key, one in scope.items() if key.startswith("test_"))
        if fails:
            with pytest.raises(AssertionError, match="violates"):
                copied()
        else:
            copied()


def test_the_numbers_are_those_of_the_command_line(explorers: Explorers, open_page: Opener) -> None:
    """The page says what `explore` prints, and within which bounds; where it holds less than that, it says so."""
    told = missionfsm("explore", "isaac.robot", "--missions", 1, "--batch", 1).out.splitlines()[0]
    counts = told.partition(": ")[2]
    assert counts.startswith("13 states in 13 situations")
    shown = open_page(explorers["isaac.robot"]).page.locator("#bounds").inner_text()
    assert shown.startswith(f"{counts}, within the bounds size 1, goals 2, batch 1. What is tried")
    held = open_page(explorers["bear.mission"]).page.locator("#bounds").inner_text()
    assert f"; this page holds the {MAX_STATES} states that are nearest. What is tried" in held


def _shapes(page: Any, kind: str) -> list[str]:
    names: list[str] = page.locator(f"#stage .shape.{kind} b").all_inner_texts()
    return names


def test_the_map_shows_where_one_is_and_came_from_and_what_is_next(explorers: Explorers, open_page: Opener) -> None:
    """Shapes are called what the program calls them; one that is next leads on, one that was before leads back."""
    page = open_page(explorers["bear.mission"]).page
    assert (_shapes(page, "past"), _shapes(page, "here")) == ([], ["[no mission]"])
    expect(page.locator("#stage .here")).to_contain_text("one of 2 states", use_inner_text=True)
    _press(page, "CreateMission", "servi delivery to", "OK")
    assert (_shapes(page, "past"), _shapes(page, "here")) == (["[no mission]"], ["[WAITING]"])
    page.locator("#stage .next[data-shape='[RUNNING at goal 0]']").click()
    _comes_to(page, "mission-1 running serving table-1 table-2")
    assert (_shapes(page, "past"), _shapes(page, "here")) == (["[no mission]", "[WAITING]"], ["[RUNNING at goal 0]"])
    page.locator("#stage .shape.past").first.click()
    _comes_to(page)
    assert _shapes(page, "here") == ["[no mission]"]


def test_several_ways_to_a_shape_are_shown_alone(explorers: Explorers, open_page: Opener) -> None:
    """Where more than one step leads to a shape, only those are left to choose from, until all are wanted again."""
    page = open_page(explorers["bear.mission"]).page
    every = page.locator(".answer").count()
    some = page.locator("#stage .next[data-shape='[WAITING]']")
    ways = int(some.inner_text().partition("\n")[2].partition(" ways")[0])
    some.click()
    assert ways < every
    expect(page.locator(".answer")).to_have_count(ways)
    page.get_by_role("button", name="Show all").click()
    expect(page.locator(".answer")).to_have_count(every)


def test_readings_are_painted_on_the_map(explorers: Explorers, open_page: Opener) -> None:
    """What comes about under a reading alone is painted so and names it, and goes when the reading is switched off."""
    page = open_page(explorers["bear.mission"]).page
    _walked(page)
    painted = page.locator("#stage .shape.assumed, #stage .shape.departs")
    one = painted.filter(has_text="assumes ").first
    name, _, letter = one.inner_text().partition("assumes ")[2].partition(",")[0].split()
    page.locator(f"[data-reading='{name}={letter}']").click()
    under = page.locator("#stage .shape", has_text=re.compile(rf"assumes {re.escape(name)} = {letter}(,|$)"))
    under.first.wait_for(state="detached")


def test_all_shapes_hold_all_states(explorers: Explorers, open_page: Opener) -> None:
    """The map of all shapes names every one once, and their states are those of the page."""
    page = open_page(explorers["bear.mission"]).page
    page.get_by_role("button", name="All shapes").click()
    names = page.locator("#stage .shape b").all_inner_texts()
    assert len(names) == len(set(names)) > 20
    assert page.evaluate("Object.values(graph.shapes).reduce((sum, one) => sum + one)") == MAX_STATES


@pytest.mark.parametrize("size", ["desktop", "phone"])
def test_all_shapes_leave_no_side_empty(size: str, explorers: Explorers, open_page: Opener) -> None:
    """At the beginning, which is the first column, the map begins at its left, with what is next beside it."""
    page = open_page(explorers["bear.mission"], size).page
    page.get_by_role("button", name="All shapes").click()
    here, frame = page.locator("#stage .here").bounding_box(), page.locator("#map").bounding_box()
    assert here["x"] - frame["x"] == pytest.approx(12, abs=3)
    assert page.locator("#stage .next").first.bounding_box()["x"] < frame["x"] + frame["width"]


CROSSINGS = """
() => {
  const boxes = [...document.querySelectorAll("#stage .shape")].map((one) => one.getBoundingClientRect());
  const within = (x, y, box) => x > box.left + 2 && x < box.right - 2 && y > box.top + 2 && y < box.bottom - 2;
  const crossings = [...document.querySelectorAll("#stage .way")].filter((way) => {
    const to = way.getScreenCTM(), length = way.getTotalLength();
    return Array.from({ length: 41 }, (_, i) => way.getPointAtLength((length * i) / 40).matrixTransform(to))
      .some(({ x, y }) => boxes.some((box) => within(x, y, box)));
  }).length;
  const overlaps = boxes.filter((a, i) => boxes.some((b, j) => i < j && a.left < b.right && b.left < a.right
    && a.top < b.bottom && b.top < a.bottom)).length;
  return [crossings, overlaps, document.querySelectorAll("#stage .way").length];
}
"""


@pytest.mark.parametrize("size", ["desktop", "phone"])
@pytest.mark.parametrize("name", systems.names())
def test_no_line_of_the_map_crosses_a_shape(name: str, size: str, explorers: Explorers, open_page: Opener) -> None:
    """Wherever one stands no line runs through a shape, no shape covers another, and at most ten ways are next."""
    page = open_page(explorers[name], size).page
    for seed in range(1, 6):
        assert page.evaluate(WANDER, [seed, 2]) == 2
        crossings, overlaps, lines = page.evaluate(CROSSINGS)
        assert (crossings, overlaps) == (0, 0)
        assert 1 <= lines <= 10 + 2


def test_the_map_is_moved_and_zoomed(explorers: Explorers, open_page: Opener) -> None:
    """It follows the mouse, the keys and the buttons, and fits again when that is wanted."""
    page = open_page(explorers["bear.mission"]).page
    placed = "[view.x, view.y, view.scale]"
    first = page.evaluate(placed)
    box = page.locator("#map").bounding_box()
    page.mouse.move(box["x"] + 20, box["y"] + box["height"] - 10)
    page.mouse.down()
    page.mouse.move(box["x"] + 50, box["y"] + box["height"] - 30)
    page.mouse.up()
    assert page.evaluate(placed) == [first[0] + 30, first[1] - 20, first[2]]
    page.locator("#map").press("ArrowLeft")
    assert page.evaluate(placed) == [first[0] + 70, first[1] - 20, first[2]]
    page.get_by_role("button", name="Zoom in").click()
    assert page.evaluate(placed)[2] == pytest.approx(first[2] * 1.25)
    page.get_by_role("button", name="Fit").click()
    assert page.evaluate(placed) == first
