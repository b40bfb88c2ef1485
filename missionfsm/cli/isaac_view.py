"""What `missionfsm dispatch` shows: a live table on a terminal, a line a change on a pipe."""

import heapq
import sys
from types import TracebackType
from typing import Final, Self

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from missionfsm.cli.common import complain, say
from missionfsm.isaac.runtime.codelet import Report
from missionfsm.isaac.runtime.missionfile import MissionFile
from missionfsm.isaac.runtime.missions import INCOMPLETE, RobotOffline, RobotOnline, Status, StatusChanged
from missionfsm.isaac.runtime.robot import Did
from missionfsm.isaac.wire.messages import Uuid
from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.text import printable

_STYLES: Final = {Status.SUCCESS: "green", Status.RUNNING: "cyan", Status.STARTED: "cyan"}
_ACTIVE: Final = (Status.STARTED, Status.RUNNING)
_FRAME: Final = 12  # lines of a table that are no rows, twice over


def robot_line(effect: object) -> str | None:
    """What is worth telling of what a simulated robot did."""
    if isinstance(effect, Did) and isinstance(effect.action, Report):
        status = effect.action.status
        return f"mission {status.uuid or 'without an id'}: {status.mission_status.value}"
    return None


class Printer:
    """Prints lines at once, and falls silent when nobody can read them any more: robots go on all the same."""

    def say(self, line: str) -> None:
        """Print one line."""
        try:
            say(printable(line))
        except UnreadableError as error:
            complain(str(error))


class View:
    """Follows the missions of one file. Plain: a line for every change."""

    def __init__(self, file: MissionFile) -> None:
        self.file = file
        self.statuses = [Status.CREATED] * len(file.missions)
        self.robots: dict[str, bool] = {}
        self._numbers: dict[Uuid, int] = {}
        self._counts = dict.fromkeys(Status, 0)
        self._counts[Status.CREATED] = len(self.statuses)
        self._expected = {entry.robot for entry in file.missions}
        self._printer = Printer()

    @property
    def unfinished(self) -> int:
        """How many missions have not ended."""
        return sum(self._counts[status] for status in INCOMPLETE)

    @property
    def succeeded(self) -> int:
        """How many missions have succeeded."""
        return self._counts[Status.SUCCESS]

    def name(self, uuids: tuple[Uuid, ...]) -> None:
        """Say under which identifiers the missions run."""
        self._numbers = {uuid: number for number, uuid in enumerate(uuids)}

    def see(self, effect: object) -> None:
        """Take note of what the server does."""
        if isinstance(effect, StatusChanged):
            number = self._numbers[effect.mission]
            self._counts[self.statuses[number]] -= 1
            self._counts[effect.status] += 1
            self.statuses[number] = effect.status
            robot = self.file.missions[number].robot
            self.say(f"missions[{number}] {robot}: {effect.status.value}")
        elif isinstance(effect, RobotOnline):
            self.robots[effect.robot] = True
            self.say(f"robot {effect.robot}: connected")
        elif isinstance(effect, RobotOffline):
            if effect.robot in self._expected:
                self.robots[effect.robot] = False
            else:  # anybody may connect; only those whom the file names are remembered
                self.robots.pop(effect.robot, None)
            self.say(f"robot {effect.robot}: disconnected")

    def say(self, line: str) -> None:
        """Tell one line."""
        self._printer.say(line)

    def summarize(self) -> None:
        """Tell how it ended."""
        failed = len(self.statuses) - self.succeeded
        self._printer.say(f"{self.succeeded} succeeded, {failed} did not")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None


class TableView(View):
    """On a terminal: tables that change in place, as tall as the terminal allows, and no lines."""

    def __init__(self, file: MissionFile, console: Console | None = None) -> None:
        super().__init__(file)
        self._console = console or Console()
        self._title = ""
        self._live = Live(get_renderable=self.render, console=self._console, refresh_per_second=4)

    def say(self, line: str) -> None:
        """Keep only what the title says."""
        self._title = line if line.startswith("listening") else self._title

    def render(self) -> Group:
        """The tables as they are now."""
        room = max(self._console.height - _FRAME, 4)
        robots = Table("robot", "connection")
        for robot, connected in list(self.robots.items())[: room // 3]:  # a copy: Live looks from a thread of its own
            robots.add_row(
                Text(printable(robot)),
                Text("connected", style="green") if connected else Text("disconnected", style="red"),
            )
        missions = Table("mission", "robot", "status", "waits for")
        rows = self._most_telling(max(room - robots.row_count, 2))
        for number in rows:
            entry, status = self.file.missions[number], self.statuses[number]
            style = _STYLES.get(status, "red" if status.terminal else "dim")
            upstream = [str(one) for one in entry.upstream if not self.statuses[one].terminal]
            missions.add_row(
                str(number),
                Text(printable(str(entry.robot))),
                Text(status.value, style=style),
                Text(", ".join(upstream[:9])),
            )
        total = ", ".join(f"{count} {status.value}" for status, count in self._counts.items() if count)
        hidden = len(self.statuses) - len(rows)
        total += f" ({hidden} not shown)" if hidden else ""
        return Group(Text(self._title), robots, missions, Text(total))

    def _most_telling(self, room: int) -> list[int]:
        """The missions to show where not all have room: what runs, then what waits, then what has ended."""
        if len(self.statuses) <= room:
            return list(range(len(self.statuses)))

        def rank(number: int) -> int:
            status = self.statuses[number]
            return 0 if status in _ACTIVE else 2 if status.terminal else 1

        return sorted(heapq.nsmallest(room, range(len(self.statuses)), key=lambda number: (rank(number), number)))

    def __enter__(self) -> Self:
        self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.__exit__(kind, error, trace)


def view_for(file: MissionFile) -> View:
    """A live table where stdout is a terminal, else plain lines."""
    return TableView(file) if sys.stdout is not None and sys.stdout.isatty() else View(file)
