"""A mission server on a real port, with an adapter through which missions are submitted; for the bridge.

    python isaac_tcp_server.py PORT [--eager]

`--eager` breaks it: no mission waits for its upstreams.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from missionfsm.adapters.isaac.missionserver import Mission, MissionRefusedError, MissionServer
from missionfsm.adapters.stdio import serve
from missionfsm.isaac.runtime.missionfile import MissionFile, parse
from missionfsm.kernel.subject import Exchange, SubjectError


class Adapter:
    def __init__(self, port: int, *, eager: bool) -> None:
        self.port = port
        self.eager = eager
        self.server: MissionServer | None = None
        self.missions: list[Mission] = []

    def close(self) -> None:
        if self.server is not None:
            self.server.close()

    def exchange(self, method: str, params: Any) -> Exchange:
        if method == "initialize":
            about = {"name": "MissionServer", "version": "1"}
            return Exchange({"implementation": about, "drives": [], "concurrent": False})
        if method == "reset":
            self.close()
            self.missions = []
            channel = params["world"].get("nameChannel", "name")
            self.server = MissionServer(self.port, channel, host="127.0.0.1")
            return Exchange({})
        if method == "submit":
            return self.submit(params.get("mission"))
        if method == "statuses":
            return Exchange({"missions": {str(handle): one.status.name for handle, one in self.numbered()}})
        raise SubjectError(method)

    def numbered(self) -> list[tuple[int, Mission]]:
        return list(enumerate(self.missions, 1))

    def submit(self, entry: Any) -> Exchange:
        upstream = entry.get("upstream", []) if isinstance(entry, dict) else None
        known = dict(self.numbered())
        if not isinstance(upstream, list) or not all(type(one) is int and one in known for one in upstream):
            return refused("there is no such upstream")
        file = parse(json.dumps({"missions": [{key: entry[key] for key in entry if key != "upstream"}]}))
        if not isinstance(file, MissionFile):
            return refused(str(file[0]))
        (one,) = file.missions
        mission = Mission(
            one.robot,
            one.channel,
            json.loads(one.config),
            [] if self.eager else [known[handle] for handle in upstream],
            status_channel=one.status_channel,
            start_timeout=one.start_timeout,
            timeout=one.timeout,
        )
        assert self.server is not None
        try:
            self.server.submit(mission)
        except MissionRefusedError as error:
            return refused(str(error))
        self.missions.append(mission)
        return Exchange({"mission": len(self.missions)})


def refused(says: str) -> Exchange:
    return Exchange(error={"status": "INVALID_ARGUMENT", "message": says})


if __name__ == "__main__":
    adapter = Adapter(int(sys.argv[1]), eager="--eager" in sys.argv)
    try:
        serve(adapter, sys.stdin.buffer, sys.stdout.buffer)
    finally:
        adapter.close()
