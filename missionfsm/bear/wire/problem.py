"""Problems of a bare message, as a monitor finds them."""

from __future__ import annotations

from attrs import frozen


@frozen
class Problem:
    """Something wrong with a message.

    Attributes:
        message: which message of the stream it is, counted from 1.
        robot: the robot that the message is about; empty if it does not say.
        rule: the id of the rule that it breaks.
        says: what is wrong, in a line.
        flagged: whether a reading tolerates it, although it departs from the letter of the page.
    """

    message: int
    robot: str
    rule: str
    says: str
    flagged: bool = False

    def __str__(self) -> str:
        about = f" about {self.robot}" if self.robot else ""
        return f"message {self.message}{about}: {self.says} [{self.rule}]"
