"""Every system is held to the laws of `missionfsm.kernel.spec`, in all states of a small exploration.

Choices of readings are the default one and those that differ from it in a single reading.
"""

from __future__ import annotations

import contextlib
import csv
import functools
import os
import subprocess
import sys
from collections import defaultdict
from collections.abc import Hashable, Iterator
from pathlib import Path
from typing import Any

import orjson
import pytest
from accused import accusations, unneeded
from attrs import evolve, frozen

from missionfsm import systems
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionProto, MissionStatusProto, signed
from missionfsm.kernel.alphabet import Bounds, Naming
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import UNCONSTRAINED, Ambiguity, choose, meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Emission, Mismatch, Step
from missionfsm.kernel.subject import SubjectError
from missionfsm.kernel.system import System
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.explain import MAX_RULES
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.suspects import with_suspects
from missionfsm.tools.check.verdict import CitedRule, Verdict
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.explore.explore import Actions, bindings, reachable, steps
from missionfsm.tools.mutate.mutants import Mutant, mutants

BOUNDS = Bounds(2, goals=2, batch=2)
LARGE = ("bear.status", "isaac.server")
EVERY = [pytest.param(one, marks=pytest.mark.long) if one in LARGE else one for one in systems.names()]
"""Every system; the large ones in the long tests."""
NEAR = 100
"""How many states of an exploration are looked at, nearest first."""

FEWER = {"isaac.server": 1}
"""Where two missions have too many states under all readings at once: how many are few enough for that."""

SITUATIONS = 12
"""In how many different situations every input is tried."""

State = Any
References = tuple[int | None, ...]


def alternatives(system: System) -> Iterator[tuple[Ambiguity, str]]:
    """Every reading that is not the default."""
    for ambiguity in system.spec.ambiguities:
        yield from ((ambiguity, letter) for letter in ambiguity.readings if letter != ambiguity.default)


def choices(system: System) -> dict[str, int]:
    """The default choice, and one for every single alternative reading; parts that are alike are read alike."""
    ambiguities = system.spec.ambiguities
    single = dict.fromkeys((one.alike or one.id, letter) for one, letter in alternatives(system))
    others = {f"{name}={letter}": choose(ambiguities, {name: letter}) for name, letter in single}
    return {"default": choose(ambiguities), **others}


@frozen
class Taken:
    """A step that may be taken in a state, and the request that it answers."""

    before: State
    request: Any
    refs: References
    step: Step


class Lab:
    """A system with what has been found out about it."""

    def __init__(self, name: str) -> None:
        self.system = systems.system(name)
        self.spec: Spec = self.system.spec
        self.worlds = self.system.alphabet({}, BOUNDS).worlds
        alphabet = self.system.alphabet(self.worlds[0], BOUNDS)
        self.plain = Actions.from_alphabet(self.system, alphabet.core_inputs, alphabet.core_drives)
        self.everything = Actions.from_alphabet(self.system, alphabet.inputs, alphabet.drives)
        self._near: dict[State, list[Step]] = {}
        self._steps: dict[tuple[State, Any, References], tuple[Step, ...]] = {}

    def start(self, world: JSON) -> State:
        return self.spec.initial(self.system.codec.read_world(world))

    def extent(self, here: State) -> int:
        return self.spec.explore_size(here)

    def most(self, start: State) -> int:
        """How far a state may go to be looked at."""
        return max(BOUNDS.size, self.extent(start))

    def plain_steps(self, here: State) -> list[Step]:
        found = self._near.get(here)
        if found is None:
            found = self._near[here] = [one.step for one in steps(self.spec, here, self.plain)]
        return found

    def near(self, assumed: int, world: JSON) -> list[State]:
        """The states that are nearest to the start, under some readings."""
        start = self.start(world)
        found, most = [start], self.most(start)
        known = {start}
        for here in found:  # grows while it is walked
            for step in self.plain_steps(here):
                after = step.after
                if after not in known and meet(assumed, step.assumes) and self.extent(after) <= most:
                    known.add(after)
                    found.append(after)
            if len(found) >= NEAR:
                break
        return found

    def situations(self, assumed: int, world: JSON) -> list[State]:
        """A few of them in which different things can be done."""
        found: dict[Hashable, State] = {}
        for here in self.near(assumed, world):
            found.setdefault(self.spec.abstraction.enabled_key(here), here)
        return list(found.values())[:SITUATIONS]

    def outcomes(self, here: State, request: Any, refs: References) -> tuple[Step, ...]:
        key = (here, request, refs)
        found = self._steps.get(key)
        if found is None:
            found = self._steps[key] = self.spec.outcomes(here, request, refs)
        return found

    def calls(self, here: State) -> Iterator[tuple[Any, References]]:
        for request, free in self.everything.requests:
            yield from ((request, refs) for refs in bindings(self.spec, here, free))

    def taken(self, here: State) -> Iterator[Taken]:
        """Every step from a state, under any readings."""
        for request, refs in self.calls(here):
            yield from (Taken(here, request, refs, step) for step in self.outcomes(here, request, refs))
        for event, free in self.everything.events:
            for refs in bindings(self.spec, here, free):
                found = self.spec.drives[event.name].steps(here, event, refs)
                yield from (Taken(here, event, refs, step) for step in found)
        for step in (*self.spec.urgent(here), *self.spec.spontaneous(here)):
            yield Taken(here, None, (), step)

    @functools.cached_property
    def all_taken(self) -> list[Taken]:
        """Every step from some situations in every world, under any readings."""
        states = dict.fromkeys(here for world in self.worlds for here in self.situations(UNCONSTRAINED, world))
        return [taken for here in states for taken in self.taken(here)]


@pytest.fixture(
    scope="module",
    params=EVERY,
)
def lab(request: pytest.FixtureRequest) -> Lab:
    return Lab(request.param)


def test_every_call_has_an_outcome_under_every_choice(lab: Lab) -> None:
    """Total: whatever is called in whatever state, each single choice of readings has an answer to it."""
    unanswered = [
        (name, lab.spec.describe(request), refs, lab.spec.describe(here))
        for name, choice in choices(lab.system).items()
        for here in lab.situations(choice, lab.worlds[0])
        for request, refs in lab.calls(here)
        if not any(meet(choice, step.assumes) for step in lab.outcomes(here, request, refs))
    ]
    assert unanswered == []


def test_what_ties_the_calls_of_a_reading_is_written(lab: Lab) -> None:
    """An ambiguity on which the answers or effects of several calls depend has a text that says why it is not split."""
    about: dict[Ambiguity, set[str]] = defaultdict(set)
    for taken in lab.all_taken:
        if taken.request is not None:
            calls = taken.step.answer is not None
            name = lab.spec.request_operation(taken.request) if calls else taken.request.name
            for one in taken.step.assumes:
                about[one.ambiguity].add(name)
    for rule in lab.spec.all_rules:
        if rule.assumes is not None and rule.code is not None:
            about[rule.assumes.ambiguity].add(rule.id.split("/")[1])
    page = (SPECS / f"{lab.system.name.replace('.', '-')}.md").read_text(encoding="utf-8")
    tied = [text.partition("\n\n")[0] for text in page.split("*Tied:* ")[1:]]
    several = [one.id for one, names in about.items() if len(names) > 1]
    assert [one for one in several if not any(one.startswith(text.split()[0]) for text in tied)] == []


def test_an_outcome_is_an_answer(lab: Lab) -> None:
    """Every outcome of a call has an answer, and no other step has one."""
    calls = [type(request) for request, _ in lab.everything.requests]
    assert [taken for taken in lab.all_taken if (taken.step.answer is None) is (type(taken.request) in calls)] == []


def test_a_refusal_changes_nothing(lab: Lab) -> None:
    """An outcome that is neither OK nor a failure keeps the state, shows nothing, opens and closes nothing."""

    def refused(taken: Taken) -> bool:
        if taken.step.answer is None or taken.step.answer.code == OK or taken.step.label:
            return False
        operation = lab.spec.operations[lab.spec.request_operation(taken.request)]
        return taken.step.answer.code not in operation.failures

    found = [taken for taken in lab.all_taken if refused(taken)]
    assert [
        taken
        for taken in found
        if taken.step.after != taken.before or taken.step.emits or taken.step.opens or taken.step.closes
    ] == []
    assert found or not lab.spec.operations


def test_names_are_kept_apart(lab: Lab) -> None:
    """A step's names are those of its state before or new ones, each once, as many as the state after it has."""

    def wrong(taken: Taken) -> bool:
        step, before = taken.step, lab.spec.names(taken.before)
        names = tuple(range(before)) if step.names is None else step.names
        opened = tuple(one.ref for one in step.opens)
        given = range(-len(taken.refs), 0) if step.answer is None else ()
        own = {*given, *range(before), *names, *opened}
        shown = {
            ref for one in (*step.emits, *(owed for new in step.opens for owed in new.owed)) for ref in one.refs or ()
        }
        new = sorted({ref for ref in own if ref >= before})
        return (
            len(names) != lab.spec.names(step.after)
            or len(set(names)) < len(names)
            or not {*step.refs, *shown} <= own
            or new != list(range(before, before + len(new)))
        )

    assert [taken for taken in lab.all_taken if wrong(taken)] == []


def test_a_rule_that_is_named_exists(lab: Lab) -> None:
    """Every rule by which a step is justified is a rule of the system."""
    known = set(lab.spec.rules_by_id)
    assert {rule for taken in lab.all_taken for rule in taken.step.rules if rule not in known} == set()


def test_what_a_question_is_about_exists(lab: Lab) -> None:
    """Who follows no reading of an ambiguity breaks promises that there are."""
    about = lab.spec.answers_for
    known = [f"{one.id}." for one in lab.spec.ambiguities]
    assert [name for name in about if not any(one.startswith(f"{name}.") for one in known)] == []
    assert {rule for rules in about.values() for rule in rules} <= set(lab.spec.rules_by_id)


def test_urgency_ends(lab: Lab) -> None:
    """Urgent steps come to rest from every state that a step leads to, whichever of them are taken."""
    resting: dict[State, bool] = {}

    def comes_to_rest(here: State, above: tuple[State, ...]) -> bool:
        if here in above:
            return False
        if here not in resting:
            resting[here] = all(comes_to_rest(step.after, (*above, here)) for step in lab.spec.urgent(here))
        return resting[here]

    assert [taken for taken in lab.all_taken if not comes_to_rest(taken.step.after, ())] == []


@pytest.mark.parametrize("decided", [True, False], ids=["default readings", "all readings"])
def test_invariants_hold_and_possibilities_are_met(lab: Lab, *, decided: bool) -> None:
    """Every invariant holds in every state within bounds, and every possibility is met in one.

    What is possible under the default readings is so under all of them.
    """
    assumed = choose(lab.spec.ambiguities) if decided else UNCONSTRAINED
    start = lab.start(lab.worlds[0])
    fewer = None if decided else FEWER.get(lab.system.name)
    found = reachable(lab.spec, start, lab.plain, fewer or lab.most(start), assumed)
    assert [(one.name, here) for one in lab.spec.invariants for here in found if not one.holds(here)] == []
    assert fewer or [one.says for one in lab.spec.possibilities if not any(map(one.holds, found))] == []


def test_states_in_one_situation_answer_alike(lab: Lab) -> None:
    """In states with one enabled key, every call has the same answers under the same readings."""
    groups = defaultdict(list)
    for here in lab.near(UNCONSTRAINED, lab.worlds[0]):
        groups[lab.spec.abstraction.enabled_key(here)].append(here)

    def answers(here: State) -> list[Any]:
        return [
            [
                (step.answer, step.refs, step.assumes, step.rules, step.label)
                for step in lab.outcomes(here, request, refs)
            ]
            for request, refs in lab.calls(here)
        ]

    alike = [(group[0], other) for group in list(groups.values())[:SITUATIONS] for other in group[1:3]]
    assert [pair for pair in alike if answers(pair[0]) != answers(pair[1])] == []


@pytest.mark.parametrize("decided", [pytest.param(True, id="default readings"), pytest.param(False, id="all readings")])
@pytest.mark.long
def test_the_shortcut_takes_the_same_steps(lab: Lab, *, decided: bool) -> None:
    """The shortcut of a system reaches exactly the states that its steps reach, in every world.

    Under all readings at once, two missions are tried in the first world and one in the others, and states are held to
    be one that go on in the same ways: a shortcut need not keep what decides nothing.
    """
    if lab.spec.abstraction.compiled is None:
        pytest.skip(f"{lab.system.name} has no shortcut")
    assumed = choose(lab.spec.ambiguities) if decided else UNCONSTRAINED
    slow = evolve(lab.spec, abstraction=evolve(lab.spec.abstraction, compiled=None))
    for number, world in enumerate(lab.worlds):
        bounds = Bounds(2 if decided or number == 0 else 1, goals=1, batch=2)
        alphabet = lab.system.alphabet(world, bounds)
        actions = Actions.from_alphabet(lab.system, alphabet.core_inputs, alphabet.core_drives)
        start = lab.start(world)
        fast = reachable(lab.spec, start, actions, bounds.size, assumed)
        stands_for = (not decided and lab.spec.abstraction.forget_ended) or (lambda state: state)
        stepwise = reachable(slow, start, actions, bounds.size, assumed)
        assert len(set(map(stands_for, fast)) ^ set(map(stands_for, stepwise))) == 0


# What is shown is recognised.


def lasting(lab: Lab, choice: int, states: list[State]) -> Iterator[tuple[Emission, int]]:
    """What has to be shown under a choice, with how many names there are to show."""
    for here in states:
        for step in lab.plain_steps(here):
            if not meet(choice, step.assumes):
                continue
            if not any(meet(choice, urgent.assumes) for urgent in lab.spec.urgent(step.after)):
                owed = (emission for new in step.opens for emission in new.owed)
                yield from ((emission, lab.spec.names(step.after)) for emission in (*step.emits, *owed))


def test_what_is_shown_is_recognised(lab: Lab) -> None:
    """A message made from a view under a choice is accepted for that view, with its names, agreeing with the choice."""
    if lab.system.naming != Naming():
        pytest.skip("its names are of several kinds; a run of the reference writes and reads every message instead")
    codec = lab.system.codec
    seen = set()
    for name, choice in choices(lab.system).items():
        for emission, count in lasting(lab, choice, lab.near(choice, lab.worlds[0])):
            if emission.optional or emission.stays or (emission.only and not meet(choice, (emission.only,))):
                continue  # it need not be shown
            width = count if emission.refs is None else len(emission.refs)
            if (name, emission.view, width) in seen:
                continue
            seen.add((name, emission.view, width))
            names = tuple(f"name-{index}" for index in range(width))
            ((known, _, rest),) = codec.split_message(codec.write_message(emission.view, names, choice, 1, 0.0))
            matches = lab.spec.matches(emission.view, codec.read_content(rest))
            assert not isinstance(matches, Mismatch), (name, lab.spec.describe(emission.view), matches.says)
            agreeing = [match for match in matches if meet(choice, match.assumes)]
            assert agreeing, (name, lab.spec.describe(emission.view))
            assert any(all(names[own] == known[at] for own, at in match.names) for match in agreeing)
    assert seen


# A violation says what is broken.

SAMPLED = {"bear.mission": 400, "bear.status": 400, "isaac.robot": 4}
"""Of how many mutants of a system one is looked at where not all are; those of a server take too long for that."""
MANY = {"bear.mission": 90, "bear.status": 90, "isaac.server": 4, "isaac.robot": 2}
"""The same for a run that takes its time."""
RIGHT = {"bear.mission": 0.9, "bear.status": 0.9, "isaac.server": 0.9, "isaac.robot": 0.95}
"""What part of many violations names the very rule, at least."""


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("bear.mission", marks=pytest.mark.long),
        pytest.param("bear.status", marks=pytest.mark.long),
        "isaac.robot",
    ],
)
def test_a_violation_names_the_rule_that_is_broken(name: str) -> None:
    """Of a sample of mutants: each violation names one to three rules, the one that was broken among them.

    And no rule that has no part in it.
    """
    found = list(accusations(systems.system(name), every=SAMPLED[name], first=2))
    assert [rule for one in found for rule in unneeded(systems.system(name), one.violation)] == []
    assert [str(one) for one in found if not 1 <= len(one.violation.rules) <= MAX_RULES] == []
    assert [str(one) for one in found if not one.is_right(systems.system(name))] == []
    assert found


@pytest.mark.long
@pytest.mark.parametrize("name", systems.names())
def test_most_violations_name_the_rule_that_is_broken(name: str) -> None:
    """Of many mutants: a violation names at most three rules, none without a part in it, mostly the broken one."""
    found = list(accusations(systems.system(name), every=MANY[name], conversations=8))
    assert [rule for one in found for rule in unneeded(systems.system(name), one.violation)] == []
    assert [str(one) for one in found if len(one.violation.rules) > MAX_RULES] == []
    wrong = [str(one) for one in found if not one.is_right(systems.system(name))]
    assert len(wrong) <= (1 - RIGHT[name]) * len(found), wrong


def test_an_accused_row_that_has_no_part_in_it_is_noticed() -> None:
    """The row that was due has a part; one about goals has none where nothing is wrong with them."""
    system = systems.system("bear.mission")
    mission = {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}
    create = {"method": "CreateMission", "params": {"mission": mission}}
    first = {"missionfsm": 1, "system": "bear.mission", "world": {}, "drives": list(system.spec.drives)}
    lines = [
        *({"call": 1, **create}, {"return": 1, "result": {"missionId": "one"}}),
        *({"call": 2, **create}, {"return": 2, "result": {"missionId": "two"}}),
    ]
    found = check(system, head(first), lines).violation
    assert found is not None
    assert [one.id.rpartition("/")[2] for one in found.rules] == ["another-mission-is-active-or-queued"]
    assert unneeded(system, found) == []
    other = next(one for one in system.spec.operations["CreateMission"].refusals if one.name == "a-goal-occurs-twice")
    assert unneeded(system, evolve(found, rules=(*found.rules, CitedRule(other.id, "", "")))) == [other.id]


def test_an_accused_rule_that_has_no_part_in_it_is_noticed() -> None:
    """A robot that passes over the end of a mission breaks what it promises of that; that missions start has no part.

    It is told so, and the law notices it.
    """
    system = systems.system("isaac.robot")
    old, new = {"lower": "1", "upper": "7"}, {"lower": "2", "upper": "7"}
    header = {"channel": "mission_status", "proto": str(signed(TYPE_IDS[MissionStatusProto]))}

    def runs(uuid: Any) -> Any:
        line = {"header": header, "payload": {"uuid": uuid, "missionStatus": "running"}}
        return {"connection": 1, "line": orjson.dumps(line).decode()}

    def arrives(uuid: Any) -> Any:
        said = {"channel": "mission", "proto": str(signed(TYPE_IDS[MissionProto]))}
        line = {"header": said, "payload": {"uuid": uuid, "config": {"serialized": "{}"}}}
        return {"drive": {"event": "line", "line": orjson.dumps(line).decode()}}

    first = {"missionfsm": 1, "system": "isaac.robot", "world": {}, "drives": list(system.spec.drives)}
    lines = (arrives(old), runs(old), {"settled": True}, arrives(new), runs(new))
    found = check(system, head(first), lines).violation
    assert found is not None
    found = with_suspects(system, found)
    named = [one.id.rpartition("/")[2] for one in found.rules]
    assert named[0] == "one-failure-at-the-end"
    assert "a-new-mission-preempts" in named
    assert unneeded(system, found) == []
    other = next(one for one in system.spec.rules if one.name == "a-mission-starts-the-behavior-tree")
    accused = (*found.rules, CitedRule(other.id, "", ""))
    assert unneeded(system, evolve(found, rules=accused)) == [other.id]


SPECS = Path(__file__).parent.parent / "specs"
BROKEN = {"bear.mission": 200, "bear.status": 400, "isaac.server": 31, "isaac.robot": 10}
"""Of how many mutants of a system one is fed its own findings where not all are."""


def fed_back(system: System, mutant: Mutant, seed: int) -> Verdict:
    """The verdict on a mutant once everything is expected of it that runs before have found."""
    expected: tuple[str, ...] = ()
    for _ in range(FINDINGS):
        plan = Plan(4, 8, 0, 20, 0)
        verdict = conform(system, mutant.subject(system), plan=plan, seed=seed, expected=expected, advice=False)
        if verdict.violation is None:
            break
        assert not set(verdict.violation.known_by) & set(expected), str(verdict)
        expected += verdict.violation.known_by
    return verdict


FINDINGS = 12
"""After so many findings of a mutant, one more is one too many."""


@pytest.mark.parametrize(
    "name",
    [pytest.param("bear.mission", marks=pytest.mark.long), *(one for one in EVERY if one != "bear.mission")],
)
def test_what_a_run_has_found_can_be_expected_of_the_next(name: str) -> None:
    """Of a sample of mutants: with all findings listed, a run with the same seed ends well, with none of them stale."""
    found = systems.system(name)
    for mutant in list(mutants(found))[1 :: BROKEN[name]]:
        verdict = fed_back(found, mutant, 1)
        assert (mutant.name, verdict.violation, verdict.stale) == (mutant.name, None, ())


@pytest.mark.long
@pytest.mark.parametrize("name", systems.names())
def test_what_many_runs_have_found_can_be_expected_of_the_next(name: str) -> None:
    """The same of many mutants, with one of three seeds each."""
    found = systems.system(name)
    for number, mutant in enumerate(list(mutants(found))[:: 4 * MANY[name]]):
        with contextlib.suppress(SubjectError):  # it does not speak the protocol any more
            verdict = fed_back(found, mutant, 1 + number % 3)
            assert (mutant.name, verdict.violation, verdict.stale) == (mutant.name, None, ())


CASES = next((one / "shared" / "cases" for one in Path(__file__).parents if (one / "shared" / "cases").is_dir()), None)


@pytest.mark.slow
@pytest.mark.skipif(CASES is None, reason="no folder shared/cases lies beside the project")
def test_every_case_that_violates_names_a_rule() -> None:
    """Whatever small histories lie beside the project: one that is judged wrong is said to break one to three rules."""
    assert CASES is not None
    with (CASES / "cases.tsv").open(encoding="utf-8", newline="") as table:
        rows = [row for row in csv.DictReader(table, delimiter="\t", quoting=csv.QUOTE_NONE) if row["exit"] == "1"]
    plain = [CASES / row["file"] for row in rows if not row["options"] and row["file"].endswith(".jsonl")]
    named = {}
    for path in plain:
        first, *lines = map(orjson.loads, path.read_bytes().splitlines())
        if "system" not in first:
            continue  # bare messages
        verdict = check(systems.system(first["system"]), head(first), lines)
        if verdict.violation is not None:
            named[path.name] = len(verdict.violation.rules)
    assert {name: rules for name, rules in named.items() if not 1 <= rules <= MAX_RULES} == {}
    assert named


# Pure.

LEDGER = """
import hashlib, sys
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.readings import choose
from missionfsm.systems import system
from missionfsm.tools.explore.explore import Actions, reachable, steps

found = system(sys.argv[1])
bounds = Bounds(1, goals=2, batch=1)
(world, *_) = found.alphabet({}, bounds).worlds
alphabet = found.alphabet(world, bounds)
plain = Actions.from_alphabet(found, alphabet.core_inputs, alphabet.core_drives)
everything = Actions.from_alphabet(found, alphabet.inputs, alphabet.drives)
start = found.spec.initial(found.codec.read_world(world))
ledger = hashlib.sha256()
most = max(1, found.spec.names(start))
for here in list(reachable(found.spec, start, plain, most, choose(found.spec.ambiguities)))[:20]:
    ledger.update(found.spec.describe(here).encode())
    for one in steps(found.spec, here, everything):
        step = one.step
        told = (one.words(found.spec), step.label, step.names, step.refs, step.rules, step.applied, str(step.answer))
        shown = [(str(emission.topic), found.spec.describe(emission.view)) for emission in step.emits]
        assumed = [str(one) for one in step.assumes]
        ledger.update(repr((told, shown, assumed, found.spec.describe(step.after))).encode())
print(ledger.hexdigest())
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", EVERY)
def test_nothing_depends_on_the_hash_seed(name: str) -> None:
    """Pure: under other hash seeds the same steps come in the same order."""
    ledgers = {
        subprocess.run(
            [sys.executable, "-c", LEDGER, name],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("0", "4711")
    }
    assert len(ledgers) == 1
