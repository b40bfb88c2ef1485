"""The mission file: a list of missions as JSON, checked whole before anything is sent.

``MissionSubmission › Sample Usage``. Every problem is reported with its place, not only the first. Unknown keys are
ignored (AI-20), with a warning. An upstream may stand further down in the file (AI-21 a) unless the caller takes the
other reading.
`Infinity` is taken for a timeout (AI-24 d), and nowhere else.
"""

import difflib
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

import attrs

from missionfsm.isaac.runtime.graph import cycles, topological_order
from missionfsm.isaac.runtime.missions import (
    DEFAULT_CHANNEL,
    DEFAULT_START_TIMEOUT,
    Effect,
    MissionRequest,
    Refused,
    too_long,
)
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.framing import MAX_LINE
from missionfsm.isaac.wire.messages import Uuid
from missionfsm.isaac.wire.strictjson import JsonFault, JsonObject, brief_json

_LONG: Final = 40  # letters of an unknown key that are compared with the known ones
_KEYS: Final = ("robot", "channel", "status_channel", "config", "start_timeout", "timeout", "upstream")


@attrs.frozen
class FileProblem:
    """What is wrong, and where: ``missions[2].upstream[0]``, or ``line 3, column 5`` in a text that is no JSON."""

    place: str
    problem: str

    def __str__(self) -> str:
        return f"{self.place}: {self.problem}"


@attrs.frozen
class MissionEntry:
    """One entry of the file, with the documented defaults filled in; `upstream` are indices, each once.

    `status_channel` None is whatever the server's default is. `config` is JSON text, of an object.
    """

    robot: str | None = None
    channel: str = DEFAULT_CHANNEL
    status_channel: str | None = None
    config: str = "{}"
    start_timeout: float = DEFAULT_START_TIMEOUT
    timeout: float = math.inf
    upstream: tuple[int, ...] = ()

    def request(self, uuids: Sequence[Uuid]) -> MissionRequest:
        """The entry as the server takes it, where `uuids` are those of the file's missions."""
        return MissionRequest(
            robot=self.robot,
            channel=self.channel,
            status_channel=self.status_channel,
            config=self.config,
            start_timeout=self.start_timeout,
            timeout=self.timeout,
            upstream=tuple(uuids[index] for index in self.upstream),
        )


@attrs.frozen
class MissionFile:
    """A file without a problem: its missions, which form a DAG, and what is odd about it all the same."""

    missions: tuple[MissionEntry, ...]
    warnings: tuple[FileProblem, ...] = ()


def parse(
    text: bytes | str, profile: Profile = DOCUMENTED, *, line_limit: int = MAX_LINE
) -> MissionFile | tuple[FileProblem, ...]:
    """The missions in a file, or all that is wrong with it.

    The profile says whether an upstream may stand further down (AI-21) and whether a robot is needed (AI-19).
    `line_limit` is that of :class:`~missionfsm.isaac.runtime.server.MissionServerCore`.
    """
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            return (FileProblem(f"byte {error.start}", "not UTF-8"),)
    value = strictjson.parse(text)
    if isinstance(value, JsonFault):
        before = text[: value.position]
        line = before.count("\n") + 1
        column = value.position - (before.rfind("\n") + 1) + 1
        return (FileProblem(f"line {line}, column {column}", value.problem),)
    reader = _Reader(profile, line_limit)
    missions = reader.file(value)
    return tuple(reader.problems) if reader.problems else MissionFile(missions, tuple(reader.warnings))


def submit_all(
    core: MissionServerCore, file: MissionFile, uuids: Sequence[Uuid], now: float
) -> Refused | tuple[Effect, ...]:
    """Create all missions of a file, then submit all, in the order of the file.

    `uuids` are fresh identifiers, one an entry. Only where the server refuses a mission whose upstreams were not
    submitted (AI-22 b) do upstreams go first. What a server refuses, a file that was parsed with its profile does not
    hold, unless an identifier is not fresh.
    """
    order = topological_order([entry.upstream for entry in file.missions])
    for index in order:
        refused = core.create(file.missions[index].request(uuids), uuids[index])
        if refused is not None:
            return Refused(f"missions[{index}]: {refused}")
    effects: list[Effect] = []
    for index in order if core.profile.ai_22_upstream == "b" else range(len(order)):
        if core.profile.ai_22_upstream == "c" and core.submitted(uuids[index]):
            continue
        result = core.submit(uuids[index], now)
        if isinstance(result, Refused):
            return Refused(f"missions[{index}]: {result}")
        effects += result
    return tuple(effects)


class _Reader:
    """Reads a parsed file, collecting all that is wrong."""

    def __init__(self, profile: Profile, line_limit: int) -> None:
        self._profile = profile
        self._line_limit = line_limit
        self.problems: list[FileProblem] = []
        self.warnings: list[FileProblem] = []

    def file(self, value: object) -> tuple[MissionEntry, ...]:
        if not isinstance(value, JsonObject):
            self._wrong("file", f'wanted an object with the key "missions", found {brief_json(value)}')
            return ()
        self._doubled(value, "", ("missions",))
        self._unknown(value, "", ("missions",))
        missions = value.get("missions")
        if not isinstance(missions, list):
            found = "is missing" if "missions" not in value else f"wanted a list, found {brief_json(missions)}"
            self._wrong("missions", found)
            return ()
        entries = tuple(
            self._entry(entry, f"missions[{index}]", index, len(missions)) for index, entry in enumerate(missions)
        )
        for cycle in cycles([entry.upstream for entry in entries]):
            round_trip = " -> ".join(f"missions[{index}]" for index in (*cycle, cycle[0]))
            self._wrong(f"missions[{cycle[0]}].upstream", f"each waits for the next, in a cycle: {round_trip}")
        return entries

    def _wrong(self, place: str, problem: str) -> None:
        self.problems.append(FileProblem(place, problem))

    def _all_wrong(self, found: Iterable[tuple[str, str]]) -> None:
        for place, problem in found:
            self._wrong(place, problem)

    def _doubled(self, value: JsonObject, path: str, keys: Sequence[str]) -> None:
        for key in value.doubled:
            if key in keys:
                self._wrong(strictjson.below(path, key), "is given more than once")

    def _unknown(self, value: JsonObject, path: str, keys: Sequence[str]) -> None:
        for key in value:
            if key not in keys:
                near = difflib.get_close_matches(key[:_LONG].lower().replace("-", "_"), keys, 1)
                hint = f"; did you mean {near[0]}?" if near else f"; known are {', '.join(keys)}"
                self.warnings.append(FileProblem(strictjson.below(path, key), f"is unknown and ignored{hint}"))

    def _entry(self, value: object, path: str, index: int, count: int) -> MissionEntry:
        if not isinstance(value, JsonObject):
            self._wrong(path, f"wanted an object, found {brief_json(value)}")
            return MissionEntry()
        self._doubled(value, path, _KEYS)
        self._unknown(value, path, _KEYS)
        status_channel = value.get("status_channel")
        entry = MissionEntry(
            robot=self._robot(value.get("robot"), f"{path}.robot"),
            channel=self._text(value.get("channel", DEFAULT_CHANNEL), f"{path}.channel"),
            status_channel=(
                self._text(status_channel, f"{path}.status_channel") if "status_channel" in value else None
            ),
            config=self._config(value.get("config"), f"{path}.config"),
            start_timeout=self._seconds(value.get("start_timeout", DEFAULT_START_TIMEOUT), f"{path}.start_timeout"),
            timeout=self._seconds(value.get("timeout", math.inf), f"{path}.timeout"),
            upstream=tuple(self._upstream(value.get("upstream", []), f"{path}.upstream", index, count)),
        )
        if (problem := too_long(entry.channel, entry.config, self._line_limit)) is not None:
            self._wrong(f"{path}.config", problem)
        return entry

    def _robot(self, value: object, path: str) -> str | None:
        if value is None:
            if self._profile.ai_19 == "c":
                self._wrong(path, "is missing: no robot to submit the mission to")
            return None
        name = self._text(value, path)
        if isinstance(value, str) and not (name.strip() if self._profile.ai_37 == "b" else name):
            self._wrong(path, f"{brief_json(value)} is no name that a robot can have")
        return name

    def _text(self, value: object, path: str) -> str:
        if not isinstance(value, str):
            self._wrong(path, f"wanted a string, found {brief_json(value)}")
            return ""
        self._all_wrong(strictjson.faults(value, path))
        return value

    def _config(self, value: object, path: str) -> str:
        if value is None:  # AI-33
            return "{}"
        if not isinstance(value, JsonObject):
            self._wrong(path, f"wanted an object, found {brief_json(value)}")
            return "{}"
        found = tuple(strictjson.faults(value, path))
        self._all_wrong(found)
        return "{}" if found else strictjson.compact(value)

    def _seconds(self, value: object, path: str) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            self._wrong(path, f"wanted a number of seconds, found {brief_json(value)}")
            return 0.0
        try:
            seconds = float(value)
        except OverflowError:
            self._wrong(path, "is too large; leave the timeout out for none")
            return 0.0
        if not seconds >= 0:
            self._wrong(path, f"wanted 0 seconds or more, found {brief_json(value)}")
            return 0.0
        return seconds

    def _upstream(self, value: object, path: str, index: int, count: int) -> Iterator[int]:
        if not isinstance(value, list):
            self._wrong(path, f"wanted a list of indices, found {brief_json(value)}")
            return
        seen: set[int] = set()
        for position, upstream in enumerate(value):
            place = f"{path}[{position}]"
            problem = self._upstream_problem(upstream, index, count)
            if problem is not None:
                self._wrong(place, problem)
                continue
            if upstream > index and self._profile.ai_21 == "b":
                self._wrong(place, f"mission {upstream} stands further down, which this server does not take")
            if upstream not in seen:
                seen.add(upstream)
                yield upstream

    def _upstream_problem(self, upstream: object, index: int, count: int) -> str | None:
        if isinstance(upstream, bool) or not isinstance(upstream, int):
            return f"wanted the index of a mission, found {brief_json(upstream)}"
        if not 0 <= upstream < count:
            missions = "1 mission" if count == 1 else f"{count} missions"
            return f"there is no mission {brief_json(upstream)} in a file of {missions}, counted from 0"
        return "the mission waits for itself" if upstream == index else None
