"""A real browser that notices what is wrong with a page."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browsing import Opener, Seen

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
SIZES = {"desktop": (1280, 900), "phone": (390, 844)}
CLIPBOARD = """
    Object.defineProperty(navigator, "clipboard", {
        value: { writeText: (text) => { window.clipped = text; return Promise.resolve(); } },
    });
"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A headless Chromium; while it runs, its event loop is that of the thread, so that no other can be run."""
    if CHROMIUM is None:
        pytest.skip("no Chromium to open pages with")
    playwright = pytest.importorskip("playwright.sync_api", reason="no playwright to steer Chromium with")
    with playwright.sync_playwright() as driver:
        # A profile is made for every browser, and is empty.
        started = driver.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS), headless=True)
        yield started
        started.close()


@pytest.fixture
def open_page(browser: Any) -> Iterator[Opener]:
    """Open a file as a page; at the end nothing was fetched but the file, and nothing went wrong in it."""
    opened: list[tuple[Path, Seen]] = []

    def opener(path: Path, size: str = "desktop", scheme: str = "light", fragment: str = "") -> Seen:
        width, height = SIZES[size]
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, offline=True)
        seen = Seen(context.new_page())
        seen.page.set_default_timeout(5000)
        seen.page.add_init_script(CLIPBOARD)
        seen.page.on("request", lambda request: seen.requests.append(request.url))
        seen.page.on("console", lambda message: seen.complaints.append(message.text))
        seen.page.on("pageerror", lambda error: seen.complaints.append(str(error)))
        seen.page.goto(path.as_uri() + fragment)
        opened.append((path, seen))
        return seen

    yield opener
    for path, seen in opened:
        fetched = {url.partition("#")[0] for url in seen.requests}
        # The icon is an empty one that stands in the page.
        assert fetched - {"data:,"} == {path.as_uri()}
        assert seen.complaints == []
        seen.page.context.close()
