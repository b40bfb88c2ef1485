"""How big the pages are and how long a browser takes to show them: ``python docs/pages.py`` prints a table.

Each is made by the command that users make it with, and opened in Chromium: reports and explorers from their files, the
status page of a mission server from the server. What a page complains of in the console ends this with status 1.
`--keep FOLDER` keeps the files.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from howlong import PROGRAM, machine
from playwright.sync_api import Browser, sync_playwright

ROOT = Path(__file__).parent.parent
HISTORY = ROOT / "tests" / "bear" / "edges" / "conform" / "AM-53-failed-without-having-run.jsonl"
FAULTY = f"{' '.join(PROGRAM)} adapter bear.mission | sed -u s/STATE_SUCCEEDED/STATE_CANCELED/"
SHORT = ("--seed", "1", "--examples", "5")
HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {}}
LOGS = {
    "contradiction.jsonl": (
        HEAD,
        {"call": 1, "method": "ClearMissionStatus", "params": {}},
        {"return": 1, "result": {"missionIds": []}},
        HEAD,
        {"call": 2, "method": "ClearMissionStatus", "params": {}},
        {"return": 2, "error": {"status": "FAILED_PRECONDITION", "message": "there is nothing to clear"}},
    ),
    "undecided.jsonl": (
        HEAD,
        {"call": 1, "method": "ClearMissionStatus", "params": {}},
        {"return": 1, "error": {"status": "INTERNAL", "message": "try again"}},
    ),
    "bare.jsonl": (
        {"metadata": {"sequenceNumber": 1}, "missionStates": {"missions": [], "currentMissionIndex": -1}},
        {"metadata": {"sequenceNumber": 2}, "missionStates": {"missions": [], "currentMissionIndex": -1}},
    ),
}
PAGES = {
    "explorer of bear.mission": ("explore", "bear.mission"),
    "explorer of bear.status": ("explore", "bear.status"),
    "explorer of isaac.server, one mission": ("explore", "isaac.server", "--missions", "1"),
    "explorer of isaac.robot": ("explore", "isaac.robot"),
    "report, a log that conforms": ("check", str(HISTORY)),
    "report, an implementation that conforms": ("conform", "bear.mission", *SHORT),
    "report, one that violates": ("conform", "bear.mission", *SHORT, "--", "sh", "-c", FAULTY),
    "report, two conversations that contradict each other": ("check", "contradiction.jsonl"),
    "report, nothing that can be judged": ("check", "undecided.jsonl"),
    "report, bare messages": ("check", "bare.jsonl"),
    "report, several logs": ("check", str(HISTORY), *LOGS),
    "teeth of isaac.robot": ("teeth", "isaac.robot"),
}
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
LOADED = "Math.round(performance.getEntriesByType('navigation')[0].loadEventEnd)"
MISSIONS = ROOT / "examples" / "isaac" / "walkthrough.json"


def make(name: str, folder: Path) -> Path:
    """One of the pages, in a folder that has the logs."""
    made = folder / f"{name.replace(', ', '-').replace(' ', '-')}.html"
    command = PAGES[name]
    at = command.index("--") if "--" in command else len(command)
    whole = [*PROGRAM, *command[:at], "--html", str(made), *command[at:]]
    subprocess.run(whole, stdout=subprocess.DEVNULL, check=False, cwd=folder)
    return made


@contextmanager
def status_page() -> Iterator[str]:
    """The address of the status page of a mission server that waits for its robots."""
    command = [*PROGRAM, "dispatch", str(MISSIONS), "--port", "0", "--http", "0", "--log", "json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as server:
        try:
            entries = (json.loads(line) for line in server.stdout or ())
            yield next(entry["address"] for entry in entries if entry["event"] == "status-page")
        finally:
            server.terminate()


def opened(browser: Browser, name: str, address: str) -> list[str]:
    """Open a page, print its size and its time, and return what it complains of."""
    page = browser.new_page()
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    answer = page.goto(address)
    size = len(answer.body()) if answer is not None else 0
    print(f"| {name} | {size / 1000:,.0f} | {page.evaluate(LOADED):,} |", flush=True)
    page.close()
    return [f"{name}: {one}" for one in complaints]


def main() -> None:
    """Print the table."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--keep", metavar="FOLDER", type=Path)
    keep = options.parse_args().keep
    complaints: list[str] = []
    print(f"{machine()}\n\n| page | kB | loaded after ms |\n| --- | --- | --- |")
    with tempfile.TemporaryDirectory() as scratch, sync_playwright() as driver:
        folder = (keep or Path(scratch)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        for name, lines in LOGS.items():
            (folder / name).write_text("".join(json.dumps(line) + "\n" for line in lines))
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        for name in PAGES:
            complaints += opened(browser, name, make(name, folder).as_uri())
        with status_page() as address:
            complaints += opened(browser, "status page of a mission server", address)
        browser.close()
    print("\n" + ("\n".join(complaints) or "no page complains of anything in the console"))
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
