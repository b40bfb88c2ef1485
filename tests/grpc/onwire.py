"""The reference under every single reading that it does not have by itself, on the wire."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from attrs import evolve, frozen
from relay import Relay

from missionfsm.adapters.grpc.client import GrpcSubject
from missionfsm.adapters.grpc.descriptors import NotOnTheWireError, encode, methods
from missionfsm.adapters.grpc.target import Target
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.reference.subject import ReferenceSubject


def alternatives(of: System) -> tuple[tuple[str, str], ...]:
    """Every ambiguity with each letter that is not its default, but for those that only JSON can say."""
    return tuple(
        (one.id, letter)
        for one in of.spec.ambiguities
        for letter in one.readings
        if letter != one.default and letter not in one.json_only
    )


Asked = tuple[str, JSON]
"""A request of the adapter protocol: its method and params."""


def recorded(of: System) -> list[Asked]:
    """What a short run asks of the reference, in binary."""
    asked: list[Asked] = []
    conform(of, Noting(ReferenceSubject(of), asked), examples=4, tours=8, steps=30, seed=1, advice=False)
    return asked


@frozen
class Noting:
    """A subject that is asked for what binary protobuf can carry, and what was asked."""

    subject: Subject
    asked: list[Asked]

    def exchange(self, method: str, params: JSON) -> Exchange:
        """What the subject answers."""
        answer = self.subject.exchange(method, params)
        if method == "initialize":
            return evolve(answer, result={**answer.result, "requests": "binary"})
        self.asked.append((method, params))
        return answer

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


def proxied(name: str, target: str, seed: int = 1) -> Verdict:
    """The same through a proxy."""
    lines: list[JSON] = []
    relay = Relay(target, lines.append, system=name)
    try:
        found = accepted(name, f"localhost:{relay.proxy.port}", seed)
    finally:
        relay.close()
    assert lines
    return found


def accepted(name: str, target: str, seed: int = 1) -> Verdict:
    """The verdict of a short run against a server."""
    subject = GrpcSubject(name, Target(target, settle=0.02, timeout=60.0, begin=0.2))
    try:
        return conform(system(name), subject, examples=1, tours=2, steps=20, seed=seed, advice=False)
    finally:
        subject.close()
