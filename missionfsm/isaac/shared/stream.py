"""What is right and wrong about every line that is seen, whoever sends it and whatever it shows."""

from __future__ import annotations

from missionfsm.isaac.shared.line import LineContent
from missionfsm.isaac.shared.readings import AI_27_UUID
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.step import Mismatch


def miswritten(content: LineContent, types: Rule, integers: Rule) -> Mismatch | None:
    """What is wrong with the numbers of a line: `types` is broken by its type id, `integers` by the others."""
    if content.unsigned:
        says = "header.proto is the unsigned type id; it is sent as its signed value"
        return Mismatch(types.id, says, near=True)
    wrong = [path for path in content.bare if path != "header.uuid"]
    return Mismatch(integers.id, f"{wrong[0]} is a number", near=True) if wrong else None


def sequence(relation: str) -> tuple[Assumption, ...]:
    """How the uuid in a header compares with the one before: it is another one, or (AI-27.uuid b) the same."""
    return (AI_27_UUID["b"],) if relation == "equal" else ()
