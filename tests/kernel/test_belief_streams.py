"""Known conversations with a lamp and a ticket queue: streams, urgency, names; each with the verdict it deserves."""

from __future__ import annotations

import pytest
from toys import FLAKY_LAMP, LAMP, PLAIN_TICKETS, TICKETS, Event, spec

from missionfsm.kernel.history import Answer, Called, Cancelled, Driven, Ended, Name, Received, Returned, Settled
from missionfsm.kernel.history import Event as Observed
from missionfsm.kernel.rules import DEADLINE_EXCEEDED, FAILED_PRECONDITION, NOT_FOUND, OK, UNAVAILABLE
from missionfsm.kernel.spec import Drive, Spec
from missionfsm.kernel.step import Emission, Opening, Step
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief

ONE, TWO = ("stream", 1), ("stream", 2)
NUDGE, SERVE = Driven(Event("nudge")), Driven(Event("serve"))
SETTLED = Settled()


def call(number: int, *request: object, of: tuple[Name, ...] = (), lost: bool = False) -> Called:
    """A call."""
    return Called(("call", number), request, of, lost)


def answer(number: int, *names: Name, code: str = OK, shape: object = None, unordered: bool = False) -> Returned:
    """Its answer."""
    return Returned(("call", number), Answer(code, shape, unordered), names)


def watched(topic: str = "lamp", shown: str | None = "off") -> list[Observed]:
    """A subscription that is answered, and its first message."""
    first = [Received(ONE, shown, (), (("", 1),))] if shown else []
    return [call(100, "watch", topic), answer(100, ONE), *first]


def shows(content: object, *names: Name, number: int | None = None, on: Name = ONE) -> Received:
    """A message."""
    return Received(on, content, names, () if number is None else (("", number),))


def failing(spec: Spec, world: object, driven: tuple[str, ...], events: list[Observed]) -> int | None:
    """The place of the event that nothing explains, or None."""
    belief = Belief(Automaton(spec, driven), world)
    return next((at for at, event in enumerate(events) if not belief.observe(event)), None)


LAMPS: list[tuple[str, list[Observed], int | None]] = [
    ("the first message is owed at once", [*watched(), SETTLED], None),
    ("a stream that says nothing is not settled", [*watched(shown=None), SETTLED], 2),
    ("a passing state need not be shown", [*watched(), NUDGE, shows("on", number=2), SETTLED], None),
    ("what only some show may be shown", [*watched(), NUDGE, shows("warming", number=2), shows("on", number=3)], None),
    ("what must have happened is shown", [*watched(), NUDGE, SETTLED], 4),
    ("what did not happen is not shown", [*watched(), shows("on", number=2)], 3),
    ("a number does not fall", [*watched(), NUDGE, shows("on", number=0), shows("dead", number=-1)], 5),
    ("a number does not stay", [*watched(), NUDGE, shows("on", number=1)], 4),
    ("a message before the answer names the stream", [call(1, "watch", "lamp"), shows("off"), answer(1, ONE)], None),
    ("a stream has one name", [call(1, "watch", "lamp"), shows("off"), answer(1, TWO)], 2),
    ("a stream may break before the answer", [call(1, "watch", "lamp"), Ended(ONE, UNAVAILABLE), answer(1, ONE)], None),
    ("the stream that broke is the one", [call(1, "watch", "lamp"), Ended(ONE, UNAVAILABLE), answer(1, TWO)], 2),
    ("a broken stream says nothing", [*watched(), Ended(ONE, UNAVAILABLE), NUDGE, shows("on")], 5),
    ("a stream ends as it may", [*watched(), Ended(ONE, FAILED_PRECONDITION)], 3),
    ("one that never ends does not", [*watched("all"), Ended(ONE, UNAVAILABLE)], 3),
    ("a stream ends once", [*watched(), Ended(ONE, UNAVAILABLE), Ended(ONE, UNAVAILABLE)], 4),
    (
        "what comes on a stream that was given up means nothing",
        [*watched(), Cancelled(ONE), shows("dead"), Ended(ONE, NOT_FOUND), NUDGE, SETTLED, shows("off")],
        None,
    ),
    ("giving up twice is no harm", [*watched(), Cancelled(ONE), Cancelled(ONE), Cancelled(TWO), SETTLED], None),
    (
        "the stream of a lost call may close what is owed",
        [call(1, "unplug", lost=True), *watched(shown=None), SETTLED],
        None,
    ),
    ("a repeat is a reading", [*watched(), shows("off", number=2), shows("off", number=3)], None),
    ("a skip is a reading", [*watched(), NUDGE, call(1, "press"), answer(1), shows("off", number=2), SETTLED], None),
    ("what is back where it was seen may stay unsaid", [*watched(), NUDGE, call(1, "press"), answer(1), SETTLED], None),
    (
        "a repeat decides nothing about skips",
        [*watched(), shows("off", number=2), NUDGE, SETTLED],
        5,
    ),
    ("an echo has the old number", [*watched("all"), shows("off", number=1), shows("off", number=1)], None),
    ("an echo has no new number", [*watched("all"), shows("off", number=2)], 3),
    ("only what was said is echoed", [*watched("all"), NUDGE, shows("on", number=1)], 4),
    ("what happens unseen is seen later", [*watched(), NUDGE, shows("on"), SETTLED, shows("dead"), SETTLED], None),
    ("what happens unseen happens once", [*watched(), NUDGE, shows("on"), shows("dead"), shows("off")], 6),
    ("a drive that does not apply is no explanation", [NUDGE, NUDGE, SETTLED], None),
    (
        "a press may come before it is warm",
        [call(1, "press"), call(2, "look"), answer(2, shape="warming"), answer(1)],
        None,
    ),
    (
        "a call in flight may come before what is urgent",
        [NUDGE, call(1, "press"), SETTLED, call(2, "look"), answer(2, shape="off"), answer(1)],
        None,
    ),
    ("when all is settled it is warm", [NUDGE, SETTLED, call(1, "look"), answer(1, shape="warming")], 3),
    (
        "a reading holds for good",
        [
            *(call(1, "press"), call(2, "press"), answer(2, code=FAILED_PRECONDITION), answer(1)),
            *(call(3, "unplug"), answer(3), NUDGE, call(4, "press"), call(5, "look"), answer(5, shape="off")),
            answer(4, code=FAILED_PRECONDITION),
        ],
        10,
    ),
    (
        "an effect may be seen before the deadline passes",
        [*watched(), call(1, "press"), shows("on"), answer(1, code=DEADLINE_EXCEEDED), SETTLED],
        None,
    ),
]


@pytest.mark.parametrize(("says", "events", "fails"), LAMPS, ids=[one[0].replace(" ", "-") for one in LAMPS])
def test_a_lamp_is_judged(says: str, events: list[Observed], fails: int | None) -> None:  # noqa: ARG001
    """The event that nothing explains is the expected one, or there is none."""
    assert failing(LAMP, "off", ("nudge",), events) == fails


def test_what_is_urgent_need_not_be_what_happened() -> None:
    """A lamp with a bad contact may go off before it is warm, and that settles it."""
    events: list[Observed] = [NUDGE, SETTLED, call(1, "look"), answer(1, shape="off")]
    assert (failing(FLAKY_LAMP, "off", ("nudge",), events), failing(LAMP, "off", ("nudge",), events)) == (None, 3)


RED, BOTH = ("red",), ("red", "blue")
QUEUES: list[tuple[str, tuple[str, ...], list[Observed], int | None]] = [
    (
        "names are bound one to one",
        (),
        [call(1, "take", "red"), call(2, "take", "red"), answer(1, "x"), answer(2, "x")],
        3,
    ),
    (
        "a name may be seen before the answer",
        (),
        [*watched(shown=None), shows(()), call(1, "take", "red"), shows(RED, "x"), answer(1, "x")],
        None,
    ),
    (
        "the answer has the name that was seen",
        (),
        [*watched(shown=None), shows(()), call(1, "take", "red"), shows(RED, "x"), answer(1, "y")],
        5,
    ),
    (
        "a name is never reused",
        RED,
        [call(1, "clear"), answer(1, "x", unordered=True), call(2, "take", "red"), answer(2, "x")],
        3,
    ),
    (
        "a name that a lost call may have freed is not reused",
        (),
        [
            *(call(1, "take", "red"), answer(1, "x"), call(2, "clear", lost=True)),
            *(call(3, "take", "blue"), answer(3, "x")),
        ],
        4,
    ),
    (
        "the order of an unordered answer means nothing",
        BOTH,
        [*watched(shown=None), call(1, "clear"), answer(1, "y", "x", unordered=True), shows(BOTH, "x", "y"), shows(())],
        None,
    ),
    (
        "an unordered answer has the names that there are",
        BOTH,
        [*watched(shown=None), shows(BOTH, "x", "y"), call(1, "clear"), answer(1, "x", "z", unordered=True)],
        4,
    ),
    ("an answer has as many names as things", BOTH, [call(1, "clear"), answer(1, "x", unordered=True)], 1),
    ("a name that nothing has is not found", (), [call(1, "peek", of=("x",)), answer(1, code=NOT_FOUND)], None),
    (
        "a name that was asked for may be given later",
        (),
        [call(1, "peek", of=("x",)), answer(1, code=NOT_FOUND), call(2, "take", "red"), answer(2, "x")],
        None,
    ),
    (
        "a name that was guessed is that of something",
        RED,
        [call(1, "peek", of=("x",)), answer(1, shape="red"), call(2, "clear"), answer(2, "x", unordered=True)],
        None,
    ),
    (
        "a guess is held to",
        RED,
        [call(1, "peek", of=("x",)), answer(1, shape="red"), call(2, "clear"), answer(2, "y", unordered=True)],
        3,
    ),
]


@pytest.mark.parametrize(("says", "world", "events", "fails"), QUEUES, ids=[one[0].replace(" ", "-") for one in QUEUES])
def test_a_queue_is_judged(
    says: str,  # noqa: ARG001
    world: tuple[str, ...],
    events: list[Observed],
    fails: int | None,
) -> None:
    """The event that nothing explains is the expected one, or there is none."""
    assert failing(PLAIN_TICKETS, world, (), events) == fails


def test_a_name_may_be_seen_when_its_thing_is_gone() -> None:
    """A late message names a ticket that was served already; that name is spent as well."""
    events = [*watched(shown=None), SERVE, shows(RED, "x"), shows(()), call(1, "take", "red"), answer(1, "x")]
    assert failing(TICKETS, RED, ("serve",), events) == 6


def test_readings_follow_the_names() -> None:
    """In which order the board lists is found out from the names, and reported."""
    belief = Belief(Automaton(TICKETS), ())
    taken: list[Observed] = [
        *(call(1, "take", "red"), answer(1, "x"), call(2, "take", "red"), answer(2, "y")),
        *(call(3, "watch"), answer(3, ONE), shows(("red", "red"), "y", "x")),
    ]
    assert (all(belief.observe(event) for event in taken), belief.readings) == (True, {"T-1": ("b",)})


WORD = (Emission("t", "word"), Emission("t", "more", stays=True))
TALKER = spec(
    "talker",
    lambda _: "",
    lambda *_: (),
    drives=(
        Drive("speak", lambda here, *_: (Step(here, emits=WORD),) if here else ()),
        Drive("hush", lambda here, *_: (Step(here, withdraws=("t",)),) if here else ()),
        Drive("cut", lambda here, *_: (Step(here, clears=("t",)),) if here else ()),
    ),
    urgent=lambda here: () if here else (Step("open", opens=(Opening("t", 0),)),),
)
"""A channel that is there from the start: speaking owes a word and offers more, which is withdrawn, or all is lost."""


@pytest.mark.parametrize(
    ("events", "failed"),
    [
        ((shows("word"), shows("more"), SETTLED), None),
        ((Driven(Event("hush")), shows("word"), SETTLED), None),
        ((Driven(Event("hush")), shows("word"), shows("more")), 3),
        ((Driven(Event("hush")), SETTLED), 2),
        ((Driven(Event("cut")), SETTLED), None),
        ((Driven(Event("cut")), shows("word")), 2),
    ],
    ids=["offered", "owed all the same", "withdrawn", "still owed", "lost", "void"],
)
def test_what_is_on_its_way_can_become_void(events: tuple[Observed, ...], failed: int | None) -> None:
    """A step may withdraw what a channel offers, or clear what it owes as well."""
    assert failing(TALKER, None, ("speak", "hush", "cut"), [Driven(Event("speak")), *events]) == failed
