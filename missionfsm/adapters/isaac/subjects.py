"""The runtime's own mission server and robot as subjects of the oracle: what is judged here is what ships.

Both are the pure cores that run under the sockets in `missionfsm.adapters.isaac.tcp`, behind the adapter protocol, on a
clock that moves only where the tester says so. Nothing is random: identifiers come from a counter.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable

from missionfsm.isaac.runtime import missionfile
from missionfsm.isaac.runtime.missionfile import MissionEntry, MissionFile
from missionfsm.isaac.runtime.missions import (
    Close,
    Effect,
    Refused,
    Send,
)
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.runtime.robot import Channels, RobotCore, RobotEffect, Transmit
from missionfsm.isaac.runtime.server import MissionServerCore, elapse
from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.framing import Decoder, as_line
from missionfsm.isaac.wire.messages import MissionStatusProto, Payload, TextProto, Uuid, stamp
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.rules import INVALID_ARGUMENT
from missionfsm.kernel.subject import Exchange, Notification, SubjectError

_NANOSECONDS = 1_000_000_000


def _line(payload: Payload, channel: str, now: float, uuid: Uuid, *, bare: bool = False) -> str:
    message = stamp(payload, channel, pubtime=round(now * _NANOSECONDS), uuid=uuid)
    return as_line(message, header_uuid_as_numbers=bare)


class _Identifiers:
    """Fresh identifiers, one after the other, with halves that no double holds."""

    def __init__(self) -> None:
        self._made = 0

    def __call__(self) -> Uuid:
        self._made += 1
        return Uuid((self._made * 0x9E3779B97F4A7C15) % (1 << 64), (self._made * 0xC2B2AE3D27D4EB4F) % (1 << 64))


class _InProcess:
    """What both have in common: initialize, reset, settle, and drives by their names."""

    system = ""
    name = ""
    drives: tuple[str, ...] = ()

    def close(self) -> None:
        """Nothing is held."""

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Answer one request of the protocol. Raises SubjectError for one that the protocol does not have."""
        params = params if isinstance(params, dict) else {}
        if method == "initialize":
            about = {"name": self.name, "version": "1"}
            return Exchange({"implementation": about, "drives": list(self.drives), "concurrent": False})
        if method == "reset":
            self.reset(params.get("world") or {})
            return Exchange({})
        if method == "settle":
            return Exchange({})
        if method == "drive" and params.get("event") in self.drives:
            return self.drive(params["event"], params)
        return self.call(method, params)

    def reset(self, world: JSON) -> None:
        """Start afresh in a world."""
        raise NotImplementedError

    def drive(self, event: str, params: JSON) -> Exchange:
        """Make something happen."""
        raise NotImplementedError

    def call(self, method: str, params: JSON) -> Exchange:
        """Answer a documented call."""
        message = f"{method!r} with {params!r} is nothing that {self.system} can be asked"
        raise SubjectError(message)


class RobotSubject(_InProcess):
    """The robot that ships, as ``isaac.robot``. It is connected from the start, and says its name as robots do."""

    system = "isaac.robot"
    name = "missionfsm robot"
    drives = ("line", "behaviorSucceeded", "behaviorFailed", "advance", "disconnect", "connect")

    def __init__(self) -> None:
        self.reset({})

    def reset(self, world: JSON) -> None:
        self._now = 0.0
        self._fresh = _Identifiers()
        self._decoder = Decoder()
        keys = {"nameChannel": "name", "channel": "missions", "statusChannel": "statuses"}
        channels = Channels(**{keys[key]: value for key, value in world.items() if key in keys})
        self._core = RobotCore(world.get("name", "robot"), channels=channels)
        self._is_connected = True
        self._core.connected(self._now)

    def drive(self, event: str, params: JSON) -> Exchange:
        effects: list[RobotEffect] = []
        if (event in ("line", "disconnect") and not self._is_connected) or (event == "connect" and self._is_connected):
            return Exchange({"happened": False})
        if event in ("connect", "disconnect"):
            self._is_connected = event == "connect"
            effects += (self._core.connected if self._is_connected else self._core.disconnected)(self._now)
        elif event == "line":
            for message in self._decoder.feed(params["line"].encode(errors="replace") + b"\n"):
                effects += self._core.received(message, self._now)
        elif event == "advance":
            return Exchange({"happened": True}, after=tuple(self._elapse(params["seconds"])))
        else:
            if self._core.codelet.mission is None and self._core.codelet.next_report is None:
                return Exchange({"happened": False})
            effects += self._core.behavior_stops(self._now, success=event == "behaviorSucceeded")
        return Exchange({"happened": True}, after=tuple(self._lines(effects)))

    def _elapse(self, seconds: float) -> Iterable[Notification]:
        until = self._now + seconds
        while (due := self._core.next_deadline()) is not None and due <= until:
            self._now = due
            yield from self._lines(self._core.advance(due))
        self._now = until
        yield from self._lines(self._core.advance(until))

    def _lines(self, effects: Iterable[RobotEffect]) -> Iterable[Notification]:
        for effect in effects:
            if isinstance(effect, Transmit):
                assert isinstance(effect.payload, TextProto | MissionStatusProto)  # noqa: S101 - what robots send
                line = _line(effect.payload, effect.channel, self._now, self._fresh())
                yield Notification("line", {"line": line})


class ServerSubject(_InProcess):
    """The mission server that ships, as ``isaac.server``, under a profile."""

    system = "isaac.server"
    drives = ("connect", "line", "disconnect", "advance")

    def __init__(self, profile: Profile = DOCUMENTED, name: str = "missionfsm server") -> None:
        self.profile = profile
        self.name = name
        self._connected = 0
        self.reset({})

    def reset(self, world: JSON) -> None:
        self._now = 0.0
        self._fresh = _Identifiers()
        self._core = MissionServerCore(self.profile, name_channel=world.get("nameChannel", "name"))
        self._missions: list[Uuid] = []
        self._decoders: dict[int, Decoder] = {}

    def call(self, method: str, params: JSON) -> Exchange:
        if method == "submit":
            return self._submit(params.get("mission"))
        if method == "statuses":
            statuses = dict(self._core.statuses())
            by_handle = {str(handle): statuses[uuid].name for handle, uuid in enumerate(self._missions, 1)}
            return Exchange({"missions": by_handle})
        return super().call(method, params)

    def _submit(self, mission: JSON) -> Exchange:
        entry = self._entry(mission)
        if isinstance(entry, str):
            return _refused(entry)
        uuid = self._fresh()
        made = self._core.create(entry.request(self._missions), uuid)
        if made is not None:
            return _refused(str(made))
        effects = self._core.submit(uuid, self._now)
        if isinstance(effects, Refused):
            return _refused(str(effects))
        self._missions.append(uuid)
        return Exchange({"mission": len(self._missions)}, after=self._lines(effects))

    def _entry(self, mission: JSON) -> MissionEntry | str:
        """The entry as a mission file would have it; its upstreams are positions among the missions so far."""
        if not isinstance(mission, dict):
            return f"wanted an object, found {strictjson.brief_json(mission)}"
        upstream = mission.get("upstream", [])
        if not isinstance(upstream, list):
            return f"upstream: wanted a list of missions, found {strictjson.brief_json(upstream)}"
        for handle in upstream:
            if isinstance(handle, bool) or not isinstance(handle, int) or not 1 <= handle <= len(self._missions):
                return f"upstream: there is no mission {strictjson.brief_json(handle)}"
        rest = {key: value for key, value in mission.items() if key != "upstream"}
        read = missionfile.parse(json.dumps({"missions": [rest]}), self.profile)
        if not isinstance(read, MissionFile):
            return "; ".join(map(str, read))
        entry = read.missions[0]
        positions = tuple(dict.fromkeys(handle - 1 for handle in upstream))
        return MissionEntry(
            entry.robot,
            entry.channel,
            entry.status_channel,
            entry.config,
            entry.start_timeout,
            entry.timeout,
            positions,
        )

    def drive(self, event: str, params: JSON) -> Exchange:
        if event == "connect":
            self._connected += 1
            number = self._connected
            self._decoders[number] = Decoder(numbers=self.profile.ai_25 == "a")
            effects = self._core.connected(number, self._now)
            return Exchange({"happened": True, "connection": number}, after=self._lines(effects))
        if event == "advance":
            return self._advance(params["seconds"])
        number = params["connection"]
        decoder = self._decoders.get(number)
        if decoder is None:
            return Exchange({"happened": False})
        if event == "disconnect":
            del self._decoders[number]
            return Exchange({"happened": True}, after=self._lines(self._core.disconnected(number, self._now)))
        found: list[Notification] = []
        for message in decoder.feed(params["line"].encode(errors="replace") + b"\n"):
            found += self._lines(self._core.received(number, message, self._now))
        return Exchange({"happened": True}, after=tuple(found))

    def _advance(self, seconds: float) -> Exchange:
        until = self._now + seconds
        found: list[Notification] = []
        while self._now < until:
            due = self._core.next_deadline()
            self._now = min(until, max(self._now, math.inf if due is None else due))
            found += self._lines(elapse(self._core, self._now))
        return Exchange({"happened": True}, after=tuple(found))

    def _lines(self, effects: Iterable[Effect]) -> tuple[Notification, ...]:
        found = []
        for effect in effects:
            if isinstance(effect, Close):
                self._decoders.pop(effect.connection, None)
                found.append(Notification("closed", {"connection": effect.connection}))
            elif isinstance(effect, Send):
                bare = self.profile.header_uuid_as_numbers
                line = _line(effect.payload, effect.channel, self._now, effect.header or self._fresh(), bare=bare)
                found.append(Notification("line", {"connection": effect.connection, "line": line}))
        return tuple(found)


def _refused(says: str) -> Exchange:
    return Exchange(error={"status": INVALID_ARGUMENT, "message": says})
