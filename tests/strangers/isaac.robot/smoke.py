"""Tries every subject of subjects.toml: nothing crashes, and each bug and choice differs from the base.

`python3 smoke.py` tries all, `python3 smoke.py NAME…` the named ones and says where they differ.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

from conversations import CONVERSATIONS, Json

HERE = Path(__file__).resolve().parent
SYSTEM = "isaac.robot"
LIMIT_SECONDS = 60
REUSED = frozenset({"the same twice", "malformed", "configurations"})
Transcripts = dict[str, list[Json]]


class Failed(Exception):
    """A subject did what no subject may do."""


def talk(command: list[str]) -> Transcripts:
    """Run all conversations with one process of a subject."""
    lines: list[Json] = [_request("initialize", {"protocolVersion": 1, "system": SYSTEM})]
    ends: list[tuple[str, int]] = []
    for name, (world, steps) in CONVERSATIONS.items():
        lines += [_request("reset", {"world": world})]
        lines += [_request(method, params) for method, params in steps]
        ends.append((name, len(lines)))
    text = "".join(json.dumps(line | {"id": number}) + "\n" for number, line in enumerate(lines))
    done = subprocess.run(
        ["nice", "-n", "10", *command],
        cwd=HERE,
        input=text,
        capture_output=True,
        text=True,
        timeout=LIMIT_SECONDS,
        check=False,
    )
    if done.returncode != 0:
        raise Failed(done.stderr[-2000:])
    answers = [json.loads(answer) for answer in done.stdout.splitlines()]
    transcripts: Transcripts = {}
    begin = next(index for index, answer in enumerate(answers) if answer.get("id") == 1)
    for name, end in ends:
        position = next(
            (index for index, answer in enumerate(answers) if answer.get("id") == end),
            len(answers),
        )
        transcripts[name] = answers[begin:position]
        begin = position
    return transcripts


def _request(method: str, params: Json) -> Json:
    return {"jsonrpc": "2.0", "method": method, "params": params}


def check(transcripts: Transcripts) -> None:
    """No adapter failure: every request is answered, and with no negative code."""
    for name, transcript in transcripts.items():
        answered = sum("id" in answer for answer in transcript)
        if answered != 1 + len(CONVERSATIONS[name][1]):
            raise Failed(f"{name}: {answered} answers")
        for answer in transcript:
            if "error" in answer:
                raise Failed(f"adapter failure: {answer}")


def check_missions(transcripts: Transcripts) -> None:
    """A mission has one final status at most, and none after it."""
    for name, transcript in transcripts.items():
        ended: set[str] = set()
        for answer in transcript:
            if answer.get("method") != "line" or name in REUSED:
                continue
            payload = json.loads(answer["params"]["line"])["payload"]
            if "missionStatus" not in payload:
                continue
            mission = json.dumps(payload["uuid"], sort_keys=True)
            if mission in ended:
                raise Failed(f"{name}: {payload} after the end")
            if payload["missionStatus"].lower() != "running":
                ended.add(mission)


def differences(base: Transcripts, other: Transcripts) -> list[str]:
    """The conversations in which two subjects differ."""
    return [name for name in base if _plain(base[name]) != _plain(other[name])]


def _plain(transcript: list[Json]) -> list[Json]:
    return [{name: member for name, member in answer.items() if name != "id"} for answer in transcript]


def first_difference(base: Transcripts, other: Transcripts, name: str) -> str:
    """The first answers that differ in a conversation."""
    for one, two in zip(_plain(base[name]), _plain(other[name]), strict=False):
        if one != two:
            return f"{name}\n  base  {json.dumps(one)}\n  other {json.dumps(two)}"
    return f"{name}: one is longer"


def subjects() -> list[dict[str, Any]]:
    """The entries of subjects.toml."""
    with (HERE / "subjects.toml").open("rb") as file:
        entries: list[dict[str, Any]] = tomllib.load(file)["subject"]
    return entries


def main() -> int:
    """Try the subjects; the exit status is the number of those that failed."""
    wanted = set(sys.argv[1:])
    base = talk(subjects()[0]["command"])
    failures = 0
    for subject in subjects():
        name = subject["name"]
        if wanted and name not in wanted:
            continue
        try:
            transcripts = talk(subject["command"])
            check(transcripts)
            if subject["verdict"] == "conforms":
                check_missions(transcripts)
        except Failed as failure:
            failures += 1
            print(f"FAILED {name}: {failure}")
            continue
        where = differences(base, transcripts)
        if not where and name != "base":
            failures += 1
            print(f"NO DIFFERENCE {name}")
        if wanted and where:
            print(f"{name}: {first_difference(base, transcripts, where[0])}")
        elif where:
            print(f"{name}: differs in {', '.join(where)}")
    print(f"{failures} failed")
    return min(failures, 100)


if __name__ == "__main__":
    sys.exit(main())
