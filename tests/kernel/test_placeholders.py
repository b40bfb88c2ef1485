"""Stand-ins in params that are members of others."""

from __future__ import annotations

from missionfsm.isaac.server.system import SYSTEM
from missionfsm.kernel.alphabet import as_text, member, pick
from missionfsm.kernel.history import Name
from missionfsm.tools.placeholders import fill, is_template, slots


def test_half_of_an_identifier() -> None:
    """A member of what a pick stands for is that of the name picked, also inside a text."""
    naming = SYSTEM.naming
    params = {"uuid": {"lower": member("lower", pick("uuid", 3)), "upper": "4"}}
    assert is_template(params)
    assert slots(params) == {3: "uuid"}
    name: Name = naming.make("uuid", 7)
    whole = naming.write(name)
    assert fill(params, {3: name}, naming, 1) == {"uuid": {"lower": whole["lower"], "upper": "4"}}
    assert fill(as_text(member("upper", pick("uuid"))), {0: name}, naming, 1) == f'"{whole["upper"]}"'
