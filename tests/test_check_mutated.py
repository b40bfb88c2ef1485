"""Whatever stands in a file, it is judged or refused in one line: no traceback, no hang.

``MISSIONFSM_MUTATED=20000`` in the environment tries so many lines of each form, instead of a few hundred of all.
"""

from __future__ import annotations

import copy
import gzip
import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random
from typing import Any

import orjson
import pytest
from traffic import MISSION, one_more, walk

from missionfsm.app.recorded import check_file
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import UnreadableError
from missionfsm.systems import system
from missionfsm.tools.reference.subject import ReferenceSubject

MANY = int(os.environ.get("MISSIONFSM_MUTATED", "30"))
"""How many lines of each form are mutated."""
SECONDS = 60
"""After so many seconds a file counts as one that hangs."""
JUNK: tuple[Any, ...] = (
    *(
        None,
        True,
        False,
        0,
        -1,
        1,
        2**31,
        2**53 + 1,
        2**63,
        -(2**63),
        1e308,
        1.5,
        -0.0,
        "",
        "0",
        "NaN",
        "\x00",
        "\ud7ff",
    ),
    *(
        "STATE_RUNNING",
        "missionfsm",
        "mission-2",
        "\u2028\u202e",
        "x" * 5_000,
        [],
        {},
        [[]],
        [{}],
        {"": {}},
        {"seconds": "1"},
    ),
)


def _nested(depth: int) -> Any:
    found: Any = 1
    for _ in range(depth):
        found = [found]
    return found


def history(name: str, seed: int = 3) -> list[Any]:
    """A small conversation with the reference of a system."""
    if name == MISSION.name:
        return walk(seed, 8).history
    of = system(name)
    random, reference = Random(seed), ReferenceSubject(of)
    alphabet = of.alphabet({}, Bounds())
    world = alphabet.worlds[0]
    reference.exchange("reset", {"world": world})
    lines: list[Any] = [{"missionfsm": 1, "system": name, "world": world, "drives": list(of.spec.drives)}]
    prompts = [one for one in (*alphabet.core_inputs, *alphabet.inputs) if "$" not in str(one.params)]
    drives = [one for one in (*alphabet.core_drives, *alphabet.drives) if "$" not in str(one)]
    for number in range(1, 9):
        lines += one_more(reference, random, number, prompts, drives)
    return lines


def messages() -> list[Any]:
    """The bare messages of a subscription."""
    return [line["message"] for line in walk(3, 8).lines if "message" in line]


def bodies() -> list[Any]:
    """The bodies of a webhook."""
    return [
        {"robot_id": "r1", "state": {"metadata": one["metadata"], "missions": one["missionStates"]["missions"]}}
        for one in messages()
    ]


def fleet() -> list[Any]:
    """A log of two robots with the time on every line."""
    first, *rest = walk(3, 6).history
    timed = enumerate(rest)
    return [first, *({**line, "at": at, "robot": robot} for at, line in timed for robot in ("r1", "r2"))]


FORMS: dict[str, Callable[[], list[Any]]] = {
    **{
        name: lambda name=name: history(name) for name in ("bear.mission", "bear.status", "isaac.server", "isaac.robot")
    },
    "bare messages": messages,
    "webhook": bodies,
    "fleet": fleet,
    "anywhere": lambda: [{**(lines := history("bear.mission"))[0], "begins": "anywhere", "others": True}, *lines[4:]],
}


def mutated(random: Random, line: Any) -> bytes:
    """A line with something wrong in it, as JSON or as bytes."""
    sort = random.randrange(4)
    if sort == 0:
        raw = bytearray(orjson.dumps(line))
        for _ in range(random.randrange(1, 4)):
            at = random.randrange(len(raw))
            raw[at : at + random.randrange(3)] = bytes(random.randrange(256) for _ in range(random.randrange(3)))
        return bytes(raw).replace(b"\n", b" ")
    line = copy.deepcopy(line)
    holder, key = random.choice(list(_places(line)))
    if sort == 1:
        holder[key] = random.choice(JUNK)
    elif sort == 2:
        del holder[key]
    else:
        holder[key] = random.choice(
            [[holder[key], holder[key]], {"value": holder[key]}, str(holder[key]), _nested(random.choice((50, 500)))]
        )
    return orjson.dumps(line, default=str, option=orjson.OPT_NON_STR_KEYS) if sort != 3 else _dumped(line)


def _dumped(line: Any) -> bytes:
    try:
        return orjson.dumps(line)
    except orjson.JSONEncodeError:  # too deep for it to write
        return b"[" * 500 + b"]" * 500


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every member and every item, with what holds it."""
    for key in list(value) if isinstance(value, dict) else range(len(value)):
        yield value, key
        if isinstance(value[key], dict | list):
            yield from _places(value[key])


@contextmanager
def limited(seconds: int) -> Iterator[None]:
    """Raise TimeoutError after so many seconds."""

    def late(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("form", FORMS)
def test_what_is_wrong_in_a_line_is_judged_or_refused(tmp_path: Path, form: str) -> None:
    """A file with one wrong line has verdicts, or is refused in a line that names the file and the line."""
    random = Random(form)
    lines = FORMS[form]()
    path = tmp_path / "log.jsonl"
    raw = [orjson.dumps(line) for line in lines]
    judged, refused = 0, list[str]()
    for _ in range(MANY):
        place = random.randrange(len(lines))
        text = b"\n".join([*raw[:place], mutated(random, lines[place]), *raw[place + 1 :]]) + b"\n"
        path.write_bytes(text)
        try:
            with limited(SECONDS):
                verdicts = check_file(str(path))
            judged += all(str(verdict) for _, verdict in verdicts)
        except UnreadableError as error:
            refused.append(str(error))
    assert judged + len(refused) == MANY
    assert judged > 0
    assert [one for one in refused if not one.startswith(str(path)) or "\n" in one] == []


@pytest.mark.parametrize("form", ["gzip", "as it is"])
def test_bytes_that_are_wrong_are_judged_or_refused(tmp_path: Path, form: str) -> None:
    """A file in which bytes are wrong has verdicts, or is refused in one line."""
    random = Random(form)
    right = b"".join(orjson.dumps(line) + b"\n" for line in history("bear.mission"))
    path, refused = tmp_path / "log", list[str]()
    for _ in range(MANY):
        raw = bytearray(gzip.compress(right) if form == "gzip" else right)
        for _ in range(random.randrange(1, 4)):
            raw[random.randrange(len(raw))] = random.randrange(256)
        path.write_bytes(bytes(raw[: random.choice((len(raw), random.randrange(len(raw))))]))
        try:
            with limited(SECONDS):
                check_file(str(path))
        except UnreadableError as error:
            refused.append(str(error))
    assert refused
    assert [one for one in refused if "\n" in one] == []
