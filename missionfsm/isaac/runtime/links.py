"""Who is connected to a mission server, and which robot that is. MissionSubmission › Robot Identification.

Where the document leaves a choice, the :class:`~missionfsm.isaac.runtime.profile.Profile` makes it. Mutable but pure.
"""

import hmac
from collections.abc import Callable, Mapping

from missionfsm.isaac.runtime.missions import Close, Ignored, RobotOffline, RobotOnline, RobotTakenOver
from missionfsm.isaac.runtime.profile import Profile
from missionfsm.isaac.runtime.records import ConnectionRecord, RobotRecord
from missionfsm.isaac.runtime.scheduler import Scheduler
from missionfsm.isaac.wire.messages import Message
from missionfsm.isaac.wire.strictjson import brief_json


class Links:
    """The connections of a server and the names that they have said; it has the scheduler told who is there.

    Args:
        profile: the readings that are followed.
        tokens: for each name what a connection has to say before it; None lets anybody be anybody.
        receive: takes a message that was kept until the name of its connection was known (AI-18 b).
    """

    def __init__(
        self,
        profile: Profile,
        tokens: Mapping[str, str] | None,
        receive: Callable[[ConnectionRecord, Message], None],
    ) -> None:
        self._profile = profile
        self._receive = receive
        self.scheduler = Scheduler(profile, self.close, self.notice)
        self._tokens = None if tokens is None else {self.scheduler.key(name): token for name, token in tokens.items()}
        self.connections: dict[int, ConnectionRecord] = {}
        self._arrived = 0
        self._dropped: list[ConnectionRecord] = []
        self._named: dict[tuple[ConnectionRecord, str], None] = {}

    @property
    def guarded(self) -> bool:
        """Whether a token has to be said before a name."""
        return self._tokens is not None

    def add(self, connection: int) -> None:
        """Somebody has connected."""
        self._arrived += 1
        self.connections[connection] = made = ConnectionRecord(connection, self._arrived)
        if self._profile.ai_18_silent == "d":
            self.scheduler.deadlines.push(self.scheduler.now + self._profile.name_timeout, "name", made)

    def drop(self, connection: int) -> None:
        """A connection has dropped."""
        gone = self.connections.pop(connection, None)
        if gone is not None:
            gone.open = False
            if self._profile.ai_15_when == "p":
                self._dropped.append(gone)
                self.scheduler.wait_for_pass()
            else:
                self._unbind(gone)

    def close(self, connection: ConnectionRecord, reason: str) -> None:
        """The server ends a connection."""
        del self.connections[connection.id]
        connection.open = False
        self.scheduler.effects.append(Close(connection.id, reason))
        self._unbind(connection)

    def _unbind(self, connection: ConnectionRecord) -> None:
        robot, connection.robot = connection.robot, None
        self.scheduler.ended(connection)
        if robot is None:
            return
        robot.connection = None
        self.scheduler.effects.append(RobotOffline(robot.name, connection.id))
        self.scheduler.lost(robot)

    def notice(self) -> None:
        """A scheduling pass begins: drops and names that waited for it."""
        dropped, self._dropped = self._dropped, []
        for gone in dropped:
            self._unbind(gone)
        named, self._named = self._named, {}
        for connection, text in named:
            if connection.open:
                self._name(connection, text)

    def says_name(self, connection: ConnectionRecord, text: str) -> None:
        """A name is said on a connection, which is heard at once or in the next pass."""
        known = connection.robot is not None and connection.robot.key == self.scheduler.key(text)
        if not self._profile.names_wait_for_pass or known:  # robots say it again and again
            self._name(connection, text)
        else:
            self._named[connection, text] = None
            self.scheduler.wait_for_pass()

    def _name(self, connection: ConnectionRecord, text: str) -> None:
        key = self.scheduler.key(text)
        bound = connection.robot
        if bound is not None and bound.key == key:
            return  # said again, as robots do
        refused = self._refused(connection, key)
        if refused:
            self.ignore(connection, refused)
        elif self._tokens is not None and not _same(self._tokens.get(key), connection.token):
            self.close(connection, f"it says the name {brief_json(text)} without its token")
        else:
            self._claim(connection, text)

    def _refused(self, connection: ConnectionRecord, key: str) -> str:
        """Why a connection cannot take a name, whoever has it; empty where it can."""
        if not key:
            return "an empty name is no name"
        if connection.displaced and self._profile.ai_16_back == "r":
            return "another connection took its name over"
        if connection.robot is not None and self._profile.ai_17 == "a":
            return "it has a name already and cannot take another"
        return ""

    def _claim(self, connection: ConnectionRecord, text: str) -> None:
        """A connection takes a name; where another has it, the profile says what becomes of the two."""
        robot = self.scheduler.robot(text)
        if robot.connection is not None and not robot.connection.open:
            self._unbind(robot.connection)  # dropped, and no pass has come since
        other = robot.connection
        if other is None:
            self._unbind(connection)
            self.scheduler.effects.append(RobotOnline(text, connection.id))
            self._bind(connection, robot, text)
        elif self._profile.ai_16 == "d":
            self.close(connection, "another connection has that name")
        elif self._profile.ai_16 == "n" or (self._profile.ai_16 == "a" and connection.number > other.number):
            self._take_over(connection, robot, other, text)
        else:
            self.ignore(connection, "another connection has that name")

    def _take_over(self, connection: ConnectionRecord, robot: RobotRecord, other: ConnectionRecord, text: str) -> None:
        self._unbind(connection)
        other.robot = robot.connection = None
        other.displaced = True
        self.scheduler.effects.append(RobotTakenOver(text, other.id, connection.id))
        if self._profile.ai_16_under_way == "m":
            self.scheduler.left(robot, other)
        else:
            self.scheduler.lost(robot)
        self._bind(connection, robot, text)

    def _bind(self, connection: ConnectionRecord, robot: RobotRecord, name: str) -> None:
        connection.robot, robot.connection, robot.name = robot, connection, name
        early, connection.early = connection.early, []
        for message in early:
            self._receive(connection, message)
        self.scheduler.found(robot)

    def ignore(self, connection: ConnectionRecord, reason: str) -> None:
        """What was said on a connection means nothing."""
        self.scheduler.effects.append(Ignored(connection.id, reason))


def _same(wanted: str | None, said: str) -> bool:
    """Whether a token is the wanted one; the time that this takes tells nothing of it."""
    return wanted is not None and hmac.compare_digest(wanted.encode(), said.encode("utf-8", "replace"))
