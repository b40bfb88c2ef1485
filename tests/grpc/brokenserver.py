"""Implementations with one rule broken, judged in this process and over gRPC: the same has to be found."""

from __future__ import annotations

import random
import time
from collections.abc import Iterator
from contextlib import contextmanager

from attrs import evolve, field, frozen

from missionfsm.adapters.grpc.client import GrpcSubject
from missionfsm.adapters.grpc.server import Server
from missionfsm.adapters.grpc.target import Target
from missionfsm.app.live import Live
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, GibberishError, Subject
from missionfsm.kernel.system import System
from missionfsm.oracle.belief import Automaton
from missionfsm.tools.conform.guide import Guide
from missionfsm.tools.conform.handshake import handshake, offered
from missionfsm.tools.conform.run import BOUNDS, Run
from missionfsm.tools.conform.tour import play, tour
from missionfsm.tools.mutate.teeth import Mutant

CONVERSATIONS, STEPS = 8, 30
"""How many conversations a break has, beside those that are written down, and how long they are."""


@contextmanager
def over_grpc(system: System, broken: Subject, **options: bool) -> Iterator[GrpcSubject]:
    """An implementation that is served, as a subject."""
    with Server(Live(system, clock=time.time, subject=broken), **options) as server:
        subject = GrpcSubject(system.name, Target(server.target, settle=0.02, begin=0.2, timeout=5))
        try:
            yield subject
        finally:
            subject.close()


@frozen
class Binary:
    """A subject that is asked for nothing that binary protobuf cannot carry."""

    subject: Subject

    def exchange(self, method: str, params: JSON) -> Exchange:
        """What the subject answers."""
        answer = self.subject.exchange(method, params)
        return evolve(answer, result={**answer.result, "requests": "binary"}) if method == "initialize" else answer

    def close(self) -> None:
        """Nothing is held."""


@frozen
class Searcher:
    """Looks for breaks; what one search found out about the system helps the next."""

    system: System
    automaton: Automaton = field(init=False)
    guide: Guide = field(init=False)

    def __attrs_post_init__(self) -> None:
        drives = tuple(self.system.spec.drives)
        object.__setattr__(self, "automaton", Automaton(self.system.spec, drives))
        worlds = self.system.alphabet({}, BOUNDS).worlds
        object.__setattr__(self, "guide", Guide(self.system, worlds, BOUNDS))

    def search(self, mutant: Mutant, subject: Subject) -> tuple[str, ...]:
        """The rules that a break is found to violate, or how else it is wrong; nothing if it is not found."""
        info = handshake(self.system, subject)
        run = Run.with_guide(offered(self.system, info), subject, info, self.automaton, self.guide.fresh())
        draw = random.Random(0)
        try:
            if tour(run, draw, CONVERSATIONS, STEPS, mutant.favour) and play(run):
                return ()
        except GibberishError as error:
            return (str(error),)
        violation = run.conversation.judge.violation
        return tuple(rule.id for rule in violation.rules) if violation is not None else ("readings contradict",)

    def in_process(self, mutant: Mutant) -> tuple[str, ...]:
        """What is found where only binary requests are asked."""
        return self.search(mutant, Binary(mutant.subject(self.system)))

    def over_grpc(self, mutant: Mutant) -> tuple[str, ...]:
        """What is found on the wire."""
        with over_grpc(self.system, mutant.subject(self.system)) as subject:
            return self.search(mutant, subject)
