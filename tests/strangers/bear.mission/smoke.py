"""Have every conversation with every subject: nothing breaks, and every variant differs from the base somewhere."""

from __future__ import annotations

import argparse
import json
import sys
import tomllib
from pathlib import Path
from typing import Any

from chat import Broken, Chat
from talks_more import TALKS

HERE = Path(__file__).parent


def converse(command: list[str], names: list[str], base: dict[str, list[Any]] | None = None) -> dict[str, list[Any]]:
    """The transcripts of one subject, by conversation; up to the first that differs from the base, if that is given."""
    chat = Chat(command)
    try:
        chat.ask("initialize", {"protocolVersion": 1, "system": "bear.mission"})
        found: dict[str, list[Any]] = {}
        for name in names:
            chat.transcript, chat.ids, chat.moments = [], [], {}
            TALKS[name](chat)
            found[name] = chat.transcript
            if base is not None and found[name] != base[name]:
                break
        chat.close()
        return found
    finally:
        chat.process.kill()
        chat.process.wait()


def parting(left: Any, right: Any, path: str = "") -> str:
    """The first place at which two values differ, with what stands there."""
    if isinstance(left, dict) and isinstance(right, dict):
        for name in [*left, *right]:
            if left.get(name) != right.get(name):
                return parting(left.get(name), right.get(name), f"{path}.{name}")
    if isinstance(left, list) and isinstance(right, list) and len(left) == len(right):
        for number, (one, other) in enumerate(zip(left, right, strict=True)):
            if one != other:
                return parting(one, other, f"{path}[{number}]")
    return f"{path} {json.dumps(left)[:150]} / {json.dumps(right)[:150]}"


def first_difference(base: list[Any], other: list[Any]) -> str:
    """Where two transcripts part."""
    for number, (left, right) in enumerate(zip(base, other, strict=False)):
        if left != right:
            return f"step {number} {left[0]}: {parting(left, right)}"
    return "their length"


def main() -> int:
    """Run and report; the exit status is 1 if anything is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--verbose", action="store_true", help="show where each variant first differs")
    parser.add_argument("--quick", action="store_true", help="end with the first conversation that differs")
    parser.add_argument("subjects", nargs="*", help="names of variants; all if none is named")
    options = parser.parse_args()
    subjects = tomllib.loads((HERE / "subjects.toml").read_text(encoding="utf-8"))["subject"]
    names = list(TALKS)
    base = converse(["python3", "robot.py"], names)
    problems = 0
    if converse(["python3", "robot.py"], names) != base:
        print("the base is not like itself")
        problems += 1
    for subject in subjects:
        if subject["command"] == ["python3", "robot.py"]:
            continue
        if options.subjects and subject["command"][-1] not in options.subjects:
            continue
        try:
            found = converse(subject["command"], names, base if options.quick else None)
        except (Broken, OSError, ValueError) as problem:
            print(f"BROKEN {subject['name']}: {problem}")
            problems += 1
            continue
        different = [name for name in found if found[name] != base[name]]
        if not different:
            print(f"SAME {subject['name']}")
            problems += 1
        elif options.verbose:
            print(f"{subject['name']}: {len(different)}, {different[0]}, ", end="")
            print(first_difference(base[different[0]], found[different[0]]))
    print(f"{len(subjects)} subjects, {len(names)} conversations, {problems} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
