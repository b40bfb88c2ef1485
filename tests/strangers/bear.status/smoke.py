"""Tries every subject of subjects.toml: nothing crashes, numbers are sound, and each bug differs from the base.

`python3 smoke.py` tries all, `python3 smoke.py NAME…` the named ones and says where they differ.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

from conversations import CONVERSATIONS, Json, Step, world

HERE = Path(__file__).resolve().parent
SYSTEM = "bear.status"
LIMIT_SECONDS = 60
NUMBERS_REPEAT: frozenset[str] = frozenset({"choice-maps-whole"})
Transcripts = dict[str, list[Json]]


class Failed(Exception):
    """A subject did what no subject may do."""


def requests(conversation: list[Step]) -> list[Json]:
    """The requests of one conversation, with a reset before them."""
    steps: list[Step] = [("reset", {"world": world()}), *conversation]
    return [{"jsonrpc": "2.0", "method": method, "params": params} for method, params in steps]


def talk(command: list[str]) -> Transcripts:
    """Run all conversations with one process of a subject; stream numbers are counted anew in each."""
    hello = {"jsonrpc": "2.0", "method": "initialize", "params": {"protocolVersion": 1, "system": SYSTEM}}
    lines: list[Json] = [hello]
    ends: list[tuple[str, int]] = []
    offset = 1
    for name, conversation in CONVERSATIONS.items():
        lines += requests(conversation)
        ends.append((name, len(lines)))
    for number, line in enumerate(lines):
        line["id"] = number
    process = subprocess.Popen(["nice", "-n", "10", *command], cwd=HERE, stdin=-1, stdout=-1, stderr=-1, text=True)
    opened: list[int] = []
    assert process.stdin is not None and process.stdout is not None and process.stderr is not None
    answers: list[Json] = []
    for line in lines:
        if line["method"] == "cancel" and line["params"]["stream"] == -1:
            line = line | {"params": {"stream": opened[-1] if opened else 0}}
        process.stdin.write(json.dumps(line) + "\n")
        process.stdin.flush()
        while True:
            text = process.stdout.readline()
            if not text:
                raise Failed(process.stderr.read()[-2000:])
            answer = json.loads(text)
            answers.append(answer)
            if answer.get("id") == line["id"]:
                break
        if "stream" in (answer.get("result") or {}):
            opened.append(answer["result"]["stream"])
    process.stdin.close()
    answers += [json.loads(text) for text in process.stdout]
    if process.wait(timeout=LIMIT_SECONDS) != 0:
        raise Failed(process.stderr.read()[-2000:])
    transcripts: Transcripts = {}
    for name, end in ends:
        position = next(index for index, answer in enumerate(answers) if answer.get("id") == end - 1) + 1
        transcripts[name] = answers[offset:position]
        offset = position
    return transcripts


def check(transcripts: Transcripts) -> None:
    """No adapter failure: no negative code, no message before the answer that carries its stream's number."""
    known: set[int] = set()
    for transcript in transcripts.values():
        for answer in transcript:
            if "error" in answer and answer["error"]["code"] < 0:
                raise Failed(f"adapter failure: {answer}")
            if "stream" in (answer.get("result") or {}):
                if answer["result"]["stream"] in known:
                    raise Failed("a stream number was used twice")
                known.add(answer["result"]["stream"])
            if answer.get("method") in ("message", "closed") and answer["params"]["stream"] not in known:
                raise Failed(f"a message before its stream: {answer}")


def metadata(message: Json) -> dict[str, int]:
    """The numbers in a message, by robot."""
    flat = {name.replace("_", "").lower(): value for name, value in message.items()}
    if "robotid" in flat:
        return {flat["robotid"]: _number(message)}
    entries = next(iter(message.values()))
    return {robot_id: _number(entry) for robot_id, entry in entries.items()}


def _number(holder: Json) -> int:
    inner: Json = holder["metadata"]
    number: Any = inner.get("sequenceNumber", inner.get("sequence_number", 0))
    return int(number)


def check_numbers(transcripts: Transcripts) -> None:
    """Numbers go up on every stream, robot by robot, but for restarts."""
    for name, transcript in transcripts.items():
        last: dict[tuple[int, str], int] = {}
        if name == "restarts":
            continue
        for answer in transcript:
            if answer.get("method") != "message":
                continue
            for robot_id, number in metadata(answer["params"]["message"]).items():
                key = (answer["params"]["stream"], robot_id)
                if number < 0 or 0 < number <= last.get(key, -1):
                    raise Failed(f"{name}: number {number} after {last[key]} on {key}")
                last[key] = number


def differences(base: Transcripts, other: Transcripts) -> list[str]:
    """The conversations in which two subjects differ."""
    return [name for name in base if _plain(base[name]) != _plain(other[name])]


def _plain(transcript: list[Json]) -> list[Json]:
    """Without ids and texts of errors, streams by the order in which the conversation opened them."""
    opened = [answer["result"]["stream"] for answer in transcript if "stream" in (answer.get("result") or {})]
    order = {number: position for position, number in enumerate(opened)}
    plain: list[Json] = []
    for answer in transcript:
        if "error" in answer:
            plain.append({"error": answer["error"]["data"]})
        elif "params" in answer:
            params: Json = answer["params"]
            plain.append({"shown": params | {"stream": order[params["stream"]]}})
        else:
            result: Json = answer["result"]
            plain.append({"result": {"opened": True} if "stream" in result else result})
    return plain


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
            if subject["verdict"] == "conforms" and name not in NUMBERS_REPEAT:
                check_numbers(transcripts)
        except Failed as failure:
            failures += 1
            print(f"FAILED {name}: {failure}")
            continue
        where = differences(base, transcripts)
        if not where and name != "base":
            failures += 1
            print(f"NO DIFFERENCE {name}")
        if wanted and where:
            print(f"{name}: {first_difference(base, transcripts, where[-1])}")
        elif where:
            print(f"{name}: differs in {', '.join(where)}")
    print(f"{failures} failed")
    return min(failures, 100)


if __name__ == "__main__":
    sys.exit(main())
