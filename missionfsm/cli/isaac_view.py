"""What `missionfsm dispatch` and `robot` show: a live table on a terminal, else lines, written in the background."""

import collections
import datetime as dt
import enum
import heapq
import sys
from types import TracebackType
from typing import Final, Protocol, Self

import orjson
from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from missionfsm.adapters.background import BackgroundLines, stdout_lines
from missionfsm.cli.common import complain
from missionfsm.isaac.runtime.codelet import Report
from missionfsm.isaac.runtime.log import Entry, Level
from missionfsm.isaac.runtime.missionfile import MissionFile
from missionfsm.isaac.runtime.missions import Status
from missionfsm.isaac.runtime.robot import Did
from missionfsm.kernel.text import clipped, printable

_STYLES: Final = {Status.SUCCESS: "green", Status.RUNNING: "cyan", Status.STARTED: "cyan"}
_ACTIVE: Final = (Status.STARTED, Status.RUNNING)
_FRAME: Final = 12  # lines of a table that are no rows, twice over


class LogFormat(enum.StrEnum):
    """How a line is written."""

    PLAIN = "plain"
    TEXT = "text"
    JSON = "json"


def written(entry: Entry, style: LogFormat, time: dt.datetime) -> str:
    """An entry as one line: its text alone, its text after time and level, or all of it as JSON."""
    if style is LogFormat.PLAIN:
        return clipped(entry.text)
    stamp = time.astimezone(dt.UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
    level = entry.level.name.lower()
    if style is LogFormat.TEXT:
        mission = f" ({entry.fields['uuid']})" if "uuid" in entry.fields else ""
        return f"{stamp} {level:<7} {clipped(entry.text)}{mission}"
    line = {"time": stamp, "level": level, "event": entry.event, **entry.fields, "text": entry.text}
    return orjson.dumps(line).decode()


def robot_line(effect: object) -> str | None:
    """What is worth telling of what a simulated robot did."""
    if isinstance(effect, Did) and isinstance(effect.action, Report):
        status = effect.action.status
        return f"mission {status.uuid or 'without an id'}: {status.mission_status.value}"
    return None


class Log:
    """Entries as lines on stdout. Nobody waits for those who read them; who stops reading stops nothing."""

    def __init__(self, style: LogFormat = LogFormat.PLAIN, level: Level = Level.INFO) -> None:
        self._style = style
        self._level = level
        self._lines: BackgroundLines = stdout_lines(self._missing)

    def tell(self, entry: Entry) -> None:
        """Have an entry written, if it matters enough."""
        if entry.level >= self._level:
            self._lines.say(written(entry, self._style, dt.datetime.now(dt.UTC)))

    def say(self, line: str) -> None:
        """Tell a line."""
        self.tell(Entry("note", line))

    def close(self) -> None:
        """Wait as long as somebody reads, and complain of lines that nobody has read."""
        unread = self._lines.close()
        if unread:
            complain(f"{unread} lines were not written: nobody reads stdout")

    def _missing(self, count: int) -> str:
        entry = Entry("missing", f"{count} lines are missing here: nobody read them in time", Level.WARNING)
        return written(entry, self._style, dt.datetime.now(dt.UTC))


class Progress(Protocol):
    """What a table shows: the missions of a file, and where each stands."""

    file: MissionFile
    statuses: list[Status]


class View:
    """A line for all that happens."""

    def __init__(self, log: Log) -> None:
        self._log = log

    def tell(self, entry: Entry) -> None:
        """Tell what happened."""
        self._log.tell(entry)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._log.close()


class TableView:
    """On a terminal: tables that change in place, as tall as the terminal allows, and no lines but the last."""

    def __init__(self, progress: Progress, console: Console | None = None) -> None:
        self.robots: dict[str, bool] = {}
        self._progress = progress
        self._expected = {entry.robot for entry in progress.file.missions}
        self._console = console or Console()
        self._title = ""
        self._last = ""
        self._live = Live(get_renderable=self.render, console=self._console, refresh_per_second=4)

    def tell(self, entry: Entry) -> None:
        """Take note of what happened."""
        robot = str(entry.fields.get("robot"))
        if entry.event == "listening":
            self._title = ", ".join(filter(None, (self._title, entry.text)))
        elif entry.event in ("robot-connected", "robot-taken-over"):
            self.robots[robot] = True
        elif entry.event == "robot-disconnected":
            if robot in self._expected:
                self.robots[robot] = False
            else:  # anybody may connect; only those whom the file names are remembered
                self.robots.pop(robot, None)
        elif entry.event == "summary":
            self._last = entry.text

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
            entry, status = self._progress.file.missions[number], self._progress.statuses[number]
            style = _STYLES.get(status, "red" if status.terminal else "dim")
            upstream = [str(one) for one in entry.upstream if not self._progress.statuses[one].terminal]
            missions.add_row(
                str(number),
                Text(printable(str(entry.robot))),
                Text(status.value, style=style),
                Text(", ".join(upstream[:9])),
            )
        counts = collections.Counter(self._progress.statuses)
        total = ", ".join(f"{counts[status]} {status.value}" for status in Status if counts[status])
        hidden = len(self._progress.statuses) - len(rows)
        total += f" ({hidden} not shown)" if hidden else ""
        return Group(Text(self._title), robots, missions, Text(total))

    def _most_telling(self, room: int) -> list[int]:
        """The missions to show if not all have room: running ones first, then waiting ones, then ended ones."""
        statuses = self._progress.statuses
        if len(statuses) <= room:
            return list(range(len(statuses)))

        def rank(number: int) -> int:
            status = statuses[number]
            return 0 if status in _ACTIVE else 2 if status.terminal else 1

        return sorted(heapq.nsmallest(room, range(len(statuses)), key=lambda number: (rank(number), number)))

    def __enter__(self) -> Self:
        self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.__exit__(kind, error, trace)
        if self._last:
            self._console.print(Text(self._last))


def view_for(progress: Progress, style: LogFormat | None, level: Level) -> View | TableView:
    """A live table where stdout is a terminal and no format was asked for, else lines."""
    if style is None and sys.stdout is not None and sys.stdout.isatty():
        return TableView(progress)
    return View(Log(style or LogFormat.PLAIN, level))
