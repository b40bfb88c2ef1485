"""Implementations with a rule broken, or that read the page in another way, in this process and on the wire.

In this process it takes a moment to find the conversation in which a break or a reading shows; only that one is had
again over gRPC, alone and through a proxy.
"""

from __future__ import annotations

import os
import random
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TypeVar

from attrs import Factory, define, evolve, field, frozen
from relay import Relay

from missionfsm.adapters.grpc.client import GrpcSubject
from missionfsm.adapters.grpc.descriptors import NotOnTheWireError, encode, methods
from missionfsm.adapters.grpc.server import Server
from missionfsm.adapters.grpc.target import Target
from missionfsm.app.live import Live
from missionfsm.app.serve import serve
from missionfsm.bear.wire.methods import METHODS, Method
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.subject import Exchange, GibberishError, Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.check.verdict import Violation
from missionfsm.tools.conform.actions import Action
from missionfsm.tools.conform.guide import Guide
from missionfsm.tools.conform.handshake import handshake, offered
from missionfsm.tools.conform.run import BOUNDS, Run
from missionfsm.tools.conform.tour import play, tour
from missionfsm.tools.conform.trials import Lab
from missionfsm.tools.mutate.mutants import Mutant
from missionfsm.tools.reference.subject import ReferenceSubject

EFFORT = 2_000
"""How many steps of references the search for the conversation in which a reading shows may take."""
CONVERSATIONS, STEPS = 8, 30
"""How many conversations an implementation has, beside those that are written down, and how long they are."""

T = TypeVar("T")
Had = tuple[JSON, tuple[Action, ...]]
"""A conversation: its world, and what was done."""
Asked = tuple[str, JSON]
"""A request of the adapter protocol: its method and params."""


def sampled(every: Sequence[T], of: int) -> Sequence[T]:
    """Every so many of them; SHARD=2/8 in the environment takes the second of eight parts of that."""
    part, _, parts = os.environ.get("SHARD", "1/1").partition("/")
    return every[::of][int(part) - 1 :: int(parts)]


@contextmanager
def connected(of: System, target: str, *, proxied: bool = False) -> Iterator[GrpcSubject]:
    """A server as a subject; through a proxy, or without one."""
    relay = Relay(target, lambda _: None, system=of.name) if proxied else None
    where = f"localhost:{relay.proxy.port}" if relay else target
    subject = GrpcSubject(of.name, Target(where, settle=0.02, begin=0.2, timeout=30))
    try:
        yield subject
    finally:
        subject.close()
        if relay:
            relay.close()


@contextmanager
def served(of: System, implementation: Subject) -> Iterator[str]:
    """Where an implementation is reached, with its control service."""
    with Server(Live(of, clock=time.time, subject=implementation)) as server:
        yield server.target


@define
class Binary:
    """A subject that is asked for nothing that binary protobuf cannot carry, and heard as far as that can carry it."""

    subject: Subject
    streams: dict[int, Method] = Factory(dict)

    def exchange(self, method: str, params: JSON) -> Exchange:
        """What the subject answers. Raises GibberishError for what has no binary form."""
        answer = self.subject.exchange(method, params)
        if method == "initialize":
            return evolve(answer, result={**answer.result, "requests": "binary"})
        called = next((one for one in METHODS if one.name == method), None)
        if called is not None and answer.error is None:
            if not called.streams:
                _encoded(called, answer.result)
            elif isinstance(answer.result.get("stream"), int):
                self.streams[answer.result["stream"]] = called
        for one in (*answer.earlier, *answer.before, *answer.after):
            if one.method == "message" and one.params["stream"] in self.streams:
                _encoded(self.streams[one.params["stream"]], one.params["message"])
        return answer

    def close(self) -> None:
        """Nothing is held."""


def _encoded(method: Method, value: JSON) -> None:
    try:
        encode(method.response, value)
    except NotOnTheWireError as error:
        raise GibberishError(str(error)) from None


@frozen
class Searcher:
    """Looks for what an implementation does otherwise; what one search found out about the system helps the next."""

    system: System
    automaton: Automaton = field(init=False)
    guide: Guide = field(init=False)

    def __attrs_post_init__(self) -> None:
        drives = tuple(self.system.spec.drives)
        object.__setattr__(self, "automaton", Automaton(self.system.spec, drives))
        worlds = self.system.alphabet({}, BOUNDS).worlds
        object.__setattr__(self, "guide", Guide(self.system, worlds, BOUNDS))

    def run(self, subject: Subject) -> Run:
        info = handshake(self.system, subject)
        return Run.with_guide(offered(self.system, info), subject, info, self.automaton, self.guide.fresh())

    def break_shown(self, mutant: Mutant) -> tuple[Had, ...]:
        """The conversation in which a break shows where only binary requests are asked.

        Several where only together they follow no readings; none where it shows in none, or first in an answer that no
        message is, which binary cannot say.
        """
        found: list[Had] = []
        run = self.run(Binary(mutant.subject(self.system)))
        run.progress = lambda run: found.append((run.conversation.world, tuple(run.conversation.actions)))
        try:
            if tour(run, random.Random(0), CONVERSATIONS, STEPS, mutant.favour) and play(run):
                return ()
        except GibberishError:
            return ()
        last = run.conversation.world, tuple(run.conversation.actions)
        return (last,) if run.conversation.judge.violation is not None else (*found, last)

    def usual(self) -> list[Had]:
        """The conversations of a search through the reference."""
        found: list[Had] = []
        run = self.run(Binary(ReferenceSubject(self.system)))
        run.progress = lambda run: found.append((run.conversation.world, tuple(run.conversation.actions)))
        assert tour(run, random.Random(0), CONVERSATIONS, STEPS)
        return found

    def readings_shown(self, ambiguity: Ambiguity) -> dict[str, Had]:
        """Of each reading that an experiment tells from another one the conversation in which it shows."""
        info = handshake(self.system, Binary(ReferenceSubject(self.system)))
        trials = Lab(self.guide, info, self.automaton, {}, EFFORT).trials(ambiguity, tuple(ambiguity.readings))
        return {trial.follows: (trial.world, trial.actions) for trial in reversed(trials)}

    def violation(self, subject: Subject, had: Iterable[Had]) -> Violation | str | None:
        """What is wrong in conversations that are had with a subject; None if nothing is."""
        run = self.run(subject)
        try:
            for one in had:
                if not run.converse(*one):
                    return run.conversation.judge.violation or "the readings contradict one another"
        except GibberishError as error:
            return str(error)
        return None


def asked(of: System, had: Iterable[Had]) -> list[Asked]:
    """What is asked in conversations."""
    found: list[Asked] = []
    searcher = Searcher(of)
    run = searcher.run(Noting(Binary(ReferenceSubject(of)), found))
    for one in had:
        run.replay(*one)
    return found


@frozen
class Noting:
    """A subject, and what it was asked."""

    subject: Subject
    asked: list[Asked]

    def exchange(self, method: str, params: JSON) -> Exchange:
        """What the subject answers."""
        if method != "initialize":
            self.asked.append((method, params))
        return self.subject.exchange(method, params)

    def close(self) -> None:
        """Nothing is held."""


def unsaid(of: System, readings: Mapping[str, str], asked: Iterable[Asked]) -> list[str]:
    """What the reference under some readings answers and shows that has no binary form, where it is asked again."""
    subject, calls = ReferenceSubject(of, readings), methods(of.name)
    opened: dict[int, str] = {}
    found = []
    for method, params in asked:
        try:
            answer = subject.exchange(method, params)
        except SubjectError:  # such as a stream that this reading did not open
            continue
        said = []
        if method in calls and answer.error is None:
            if calls[method].streams:
                opened[answer.result["stream"]] = method
            else:
                said.append((method, answer.result))
        unasked = (*answer.earlier, *answer.before, *answer.after)
        said += [(opened[one.params["stream"]], one.params.get("message")) for one in unasked]
        for name, value in said:
            try:
                encode(calls[name].response, value or {})
            except NotOnTheWireError as error:
                found.append(str(error))
    return found


@define
class Looked:
    """What became of many implementations on the wire.

    Attributes:
        shown: how many of them do otherwise than the reference in a conversation that binary requests can have.
        hidden: the names of the others.
        wrong: what is not as it should be, in words.
    """

    what: str
    every: int = 0
    shown: int = 0
    hidden: list[str] = Factory(list)
    wrong: list[str] = Factory(list)

    def __str__(self) -> str:
        return f"{self.shown} of {self.every} {self.what} but for {len(self.wrong)}; {len(self.hidden)} show nowhere"


def breaks_carried(of: System, mutants: Iterable[Mutant], every: int) -> Looked:
    """Every break that shows in this process is to be found over gRPC, alone and through a proxy."""
    searcher = Searcher(of)
    found = Looked("breaks show in binary requests, and are found over gRPC, alone and through a proxy")
    for mutant in sampled(tuple(mutants), every):
        found.every += 1
        had = searcher.break_shown(mutant)
        if not had:
            found.hidden.append(mutant.name)
            continue
        found.shown += 1
        with served(of, mutant.subject(of)) as target:
            for proxied in (False, True):
                with connected(of, target, proxied=proxied) as subject:
                    if searcher.violation(subject, had) is None:
                        found.wrong.append(f"{mutant.name}{' through a proxy' * proxied}")
    return found


def readings_accepted(of: System, every: int) -> Looked:
    """Every reading is to be accepted over gRPC, alone and through a proxy: where it shows, or else in a usual talk."""
    searcher = Searcher(of)
    usual = max(searcher.usual(), key=lambda one: len(one[1]))
    found = Looked("readings show in binary requests, and are accepted over gRPC, alone and through a proxy")
    for ambiguity in sampled([one for one in of.spec.ambiguities if len(one.readings) > 1], every):
        shown = searcher.readings_shown(ambiguity)
        for letter in ambiguity.readings:
            if letter == ambiguity.default or letter in ambiguity.json_only:
                continue
            name = f"{ambiguity.id}={letter}"
            found.every += 1
            found.shown += letter in shown
            found.hidden += [] if letter in shown else [name]
            with serve(of.name, readings={ambiguity.id: letter}) as robot:
                for proxied in (False, True):
                    with connected(of, robot.target, proxied=proxied) as subject:
                        violation = searcher.violation(subject, [shown.get(letter, usual)])
                        if violation is not None:
                            found.wrong.append(f"{name}{' through a proxy' * proxied}: {violation}")
    return found
