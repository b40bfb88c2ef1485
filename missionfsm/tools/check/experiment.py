"""What would tell readings apart that a judgement leaves open."""

from __future__ import annotations

from attrs import frozen

from missionfsm.kernel.codec import JSON


@frozen
class Experiment:
    """What would tell readings apart that are still open.

    Attributes:
        ambiguity: the id of the question.
        follows: the letter of the reading that it shows.
        against: the letters that it rules out if the implementation follows that one.
        says: what to do and what is then seen, line by line.
        history: the same as lines of the history format, as the reference answers under `follows`.
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
