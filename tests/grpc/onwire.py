"""The reference under every single reading that it does not have by itself, on the wire."""

from __future__ import annotations

from relay import Relay

from missionfsm.adapters.grpc.client import GrpcSubject, Target
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.conform import conform


def alternatives(of: System) -> tuple[tuple[str, str], ...]:
    """Every ambiguity with each letter that is not its default."""
    return tuple((one.id, letter) for one in of.spec.ambiguities for letter in one.readings if letter != one.default)


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
