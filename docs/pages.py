"""How big the pages are and how long a browser takes to show them: ``python docs/pages.py`` prints a table.

Each is made by the command that users make it with, and opened in Chromium from its file. `--keep FOLDER` keeps them.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import tempfile
from pathlib import Path

from howlong import PROGRAM, machine
from playwright.sync_api import sync_playwright

HISTORY = (
    Path(__file__).parent.parent / "tests" / "bear" / "edges" / "conform" / "AM-53-failed-without-having-run.jsonl"
)
FAULTY = f"{' '.join(PROGRAM)} adapter bear.mission | sed -u s/STATE_SUCCEEDED/STATE_CANCELED/"
SHORT = ("--seed", "1", "--examples", "5")
PAGES = {
    "explorer of bear.mission": ("explore", "bear.mission"),
    "explorer of bear.status": ("explore", "bear.status"),
    "explorer of isaac.server, one mission": ("explore", "isaac.server", "--missions", "1"),
    "explorer of isaac.robot": ("explore", "isaac.robot"),
    "report, a log that conforms": ("check", str(HISTORY)),
    "report, an implementation that conforms": ("conform", "bear.mission", *SHORT),
    "report, one that violates": ("conform", "bear.mission", *SHORT, "--", "sh", "-c", FAULTY),
    "teeth of isaac.robot": ("teeth", "isaac.robot"),
}
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
LOADED = "Math.round(performance.getEntriesByType('navigation')[0].loadEventEnd)"


def make(name: str, folder: Path) -> Path:
    """One of the pages, in a folder."""
    made = folder / f"{name.replace(', ', '-').replace(' ', '-')}.html"
    command = PAGES[name]
    at = command.index("--") if "--" in command else len(command)
    whole = [*PROGRAM, *command[:at], "--html", str(made), *command[at:]]
    subprocess.run(whole, stdout=subprocess.DEVNULL, check=False, cwd=folder)
    return made


def main() -> None:
    """Print the table."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--keep", metavar="FOLDER", type=Path)
    keep = options.parse_args().keep
    print(f"{machine()}\n\n| page | kB | loaded after ms |\n| --- | --- | --- |")
    with tempfile.TemporaryDirectory() as scratch, sync_playwright() as driver:
        folder = keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        for name in PAGES:
            path = make(name, folder)
            page = browser.new_page()
            page.goto(path.as_uri())
            size = path.stat().st_size / 1000
            print(f"| {name} | {size:,.0f} | {page.evaluate(LOADED):,} |", flush=True)
            page.close()
        browser.close()


if __name__ == "__main__":
    main()
