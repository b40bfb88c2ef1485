"""The states that a system can reach within bounds, with all that can be done in each, as data for a page.

Much is the same in many states, so doings (what is asked or happens), effects (what comes of it) and the parts of
messages are kept once and referred to by number. The page follows names by itself: an effect says which names of the
state it keeps and how many it adds, as a `missionfsm.kernel.step.Step` does.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator

from attrs import frozen

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer, Name
from missionfsm.kernel.readings import choose, meet
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Emission, Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Request, State
from missionfsm.pages.actions import BY_ITSELF, ENVIRONMENT, Doings, Tried
from missionfsm.pages.naming import PLACES, TEXT, Shared, Writer, dumped
from missionfsm.tools.check.phrases import answer_words

MAX_STATES = 4_000
"""How many states a page holds, the nearest ones: some megabytes."""

BEYOND, HERE = -1, -2
"""In the place of the number of a state: one that the page does not hold; the very state where it was done."""


@frozen
class Effect:
    """What comes of something.

    Attributes:
        code: the status that is answered; empty where nothing is.
        answer: the answer in words; `result` as it stands in a history, a template.
        keeps: the names after it; None for those before.
        adds: how many names there are to choose from besides those before.
        refs: the names that the answer mentions.
        opens: the connections that come about, as topics and names; `closes`: the topics of those that end.
        sends: what is sent on connections.
    """

    code: str
    answer: str
    result: str
    keeps: tuple[int, ...] | None
    adds: int
    refs: tuple[int, ...]
    rules: tuple[int, ...]
    assumes: int
    label: str
    opens: tuple[tuple[int, int], ...]
    closes: tuple[int, ...]
    sends: tuple[tuple[int, str, str, tuple[int, ...]], ...]


class Graph:
    """Walks a system breadth first and gathers what a page needs.

    Args:
        assumed: the readings that are possible (see `missionfsm.kernel.readings`).
    """

    def __init__(self, system: System, bounds: Bounds, assumed: int) -> None:
        self.system, self.spec, self.bounds, self.assumed = system, system.spec, bounds, assumed
        self.world = system.alphabet({}, bounds).worlds[0]
        self.alphabet = system.alphabet(self.world, bounds)
        self.choice = choose(self.spec.ambiguities, dict(_reference(self.spec, assumed)))
        self._writer = Writer(system.naming)
        self._tries = Doings(system, self.alphabet, self._writer)
        self._rules, self._assumptions, self._doings, self._effects = (Shared() for _ in range(4))
        self._parts, self._topics = Shared(), Shared()
        self._known: dict[tuple[object, ...], tuple[int, tuple[str, ...]]] = {}
        self._start = self.spec.initial(system.codec.read_world(self.world))
        # What subscribers see can be looked up in every state, what is sent on connections is told as it is sent.
        self._sends = not system.codec.streams
        self._looks = dict(self._looking())
        self._alike: dict[str, set[State]] = {}

    def data(self) -> JSON:
        """All of it.

        States may be told apart that an exploration counts as one, since a history has to know more than what can be
        done next; `held` and `shapes` count as an exploration does.
        """
        kinds = {self._start: (TEXT,) * self.spec.names(self._start)}
        extent, counted = self.spec.explore_size, self.spec.abstraction.canonical or (lambda state: state)
        numbers, todo, states = {self._start: 0}, [self._start], []
        for here in todo:  # grows while it is walked
            moves: dict[tuple[int, int, int], None] = {}
            for tried in self._tries(here, kinds[here]):
                for step in tried.steps:
                    if not meet(self.assumed, step.assumes):
                        continue
                    effect, after = self._effect(tried, step, kinds[here])
                    within = extent(step.after) <= self.bounds.size
                    if step.after not in numbers and within and len(numbers) < MAX_STATES:
                        numbers[step.after] = len(numbers)
                        kinds[step.after] = after
                        todo.append(step.after)
                    to = HERE if step.after == here else numbers.get(step.after, BEYOND)
                    moves[self._doings.number(tried.doing), effect, to] = None
            words = self.spec.describe(here)
            self._alike.setdefault(words, set()).add(counted(here))
            states.append([words, self._views_of(here, kinds[here]), [*_flat(moves)]])
        return self._summary(states)

    def _summary(self, states: list[JSON]) -> JSON:
        spec, bounds = self.spec, self.bounds
        asked = {assumption.ambiguity.id for combined in self._assumptions.values for assumption in combined}
        rules = [spec.rules_by_id[rule] for rule in self._rules.values]
        found = {
            "system": spec.system,
            "bounds": {"missions": bounds.size, **dict(bounds.own)},
            "head": {
                "missionfsm": 1,
                "system": spec.system,
                "world": self.world,
                "drives": sorted({drive["event"] for drive in self.alphabet.core_drives}),
            },
            # Streams are not subscribed to for long, so nothing is owed; what is sent on connections may be owed.
            "settles": not self._sends,
            "names": spec.names(self._start),
            "ambiguities": [
                {
                    "id": one.id,
                    "question": one.question,
                    "readings": dict(one.readings),
                    "possible": "".join(one.possible(self.assumed)),
                    "reference": one.possible(self.choice)[0],
                    "flagged": sorted(one.flagged),
                }
                for one in spec.ambiguities
                if one.id in asked
            ],
            "rules": [{"says": rule.says, "cite": str(rule.cite), "id": rule.id} for rule in rules],
            "assumes": [
                [[one.ambiguity.id, "".join(one.letters)] for one in some] for some in self._assumptions.values
            ],
            "groups": [*self._groups()],
            "doings": [
                [one.kind, one.group, one.words, one.line, one.refs, one.kinds, len(one.brings)]
                for one in self._doings.values
            ],
            "effects": [
                [
                    *(one.code, one.answer, one.result, one.keeps, one.adds, one.refs),
                    *(one.rules, one.assumes, one.label, one.opens, one.closes, one.sends),
                ]
                for one in self._effects.values
            ],
            "views": list(self._looks),
            "shapes": {words: len(some) for words, some in self._alike.items()},
            "held": len(set().union(*self._alike.values())),
            "parts": [json.loads(part) for part in self._parts.values],
            "states": states,
        }
        return {**found, "digest": hashlib.sha256(dumped(found).encode("utf-8", "replace")).hexdigest()[:8]}

    def _groups(self) -> Iterator[JSON]:
        yield {"name": BY_ITSELF, "cite": "", "failures": []}
        yield {"name": ENVIRONMENT, "cite": "", "failures": []}
        for operation in self.spec.operations.values():
            yield {"name": operation.name, "cite": str(operation.cite), "failures": list(operation.failures)}

    # What comes of it.

    def _effect(self, tried: Tried, step: Step, kinds: tuple[str, ...]) -> tuple[int, tuple[str, ...]]:
        """The number of the effect of a step, and the kinds of the names after it."""
        opens = tuple((opening.topic, opening.ref, opening.kind) for opening in step.opens)
        seen = (step.names, step.refs, opens, step.kinds, step.rules, step.assumes, step.answer, step.label)
        sent = (step.ends, step.emits) if self._sends else ()
        key = (tried.method, tried.doing.refs, tried.doing.brings, kinds, seen, sent)
        if key not in self._known:
            effect, after = self._made(tried, step, kinds)
            self._known[key] = self._effects.number(effect), after
        return self._known[key]

    def _made(self, tried: Tried, step: Step, kinds: tuple[str, ...]) -> tuple[Effect, tuple[str, ...]]:
        opened = {opening.ref: opening.kind for opening in step.opens}
        added = range(len(kinds), len(kinds) + step.adds(len(kinds)))
        new = iter(step.kinds)
        pool = (*kinds, *(opened[ref] if ref in opened else next(new, TEXT) for ref in added))
        known = (*kinds, *tried.doing.brings)
        given = tuple(TEXT if at is None else known[at] for at in tried.doing.refs)

        def kind_of(ref: int) -> str:
            return pool[ref] if ref >= 0 else given[-ref - 1]

        after = kinds if step.names is None else tuple(map(kind_of, step.names))
        places = tuple(self._writer.place(kind_of(ref), at) for at, ref in enumerate(step.refs))
        effect = Effect(
            *self._answered(tried.method, step.answer, places),
            step.names,
            len(added),
            step.refs,
            tuple(self._rules.number(rule) for rule in step.rules),
            self._assumptions.number(step.assumes),
            step.label,
            tuple((self._topics.number(one.topic), one.ref) for one in step.opens if self._sends),
            tuple(map(self._topics.number, step.ends)),
            tuple(self._sent(one, step, kind_of) for one in step.emits if self._sends),
        )
        return effect, after

    def _answered(self, method: str, answer: Answer | None, places: tuple[Name, ...]) -> tuple[str, str, str]:
        """The code of an answer, the answer in words, and its line; empty where nothing is answered."""
        if answer is None:
            return "", "", ""
        if answer.code != OK:
            result: JSON = {"error": {"status": answer.code}}
        elif method in self.system.codec.streams:
            result = {"result": {"stream": PLACES}}
        else:
            result = {"result": self.system.codec.write_answer(method, answer, places)}
        return answer.code, answer_words(answer, ()), self._writer.text(result)

    def _sent(
        self, emission: Emission, step: Step, kind_of: Callable[[int], str]
    ) -> tuple[int, str, str, tuple[int, ...]]:
        """A line on a connection: the topic, the line in words and as it is, and the names in it.

        One that may be left out is left out of the history, so that no reading is assumed that nobody chose.
        """
        refs = emission.refs
        if refs is None:
            refs = step.names or tuple(range(self.spec.names(step.after)))
        places = tuple(self._writer.place(kind_of(ref), at) for at, ref in enumerate(refs))
        line = ""
        if emission.only is None and not emission.optional and not emission.stays:
            line = self._writer.text(self.system.codec.write_message(emission.view, places, self.choice, 1, 0.0))
        return self._topics.number(emission.topic), self.spec.describe(emission.view), line, refs

    # What it looks like.

    def _looking(self) -> Iterator[tuple[str, Request]]:
        """The calls that show a state: the look of the alphabet, and one for every operation that opens a stream."""
        codec, found = self.system.codec, set[str]()
        for prompt in (*((self.alphabet.look,) if self.alphabet.look else ()), *self.alphabet.core_inputs):
            if prompt.method in found or not (prompt is self.alphabet.look or prompt.method in codec.streams):
                continue
            names, rest = codec.split_request(prompt.method, prompt.params)
            request = codec.read_request(prompt.method, rest)
            if not names and any(self._seen(self._start, (), prompt.method, request)):
                found.add(prompt.method)
                yield prompt.method, request

    def _seen(self, here: State, kinds: tuple[str, ...], method: str, request: Request) -> Iterator[JSON]:
        """What a call shows at once, under the reference's readings."""
        codec, writer = self.system.codec, self._writer
        step = next((one for one in self.spec.outcomes(here, request, ()) if meet(self.choice, one.assumes)), None)
        if step is None or step.answer is None or step.answer.code != OK:
            return
        if method not in codec.streams:
            places = tuple(writer.place(kinds[ref], ref) for ref in step.refs)
            yield codec.write_answer(method, step.answer, places)
        for opening in step.opens:
            for owed in opening.owed[:1]:
                refs = range(len(kinds)) if owed.refs is None else owed.refs
                places = tuple(writer.place(kinds[ref], ref) for ref in refs)
                yield codec.write_message(owed.view, places, self.choice, 1, 0.0)

    def _views_of(self, here: State, kinds: tuple[str, ...]) -> list[int | None]:
        first = (next(self._seen(here, kinds, method, request), None) for method, request in self._looks.items())
        return [None if one is None else self._parts.json(json.loads(self._writer.text(one))) for one in first]


def _reference(spec: Spec, assumed: int) -> Iterable[tuple[str, str]]:
    """Of what is possible the readings that the reference follows."""
    for one in spec.ambiguities:
        left = one.possible(assumed)
        yield one.id, one.default if one.default in left else left[0]


def _flat(moves: Iterable[tuple[int, int, int]]) -> Iterator[int]:
    for move in moves:
        yield from move
