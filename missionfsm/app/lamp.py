"""A lamp, as a system: what ``missionfsm new`` writes for a start. Put your own page in the place of the manual's."""

from __future__ import annotations

from attrs import frozen

from missionfsm.kernel.alphabet import Alphabet, Bounds, Input
from missionfsm.kernel.codec import JSON, Codec, Malformed, UnreadableError
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.rules import FAILED_PRECONDITION, OK, Document, Operation, decide, refusal
from missionfsm.kernel.spec import Delivery, Drive, Spec
from missionfsm.kernel.step import Mismatch, Step
from missionfsm.kernel.system import System

NAME = "lamp"
PAGE = Document("Lamp", "The lamp's manual")

# What the page leaves open: the first reading is the one that the reference follows.

DIM_OFF = Ambiguity("L-01", "What does Dim do to a lamp that is off?", {"a": "it is refused", "b": "nothing"}, "a")

# What it refuses. The state is "off", "dim", "on" or "burnt out".


@refusal(FAILED_PRECONDITION, cite=PAGE["Switch", "Errors"])
def the_lamp_is_burnt_out(state: str, _: str) -> bool:
    """The lamp is burnt out."""
    return state == "burnt out"


@refusal(FAILED_PRECONDITION, cite=PAGE["Dim", "Errors"], assumes=DIM_OFF["a"])
def the_lamp_is_off(state: str, _: str) -> bool:
    """The lamp is off, and only light can be dimmed (L-01)."""
    return state == "off"


OPERATIONS = {
    "Switch": Operation.with_rules("Switch", NAME, PAGE["Switch"], refusals=[the_lamp_is_burnt_out]),
    "Dim": Operation.with_rules("Dim", NAME, PAGE["Dim"], refusals=[the_lamp_is_burnt_out, the_lamp_is_off]),
}

# What happens where nothing refuses.

EFFECTS = {
    "Switch": {"off": "on", "on": "off", "dim": "off"},
    "Dim": {"off": "off", "on": "dim", "dim": "on"},
}


def outcomes(state: str, request: str, _names: object) -> tuple[Step, ...]:
    """Every answer that the page allows to a call in a state, with the state after it."""
    steps = []
    for one in decide(OPERATIONS[request].blocking(state, request)):
        after = state if one.code else EFFECTS[request][state]
        answer = Answer(one.code) if one.code else Answer(OK, after)
        steps.append(Step(after, answer=answer, rules=tuple(rule.id for rule in one.rules), assumes=one.assumes))
    return tuple(steps)


@frozen
class Event:
    """Something that happens to the lamp, by the name of its drive."""

    name: str


BURN_OUT = Event("burnOut")


def burns_out(state: str, _event: Event, _names: object) -> tuple[Step, ...]:
    """The one thing that a tester can make happen; it may happen by itself as well."""
    return () if state == "burnt out" else (Step("burnt out", label="burns out"),)


SPEC = Spec(
    system=NAME,
    title="a lamp",
    initial=lambda _world: "off",
    operations=OPERATIONS,
    outcomes=outcomes,
    drives={"burnOut": Drive("burnOut", burns_out, by_itself=(BURN_OUT,))},
    urgent=lambda _state: (),
    matches=lambda view, content: Mismatch("lamp/no-messages", f"{content} is not {view}"),
    delivery=lambda _topic: Delivery(),
    sequence=lambda _relation: (),
    names=lambda _state: 0,
    request_operation=str,
    ambiguities=(DIM_OFF,),
    describe=str,
)

# Its JSON.


def read_answer(_method: str, result: JSON) -> tuple[Answer, tuple[()]]:
    """``{"light": "on"}`` as an answer; anything else is remembered as malformed."""
    light = result.get("light") if isinstance(result, dict) else None
    return Answer(OK, light if isinstance(light, str) else Malformed("it does not say how the light is")), ()


def read_drive(given: JSON) -> tuple[Event, tuple[()]]:
    """``{"event": "burnOut"}``."""
    if not isinstance(given, dict) or given.get("event") != "burnOut":
        raise UnreadableError("drive.event: a lamp has burnOut only")
    return BURN_OUT, ()


CODEC = Codec(
    methods=tuple(OPERATIONS),
    streams=(),
    read_world=lambda _given: None,
    split_request=lambda _method, params: ((), params),
    read_request=lambda method, _params: method,
    read_answer=read_answer,
    split_message=lambda message: (((), (), message),),
    read_content=str,
    read_drive=read_drive,
    write_request=lambda _request, _names: {},
    write_answer=lambda _method, answer, _names: {"light": answer.shape},
    write_message=lambda view, _names, _choice, _number, _seconds: view,
    write_world=lambda _world: {},
    write_drive=lambda event, _names: {"event": event.name},
)


def alphabet(_world: JSON, _bounds: Bounds) -> Alphabet:
    """What is worth trying."""
    calls = tuple(Input(name, {}) for name in OPERATIONS)
    drives = ({"event": "burnOut"},)
    return Alphabet(inputs=calls, core_inputs=calls, drives=drives, core_drives=drives, worlds=({},))


SYSTEM = System(NAME, SPEC, CODEC, alphabet)
