"""What several tests of the Isaac side need: short ways to say what happens to a server."""

from collections.abc import Iterable, Sequence

from missionfsm.isaac.runtime.missions import Effect, MissionRequest, Refused, Send, Status, StatusChanged
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.runtime.server import MissionServerCore, elapse
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto, TextProto, Uuid, WireStatus

RUNNING, SUCCESS, FAILURE = WireStatus.RUNNING, WireStatus.SUCCESS, WireStatus.FAILURE


def uuid(number: int) -> Uuid:
    """The identifier of the test's mission `number`."""
    return Uuid(lower=number, upper=7)


def says_name(name: str, channel: str = "name") -> Message:
    """A robot says its name."""
    return Message(Header(channel), TextProto(name))


def says_status(number: int | None, status: WireStatus, channel: str = "mission_status") -> Message:
    """A robot reports on the test's mission `number`, or on none in particular."""
    return Message(Header(channel), MissionStatusProto(None if number is None else uuid(number), status))


class Driver:
    """A server core, a clock, and the missions 0, 1, 2, … of a test. Each call returns what was sent, as numbers."""

    def __init__(self, profile: Profile = DOCUMENTED) -> None:
        self.core = MissionServerCore(profile)
        self.now = 0.0
        self.made = 0
        self.effects: list[Effect] = []

    def make(self, robot: str | None = "r", upstream: Iterable[int] = (), **settings: object) -> int:
        """Create the next mission; it must not be refused."""
        number = self.made
        refused = self.core.create(request(robot, upstream, **settings), uuid(number))
        assert refused is None, refused
        self.made += 1
        return number

    def add(self, robot: str | None = "r", upstream: Iterable[int] = (), **settings: object) -> list[int]:
        """Create and submit the next mission."""
        return self.submit(self.make(robot, upstream, **settings))

    def submit(self, number: int) -> list[int]:
        result = self.core.submit(uuid(number), self.now)
        assert not isinstance(result, Refused), result
        return self._note(result)

    def connect(self, connection: int, name: str | None = None) -> list[int]:
        sent = self._note(self.core.connected(connection, self.now))
        return sent if name is None else sent + self.hear(connection, says_name(name))

    def hear(self, connection: int, message: Message) -> list[int]:
        return self._note(self.core.received(connection, message, self.now))

    def report(self, connection: int, number: int | None, *statuses: WireStatus) -> list[int]:
        return [one for status in statuses for one in self.hear(connection, says_status(number, status))]

    def drop(self, connection: int) -> list[int]:
        return self._note(self.core.disconnected(connection, self.now))

    def wait(self, seconds: float) -> list[int]:
        self.now += seconds
        return self._note(elapse(self.core, self.now))

    def statuses(self) -> list[str]:
        return [status.name for _, status in self.core.statuses()]

    def changes(self) -> list[tuple[int, str]]:
        """Every change of status so far."""
        return [(one.mission.lower, one.status.name) for one in self.effects if isinstance(one, StatusChanged)]

    def _note(self, effects: Sequence[Effect]) -> list[int]:
        self.effects += effects
        return [one.payload.uuid.lower for one in effects if isinstance(one, Send) and one.payload.uuid is not None]


def request(robot: str | None = "r", upstream: Iterable[int] = (), **settings: object) -> MissionRequest:
    return MissionRequest(robot=robot, upstream=tuple(uuid(number) for number in upstream), **settings)  # type: ignore[arg-type]


__all__ = ["FAILURE", "RUNNING", "SUCCESS", "Driver", "Status", "request", "says_name", "says_status", "uuid"]
