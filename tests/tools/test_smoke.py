"""The first minutes of an adapter: each fault in one line that says what was expected, what came and what to change."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
from commandline import CommandLine

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, MissingMethodError, Notification
from missionfsm.systems import names, system
from missionfsm.tools.conform.run import BOUNDS
from missionfsm.tools.conform.smoke import smoke
from missionfsm.tools.placeholders import is_template
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")


class Odd:
    """The reference, but for what is answered to some methods: a result, or an error that is raised."""

    def __init__(self, **instead: Any) -> None:
        self.instead = instead
        self.reference = ReferenceSubject(MISSION, {})

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Answer."""
        exchange = self.reference.exchange(method, params)
        odd = self.instead.get(method)
        if isinstance(odd, Exception):
            raise odd
        return exchange if odd is None else Exchange(odd, None, exchange.before, exchange.after)

    def close(self) -> None:
        """Nothing is held."""


@pytest.mark.parametrize("name", names())
def test_the_reference_is_an_adapter(name: str) -> None:
    """Every method and every drive that needs no name is tried; nothing is wrong and nothing is left to do."""
    tried = system(name)
    found = smoke(tried, lambda: ReferenceSubject(tried, {}))
    assert (found.faults, found.left) == ((), ())
    assert set(tried.codec.methods) <= set(found.tried)
    drives = {one["event"] for one in tried.alphabet({}, BOUNDS).drives if not is_template(one)}
    assert {one.removeprefix("drive ") for one in found.tried if one.startswith("drive ")} == drives
    assert str(found).startswith(f"missionfsm reference 1 is an adapter of {name}: ")


ABOUT = {"implementation": {"name": "mine"}, "drives": ["goalreached", "fly"]}


@pytest.mark.parametrize(
    ("instead", "faults"),
    [
        (
            {"initialize": ABOUT},
            (
                "initialize declares drive 'goalreached' (goalReached may be meant), which is not known",
                "initialize declares drive 'fly', which is not known",
            ),
        ),
        (
            {"initialize": {}},
            (
                "initialize: the adapter answered initialize without an implementation name: {}; "
                'answer with {"implementation": {"name": …}, "drives": […]}',
            ),
        ),
        ({"reset": "ok"}, ("reset: {} was expected and 'ok' came; answer with an empty object",)),
        (
            {
                "drive": {"happened": "yes"},
                "initialize": {"implementation": {"name": "mine"}, "drives": ["goalReached"]},
            },
            (
                'drive goalReached: {"happened": true} or {"happened": false} was expected and '
                "{'happened': 'yes'} came",
            ),
        ),
        (
            {"cancel": MissingMethodError("gone")},
            ("SubscribeMissionStatus: cancel was asked and JSON-RPC error -32601 came; add that method",),
        ),
    ],
    ids=lambda given: next(iter(given)) if isinstance(given, dict) else "",
)
def test_a_fault_is_one_line(instead: dict[str, Any], faults: tuple[str, ...]) -> None:
    """What was expected, what came, and what to change."""
    found = smoke(MISSION, lambda: Odd(**instead))
    assert found.faults == faults
    assert not found.is_adapter


def test_a_message_that_is_malformed_is_a_fault() -> None:
    """A message that is none of the documented ones is told once, with what is wrong with it."""

    class Talks(Odd):
        def exchange(self, method: str, params: JSON) -> Exchange:
            exchange = super().exchange(method, params)
            if method != "SubscribeMissionStatus":
                return exchange
            return Exchange(
                exchange.result, after=(Notification("message", {"stream": 1, "message": {"missionStates": 7}}),)
            )

    (fault,) = smoke(MISSION, Talks).faults
    assert fault.startswith("a message on stream 1 is malformed: ")


def test_a_call_that_is_not_there_is_to_be_done() -> None:
    """It keeps nobody from judging the rest."""
    found = smoke(MISSION, lambda: Odd(ChargeRobot=MissingMethodError("gone")))
    assert found.faults == ()
    assert found.left == ('ChargeRobot is not there (error -32601): add it, or declare "methods" without it',)


ADAPTER = """
import json, sys
for line in sys.stdin:
    asked = json.loads(line)
    answer = {"jsonrpc": "2.0", "id": asked["id"]}
    if asked["method"] == "initialize":
        answer["result"] = {"implementation": {"name": "mine"}, "drives": []}
    elif asked["method"] in ("reset", "settle"):
        answer["result"] = {}
    elif asked["method"] == "SkipGoal":
        answer["error"] = {"code": 9, "data": {"status": "INVALID_ARGUMENT"}}
    elif asked["method"] == "ChargeRobot":
        print("charging", flush=True)
    else:
        answer["error"] = {"code": -32601}
    print(json.dumps(answer), flush=True)
"""


def test_it_goes_on_after_a_failure(command_line: CommandLine, tmp_path: Path) -> None:
    """A code that is not that of its status and a log on stdout are both told; the exit status says that it is none."""
    adapter = tmp_path / "mine.py"
    adapter.write_text(ADAPTER)
    ended = command_line("smoke", "bear.mission", "--", sys.executable, adapter)
    faults = [line for line in ended.out.splitlines() if line.startswith("  fault: ")]
    assert ended.status == 3
    assert len(faults) == 2
    assert "write nothing but the protocol to stdout: logs go to stderr" in faults[0]
    assert faults[1].endswith("; send code 3 for INVALID_ARGUMENT, or status FAILED_PRECONDITION for code 9")
    assert "  to do: CreateMission is not there (error -32601)" in ended.out
    assert "  to do: the drive goalReached is not there: rules that need it are not tested" in ended.out


def test_what_is_buffered_is_told(command_line: CommandLine) -> None:
    """An adapter that never flushes does not answer in time; what to change is said."""
    script = "import sys\nfor line in sys.stdin: pass"
    ended = command_line("smoke", "bear.mission", "--timeout", 0.5, "--", sys.executable, "-c", script)
    assert ended.status == 3
    assert "flush stdout after every line" in ended.out
