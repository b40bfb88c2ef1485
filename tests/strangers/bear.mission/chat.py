"""A conversation with one subject: sends requests, checks the form of what comes back, and keeps a transcript."""

from __future__ import annotations

import json
import re
import selectors
import subprocess
import time
from pathlib import Path
from typing import Any

Json = dict[str, Any]
HERE = Path(__file__).parent
PATIENCE = 20.0


class Broken(Exception):
    """The subject does not keep to the adapter protocol."""


def goal(name: str) -> Json:
    """A goal by its destination."""
    return {"destinationId": name}


def pose(x: float, heading: float = 0.0) -> Json:
    """A goal by its pose."""
    return {"pose": {"xMeters": x, "yMeters": 7.8, "headingRadians": heading}}


def one(family: str, kind: str, where: str | Json) -> Json:
    """A mission request with a single goal."""
    target = goal(where) if isinstance(where, str) else where
    return {"mission": {f"{family}Mission": {f"{kind}Mission": {"goal": target}}}}


def many(family: str, kind: str, *where: str | Json) -> Json:
    """A mission request with a list of goals."""
    goals = [goal(name) if isinstance(name, str) else name for name in where]
    return {"mission": {f"{family}Mission": {f"{kind}Mission": {"goals": goals}}}}


def workflow(family: str, kind: str, *where: str) -> Json:
    """A workflow request."""
    body: Json = {"goal": goal(where[0])} if kind == "birthday" else {"goals": [goal(name) for name in where]}
    return {"missionWorkflow": {f"{family}Workflow": {kind: body}}}


class Chat:
    """Drives one subject."""

    def __init__(self, command: list[str]) -> None:
        """Start the subject."""
        self.process = subprocess.Popen(
            command, cwd=HERE, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, bufsize=0
        )
        assert self.process.stdout is not None
        self.selector = selectors.DefaultSelector()
        self.selector.register(self.process.stdout, selectors.EVENT_READ)
        self.rest = b""
        self.requests = 0
        self.calls = 0
        self.transcript: list[Any] = []
        self.ids: list[str] = []
        self.answered: list[str] = []
        self.moments: dict[int, str] = {}
        self.first_stream = 0
        self.streams: list[int] = []

    # lines

    def read(self) -> Json:
        """The next line of the subject."""
        assert self.process.stdout is not None
        end = time.monotonic() + PATIENCE
        while b"\n" not in self.rest:
            if not self.selector.select(max(0.0, end - time.monotonic())):
                raise Broken("no answer in time")
            piece = self.process.stdout.read(65536)
            if not piece:
                raise Broken("the subject has ended")
            self.rest += piece
        line, self.rest = self.rest.split(b"\n", 1)
        found = json.loads(line)
        if not isinstance(found, dict) or found.get("jsonrpc") != "2.0":
            raise Broken(f"no JSON-RPC: {line!r}")
        return found

    def ask(self, method: str, params: Json, settle: bool = True) -> tuple[Json, list[Json], list[Json]]:
        """Send a request; the answer and the messages before and after it, until what it caused is settled."""
        answer, before = self.exchange(method, params)
        if not settle:
            return answer, before, []
        _, after = self.exchange("settle", {})
        return answer, before, after

    def exchange(self, method: str, params: Json) -> tuple[Json, list[Json]]:
        """Send one request and read up to its answer."""
        self.requests += 1
        line = json.dumps({"jsonrpc": "2.0", "id": self.requests, "method": method, "params": params}) + "\n"
        assert self.process.stdin is not None
        self.process.stdin.write(line.encode())
        messages = []
        while True:
            item = self.read()
            if "method" in item:
                messages.append(item["params"])
                continue
            if item.get("id") != self.requests or ("result" in item) == ("error" in item):
                raise Broken(f"no answer: {item}")
            return item, messages

    def close(self) -> None:
        """End the subject and insist on a clean exit."""
        assert self.process.stdin is not None and self.process.stderr is not None
        self.process.stdin.close()
        status = self.process.wait(PATIENCE)
        complaint = self.process.stderr.read()
        if status != 0 or complaint:
            raise Broken(f"exit {status}: {complaint[-500:]!r}")

    # the transcript

    def plain(self, value: Any) -> Any:
        """A value with ids replaced by their order of appearance."""
        if isinstance(value, dict):
            return {name: self.plain(item) for name, item in value.items()}
        if isinstance(value, list):
            return [self.plain(item) for item in value]
        return self.named(value) if isinstance(value, str) and value in self.ids else value

    def named(self, mission_id: str) -> str:
        """What stands for an id: its order of appearance and its form."""
        form = re.sub(r"[0-9a-f]{4,}", "x", re.sub(r"\d+", "0000", mission_id))
        return f"#{self.ids.index(mission_id)}:{form}"

    def learn(self, value: Any) -> None:
        """Take notice of the ids in an answer or a message."""
        if isinstance(value, list):
            for item in value:
                self.learn(item)
        elif isinstance(value, dict):
            for name, item in value.items():
                found = item if isinstance(item, list) else [item]
                if name in ("missionId", "missionIds", "mission_id"):
                    self.ids += [one for one in found if isinstance(one, str) and one and one not in self.ids]
                else:
                    self.learn(item)

    def shown(self, message: Json) -> Any:
        """A stream message as it stands in the transcript."""
        stream = message["stream"]
        if stream not in self.streams:
            raise Broken(f"a message on stream {stream}")
        self.learn(message)
        shown = self.plain(message["message"])
        metadata = shown.get("metadata", {})
        moment = metadata.get("timestamp")
        if isinstance(moment, str):
            later = moment >= self.moments.get(stream, "")
            self.moments[stream] = moment
            metadata["timestamp"] = "later" if later else "earlier"
        elif moment is not None:
            metadata["timestamp"] = "in parts"
        number = metadata.get("sequenceNumber")
        if isinstance(number, int) and number > 1_000_000_000:
            metadata["sequenceNumber"] = "huge"
        return [stream - self.first_stream, shown]

    def call(self, method: str, params: Json | None = None, settle: bool = True) -> Json:
        """Make a call and put it down with everything that it caused."""
        answer, before, after = self.ask(method, params or {}, settle)
        error = answer.get("error", {})
        if "error" in answer and (error.get("code", -1) < 0 or not error.get("data", {}).get("status")):
            raise Broken(f"{method} {params}: {error}")
        result: Json = answer.get("result", {})
        if method == "SubscribeMissionStatus" and "stream" in result:
            self.first_stream = self.first_stream if self.streams else result["stream"]
            self.streams.append(result["stream"])
            result = {"stream": result["stream"] - self.first_stream}
        fresh = [result[name] for name in ("missionId", "missionIds") if name in result]
        self.learn(result)
        for item in fresh:
            self.answered += item if isinstance(item, list) else [item]
        outcome = self.plain(result) if "result" in answer else [error["code"], error["data"]["status"]]
        self.transcript.append([method, outcome, [self.shown(m) for m in before], [self.shown(m) for m in after]])
        return result

    # shorthands

    def reset(self, **world: Any) -> None:
        """Begin anew, with one stream open."""
        self.streams, self.answered = [], []
        self.call("reset", {"world": world})
        self.call("SubscribeMissionStatus")

    def nth(self, number: int) -> str:
        """The id that was answered as the nth since the last reset; counted from 0."""
        return self.answered[number] if -len(self.answered) <= number < len(self.answered) else "nobody"

    def create(self, request: Json) -> None:
        """CreateMission."""
        self.call("CreateMission", request)

    def append(self, request: Json) -> None:
        """AppendMission."""
        self.call("AppendMission", request)

    def batch(self, *requests: Json) -> None:
        """CreateMissionBatch."""
        self.call("CreateMissionBatch", {"missions": list(requests)})

    def append_batch(self, *requests: Json) -> None:
        """AppendMissionBatch."""
        self.call("AppendMissionBatch", {"missions": list(requests)})

    def update(self, number: int, command: str) -> None:
        """UpdateMission for the nth answered id."""
        self.call("UpdateMission", {"missionCommand": {"missionId": self.nth(number), "command": f"COMMAND_{command}"}})

    def drive(self, event: str, times: int = 1, **fields: Any) -> None:
        """Let something happen, once or more often."""
        for _ in range(times):
            self.call("drive", {"event": event, **fields})

    def look(self) -> None:
        """Open a second stream for a snapshot, and give it up."""
        self.call("SubscribeMissionStatus")
        self.call("cancel", {"stream": self.streams[-1]})
        self.streams.pop()
