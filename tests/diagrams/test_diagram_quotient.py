"""Pictures of explored graphs: every arrow is a step of the model, and every step of the model is there."""

from __future__ import annotations

import random
from types import SimpleNamespace

import pytest
from attrs import evolve, frozen

from missionfsm import systems
from missionfsm.kernel.alphabet import Alphabet, Input
from missionfsm.kernel.codec import Codec
from missionfsm.kernel.history import Answer, Name
from missionfsm.kernel.picture import Sketch
from missionfsm.kernel.readings import Ambiguity, choose
from missionfsm.kernel.rules import FAILED_PRECONDITION, OK
from missionfsm.kernel.spec import Delivery, Spec
from missionfsm.kernel.step import ONCE_HAD, Mismatch, Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Refs
from missionfsm.tools.draw import diagram as picture
from missionfsm.tools.draw.diagram import Arrow, Node, Side, Stay
from missionfsm.tools.draw.gallery import Picture
from missionfsm.tools.draw.quotient import Move, Quotient, quotient
from missionfsm.tools.draw.tables import of_contrast, of_quotient
from missionfsm.tools.explore.explore import Actions, bindings
from missionfsm.tools.reference.model import Reference, Snapshot

# A turnstile: a coin unlocks it for one push. What becomes of a second coin is nowhere said.

SECOND = Ambiguity("T-1", "What becomes of a second coin?", {"a": "it is kept", "b": "it is handed back"}, "a")


@frozen
class Push:
    name: str = "push"


def _coin(state: str, _: str, __: Refs) -> tuple[Step, ...]:
    if state == "locked":
        return (Step("open", answer=Answer(OK)),)
    kept = Step(state, answer=Answer(OK), assumes=(SECOND["a"],))
    return (kept, Step(state, answer=Answer(FAILED_PRECONDITION), assumes=(SECOND["b"],)))


def _push(state: str, _: Push, __: Refs) -> tuple[Step, ...]:
    return (Step("turning"),) if state == "open" else ()


TURNSTILE = Spec(
    system="turnstile",
    title="a turnstile",
    initial=lambda _: "locked",
    operations={},
    outcomes=_coin,
    drives={"push": SimpleNamespace(name="push", steps=_push)},  # type: ignore[dict-item] - as much of one as is used
    urgent=lambda state: (Step("locked"),) if state == "turning" else (),
    matches=lambda *_: Mismatch("", ""),
    delivery=lambda _: Delivery(),
    sequence=lambda _: (),
    names=lambda _: 0,
    request_operation=str,
    ambiguities=(SECOND,),
)
CODEC = Codec(
    read_world=lambda _: None,
    split_request=lambda _, params: ((), params),
    read_request=lambda method, _: method,
    read_drive=lambda _: (Push(), ()),
)
SYSTEM = System("turnstile", TURNSTILE, CODEC, lambda *_: Alphabet((), (), (), (), ({},)))
SKETCH = Sketch(
    "arm",
    "the arm",
    node=str,
    label=lambda _, what, __: "push" if isinstance(what, Push) else "coin",
    within=lambda _: True,
    inputs=(Input("coin", {}),),
    drives=({},),
)
LOCKED, OPEN = "locked", "open"


def turnstile(letter: str) -> Quotient:
    return quotient(SYSTEM, SKETCH, choose([SECOND], {"T-1": letter}))


def test_a_system_is_drawn_settled() -> None:
    """What is urgent is part of the step before it: nobody sees the arm turning."""
    assert turnstile("a") == Quotient(
        nodes=(LOCKED, OPEN),
        starts=(LOCKED,),
        moves=(
            Move(LOCKED, "coin", OK, (), OPEN, refused=False),
            Move(OPEN, "coin", OK, (), OPEN, refused=False),
            Move(OPEN, "push", "", (), LOCKED, refused=False),
        ),
        labels=("coin", "push"),
    )


def test_what_stays_is_no_arrow() -> None:
    """What does not leave its node is told beside the picture; refusals only if they are asked for."""
    nodes = Node(LOCKED, (LOCKED,), start=True), Node(OPEN, (OPEN,))
    arrows = Arrow(LOCKED, OPEN, ("coin",)), Arrow(OPEN, LOCKED, ("push",))
    kept, handed_back = (picture.of_quotient("", turnstile(letter)) for letter in "ab")
    assert (kept.nodes, kept.arrows) == (handed_back.nodes, handed_back.arrows) == (nodes, arrows)
    assert (kept.stays, handed_back.stays) == ((Stay((OPEN,), ("coin",)),), ())
    told = picture.of_quotient("", turnstile("b"), refusals=True)
    assert told.stays == (Stay((OPEN,), ("coin",), FAILED_PRECONDITION),)


def test_two_readings_in_one_picture() -> None:
    """What is so under one reading alone is on its side; what both share is on neither."""
    versus = "T-1=a", "T-1=b"
    drawn = picture.of_contrast("", turnstile("a"), turnstile("b"), versus)
    assert {arrow.side for arrow in drawn.arrows} == {Side.BOTH}
    assert drawn.stays == (
        Stay((OPEN,), ("coin",), side=Side.FIRST),
        Stay((OPEN,), ("coin",), FAILED_PRECONDITION, Side.SECOND),
    )
    assert [drawn.only(one.side) for one in drawn.stays] == list(versus)


def test_tables_tell_everything() -> None:
    """A cell has where an event leads, or what it is refused with, or that it does not happen."""
    lines = "| state | coin | push |", "| --- | --- | --- |", "| locked | open | · |"
    assert of_quotient(turnstile("b")) == "\n".join((*lines, "| open | _FAILED_PRECONDITION_ | locked |\n"))
    both = of_contrast(turnstile("a"), turnstile("b"), ("T-1=a", "T-1=b"))
    assert "| open | **T-1=a**: stays<br>**T-1=b**: _FAILED_PRECONDITION_ | locked |\n" in both


# The systems.

SKETCHES = [(name, sketch) for name in systems.names() for sketch in systems.system(name).sketches]
every_sketch = pytest.mark.parametrize(
    ("name", "sketch"), SKETCHES, ids=[f"{name}-{sketch.name}" for name, sketch in SKETCHES]
)


class Walker:
    """Walks the reference of a system about within the bounds of a sketch, as a quotient sees it."""

    def __init__(self, name: str, sketch: Sketch, choice: dict[str, str], seed: int) -> None:
        self.system = systems.system(name)
        self.sketch = sketch
        self.model = Reference(self.system, choice)
        self.random = random.Random(seed)
        actions = Actions.from_alphabet(self.system, sketch.inputs, sketch.drives)
        self.tried = [(what, free, True) for what, free in actions.requests]
        self.tried += [(what, free, False) for what, free in actions.events]

    def named(self, here: Snapshot, ref: int | None) -> Name | None:
        """The name at a position of the state, or one that the robot had once."""
        if ref is None:
            return None
        return self.random.choice(sorted(here.gone, key=str)) if ref == ONCE_HAD else here.names[ref]

    def step(self, here: Snapshot) -> tuple[Snapshot, tuple[str | None, str, str, str | None]]:
        """A step that leads somewhere within the bounds, and the move that it is: source, label, code, target."""
        while True:
            what, free, asked = self.random.choice(self.tried)
            refs = self.random.choice(list(bindings(self.system.spec, here.state, free)))
            if ONCE_HAD in refs and not here.gone:
                continue
            names = tuple(self.named(here, ref) for ref in refs)
            label = self.sketch.label(self.sketch.simple(here.state, self.model.choice), what, refs)
            after, reply = (self.model.call if asked else self.model.drive)(here, what, names)
            if reply.happened and label is not None and self.sketch.within(after.state):
                code = reply.answer.code if reply.answer else ""
                return after, (self.sketch.node(here.state), label, code, self.sketch.node(after.state))


HIDDEN = "something else"


UNTOLD = {("AI-10", "d"), ("AI-39", "b")}
"""Readings that a picture cannot tell: a status that names no mission is about the robot's current one; while time
passes once, a scheduling pass sends a mission and its time runs out."""


def check(name: str, sketch: Sketch, choice: dict[str, str], seeds: int) -> None:
    """Wherever the reference goes it goes along the moves of the picture, and what is not shown leaves no node."""
    system = systems.system(name)
    known = evolve(sketch, label=lambda *what: sketch.label(*what) or HIDDEN)
    drawn = quotient(system, known, choose(system.spec.ambiguities, choice)).moves
    assert [move for move in drawn if move.label == HIDDEN and move.source != move.target] == [], choice
    moves = {(move.source, move.label, move.code, move.target) for move in drawn}
    for seed in range(seeds):
        walker = Walker(name, sketch, choice, seed)
        here = walker.model.start(system.codec.read_world(sketch.world))
        for _ in range(30):
            here, taken = walker.step(here)
            assert taken in moves or None in (taken[0], taken[3]), (choice, seed)


@every_sketch
def test_every_step_of_the_reference_is_in_the_picture(name: str, sketch: Sketch) -> None:
    """Every step of the reference is a move of the picture, whether it is seen or leaves its node."""
    check(name, sketch, {}, seeds=20)


@pytest.mark.long
@every_sketch
def test_every_step_under_another_reading_is_in_its_picture(name: str, sketch: Sketch) -> None:
    """So it is under every choice that differs from the reference's in one reading, in all calls that look alike."""
    ambiguities = systems.system(name).spec.ambiguities
    others = ((one.alike or one.id, letter) for one in ambiguities for letter in one.readings if letter != one.default)
    for question, letter in dict.fromkeys(others):
        if (question, letter) in UNTOLD:
            continue
        check(name, sketch, {question: letter}, seeds=1)


@every_sketch
def test_pictures_are_small(name: str, sketch: Sketch) -> None:
    """A picture has few nodes, and their identifiers are as different as they are."""
    system = systems.system(name)
    for choice in ({}, *(dict([one.split("=")]) for one in sketch.contrasts)):
        drawn = quotient(system, sketch, choose(system.spec.ambiguities, choice))
        assert 2 <= len(drawn.nodes) <= 12
        assert len(set(map(picture.identifier, drawn.nodes))) == len(drawn.nodes)
        assert set(drawn.starts) <= set(drawn.nodes) != set()


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "which", "names"),
    [("bear.mission", "queue", 3), ("isaac.server", "dispatch", 3)],
)
def test_what_stands_for_a_state_does_as_it_does(name: str, which: str, names: int) -> None:
    """The picture is the same where no state stands for another (in a part of it that is small enough)."""
    system = systems.system(name)
    sketch = next(one for one in system.sketches if one.name == which)
    # Without time, of which a server has much to decide that never matters.
    drives = tuple(one for one in sketch.drives if one["event"] != "advance")
    sketch = evolve(sketch, within=lambda state: system.spec.names(state) <= names, drives=drives)
    assumed = choose(system.spec.ambiguities)
    plain = quotient(system, evolve(sketch, simple=lambda state, _: state), assumed)
    simple = quotient(system, sketch, assumed)
    assert (set(plain.moves), set(plain.nodes), plain.starts) == (set(simple.moves), set(simple.nodes), simple.starts)


def test_contrasts_tell_something_apart(gallery: dict[str, Picture]) -> None:
    """Two readings in one picture are both to be seen in it, and what they share."""
    contrasts = [one for one in gallery.values() if one.diagram.versus]
    assert contrasts
    for one in contrasts:
        sides = {part.side for part in (*one.diagram.nodes, *one.diagram.arrows, *one.diagram.stays)}
        assert sides == set(Side), one.id


def test_chart_pictures_are_their_charts(gallery: dict[str, Picture]) -> None:
    """A lifecycle's arrows, and what stays where it is, are the moves of its table: no more, no fewer."""
    for one in gallery.values():
        if one.chart is None:
            continue
        drawn = [(arrow.source, line, arrow.target) for arrow in one.diagram.arrows for line in arrow.lines]
        drawn += [(node, line, node) for stay in one.diagram.stays for node in stay.nodes for line in stay.lines]
        moves = (
            (picture.state_name(source), trigger, picture.state_name(target))
            for trigger, source, target in one.chart.table
        )
        plain = ((source, line.rstrip(" ¹²³⁴⁵⁶⁷⁸⁹"), target) for source, line, target in drawn)
        assert sorted(plain) == sorted(moves), one.id
