"""The belief automaton as it is walked: the same twice, the same anywhere, and small."""

from __future__ import annotations

import random
import subprocess
import sys
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

from toys import TICKETS, Event

from missionfsm.bear.mission.events import Event as RobotEvent
from missionfsm.bear.mission.inputs import Request, Wanted
from missionfsm.bear.mission.state import Kind, World
from missionfsm.bear.mission.system import SYSTEM
from missionfsm.bear.wire.messages import Command, Goal
from missionfsm.kernel import history
from missionfsm.kernel.history import Answer, Called, Driven, Received, Returned, Settled
from missionfsm.kernel.rules import OK
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.tools.reference.model import Reference, Reply

EVENTS = 1_000
GOALS = tuple(Goal(destination_id=f"table-{number}") for number in (1, 2, 3))
NAVIGATE, DELIVER = Wanted(Kind.BASE_NAVIGATE, GOALS[:1]), Wanted(Kind.SERVI_DELIVERY, GOALS[:2])
COMMANDS = (Command.COMMAND_CANCEL, Command.COMMAND_PAUSE, Command.COMMAND_RESUME, Command.COMMAND_FINISH)
REQUESTS = (
    Request("CreateMission", (DELIVER,)),
    Request("AppendMission", (NAVIGATE,)),
    Request("AppendMission", (DELIVER,)),
    Request("ChargeRobot"),
    Request("ClearMissionStatus"),
    Request("SkipGoal"),
    *(Request("UpdateMission", command=command) for command in COMMANDS),
)
DRIVES = ("goalReached", "goalReached", "missionSucceeded", "missionFailed")


def robot(seed: int) -> Iterator[history.Event]:
    """What is seen of a robot that is busy for ever, and of which nobody knows what it does by itself."""
    chance, model = random.Random(seed), Reference(SYSTEM)
    here = model.start(World())
    called = 0

    def seen(reply: Reply) -> Iterator[history.Event]:
        if reply.answer is not None:
            yield Returned(("call", called), reply.answer, reply.names)
        for sent in reply.sent:
            message = SYSTEM.codec.write_message(sent.view, sent.names, model.choice, sent.number, 0.0)
            ((names, marks, rest),) = SYSTEM.codec.split_message(message)
            yield Received(sent.channel, SYSTEM.codec.read_content(rest), names, marks)

    request = Request("SubscribeMissionStatus")
    names: tuple[history.Name, ...] = ()
    while True:
        called += 1
        yield Called(("call", called), request, names)
        here, reply = model.call(here, request, names)
        yield from seen(reply)
        for _ in range(chance.randrange(3)):
            here, reply = model.drive(here, RobotEvent(chance.choice(DRIVES)))
            yield from seen(reply)
        if not chance.randrange(4):
            yield Settled()
        request = chance.choice(REQUESTS) if len(here.names) < 5 else Request("ClearMissionStatus")
        names = (chance.choice((*here.names, "nobody")),) if request.command else ()


def walk(automaton: Automaton, seed: int, count: int = EVENTS) -> tuple[list[bool], list[int]]:
    """The verdicts on a busy robot, and the number of explanations after every event."""
    here = Belief(automaton, World())
    verdicts, sizes = [], []
    for event, _ in zip(robot(seed), range(count), strict=False):
        verdicts.append(here.observe(event))
        sizes.append(len(here.node.explanations))
    return verdicts, sizes


def test_a_long_walk_stays_small() -> None:
    """A thousand events of a robot of which nothing is driven: the explanations stay few, as pinned."""
    automaton = Automaton(SYSTEM.spec)
    verdicts, sizes = walk(automaton, 1)
    assert all(verdicts)
    assert (max(sizes), sorted(sizes)[len(sizes) // 2]) == (20, 1)


def test_the_second_walk_adds_nothing() -> None:
    """The same history twice gets the same verdicts, and the second time everything is known."""
    automaton = Automaton(SYSTEM.spec)
    first, cold = walk(automaton, 2), automaton.size
    second, warm = walk(automaton, 2), automaton.size
    assert (second, warm) == (first, cold)


def test_an_automaton_that_starts_over_decides_the_same() -> None:
    """With room for few nodes the automaton stays as small, judges the same and has counted the same rules."""
    memory = 300_000
    roomy, tight = Automaton(SYSTEM.spec), Automaton(SYSTEM.spec, memory=memory)
    expected, found = walk(roomy, 2), walk(tight, 2)
    assert (found, tight.exercised()) == (expected, roomy.exercised())
    assert tight.bytes + tight.successors.bytes <= memory < roomy.bytes


def test_what_is_remembered_takes_about_what_is_counted() -> None:
    """The bytes that an automaton counts are within a factor of two of those that it takes, also with long lists."""
    automaton = Automaton(SYSTEM.spec, SYSTEM.spec.drives)
    here = Belief(automaton, World())
    tracemalloc.start()
    for number in range(200):
        create, name = Called(("call", number), Request("CreateMission", (NAVIGATE,))), f"mission {number}"
        assert here.observe(create)
        assert here.observe(Returned(create.call, Answer(OK), (name,)))
        assert here.observe(Driven(RobotEvent("goalReached")))
    taken, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    counted = automaton.bytes + automaton.successors.bytes
    assert taken / 2 < counted < taken * 2


def test_the_same_situation_with_other_names_is_the_same_node() -> None:
    """Tickets come and go under ever new names, and the automaton stops to grow."""
    automaton = Automaton(TICKETS, driven=("serve",))
    here, sizes = Belief(automaton, ()), []
    for number in range(300):
        events = (
            Called(("call", number), ("take", "red")),
            Returned(("call", number), Answer(OK), (f"ticket {number}",)),
            Driven(Event("serve")),
            Settled(),
        )
        assert all(here.observe(event) for event in events)
        sizes.append(automaton.size)
    assert len(set(sizes[2:])) == 1


def test_a_belief_remembers_the_names_that_are_gone() -> None:
    """A name whose thing is gone cannot come again."""
    here = Belief(Automaton(TICKETS, driven=("serve",)), ())

    def take(number: int, name: str) -> bool:
        here.observe(Called(("call", number), ("take", "red")))
        return here.observe(Returned(("call", number), Answer(OK), (name,)))

    assert [take(1, "x"), here.observe(Driven(Event("serve"))), take(2, "y"), take(3, "x")] == [True, True, True, False]


SCRIPT = """
import sys
sys.path.insert(0, sys.argv[1])
from test_belief_walk import SYSTEM, walk
from missionfsm.oracle.automaton import Automaton
automaton = Automaton(SYSTEM.spec)
print(walk(automaton, 3, 250), automaton.size, sorted(automaton.exercised().items()))
"""


def test_the_walk_is_the_same_under_every_hash_seed() -> None:
    """Verdicts, sizes, edges and exercised rules do not depend on the order of sets."""
    found = {
        subprocess.run(
            [sys.executable, "-c", SCRIPT, str(Path(__file__).parent)],
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": ":".join(sys.path)},
            capture_output=True,
            check=True,
            text=True,
        ).stdout
        for seed in ("1", "4242")
    }
    assert len(found) == 1
