"""Whatever an adapter writes is judged, or is told as the adapter's failure in one line: no traceback, no hang.

``MISSIONFSM_MUTATED=20000`` in the environment garbles so many lines of each system's adapter, instead of thirty.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from random import Random

import orjson
import pytest
from mutated import MANY, SECONDS, limited, mutated

from missionfsm.adapters.stdio import Child, _respond
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, SubjectError
from missionfsm.systems import system
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.reference.subject import ReferenceSubject

TRIES = 5 + MANY // 100
"""How many whole runs have a garbled line; each of them is made short."""
SYSTEMS = ("bear.mission", "bear.status", "isaac.server", "isaac.robot")


class Garbling(Child):
    """A child that answers as the reference does, but for one line, which is garbled.

    The program that is started reads and says nothing; what it would have said is put where its lines are read.
    """

    def __init__(self, name: str, random: Random) -> None:
        super().__init__(["sh", "-c", "cat >/dev/null"], timeout=0.02)
        self.system, self.random = system(name), random
        self.conversation: list[tuple[str, JSON, list[JSON]]] = []
        self.again(-1)

    def again(self, garbled: int) -> None:
        """Begin anew, and garble the line with this number, counted from 0; none has a number below 0."""
        self.reference, self.garbled, self.said = ReferenceSubject(self.system), garbled, 0
        self.conversation.clear()

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Answer as the reference does, but for the line that is garbled."""
        answers = _respond(self.reference, orjson.dumps({"id": 0, "method": method, "params": params}))
        self.conversation.append((method, params, answers))
        at, self.said = self.garbled - self.said, self.said + len(answers)
        return self.answered(method, params, answers, at)

    def answered(self, method: str, params: JSON, answers: list[JSON], at: int) -> Exchange:
        """Have a request answered in these lines, of which one may be garbled."""
        right = [{**line, "id": self._serial + 1} if "id" in line else line for line in answers]
        self._lines = deque(
            mutated(self.random, line) if place == at else orjson.dumps(line) for place, line in enumerate(right)
        )
        return super().exchange(method, params)


@pytest.fixture
def garbling(request: pytest.FixtureRequest) -> Iterator[Garbling]:
    child = Garbling(request.param, Random(request.param))
    yield child
    child.close()


@pytest.mark.parametrize("garbling", SYSTEMS, indirect=True)
def test_a_garbled_line_is_read_or_refused(garbling: Garbling) -> None:
    """An answer of a conversation as ``conform`` has it is read, or the adapter's failure is said in one line."""
    conform(garbling.system, garbling, plan=Plan.of(1), advice=False)
    read, refused = 0, list[str]()
    for _ in range(MANY):
        method, params, answers = garbling.random.choice(garbling.conversation)
        try:
            with limited(SECONDS):
                garbling.answered(method, params, answers, garbling.random.randrange(len(answers)))
            read += 1
        except SubjectError as error:
            refused.append(str(error))
    assert read + len(refused) == MANY
    assert read > 0
    assert refused
    assert [one for one in refused if not one.startswith("the adapter ") or "\n" in one] == []


@pytest.mark.long
@pytest.mark.parametrize("garbling", SYSTEMS, indirect=True)
def test_an_adapter_that_garbles_a_line_is_judged_or_has_failed(garbling: Garbling) -> None:
    """``conform`` comes to a verdict, or the adapter's failure is said in one line."""
    conform(garbling.system, garbling, plan=Plan.of(1), advice=False)
    lines, judged, refused = garbling.said, 0, list[str]()
    for _ in range(TRIES):
        garbling.again(garbling.random.randrange(lines))
        try:
            with limited(SECONDS):
                judged += bool(str(conform(garbling.system, garbling, plan=Plan.of(1), advice=False)))
        except SubjectError as error:
            refused.append(str(error))
    assert judged + len(refused) == TRIES
    assert judged > 0
    assert [one for one in refused if not one.startswith("the adapter ") or "\n" in one] == []
