"""What a verdict rests on: what departs from the text or from itself, what is waived, what was not put to the test."""

from __future__ import annotations

from collections.abc import Iterable

import pytest
from attrs import evolve
from kernel.toys import spec as toy

from missionfsm.kernel.history import Answer, Called, Returned
from missionfsm.kernel.readings import UNCONSTRAINED, Ambiguity, meet
from missionfsm.kernel.rules import (
    FAILED_PRECONDITION,
    INVALID_ARGUMENT,
    OK,
    UNIMPLEMENTED,
    Document,
    Operation,
    Waiver,
    promise,
)
from missionfsm.kernel.spec import Drive, Spec
from missionfsm.kernel.step import Step
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.tools.check.eliminations import Eliminations
from missionfsm.tools.check.scope import assumed, flagged, held_to_the_text, unchecked, untested
from missionfsm.tools.check.verdict import Outcome, Untested, Verdict

PAGE = Document("Page", "A page")
CODES = {"a": "INVALID_ARGUMENT.", "b": "FAILED_PRECONDITION."}
KNOCK, RING = (
    Ambiguity(f"D-1.{call}", f"Which code has {call}?", CODES, "a", alike="D-1") for call in ("knock", "ring")
)
OPEN = Ambiguity("D-2", "May a locked door open?", {"a": "No.", "b": "Yes."}, "a", flagged=frozenset("b"))


def _outcomes(state: str, request: tuple[str, ...], _: object) -> tuple[Step, ...]:
    if request == ("open",):
        return (
            Step(state, answer=Answer(FAILED_PRECONDITION), assumes=(OPEN["a"],)),
            Step(state, answer=Answer(OK), assumes=(OPEN["b"],)),
        )
    question = KNOCK if request == ("knock",) else RING
    return (
        Step(state, answer=Answer(INVALID_ARGUMENT), assumes=(question["a"],)),
        Step(state, answer=Answer(FAILED_PRECONDITION), assumes=(question["b"],)),
    )


def _operation(name: str) -> Operation:
    return Operation.with_rules(
        name, "door", PAGE[name], promises=(promise("it-answers", "It answers.", cite=PAGE[name]),)
    )


DOOR: Spec = evolve(
    toy("door", str, _outcomes, ambiguities=(KNOCK, RING, OPEN), drives=(Drive("lock", lambda *_: ()),)),
    operations={name: _operation(name) for name in ("knock", "ring", "open")},
    describe=lambda request: str(request[0]),
    waived=(
        Waiver("how-loud-it-is", "Nobody hears it.", PAGE["knock"], ("knock",)),
        Waiver("what-colour-it-has", "Nobody sees it.", PAGE["Door"]),
    ),
)


def judged(*answers: tuple[str, str]) -> tuple[str, ...]:
    """What is flagged where calls were answered so."""
    belief = Belief(Automaton(DOOR), "")
    eliminations = Eliminations(belief)
    for number, (call, code) in enumerate(answers):
        for event in (Called(("call", number), (call,)), Returned(("call", number), Answer(code))):
            assert belief.observe(event)
            eliminations.notice(event, (call,))
    return flagged(DOOR, belief.readings, eliminations.found, (one.assumed for one in belief.node.explanations))


def test_what_keeps_to_the_text_is_not_flagged() -> None:
    """One that refuses what is locked and answers alike calls alike has no flag."""
    alike = (("knock", INVALID_ARGUMENT), ("ring", INVALID_ARGUMENT), ("open", FAILED_PRECONDITION))
    assert (judged(), judged(*alike)) == ((), ())


def test_where_no_reading_is_left_none_departs() -> None:
    """A question that was answered in every way that it has been read is a violation, no departure."""
    left = {one.id: () for one in DOOR.ambiguities}
    assert flagged(DOOR, left, {}) == ()


def test_a_departure_is_flagged_with_its_event() -> None:
    """A reading that departs from the text is named with what it says and the event that left no other."""
    assert judged(("open", OK)) == (
        "D-2=b departs from the text: May a locked door open? Yes. (seen where open was answered OK)",
    )


def test_incoherence_is_flagged_with_both_events() -> None:
    """Alike calls that are read differently are explained, and both sides are named with their events."""
    assert judged(("knock", INVALID_ARGUMENT), ("ring", FAILED_PRECONDITION)) == (
        "incoherent, calls that look alike are read differently: "
        "D-1.knock=a (seen where knock was answered INVALID_ARGUMENT), "
        "but D-1.ring=b (seen where ring was answered FAILED_PRECONDITION)",
    )


def test_one_explanation_that_keeps_to_the_text_is_enough() -> None:
    """Nothing is flagged while one explanation departs nowhere, though others do."""
    ways = [meet(UNCONSTRAINED, some) for some in ((OPEN["b"],), (KNOCK["a"], RING["b"]), (OPEN["a"], KNOCK["a"]))]
    assert flagged(DOOR, {}, {}, ways) == ()


def test_readings_that_are_possible_apart_may_not_be_so_together() -> None:
    """Where every explanation departs somewhere, the one that departs least is flagged."""
    ways = [meet(UNCONSTRAINED, some) for some in ((OPEN["b"], KNOCK["a"], RING["b"]), (KNOCK["b"], RING["a"]))]
    assert flagged(DOOR, {}, {}, ways) == (
        "incoherent, calls that look alike are read differently: D-1.knock=b, but D-1.ring=a",
    )


def test_nothing_departs_where_nothing_may() -> None:
    """Under the letter of the text flagged readings are ruled out from the start, and asking for one is refused."""
    left = assumed(DOOR, {"D-1": "b"}, no_flagged=True)
    assert [one.possible(left) for one in DOOR.ambiguities] == [("b",), ("b",), ("a",)]
    assert assumed(DOOR, None, no_flagged=False) == UNCONSTRAINED
    with pytest.raises(ValueError, match="D-2=b departs from the text, and nothing that does is accepted"):
        assumed(DOOR, {"D-2": "b"}, no_flagged=True)


def test_what_is_flagged_can_be_held_against_one_that_conforms() -> None:
    """A flagged verdict becomes a violation that says what departs; one without flags, or a bad one, stays."""
    good = Verdict(Outcome.CONFORMS, "door", flagged=("this",))
    others = (Verdict(Outcome.CONFORMS, "door"), Verdict(Outcome.INCONCLUSIVE, "door", flagged=("this",)))
    held = held_to_the_text(good)
    assert held.violation is not None
    assert (held.outcome, held.violation.observed) == (
        Outcome.VIOLATES,
        "What was observed departs from the text: this",
    )
    assert tuple(map(held_to_the_text, others)) == others


@pytest.mark.parametrize(
    ("used", "said"), [((), ["what-colour"]), (("knock",), ["how-loud", "what-colour"]), (("lock",), ["what-colour"])]
)
def test_what_is_waived_is_said_where_it_could_have_shown(used: Iterable[str], said: list[str]) -> None:
    """A waiver is told with its place where one of its calls or drives was used, or always if it has none."""
    assert [line.partition("-it")[0].partition("-is")[0] for line in unchecked(DOOR, used)] == said
    assert unchecked(DOOR, ("knock",))[0] == "how-loud-it-is: Nobody hears it. [Page › knock]"


def test_what_was_not_tested_is_said_with_the_reason() -> None:
    """Calls that were not tried, are not there or never succeeded, their rules, and drives that nobody commanded."""
    answers = {"knock": {UNIMPLEMENTED: 3}, "ring": {FAILED_PRECONDITION: 1, INVALID_ARGUMENT: 2}}
    left_out = tuple(f"door/{name}/it-answers" for name in ("knock", "ring"))
    assert untested(DOOR, answers, (), left_out) == Untested(
        {
            "knock": "is not there: UNIMPLEMENTED",
            "ring": "never succeeded: INVALID_ARGUMENT 2 times, FAILED_PRECONDITION",
            "open": "was not tried",
        },
        {
            "door/knock/it-answers": "knock is not there: UNIMPLEMENTED",
            "door/ring/it-answers": "ring never succeeded: INVALID_ARGUMENT 2 times, FAILED_PRECONDITION",
        },
        ("lock",),
        operations=3,
        all_drives=1,
    )
    assert untested(DOOR, {"knock": {OK: 1}}, ("lock",), ("door/knock/it-answers",)) == Untested(
        {"ring": "was not tried", "open": "was not tried"},
        {"door/knock/it-answers": "never came up"},
        operations=3,
        all_drives=1,
    )
