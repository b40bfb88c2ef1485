"""A transport that is not perfect: what it does to a right history is explained and flagged, and excuses no more."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import orjson
import pytest
from commandline import CommandLine
from traffic import COMMANDS, DRIVES, SUBSCRIBE, Recorder, delivery, navigate, readings_at_random, walk

from missionfsm.app.recorded import check_file
from missionfsm.kernel.transport import MADE_BY_CLIENTS, TRANSPORT
from missionfsm.tools.check.verdict import Outcome, Verdict


def judged(path: Path, lines: list[Any], **how: Any) -> Verdict:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    ((_, verdict),) = check_file(str(path), **how)
    return verdict


def flags(verdict: Verdict) -> set[str]:
    """The readings of the transport that it says are followed."""
    return {one.partition("=")[0] for one in verdict.flagged} & {one.id for one in TRANSPORT}


def day() -> Recorder:
    """A mission runs, another waits; the robot is driven."""
    log = Recorder()
    log.call(SUBSCRIBE)
    log.call("CreateMission", delivery("table-1", "table-2"))
    log.call("AppendMission", navigate("table-3"))
    log.drive(event="goalReached")
    return log


def shown(lines: list[Any]) -> list[int]:
    """Where messages are."""
    return [place for place, line in enumerate(lines) if "message" in line]


def closed(lines: list[Any], **more: Any) -> list[Any]:
    return [*lines, {"stream": 1, "closed": True, **more}, {"settled": True}]


def lost(lines: list[Any], place: int) -> list[Any]:
    gone = shown(lines)[place]
    return [*lines[:gone], *lines[gone + 1 :]]


def doubled(lines: list[Any], place: int) -> list[Any]:
    again = shown(lines)[place] + 1
    return [*lines[:again], lines[again - 1], *lines[again:]]


def restarted(lines: list[Any]) -> list[Any]:
    metadata = {"timestamp": "2025-04-01T17:05:00.001Z", "sequenceNumber": 0}
    message = {"metadata": metadata, "missionStates": {"missions": [], "currentMissionIndex": -1}}
    return [*lines, {"stream": 1, "message": message}]


def failed(status: str, *, applied: bool) -> list[Any]:
    """The history in which the answer to the second call is a status that a client made."""
    log = day()
    lines = [line for line in log.history if line.get("return") != 3]
    place = next(place for place, line in enumerate(lines) if line.get("call") == 3)
    if not applied:
        other = Recorder()
        other.call(SUBSCRIBE)
        other.call("CreateMission", delivery("table-1", "table-2"))
        place = len(other.history)
        lines = [*other.history, lines[next(at for at, line in enumerate(lines) if line.get("call") == 3)]]
        other.drive(event="goalReached")
        lines += other.history[place:]
    answer = {"return": 3, "error": {"status": status, "message": ""}}
    return [*lines[: place + 1], answer, *lines[place + 1 :], {"settled": True}]


def without_first() -> list[Any]:
    """The history of a second stream that begins with its second message."""
    log = day()
    log.call(SUBSCRIBE)
    lines = lost(log.history, -1)
    log.drive(event="goalReached")
    return [*lines, *log.history[len(lines) + 1 :]]


LINES = day().history
SETTLED = [*LINES, {"settled": True}]
CASES = {
    "a clean end": (closed(LINES), {"TR-01"}),
    "the client's deadline": (closed(LINES, error={"status": "DEADLINE_EXCEEDED"}), {"TR-01"}),
    "a client that is gone": (closed(LINES, error={"status": "UNKNOWN"}), {"TR-04"}),
    "a redelivery": (doubled(SETTLED, 1), {"TR-02"}),
    "the first message twice": (doubled(SETTLED, 0), {"TR-02"}),
    "the last message lost": (lost(SETTLED, -1), {"TR-03"}),
    "a restart": (restarted(LINES), {"TR-05"}),
}


@pytest.mark.parametrize("case", CASES)
def test_what_a_transport_does_is_explained_and_flagged(tmp_path: Path, case: str) -> None:
    """What a transport does to a right history is explained by the reading for it and no other; strictly it is not."""
    lines, wanted = CASES[case]
    verdict = judged(tmp_path / "log", lines)
    assert (verdict.conforms, flags(verdict)) == (True, wanted)
    assert not judged(tmp_path / "log", lines, strict=True).conforms
    assert not judged(tmp_path / "log", [{**lines[0], "transport": "strict"}, *lines[1:]]).conforms
    (ambiguity,) = wanted
    assert not judged(tmp_path / "log", lines, readings={ambiguity: "a"}).conforms
    assert " (seen where " in next(one for one in verdict.flagged if one.startswith(ambiguity))


@pytest.mark.parametrize("applied", [False, True])
@pytest.mark.parametrize("status", sorted(MADE_BY_CLIENTS))
def test_a_status_that_a_client_made_leaves_the_call_open(tmp_path: Path, status: str, *, applied: bool) -> None:
    """A call that came back with a status that any client makes may have taken effect or not."""
    assert judged(tmp_path / "log", failed(status, applied=applied)).conforms


def test_many_answers_that_never_came_are_no_violation(tmp_path: Path) -> None:
    """Where a client's deadline passed again and again, what was appended all the same is listed in its place."""
    log = Recorder()
    log.head["drives"] += ["fault"]  # so that the robot itself answers nothing of the kind
    log.call("CreateMission", navigate("table-1"))
    for _ in range(14):
        log.call("AppendMission", navigate("table-1"))
    log.call(SUBSCRIBE)
    passed = {"status": "DEADLINE_EXCEEDED", "message": "made up"}
    lines = [
        {"return": line["return"], "error": passed} if line.get("return") in (2, 5, 8, 10, 13) else line
        for line in log.history
    ]
    verdict = judged(tmp_path / "log", lines)
    assert (verdict.conforms, flags(verdict)) == (True, {"TR-04"})


FP = {"status": "FAILED_PRECONDITION", "message": ""}
BATCH = ("AppendMissionBatch", {"missions": [navigate("table-1")]})


def refused(method: str, params: Any = None, call: int = 70) -> list[Any]:
    """The history, then a call that is refused."""
    return [*LINES, {"call": call, "method": method, "params": params or {}}, {"return": call, "error": FP}]


def test_a_robot_may_be_too_old_for_calls_that_came_later(tmp_path: Path) -> None:
    """Software that is too old refuses every call that came later, and no other; what it has answered it knows."""
    lines = [*refused(*BATCH), *refused(*BATCH, 71)[len(LINES) :]]
    verdict = judged(tmp_path / "log", lines)
    assert (verdict.conforms, flags(verdict)) == (True, {"TR-06"})
    assert not judged(tmp_path / "log", lines, readings={"TR-06": "a"}).conforms
    known = [*lines[:-1], {"return": 71, "result": {"missionIds": ["n"]}}]
    assert judged(tmp_path / "log", known).violation is not None
    assert judged(tmp_path / "log", refused("AppendMission", navigate("table-1"))).violation is not None


LATER = {
    "something that was there goes on": [
        {
            "call": 71,
            "method": "UpdateMission",
            "params": {"missionCommand": {"missionId": "m1", "command": "COMMAND_PAUSE"}},
        },
        {"return": 71, "result": {}},
    ],
    "everything settles": [{"settled": True}],
    "nothing follows": [],
}


@pytest.mark.parametrize("later", LATER)
def test_a_restart_that_nobody_sees_excuses_nothing(tmp_path: Path, later: str) -> None:
    """An answer that only a restart explains is what is wrong, not the right line after it that shows otherwise."""
    wrong = refused("AppendMission", navigate("table-1"))
    verdict = judged(tmp_path / "log", [*wrong, *LATER[later]])
    assert verdict.violation is not None
    assert (verdict.violation.at, flags(verdict)) == (len(wrong), set())
    assert "AppendMission(base navigate to 'table-1') was answered FAILED_PRECONDITION" in verdict.violation.observed
    assert verdict.violation.history[-1] == wrong[-1]


def test_a_restart_that_is_seen_after_an_answer_explains_it(tmp_path: Path) -> None:
    """What was answered before the list is seen to be empty is explained, with the numbers from 0."""
    lines = [*refused("AppendMission", navigate("table-1")), *restarted(LINES)[len(LINES) :]]
    verdict = judged(tmp_path / "log", lines)
    assert (verdict.conforms, flags(verdict)) == (True, {"TR-05"})
    shown_later = [*lines, *refused("SkipGoal", {}, 71)[len(LINES) :]]
    assert judged(tmp_path / "log", shown_later).conforms


def test_a_restart_may_be_seen_after_the_end_of_a_log_in_use(tmp_path: Path) -> None:
    """In a log of a robot that nobody drives, which ends with the answer, the empty list may have come later."""
    head = {key: value for key, value in LINES[0].items() if key != "drives"}
    log = [head, *(line for line in day().history[1:] if "drive" not in line)]
    undriven = [
        *log[:-1],
        *refused("UpdateMission", {"missionCommand": {"missionId": "m1", "command": "COMMAND_PAUSE"}})[-2:],
    ]
    verdict = judged(tmp_path / "log", undriven)
    assert verdict.conforms, str(verdict)


WRONG = {
    "another message with the same number": [
        *LINES,
        {"stream": 1, "message": {**LINES[shown(LINES)[1]]["message"], "metadata": LINES[-1]["message"]["metadata"]}},
    ],
    "what was shown before comes after what was lost": [
        *lost(SETTLED, -1),
        {
            "stream": 1,
            "message": {
                **LINES[shown(LINES)[-2]]["message"],
                "metadata": {"timestamp": "2025-04-01T17:05:00Z", "sequenceNumber": 99},
            },
        },
    ],
    "an empty list though the numbers go on": [
        *LINES,
        {
            "stream": 1,
            "message": {
                "metadata": {"timestamp": "2025-04-01T17:05:00Z", "sequenceNumber": 99},
                "missionStates": {"missions": [], "currentMissionIndex": -1},
            },
        },
    ],
    "a status that no client makes": failed("NOT_FOUND", applied=False),
    "a stream that ends with a status that no client makes": closed(LINES, error={"status": "NOT_FOUND"}),
}


@pytest.mark.parametrize("case", WRONG)
def test_no_transport_excuses_it(tmp_path: Path, case: str) -> None:
    """What no transport does is a violation as before."""
    assert judged(tmp_path / "log", WRONG[case]).violation is not None


def test_the_first_message_of_a_stream_is_not_lost(tmp_path: Path) -> None:
    """A stream whose first message is one that was owed later is a violation where every change is a message."""
    lines = without_first()
    assert judged(tmp_path / "log", lines, readings={"AM-47.skip": "a"}).violation is not None
    assert judged(tmp_path / "log", lines).conforms


@pytest.mark.parametrize("seed", [2, 7])
def test_streams_that_never_show_anything_are_noticed_once_things_have_settled(tmp_path: Path, seed: int) -> None:
    """Whatever has happened unseen before: the first message of a stream that is open is neither late nor lost."""
    random, log = Random(seed), Recorder(drives=False)
    log.call(SUBSCRIBE)
    for _ in range(18):
        what = random.randrange(10)
        if what < 4:
            log.call(random.choice(("CreateMission", "AppendMission")), delivery("table-1", "table-2"))
        elif what < 7 and log.missions:
            command = {"missionId": random.choice(log.missions), "command": random.choice(COMMANDS)}
            log.call("UpdateMission", {"missionCommand": command})
        elif what < 9:
            log.call("SkipGoal" if what == 7 else SUBSCRIBE)
        else:
            log.drive(event=random.choice(DRIVES))
    log.settle()
    calls = [one for one in log.history if "message" not in one]
    assert judged(tmp_path / "log.jsonl", log.history).outcome is Outcome.CONFORMS
    verdict = judged(tmp_path / "log.jsonl", calls)
    assert verdict.violation is not None
    assert verdict.violation.observed == "everything settled"
    assert judged(tmp_path / "log.jsonl", calls[:-1]).outcome is not Outcome.VIOLATES


@pytest.mark.parametrize("seed", range(24))
def test_a_right_history_needs_no_transport(tmp_path: Path, seed: int) -> None:
    """Nothing of the transport is used where nothing happened to a history, whatever the readings."""
    log = walk(seed, 20, readings_at_random(seed))
    verdict = judged(tmp_path / "log", log.history)
    assert (verdict.conforms, flags(verdict)) == (True, set())


@pytest.mark.parametrize("seed", range(24))
def test_what_is_lost_and_doubled_at_random_is_explained(tmp_path: Path, seed: int) -> None:
    """Messages but the first of a stream may be lost and doubled anywhere, and streams may end: all of it conforms."""
    random = Random(seed)
    log = walk(seed, 20)
    lines: list[Any] = [log.history[0]]
    seen: set[int] = set()
    for line in log.lines:
        stream = line["stream"] if "message" in line else 0
        if stream and stream in seen and random.random() < 0.2:
            continue
        seen.add(stream)
        lines += [line] * (1 + (bool(stream) and random.random() < 0.2))
    for stream in log.streams[: random.randrange(2)]:
        lines.append({"stream": stream, "closed": True})
    verdict = judged(tmp_path / "log", lines)
    assert verdict.conforms, str(verdict)


def test_the_option_makes_the_transport_strict(command_line: CommandLine, tmp_path: Path) -> None:
    """``--transport strict`` leaves the readings of the transport out; the first line may say the same."""
    path = tmp_path / "log"
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in CASES["a clean end"][0]))
    assert command_line("check", path).status == 0
    strict = command_line("check", path, "--transport", "strict")
    assert (strict.status, "stream 1 ended cleanly" in strict.out) == (1, True)


@pytest.mark.parametrize(("key", "value"), [("transport", "lossy"), ("transport", True), ("begins", "here")])
def test_a_first_line_that_says_something_unknown_is_refused(
    command_line: CommandLine, tmp_path: Path, key: str, value: Any
) -> None:
    """What the first line says of the transport and of the beginning is one word each, or left out."""
    path = tmp_path / "log"
    path.write_bytes(orjson.dumps({**LINES[0], key: value}))
    ended = command_line("check", path)
    assert (ended.status, ended.err.startswith(f"missionfsm: {path}:1: {key}: ")) == (2, True)


def test_a_log_that_only_a_transport_might_explain_says_how_to_decide_it(tmp_path: Path) -> None:
    """Where there is too much that a transport may have done, the verdict says how to leave it out; that decides."""
    log = Recorder(drives=False)
    log.call(SUBSCRIBE)
    log.call("CreateMission", navigate("table-1"))
    lines, tables = log.lines, ("table-1", "table-2", "table-3", "table-1")
    lines += [{"call": 90 + at, "method": "AppendMission", "params": navigate(one)} for at, one in enumerate(tables)]
    lines += [{"return": 90 + at, "result": {"missionId": f"m{at}"}} for at in range(len(tables))]
    message = orjson.loads(orjson.dumps(lines[shown(lines)[-1]]))
    states = message["message"]["missionStates"]
    message["message"]["metadata"]["sequenceNumber"] += 1
    turned_round = [("m3", "table-2"), ("m2", "table-3"), ("m1", "table-2"), ("m0", "table-1")]
    waits = {"state": "STATE_DEFAULT", "currentGoalIndex": 0, "missionType": states["missions"][0]["missionType"]}
    states["missions"] += [{"missionId": name, "goals": [{"destinationId": at}], **waits} for name, at in turned_round]
    found = judged(tmp_path / "log", [log.head, *lines, message, {"settled": True}])
    assert found.outcome is not Outcome.CONFORMS
    assert found.outcome is Outcome.VIOLATES or "--transport strict leaves that out" in found.because
    assert judged(tmp_path / "log", [log.head, *lines, message, {"settled": True}], strict=True).violation
