"""The reference, whatever readings it follows, conforms; and what it follows is among what is reported."""

from __future__ import annotations

import random

import pytest

from missionfsm.kernel.alphabet import ANY_NAME, Bounds
from missionfsm.oracle.belief import Automaton
from missionfsm.systems import system
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.conversation import Action, Conversation, introduce
from missionfsm.tools.conform.run import Run
from missionfsm.tools.reference.subject import Reference

MISSION = system("bear.mission")
BOUNDS = Bounds(2, goals=3, batch=2)
ALTERNATIVES = [
    (ambiguity.id, letter)
    for ambiguity in MISSION.spec.ambiguities
    for letter in ambiguity.readings
    if letter != ambiguity.default
]
AUTOMATON = Automaton(MISSION.spec, MISSION.spec.drives)
"""What is observed does not depend on who is judged, so all of them walk in one automaton."""

CONVERSATIONS, STEPS = 8, 25
CHOOSING = ("AM-18", "AM-45.when")


def talk(reference: Reference, world: object, chance: random.Random) -> Conversation:
    """A conversation of calls and drives by chance, watched from its start, settled now and then."""
    alphabet = MISSION.alphabet(world, BOUNDS)
    conversation = Conversation(MISSION, reference, introduce(MISSION, reference), world, AUTOMATON)
    conversation.perform(Action(1, "SubscribeMissionStatus", {}))
    for serial in range(2, STEPS):
        if chance.random() < 0.3:
            done = conversation.perform(Action(serial, "drive", chance.choice(alphabet.drives)))
        else:
            prompt = chance.choice(alphabet.plain if chance.random() < 0.6 else alphabet.prompts)
            given = [one for one, name in conversation.given.items() if isinstance(name, str)]
            named = ANY_NAME in repr(prompt.params)
            name = (chance.choice(given) if given and chance.random() < 0.9 else "no-such-mission") if named else None
            done = conversation.perform(Action(serial, prompt.method, prompt.params, name))
        if not done or (chance.random() < 0.5 and not conversation.perform(Action(-serial, "settle"))):
            break
    return conversation


@pytest.mark.parametrize(("ambiguity", "letter"), ALTERNATIVES, ids=[f"{one}={letter}" for one, letter in ALTERNATIVES])
def test_the_reference_under_an_alternative_reading_conforms(ambiguity: str, letter: str) -> None:
    """A reference that follows a single alternative is explained, and all that it follows is reported as possible."""
    chance = random.Random(f"{ambiguity}={letter}")
    reference = Reference(MISSION, {ambiguity: letter})
    for number in range(CONVERSATIONS):
        worlds = MISSION.alphabet({}, BOUNDS).worlds
        judge = talk(reference, worlds[number % len(worlds)], chance).judge
        assert judge.right, str(judge.verdict())
        followed = judge.belief.readings
        assert letter in followed.get(ambiguity, (letter,))
        for one in MISSION.spec.ambiguities:
            if one.id != ambiguity:
                assert one.default in followed.get(one.id, (one.default,))


@pytest.mark.slow
def test_the_reference_conforms_under_its_own_readings() -> None:
    """The reference conforms where its own readings are demanded, and does not where another one is."""
    demanded = {one.id: one.default for one in MISSION.spec.ambiguities}
    conforming = conform(MISSION, Reference(MISSION), examples=5, steps=25, seed=1, readings=demanded)
    assert conforming.conforms, str(conforming)
    violating = conform(MISSION, Reference(MISSION), examples=20, steps=25, seed=1, readings={"AM-16": "b"})
    assert violating.outcome.value == "violates"


@pytest.mark.slow
def test_the_same_seed_gives_the_same_verdict() -> None:
    """Whatever a verdict says, it says again for the same seed; another seed exercises other things."""
    verdicts = [
        conform(MISSION, Reference(MISSION, {"AM-09": "b"}), examples=3, steps=20, seed=seed) for seed in (5, 5, 6)
    ]
    assert verdicts[0].to_json() == verdicts[1].to_json()
    assert verdicts[0].exercised != verdicts[2].exercised


@pytest.mark.parametrize(
    ("name", "letter"),
    [
        (one.id, letter)
        for one in MISSION.spec.ambiguities
        if one.id in ("AM-18", "AM-45.when")
        for letter in one.readings
    ],
)
def test_the_written_down_conversations_tell_how_goals_are_chosen(name: str, letter: str) -> None:
    """Which goal a NavigateAuto mission takes, and when, shows only where goals are taken away at the right moment."""
    run = Run.of(MISSION, Reference(MISSION, {name: letter}))
    assert run.play()
    assert run.readings[name] == (letter,)
