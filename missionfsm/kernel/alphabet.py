"""What is worth trying on a system: the requests, drives and worlds that exploration and generation draw from."""

from __future__ import annotations

from attrs import frozen

from missionfsm.kernel.codec import JSON

ANY_NAME = "$name"
"""Stands in a prompt's params for a name that the tester picks: one seen so far, or a wrong one."""


@frozen
class Bounds:
    """How far exploration goes.

    Attributes:
        missions: at most so many are listed at a time.
        goals: a mission has at most so many.
        batch: a batch has at most so many missions.
    """

    missions: int = 2
    goals: int = 2
    batch: int = 2


@frozen
class Prompt:
    """One call worth trying: its method and the JSON of its params, with `ANY_NAME` where a name goes."""

    method: str
    params: JSON


@frozen
class Alphabet:
    """What is worth trying.

    Attributes:
        prompts: calls, malformed ones included.
        plain: those that bring the system on: few, well-formed, each with a meaning of its own; for exploration.
        drives: what to make happen, as JSON.
        plain_drives: those among them that bring the system on.
        worlds: the worlds to try it in, as JSON, the usual one first.
        wrong_names: names that nothing has.
    """

    prompts: tuple[Prompt, ...]
    plain: tuple[Prompt, ...]
    drives: tuple[JSON, ...]
    plain_drives: tuple[JSON, ...]
    worlds: tuple[JSON, ...]
    wrong_names: tuple[str, ...] = ()
