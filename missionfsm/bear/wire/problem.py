"""What is wrong with a bare message: one of a subscription of which nothing else is known."""

from __future__ import annotations

from attrs import frozen


@frozen
class Problem:
    """Something wrong with a message.

    Attributes:
        message: which message of the stream it is, counted from 1.
        robot: whom it is about; empty where it does not say.
        rule: the id of the rule that it breaks.
        says: what is wrong, in a line.
        flagged: it departs from the letter of the page in a way that a reading tolerates.
    """

    message: int
    robot: str
    rule: str
    says: str
    flagged: bool = False

    def __str__(self) -> str:
        about = f" about {self.robot}" if self.robot else ""
        return f"message {self.message}{about}: {self.says} [{self.rule}]"
