"""What a person is told of a mission that was sent though it was not due."""

import re

import pytest
from attrs import evolve
from server_history import SERVER, History

from missionfsm.isaac.shared.line import new_uuid, uuid_name
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto, Uuid, WireStatus
from missionfsm.oracle.transcript import Head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.narrate import story
from missionfsm.tools.check.needed import disregarding, ways_to_break
from missionfsm.tools.check.phrases import name_words


def _told(history: History, **options: object) -> str:
    verdict = history.judged(**options)
    assert verdict.violation is not None
    return str(verdict)


def _first(**mission: object) -> History:
    return History().submit(1, config={"a": {"b": {"c": 1}}}, **mission)


A = '{"a":{"b":{"c":1}}}'


def test_a_story_tells_a_uuid_once_a_line() -> None:
    """A robot that stamps a status with the uuid of its mission names one thing, though twice; two are two things."""
    mission, other = Uuid(1234567890123456789, 1 << 62), Uuid(1234567890123456780, 1 << 62)
    payload = MissionStatusProto(mission, WireStatus.RUNNING)
    begun = History().robot(1)
    for stamp in (mission, other):
        line = encode(Message(Header("mission_status", 1, 1, stamp), payload)).decode().strip()
        begun = begun.drive("line", connection=1, line=line)
    told = story(SERVER, ({"missionfsm": 1, "system": "isaac.server", "world": {}}, *begun.lines)).splitlines()
    assert [re.findall(r"uuid no. \d", line) for line in told[-2:]] == [["uuid no. 1"], ["uuid no. 1", "uuid no. 2"]]


def test_an_upstream_has_not_succeeded() -> None:
    """The violation says that an upstream has not succeeded yet."""
    history = _first().submit(2, upstream=[1]).robot(1).sends(1, 1, A).settles.sends(1, 2)
    assert "an upstream of the mission with that configuration has not succeeded" in _told(history)


def test_an_upstream_has_failed() -> None:
    """The violation says that an upstream has failed, and does not say that nothing changed."""
    begun = _first().robot(1).sends(1, 1, A).settles.reports(1, 1, "failure").settles.shows("FAILED")
    told = _told(begun.submit(2, upstream=[1]).sends(1, 2), readings={"AI-10": "ab"})
    assert "an upstream of the mission with that configuration has failed" in told
    assert "nothing changed since" not in told


def test_a_mission_is_sent_twice() -> None:
    """The violation says that the mission was sent before."""
    history = _first().robot(1).sends(1, 1, A).settles.sends(1, 1, A)
    assert "the mission with that uuid was sent already" in _told(history)


def test_a_mission_has_ended() -> None:
    """The violation says that the mission has ended, and how."""
    begun = _first().robot(1).sends(1, 1, A).settles.reports(1, 1, "success").settles.shows("SUCCESS")
    assert "the mission with that uuid has ended, it is success" in _told(begun.sends(1, 1, A))
    never = History().submit(1, start_timeout=2).settles.waits(9).settles.shows("FAILED_TIMEDOUT").robot(1)
    assert "the mission with that configuration has ended, it is timed out" in _told(never.sends(1, 1))


def test_a_mission_is_for_another_robot() -> None:
    """The violation says for which robot the mission is, and whose connection it came on."""
    history = _first(robot="q").robot(1).settles.sends(1, 1, A)
    assert "the mission with that configuration is for 'q', the connection is that of 'r'" in _told(history)
    nobody = _first().drive("connect", connection=1).settles.sends(1, 1, A)
    assert "is for 'r', the connection has said no name" in _told(nobody)


def test_a_line_that_is_due_never_comes() -> None:
    """Also where only what comes later shows it: what was sent last on each connection is said."""
    begun = History().robot(1, "a").robot(2, "b").robot(3, "c").submit(1, robot="a", timeout=60).sends(1, 1)
    begun.submit(2, robot="b", upstream=[1], start_timeout=8).submit(3, robot="c", upstream=[1], timeout=40.5)
    begun.submit(4, robot="a", upstream=[2, 3]).submit(5, robot="b", upstream=[4]).submit(6, robot="c")
    begun = begun.waits(1).settles.reports(1, 1, "running").waits(3).settles
    begun = begun.reports(1, 1, "success").sends(2, 2).sends(3, 3).waits(2).settles
    begun.shows("SUCCESS", "STARTED", "STARTED", "QUEUED", "QUEUED", "QUEUED")
    begun = begun.reports(2, 2, "running").reports(3, 3, "running").waits(2).settles
    begun = begun.reports(2, 2, "success").waits(2).settles
    stays = ("SUCCESS", "SUCCESS", "RUNNING", "QUEUED", "QUEUED", "QUEUED")
    verdict = begun.shows(*stays).reports(3, 3, "failure").waits(3).settles.shows(*stays).judged()
    assert verdict.violation is not None
    assert verdict.violation.observed == "everything settled"
    told = str(verdict)
    assert "nothing new" not in told
    assert "a line is due that does not come; connection 1 showed a mission on mission" in told


def test_a_robot_is_busy() -> None:
    """The violation says with which mission, and that it is under way."""
    begun = _first().submit(2).robot(1).sends(1, 1, A).settles.reports(1, 1, "running").settles
    told = _told(begun.shows("RUNNING", "QUEUED").sends(1, 2), readings={"AI-11": "a"})
    assert f"its robot is busy: the one with {A} is running" in told
    assert "nothing changed since" not in told


def test_a_mission_was_never_accepted() -> None:
    """The violation says that no such mission was accepted."""
    history = History().submit(1, refused=True, start_timeout=-1).robot(1).sends(1, 1)
    assert "a mission with that channel and that configuration was never accepted" in _told(history)


@pytest.mark.parametrize("name", [uuid_name(Uuid(2, 7)), new_uuid(3)])
def test_a_uuid_is_told_by_its_halves(name: object) -> None:
    """A uuid is written in words and in JSON by its lower and upper half, as a log has them."""
    uuid = Uuid.of(name[1])  # type: ignore[index]
    assert name_words(name) == f"uuid (lower {uuid.lower}, upper {uuid.upper})"
    assert SERVER.naming.write(name) == {"lower": str(uuid.lower), "upper": str(uuid.upper)}


def test_what_ended_is_told_before_what_is_cancelled_for_it() -> None:
    """Where a mission is given up too early and another is cancelled for it, the limit is what is told of."""
    history = History().submit(1).submit(2, upstream=[1]).robot(1).sends(1, 1).settles
    early = history.waits(1).settles.shows("FAILED_TIMEDOUT", "FAILED_UPSTREAM").judged()
    assert early.violation is not None
    assert "is shown as timed out" in str(early)
    assert "no upstream of it has failed" not in str(early)
    alone = History().submit(1).submit(2, upstream=[1]).robot(1).sends(1, 1).settles.shows("STARTED", "FAILED_UPSTREAM")
    assert "shown as canceled, though no upstream of it has failed" in str(alone.judged())


@pytest.mark.parametrize("rule", sorted({one.rule for one in SERVER.step_mutations}))
def test_a_server_that_may_break_a_rule_can_be_followed(rule: str) -> None:
    """Whether a rule has a part in a violation is asked of a server that breaks it: no wrong step is a crash."""
    history = History().submit(1).submit(2, upstream=[1], timeout=2).submit(3).robot(1).sends(1, 1).settles
    history = history.reports(1, 1, "failure").waits(1).sends(1, 3).waits(3).shows("FAILED", "SUCCESS", "RUNNING")
    spec = disregarding(SERVER.spec, ways_to_break(SERVER, rule))
    given = Head("isaac.server", {}, tuple(history.drives))
    judge = Judge(evolve(SERVER, spec=spec), given, waits=False)
    followed = [judge.feed(line) for line in history.lines]
    assert any(followed)
    assert judge.events
