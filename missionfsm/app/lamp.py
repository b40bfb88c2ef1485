"""A lamp, as a system: what ``missionfsm new`` writes for a start. Put your own page in the place of the manual's."""

from __future__ import annotations

from missionfsm.kernel.language import (
    FAILED_PRECONDITION,
    JSON,
    OK,
    Alphabet,
    Ambiguity,
    Answer,
    Codec,
    Document,
    Drive,
    Happening,
    Input,
    Malformed,
    Operation,
    Spec,
    Step,
    System,
    decide,
    refusal,
)

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


def burns_out(state: str, _event: Happening, _names: object) -> tuple[Step, ...]:
    """The one thing that a tester can make happen; it may happen by itself as well."""
    return () if state == "burnt out" else (Step("burnt out", label="burns out"),)


SPEC = Spec(
    NAME,
    title="a lamp",
    initial=lambda _world: "off",
    operations=OPERATIONS,
    outcomes=outcomes,
    drives=[Drive("burnOut", burns_out, by_itself=(Happening("burnOut"),))],
    ambiguities=(DIM_OFF,),
    describe=lambda one: one.name if isinstance(one, Happening) else str(one),
)

# Its JSON: a request is its method, a drive its name.


def read_answer(_method: str, result: JSON) -> tuple[Answer, tuple[()]]:
    """``{"light": "on"}`` as an answer; anything else is remembered as malformed."""
    light = result.get("light") if isinstance(result, dict) else None
    return Answer(OK, light if isinstance(light, str) else Malformed("it does not say how the light is")), ()


CODEC = Codec(
    methods=tuple(OPERATIONS),
    events=tuple(SPEC.drives),
    read_answer=read_answer,
    write_answer=lambda _method, answer, _names: {"light": answer.shape},
)

# What is worth trying: each call, each drive.

CALLS = tuple(Input(name, {}) for name in OPERATIONS)

SYSTEM = System(NAME, SPEC, CODEC, lambda _world, _bounds: Alphabet(CALLS, drives=({"event": "burnOut"},)))
