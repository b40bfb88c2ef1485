"""A mission as the page's sample makes one. MissionSubmission › Sample Usage."""

import json
import math
from collections.abc import Iterable, Mapping
from types import UnionType
from typing import Any, Self

import attrs

from missionfsm.adapters.isaac.tcp import fresh_uuid
from missionfsm.isaac.runtime.missions import DEFAULT_START_TIMEOUT, MissionRequest, Snapshot
from missionfsm.isaac.runtime.missions import Status as MissionStatus
from missionfsm.isaac.runtime.scheduler import upstreams_first
from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.messages import Uuid


class MissionRefusedError(ValueError):
    """The server did not take a mission; missions upstream of it may have been made known to it."""


class Mission:
    """A mission, with the documented keys and defaults. Its `status` changes once it is submitted.

    `config` is any JSON object. Timeouts are seconds, 0 … inf. ValueError for what cannot be sent, TypeError for what
    is of another kind: a channel that is a number, a robot that is no text.

    Attributes:
        uuid: its identifier, the same over retries.
        upstream: the missions that have to succeed first.
        status: where it stands; may be read from any thread.
    """

    Status = MissionStatus

    def __init__(
        self,
        robot: str | None = None,
        channel: str = "mission",
        config: Mapping[str, Any] | None = None,
        upstream: Iterable["Mission"] = (),
        *,
        status_channel: str | None = None,
        start_timeout: float = DEFAULT_START_TIMEOUT,
        timeout: float = math.inf,
    ) -> None:
        self.upstream = tuple(upstream)
        _refuse_others("robot", robot, str | None, "a text")
        _refuse_others("channel", channel, str, "a text")
        _refuse_others("status_channel", status_channel, str | None, "a text")
        _refuse_others("start_timeout", start_timeout, int | float, "a number of seconds")
        _refuse_others("timeout", timeout, int | float, "a number of seconds")
        for one in self.upstream:
            _refuse_others("upstream", one, Mission, "missions")
        self.uuid: Uuid = fresh_uuid()
        self.request = MissionRequest(
            robot=robot,
            channel=channel,
            status_channel=status_channel,
            config=_config_text({} if config is None else config),
            start_timeout=start_timeout,
            timeout=timeout,
            upstream=tuple(mission.uuid for mission in self.upstream),
        )
        self.status = MissionStatus.CREATED
        self.server: object = None  # the one that it was submitted to
        self.forgotten = False  # by that server

    @classmethod
    def restored(cls, kept: Snapshot, upstream: Iterable["Mission"], server: object) -> Self:
        """A mission that a journal kept, as one of the server that reads it."""
        made = cls(upstream=upstream)
        made.uuid, made.request, made.status, made.server = kept.uuid, kept.request, kept.status, server
        return made

    @property
    def robot(self) -> str | None:
        """The robot that the mission is for."""
        return self.request.robot

    @property
    def channel(self) -> str:
        """The channel on which it is sent."""
        return self.request.channel

    @property
    def config(self) -> dict[str, Any]:
        """The configuration that it carries, each time as a new value."""
        config: dict[str, Any] = json.loads(self.request.config)
        return config

    @property
    def outstanding_upstream(self) -> tuple["Mission", ...]:
        """The upstreams that have not succeeded."""
        return tuple(one for one in self.upstream if one.status is not MissionStatus.SUCCESS)

    def outstanding_request(self) -> MissionRequest:
        """The request without upstreams that have succeeded and are forgotten; MissionRefusedError if one had not."""
        known: list[Uuid] = []
        for one in self.upstream:
            if not one.forgotten:
                known.append(one.uuid)
            elif one.status is not MissionStatus.SUCCESS:
                raise MissionRefusedError(f"upstream {one!r} is forgotten, and had not succeeded")
        return attrs.evolve(self.request, upstream=tuple(known))

    def __repr__(self) -> str:
        return f"<Mission {self.uuid} for {self.request.robot!r}: {self.status.value}>"


def _refuse_others(name: str, value: object, kind: type | UnionType, wanted: str) -> None:
    if isinstance(value, bool) or not isinstance(value, kind):
        msg = f"{name}: wanted {wanted}, found {value!r}"
        raise TypeError(msg)


def _config_text(config: Mapping[str, Any]) -> str:
    try:
        text = strictjson.compact(dict(config))
    except (TypeError, ValueError, RecursionError) as error:
        msg = f"config is not JSON: {error}"
        raise ValueError(msg) from None
    problem = next(strictjson.faults(strictjson.parse(text), "config"), None)
    if problem is not None:
        msg = f"{problem[0]} {problem[1]}"
        raise ValueError(msg)
    return text


def not_submitted(mission: Mission) -> list[Mission]:
    """A mission behind all its upstreams that no server knows, upstreams first."""
    return upstreams_first(mission, lambda one: [up for up in one.upstream if up.server is None])
