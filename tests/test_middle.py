"""Logs that begin while a robot is in use, and robots that others use as well."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import orjson
import pytest
from commandline import CommandLine
from traffic import navigate, one_more, readings_at_random, walk

from missionfsm.app.asked import judged_system
from missionfsm.app.recorded import check_file
from missionfsm.kernel.alphabet import Bounds
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.reference.subject import ReferenceSubject


@cache
def automaton(name: str, drives: tuple[str, ...], *, strict: bool, anywhere: bool, others: bool) -> Automaton:
    spec = judged_system(name, strict=strict, anywhere=anywhere, others=others).spec
    return Automaton(spec, drives)


def read(first: Any, lines: list[Any]) -> Judge:
    said = head(first)
    how = {"strict": said.strict, "anywhere": said.anywhere, "others": said.others}
    judge = Judge(
        judged_system(said.system, **how), said, automaton(said.system, said.drives, **how), apart=True, waits=False
    )
    for line in lines:
        if not judge.feed(line):
            break
    return judge


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 6, 7, 8])
def test_a_conforming_history_that_is_cut_anywhere_is_no_violation(seed: int) -> None:
    """However much of a right history is missing at its beginning, what is left is never a violation."""
    log = walk(seed, 14, readings_at_random(seed), drives=seed % 2 == 0)
    first = {**log.head, "begins": "anywhere", "transport": "strict"}
    wrong = {}
    for cut in range(len(log.lines)):
        judge = read(first, log.lines[cut:])
        if not judge.right:
            wrong[cut] = str(judge.verdict())
    assert wrong == {}


@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize("seed", range(1_000, 1_012))
def test_a_conforming_history_of_which_calls_are_hidden_is_no_violation(
    tmp_path: Path, seed: int, *, strict: bool
) -> None:
    """However many calls of a right history are somebody else's, it is never a violation where there are others."""
    random, log = Random(seed), walk(seed, 20, readings_at_random(seed) if seed % 3 == 0 else {}, drives=seed % 2 == 0)
    calls = [
        line for line in log.lines if "call" in line and line["method"] not in ("SubscribeMissionStatus", "cancel")
    ]
    hidden = {line["call"] for line in calls if random.random() < 0.4}
    left = [line for line in log.lines if hidden.isdisjoint((line.get("call"), line.get("return")))]
    first = {**log.head, "others": True} | ({"transport": "strict"} if strict else {})
    ((_, verdict),) = check_file(str(written(tmp_path / "log", [first, *left])))
    assert verdict.violation is None, str(verdict)


STATUS = judged_system("bear.status", strict=True)
STATUS_WORLD = STATUS.alphabet({}, Bounds()).worlds[0]


def status_log(seed: int, steps: int) -> list[Any]:
    """A conversation with the reference of `bear.status`: subscriptions, requests and whatever robots report."""
    random, reference, lines = Random(seed), ReferenceSubject(STATUS), list[Any]()
    reference.exchange("reset", {"world": STATUS_WORLD})
    alphabet = STATUS.alphabet(STATUS_WORLD, Bounds())
    prompts = [one for one in alphabet.inputs if "$" not in str(one.params)]
    drives = [one for one in alphabet.drives if one["event"] in ("report", "restart", "fault")]
    for number in range(1, steps + 1):
        lines += one_more(reference, random, number, prompts, drives)
        lines += [{"settled": True}] * (random.random() < 0.2)
    return lines


@pytest.mark.parametrize("drives", [(), ("report", "restart"), tuple(STATUS.spec.drives)])
@pytest.mark.parametrize("seed", range(2))
def test_a_log_of_statuses_that_is_cut_anywhere_is_no_violation(seed: int, drives: tuple[str, ...]) -> None:
    """However much of a right log of statuses is missing at its beginning, what is left is never a violation."""
    lines = status_log(seed, 24)
    first = {"missionfsm": 1, "system": "bear.status", "world": STATUS_WORLD, "drives": list(drives)}
    first |= {"begins": "anywhere", "transport": "strict"}
    wrong = {}
    for cut in range(0, len(lines), 2):
        judge = read(first, lines[cut:])
        if not judge.right:
            wrong[cut] = str(judge.verdict())
    assert wrong == {}


def shown(number: int, *missions: tuple[str, str], table: str = "table-1", stream: int = 1) -> Any:
    """A message that lists missions, each with its id and the end of its state's name."""
    listed = [
        {
            "missionId": name,
            "state": f"STATE_{state}",
            "missionType": {"baseType": "BASE_TYPE_NAVIGATE"},
            "goals": [{"destinationId": table}],
            "currentGoalIndex": 0,
        }
        for name, state in missions
    ]
    active = next((at for at, (_, state) in enumerate(missions) if state in ("RUNNING", "PAUSED")), -1)
    metadata = {"timestamp": "2025-04-01T17:05:00.001Z", "sequenceNumber": number}
    return {
        "stream": stream,
        "message": {"metadata": metadata, "missionStates": {"missions": listed, "currentMissionIndex": active}},
    }


def call(number: int, method: str, params: Any, answer: Any) -> list[Any]:
    return [{"call": number, "method": method, "params": params}, {"return": number, **answer}]


def told(number: int, command: str, answer: Any, mission: str = "A") -> list[Any]:
    asked = {"missionCommand": {"missionId": mission, "command": f"COMMAND_{command}"}}
    return call(number, "UpdateMission", asked, answer)


SETTLED = {"settled": True}
HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {"family": "servi"}, "transport": "strict"}
ANYWHERE, OTHERS = {**HEAD, "begins": "anywhere"}, {**HEAD, "others": True}
REFUSED = {"error": {"status": "FAILED_PRECONDITION", "message": ""}}
BUSY = shown(4211, ("X", "SUCCEEDED"), ("Y", "RUNNING"))
FIRST = [*call(1, "SubscribeMissionStatus", {}, {"result": {"stream": 1}}), shown(1)]
MINE = [*call(2, "CreateMission", navigate("table-1"), {"result": {"missionId": "A"}}), shown(2, ("A", "RUNNING"))]
THEIRS = shown(3, ("A", "SUCCEEDED"), ("T", "RUNNING"))


def cleared(*missions: str) -> list[Any]:
    return call(1, "ClearMissionStatus", {}, {"result": {"missionIds": list(missions)}})


RIGHT = {
    "nothing is known, so that any answer may be right": (ANYWHERE, call(1, "SkipGoal", {}, REFUSED), ""),
    "the state is shown and goes on": (ANYWHERE, [BUSY, shown(4212, ("X", "SUCCEEDED"), ("Y", "SUCCEEDED"))], ""),
    "an answer to a call from before": (ANYWHERE, [{"return": 9, "result": {}}, BUSY], ""),
    "a call from before takes effect": (
        ANYWHERE,
        [BUSY, shown(4212, ("X", "SUCCEEDED"), ("Y", "RUNNING"), ("Z", "DEFAULT"))],
        "LOG-01",
    ),
    "a stream from before": (ANYWHERE, [BUSY, shown(7, ("X", "SUCCEEDED"), ("Y", "RUNNING"), stream=2)], ""),
    "a stream from before ends": (ANYWHERE, [BUSY, {"stream": 5, "closed": True}], ""),
    "what had its way before the list was shown": (
        ANYWHERE,
        [*told(1, "FINISH", {"result": {}}, "X")[:1], BUSY, {"return": 1, "result": {}}],
        "",
    ),
    "a mission ends unseen and is cleared": (ANYWHERE, [BUSY, *cleared("X", "Y")], ""),
    "others create": (
        OTHERS,
        [*FIRST, *MINE, THEIRS, *call(3, "CreateMission", navigate("table-2"), REFUSED)],
        "LOG-02",
    ),
    "others create before it is shown": (
        OTHERS,
        [*FIRST, *call(2, "CreateMission", navigate("table-2"), REFUSED), shown(2, ("T", "RUNNING"))],
        "LOG-02",
    ),
    "others clear": (OTHERS, [*FIRST, *MINE, shown(3, ("A", "SUCCEEDED")), shown(4)], "LOG-02"),
    "others clear, which another stream shows later": (
        OTHERS,
        [
            *FIRST,
            *call(9, "SubscribeMissionStatus", {}, {"result": {"stream": 2}}),
            shown(1, stream=2),
            *MINE,
            *(shown(3, ("A", "SUCCEEDED")), shown(4), shown(2, ("A", "RUNNING"), stream=2)),
            *(shown(3, ("A", "SUCCEEDED"), stream=2), shown(4, stream=2)),
            *call(3, "CreateMission", navigate("table-1"), {"result": {"missionId": "B"}}),
        ],
        "LOG-02",
    ),
    "others cancel": (
        {**OTHERS, "drives": ["missionFailed"]},
        [*FIRST, *MINE, shown(3, ("A", "CANCELED"))],
        "LOG-02",
    ),
}
WRONG = {
    "an answer that no state allows": (ANYWHERE, call(1, "CreateMission", navigate("nowhere"), {"result": {}})),
    "a call that is refused for what is shown": (
        ANYWHERE,
        [BUSY, *call(1, "SkipGoal", {}, {"error": {"status": "NOT_FOUND", "message": ""}})],
    ),
    "a mission that has ended runs again": (ANYWHERE, [BUSY, shown(4212, ("X", "RUNNING"))]),
    "missions change places": (ANYWHERE, [BUSY, shown(4212, ("Y", "SUCCEEDED"), ("X", "SUCCEEDED"))]),
    "goals change": (ANYWHERE, [BUSY, shown(4212, ("X", "SUCCEEDED"), ("Y", "RUNNING"), table="table-2")]),
    "numbers go back": (ANYWHERE, [BUSY, shown(4210, ("X", "SUCCEEDED"), ("Y", "SUCCEEDED"))]),
    "we create while a mission is known to run": (
        {**ANYWHERE, "drives": ["goalReached", "missionSucceeded", "missionFailed"]},
        [BUSY, SETTLED, *call(1, "CreateMission", navigate("table-1"), {"result": {"missionId": "Z"}})],
    ),
    "what was shown had settled, and an unknown call adds to it": (
        ANYWHERE,
        [BUSY, SETTLED, shown(4212, ("X", "SUCCEEDED"), ("Y", "RUNNING"), ("Z", "DEFAULT"))],
    ),
    "what has ended is cleared while another mission runs": (ANYWHERE, [BUSY, *cleared("X")]),
    "not all that has ended is cleared": (
        ANYWHERE,
        [BUSY, shown(4212, ("X", "SUCCEEDED"), ("Y", "SUCCEEDED")), *cleared("Y")],
    ),
    "a mission that has ended is told to finish": (ANYWHERE, [BUSY, *told(1, "FINISH", {"result": {}}, "X")]),
    "a mission that we paused goes on by itself": (
        ANYWHERE,
        [BUSY, SETTLED, *told(1, "PAUSE", {"result": {}}, "Y"), SETTLED],
    ),
    "a mission of others runs again": (OTHERS, [*FIRST, *MINE, THEIRS, shown(4, ("A", "RUNNING"), ("T", "SUCCEEDED"))]),
    "what others have cleared comes again as a new mission": (
        OTHERS,
        [
            *(*FIRST, *MINE, shown(3, ("A", "SUCCEEDED")), shown(4)),
            *call(3, "CreateMission", navigate("table-1"), {"result": {"missionId": "A"}}),
        ],
    ),
    "what waits is gone while another mission goes on": (
        OTHERS,
        [*FIRST, *MINE, shown(3, ("A", "RUNNING"), ("T", "DEFAULT")), shown(4, ("A", "RUNNING"))],
    ),
    "nobody said that there are others": (HEAD, [*FIRST, *MINE, THEIRS]),
    "nobody said that it begins anywhere": (HEAD, [BUSY]),
}


@pytest.mark.parametrize("case", RIGHT)
def test_what_is_not_in_the_log_is_explained(case: str) -> None:
    """What was before the log, and what others do, is no violation; it is flagged where something has to be assumed."""
    first, lines, flag = RIGHT[case]
    judge = read(first, lines)
    assert judge.right, str(judge.verdict())
    flagged = {one.partition("=")[0] for one in judge.verdict().flagged}
    assert flagged & {"LOG-01", "LOG-02"} == ({flag} if flag else set())


@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize("states", [("SUCCEEDED", "SUCCEEDED"), ("SUCCEEDED", "RUNNING"), ("SUCCEEDED", "FAILED")])
def test_missions_have_one_order_on_all_streams(tmp_path: Path, states: tuple[str, str], *, strict: bool) -> None:
    """Others turn no list round: at most a robot that has restarted would show one, where that can be."""
    first = {name: said for name, said in OTHERS.items() if strict or name != "transport"}
    listed = list(zip("AT", states, strict=True))
    begun = [*FIRST, *MINE, THEIRS, shown(4, *listed)]
    again = call(9, "SubscribeMissionStatus", {}, {"result": {"stream": 2}})

    def verdict(*missions: tuple[str, str]) -> Any:
        lines = [*begun, *again, shown(4, *missions, stream=2)]
        return check_file(str(written(tmp_path / "log", [first, *lines])))[0][1]

    kept, turned = verdict(*listed), verdict(*reversed(listed))
    assert kept.violation is None
    assert not any(one.startswith("TR-05") for one in kept.flagged)
    assert turned.violation is not None or (not strict and any(one.startswith("TR-05") for one in turned.flagged))


OWN = [*call(1, "SubscribeMissionStatus", {}, {"result": {"stream": 1}}), BUSY]
ADDED = shown(4212, ("X", "SUCCEEDED"), ("Y", "RUNNING"), ("Z", "DEFAULT"))
UNDER_WAY = {
    "nothing": (OWN, False),
    "nothing, but the stream was opened before": (OWN[2:], True),
    "a call that is answered later": ([*OWN, {"return": 77, "result": {"missionId": "Z"}}], True),
    "a call that was answered before": ([{"return": 77, "result": {"missionId": "Y"}}, *OWN], False),
    "another stream": ([shown(4210, ("X", "SUCCEEDED"), ("Y", "RUNNING"), stream=9), *OWN], True),
    "a call of the log": ([OWN[0], *call(2, "SkipGoal", {}, REFUSED), *OWN[1:]], True),
}


@pytest.mark.parametrize("case", UNDER_WAY)
def test_a_stream_that_the_log_opens_shows_all_that_was_before(tmp_path: Path, case: str) -> None:
    """Unless something else is under way: then what the message shows may be older, or a call may still take effect."""
    lines, explained = UNDER_WAY[case]
    lines = [*lines[: len(lines) - (case == "a call that is answered later")], ADDED, *lines[lines.index(BUSY) + 1 :]]
    ((_, verdict),) = check_file(str(written(tmp_path / "log", [ANYWHERE, *lines])))
    assert (verdict.violation is None) is explained, str(verdict)
    if explained:
        assert [one.partition("=")[0] for one in verdict.flagged] == ["LOG-01"]


def test_of_a_pipe_nobody_knows_which_calls_from_before_are_answered() -> None:
    """There a minute has to have passed before a stream is opened."""
    for at, explained in ((None, True), (30.0, True), (90.0, False)):
        timed = [{**line, **({} if at is None else {"at": at})} for line in (*OWN, ADDED)]
        begun = {"return": 70, "result": {}, **({} if at is None else {"at": 0.0})}
        assert read(ANYWHERE, [begun, *timed]).right is explained


GONE = {"error": {"status": "NOT_FOUND", "message": ""}}
OURS = [*FIRST, *MINE]
DRIVEN = {"drives": ["goalReached", "missionSucceeded", "missionFailed"]}


BEFORE_THE_ANSWER = {
    "others paused": [*OURS, *told(3, "PAUSE", REFUSED), shown(3, ("A", "PAUSED"))],
    "others resumed": [
        *OURS,
        *told(3, "PAUSE", {"result": {}}),
        shown(3, ("A", "PAUSED")),
        *told(4, "RESUME", REFUSED),
        shown(4, ("A", "RUNNING")),
    ],
    "others cancelled": [*OURS, *told(3, "PAUSE", REFUSED), shown(3, ("A", "CANCELED"))],
    "others cancelled and created": [
        *OURS,
        *told(3, "CANCEL", GONE),
        shown(3, ("A", "CANCELED")),
        shown(4, ("A", "CANCELED"), ("T", "RUNNING")),
    ],
    "others created": [*FIRST, *call(2, "ClearMissionStatus", {}, REFUSED), shown(2, ("T", "RUNNING"))],
    "others cancelled, so that we could create": [
        *OURS,
        *call(3, "CreateMission", navigate("table-1"), {"result": {"missionId": "B"}}),
        shown(3, ("A", "CANCELED")),
        shown(4, ("A", "CANCELED"), ("B", "RUNNING")),
    ],
}


APPENDED = [*OURS, *call(3, "AppendMission", navigate("table-2"), {"result": {"missionId": "B"}})]
PAIR = {"missions": [navigate("table-2"), navigate("table-3")]}
OTHER_TYPE = {"serviType": "SERVI_TYPE_BUSSING"}


def listed(number: int, *missions: tuple[str, str, str], index: int = 0, mission_type: Any = None) -> Any:
    """A message that lists missions, each with its id, the end of its state's name, and where it goes."""
    line = shown(number, *((name, state) for name, state, _ in missions))
    for one, (_, _, table) in zip(line["message"]["missionStates"]["missions"], missions, strict=True):
        one |= {"goals": [{"destinationId": table}], "currentGoalIndex": index}
    line["message"]["missionStates"]["missions"][-1] |= {"missionType": mission_type} if mission_type else {}
    return line


RUNS, WAITS = ("A", "RUNNING", "table-1"), ("B", "DEFAULT", "table-2")
NOT_OTHERS = {
    "our mission has other goals": [*APPENDED, listed(3, RUNS, ("B", "DEFAULT", "table-3"))],
    "our mission has another type": [*APPENDED, listed(3, RUNS, WAITS, mission_type=OTHER_TYPE)],
    "a goal that no mission has": [*OURS, listed(3, RUNS, index=4)],
    "a mission that ran waits": [*APPENDED, listed(3, RUNS, WAITS), listed(4, ("A", "DEFAULT", "table-1"), WAITS)],
    "one id for two missions": [*OURS, *call(3, "AppendMissionBatch", PAIR, {"result": {"missionIds": ["B"]}})],
    "the ids of a batch are those of each other": [
        *OURS,
        *call(3, "AppendMissionBatch", PAIR, {"result": {"missionIds": ["B", "C"]}}),
        listed(3, RUNS, ("C", "DEFAULT", "table-2"), ("B", "DEFAULT", "table-3")),
    ],
    "an id that a mission has": [*OURS, *call(3, "AppendMission", navigate("table-2"), {"result": {"missionId": "A"}})],
    "a stream that has ended": [*OURS, {"stream": 1, "closed": True, "error": {"status": "INTERNAL"}}, shown(3)],
    "a number goes back": [*OURS, *told(3, "PAUSE", REFUSED), shown(1, ("A", "PAUSED"))],
}


@pytest.mark.parametrize("case", NOT_OTHERS)
def test_others_do_not_change_what_a_mission_is_nor_what_an_answer_says(
    command_line: CommandLine, tmp_path: Path, case: str
) -> None:
    """Others cannot give a mission other goals or another type, nor an id twice, nor make a stream go on that ended."""
    for first in (OTHERS, {key: value for key, value in OTHERS.items() if key != "transport"}):
        assert command_line("check", written(tmp_path / "log", [first, *NOT_OTHERS[case]])).status == 1


def test_a_snapshot_may_be_older_than_what_another_stream_has_shown(command_line: CommandLine, tmp_path: Path) -> None:
    """Of a robot in use, a second stream begins with what was before; a mission of others is cancelled unseen."""
    lines = [
        {"call": 1, "method": "SubscribeMissionStatus", "params": {}},
        {"call": 2, "method": "CreateMission", "params": navigate("table-1")},
        shown(2, ("A", "RUNNING"), stream=1),
        {"return": 1, "result": {"stream": 2}},
        {"return": 2, "result": {"missionId": "A"}},
        shown(0, stream=2),
        shown(3, ("A", "CANCELED"), stream=2),
        *call(3, "AppendMission", navigate("table-1"), REFUSED),
    ]
    first = {key: value for key, value in ANYWHERE.items() if key != "transport"}
    log = written(tmp_path / "log", [{**first, "others": True}, *lines])
    assert command_line("check", log).status == 0


def test_what_others_did_may_be_shown_by_one_stream_long_before_another(
    command_line: CommandLine, tmp_path: Path
) -> None:
    """A slow stream shows what was before a mission of others was cancelled unseen and ours could be created."""
    lines = [
        *OURS,
        *call(3, "SubscribeMissionStatus", {}, {"result": {"stream": 2}}),
        shown(2, ("A", "RUNNING"), stream=2),
        *call(4, "CreateMission", navigate("table-1"), {"result": {"missionId": "B"}}),
        shown(3, ("A", "PAUSED")),
        shown(4, ("A", "CANCELED")),
        shown(5, ("A", "CANCELED"), ("B", "RUNNING")),
        shown(3, ("A", "PAUSED"), stream=2),
        shown(4, ("A", "CANCELED"), stream=2),
    ]
    assert command_line("check", written(tmp_path / "log", [OTHERS, *lines])).status == 0


def written(path: Path, lines: list[Any]) -> Path:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    return path


@pytest.mark.parametrize("drives", [{}, DRIVEN])
@pytest.mark.parametrize("case", BEFORE_THE_ANSWER)
def test_what_others_did_may_be_shown_only_after_our_answer(
    command_line: CommandLine, tmp_path: Path, case: str, drives: Any
) -> None:
    """What somebody else did takes effect before our call and is seen later, whatever else explains the answer."""
    first = {key: value for key, value in HEAD.items() if key != "transport"} | drives
    for transport in ({}, {"transport": "strict"}):
        log = written(tmp_path / "log", [first | transport, *BEFORE_THE_ANSWER[case]])
        assert command_line("check", log, "--others").status == 0
        assert command_line("check", log).status == 1


@pytest.mark.parametrize("case", WRONG)
def test_what_no_caller_can_do_is_wrong(case: str) -> None:
    """What nobody can bring about, whoever called before or besides, is a violation."""
    first, lines = WRONG[case]
    judge = read(first, lines)
    assert judge.violation is not None


def test_what_no_state_shows_is_told_as_that() -> None:
    """Where nothing is known of what was before, a message that no state shows breaks the rule of what is wrong."""
    before = (("X", "SUCCEEDED"), ("A", "PAUSED"), ("Z", "DEFAULT"))
    resumed = call(
        2, "UpdateMission", {"missionCommand": {"missionId": "Z", "command": "COMMAND_RESUME"}}, {"result": {}}
    )
    judge = read(
        {**ANYWHERE, **DRIVEN}, [*FIRST[:2], shown(71, *before), *resumed, shown(72, *before[:2], ("Z", "RUNNING"))]
    )
    assert judge.violation is not None
    assert [one.what for one in judge.violation.expected] == ["any state that what was shown before can have become"]
    assert judge.violation.rules[0].id.endswith("/the-state-is-reported")
    assert judge.violation.notes == ("mission 2 is STATE_RUNNING, expected STATE_DEFAULT since it waits",)


def test_what_is_outstanding_for_long_is_late(command_line: CommandLine, tmp_path: Path) -> None:
    """After a silence of so many seconds everything has settled, also where the last message is said again."""
    head_line = {key: value for key, value in HEAD.items() if key != "transport"}
    lines = [
        *FIRST,
        *MINE,
        *call(3, "AppendMission", navigate("table-1"), {"result": {"missionId": "B"}}),
        shown(3, ("A", "RUNNING"), ("B", "DEFAULT")),
        shown(4, ("A", "SUCCEEDED"), ("B", "DEFAULT")),
        shown(5, ("A", "SUCCEEDED"), ("B", "DEFAULT")),
    ]
    path = tmp_path / "log"
    timed = [{**line, "at": 10.0 * number} for number, line in enumerate(lines)]
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in [head_line, *timed]))
    assert command_line("check", path).status == 0
    assert command_line("check", path, "--settled-after", "11").status == 0
    late = [*timed[:-1], {**timed[-1], "at": 500.0}]
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in [head_line, *late]))
    assert command_line("check", path).status == 0
    assert command_line("check", path, "--settled-after", "60").status == 1
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in [head_line, *lines]))
    ended = command_line("check", path, "--settled-after", "60")
    assert (ended.status, "--settled-after" in ended.err) == (2, True)


@pytest.mark.parametrize("option", [("--begins", "anywhere"), ("--others",)])
def test_a_system_that_cannot_be_judged_so_says_so(
    command_line: CommandLine, tmp_path: Path, option: tuple[str, ...]
) -> None:
    """A log of a system that can only be judged from its beginning is bad input, in one line."""
    path = tmp_path / "log"
    path.write_bytes(orjson.dumps({"missionfsm": 1, "system": "isaac.server", "world": {}}) + b"\n")
    ended = command_line("check", path, *option)
    assert (ended.status, ended.err.count("\n"), "isaac.server: " in ended.err) == (2, 1, True)


def battery(number: int, percent: int, stream: int = 1) -> Any:
    metadata = {"timestamp": "2025-04-01T17:05:00.001Z", "sequenceNumber": number}
    state = {"chargePercent": percent, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"}
    return {"stream": stream, "message": {"robotId": "r1", "metadata": metadata, "batteryState": state}}


def test_others_change_nothing_of_statuses(command_line: CommandLine, tmp_path: Path) -> None:
    """Nobody can do anything to a status: `--others` is taken, and explains nothing."""
    world = {"robots": [{"robotId": "r1", "locationId": "L1"}], "locations": [{"locationId": "L1"}]}
    first = {"missionfsm": 1, "system": "bear.status", "world": world}
    asked = {"selector": {"robotIds": {"ids": ["r1"]}}}
    opened = call(1, "SubscribeBatteryStatus", asked, {"result": {"stream": 1}})
    for percent in (50, 150):
        log = written(tmp_path / "log", [first, *opened, battery(18, percent)])
        alone, among_others = command_line("check", log), command_line("check", log, "--others")
        assert (among_others.status, among_others.out) == (alone.status, alone.out) == (int(percent > 100), alone.out)


def test_streams_of_statuses_from_before_the_log_are_held_to_their_form() -> None:
    """What comes on a stream that was opened before the log is right if it may come at all; on others all is judged."""
    world = {"robots": [{"robotId": "r1", "locationId": "L1"}], "locations": [{"locationId": "L1"}]}
    first = {"missionfsm": 1, "system": "bear.status", "world": world, "transport": "strict"}
    anywhere = {**first, "begins": "anywhere"}
    asked = {"selector": {"robotIds": {"ids": ["r1"]}}}
    opened = call(1, "SubscribeBatteryStatus", asked, {"result": {"stream": 1}})
    lines = [battery(17, 50, stream=4), battery(18, 49, stream=4)]
    assert (read(anywhere, lines).right, read(first, lines).right) == (True, False)
    assert not read(anywhere, [*lines, battery(16, 49, stream=4)]).right
    assert read(anywhere, [*opened, battery(19, 49)]).right
    assert not read(anywhere, [*opened, battery(19, 149)]).right


@pytest.mark.parametrize("strict", [True, False])
def test_a_restart_explains_no_list_that_no_robot_has(tmp_path: Path, *, strict: bool) -> None:
    """The first list of a log that begins anywhere is one that some robot shows, whatever was before."""
    first = {name: said for name, said in ANYWHERE.items() if strict or name != "transport"}
    opened = call(1, "SubscribeMissionStatus", {}, {"result": {"stream": 1}})

    def verdict(*missions: tuple[str, str]) -> Any:
        return check_file(str(written(tmp_path / "log", [first, *opened, shown(1, *missions), SETTLED])))[0][1]

    assert verdict(("X", "SUCCEEDED"), ("Y", "RUNNING")).violation is None
    found = verdict(("X", "RUNNING"), ("Y", "RUNNING")).violation
    assert found is not None
    assert found.rules


@pytest.mark.parametrize(
    ("option", "lines", "advised"),
    [
        ("--begins anywhere", [BUSY, SETTLED], True),
        ("--begins anywhere", [shown(1, ("X", "RUNNING"), ("Y", "RUNNING")), SETTLED], False),
        ("--begins anywhere", [*FIRST, *MINE, shown(4, ("A", "PAUSED"))], False),
        ("--others", [*FIRST, *MINE, THEIRS], True),
        ("--others", [*FIRST, *MINE, shown(4, ("A", "RUNNING"), ("T", "RUNNING"))], False),
    ],
)
def test_a_log_that_looks_like_one_of_these_is_told_so(
    tmp_path: Path, option: str, lines: list[Any], *, advised: bool
) -> None:
    """A violation names the option under which its line is explained, where the log looks as if that were so."""
    for path, more in ((tmp_path / "log", []), (tmp_path / "longer", [SETTLED] * 3)):
        found = check_file(str(written(path, [HEAD, *lines, *more])))[0][1].violation
        assert found is not None
        assert any(f"{option} explains this line" in note for note in found.notes) == advised, found.notes
