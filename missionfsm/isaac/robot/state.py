"""The mission client as a state: whether it is connected, what it runs, what it has yet to say."""

from __future__ import annotations

from attrs import evolve, frozen

from missionfsm.isaac.shared.line import MICROSECONDS
from missionfsm.kernel.chart import Chart

SYSTEM_NAME = "isaac.robot"

RUNNING_BOUND = 40 * MICROSECONDS
"""Time within which RUNNING has to be reported at least once, in microseconds. The tester's choice (AI-31)."""

NAME_BOUND = 90 * MICROSECONDS
"""Time within which the name has to be said at least once, in microseconds. The tester's choice (AI-31)."""

TICK = MICROSECONDS
"""How long a status may wait for the codelet's own tick at most, in microseconds. The tester's choice (AI-31)."""

LIFECYCLE: Chart[str] = Chart(
    "codelet",
    "IDLE",
    (
        ("a mission arrives", "IDLE", "RUNNING"),
        ("a mission arrives", "RUNNING", "RUNNING"),
        ("an unusable mission arrives", "IDLE", "IDLE"),
        ("an unusable mission arrives", "RUNNING", "IDLE"),
        ("an unusable mission is passed over", "RUNNING", "RUNNING"),
        ("the tree reports success", "RUNNING", "IDLE"),
        ("the tree reports failure", "RUNNING", "IDLE"),
        ("the connection drops", "RUNNING", "IDLE"),
    ),
    {
        "an unusable mission arrives": "AI-33.unusable, AI-33.preempts a",
        "an unusable mission is passed over": "AI-33.preempts b",
        "the connection drops": "AI-15.mission b, c",
    },
)
"""Whether a behavior tree runs."""


@frozen(cache_hash=True)
class World:
    """What a robot is configured with: its name, None where that is any, and its channels."""

    name: str | None = "robot"
    channel: str = "mission"
    status_channel: str = "mission_status"
    name_channel: str = "name"

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels that missions and robots are talked of on."""
        return self.channel, self.status_channel, self.name_channel


@frozen(cache_hash=True)
class Report:
    """A status that is owed: ``running``, ``success`` or ``failure``, of a mission with or without an identifier."""

    status: str
    named: bool
    channel: str = "mission_status"


@frozen(cache_hash=True)
class Earlier:
    """Any status on that channel: of a mission from before the log."""

    channel: str


@frozen(cache_hash=True)
class Waiting:
    """A status that waits.

    Attributes:
        named: whether its mission has an identifier.
        offered: whether RUNNING of that mission may come just before it.
        kept: whether it is told once the connection is there again, whatever becomes of others (AI-15.mission c).
        preempted: whether it is of a mission that the next one ended.
        unread: whether it is due for a line that may not have been read yet (AI-31.read b).
    """

    status: str
    named: bool
    offered: bool
    kept: bool = False
    preempted: bool = False
    unread: bool = False


@frozen(cache_hash=True)
class Introduction:
    """The name that is owed, on the name channel; any name where it is None."""

    name: str | None
    channel: str


@frozen(cache_hash=True)
class Other:
    """Whatever else the application around the codelet sends, on other channels than those."""

    channels: tuple[str, ...]

    @property
    def another(self) -> str:
        """A channel that is none of those."""
        return next(f"log{'-' * length}" for length in range(4) if f"log{'-' * length}" not in self.channels)


@frozen(cache_hash=True)
class Codelet:
    """A robot's mission client.

    Attributes:
        begun: whether it was ever connected, which it is at the very start.
        connected: whether its connection is there.
        running: whether a behavior tree runs.
        named: whether its mission has an identifier.
        used: whether a mission was ended before.
        waiting: the statuses that wait for the codelet's own tick, or for the connection to be back.
        waited: microseconds for which they have waited while connected.
        quiet: microseconds for which RUNNING may not have been reported though a tree ran.
        nameless: microseconds for which the name may not have been said though it was connected.
        in_use: whether it was in use before a log of it begins, whose first line is still to come.
        earlier: microseconds for which statuses of missions from before the log may still wait while connected; 1 where
            that time is over and what was said in it may still be seen.
    """

    world: World = World()
    begun: bool = False
    connected: bool = False
    running: bool = False
    named: bool = False
    used: bool = False
    waiting: tuple[Waiting, ...] = ()
    waited: int = 0
    quiet: int = 0
    nameless: int = 0
    in_use: bool = False
    earlier: int = 0

    @property
    def state(self) -> str:
        """Where it is on the chart."""
        return "RUNNING" if self.running else "IDLE"

    def moved(self, trigger: str) -> Codelet:
        """It, once it has moved on the chart."""
        state = LIFECYCLE.after(trigger, self.state)
        assert state is not None, f"{trigger} is no move from {self.state}"  # noqa: S101 - the caller has looked
        runs = state == "RUNNING"
        return evolve(self, running=runs, named=self.named and runs, used=True, quiet=0)

    @property
    def about(self) -> int | None:
        """The position of the identifier of the mission that runs, among the names; None where it has none."""
        return len(self.waits) if self.running and self.named else None

    @property
    def mission(self) -> tuple[int, ...]:
        """The same, as the names that a step keeps."""
        return () if self.about is None else (self.about,)

    @property
    def waits(self) -> tuple[int, ...]:
        """The positions of the identifiers of the statuses that wait."""
        return tuple(range(sum(one.named for one in self.waiting)))

    @property
    def identifiers(self) -> int:
        """How many identifiers it has: those of the statuses that wait, then that of the mission that runs."""
        return len(self.waits) + len(self.mission)
