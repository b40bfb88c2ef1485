"""Starts every subject, leads the conversations with it and looks for crashes and for variants that show nothing."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from pathlib import Path
from threading import Timer
from typing import IO, Any

from conversations import CONVERSATIONS
from talk import LETTERS

_HERE = Path(__file__).resolve().parent
_TEXT = "-7485136457943612313"
_STATUS = "-8059665372481944188"
_SECONDS = 120.0


class Broken(Exception):
    """A subject answered what no adapter may answer, or the base showed what it should not."""


class Process:
    """A subject at work and the record of what it said."""

    def __init__(self, command: list[str]) -> None:
        """Start the subject."""
        self._process = subprocess.Popen(command, cwd=_HERE, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._timer = Timer(_SECONDS, self._process.kill)
        self._timer.start()
        self._next = 0
        self.record: list[Any] = []
        self.lines: dict[int, list[str]] = {}

    @staticmethod
    def _pipe(pipe: IO[bytes] | None) -> IO[bytes]:
        assert pipe is not None
        return pipe

    def call(self, method: str, params: dict[str, Any]) -> dict[str, Any]:
        """Ask and return the answer with its result or error."""
        self._next += 1
        stdin, stdout = self._pipe(self._process.stdin), self._pipe(self._process.stdout)
        stdin.write(json.dumps({"jsonrpc": "2.0", "id": self._next, "method": method, "params": params}).encode())
        stdin.write(b"\n")
        stdin.flush()
        while True:
            line = stdout.readline()
            if not line:
                raise Broken(f"ended during {method} {params}")
            message: dict[str, Any] = json.loads(line)
            if "method" in message:
                self._notified(message)
                continue
            if message.get("id") != self._next:
                raise Broken(f"answer to an unknown id: {message}")
            if message.get("error", {}).get("code", 0) < 0:
                raise Broken(f"{method} {params}: {message['error']}")
            self.record.append((method, message.get("result", message.get("error"))))
            return message

    def _notified(self, message: dict[str, Any]) -> None:
        self.record.append((message["method"], message["params"]))
        if message["method"] == "line":
            self.lines.setdefault(message["params"]["connection"], []).append(message["params"]["line"])

    def stop(self) -> int:
        """End of input; the exit status."""
        self._pipe(self._process.stdin).close()
        self._pipe(self._process.stdout).read()
        status = self._process.wait()
        self._timer.cancel()
        return status

    def kill(self) -> None:
        """End the subject at once."""
        self._process.kill()
        self._process.wait()
        self._timer.cancel()


class Tester:
    """One conversation with a subject."""

    def __init__(self, process: Process, is_base: bool) -> None:
        """Talk to that subject; expectations are checked of the base alone."""
        self._process = process
        self._is_base = is_base
        self._missions: list[int] = []
        self._handles_known = 0

    def reset(self, name_channel: str = "name") -> None:
        """Begin anew."""
        self._process.call("reset", {"world": {"nameChannel": name_channel}})
        self._missions = []

    def submit(self, robot: Any, upstream: list[int] | None = None, **members: Any) -> int:
        """Submit a mission."""
        handles = [self._missions[place] for place in upstream or [] if self._missions[place]]
        answer = self._process.call("submit", {"mission": {"robot": robot, "upstream": handles, **members}})
        self._missions.append(answer.get("result", {}).get("mission", 0))
        self._settle()
        return len(self._missions) - 1

    def submit_raw(self, mission: Any) -> None:
        """Submit something as it is."""
        self._process.call("submit", {"mission": mission})
        self._settle()

    def connect(self, name: str | None = None) -> int:
        """Connect and say the name where one is given."""
        connection = int(self._drive(event="connect")["connection"])
        if name is not None:
            self.name(connection, name)
        return connection

    def name(self, connection: int, name: str, channel: str = "name", **header: Any) -> None:
        """Say a name."""
        full = {"channel": channel, "pubtime": "1", "proto": _TEXT, **header}
        if full["proto"] is None:
            del full["proto"]
        self.line(connection, json.dumps({"header": full, "payload": {"text": name}}))

    def _seen(self, connection: int, nth: int) -> tuple[dict[str, Any], str] | None:
        """The uuid of the nth mission seen on a connection and its status channel, if it can be read."""
        found: list[tuple[dict[str, Any], str]] = []
        for line in self._process.lines.get(connection, []):
            try:
                message = json.loads(line)
            except ValueError:
                continue
            payload = message.get("payload", {}) if isinstance(message, dict) else {}
            if "uuid" in payload:
                found.append((payload["uuid"], "mission_status"))
        return found[nth] if -len(found) <= nth < len(found) else None

    def report(self, connection: int, state: str, nth: int = -1, **changes: Any) -> None:
        """Report on the nth mission seen on a connection."""
        seen = self._seen(changes.get("about", connection), nth)
        if seen is None:
            self._process.record.append("nothing to report on")
            return
        uuid: dict[str, Any] = {half: str(value) for half, value in seen[0].items()}
        if "uuid" in changes:
            uuid = changes["uuid"]
        if "upper" in changes:
            uuid["upper"] = changes["upper"]
        if changes.get("numbers"):
            uuid = {half: int(value) for half, value in uuid.items()}
        if changes.get("signed"):
            uuid = {half: str((int(value) + 2**63) % 2**64 - 2**63) for half, value in uuid.items()}
        header = {"channel": changes.get("channel", seen[1]), "pubtime": "1", "proto": changes.get("proto", _STATUS)}
        if header["proto"] is None:
            del header["proto"]
        self.line(connection, json.dumps({"header": header, "payload": {"uuid": uuid, "missionStatus": state}}))

    def line(self, connection: int, line: str) -> None:
        """Send a line as it is."""
        self._drive(event="line", connection=connection, line=line)

    def drop(self, connection: int) -> None:
        """Drop a connection."""
        self._drive(event="disconnect", connection=connection)

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        self._drive(event="advance", seconds=seconds)

    def expect(self, text: str) -> None:
        """Check what the base shows."""
        statuses = self._settle()
        shown = "".join(LETTERS[statuses[str(handle)]] for handle in self._missions if str(handle) in statuses)
        if self._is_base and shown != text:
            raise Broken(f"the base shows {shown}, not {text}")

    def _drive(self, **params: Any) -> dict[str, Any]:
        answer = self._process.call("drive", params)
        self._settle()
        result: dict[str, Any] = answer["result"]
        return result

    def _settle(self) -> dict[str, str]:
        self._process.call("settle", {})
        missions: dict[str, str] = self._process.call("statuses", {})["result"]["missions"]
        return missions


def _converse(command: list[str], is_base: bool) -> dict[str, list[Any]]:
    """The record of every conversation, each with a process of its own state but one process for all."""
    process = Process(command)
    records: dict[str, list[Any]] = {}
    try:
        process.call("initialize", {"protocolVersion": 1, "system": "isaac.server"})
        for conversation in CONVERSATIONS:
            tester = Tester(process, is_base)
            tester.reset()
            process.record = []
            try:
                conversation(tester)
            except Broken as broken:
                raise Broken(f"{conversation.__name__}: {broken}") from None
            records[conversation.__name__] = process.record
    except BaseException:
        process.kill()
        raise
    if process.stop() != 0:
        raise Broken("a bad exit status")
    return records


def main() -> int:
    """Try all subjects, or those named by the arguments; the number of failures shows in the exit status."""
    subjects = tomllib.loads((_HERE / "subjects.toml").read_text(encoding="utf-8"))["subject"]
    base = _converse(subjects[0]["command"], True)
    if _converse(subjects[0]["command"], True) != base:
        print("base: two runs differ")
        return 1
    failures = 0
    for subject in subjects[1:]:
        if sys.argv[1:] and subject["name"] not in sys.argv[1:]:
            continue
        try:
            records = _converse(subject["command"], False)
        except Broken as broken:
            print(f"{subject['name']}: {broken}")
            failures += 1
            continue
        different = [name for name, record in records.items() if record != base[name]]
        print(f"{subject['name']}: {'differs in ' + different[0] if different else 'NOTHING DIFFERS'}")
        failures += not different
    print(f"{len(subjects)} subjects, {failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
