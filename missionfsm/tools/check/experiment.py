"""Experiments that would tell apart the readings which a verdict leaves open."""

from __future__ import annotations

from attrs import frozen

from missionfsm.kernel.codec import JSON


@frozen
class Experiment:
    """A conversation that would tell open readings apart.

    Attributes:
        ambiguity: the id of the ambiguity.
        follows: the letter of the reading that it would show.
        against: the letters that it would rule out then.
        says: what to do and what is seen then, line by line.
        history: the same as lines of the history format, answered by the reference under `follows`.
    """

    ambiguity: str
    follows: str
    against: tuple[str, ...]
    says: str
    history: tuple[JSON, ...] = ()

    def to_json(self) -> JSON:
        """The experiment as the command line writes it."""
        return {
            "ambiguity": self.ambiguity,
            "follows": self.follows,
            "against": list(self.against),
            "says": self.says.splitlines(),
            "history": list(self.history),
        }

    def __str__(self) -> str:
        return f"{self.ambiguity}: {self.follows}, and not {' or '.join(self.against)}, would show in\n{self.says}"
