"""Whatever stands in a file, it is judged or refused in one line: no traceback, no hang.

``MISSIONFSM_MUTATED=20000`` in the environment tries so many lines of each form, instead of a few hundred of all.
"""

from __future__ import annotations

import gzip
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import orjson
import pytest
from mutated import MANY, SECONDS, limited, mutated
from traffic import MISSION, hourly, one_more, walk

from missionfsm.app.recorded import check_file
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import UnreadableError
from missionfsm.systems import system
from missionfsm.tools.reference.subject import ReferenceSubject


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


def statuses() -> list[Any]:
    """The bare messages of a subscription to all that a robot says of itself."""
    of = system("bear.status")
    alphabet, random, reference = of.alphabet({}, Bounds()), Random(5), ReferenceSubject(of)
    reference.exchange("reset", {"world": alphabet.worlds[0]})
    opened = reference.exchange("SubscribeRobotStatus", {"selector": {"robotIds": {"ids": ["r1"]}}})
    assert opened.error is None
    reports = [one for one in (*alphabet.core_drives, *alphabet.drives) if one.get("event") == "report"]
    exchanges = [opened, *(reference.exchange("drive", random.choice(reports)) for _ in range(40))]
    found = [one.params["message"] for exchange in exchanges for one in exchange.after if one.method == "message"]
    assert len(found) > 5
    return found


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
    "bare statuses": statuses,
    "webhook": bodies,
    "fleet": fleet,
    "hourly": lambda: hourly(3).history,
    "anywhere": lambda: [{**(lines := history("bear.mission"))[0], "begins": "anywhere", "others": True}, *lines[4:]],
}


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
