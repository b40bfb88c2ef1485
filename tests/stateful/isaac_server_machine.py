"""The mission server of the Mission Submission page as a machine of plain rules: missions, upstreams, robots, limits.

The server follows its documented profile (`missionfsm.isaac.runtime.profile`) in what the page leaves open; where the
machine accepts more than that, it says so. The model is a list of missions and a dict of connections.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable
from typing import Any

from attrs import define
from hypothesis import strategies as st
from hypothesis.stateful import (
    Bundle,
    RuleBasedStateMachine,
    consumes,
    initialize,
    invariant,
    multiple,
    precondition,
    rule,
)
from isaac_lines import NO_MESSAGES, Post, line, text

from missionfsm.isaac.runtime.missions import Close, Effect, MissionRequest, Refused, Send
from missionfsm.isaac.runtime.server import MissionServerCore, elapse
from missionfsm.isaac.wire.messages import Uuid

MISSIONS = Bundle("missions")
CONNECTIONS = Bundle("connections")

INCOMPLETE = ("CREATED", "QUEUED", "STARTED", "RUNNING")
"""Sample Usage: the statuses of a mission that has not completed."""
ROBOTS = ("carter-01", "carter-02", "arm01")
CHANNELS = ("mission", "mission", "arm")
LIMITS = (2.0, 5.0, 5.0)


@define
class Mission:
    """A mission as it was submitted, and what is known of it.

    Attributes:
        submitted: when, in seconds; as are `sent` and `acknowledged`, None for not yet.
        connection: where it was sent.
        status: what the server showed last.
    """

    number: int
    robot: str
    channel: str
    config: str
    start_timeout: float
    timeout: float
    upstream: list[Mission]
    submitted: float
    sent: float | None = None
    acknowledged: float | None = None
    connection: int | None = None
    status: str = "QUEUED"

    @property
    def over(self) -> bool:
        """Whether it has completed, in whatever way."""
        return self.status not in INCOMPLETE

    @property
    def failed(self) -> bool:
        """Whether it has completed without success."""
        return self.over and self.status != "SUCCESS"

    @property
    def ready(self) -> bool:
        """Mission Dependencies: every upstream mission has completed with success."""
        return all(one.status == "SUCCESS" for one in self.upstream)


class ServerMachine(RuleBasedStateMachine):
    """A mission server, and robots that connect to it."""

    make_server: Callable[[], MissionServerCore] = MissionServerCore

    @initialize(target=CONNECTIONS)
    def a_server(self) -> Any:
        """A server that listens, and two robots that have connected and said who they are."""
        self.server = self.make_server()
        self.post = Post()
        self.now = 0.0
        self.seldom = 0
        self.missions: list[Mission] = []
        self.names: dict[int, list[str]] = {}
        """For each open connection the names that were said on it."""
        self.outdone: set[int] = set()
        """Connections whose name another one said as well, until they say it alone."""
        self.connected = 0
        return multiple(self.a_robot_connects(ROBOTS[0]), self.a_robot_connects(ROBOTS[1]))

    # What comes of what happens.

    def happens(self, effects: Iterable[Effect], *, may_end: Mission | None = None, how: tuple[str, ...] = ()) -> None:
        """Look at what was sent, and at every status.

        Args:
            may_end: the mission that has completed now, in one of the ways of `how`.
        """
        sent = [self.is_sent(one) for one in effects if isinstance(one, Send)]
        for one in effects:
            if isinstance(one, Close):
                self.names.pop(one.connection, None)
        shown = {uuid.lower: status.value for uuid, status in self.server.statuses()}
        assert list(shown) == [one.number for one in self.missions]
        for mission in self.missions:
            before, mission.status = mission.status, shown[mission.number]
            if before == mission.status:
                continue
            assert before in INCOMPLETE, f"{mission} was {before}: what has completed stays so"
            if mission.status in ("STARTED", "RUNNING"):
                assert mission in sent or mission.acknowledged is not None
            elif mission is may_end:
                assert mission.status in how
            else:
                assert mission.failed
                assert self.may_be_given_up(mission), f"{mission} was {before}"

    def is_sent(self, effect: Send) -> Mission:
        """A mission goes to a robot: to the right one, once, when all upstream missions have succeeded."""
        message = self.post.read(effect.channel, effect.payload)
        mission = next(one for one in self.missions if one.number == message.mission)
        assert mission.sent is None, "sent once"
        # Mission Dependencies: not before all upstream missions are completed with success.
        status = dict(self.server.statuses())
        assert all(status[Uuid(one.number, 0)].value == "SUCCESS" for one in mission.upstream)
        # Robot Identification: on the connection that said the robot's name.
        assert mission.robot in self.names[effect.connection]
        # Sample Usage, "channel" and "config".
        assert (message.channel, message.kind) == (mission.channel, "mission")
        assert json.loads(message.says) == json.loads(mission.config)
        mission.sent, mission.connection = self.now, effect.connection
        return mission

    def only_connection(self, robot: str) -> int | None:
        """The open connection that said a robot's name and no other, if no other said it since."""
        theirs = [connection for connection, names in self.names.items() if robot in names]
        alone = len(theirs) == 1 and set(self.names[theirs[0]]) == {robot} and theirs[0] not in self.outdone
        return theirs[0] if alone else None

    def may_be_given_up(self, mission: Mission) -> bool:
        """Whether something may have canceled or aborted it: an upstream, a limit, its connection.

        Open: from when the limits count (they have not elapsed while they have not since the submission), and who the
        robot is where two connections say its name.
        """
        since = self.now - mission.submitted
        upstream = any(one.failed or self.server.status(Uuid(one.number, 0)) is None for one in mission.upstream)
        lost = mission.connection is not None and self.only_connection(mission.robot) != mission.connection
        return upstream or lost or since >= mission.start_timeout or since >= mission.timeout

    # MissionServer Class, Mission Dependencies

    def submit_one(self, robot: str, channel: str, upstream: list[Mission], limits: tuple[float, float]) -> Mission:
        """A mission is made and submitted."""
        number = len(self.missions) + 1
        config = json.dumps({"goals.path": {"Plan2Generator": {"number": number}}})
        start_timeout, timeout = limits
        request = MissionRequest(
            robot=robot,
            channel=channel,
            status_channel="mission_status",
            config=config,
            start_timeout=start_timeout,
            timeout=timeout,
            upstream=tuple(Uuid(one.number, 0) for one in upstream),
        )
        mission = Mission(number, robot, channel, config, start_timeout, timeout, upstream, self.now)
        assert self.server.create(request, Uuid(number, 0)) is None
        self.missions.append(mission)
        effects = self.server.submit(Uuid(number, 0), self.now)
        assert not isinstance(effects, Refused)
        self.happens(effects)
        return mission

    @rule(
        target=MISSIONS,
        robot=st.sampled_from([ROBOTS[0], *ROBOTS]),
        channel=st.sampled_from(CHANNELS),
        upstream=st.lists(MISSIONS, max_size=3, unique_by=id),
        limits=st.tuples(st.sampled_from(LIMITS), st.sampled_from([math.inf, math.inf, 3.0])),
    )
    def submit(self, robot: str, channel: str, upstream: list[Mission], limits: tuple[float, float]) -> Mission:
        """A mission with missions upstream of it, of any robots, in whatever state they are."""
        return self.submit_one(robot, channel, upstream, limits)

    @rule(target=MISSIONS, robot=st.sampled_from(ROBOTS))
    def submit_without_upstream(self, robot: str) -> Mission:
        """A mission that depends on none, with the documented limits: 5 seconds to start, no end."""
        return self.submit_one(robot, "mission", [], (5.0, math.inf))

    @precondition(lambda self: self.seldom < 6)
    @rule(robot=st.sampled_from(ROBOTS))
    def submit_below_nothing(self, robot: str) -> None:
        """Mission Dependencies: upstream missions are missions that there are, so that there is never a cycle."""
        self.seldom += 1
        number = len(self.missions) + 1
        for upstream in (number, 1_000):  # itself, and one that nobody made
            request = MissionRequest(robot=robot, upstream=(Uuid(upstream, 0),))
            assert isinstance(self.server.create(request, Uuid(number, 0)), Refused)
        self.happens(())

    # JsonTcpServer Class, Robot Identification

    def connect(self) -> int:
        """A robot connects: nothing is sent to it before it has said who it is."""
        self.connected += 1
        self.names[self.connected] = []
        self.happens(self.server.connected(self.connected, self.now))
        return self.connected

    def name(self, connection: int, name: str) -> None:
        """It says its name; who said it before has to say it again if it is to count."""
        others = {other for other, names in self.names.items() if name in names and other != connection}
        self.outdone = self.outdone | others | {connection} if others else self.outdone - {connection}
        self.names.setdefault(connection, []).append(name)
        self.receive(connection, line("name", "text", None, name))

    def receive(self, connection: int, some: str, **ends: Any) -> None:
        """It says something."""
        for one in text(some):
            self.happens(self.server.received(connection, one, self.now), **ends)

    @precondition(lambda self: len(self.names) < 4)
    @rule(target=CONNECTIONS, name=st.sampled_from([*ROBOTS, ""]))
    def a_robot_connects(self, name: str) -> int:
        """A robot connects, and says its name now or later.

        Robot Identification: all missions that are queued for it go to this connection.
        """
        connection = self.connect()
        if name:
            self.name(connection, name)
        return connection

    @precondition(lambda self: self.seldom < 6)
    @rule(connection=CONNECTIONS, name=st.sampled_from(ROBOTS))
    def a_robot_says_a_name(self, connection: int, name: str) -> None:
        """Periodically, or as another: which of two names is that of the connection is open."""
        self.seldom += 1
        if connection in self.names:
            self.name(connection, name)

    @precondition(lambda self: self.seldom < 6)
    @rule(connection=consumes(CONNECTIONS))
    def a_robot_is_gone(self, connection: int) -> None:
        """A connection drops. Open: what becomes of the mission that was sent on it."""
        self.seldom += 1
        self.names.pop(connection, None)
        self.happens(self.server.disconnected(connection, self.now))

    # Mission Codelet, as the server hears it

    def underway(self) -> list[Mission]:
        """Missions that were sent on a connection that is open, and have not completed."""
        return [one for one in self.missions if one.connection in self.names and not one.over]

    @precondition(lambda self: self.underway())
    @rule(data=st.data(), says=st.sampled_from(["running", "success", "failure"]))
    def a_robot_reports(self, data: st.DataObject, says: str) -> None:
        """The robot says how a mission goes that it was sent: the server shows it."""
        self.reports(data.draw(st.sampled_from(self.underway())), says)

    @precondition(lambda self: self.underway())
    @rule(seconds=st.sampled_from([0.0, 0.5, 1.5]))
    def a_mission_succeeds(self, seconds: float) -> None:
        """The usual way: RUNNING once or more, and SUCCESS."""
        mission = self.underway()[0]
        self.reports(mission, "running")
        self.time_passes(seconds)
        if not mission.over:
            self.reports(mission, "running")
            self.reports(mission, "success")

    def reports(self, mission: Mission, says: str) -> None:
        """A status comes on the connection where the mission was sent."""
        assert mission.connection is not None
        mission.acknowledged = self.now if mission.acknowledged is None else mission.acknowledged
        how = {"running": ("RUNNING",), "success": ("SUCCESS",), "failure": ("FAILED",)}[says]
        some = line("mission_status", "status", mission.number, says)
        self.receive(mission.connection, some, may_end=mission, how=how)
        assert mission.status in how

    def unmoved(self, connection: int, some: str) -> None:
        """A line that changes the status of no mission."""
        self.seldom += 1
        before = [one.status for one in self.missions]
        self.receive(connection, some)
        assert [one.status for one in self.missions] == before

    @precondition(lambda self: self.underway() and self.seldom < 6)
    @rule(connection=CONNECTIONS, says=st.sampled_from(["running", "success", "failure"]))
    def another_robot_reports(self, connection: int, says: str) -> None:
        """A status of a mission that was sent to another robot changes nothing."""
        mission = next((one for one in self.underway() if one.connection != connection), None)
        if mission is not None:
            self.unmoved(connection, line("mission_status", "status", mission.number, says))

    @precondition(lambda self: self.seldom < 6)
    @rule(connection=CONNECTIONS, mission=MISSIONS, says=st.sampled_from(["running", "success", "failure"]))
    def a_robot_reports_what_is_over(self, connection: int, mission: Mission, says: str) -> None:
        """A status of a mission that has completed, or was not sent, changes nothing."""
        if mission.sent is None or mission.over:
            self.unmoved(connection, line("mission_status", "status", mission.number, says))

    @precondition(lambda self: self.seldom < 6)
    @rule(
        connection=CONNECTIONS,
        some=st.sampled_from([*NO_MESSAGES, line("mission_status", "status", 1_000, "success")]),
    )
    def a_robot_says_something_else(self, connection: int, some: str) -> None:
        """What is no message, or about no mission, has no effect on any mission."""
        self.unmoved(connection, some)

    # Sample Usage, "start_timeout" and "timeout"

    @rule(seconds=st.sampled_from([0.25, 1.0, 2.5, 4.0]))
    def time_passes(self, seconds: float) -> None:
        """Time passes, event after event."""
        self.now += seconds
        self.happens(elapse(self.server, self.now))

    # What holds at all times.

    @invariant()
    def failures_cancel_what_is_downstream(self) -> None:
        """Mission Dependencies: if an upstream mission fails, the mission is canceled; so is what depends on it."""
        for mission in self.missions:
            if any(one.failed for one in mission.upstream):
                assert mission.failed
                assert mission.sent is None

    @invariant()
    def limits_are_kept(self) -> None:
        """Sample Usage: a mission that is not acknowledged, or not completed, in time is aborted."""
        for mission in self.missions:
            if mission.sent is not None and not mission.over and self.only_connection(mission.robot) is not None:
                if mission.acknowledged is None:
                    assert self.now - mission.sent <= mission.start_timeout
                else:
                    assert self.now - mission.acknowledged <= mission.timeout

    @invariant()
    def robots_have_something_to_do(self) -> None:
        """Robot Identification: what is queued for a robot and ready goes to its connection; one mission at least.

        Of a name that two connections said, and of a connection that said two names, nothing is claimed.
        """
        for robot in ROBOTS:
            if self.only_connection(robot) is None:
                continue
            queued = [one for one in self.missions if one.robot == robot and not one.over]
            waiting = [one for one in queued if one.sent is None and one.ready]
            assert not waiting or any(one.sent is not None for one in queued), f"{waiting} could be sent"

    @invariant()
    def statuses_say_what_is_known(self) -> None:
        """Sample Usage: QUEUED or CREATED before it is sent, STARTED until it is acknowledged, then RUNNING."""
        for mission in self.missions:
            if not mission.over:
                if mission.sent is None:
                    assert mission.status in ("CREATED", "QUEUED")
                else:
                    assert mission.status == ("STARTED" if mission.acknowledged is None else "RUNNING")
