"""Which missions may come to be sent: all that are, and few that are not, so that a log is decided where one was."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from random import Random

import pytest
from attrs import evolve
from server_history import History

from missionfsm.isaac.server.foresight import foresees, heeded
from missionfsm.isaac.server.inputs import NAME, STATUS, Connects, Drops, Incoming, Submission
from missionfsm.isaac.server.spec import SPEC
from missionfsm.isaac.server.state import Mission, Sends, Server, Status, World, first_link_ref, handle_ref, uuid_ref
from missionfsm.isaac.shared.drives import Passes
from missionfsm.isaac.shared.line import LineContent
from missionfsm.kernel.step import Step

SECOND = 1_000_000
FEW = 16
"""How many of the ways are looked at in which something may happen."""
NOTHING: frozenset[str] = frozenset()


def message(config: str = "{}") -> LineContent:
    return LineContent("mission", "mission", config, "text", named=True)


def submissions(random: Random, server: Server) -> list[tuple[str, tuple[Step, ...]]]:
    count = len(server.missions)
    upstream = random.sample(range(count), random.randint(0, min(2, count)))
    asked = Submission(
        random.choice(("r", "q", None)),
        config=random.choice(("{}", "{1}")),
        start=random.choice((None, SECOND, 5 * SECOND)),
        run=random.choice((None, SECOND)),
        upstream=len(upstream),
    )
    return [("submit", SPEC.outcomes(server, asked, tuple(map(handle_ref, upstream))))] if count < 6 else []


def driven(random: Random, server: Server) -> Iterator[tuple[str, tuple[Step, ...]]]:
    """What may be made happen in a state: what `foresees` is told of it, and how it happens."""
    events: list[tuple[Connects | Drops | Incoming | Passes, tuple[int, ...]]] = [
        (Passes(random.choice((0, SECOND // 2, SECOND, 6 * SECOND))), ())
    ]
    if len(server.links) < 3:
        events.append((Connects(), ()))
    for at in range(len(server.links)):
        link = first_link_ref(server) + at
        events.append((Incoming(NAME, random.choice(("r", "q")), "name"), (link,)))
        if random.random() < 0.2:
            events.append((Drops(), (link,)))
        for index, one in enumerate(server.missions):
            if one.sent:
                said = random.choice(("running", "running", "success", "failure"))
                events.append((Incoming(STATUS, said, "mission_status", named=True), (link, uuid_ref(index))))
    for event, refs in events:
        drive = SPEC.drives[event.name]
        yield (
            drive.heeded(event) if drive.heeded else "",
            tuple(itertools.islice(drive.steps(server, event, refs), FEW)),
        )


def life(random: Random, length: int) -> Iterator[tuple[Server, frozenset[str], Step]]:
    """States of a server, with what happens next, and how."""
    server = SPEC.initial(World(tolerance=random.choice((0, SECOND))))
    for _ in range(length):
        ways = [*submissions(random, server), *driven(random, server)]
        ways += [("", SPEC.urgent(server)), ("", SPEC.urgent(server)), ("", SPEC.spontaneous(server))]
        told, steps = random.choice([way for way in ways if way[1]])
        step = random.choice(steps)
        yield server, frozenset({told} - {""}), step
        server = step.after


@pytest.mark.parametrize("seed", range(12))
def test_every_mission_that_is_sent_is_foreseen(seed: int) -> None:
    """A server foresees every mission that it comes to send, by what happens in between, on its connection."""
    past: list[tuple[Server, frozenset[str]]] = []
    for server, told, step in life(Random(seed), 120):
        past = [(known, happened | told) for known, happened in (*past[-15:], (server, NOTHING))]
        for one in step.emits:
            if isinstance(one.view, Sends):
                for known, happened in past:
                    told_of = message(one.view.config)
                    assert foresees(known, (), told_of, (), happened, one.topic), (known, happened, one)


def waiting(**changes: object) -> Server:
    """A server with a robot, and a mission of it that waits for one of another."""
    first = Mission("r", "mission", None, "{}", None, None, status=Status.RUNNING, sent=True, sent_on=0)
    second = evolve(Mission("q", "mission", None, "{}", None, None, waits=(0,), depends=True), **changes)
    named = next(one.after for one in SPEC.drives["connect"].steps(Server(missions=(first, second)), Connects(), ()))
    heard = Incoming(NAME, "q", "name")
    return next(one.after for one in SPEC.drives["line"].steps(named, heard, (first_link_ref(named),)))


def test_what_waits_is_sent_after_a_success_alone() -> None:
    """A mission that waits is not foreseen where nothing but a failure, a sign of life or a question comes."""
    server, slot = waiting(), ("link", 0)
    told = [frozenset(), {"running"}, {"failure"}, {"statuses"}, {"success"}, {"line"}, {"submit"}, {"connect"}]
    assert [foresees(server, (), message(), (), frozenset(one), slot) for one in told] == [False] * 4 + [True] * 4
    assert foresees(waiting(waits=()), (), message(), (), NOTHING, slot)
    assert not foresees(waiting(waits=(), doomed=(Status.FAILED,)), (), message(), (), NOTHING, slot)
    assert not foresees(waiting(waits=()), (), message("{2}"), (), NOTHING, slot)
    assert foresees(waiting(), (), message(), (), NOTHING, None)


def test_a_status_is_heeded_as_it_is_only_where_it_is_beyond_doubt() -> None:
    """What is reported in capitals, or as nobody documents it, may be a success."""
    said = Incoming(STATUS, "failure", "mission_status", named=True)
    assert [heeded(said), heeded(evolve(said, odd=True)), heeded(evolve(said, garbled=True))] == [
        "failure",
        "line",
        "line",
    ]
    assert [heeded(Connects()), heeded(Drops()), heeded(Incoming(NAME, "failure"))] == ["connect", "disconnect", "line"]


def pairs(many: int, failing: int | None) -> History:
    """So many missions of one robot, and for each one of another robot that waits for it, which is sent in any case."""
    history = History()
    for number in range(1, many + 1):
        history.submit(number)
    for number in range(1, many + 1):
        history.submit(many + number, robot="q", upstream=[number])
    history.robot(2, "q").robot(1).waits(1).sends(1, 1)
    for number in range(1, many):
        history.reports(1, number, "running").waits(1)
        history.reports(1, number, "failure" if number == failing else "success").waits(1)
        history.sends(1, number + 1).sends(2, many + number).waits(1)
        history.reports(2, many + number, "running").reports(2, many + number, "success")
    return history.settles


@pytest.mark.parametrize(("many", "failing"), [(3, None), (3, 2), (4, None)])
def test_what_waits_for_a_failed_mission_is_decided(many: int, failing: int | None) -> None:
    """Missions of two robots that wait for one another are decided, though their times to start are over on the way."""
    history = pairs(many, failing)
    verdict = history.judged()
    assert verdict.outcome.value == ("violates" if failing else "conforms"), verdict
