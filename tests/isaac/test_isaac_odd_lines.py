"""Lines that are not written as the wire has them: they may be understood or not, on either side."""

import json
from typing import Any

import pytest
from server_history import History

from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Outcome, Verdict

ONE, TWO = Uuid(1, 1 << 61 | 1), Uuid(2, 1 << 61 | 2)


def _written(payload: Any, channel: str, /, header: Any = None, **changes: Any) -> str:
    """A message whose header and payload are changed so; what is None is left out."""
    raw = json.loads(encode(Message(Header(channel, 1, 1), payload)))
    for part, change in (("header", header or {}), ("payload", changes)):
        raw[part] = {key: value for key, value in {**raw[part], **change}.items() if value is not None}
    return json.dumps(raw)


# The server.


def _reported(**changes: Any) -> History:
    line = _written(MissionStatusProto(ONE, WireStatus.RUNNING), "mission_status", **changes)
    return History().submit(1).robot(1).sends(1, 1).settles.drive("line", connection=1, line=line).settles


@pytest.mark.parametrize("shown", ["STARTED", "RUNNING"])
@pytest.mark.parametrize(
    "changes", [{"missionStatus": "RUNNING"}, {"missionStatus": 0}, {"header": {"proto": None}}], ids=str
)
def test_a_status_that_is_written_otherwise_counts_or_does_not(changes: Any, shown: str) -> None:
    """A server may count or ignore a status in capitals, as a number or without a type id, and goes on either way."""
    history = _reported(**changes).shows(shown)
    assert history.judged(no_flagged=True).outcome is Outcome.CONFORMS
    assert history.reports(1, 1, "running").settles.shows("RUNNING").judged().outcome is Outcome.CONFORMS


def test_whether_a_status_in_capitals_counts_is_decided_once() -> None:
    """A server that ignored one status in capitals may not count the next one."""
    twice = _reported(missionStatus="RUNNING").shows("STARTED")
    line = _written(MissionStatusProto(ONE, WireStatus.SUCCESS), "mission_status", missionStatus="SUCCESS")
    history = twice.drive("line", connection=1, line=line).settles
    assert history.shows("SUCCESS").judged(readings={"AI-10": "ab"}).outcome is Outcome.VIOLATES


@pytest.mark.parametrize("proto", [None, "10961607615765939303"])
@pytest.mark.parametrize("taken", [True, False])
def test_a_name_without_a_signed_type_id_counts_or_does_not(proto: str | None, *, taken: bool) -> None:
    """A server may or may not identify a robot by a name whose type id is missing or unsigned."""
    line = _written(TextProto("r"), "name", {"proto": proto})
    history = History().submit(1).drive("connect", connection=1).drive("line", connection=1, line=line)
    history = history.sends(1, 1).settles if taken else history.settles.waits(2).settles.says(1).sends(1, 1).settles
    assert history.judged(no_flagged=True).outcome is Outcome.CONFORMS


def test_a_mission_that_says_that_it_is_a_text_is_no_greeting() -> None:
    """A mission under the type id of a text is malformed; a text on the same channel is not."""
    proto = str(json.loads(_written(TextProto("hello"), "log"))["header"]["proto"])
    mission = {"connection": 1, "line": _written(MissionProto(ONE, "{}"), "mission", {"proto": proto})}
    greeting = {"connection": 1, "line": _written(TextProto("hello"), "mission")}
    for line, right in ((mission, False), (greeting, True)):
        history = History().robot(1)
        history.lines.append(line)
        assert history.settles.judged().conforms is right, line


GARBLED_LINES: tuple[dict[str, Any], ...] = (
    {"priority": 3},
    {"header": {"seq": "5"}},
    {"header": {"pubtime": "0x1"}},
    {"header": {"acqtime": 1.5}},
    {"header": {"uuid": "7"}},
    {"header": {"pubtime": "007"}},
)
"""Lines in which something is not written as documented."""


@pytest.mark.parametrize("shown", ["STARTED", "RUNNING"])
@pytest.mark.parametrize("changes", [*GARBLED_LINES, {"uuid": "1"}, {"uuid": {"lower": "+1"}}], ids=str)
def test_a_status_in_which_something_is_of_another_form_counts_or_does_not(changes: Any, shown: str) -> None:
    """A server may count or ignore a status with a member of another form, and has to count a well-formed one."""
    history = _reported(**changes).shows(shown)
    assert history.judged(no_flagged=True).outcome is Outcome.CONFORMS
    assert history.reports(1, 1, "running").settles.shows("STARTED").judged(no_flagged=True).conforms is False


@pytest.mark.parametrize("changes", GARBLED_LINES, ids=str)
@pytest.mark.parametrize("taken", [True, False])
def test_a_name_in_which_something_is_of_another_form_counts_or_does_not(changes: Any, *, taken: bool) -> None:
    """A server may or may not identify a robot by a name with a member of another form."""
    line = _written(TextProto("r"), "name", **changes)
    history = History().submit(1).drive("connect", connection=1).drive("line", connection=1, line=line)
    history = history.sends(1, 1).settles if taken else history.settles.waits(2).settles.says(1).sends(1, 1).settles
    assert history.judged(no_flagged=True).outcome is Outcome.CONFORMS


# The robot.

DRIVES = ("line", "behaviorSucceeded", "behaviorFailed", "advance")
SETTLED = {"settled": True}


def _says(uuid: Uuid, status: WireStatus) -> Any:
    return {
        "connection": 1,
        "line": encode(Message(Header("mission_status", 1, 1), MissionStatusProto(uuid, status))).decode(),
    }


def _arrives(uuid: Uuid, config: str = "{}", /, **changes: Any) -> Any:
    return {"drive": {"event": "line", "line": _written(MissionProto(uuid, config), "mission", **changes)}}


def _judged(*lines: Any, **options: Any) -> Verdict:
    return check(system("isaac.robot"), Head("isaac.robot", {}, DRIVES), (*lines, SETTLED), **options)


RUNS = (
    _says(ONE, WireStatus.RUNNING),
    SETTLED,
    {"drive": {"event": "behaviorSucceeded"}},
    _says(ONE, WireStatus.SUCCESS),
)
FAILS = (_says(ONE, WireStatus.FAILURE),)
NEXT = (SETTLED, _arrives(TWO), _says(TWO, WireStatus.RUNNING))
CONFIG = {"a": {"b": {"c": 1}}}


@pytest.mark.parametrize("then", [RUNS, ()], ids=["runs", "is ignored"])
@pytest.mark.parametrize(
    "changes",
    [
        {"header": {"proto": None}},
        {"header": {"proto": "9410896613310777529"}},
        {"config": {"serialized": CONFIG}},
        {"config": CONFIG},
    ],
    ids=str,
)
def test_a_mission_that_is_written_otherwise_runs_or_is_no_message(changes: Any, then: Any) -> None:
    """A robot may run or ignore a mission whose type id or configuration is written differently."""
    assert _judged(_arrives(ONE, **changes), *then, *NEXT, no_flagged=True).outcome is Outcome.CONFORMS


NUMBERS = {"uuid": {"lower": 1, "upper": 1 << 61 | 1}}


@pytest.mark.parametrize(
    "changes", [NUMBERS, {"header": {"proto": None}}, {"header": {"proto": "9410896613310777529"}}], ids=str
)
def test_a_mission_that_is_written_otherwise_may_fail(changes: Any) -> None:
    """A robot may fail a mission whose type id or uuid is written differently."""
    assert _judged(_arrives(ONE, **changes), *FAILS, *NEXT, no_flagged=True).outcome is Outcome.CONFORMS


GARBLED: tuple[dict[str, Any], ...] = (
    {"priority": 3},
    {"header": {"seq": "5"}},
    {"config": {"serialized": "{}", "version": 2}},
    {"uuid": {"lower": "01", "upper": str(1 << 61 | 1)}},
    {"uuid": {"lower": "+1", "upper": str(1 << 61 | 1)}},
    {"uuid": {"lower": "1.0", "upper": "1"}},
    {"uuid": "1"},
    {"uuid": {"lower": "18446744073709551616"}},
    {"config": 5},
    {"config": None},
    {"config": {}},
    {"config": {"serialized": None}},
    {"config": None, "header": {"proto": None}},
    {"config": ["{}"]},
    {"header": {"pubtime": "0x1"}},
)
"""Missions in which something is not written as documented."""


@pytest.mark.parametrize("then", [RUNS, FAILS, ()], ids=["runs", "fails", "is ignored"])
@pytest.mark.parametrize("changes", GARBLED, ids=str)
def test_nothing_is_said_of_a_mission_in_which_something_is_of_another_form(changes: Any, then: Any) -> None:
    """A robot may run, fail or ignore a mission with a member of another form."""
    assert _judged(_arrives(ONE, **changes), *then, *NEXT, no_flagged=True).outcome is Outcome.CONFORMS


@pytest.mark.parametrize("fails", [FAILS, ()])
@pytest.mark.parametrize("old", [RUNS[:1], (_says(TWO, WireStatus.FAILURE),)], ids=["goes on", "preempted"])
def test_such_a_mission_preempts_another_or_does_not(old: Any, fails: Any) -> None:
    """A mission with a malformed uuid may end the one that runs or leave it alone, and may fail or not."""
    preempted = old != RUNS[:1]
    shown = (*old, *fails) if preempted else (*fails, _says(TWO, WireStatus.RUNNING))
    lines = (_arrives(TWO), _says(TWO, WireStatus.RUNNING), SETTLED, _arrives(ONE, uuid="1"), *shown)
    assert _judged(*lines, no_flagged=True).outcome is Outcome.CONFORMS


def test_a_mission_in_a_line_of_another_form_does_not_end_by_itself() -> None:
    """Such a mission succeeds only if its behavior does, fails once, and has to be a mission at all."""
    succeeds = (_says(ONE, WireStatus.SUCCESS),)
    assert _judged(_arrives(ONE, priority=3), *RUNS[:2], *succeeds).outcome is Outcome.VIOLATES
    assert _judged(_arrives(ONE, priority=3), *FAILS, *FAILS).outcome is Outcome.VIOLATES
    noise = {"drive": {"event": "line", "line": "no json"}}
    assert _judged(noise, *FAILS).outcome is Outcome.VIOLATES


UNUSABLE = ("no json", "null", "", "[]", '{"a":1}')


@pytest.mark.parametrize("first", UNUSABLE)
@pytest.mark.parametrize("second", [*UNUSABLE, json.dumps(CONFIG)])
def test_what_becomes_of_one_kind_of_configuration_is_not_tied_to_another(first: str, second: str) -> None:
    """Some are passed over, some fail, some end the mission that runs, and some do not."""
    if first == second:
        return
    running = (_arrives(TWO), _says(TWO, WireStatus.RUNNING), SETTLED)
    preempted = (_says(TWO, WireStatus.FAILURE), *FAILS, SETTLED)
    goes_on = (*FAILS, _says(TWO, WireStatus.RUNNING), SETTLED)
    passes_over = (_arrives(Uuid(3, 3), second), SETTLED)
    verdict = _judged(_arrives(ONE, first), *FAILS, SETTLED, *passes_over, *NEXT)
    assert verdict.outcome is Outcome.CONFORMS
    verdict = _judged(*running, _arrives(ONE, first), *preempted, *running, _arrives(ONE, second), *goes_on)
    assert verdict.outcome is Outcome.CONFORMS
    again = _judged(*running, _arrives(ONE, first), *preempted, *running, _arrives(ONE, first), *goes_on)
    assert again.outcome is Outcome.VIOLATES


def test_a_mission_that_is_written_well_is_not_ignored() -> None:
    """A robot has to report a mission whose line is as documented."""
    assert _judged(_arrives(ONE), *NEXT).outcome is Outcome.VIOLATES


@pytest.mark.parametrize("config", [{"serialized": CONFIG}, CONFIG])
def test_a_configuration_that_is_no_text_may_be_unusable(config: Any) -> None:
    """A robot may fail a mission whose configuration is an object instead of a text."""
    assert _judged(_arrives(ONE, config=config), *FAILS, *NEXT, no_flagged=True).outcome is Outcome.CONFORMS


def test_a_configuration_of_unknown_nodes_may_be_passed_over_which_is_flagged() -> None:
    """AI-33.unknown c: a robot may ignore a mission that configures unknown nodes, which is flagged."""
    verdict = _judged(_arrives(ONE, json.dumps(CONFIG)), *NEXT)
    assert [one.reading for one in verdict.flagged] == ["AI-33.unknown=c"]


def test_a_configuration_of_unknown_nodes_may_be_unusable_which_is_flagged() -> None:
    """AI-33.unknown b: a robot may fail such a mission, which is flagged; one without configuration may not fail."""
    arrives = _arrives(ONE, json.dumps(CONFIG))
    verdict = _judged(arrives, *FAILS, *NEXT)
    assert [one.reading for one in verdict.flagged] == ["AI-33.unknown=b"]
    assert _judged(arrives, *FAILS, *NEXT, no_flagged=True).outcome is Outcome.VIOLATES
    assert _judged(_arrives(ONE), *FAILS, *NEXT).outcome is Outcome.VIOLATES


@pytest.mark.parametrize("then", [RUNS, FAILS])
def test_a_mission_whose_header_names_another_type_may_run_or_fail_which_is_flagged(then: Any) -> None:
    """AI-27.type b: what the header says is a status is none of the codelet's missions, which is passed over."""
    arrives = _arrives(ONE, header={"proto": "-8059665372481944188"})
    verdict = _judged(arrives, *then, *NEXT)
    assert verdict.outcome is Outcome.CONFORMS
    assert [one.reading for one in verdict.flagged] == ["AI-27.type=b"]
    assert _judged(arrives, *NEXT, no_flagged=True).outcome is Outcome.CONFORMS


def test_a_status_need_not_name_its_mission() -> None:
    """AI-10 a: on the page a status has no uuid of a mission; it is about the one that runs."""
    unnamed = [
        {"connection": 1, "line": _written(MissionStatusProto(None, status), "mission_status")}
        for status in (WireStatus.RUNNING, WireStatus.SUCCESS)
    ]
    ends = (unnamed[0], SETTLED, {"drive": {"event": "behaviorSucceeded"}}, unnamed[1])
    assert _judged(_arrives(ONE), *ends, no_flagged=True).outcome is Outcome.CONFORMS
    assert _judged(_arrives(ONE, uuid=None), *ends, no_flagged=True).outcome is Outcome.CONFORMS


def test_all_missions_that_are_queued_may_be_sent_at_once() -> None:
    """AI-11 b is what Robot Identification says, but each mission preempts the one before: so it is flagged."""
    history = History().submit(1).submit(2).robot(1)
    at_once = history.sends(1, 1).sends(1, 2).settles.judged()
    assert at_once.outcome is Outcome.CONFORMS
    assert [one.reading for one in at_once.flagged] == ["AI-11=b"]
    one = History().submit(1).submit(2).robot(1).sends(1, 1).settles.judged(no_flagged=True)
    assert one.outcome is Outcome.CONFORMS
