"""A server that dies at any write, and one that goes on from its journal: nothing is lost, nothing done twice."""

import itertools
import os
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import attrs
import pytest
from isaac_helpers import FAILURE, RUNNING, SUCCESS, Driver, says_name, uuid

from missionfsm.adapters.isaac.journal import Bookkeeper, Journal, JournalError
from missionfsm.isaac.runtime.missions import (
    RESUME,
    Effect,
    MissionRequest,
    Refused,
    Send,
    Snapshot,
    Status,
    StatusChanged,
)
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto, Uuid


class CrashError(Exception):
    pass


class CrashingJournal(Journal):
    """Dies at a write: before it is on the disk, or after."""

    def __init__(self, path: Path, writes: int, *, before: bool) -> None:
        super().__init__(path)
        self.left, self.before = writes, before

    def write(self, new: Iterable[Snapshot] = (), changed: Iterable[Snapshot] = (), gone: Iterable[Uuid] = ()) -> None:
        self.left -= 1
        if self.left == 0 and self.before:
            raise CrashError
        super().write(new, changed, gone)
        if self.left == 0:
            raise CrashError


@attrs.define(slots=False)
class World:
    """Robots that report, on a server that keeps a journal; what is told is told after it was written."""

    journal: Journal
    resume: str
    profile: Profile = DOCUMENTED
    accepted: set[Uuid] = attrs.Factory(set)
    told: list[tuple[Uuid, Status]] = attrs.Factory(list)
    sent: list[tuple[Uuid, Uuid]] = attrs.Factory(list)
    fresh: Iterator[int] = attrs.Factory(lambda: itertools.count(1000))

    def start(self) -> None:
        self.core = MissionServerCore(self.profile)
        self.books = Bookkeeper(self.core, self.journal)
        snapshots = self.journal.missions()
        self.books.restore(snapshots)
        self.sends: list[Send] = []
        self._perform(self.core.restore(snapshots, self.resume, lambda: uuid(next(self.fresh)), 0.0))

    def submit(self, number: int, robot: str, *upstream: int) -> None:
        request = MissionRequest(robot, upstream=tuple(map(uuid, upstream)))
        assert self.core.create(request, uuid(number)) is None
        self.books.create(uuid(number))
        self._perform(self.core.submit(uuid(number), 0.0), submitted=True)
        self.accepted.add(uuid(number))

    def run(self) -> None:
        """Robots connect and do what they are sent; mission 3 fails."""
        names = {1: "a", 2: "b"}
        for number, name in names.items():
            self._perform(self.core.connected(number, 0.0))
            self._perform(self.core.received(number, says_name(name), 0.0))
        while self.sends:
            send = self.sends.pop(0)
            for status in (RUNNING, FAILURE if send.mission == uuid(3) else SUCCESS):
                report = Message(Header("mission_status"), MissionStatusProto(send.payload.uuid, status))
                self._perform(self.core.received(send.connection, report, 0.0))

    def _perform(self, effects: tuple[Effect, ...] | Refused, *, submitted: bool = False) -> None:
        assert not isinstance(effects, Refused)
        self.books.note(effects, submitted=submitted)
        for effect in effects:
            if isinstance(effect, Send) and effect.payload.uuid is not None:
                self.sends.append(effect)
                self.sent.append((effect.mission, effect.payload.uuid))
            elif isinstance(effect, StatusChanged):
                self.told.append((effect.mission, effect.status))


PLAN = ((0, "a"), (1, "b", 0), (2, "a", 0), (3, "b", 1), (4, "a", 3), (5, "b", 2))


def whole(world: World) -> None:
    for number, robot, *upstream in PLAN:
        if uuid(number) not in world.accepted:
            world.submit(number, str(robot), *upstream)  # type: ignore[arg-type]
    world.run()


@pytest.mark.parametrize("resume", RESUME)
def test_isaac_journal_a_server_that_dies_at_any_write_loses_and_doubles_nothing(tmp_path: Path, resume: str) -> None:
    """Killed before or after each write: what was accepted ends, what was told done is not run again.

    Of what was under way each goes by the reading: run again under another identifier, or failed and never sent again.
    """
    deaths = 0
    for writes, before in ((count, before) for count in itertools.count(1) for before in (True, False)):
        path = tmp_path / f"{writes}{before}"
        journal = CrashingJournal(path, writes, before=before)
        world = World(journal, resume)
        world.start()
        try:
            whole(world)
        except CrashError:
            deaths += 1
        else:
            break
        finally:
            journal.close()
        told, sent = list(world.told), list(world.sent)
        with_journal = Journal(path)
        world.journal = with_journal
        known = {one.uuid: one for one in with_journal.missions()}
        assert world.accepted <= known.keys()
        world.accepted |= known.keys()  # a submission whose answer was not heard
        world.start()
        whole(world)
        again = world.sent[len(sent) :]
        ends = dict(world.core.statuses())
        assert len(ends) == len(PLAN)
        assert all(status.terminal for status in ends.values())
        done = {mission for mission, status in told if status.terminal}
        assert done.isdisjoint(mission for mission, _ in again)
        assert all(ends[mission] is status for mission, status in told if status.terminal)
        assert len(set(world.sent)) == len(world.sent)
        started = {mission for mission, one in known.items() if one.status is Status.STARTED}
        if resume == "fail":
            assert started.isdisjoint(mission for mission, _ in again)
            assert all(ends[mission] is Status.FAILED_DISCONNECTED for mission in started)
        else:
            assert started <= {mission for mission, _ in again}
            assert {mission.lower: status.name for mission, status in ends.items()} == {
                0: "SUCCESS", 1: "SUCCESS", 2: "SUCCESS", 3: "FAILED", 4: "FAILED_UPSTREAM", 5: "SUCCESS",
            }  # fmt: skip
        with_journal.close()
    assert deaths >= 2 * len(PLAN) + 10


def test_isaac_journal_what_was_forgotten_and_what_was_retried_survive(tmp_path: Path) -> None:
    """A forgotten mission is gone for good, and a retry goes on under its own identifier and place."""
    journal = Journal(tmp_path / "journal")
    world = World(journal, "rerun")
    world.start()
    whole(world)
    assert world.core.forget(uuid(4)) is None
    world.books.forget([uuid(4)])
    world._perform(world.core.retry(uuid(3), uuid(77), 0.0))
    journal.close()
    world.journal = Journal(tmp_path / "journal")
    kept = {one.uuid.lower: one for one in world.journal.missions()}
    assert kept.keys() == {0, 1, 2, 3, 5}
    assert (kept[3].status, kept[3].attempt, kept[3].number) == (Status.STARTED, uuid(77), 6)
    world.start()
    world.run()
    assert world.sent[-1] == (uuid(3), uuid(1000))
    assert world.core.status(uuid(3)) is Status.FAILED
    world.journal.close()


def test_isaac_journal_one_server_at_a_time_and_no_other_file(tmp_path: Path) -> None:
    """A second server, a folder, a text and a foreign database are refused in words."""
    path = tmp_path / "journal"
    first = Journal(path)
    with pytest.raises(JournalError, match="another server has it open"):
        Journal(path)
    first.close()
    Journal(path).close()
    (tmp_path / "text").write_text("no database at all, but long enough to be read as one" * 30)
    foreign = sqlite3.connect(tmp_path / "foreign")
    foreign.execute("CREATE TABLE x (y)")
    foreign.close()
    for name, says in (
        ("", "unable to open"),
        ("text", "not a database"),
        ("foreign", "is no journal of this version"),
    ):
        with pytest.raises(JournalError, match=says):
            Journal(tmp_path / name)


def test_isaac_server_cancelling_retrying_and_forgetting() -> None:
    """A cancelled mission cancels what waits for it; a retry runs both again; what nothing needs can be forgotten."""
    server = Driver()
    server.add("r")
    server.add("s", [0])
    server.add("r")
    core = server.core
    assert server.connect(1, "r") == [0]
    assert not isinstance(core.cancel(uuid(0), 1.0), Refused)
    assert server.statuses() == ["FAILED_CANCELLED", "FAILED_UPSTREAM", "STARTED"]
    assert server.report(1, 0, SUCCESS) == []
    server.report(1, 2, RUNNING, SUCCESS)
    assert str(core.cancel(uuid(0), 1.0)) == f"mission {uuid(0)} has ended: FAILED_CANCELLED"
    assert (
        str(core.retry(uuid(1), uuid(9), 1.0))
        == f"mission {uuid(1)} has an upstream that has not succeeded; retry that"
    )
    retried = core.retry(uuid(0), uuid(8), 1.0)
    assert not isinstance(retried, Refused)
    assert server._note(retried) == [8]
    assert str(core.forget(uuid(0))) == f"mission {uuid(0)} has not ended: STARTED"
    assert server.report(1, 0, SUCCESS) == []
    assert server.statuses() == ["STARTED", "QUEUED", "SUCCESS"]
    server.report(1, 8, RUNNING, SUCCESS)
    assert str(core.forget(uuid(0))) == f"mission {uuid(0)} is upstream of 1 that have not ended"
    assert server.connect(2, "s") == [1]
    server.report(2, 1, RUNNING, SUCCESS)
    assert [core.forget(uuid(number)) for number in range(3)] == [None] * 3
    assert server.statuses() == []
    assert str(core.forget(uuid(0))) == f"there is no mission {uuid(0)}"


@pytest.mark.parametrize("entry", [("AI-12", "a"), ("AI-12", "b"), ("AI-13", "b"), ("AI-04", "b")], ids="".join)
def test_isaac_server_a_retry_is_sent_once(entry: tuple[str, str]) -> None:
    """A mission that was cancelled while it waited in the queue and is retried is there once, behind the others."""
    server = Driver(DOCUMENTED.choosing(*entry))
    for _ in range(3):
        server.add("r")
    for effects in (server.core.cancel(uuid(1), 0.0), server.core.retry(uuid(1), uuid(9), 0.0)):
        assert not isinstance(effects, Refused)
    sent = server.connect(1, "r")
    while server.core.unfinished:
        sent += server.report(1, sent[-1], RUNNING, SUCCESS)
    assert sorted(sent) == [0, 2, 9]


def test_isaac_dispatch_killed_with_a_journal_goes_on(tmp_path: Path) -> None:
    """Kill -9 in the middle of a file: the second start runs what is left, and a third one has nothing to do."""
    file = tmp_path / "missions.json"
    file.write_text('{"missions": [{"robot": "r"}, {"robot": "r"}, {"robot": "s", "upstream": [1]}]}')
    command = [sys.executable, "-m", "missionfsm", "dispatch", str(file), "--port", "0"]
    command += ["--journal", str(tmp_path / "journal"), "--resume", "rerun"]

    def dispatch() -> subprocess.Popen[str]:
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def robot(port: str, name: str, script: str) -> subprocess.Popen[str]:
        there = ["robot", "--name", name, "--port", port, "--script", script]
        return subprocess.Popen([sys.executable, "-m", "missionfsm", *there], stdout=subprocess.DEVNULL)

    def port(server: subprocess.Popen[str]) -> str:
        return next(line.strip().rpartition(":")[2] for line in server.stdout or () if line.startswith("listening"))

    server = dispatch()
    first = robot(port(server), "r", "succeed:0,hang")
    assert server.stdout is not None
    assert any(line == "missions[1] r: RUNNING\n" for line in server.stdout)
    os.kill(server.pid, signal.SIGKILL)
    first.kill()
    first.wait()
    server.communicate()
    server = dispatch()
    number = port(server)
    robots = [robot(number, name, "succeed:0") for name in "rs"]
    out, errors = server.communicate(timeout=30)
    for one in robots:
        one.kill()
        one.wait()
    assert (server.returncode, errors) == (0, "")
    assert "missions[0] r: STARTED" not in out
    assert out.splitlines()[-1] == "3 succeeded, 0 did not"
    out, errors = dispatch().communicate(timeout=30)
    assert out.splitlines()[-1] == "3 succeeded, 0 did not"
    file.write_text('{"missions": [{"robot": "r"}]}')
    other = dispatch()
    assert other.communicate(timeout=30)[1] == (
        f"missionfsm: --journal: {tmp_path / 'journal'}: holds 3 missions and the file 1; take another journal\n"
    )
    assert other.returncode == 2
